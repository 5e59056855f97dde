/* The search for the first touch steps through time, all features of a pair at once.  Each feature's gap g with a bound
 * K on its second derivative cannot close before g + g' dt - K dt^2 / 2 = 0 does, so the least such dt over the features
 * is a step that nothing can be missed in, at any speed (conservative advancement, Mirtich 1996, with a bound of the
 * second order).  For free flight against a wall the bound is the motion itself and a step lands on the root; near any
 * root the steps converge as Newton's do. */
#include "touch.h"

#define MAX_STEPS 4000
#define PASSING 1e-5 /* first step for a point that passes by a side, or that a contact holds already [s] */
#define PATIENCE 60 /* steps after which a search is not on its way to a root */

/* ---------------------------------------------------------------- bounds */

typedef struct PairBound {
    double steer_ab, steer_ba; /* |second derivative| of a gap with the side on b, on a */
    double closing; /* speed of the points against each other */
} PairBound;

/* Bounds over [from, to] for two movers whose shapes reach ra and rb from their centres, and of which no two points are
 * farther apart than `apart` at the start. */
static PairBound pair_bound(const Motion *ma, double ra, const Motion *mb, double rb, double apart, double from,
                            double to) {
    MotionBound a = motion_bound(ma, from, to), b = motion_bound(mb, from, to);
    double relative = a.is_steady && b.is_steady ? vlength(vsub(a.steady, b.steady)) : a.acceleration + b.acceleration;
    double swing_a = a.spin * a.spin + a.spin_acceleration, swing_b = b.spin * b.spin + b.spin_acceleration;
    double points = relative + ra * swing_a + rb * swing_b;
    double centres = a.speed + b.speed;
    if (a.is_steady && b.is_steady) { /* their velocity against each other is greatest at one of the ends */
        Vec first = vsub(motion_state(ma, from).v, motion_state(mb, from).v);
        Vec last = vmad(first, to - from, vsub(a.steady, b.steady));
        centres = sqrt(fmax(vdot(first, first), vdot(last, last)));
    }
    PairBound bound;
    bound.closing = centres + ra * a.spin + rb * b.spin;
    apart += bound.closing * (to - from); /* |rho| at most */
    bound.steer_ab = points + 2 * b.spin * bound.closing + swing_b * apart;
    bound.steer_ba = points + 2 * a.spin * bound.closing + swing_a * apart;
    return bound;
}

/* How long the bound on a pair may look ahead before its terms in the distance grow useless. */
static double look_ahead(const Motion *ma, const Motion *mb, double from, double to) {
    double limit = to - from;
    for (int k = 0; k < 2; k++) {
        const Motion *m = k ? mb : ma;
        if (m->degree == 0) continue;
        double spin = m->degree <= 2 ? fabs(m->v[2][0]) : motion_bound(m, from, fmin(to, m->end)).spin;
        if (spin * limit > 0.5) limit = 0.5 / spin;
    }
    return from + limit;
}

/* The longest dt for which gap + rate dt - steer dt^2 / 2 stays above 0. */
static double safe_step(double gap, double rate, double steer) {
    double root = sqrt(rate * rate + 2 * steer * gap);
    if (rate < 0) return 2 * gap / (root - rate);
    return steer > 0 ? (rate + root) / steer : INFINITY;
}

/* Whether a's corner sits on b's side from outside: both sides of the corner lead away from b's side, within the slack. */
static bool leads_away(const World *world, const Feature *f, const Placed *a, Vec normal, const Slack *slack) {
    const Shape *shape = &world->shape[f->shape_a];
    if (shape->count == 1) return true;
    const Vec *v = &world->vertex[shape->first];
    int32_t n = shape->count;
    for (int32_t k = 0; k < 2; k++) {
        Vec to = vsub(v[(f->index_a + (k ? 1 : n - 1)) % n], v[f->index_a]);
        if (vdot(turn(a->at, to), normal) < -1e-6 * vlength(to) - 4 * slack->gap) return false;
    }
    return true;
}

/* Whether b's side is the one that a's point is at: a point a little inside an outline is behind more than one of its
 * sides, and touches the one that it is least deep behind. */
static bool is_nearest(const World *world, const Feature *f, const Gap *g, const Placed *a, const Placed *b,
                       const Slack *slack) {
    const Shape *shape = &world->shape[f->shape_b];
    if (!f->is_side || g->gap >= 0) return true;
    const Vec *v = &world->vertex[shape->first];
    const Side *side = &world->side[shape->first];
    Vec point = unplace(b->at, place(a->at, f->point_a));
    int32_t n = shape->count, next = (f->index_b + 1) % n, before = (f->index_b + n - 1) % n;
    for (int32_t k = 0; k < 2; k++) {
        int32_t other = k ? next : before, corner = k ? next : f->index_b;
        if (side[corner].reflex) continue;
        Vec outward = vec(side[other].along.y, -side[other].along.x);
        if (vdot(vsub(point, v[other]), outward) - f->radius_a > g->gap + slack->gap) return false;
    }
    return true;
}

