/* What the parts of the crowd share: crowd.c steps; crowd_range.c says what bodies may sweep in a frame, crowd_touch.c finds
 * pairs there, crowd_near.c how near they are, crowd_contact.c makes contacts of them; crowd_rest.c puts bodies to rest,
 * crowd_events.c tells what happened. */
#ifndef CROWD_PARTS_H
#define CROWD_PARTS_H

#include <stdlib.h>

#include "broad.h"
#include "crowd.h"
#include "crowd_memory.h"
#include "crowd_pivots.h"
#include "posed.h"

/* Two pieces whose boxes meet but that do not touch yet: they cannot before the gap along the normal is used up. */
typedef struct Near {
    int32_t piece_a, piece_b;
    int32_t a, b; /* bodies */
    Vec normal; /* of an axis that separates them */
    double gap; /* when the bodies had moved and turned so much in the frame: */
    Vec moved; /* b against a */
    double turned_a, turned_b;
} Near;

/* How far a body may move in the frame before what it may meet is looked for anew. */
typedef struct Range {
    Vec low, high; /* of the way of its centre */
    double room; /* beyond that, and for turning */
} Range;

/* What a body is to a frame. */
typedef enum Part { PART_NONE, PART_STANDS, PART_MOVES } Part;

struct Crowd {
    Recorder *recorder; /* or NULL */
    double tolerance;
    double time; /* when the substep ends */
    bool open; /* a frame goes on */
    double length, left; /* of it, and how long it has to go yet [s] */
    Part *part; /* by body, when it began */
    Vec *base; /* by body: where it was then */
    double *base_angle;
    double substep; /* the last one's length: impulses are of that long */
    double longest_substep;
    int32_t body_count, shape_count, piece_count;
    Mover *mover; /* by body */
    int32_t *active; /* the bodies that take part in the frame */
    int32_t active_count;
    Pose *start; /* by body: when the frame began */
    double *start_angle, *body_swing;
    Vec *lead; /* by body: how far ahead of the start its contacts are looked for */
    int64_t *placed; /* by body: the moment for which its outlines hold */
    int64_t moment; /* counts frames and substeps */
    Posed posed;
    double fall; /* the size of gravity [m/s^2] */
    double *piece_reach; /* by piece: its shape's reach */
    Box *piece_box; /* by piece, when the frame began, without margins */
    Box *shape_box; /* by shape: all that it may sweep in the frame */
    Range *range; /* by body: within which those boxes hold */
    Index
        known; /* the pairs of pieces that are contacts or near ones, once a body has left its range; else -1 of them */
    bool *shape_moves;
    Sweep sweep;
    Near *near;
    int32_t near_count, near_capacity;
    Near *last_near; /* of the frame before, with their gaps when it ended */
    Index last_index;
    Vec *end; /* by body: where it was when that frame ended */
    double *end_angle;
    Rows rows; /* the contacts */
    Memory memory;
    Pivots pivots;
    bool *pressed; /* by body: a contact presses on it in the substep; not looked for without pivots */
    /* crowd_rest.c */
    Vec *still_position; /* by body: where it was when it last moved */
    double *still_angle, *still_time;
    bool *told; /* by body: it was told to rest, and has not left the place since */
    Vec *told_position;
    double *told_angle;
    int32_t *island; /* by body: union-find */
    double *island_time;
    int32_t *ring; /* by body: the next one that was put to rest with it */
    double *roused; /* by body: how hard it was woken in this frame [m/s], or 0 */
    bool *nudged; /* by body: to be woken when the frame is over */
    bool *touched; /* by body: has had a contact or a joint in the frame, or, when it ends, has something near */
};

/* An array of so many, and one more, zeroed. */
static inline void *table(size_t count, size_t size) { return calloc(count + 1, size); }

/* Where a body is in the frame. */
static inline Vec crowd_position(const Crowd *crowd, int32_t body) {
    return vadd(crowd->base[body], crowd->mover[body].moved);
}
static inline double crowd_angle(const Crowd *crowd, int32_t body) {
    return crowd->base_angle[body] + crowd->mover[body].turned;
}

static inline bool crowd_moves(const World *world, int32_t body) { return world->body[body].mode == MODE_CROWD; }

/* The smaller reach of two pieces' shapes: what lengths about their contact are measured by. */
static inline double contact_reach(const Crowd *crowd, int32_t piece_a, int32_t piece_b) {
    return smaller(crowd->piece_reach[piece_a], crowd->piece_reach[piece_b]);
}

/* crowd_contact.c */
void contact_set_points(Crowd *crowd, const World *world, Contact *c, const Manifold *m, const Record *old);
void contact_add(Crowd *crowd, const World *world, const Near *near, const Manifold *m);

