/* The best polygons over the samples of a closed outline: where its corners are.
 *
 * A reading's nats have terms that no sum over the sides can hold: of flat corners, of short sides, of bows all to one side. So
 * the splits of least squares only propose polygons, and the cheapest of them is the best. */
#include "outline.h"

#include <math.h>

/* Nobody draws a straight side straight. Sides bow this way and that, by shares of their lengths that are spread as Student's
 * t with four degrees, as writers differ and a hand slips; and nobody's are bent by much more than BENT. All of one
 * outline to the same side they hardly bow: that is no polygon but something round. */
static const double BOW = 0.0178;
static const double BENT = 0.05;
static const double ROUNDED = 0.018; /* usual mean bow, times the root of the number of sides */
/* (tremor / bow)², while splitting: how much rather a side trembles than bows. Both are tried. */
static const double STIFFNESS[2] = {0.02, 0.6};
static const double FLAT = 0.8; /* a corner that turns by less [rad] may be a bow, */
static const double EVEN = 0.66; /* or less than this share of what it would in an even polygon */
static const double REFLEX = 1.2; /* likewise one that turns inward: */
static const double CLEAR = 0.36; /* its cosine: one that turns by more is clear, and no angle need be taken */
static const double TIE = 1e-9; /* nats that no polygon is better by that was found again from another beginning */
static const double INWARD = 4.0; /* nats that a corner which turns inward is rarer */
static const double LACKING = 0.67; /* of a side, at most, may be where the pen was lifted: more of it was not drawn */
static const double FLATNESS = 0.096;
static const double THICK = 0.4; /* twice the area over the length: in thinner outlines ink is off by shares of that */
static const double SHORT = 0.12; /* and a side shorter than this share of the outline a rounded corner: */
static const double WALL = 2.7; /* unless its two corners turn by more than this [rad] together: it is a wall's end */
static const double SHORTNESS = 0.0096; /* the spreads say how fast such readings become unlikely */

enum { BEGINNINGS = 3, WINDOW = 3 }; /* samples to either side of a corner that say how sharp it is */

void polygon_corners(const Polygon *p, double *corners) {
    const Runs *r = p->runs;
    for (int q = 0; q < p->k; q++) {
        int b = (p->start + p->cut[q]) % r->n, e = (b + r->n - 1) % r->n;
        double end[2] = {r->x[e], r->y[e]}, begin[2] = {r->x[b], r->y[b]}, *c = corners + 2 * q;
        corner(&p->side[(q + p->k - 1) % p->k], &p->side[q], end, begin, c);
        c[0] /= p->stretch[0];
        c[1] /= p->stretch[1];
    }
}

static double turn_at(const double *a, const double *b, const double *c) {
    double dx = b[0] - a[0], dy = b[1] - a[1], ex = c[0] - b[0], ey = c[1] - b[1];
    return atan2(dx * ey - dy * ex, dx * ex + dy * ey);
}

/* Nats that it is odd how side bc meets those before and behind it, ab and cd: at a flat corner, or one that turns inward, or
 * as what rounds a corner.
 * area: of the polygon, with its sign.  share: of the outline's length, of this side.  k: how many sides there are. */
static double odd_side(const double *a, const double *b, const double *c, const double *d, double area, double share,
                       int k) {
    double dx = c[0] - b[0], dy = c[1] - b[1], ex = d[0] - c[0], ey = d[1] - c[1];
    double dot = dx * ex + dy * ey, odd = 0;
    int reflex = (dx * ey - dy * ex) * area < 0;
    if (reflex) odd += INWARD;
    if (dot > 0 && dot * dot > CLEAR * CLEAR * (dx * dx + dy * dy) * (ex * ex + ey * ey)) {
        double flat = ((reflex ? REFLEX : fmin(FLAT, EVEN * 2 * PI / k)) - fabs(turn_at(b, c, d))) / FLATNESS;
        if (flat > 0) odd += 0.5 * flat * flat;
    }
    double brief = fmin(SHORT, 0.7 / k) - share;
    if (brief > 0) { /* what rounds a corner turns by as much as a corner does; the end of a wall turns back */
        double back = fabs(turn_at(a, b, c) + turn_at(b, c, d));
        brief *= fmin(fmax((WALL - back) / 0.5, 0), 1) / SHORTNESS;
        odd += 0.5 * brief * brief;
    }
    return odd;
}

/* The polygon's cost, and its mean squared distance. Ink that overshoots a corner lies on its side's line: it pays for the
 * length beyond at a quarter. */
