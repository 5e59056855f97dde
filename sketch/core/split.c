/* Optimal polyline segmentation: a row of samples is split into k runs, each with its own line, so that the sum of
 * squared orthogonal distances is least (Bellman 1961, "On the approximation of curves by line segments using dynamic
 * programming"). Global, so that one bad corner cannot spoil the others as it does with local corner finders. */
#include "fit.h"

#include <math.h>
#include <string.h>

double segment_distance2(double px, double py, const double a[2], const double b[2])
{
    double dx = b[0] - a[0], dy = b[1] - a[1], l2 = dx * dx + dy * dy;
    double t = l2 > 0 ? ((px - a[0]) * dx + (py - a[1]) * dy) / l2 : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    double ex = a[0] + t * dx - px, ey = a[1] + t * dy - py;
    return ex * ex + ey * ey;
}

double sample_parts(const double *xy, const int32_t *part_end, int parts, double *x, double *y, int n)
{
    double total = 0;
    for (int p = 0, i = 0; p < parts; i = part_end[p++])
        for (int j = i + 1; j < part_end[p]; j++)
            total += hypot(xy[2 * j] - xy[2 * j - 2], xy[2 * j + 1] - xy[2 * j - 1]);
    double done = 0;
    int k = 0;
    for (int p = 0, i = 0; p < parts && k < n; i = part_end[p++])
        for (int j = i + 1; j < part_end[p] && k < n; j++) {
            double dx = xy[2 * j] - xy[2 * j - 2], dy = xy[2 * j + 1] - xy[2 * j - 1], l = hypot(dx, dy);
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

/* Scatter of samples first .. first+count-1 about their mean: mean in m, (xx, xy, yy) in s. */
static void scatter(const Runs *r, int first, int count, double m[2], double s[3])
{
    int e = first + count;
    double w = 1.0 / count;
    double ax = r->sx[e] - r->sx[first], ay = r->sy[e] - r->sy[first];
    m[0] = ax * w;
    m[1] = ay * w;
    s[0] = r->sxx[e] - r->sxx[first] - ax * m[0];
    s[1] = r->sxy[e] - r->sxy[first] - ax * m[1];
    s[2] = r->syy[e] - r->syy[first] - ay * m[1];
}

void runs_prepare(Runs *r)
{
    int n = r->n;
    memcpy(r->x + n, r->x, n * sizeof *r->x);
    memcpy(r->y + n, r->y, n * sizeof *r->y);
    r->sx[0] = r->sy[0] = r->sxx[0] = r->sxy[0] = r->syy[0] = 0;
    for (int i = 0; i < 2 * n; i++) {
        r->sx[i + 1] = r->sx[i] + r->x[i];
        r->sy[i + 1] = r->sy[i] + r->y[i];
        r->sxx[i + 1] = r->sxx[i] + r->x[i] * r->x[i];
        r->sxy[i + 1] = r->sxy[i] + r->x[i] * r->y[i];
        r->syy[i + 1] = r->syy[i] + r->y[i] * r->y[i];
    }
    for (int i = 0; i < n; i++) {
        r->cost[i][0] = r->cost[i][1] = 0;
        for (int m = 2; m <= n; m++) {
            double c[2], s[3];
            scatter(r, i, m, c, s);
            double half = 0.5 * (s[0] - s[2]);
            double least = 0.5 * (s[0] + s[2]) - sqrt(half * half + s[1] * s[1]); /* smaller eigenvalue */
            r->cost[i][m] = least > 0 ? least : 0;
        }
    }
}

Line runs_line(const Runs *r, int first, int count)
{
    double m[2], s[3];
    scatter(r, first, count, m, s);
    double angle = 0.5 * atan2(2 * s[1], s[0] - s[2]);
    Line line = {m[0], m[1], cos(angle), sin(angle)};
    double ahead = (r->x[first + count - 1] - r->x[first]) * line.dx + (r->y[first + count - 1] - r->y[first]) * line.dy;
    if (ahead < 0) {
        line.dx = -line.dx;
        line.dy = -line.dy;
    }
    return line;
}

void runs_split(const Runs *r, int start, int kmax, double total[SIDES + 1], int cut[SIDES + 1][SIDES + 1])
{
    int n = r->n;
    double best[SIDES + 1][SAMPLES + 1];
    int16_t from[SIDES + 1][SAMPLES + 1];
    for (int j = 0; j <= n; j++) {
        best[1][j] = r->cost[start % n][j];
        from[1][j] = 0;
    }
    for (int k = 2; k <= kmax; k++)
        for (int j = 0; j <= n; j++) {
            double least = INFINITY;
            int at = 0;
            for (int i = 2 * (k - 1); i <= j - 2; i++) { /* a run has two samples or more */
                double c = best[k - 1][i] + r->cost[(start + i) % n][j - i];
                if (c < least) {
                    least = c;
                    at = i;
                }
            }
            best[k][j] = least;
            from[k][j] = (int16_t)at;
        }
    for (int k = 1; k <= kmax; k++) {
        total[k] = best[k][n];
        cut[k][k] = n;
        for (int q = k, j = n; q > 0; q--) {
            j = from[q][j];
            cut[k][q - 1] = j;
        }
    }
}

void corner(const Line *a, const Line *b, const double end[2], const double begin[2], double out[2])
{
    double mx = 0.5 * (end[0] + begin[0]), my = 0.5 * (end[1] + begin[1]);
    double gap = hypot(end[0] - begin[0], end[1] - begin[1]);
    double sine = a->dx * b->dy - a->dy * b->dx;
    if (fabs(sine) > 0.1) {
        double t = ((b->x - a->x) * b->dy - (b->y - a->y) * b->dx) / sine;
        double x = a->x + t * a->dx, y = a->y + t * a->dy;
        if (hypot(x - mx, y - my) <= 2.5 * gap) { /* otherwise the lines meet far from the ink */
            out[0] = x;
            out[1] = y;
            return;
        }
    }
    double ta = (mx - a->x) * a->dx + (my - a->y) * a->dy, tb = (mx - b->x) * b->dx + (my - b->y) * b->dy;
    out[0] = 0.5 * (a->x + ta * a->dx + b->x + tb * b->dx);
    out[1] = 0.5 * (a->y + ta * a->dy + b->y + tb * b->dy);
}
