#include "active.h"

#include <stdlib.h>
#include <string.h>

#define LEFT_OF_REDUNDANT 1e-8 /* a row of which elimination leaves less than this part says what others have said */
#define LEFT_OF_ROUNDED 1e-5 /* where it leaves less than this, rounding shows */

void active_destroy(Active *active) {
    free(active->pair);
    free(active->newest);
    free(active->holds);
    free(active->rows);
    free(active->meeting);
    free(active->begin);
    free(active->lower);
    free(active->inverse);
    free(active->unknown);
    *active = (Active){0};
}

/* Room for so many pairs and members; what was there is lost. */
static int reserve(Active *active, int32_t pairs, int32_t members) {
    if (pairs <= active->capacity && members <= active->members) return SIM_OK;
    size_t n = 2 * (size_t)pairs + 1, m = 2 * (size_t)members;
    active_destroy(active);
    active->pair = malloc((6 * n + 1) * sizeof *active->pair);
    active->newest = malloc(m * sizeof *active->newest);
    active->holds = malloc(2 * n * sizeof *active->holds);
    active->rows = malloc(n * sizeof *active->rows);
    active->begin = malloc(n * sizeof *active->begin);
    active->inverse = malloc(n * sizeof *active->inverse);
    active->unknown = malloc(6 * n * sizeof *active->unknown);
    if (!active->pair || !active->newest || !active->holds || !active->rows) return SIM_OUT_OF_MEMORY;
    if (!active->begin || !active->inverse || !active->unknown) return SIM_OUT_OF_MEMORY;
    active->rank = active->pair + n;
    active->first = active->pair + 2 * n;
    active->older = active->pair + 3 * n;
    active->met = active->pair + 5 * n;
    active->force = active->unknown + 2 * n;
    active->softness = active->unknown + 4 * n;
    active->capacity = (int32_t)n;
    active->members = (int32_t)m;
    return SIM_OK;
}

/* ---------------------------------------------------------------- the order */

enum { HOLDS = -1, IDLE = -2, NONE = -1 };

/* Mark the pairs that hold, and list them by member. */
static void find_holding(Active *active, const System *system) {
    int32_t pairs = system->row_count / 2, *rank = active->rank;
    for (int32_t p = 0; p < pairs; p++)
        rank[p] = p < system->joint_count || system->contact[p - system->joint_count].active ? HOLDS : IDLE;
    for (int32_t i = 0; i < system->count; i++) active->newest[i] = NONE;
    for (int32_t i = 2 * pairs - 1; i >= 0; i--) {
        int32_t member = system->row[i & ~1].member[i & 1];
        if (member < 0 || rank[i / 2] != HOLDS) continue;
        active->older[i] = active->newest[member];
        active->newest[member] = i;
    }
}

/* Put a pair, and those that hang together with it, at the end of the order: breadth first over pairs that share a body (Cuthill
 * and McKee 1969).  From the end of a chain it comes out banded; what is reached last from anywhere is such an end. */
static void spread(Active *active, const System *system, int32_t seed) {
    int32_t head = active->count, *rank = active->rank;
    rank[seed] = active->count;
    active->pair[active->count++] = seed;
    for (; head < active->count; head++)
        for (int side = 0; side < 2; side++) {
            int32_t member = system->row[2 * active->pair[head]].member[side];
            for (int32_t i = member < 0 ? NONE : active->newest[member]; i != NONE; i = active->older[i]) {
                if (rank[i / 2] != HOLDS) continue;
                rank[i / 2] = active->count;
                active->pair[active->count++] = i / 2;
            }
        }
}

/* List where an active pair meets those up to it, and find where its profile begins. */
static int find_meetings(Active *active, const System *system, int32_t i, int32_t *count) {
    active->first[i] = i;
    for (int side = 0; side < 2; side++) {
        int32_t member = system->row[2 * active->pair[i]].member[side];
        for (int32_t k = member < 0 ? NONE : active->newest[member]; k != NONE; k = active->older[k]) {
            int32_t other = active->rank[k / 2];
            if (other > i) continue;
            if (*count == active->meeting_capacity) {
                int32_t capacity = *count ? 2 * *count : 64;
                Meeting *grown = realloc(active->meeting, (size_t)capacity * sizeof *grown);
                if (!grown) return SIM_OUT_OF_MEMORY;
                active->meeting = grown;
                active->meeting_capacity = capacity;
            }
            active->meeting[(*count)++] = (Meeting){other, (int8_t)side, (int8_t)(k & 1)};
            if (other < active->first[i]) active->first[i] = other;
        }
    }
    return SIM_OK;
}

