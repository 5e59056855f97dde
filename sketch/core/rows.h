/* Rows of a mask, most of which is bare paper. */
#ifndef ROWS_H
#define ROWS_H

#include <stdint.h>
#include <string.h>

#include "api.h"

/* The first x from `x` on, below `end`, where a row is not 0; `end` where there is none.  Eight pixels are looked at
 * together where all of them may be paper. */
static inline int32_t next_ink(const uint8_t *row, int32_t x, int32_t end) {
    while (x < end) {
        uint64_t eight = 0;
        if (x + 8 <= end) memcpy(&eight, row + x, 8);
        if (x + 8 <= end && !eight)
            x += 8;
        else if (row[x])
            return x;
        else
            x++;
    }
    return end;
}

/* See trace_pieces.c. */
INK_API int32_t ink_pieces(const uint8_t *mask, int32_t width, int32_t height, int32_t *pixels, int32_t *start);

#endif
