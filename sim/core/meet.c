/* What two bodies are to each other at one moment: where they touch, whether they overlap, whether they are apart. */
#include "touch.h"

/* ---------------------------------------------------------------- what is a touch */

/* Whether a's corner sits on something with this normal from outside: both sides of the corner lead away, or no
 * farther in than what is held. */
static bool leads_away(const World *world, const Feature *f, const Placed *a, Vec normal, const Slack *slack) {
    const Shape *shape = &world->shape[f->shape_a];
    if (shape->count == 1) return true;
    const Vec *v = &world->vertex[shape->first];
    int32_t n = shape->count;
    for (int32_t k = 0; k < 2; k++) {
        Vec to = vsub(v[(f->index_a + (k ? 1 : n - 1)) % n], v[f->index_a]);
        if (vdot(turn(a->at, to), normal) < -1e-6 * vlength(to) - slack->deep) return false;
    }
    return true;
}

/* Whether b's side is the one that a's point is at: a point a little inside an outline is behind more than one of its
 * sides, and touches the one that it is least deep behind, of those that it can have come in through. */
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
        double gap = vdot(vsub(point, v[other]), outward) - f->radius_a;
        if (gap > slack->gap) return false; /* in front of the other side of a tip: it has not come in */
        bool less_deep = gap > g->gap + slack->gap;
        if (less_deep && leads_away(world, f, a, turn(b->at, outward), slack)) return false;
    }
    return true;
}

bool feature_faces(const World *world, const Feature *f, const Gap *g, const Placed *a, const Placed *b,
                   const Slack *slack) {
    return is_nearest(world, f, g, a, b, slack) && leads_away(world, f, a, g->normal, slack);
}

/* Whether a side keeps a corner, with what it belongs to, off the side's shape, and goes on to. */
static bool keeps_off(const World *world, const Feature *on_side, const Placed *a, const Placed *b,
                      const Slack *slack) {
    Gap g = feature_gap(on_side, a, b);
    return g.gap >= -slack->gap && g.rate >= -slack->unsure && leads_away(world, on_side, a, g.normal, slack);
}

/* Whether the side of b that starts at this vertex keeps a's corner, or disk, off. */
static bool side_keeps_off(const World *world, const Feature *f, int32_t side, const Placed *a, const Placed *b,
                           const Slack *slack) {
    Feature on_side = feature_on_side(world, f->shape_a, f->index_a, f->shape_b, side);
    return keeps_off(world, &on_side, a, b, slack);
}

bool corner_passes(const World *world, const Feature *f, const Gap *g, const Placed *a, const Placed *b,
                   const Slack *slack) {
    int32_t na = world->shape[f->shape_a].count, nb = world->shape[f->shape_b].count;
    if (f->is_corner)
        return side_keeps_off(world, f, f->index_b, a, b, slack) ||
               side_keeps_off(world, f, (f->index_b + nb - 1) % nb, a, b, slack);
    if (!f->is_side || na == 1 || fabs(g->margin) > 8 * slack->gap) return false;
    double from_start = vdot(vsub(place(a->at, f->point_a), place(b->at, f->point_b)), turn(b->at, f->along));
    bool at_start = from_start < 0.5 * f->length;
    int32_t corner = at_start ? f->index_b : (f->index_b + 1) % nb;
    if (world->side[world->shape[f->shape_b].first + corner].reflex) return false;
    if (side_keeps_off(world, f, at_start ? (f->index_b + nb - 1) % nb : corner, a, b, slack)) return true;
    for (int32_t k = 0; k < 2; k++) { /* seen from the other corner: the two sides of a's */
        Feature back = feature_on_side(world, f->shape_b, corner, f->shape_a, (f->index_a + (k ? na - 1 : 0)) % na);
        if (keeps_off(world, &back, b, a, slack)) return true;
    }
    return false;
}

/* ---------------------------------------------------------------- touching now */

/* Whether two touches of one corner are in a dent of the other outline: it is on both sides of that. */
static bool is_in_a_dent(const World *world, const Feature *f, const Feature *g) {
    if (!f->is_side || !g->is_side || f->shape_a != g->shape_a || f->index_a != g->index_a) return false;
    const Shape *b = &world->shape[f->shape_b];
    bool follows = (f->index_b + 1) % b->count == g->index_b, leads = (g->index_b + 1) % b->count == f->index_b;
    return (follows && world->side[b->first + g->index_b].reflex) ||
           (leads && world->side[b->first + f->index_b].reflex);
}

/* Drop the one of two touches at one point that says nothing new: the same touch seen from both sides, or a corner on
 * a corner, where a side that is not approached, else the one that is approached faster, else the outer one, holds. */
static bool merge_same_point(const World *world, Touching *out, int32_t count, const Touching *found,
                             const Slack *slack) {
    double near = 8 * slack->gap;
    for (int32_t k = 0; k < count; k++) {
        Touching *had = &out[k];
        bool same_pair =
            (had->feature.shape_a == found->feature.shape_a && had->feature.shape_b == found->feature.shape_b) ||
            (had->feature.shape_a == found->feature.shape_b && had->feature.shape_b == found->feature.shape_a);
        if (!same_pair || vlength(vsub(had->gap.point, found->gap.point)) > near) continue;
        if (is_in_a_dent(world, &had->feature, &found->feature)) continue;
        if (fabs(vdot(had->gap.normal, found->gap.normal)) < 1 - 1e-9) {
            bool had_stays = had->gap.rate >= -slack->unsure, found_stays = found->gap.rate >= -slack->unsure;
            double faster = had->gap.rate - found->gap.rate;
            bool nearer = faster > near || (faster > -near && found->gap.gap > had->gap.gap + 1e-3 * near);
            if (had_stays != found_stays ? found_stays : nearer) *had = *found;
        }
        return true;
    }
    return false;
}

