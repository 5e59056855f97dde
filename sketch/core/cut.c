/* Where a pen went on from one thing to the next without being lifted: a stroke as a row of loops, of straight lines and
 * of the short ways between them. Only a proposal; whether the parts say the ink better is for the fits to say. */
#include "fit.h"

#include <math.h>

enum {
    PARTS = 8, /* the most things that one stroke is cut into */
    LEAST = 5, /* samples of the least thing */
    MOST = 4 * SAMPLES / 5, /* and of the greatest: what a stroke has beyond is a hook */
    LEAST_LINE = SAMPLES / 6, /* samples of the shortest straight line that is a thing */
    CLOSURES = 96 /* the most places looked at where the pen comes back to its own way */
};

enum { LOOP = 0, STRAIGHT_LINE = 1, BETWEEN = 2, KINDS = 3 }; /* of parts */

static const double PI = 3.14159265358979323846;
static const double GAP = 0.12; /* of a loop's length: how far its ends may be apart */
static const double THICK = 0.12; /* least area of a loop, as a share of the circle's of its length */
static const double STRAIGHT = 0.96; /* of a line's length: the distance of its ends */
static const double WAY = 0.2; /* of the stroke: the longest way from one thing to the next */
static const double HOOK = 0.06; /* of the stroke: the longest way before the first thing, and after the last */
static const double DIRECT = 0.9; /* of a way's length: the distance of its ends, at least */
static const double BACK = 1.5; /* steps: as near as the pen comes where it comes back to its own way */
/* Costs, in loops that close. */
static const double OPEN = 4.0; /* of a loop's gap, as a share of its length */
static const double TANGLED = 2.0; /* of a loop that comes back to itself on its way */
static const double LINE = 1.2; /* of a straight line */
static const double ON = 0.4; /* of a way from one thing to the next, however short */
static const double LONGER = 4.0; /* of such a way's length, as a share of the stroke */

typedef struct {
    double x[SAMPLES], y[SAMPLES], area[SAMPLES + 1]; /* area: twice what the way so far sweeps about the origin */
    double step;
    int count, from[CLOSURES], to[CLOSURES]; /* where the way comes back to itself */
} Way;

static double apart(const Way *w, int i, int j) { return length(w->x[j] - w->x[i], w->y[j] - w->y[i]); }

/* Whether the pen comes back to itself in a quarter to three quarters of samples i .. j. */
static int is_tangled(const Way *w, int i, int j) {
    for (int c = 0; c < w->count; c++) {
        int inner = w->to[c] - w->from[c];
        if (w->from[c] >= i && w->to[c] <= j && 4 * inner > j - i && 4 * inner < 3 * (j - i)) return 1;
    }
    return 0;
}

/* What samples i .. j cost as a loop; infinite if they are none. */
static double loop_cost(const Way *w, int i, int j) {
    double length = (j - i) * w->step, gap = apart(w, i, j);
    if (j - i < LEAST || gap > GAP * length) return INFINITY;
    double twice = w->area[j] - w->area[i] + w->x[j] * w->y[i] - w->y[j] * w->x[i], around = length + gap;
    if (2 * PI * fabs(twice) < THICK * around * around) return INFINITY;
    double cost = 1 + OPEN * gap / length;
    return is_tangled(w, i, j) ? cost + TANGLED : cost;
}

static double line_cost(const Way *w, int i, int j) {
    double length = (j - i) * w->step;
    if (apart(w, i, j) < STRAIGHT * length) return INFINITY;
    return j - i >= LEAST_LINE ? LINE : INFINITY;
}

static double way_cost(const Way *w, int i, int j) {
    double share = (double)(j - i) / SAMPLES;
    int inside = i > 0 && j < SAMPLES - 1; /* before the first thing and after the last are hooks alone */
    if (share > (inside ? WAY : HOOK) || apart(w, i, j) < DIRECT * (j - i) * w->step) return INFINITY;
    return ON + LONGER * share;
}

