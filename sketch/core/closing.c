/* Where a stroke that goes once around closes: what was drawn before and after that runs on, and is no part of the outline. */
#include "fit.h"

#include <math.h>
#include <string.h>

static const double TAIL = 0.12; /* of a stroke's length, at most, runs on beyond its closing */
static const double BY = 0.35; /* of such a tail: as near as the end that it passes by is */

enum { STEPS = 40 }; /* of an end's course, with more points every second, third, .. of them */

/* An end's course: indices of its points, in order from the end, and how far along each is [pixels]. */
typedef struct {
    int count, at[STEPS + 1];
    double along[STEPS + 1];
} Course;

static void follow(const double *xy, int first, int step, int n, double reach, Course *c) {
    double along = 0;
    int points = 0, stride;
    for (int i = 1; i < n && along < reach; i++, points++) {
        const double *p = xy + 2 * (first + step * i), *q = p - 2 * step;
        along += length(p[0] - q[0], p[1] - q[1]);
    }
    stride = 1 + (points - 1) / STEPS;
    c->count = 0;
    along = 0;
    for (int i = 0; i <= points; i++) {
        const double *p = xy + 2 * (first + step * i), *q = p - 2 * step;
        if (i) along += length(p[0] - q[0], p[1] - q[1]);
        if (i % stride) continue;
        c->at[c->count] = first + step * i;
        c->along[c->count++] = along;
    }
}

/* Where a course first passes by a point, an end of the other: the index of the course's segment, and how far along. */
static int passes(const double *xy, const double *end, const Course *c, double *along, double at[2]) {
    double best = INFINITY;
    int found = -1;
    for (int j = 0; j + 1 < c->count; j++) {
        const double *a = xy + 2 * c->at[j], *b = xy + 2 * c->at[j + 1];
        double dx = b[0] - a[0], dy = b[1] - a[1], l2 = dx * dx + dy * dy;
        double t = l2 > 0 ? fmin(fmax(((end[0] - a[0]) * dx + (end[1] - a[1]) * dy) / l2, 0), 1) : 0;
        double x = a[0] + t * dx, y = a[1] + t * dy, off = hypot(end[0] - x, end[1] - y);
        double s = c->along[j] + t * (c->along[j + 1] - c->along[j]);
        if (off >= best) continue;
        best = off;
        if (off >= BY * s) {
            found = -1;
            continue;
        }
        found = j;
        *along = s;
        at[0] = x;
        at[1] = y;
    }
    return found;
}

/* Where a stroke closes: there its points first .. last are left, and so much of its length before and after them. */
typedef struct {
    double at[2], before, after;
    int first, last;
} Closing;

/* Where two ends' courses cross; of several such places the one where the least is beyond. */
static Closing crossed(const double *xy, const Course *head, const Course *tail, double most) {
    Closing found = {{0, 0}, 0, 0, 0, -1};
    for (int i = 0; i + 1 < head->count; i++)
        for (int j = 0; j + 1 < tail->count && head->along[i] + tail->along[j] < most; j++) {
            const double *a = xy + 2 * head->at[i], *b = xy + 2 * head->at[i + 1];
            const double *c = xy + 2 * tail->at[j], *d = xy + 2 * tail->at[j + 1];
            if (head->at[i + 1] >= tail->at[j + 1]) break;
            double t = crossing(a, b, c, d);
            if (t < 0) continue;
            double x = a[0] + t * (b[0] - a[0]), y = a[1] + t * (b[1] - a[1]);
            double before = head->along[i] + hypot(x - a[0], y - a[1]);
            double after = tail->along[j] + hypot(x - c[0], y - c[1]);
            most = before + after;
            found = (Closing){{x, y}, before, after, head->at[i + 1], tail->at[j + 1]};
        }
    return found;
}

/* The stroke between where it closes and there again. Returns the number of points, 0 if nothing runs on beyond. */
static int32_t without_ends(const double *xy, int32_t n, const Closing *c, double *ring, double *tails) {
    int first = c->first, last = c->last;
    if (last < first + 2 || (first == 0 && last == n - 1)) return 0;
    const int head = first > 0;
    *tails = c->before + c->after;
    memcpy(ring + 2 * head, xy + 2 * first, 2 * (size_t)(last - first + 1) * sizeof *xy);
    if (head) memcpy(ring, c->at, sizeof c->at);
    if (!head) memcpy(ring + 2 * (last - first + 1), c->at, sizeof c->at);
    return last - first + 2;
}

/* xy: a stroke's points [pixels], (n, 2).  length: of it.
 * Out: ring: (n + 1, 2), the stroke from where its two ends cross, or one passes by the other, up to there again.  tails:
 * length of what is left out.  Returns the number of the ring's points, 0 where there is none. */
INK_API int32_t ink_ring(const double *xy, int32_t n, double length, double *ring, double *tails) {
    Course head, tail;
    if (n < 4) return 0;
    double most = TAIL * length, at[2];
    follow(xy, 0, 1, n, most, &head);
    follow(xy, n - 1, -1, n, most, &tail);
    Closing c = crossed(xy, &head, &tail, most);
    int32_t count = without_ends(xy, n, &c, ring, tails);
    if (count > 0) return count;
    c = (Closing){{0, 0}, 0, 0, 0, n - 1};
    int j = passes(xy, xy, &tail, &c.after, at);
    if (j >= 0 && c.after < most) {
        memcpy(c.at, at, sizeof at);
        c.last = tail.at[j + 1];
        count = without_ends(xy, n, &c, ring, tails);
        if (count > 0) return count;
    }
    c = (Closing){{0, 0}, 0, 0, 0, n - 1};
    j = passes(xy, xy + 2 * (n - 1), &head, &c.before, at);
    if (j < 0 || !(c.before < most)) return 0;
    memcpy(c.at, at, sizeof at);
    c.first = head.at[j + 1];
    return without_ends(xy, n, &c, ring, tails);
}
