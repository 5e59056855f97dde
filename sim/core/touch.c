/* The search for the first touch steps through time, all features of a pair at once.  Each feature's gap g with a bound
 * K on its second derivative cannot close before g + g' dt - K dt^2 / 2 = 0 does, so the least such dt over the features
 * is a step that nothing can be missed in, at any speed (conservative advancement, Mirtich 1996, with a bound of the
 * second order).  For free flight against a wall the bound is the motion itself and a step lands on the root; near any
 * root the steps converge as Newton's do. */
#include "touch.h"

#include "broad.h"

#define MAX_STEPS 4000
#define PASSING 1e-5 /* first step for a point that passes by a side, or that a contact holds already [s] */
#define SLOW 0.1 /* of the time left: a step shorter than that asks for the gap's acceleration too */
#define PATIENCE 60 /* steps after which a search is not on its way to a root */

/* ---------------------------------------------------------------- bounds */

typedef struct PairBound {
    double steer_ab, steer_ba; /* |second derivative| of a gap with the side on b, on a */
    double veer_ab, veer_ba; /* and the third */
    double points, jerk; /* the points' acceleration against each other, and its change */
    double closing; /* speed of the points against each other */
    double passing; /* and as one sees them who turns with a or b */
} PairBound;

/* The third derivative of a unit vector that turns with a body. */
static double whirl(const MotionBound *m) {
    return m->spin_jerk + 3 * m->spin * m->spin_acceleration + m->spin * m->spin * m->spin;
}

/* Bounds over [from, to] for two movers whose shapes reach ra and rb from their centres, and of which no two points are
 * farther apart than `apart` at the start. */
