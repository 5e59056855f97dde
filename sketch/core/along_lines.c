/* Lines that grain or noise has broken, made smooth along themselves. */
#include <math.h>
#include <stdint.h>

#include "api.h"

static int32_t within(int32_t v, int32_t end) { return v < 0 ? 0 : v >= end ? end - 1 : v; }

/* A picture between its pixels, in 256ths. */
static int32_t sample(const uint8_t *picture, int32_t width, int32_t height, float x, float y) {
    const int32_t fx = (int32_t)floorf(x * 16.0F), fy = (int32_t)floorf(y * 16.0F);
    const int32_t left = within(fx >> 4, width), right = within((fx >> 4) + 1, width);
    const uint8_t *above = picture + (int64_t)within(fy >> 4, height) * width;
    const uint8_t *below = picture + (int64_t)within((fy >> 4) + 1, height) * width;
    const int32_t u = fx & 15, v = fy & 15;
    return (above[left] * (16 - u) + above[right] * u) * (16 - v) + (below[left] * (16 - u) + below[right] * u) * v;
}

/* The mean along its line for each pixel of `near`, into `smooth`, where the others stay.
 *
 * The line's direction is the one in which darkness changes least around (the structure tensor of Bigun and Granlund,
 * 1987), and the mean reaches `reach` pixels to either side of what has one direction only, and less where several
 * lines meet (Weickert, "Coherence-enhancing diffusion filtering", IJCV 31, 1999).  near: of half the size, each way,
 * not 0 where something is drawn.  xx, xy, yy: the tensor there, likewise. */
INK_API void ink_along_lines(const uint8_t *dark, int32_t width, int32_t height, const uint8_t *near, const float *xx,
                             const float *xy, const float *yy, int32_t reach, uint8_t *smooth) {
    for (int32_t y = 0; y < height / 2 * 2; y++) {
        for (int32_t x = 0; x < width / 2 * 2; x++) {
            const int64_t half = (int64_t)(y / 2) * (width / 2) + x / 2;
            if (!near[half]) continue;
            const float across = xx[half] - yy[half], twice = 2 * xy[half], all = xx[half] + yy[half];
            const float apart = sqrtf(across * across + twice * twice);
            if (!(apart > 0) || !(all > 0)) continue;
            /* half of the angle of (across, twice) is that of the gradient, and the line is at right angles to it */
            const float c = sqrtf(fmaxf(0.5F * (1 + across / apart), 0));
            const float s = copysignf(sqrtf(fmaxf(0.5F * (1 - across / apart), 0)), twice);
            const float step = apart / all;
            int32_t sum = 0;
            for (int32_t k = -reach; k <= reach; k++)
                sum += sample(dark, width, height, (float)x - (float)k * step * s, (float)y + (float)k * step * c);
            const int32_t parts = 256 * (2 * reach + 1);
            smooth[(int64_t)y * width + x] = (uint8_t)((sum + parts / 2) / parts);
        }
    }
}