/* crowd_range.c */
int range_create(Crowd *crowd, const World *world);
void range_destroy(Crowd *crowd);
void range_place(Crowd *crowd, const World *world, int32_t body);
void range_start(Crowd *crowd, const World *world, int32_t body, double dt);
void range_widen(Crowd *crowd, const World *world, int32_t body, double left);
Box range_swept(const Crowd *crowd, Box box, int32_t body);

/* Whether the body will be out of its range in dt, at its present velocity. */
static inline bool range_left(const Crowd *crowd, int32_t body, double dt) {
    const Mover *m = &crowd->mover[body];
    const Range *range = &crowd->range[body];
    Two to = two(m->moved) + both(dt) * two(m->velocity), low = two(range->low) - to, high = to - two(range->high);
    double room = range->room - smaller(fabs(m->turned) + fabs(m->spin) * dt, 2.0) * crowd->body_swing[body];
    Mask out = (Mask)(low > both(room)) | (Mask)(high > both(room));
    return (out[0] | out[1]) != 0 || room < 0;
}

/* crowd_near.c */
/* How far a near pair is apart at least, as the bodies have moved since it was looked at. */
static inline double near_gap(const Crowd *crowd, const Near *n) {
    const Mover *a = &crowd->mover[n->a], *b = &crowd->mover[n->b];
    Vec moved = vsub(vsub(b->moved, a->moved), n->moved);
    return n->gap + vdot(n->normal, moved) - fabs(a->turned - n->turned_a) * crowd->posed.swing[n->piece_a] -
           fabs(b->turned - n->turned_b) * crowd->posed.swing[n->piece_b];
}

/* The gap and its normal hold for where the bodies are now. */
static inline void near_set(const Crowd *crowd, Near *n, Vec normal, double gap) {
    const Mover *a = &crowd->mover[n->a], *b = &crowd->mover[n->b];
    n->normal = normal;
    n->gap = gap;
    n->moved = vsub(b->moved, a->moved);
    n->turned_a = a->turned;
    n->turned_b = b->turned;
}

/* An upper bound of how fast two bodies' pieces come nearer, whatever the direction. */
static inline double near_rate(const Crowd *crowd, const Near *n) {
    const Mover *a = &crowd->mover[n->a], *b = &crowd->mover[n->b];
    return vlength(vsub(b->velocity, a->velocity)) + fabs(a->spin) * crowd->posed.swing[n->piece_a] +
           fabs(b->spin) * crowd->posed.swing[n->piece_b];
}

/* And of how much nearer at that rate in dt, as gravity changes it. */
static inline double near_closing(const Crowd *crowd, double rate, double dt) { return dt * (rate + dt * crowd->fall); }

/* How much nearer two bodies' pieces can come along the normal in dt, at their present velocities. */
static inline double near_approach(const Crowd *crowd, const Near *n, double dt) {
    const Mover *a = &crowd->mover[n->a], *b = &crowd->mover[n->b];
    double turning = fabs(a->spin) * crowd->posed.swing[n->piece_a] + fabs(b->spin) * crowd->posed.swing[n->piece_b];
    return dt * (turning - vdot(n->normal, vsub(b->velocity, a->velocity)));
}

void near_manifold(Crowd *crowd, World *world, int32_t piece_a, int32_t piece_b, int32_t a, int32_t b, double margin,
                   Manifold *m);
bool near_look(Crowd *crowd, World *world, Near *near, double soon, double later);
bool near_look_along(Crowd *crowd, World *world, Near *near, double dt, double later);
double near_skin(const Crowd *crowd, const Near *near);

/* crowd_touch.c */
int touch_create(Crowd *crowd, const World *world);
void touch_destroy(Crowd *crowd);
int touch_frame(Crowd *crowd, World *world, double dt, double substep);
void touch_refresh(Crowd *crowd, World *world, double left);
int touch_near(Crowd *crowd, World *world, double left, double substep, double threshold, bool *found);
int touch_finish(Crowd *crowd, double dt);

/* crowd_events.c */
bool events_touching(const Crowd *crowd, const World *world, const Contact *contact);
int events_tell_impacts(Crowd *crowd, const World *world);
int events_tell_contacts(Crowd *crowd, const World *world);
int events_tell_rest(Crowd *crowd, const World *world, int32_t body);

/* crowd_rest.c */
int rest_create(Crowd *crowd, const World *world);
void rest_destroy(Crowd *crowd);
bool rest_wake_joined(Crowd *crowd, World *world);
bool rest_disturb(Crowd *crowd, World *world, int32_t body, int32_t by, bool close);
void rest_wake_nudged(Crowd *crowd, World *world);
void rest_forget(Crowd *crowd, int32_t body);
int rest_update(Crowd *crowd, World *world, double dt);

#endif
