/* Contacts with Coulomb friction at one moment are a linear complementarity problem: in the plane the friction cone has
 * two sides, so nothing is approximated (Stewart and Trinkle 1996; Anitescu and Potra 1997; for forces Baraff 1994).
 * A contact has the unknowns normal force n, friction p and m to either side, and the slip s that is left:
 *
 *     n >= 0   against   normal velocity (or acceleration) >= 0
 *     p, m >= 0          slip to their side + s >= 0
 *     s >= 0             mu n - p - m >= 0
 *
 * Joints are eliminated first.  Unknowns are scaled so that every contact's own coupling is 1: mass ratios of a million
 * then do not drown the small masses in the rounding of the large.
 */
#include "impact.h"

#include <stdlib.h>
#include <string.h>

#include "lcp.h"

#define MOST_SHARED 10 /* contacts: of more, loads are not shared out */

void contact_solver_destroy(ContactSolver *solver) {
    free(solver->block);
    free(solver->index);
    free(solver->rounds);
    *solver = (ContactSolver){0};
}

/* ---------------------------------------------------------------- the problem */

typedef struct Problem {
    System *system;
    int32_t joints, contacts, unknowns; /* rows of joints; contacts that take part; the LCP's size */
    int32_t width; /* of the reduced matrix: joints + 2 contacts + 1 */
    int32_t *contact; /* those that take part */
    int32_t *at; /* where each one's unknowns start */
    bool *sticks; /* whether each one has unknowns for friction */
    bool *pivoted; /* joint rows that the elimination used */
    double *reduced; /* rows of joints, then two a contact; the last column is the wanted change */
    double *M, *q, *z, *work, *scale;
    int32_t *basis;
} Problem;

static int lay_out(ContactSolver *solver, Problem *p, System *system, const bool *takes_part) {
    int32_t total = system->contact_count;
    size_t joints = 2 * (size_t)system->joint_count, contacts = 0;
    for (int32_t k = 0; k < total; k++) contacts += takes_part[k];
    size_t rows = joints + 2 * contacts, most = 4 * contacts;
    size_t doubles = 1 + rows * (rows + 1) + most * most + 2 * most + contacts + lcp_work((int32_t)most);
    size_t ints = 3 * contacts + most + joints + 8;
    if (doubles > solver->size) {
        free(solver->block);
        solver->block = malloc(2 * doubles * sizeof *solver->block);
        solver->size = solver->block ? 2 * doubles : 0;
    }
    if (ints > solver->index_size) {
        free(solver->index);
        solver->index = malloc(2 * ints * sizeof *solver->index);
        solver->index_size = solver->index ? 2 * ints : 0;
    }
    if (!solver->size || !solver->index_size) return SIM_OUT_OF_MEMORY;
    *p = (Problem){
        .system = system, .joints = (int32_t)joints, .contacts = (int32_t)contacts, .width = (int32_t)rows + 1};
    p->reduced = solver->block;
    p->M = p->reduced + rows * (rows + 1);
    p->q = p->M + most * most;
    p->z = p->q + most;
    p->scale = p->z + most;
    p->work = p->scale + contacts;
    p->contact = solver->index;
    p->at = p->contact + contacts;
    p->basis = p->at + contacts;
    p->sticks = (bool *)(p->basis + most);
    p->pivoted = p->sticks + contacts;
    contacts = 0;
    for (int32_t k = 0; k < total; k++)
        if (takes_part[k]) p->contact[contacts++] = k;
    return SIM_OK;
}

static const Row *problem_row(const Problem *p, int32_t i) {
    if (i < p->joints) return &p->system->row[i];
    return contact_row(p->system, p->contact[(i - p->joints) / 2]) + (i - p->joints) % 2;
}

static double *reduced_row(const Problem *p, int32_t i) { return p->reduced + (size_t)i * (size_t)p->width; }

