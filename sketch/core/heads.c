/* Which strokes may be an arrow's head. */
#include "fit.h"

#include <math.h>

enum { HEADS = 4 /* strokes near a shaft's end that are tried as its head: the nearest */ };

/* The nearest and the farthest of a stroke's points from a place [pixels]. */
static void distances(const double *points, int64_t count, const double *place, double *nearest, double *farthest) {
    *nearest = INFINITY;
    *farthest = 0;
    for (int64_t k = 0; k < count; k++) {
        double d = length(points[2 * k] - place[0], points[2 * k + 1] - place[1]);
        if (d < *nearest) *nearest = d;
        if (d > *farthest) *farthest = d;
    }
}

/* boxes: (pieces, 4): least x and y, greatest x and y [pixels]; NaN for none. measure: of each, as of ink_strokes. points:
 * (pieces, 2): where the points of each are, and how many. rivals, from: as of ink_apart.
 * shaft: a piece. tips: (2, 2): its two ends, or what may be [pixels]. reach: as near to a tip as a head comes, span: as far
 * from it as it goes, size: as large as it is [pixels].
 * Out: heads: (2, HEADS) for each tip, the nearest first; found: (2) how many. */
INK_API void ink_heads(int32_t pieces, const double *boxes, const double *measure, const int64_t *points,
                       const int32_t *rivals, const int32_t *from, int32_t shaft, const double *tips, double reach,
                       double span, double size, int32_t *heads, int32_t *found) {
    double gap[2][HEADS];
    found[0] = found[1] = 0;
    for (int q = 0; q < pieces; q++) {
        const double *box = boxes + 4 * q;
        for (int e = 0; e < 2; e++) {
            double x = tips[2 * e], y = tips[2 * e + 1], nearest, farthest;
            if (!(box[0] <= x + reach && box[1] <= y + reach && box[2] >= x - reach && box[3] >= y - reach)) continue;
            if (x - box[0] >= span || y - box[1] >= span || box[2] - x >= span || box[3] - y >= span) continue;
            if (q == shaft || 3 * measure[8 * q + 6] > size || !ink_apart(rivals, from, shaft, q)) continue;
            distances((const double *)(intptr_t)points[2 * q], points[2 * q + 1], tips + 2 * e, &nearest, &farthest);
            int n = found[e];
            if (nearest >= reach || farthest >= span || (n == HEADS && nearest >= gap[e][n - 1])) continue;
            int k = n < HEADS ? found[e]++ : HEADS - 1;
            for (; k > 0 && gap[e][k - 1] > nearest; k--) {
                gap[e][k] = gap[e][k - 1];
                heads[HEADS * e + k] = heads[HEADS * e + k - 1];
            }
            gap[e][k] = nearest;
            heads[HEADS * e + k] = q;
        }
    }
}
