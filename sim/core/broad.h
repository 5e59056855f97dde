/* The broad phase: which boxes overlap. */
#ifndef BROAD_H
#define BROAD_H

#include <stdbool.h>
#include <stdint.h>

#include "vec.h"

/* C's fmin and fmax are calls, for the sake of NaN. */
static inline double smaller(double a, double b) { return a < b ? a : b; }
static inline double larger(double a, double b) { return a > b ? a : b; }

typedef struct Box {
    Vec low, high;
} Box;

static inline bool boxes_meet(const Box *a, const Box *b) {
    return a->low.x <= b->high.x && b->low.x <= a->high.x && a->low.y <= b->high.y && b->low.y <= a->high.y;
}

static inline Box box_join(Box a, Box b) {
    return (Box){vec(smaller(a.low.x, b.low.x), smaller(a.low.y, b.low.y)),
                 vec(larger(a.high.x, b.high.x), larger(a.high.y, b.high.y))};
}

static inline Box box_grow(Box a, double by) {
    return (Box){vec(a.low.x - by, a.low.y - by), vec(a.high.x + by, a.high.y + by)};
}

typedef struct Pair {
    int32_t a, b; /* a < b */
} Pair;

typedef struct Sweep {
    int32_t count;
    int32_t *order;      /* boxes by their lower end, kept from call to call: nearly sorted the next time */
    int32_t *met;        /* places in that order that one box meets */
    double *low, *high;  /* along the axis, in that order */
    double *across_low, *across_high; /* along the other one */
    bool *moving;
    Pair *pair;
    int32_t pair_count, pair_capacity;
} Sweep;

int sweep_create(Sweep *sweep, int32_t count);
void sweep_destroy(Sweep *sweep);

/* Find all pairs of overlapping boxes of which one at least is marked as moving. Fills sweep->pair.
 * Returns SIM_OK or SIM_OUT_OF_MEMORY. */
int sweep_pairs(Sweep *sweep, const Box *box, const bool *moving);

#endif
