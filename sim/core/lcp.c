/* Lemke's complementary pivoting (Cottle, Pang and Stone, The Linear Complementarity Problem, section 4.4), with the
 * lexicographic rule against cycling: contact problems are degenerate as a rule (a box stands on two corners). */
#include "lcp.h"

#include <math.h>
#include <string.h>

#define TINY 1e-11
#define LEAST_SOFTNESS 1e-8

typedef struct Tableau {
    int32_t n, width; /* columns: w (n), z (n), the artificial variable, the right side */
    double *t;
    int32_t *basis; /* the variable that each row stands for */
} Tableau;

static double *row(const Tableau *tab, int32_t i) { return tab->t + (size_t)i * (size_t)tab->width; }

static void pivot(Tableau *tab, int32_t r, int32_t column) {
    double *p = row(tab, r), scale = 1 / p[column];
    for (int32_t j = 0; j < tab->width; j++) p[j] *= scale;
    p[column] = 1;
    for (int32_t i = 0; i < tab->n; i++) {
        double *q = row(tab, i), k = q[column];
        if (i == r || k == 0) continue;
        for (int32_t j = 0; j < tab->width; j++) q[j] -= k * p[j];
        q[column] = 0;
    }
    tab->basis[r] = column;
}

/* Whether row i comes before row k in the order of (right side, inverse of the basis) / entry of the column. */
static bool comes_before(const Tableau *tab, int32_t i, int32_t k, int32_t column) {
    const double *p = row(tab, i), *q = row(tab, k);
    int32_t last = tab->width - 1;
    for (int32_t j = -1; j < tab->n; j++) {
        int32_t c = j < 0 ? last : j;
        double a = p[c] / p[column], b = q[c] / q[column];
        if (fabs(a - b) > TINY * (fabs(a) + fabs(b) + 1e-3)) return a < b;
    }
    return false;
}

/* The row that limits the entering column; the artificial variable leaves as soon as it can. -1: a ray. */
static int32_t leaving_row(const Tableau *tab, int32_t column) {
    int32_t best = -1, artificial = 2 * tab->n, last = tab->width - 1;
    for (int32_t i = 0; i < tab->n; i++) {
        if (row(tab, i)[column] <= TINY) continue;
        if (best < 0 || comes_before(tab, i, best, column)) best = i;
    }
    if (best < 0) return -1;
    double least = row(tab, best)[last] / row(tab, best)[column];
    for (int32_t i = 0; i < tab->n; i++)
        if (tab->basis[i] == artificial && row(tab, i)[column] > TINY &&
            row(tab, i)[last] / row(tab, i)[column] <= least + TINY * (fabs(least) + 1e-3))
            return i;
    return best;
}

/* The tableau of w = (M + soften I) z + q - soften near. */
static void fill(Tableau *tab, const double *M, const double *q, double soften, const double *near) {
    int32_t n = tab->n;
    memset(tab->t, 0, lcp_work(n) * sizeof *tab->t);
    for (int32_t i = 0; i < n; i++) {
        double *p = row(tab, i);
        p[i] = 1;
        for (int32_t j = 0; j < n; j++) p[n + j] = -M[(size_t)i * (size_t)n + (size_t)j];
        p[n + i] -= soften;
        p[2 * n] = -1;
        p[2 * n + 1] = q[i] - soften * near[i];
        tab->basis[i] = i;
    }
}

/* Follow Lemke's path from the tableau to its end; false where that is a ray, or too far. */
static bool follow(Tableau *tab, double *z) {
    int32_t n = tab->n, entering = 2 * n, r = -1;
    for (int32_t i = 0; i < n; i++)
        if (row(tab, i)[2 * n + 1] < 0 && (r < 0 || row(tab, i)[2 * n + 1] < row(tab, r)[2 * n + 1])) r = i;
    for (int32_t k = 0; r >= 0 && k < 20 * n + 40; k++) {
        int32_t leaving = tab->basis[r];
        pivot(tab, r, entering);
        if (leaving == 2 * n) break;
        entering = leaving < n ? leaving + n : leaving - n; /* the complement of what left */
        r = leaving_row(tab, entering);
        if (r < 0) return false;
    }
    for (int32_t i = 0; i < n; i++) z[i] = 0;
    for (int32_t i = 0; i < n; i++) {
        if (tab->basis[i] == 2 * n) return false;
        if (tab->basis[i] >= n) z[tab->basis[i] - n] = fmax(row(tab, i)[2 * n + 1], 0);
    }
    return true;
}

/* Whether z solves the problem to `allowed`, of its size. */
static bool is_solution(int32_t n, const double *M, const double *q, const double *z, double allowed) {
    double size = 0, most = 0;
    for (int32_t i = 0; i < n; i++) size = fmax(size, fabs(q[i])), most = fmax(most, z[i]);
    for (int32_t i = 0; i < n; i++) {
        double w = q[i];
        for (int32_t j = 0; j < n; j++) w += M[(size_t)i * (size_t)n + (size_t)j] * z[j];
        if (w < -allowed * size || (w > allowed * size && z[i] > allowed * most)) return false;
    }
    return true;
}

/* A little softness gives a size to pivots that are rounding alone, and shares what may be shared; solving again about the
 * solution found takes its effect on the rest away (proximal point method). */
static bool solve_softened(Tableau *tab, const double *M, const double *q, double soften, double *z) {
    bool found = true;
    for (int32_t i = 0; i < tab->n; i++) z[i] = 0;
    for (int pass = 0; pass < 2 && found; pass++) {
        fill(tab, M, q, soften, z);
        found = follow(tab, z);
    }
    return found && is_solution(tab->n, M, q, z, 10 * soften);
}

bool lcp_solve(int32_t n, const double *M, const double *q, double *z, double *work, int32_t *basis) {
    bool trivial = true;
    for (int32_t i = 0; i < n; i++) {
        z[i] = 0;
        trivial = trivial && q[i] >= 0;
    }
    if (trivial) return true;
    Tableau tab = {n, 2 * n + 2, work, basis};
    fill(&tab, M, q, 0, z);
    if (follow(&tab, z) && is_solution(n, M, q, z, 1e-9)) return true;
    for (double soften = LEAST_SOFTNESS; soften < 1e-5; soften *= 10) /* redundant contacts */
        if (solve_softened(&tab, M, q, soften, z)) return true;
    return false;
}

bool lcp_share(int32_t n, const double *M, const double *q, double *z, double *work, int32_t *basis) {
    Tableau tab = {n, 2 * n + 2, work, basis};
    return solve_softened(&tab, M, q, LEAST_SOFTNESS, z);
}
