/* Optimal polyline segmentation: a row of samples is split into k runs, each with its own line, so that the sum of
 * squared orthogonal distances is least (Bellman 1961, "On the approximation of curves by line segments using dynamic
 * programming"). Global, so that one bad corner cannot spoil the others as it does with local corner finders. */
#include "fit.h"

#include <math.h>
#include <string.h>

double sample_parts(const double *xy, const int32_t *part_end, int parts, double *x, double *y, int n) {
    double total = 0;
    for (int p = 0, i = 0; p < parts; i = part_end[p++])
        for (int j = i + 1; j < part_end[p]; j++)
            total += length(xy[2 * j] - xy[2 * j - 2], xy[2 * j + 1] - xy[2 * j - 1]);
    double done = 0;
    int k = 0;
    for (int p = 0, i = 0; p < parts && k < n; i = part_end[p++])
        for (int j = i + 1; j < part_end[p] && k < n; j++) {
            double dx = xy[2 * j] - xy[2 * j - 2], dy = xy[2 * j + 1] - xy[2 * j - 1], l = length(dx, dy);
            for (double at; k < n && (at = (k + 0.5) * total / n) <= done + l && l > 0; k++) {
                double t = (at - done) / l;
                x[k] = xy[2 * j - 2] + t * dx;
                y[k] = xy[2 * j - 1] + t * dy;
            }
            done += l;
        }
    int last = 2 * (part_end[parts - 1] - 1);
    for (; k < n; k++) { /* rounding at the very end, or ink without length */
        x[k] = xy[last];
        y[k] = xy[last + 1];
    }
    return total;
}

/* The sum of q(t)² over m samples, q(t) = t² - mean(t²), t evenly from -1 to 1. */
static double bow_squares(int m) {
    double g = m - 1, fourth = m * (m + 1.0) * (3.0 * m * m - 7) / (15 * g * g * g), mean = (m + 1) / (3 * g);
    return fourth - m * mean * mean;
}

INK_WIDE void runs_prepare(Runs *r, int begin, double stiffness) {
    int n = r->n;
    memcpy(r->x + n, r->x, n * sizeof *r->x);
    memcpy(r->y + n, r->y, n * sizeof *r->y);
    r->sx[0] = r->sy[0] = r->sxx[0] = r->sxy[0] = r->syy[0] = 0;
    r->six[0] = r->siy[0] = r->siix[0] = r->siiy[0] = 0;
    for (int i = 0; i < 2 * n; i++) {
        double x = r->x[i], y = r->y[i];
        r->sx[i + 1] = r->sx[i] + x;
        r->sy[i + 1] = r->sy[i] + y;
        r->sxx[i + 1] = r->sxx[i] + x * x;
        r->sxy[i + 1] = r->sxy[i] + x * y;
        r->syy[i + 1] = r->syy[i] + y * y;
        r->six[i + 1] = r->six[i] + i * x;
        r->siy[i + 1] = r->siy[i] + i * y;
        r->siix[i + 1] = r->siix[i] + (double)i * i * x;
        r->siiy[i + 1] = r->siiy[i] + (double)i * i * y;
    }
    double count[SAMPLES + 1], mean2[SAMPLES + 1], squares[SAMPLES + 1], inverse[SAMPLES + 1], per_step[SAMPLES + 1];
    for (int m = 2; m <= n; m++) {
        count[m] = m;
        inverse[m] = 1.0 / m;
        mean2[m] = (m + 1) / (3.0 * (m - 1));
        per_step[m] = 2.0 / (m - 1);
        squares[m] = m > 3 ? bow_squares(m) : INFINITY; /* fewer samples do not show a bow */
    }
    for (int i = 0; i < n; i++) {
        /* Rows of what the runs from i on have in common, so that a compiler takes several runs at a time. */
        double least[SAMPLES + 1], bowed[SAMPLES + 1], per_length[SAMPLES + 1];
        int most_samples = i < begin ? n - i : n - i + begin;
        for (int m = 2; m <= most_samples; m++) {
            int e = i + m;
            double ax = r->sx[e] - r->sx[i], ay = r->sy[e] - r->sy[i];
            double xx = r->sxx[e] - r->sxx[i] - ax * ax * inverse[m];
            double xy = r->sxy[e] - r->sxy[i] - ax * ay * inverse[m];
            double yy = r->syy[e] - r->syy[i] - ay * ay * inverse[m];
            double half = 0.5 * (xx - yy), mid = 0.5 * (xx + yy), spread = sqrt(half * half + xy * xy);
            double most = mid + spread, c = i + 0.5 * (count[m] - 1), k = per_step[m];
            double qx =
                (r->siix[e] - r->siix[i] - 2 * c * (r->six[e] - r->six[i]) + c * c * ax) * k * k - mean2[m] * ax;
            double qy =
                (r->siiy[e] - r->siiy[i] - 2 * c * (r->siy[e] - r->siy[i]) + c * c * ay) * k * k - mean2[m] * ay;
            /* the bow's sum along the normal, squared: the normal's projector is (most - S) / (most - least) */
            double along = most * (qx * qx + qy * qy) - (xx * qx * qx + 2 * xy * qx * qy + yy * qy * qy);
            double under = spread > 0 ? 2 * spread : INFINITY, length2 = 12 * most > 1e-12 ? 12 * most : 1e-12;
            bowed[m] = along / under;
            least[m] = mid - spread > 0 ? mid - spread : 0;
            per_length[m] = count[m] / length2;
        }
        double *cost = r->cost[i];
        cost[0] = cost[1] = 0;
        for (int m = 2; m <= most_samples; m++) {
            double left = least[m] - bowed[m] / (squares[m] + stiffness * per_length[m]);
            cost[m] = left > 0 ? left : 0;
        }
    }
}

