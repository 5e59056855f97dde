/* A thin bar: an open line or polyline of one stroke. */
#include "facts.h"

#include <math.h>

enum {
    BENDS = 6,     /* as in core/strokes.c */
    LEGS = 12,     /* likewise */
    MOST_BENDS = 5 /* sides of a bar, at most */
};

/* of its half extent: usual spread of a rod's ink; what is off by much more is bent on purpose */
static const double STRAIGHT = 0.02;
static const double BEND = 3.0;   /* nats for each corner of a bar */
static const double SHARP = 12.0; /* nats that a right angle is rarer in a bar, one that folds it back twice that */

/* How sharply a polyline of k sides turns: each corner by 1 - cos of its angle. */
static double turning(const double *v, int k) {
    double sum = 0;
    for (int q = 1; q < k; q++, v += 2) {
        const double ax = v[2] - v[0], ay = v[3] - v[1], bx = v[4] - v[2], by = v[5] - v[3];
        sum += 1 - (ax * bx + ay * by) / fmax(hypot(ax, ay) * hypot(bx, by), 1e-12);
    }
    return sum;
}

/* The best polyline of a stroke as a bar: of how many sides it is.
 *
 * residual, vertices, facts: of every stroke of the page, as of ink_cross; name: the stroke.
 * Out: cost: nats to say it, besides how rare bars are. */
INK_API int32_t ink_bar(const double *residual, const double *vertices, const Facts *facts, int32_t name,
                        double *cost) {
    const Facts *piece = facts + name;
    const double *its = residual + (LEGS + 1) * name;
    const double usual = STRAIGHT * (piece->scale > 1e-9 ? piece->scale : 1e-9);
    int sides = 1;
    *cost = INFINITY;
    for (int k = 1; k <= MOST_BENDS; k++) {
        const double said = 2 * (k + 1) * PARAMETER, bends = BEND * (k - 1);
        if (said + bends > *cost) break;
        double found = misfit_of(piece, its[k], piece->scale) + 0.5 * its[k] / (usual * usual) + said + bends;
        if (found > *cost) continue;
        found += SHARP * turning(vertices + 2 * (BENDS + 1) * ((BENDS + 1) * name + k), k);
        if (found < *cost) {
            *cost = found;
            sides = k;
        }
    }
    return sides;
}
