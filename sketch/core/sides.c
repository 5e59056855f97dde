/* The best polygons over the samples of a closed outline: where its corners are.
 *
 * A reading's nats have terms that no sum over the sides can hold: of flat corners, of short sides, of bows all to one side, of
 * what was not drawn. So the splits of least squares only propose polygons; the cheapest is refined, each of its corners moved and
 * left out, so that it is the same wherever the pen began. */
#include "outline.h"

#include <math.h>
#include <string.h>

/* Nobody draws a straight side straight. Sides bow this way and that, by shares of their lengths that are spread as Student's
 * t with four degrees, as writers differ and a hand slips; and nobody's are bent by much more than BENT. All of one
 * outline to the same side they hardly bow: that is no polygon but something round. */
static const double BOW = 0.0178;
static const double BENT = 0.05;
static const double ARC =
    0.13; /* of its length: a side that bows further, as sixty degrees of a circle do, may be meant to, */
static const double ARCED = 10; /* and this is what to say that takes [nats]: as much as to bow so far by chance */
static const double ROUNDED = 0.018; /* usual mean bow, times the root of the number of sides */
/* Between its corners ink runs the way its side does: the mean squared sine of the angle between them is less than SLANT,
 * whatever the hand, or hardly more; of a long outline times the root of how much longer than wide it is, as the frame
 * makes more of how that trembles. On a flight of steps it is 0.3, however near these are to one slope. */
static const double SLANT = 0.08;
static const double SLANTED = 0.12; /* the square of this is usual beyond that */
static const double BESIDE = 0.125; /* of a side, from either corner: there ink turns from one side to the other */
static const double FLAT = 0.8; /* a corner that turns by less [rad] may be a bow, */
static const double EVEN = 0.66; /* or less than this share of what it would in an even polygon */
static const double REFLEX = 1.2; /* likewise one that turns inward */
static const double WIDE = 0.25; /* of the ink: where more is missing, what would fit best after all was not meant */
static const double MENDS = 40; /* nats that moving its corners hardly ever saves of a polygon more */
static const double ROUNDER = 80; /* nats that something round may take less, and polygons are not looked at further */
static const double TIE = 1e-9; /* nats that no polygon is better by that was found again from another beginning */
static const double INWARD = 4.0; /* nats that a corner which turns inward is rarer */
static const double LACKING = 0.67; /* of a side, at most, may be where the pen was lifted: more of it was not drawn */
static const double NO_SIDE = 100; /* nats that it is odd to take it for drawn all the same */
static const double FLATNESS = 0.096;
static const double THICK = 0.4; /* twice the area over the length: in thinner outlines ink is off by shares of that */
static const double SHORT = 0.12; /* and a side shorter than this share of the outline a rounded corner: */
static const double WALL = 2.7; /* unless its two corners turn by more than this [rad] together: it is a wall's end */
static const double SHORTNESS = 0.0096; /* the spreads say how fast such readings become unlikely */

enum { CUP = 4 }; /* sides of what is open on purpose where one was not drawn: of a polygon of more it was forgotten */
enum { BEGINNINGS = 2, WINDOW = 3 }; /* samples to either side of a corner that say how sharp it is */

/* The point of a side's line that is nearest to an end of ink. */
static void foot(const Line *side, const double *end, const double *stretch, double *out) {
    double x = end[0] * stretch[0] - side->x, y = end[1] * stretch[1] - side->y, t = x * side->dx + y * side->dy;
    out[0] = side->x + t * side->dx;
    out[1] = side->y + t * side->dy;
}

