/* An open stroke's readings: a polyline of 1 .. SIDES segments. */
#include "fit.h"

#include <math.h>
#include <string.h>

/* xy: one stroke [pixels], (n, 2). Out: samples: SAMPLES points in equal steps of length; residual[k]: mean squared
 * distance [pixels²] of the best k segments; vertices[k][SIDES + 1][2]. Returns the stroke's length. */
INK_API double ink_open(const double *xy, int32_t n, double *samples, double *residual, double *vertices)
{
    Runs r;
    double total[SIDES + 1], x0 = xy[0], y0 = xy[1];
    int cut[SIDES + 1][SIDES + 1];
    r.n = SAMPLES;
    r.stiffness = 1e9; /* straight */
    double length = sample_parts(xy, &n, 1, r.x, r.y, SAMPLES);
    for (int i = 0; i < SAMPLES; i++) {
        samples[2 * i] = r.x[i];
        samples[2 * i + 1] = r.y[i];
        r.x[i] -= x0; /* sums of squares keep their digits near the origin */
        r.y[i] -= y0;
    }
    runs_prepare(&r);
    runs_split(&r, 0, SIDES, total, cut);
    residual[0] = INFINITY;
    for (int k = 1; k <= SIDES; k++) {
        Line side[SIDES];
        double *v = vertices + 2 * (SIDES + 1) * k;
        for (int q = 0; q < k; q++)
            side[q] = runs_line(&r, cut[k][q], cut[k][q + 1] - cut[k][q]);
        for (int q = 1; q < k; q++) {
            int b = cut[k][q];
            double end[2] = {r.x[b - 1], r.y[b - 1]}, begin[2] = {r.x[b], r.y[b]};
            corner(&side[q - 1], &side[q], end, begin, v + 2 * q);
        }
        const Line *a = &side[0], *z = &side[k - 1];
        const double *first = xy, *last = xy + 2 * (n - 1);
        double t = (first[0] - x0 - a->x) * a->dx + (first[1] - y0 - a->y) * a->dy;
        v[0] = a->x + t * a->dx;
        v[1] = a->y + t * a->dy;
        t = (last[0] - x0 - z->x) * z->dx + (last[1] - y0 - z->y) * z->dy;
        v[2 * k] = z->x + t * z->dx;
        v[2 * k + 1] = z->y + t * z->dy;
        double sum = 0;
        for (int q = 0; q < k; q++)
            for (int i = cut[k][q]; i < cut[k][q + 1]; i++)
                sum += segment_distance2(r.x[i], r.y[i], v + 2 * q, v + 2 * q + 2);
        residual[k] = sum / SAMPLES;
        for (int q = 0; q <= k; q++) {
            v[2 * q] += x0;
            v[2 * q + 1] += y0;
        }
    }
    return length;
}
