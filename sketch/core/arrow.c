/* An arrow's reading: a shaft from its tail to the tip, and two barbs from the tip, fitted to all the ink of some strokes. */
#include "fit.h"

#include <math.h>

enum { STEPS = 12 }; /* along each part of an arrow, to look for its ink */

/* A head is two barbs alike, at some 35 degrees, less than half as long as the shaft; the spreads of these. */
static const double ALIKE = 0.35; /* of the logarithm of one barb over the other */
static const double SIZE = 0.45, SIZES = 0.4; /* of the shaft, and of its logarithm */
static const double ANGLE = 0.6, ANGLES = 0.25; /* [rad] */

typedef struct {
    double head[6]; /* the tip and the barbs' ends [pixels] */
    double lengths[3]; /* of the shaft and of the barbs [pixels] */
    double angles[2]; /* between barb and shaft */
    double unlike; /* nats of how unlike a head its head is */
    double ink[3]; /* length of the ink that is nearest to the shaft, and to each barb [pixels] */
    double bare; /* mean squared distance of the arrow from the ink [pixels²] */
    double off[]; /* of each stroke from the arrow */
} Arrow;

/* The arrow on `count` strokes; returns 0 where the ink has no head, a barb on each side that points back, or none that is
 * less than `most` nats unlike one. */
static int fit_arrow(const double *samples, const double *length, const int32_t *names, int count, const double *tail,
                     const double *toward, double most, Arrow *out) {
    double *head = out->head, *lengths = out->lengths, *angles = out->angles, *ink = out->ink, *off = out->off;
    double ux = toward[0] - tail[0], uy = toward[1] - tail[1], l = hypot(ux, uy);
    if (l <= 0) return 0;
    ux /= l;
    uy /= l;
    double reach = 0, left[2] = {0, 0}, right[2] = {0, 0}; /* along the shaft, and across */
    for (int k = 0; k < count; k++)
        for (int i = 0; i < SAMPLES; i++) {
            const double *p = samples + 2 * (SAMPLES * names[k] + i);
            double s = (p[0] - tail[0]) * ux + (p[1] - tail[1]) * uy, h = (p[1] - tail[1]) * ux - (p[0] - tail[0]) * uy;
            if (s > reach) reach = s;
            if (h > left[1]) {
                left[0] = s;
                left[1] = h;
            }
            if (h < right[1]) {
                right[0] = s;
                right[1] = h;
            }
        }
    double sum = 0, n = 0;
    for (int k = 0; k < count; k++)
        for (int i = 0; i < SAMPLES; i++) {
            const double *p = samples + 2 * (SAMPLES * names[k] + i);
            double s = (p[0] - tail[0]) * ux + (p[1] - tail[1]) * uy, h = (p[1] - tail[1]) * ux - (p[0] - tail[0]) * uy;
            if (s > 0.96 * reach) {
                sum += h;
                n++;
            }
        }
    if (reach <= 0) return 0;
    double tip[2] = {reach, sum / n}, origin[2] = {0, 0};
    lengths[0] = reach;
    lengths[1] = hypot(tip[0] - left[0], tip[1] - left[1]);
    lengths[2] = hypot(tip[0] - right[0], tip[1] - right[1]);
    angles[0] = atan2(left[1] - tip[1], tip[0] - left[0]);
    angles[1] = atan2(tip[1] - right[1], tip[0] - right[0]);
    for (int e = 0; e < 2; e++)
        if (angles[e] < 0.15 || angles[e] > 1.4 || lengths[e + 1] < 0.1 * reach) return 0;
    double alike = log(lengths[1] / lengths[2]) / ALIKE;
    double size = log((lengths[1] + lengths[2]) / 2 / lengths[0] / SIZE) / SIZES;
    double spread[2] = {(angles[0] - ANGLE) / ANGLES, (angles[1] - ANGLE) / ANGLES};
    out->unlike = 0.5 * (alike * alike + size * size + (spread[0] * spread[0] + spread[1] * spread[1]));
    if (out->unlike > most) return 0;
    ink[0] = ink[1] = ink[2] = 0;
    for (int k = 0; k < count; k++) {
        off[k] = 0;
        for (int i = 0; i < SAMPLES; i++) {
            const double *p = samples + 2 * (SAMPLES * names[k] + i);
            double s = (p[0] - tail[0]) * ux + (p[1] - tail[1]) * uy, h = (p[1] - tail[1]) * ux - (p[0] - tail[0]) * uy;
            const double d[3] = {segment_distance2(s, h, origin, tip), segment_distance2(s, h, tip, left),
                                 segment_distance2(s, h, tip, right)};
            int nearest = d[1] < d[0] ? (d[2] < d[1] ? 2 : 1) : (d[2] < d[0] ? 2 : 0);
            off[k] += d[nearest] / SAMPLES;
            ink[nearest] += length[8 * names[k]] / SAMPLES;
        }
    }
    /* An arrow has ink along all of it: a barb that nobody drew is as far off as ink that no arrow has. */
    const double *part[3][2] = {{origin, tip}, {tip, left}, {tip, right}};
    double whole = lengths[0] + lengths[1] + lengths[2];
    out->bare = 0;
    for (int e = 0; e < 3; e++) {
        double bare = 0;
        for (int i = 0; i < STEPS; i++) {
            double t = (i + 0.5) / STEPS, nearest = INFINITY;
            double s = part[e][0][0] + t * (part[e][1][0] - part[e][0][0]);
            double h = part[e][0][1] + t * (part[e][1][1] - part[e][0][1]);
            double x = tail[0] + s * ux - h * uy, y = tail[1] + s * uy + h * ux;
            for (int k = 0; k < count; k++) {
                const double *p = samples + 2 * SAMPLES * names[k];
                for (int j = 0; j < SAMPLES; j++) {
                    double dx = p[2 * j] - x, dy = p[2 * j + 1] - y;
                    nearest = fmin(nearest, dx * dx + dy * dy);
                }
            }
            bare += nearest / STEPS;
        }
        out->bare += bare * lengths[e] / whole;
    }
    const double *at[3] = {tip, left, right};
    for (int e = 0; e < 3; e++) {
        head[2 * e] = tail[0] + at[e][0] * ux - at[e][1] * uy;
        head[2 * e + 1] = tail[1] + at[e][0] * uy + at[e][1] * ux;
    }
    return 1;
}

/* Arrows on groups of strokes.
 *
 * samples: of every stroke of the page, (strokes, SAMPLES, 2) [pixels]; length: of each stroke, a row of `measure` apart
 * [pixels]; names: the strokes of the groups, one after another; ends: where each of `count` groups ends.
 * given: (count, 5): of each, the shaft's tail, a point on the way to the tip, and the most nats that the head may be unlike
 * one.
 * Out: fits: for each group a row of `width` doubles, an Arrow; one without a head has a shaft of length 0. */
INK_API void ink_arrows(const double *samples, const double *length, const int32_t *names, const int32_t *ends,
                        int32_t count, const double *given, int32_t width, double *fits) {
    for (int g = 0, first = 0; g < count; first = ends[g++]) {
        Arrow *arrow = (Arrow *)(fits + width * g);
        if (!fit_arrow(samples, length, names + first, ends[g] - first, given + 5 * g, given + 5 * g + 2,
                       given[5 * g + 4], arrow))
            arrow->lengths[0] = 0;
    }
}
