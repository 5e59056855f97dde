#include "project.h"

#include <string.h>

#define RELAX 1e-6    /* makes redundant rows solvable; what that leaves is taken away by iterating */
#define FARTHEST 20.0 /* times the error that is corrected: a correction goes no farther */

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
    const Feature *f = &c->feature;
    return feature_gap(f, system_placed(system, f->body_a), system_placed(system, f->body_b)).gap - c->hold;
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
        memcpy(row->fa, row->ja, sizeof row->fa);
        memcpy(row->fb, row->jb, sizeof row->fb);
    }
    return status;
}

/* Newton's method on the positions: the first pass leaves the square of the error. */
static int project_positions(Smooth *s, System *system) {
    Active *active = &s->active;
    system_store(system, s->start);
    double first = 0;
    for (int pass = 0; pass < 3; pass++) {
        int status = place_plain(system);
        if (status != SIM_OK) return status;
        double worst = 0;
        for (int32_t i = 0; i < active->count; i++) {
            active->unknown[i] = -position_error(system, active->row[i]);
            worst = fmax(worst, fabs(active->unknown[i]));
        }
        if (pass == 0) first = worst;
        if (worst <= s->slack.root) break;
        active_factor(active, system, RELAX);
        active_solve(active);
        for (int32_t i = 0; i < active->count; i++) {
            const Row *row = &system->row[active->row[i]];
            move(system, row->a, active->weight[i], active->unknown[i]);
            move(system, row->b, active->weight[i] + 3, active->unknown[i]);
        }
    }
    keep_if_small(system, s->start, first);
    return SIM_OK;
}

int project_velocities(Smooth *s, System *system) {
    Active *active = &s->active;
    int status = place_plain(system);
    if (status != SIM_OK) return status;
    system_store(system, s->start);
    double first = 0;
    active_factor(active, system, RELAX);
    for (int pass = 0; pass < 3; pass++) {
        for (int32_t i = 0; i < active->count; i++) {
            active->unknown[i] = -row_speed(&system->row[active->row[i]], system->state);
            if (pass == 0) first = fmax(first, fabs(active->unknown[i]));
        }
        active_solve(active);
        for (int32_t i = 0; i < active->count; i++) row_push(system, &system->row[active->row[i]], active->unknown[i]);
    }
    keep_if_small(system, s->start, first);
    return SIM_OK;
}

int project(Smooth *s, System *system, double *left) {
    Active *active = &s->active;
    *left = 0;
    if (active->count == 0) return SIM_OK;
    int status = project_positions(s, system);
    if (status == SIM_OK) status = project_velocities(s, system);
    for (int32_t i = 0; i < active->count; i++)
        *left = fmax(*left, fabs(row_speed(&system->row[active->row[i]], system->state)));
    return status;
}
