/* The side that one piece of ink lends to others: the way along it from where they end to where they begin. */
#include "fit.h"

enum {
    FINE = 8,         /* steps, at least, in which the way is looked for, from end to end, */
    MOST_STEPS = 1000 /* but not more than so many of all of that ink; as in sketch/kernel.py */
};

static const double ENDS_ON = 0.08; /* of its length: a piece whose ends are as near goes around */
static const double WHOLE = 0.8;    /* of a piece, between the ends of several others: it is their own side */
static const double DETOUR = 1.5;   /* of the distance of the ends: the longest way over other ink */

/* A piece's ink in `count` equal steps. */
static void in_steps(const double *xy, int32_t n, double length_of_all, int32_t count, double *out) {
    double done = 0, next = 0;
    int32_t j = 0;
    for (int32_t k = 0; k < count; k++) {
        double at = count > 1 ? length_of_all * k / (count - 1) : 0;
        while (j + 1 < n && (next < at || !j)) {
            j++;
            done = next;
            next += length(xy[2 * j] - xy[2 * j - 2], xy[2 * j + 1] - xy[2 * j - 1]);
        }
        double t = next > done ? fmin((at - done) / (next - done), 1) : 0;
        for (int e = 0; e < 2; e++) out[2 * k + e] = xy[2 * j - 2 + e] + t * (xy[2 * j + e] - xy[2 * j - 2 + e]);
    }
}

/* Which of n points is the nearest to a place; `best`: how near that is. */
static int32_t nearest(const double *xy, int32_t n, const double at[2], double *best) {
    int32_t found = 0;
    *best = INFINITY;
    for (int32_t k = 0; k < n; k++) {
        double dx = xy[2 * k] - at[0], dy = xy[2 * k + 1] - at[1], d2 = dx * dx + dy * dy;
        if (d2 < *best) {
            *best = d2;
            found = k;
        }
    }
    *best = sqrt(*best);
    return found;
}

/* samples: of a piece, (SAMPLES, 2); xy: its n points, n > 1.  shape: its length and the distance of its ends.  ends: (2, 2),
 * where the others begin and where they end.  reach: as near to these its ink must come.  several: whether the others are
 * several pieces.  All in pixels.
 * Out: shape[0]: the step from point to point.  side: along it from their last end to their first, (MOST_STEPS + 1, 2).
 * Returns how many points; 0 for none. */
INK_API int32_t ink_lend(const double *samples, const double *xy, int32_t n, double shape[2], const double *ends,
                         double reach, int32_t several, double *side) {
    const double all = shape[0],
                 gap = sqrt((ends[0] - ends[2]) * (ends[0] - ends[2]) + (ends[1] - ends[3]) * (ends[1] - ends[3]));
    double steps[2 * MOST_STEPS], from_first, from_last;
    const double *ink = samples;
    int32_t count = SAMPLES;
    int32_t first = nearest(ink, count, ends, &from_first), last = nearest(ink, count, ends + 2, &from_last);
    if (count * gap < FINE * all) {
        if (fmax(from_first, from_last) >= reach + all / count) return 0;
        const double fine = ceil(all * FINE / gap);
        count = fine < MOST_STEPS ? (int32_t)fine : MOST_STEPS;
        in_steps(xy, n, all, count, steps);
        ink = steps;
        first = nearest(ink, count, ends, &from_first);
        last = nearest(ink, count, ends + 2, &from_last);
    }
    if (fmax(from_first, from_last) > reach + all / count / 2) return 0;
    int32_t way = first > last ? first - last : last - first, step = first > last ? 1 : -1;
    if (shape[1] < ENDS_ON * all && 2 * way > count) {
        way = count - way;
        step = -step;
    }
    shape[0] = all / count;
    if (way == 0 || way * all / count >= DETOUR * gap || (several && way > WHOLE * count)) return 0;
    for (int32_t k = 0; k <= way; k++) {
        const double *p = ink + 2 * (((last + step * k) % count + count) % count);
        side[2 * k] = p[0];
        side[2 * k + 1] = p[1];
    }
    return way + 1;
}
