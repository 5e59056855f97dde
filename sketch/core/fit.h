/* Fits of drawn outlines and lines. Plain C11, no allocation, no globals; all lengths in the caller's pixels. */
#ifndef SKETCH_FIT_H
#define SKETCH_FIT_H

#include <math.h>
#include <stdint.h>

#include "api.h"

static const double RETRACE = 1.0; /* nats an observation of ink that was drawn already */

enum {
    SAMPLES = 48, /* of a piece of ink: a rectangle's side still has a dozen */
    SIDES = 12    /* the most sides that are told apart; beyond, an outline is round or free */
};

/* All segmentations of one row of samples: sums over any run of them in constant time. */
typedef struct {
    int n;
    double x[2 * SAMPLES], y[2 * SAMPLES]; /* the samples twice over, so that a run may pass the end */
    /* Which way it goes from each to the next: of length 1, or 0 where the pen was lifted. */
    double along_x[2 * SAMPLES], along_y[2 * SAMPLES];
    double sx[2 * SAMPLES + 1], sy[2 * SAMPLES + 1];
    double sxx[2 * SAMPLES + 1], sxy[2 * SAMPLES + 1], syy[2 * SAMPLES + 1];
    double six[2 * SAMPLES + 1], siy[2 * SAMPLES + 1];   /* x and y times the index, */
    double siix[2 * SAMPLES + 1], siiy[2 * SAMPLES + 1]; /* and times its square: for the bow */
    double cost[SAMPLES][SAMPLES + 1]; /* cost[i][m]: of samples i .. i+m-1 as one side, see Line */
} Runs;

typedef struct {
    double x, y, dx, dy; /* a point of the line, and its unit direction in the order of the samples */
    double bow;          /* how far the run's middle stands off its ends, to the left of the direction */
    double cost;         /* squared distances from the bowed line, and the price of the bow */
} Line;

/* Fill the sums, and the costs of what splits begun at the first sample, or at sample `begin`, have runs of; those of others
 * are left undefined.  stiffness: (tremor / usual bow)², what a bow costs. */
void runs_prepare(Runs *r, int begin, double stiffness);

/* The line of samples first .. first+count-1. Nobody draws a straight side straight: it may bow, at a price. */
Line runs_line(const Runs *r, int first, int count, double stiffness);

/* The best splits of the samples, begun at one of them, into 1, 2, 3 .. runs: each from the one before. */
typedef struct {
    const Runs *runs;
    int start, n;
    double best[SIDES + 1][SAMPLES + 1]; /* best[k][j]: cost of the best k runs of the first j samples */
} Split;

void split_begin(Split *s, const Runs *r, int start);
void split_further(Split *s, int k);                           /* from k - 1 runs to k */
void split_bounds(const Split *s, int k, int cut[SIDES + 1]);  /* the k + 1 bounds of the best k runs */

/* Where two neighbouring sides meet, given the last sample of one and the first of the next. */
void corner(const Line *a, const Line *b, const double end[2], const double begin[2], double out[2]);

/* Equal steps of arc length along the inked parts of a chain (not along the gaps between the parts). */
double sample_parts(const double *xy, const int32_t *part_end, int parts, double *x, double *y, int n);

INK_API int32_t ink_is_simple(const double *v, int32_t n);
INK_API double ink_depth(double x, double y, const double *outline, int32_t n);

/* Of a vector whose squares neither vanish nor overflow: within ink, or in an outline's own frame. hypot takes five times as
 * long. */
static inline double length(double x, double y) { return sqrt(x * x + y * y); }

/* Of ink taken as a course of segments: its length, and the sums over it of x, y and of xx, xy, yy. */
typedef struct {
    double length, x[2], xx[3];
} Moments;

/* Take in a segment of some length, by its vector and its middle. */
static inline void add_segment(Moments *m, double length, double dx, double dy, double cx, double cy) {
    m->length += length;
    m->x[0] += length * cx;
    m->x[1] += length * cy;
    m->xx[0] += length * (cx * cx + dx * dx / 12);
    m->xx[1] += length * (cx * cy + dx * dy / 12);
    m->xx[2] += length * (cy * cy + dy * dy / 12);
}

/* The rectangle nearest to a quadrilateral, (4, 2) [pixels], and the mean squared distance that it adds in a frame with normal
 * = to * pixel; infinite where the quadrilateral is like none. */
double nearest_rectangle(const double *corners, const double to[4], double *box);

/* Whether two pieces share no ink: rivals[from[i] .. from[i + 1]] are those that share some with piece i; from may be null. */
int ink_apart(const int32_t *rivals, const int32_t *from, int i, int j);

int again_end(const double *p, int first, int step, int n, double total, double extent);

static inline double segment_distance2(double px, double py, const double a[2], const double b[2]) {
    double dx = b[0] - a[0], dy = b[1] - a[1], l2 = dx * dx + dy * dy;
    double t = l2 > 0 ? ((px - a[0]) * dx + (py - a[1]) * dy) / l2 : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    double ex = a[0] + t * dx - px, ey = a[1] + t * dy - py;
    return ex * ex + ey * ey;
}

/* The share of segment ab at which it crosses cd, negative where it does not. */
static inline double crossing(const double a[2], const double b[2], const double c[2], const double d[2]) {
    double dx = b[0] - a[0], dy = b[1] - a[1], ex = d[0] - c[0], ey = d[1] - c[1], fx = c[0] - a[0], fy = c[1] - a[1];
    double det = dx * ey - dy * ex;
    if (det == 0) return -1;
    double t = (fx * ey - fy * ex) / det, u = (fx * dy - fy * dx) / det;
    return t >= 0 && t <= 1 && u >= 0 && u <= 1 ? t : -1;
}

/* As said where they are. */
INK_API int32_t ink_along(int32_t pieces, const double *boxes, const double *samples, const double *sizes,
                          const double *outline, int32_t n, double reach, double box[4], int32_t *found);
INK_API void ink_off_outline(const double *samples, const int32_t *names, int32_t count, const double *outline,
                             int32_t n, double *off, double *greatest);
INK_API int32_t ink_within(const double *samples, int32_t name, const double *triangle, double reach);

#endif
