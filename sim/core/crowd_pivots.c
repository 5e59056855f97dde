/* The crowd's pivots, solved all at once.
 *
 * Pivots couple where they share a body, so the matrix is narrow once they are ordered along the bodies (Cuthill and McKee
 * 1969), and an envelope factorization (George and Liu 1981) takes time linear in the length of a chain.
 */
#include "crowd_pivots.h"

#include <stdlib.h>
#include <string.h>

/* Of a row's diagonal, for loops and chains drawn taut, which say the same thing more than once.  The speeds that they ask for
 * always agree, those of the bodies at rest do.  The places may not: two rods on one line do not reach a third point, and
 * what would bring a taut chain a little further along it throws it far aside. */
static const double GIVE_SPEEDS = 1e-9;
static const double GIVE_PLACES = 3e-3;

int pivots_create(Pivots *pivots, const World *world) {
    size_t n = (size_t)world->joint_count + 1;
    *pivots = (Pivots){
        .pivot = calloc(n, sizeof *pivots->pivot),
        .right = calloc(2 * n, sizeof *pivots->right),
        .speeds = {.give = GIVE_SPEEDS, .inverse_d = calloc(2 * n, sizeof(double))},
        .places = {.give = GIVE_PLACES, .inverse_d = calloc(2 * n, sizeof(double))},
        .row = calloc(2 * n, sizeof *pivots->row),
        .first = calloc(2 * n, sizeof *pivots->first),
        .mark = calloc((size_t)world->body_count, sizeof *pivots->mark),
    };
    bool made = pivots->pivot && pivots->right && pivots->speeds.inverse_d && pivots->places.inverse_d && pivots->row &&
                pivots->first && pivots->mark;
    return made ? SIM_OK : SIM_OUT_OF_MEMORY;
}

void pivots_destroy(Pivots *pivots) {
    free(pivots->pivot);
    free(pivots->right);
    free(pivots->speeds.entry);
    free(pivots->speeds.inverse_d);
    free(pivots->places.entry);
    free(pivots->places.inverse_d);
    free(pivots->row);
    free(pivots->first);
    free(pivots->mark);
}

static bool share_body(const Pivot *p, const Pivot *q, const Mover *mover) {
    if ((p->a == q->a || p->a == q->b) && mover[p->a].inverse_mass > 0) return true;
    return (p->b == q->a || p->b == q->b) && mover[p->b].inverse_mass > 0;
}

/* Breadth first along the bodies, from an end where there is one. */
static void order(Pivots *pivots, const World *world, const Mover *mover) {
    Pivot *p = pivots->pivot;
    int32_t *degree = pivots->mark;
    for (int32_t i = 0; i < world->body_count; i++) degree[i] = 0;
    for (int32_t i = 0; i < pivots->count; i++) {
        degree[p[i].a]++;
        degree[p[i].b]++;
    }
    for (int32_t done = 0, from = 0; done < pivots->count; done++) {
        int32_t next = -1, lowest = INT32_MAX;
        for (; next < 0 && from < done; from += next < 0) /* the first pivot found that still has neighbours */
            for (int32_t i = done; i < pivots->count && next < 0; i++)
                if (share_body(&p[from], &p[i], mover)) next = i;
        for (int32_t i = done; i < pivots->count && from >= done; i++) {
            int32_t d = (mover[p[i].a].inverse_mass > 0 ? degree[p[i].a] : 0) +
                        (mover[p[i].b].inverse_mass > 0 ? degree[p[i].b] : 0);
            if (d >= lowest) continue;
            lowest = d;
            next = i;
        }
        Pivot swap = p[done];
        p[done] = p[next];
        p[next] = swap;
    }
}

