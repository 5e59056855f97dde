/* A closed outline's readings: round, or a polygon of 3 .. SIDES sides, fitted to one chain of ink.
 *
 * Both are judged in the ink's normal frame, where its second moments are those of the unit circle: there every ellipse is
 * round, every triangle equilateral and every parallelogram a square, so that a long thin box has as many samples on its
 * short sides as on its long ones, and "how far off" means the same for all. */
#include "fit.h"

#include <math.h>
#include <string.h>

enum { FEWEST = 5, MOST = 7 }; /* sides of a polygon that may be taken for something round, and is none */

typedef struct {
    double mean[2];
    double to[4];   /* normal = to * (pixel - mean), row major */
    double back[4]; /* its inverse */
} Frame;

/* Second moments of the chain taken as a closed curve (the gaps bridged), so that a missing piece moves them little. */
static Frame normal_frame(const double *xy, int n, double least_axis) {
    double w = 0, m[2] = {0, 0};
    Moments t;
    for (int pass = 0; pass < 2; pass++) { /* the mean first: moments about it keep their digits */
        t = (Moments){0};
        for (int i = 0, j = n - 1; i < n; j = i++) {
            double dx = xy[2 * i] - xy[2 * j], dy = xy[2 * i + 1] - xy[2 * j + 1];
            double cx = 0.5 * (xy[2 * i] + xy[2 * j]) - m[0], cy = 0.5 * (xy[2 * i + 1] + xy[2 * j + 1]) - m[1];
            add_segment(&t, length(dx, dy), dx, dy, cx, cy);
        }
        w = t.length > 0 ? t.length : 1;
        if (pass == 0) {
            m[0] = t.x[0] / w;
            m[1] = t.x[1] / w;
        }
    }
    double half = 0.5 * (t.xx[0] - t.xx[2]) / w, mid = 0.5 * (t.xx[0] + t.xx[2]) / w, off = t.xx[1] / w;
    double spread = sqrt(half * half + off * off), angle = 0.5 * atan2(off, half);
    double c = cos(angle), sn = sin(angle);
    double p = sqrt(2 * fmax(mid + spread, 0)), q = sqrt(2 * fmax(mid - spread, 0)); /* radii of the like ellipse */
    p = fmax(p, least_axis);
    q = fmax(q, least_axis);
    Frame f = {{m[0], m[1]}, {c / p, sn / p, -sn / q, c / q}, {c * p, -sn * q, sn * p, c * q}};
    return f;
}

static const double LONG = 1.6; /* outlines longer than this many times their width are measured in two ways */
static const double PI = 3.14159265358979323846;
static const double TREMOR = 0.045;     /* spread of ink about what was meant, in the frame: a share of the radius */
static const double SLOPPY = 0.1;      /* nobody's ink is off by much more than this */
static const double RETRACE = 1.0;      /* nats an observation of ink that was drawn already */
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
static const double REFLEX = 1.2; /* likewise one that turns inward */
static const double TIE = 1e-9; /* nats that no polygon is better by that was found again from another beginning */
static const double INWARD = 4.0; /* nats that a corner which turns inward is rarer */
static const double FLATNESS = 0.096;
static const double THICK = 0.4; /* twice the area over the length: in thinner outlines ink is off by shares of that */
static const double SHORT = 0.12; /* and a side shorter than this share of the outline a rounded corner: */
static const double WALL = 2.7; /* unless its two corners turn by more than this [rad] together: it is a wall's end */
static const double SHORTNESS = 0.0096; /* the spreads say how fast such readings become unlikely */

/* Least squares of x² + y² = a(x² - y²) + b 2xy + cx + dy + e, or of its circles alone (a = b = 0): near the unit circle the
 * algebraic distance is the geometric one to first order. Reweighted (Cauchy's weights), so that a pen's hooks and tails do
 * not pull. Returns the mean squared distance (Sampson's, capped). */
