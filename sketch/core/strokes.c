/* Every stroke of a page measured once: cleaned, sampled, and read as polylines of 1 .. BENDS segments. */
#include "fit.h"

#include <math.h>
#include <string.h>

static const double CLOSING =
    0.25; /* of the gap without it: what leaves less of one is the side that closes an outline */
static const double ENOUGH = 0.045; /* of the spread of a stroke: a polyline that is nearer says it well */

enum {
    BENDS = 6, /* segments of a polyline that anything with a meaning may have */
    AGAIN = 4, /* times that a side is drawn at an end of a stroke */
    LEGS = 12  /* and of one that ink is said freely with */
};

/* Where the little turn back ends that a pen leaves where it goes down: the last turn of over 60 degrees within `reach` of
 * the start; 0 for none. Steps run from `first` by `step` (1 or -1) over n points. */
static int hook_end(const double *p, int first, int step, int n, double reach) {
    double along = 0, ahead = 0;
    int best = 0;
    for (int i = 1, j = 1; i + 1 < n; i++) { /* j: as far ahead as one may look back */
        const double *q = p + 2 * (first + step * i), *before = q - 2 * step, *start = p + 2 * first;
        double w = length(q[0] - before[0], q[1] - before[1]);
        along += w;
        if (along > reach) break;
        if (i > 1) ahead -= w;
        for (; j + 1 < n && ahead < reach; j++) {
            const double *b = p + 2 * (first + step * (j + 1)), *a = b - 2 * step;
            ahead += length(b[0] - a[0], b[1] - a[1]);
        }
        const double *far = p + 2 * (first + step * j);
        double ax = far[0] - q[0], ay = far[1] - q[1], bx = q[0] - start[0], by = q[1] - start[1];
        if (ax * bx + ay * by < 0.5 * length(ax, ay) * length(bx, by)) best = i;
    }
    return best;
}

/* Whether a stroke's ends are nearer to each other with what its first a and last b steps add. */
static int closes(const double *p, int n, int a, int b) {
    const double *begin = p, *end = p + 2 * (n - 1), *first = p + 2 * a, *last = end - 2 * b;
    const double gap = length(begin[0] - end[0], begin[1] - end[1]);
    return gap < CLOSING * length(first[0] - last[0], first[1] - last[1]);
}

static void moments(const double *p, int n, double *total, double mean[2], double s[3]) {
    Moments t = {0};
    for (int i = 1; i < n; i++) {
        double dx = p[2 * i] - p[2 * i - 2], dy = p[2 * i + 1] - p[2 * i - 1];
        double cx = 0.5 * (p[2 * i] + p[2 * i - 2]) - p[0], cy = 0.5 * (p[2 * i + 1] + p[2 * i - 1]) - p[1];
        add_segment(&t, length(dx, dy), dx, dy, cx, cy);
    }
    *total = t.length;
    double w = t.length > 0 ? 1 / t.length : 0, mx = t.x[0] * w, my = t.x[1] * w;
    s[0] = t.xx[0] * w - mx * mx;
    s[1] = t.xx[1] * w - mx * my;
    s[2] = t.xx[2] * w - my * my;
    mean[0] = p[0] + mx;
    mean[1] = p[1] + my;
}

static double least_spread(const double s[3]) {
    double half = 0.5 * (s[0] - s[2]);
    return sqrt(fmax(0.5 * (s[0] + s[2]) - sqrt(half * half + s[1] * s[1]), 0));
}

static void polylines(const double *p, int n, double spread2, Runs *r, double *residual, double *vertices) {
    double x0 = p[0], y0 = p[1];
    int cut[SIDES + 1];
    Split split;
    for (int i = 0; i < r->n; i++) { /* sums of squares keep their digits near the origin */
        r->x[i] -= x0;
        r->y[i] -= y0;
    }
    runs_prepare(r, 0, 1e9); /* straight */
    split_begin(&split, r, 0);
    residual[0] = INFINITY;
    for (int k = 1; k <= LEGS; k++) {
        if (k > BENDS && residual[k - 1] < ENOUGH * ENOUGH * spread2) { /* what more legs save takes more to say */
            residual[k] = residual[k - 1];
            continue;
        }
        if (k > 1) split_further(&split, k);
        if (k > BENDS) {
            residual[k] = split.best[k][r->n] / r->n;
            continue;
        }
        split_bounds(&split, k, cut);
        Line side[BENDS];
        double *v = vertices + 2 * (BENDS + 1) * k, sum = 0;
        for (int q = 0; q < k; q++) side[q] = runs_line(r, cut[q], cut[q + 1] - cut[q], 1e9);
        for (int q = 1; q < k; q++) {
            int b = cut[q];
            double end[2] = {r->x[b - 1], r->y[b - 1]}, begin[2] = {r->x[b], r->y[b]};
            corner(&side[q - 1], &side[q], end, begin, v + 2 * q);
        }
        for (int e = 0; e < 2; e++) { /* the ends: where the pen was, put on the line */
            const Line *a = &side[e ? k - 1 : 0];
            const double *at = p + (e ? 2 * (n - 1) : 0);
            double t = (at[0] - x0 - a->x) * a->dx + (at[1] - y0 - a->y) * a->dy;
            v[2 * e * k] = a->x + t * a->dx;
            v[2 * e * k + 1] = a->y + t * a->dy;
        }
        for (int q = 0; q < k; q++)
            for (int i = cut[q]; i < cut[q + 1]; i++)
                sum += segment_distance2(r->x[i], r->y[i], v + 2 * q, v + 2 * q + 2);
        residual[k] = sum / r->n;
        for (int q = 0; q <= k; q++) {
            v[2 * q] += x0;
            v[2 * q + 1] += y0;
        }
    }
}

