/* What each reading of a closed outline takes to say, in nats: round, a rectangle, a polygon, an outline of any course. */
#include "closed.h"
#include "scoring.h"

#include <math.h>

enum {
    FEWEST = 5, /* sides of polygons that are nearly round */
    MOST = 8, /* sides of polygons beside whose corners something round turns more; as in core/outline.c */
    FEWER = 7, /* likewise where its points are few: eight of these may be round as well */
    MANY = 12 /* steps between points around an outline: where there are more, one sees how the ink turns */
};

static const double PI = 3.14159265358979323846;
static const double ROUND = 31.0; /* nats that a round outline is rarer than its three parameters say */
static const double TRIANGLE = 2.0; /* nats that triangles are commoner than other polygons, */
static const double FOURSIDED = 4.0; /* and quadrilaterals */
static const double IRREGULAR = 6.0; /* nats that a quadrilateral is rarer of which no two sides are parallel */
static const double ALIKE = 0.1; /* [rad]: how far opposite sides usually are from parallel that are meant to be */
static const double ALSO = 10.0; /* nats: likelihoods of polygons that take so much more are not told apart */
/* nats to say where a corner is, either way, that is off its place in a regular polygon by some REGULAR */
static const double NEARLY = 1.5;
static const double REGULAR = 0.06; /* of the radius: how far corners that are meant to be regular usually are off */
static const double BOX = 17.0; /* nats to say a rectangle: five parameters, and that nothing is drawn oftener */
static const double UNROUND = 0.115; /* usual log of a drawn circle's length over its width, either way */
/* usual share of a round outline's turning that is at a polygon's corners, beyond what is there anyway */
static const double EVENLY = 0.4;
/* how much the share of turning that is at corners differs from the usual: EVENLY, or all of a polygon's */
static const double TURNING = 0.12;
static const double ELLIPSE = 7.5; /* nats that an ellipse takes beyond a circle: 1.6 times as long as wide is either */
static const double FREEFORM =
    29.0; /* nats that an outline of any course, a hill or a cloud, is rarer than a polygon */
static const double ARC = 7.0; /* nats to say each arc of such an outline: where along it one ends is hardly told */
static const double WIDE = 0.25; /* of its ink: where more is missing, nobody can say which course it took */
static const double OPEN = 60; /* nats that something round is rarer of which as much is missing */

typedef struct {
    double cost; /* nats; infinite for none */
    double model; /* of these, what its parameters take, whatever the ink */
    double rough; /* nats to say the ink, given a polygon's outline */
} Reading;

typedef struct {
    double scale, narrow; /* geometric mean of its half axes, and the shorter [pixels] */
    double gap; /* what is missing, as a share of its ink */
    Reading circle, ellipse, polygon, rectangle, any;
    double round[3]; /* the circle's centre and radius [pixels] */
    double sides; /* of the polygon, */
    double next, ahead; /* of the one that comes next, and the nats that it takes more */
} Readings;

/* What is known of ink that came in few points, in equal steps: without any, no points. */
typedef struct {
    double said; /* numbers that they say */
    double steps; /* between them, MANY at most */
    double even, cornered; /* nats to say how even these are, of something round and of a polygon of few sides */
} Few;

static double square(double x) { return x * x; }

/* Nats to say the corners of a k-gon. */
static double said(int k) { return 2 * k * CORNER - (k == 3 ? TRIANGLE : k == 4 ? FOURSIDED : 0); }

/* The angle between two vectors [rad], from 0 to pi. */
static double between(double ax, double ay, double bx, double by) {
    return fabs(atan2(ay * bx - ax * by, ax * bx + ay * by));
}

/* The least angle between opposite sides of a quadrilateral [rad]. */
static double unlike(const double *v) {
    return fmin(between(v[2] - v[0], v[3] - v[1], v[4] - v[6], v[5] - v[7]),
                between(v[4] - v[2], v[5] - v[3], v[6] - v[0], v[7] - v[1]));
}

