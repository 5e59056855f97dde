/* The lines of a skeleton: where they are going, and how far they are off what they may be. */
#include "fit.h"

static double apart(const double *a, const double *b) { return length(a[0] - b[0], a[1] - b[1]); }

/* The length of a course of n points. */
INK_API double ink_length(const double *xy, int32_t n) {
    double sum = 0;
    for (int32_t i = 1; i < n; i++) sum += apart(xy + 2 * i, xy + 2 * i - 2);
    return sum;
}

/* Which of n points is nearest to a place, the first of several. */
INK_API int32_t ink_nearest(const double *xy, int32_t n, double x, double y) {
    double least = INFINITY;
    int32_t at = 0;
    for (int32_t i = 0; i < n; i++) {
        const double off = hypot(xy[2 * i] - x, xy[2 * i + 1] - y);
        if (off < least) {
            least = off;
            at = i;
        }
    }
    return at;
}

/* The direction of the line through n points that fits them best, the way that they go. */
static void direction_of(const double *xy, int32_t n, double *u) {
    double x = 0, y = 0, xx = 0, xy2 = 0, yy = 0;
    for (int32_t i = 0; i < n; i++) {
        x += xy[2 * i] / n;
        y += xy[2 * i + 1] / n;
    }
    for (int32_t i = 0; i < n; i++) {
        const double dx = xy[2 * i] - x, dy = xy[2 * i + 1] - y;
        xx += dx * dx;
        xy2 += 2 * dx * dy;
        yy += dy * dy;
    }
    const double angle = 0.5 * atan2(xy2, xx - yy);
    u[0] = cos(angle);
    u[1] = sin(angle);
    if (u[0] * (xy[2 * n - 2] - xy[0]) + u[1] * (xy[2 * n - 1] - xy[1]) < 0) {
        u[0] = -u[0];
        u[1] = -u[1];
    }
}

/* Where a line of n points gets clear of a junction's ink, and its direction there.
 *
 * It is looked at from where it is farther than `reach` from the junction's centre on, or from half of its length on, for
 * the length of `sight`.  out: the place (2) and the direction (2). */
INK_API void ink_heading(const double *xy, int32_t n, const double *centre, double reach, double sight, double *out) {
    const double half = 0.5 * ink_length(xy, n);
    double along = 0;
    int32_t first = 0, end;
    while (first < n - 1 && along < half && apart(xy + 2 * first, centre) < reach) {
        along += apart(xy + 2 * first + 2, xy + 2 * first);
        first++;
    }
    double limit = fmin(along, half) + sight;
    for (end = first; end < n && along <= limit; end++)
        if (end + 1 < n) along += apart(xy + 2 * end + 2, xy + 2 * end);
    if (end - first < 2) {
        first = n > 1 ? n - 2 : 0;
        end = n;
    }
    out[0] = xy[2 * first];
    out[1] = xy[2 * first + 1];
    direction_of(xy + 2 * first, end - first, out + 2);
}

/* The curvature of a line of n points from the one nearest to `start` on, over twice `sight`, leftwards positive; 0 where
 * too little of it is there to tell, or where it is off the parabola by more than `smooth` of the sight. */
INK_API double ink_bend(const double *xy, int32_t n, const double *start, double sight, double smooth) {
    int32_t first = 0, end;
    double near = INFINITY, along = 0;
    for (int32_t i = 0; i < n; i++) {
        const double off = apart(xy + 2 * i, start);
        first = off < near ? i : first;
        near = off < near ? off : near;
    }
    for (end = first + 1; end < n; end++) {
        along += apart(xy + 2 * end, xy + 2 * end - 2);
        if (along >= 2 * sight) break;
    }
    const double *far = xy + 2 * (end - 1), fx = far[0] - start[0], fy = far[1] - start[1], reach = length(fx, fy);
    if (end - first < 5 || reach < sight) return 0;
    double with = 0, square = 0, off2 = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t i = first; i < end; i++) {
            const double dx = xy[2 * i] - start[0], dy = xy[2 * i + 1] - start[1];
            const double x = (dx * fx + dy * fy) / reach, y = (dy * fx - dx * fy) / reach;
            const double shape = x * (x - reach) / 2; /* y = k shape is the parabola through both ends */
            if (pass == 0) {
                with += shape * y;
                square += shape * shape;
            } else
                off2 += (y - with / square * shape) * (y - with / square * shape);
        }
    }
    return sqrt(off2 / (end - first)) < smooth * sight ? with / square : 0;
}
