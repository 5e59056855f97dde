/* Thinning: a mask of ink to lines one pixel wide.
 *
 * The conditions are those of Guo and Hall, "Parallel thinning with two-subiteration algorithms", CACM 32(3),
 * 1989, algorithm A1: they keep connectedness, holes and ends.  Only pixels at the border of what is left are
 * looked at, so that the time goes with the ink and not with the page.
 */
#include <stdint.h>
#include <stdlib.h>

#include "api.h"
#include "rows.h"

enum { INK = 1, LISTED = 2, GOING = 4 };

/* The eight neighbours clockwise from the north, as bits 0 to 7 of a neighbourhood. */
static void neighbour_offsets(int width, int offset[8]) {
    const int all[8] = {-width, -width + 1, 1, width + 1, width, width - 1, -1, -width - 1};
    for (int k = 0; k < 8; k++) offset[k] = all[k];
}

static unsigned neighbourhood(const uint8_t *p, const int offset[8]) {
    unsigned bits = 0;
    for (int k = 0; k < 8; k++) bits |= (unsigned)(p[offset[k]] & INK) << k;
    return bits;
}

/* Whether a pixel with these neighbours goes in the first (0) or second (1) subiteration. */
static int goes(unsigned bits, int second) {
    const unsigned p2 = bits & 1, p3 = bits >> 1 & 1, p4 = bits >> 2 & 1, p5 = bits >> 3 & 1;
    const unsigned p6 = bits >> 4 & 1, p7 = bits >> 5 & 1, p8 = bits >> 6 & 1, p9 = bits >> 7 & 1;
    const unsigned components = ((!p2) & (p3 | p4)) + ((!p4) & (p5 | p6)) + ((!p6) & (p7 | p8)) + ((!p8) & (p9 | p2));
    const unsigned n1 = (p9 | p2) + (p3 | p4) + (p5 | p6) + (p7 | p8);
    const unsigned n2 = (p2 | p3) + (p4 | p5) + (p6 | p7) + (p8 | p9);
    const unsigned n = n1 < n2 ? n1 : n2;
    const unsigned side = second ? (p2 | p3 | !p5) & p4 : (p6 | p7 | !p9) & p8;
    return components == 1 && n >= 2 && n <= 3 && !side;
}

/* Whether the pixel only fills the step of a staircase: two neighbours at a right angle that touch without it. */
static int is_step(unsigned bits) {
    const unsigned n = bits & 1, e = bits >> 2 & 1, s = bits >> 4 & 1, w = bits >> 6 & 1;
    const unsigned ne = bits >> 1 & 1, se = bits >> 3 & 1, sw = bits >> 5 & 1, nw = bits >> 7 & 1;
    return (n & e & !s & !w & !sw) | (e & s & !n & !w & !nw) | (s & w & !n & !e & !ne) | (w & n & !e & !s & !se);
}

/* Make ink of what is not 0, and paper of the outermost rows and columns; returns how much ink there is. */
static int32_t count_ink(uint8_t *mask, int width, int height) {
    int32_t count = 0;
    memset(mask, 0, (size_t)width);
    memset(mask + (size_t)(height - 1) * width, 0, (size_t)width);
    for (int y = 1; y < height - 1; y++) {
        uint8_t *row = mask + (size_t)y * width;
        row[0] = row[width - 1] = 0;
        for (int x = next_ink(row, 0, width); x < width; x = next_ink(row, x + 1, width)) {
            row[x] = INK;
            count++;
        }
    }
    return count;
}

static size_t list_border(uint8_t *mask, int width, int height, const int offset[8], int32_t *list) {
    size_t count = 0;
    for (int y = 1; y < height - 1; y++) {
        uint8_t *row = mask + (size_t)y * width;
        for (int x = next_ink(row, 1, width); x < width; x = next_ink(row, x + 1, width)) {
            if (neighbourhood(row + x, offset) != 255) {
                row[x] |= LISTED;
                list[count++] = (int32_t)(row + x - mask);
            }
        }
    }
    return count;
}

/* Take off all marks; returns how much ink is left. */
static int32_t count_left(uint8_t *mask, int width, int height) {
    int32_t left = 0;
    for (int y = 1; y < height - 1; y++) {
        uint8_t *row = mask + (size_t)y * width;
        for (int x = next_ink(row, 0, width); x < width; x = next_ink(row, x + 1, width)) left += row[x] &= INK;
    }
    return left;
}

/* One subiteration over the listed pixels: those that go are cleared and the ink they lay bare is listed in
 * their place.  A pixel is listed at most once, so `next` never holds more than there is ink. */
static size_t peel(uint8_t *mask, const int offset[8], const uint8_t table[256], const int32_t *list, size_t count,
                   int32_t *next) {
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        if (table[neighbourhood(mask + list[i], offset)]) mask[list[i]] |= GOING;
    for (size_t i = 0; i < count; i++) {
        uint8_t *p = mask + list[i];
        if (!(*p & GOING)) {
            next[kept++] = list[i];
            continue;
        }
        *p = 0;
        for (int k = 0; k < 8; k++) {
            uint8_t *q = p + offset[k];
            if ((*q & (INK | LISTED)) == INK) {
                *q |= LISTED;
                next[kept++] = (int32_t)(q - mask);
            }
        }
    }
    return kept;
}

/* Thin a mask (0 is paper) in place; what is left is 1.  The outermost rows and columns count as paper.
 * Returns the number of pixels left, or -1 where memory is short. */
INK_API int32_t ink_thin(uint8_t *mask, int32_t width, int32_t height) {
    if (width < 3 || height < 3) {
        for (int64_t i = 0; i < (int64_t)width * height; i++) mask[i] = 0;
        return 0;
    }
    const int32_t ink = count_ink(mask, width, height);
    int32_t *list = malloc(((size_t)ink + 1) * 2 * sizeof *list), left = -1;
    if (!list) return left;
    int32_t *next = list + ink + 1;
    int offset[8];
    uint8_t table[2][256];
    neighbour_offsets(width, offset);
    for (unsigned bits = 0; bits < 256; bits++)
        for (int second = 0; second < 2; second++) table[second][bits] = (uint8_t)goes(bits, second);

    size_t count = list_border(mask, width, height, offset, list);
    for (int idle = 0, second = 0; idle < 2; second = !second) {
        const size_t before = count;
        int32_t gone = 0;
        count = peel(mask, offset, table[second], list, before, next);
        for (size_t i = 0; i < before; i++) gone += !mask[list[i]];
        idle = gone ? 0 : idle + 1;
        int32_t *swap = list;
        list = next;
        next = swap;
    }
    for (size_t i = 0; i < count; i++)
        if (is_step(neighbourhood(mask + list[i], offset))) mask[list[i]] = 0;
    left = count_left(mask, width, height); /* not all was ever listed: the middle of a block stays unseen */
    free(list < next ? list : next);
    return left;
}

/* How many pixels of a skeleton, as ink_thin leaves it, have one neighbour: the ends of its lines. */
INK_API int32_t ink_ends(const uint8_t *skeleton, int32_t width, int32_t height) {
    int offset[8];
    int32_t ends = 0;
    neighbour_offsets(width, offset);
    for (int y = 1; y < height - 1; y++) {
        const uint8_t *row = skeleton + (size_t)y * width;
        for (int x = next_ink(row, 1, width - 1); x < width - 1; x = next_ink(row, x + 1, width - 1)) {
            const unsigned bits = neighbourhood(row + x, offset);
            ends += bits && !(bits & (bits - 1));
        }
    }
    return ends;
}
