/* Questions about outlines, closed ones and open ones. */
#include "fit.h"

#include <math.h>

static double turn(const double *a, const double *b, const double *c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Whether no two sides of a closed outline, (n, 2), cross or touch, but neighbours at their corner. */
INK_API int32_t ink_is_simple(const double *v, int32_t n) {
    for (int i = 0; i < n; i++)
        for (int j = i + 2; j < n; j++) {
            if (i == 0 && j == n - 1) continue;
            const double *a = v + 2 * i, *b = v + 2 * (i + 1), *c = v + 2 * j, *d = v + 2 * ((j + 1) % n);
            if (turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0) return 0;
        }
    return 1;
}

/* Mean squared distances of `count` strokes, those with these names, from a closed outline, (n, 2), and the greatest ones
 * [pixels²]. */
INK_WIDE INK_API void ink_off_outline(const double *samples, const int32_t *names, int32_t count, const double *outline,
                                      int32_t n, double *off, double *greatest) {
    for (int k = 0; k < count; k++) {
        const double *p = samples + 2 * SAMPLES * names[k];
        double best[SAMPLES], sum = 0, most = 0;
        for (int i = 0; i < SAMPLES; i++) best[i] = INFINITY;
        for (int q = 0; q < n; q++) {
            const double *a = outline + 2 * q, *b = outline + 2 * ((q + 1) % n);
            double dx = b[0] - a[0], dy = b[1] - a[1], l2 = dx * dx + dy * dy, per = l2 > 0 ? 1 / l2 : 0;
            for (int i = 0; i < SAMPLES; i++) {
                double x = p[2 * i] - a[0], y = p[2 * i + 1] - a[1], t = (x * dx + y * dy) * per;
                t = t < 0 ? 0 : t > 1 ? 1 : t;
                x -= t * dx;
                y -= t * dy;
                best[i] = x * x + y * y < best[i] ? x * x + y * y : best[i];
            }
        }
        for (int i = 0; i < SAMPLES; i++) {
            sum += best[i];
            most = best[i] > most ? best[i] : most;
        }
        off[k] = sum / SAMPLES;
        greatest[k] = most;
    }
}

/* Distance of a point from a closed outline [pixels], negative inside (even-odd rule). */
INK_API double ink_depth(double x, double y, const double *outline, int32_t n) {
    double best = INFINITY;
    int within = 0;
    for (int q = 0; q < n; q++) {
        const double *a = outline + 2 * q, *b = outline + 2 * ((q + 1) % n);
        best = fmin(best, segment_distance2(x, y, a, b));
        if ((a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1])) within = !within;
    }
    return within ? -sqrt(best) : sqrt(best);
}

/* Likewise of `count` points, (count, 2). */
INK_API void ink_depths(const double *points, int32_t count, const double *outline, int32_t n, double *depths) {
    for (int i = 0; i < count; i++) depths[i] = ink_depth(points[2 * i], points[2 * i + 1], outline, n);
}

/* Whether a stroke is within a triangle, (3, 2), or beyond its sides by no more than `reach` [pixels]. */
INK_API int32_t ink_within(const double *samples, int32_t name, const double *triangle, double reach) {
    const double *p = samples + 2 * SAMPLES * name;
    const double side = turn(triangle, triangle + 2, triangle + 4) < 0 ? -1 : 1;
    for (int q = 0; q < 3; q++) {
        const double *a = triangle + 2 * q, *b = triangle + 2 * ((q + 1) % 3);
        const double most = reach * fmax(length(b[0] - a[0], b[1] - a[1]), 1e-9);
        for (int i = 0; i < SAMPLES; i++)
            if (side * turn(a, b, p + 2 * i) < -most) return 0;
    }
    return 1;
}

/* Keep a point where it is nearer to the side from a to b than `best`, squared. */
static void keep_nearer(const double *p, const double *a, const double *b, double *best, double at[2]) {
    const double off = segment_distance2(p[0], p[1], a, b);
    if (off >= *best) return;
    *best = off;
    at[0] = p[0], at[1] = p[1];
}

/* How near two open lines, (n, 2) and (m, 2), come to each other [pixels].  Out: at: a place on one of them where they do. */
INK_API double ink_gap(const double *one, int32_t n, const double *other, int32_t m, double at[2]) {
    double best = INFINITY; /* squared */
    for (int i = 0; i + 1 < n; i++)
        for (int j = 0; j + 1 < m; j++) {
            const double *a = one + 2 * i, *b = a + 2, *c = other + 2 * j, *d = c + 2;
            const double from = turn(c, d, a), to = turn(c, d, b);
            if (from * to < 0 && turn(a, b, c) * turn(a, b, d) < 0) {
                const double t = from / (from - to);
                at[0] = a[0] + t * (b[0] - a[0]);
                at[1] = a[1] + t * (b[1] - a[1]);
                return 0;
            }
            keep_nearer(a, c, d, &best, at);
            keep_nearer(b, c, d, &best, at);
            keep_nearer(c, a, b, &best, at);
            keep_nearer(d, a, b, &best, at);
        }
    return sqrt(best);
}

enum { STEPS = 64 }; /* along a side, to look for where another outline is near */

/* Whether a place of one outline, within `reach` of a point, is within another or nearer to it than `near`. */
static int comes_near(const double *one, int32_t n, const double *other, int32_t m, double x, double y, double reach,
                      double near) {
    for (int q = 0; q < n; q++) {
        const double *a = one + 2 * q, *b = one + 2 * ((q + 1) % n);
        if (segment_distance2(x, y, a, b) >= reach * reach) continue;
        for (int i = 0; i < STEPS; i++) {
            double px = a[0] + i * (b[0] - a[0]) / STEPS, py = a[1] + i * (b[1] - a[1]) / STEPS;
            if (hypot(px - x, py - y) < reach && ink_depth(px, py, other, m) < near) return 1;
        }
    }
    return 0;
}

/* Whether two closed outlines, (n, 2) and (m, 2), overlap or come nearer than `near` within `reach` of a point [pixels]. */
INK_API int32_t ink_touch(const double *one, int32_t n, const double *other, int32_t m, double x, double y,
                          double reach, double near) {
    return comes_near(one, n, other, m, x, y, reach, near) || comes_near(other, m, one, n, x, y, reach, near);
}