static int lay_out(Active *active, const System *system) {
    int32_t meetings = 0;
    size_t size = 0;
    for (int32_t i = 0; i < active->count; i++) {
        int32_t k = active->pair[i] - system->joint_count;
        active->holds[2 * i] = true;
        active->holds[2 * i + 1] = k < 0 || (system->contact[k].slide == 0 && system->contact[k].friction > 0);
        active->softness[2 * i] = active->softness[2 * i + 1] = 1;
        active->met[i] = meetings;
        int status = find_meetings(active, system, i, &meetings);
        if (status != SIM_OK) return status;
        active->begin[i] = size;
        size += (size_t)(i - active->first[i]);
    }
    active->met[active->count] = meetings;
    if (size >= active->profile_capacity) { /* room for none is room too: nothing is added to a null pointer */
        free(active->lower);
        size_t capacity = 2 * size + 1;
        active->lower = malloc(2 * capacity * sizeof *active->lower);
        active->profile_capacity = active->lower ? capacity : 0;
        if (!active->lower) return SIM_OUT_OF_MEMORY;
    }
    active->upper = active->lower + active->profile_capacity;
    return SIM_OK;
}

int active_choose(Active *active, const System *system) {
    int32_t pairs = system->row_count / 2;
    int status = reserve(active, pairs, system->count);
    if (status != SIM_OK) return status;
    find_holding(active, system);
    active->count = 0;
    for (int32_t seed = 0; seed < pairs; seed++) {
        if (active->rank[seed] != HOLDS) continue;
        int32_t start = active->count;
        spread(active, system, seed);
        int32_t last = active->pair[active->count - 1];
        for (int32_t i = start; i < active->count; i++) active->rank[active->pair[i]] = HOLDS;
        active->count = start;
        spread(active, system, last);
    }
    return lay_out(active, system);
}

/* ---------------------------------------------------------------- the equations */

static Block transposed(Block m) { return (Block){m.a, m.c, m.b, m.d}; }

static Block product(Block m, Block n) {
    return (Block){m.a * n.a + m.b * n.c, m.a * n.b + m.b * n.d, m.c * n.a + m.d * n.c, m.c * n.b + m.d * n.d};
}

static Block plus(Block m, Block n) { return (Block){m.a + n.a, m.b + n.b, m.c + n.c, m.d + n.d}; }
static Block minus(Block m, Block n) { return (Block){m.a - n.a, m.b - n.b, m.c - n.c, m.d - n.d}; }

/* J of a pair's rows on one side, times M^-1 F' of another's on that. */
static Block coupling(const RowPair *rows, int side, const RowPair *other, int other_side) {
    const double *j0 = rows->j[0][side], *j1 = rows->j[1][side];
    const double *w0 = other->weight[0][other_side], *w1 = other->weight[1][other_side];
    return (Block){j0[0] * w0[0] + j0[1] * w0[1] + j0[2] * w0[2], j0[0] * w1[0] + j0[1] * w1[1] + j0[2] * w1[2],
                   j1[0] * w0[0] + j1[1] * w0[1] + j1[2] * w0[2], j1[0] * w1[0] + j1[1] * w1[1] + j1[2] * w1[2]};
}

static void load_rows(const Active *active, const System *system, int32_t i) {
    RowPair *rows = &active->rows[i];
    for (int r = 0; r < 2; r++) {
        const Row *row = active_row(active, system, 2 * i + r);
        if (!row) {
            memset(rows->j[r], 0, sizeof rows->j[r]);
            memset(rows->weight[r], 0, sizeof rows->weight[r]);
            continue;
        }
        memcpy(rows->j[r], row->j, sizeof row->j);
        for (int side = 0; side < 2; side++) {
            int32_t member = row->member[side];
            const Body *body =
                &system->world->body[member < 0 ? 0 : system->member[member]]; /* the background's inverses are 0 */
            rows->weight[r][side][0] = body->inverse_mass * row->f[side][0];
            rows->weight[r][side][1] = body->inverse_mass * row->f[side][1];
            rows->weight[r][side][2] = body->inverse_moment * row->f[side][2];
        }
    }
}

/* Fill row i of the matrix left of the diagonal, and, where `upper` is asked for, its column above; both begin at the
 * profile.  The diagonal is returned. */