/* xy: the strokes' points [pixels] one after another, (n, 2); ends: where each of `count` strokes ends.
 * Out, for each stroke: clean: its points without repeats and hooks, clean_ends likewise; measure (11): length; box (4); ends'
 * distance; root mean square distance from its centroid; thickness (root mean square, across its longer axis); ...
 * samples (SAMPLES, 2) in equal steps of length; residual[k]: mean squared distance from its best k segments, k up to
 * LEGS; vertices[k][BENDS + 1][2]. A stroke without length has measure 0. */
INK_API void ink_strokes(const double *xy, const int32_t *ends, int32_t count, double *clean, int32_t *clean_ends,
                         double *measure, double *samples, double *residual, double *vertices) {
    int out = 0;
    Runs r;
    r.n = SAMPLES;
    for (int s = 0, first = 0; s < count; first = ends[s++]) {
        double *p = clean + 2 * out, *m = measure + 8 * s, mean[2], spread[3];
        int n = 0;
        for (int i = first; i < ends[s]; i++)
            if (n == 0 || xy[2 * i] != p[2 * n - 2] || xy[2 * i + 1] != p[2 * n - 1]) {
                memcpy(p + 2 * n, xy + 2 * i, 2 * sizeof *p);
                n++;
            }
        memset(m, 0, 8 * sizeof *m);
        clean_ends[s] = out + n;
        if (n < 2) {
            out += n;
            continue;
        }
        moments(p, n, &m[0], mean, spread);
        if (n >= 5) { /* a thin box's short side is no hook: it is as long as the stroke is thick */
            double reach = fmin(0.05 * m[0], 0.8 * least_spread(spread));
            int a = hook_end(p, 0, 1, n, reach), b = hook_end(p, n - 1, -1, n, reach);
            if (n - a - b >= 3 && a + b > 0 && !closes(p, n, a, b)) {
                n -= a + b;
                memmove(p, p + 2 * a, 2 * n * sizeof *p);
                moments(p, n, &m[0], mean, spread);
            }
        }
        for (int back = 0, e = 0; e < 2 * AGAIN && n >= 5 && back < 2; e++) { /* what it goes over more than once */
            int a = e % 2 ? again_end(p, n - 1, -1, n, m[0], 3 * sqrt(spread[0] + spread[2]))
                          : again_end(p, 0, 1, n, m[0], 3 * sqrt(spread[0] + spread[2]));
            back = a ? 0 : back + 1;
            if (a == 0) continue;
            n -= a;
            if (e % 2 == 0) memmove(p, p + 2 * a, 2 * n * sizeof *p);
            moments(p, n, &m[0], mean, spread);
        }
        out += n;
        clean_ends[s] = out;
        m[1] = m[3] = p[0];
        m[2] = m[4] = p[1];
        for (int i = 1; i < n; i++) {
            m[1] = fmin(m[1], p[2 * i]);
            m[2] = fmin(m[2], p[2 * i + 1]);
            m[3] = fmax(m[3], p[2 * i]);
            m[4] = fmax(m[4], p[2 * i + 1]);
        }
        m[5] = hypot(p[2 * n - 2] - p[0], p[2 * n - 1] - p[1]);
        m[6] = sqrt(fmax(spread[0] + spread[2], 0));
        m[7] = least_spread(spread);
        sample_parts(p, &n, 1, r.x, r.y, SAMPLES);
        for (int i = 0; i < SAMPLES; i++) {
            samples[2 * (SAMPLES * s + i)] = r.x[i];
            samples[2 * (SAMPLES * s + i) + 1] = r.y[i];
        }
        polylines(p, n, m[6] * m[6], &r, residual + (LEGS + 1) * s, vertices + 2 * (BENDS + 1) * (BENDS + 1) * s);
    }
}
