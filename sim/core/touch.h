/* When two bodies first touch (touch.c), and what they are to each other now (meet.c). */
#ifndef TOUCH_H
#define TOUCH_H

#include "feature.h"

#define VELOCITY_TIME 1.0 /* an error in velocity counts as what it moves a body by in this time [s] */

/* Lengths and speeds below which two things are the same, set once for a run from its tolerance. */
typedef struct Slack {
    double gap;   /* a gap this small counts as closed [m] */
    double speed; /* a speed this small counts as none [m/s] */
    double root;  /* a gap is solved for to this [m]: rounding */
    double unsure; /* bodies that ought to go alike may approach so fast by error alone [m/s] */
    double bounce; /* bounces lower than this are not followed [m] */
    double
        deep; /* overlaps up to this are contacts that were pushed in; what is deeper is for the crowd to let out [m] */
} Slack;

/* Whether a contact that parts at this speed is back before it has gone far enough to be seen.  Where nothing pulls a pair
 * together it does not come back, and every speed counts. */
static inline bool is_low(const Slack *slack, double pull, double speed) {
    return pull > 0 && speed * speed < 2 * pull * slack->bounce;
}

typedef struct Touching {
    Feature feature;
    Gap gap;
} Touching;

/* A body's motion, for the search. */
typedef struct Mover {
    int32_t body;
    const Motion *motion;
} Mover;

/* The first time in [from, to] at which a feature of the two bodies that is not among `closed` touches; INFINITY if none.
 * `from` if they are too deep in each other then.  A search that takes too many steps gives up at a time before which
 * nothing touches, and returns that. The steps taken are added to *steps. */
double first_touch(const World *world, Mover a, Mover b, double from, double to, const Slack *slack,
                   const Feature *const *closed, int32_t closed_count, double *steps);

/* Whether a feature whose gap has closed is a touch at all: the point sits on the side from outside, and that side is the
 * one that it came in through. */
bool feature_faces(const World *world, const Feature *f, const Gap *g, const Placed *a, const Placed *b,
                   const Slack *slack);

/* Whether a corner that meets another passes by it: some side of the two keeps them apart, and goes on to. */
bool corner_passes(const World *world, const Feature *f, const Gap *g, const Placed *a, const Placed *b,
                   const Slack *slack);

/* The features of two bodies that touch now, at most `capacity`; their number is returned.  Where a pair of features
 * is the same touch seen from both sides, one is given. */
int32_t touching_now(const World *world, int32_t body_a, const State *a, int32_t body_b, const State *b,
                     const Slack *slack, Touching *out, int32_t capacity);

/* Whether two shapes, or any of two bodies, overlap farther than what is still held as a contact. */
bool shapes_too_deep(const World *world, int32_t shape_a, Pose at_a, int32_t shape_b, Pose at_b, const Slack *slack);
bool too_deep(const World *world, int32_t body_a, int32_t body_b, const Slack *slack);

/* Whether two bodies surely do not overlap by more than `rounding`: some side of theirs, or their circles, keep them apart. */
bool surely_apart(const World *world, int32_t body_a, int32_t body_b, double rounding);

#endif