/* Where a way comes back to itself, noted in it; returns whether it has a loop at all. */
static int find_closures(Way *w) {
    int loops = 0;
    w->count = 0;
    for (int i = 0; i + LEAST < SAMPLES; i++)
        for (int j = i + LEAST; j < SAMPLES && j - i <= MOST; j++) {
            double dx = w->x[j] - w->x[i], dy = w->y[j] - w->y[i], d2 = dx * dx + dy * dy;
            double gap = GAP * (j - i) * w->step;
            loops += d2 < gap * gap;
            if (d2 < BACK * BACK * w->step * w->step && w->count < CLOSURES) {
                w->from[w->count] = i;
                w->to[w->count++] = j;
            }
        }
    return loops > 0;
}

typedef struct {
    double cost[PARTS + 1][SAMPLES]; /* of the cheapest row of so many parts up to a sample */
    int from[PARTS + 1][SAMPLES], kind[PARTS + 1][SAMPLES]; /* of its last part: the first sample, and what it is */
} Rows;

/* The cheapest rows of parts up to every sample, by dynamic programming. */
static void find_rows(const Way *w, Rows *rows) {
    double cost[SAMPLES][SAMPLES][KINDS];
    for (int i = 0; i + 1 < SAMPLES; i++)
        for (int j = i + 1; j < SAMPLES; j++) {
            cost[i][j][LOOP] = loop_cost(w, i, j);
            cost[i][j][STRAIGHT_LINE] = line_cost(w, i, j);
            cost[i][j][BETWEEN] = way_cost(w, i, j);
        }
    for (int k = 0; k <= PARTS; k++)
        for (int j = 0; j < SAMPLES; j++) rows->cost[k][j] = INFINITY;
    rows->cost[0][0] = 0;
    for (int k = 1; k <= PARTS; k++)
        for (int i = 0; i + 1 < SAMPLES; i++) {
            double before = rows->cost[k - 1][i];
            if (!isfinite(before)) continue;
            int kinds = k > 1 && rows->kind[k - 1][i] == BETWEEN ? BETWEEN : KINDS; /* no way after a way */
            for (int j = i + 1; j < SAMPLES; j++)
                for (int t = 0; t < kinds; t++)
                    if (before + cost[i][j][t] < rows->cost[k][j]) {
                        rows->cost[k][j] = before + cost[i][j][t];
                        rows->from[k][j] = i;
                        rows->kind[k][j] = t;
                    }
        }
}

/* xy: a stroke's points, (n, 2). Out: cuts, as shares of its length, PARTS at most, with 0 and 1; kinds: of the parts between
 * them. Returns how many parts there are; 1 where the stroke is better left whole. */
static int32_t cut(const double *xy, int32_t n, double *cuts, int32_t *kinds) {
    Way w;
    Rows rows;
    if (n < 2) return 1;
    int32_t end[1] = {n};
    double total = sample_parts(xy, end, 1, w.x, w.y, SAMPLES);
    w.step = total / SAMPLES;
    if (total <= 0) return 1;
    w.area[0] = 0;
    for (int i = 1; i < SAMPLES; i++) w.area[i] = w.area[i - 1] + w.x[i - 1] * w.y[i] - w.y[i - 1] * w.x[i];
    if (!find_closures(&w)) return 1; /* as most strokes have none */
    find_rows(&w, &rows);
    int parts = 1, last = SAMPLES - 1, found = 0;
    for (int k = 2; k <= PARTS; k++)
        if (rows.cost[k][last] < rows.cost[parts][last]) parts = k;
    if (!isfinite(rows.cost[parts][last])) return 1;
    cuts[0] = 0;
    cuts[parts] = 1;
    for (int k = parts, j = last; k > 0; j = rows.from[k--][j]) {
        int kind = rows.kind[k][j];
        /* a line between two things is the pen's way from one to the other */
        kinds[k - 1] = kind == STRAIGHT_LINE && k > 1 && k < parts ? BETWEEN : kind;
        found += kind == LOOP;
        if (k < parts) cuts[k] = (j + 0.5) / SAMPLES;
    }
    return found ? parts : 1;
}

/* Likewise of `count` strokes; ends: where the points of each end. Out: for each cuts (PARTS + 1), kinds (PARTS), and how many
 * parts there are. */
INK_API void ink_cuts(const double *xy, const int32_t *ends, int32_t count, double *cuts, int32_t *kinds,
                      int32_t *parts) {
    for (int s = 0, first = 0; s < count; first = ends[s++])
        parts[s] = cut(xy + 2 * first, ends[s] - first, cuts + (PARTS + 1) * s, kinds + PARTS * s);
}
