/* Where a body's edge lies: the outline of its kind that differs least in area from what was drawn.
 *
 * A fit says what was meant, by the middle of the ink; the body reaches to the outer edge of it, its convex hull. To move or
 * turn a side changes the area that outline and hull do not share by the hull's signed distances along that side: least is
 * where these are in the median, a regression of least absolute distances (Boscovich; here by reweighted least squares).
 * Tails and hooks are a small part of a side, and so do not move it. */
#include "fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    EDGE = 96, /* samples of the hull */
    PASSES = 16
};
static const double BEYOND = 15.0;  /* times as far out as half of the ink is off: what runs on past a corner, */
static const double CLOSE = 0.05;  /* if it is off by more than this share of the outline's size */
static const double MEDIAN = 0.01; /* of the outline's size: distances below count by their squares */
static const double WITHIN = 0.4;  /* of a side has hull beyond it: less than half, as hands run past corners */
static const double STILL = 1e-4; /* of the outline's size: what moves no farther is in its place */
/* What lies over a corner is as near to either of its sides: it goes with the one that it is less beyond. */
static const double BESIDE = 1e-6;
static const double ASTRAY = 0.5;  /* of the outline's size: a corner that moves farther is no placing any more */

typedef struct {
    double x[EDGE], y[EDGE];
} Edge;

static int by_place(const void *p, const void *q) {
    const double *a = p, *b = q;
    return a[0] != b[0] ? (a[0] > b[0] ? 1 : -1) : (a[1] > b[1]) - (a[1] < b[1]);
}

static int by_size(const void *p, const void *q) {
    double a = *(const double *)p, b = *(const double *)q;
    return (a > b) - (a < b);
}

