/* The rows of a system that hold, and the linear equations of their forces: J M^-1 F' f = what the rows lack. */
#ifndef ACTIVE_H
#define ACTIVE_H

#include "system.h"

typedef struct Active {
    int32_t count, capacity;
    int32_t *row;            /* the system's, in elimination order */
    int32_t *rank; /* of each of the system's rows: its place in that order, negative where it does not hold */
    int32_t *first; /* of each active row: where its profile begins, the first row that shares a body with it */
    double *lower, *upper; /* the factors, both by rows: L, and U transposed */
    double *inverse; /* of L's diagonal; U's is ones */
    double (*weight)[6]; /* M^-1 F': what a unit of each row's force does to its two members */
    double *unknown; /* the right side, then what solves it */
    double *force; /* the last found [N] */
    double *softness; /* how much softer than the others each row is */
} Active;

void active_destroy(Active *active);

/* Choose the rows that hold from the contacts' modes, and an order in which eliminating them fills little. */
int active_choose(Active *active, const System *system);

/* Factor the matrix of the system as it is placed; `relax` makes rows solvable that say what others have said. */
void active_factor(Active *active, const System *system, double relax);

/* unknown := the forces that take it away. */
void active_solve(Active *active);

#endif