static PairBound pair_bound(const Motion *ma, double ra, const Motion *mb, double rb, double apart, double from,
                            double to) {
    MotionBound a = motion_bound(ma, from, to), b = motion_bound(mb, from, to);
    double swing_a = a.spin * a.spin + a.spin_acceleration, swing_b = b.spin * b.spin + b.spin_acceleration;
    RelativeBound centres = {0};
    if (a.is_steady && b.is_steady) { /* their velocity against each other is greatest at one of the ends */
        Vec first = vsub(motion_state(ma, from).v, motion_state(mb, from).v), pull = vsub(a.steady, b.steady);
        Vec last = vmad(first, to - from, pull);
        centres.speed = sqrt(fmax(vdot(first, first), vdot(last, last)));
        centres.acceleration = vlength(pull);
    } else {
        centres = motion_against(ma, mb, from, to);
    }
    double points = centres.acceleration + ra * swing_a + rb * swing_b;
    PairBound bound = {.points = points};
    bound.closing = centres.speed + ra * a.spin + rb * b.spin;
    apart += bound.closing * (to - from); /* |rho| at most */
    bound.passing = bound.closing + fmax(a.spin, b.spin) * apart;
    bound.steer_ab = points + 2 * b.spin * bound.closing + swing_b * apart;
    bound.steer_ba = points + 2 * a.spin * bound.closing + swing_a * apart;
    bound.jerk = centres.jerk + ra * whirl(&a) + rb * whirl(&b);
    bound.veer_ab = bound.jerk + 3 * b.spin * points + 3 * swing_b * bound.closing + apart * whirl(&b);
    bound.veer_ba = bound.jerk + 3 * a.spin * points + 3 * swing_a * bound.closing + apart * whirl(&a);
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

/* ---------------------------------------------------------------- the search */

typedef struct Search {
    const World *world;
    const Slack *slack;
    Mover a, b;
    const Feature *const *closed;
    int32_t closed_count;
    double *steps; /* counted */
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
static double room_of(const Slack *slack, const Gap *g) {
    if (g->gap > slack->gap || fabs(g->rate) > slack->speed)
        return fmax(g->gap, 0); /* clear, or on its way in or out */
    return g->gap > -0.25 * slack->gap ? g->gap + 0.5 * slack->gap : 1e-3 * slack->gap;
}

/* The gap's second derivative: what the bodies' accelerations do along the normal, and what comes from their velocities. */
static double gap_acceleration(const Search *s, const Feature *f, const Gap *g, const Placed *pa, const Placed *pb,
                               double time) {
    double sum, along;
    bool a_first = f->body_a == s->a.body;
    feature_bias(f, a_first ? pa : pb, a_first ? pb : pa, &sum, &along);
    for (int k = 0; k < 2; k++) {
        State a = motion_acceleration(k ? s->b.motion : s->a.motion, time);
        double part = vdot(a.v, g->normal) + a.spin * vcross(vsub(g->point, (k ? pb : pa)->at.p), g->normal);
        sum += (k == 0) == a_first ? part : -part;
    }
    return sum;
}

/* How far in time one feature is safe, from its gap now: 0 when it touches. */
static double feature_step(const Slack *slack, const Gap *g, const PairBound *bound, double steer) {
    double aside = -g->margin - slack->gap; /* how far the foot is from where a touch could be */
    double until_margin = aside > 0 ? aside / bound->passing : 0;
    bool in_front = g->gap > -slack->deep;
    if (aside <= 0 && in_front && g->gap <= slack->root && g->rate < -slack->speed) return 0;
    if (aside <= 0 && in_front && g->gap < -0.25 * slack->gap && g->rate < -1e-6 * slack->speed) return 0;
    double step;
    if (g->gap > slack->gap || (in_front && fabs(g->rate) > slack->speed))
        step = safe_step(room_of(slack, g), g->rate, steer);
    else if (in_front)
        step = fmax(safe_step(room_of(slack, g), 0, steer), 1e-9);
    else /* behind the side: it has to come in front of it first */
        step = fmax(safe_step(-g->gap, -g->rate, steer), 1e-5);
    return fmax(step, until_margin);
}

/* How long a point may go on in that is in already and goes slowly: until it turns round, if that cannot be seen; when the
 * search begins, at least as long as a touch takes to go in by what can be told, since what began it had its say. */
static double turning_step(const Slack *slack, const Gap *g, double acceleration, double steer, bool begins) {
    double seen = 1e-3 * slack->gap;
    if (acceleration > 0 && g->rate * g->rate < 2 * acceleration * seen) return -g->rate / acceleration;
    return begins ? fmax(safe_step(seen, g->rate, steer), 1e-9) : 0;
}

/* The most that a gap's third derivative can be. Of rho . n it follows term by term, with n turning as the side does; of
 * |rho| with n turning by what the points move across it, as long as they do not come nearer. */
static double veer_of(const PairBound *bound, const Feature *f, const Gap *g, bool a_first) {
    if (f->is_side) return a_first ? bound->veer_ab : bound->veer_ba;
    double turning = bound->closing / fmax(g->gap + f->radius_a + f->radius_b, 1e-300);
    return bound->jerk + 3 * turning * (bound->points + turning * bound->closing);
}

/* room + rate dt + acceleration dt^2 / 2 - veer dt^3 / 6 is not negative for so long: what falls of it may take half of
 * the room each. */
static double third_order_step(double room, double rate, double acceleration, double veer) {
    double step = veer == 0 ? INFINITY : acceleration > 0 ? 3 * acceleration / veer : 0;
    if (rate < 0) step = fmin(step, 0.5 * room / -rate);
    return acceleration < 0 ? fmin(step, sqrt(room / -acceleration)) : step;
}

/* The safe step of all features of two shapes; *parting says whether what keeps it short parts already, but slowly. */
static double shapes_step(const Search *s, int32_t shape_a, int32_t shape_b, const Placed *pa, const Placed *pb,
                          const PairBound *bound, double passing, double time, double step, bool begins,
                          bool *parting) {
    FeatureWalk walk = walk_features(s->world, shape_a, pa->at, shape_b, pb->at);
    for (Feature f; step > 0;) {
        double way = (1 + 1e-9) * step * bound->passing + s->slack->gap; /* what is farther cannot touch in the step */
        walk.above = walk.beside = way;
        walk.below = way + s->slack->deep;
        if (!next_feature(&walk, &f)) break;
        if (is_closed(s, &f)) continue;
        bool a_first = f.body_a == s->a.body;
        Gap g = feature_gap(&f, a_first ? pa : pb, a_first ? pb : pa);
        /* the distance of two points curves up by what they move across it: only their acceleration takes from it */
        double steer = !f.is_side ? bound->points : a_first ? bound->steer_ab : bound->steer_ba;
        double own = feature_step(s->slack, &g, bound, steer);
        bool parts = false; /* but slowly at first */
        bool slow = g.rate >= 0 || (own > 0 && g.rate >= -s->slack->speed);
        if (slow && g.gap > -s->slack->deep && own < SLOW * step) {
            double acceleration = gap_acceleration(s, &f, &g, pa, pb, time), veer = veer_of(bound, &f, &g, a_first);
            parts = acceleration > 0 && veer > 0;
            own = fmax(own, third_order_step(room_of(s->slack, &g), g.rate, acceleration, veer));
        }
        const Placed *point_of = a_first ? pa : pb, *side_of = a_first ? pb : pa;
        if (own <= 0 && g.rate >= -s->slack->speed) /* on its way in, slowly: unless it turns round at once */
            own = turning_step(s->slack, &g, gap_acceleration(s, &f, &g, pa, pb, time), steer, begins);
        if (own <= 0 && !feature_faces(s->world, &f, &g, point_of, side_of, s->slack)) own = passing;
        if (own <= 0 && corner_passes(s->world, &f, &g, point_of, side_of, s->slack)) own = passing;
        if (own < passing && is_held(s, &f, &g, pa, pb)) own = passing;
        if (g.gap < -s->slack->gap && g.margin < -s->slack->gap) own = fmax(own, passing); /* in behind, and beside */
        if (own >= step) continue;
        step = own;
        *parting = parts;
    }
    return step;
}

/* How far apart the disks about two shapes are. */
static double disks_apart(const Shape *a, const Placed *pa, const Shape *b, const Placed *pb) {
    return vlength(vsub(place(pa->at, a->centre), place(pb->at, b->centre))) - a->reach - b->reach;
}

/* Whether a body in flight stays clear of the box about a shape that stands. */
static bool stays_clear(const Search *s, const Shape *a, const Shape *b, double from, double to) {
    if (s->a.motion->degree > 2 || s->b.motion->degree > 0) return false;
    State first = motion_state(s->a.motion, from), last = motion_state(s->a.motion, to);
    State fall = motion_acceleration(s->a.motion, from), stands = motion_state(s->b.motion, from);
    /* a parabola strays from its chord by an eighth of its acceleration times the time squared */
    Vec bend = vscale(vec(fabs(fall.v.x), fabs(fall.v.y)), 0.125 * (to - from) * (to - from));
    Box way = box_join((Box){vsub(first.p, bend), vadd(first.p, bend)}, (Box){vsub(last.p, bend), vadd(last.p, bend)});
    way = box_grow(way, vlength(a->centre) + a->reach + s->slack->gap);
    Pose at = pose(stands.p, stands.angle);
    Box box = {0};
    for (int32_t k = 0; k < b->count; k++) {
        Vec v = place(at, s->world->vertex[b->first + k]);
        Box point = box_grow((Box){v, v}, b->radius);
        box = k ? box_join(box, point) : point;
    }
    return !boxes_meet(&way, &box);
}

/* How far a shape's points are from the centre of mass of the body that carries it; a circle's one point is its centre. */
static double arm_of(const World *world, const Shape *shape) {
    return shape->count == 1 ? vlength(world->vertex[shape->first]) : vlength(shape->centre) + shape->reach;
}

/* How far ahead the search looks at first: of a long outline, only at what the other shape can come near, as it is far more. */
static double first_look(const Search *s, const Shape *a, const Shape *b, double from, double to) {
    if (a->count <= LONG_OUTLINE && b->count <= LONG_OUTLINE) return to - from;
    PairBound all = pair_bound(s->a.motion, arm_of(s->world, a), s->b.motion, arm_of(s->world, b), 0, from, to);
    return fmin(to - from, fmin(a->reach, b->reach) / fmax(all.closing, 1e-300));
}

static double search_shapes(const Search *s, int32_t shape_a, int32_t shape_b, double from, double to) {
    const Shape *a = &s->world->shape[shape_a], *b = &s->world->shape[shape_b];
    if (stays_clear(s, a, b, from, to)) return INFINITY;
    double t = from, horizon = from, ahead = first_look(s, a, b, from, to), ra = arm_of(s->world, a),
           rb = arm_of(s->world, b);
    PairBound bound = {0};
    for (int32_t steps = 0; steps < MAX_STEPS; steps++) {
        *s->steps += 1;
        State state_a = motion_state(s->a.motion, t), state_b = motion_state(s->b.motion, t);
        Placed pa = placed(&state_a), pb = placed(&state_b);
        double apart = disks_apart(a, &pa, b, &pb);
        if (t >= horizon) {
            horizon = look_ahead(s->a.motion, s->b.motion, t, fmin(to, t + ahead));
            ahead *= 4;
            bound = pair_bound(s->a.motion, ra, s->b.motion, rb, apart + 2 * (a->reach + b->reach), t, horizon);
            if (bound.closing == 0) return INFINITY;
        }
        if (t == from && apart <= 0 && shapes_too_deep(s->world, shape_a, pa.at, shape_b, pb.at, s->slack)) return t;
        double step = horizon - t;
        bool parting = false;
        if (apart <=
            step * bound.closing) /* what passes by once mostly goes on to: longer steps, the longer it lasts */
            step =
                shapes_step(s, shape_a, shape_b, &pa, &pb, &bound, PASSING * (1 + steps), t, step, t == from, &parting);
        if (step <= 0) return t;
        if (parting && step < SLOW * (horizon - t)) { /* bounds are the closer, the less far they look ahead */
            ahead = SLOW * (horizon - t);
            horizon = t;
            continue;
        }
        if (steps > PATIENCE)
            step = fmax(step, 0.5 * s->slack->gap / bound.closing); /* creeping: half a slack at least */
        if (t + step >= to) return INFINITY;
        double next = fmin(t + step, horizon);
        t = next > t ? next : nextafter(t, INFINITY);
    }
    return t;
}

double first_touch(const World *world, Mover a, Mover b, double from, double to, const Slack *slack,
                   const Feature *const *closed, int32_t closed_count, double *steps) {
    Search s = {world, slack, a, b, closed, closed_count, steps};
    Pose anywhere = {{0, 0}, 1, 0};
    ShapeWalk shapes = walk_shapes(world, a.body, anywhere, b.body, anywhere, INFINITY);
    double best = INFINITY;
    while (next_shapes(&shapes))
        best = fmin(best, search_shapes(&s, shapes.shape_a, shapes.shape_b, from, fmin(to, best)));
    return best;
}