int32_t touching_now(const World *world, int32_t body_a, const State *state_a, int32_t body_b, const State *state_b,
                     const Slack *slack, Touching *out, int32_t capacity) {
    double reach = world->body[body_a].reach + world->body[body_b].reach + slack->gap;
    Vec apart = vsub(state_a->p, state_b->p);
    if (vdot(apart, apart) > reach * reach) return 0;
    Placed pa = placed(state_a), pb = placed(state_b);
    ShapeWalk shapes = walk_shapes(world, body_a, pa.at, body_b, pb.at, slack->gap);
    int32_t count = 0;
    while (next_shapes(&shapes)) {
        FeatureWalk walk = walk_features(world, shapes.shape_a, pa.at, shapes.shape_b, pb.at);
        walk.above = walk.beside = 2 * slack->gap; /* rounding is less than the slack */
        walk.below = 2 * slack->deep;
        for (Touching t; next_feature(&walk, &t.feature);) {
            bool a_first = t.feature.body_a == body_a;
            const Placed *point_of = a_first ? &pa : &pb, *other = a_first ? &pb : &pa;
            t.gap = feature_gap(&t.feature, point_of, other);
            if (t.gap.gap > slack->gap || t.gap.gap < -slack->deep || t.gap.margin < -slack->gap) continue;
            if (!feature_faces(world, &t.feature, &t.gap, point_of, other, slack)) continue;
            if (count < capacity && !merge_same_point(world, out, count, &t, slack)) out[count++] = t;
        }
    }
    return count;
}

/* ---------------------------------------------------------------- depth */

/* Whether a stretch is farther from a point than what is nearest, and not where a ray from the point to the right can cross it. */
static bool says_nothing(const Stretch *stretch, Vec point, double nearest) {
    Vec apart = vsub(stretch->centre, point);
    bool crosses = fabs(apart.y) <= stretch->reach && apart.x >= -stretch->reach;
    return !crosses && vlength(apart) - stretch->reach > nearest;
}

/* How deep a disk about a point of the shape's frame is in a polygon; negative outside. */
static double depth_in(const World *world, const Shape *shape, Vec point, double radius) {
    const Vec *v = &world->vertex[shape->first];
    const Side *side = &world->side[shape->first];
    bool inside = false;
    double nearest = INFINITY;
    for (int32_t i = 0; i < shape->count; i++) {
        while (shape->count > LONG_OUTLINE && i % STRETCH == 0 && i < shape->count &&
               says_nothing(&world->stretch[shape->first + i], point, nearest))
            i += STRETCH;
        if (i >= shape->count) break;
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
    Vec centre = unplace(at_a, place(at_b, b->centre));
    for (int32_t i = 0; i < a->count; i++) {
        if (i % STRETCH == 0 && a->count > LONG_OUTLINE) { /* what is beyond b's disk is in nothing of it */
            const Stretch *stretch = &world->stretch[a->first + i];
            if (vlength(vsub(stretch->centre, centre)) > stretch->reach + b->reach) {
                i += STRETCH - 1;
                continue;
            }
        }
        Vec point = unplace(at_b, place(at_a, world->vertex[a->first + i]));
        double depth = b->count > 1 ? depth_in(world, b, point, a->radius)
                                    : a->radius + b->radius - vlength(vsub(point, world->vertex[b->first]));
        deepest = fmax(deepest, depth);
    }
    return deepest;
}

bool shapes_too_deep(const World *world, int32_t shape_a, Pose at_a, int32_t shape_b, Pose at_b, const Slack *slack) {
    const Shape *a = &world->shape[shape_a], *b = &world->shape[shape_b];
    double limit = 0.9 * slack->deep;
    return corners_depth(world, a, at_a, b, at_b) > limit || corners_depth(world, b, at_b, a, at_a) > limit;
}

bool too_deep(const World *world, int32_t body_a, int32_t body_b, const Slack *slack) {
    Pose at_a = body_pose(&world->body[body_a]), at_b = body_pose(&world->body[body_b]);
    ShapeWalk shapes = walk_shapes(world, body_a, at_a, body_b, at_b, 0);
    while (next_shapes(&shapes))
        if (shapes_too_deep(world, shapes.shape_a, at_a, shapes.shape_b, at_b, slack)) return true;
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

/* Whether a disk about the centre of its shape is outside of a polygon. */
static bool is_outside(const World *world, const Shape *disk, Pose at_disk, const Shape *b, Pose at_b,
                       double rounding) {
    if (disk->count > 1 || b->count == 1) return false;
    return depth_in(world, b, unplace(at_b, place(at_disk, disk->centre)), disk->radius) <= rounding;
}

bool surely_apart(const World *world, int32_t body_a, int32_t body_b, double rounding) {
    Pose at_a = body_pose(&world->body[body_a]), at_b = body_pose(&world->body[body_b]);
    ShapeWalk shapes = walk_shapes(world, body_a, at_a, body_b, at_b, 0);
    while (next_shapes(&shapes)) {
        const Shape *a = &world->shape[shapes.shape_a], *b = &world->shape[shapes.shape_b];
        bool apart = is_outside(world, a, at_a, b, at_b, rounding) || is_outside(world, b, at_b, a, at_a, rounding) ||
                     in_front_of_a_side(world, a, at_a, b, at_b, rounding) ||
                     in_front_of_a_side(world, b, at_b, a, at_a, rounding);
        if (!apart) return false;
    }
    return true;
}