/* Fill the matrix of all rows and eliminate the joints' forces. `wanted` is the last column, by the system's rows. */
static void reduce(Problem *p, const double *wanted) {
    int32_t n = p->width - 1;
    double largest = 0;
    for (int32_t i = 0; i < n; i++) {
        double *t = reduced_row(p, i);
        const Row *row = problem_row(p, i);
        for (int32_t j = 0; j < n; j++) t[j] = row_coupling(p->system, row, problem_row(p, j));
        t[n] = wanted[row - p->system->row];
        if (i < p->joints) largest = fmax(largest, t[i]);
    }
    for (int32_t k = 0; k < p->joints; k++) p->pivoted[k] = false;
    for (int32_t done = 0; done < p->joints; done++) {
        int32_t best = -1;
        for (int32_t k = 0; k < p->joints; k++)
            if (!p->pivoted[k] && (best < 0 || reduced_row(p, k)[k] > reduced_row(p, best)[best])) best = k;
        const double *t = reduced_row(p, best);
        if (t[best] < 1e-11 * largest) break; /* the rows left say what the others have said */
        p->pivoted[best] = true;
        for (int32_t i = 0; i < n; i++) {
            double *u = reduced_row(p, i), factor = u[best] / t[best];
            if (i == best || factor == 0) continue;
            for (int32_t j = 0; j <= n; j++) u[j] -= factor * t[j];
            u[best] = 0;
        }
    }
}

/* Build the LCP over what is left. */
static void complement(Problem *p) {
    int32_t at = 0;
    for (int32_t c = 0; c < p->contacts; c++) {
        const Contact *contact = &p->system->contact[p->contact[c]];
        p->sticks[c] = contact->slide == 0 && contact->friction > 0;
        p->at[c] = at;
        at += p->sticks[c] ? 4 : 1;
        double own = reduced_row(p, p->joints + 2 * c)[p->joints + 2 * c];
        p->scale[c] = own > 1e-300 ? 1 / sqrt(own) : 1;
    }
    p->unknowns = at;
    memset(p->M, 0, (size_t)at * (size_t)at * sizeof *p->M);
    memset(p->q, 0, (size_t)at * sizeof *p->q);
    for (int32_t c = 0; c < p->contacts; c++) {
        const double *normal = reduced_row(p, p->joints + 2 * c), *along = normal + p->width;
        double s = p->scale[c];
        int32_t i = p->at[c];
        double *M = p->M + (size_t)i * (size_t)at;
        p->q[i] = s * normal[p->width - 1];
        if (p->sticks[c]) {
            p->q[i + 1] = s * along[p->width - 1];
            p->q[i + 2] = -p->q[i + 1];
            M[at + i + 3] = M[2 * at + i + 3] = 1;
            M[3 * at + i] = p->system->contact[p->contact[c]].friction;
            M[3 * at + i + 1] = M[3 * at + i + 2] = -1;
        }
        for (int32_t d = 0; d < p->contacts; d++) {
            int32_t j = p->at[d], column = p->joints + 2 * d;
            double st = s * p->scale[d];
            M[j] = st * normal[column];
            if (p->sticks[d]) M[j + 1] = st * normal[column + 1], M[j + 2] = -M[j + 1];
            if (!p->sticks[c]) continue;
            M[at + j] = st * along[column];
            M[2 * at + j] = -M[at + j];
            if (!p->sticks[d]) continue;
            M[at + j + 1] = M[2 * at + j + 2] = st * along[column + 1];
            M[at + j + 2] = M[2 * at + j + 1] = -M[at + j + 1];
        }
    }
}

/* Whether a contact may be idle only because others carry its load: it neither presses nor opens. */
static bool is_shared(const Problem *p) {
    for (int32_t c = 0; c < p->contacts; c++) {
        int32_t i = p->at[c];
        const double *M = p->M + (size_t)i * (size_t)p->unknowns;
        double opens = p->q[i], size = fabs(opens);
        for (int32_t j = 0; j < p->unknowns; j++) {
            opens += M[j] * p->z[j];
            size = fmax(size, fabs(M[j] * p->z[j]));
        }
        if (p->z[i] == 0 && size > 0 && fabs(opens) <= 1e-9 * size) return true;
    }
    return false;
}

/* Solve it.  Which wheel of three on one axle carries the load is not said by rigid bodies; that each carries its share is what a
 * spring under each would say.  That matters to what moves, which has few contacts. */
