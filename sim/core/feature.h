/* How two shapes can touch: a corner or a circle of one against a side, a corner or a circle of the other.
 *
 * Every way of touching has one smooth gap function of the two poses.  Looking for the first touch, holding a contact
 * that has closed, and noticing its end all ask the same function.  Shapes need not be convex for that.
 */
#ifndef FEATURE_H
#define FEATURE_H

#include "motion.h"

typedef struct Feature {
    int32_t shape_a, shape_b; /* the point is of a, the side (or the other point) of b */
    int32_t body_a, body_b;
    int32_t index_a, index_b; /* vertices; b's is where its side starts */
    bool is_side;             /* b has a side, else a point */
    bool is_corner;           /* b's point is a polygon's corner, and touches only outwards */
    Vec point_a, point_b;     /* in the bodies' frames */
    double radius_a, radius_b;
    Vec along;     /* b's side from point_b on, unit; of a corner the direction of the side before */
    Vec after;     /* of a corner: the direction of the side after it */
    double length; /* of the side */
} Feature;

/* A feature at one moment. The normal points from b to a; `along` is the normal turned by a quarter. */
typedef struct Gap {
    double gap, rate; /* [m], [m/s] */
    Vec normal, along;
    Vec point;     /* of contact */
    double slip;   /* velocity of a against b along `along` at the point [m/s] */
    double margin; /* how far the foot is inside the side or the corner's cone [m]; negative: no contact here */
} Gap;

/* A body at one moment, as the gap functions want it. */
typedef struct Placed {
    Pose at;
    Vec v;
    double spin;
} Placed;

static inline Placed placed(const State *s) { return (Placed){pose(s->p, s->angle), s->v, s->spin}; }

/* A walk through the pairs of shapes of two bodies that can collide and whose disks are within `margin` of each other. */
typedef struct ShapeWalk {
    const World *world;
    const Body *a, *b;
    Pose at_a, at_b;
    double margin;
    int32_t shape_a, shape_b;
} ShapeWalk;

ShapeWalk walk_shapes(const World *world, int32_t body_a, Pose at_a, int32_t body_b, Pose at_b, double margin);
bool next_shapes(ShapeWalk *walk);

/* A walk through the ways in which two shapes can touch.  Those are passed over that are clearly out of reach: with a gap
 * above `above` or below -`below`, or with a foot farther than `beside` from where it could touch [m].  The three may be
 * changed on the way. */
typedef struct FeatureWalk {
    const World *world;
    double above, below, beside;
    int32_t point_shape, other_shape; /* whose points are tried on what of which */
    Pose point_at, other_at;
    bool on_sides;     /* else on corners */
    int32_t i, j;      /* the next point, and side or corner */
    Vec point;         /* i's, in the other's frame */
    int32_t turns_left; /* of the two ways round */
} FeatureWalk;

FeatureWalk walk_features(const World *world, int32_t shape_a, Pose at_a, int32_t shape_b, Pose at_b);
bool next_feature(FeatureWalk *walk, Feature *out);

/* The feature of a vertex of one shape and the side of another that starts at a vertex of it. */
Feature feature_on_side(const World *world, int32_t shape_a, int32_t index_a, int32_t shape_b, int32_t index_b);

Gap feature_gap(const Feature *f, const Placed *a, const Placed *b);

/* The part of the gap's second derivative, and of the slip's first, that does not come from the bodies'
 * accelerations: centripetal terms and the turning of the normal [m/s^2]. */
void feature_bias(const Feature *f, const Placed *a, const Placed *b, double *normal_bias, double *along_bias);

bool feature_same(const Feature *f, const Feature *g);

#endif
