/* Where a stroke's end goes over ink that the stroke draws anyway: a side drawn forth and back, or begun twice. */
#include "fit.h"

#include <math.h>

static const double AGAIN = 0.1; /* of a half extent: nobody means two lines that are nearer as two, */
static const double FOLD = 0.1;   /* and nobody a side that turns back by so little of its length; */
static const double TIGHT = 0.4;  /* of that, where it turns back: a long box is as wide there as anywhere */

enum { PLACES = 16 }; /* along such a leg, where it is compared */

/* Squared distance of a place from the ink from point `fold` on, as far as the leg may reach. */
static double off_rest(const double *p, int first, int step, int n, int fold, double reach, const double at[2]) {
    double best = INFINITY, along = 0;
    for (int j = fold; j + 1 < n && along < reach; j++) {
        const double *b = p + 2 * (first + step * j), *c = b + 2 * step;
        best = fmin(best, segment_distance2(at[0], at[1], b, c));
        along += length(c[0] - b[0], c[1] - b[1]);
    }
    return best;
}

/* Whether the points before `fold`, counted from an end, a leg so long, lie on the ink behind it to within `near`. */
static int lies_on(const double *p, int first, int step, int n, int fold, double leg, double near) {
    double sum = 0, at_fold = 0, done = 0;
    int k = 0;
    for (int i = 0; i < fold; i++) {
        const double *a = p + 2 * (first + step * i), *next = a + 2 * step;
        double w = length(next[0] - a[0], next[1] - a[1]), where;
        for (; k < PLACES && w > 0 && (where = (k + 0.5) * leg / PLACES) <= done + w; k++) {
            double t = (where - done) / w, at[2] = {a[0] + t * (next[0] - a[0]), a[1] + t * (next[1] - a[1])};
            double off2 = off_rest(p, first, step, n, fold, 1.5 * leg, at);
            sum += off2 / PLACES;
            if (4 * k >= 3 * PLACES) at_fold += off2 * 4 / PLACES;
        }
        done += w;
    }
    return sum < near * near && at_fold < TIGHT * TIGHT * near * near;
}

/* Points from an end of a stroke, n of them from `first` by `step`, to where it turns back and goes over what they drew;
 * 0 where it does not.  total: length of the stroke.  extent: three times its spread [pixels]. */
int again_end(const double *p, int first, int step, int n, double total, double extent) {
    const double *start = p + 2 * first;
    double far2 = 0, along = 0, leg = 0;
    int fold = 0;
    for (int i = 1; i < n; i++) { /* to the farthest place before it comes back by a quarter */
        const double *q = p + 2 * (first + step * i), *before = q - 2 * step;
        double dx = q[0] - start[0], dy = q[1] - start[1], d2 = dx * dx + dy * dy;
        along += length(q[0] - before[0], q[1] - before[1]);
        if (d2 > far2) {
            far2 = d2;
            fold = i;
            leg = along;
        } else if (d2 < 0.5625 * far2 && far2 > 0.0025 * extent * extent) /* not where the pen only trembles */
            break;
        if (leg > 0.6 * total) return 0;
    }
    if (fold == 0 || fold + 2 > n || total - leg < 0.75 * leg || leg > 1.25 * sqrt(far2)) return 0;
    double near = fmin(AGAIN * 0.5 * extent, FOLD * leg);
    return lies_on(p, first, step, n, fold, leg, near) ? fold : 0;
}