static double fit_round(const double *x, const double *y, const double *factor, double cap2, int circle,
                        double conic[5]) {
    double weight[SAMPLES], sum = 0;
    int first = circle ? 2 : 0;
    for (int i = 0; i < SAMPLES; i++) weight[i] = 1;
    for (int pass = 0; pass < 4; pass++) {
        double a[5][6];
        memset(a, 0, sizeof a);
        for (int i = 0; i < SAMPLES; i++) {
            double row[6] = {x[i] * x[i] - y[i] * y[i], 2 * x[i] * y[i], x[i], y[i], 1, x[i] * x[i] + y[i] * y[i]};
            for (int p = first; p < 5; p++)
                for (int q = p; q < 6; q++) a[p][q] += weight[i] * row[p] * row[q];
        }
        conic[0] = conic[1] = 0;
        for (int p = first; p < 5; p++) { /* symmetric and positive definite: elimination without pivots */
            a[p][p] += 1e-9 * SAMPLES;
            for (int q = p + 1; q < 5; q++) {
                double f = a[p][q] / a[p][p];
                for (int t = q; t < 6; t++) a[q][t] -= f * a[p][t];
            }
        }
        for (int p = 4; p >= first; p--) {
            double v = a[p][5];
            for (int q = p + 1; q < 5; q++) v -= a[p][q] * conic[q];
            conic[p] = v / a[p][p];
        }
        sum = 0;
        for (int i = 0; i < SAMPLES; i++) {
            double u = x[i] * x[i] + y[i] * y[i] - conic[0] * (x[i] * x[i] - y[i] * y[i]) - conic[1] * 2 * x[i] * y[i] -
                       conic[2] * x[i] - conic[3] * y[i] - conic[4];
            double gx = 2 * x[i] * (1 - conic[0]) - 2 * conic[1] * y[i] - conic[2];
            double gy = 2 * y[i] * (1 + conic[0]) - 2 * conic[1] * x[i] - conic[3];
            double d2 = fmin(u * u / fmax(gx * gx + gy * gy, 1e-6), cap2);
            sum += d2 * factor[i];
            weight[i] = 1 / (1 + d2 / (0.06 * 0.06));
        }
    }
    return sum / SAMPLES;
}

/* The corners of a k-gon whose sides are the runs bounded by `cut` (counted from `start`): corner q is where side q begins. */
static void polygon_corners(const Runs *r, int start, const int *cut, int k, const Line *side, double *corners) {
    for (int q = 0; q < k; q++) {
        int b = (start + cut[q]) % r->n, e = (b + r->n - 1) % r->n;
        double end[2] = {r->x[e], r->y[e]}, begin[2] = {r->x[b], r->y[b]};
        corner(&side[(q + k - 1) % k], &side[q], end, begin, corners + 2 * q);
    }
}

/* The sides of the k-gon over the runs bounded by `cut`, and its mean squared distance. Ink that overshoots a corner lies on
 * its side's line: it pays for the length beyond at a quarter. */
