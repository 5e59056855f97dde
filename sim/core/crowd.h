/* The crowd: many bodies in contact at once, stepped together by small substeps (crowd.c). */
#ifndef CROWD_H
#define CROWD_H

#include "record.h"

typedef struct Crowd Crowd;

/* NULL when out of memory.  What happens is told to the recorder, if there is one. */
Crowd *crowd_create(const World *world, Recorder *recorder);
void crowd_destroy(Crowd *crowd);

/* Advance every body whose mode is MODE_CROWD from a time to another.  Bodies in other modes are not touched: those at rest and the
 * background are walls for this step; bodies in flight or smooth motion are kept clear of the crowd by the caller, which
 * makes them part of it when they come near.  Contacts are remembered from step to step for warm starting.
 * On return a body that has come to rest has MODE_REST (its whole island with it, velocities zero); one that touches
 * nothing, carries no joint and has nothing near has MODE_FLIGHT. A resting body that is hit is woken: MODE_CROWD. */
int crowd_step(Crowd *crowd, World *world, double from, double to, double tolerance);

/* Whether a body is so slow that in the crowd rolling resistance acts on it; never without gravity. */
bool crowd_is_slow(const World *world, int32_t body);

#endif