static bool solve_problem(const Problem *p) {
    if (!lcp_solve(p->unknowns, p->M, p->q, p->z, p->work, p->basis)) return false;
    if (p->contacts > MOST_SHARED || !is_shared(p)) return true;
    return lcp_share(p->unknowns, p->M, p->q, p->z, p->work, p->basis) ||
           lcp_solve(p->unknowns, p->M, p->q, p->z, p->work, p->basis);
}

/* Solve for the forces of all rows of the system, so that J M^-1 F' force + wanted obeys the contacts' laws; what is
 * less than `nothing` is rounding. */
static int solve(ContactSolver *solver, System *system, const bool *takes_part, double *wanted, double nothing,
                 double *force) {
    Problem p;
    for (int32_t i = 0; i < system->row_count; i++)
        if (fabs(wanted[i]) < nothing) wanted[i] = 0;
    int status = lay_out(solver, &p, system, takes_part);
    if (status != SIM_OK) return status;
    reduce(&p, wanted);
    complement(&p);
    if (!solve_problem(&p)) return SIM_BAD_INPUT;
    memset(force, 0, (size_t)system->row_count * sizeof *force);
    for (int32_t c = 0; c < p.contacts; c++) {
        const double *z = &p.z[p.at[c]];
        double *f = &force[2 * (system->joint_count + p.contact[c])];
        f[0] = p.scale[c] * z[0];
        if (p.sticks[c]) f[1] = p.scale[c] * (z[1] - z[2]);
    }
    for (int32_t k = 0; k < p.joints; k++) {
        if (!p.pivoted[k]) continue;
        const double *t = reduced_row(&p, k);
        double sum = t[p.width - 1];
        for (int32_t c = 0; c < p.contacts; c++) {
            const double *f = &force[2 * (system->joint_count + p.contact[c])];
            sum += t[p.joints + 2 * c] * f[0] + (p.sticks[c] ? t[p.joints + 2 * c + 1] * f[1] : 0);
        }
        force[k] = -sum / t[k];
    }
    return SIM_OK;
}

/* ---------------------------------------------------------------- impacts */

static double kinetic_energy(const System *s) {
    double sum = 0;
    for (int32_t i = 0; i < s->count; i++) {
        const Body *b = &s->world->body[s->member[i]];
        sum += 0.5 * (b->mass * vdot(s->state[i].v, s->state[i].v) + b->moment * s->state[i].spin * s->state[i].spin);
    }
    return sum;
}

/* Work space of the rounds, by the system's rows, contacts and members. */
typedef struct Rounds {
    double *wanted, *force, *elastic_force;
    State *before, *elastic;
    bool *takes_part;
} Rounds;

static int reserve_rounds(ContactSolver *solver, const System *s, Rounds *r) {
    size_t rows = (size_t)s->row_count, members = (size_t)s->count;
    size_t bytes = 3 * rows * sizeof(double) + 2 * members * sizeof(State) + (size_t)s->contact_count;
    if (bytes > solver->rounds_size) {
        free(solver->rounds);
        solver->rounds = malloc(2 * bytes);
        solver->rounds_size = solver->rounds ? 2 * bytes : 0;
        if (!solver->rounds) return SIM_OUT_OF_MEMORY;
    }
    r->wanted = solver->rounds;
    r->force = r->wanted + rows;
    r->elastic_force = r->force + rows;
    r->before = (State *)(r->elastic_force + rows);
    r->elastic = r->before + members;
    r->takes_part = (bool *)(r->elastic + members);
    return SIM_OK;
}

/* Whether a contact that approaches at this speed bounces.  Bounces that come ever faster end where they would: one too low
 * to be seen is none. */
static bool bounces_at(const Contact *c, double speed, const Slack *slack) {
    return c->elasticity > 0 && speed < -slack->speed && !is_low(slack, c->pull, c->elasticity * speed);
}