/* Whether a feature whose gap has closed is a touch at all. */
static bool faces(const World *world, const Feature *f, const Gap *g, const Placed *a, const Placed *b,
                  const Slack *slack) {
    return is_nearest(world, f, g, a, b, slack) && leads_away(world, f, a, g->normal, slack);
}

/* ---------------------------------------------------------------- the search */

typedef struct Search {
    const World *world;
    const Slack *slack;
    Mover a, b;
    const Feature *const *closed;
    int32_t closed_count;
} Search;

static bool is_closed(const Search *s, const Feature *f) {
    for (int32_t k = 0; k < s->closed_count; k++)
        if (feature_same(s->closed[k], f)) return true;
    return false;
}

/* Whether a closed contact holds this touch already: at the same point, of the same two shapes, since corners that meet
 * touch in more ways than one, or along the same normal, of shapes that lie on each other. */
static bool is_held(const Search *s, const Feature *f, const Gap *g, const Placed *pa, const Placed *pb) {
    for (int32_t k = 0; k < s->closed_count; k++) {
        const Feature *c = s->closed[k];
        bool a_first = c->body_a == s->a.body;
        Gap held = feature_gap(c, a_first ? pa : pb, a_first ? pb : pa);
        if (vlength(vsub(held.point, g->point)) > 8 * s->slack->gap) continue;
        bool same = (c->shape_a == f->shape_a && c->shape_b == f->shape_b) ||
                    (c->shape_a == f->shape_b && c->shape_b == f->shape_a);
        if (same || fabs(vcross(held.normal, g->normal)) < 1e-6) return true;
    }
    return false;
}

/* A point that touches and hardly moves matters again when it has gone in by half the slack.  One that is in already
 * matters as soon as it goes on in: farther, the contact would have to lift it, and a body that rocks never rest. */
static double grazing_step(const Slack *slack, double gap, double steer) {
    double room = gap > -0.25 * slack->gap ? gap + 0.5 * slack->gap : 1e-3 * slack->gap;
    return fmax(safe_step(room, 0, steer), 1e-9);
}

/* How far in time one feature is safe, from its gap now: 0 when it touches. */
static double feature_step(const Slack *slack, const Gap *g, const PairBound *bound, double steer) {
    double aside = -g->margin - slack->gap; /* how far the foot is from where a touch could be */
    double until_margin = aside > 0 ? aside / bound->closing : 0;
    bool in_front = g->gap > -slack->deep;
    if (aside <= 0 && in_front && g->gap <= slack->root && g->rate < -slack->speed) return 0;
    if (aside <= 0 && in_front && g->gap < -0.25 * slack->gap && g->rate < -1e-6 * slack->speed) return 0;
    double step;
    if (g->gap > slack->gap || (in_front && fabs(g->rate) > slack->speed)) /* clear, or on its way in or out */
        step = safe_step(fmax(g->gap, 0), g->rate, steer);
    else if (in_front)
        step = grazing_step(slack, g->gap, steer);
    else /* behind the side: it has to come in front of it first */
        step = fmax(safe_step(-g->gap, -g->rate, steer), 1e-5);
    return fmax(step, until_margin);
}

/* The safe step of all features of two shapes. */
static double shapes_step(const Search *s, const Shape *sa, const Shape *sb, const Placed *pa, const Placed *pb,
                          const PairBound *bound, double passing, double step) {
    int32_t ia = (int32_t)(sa - s->world->shape), ib = (int32_t)(sb - s->world->shape);
    Vec apart = vsub(place(pa->at, sa->centre), place(pb->at, sb->centre));
    double discs = vlength(apart) - sa->reach - sb->reach;
    if (discs > step * bound->closing) return step;
    int32_t count = feature_count(s->world, ia, ib);
    for (int32_t k = 0; k < count && step > 0; k++) {
        Feature f;
        if (!feature_make(s->world, ia, ib, k, &f) || is_closed(s, &f)) continue;
        bool a_first = f.body_a == s->a.body;
        Gap g = feature_gap(&f, a_first ? pa : pb, a_first ? pb : pa);
        double steer =
            f.is_side ? (a_first ? bound->steer_ab : bound->steer_ba) : fmin(bound->steer_ab, bound->steer_ba);
        double own = feature_step(s->slack, &g, bound, steer);
        const Placed *point_of = a_first ? pa : pb, *side_of = a_first ? pb : pa;
        if (own <= 0 && !faces(s->world, &f, &g, point_of, side_of, s->slack)) own = passing;
        if (own < passing && is_held(s, &f, &g, pa, pb)) own = passing;
        if (g.gap < -s->slack->gap && g.margin < -s->slack->gap) own = fmax(own, passing); /* in behind, and beside */
        step = fmin(step, own);
    }
    return step;
}

