/* A closed outline's readings: round, or a polygon of 3 .. SIDES sides, fitted to one chain of ink.
 *
 * Both are judged in the ink's normal frame, where its second moments are those of the unit circle: there every ellipse is
 * round, every triangle equilateral and every parallelogram a square, so that a long thin box has as many samples on its
 * short sides as on its long ones, and "how far off" means the same for all. */
#include "outline.h"
#include "closed.h"

#include <math.h>
#include <string.h>

static const double CAP = 0.3; /* distances count up to this share of the radius: hooks and flourishes */
enum { MOST = 8 }; /* sides of a polygon whose corners are told from something round */

/* The frame: of second moments of the chain taken as a closed curve (the gaps bridged), so that a missing piece moves them
 * little. */
static void normal_frame(const double *xy, int n, double least_axis, Closed *out) {
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
    memcpy(out->mean, m, sizeof m);
    memcpy(out->to, (double[]){c / p, sn / p, -sn / q, c / q}, sizeof out->to);
    memcpy(out->back, (double[]){c * p, -sn * q, sn * p, c * q}, sizeof out->back);
}

static const double LONG = 1.6; /* outlines longer than this many times their width are measured in two ways */
/* Least squares of x² + y² = a(x² - y²) + b 2xy + cx + dy + e, or of its circles alone (a = b = 0): near the unit circle the
 * algebraic distance is the geometric one to first order. Reweighted (Cauchy's weights), so that a pen's hooks and tails do
 * not pull. Returns the mean squared distance (Sampson's, capped). */
