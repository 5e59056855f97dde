/* The ink of a mask along printed lines that are nearly level. */
#include <stddef.h>
#include <stdint.h>

#include "api.h"

/* Of each of `count` columns x the ink within `reach` rows of middle[k]: how many pixels, and the sum of how far they
 * are below that.  All of these rows are on the mask. */
INK_API void ink_columns(const uint8_t *mask, int32_t width, const int32_t *x, const int32_t *middle, int32_t count,
                         int32_t reach, int32_t *pixels, int32_t *below) {
    for (int32_t k = 0; k < count; k++) {
        const uint8_t *p = mask + (size_t)middle[k] * width + x[k];
        int32_t found = 0, sum = 0;
        for (int32_t off = -reach; off <= reach; off++) {
            const int32_t ink = p[(ptrdiff_t)off * width] != 0;
            found += ink;
            sum += ink * off;
        }
        pixels[k] = found;
        below[k] = sum;
    }
}

/* The row's column, from `x`, of a straight way that moves `aside` columns over `rows` rows. */
static int32_t column(int32_t x, int32_t aside, int32_t row, int32_t rows) {
    const int32_t twice = 2 * aside * row, last = rows - 1;
    return x + (twice + (twice < 0 ? -last : last)) / (2 * last);
}

/* Mark in `through`, which is 0, the ink of a belt, `rows` by `width` and at least two rows, on straight ways all of ink
 * from its first row to its last, that move no more than `flat` columns a row. */
INK_API void ink_through(const uint8_t *belt, int32_t rows, int32_t width, int32_t flat, uint8_t *through) {
    const int32_t last = rows - 1, most = flat * last;
    for (int32_t x = 0; x < width; x++) {
        if (!belt[x]) continue;
        const int32_t least = x < most ? -x : -most, end = width - 1 - x < most ? width - 1 - x : most;
        for (int32_t aside = least; aside <= end; aside++) {
            int32_t row = last;
            while (row > 0 && belt[row * width + column(x, aside, row, rows)]) row--;
            if (row) continue;
            for (row = 0; row < rows; row++) through[row * width + column(x, aside, row, rows)] = 1;
        }
    }
}
