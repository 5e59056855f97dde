/* Which pieces of ink lie along an outline. */
#include "fit.h"

#include <math.h>

enum {
    FEW = 8,   /* pieces, of which each is looked at as a whole */
    PLACES = 4 /* of the samples of one, otherwise */
};

static const int PLACE[PLACES] = {0, 16, 31, 47};
static const double ASTRAY = 0.3; /* of a piece's size: ink further off than this does not run along something */

/* Whether a few places of a piece are near a closed outline, (n, 2): off by less than `far` in the mean square [pixels²]. */
static int runs_along(const double *samples, const double *outline, int32_t n, double far) {
    double sum = 0;
    for (int k = 0; k < PLACES; k++) {
        const double *p = samples + 2 * PLACE[k];
        double best = INFINITY;
        for (int q = 0; q < n; q++) {
            double d2 = segment_distance2(p[0], p[1], outline + 2 * q, outline + 2 * (q + 1 < n ? q + 1 : 0));
            best = d2 < best ? d2 : best;
        }
        sum += best;
    }
    return sum / PLACES < far;
}

/* boxes: (pieces, 4): least x and y, greatest x and y [pixels]; NaN for none. samples: (pieces, SAMPLES, 2). sizes: of each
 * [pixels].
 * Out: box: the outline's, (n, 2), widened by `reach`; found: the pieces in it that may run along the outline; where they
 * are many, told by a few places of each. Returns how many. */
INK_API int32_t ink_along(int32_t pieces, const double *boxes, const double *samples, const double *sizes,
                          const double *outline, int32_t n, double reach, double box[4], int32_t *found) {
    box[0] = box[1] = INFINITY;
    box[2] = box[3] = -INFINITY;
    for (int q = 0; q < n; q++)
        for (int e = 0; e < 2; e++) {
            box[e] = outline[2 * q + e] < box[e] ? outline[2 * q + e] : box[e];
            box[2 + e] = outline[2 * q + e] > box[2 + e] ? outline[2 * q + e] : box[2 + e];
        }
    for (int e = 0; e < 2; e++) {
        box[e] -= reach;
        box[2 + e] += reach;
    }
    int inside = 0, count = 0;
    for (int i = 0; i < pieces; i++) {
        const double *b = boxes + 4 * i;
        if (b[0] >= box[0] && b[1] >= box[1] && b[2] <= box[2] && b[3] <= box[3]) found[inside++] = i;
    }
    if (inside <= FEW) return inside;
    for (int k = 0; k < inside; k++) {
        int i = found[k];
        double far = ASTRAY * sizes[i];
        if (runs_along(samples + 2 * SAMPLES * i, outline, n, far * far)) found[count++] = i;
    }
    return count;
}
