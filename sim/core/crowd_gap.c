/* How far apart a contact's points are as its bodies move, and how overlaps are taken out of the positions. */
#include "crowd_rows.h"

#include "broad.h"

static const double RATE = 0.6;  /* share of an overlap that a pass drives out */
static const double TURN = 0.03; /* [rad]: a pair that has turned so far in the frame is looked at again */

/* When the bodies have moved and turned so in the frame, to the second order of the turns: a corner goes on a circle, a side
 * turns away under it. */
static inline Two gap_at(const Contact *c, Vec apart, double turned_a, double turned_b) {
    double slid = vcross(c->normal, apart) * (turned_a * c->slide_a + turned_b * c->slide_b);
    Two first =
        c->separation + both(vdot(apart, c->normal)) + both(turned_b) * c->spin_nb - both(turned_a) * c->spin_na;
    return first + both(turned_a * turned_a) * c->bend_aa + both(turned_b * turned_b) * c->bend_bb +
           both(turned_a * turned_b) * c->bend_ab + both(slid);
}

static inline Two gap_between(const Contact *c, const Mover *a, const Mover *b) {
    return gap_at(c, vsub(b->moved, a->moved), a->turned, b->turned);
}

Two gap_now(const Contact *c, const Mover *a, const Mover *b) { return gap_between(c, a, b); }

static inline void set_limit(Contact *c, Two gap, double inverse_dt) { c->limit = positive(gap) * both(-inverse_dt); }

void gap_limit(Contact *contact, int32_t count, const Mover *mover, double dt) {
    for (int32_t i = 0; i < count; i++) {
        Contact *c = &contact[i];
        set_limit(c, gap_between(c, &mover[c->a], &mover[c->b]), 1 / dt);
    }
}

/* Whether the gap of a contact's points will be smaller than its limit lets it be. */
static bool foresee(Contact *c, const Mover *a, const Mover *b, double dt) {
    Vec apart = vsub(b->moved, a->moved), way = vscale(vsub(b->velocity, a->velocity), dt);
    double turn_a = dt * a->spin, turn_b = dt * b->spin;
    Two now = gap_between(c, a, b), then = gap_at(c, vadd(apart, way), a->turned + turn_a, b->turned + turn_b);
    Two linear = both(vdot(c->normal, way)) + both(turn_b) * c->spin_nb - both(turn_a) * c->spin_na;
    bool any = false;
    for (int32_t k = 0; k < c->count; k++) {
        double gap = larger(now[k], 0) + smaller(then[k] - now[k] - linear[k], 0);
        double limit = gap > 0 ? -gap / dt : 0; /* never more: to push by a guess could gain energy */
        if (fabs(limit - c->limit[k]) * dt <= c->fine) continue;
        c->limit[k] = limit;
        any = true;
    }
    return any;
}

bool gap_foresee(Rows *rows, const Mover *mover, const int32_t *active, int32_t active_count, double dt) {
    static const double FAST = 0.03; /* [rad] in the substep */
    bool spins = false, any = false;
    for (int32_t k = 0; k < active_count; k++) {
        rows->whirls[active[k]] = fabs(mover[active[k]].spin) * dt >= FAST;
        spins |= rows->whirls[active[k]];
    }
    if (!spins) return false;
    int32_t count = 0;
    for (int32_t i = 0; i < rows->count; i++) {
        rows->list[count] = i;
        count += rows->whirls[rows->ends[i].a] | rows->whirls[rows->ends[i].b];
    }
    for (int32_t k = 0; k < count; k++) {
        Contact *c = &rows->contact[rows->list[k]];
        if (!foresee(c, &mover[c->a], &mover[c->b], dt)) continue;
        rows_heat(rows, mover, c->a, true);
        rows_heat(rows, mover, c->b, true);
        any = true;
    }
    return any;
}

void gap_close(Rows *rows, Mover *mover, double dt) {
    double inverse_dt = 1 / dt;
    rows->stale_count = 0;
    for (int32_t i = 0; i < rows->count; i++) {
        Contact *c = &rows->contact[i];
        Mover *a = &mover[c->a], *b = &mover[c->b];
        Two gap = gap_between(c, a, b), depth = -gap - both(c->slop);
        Vec shifted = vsub(vsub(b->moved, a->moved), c->moved);
        double turned = c->turns_b * b->turned - c->turns_a * a->turned - c->turned;
        rows->stale[rows->stale_count] = i;
        rows->stale_count += (fabs(turned) >= TURN) | (fabs(shifted.x) + fabs(shifted.y) >= c->slack);
        set_limit(c, gap, inverse_dt);
        if ((depth[0] <= 0) & ((depth[1] <= 0) | (c->count < 2))) continue;
        depth = (Two){smaller(depth[0], c->slack), smaller(depth[1], c->slack)};
        Two push = {0, 0};
        if (c->pair_mass > 0)
            push = (depth * swapped(c->mobility) - both(c->coupling) * swapped(depth)) * both(c->pair_mass);
        if (c->pair_mass == 0 || push[0] < 0 || push[1] < 0) { /* the deeper one alone */
            push = depth * c->mass_n;
            push[c->count < 2 || depth[0] > depth[1]] = 0;
        }
        push *= both(RATE);
        double sum = sum_of(push);
        a->moved = vmad(a->moved, -sum * c->inverse_mass_a, c->normal);
        a->turned -= c->inverse_moment_a * sum_of(c->spin_na * push);
        b->moved = vmad(b->moved, sum * c->inverse_mass_b, c->normal);
        b->turned += c->inverse_moment_b * sum_of(c->spin_nb * push);
    }
}
