/* A line of any course, open or closed, drawn with few sides. */
#include "fit.h"

#include <math.h>
#include <string.h>

enum {
    COURSE = 32,
    DENSE = 4 * COURSE
}; /* sides that it is drawn with at most, and places along it where it may close */
static const double CLOSE =
    0.002; /* of its extent: ink that is no further off is followed; so is a circle with 32 sides */
static const double LOOSE = 0.04; /* likewise: what is off by more was drawn, and no slip where the pen turned */
static const double LOOP =
    0.1; /* of an outline's length: what two strokes have beyond the corner where they cross is less */

/* The outline of a polyline, (count, 2), drawn with a pen so wide, mitred at its corners: (2 * count, 2). */
static void thicken(const double *line, int count, double pen, double *outline) {
    double before[2] = {0, 0};
    for (int i = 0; i < count; i++) {
        double normal[2] = {0, 0}, mitre[2];
        if (i < count - 1) {
            double dx = line[2 * i + 2] - line[2 * i], dy = line[2 * i + 3] - line[2 * i + 1], l = length(dx, dy);
            l = l > 1e-9 ? l : 1e-9;
            normal[0] = -(dy / l);
            normal[1] = dx / l;
        }
        mitre[0] = before[0] + normal[0];
        mitre[1] = before[1] + normal[1];
        if (i > 0 && i < count - 1) {
            double square = mitre[0] * mitre[0] + mitre[1] * mitre[1], by = (square > 0.5 ? square : 0.5) / 2;
            mitre[0] /= by;
            mitre[1] /= by;
        }
        for (int e = 0; e < 2; e++) {
            double side = mitre[e] * pen / 2;
            outline[2 * i + e] = line[2 * i + e] + side;
            outline[2 * (2 * count - 1 - i) + e] = line[2 * i + e] - side;
            before[e] = normal[e];
        }
    }
}

/* The point between two of a polyline's that is farthest from the straight line between them; how far that is. */
static int farthest(const double *xy, int from, int to, double *far) {
    int at = from;
    *far = 0;
    for (int i = from + 1; i < to; i++) {
        double off = segment_distance2(xy[2 * i], xy[2 * i + 1], xy + 2 * from, xy + 2 * to);
        if (off > *far) {
            *far = off;
            at = i;
        }
    }
    *far = sqrt(*far);
    return at;
}

/* The corners of a polyline: its ends, and then always the point that is farthest from the line so far, until none is far or
 * there are `most` sides (after Ramer 1972). xy: (n, 2).  near: how near, as a share of its extent.  Out: line:
 * (most + 1, 2). Returns how many points it has. */
static int with_few_sides(const double *xy, int n, int most, double near, double *line) {
    int at[COURSE + 1] = {0, n - 1}, next[COURSE], sides = 1;
    double off[COURSE], low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int i = 0; i < 2 * n; i++) {
        low[i % 2] = fmin(low[i % 2], xy[i]);
        high[i % 2] = fmax(high[i % 2], xy[i]);
    }
    const double close = near * hypot(high[0] - low[0], high[1] - low[1]);
    next[0] = farthest(xy, 0, n - 1, &off[0]);
    while (sides < most) {
        int worst = 0;
        for (int k = 1; k < sides; k++)
            if (off[k] > off[worst]) worst = k;
        if (off[worst] <= close) break;
        for (int k = sides++; k > worst; k--) {
            at[k + 1] = at[k];
            if (k > worst + 1) {
                next[k] = next[k - 1];
                off[k] = off[k - 1];
            }
        }
        at[worst + 1] = next[worst];
        for (int k = worst; k < worst + 2; k++) next[k] = farthest(xy, at[k], at[k + 1], &off[k]);
    }
    for (int k = 0; k <= sides; k++)
        for (int e = 0; e < 2; e++) line[2 * k + e] = xy[2 * at[k] + e];
    return sides + 1;
}

/* xy: points of a stroke [pixels], (n, 2), n > 1.  pen: what it is at least as thick as [pixels].
 * Out: line: room for (COURSE + 1, 2). Returns how many points it has, or 0 where it crosses itself. */
INK_API int32_t ink_course(const double *xy, int32_t n, double pen, double *line) {
    double outline[4 * (COURSE + 1)];
    for (double near = CLOSE; near < LOOSE; near *= 2) { /* as near as it can be followed without crossing */
        const int count = with_few_sides(xy, n, COURSE, near, line);
        thicken(line, count, pen, outline);
        if (ink_is_simple(outline, 2 * count)) return count;
    }
    return 0;
}