static int shape_envelope(Pivots *pivots, const Mover *mover) {
    int64_t used = 0;
    for (int32_t i = 0; i < pivots->count; i++) {
        int32_t first = i;
        for (int32_t j = 0; j < i && first == i; j++)
            if (share_body(&pivots->pivot[i], &pivots->pivot[j], mover)) first = j;
        for (int32_t k = 2 * i; k < 2 * i + 2; k++) {
            pivots->first[k] = 2 * first;
            used += k - 2 * first;
            pivots->row[k] = used++;
        }
    }
    pivots->entry_count = used;
    if (used <= pivots->entry_capacity) return SIM_OK;
    for (int32_t k = 0; k < 2; k++) {
        Factored *f = k == 0 ? &pivots->speeds : &pivots->places;
        double *entry = realloc(f->entry, (size_t)(2 * used) * sizeof *entry);
        if (!entry) return SIM_OUT_OF_MEMORY;
        f->entry = entry;
    }
    pivots->entry_capacity = 2 * used;
    return SIM_OK;
}

int pivots_load(Pivots *pivots, const World *world, const Mover *mover) {
    pivots->count = 0;
    for (int32_t i = 0; i < world->joint_count; i++) {
        const Joint *j = &world->joint[i];
        if (mover[j->a].inverse_mass == 0 && mover[j->b].inverse_mass == 0) continue;
        Pose a = body_pose(&world->body[j->a]), b = body_pose(&world->body[j->b]);
        Vec arm_a = turn(a, j->local_a), arm_b = turn(b, j->local_b);
        pivots->pivot[pivots->count++] =
            (Pivot){j->a, j->b, arm_a, arm_b, arm_a, arm_b, vsub(place(b, j->local_b), place(a, j->local_a))};
    }
    if (pivots->count == 0) return SIM_OK;
    order(pivots, world, mover);
    return shape_envelope(pivots, mover);
}

/* An arm turned since the frame began. */
static Vec turned_arm(Vec arm, double angle) { return turn(pose(vec(0, 0), angle), arm); }

/* What an impulse at q does to the velocity at p, for the bodies that they share. */
static void couple(const Pivot *p, const Pivot *q, const Mover *mover, double block[4]) {
    block[0] = block[1] = block[2] = block[3] = 0;
    for (int32_t side = 0; side < 4; side++) {
        int32_t body = side < 2 ? p->a : p->b, other = side % 2 ? q->b : q->a;
        if (body != other) continue;
        double sign = (side < 2) == (side % 2 == 0) ? 1 : -1;
        Vec r = side < 2 ? p->arm_a : p->arm_b, s = side % 2 ? q->arm_b : q->arm_a;
        double m = sign * mover[body].inverse_mass, i = sign * mover[body].inverse_moment;
        block[0] += m + i * r.y * s.y;
        block[1] -= i * r.y * s.x;
        block[2] -= i * r.x * s.y;
        block[3] += m + i * r.x * s.x;
    }
}

static double *at(const Pivots *pivots, const Factored *f, int32_t row, int32_t column) {
    return &f->entry[pivots->row[row] - row + column];
}

/* As L D L^T, of the matrix in its place. */
static void factor(const Pivots *pivots, Factored *f) {
    for (int32_t i = 0; i < 2 * pivots->count; i++) {
        double *row = at(pivots, f, i, 0), left = row[i] * (1 + f->give);
        for (int32_t j = pivots->first[i]; j < i; j++) {
            const double *above = at(pivots, f, j, 0);
            int32_t begin = pivots->first[i] > pivots->first[j] ? pivots->first[i] : pivots->first[j];
            for (int32_t k = begin; k < j; k++) row[j] -= row[k] * above[k];
        }
        for (int32_t j = pivots->first[i]; j < i; j++) { /* row[j] was L_ij d_j */
            double l = row[j] * f->inverse_d[j];
            left -= l * row[j];
            row[j] = l;
        }
        f->inverse_d[i] = left > 0 ? 1 / left : 0;
    }
}

