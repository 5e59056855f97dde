/* Cutting a simple polygon into convex pieces. */
#ifndef DECOMPOSE_H
#define DECOMPOSE_H

#include <stdbool.h>
#include <stdint.h>

#include "vec.h"

/* Pieces as runs of indices into the polygon's vertices, each counter-clockwise. */
typedef struct Cutting {
    int32_t piece_count, index_count;
    int32_t *start; /* piece_count + 1 */
    int32_t *index;
} Cutting;

/* Cut a simple polygon with count >= 3 vertices, counter-clockwise. The pieces cover it without overlap.
 * Returns SIM_OK or SIM_OUT_OF_MEMORY. */
int polygon_cut(Cutting *cutting, const Vec *vertex, int32_t count);
void cutting_destroy(Cutting *cutting);

#endif
