/* The ink on a page: lines that are too thin for a threshold, and how far ink reaches. */
#include <stdint.h>

#include "rows.h"

#define EXPORT __attribute__((visibility("default")))

static int larger(int a, int b) { return a > b ? a : b; }

/* The least darkness two to `reach` steps from a pixel. */
static int paler(const uint8_t *p, int32_t step, int32_t reach) {
    int least = 255;
    for (int32_t k = 2; k <= reach; k++) least = p[k * step] < least ? p[k * step] : least;
    return least;
}

/* Whether a pixel is on the crest of a line: next to it, across, it is hardly darker, and farther to both sides
 * much paler.  Along the edge of darker ink one side is darker; within it neither is paler. */
static int is_crest(const uint8_t *p, int32_t width, int32_t reach, float crest, float beside) {
    const int32_t across[4] = {1, width, width + 1, width - 1};
    for (int k = 0; k < 4; k++) {
        const int32_t step = across[k], far = k < 2 ? reach : reach - 1;
        if ((float)larger(p[step], p[-step]) >= crest * (float)*p) continue;
        if ((float)larger(paler(p, step, far), paler(p, -step, far)) < beside * (float)*p) return 1;
    }
    return 0;
}

/* Mark in `line`, which is 0, the pixels that are darker than `faintest`, no ink of `mask` and on the crest of a line
 * (see is_crest).  Nothing is looked for within `reach` of the picture's edges. */
EXPORT void ink_crests(const uint8_t *darkness, const uint8_t *mask, int32_t width, int32_t height, int32_t faintest,
                       int32_t reach, float crest, float beside, uint8_t *line) {
    for (int32_t y = reach; y < height - reach; y++) {
        const size_t row = (size_t)y * width;
        for (int32_t x = reach; x < width - reach; x++) {
            const uint8_t *p = darkness + row + x;
            if (*p > faintest && !mask[row + x]) line[row + x] = (uint8_t)is_crest(p, width, reach, crest, beside);
        }
    }
}

/* Distance of each pixel of ink to the paper, into `distance`, which is 0.  The outermost rows and columns count as
 * paper.  By chamfering with the steps of Borgefors, "Distance transformations in digital images", CVGIP 34, 1986,
 * that are best for 3 x 3 pixels. */
EXPORT void ink_distance(const uint8_t *mask, int32_t width, int32_t height, float *distance) {
    const float straight = 0.955F, diagonal = 1.3693F;
    for (int pass = 0; pass < 2; pass++) {
        const int32_t ahead = pass ? width : -width, back = pass ? 1 : -1;
        for (int32_t i = 1; i < height - 1; i++) {
            const int32_t y = pass ? height - 1 - i : i;
            const uint8_t *row = mask + (size_t)y * width;
            float *to = distance + (size_t)y * width;
            for (int32_t x = next_ink(row, 1, width - 1); x < width - 1;) {
                int32_t end = x;
                while (end < width - 1 && row[end]) end++;
                for (int32_t k = x; k < end; k++) {
                    float *p = to + (pass ? x + end - 1 - k : k);
                    float least = pass ? *p : (float)(width + height);
                    const float near[4] = {p[back] + straight, p[ahead] + straight, p[ahead + 1] + diagonal,
                                           p[ahead - 1] + diagonal};
                    for (int n = 0; n < 4; n++) least = near[n] < least ? near[n] : least;
                    *p = least;
                }
                x = next_ink(row, end, width - 1);
            }
        }
    }
}