void pivots_factor(Pivots *pivots, const Mover *mover, bool speeds) {
    for (int32_t i = 0; i < pivots->count; i++) {
        Pivot *p = &pivots->pivot[i];
        p->arm_a = turned_arm(p->start_a, mover[p->a].turned);
        p->arm_b = turned_arm(p->start_b, mover[p->b].turned);
        for (int32_t j = pivots->first[2 * i] / 2; j <= i; j++) {
            double block[4];
            couple(p, &pivots->pivot[j], mover, block);
            double *upper = at(pivots, &pivots->places, 2 * i, 2 * j),
                   *lower = at(pivots, &pivots->places, 2 * i + 1, 2 * j);
            upper[0] = block[0];
            if (j < i) upper[1] = block[1];
            lower[0] = block[2];
            lower[1] = block[3];
        }
    }
    if (speeds && pivots->count > 0) {
        memcpy(pivots->speeds.entry, pivots->places.entry, (size_t)pivots->entry_count * sizeof *pivots->speeds.entry);
        factor(pivots, &pivots->speeds);
    }
    factor(pivots, &pivots->places);
}

/* The impulses for the right side, in its place. */
static void back_solve(Pivots *pivots, const Factored *f) {
    double *x = pivots->right;
    int32_t n = 2 * pivots->count;
    for (int32_t i = 0; i < n; i++) {
        const double *row = at(pivots, f, i, 0);
        for (int32_t j = pivots->first[i]; j < i; j++) x[i] -= row[j] * x[j];
    }
    for (int32_t i = 0; i < n; i++) x[i] *= f->inverse_d[i];
    for (int32_t i = n - 1; i >= 0; i--) {
        const double *row = at(pivots, f, i, 0);
        for (int32_t j = pivots->first[i]; j < i; j++) x[j] -= row[j] * x[i];
    }
}

void pivots_solve(Pivots *pivots, Mover *mover) {
    if (pivots->count == 0) return;
    for (int32_t i = 0; i < pivots->count; i++) {
        const Pivot *p = &pivots->pivot[i];
        const Mover *a = &mover[p->a], *b = &mover[p->b];
        Vec v = vsub(vmad(b->velocity, b->spin, vperp(p->arm_b)), vmad(a->velocity, a->spin, vperp(p->arm_a)));
        pivots->right[2 * i] = -v.x;
        pivots->right[2 * i + 1] = -v.y;
    }
    back_solve(pivots, &pivots->speeds);
    for (int32_t i = 0; i < pivots->count; i++) {
        const Pivot *p = &pivots->pivot[i];
        Mover *a = &mover[p->a], *b = &mover[p->b];
        Vec j = vec(pivots->right[2 * i], pivots->right[2 * i + 1]);
        a->velocity = vmad(a->velocity, -a->inverse_mass, j);
        a->spin -= a->inverse_moment * vcross(p->arm_a, j);
        b->velocity = vmad(b->velocity, b->inverse_mass, j);
        b->spin += b->inverse_moment * vcross(p->arm_b, j);
    }
}

static void shift(Mover *m, Vec arm, Vec impulse, double rate) {
    Vec way = vscale(impulse, m->inverse_mass);
    double angle = m->inverse_moment * vcross(arm, impulse);
    m->moved = vadd(m->moved, way);
    m->turned += angle;
    m->velocity = vmad(m->velocity, rate, way);
    m->spin += rate * angle;
}

void pivots_join(Pivots *pivots, Mover *mover, double rate, const bool *pressed) {
    if (pivots->count == 0) return;
    for (int32_t i = 0; i < pivots->count; i++) {
        const Pivot *p = &pivots->pivot[i];
        const Mover *a = &mover[p->a], *b = &mover[p->b];
        Vec way_a = vadd(a->moved, vsub(turned_arm(p->start_a, a->turned), p->start_a));
        Vec way_b = vadd(b->moved, vsub(turned_arm(p->start_b, b->turned), p->start_b));
        Vec apart = vadd(p->start_apart, vsub(way_b, way_a));
        pivots->right[2 * i] = -apart.x;
        pivots->right[2 * i + 1] = -apart.y;
    }
    back_solve(pivots, &pivots->places);
    for (int32_t i = 0; i < pivots->count; i++) {
        const Pivot *p = &pivots->pivot[i];
        Vec j = vec(pivots->right[2 * i], pivots->right[2 * i + 1]);
        double own = pressed && (pressed[p->a] || pressed[p->b]) ? 0 : rate;
        shift(&mover[p->a], p->arm_a, vscale(j, -1), own);
        shift(&mover[p->b], p->arm_b, j, own);
    }
}
