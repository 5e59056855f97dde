/* Smooth constrained motion: joints and contacts hold, and the bodies move as Newton and Euler say. */
#ifndef SMOOTH_H
#define SMOOTH_H

#include "active.h"
#include "dop853.h"

/* What integrating an island keeps from step to step. */
typedef struct Pace {
    double step;        /* length to try next [s] */
    double last, error; /* length of the last one, and its error, of what is allowed; 0 before any */
    double relax;       /* what makes redundant rows solvable; 0 as long as none are */
} Pace;

typedef struct Smooth {
    double *block;                                                /* that holds these: */
    double *start, *before, *trial, *end;                         /* 6 numbers a member */
    double *slopes_before, *k[ALL_STAGES], *dense[DENSE]; /* likewise */
    double *acceleration;                        /* 3 a member */
    Active active;
    double tolerance;
    double relax;         /* of the island at hand */
    const Pace *latest;   /* whose step was the last one, which began at `before`; NULL: nobody's */
    double latest_end;    /* [s] */
    bool projected;       /* since then */
    Slack slack;
    double evals, rows; /* counted for the profile */
} Smooth;

int smooth_create(Smooth *smooth, const World *world, double tolerance, Slack slack);
void smooth_destroy(Smooth *smooth);

/* Place the system and choose the rows that hold. */
int smooth_prepare(Smooth *smooth, System *system);

/* One step from the system's states at time `from`, at the island's pace.  motion[i] is filled for every member and ends
 * where the step does, or at the first moment at which a contact's mode no longer holds (it would pull, leave its cone, stop
 * slipping, or leave its side); *ended says whether one did. */
int smooth_step(Smooth *smooth, System *system, double from, Pace *pace, Motion *motion, bool *ended);

#endif