/* Places in equal steps along a polyline, the first and the last at its ends: line is (count, 2).  along: room for n lengths. */
static void in_steps(const double *xy, int32_t n, double *along, double *line, int count) {
    along[0] = 0;
    for (int j = 1; j < n; j++)
        along[j] = along[j - 1] + hypot(xy[2 * j] - xy[2 * j - 2], xy[2 * j + 1] - xy[2 * j - 1]);
    const double step = along[n - 1] / (count - 1);
    for (int k = 0, j = 0; k < count; k++) {
        const double at = k < count - 1 ? k * step : along[n - 1];
        while (j < n - 1 && along[j + 1] <= at) j++;
        for (int e = 0; e < 2; e++)
            line[2 * k + e] =
                j == n - 1
                    ? xy[2 * j + e]
                    : (xy[2 * j + 2 + e] - xy[2 * j + e]) / (along[j + 1] - along[j]) * (at - along[j]) + xy[2 * j + e];
    }
}

/* Cut off what strokes that cross at a corner have beyond it: loops of a closed line, (n, 2), the smallest first. Returns how
 * many corners are left, or 0 where what goes around twice is no such end. */
static int without_loops(double *line, int n) {
    for (;;) {
        double around = 0, least = INFINITY, there[2] = {0, 0}, upto[COURSE];
        int first = 0, last = -1, outer = 0;
        for (int i = 0; i < n; i++) {
            const double *a = line + 2 * i, *b = line + 2 * ((i + 1) % n);
            upto[i] = around;
            around += hypot(b[0] - a[0], b[1] - a[1]);
        }
        for (int i = 0; i < n; i++)
            for (int j = i + 2; j < n; j++) {
                const double *a = line + 2 * i, *b = a + 2, *c = line + 2 * j, *d = line + 2 * ((j + 1) % n);
                const double t = crossing(a, b, c, d);
                if ((i == 0 && j == n - 1) || t < 0) continue;
                const double at[2] = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])};
                const double within =
                    upto[j] + hypot(at[0] - c[0], at[1] - c[1]) - upto[i] - hypot(at[0] - a[0], at[1] - a[1]);
                const double loop = fmin(within, around - within);
                if (loop >= least) continue;
                least = loop;
                first = i;
                last = j;
                outer = within > loop;
                memcpy(there, at, sizeof at);
            }
        if (last < 0) return n;
        if (least > LOOP * around) return 0;
        if (outer) { /* what is kept is between the two */
            memmove(line + 2, line + 2 * (first + 1), 2 * (size_t)(last - first) * sizeof *line);
            memcpy(line, there, sizeof there);
            n = last - first + 1;
        } else {
            memcpy(line + 2 * (first + 1), there, sizeof there);
            memmove(line + 2 * (first + 2), line + 2 * (last + 1), 2 * (size_t)(n - last - 1) * sizeof *line);
            n -= last - first - 1;
        }
        if (n < 3) return 0;
    }
}

/* xy: points of ink that goes once around [pixels], (n, 2), n > 1, in one stroke or several.  scratch: room for 3 n + 6
 * numbers.
 * Out: outline: room for (COURSE, 2), closed, without what runs beyond where its ends are nearest to each other. Returns how
 * many corners it has, or 0 where it crosses itself. */
INK_API int32_t ink_course_around(const double *xy, int32_t n, int32_t several, double *scratch, double *outline) {
    double dense[2 * DENSE], line[2 * (COURSE + 1)], least = INFINITY;
    double *along = scratch, *once = scratch + n;
    int first = 0, last = 0, count = 0;
    in_steps(xy, n, along, dense, DENSE);
    for (int i = 0; i < COURSE / 2; i++)
        for (int j = DENSE - COURSE / 2; j < DENSE; j++) {
            const double apart = hypot(dense[2 * i] - dense[2 * j], dense[2 * i + 1] - dense[2 * j + 1]);
            if (apart < least) {
                least = apart;
                first = i;
                last = j;
            }
        }
    const double step = along[n - 1] / (DENSE - 1), begin = first * step, end = last * step;
    memcpy(once, dense + 2 * first, 2 * sizeof *once);
    for (int i = 0; i < n; i++)
        if (along[i] > begin && along[i] < end) memcpy(once + 2 * ++count, xy + 2 * i, 2 * sizeof *once);
    memcpy(once + 2 * ++count, dense + 2 * last, 2 * sizeof *once);
    memcpy(once + 2 * ++count, once, 2 * sizeof *once); /* and back to where it begins */
    int corners = with_few_sides(once, count + 1, COURSE, CLOSE, line) - 1;
    if (several) corners = without_loops(line, corners); /* one that crosses itself is no outline */
    memcpy(outline, line, 2 * (size_t)corners * sizeof *line);
    return corners > 2 && ink_is_simple(outline, corners) ? corners : 0;
}
