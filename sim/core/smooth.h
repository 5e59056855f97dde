/* Smooth constrained motion: joints and contacts hold, and the bodies move as Newton and Euler say. */
#ifndef SMOOTH_H
#define SMOOTH_H

#include "dop853.h"
#include "system.h"

typedef struct Smooth {
    int32_t capacity, row_capacity; /* members, rows */
    double *start, *trial, *end, *k[ALL_STAGES];
    int32_t *active, *rank, *first; /* rows that hold, in elimination order; each row's place in it; profiles */
    int32_t active_count;
    double *matrix, *force, *residual, *softness; /* the latter three by active row */
    double *acceleration;
    double tolerance;
    double relax; /* what makes redundant rows solvable: kept by the caller from step to step, 0 at first */
    Slack slack;
    double evals, rows; /* counted for the profile */
} Smooth;

int smooth_create(Smooth *smooth, const World *world, double tolerance, Slack slack);
void smooth_destroy(Smooth *smooth);

/* Choose the rows that hold from the contacts' modes, and an order in which eliminating them fills little. */
int smooth_prepare(Smooth *smooth, System *system);

/* Take the states onto the constraints: positions, then velocities.  *left becomes the largest speed against a row that
 * is left over: nearly contradictory rows, as of a jammed wedge, cannot all be met. */
int smooth_project(Smooth *smooth, System *system, double *left);
int smooth_project_velocities(Smooth *smooth, System *system);

/* One step from the system's states at time `from`, by a length near *h; *h becomes the length to try next.  motion[i] is filled for every member and ends where the step does, or at the first moment at which a contact's
 * mode no longer holds (it would pull, leave its cone, stop slipping, or leave its side); *ended says whether one did. */
int smooth_step(Smooth *smooth, System *system, double from, double *h, Motion *motion, bool *ended);

#endif
