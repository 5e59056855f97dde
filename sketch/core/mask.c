/* The ink on a page: lines that are too thin for a threshold, and how far ink reaches. */
#include <stdint.h>
#include <stdlib.h>

#include "api.h"
#include "rows.h"

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

enum { STRETCH = 32 /* pixels of a row that are looked at together: most of a page is bare */ };

static int darkest(const uint8_t *p, int32_t count) {
    uint8_t most = 0;
    for (int32_t k = 0; k < count; k++) most = p[k] > most ? p[k] : most;
    return most;
}

/* Mark in `line`, which is 0, the pixels that are darker than `faintest`, no ink of `mask` and on the crest of a line
 * (see is_crest).  Nothing is looked for within `reach` of the picture's edges. */
INK_API void ink_crests(const uint8_t *darkness, const uint8_t *mask, int32_t width, int32_t height, int32_t faintest,
                        int32_t reach, float crest, float beside, uint8_t *line) {
    for (int32_t y = reach; y < height - reach; y++) {
        const size_t row = (size_t)y * width;
        for (int32_t from = reach; from < width - reach; from += STRETCH) {
            const int32_t end = from + STRETCH < width - reach ? from + STRETCH : width - reach;
            if (darkest(darkness + row + from, end - from) <= faintest) continue;
            for (int32_t x = from; x < end; x++) {
                const uint8_t *p = darkness + row + x;
                if (*p > faintest && !mask[row + x]) line[row + x] = (uint8_t)is_crest(p, width, reach, crest, beside);
            }
        }
    }
}

typedef struct {
    const uint8_t *mask, *line;
    int32_t offset[8];
    int32_t *label; /* beside lines: of the stretches of ink there, those that were looked at, from 1, else 0 */
    int32_t *queue, count;
} Beside;

/* Whether a pixel is ink beside a line. */
static int is_beside(const Beside *b, int32_t at) {
    int touched = 0;
    for (int k = 0; k < 8; k++) touched |= b->line[at + b->offset[k]];
    return touched && b->mask[at];
}

/* The stretch of ink beside lines that a pixel is in; 0 where it is in none. */
static int32_t stretch_at(Beside *b, int32_t at) {
    if (!is_beside(b, at)) return 0;
    if (b->label[at]) return b->label[at];
    int32_t listed = 0;
    b->queue[listed++] = at;
    b->label[at] = ++b->count;
    for (int32_t next = 0; next < listed; next++) {
        for (int k = 0; k < 8; k++) {
            const int32_t q = b->queue[next] + b->offset[k];
            if (is_beside(b, q) && !b->label[q]) {
                b->label[q] = b->count;
                b->queue[listed++] = q;
            }
        }
    }
    return b->count;
}

/* Take it that no ink beside some pixels of lines was looked at. */
static void forget(Beside *b, const int32_t *pixels, int32_t count) {
    for (int32_t i = 0; i < count; i++)
        for (int k = 0; k < 8; k++) b->label[pixels[i] + b->offset[k]] = 0;
}

/* Whether a piece of a line, `count` pixels, lies between two stretches of ink. */
static int links(Beside *b, const int32_t *pixels, int32_t count) {
    int32_t first = 0;
    for (int32_t i = 0; i < count; i++) {
        for (int k = 0; k < 8; k++) {
            const int32_t stretch = stretch_at(b, pixels[i] + b->offset[k]);
            if (first && stretch && stretch != first) return 1;
            first = stretch ? stretch : first;
        }
    }
    return 0;
}

/* Whether some pixels lie less than `longest` apart [pixels]. */
static int is_short(const int32_t *pixels, int32_t count, int32_t width, double longest) {
    int32_t left = width, right = 0, top = pixels[0] / width, bottom = top;
    for (int32_t i = 0; i < count; i++) {
        const int32_t x = pixels[i] % width, y = pixels[i] / width;
        left = x < left ? x : left;
        right = x > right ? x : right;
        top = y < top ? y : top;
        bottom = y > bottom ? y : bottom;
    }
    const double wide = right - left, high = bottom - top;
    return wide * wide + high * high < longest * longest;
}

/* Add to the ink of `mask` the pieces of `line` that are at least `longest` long or link two stretches of ink: what is
 * shorter and leads nowhere is a bump of an edge.  size: of the line, which leaves out the picture's two outermost
 * rows and columns.  Returns 0, or -1 where memory is short. */
INK_API int32_t ink_link(const uint8_t *line, int32_t width, int32_t height, int32_t size, double longest,
                         uint8_t *mask) {
    Beside b = {mask, line, {-width, -width + 1, 1, width + 1, width, width - 1, -1, -width - 1}, NULL, NULL, 0};
    int32_t status = -1, dropped = 0;
    int32_t *pixels = malloc(((size_t)size + 1) * 3 * sizeof *pixels);
    b.label = malloc((size_t)width * height * sizeof *b.label); /* to clear it all takes longer than all else */
    b.queue = malloc(((size_t)size * 8 + 1) * sizeof *b.queue);
    if (!pixels || !b.label || !b.queue) goto out;
    int32_t *start = pixels + size, *gone = start + size + 1;
    const int32_t found = ink_pieces(line, width, height, pixels, start);
    if (found < 0) goto out;
    forget(&b, pixels, start[found]);
    for (int32_t n = 0; n < found; n++) {
        const int32_t *piece = pixels + start[n], count = start[n + 1] - start[n];
        if (is_short(piece, count, width, longest) && !links(&b, piece, count)) gone[dropped++] = n;
    }
    for (int32_t n = 0, d = 0; n < found; n++) {
        if (d < dropped && gone[d] == n) {
            d++;
            continue;
        }
        for (int32_t i = start[n]; i < start[n + 1]; i++) mask[pixels[i]] = 1;
    }
    status = 0;
out:
    free(pixels);
    free(b.label);
    free(b.queue);
    return status;
}

/* Distance of each pixel of ink to the paper, into `distance`, which is 0.  The outermost rows and columns count as
 * paper.  By chamfering with the steps of Borgefors, "Distance transformations in digital images", CVGIP 34, 1986,
 * that are best for 3 x 3 pixels. */
INK_API void ink_distance(const uint8_t *mask, int32_t width, int32_t height, float *distance) {
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
