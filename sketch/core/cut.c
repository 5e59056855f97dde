/* Where a pen went on from one thing to the next without being lifted: a stroke as a row of loops, of straight lines and
 * of the short ways between them. Only a proposal; whether the parts say the ink better is for the fits to say. */
#include "fit.h"

#include <math.h>

enum {
    PARTS = 8, /* the most things that one stroke is cut into */
    LEAST = 5, /* samples of the least thing */
    MOST = 4 * SAMPLES / 5, /* and of the greatest: what a stroke has beyond is a hook */
    CLOSURES = 96 /* the most places looked at where the pen comes back to its own way */
};

static const double PI = 3.14159265358979323846;
static const double GAP = 0.12; /* of a loop's length: how far its ends may be apart */
static const double THICK = 0.12; /* least area of a loop, as a share of the circle's of its length */
static const double STRAIGHT = 0.96; /* of a line's length: the distance of its ends */
static const double WAY = 0.2; /* of the stroke: the longest way from one thing to the next */
static const double HOOK = 0.06;
static const double TANGLED = 2.0; /* what a loop costs more, in parts, that comes back to itself on its way */

typedef struct {
    double x[SAMPLES], y[SAMPLES], area[SAMPLES + 1]; /* area: twice what the way so far sweeps about the origin */
    double step;
    int count, from[CLOSURES], to[CLOSURES]; /* where the way comes back to itself */
} Way;

static double apart(const Way *w, int i, int j) { return length(w->x[j] - w->x[i], w->y[j] - w->y[i]); }

/* What samples i .. j cost as a loop, in parts; infinite if they are none. */
static double loop_cost(const Way *w, int i, int j) {
    double length = (j - i) * w->step, gap = apart(w, i, j);
    if (j - i < LEAST || gap > GAP * length) return INFINITY;
    double twice = w->area[j] - w->area[i] + w->x[j] * w->y[i] - w->y[j] * w->x[i], around = length + gap;
    if (2 * PI * fabs(twice) < THICK * around * around) return INFINITY;
    double cost = 1 + 4 * gap / length;
    for (int c = 0; c < w->count; c++) {
        int inner = w->to[c] - w->from[c];
        if (w->from[c] >= i && w->to[c] <= j && 4 * inner > j - i && 4 * inner < 3 * (j - i)) return cost + TANGLED;
    }
    return cost;
}

static double line_cost(const Way *w, int i, int j) {
    double length = (j - i) * w->step;
    if (apart(w, i, j) < STRAIGHT * length) return INFINITY;
    return j - i >= SAMPLES / 6 ? 1.2 : INFINITY;
}

static double way_cost(const Way *w, int i, int j) {
    double share = (double)(j - i) / SAMPLES;
    int inside = i > 0 && j < SAMPLES - 1; /* before the first thing and after the last are hooks alone */
    if (share > (inside ? WAY : HOOK) || apart(w, i, j) < 0.9 * (j - i) * w->step) return INFINITY;
    return 0.4 + 4 * share;
}

/* xy: a stroke's points, (n, 2). Out: cuts, as shares of its length, PARTS at most, with 0 and 1; kinds: of the parts between
 * them, 0 for a loop, 1 for a straight line, 2 for a way. Returns how many parts there are; 1 where the stroke is better
 * left whole. */
INK_API int32_t ink_cut(const double *xy, int32_t n, double *cuts, int32_t *kinds) {
    Way w;
    int32_t end[1] = {n};
    double total = sample_parts(xy, end, 1, w.x, w.y, SAMPLES);
    double best[PARTS + 1][SAMPLES];
    int from[PARTS + 1][SAMPLES], kind[PARTS + 1][SAMPLES];
    w.step = total / SAMPLES;
    w.count = 0;
    if (total <= 0) return 1;
    w.area[0] = 0;
    for (int i = 1; i < SAMPLES; i++) w.area[i] = w.area[i - 1] + w.x[i - 1] * w.y[i] - w.y[i - 1] * w.x[i];
    int loops = 0;
    for (int i = 0; i + LEAST < SAMPLES; i++)
        for (int j = i + LEAST; j < SAMPLES && j - i <= MOST; j++) {
            double dx = w.x[j] - w.x[i], dy = w.y[j] - w.y[i], d2 = dx * dx + dy * dy;
            double gap = GAP * (j - i) * w.step;
            loops += d2 < gap * gap;
            if (d2 < 2.25 * w.step * w.step && w.count < CLOSURES) {
                w.from[w.count] = i;
                w.to[w.count++] = j;
            }
        }
    if (loops == 0) return 1; /* as for most strokes */
    for (int k = 0; k <= PARTS; k++)
        for (int j = 0; j < SAMPLES; j++) best[k][j] = INFINITY;
    best[0][0] = 0;
    double cost[SAMPLES][SAMPLES][3];
    for (int i = 0; i + 1 < SAMPLES; i++)
        for (int j = i + 1; j < SAMPLES; j++) {
            cost[i][j][0] = loop_cost(&w, i, j);
            cost[i][j][1] = line_cost(&w, i, j);
            cost[i][j][2] = way_cost(&w, i, j);
        }
    for (int k = 1; k <= PARTS; k++)
        for (int i = 0; i + 1 < SAMPLES; i++) {
            if (!isfinite(best[k - 1][i])) continue;
            int kinds_left = k > 1 && kind[k - 1][i] == 2 ? 2 : 3; /* no way after a way */
            for (int j = i + 1; j < SAMPLES; j++)
                for (int t = 0; t < kinds_left; t++)
                    if (best[k - 1][i] + cost[i][j][t] < best[k][j]) {
                        best[k][j] = best[k - 1][i] + cost[i][j][t];
                        from[k][j] = i;
                        kind[k][j] = t;
                    }
        }
    int parts = 1, last = SAMPLES - 1, found = 0;
    for (int k = 2; k <= PARTS; k++)
        if (best[k][last] < best[parts][last]) parts = k;
    if (!isfinite(best[parts][last])) return 1;
    cuts[0] = 0;
    cuts[parts] = 1;
    for (int k = parts, j = last; k > 0; j = from[k--][j]) {
        /* a line between two things is the pen's way from one to the other */
        kinds[k - 1] = kind[k][j] == 1 && k > 1 && k < parts ? 2 : kind[k][j];
        found += kind[k][j] == 0;
        if (k < parts) cuts[k] = (j + 0.5) / SAMPLES;
    }
    return found ? parts : 1;
}