static double fit_polygon(const Runs *r, const double *factor, int start, const int *cut, int k, double stiffness,
                          const double stretch[2], double cap2, Line *side, double *oddness, double *perimeter) {
    Line chord[SIDES];
    const double *x = r->x + start, *y = r->y + start; /* the samples are there twice, so that none is beyond the end */
    double drawn[2 * SIDES], share[SIDES];
    for (int q = 0; q < k; q++) {
        chord[q] = side[q] = runs_line(r, (start + cut[q]) % r->n, cut[q + 1] - cut[q], stiffness);
        double off = 2.0 / 3 * side[q].bow; /* the drawn corners are the ends of the bows */
        chord[q].x -= off * side[q].dy;
        chord[q].y += off * side[q].dx;
    }
    polygon_corners(r, start, cut, k, chord, drawn);
    double sum = 0, around = 0, area = 0, bows = 0;
    for (int q = 0; q < k; q++) {
        const double *a = drawn + 2 * q, *b = drawn + 2 * ((q + 1) % k);
        around += length((b[0] - a[0]) / stretch[0], (b[1] - a[1]) / stretch[1]);
        area += a[0] * b[1] - a[1] * b[0];
        share[q] = side[q].bow / fmax(length(b[0] - a[0], b[1] - a[1]), 1e-9);
        bows += share[q] / k;
    }
    double odd = 0.5 * k * bows * bows / (ROUNDED * ROUNDED), bent = 1;
    for (int q = 0; q < k; q++) {
        const double *a = drawn + 2 * q, *b = drawn + 2 * ((q + 1) % k);
        double dx = b[0] - a[0], dy = b[1] - a[1], l = length(dx, dy), bow = side[q].bow;
        double per = l > 0 ? 1 / l : 0, ux = dx * per, uy = dy * per;
        for (int i = cut[q]; i < cut[q + 1]; i++) {
            double px = x[i] - a[0], py = y[i] - a[1];
            double t = px * ux + py * uy, h = l > 0 ? py * ux - px * uy : length(px, py);
            double over = t < 0 ? -t : t > l ? t - l : 0, u = 2 * t * per - 1;
            h += over == 0 && l > 0 ? bow * (1 - u * u) : 0;
            double off2 = h * h + 0.0625 * over * over;
            sum += (off2 < cap2 ? off2 : cap2) * factor[start + i < r->n ? start + i : start + i - r->n];
        }
        const double *c = drawn + 2 * ((q + 2) % k);
        double turn = atan2(dx * (c[1] - b[1]) - dy * (c[0] - b[0]), dx * (c[0] - b[0]) + dy * (c[1] - b[1]));
        int reflex = turn * area < 0;
        double usual = (share[q] - bows) / BOW, most = share[q] / BENT;
        double flat = fmax((reflex ? REFLEX : fmin(FLAT, EVEN * 2 * PI / k)) - fabs(turn), 0) / FLATNESS;
        double brief = fmin(SHORT, 0.7 / k) - length(dx / stretch[0], dy / stretch[1]) / fmax(around, 1e-9);
        if (brief > 0) { /* what rounds a corner turns by as much as a corner does; the end of a wall turns back */
            const double *z = drawn + 2 * ((q + k - 1) % k);
            double fx = a[0] - z[0], fy = a[1] - z[1];
            double back = fabs(atan2(fx * dy - fy * dx, fx * dx + fy * dy) + turn);
            brief *= fmin(fmax((WALL - back) / 0.5, 0), 1) / SHORTNESS;
        } else
            brief = 0;
        bent *= 1 + 0.25 * usual * usual;
        odd += 0.5 * (most * most + flat * flat + brief * brief);
        if (reflex) odd += INWARD;
    }
    *oddness = odd + 2.5 * log(bent);
    *perimeter = around;
    /* The frame makes a straight wall as wide as it is long; one that turns a corner stays thin in it. */
    double thick = fabs(area) / (THICK * fmax(around, 1e-9));
    return sum / (r->n * fmin(thick * thick, 1));
}

/* A writer's precision goes with the size of what is drawn: being off counts by a part's own size, and where the part closes
 * by itself, by its thickness. A little loop is no careless piece of something large. */
static void own_scale(const double *z, const int32_t *part_end, int parts, double ink, double factor[SAMPLES]) {
    for (int q = 0; parts == 1 && q < SAMPLES; q++) factor[q] = 1;
    if (parts == 1) return;
    double done = 0;
    int k = 0;
    for (int p = 0, i = 0; p < parts; i = part_end[p++]) {
        Moments t = {0};
        for (int j = i + 1; j < part_end[p]; j++) {
            double dx = z[2 * j] - z[2 * j - 2], dy = z[2 * j + 1] - z[2 * j - 1];
            double cx = 0.5 * (z[2 * j] + z[2 * j - 2]), cy = 0.5 * (z[2 * j + 1] + z[2 * j - 1]);
            add_segment(&t, length(dx, dy), dx, dy, cx, cy);
        }
        int e = part_end[p] - 1;
        double l = t.length, f = 1;
        if (l > 0) {
            double xx = t.xx[0] / l - t.x[0] * t.x[0] / (l * l), yy = t.xx[2] / l - t.x[1] * t.x[1] / (l * l);
            double xy = t.xx[1] / l - t.x[0] * t.x[1] / (l * l), half = 0.5 * (xx - yy);
            double size2 = 4 * (xx + yy); /* 1 for a side of a square */
            if (length(z[2 * e] - z[2 * i], z[2 * e + 1] - z[2 * i + 1]) < 0.15 * l)
                size2 = 2 * (0.5 * (xx + yy) - sqrt(half * half + xy * xy));
            f = 1 / fmin(fmax(size2, 1e-4), 1);
        }
        done += l;
        for (; k < SAMPLES && (p + 1 == parts || (k + 0.5) * ink / SAMPLES <= done); k++) factor[k] = f;
    }
}

