/* Motion from event to event: every body has a motion in closed form until something changes it.
 *
 * An event is the first touch of two bodies, or the end of a stretch of smooth motion.  Between events nothing is
 * computed; at one, only the bodies about it are looked at again.
 */
#ifndef EXACT_H
#define EXACT_H

#include "broad.h"
#include "impact.h"
#include "record.h"
#include "smooth.h"

/* Bodies that joints and pressing contacts hold together, in smooth motion. */
typedef struct Island {
    int32_t member_count, contact_count, member_capacity, contact_capacity;
    int32_t *member;
    Contact *contact;
    Pace pace;
    bool ended;  /* the modes of its contacts end with its present motion */
    bool jammed;  /* its constraints cannot be met: it goes to the crowd */
    bool in_use;
} Island;

typedef struct Track {
    Motion motion;
    int32_t island;    /* -1 for flight and rest */
    double touch_time; /* first touch with anything, as far as the motions reach */
    int32_t partner;
    double bucket, bucket_time; /* how many events it had lately */
    int32_t repeats;            /* and at this very moment */
    double step;                /* that its last smooth motion would have taken next [s]; 0 before any */
} Track;

/* Pairs of shapes, as keys. */
typedef struct PairList {
    uint64_t *pair;
    int32_t count, capacity;
} PairList;

typedef struct Exact {
    World *world;
    Recorder *recorder;
    Slack slack;
    double tolerance;
    double horizon; /* touches are known up to here [s] */
    Track *track; /* of every body */
    Island *island;
    int32_t island_count;
    System group; /* the bodies about an event */
    System part;  /* one island */
    ContactSolver solver;
    Smooth smooth;
    Motion *motion; /* of the part's members, from a step */
    Course *course; /* of every body, from when its touches are looked for */
    double *acceleration;
    int32_t *root; /* union-find over the group */
    Vec *impulse;
    int32_t impulse_capacity;
    Touching *touching;
    int32_t touching_capacity;
    const Feature **closed;
    int32_t closed_capacity;
    PairList before, after;   /* pairs in contact, before an event and after it */
    bool *changed, *fresh;    /* bodies whose touches, or everything, have to be looked at again */
    Sweep sweep;
    Box *box;       /* where each body can be while touches are looked for */
    bool *searched; /* bodies of which they are */
    bool from_crowd;          /* it is the crowd's bodies that are taken up */
    double spent, spent_time; /* pairs looked at lately, for the budget */
    double steps, steps_time; /* of the integrator, likewise */
} Exact;

int exact_create(Exact *exact, World *world, Recorder *recorder, double tolerance);
void exact_destroy(Exact *exact);

/* Take up all bodies at the start. */
int exact_start(Exact *exact, double time);

/* Take up the bodies of the crowd again: overlaps that it left are held and let out. */
int exact_take_back(Exact *exact, double time);

/* Run to `until`, or to an earlier time at which bodies went to the crowd; *reached says which.  What happens at `until`
 * itself is left to the next call. */
int exact_run(Exact *exact, double from, double until, double *reached);

/* Write what is left to be written: samples up to the end. */
void exact_finish(Exact *exact);

/* A tracked body's state. */
State exact_state(const Exact *exact, int32_t body, double time);

/* Give a body, with all that its motion hangs on, to the crowd. */
int exact_hand_over(Exact *exact, int32_t body, double time);

/* A body may have entered or left the crowd in its step: write its samples and follow it on. */
int exact_after_crowd(Exact *exact, int32_t body, double from, double to);

/* group.c: dissolve what holds the bodies of exact->group at `time`, resolve what happens, and set them on their way. */
int group_reform(Exact *exact, double time);

/* Put a body into the group with all that its motion hangs on: its island, its joints, what touches it.  In two steps: bodies
 * that are not in it, and then what the motion of its members hangs on, from one of them on. */
int group_gather(Exact *exact, int32_t body, double time);
void group_add(Exact *exact, int32_t body, double time);
int group_spread(Exact *exact, int32_t first_member, double time);

/* change.c: the contacts of the group's islands, to be called before those are dissolved; what is different now that the
 * contacts' modes are known; a body that came to rest. */
int change_note_before(Exact *exact);
int change_tell_contacts(Exact *exact, double time);
int change_tell_rest(Exact *exact, int32_t body, double time, Vec at);

/* Set the group's bodies down where they are, for the crowd to take up. */
void group_send_to_crowd(Exact *exact, double time);

static inline bool is_tracked(const Exact *e, int32_t body) { return e->world->body[body].mode != MODE_CROWD; }

/* search.c: find the first touches of all bodies marked as changed, and of those whose partner was one of them. */
int search_touches(Exact *exact, double from);

/* Touches are looked for up to a horizon that does not hang on how long the run is to be: a longer one begins as a shorter
 * one does. */
int search_farther(Exact *exact);

/* Mark the bodies that something is near or that may hang on a joint: all others are by themselves. */
int search_neighbours(Exact *exact, double time);

/* The next stretch of an island's smooth motion. */
int island_advance(Exact *exact, int32_t island, double from);
int island_settle(Exact *exact, const Island *island, double time);
void island_dissolve(Exact *exact, int32_t island);

#endif