INK_WIDE static double fit_round(const double *x, const double *y, const double *factor, double cap2, int circle,
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

/* The conic, in the frame, and the circle, in pixels, each with the nats to say the ink, given it. */
static void fit_rounds(const Runs *r, const Ink *ink, Closed *out) {
    const double *back = out->back, scale = sqrt(fabs(back[0] * back[3] - back[1] * back[2]));
    double x[SAMPLES], y[SAMPLES], conic[5], again = retraced(ink, 2 * PI);
    double square = fit_round(r->x, r->y, ink->factor, ink->cap2, 0, out->conic);
    out->conic_cost = misfit(square, ink->observations) + again;
    for (int i = 0; i < SAMPLES; i++) {
        x[i] = (back[0] * r->x[i] + back[1] * r->y[i]) / scale;
        y[i] = (back[2] * r->x[i] + back[3] * r->y[i]) / scale;
    }
    out->circle_cost = misfit(fit_round(x, y, ink->factor, ink->cap2, 1, conic), ink->observations) + again;
    out->circle[0] = out->mean[0] + scale * conic[2] / 2;
    out->circle[1] = out->mean[1] + scale * conic[3] / 2;
    out->circle[2] = scale * sqrt(fmax(conic[4] + conic[2] * conic[2] / 4 + conic[3] * conic[3] / 4, 0));
}

/* Twice the area that the ink goes around, with its sign. */
static double enclosed(const Runs *r) {
    double area = 0;
    for (int i = 0, j = SAMPLES - 1; i < SAMPLES; j = i++) area += r->x[j] * r->y[i] - r->x[i] * r->y[j];
    return area;
}

/* How much of the ink's turning is at the corners of its k-gon: 1 where sides are straight, 0 where it turns evenly. At a
 * corner the ink's directions a few samples before and behind it are compared, so that a rounded one counts as well. */
static double turning(const Runs *r, const double *corners, int k) {
    const double *x = r->x, *y = r->y;
    double area = enclosed(r), sum = 0, even = 4.0 * k / SAMPLES;
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

static const double BLUNT = 0.12; /* usual radius by which a hand rounds corners, in the frame */
static const double ALIKE = 2; /* independent corners: one hand rounds all of an outline alike */
static const double POINT = 0.015; /* how far ink is off a sharp corner all the same */
static const double BETWEEN = 0.3; /* of a step: how far from a corner the points before and behind it usually are */
static const double FURTHEST =
    0.1; /* of the radius: so far, usually, ink in several strokes and its polygon are apart at most */
static const double BLUNTER =
    0.12; /* of the radius: how much further off the ink than the next one corner usually is */
static const double MIDST = 0.75; /* of a side: its middle part, */
enum { FEW = 8 }; /* where it has as many samples */
static const double LEVEL = 0.1; /* sine of the angle between sides that meet nowhere */
static const double UNDRAWN = 2; /* times a gap: a corner that is as near to both of its ends was not drawn */

/* Squared distance of a place from the closed line through the samples, which are there twice over. */
INK_WIDE static double nearest_ink2(const Runs *r, double px, double py) {
    double off2[SAMPLES], best = INFINITY;
    for (int i = 0; i < SAMPLES; i++) { /* without branches: a compiler takes several at a time */
        double ax = r->x[i], ay = r->y[i], dx = r->x[i + 1] - ax, dy = r->y[i + 1] - ay, l2 = dx * dx + dy * dy;
        double t = ((px - ax) * dx + (py - ay) * dy) / (l2 > 0 ? l2 : 1);
        t = t < 0 ? 0 : t > 1 ? 1 : t;
        double ex = ax + t * dx - px, ey = ay + t * dy - py;
        off2[i] = ex * ex + ey * ey;
    }
    for (int i = 0; i < SAMPLES; i++) best = off2[i] < best ? off2[i] : best;
    return best;
}

/* Whether a corner was drawn, and is not as near to both sides of a gap. */
static int is_drawn(const Ink *ink, const double *c) {
    for (const Lift *l = ink->lifts; l < ink->lifts + ink->lift_count; l++)
        if (fmax(length(c[0] - l->end[0], c[1] - l->end[1]), length(c[0] - l->begin[0], c[1] - l->begin[1])) <
            UNDRAWN * l->gap)
            return 0;
    return 1;
}

/* Nats to say how far ink stays off the corners of its k-gon, beyond what is usual: an even one's corner that is rounded by a
 * radius r is r (sec(pi / k) - 1) off. Student's t with four degrees, as writers differ; of something round a polygon's corners
 * are far off.
 * square: mean squared distance from its sides.  step: between the ink's points. */
static double blunted(const Runs *r, const Ink *ink, const double *corners, int k, double square, double step) {
    double round = BLUNT * (1 / cos(PI / k) - 1), between = BETWEEN * step * sin(PI / k);
    double seen2 = round * round + between * between, usual2 = seen2 + POINT * POINT + square, off2 = 0;
    for (const double *c = corners; c < corners + 2 * k; c += 2) {
        off2 += (is_drawn(ink, c) ? nearest_ink2(r, c[0], c[1]) / usual2 : 1) / k;
    }
    return round * round / seen2 * ALIKE * 2.5 * log((1 + 0.25 * off2) / 1.25); /* few points say little of corners */
}

/* Nats for one corner of a triangle that is far blunter than the others: it may be a short side. Each is where the middle parts
 * of its sides meet, going on as these bow, whatever the ink does at corners; of real triangles it falls off exponentially
 * how much further off than the next one the bluntest is. Hands that round one corner of a box more than the others are no
 * rarity: of more sides it says nothing. */
static double uneven(const Runs *r, const Ink *ink, const Polygon *p) {
    double first = 0, second = 0;
    Line side[3];
    if (p->k > 3 || p->bridge >= 0) return 0;
    for (int q = 0; q < p->k; q++) {
        const int all = p->cut[q + 1] - p->cut[q], n = all < FEW ? all : (int)(MIDST * all);
        side[q] = runs_line(p->runs, (p->start + p->cut[q] + (all - n) / 2) % r->n, n, STIFFNESS);
        const double u = (double)all / n, on = (u * u - 1.0 / 3) * side[q].bow;
        side[q].x -= on * side[q].dy;
        side[q].y += on * side[q].dx;
    }
    for (int q = 0; q < p->k; q++) {
        const Line *a = side + (q + p->k - 1) % p->k, *b = side + q;
        const double sine = a->dx * b->dy - a->dy * b->dx;
        if (fabs(sine) < LEVEL) continue;
        const double t = ((b->x - a->x) * b->dy - (b->y - a->y) * b->dx) / sine;
        const double c[2] = {(a->x + t * a->dx) / p->stretch[0], (a->y + t * a->dy) / p->stretch[1]};
        if (!is_drawn(ink, c)) continue;
        const double off = sqrt(nearest_ink2(r, c[0], c[1]));
        second = fmax(second, fmin(first, off));
        first = fmax(first, off);
    }
    return fmax((first - second) / BLUNTER - 1, 0);
}

/* Nats to say how far the ink and its k-gon are apart where they are furthest: hooks are short, but the stem of a letter runs
 * on far beyond what is closed of it, however well the rest goes along sides, and sides that meet far beyond the ink were
 * round. */
INK_WIDE static double astray(const Runs *r, const Ink *ink, const double *corners, int k) {
    double off2[SAMPLES], most = 0;
    for (const double *c = corners; c < corners + 2 * k; c += 2)
        if (is_drawn(ink, c)) most = fmax(most, nearest_ink2(r, c[0], c[1]));
    for (int i = 0; i < SAMPLES; i++) off2[i] = INFINITY;
    for (int q = 0; q < k; q++) {
        const double *a = corners + 2 * q, *b = corners + 2 * ((q + 1) % k);
        double dx = b[0] - a[0], dy = b[1] - a[1], l2 = dx * dx + dy * dy, per = l2 > 0 ? 1 / l2 : 0;
        for (int i = 0; i < SAMPLES; i++) { /* without branches, as above */
            double x = r->x[i] - a[0], y = r->y[i] - a[1], t = (x * dx + y * dy) * per;
            t = t < 0 ? 0 : t > 1 ? 1 : t;
            double ex = x - t * dx, ey = y - t * dy, d2 = ex * ex + ey * ey;
            off2[i] = d2 < off2[i] ? d2 : off2[i];
        }
    }
    for (int i = 0; i < SAMPLES; i++) most = off2[i] > most ? off2[i] : most;
    return 0.5 * most / (FURTHEST * FURTHEST);
}

/* Where the pen is lifted, behind each part. Returns what is missing of the outline at least. */
static double find_lifts(const double *z, const int32_t *part_end, int parts, double ink, Lift *lifts) {
    double done = 0, gaps = 0;
    for (int p = 0, i = 0; p < parts; i = part_end[p++]) {
        int last = part_end[p] - 1, next = p + 1 < parts ? part_end[p] : 0;
        for (int j = i + 1; j <= last; j++) done += length(z[2 * j] - z[2 * j - 2], z[2 * j + 1] - z[2 * j - 1]);
        double behind = done * SAMPLES / fmax(ink, 1e-300) - 0.5; /* sample k is (k + 0.5) / SAMPLES of the ink on */
        lifts[p].next = next ? (int)fmin(ceil(behind), SAMPLES - 1) : 0;
        memcpy(lifts[p].end, z + 2 * last, sizeof lifts[p].end);
        memcpy(lifts[p].begin, z + 2 * next, sizeof lifts[p].begin);
        gaps += lifts[p].gap = gap_after(z, part_end, parts, p);
    }
    return gaps;
}

/* The ellipse that a conic in the frame is, if it may have been meant. */
static void as_ellipse(Closed *out) {
    double a = out->conic[0], b = out->conic[1], c = out->conic[2], d = out->conic[3], e = out->conic[4];
    out->is_ellipse = 0;
    memset(out->middle, 0, sizeof out->middle);
    memset(out->axes, 0, sizeof out->axes);
    if (a * a + b * b > 0.5) return; /* in this frame whatever is round is nearly a circle */
    /* about its centre (u, v) the conic is zᵀ M z = level, M = [[1 - a, -b], [-b, 1 + a]] */
    double det = 1 - a * a - b * b;
    double u = (c * (1 + a) + d * b) / (2 * det), v = (c * b + d * (1 - a)) / (2 * det);
    double level = e + (c * u + d * v) / 2;
    if (!(level > 0.2 && level < 5)) return;
    /* half axes: z = sqrt(level) M^-1/2 (unit vector), then to pixels; M's inverse's root by Cayley and Hamilton */
    const double *back = out->back, root = sqrt(det), f = sqrt(level / (det * (2 + 2 * root)));
    const double m00 = f * (1 + a + root), m01 = f * b, m11 = f * (1 - a + root);
    out->is_ellipse = 1;
    out->middle[0] = out->mean[0] + (back[0] * u + back[1] * v);
    out->middle[1] = out->mean[1] + (back[2] * u + back[3] * v);
    out->axes[0] = back[0] * m00 + back[1] * m01;
    out->axes[1] = back[0] * m01 + back[1] * m11;
    out->axes[2] = back[2] * m00 + back[3] * m01;
    out->axes[3] = back[2] * m01 + back[3] * m11;
}

/* How much of something round is missing along it, from where the ink ends to where it goes on, in the frame; there an ellipse is
 * nearly a circle. Not less than between these; ends that run on beyond each other leave nothing out. */
static double missing_around(const Runs *r, const Ink *ink, const Closed *fit) {
    if (!fit->is_ellipse) return fit->gap;
    const double *to = fit->to, *v = fit->axes, x = fit->middle[0] - fit->mean[0], y = fit->middle[1] - fit->mean[1];
    const double u = to[0] * x + to[1] * y, w = to[2] * x + to[3] * y;
    const double radius = sqrt(fabs((v[0] * v[3] - v[1] * v[2]) * (to[0] * to[3] - to[1] * to[2])));
    const double way = enclosed(r) < 0 ? -1 : 1;
    double sum = 0;
    for (const Lift *l = ink->lifts; l < ink->lifts + ink->lift_count; l++) {
        const double begin = atan2(l->begin[1] - w, l->begin[0] - u), end = atan2(l->end[1] - w, l->end[0] - u);
        const double angle = way * (begin - end), on = angle - 2 * PI * floor(angle / (2 * PI));
        sum += fmax(on < PI ? on * radius : 0, l->gap);
    }
    return sum;
}

/* Fit the readings of a closed chain of ink.
 *
 * xy: points [pixels], (n, 2), the parts one after another; part_end: where each part ends.
 * least_axis: the frame's radii are at least this long [pixels]: below, the pen's own width is what one sees.
 * observations: how many independent ones the ink is worth.
 * hopeless: a first split that costs more [nats] is not looked into further.
 * scratch: for the ink in its frame and a Lift for each part. */
INK_API void ink_closed(const double *xy, const int32_t *part_end, int parts, double least_axis, double observations,
                        double hopeless, Closed *out, double *scratch) {
    int n = part_end[parts - 1];
    normal_frame(xy, n, least_axis, out);
    const double *mean = out->mean, *to = out->to, *back = out->back;
    double *z = scratch; /* (n, 2): the chain in the frame */
    for (int i = 0; i < n; i++) {
        double dx = xy[2 * i] - mean[0], dy = xy[2 * i + 1] - mean[1];
        z[2 * i] = to[0] * dx + to[1] * dy;
        z[2 * i + 1] = to[2] * dx + to[3] * dy;
    }
    Runs r, longer;
    r.n = SAMPLES;
    out->ink = sample_parts(z, part_end, parts, r.x, r.y, SAMPLES);
    Lift *lifts = (Lift *)(scratch + 2 * n);
    out->gap = find_lifts(z, part_end, parts, out->ink, lifts);
    double factor[2 * SAMPLES];
    own_scale(z, part_end, parts, out->ink, factor);
    memcpy(factor + SAMPLES, factor, SAMPLES * sizeof *factor);
    Ink ink = {.factor = factor,
               .cap2 = CAP * CAP,
               .length = out->ink,
               .observations = observations,
               .side = 2 * CORNER,
               .hopeless = hopeless,
               .lifts = lifts,
               .lift_count = parts,
               .gaps = out->gap,
               .undrawn = GAP * observations / fmax(out->ink, 1e-9)};
    fit_rounds(&r, &ink, out);
    as_ellipse(out);
    ink.round = fmin(out->conic_cost, out->circle_cost);
    out->missing = missing_around(&r, &ink, out);

    Polygon found[SIDES + 1];
    ink.longer = hypot(back[0], back[2]) / hypot(back[1], back[3]);
    best_polygons(&ink, &r, &longer, ink.longer > LONG ? sqrt(sqrt(ink.longer)) : 1, found, &out->arced);
    for (int k = 0; k <= SIDES; k++) {
        double *v = out->vertices[k], cost = found[k].cost - found[k].undrawn;
        out->cost[k] = cost;
        out->lacks[k] = found[k].undrawn;
        out->residual[k] = isfinite(cost) ? found[k].square : INFINITY;
        out->turned[k] = 0;
        if (!isfinite(cost)) continue;
        polygon_corners(found + k, v);
        if (parts > 1)
            out->cost[k] += astray(&r, &ink, v, k); /* one that runs on in one stroke is read without its ends */
        if (k <= MOST) {
            out->cost[k] += blunted(&r, &ink, v, k, found[k].square, out->ink / n) + uneven(&r, &ink, found + k);
            out->turned[k] = turning(&r, v, k);
        }
        for (double *c = v; c < v + 2 * k; c += 2) {
            double x = c[0], y = c[1];
            c[0] = mean[0] + back[0] * x + back[1] * y;
            c[1] = mean[1] + back[2] * x + back[3] * y;
        }
    }
    out->extra = isfinite(out->cost[4]) ? nearest_rectangle(out->vertices[4], to, out->rectangle) : INFINITY;
}
