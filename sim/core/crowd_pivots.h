/* The crowd's pivots, solved all at once: a chain holds whatever hangs on it. */
#ifndef CROWD_PIVOTS_H
#define CROWD_PIVOTS_H

#include "crowd_rows.h"
#include "world.h"

typedef struct Pivot {
    int32_t a, b;         /* movers */
    Vec start_a, start_b; /* arms when the frame began, in the scene's frame */
    Vec arm_a, arm_b;     /* now */
    Vec start_apart;      /* from a's point to b's when the frame began */
} Pivot;

/* A matrix by rows, two a pivot, from its first column that is not 0 to the diagonal; factored L D L^T. */
typedef struct Factored {
    double give; /* of its diagonal, that is added to it */
    double *entry, *inverse_d;
} Factored;

typedef struct Pivots {
    Pivot *pivot; /* in the order of elimination */
    int32_t count;
    Factored speeds, places; /* J M^-1 J^T, to solve for both */
    double *right;
    int64_t *row; /* where a row's diagonal is in `entry` */
    int32_t *first;
    int64_t entry_count, entry_capacity;
    int32_t *mark; /* by body, for ordering */
} Pivots;

int pivots_create(Pivots *pivots, const World *world);
void pivots_destroy(Pivots *pivots);

/* Take up the joints of moving bodies, as a frame begins. */
int pivots_load(Pivots *pivots, const World *world, const Mover *mover);

/* The matrix for where the bodies are now, to mend their places, and to solve for their speeds too. */
void pivots_factor(Pivots *pivots, const Mover *mover, bool speeds);

/* Bring the two points of every pivot to the same velocity. */
void pivots_solve(Pivots *pivots, Mover *mover);

/* Bring the two points of every pivot together, by impulses as they were directed when the matrix was made.  They change the
 * velocities too by `rate` times the way [1/s]: after a step of 1 / rate from there this keeps the energy of a swing (RATTLE,
 * Andersen 1983), with 0 it only mends, as it does at pivots of movers that are `pressed`, if that is not NULL: there it
 * could feed a jam. */
void pivots_join(Pivots *pivots, Mover *mover, double rate, const bool *pressed);

#endif
