/* The rows of a system that hold, and the linear equations of their forces: J M^-1 F' f = what the rows lack.
 *
 * The matrix is of blocks of two by two, those of a joint's or a contact's two rows; a row that does not hold stands in
 * it as a one on the diagonal.  Blocks meet only in bodies that they share.  Where is worked out when the rows are
 * chosen, so that filling and factoring asks nothing: a chain of pivots takes a time in proportion to its length.
 */
#ifndef ACTIVE_H
#define ACTIVE_H

#include "system.h"

/* The matrix a b, c d. */
typedef struct Block {
    double a, b, c, d;
} Block;

/* Two rows as they are: by row, then by side. */
typedef struct RowPair {
    double j[2][2][3];      /* J, or zeros for a row that does not hold */
    double weight[2][2][3]; /* M^-1 F': what a unit of each row's force does to its two members */
} RowPair;

/* A member that two pairs share: on this side of the later one, on that side of `other`, the earlier or the same. */
typedef struct Meeting {
    int32_t other;
    int8_t side, other_side;
} Meeting;

/* What elimination leaves of each row's coupling with itself. */
typedef enum Condition { SOUND, ROUNDED, REDUNDANT } Condition;

typedef struct Active {
    int32_t count;  /* of pairs, a joint or a contact each */
    int32_t *pair;  /* the system's (its rows 2 p and 2 p + 1), in elimination order */
    int32_t *rank;  /* of each of the system's pairs: its place in that order, negative where none of it holds */
    int32_t *first; /* of each active pair: where its profile begins, the first that it meets */
    int32_t *met;   /* of each active pair: where its meetings begin, and after the last one */
    int32_t *newest, *older; /* lists of a member's pairs: by member, then by pair and side; -1 ends them */
    int32_t capacity, members;
    bool *holds; /* by active pair, both rows */
    RowPair *rows;
    Meeting *meeting;
    int32_t meeting_capacity;
    size_t *begin;        /* of each active pair: where its profile lies in lower and upper */
    Block *lower,
        *upper; /* the factors, both by rows: L without its diagonal, and U transposed as a matrix of blocks */
    size_t profile_capacity;
    Block *inverse;   /* of L's diagonal; U's is ones */
    double *unknown;  /* the right side, then what solves it; 0 for a row that does not hold */
    double *force;    /* the last found [N] */
    double *softness; /* how much softer than the others each row is */
} Active;

void active_destroy(Active *active);

/* Choose the rows that hold from the contacts' modes, and an order in which eliminating them fills little. */
int active_choose(Active *active, const System *system);

/* The i-th of the active rows, two a pair; NULL where it does not hold. */
static inline Row *active_row(const Active *active, const System *system, int32_t i) {
    return active->holds[i] ? &system->row[2 * active->pair[i / 2] + (i & 1)] : NULL;
}

/* Whether no contact slides against friction: then F = J, and the matrix is symmetric. */
bool active_is_symmetric(const System *system);

/* Factor the matrix of the system as it is placed; `relax` makes rows solvable that say what others have said. */
Condition active_factor(Active *active, const System *system, double relax);

/* unknown := the forces that take it away. */
void active_solve(Active *active);

#endif
