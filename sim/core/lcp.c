/* Lemke's complementary pivoting (Cottle, Pang and Stone, The Linear Complementarity Problem, section 4.4), with the
 * lexicographic rule against cycling: contact problems are degenerate as a rule (a box stands on two corners). */
#include "lcp.h"

#include <math.h>
#include <string.h>

#define TINY 1e-11

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

static void fill(Tableau *tab, const double *M, const double *q) {
    int32_t n = tab->n;
    memset(tab->t, 0, lcp_work(n) * sizeof *tab->t);
    for (int32_t i = 0; i < n; i++) {
        double *p = row(tab, i);
        p[i] = 1;
        for (int32_t j = 0; j < n; j++) p[n + j] = -M[(size_t)i * (size_t)n + (size_t)j];
        p[2 * n] = -1;
        p[2 * n + 1] = q[i];
        tab->basis[i] = i;
    }
}

bool lcp_solve(int32_t n, const double *M, const double *q, double *z, double *work, int32_t *basis) {
    int32_t worst = -1;
    for (int32_t i = 0; i < n; i++) {
        z[i] = 0;
        if (q[i] < 0 && (worst < 0 || q[i] < q[worst])) worst = i;
    }
    if (worst < 0) return true;
    Tableau tab = {n, 2 * n + 2, work, basis};
    fill(&tab, M, q);
    int32_t entering = 2 * n, r = worst;
    for (int32_t k = 0; k < 40 * n + 40; k++) {
        int32_t leaving = tab.basis[r];
        pivot(&tab, r, entering);
        if (leaving == 2 * n) {
            for (int32_t i = 0; i < n; i++)
                if (tab.basis[i] >= n && tab.basis[i] < 2 * n) z[tab.basis[i] - n] = fmax(row(&tab, i)[2 * n + 1], 0);
            return true;
        }
        entering = leaving < n ? leaving + n : leaving - n; /* the complement of what left */
        r = leaving_row(&tab, entering);
        if (r < 0) return false;
    }
    return false;
}