/* Squared distance from point `to` to the ink from point `from` on, in steps of `step`, as far as `reach` goes. */
static double nearest2(const double *z, int to, int from, int end, int step, double reach) {
    double best = INFINITY, done = 0;
    for (int i = from; i != end && done < reach; i += step) {
        const double *a = z + 2 * i, *b = z + 2 * (i + step);
        best = fmin(best, segment_distance2(z[2 * to], z[2 * to + 1], a, b));
        done += length(b[0] - a[0], b[1] - a[1]);
    }
    return best;
}

/* What is missing of the outline between the end of part p and the beginning of the next: nothing where one runs on along
 * the other, little where they cross at a corner. */
static double gap_after(const double *z, const int32_t *part_end, int parts, int p) {
    int begin = p ? part_end[p - 1] : 0, last = part_end[p] - 1;
    int next = p + 1 < parts ? part_end[p] : 0, stop = p + 1 < parts ? part_end[p + 1] : part_end[0];
    double gx = z[2 * next] - z[2 * last], gy = z[2 * next + 1] - z[2 * last + 1], g2 = gx * gx + gy * gy;
    double reach = 2 * sqrt(g2);
    g2 = fmin(g2, nearest2(z, next, last, begin, -1, reach));
    return sqrt(fmin(g2, nearest2(z, last, next, stop - 1, 1, reach)));
}

/* Nats to say the ink's distances from an outline: Student's t for the tremor, unknown but about TREMOR, and a normal prior
 * on how careless people are. n: independent observations, as neighbouring points err together. */
static double misfit(double mean_square, double n) {
    return 0.5 * n * (log1p(mean_square / (TREMOR * TREMOR)) + mean_square / (SLOPPY * SLOPPY));
}

/* Nats to say that ink runs along the outline more often than once. */
static double retraced(double ink, double perimeter, double n) {
    return RETRACE * n * fmax(1 - perimeter / fmax(ink, 1e-9), 0);
}

/* The ellipse, in the frame, and the circle, in pixels: out as conic (5) and cost, centre (2), radius and cost. */
static void fit_rounds(const Runs *r, const Frame *f, const double *factor, double ink, double n, double cap2,
                       double out[10]) {
    double x[SAMPLES], y[SAMPLES], conic[5], scale = sqrt(fabs(f->back[0] * f->back[3] - f->back[1] * f->back[2]));
    out[5] = misfit(fit_round(r->x, r->y, factor, cap2, 0, out), n) + retraced(ink, 2 * PI, n);
    for (int i = 0; i < SAMPLES; i++) {
        x[i] = (f->back[0] * r->x[i] + f->back[1] * r->y[i]) / scale;
        y[i] = (f->back[2] * r->x[i] + f->back[3] * r->y[i]) / scale;
    }
    out[9] = misfit(fit_round(x, y, factor, cap2, 1, conic), n) + retraced(ink, 2 * PI, n);
    out[6] = f->mean[0] + scale * conic[2] / 2;
    out[7] = f->mean[1] + scale * conic[3] / 2;
    out[8] = scale * sqrt(fmax(conic[4] + conic[2] * conic[2] / 4 + conic[3] * conic[3] / 4, 0));
}