static double search_shapes(const Search *s, const Shape *sa, const Shape *sb, double from, double to) {
    double t = from, horizon = from;
    PairBound bound = {0};
    double ra = vlength(sa->centre) + sa->reach, rb = vlength(sb->centre) + sb->reach;
    for (int32_t steps = 0; steps < MAX_STEPS; steps++) {
        State state_a = motion_state(s->a.motion, t), state_b = motion_state(s->b.motion, t);
        Placed pa = placed(&state_a), pb = placed(&state_b);
        if (t >= horizon) {
            horizon = look_ahead(s->a.motion, s->b.motion, t, to);
            double apart = vlength(vsub(place(pa.at, sa->centre), place(pb.at, sb->centre))) + sa->reach + sb->reach;
            bound = pair_bound(s->a.motion, ra, s->b.motion, rb, apart, t, horizon);
            if (bound.closing == 0) return INFINITY;
        }
        /* what passes by once mostly goes on to: longer steps, the longer it lasts */
        double step = shapes_step(s, sa, sb, &pa, &pb, &bound, PASSING * (1 + steps), horizon - t);
        if (step <= 0) return t;
        if (steps > PATIENCE)
            step = fmax(step, 0.5 * s->slack->gap / bound.closing); /* creeping: half a slack at least */
        if (t + step >= to) return INFINITY;
        double next = fmin(t + step, horizon);
        t = next > t ? next : nextafter(t, INFINITY);
    }
    return t;
}

double first_touch(const World *world, Mover a, Mover b, double from, double to, const Slack *slack,
                   const Feature *const *closed, int32_t closed_count) {
    Search s = {world, slack, a, b, closed, closed_count};
    const Body *body_a = &world->body[a.body], *body_b = &world->body[b.body];
    double best = INFINITY;
    for (int32_t i = body_a->first_shape; i < body_a->first_shape + body_a->shape_count; i++)
        for (int32_t j = body_b->first_shape; j < body_b->first_shape + body_b->shape_count; j++) {
            if (!world_collides(world, i, j)) continue;
            double t = search_shapes(&s, &world->shape[i], &world->shape[j], from, fmin(to, best));
            if (t < best) best = t;
        }
    return best;
}

/* ---------------------------------------------------------------- touching now */

/* Drop the one of two touches at one point that says nothing new: the same touch seen from both sides, or a corner on
 * a corner, where the side that is approached faster, else the outer one, holds. */
static bool merge_same_point(Touching *out, int32_t count, const Touching *found, double near) {
    for (int32_t k = 0; k < count; k++) {
        Touching *had = &out[k];
        bool same_pair =
            (had->feature.shape_a == found->feature.shape_a && had->feature.shape_b == found->feature.shape_b) ||
            (had->feature.shape_a == found->feature.shape_b && had->feature.shape_b == found->feature.shape_a);
        if (!same_pair || vlength(vsub(had->gap.point, found->gap.point)) > near) continue;
        if (fabs(vdot(had->gap.normal, found->gap.normal)) < 1 - 1e-9) {
            double faster = had->gap.rate - found->gap.rate;
            if (faster > near || (faster > -near && found->gap.gap > had->gap.gap + 1e-3 * near)) *had = *found;
        }
        return true;
    }
    return false;
}

int32_t touching_now(const World *world, int32_t body_a, const State *state_a, int32_t body_b, const State *state_b,
                     const Slack *slack, Touching *out, int32_t capacity) {
    const Body *a = &world->body[body_a], *b = &world->body[body_b];
    Placed pa = placed(state_a), pb = placed(state_b);
    int32_t count = 0;
    for (int32_t i = a->first_shape; i < a->first_shape + a->shape_count; i++)
        for (int32_t j = b->first_shape; j < b->first_shape + b->shape_count; j++) {
            const Shape *sa = &world->shape[i], *sb = &world->shape[j];
            Vec apart = vsub(place(pa.at, sa->centre), place(pb.at, sb->centre));
            double reach = sa->reach + sb->reach + slack->gap;
            if (vdot(apart, apart) > reach * reach || !world_collides(world, i, j)) continue;
            int32_t features = feature_count(world, i, j);
            for (int32_t k = 0; k < features; k++) {
                Touching t;
                if (!feature_make(world, i, j, k, &t.feature)) continue;
                bool a_first = t.feature.body_a == body_a;
                const Placed *point_of = a_first ? &pa : &pb;
                t.gap = feature_gap(&t.feature, point_of, a_first ? &pb : &pa);
                if (t.gap.gap > slack->gap || t.gap.gap < -slack->deep || t.gap.margin < -slack->gap) continue;
                if (!faces(world, &t.feature, &t.gap, point_of, a_first ? &pb : &pa, slack)) continue;
                if (count < capacity && !merge_same_point(out, count, &t, 8 * slack->gap)) out[count++] = t;
            }
        }
    return count;
}

