/* Strokes point by point: where they turn, and without the steps of the pixels that they were found on. */
#include <math.h>
#include <stdint.h>

#include "api.h"

/* By how much a chain of n points, (n, 2) [pixels], turns within `cut` points to either side of each, as if it went around
 * [rad].  turn: (n), of which an open chain's first and last `cut` mean nothing.  0 < cut <= n. */
INK_API void ink_turns(const double *xy, int32_t n, int32_t cut, double *turn) {
    for (int32_t i = 0; i < n; i++) {
        const double *at = xy + 2 * i, *from = xy + 2 * (i < cut ? i - cut + n : i - cut);
        const double *to = xy + 2 * (i + cut < n ? i + cut : i + cut - n);
        const double bx = at[0] - from[0], by = at[1] - from[1], ax = to[0] - at[0], ay = to[1] - at[1];
        turn[i] = fabs(atan2(bx * ay - by * ax, bx * ax + by * ay));
    }
}

/* Point i of n of a chain, one coordinate: around it if it is closed, else turned over about its ends. */
static double beyond(const double *v, int32_t n, int32_t i, int32_t closed) {
    if (closed) return v[2 * ((i + n) % n)];
    if (i < 0) return 2 * v[0] - v[-2 * i];
    if (i >= n) return 2 * v[2 * n - 2] - v[2 * (2 * n - 2 - i)];
    return v[2 * i];
}

/* A chain of n points, (n, 2), smoothed along itself: the mean of the points up to `reach` to either side of each, with
 * these weights, (2 * reach + 1).  closed: whether the last point leads to the first; else both stay.  reach <= n, < n where open.
 * smooth: (n, 2). */
INK_API void ink_smooth(const double *xy, int32_t n, const double *weight, int32_t reach, int32_t closed,
                        double *smooth) {
    for (int32_t i = 0; i < n; i++) {
        const int inner = i >= reach && i + reach < n;
        for (int k = 0; k < 2; k++) {
            double sum = 0;
            for (int32_t j = -reach; j <= reach; j++)
                sum += weight[j + reach] * (inner ? xy[2 * (i + j) + k] : beyond(xy + k, n, i + j, closed));
            smooth[2 * i + k] = sum;
        }
    }
}
