#include "feature.h"

/* ---------------------------------------------------------------- which ones there are */

ShapeWalk walk_shapes(const World *world, int32_t body_a, Pose at_a, int32_t body_b, Pose at_b, double margin) {
    const Body *a = &world->body[body_a], *b = &world->body[body_b];
    return (ShapeWalk){world, a, b, at_a, at_b, margin, a->first_shape, b->first_shape - 1};
}

bool next_shapes(ShapeWalk *w) {
    for (; w->shape_a < w->a->first_shape + w->a->shape_count; w->shape_a++, w->shape_b = w->b->first_shape - 1)
        while (++w->shape_b < w->b->first_shape + w->b->shape_count) {
            const Shape *a = &w->world->shape[w->shape_a], *b = &w->world->shape[w->shape_b];
            Vec apart = vsub(place(w->at_a, a->centre), place(w->at_b, b->centre));
            double reach = a->reach + b->reach + w->margin;
            if (vdot(apart, apart) <= reach * reach && world_collides(w->world, w->shape_a, w->shape_b)) return true;
        }
    return false;
}

/* Polygons' corners are tried on each other's sides, a circle's centre on a polygon's sides, then on its corners. */
FeatureWalk walk_features(const World *world, int32_t shape_a, Pose at_a, int32_t shape_b, Pose at_b) {
    bool round_a = world->shape[shape_a].count == 1, round_b = world->shape[shape_b].count == 1;
    bool swap = !round_a && round_b;
    return (FeatureWalk){.world = world,
                         .above = INFINITY,
                         .below = INFINITY,
                         .beside = INFINITY,
                         .point_shape = swap ? shape_b : shape_a,
                         .other_shape = swap ? shape_a : shape_b,
                         .point_at = swap ? at_b : at_a,
                         .other_at = swap ? at_a : at_b,
                         .on_sides = !(round_a && round_b),
                         .i = -1,
                         .turns_left = !(round_a && round_b)};
}

static void turn_round(FeatureWalk *w) {
    w->turns_left--;
    w->i = -1;
    if (w->world->shape[w->point_shape].count == 1) {
        w->on_sides = false;
        return;
    }
    int32_t shape = w->point_shape;
    Pose at = w->point_at;
    w->point_shape = w->other_shape, w->other_shape = shape;
    w->point_at = w->other_at, w->other_at = at;
}

/* How far from a side, or a corner, a point may be whose feature is in reach. */
static double farthest(const FeatureWalk *w) {
    double radius = w->world->shape[w->point_shape].radius;
    if (!w->on_sides) return w->above + radius + w->world->shape[w->other_shape].radius;
    return fmax(w->above + radius, w->below) + w->beside;
}

static bool is_beyond(const Stretch *stretch, Vec from, double reach) {
    Vec apart = vsub(stretch->centre, from);
    reach += stretch->reach;
    return vdot(apart, apart) > reach * reach;
}

/* The first from i on of a shape's vertices that is not in a stretch which is all farther than that from a point; or past the
 * last, at the shape's count. */
static int32_t skip_stretches(const World *world, const Shape *shape, int32_t i, Vec from, double reach) {
    while (i % STRETCH == 0 && i < shape->count && is_beyond(&world->stretch[shape->first + i], from, reach))
        i += STRETCH;
    return i < shape->count ? i : shape->count;
}

/* The next vertex that may touch: one that bulges. */
static int32_t next_point(const FeatureWalk *w) {
    const Shape *points = &w->world->shape[w->point_shape], *other = &w->world->shape[w->other_shape];
    int32_t i = w->i + 1;
    Vec centre = points->count > LONG_OUTLINE ? unplace(w->point_at, place(w->other_at, other->centre)) : vec(0, 0);
    for (; i < points->count && points->count > 1; i++) {
        if (points->count > LONG_OUTLINE) i = skip_stretches(w->world, points, i, centre, other->reach + farthest(w));
        if (i == points->count || !w->world->side[points->first + i].reflex) break;
    }
    return i;
}

/* The side, or corner, from j on that the point is tried on next; the other's count if none is left. */
static int32_t next_other(const FeatureWalk *w, int32_t j) {
    const Shape *other = &w->world->shape[w->other_shape];
    return other->count > LONG_OUTLINE ? skip_stretches(w->world, other, j, w->point, farthest(w)) : j;
}

/* Go to the next pair of a point and what it is tried on. */
static bool step_on(FeatureWalk *w) {
    const Shape *points = &w->world->shape[w->point_shape], *other = &w->world->shape[w->other_shape];
    if (w->i >= 0 && (w->j = next_other(w, w->j + 1)) < other->count) return true;
    for (;;) {
        w->i = next_point(w);
        if (w->i == points->count) break;
        w->point = unplace(w->other_at, place(w->point_at, w->world->vertex[points->first + w->i]));
        w->j = next_other(w, 0);
        if (w->j < other->count) return true;
    }
    if (w->turns_left == 0) return false;
    turn_round(w);
    return step_on(w);
}

static bool is_in_reach(const FeatureWalk *w) {
    const Shape *points = &w->world->shape[w->point_shape], *other = &w->world->shape[w->other_shape];
    const Side *side = &w->world->side[other->first + w->j];
    Vec rho = vsub(w->point, w->world->vertex[other->first + w->j]);
    if (!w->on_sides) {
        double far = w->above + points->radius + other->radius;
        return vdot(rho, rho) <= far * far;
    }
    double gap = rho.x * side->along.y - rho.y * side->along.x - points->radius, foot = vdot(rho, side->along);
    return gap <= w->above && gap >= -w->below && foot >= -w->beside && side->length - foot >= -w->beside;
}