static Block fill(const Active *active, int32_t i, Block *lower, Block *upper) {
    int32_t first = active->first[i];
    Block diagonal = {0, 0, 0, active->holds[2 * i + 1] ? 0 : 1};
    for (int32_t j = first; j < i; j++) lower[j - first] = (Block){0};
    for (int32_t j = first; upper && j < i; j++) upper[j - first] = (Block){0};
    for (int32_t k = active->met[i]; k < active->met[i + 1]; k++) {
        const Meeting *m = &active->meeting[k];
        const RowPair *rows = &active->rows[i], *other = &active->rows[m->other];
        Block *at = m->other == i ? &diagonal : &lower[m->other - first];
        *at = plus(*at, coupling(rows, m->side, other, m->other_side));
        if (!upper || m->other == i) continue;
        at = &upper[m->other - first];
        *at = plus(*at, coupling(other, m->other_side, rows, m->side));
    }
    return diagonal;
}

/* Whether no contact slides against friction: then F = J, and the matrix is symmetric. */
bool active_is_symmetric(const System *system) {
    for (int32_t k = 0; k < system->contact_count; k++) {
        const Contact *c = &system->contact[k];
        if (c->active && c->slide != 0 && c->friction > 0) return false;
    }
    return true;
}

/* The inverse of a diagonal block of L, of a row that had `own` on the matrix's diagonal. */
static Block invert(Block left, Block own, Condition *worst) {
    double determinant = left.a * left.d - left.b * left.c, part = 1 / determinant, of = own.d * left.a;
    if (!(left.a >= LEFT_OF_ROUNDED * own.a && determinant >= LEFT_OF_ROUNDED * of)) {
        bool redundant = !(left.a >= LEFT_OF_REDUNDANT * own.a && determinant >= LEFT_OF_REDUNDANT * of);
        *worst = redundant ? REDUNDANT : *worst == REDUNDANT ? REDUNDANT : ROUNDED;
    }
    return (Block){left.d * part, -left.b * part, -left.c * part, left.a * part};
}

/* LU without pivoting within the profile. */
Condition active_factor(Active *active, const System *system, double relax) {
    bool symmetric = active_is_symmetric(system);
    Condition worst = SOUND;
    for (int32_t i = 0; i < active->count; i++) {
        int32_t first = active->first[i];
        Block *li = active->lower + active->begin[i], *ui = active->upper + active->begin[i];
        load_rows(active, system, i);
        Block own = fill(active, i, li, symmetric ? NULL : ui), left = own;
        left.a += relax * fabs(own.a) * active->softness[2 * i];
        left.d += relax * fabs(own.d) * active->softness[2 * i + 1];
        for (int32_t j = first; j < i; j++) {
            int32_t from = first > active->first[j] ? first : active->first[j];
            const Block *lj = active->lower + active->begin[j] + (from - active->first[j]);
            const Block *uj = active->upper + active->begin[j] + (from - active->first[j]);
            Block lower = li[j - first], upper;
            for (int32_t k = 0; k < j - from; k++) lower = minus(lower, product(li[from - first + k], uj[k]));
            upper = symmetric ? transposed(lower) : ui[j - first];
            for (int32_t k = 0; !symmetric && k < j - from; k++)
                upper = minus(upper, product(lj[k], ui[from - first + k]));
            li[j - first] = lower;
            ui[j - first] = product(active->inverse[j], upper);
            left = minus(left, product(lower, ui[j - first]));
        }
        active->inverse[i] = invert(left, own, &worst);
    }
    return worst;
}

void active_solve(Active *active) {
    double *x = active->unknown;
    for (int32_t i = 0; i < active->count; i++) {
        const Block *li = active->lower + active->begin[i], *inverse = &active->inverse[i];
        const double *xk = x + 2 * active->first[i];
        double x0 = x[2 * i], x1 = x[2 * i + 1];
        for (int32_t k = 0; k < i - active->first[i]; k++) {
            x0 -= li[k].a * xk[2 * k] + li[k].b * xk[2 * k + 1];
            x1 -= li[k].c * xk[2 * k] + li[k].d * xk[2 * k + 1];
        }
        x[2 * i] = inverse->a * x0 + inverse->b * x1;
        x[2 * i + 1] = inverse->c * x0 + inverse->d * x1;
    }
    for (int32_t i = active->count - 1; i >= 0; i--) {
        const Block *ui = active->upper + active->begin[i];
        double *xk = x + 2 * active->first[i], x0 = x[2 * i], x1 = x[2 * i + 1];
        for (int32_t k = 0; k < i - active->first[i]; k++) {
            xk[2 * k] -= ui[k].a * x0 + ui[k].b * x1;
            xk[2 * k + 1] -= ui[k].c * x0 + ui[k].d * x1;
        }
    }
}
