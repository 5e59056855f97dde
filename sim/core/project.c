#include "project.h"

#include <string.h>

#define RELAX 1e-6    /* makes redundant rows solvable; what that leaves is taken away by iterating */
#define FARTHEST 20.0 /* times the error that is corrected: a correction goes no farther */
#define UNSEEN 0.02   /* of the slack: a drift as small as this is left for later */

static double position_error(const System *system, int32_t row) {
    bool is_joint = row < 2 * system->joint_count;
    if (is_joint) {
        const Joint *joint = &system->world->joint[system->joint[row / 2]];
        const Placed *a = system_placed(system, joint->a), *b = system_placed(system, joint->b);
        Vec apart = vsub(place(a->at, joint->local_a), place(b->at, joint->local_b));
        return row & 1 ? apart.y : apart.x;
    }
    if (row & 1) return 0;
    const Contact *c = &system->contact[row / 2 - system->joint_count];
    return c->gap.gap - c->hold;
}

static void move(const System *system, int32_t i, const double *weight, double by) {
    if (i < 0) return;
    State *state = &system->state[i];
    state->p = vmad(state->p, by, vec(weight[0], weight[1]));
    state->angle += by * weight[2];
}

/* Rows that nearly say the same, and differ by rounding, would be met by running far away: a correction that is much larger than
 * what it corrects is not made. */
static void keep_if_small(System *system, const double *before, double worst) {
    bool small = true;
    for (int32_t i = 0; i < system->count; i++) {
        const State *s = &system->state[i];
        const double *b = before + 6 * i;
        double reach = system->world->body[system->member[i]].reach, most = FARTHEST * worst;
        small = small && vlength(vsub(s->p, vec(b[0], b[1]))) + reach * fabs(s->angle - b[2]) <= most;
        small = small && vlength(vsub(s->v, vec(b[3], b[4]))) + reach * fabs(s->spin - b[5]) <= most;
    }
    if (!small) system_load(system, before);
}

/* Place the rows, with forces along the rows themselves: what is moved onto the constraints by the least motion gains no
 * energy, as it would along the force of a sliding contact. */
static int place_plain(System *system) {
    int status = system_place(system);
    for (int32_t i = 0; i < system->row_count && status == SIM_OK; i++) {
        Row *row = &system->row[i];
        memcpy(row->f, row->j, sizeof row->f);
    }
    return status;
}

/* Newton's method on the positions: the first pass leaves the square of the error. */
static int project_positions(Smooth *s, System *system) {
    Active *active = &s->active;
    system_store(system, s->trial);
    double first = 0;
    for (int pass = 0; pass < 3; pass++) {
        int status = place_plain(system);
        if (status != SIM_OK) return status;
        double worst = 0;
        for (int32_t i = 0; i < 2 * active->count; i++) {
            active->unknown[i] = active->holds[i] ? -position_error(system, 2 * active->pair[i / 2] + (i & 1)) : 0;
            worst = fmax(worst, fabs(active->unknown[i]));
        }
        if (pass == 0) first = worst;
        if (worst <= s->slack.root) break;
        active_factor(active, system, RELAX);
        active_solve(active);
        for (int32_t i = 0; i < 2 * active->count; i++) {
            const Row *row = active_row(active, system, i);
            for (int side = 0; row && side < 2; side++)
                move(system, row->member[side], active->rows[i / 2].weight[i & 1][side], active->unknown[i]);
        }
    }
    keep_if_small(system, s->trial, first);
    return SIM_OK;
}

int project_velocities(Smooth *s, System *system) {
    Active *active = &s->active;
    int status = place_plain(system);
    if (status != SIM_OK) return status;
    system_store(system, s->trial);
    double first = 0;
    active_factor(active, system, RELAX);
    for (int pass = 0; pass < 3; pass++) {
        for (int32_t i = 0; i < 2 * active->count; i++) {
            const Row *row = active_row(active, system, i);
            active->unknown[i] = row ? -row_speed(row, system->state) : 0;
            if (pass == 0) first = fmax(first, fabs(active->unknown[i]));
        }
        active_solve(active);
        for (int32_t i = 0; i < 2 * active->count; i++) {
            const Row *row = active_row(active, system, i);
            if (row) row_push(system, row, active->unknown[i]);
        }
    }
    keep_if_small(system, s->trial, first);
    return SIM_OK;
}

static double largest_speed(const Smooth *s, const System *system) {
    double largest = 0;
    for (int32_t i = 0; i < 2 * s->active.count; i++) {
        const Row *row = active_row(&s->active, system, i);
        if (row) largest = fmax(largest, fabs(row_speed(row, system->state)));
    }
    return largest;
}

/* Whether the system, as it is placed, has hardly drifted off its constraints since it was last put onto them.  Rows that
 * repeat each other must not contradict each other even by so much. */
static bool keeps_to_constraints(const Smooth *s, const System *system) {
    const Active *active = &s->active;
    if (s->relax > 0) return false;
    for (int32_t i = 0; i < 2 * active->count; i++)
        if (active->holds[i] &&
            !(fabs(position_error(system, 2 * active->pair[i / 2] + (i & 1))) <= UNSEEN * s->slack.gap))
            return false;
    return largest_speed(s, system) <= UNSEEN * s->slack.speed;
}

int project(Smooth *s, System *system, double *left) {
    *left = 0;
    if (s->active.count == 0 || keeps_to_constraints(s, system)) return SIM_OK;
    s->projected = true;
    int status = project_positions(s, system);
    if (status == SIM_OK) status = project_velocities(s, system);
    *left = largest_speed(s, system);
    return status;
}
