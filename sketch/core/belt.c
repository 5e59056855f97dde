/* Small rings on paper: the belt of ink around a place, met along rays from it. */
#include "fit.h"

enum { RAYS = 48, STEPS = 512 }; /* directions in which the belt is looked for, and places along each */

static const double STEP = 0.5;                    /* [pixels] between those */
static const double SMALLEST = 0.9, LARGEST = 4.5; /* pen widths: the radius that the pen's middle went along */
static const double REACH = 1.2;                   /* pen widths to either side of the circle so far */
static const double NEARER = 0.15; /* of two runs of ink, how much rather the nearer one is the belt's */
static const double MET = 0.6;     /* the share of a pen width that must be ink */
static const double SOME = 0.6;    /* the share of the rays that must meet the belt before it is fitted, */
static const double DRAWN = 0.9;   /* and after */
static const double OPEN = 0.25; /* of those that must meet paper beyond it: a ring stands out from a scribble, */
static const double CLEAR = 0.8; /* and with those within it; */
static const double BLOT = 0.6;  /* one that is filled must stand out by so much, and be as round */
static const double ROUND = 0.4; /* one that other ink is all around must be as round, and clear by its hole alone */
static const double BEYOND = 1.1, WITHIN = 0.8; /* pen widths from the belt's middle to the paper beside it */
static const double OUT_OF_ROUND = 0.09; /* deviation from a circle, a share of its radius: a square has 0.11 */
/* Of roundness, what rims that are not to be seen speak against a ring: lines often run into its belt from outside, seldom
 * over its hole. By logistic regression on rings of 540 pictures. */
static const double HIDDEN_OUTSIDE = 0.2, HIDDEN_WITHIN = 0.4;
static const double LEAST_ROUND = -0.1;

typedef struct {
    const uint8_t *mask;
    int32_t width, height;
    double pen;
} Paper;

static int ink_at(const Paper *p, double x, double y) {
    const double column = fmin(fmax(rint(x), 0), p->width - 1), row = fmin(fmax(rint(y), 0), p->height - 1);
    return p->mask[(int64_t)row * p->width + (int64_t)column];
}

/* Where each ray crosses the run of ink whose middle is nearest to the radius: how far out, or -1 where there is none.
 * Where ink runs along the ray its middle says nothing, and the nearest of it that is a pen wide is taken. */
static int met_along(const Paper *p, const double middle[2], double radius, double along[RAYS]) {
    const double begin = fmax(radius - REACH * p->pen, 0), end = radius + REACH * p->pen;
    const int steps = (int)ceil((end - begin) / STEP);
    const int half = (int)fmax(floor(p->pen), 1); /* half-pixel steps over half a pen to either side */
    double window[STEPS], total = 0;
    if (steps > STEPS || 2 * half + 1 > STEPS) return 0;
    for (int k = 0; k <= 2 * half; k++)
        total += window[k] = 0.5 - 0.5 * cos(6.283185307179586 * (k + 1) / (2 * half + 2));
    int met = 0;
    for (int r = 0; r < RAYS; r++) {
        const double turn = r * (6.283185307179586 / RAYS), dx = cos(turn), dy = sin(turn);
        int ink[STEPS];
        for (int k = 0; k < steps; k++) {
            const double far = begin + STEP * k;
            ink[k] = ink_at(p, middle[0] + dx * far, middle[1] + dy * far);
        }
        double best = -1e300, filled = 0;
        for (int k = 0; k < steps; k++) {
            double sum = 0;
            for (int j = -half; j <= half; j++)
                if (k + j >= 0 && k + j < steps && ink[k + j]) sum += window[j + half];
            const double far = begin + STEP * k, off = (far - radius) / p->pen;
            const double value = sum / total - NEARER * off * off;
            if (value > best) {
                best = value;
                filled = sum / total;
                along[r] = far;
            }
        }
        if (filled > MET)
            met++;
        else
            along[r] = -1;
    }
    return met;
}