/* Nats that a polygon's ink is further off it than it seems, where its points are few: the corners follow them. n points in
 * equal steps say 2 n - 1 numbers, of which the corners take two each. */
static double too_near(double mean_square, double count, int sides, double numbers) {
    if (numbers <= 0 || !isfinite(mean_square)) return 0;
    return misfit(mean_square * numbers / fmax(numbers - 2 * sides, 1), count) - misfit(mean_square, count);
}

/* Nats to say how far a polygon's corners are off those of an affine image of a regular one. Such an image is
 * a + b w^j + c w^-j, with w the k-th root of one: what the corners' other discrete Fourier coefficients hold is how far they
 * are off it. */
static double irregular(const Closed *fit, int k) {
    double re[MOST], im[MOST], c[MOST], s[MOST], off2 = 0;
    const double *back = fit->back, det = back[0] * back[3] - back[1] * back[2];
    for (int j = 0; j < k; j++) {
        const double x = fit->vertices[k][2 * j] - fit->mean[0], y = fit->vertices[k][2 * j + 1] - fit->mean[1];
        re[j] = (back[3] * x - back[1] * y) / det;
        im[j] = (back[0] * y - back[2] * x) / det;
        c[j] = cos(2 * PI * j / k);
        s[j] = sin(2 * PI * j / k);
    }
    for (int f = 2; f < k - 1; f++) {
        double x = 0, y = 0;
        for (int j = 0, w = 0; j < k; j++, w = (w + f) % k) {
            x += re[j] * c[w] - im[j] * s[w];
            y += re[j] * s[w] + im[j] * c[w];
        }
        off2 += square(hypot(x, y));
    }
    return 0.5 * (off2 / k) / (REGULAR * REGULAR);
}

/* Nats to say how much of the ink's turning is at a polygon's corners, of something round (out) and of the polygon. Beside
 * many corners nothing is left to turn.
 * most: sides that it is told of.  steps: between the points of its line, MANY where there are more: all turning is at these,
 * and as many of them as the polygon has corners may be its corners. */
static double turning(const Closed *fit, int sides, int most, double steps, double *evenly) {
    *evenly = 0;
    if (sides > most || !isfinite(fit->cost[sides])) return 0;
    double off = 1 - fmin(fmax(fit->turned[sides], 0), 1);
    off = fmin(off * (1 - sides / (double)MANY) / (1 - sides / steps), 1 - EVENLY);
    *evenly = 0.5 * square((1 - off - EVENLY) / TURNING);
    return 0.5 * square(off / TURNING);
}

/* The least of some numbers from `first` to SIDES, but for one of them; the earliest where several are. */
static int least_of(const double *of, int first, int but) {
    int best = first == but ? first + 1 : first;
    for (int k = best + 1; k <= SIDES; k++)
        if (k != but && of[k] < of[best]) best = k;
    return best;
}

/* The circle and the ellipse; one hardly longer than wide is a circle too. */
static void read_round(const Closed *fit, double count, double besides, Readings *out) {
    const double missing = fit->missing / fit->ink;
    besides += GAP * count * missing + (missing > WIDE ? OPEN : 0);
    for (int e = 0; e < 3; e++) out->round[e] = fit->circle[e];
    out->circle = (Reading){fit->circle_cost + ROUND + besides, ROUND, 0};
    out->ellipse = (Reading){INFINITY, ROUND + ELLIPSE, 0};
    if (!fit->is_ellipse) return;
    const double *v = fit->axes;
    const double total = v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3], area = fabs(v[0] * v[3] - v[1] * v[2]);
    const double longer = acosh(fmax(total / (2 * area), 1)); /* log of the half axes' ratio */
    const double cost = fit->conic_cost + ROUND + besides, as_circle = cost + 0.5 * square(longer / UNROUND);
    out->ellipse.cost = cost + ELLIPSE;
    if (as_circle >= out->circle.cost) return;
    out->circle.cost = as_circle;
    out->round[0] = fit->middle[0];
    out->round[1] = fit->middle[1];
    out->round[2] = sqrt(area);
}