void polygon_corners(const Polygon *p, double *corners) {
    const Runs *r = p->runs;
    for (int q = 0; q < p->k; q++) {
        int b = (p->start + p->cut[q]) % r->n, e = (b + r->n - 1) % r->n, before = (q + p->k - 1) % p->k;
        double end[2] = {r->x[e], r->y[e]}, begin[2] = {r->x[b], r->y[b]}, *c = corners + 2 * q;
        if (q == p->bridge)
            foot(&p->side[before], p->lift->end, p->stretch, c);
        else if (before == p->bridge)
            foot(&p->side[q], p->lift->begin, p->stretch, c);
        else
            corner(&p->side[before], &p->side[q], end, begin, c);
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
    /* As cos x > 1 - x²/2, a corner of a lesser cosine turns by more, and its angle need not be taken. */
    double flattest = reflex ? REFLEX : fmin(FLAT, EVEN * 2 * PI / k), clear = 1 - flattest * flattest / 2;
    if (dot > 0 && dot * dot > clear * clear * (dx * dx + dy * dy) * (ex * ex + ey * ey)) {
        double flat = (flattest - fabs(turn_at(b, c, d))) / FLATNESS;
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

/* Nats for how much of a polygon's outline nobody drew: along its sides, from where the ink ends to where it goes on. Notes where
 * going straight would save most of it.
 * at: corners, stretched as the polygon is.  length_of: its sides, as they are. */
static double undrawn(const Ink *ink, Polygon *p, const double *at, const double *length_of) {
    int n = p->runs->n, k = p->k;
    double sum = 0;
    p->saving = 0;
    for (const Lift *lift = ink->lifts; lift < ink->lifts + ink->lift_count; lift++) {
        int next = (lift->next - p->start + n) % n, last = (next + n - 1) % n, side[2] = {0, 0};
        double along[2];
        while (p->cut[side[0] + 1] <= last) side[0]++;
        while (p->cut[side[1] + 1] <= next) side[1]++;
        for (int e = 0; e < 2; e++) {
            const double *a = at + 2 * side[e], *b = at + 2 * ((side[e] + 1) % k), *z = e ? lift->begin : lift->end;
            double dx = b[0] - a[0], dy = b[1] - a[1], l2 = dx * dx + dy * dy;
            double t = l2 > 0 ? ((z[0] * p->stretch[0] - a[0]) * dx + (z[1] * p->stretch[1] - a[1]) * dy) / l2 : 0;
            along[e] = fmin(fmax(t, 0), 1) * length_of[side[e]];
        }
        double way = fmax(along[1] - along[0], 0);
        if (side[0] != side[1]) {
            way = length_of[side[0]] - along[0] + along[1];
            if ((side[0] + 1) % k != side[1]) way += length_of[p->bridge];
        } else if (way > LACKING * length_of[side[0]])
            sum += NO_SIDE;
        sum += ink->undrawn * fmax(way, lift->gap);
        if (p->bridge < 0 && (side[0] + 1) % k == side[1]) {
            if (way - lift->gap > p->saving) {
                p->saving = way - lift->gap;
                p->lift = lift;
            }
        }
    }
    return sum;
}

/* Which way the ink runs from each sample to the next. */
static void find_headings(Runs *r, const Ink *ink) {
    const int n = r->n;
    for (int i = 0; i < n; i++) {
        const double dx = r->x[(i + 1) % n] - r->x[i], dy = r->y[(i + 1) % n] - r->y[i], l = length(dx, dy);
        r->along_x[i] = l > 0 ? dx / l : 0;
        r->along_y[i] = l > 0 ? dy / l : 0;
    }
    for (const Lift *lift = ink->lifts; lift < ink->lifts + ink->lift_count; lift++) {
        const int last = (lift->next + n - 1) % n;
        r->along_x[last] = r->along_y[last] = 0;
    }
    memcpy(r->along_x + n, r->along_x, n * sizeof *r->along_x);
    memcpy(r->along_y + n, r->along_y, n * sizeof *r->along_y);
}

/* A polygon's side: how far it bows, as a share of its length, and the squared sines between its ink and it, summed up. */
typedef struct {
    double share, slanted;
} Bent;

/* Nats for how a polygon's sides bow, and for how their ink runs; those that bow by more than `arc` are arcs. */
static double crooked(const Ink *ink, const Polygon *p, const Bent *side, double arc) {
    int straight = 0;
    double mean = 0, slanted = 0, odd = 0, bent = 1;
    for (int q = 0; q < p->k; q++)
        if (fabs(side[q].share) <= arc) {
            mean += side[q].share;
            straight++;
        }
    mean /= straight ? straight : 1;
    for (int q = 0; q < p->k; q++) {
        if (fabs(side[q].share) > arc) {
            odd += ARCED;
            continue;
        }
        const double usual = (side[q].share - mean) / BOW, most = side[q].share / BENT;
        bent *= 1 + 0.25 * usual * usual;
        odd += 0.5 * most * most;
        slanted += side[q].slanted;
    }
    odd += 0.5 * straight * mean * mean / (ROUNDED * ROUNDED) + 2.5 * log(bent);
    slanted = slanted / p->runs->n - SLANT * sqrt(ink->longer);
    return odd + 0.5 * ink->observations * fmax(slanted, 0) / (SLANTED * SLANTED);
}

/* The polygon's cost, and its mean squared distance. Ink that overshoots a corner lies on its side's line: it pays for the
 * length beyond at a quarter. */
INK_WIDE static void judge(const Ink *ink, Polygon *p) {
    const Runs *r = p->runs;
    /* the samples are there twice: none is beyond the end */
    const double *x = r->x + p->start, *y = r->y + p->start;
    const double *along_x = r->along_x + p->start, *along_y = r->along_y + p->start;
    const double *factor = ink->factor + p->start, cap2 = ink->cap2;
    int k = p->k;
    Polygon drawn = *p; /* the drawn corners are the ends of the bows */
    drawn.stretch[0] = drawn.stretch[1] = 1;
    for (int q = 0; q < k; q++) {
        double off = 2.0 / 3 * p->side[q].bow;
        drawn.side[q].x -= off * p->side[q].dy;
        drawn.side[q].y += off * p->side[q].dx;
    }
    double at[2 * SIDES], length_of[SIDES], stretched[SIDES], off[SAMPLES], slant[SAMPLES];
    double sum = 0, around = 0, area = 0, most = 0, odd = 0;
    Bent side[SIDES];
    const int even = p->stretch[0] == 1 && p->stretch[1] == 1;
    polygon_corners(&drawn, at);
    for (int q = 0; q < k; q++) {
        const double *a = at + 2 * q, *b = at + 2 * ((q + 1) % k);
        const double l = stretched[q] = length(b[0] - a[0], b[1] - a[1]);
        length_of[q] = even ? l : length((b[0] - a[0]) / p->stretch[0], (b[1] - a[1]) / p->stretch[1]);
        around += length_of[q];
        area += a[0] * b[1] - a[1] * b[0];
        side[q].share = p->side[q].bow / (l > 1e-9 ? l : 1e-9);
        most = fmax(most, fabs(side[q].share));
    }
    const double per_around = 1 / fmax(around, 1e-9);
    for (int q = 0; q < k; q++) {
        const double *a = at + 2 * q, *b = at + 2 * ((q + 1) % k);
        double dx = b[0] - a[0], dy = b[1] - a[1], l = stretched[q], bow = p->side[q].bow;
        double per = l > 0 ? 1 / l : 0, ux = dx * per, uy = dy * per;
        for (int i = p->cut[q]; i < p->cut[q + 1]; i++) { /* without branches: a compiler takes several at a time */
            double px = x[i] - a[0], py = y[i] - a[1];
            double t = px * ux + py * uy, h = py * ux - px * uy, back = -t, beyond = t - l, u = 2 * t * per - 1;
            double over = beyond > 0 ? beyond : 0, bowed = h + bow * (1 - u * u);
            over = back > 0 ? back : over;
            h = over > 0 ? h : bowed;
            double off2 = h * h + 0.0625 * over * over;
            off2 = l > 0 ? off2 : px * px + py * py;
            off[i] = (off2 < cap2 ? off2 : cap2) * factor[i];
            double sine = along_x[i] * uy - along_y[i] * ux;
            slant[i] = t > BESIDE * l && t < (1 - BESIDE) * l ? sine * sine : 0;
        }
        side[q].slanted = 0;
        for (int i = p->cut[q]; i < p->cut[q + 1]; i++) side[q].slanted += slant[i];
        odd += odd_side(at + 2 * ((q + k - 1) % k), a, b, at + 2 * ((q + 2) % k), area, length_of[q] * per_around, k);
    }
    for (int i = 0; i < r->n; i++) sum += off[i];
    /* The frame makes a straight wall as wide as it is long; one that turns a corner stays thin in it. */
    double thick = fabs(area) * per_around / THICK;
    p->square = sum / (r->n * fmin(thick * thick, 1));
    p->undrawn = undrawn(ink, p, at, length_of);
    odd += misfit(p->square, ink->observations) + retraced(ink, around) + p->undrawn;
    p->cost = odd + crooked(ink, p, side, INFINITY);
    p->arced = most > ARC ? odd + crooked(ink, p, side, ARC) : INFINITY;
}

static int is_simple(const Polygon *p) {
    double corners[2 * SIDES];
    polygon_corners(p, corners);
    return ink_is_simple(corners, p->k);
}

/* The cheapest polygons of each number of sides: those that are no outline, as their sides cross, may lead to one that is.
 * And the cheapest outline that has arcs. */
typedef struct {
    Polygon *simple, any[SIDES + 1], arched;
} Found;

/* Take a polygon for the best of its number of sides, if it is. */
static void take(const Ink *ink, const Polygon *p, Found *found) {
    const double more = (p->k - found->arched.k) * ink->side;
    if (p->arced + more < found->arched.arced - TIE && is_simple(p)) found->arched = *p;
    if (p->cost < found->any[p->k].cost - TIE) found->any[p->k] = *p;
    if (p->cost < found->simple[p->k].cost - TIE && is_simple(p)) found->simple[p->k] = *p;
}

/* The polygon with one more side, straight from where the ink ends to where it goes on. */
static void put_bridge(Polygon *p) {
    int n = p->runs->n, at = (p->lift->next - p->start + n) % n, q = 1;
    if (at == 0) at = n;
    while (p->cut[q] < at) q++;
    for (int i = p->k; i > q; i--) {
        p->cut[i + 1] = p->cut[i];
        p->side[i] = p->side[i - 1];
    }
    p->k++;
    p->cut[q + 1] = p->cut[q];
    p->bridge = q;
    p->side[q] = (Line){0, 0, 1, 0, 0, 0};
}

/* Judge a polygon, and take it; likewise with a side that nobody drew, where that may be cheaper. */
static void propose(const Ink *ink, Polygon *p, Found *found) {
    judge(ink, p);
    take(ink, p, found);
    if (p->bridge < 0 && p->k >= CUP && p->k < SIDES && p->saving * ink->undrawn > ink->side) {
        Polygon bridged = *p;
        put_bridge(&bridged);
        judge(ink, &bridged);
        take(ink, &bridged, found);
    }
}

/* Fit a side that was drawn again. */
static void lay(Polygon *p, int q) {
    if (q == p->bridge) return;
    p->side[q] = runs_line(p->runs, (p->start + p->cut[q]) % p->runs->n, p->cut[q + 1] - p->cut[q], STIFFNESS);
}

/* Move a corner by some samples. Returns whether all sides still have some. */
static int move(Polygon *p, int q, int by) {
    int before = (q + p->k - 1) % p->k;
    if (p->bridge >= 0 && (q == p->bridge || before == p->bridge)) return 0;
    if (q == 0) {
        p->start = (p->start + by + p->runs->n) % p->runs->n;
        for (int i = 1; i < p->k; i++) p->cut[i] -= by;
    } else
        p->cut[q] += by;
    if (p->cut[q + 1] - p->cut[q] < 2 || p->cut[before + 1] - p->cut[before] < 2) return 0;
    lay(p, q);
    lay(p, before);
    return 1;
}

/* Leave a corner out. Returns whether it can be. */
static int leave_out(Polygon *p, int q) {
    int k = p->k - 1, before = (q + k) % p->k;
    if (p->bridge >= 0 && (q == p->bridge || before == p->bridge || k <= CUP)) return 0;
    int by = q ? 0 : p->cut[1];
    p->k = k;
    p->start = (p->start + by) % p->runs->n;
    for (int i = 0; i < k; i++) {
        int from = i < q ? i : i + 1;
        p->cut[i] = p->cut[from] - by;
        p->side[i] = p->side[from];
    }
    p->cut[k] = p->runs->n;
    if (p->bridge > q || (p->bridge >= 0 && q == 0)) p->bridge--;
    lay(p, (q + k - 1) % k);
    return 1;
}

/* Nats to say the ink, given a polygon, or if its sides that bow far were meant to. */
static double nats(const Polygon *p, int arcs) { return arcs ? p->arced : p->cost; }

/* Move corners, each by a sample at a time, as long as that costs less. Where one came from is not looked at again, nor the
 * corner itself before another one has moved. */
static void refine(const Ink *ink, Polygon *p, int arcs) {
    for (int q = 0, idle = 0; idle < p->k; q = (q + 1) % p->k) {
        int moved = 0;
        for (int by = -1; by <= 1 && !moved; by += 2)
            for (Polygon t = *p; move(&t, q, by); t = *p) {
                judge(ink, &t);
                if (!(nats(&t, arcs) < nats(p, arcs) - TIE)) break;
                *p = t;
                moved = 1;
            }
        idle = moved ? 1 : idle + 1;
    }
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

/* The splits of least squares from two beginnings, at each of which a side must begin: where the ink does, and at its sharpest
 * corner. */
static void split_sides(const Ink *ink, Runs *r, const double stretch[2], Found *found) {
    const int sharp = sharpest(r);
    find_headings(r, ink);
    runs_prepare(r, sharp, STIFFNESS);
    Split split;
    Polygon p;
    p.runs = r;
    p.bridge = -1;
    p.stretch[0] = stretch[0];
    p.stretch[1] = stretch[1];
    for (int b = 0; b < BEGINNINGS; b++) {
        double least = INFINITY;
        p.start = b == 0 ? 0 : sharp;
        split_begin(&split, r, p.start);
        split_further(&split, 2);
        for (p.k = 3; p.k <= SIDES; p.k++) {
            split_further(&split, p.k);
            split_bounds(&split, p.k, p.cut);
            for (int q = 0; q < p.k; q++)
                p.side[q] = runs_line(r, (p.start + p.cut[q]) % r->n, p.cut[q + 1] - p.cut[q], STIFFNESS);
            propose(ink, &p, found);
            least = fmin(least, p.cost + p.k * ink->side);
            if (p.k >= 5 && (p.k + 1) * ink->side > least) /* more sides cost more than they could save */
                break;
        }
        if (isfinite(least) && least > ink->hopeless) return;
    }
}

/* Refine the cheapest polygon, or one of more sides that may be cheaper then, and what is left of it without one of its corners as
 * long as that is cheaper. */
static void refine_best(const Ink *ink, Found *found) {
    const Polygon *any = found->any;
    int best = 3;
    for (int k = 4; k <= SIDES; k++)
        if (any[k].cost + k * ink->side < any[best].cost + best * ink->side) best = k;
    if (any[best].cost + best * ink->side > ink->round + ROUNDER || ink->gaps > WIDE * ink->length) return;
    for (int k = SIDES; k > best; k--)
        if (any[k].cost + (k - 1) * ink->side < any[best].cost + best * ink->side) best = k;
    Polygon fewer = any[best];
    refine(ink, &fewer, 0);
    take(ink, &fewer, found);
    for (int k = best - 1; k >= 3; k--) {
        fewer.cost = INFINITY;
        for (int q = 0; q <= k; q++) {
            Polygon p = any[k + 1];
            if (!leave_out(&p, q)) continue;
            judge(ink, &p);
            if (p.cost < fewer.cost) fewer = p;
        }
        if (fewer.cost > any[k + 1].cost + ink->side + MENDS) return;
        refine(ink, &fewer, 0);
        take(ink, &fewer, found);
        if (any[k].cost > any[k + 1].cost + ink->side) return;
    }
}

/* Likewise the outline that has arcs, the corners of which are elsewhere. */
static void refine_arched(const Ink *ink, Found *found) {
    Polygon p = found->arched;
    double least = ink->round;
    for (int k = 3; k <= SIDES; k++) least = fmin(least, found->simple[k].cost + k * ink->side);
    if (!(p.arced + p.k * ink->side < least + MENDS)) return; /* of something round much more could be saved */
    refine(ink, &p, 1);
    take(ink, &p, found);
}

void best_polygons(const Ink *ink, Runs *square, Runs *longer, double stretch, Polygon best[SIDES + 1], double *arced) {
    const double even[2] = {1, 1}, drawn[2] = {stretch, 1 / stretch};
    Found found = {.simple = best, .arched.arced = INFINITY};
    for (int k = 0; k <= SIDES; k++) {
        best[k].cost = found.any[k].cost = INFINITY;
        best[k].undrawn = found.any[k].k = 0;
    }
    split_sides(ink, square, even, &found);
    /* The ends of a long box may be as loose along it as its sides are across, as if it had been drawn square and
     * stretched, or less so: both are tried, as nobody says how a hand errs. */
    if (stretch > 1) {
        longer->n = square->n;
        for (int i = 0; i < square->n; i++) {
            longer->x[i] = square->x[i] * drawn[0];
            longer->y[i] = square->y[i] * drawn[1];
        }
        split_sides(ink, longer, drawn, &found);
    }
    refine_best(ink, &found);
    refine_arched(ink, &found);
    *arced = found.arched.arced + found.arched.k * ink->side;
}