static void make_feature(const FeatureWalk *w, Feature *out) {
    const Shape *a = &w->world->shape[w->point_shape], *b = &w->world->shape[w->other_shape];
    const Side *side = &w->world->side[b->first];
    *out = (Feature){.shape_a = w->point_shape,
                     .shape_b = w->other_shape,
                     .body_a = a->body,
                     .body_b = b->body,
                     .index_a = w->i,
                     .index_b = w->j,
                     .is_side = w->on_sides,
                     .is_corner = !w->on_sides && b->count > 1,
                     .point_a = w->world->vertex[a->first + w->i],
                     .point_b = w->world->vertex[b->first + w->j],
                     .radius_a = a->radius,
                     .radius_b = b->radius};
    if (b->count == 1) return;
    out->along = side[w->on_sides ? w->j : (w->j + b->count - 1) % b->count].along;
    out->after = side[w->j].along;
    out->length = side[w->j].length;
}

bool next_feature(FeatureWalk *w, Feature *out) {
    while (step_on(w)) {
        const Shape *other = &w->world->shape[w->other_shape];
        bool dent = !w->on_sides && other->count > 1 && w->world->side[other->first + w->j].reflex;
        if (dent || !is_in_reach(w)) continue;
        make_feature(w, out);
        return true;
    }
    return false;
}

Feature feature_on_side(const World *world, int32_t shape_a, int32_t index_a, int32_t shape_b, int32_t index_b) {
    Feature f;
    FeatureWalk at = {
        .world = world, .point_shape = shape_a, .other_shape = shape_b, .on_sides = true, .i = index_a, .j = index_b};
    make_feature(&at, &f);
    return f;
}

/* ---------------------------------------------------------------- their gaps */

/* The velocity of a body's material point at arm r from its centre. */
static Vec velocity_at(const Placed *b, Vec r) { return vmad(b->v, b->spin, vperp(r)); }

/* With P the point of a, E the start of b's side (or the point of b), rho = P - E, w = dP/dt - dE/dt, and n turning
 * with the side:  gap = rho.n - ra,  rate = w.n + spin_b rho.t;  between points n = rho / |rho|,  rate = w.n. */
Gap feature_gap(const Feature *f, const Placed *a, const Placed *b) {
    Vec ra = turn(a->at, f->point_a), rb = turn(b->at, f->point_b);
    Vec rho = vsub(vadd(a->at.p, ra), vadd(b->at.p, rb));
    Vec w = vsub(velocity_at(a, ra), velocity_at(b, rb));
    Gap g;
    if (f->is_side) {
        g.along = turn(b->at, f->along);
        g.normal = vec(g.along.y, -g.along.x); /* outwards, for sides that run counter-clockwise */
        double foot = vdot(rho, g.along), height = vdot(rho, g.normal);
        g.gap = height - f->radius_a;
        g.rate = vdot(w, g.normal) + b->spin * foot;
        g.slip = vdot(w, g.along) - f->radius_a * a->spin - b->spin * (height - f->radius_a);
        g.margin = fmin(foot, f->length - foot);
    } else {
        double distance = vlength(rho);
        g.normal = distance > 0 ? vscale(rho, 1 / distance) : vec(0, 1);
        g.along = vperp(g.normal);
        g.gap = distance - f->radius_a - f->radius_b;
        g.rate = vdot(w, g.normal);
        g.slip = vdot(w, g.along) - f->radius_a * a->spin - f->radius_b * b->spin;
        g.margin = f->is_corner ? fmin(vdot(rho, turn(b->at, f->along)), -vdot(rho, turn(b->at, f->after))) : INFINITY;
    }
    g.point = vmad(vadd(a->at.p, ra), -f->radius_a, g.normal);
    return g;
}

void feature_bias(const Feature *f, const Placed *a, const Placed *b, double *normal_bias, double *along_bias) {
    Vec ra = turn(a->at, f->point_a), rb = turn(b->at, f->point_b);
    Vec rho = vsub(vadd(a->at.p, ra), vadd(b->at.p, rb));
    Vec w = vsub(velocity_at(a, ra), velocity_at(b, rb));
    Vec centripetal = vsub(vscale(rb, b->spin * b->spin), vscale(ra, a->spin * a->spin));
    if (f->is_side) { /* n and t turn with b: dn/dt = spin_b t, dt/dt = -spin_b n */
        Vec t = turn(b->at, f->along), n = vec(t.y, -t.x);
        double wn = vdot(w, n), wt = vdot(w, t), foot = vdot(rho, t), height = vdot(rho, n), spin = b->spin;
        *normal_bias = vdot(centripetal, n) + 2 * spin * wt - spin * spin * height;
        *along_bias = vdot(centripetal, t) - spin * wn - spin * (wn + spin * foot);
    } else { /* dn/dt = (w.t / |rho|) t */
        double distance = vlength(rho);
        Vec n = distance > 0 ? vscale(rho, 1 / distance) : vec(0, 1), t = vperp(n);
        double wn = vdot(w, n), wt = vdot(w, t), turning = distance > 0 ? wt / distance : 0;
        *normal_bias = vdot(centripetal, n) + wt * turning;
        *along_bias = vdot(centripetal, t) - turning * wn;
    }
}

bool feature_same(const Feature *f, const Feature *g) {
    return f->shape_a == g->shape_a && f->shape_b == g->shape_b && f->index_a == g->index_a &&
           f->index_b == g->index_b && f->is_side == g->is_side;
}