/* The best polygons of 3 .. SIDES sides over two beginnings, where they cost less than those that are there.
 * more: nats to say one more side. */
static void best_polygons(const Runs *r, const double *factor, int way, double stiffness, const double stretch[2],
                          double cap2, double ink, double observations, double more, double hopeless, double *residual,
                          double *cost, double *vertices) {
    Line side[SIDES];
    double polygon[2 * SIDES], odd, around;
    int cut[SIDES + 1], start = 0;
    Split split;
    /* A k-gon's runs must begin at a corner. The pen's start may be none: first cut the chain anywhere, then begin again
     * from a corner found that way. */
    for (int round = 0; round < 2; round++) {
        double least = INFINITY;
        int next = start;
        split_begin(&split, r, way, start);
        split_further(&split, 2);
        for (int k = 3; k <= SIDES; k++) {
            split_further(&split, k);
            split_bounds(&split, k, cut);
            double s = fit_polygon(r, factor, start, cut, k, stiffness, stretch, cap2, side, &odd, &around);
            double c = misfit(s, observations) + odd + retraced(ink, around, observations);
            least = fmin(least, c + k * more);
            if (c < cost[k] - TIE) {
                polygon_corners(r, start, cut, k, side, polygon);
                if (ink_is_simple(polygon, k)) {
                    cost[k] = c;
                    residual[k] = s;
                    for (int q = 0; q < 2 * k; q++) vertices[2 * SIDES * k + q] = polygon[q] / stretch[q % 2];
                }
            }
            if (k == 5) next = (start + cut[2]) % SAMPLES;
            if (k >= 5 && (k + 1) * more > least) /* more sides cost more than they could save */
                break;
        }
        if (least > hopeless) return;
        start = next;
    }
}

/* How much of the ink's turning is at the corners of its k-gon: 1 where sides are straight, 0 where it turns evenly. At a
 * corner the ink's directions a few samples before and behind it are compared, so that a rounded one counts as well. */
static double turning(const Runs *r, const double stretch[2], const double *corners, int k) {
    double x[SAMPLES], y[SAMPLES], area = 0, sum = 0, even = 4.0 * k / SAMPLES;
    for (int i = 0; i < SAMPLES; i++) {
        x[i] = r->x[i] / stretch[0];
        y[i] = r->y[i] / stretch[1];
    }
    for (int i = 0, j = SAMPLES - 1; i < SAMPLES; j = i++) area += x[j] * y[i] - x[i] * y[j];
    for (int q = 0; q < k; q++) {
        double best = INFINITY;
        int at = 0;
        for (int i = 0; i < SAMPLES; i++) {
            double dx = x[i] - corners[2 * q], dy = y[i] - corners[2 * q + 1], d2 = dx * dx + dy * dy;
            if (d2 < best) {
                best = d2;
                at = i + SAMPLES;
            }
        }
        int a = (at - 3) % SAMPLES, b = (at - 1) % SAMPLES, c = (at + 1) % SAMPLES, d = (at + 3) % SAMPLES;
        double ux = x[b] - x[a], uy = y[b] - y[a], vx = x[d] - x[c], vy = y[d] - y[c];
        double turn = atan2(ux * vy - uy * vx, ux * vx + uy * vy);
        sum += fmin(fmax(area < 0 ? -turn : turn, 0), 3 * PI / k); /* ink that turns back is no corner */
    }
    return (sum / (2 * PI) - even) / (1 - even);
}

/* Fit the readings of a closed chain of ink.
 *
 * xy: points [pixels], (n, 2), the parts one after another; part_end: where each part ends.
 * least_axis: the frame's radii are at least this long [pixels]: below, the pen's own width is what one sees.
 * observations: how many independent ones the ink is worth.
 * side: nats to say one more side.
 * hopeless: a first split that costs more [nats] is not looked into further.
 * cap: distances count up to this, in the frame.
 * Out: frame: mean (2), to (4), back (4); length: of the ink and of the gaps, in the frame; round: as of fit_rounds;
 * residual[k]: mean squared distance of the best k-gon; cost[k]: nats to say the ink, given it, with its bowed sides, flat
 * corners and short sides; vertices[k][SIDES][2] [pixels]; rectangle: what the nearest adds to residual[4], infinite for none,
 * and its corners (8) [pixels]; turned[k]: how much of the ink's turning is at the corners of the k-gon, for the best of those with
 * FEWEST to MOST sides. */
