/* Smooth constrained motion: joints and contacts hold, and the bodies move as Newton and Euler say. */
#ifndef SMOOTH_H
#define SMOOTH_H

#include "active.h"
#include "dop853.h"

typedef struct Smooth {
    double *start, *trial, *end, *k[ALL_STAGES]; /* 6 numbers a member */
    double *acceleration;                        /* 3 a member */
    Active active;
    double tolerance;
    double relax; /* what makes redundant rows solvable: kept by the caller from step to step, 0 at first */
    Slack slack;
    double evals, rows; /* counted for the profile */
} Smooth;

int smooth_create(Smooth *smooth, const World *world, double tolerance, Slack slack);
void smooth_destroy(Smooth *smooth);

/* Place the system and choose the rows that hold. */
int smooth_prepare(Smooth *smooth, System *system);

/* One step from the system's states at time `from`, by a length near *h; *h becomes the length to try next.  motion[i] is filled for every member and ends where the step does, or at the first moment at which a contact's
 * mode no longer holds (it would pull, leave its cone, stop slipping, or leave its side); *ended says whether one did. */
int smooth_step(Smooth *smooth, System *system, double from, double *h, Motion *motion, bool *ended);

#endif