/* Orthogonal regression, then the bow b along q(t) = t² - mean(t²), t from -1 to 1 over the run, which is orthogonal to
 * the line. A bow of a few hundredths of the side is usual; as a normal prior of that spread it is a ridge term in the
 * squares: stiffness (b / length)². */
Line runs_line(const Runs *r, int first, int count, double stiffness) {
    int e = first + count;
    double w = 1.0 / count;
    double ax = r->sx[e] - r->sx[first], ay = r->sy[e] - r->sy[first];
    double mx = ax * w, my = ay * w;
    double xx = r->sxx[e] - r->sxx[first] - ax * mx;
    double xy = r->sxy[e] - r->sxy[first] - ax * my;
    double yy = r->syy[e] - r->syy[first] - ay * my;
    double half = 0.5 * (xx - yy), mid = 0.5 * (xx + yy), spread = sqrt(half * half + xy * xy);
    double most = mid + spread, least = mid - spread;
    /* the eigenvector of the larger eigenvalue, by whichever of its two forms keeps more digits */
    double dx = half >= 0 ? half + spread : xy, dy = half >= 0 ? xy : spread - half, l = sqrt(dx * dx + dy * dy);
    if (l > 0) {
        dx /= l;
        dy /= l;
    } else {
        dx = 1;
        dy = 0;
    }
    int z = e - 1;
    if ((r->x[z] - r->x[first]) * dx + (r->y[z] - r->y[first]) * dy < 0) {
        dx = -dx;
        dy = -dy;
    }
    least = least > 0 ? least : 0;
    double length2 = fmax(12 * most * w, 1e-12);
    Line line = {mx, my, dx, dy, 0, least};
    if (count < 4) return line;
    double c = 0.5 * (first + z), k = 0.5 * (z - first); /* t = (i - c) / k */
    double mean2 = (k + 1) / (3 * k);                    /* mean of t² over the run */
    double qx = (r->siix[e] - r->siix[first] - 2 * c * (r->six[e] - r->six[first]) + c * c * ax) / (k * k) - mean2 * ax;
    double qy = (r->siiy[e] - r->siiy[first] - 2 * c * (r->siy[e] - r->siy[first]) + c * c * ay) / (k * k) - mean2 * ay;
    double hq = dx * qy - dy * qx;
    double qq = bow_squares(count);
    line.bow = hq / (qq + stiffness / length2);
    line.cost -= hq * line.bow;
    if (line.cost < 0) line.cost = 0;
    return line;
}

/* What samples i, i + 1, .. of a split, counted from its beginning, cost as one run: by their number. */
static const double *run_cost(const Split *s, int i) {
    int at = s->start + i;
    return s->runs->cost[at < s->n ? at : at - s->n];
}

void split_begin(Split *s, const Runs *r, int start) {
    s->runs = r;
    s->start = start;
    s->n = r->n;
    memcpy(s->best[1], run_cost(s, 0), sizeof s->best[1]);
}

INK_WIDE void split_further(Split *s, int k) {
    double *low = s->best[k];
    for (int j = 0; j <= s->n; j++) low[j] = INFINITY;
    for (int i = 2 * (k - 1); i <= s->n - 2; i++) { /* a run has two samples or more */
        const double before = s->best[k - 1][i], *run = run_cost(s, i);
        double *to = low + i;
        for (int m = 2; m <= s->n - i; m++) {
            double c = before + run[m];
            to[m] = c < to[m] ? c : to[m];
        }
    }
}

/* Where the runs begin is not noted on the way: of the few that are asked for it is found again from what they cost. */
void split_bounds(const Split *s, int k, int cut[SIDES + 1]) {
    cut[k] = s->n;
    for (int q = k; q > 1; q--) {
        int j = cut[q], i = 2 * (q - 1);
        while (i < j - 2 && s->best[q - 1][i] + run_cost(s, i)[j - i] > s->best[q][j]) i++;
        cut[q - 1] = i;
    }
    cut[0] = 0;
}

void corner(const Line *a, const Line *b, const double end[2], const double begin[2], double out[2]) {
    double mx = 0.5 * (end[0] + begin[0]), my = 0.5 * (end[1] + begin[1]);
    double gap = length(end[0] - begin[0], end[1] - begin[1]);
    double sine = a->dx * b->dy - a->dy * b->dx;
    if (fabs(sine) > 0.1) {
        double t = ((b->x - a->x) * b->dy - (b->y - a->y) * b->dx) / sine;
        double x = a->x + t * a->dx, y = a->y + t * a->dy;
        if (length(x - mx, y - my) <= 2.5 * gap) { /* otherwise the lines meet far from the ink */
            out[0] = x;
            out[1] = y;
            return;
        }
    }
    double ta = (mx - a->x) * a->dx + (my - a->y) * a->dy, tb = (mx - b->x) * b->dx + (my - b->y) * b->dy;
    out[0] = 0.5 * (a->x + ta * a->dx + b->x + tb * b->dx);
    out[1] = 0.5 * (a->y + ta * a->dy + b->y + tb * b->dy);
}