static double turned(const double *a, const double *b, const double *c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Andrew's monotone chain: the hull's corners into `out` (room for 2n + 2), counter-clockwise with y up; returns their count.
 * Sorts the points. */
static int convex_hull(double *xy, int n, double *out) {
    int k = 0;
    qsort(xy, (size_t)n, 2 * sizeof *xy, by_place);
    for (int half = 0; half < 2; half++) {
        int floor = k;
        for (int i = 0; i < n; i++) {
            const double *p = xy + 2 * (half ? n - 1 - i : i);
            while (k >= floor + 2 && turned(out + 2 * k - 4, out + 2 * k - 2, p) <= 0) k--;
            memcpy(out + 2 * k++, p, 2 * sizeof *p);
        }
        k--; /* where the other half begins */
    }
    return k;
}

/* Weighted normal equations a (m, m + 1), symmetric and positive definite, in place; the solution is in column m. */
static void solve(double a[5][6], int m) {
    for (int p = 0; p < m; p++) {
        a[p][p] += 1e-12;
        for (int q = p + 1; q < m; q++) {
            double f = a[q][p] / a[p][p];
            for (int t = p; t <= m; t++) a[q][t] -= f * a[p][t];
        }
    }
    for (int p = m - 1; p >= 0; p--) {
        for (int q = p + 1; q < m; q++) a[p][m] -= a[p][q] * a[q][m];
        a[p][m] /= a[p][p];
    }
}

static void add_row(double a[5][6], int m, const double row[5], double off, int outside, double least) {
    double w = (outside ? WITHIN : 1 - WITHIN) / fmax(fabs(off), least);
    for (int p = 0; p < m; p++) {
        for (int q = 0; q < m; q++) a[p][q] += w * row[p] * row[q];
        a[p][m] += w * row[p] * off;
    }
}

static void place_circle(const Edge *e, double circle[3]) {
    double least = MEDIAN * circle[2];
    for (int pass = 0; pass < PASSES; pass++) {
        double a[5][6] = {{0}};
        for (int i = 0; i < EDGE; i++) {
            double dx = e->x[i] - circle[0], dy = e->y[i] - circle[1], r = fmax(hypot(dx, dy), 1e-12);
            double row[5] = {dx / r, dy / r, 1};
            add_row(a, 3, row, r - circle[2], r > circle[2], least);
        }
        solve(a, 3);
        for (int p = 0; p < 3; p++) circle[p] += a[p][3];
        if (fabs(a[0][3]) + fabs(a[1][3]) + fabs(a[2][3]) < STILL * circle[2]) break;
    }
}

/* Moves and turns the sides of a polygon, of a rectangle all by one angle. Returns 0 where they do not meet any more. */
static int place_sides(const Edge *e, double *v, int k, int rectangle, double size, double inward) {
    for (int pass = 0; pass < PASSES; pass++) {
        double a[SIDES][5][6], all[5][6], u[SIDES][2], length[SIDES], middle[SIDES][2], next[2 * SIDES];
        double centre[2] = {0, 0}, moved = 0;
        memset(a, 0, sizeof a);
        memset(all, 0, sizeof all);
        for (int q = 0; q < k; q++) {
            const double *p = v + 2 * q, *z = v + 2 * ((q + 1) % k);
            double l = length[q] = fmax(hypot(z[0] - p[0], z[1] - p[1]), 1e-12);
            for (int c = 0; c < 2; c++) {
                u[q][c] = (z[c] - p[c]) / l;
                middle[q][c] = 0.5 * (p[c] + z[c]);
                centre[c] += p[c] / k;
            }
        }
        for (int i = 0; i < EDGE; i++) {
            double best = INFINITY;
            int q = 0;
            for (int s = 0; s < k; s++) {
                double x = e->x[i] - v[2 * s], y = e->y[i] - v[2 * s + 1], along = x * u[s][0] + y * u[s][1];
                double over = along < 0 ? -along : along > length[s] ? along - length[s] : 0;
                double off = y * u[s][0] - x * u[s][1], d = off * off + (1 + BESIDE) * over * over;
                if (d < best) {
                    best = d;
                    q = s;
                }
            }
            const double *about = rectangle ? centre : middle[q];
            double t = (e->x[i] - about[0]) * u[q][0] + (e->y[i] - about[1]) * u[q][1];
            double off = (e->y[i] - middle[q][1]) * u[q][0] - (e->x[i] - middle[q][0]) * u[q][1];
            double row[5] = {1, t};
            if (rectangle) {
                memset(row, 0, sizeof row);
                row[q] = 1;
                row[4] = t;
            }
            add_row(rectangle ? all : a[q], rectangle ? 5 : 2, row, off, off * inward < 0, MEDIAN * size);
        }
        if (rectangle) solve(all, 5);
        for (int q = 0; q < k; q++) { /* sides as a point and a direction */
            if (!rectangle) solve(a[q], 2);
            double shift = rectangle ? all[q][5] : a[q][0][2], angle = rectangle ? all[4][5] : a[q][1][2];
            double c = 1 / hypot(1, angle), s = angle * c, x = u[q][0], y = u[q][1];
            const double *about = rectangle ? centre : middle[q];
            double px = middle[q][0] - y * shift - about[0], py = middle[q][1] + x * shift - about[1];
            middle[q][0] = about[0] + c * px - s * py;
            middle[q][1] = about[1] + s * px + c * py;
            u[q][0] = c * x - s * y;
            u[q][1] = s * x + c * y;
        }
        for (int q = 0; q < k; q++) { /* corner q is where side q - 1 meets side q */
            const double *p = middle[(q + k - 1) % k], *d = u[(q + k - 1) % k], *z = middle[q], *f = u[q];
            double sine = d[0] * f[1] - d[1] * f[0];
            if (fabs(sine) < 0.1) return 0;
            double t = ((z[0] - p[0]) * f[1] - (z[1] - p[1]) * f[0]) / sine;
            next[2 * q] = p[0] + t * d[0];
            next[2 * q + 1] = p[1] + t * d[1];
            moved = fmax(moved, fabs(next[2 * q] - v[2 * q]) + fabs(next[2 * q + 1] - v[2 * q + 1]));
        }
        memcpy(v, next, 2 * (size_t)k * sizeof *v);
        if (moved < STILL * size) break;
    }
    return 1;
}

static double off_edge(double x, double y, const double *v, int k) {
    if (k == 0) return hypot(x - v[0], y - v[1]) - v[2];
    return ink_depth(x, y, v, k);
}

/* Leaves out ink that runs on past a corner, or the closing: that is no part of the body. Returns how many points stay. */
static int without_tails(double *xy, int n, const double *v, int k, double size, double *off) {
    double *sorted = off + n;
    int kept = 0;
    for (int i = 0; i < n; i++) {
        off[i] = off_edge(xy[2 * i], xy[2 * i + 1], v, k);
        sorted[i] = fabs(off[i]);
    }
    qsort(sorted, (size_t)n, sizeof *sorted, by_size);
    double most = fmax(BEYOND * sorted[n / 2], CLOSE * size);
    for (int i = 0; i < n; i++)
        if (off[i] <= most) {
            memcpy(xy + 2 * kept, xy + 2 * i, 2 * sizeof *xy);
            kept++;
        }
    return kept;
}

/* Place an outline about its ink.
 *
 * xy: all points of the ink, (n, 2), n >= 2; they are sorted.  scratch: room for 2n + 2 points.
 * v: a polygon of k sides, 3 .. SIDES, convex; k = 4 with rectangle: its sides stay at right angles; k = 0: centre and
 * radius of a circle. Replaced by the placed one; returns 0 where there is none, and v is what it was. */
INK_API int32_t ink_placed(double *xy, int32_t n, double *scratch, double *v, int32_t k, int32_t rectangle) {
    double placed[2 * SIDES], area = 0, size = v[2];
    for (int q = 0; q < k; q++) {
        const double *a = v + 2 * q, *b = v + 2 * ((q + 1) % k), *c = v + 2 * ((q + 2) % k);
        area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
        if (turned(a, b, c) * turned(b, c, v + 2 * ((q + 3) % k)) <= 0) return 0; /* not convex */
    }
    if (k > 0) size = sqrt(fabs(area));
    n = without_tails(xy, n, v, k, size, scratch);
    int count = n > 2 ? convex_hull(xy, n, scratch) : 0;
    Edge e;
    if (count < 3) return 0;
    memcpy(scratch + 2 * count, scratch, 2 * sizeof *scratch);
    count++;
    sample_parts(scratch, &count, 1, e.x, e.y, EDGE);
    if (k == 0) {
        memcpy(placed, v, 3 * sizeof *v);
        place_circle(&e, placed);
        if (!(hypot(placed[0] - v[0], placed[1] - v[1]) + fabs(placed[2] - v[2]) < ASTRAY * size)) return 0;
        memcpy(v, placed, 3 * sizeof *v);
        return 1;
    }
    memcpy(placed, v, 2 * (size_t)k * sizeof *v);
    if (!place_sides(&e, placed, k, rectangle, size, area) || !ink_is_simple(placed, k)) return 0;
    for (int q = 0; q < k; q++)
        if (!(hypot(placed[2 * q] - v[2 * q], placed[2 * q + 1] - v[2 * q + 1]) < ASTRAY * size)) return 0;
    memcpy(v, placed, 2 * (size_t)k * sizeof *v);
    return 1;
}