/* ---------------------------------------------------------------- too deep */

/* How deep a disk about a point of the shape's frame is in a polygon; negative outside. */
static double depth_in(const World *world, const Shape *shape, Vec point, double radius) {
    const Vec *v = &world->vertex[shape->first];
    const Side *side = &world->side[shape->first];
    bool inside = false;
    double nearest = INFINITY;
    for (int32_t i = 0; i < shape->count; i++) {
        Vec a = v[i], b = v[(i + 1) % shape->count], to = vsub(point, a);
        double foot = fmin(fmax(vdot(to, side[i].along), 0), side[i].length);
        nearest = fmin(nearest, vlength(vsub(to, vscale(side[i].along, foot))));
        if ((a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) * (b.x - a.x) / (b.y - a.y))
            inside = !inside;
    }
    return inside ? nearest + radius : radius - nearest;
}

/* How deep the corners, or the circle, of a are in b. */
static double corners_depth(const World *world, const Shape *a, Pose at_a, const Shape *b, Pose at_b) {
    double deepest = -INFINITY;
    for (int32_t i = 0; i < a->count; i++) {
        Vec point = unplace(at_b, place(at_a, world->vertex[a->first + i]));
        double depth = b->count > 1 ? depth_in(world, b, point, a->radius)
                                    : a->radius + b->radius - vlength(vsub(point, world->vertex[b->first]));
        deepest = fmax(deepest, depth);
    }
    return deepest;
}

bool too_deep(const World *world, int32_t body_a, int32_t body_b, const Slack *slack) {
    const Body *a = &world->body[body_a], *b = &world->body[body_b];
    Pose at_a = body_pose(a), at_b = body_pose(b);
    for (int32_t i = a->first_shape; i < a->first_shape + a->shape_count; i++)
        for (int32_t j = b->first_shape; j < b->first_shape + b->shape_count; j++) {
            const Shape *sa = &world->shape[i], *sb = &world->shape[j];
            Vec apart = vsub(place(at_a, sa->centre), place(at_b, sb->centre));
            if (vlength(apart) > sa->reach + sb->reach || !world_collides(world, i, j)) continue;
            if (fmax(corners_depth(world, sa, at_a, sb, at_b), corners_depth(world, sb, at_b, sa, at_a)) >
                0.9 * slack->deep)
                return true;
        }
    return false;
}

/* ---------------------------------------------------------------- surely apart */

/* Whether all of a is in front of one side of b, which is an outline that bulges everywhere. */
static bool in_front_of_a_side(const World *world, const Shape *a, Pose at_a, const Shape *b, Pose at_b,
                               double rounding) {
    const Vec *v = &world->vertex[b->first];
    const Side *side = &world->side[b->first];
    for (int32_t j = 0; j < b->count && b->count > 1; j++) {
        Vec outward = vec(side[j].along.y, -side[j].along.x);
        double least = INFINITY;
        for (int32_t i = 0; i < a->count && least >= -rounding; i++) {
            Vec point = unplace(at_b, place(at_a, world->vertex[a->first + i]));
            least = fmin(least, vdot(vsub(point, v[j]), outward) - a->radius);
        }
        if (least >= -rounding) return true;
    }
    return false;
}

bool surely_apart(const World *world, int32_t body_a, int32_t body_b, double rounding) {
    const Body *a = &world->body[body_a], *b = &world->body[body_b];
    Pose at_a = body_pose(a), at_b = body_pose(b);
    for (int32_t i = a->first_shape; i < a->first_shape + a->shape_count; i++)
        for (int32_t j = b->first_shape; j < b->first_shape + b->shape_count; j++) {
            const Shape *sa = &world->shape[i], *sb = &world->shape[j];
            Vec apart = vsub(place(at_a, sa->centre), place(at_b, sb->centre));
            if (vlength(apart) >= sa->reach + sb->reach || !world_collides(world, i, j)) continue;
            bool round_a = sa->count == 1, round_b = sb->count == 1;
            if (round_a && !round_b &&
                depth_in(world, sb, unplace(at_b, place(at_a, sa->centre)), sa->radius) <= rounding)
                continue;
            if (round_b && !round_a &&
                depth_in(world, sa, unplace(at_a, place(at_b, sb->centre)), sb->radius) <= rounding)
                continue;
            if (in_front_of_a_side(world, sa, at_a, sb, at_b, rounding)) continue;
            if (in_front_of_a_side(world, sb, at_b, sa, at_a, rounding)) continue;
            return false;
        }
    return true;
}
