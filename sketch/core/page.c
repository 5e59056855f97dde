/* From a picture of paper to the pixels that are ink by themselves. */
#include <stdint.h>
#include <stdlib.h>

#include "api.h"

static inline uint8_t least(uint8_t a, uint8_t b) { return a < b ? a : b; }
static inline uint8_t most(uint8_t a, uint8_t b) { return a > b ? a : b; }

/* To the nearest whole number, of two the even one: with so large a number added, no digits are left for more. */
static inline float rounded(float x) { return x + 12582912.0F - 12582912.0F; }

/* How much darker than the light on it each pixel of a BGR picture is, as a share of that light, 0 to 255.
 *
 * A pen of any colour is dark in one channel at least, and that one counts.  negative: of a picture's negative.
 * light: at each pixel; below `dimmest` it counts as that.  Returns 0, or -1 where memory is short. */
INK_API int32_t ink_darkness(const uint8_t *bgr, const uint8_t *light, int32_t width, int32_t height, int32_t negative,
                             int32_t dimmest, uint8_t *darkness) {
    uint8_t *grey = malloc((size_t)width + 1);
    if (!grey) return -1;
    for (int32_t y = 0; y < height; y++) {
        const uint8_t *p = bgr + (size_t)y * 3 * width, *lit = light + (size_t)y * width;
        uint8_t *out = darkness + (size_t)y * width;
        for (int32_t x = 0; x < width; x++)
            grey[x] = negative ? (uint8_t)~most(most(p[3 * x], p[3 * x + 1]), p[3 * x + 2])
                               : least(least(p[3 * x], p[3 * x + 1]), p[3 * x + 2]);
        for (int32_t x = 0; x < width; x++) {
            const int less = lit[x] > grey[x] ? lit[x] - grey[x] : 0, from = lit[x] > dimmest ? lit[x] : dimmest;
            out[x] = (uint8_t)(int)rounded((float)less * 255.0F / (float)from);
        }
    }
    free(grey);
    return 0;
}

/* Mark in `mask` the pixels that are darker than `floor`, and crisper than half of the darkest around them.
 *
 * A pixel is as crisp as it is dark, and half of what it is darker than the mean around it again; rounded, to the even one
 * of two.  around: the mean, which gets how crisp each pixel is.  Of `count` pixels each. */
INK_API void ink_crisp(const uint8_t *restrict darkness, const uint8_t *restrict darkest, int64_t count, uint8_t floor,
                       uint8_t *restrict around, uint8_t *restrict mask) {
    const int16_t least_dark = floor;
    for (int64_t i = 0; i < count; i++) { /* all in 16 bits: so a compiler takes eight at a time */
        const int16_t dark = darkness[i], twice = (int16_t)(3 * dark - around[i]);
        int16_t crisp = (int16_t)((int16_t)(twice + (twice >> 1 & 1)) >> 1);
        crisp = crisp > 0 ? crisp : 0;
        crisp = crisp < 255 ? crisp : 255;
        const int16_t ink = (int16_t)((crisp > darkest[i] >> 1) & (dark > least_dark));
        around[i] = (uint8_t)crisp;
        mask[i] = (uint8_t)ink;
    }
}