/* The contacts that take part exchange impulses at once, with their restitution or without. */
static int exchange(ContactSolver *solver, System *s, Rounds *r, bool elastic, const Slack *slack) {
    for (int32_t i = 0; i < s->row_count; i++) r->wanted[i] = row_speed(&s->row[i], s->state);
    for (int32_t k = 0; k < s->contact_count; k++) {
        double *u = &r->wanted[2 * (s->joint_count + k)];
        if (elastic && bounces_at(&s->contact[k], *u, slack)) *u *= 1 + s->contact[k].elasticity;
    }
    int status = solve(solver, s, r->takes_part, r->wanted, 1e-6 * slack->speed, r->force);
    if (status != SIM_OK) return status;
    for (int32_t i = 0; i < s->row_count; i++)
        if (r->force[i] != 0) row_push(s, &s->row[i], r->force[i]);
    return SIM_OK;
}

/* Newton's restitution with friction can gain energy where several contacts act at once (Kane and Levinson 1985); the
 * plastic impact never does. Go from it towards the elastic one as far as the energy of before allows. */
static int exchange_without_gain(ContactSolver *solver, System *s, Rounds *r, const Slack *slack) {
    size_t states = (size_t)s->count * sizeof *r->before;
    memcpy(r->before, s->state, states);
    double energy = kinetic_energy(s);
    int status = exchange(solver, s, r, true, slack);
    if (status != SIM_OK || kinetic_energy(s) <= energy * (1 + 1e-12)) return status;
    memcpy(r->elastic_force, r->force, (size_t)s->row_count * sizeof *r->force);
    memcpy(s->state, r->before, states);
    status = exchange(solver, s, r, false, slack);
    if (status != SIM_OK) return status;
    double low = 0, high = 1;
    for (int i = 0; i < 50; i++) {
        double part = (low + high) / 2;
        memcpy(s->state, r->before, states);
        for (int32_t k = 0; k < s->row_count; k++)
            row_push(s, &s->row[k], r->force[k] + part * (r->elastic_force[k] - r->force[k]));
        if (kinetic_energy(s) <= energy)
            low = part;
        else
            high = part;
    }
    memcpy(s->state, r->before, states);
    for (int32_t k = 0; k < s->row_count; k++) {
        r->force[k] += low * (r->elastic_force[k] - r->force[k]);
        row_push(s, &s->row[k], r->force[k]);
    }
    return SIM_OK;
}

/* Which contacts act in this round, and whether any does.  While something bounces, only those that approach: an impulse
 * runs down a line of touching balls from pair to pair, as a cradle's does, and those that may approach by error alone wait
 * for it.  Where nothing bounces all act together, since passing on from pair to pair would never end. */
static bool choose_round(const System *s, Rounds *r, const Slack *slack, bool together, bool *bounces) {
    double fastest = 0;
    for (int32_t k = 0; k < s->contact_count; k++) fastest = fmax(fastest, -row_speed(contact_row(s, k), s->state));
    double least = fastest > slack->unsure ? slack->unsure : slack->speed;
    *bounces = false;
    for (int32_t k = 0; k < s->contact_count; k++) {
        double speed = row_speed(contact_row(s, k), s->state);
        r->takes_part[k] = speed < -least;
        *bounces = *bounces || (r->takes_part[k] && bounces_at(&s->contact[k], speed, slack));
    }
    if (together) *bounces = false;
    if (!*bounces)
        for (int32_t k = 0; k < s->contact_count; k++) r->takes_part[k] = true;
    return fastest > slack->speed;
}

int resolve_impacts(ContactSolver *solver, System *s, const Slack *slack, Vec *impulse, int32_t *count) {
    Rounds r;
    int status = system_place(s);
    for (int32_t k = 0; k < s->contact_count; k++) s->contact[k].slide = 0;
    if (status == SIM_OK) status = system_place(s);
    if (status == SIM_OK) status = reserve_rounds(solver, s, &r);
    for (int32_t round = 0; status == SIM_OK; round++) {
        int32_t limit = 4 * s->contact_count + 16;
        bool bounces;
        if (!choose_round(s, &r, slack, round >= limit, &bounces)) return SIM_OK;
        if (round > limit + 3) return SIM_BAD_INPUT;
        status = bounces ? exchange_without_gain(solver, s, &r, slack) : exchange(solver, s, &r, false, slack);
        for (int32_t k = 0; k < s->contact_count && status == SIM_OK; k++) {
            const double *f = &r.force[2 * (s->joint_count + k)];
            impulse[k] = vadd(impulse[k], vec(f[0], f[1]));
        }
        *count += 1;
    }
    return status;
}

