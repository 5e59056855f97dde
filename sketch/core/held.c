/* Which open lines rings hold: by their ends, or where another ends on them or crosses them. */
#include "fit.h"

#include <math.h>

enum { FIRST = 1, LAST = 2 };

static const double ACROSS =
    0.3; /* sine of the angle, at least, at which a line ends on another, or crosses it: 17 degrees */

/* A line: its points, how many, and how long it is from end to end. */
typedef struct {
    const double *points;
    int n;
    double u, v, length;
} Course;

static Course course_of(const double *points, const int32_t *from, int n) {
    Course l = {points + 2 * from[n], from[n + 1] - from[n], 0, 0, 0};
    l.u = l.points[2 * l.n - 2] - l.points[0];
    l.v = l.points[2 * l.n - 1] - l.points[1];
    l.length = hypot(l.u, l.v);
    return l;
}

/* Which ends of a line are in a ring; -1 where the ring is too large for it. */
static int ends_in(const Course *l, const double *r, double reach, double shorter) {
    if (shorter * r[2] >= l->length) return -1;
    const double x = r[0] - l->points[0], y = r[1] - l->points[1];
    const double far_x = x - l->u, far_y = y - l->v;
    return FIRST * (x * x + y * y < reach * reach) + LAST * (far_x * far_x + far_y * far_y < reach * reach);
}

/* Whether a line goes through a ring. */
static int passes(const Course *l, const double *r, double reach) {
    for (int k = 0; k + 1 < l->n; k++)
        if (segment_distance2(r[0], r[1], l->points + 2 * k, l->points + 2 * k + 2) < reach * reach) return 1;
    return 0;
}

/* Whether one line leads off another. */
static int across(const Course *a, const Course *b) {
    return fabs(a->u * b->v - a->v * b->u) > ACROSS * a->length * b->length;
}

/* points: of all lines [pixels]; from: (count + 1): the first of each. rings: (many, 3): middle and extent [pixels].
 * in_ring: of a ring's extent: an end so near to its middle is in the ring; through: likewise of a line that goes into it, or
 * through; shorter: times, at least, that the line is as long as the ring's extent.
 * Out: held: (count): how many ends of each some ring holds, and in how many it goes on where another ends or crosses it; wide:
 * (count): the extent of the largest of these, else 0. */
INK_API void ink_held(const double *points, const int32_t *from, int32_t count, const double *rings, int32_t many,
                      double in_ring, double through, double shorter, int32_t *held, double *wide) {
    for (int n = 0; n < count; n++) {
        const Course l = course_of(points, from, n);
        int found = 0, on = 0;
        wide[n] = 0;
        for (int k = 0; k < many; k++) {
            const double *r = rings + 3 * k, reach = in_ring * r[2];
            int its = ends_in(&l, r, reach, shorter), there = 0;
            if (its < 0) continue;
            if (its && fabs(l.u * (r[1] - l.points[1]) - l.v * (r[0] - l.points[0])) >= through * r[2] * l.length)
                its = 0;
            const int on_ring = !its && passes(&l, r, through * r[2]);
            for (int m = 0; m < count && on_ring && !there; m++) {
                const Course other = course_of(points, from, m);
                const int ends = ends_in(&other, r, reach, shorter);
                there = ends >= 0 && (ends > 0 || passes(&other, r, through * r[2])) && across(&l, &other);
            }
            found |= its;
            on += there;
            if ((its || there) && wide[n] < r[2]) wide[n] = r[2];
        }
        held[n] = !!(found & FIRST) + !!(found & LAST) + on;
    }
}