static void judge(const Ink *ink, Polygon *p) {
    const Runs *r = p->runs;
    const double *x = r->x + p->start, *y = r->y + p->start; /* the samples are there twice: none is beyond the end */
    int k = p->k;
    Polygon drawn = *p; /* the drawn corners are the ends of the bows */
    drawn.stretch[0] = drawn.stretch[1] = 1;
    for (int q = 0; q < k; q++) {
        double off = 2.0 / 3 * p->side[q].bow;
        drawn.side[q].x -= off * p->side[q].dy;
        drawn.side[q].y += off * p->side[q].dx;
    }
    double at[2 * SIDES], share[SIDES], length_of[SIDES], sum = 0, around = 0, area = 0, bows = 0;
    polygon_corners(&drawn, at);
    for (int q = 0; q < k; q++) {
        const double *a = at + 2 * q, *b = at + 2 * ((q + 1) % k);
        length_of[q] = length((b[0] - a[0]) / p->stretch[0], (b[1] - a[1]) / p->stretch[1]);
        around += length_of[q];
        area += a[0] * b[1] - a[1] * b[0];
        share[q] = p->side[q].bow / fmax(length(b[0] - a[0], b[1] - a[1]), 1e-9);
        bows += share[q] / k;
    }
    double odd = 0.5 * k * bows * bows / (ROUNDED * ROUNDED), bent = 1, per_around = 1 / fmax(around, 1e-9);
    for (int q = 0; q < k; q++) {
        const double *a = at + 2 * q, *b = at + 2 * ((q + 1) % k);
        double dx = b[0] - a[0], dy = b[1] - a[1], l = length(dx, dy), bow = p->side[q].bow;
        double per = l > 0 ? 1 / l : 0, ux = dx * per, uy = dy * per;
        for (int i = p->cut[q]; i < p->cut[q + 1]; i++) {
            double px = x[i] - a[0], py = y[i] - a[1];
            double t = px * ux + py * uy, h = l > 0 ? py * ux - px * uy : length(px, py);
            double over = t < 0 ? -t : t > l ? t - l : 0, u = 2 * t * per - 1;
            h += over == 0 && l > 0 ? bow * (1 - u * u) : 0;
            double off2 = h * h + 0.0625 * over * over;
            int sample = p->start + i < r->n ? p->start + i : p->start + i - r->n;
            sum += (off2 < ink->cap2 ? off2 : ink->cap2) * ink->factor[sample];
        }
        double lacks = ink->lacks[p->start + p->cut[q + 1] - 1] - ink->lacks[p->start + p->cut[q]];
        if (lacks > LACKING * length_of[q]) odd = INFINITY;
        double usual = (share[q] - bows) / BOW, most = share[q] / BENT;
        bent *= 1 + 0.25 * usual * usual;
        odd += 0.5 * most * most +
               odd_side(at + 2 * ((q + k - 1) % k), a, b, at + 2 * ((q + 2) % k), area, length_of[q] * per_around, k);
    }
    /* The frame makes a straight wall as wide as it is long; one that turns a corner stays thin in it. */
    double thick = fabs(area) * per_around / THICK;
    p->square = sum / (r->n * fmin(thick * thick, 1));
    p->cost = misfit(p->square, ink->observations) + odd + 2.5 * log(bent) + retraced(ink, around);
}

static int is_simple(const Polygon *p) {
    double corners[2 * SIDES];
    polygon_corners(p, corners);
    return ink_is_simple(corners, p->k);
}

/* Take a polygon for the best of its number of sides, if it is. */
static void propose(const Polygon *p, Polygon *found) {
    if (p->cost < found[p->k].cost - TIE && is_simple(p)) found[p->k] = *p;
}

/* Where the ink turns most sharply. */
static int sharpest(const Runs *r) {
    double most = -INFINITY;
    int at = 0;
    for (int i = WINDOW; i < r->n - WINDOW; i++) {
        double ux = r->x[i] - r->x[i - WINDOW], uy = r->y[i] - r->y[i - WINDOW];
        double vx = r->x[i + WINDOW] - r->x[i], vy = r->y[i + WINDOW] - r->y[i];
        double back = -(ux * vx + uy * vy) / sqrt(fmax((ux * ux + uy * uy) * (vx * vx + vy * vy), 1e-300));
        if (back > most) {
            most = back;
            at = i;
        }
    }
    return at;
}

/* The splits of least squares from a few beginnings, at each of which a side must begin: where the ink does, at a corner across
 * from there, and at the sharpest. */
static void split_sides(const Ink *ink, const Runs *r, const double stretch[2], int way, Polygon *found) {
    int opposite = 0;
    Split split;
    Polygon p;
    p.runs = r;
    p.stiffness = STIFFNESS[way];
    p.stretch[0] = stretch[0];
    p.stretch[1] = stretch[1];
    for (int b = 0; b < BEGINNINGS; b++) {
        double least = INFINITY;
        p.start = b == 0 ? 0 : b == 1 ? opposite : sharpest(r);
        split_begin(&split, r, way, p.start);
        split_further(&split, 2);
        for (p.k = 3; p.k <= SIDES; p.k++) {
            split_further(&split, p.k);
            split_bounds(&split, p.k, p.cut);
            for (int q = 0; q < p.k; q++)
                p.side[q] = runs_line(r, (p.start + p.cut[q]) % r->n, p.cut[q + 1] - p.cut[q], p.stiffness);
            judge(ink, &p);
            propose(&p, found);
            least = fmin(least, p.cost + p.k * ink->side);
            if (p.k == 5) opposite = (p.start + p.cut[2]) % r->n;
            if (p.k >= 5 && (p.k + 1) * ink->side > least) /* more sides cost more than they could save */
                break;
        }
        if (isfinite(least) && least > ink->hopeless) return;
    }
}

void best_polygons(const Ink *ink, Runs *square, Runs *longer, double stretch, Polygon found[SIDES + 1]) {
    const double even[2] = {1, 1}, drawn[2] = {stretch, 1 / stretch};
    for (int k = 0; k <= SIDES; k++) found[k].cost = INFINITY;
    runs_prepare(square, 1, 2, STIFFNESS);
    for (int way = 0; way < 2; way++) split_sides(ink, square, even, way, found);
    /* The ends of a long box may be as loose along it as its sides are across, as if it had been drawn square and
     * stretched, or less so: both are tried, as nobody says how a hand errs. */
    if (stretch > 1) {
        longer->n = square->n;
        for (int i = 0; i < square->n; i++) {
            longer->x[i] = square->x[i] * drawn[0];
            longer->y[i] = square->y[i] * drawn[1];
        }
        runs_prepare(longer, 1, 1, STIFFNESS);
        split_sides(ink, longer, drawn, 0, found);
    }
}
