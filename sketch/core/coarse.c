/* What it costs that a shape says ink less precisely than something smaller would. */
#include "fit.h"

static const double TREMOR = 0.05, SLOPPY = 0.1; /* as in sketch/scoring.py */

/* Nats to say an observation that is off by so much [shares of a size]: as of `sketch.scoring.misfit`. */
static double misfit(double off) {
    return 0.5 * (log1p(off * off / (TREMOR * TREMOR)) + off * off / (SLOPPY * SLOPPY));
}

/* The root mean square distance of n points from the sides of a shape. */
static double off_shape(const double *xy, int32_t n, const double *corners, int32_t count, int32_t closed) {
    double sum = 0;
    for (int32_t k = 0; k < n; k++) {
        double best = INFINITY;
        for (int32_t q = 0; q + 1 < count + (closed != 0); q++) {
            const double *next = corners + 2 * (q + 1 < count ? q + 1 : 0);
            best = fmin(best, segment_distance2(xy[2 * k], xy[2 * k + 1], corners + 2 * q, next));
        }
        sum += best;
    }
    return sqrt(sum / n);
}

/* xy: points of all stretches of ink [pixels]; ends: of each of `count` stretches, the points up to its end.  worth: of each,
 * the size of the smallest thing that it may be part of [pixels], the observations that it is worth, and the nats to say it
 * freely.  corners: of the shape, (n, 2) [pixels]; closed: whether the last leads to the first.  slack: how far ink may be
 * off it, and size: of the shape [pixels].
 * Returns nats that the shape owes: for no stretch more than it takes to say that freely. */
INK_API double ink_coarseness(const double *xy, const int32_t *ends, const double *worth, int32_t count,
                              const double *corners, int32_t n, int32_t closed, double slack, double size) {
    double owed = 0;
    for (int32_t s = 0, i = 0; s < count; i = ends[s++]) {
        const double scale = worth[3 * s], observations = worth[3 * s + 1], freely = worth[3 * s + 2];
        const double off = fmax(off_shape(xy + 2 * i, ends[s] - i, corners, n, closed) - slack, 0);
        const double finer = misfit(off / fmin(scale, size)) - misfit(off / size);
        owed += fmin(observations * finer, freely);
    }
    return owed;
}