/* An outline of any course, or of sides and arcs, as far as it is cheaper than those that are known already. */
static Reading read_any(const Closed *fit, double count, double gaps, double besides, const Readings *known) {
    const double model = FREEFORM + 3 * ARC;
    double best = fmin(fmin(known->circle.cost, known->ellipse.cost), fmin(known->polygon.cost, known->rectangle.cost));
    double arcs = INFINITY;
    if (fit->gap > WIDE * fit->ink) return (Reading){INFINITY, model, 0};
    if (FREEFORM + gaps + 3 * ARC <= best)
        for (int k = 3; k <= SIDES; k++) arcs = fmin(arcs, misfit(fit->residual[k], count) + ARC * k);
    const double cost = fmin(FREEFORM + gaps + arcs, fit->arced + besides);
    return (Reading){cost < best ? cost : INFINITY, model, 0};
}

/* The readings of ink that goes once around.
 *
 * fit: to its line.  rounded: the same, or where its points are few, to the ink between them if it is round.
 * count: of its observations.  besides: nats to say what else there is. */
INK_API void ink_readings(const Closed *fit, const Closed *rounded, double count, double besides, const Few *few,
                          Readings *out) {
    const double *back = fit->back, gaps = GAP * count * fit->gap / fit->ink + besides;
    double rough[SIDES + 1], total[SIDES + 1], told[SIDES + 1], off[SIDES + 1], evenly, none;
    out->scale = sqrt(fabs(back[0] * back[3] - back[1] * back[2]));
    out->narrow = fmin(hypot(back[0], back[2]), hypot(back[1], back[3]));
    out->gap = fit->gap / fit->ink;
    for (int k = 3; k <= SIDES; k++) {
        rough[k] = fit->cost[k] + too_near(fit->residual[k], count, k, few->said);
        double own = said(k);
        if (k == 4 && isfinite(fit->cost[4])) own += fmin(0.5 * square(unlike(fit->vertices[4]) / ALIKE), IRREGULAR);
        total[k] = rough[k] + fit->lacks[k] + own;
    }
    const double least = total[least_of(total, 3, 0)];
    const int most = few->said > 0 ? FEWER : MOST;
    for (int k = FEWEST; k <= most; k++) {
        const double clean = 6 * CORNER + (2 * k - 6) * NEARLY - said(k);
        if (total[k] + clean < least + ALSO) total[k] += fmin(clean + irregular(fit, k), 0);
    }
    for (int k = 3; k <= most; k++) total[k] += few->cornered;
    const double straight = turning(fit, least_of(total, FEWEST, 0), most, few->steps, &evenly);
    for (int k = 3; k <= SIDES; k++) off[k] = straight;
    off[3] = few->said > 0 ? 0 : turning(fit, 3, most, few->steps, &none);
    off[4] = few->said > 0 ? 0 : turning(fit, 4, most, few->steps, &none);
    /* what turns beside the corners speaks against few of them, where there are points enough to see it */
    for (int k = 3; k <= SIDES; k++) told[k] = few->said > 0 ? total[k] : total[k] + off[k];
    const int sides = least_of(told, 3, 0), second = least_of(told, 3, sides);
    read_round(rounded, count, besides + (sides < FEWEST ? 0 : evenly) + few->even, out);
    out->sides = sides;
    out->next = second;
    out->ahead = told[second] - told[sides];
    out->polygon = (Reading){total[sides] + besides + off[sides], 2 * sides * CORNER, rough[sides]};
    out->rectangle = (Reading){INFINITY, BOX, INFINITY};
    if (isfinite(fit->extra)) {
        const double mean_square = fit->residual[4];
        out->rectangle.rough = rough[4] + misfit(mean_square + fit->extra, count) - misfit(mean_square, count);
        out->rectangle.cost = out->rectangle.rough + BOX + fit->lacks[4] + besides + few->cornered + off[4];
    }
    out->any = read_any(fit, count, gaps, besides, out);
}
