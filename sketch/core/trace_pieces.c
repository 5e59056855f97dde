/* The pieces of a mask: its ink pixels sorted by connected piece. */
#include <stdint.h>
#include <stdlib.h>

#include "api.h"
#include "rows.h"

/* List the pixels of each 8-connected piece of ink, piece after piece.
 *
 * mask: 0 is paper; the outermost rows and columns count as paper.  pixels: room for every ink pixel; gets their
 * indices.  start: room for one more than there are ink pixels; gets where each piece starts in pixels, and the end.
 * Returns the number of pieces, or -1 where memory is short. */
INK_API int32_t ink_pieces(const uint8_t *mask, int32_t width, int32_t height, int32_t *pixels, int32_t *start) {
    const int32_t offset[8] = {-width, -width + 1, 1, width + 1, width, width - 1, -1, -width - 1};
    int32_t pieces = 0, listed = 0;
    start[0] = 0;
    if (width < 3 || height < 3) return 0;
    uint8_t *left = malloc((size_t)width * height);
    if (!left) return -1;
    memcpy(left, mask, (size_t)width * height);
    memset(left, 0, (size_t)width);
    memset(left + (size_t)(height - 1) * width, 0, (size_t)width);
    for (int32_t y = 1; y < height - 1; y++) left[(size_t)y * width] = left[(size_t)(y + 1) * width - 1] = 0;
    for (int32_t y = 1; y < height - 1; y++) {
        const uint8_t *row = left + (size_t)y * width;
        for (int32_t x = next_ink(row, 1, width - 1); x < width - 1; x = next_ink(row, x + 1, width - 1)) {
            const int32_t at = y * width + x;
            left[at] = 0;
            pixels[listed++] = at;
            /* what has been listed of this piece is its own queue */
            for (int32_t next = start[pieces]; next < listed; next++) {
                for (int k = 0; k < 8; k++) {
                    const int32_t q = pixels[next] + offset[k];
                    if (left[q]) {
                        left[q] = 0;
                        pixels[listed++] = q;
                    }
                }
            }
            start[++pieces] = listed;
        }
    }
    free(left);
    return pieces;
}

/* Measure pieces as ink_pieces lists them: start has one more than there are `pieces`.
 *
 * darkness: of the page, or null.  edge: not 0 off the sheet and near its edge, or null.
 * Out, of each piece: extent (2): how many rows and columns it goes from its first to its last [pixels]; strength: its mean
 * darkness; at_edge: whether it has a pixel at the sheet's edge; both 0 where that is not given. */
INK_API void ink_measure_pieces(const int32_t *pixels, const int32_t *start, int32_t pieces, int32_t width,
                                const uint8_t *darkness, const uint8_t *edge, int32_t *extent, double *strength,
                                uint8_t *at_edge) {
    for (int32_t n = 0; n < pieces; n++) {
        int32_t left = width, right = 0, bottom = 0, top = pixels[start[n]] / width;
        int64_t dark = 0;
        uint8_t met = 0;
        for (int32_t i = start[n]; i < start[n + 1]; i++) {
            const int32_t y = pixels[i] / width, x = pixels[i] - y * width;
            left = x < left ? x : left;
            right = x > right ? x : right;
            bottom = y > bottom ? y : bottom;
            dark += darkness ? darkness[pixels[i]] : 0;
            met |= edge && edge[pixels[i]];
        }
        extent[2 * n] = bottom - top; /* pieces begin in their topmost row */
        extent[2 * n + 1] = right - left;
        strength[n] = (double)dark / (start[n + 1] - start[n]);
        at_edge[n] = met;
    }
}