/* The circle through the places where the belt was met (Kasa 1976), in place. Returns 0 where there is none. */
static int fit_circle(double middle[2], double *radius, const double along[RAYS]) {
    double x[RAYS], y[RAYS], mx = 0, my = 0;
    int n = 0;
    for (int r = 0; r < RAYS; r++) {
        if (along[r] < 0) continue;
        const double turn = r * (6.283185307179586 / RAYS);
        x[n] = middle[0] + along[r] * cos(turn);
        y[n] = middle[1] + along[r] * sin(turn);
        mx += x[n];
        my += y[n++];
    }
    mx /= n;
    my /= n;
    double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, z = 0;
    for (int k = 0; k < n; k++) {
        const double u = x[k] - mx, v = y[k] - my, w = u * u + v * v;
        xx += u * u;
        xy += u * v;
        yy += v * v;
        xz += u * w;
        yz += v * w;
        z += w;
    }
    const double det = xx * yy - xy * xy;
    if (det <= 0) return 0;
    const double a = (xz * yy - yz * xy) / det / 2, b = (yz * xx - xz * xy) / det / 2;
    middle[0] = mx + a;
    middle[1] = my + b;
    *radius = sqrt(z / n + a * a + b * b);
    return 1;
}

/* The belt of ink around a seed: where the pen's middle went, along each ray.
 *
 * mask: ink 1, paper 0.  seed: a place and a radius [pixels].  pen: its width [pixels].
 * out: gets the belt's roundness (1 is perfect, 0 as much out of round as a careless square), its middle and radius, and
 * its place on each of RAYS rays. Along each the belt is the run of ink whose middle is nearest to the circle so far,
 * which is then fitted to those middles, three times. Returns 1, or 0 where there is no belt. */
INK_API int32_t ink_belt(const uint8_t *mask, int32_t width, int32_t height, const double *seed, double pen,
                         double *out) {
    const Paper paper = {mask, width, height, pen};
    double middle[2] = {seed[0], seed[1]}, radius = seed[2], along[RAYS];
    for (int pass = 0; pass < 3; pass++) {
        if (met_along(&paper, middle, radius, along) < SOME * RAYS) return 0;
        if (!fit_circle(middle, &radius, along)) return 0;
        if (!(radius >= SMALLEST * pen && radius <= LARGEST * pen)) return 0;
    }
    const int met = met_along(&paper, middle, radius, along);
    if (met < DRAWN * RAYS) return 0;
    double beyond = 0, within = 0, uneven = 0;
    for (int r = 0; r < RAYS; r++) {
        const double dx = cos(r * (6.283185307179586 / RAYS)), dy = sin(r * (6.283185307179586 / RAYS));
        if (along[r] < 0) along[r] = radius;
        const double far = along[r] + BEYOND * pen, near = fmax(along[r] - WITHIN * pen, 0);
        beyond += !ink_at(&paper, middle[0] + dx * far, middle[1] + dy * far);
        within += !ink_at(&paper, middle[0] + dx * near, middle[1] + dy * near);
        uneven += (along[r] - radius) * (along[r] - radius);
    }
    beyond /= RAYS;
    within /= RAYS;
    const double roundness = 1 - sqrt(uneven / RAYS) / radius / OUT_OF_ROUND;
    const int clear = within + beyond >= CLEAR || (beyond > BLOT && roundness > BLOT);
    const int open = beyond >= OPEN && clear && roundness >= LEAST_ROUND;
    /* a pivot's ring among the ends of rods leaves no paper beside it, but a hole that is whole and round */
    if (!open && (within < CLEAR || roundness < ROUND)) return 0;
    /* of one that is filled only half is to be seen: its outer rim */
    out[0] = within + beyond < CLEAR ? roundness / 2 : roundness;
    out[0] -= HIDDEN_OUTSIDE * (1 - beyond) + HIDDEN_WITHIN * (1 - within);
    out[1] = middle[0];
    out[2] = middle[1];
    out[3] = radius;
    for (int r = 0; r < RAYS; r++) {
        const double turn = r * (6.283185307179586 / RAYS);
        const double even = (along[(r + RAYS - 1) % RAYS] + 2 * along[r] + along[(r + 1) % RAYS]) / 4;
        out[4 + 2 * r] = middle[0] + even * cos(turn);
        out[5 + 2 * r] = middle[1] + even * sin(turn);
    }
    return 1;
}
