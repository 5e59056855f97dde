#include "active.h"

#include <stdlib.h>
#include <string.h>

void active_destroy(Active *active) {
    free(active->row);
    free(active->weight);
    *active = (Active){0};
}

static int reserve(Active *active, int32_t rows) {
    if (rows <= active->capacity) return SIM_OK;
    size_t n = 2 * (size_t)rows;
    active_destroy(active);
    active->row = malloc(3 * n * sizeof *active->row);
    active->weight = malloc((10 * n + 2 * n * n) * sizeof(double));
    if (!active->row || !active->weight) return SIM_OUT_OF_MEMORY;
    active->rank = active->row + n;
    active->first = active->row + 2 * n;
    active->unknown = (double *)active->weight + 6 * n;
    active->force = active->unknown + n;
    active->softness = active->unknown + 2 * n;
    active->inverse = active->unknown + 3 * n;
    active->lower = active->unknown + 4 * n;
    active->upper = active->lower + n * n;
    active->capacity = (int32_t)n;
    return SIM_OK;
}

static bool share_member(const Row *i, const Row *j) {
    return (i->a >= 0 && (i->a == j->a || i->a == j->b)) || (i->b >= 0 && (i->b == j->a || i->b == j->b));
}

enum { HOLDS = -1, IDLE = -2 };

/* Put a row, and those that hang together with it, at the end of the order: breadth first over rows that share a body (Cuthill
 * and McKee 1969).  From the end of a chain it comes out banded; what is reached last from anywhere is such an end. */
static void spread(Active *active, const System *system, int32_t seed) {
    int32_t head = active->count, *rank = active->rank;
    rank[seed] = active->count;
    active->row[active->count++] = seed;
    for (; head < active->count; head++)
        for (int32_t j = 0; j < system->row_count; j++) {
            if (rank[j] != HOLDS || !share_member(&system->row[active->row[head]], &system->row[j])) continue;
            rank[j] = active->count;
            active->row[active->count++] = j;
        }
}

int active_choose(Active *active, const System *system) {
    int status = reserve(active, system->row_count);
    if (status != SIM_OK) return status;
    int32_t *rank = active->rank;
    for (int32_t i = 0; i < system->row_count; i++) rank[i] = i < 2 * system->joint_count ? HOLDS : IDLE;
    for (int32_t k = 0; k < system->contact_count; k++) {
        const Contact *c = &system->contact[k];
        int32_t normal = 2 * (system->joint_count + k);
        if (c->active) rank[normal] = HOLDS;
        if (c->active && c->slide == 0 && c->friction > 0) rank[normal + 1] = HOLDS;
    }
    active->count = 0;
    for (int32_t seed = 0; seed < system->row_count; seed++) {
        if (rank[seed] != HOLDS) continue;
        int32_t start = active->count;
        spread(active, system, seed);
        int32_t last = active->row[active->count - 1];
        for (int32_t i = start; i < active->count; i++) rank[active->row[i]] = HOLDS;
        active->count = start;
        spread(active, system, last);
    }
    for (int32_t i = 0; i < active->count; i++) {
        active->softness[i] = 1;
        int32_t *first = &active->first[i];
        for (*first = 0; *first < i; ++*first)
            if (share_member(&system->row[active->row[i]], &system->row[active->row[*first]])) break;
    }
    return SIM_OK;
}

static void weigh(const System *system, int32_t member, const double *f, double *weight) {
    const Body *body =
        &system->world->body[member < 0 ? 0 : system->member[member]]; /* the background's inverses are 0 */
    weight[0] = body->inverse_mass * f[0];
    weight[1] = body->inverse_mass * f[1];
    weight[2] = body->inverse_moment * f[2];
}

static double along(const double *j, const double *weight) {
    return j[0] * weight[0] + j[1] * weight[1] + j[2] * weight[2];
}

/* J_i M^-1 F_j', of rows i and j with j's weight. */
static double coupling(const Row *i, const Row *j, const double *weight) {
    double sum = 0;
    if (i->a == j->a) sum += along(i->ja, weight);
    if (i->a == j->b) sum += along(i->ja, weight + 3);
    if (i->b == j->a) sum += along(i->jb, weight);
    if (i->b == j->b) sum += along(i->jb, weight + 3);
    return sum;
}

/* Whether no contact slides against friction: then F = J, and the matrix is symmetric. */
static bool is_symmetric(const System *system) {
    for (int32_t k = 0; k < system->contact_count; k++) {
        const Contact *c = &system->contact[k];
        if (c->active && c->slide != 0 && c->friction > 0) return false;
    }
    return true;
}

/* LU without pivoting within the profile. */
void active_factor(Active *active, const System *system, double relax) {
    int32_t n = active->count;
    bool symmetric = is_symmetric(system);
    for (int32_t i = 0; i < n; i++) {
        const Row *ri = &system->row[active->row[i]];
        double *weight = active->weight[i];
        weigh(system, ri->a, ri->fa, weight);
        weigh(system, ri->b, ri->fb, weight + 3);
        double *li = active->lower + (size_t)i * (size_t)n, *ui = active->upper + (size_t)i * (size_t)n;
        for (int32_t j = active->first[i]; j < i; j++) {
            const Row *rj = &system->row[active->row[j]];
            const double *lj = active->lower + (size_t)j * (size_t)n, *uj = active->upper + (size_t)j * (size_t)n;
            int32_t from = active->first[i] > active->first[j] ? active->first[i] : active->first[j];
            double lower = coupling(ri, rj, active->weight[j]);
            for (int32_t k = from; k < j; k++) lower -= li[k] * uj[k];
            double upper = symmetric ? lower : coupling(rj, ri, weight);
            for (int32_t k = from; !symmetric && k < j; k++) upper -= lj[k] * ui[k];
            li[j] = lower;
            ui[j] = upper * active->inverse[j];
        }
        double diagonal = coupling(ri, ri, weight);
        diagonal += relax * fabs(diagonal) * active->softness[i];
        for (int32_t k = active->first[i]; k < i; k++) diagonal -= li[k] * ui[k];
        active->inverse[i] = 1 / diagonal;
    }
}

void active_solve(Active *active) {
    int32_t n = active->count;
    double *x = active->unknown;
    for (int32_t i = 0; i < n; i++) {
        const double *li = active->lower + (size_t)i * (size_t)n;
        double sum = x[i];
        for (int32_t k = active->first[i]; k < i; k++) sum -= li[k] * x[k];
        x[i] = sum * active->inverse[i];
    }
    for (int32_t i = n - 1; i >= 0; i--) {
        const double *ui = active->upper + (size_t)i * (size_t)n;
        for (int32_t k = active->first[i]; k < i; k++) x[k] -= ui[k] * x[i];
    }
}