int resolve_shock(ContactSolver *solver, System *s, const Slack *slack) {
    Rounds r;
    for (int32_t k = 0; k < s->contact_count; k++) s->contact[k].slide = 0;
    int status = system_place(s);
    if (status == SIM_OK) status = reserve_rounds(solver, s, &r);
    if (status != SIM_OK) return status;
    for (int32_t i = 0; i < s->row_count; i++) r.wanted[i] = row_speed(&s->row[i], s->state);
    for (int32_t k = 0; k < s->contact_count; k++) {
        double *u = &r.wanted[2 * (s->joint_count + k)];
        r.takes_part[k] = true;
        if (*u <= slack->speed) *u = fmin(*u, 0) - slack->speed;
    }
    status = solve(solver, s, r.takes_part, r.wanted, 0, r.force);
    for (int32_t i = 0; i < s->row_count && status == SIM_OK; i++)
        if (r.force[i] != 0) row_push(s, &s->row[i], r.force[i]);
    return status;
}

/* ---------------------------------------------------------------- forces */

static void accelerations(const System *s, const double *force, double *out) {
    for (int32_t i = 0; i < s->count; i++) {
        out[3 * i] = s->world->gravity.x;
        out[3 * i + 1] = s->world->gravity.y;
        out[3 * i + 2] = 0;
    }
    for (int32_t k = 0; k < s->row_count; k++) {
        const Row *row = &s->row[k];
        if (force[k] == 0) continue;
        for (int side = 0; side < 2; side++) {
            int32_t i = row->member[side];
            const double *f = row->f[side];
            if (i < 0) continue;
            const Body *body = &s->world->body[s->member[i]];
            out[3 * i] += force[k] * body->inverse_mass * f[0];
            out[3 * i + 1] += force[k] * body->inverse_mass * f[1];
            out[3 * i + 2] += force[k] * body->inverse_moment * f[2];
        }
    }
}

int find_modes(ContactSolver *solver, System *s, const Slack *slack, double *acceleration) {
    Rounds r;
    int status = system_place(s);
    for (int32_t k = 0; k < s->contact_count; k++) {
        double slip = row_speed(contact_row(s, k) + 1, s->state);
        s->contact[k].slide = fabs(slip) <= slack->unsure ? 0 : slip > 0 ? 1 : -1; /* the forces tell the rest */
    }
    if (status == SIM_OK) status = system_place(s);
    if (status == SIM_OK) status = reserve_rounds(solver, s, &r);
    if (status != SIM_OK) return status;
    memset(r.force, 0, (size_t)s->row_count * sizeof *r.force);
    accelerations(s, r.force, acceleration);
    for (int32_t i = 0; i < s->row_count; i++) r.wanted[i] = row_acceleration(&s->row[i], acceleration);
    for (int32_t k = 0; k < s->contact_count; k++)
        r.takes_part[k] = row_speed(contact_row(s, k), s->state) <= slack->speed;
    status = solve(solver, s, r.takes_part, r.wanted, 1e-4 * slack->speed, r.force);
    if (status != SIM_OK) return status;
    accelerations(s, r.force, acceleration);
    for (int32_t k = 0; k < s->contact_count; k++) {
        Contact *c = &s->contact[k];
        const double *f = &r.force[2 * (s->joint_count + k)];
        c->active = f[0] > 0;
        c->force = f[0];
        c->along_force = f[1];
        const Row *along = contact_row(s, k) + 1;
        double slipping = fabs(row_acceleration(along, acceleration));
        double none = 1e-12 * (f[0] * row_coupling(s, along, along) + 1e-3 * vlength(s->world->gravity));
        if (c->slide == 0 && c->friction > 0 && fabs(f[1]) >= c->friction * f[0] * (1 - 1e-6) && slipping > none)
            c->slide = f[1] < 0 ? 1 : -1; /* against friction, also where it hardly slips yet */
    }
    return SIM_OK;
}