INK_API void ink_closed(const double *xy, const int32_t *part_end, int parts, double least_axis, double cap,
                        double observations, double side, double hopeless, double *frame, double *length, double *round,
                        double *residual, double *cost, double *vertices, double *rectangle, double *turned,
                        double *scratch) {
    int n = part_end[parts - 1];
    Frame f = normal_frame(xy, n, least_axis);
    memcpy(frame, f.mean, sizeof f.mean);
    memcpy(frame + 2, f.to, sizeof f.to);
    memcpy(frame + 6, f.back, sizeof f.back);
    double *z = scratch; /* (n, 2): the chain in the frame */
    for (int i = 0; i < n; i++) {
        double dx = xy[2 * i] - f.mean[0], dy = xy[2 * i + 1] - f.mean[1];
        z[2 * i] = f.to[0] * dx + f.to[1] * dy;
        z[2 * i + 1] = f.to[2] * dx + f.to[3] * dy;
    }
    length[1] = 0;
    for (int p = 0; p < parts; p++) length[1] += gap_after(z, part_end, parts, p);
    Runs r;
    r.n = SAMPLES;
    length[0] = sample_parts(z, part_end, parts, r.x, r.y, SAMPLES);
    double factor[SAMPLES];
    own_scale(z, part_end, parts, length[0], factor);
    double cap2 = cap * cap;
    fit_rounds(&r, &f, factor, length[0], observations, cap2, round);

    for (int k = 0; k <= SIDES; k++) cost[k] = residual[k] = INFINITY;
    double stretch[2] = {1, 1};
    runs_prepare(&r, 1, 2, STIFFNESS);
    for (int way = 0; way < 2; way++)
        best_polygons(&r, factor, way, STIFFNESS[way], stretch, cap2, length[0], observations, side, hopeless, residual,
                      cost, vertices);
    /* The ends of a long box may be as loose along it as its sides are across, as if it had been drawn square and
     * stretched, or less so: both are tried, as nobody says how a hand errs. */
    double p = hypot(f.back[0], f.back[2]), q = hypot(f.back[1], f.back[3]);
    if (p > LONG * q) {
        stretch[0] = sqrt(sqrt(p / q));
        stretch[1] = 1 / stretch[0];
        for (int i = 0; i < SAMPLES; i++) {
            r.x[i] *= stretch[0];
            r.y[i] *= stretch[1];
        }
        runs_prepare(&r, 1, 1, STIFFNESS);
        best_polygons(&r, factor, 0, STIFFNESS[0], stretch, cap2, length[0], observations, side, hopeless, residual,
                      cost, vertices);
    }
    int best = FEWEST;
    for (int k = 0; k <= SIDES; k++) turned[k] = 0;
    for (int k = FEWEST; k <= MOST; k++)
        if (cost[k] + k * side < cost[best] + best * side) best = k;
    if (isfinite(cost[best])) turned[best] = turning(&r, stretch, vertices + 2 * SIDES * best, best);
    for (int k = 3; k <= SIDES; k++)
        for (int q = 0; q < k && isfinite(cost[k]); q++) {
            double *v = vertices + 2 * (SIDES * k + q), x = v[0], y = v[1];
            v[0] = f.mean[0] + f.back[0] * x + f.back[1] * y;
            v[1] = f.mean[1] + f.back[2] * x + f.back[3] * y;
        }
    rectangle[0] = isfinite(cost[4]) ? nearest_rectangle(vertices + 2 * SIDES * 4, f.to, rectangle + 1) : INFINITY;
}
