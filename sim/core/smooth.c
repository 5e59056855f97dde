#include "smooth.h"

#include <stdlib.h>
#include <string.h>

#define LOCAL 0.02            /* the part of the tolerance that one step may err by */
#define RELAX 1e-10           /* makes redundant rows solvable; refinement takes its effect away again */
#define RELAX_MORE 1e-7    /* the same where rows that nearly repeat each other keep a step from converging */
#define PATIENCE 3         /* tries of a step before that is taken to be so */
#define RELAX_PROJECTION 1e-6 /* the same for projection, which is iterated anyway */
#define FARTHEST 20.0         /* times the error that is corrected: a correction goes no farther */
#define DECISIVE 1e-9         /* how far past its limit a force is when its event is taken, of the forces about */
#define UNSURE 0.02       /* forces that redundant contacts may share out otherwise: ask again after this time [s] */
#define LONGEST 2.0       /* a step [s]: within it, the ends of contacts' modes are looked for at the stages */
#define VELOCITY_TIME 1.0 /* an error in velocity counts as what it moves a body by in this time [s] */

int smooth_create(Smooth *s, const World *world, double tolerance, Slack slack) {
    *s = (Smooth){.capacity = world->body_count, .tolerance = tolerance, .slack = slack};
    size_t n = 6 * (size_t)world->body_count;
    double *block = malloc((ALL_STAGES + 4) * n * sizeof *block);
    if (!block) return SIM_OUT_OF_MEMORY;
    s->start = block;
    s->trial = block + n;
    s->end = block + 2 * n;
    s->acceleration = block + 3 * n;
    for (int i = 0; i < ALL_STAGES; i++) s->k[i] = block + (4 + (size_t)i) * n;
    return SIM_OK;
}

void smooth_destroy(Smooth *s) {
    free(s->start);
    free(s->active);
    free(s->matrix);
    *s = (Smooth){0};
}

/* ---------------------------------------------------------------- the rows that hold */

static bool share_member(const Row *i, const Row *j) {
    return (i->a >= 0 && (i->a == j->a || i->a == j->b)) || (i->b >= 0 && (i->b == j->a || i->b == j->b));
}

static int reserve(Smooth *s, int32_t rows) {
    if (rows <= s->row_capacity) return SIM_OK;
    size_t n = 2 * (size_t)rows;
    free(s->active);
    free(s->matrix);
    s->row_capacity = 0;
    s->active = malloc(3 * n * sizeof *s->active);
    s->matrix = malloc((n * n + 3 * n) * sizeof *s->matrix);
    if (!s->active || !s->matrix) return SIM_OUT_OF_MEMORY;
    s->rank = s->active + n;
    s->first = s->active + 2 * n;
    s->force = s->matrix + n * n;
    s->residual = s->force + n;
    s->softness = s->force + 2 * n;
    s->row_capacity = (int32_t)n;
    return SIM_OK;
}

int smooth_prepare(Smooth *s, System *system) {
    int status = system_place(system);
    if (status == SIM_OK) status = reserve(s, system->row_count);
    if (status != SIM_OK) return status;
    if (s->relax == 0) s->relax = RELAX;
    for (int32_t i = 0; i < system->row_count; i++) s->rank[i] = -2; /* does not hold */
    for (int32_t i = 0; i < 2 * system->joint_count; i++) s->rank[i] = -1;
    for (int32_t k = 0; k < system->contact_count; k++) {
        const Contact *c = &system->contact[k];
        int32_t normal = 2 * (system->joint_count + k);
        if (c->active) s->rank[normal] = -1;
        if (c->active && c->slide == 0 && c->friction > 0) s->rank[normal + 1] = -1;
    }
    /* Breadth first over rows that share a body (Cuthill and McKee 1969): chains come out banded. */
    s->active_count = 0;
    for (int32_t seed = 0; seed < system->row_count; seed++) {
        if (s->rank[seed] != -1) continue;
        int32_t head = s->active_count;
        s->rank[seed] = s->active_count;
        s->active[s->active_count++] = seed;
        for (; head < s->active_count; head++)
            for (int32_t j = 0; j < system->row_count; j++) {
                if (s->rank[j] != -1 || !share_member(&system->row[s->active[head]], &system->row[j])) continue;
                s->rank[j] = s->active_count;
                s->active[s->active_count++] = j;
            }
    }
    for (int32_t i = 0; i < s->active_count; i++) s->softness[i] = 1;
    for (int32_t i = 0; i < s->active_count; i++)
        for (s->first[i] = 0; s->first[i] < i; s->first[i]++)
            if (share_member(&system->row[s->active[i]], &system->row[s->active[s->first[i]]])) break;
    return SIM_OK;
}

/* How much softer than the others each row may be in a step: where sticking contacts share a load in more than one way,
 * friction goes to those that press as it begins, as Coulomb's law wants. */
static void find_softness(Smooth *s, const System *system) {
    int32_t joints = 2 * system->joint_count;
    double most = 0;
    for (int32_t k = 0; k < system->contact_count; k++) most = fmax(most, system->contact[k].force);
    for (int32_t i = 0; i < s->active_count; i++) {
        int32_t row = s->active[i];
        bool is_friction = row >= joints && (row & 1) == 1 && most > 0;
        s->softness[i] = is_friction ? most / fmax(system->contact[(row - joints) / 2].force, 1e-4 * most) : 1;
    }
}

/* LU without pivoting within the profile: L below with its diagonal, U above with ones on its diagonal. */
static void factor(Smooth *s, const System *system, double relax) {
    int32_t n = s->active_count;
    double *A = s->matrix;
    for (int32_t i = 0; i < n; i++) {
        const Row *ri = &system->row[s->active[i]];
        for (int32_t j = s->first[i]; j < i; j++) {
            const Row *rj = &system->row[s->active[j]];
            double lower = row_coupling(system, ri, rj), upper = row_coupling(system, rj, ri);
            int32_t k = s->first[i] > s->first[j] ? s->first[i] : s->first[j];
            for (; k < j; k++) {
                lower -= A[i * n + k] * A[k * n + j];
                upper -= A[j * n + k] * A[k * n + i];
            }
            A[i * n + j] = lower;
            A[j * n + i] = upper / A[j * n + j];
        }
        double diagonal = row_coupling(system, ri, ri);
        diagonal += relax * fabs(diagonal) * s->softness[i];
        for (int32_t k = s->first[i]; k < i; k++) diagonal -= A[i * n + k] * A[k * n + i];
        A[i * n + i] = diagonal;
    }
}

/* residual := the forces that take it away. */
static void substitute(Smooth *s) {
    int32_t n = s->active_count;
    const double *A = s->matrix;
    double *x = s->residual;
    for (int32_t i = 0; i < n; i++) {
        for (int32_t k = s->first[i]; k < i; k++) x[i] -= A[i * n + k] * x[k];
        x[i] /= A[i * n + i];
    }
    for (int32_t i = n - 1; i >= 0; i--)
        for (int32_t k = s->first[i]; k < i; k++) x[k] -= A[k * n + i] * x[i];
}

/* ---------------------------------------------------------------- accelerations */

static void add_force(const System *system, double *acceleration, int32_t i, const double *f, double force) {
    if (i < 0) return;
    const Body *body = &system->world->body[system->member[i]];
    acceleration[3 * i] += force * body->inverse_mass * f[0];
    acceleration[3 * i + 1] += force * body->inverse_mass * f[1];
    acceleration[3 * i + 2] += force * body->inverse_moment * f[2];
}

static double row_of(const Row *row, const double *acceleration) {
    double sum = row->bias;
    for (int i = 0; i < 3; i++) {
        if (row->a >= 0) sum += row->ja[i] * acceleration[3 * row->a + i];
        if (row->b >= 0) sum += row->jb[i] * acceleration[3 * row->b + i];
    }
    return sum;
}

/* The members' accelerations at the system's states into `out` (3 a member), and the contacts' forces. */
static int accelerate(Smooth *s, System *system, double *out) {
    int status = system_place(system);
    if (status != SIM_OK) return status;
    system_find_bias(system);
    for (int32_t i = 0; i < system->count; i++) {
        out[3 * i] = system->world->gravity.x;
        out[3 * i + 1] = system->world->gravity.y;
        out[3 * i + 2] = 0;
    }
    s->evals += 1;
    s->rows += s->active_count;
    memset(s->force, 0, (size_t)s->active_count * sizeof *s->force);
    factor(s, system, s->relax);
    for (int pass = 0; pass < 2; pass++) { /* the second pass takes away what relaxing left */
        for (int32_t i = 0; i < s->active_count; i++) s->residual[i] = -row_of(&system->row[s->active[i]], out);
        substitute(s);
        for (int32_t i = 0; i < s->active_count; i++) {
            const Row *row = &system->row[s->active[i]];
            s->force[i] += s->residual[i];
            add_force(system, out, row->a, row->fa, s->residual[i]);
            add_force(system, out, row->b, row->fb, s->residual[i]);
        }
    }
    for (int32_t k = 0; k < system->contact_count; k++) {
        Contact *c = &system->contact[k];
        int32_t normal = 2 * (system->joint_count + k);
        c->force = s->rank[normal] >= 0 ? s->force[s->rank[normal]] : 0;
        c->along_force = s->rank[normal + 1] >= 0 ? s->force[s->rank[normal + 1]] : -c->slide * c->friction * c->force;
    }
    return SIM_OK;
}

static void load(System *system, const double *y) {
    for (int32_t i = 0; i < system->count; i++, y += 6)
        system->state[i] = (State){vec(y[0], y[1]), y[2], vec(y[3], y[4]), y[5]};
}

static void store(const System *system, double *y) {
    for (int32_t i = 0; i < system->count; i++, y += 6) {
        const State *s = &system->state[i];
        y[0] = s->p.x, y[1] = s->p.y, y[2] = s->angle, y[3] = s->v.x, y[4] = s->v.y, y[5] = s->spin;
    }
}

/* ---------------------------------------------------------------- projection */

static const Placed BACKGROUND = {{{0, 0}, 1, 0}, {0, 0}, 0};

static double position_error(const System *system, int32_t row) {
    const World *world = system->world;
    bool is_joint = row < 2 * system->joint_count;
    int32_t k = is_joint ? row / 2 : (row - 2 * system->joint_count) / 2;
    const Contact *c = is_joint ? NULL : &system->contact[k];
    const Joint *joint = is_joint ? &world->joint[system->joint[k]] : NULL;
    int32_t a = is_joint ? joint->a : c->feature.body_a, b = is_joint ? joint->b : c->feature.body_b;
    const Placed *pa = system->place_of[a] >= 0 ? &system->placed[system->place_of[a]] : &BACKGROUND;
    const Placed *pb = system->place_of[b] >= 0 ? &system->placed[system->place_of[b]] : &BACKGROUND;
    if (is_joint) {
        Vec apart = vsub(place(pa->at, joint->local_a), place(pb->at, joint->local_b));
        return row & 1 ? apart.y : apart.x;
    }
    return row & 1 ? 0 : feature_gap(&c->feature, pa, pb).gap - c->hold;
}

static void move(const System *system, int32_t i, const double *f, double by) {
    if (i < 0) return;
    const Body *body = &system->world->body[system->member[i]];
    State *state = &system->state[i];
    state->p = vmad(state->p, by * body->inverse_mass, vec(f[0], f[1]));
    state->angle += by * body->inverse_moment * f[2];
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
    if (!small) load(system, before);
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
    store(system, s->start);
    double first = 0;
    for (int pass = 0; pass < 3; pass++) {
        int status = place_plain(system);
        if (status != SIM_OK) return status;
        double worst = 0;
        for (int32_t i = 0; i < s->active_count; i++) {
            s->residual[i] = -position_error(system, s->active[i]);
            worst = fmax(worst, fabs(s->residual[i]));
        }
        if (pass == 0) first = worst;
        if (worst <= s->slack.root) break;
        factor(s, system, RELAX_PROJECTION);
        substitute(s);
        for (int32_t i = 0; i < s->active_count; i++) {
            const Row *row = &system->row[s->active[i]];
            move(system, row->a, row->fa, s->residual[i]);
            move(system, row->b, row->fb, s->residual[i]);
        }
    }
    keep_if_small(system, s->start, first);
    return SIM_OK;
}

int smooth_project_velocities(Smooth *s, System *system) {
    int status = place_plain(system);
    if (status != SIM_OK) return status;
    store(system, s->start);
    double first = 0;
    factor(s, system, RELAX_PROJECTION);
    for (int pass = 0; pass < 3; pass++) {
        for (int32_t i = 0; i < s->active_count; i++) {
            s->residual[i] = -row_speed(&system->row[s->active[i]], system->state);
            if (pass == 0) first = fmax(first, fabs(s->residual[i]));
        }
        substitute(s);
        for (int32_t i = 0; i < s->active_count; i++) row_push(system, &system->row[s->active[i]], s->residual[i]);
    }
    keep_if_small(system, s->start, first);
    return SIM_OK;
}

int smooth_project(Smooth *s, System *system, double *left) {
    *left = 0;
    if (s->active_count == 0) return SIM_OK;
    int status = project_positions(s, system);
    if (status == SIM_OK) status = smooth_project_velocities(s, system);
    for (int32_t i = 0; i < s->active_count; i++)
        *left = fmax(*left, fabs(row_speed(&system->row[s->active[i]], system->state)));
    return status;
}

/* ---------------------------------------------------------------- the step */

/* dy/dt at y. */
static int derive(Smooth *s, System *system, const double *y, double *k) {
    load(system, y);
    int status = accelerate(s, system, s->acceleration);
    for (int32_t i = 0; i < system->count; i++)
        for (int c = 0; c < 3; c++) {
            k[6 * i + c] = y[6 * i + 3 + c];
            k[6 * i + 3 + c] = s->acceleration[3 * i + c];
        }
    return status;
}

static int stage(Smooth *s, System *system, int i, double h) {
    int32_t n = 6 * system->count;
    for (int32_t c = 0; c < n; c++) {
        double sum = 0;
        for (int j = 0; j < i; j++) sum += DOP853_A[i][j] * s->k[j][c];
        s->trial[c] = s->start[c] + h * sum;
    }
    return derive(s, system, s->trial, s->k[i]);
}

/* The estimated error of a step, of what is allowed. */
static double step_error(const Smooth *s, const System *system, double h) {
    double fifth = 0, third = 0, allowed = LOCAL * s->tolerance;
    for (int32_t i = 0; i < system->count; i++) {
        double reach = system->world->body[system->member[i]].reach;
        for (int c = 0; c < 6; c++) {
            double e5 = 0, e3 = 0, scale = (c % 3 == 2 ? reach : 1) * (c >= 3 ? VELOCITY_TIME : 1) / allowed;
            for (int j = 0; j < STAGES; j++) {
                e5 += DOP853_E5[j] * s->k[j][6 * i + c];
                e3 += DOP853_E3[j] * s->k[j][6 * i + c];
            }
            fifth += e5 * e5 * scale * scale;
            third += e3 * e3 * scale * scale;
        }
    }
    if (fifth == 0 && third == 0) return 0;
    return h * fifth / sqrt((fifth + 0.01 * third)); /* not averaged over components: each must keep to it */
}

/* The dense output of one component as a polynomial in the part of the step that has passed. */
static void dense(const Smooth *s, int32_t c, double h, double *out) {
    double F[7], delta = s->end[c] - s->start[c], p[MOTION_DEGREE + 1] = {0};
    F[0] = delta;
    F[1] = h * s->k[0][c] - delta;
    F[2] = 2 * delta - h * (s->k[STAGES][c] + s->k[0][c]);
    for (int i = 0; i < 4; i++) {
        F[3 + i] = 0;
        for (int j = 0; j < ALL_STAGES; j++) F[3 + i] += DOP853_D[i][j] * s->k[j][c];
        F[3 + i] *= h;
    }
    for (int i = 6; i >= 0; i--) { /* p := (p + F[i]) times x, or times 1 - x */
        p[0] += F[i];
        for (int d = MOTION_DEGREE; d >= 0; d--) {
            double below = d > 0 ? p[d - 1] : 0;
            p[d] = i % 2 == 0 ? below : p[d] - below;
        }
    }
    p[0] += s->start[c];
    memcpy(out, p, sizeof p);
}

/* How far a contact is from where its mode ends, in each of three ways: its force would pull; it slips, or its slip comes
 * to rest; its point leaves the side. Negative past it; forces are those last found. */
static void mode_ends(const Smooth *s, const System *system, const Contact *c, double scale, double ends[3]) {
    int32_t a = system->place_of[c->feature.body_a], b = system->place_of[c->feature.body_b];
    Gap g =
        feature_gap(&c->feature, a >= 0 ? &system->placed[a] : &BACKGROUND, b >= 0 ? &system->placed[b] : &BACKGROUND);
    ends[0] = c->force / scale + DECISIVE;
    ends[1] = INFINITY;
    if (c->slide != 0)
        ends[1] = c->slide * g.slip + 0.01 * s->slack.speed;
    else if (c->friction > 0)
        ends[1] = (c->friction * c->force - fabs(c->along_force)) / scale + DECISIVE;
    ends[2] = g.margin + s->slack.gap;
}

static double modes_margin(const Smooth *s, const System *system, double scale) {
    double least = INFINITY, ends[3];
    for (int32_t k = 0; k < system->contact_count; k++) {
        const Contact *c = &system->contact[k];
        if (!c->active) continue;
        mode_ends(s, system, c, scale, ends);
        for (int i = 0; i < 3; i++)
            if (!(c->unsure & 1 << i)) least = fmin(least, ends[i]);
    }
    return least;
}

/* Ends that are past before the step begins do not count in it: redundant contacts may share out forces otherwise. */
static bool find_unsure(const Smooth *s, System *system, double scale) {
    bool any = false;
    double ends[3];
    for (int32_t k = 0; k < system->contact_count; k++) {
        Contact *c = &system->contact[k];
        c->unsure = 0;
        if (!c->active) continue;
        mode_ends(s, system, c, scale, ends);
        for (int i = 0; i < 3; i++) c->unsure |= (ends[i] < 0) << i;
        any = any || c->unsure;
    }
    return any;
}

static double margin_at(Smooth *s, System *system, const Motion *motion, double time, double scale) {
    for (int32_t i = 0; i < system->count; i++) system->state[i] = motion_state(&motion[i], time);
    accelerate(s, system, s->acceleration);
    return modes_margin(s, system, scale);
}

/* The first moment of the step past which the modes do not hold, searched on its dense output; INFINITY if there is none. */
static double find_end_of_modes(Smooth *s, System *system, const Motion *motion, double from, double to, double scale) {
    const int parts = 8;
    double before = from, after = to, high = margin_at(s, system, motion, from, scale), low = 0, none = INFINITY;
    if (high < 0) { /* redundant contacts share out forces in another way than when the step was made */
        find_unsure(s, system, scale);
        none = to = fmin(to, from + UNSURE);
        high = modes_margin(s, system, scale);
    }
    bool found = false;
    for (int i = 1; i <= parts && !found; i++) {
        double t = from + (to - from) * i / parts, m = margin_at(s, system, motion, t, scale);
        found = m < 0;
        if (found) {
            after = t, low = m;
        } else {
            before = t, high = m;
        }
    }
    if (!found) return none;
    for (int i = 0; i < 100 && after - before > 1e-13 * (1 + fabs(after)); i++) { /* Illinois, kept off the ends */
        double part = fmin(fmax(high / (high - low), 0.02), 0.98), t = before + (after - before) * part;
        double m = margin_at(s, system, motion, t, scale);
        if (m < 0) {
            after = t, low = m, high *= 0.5;
        } else {
            before = t, high = m, low *= 0.5;
        }
    }
    return after;
}

static double force_scale(const System *system) {
    double scale = 0;
    for (int32_t k = 0; k < system->contact_count; k++) scale = fmax(scale, fabs(system->contact[k].force));
    return scale > 0 ? scale : 1;
}

int smooth_step(Smooth *s, System *system, double from, double *h, Motion *motion, bool *ended) {
    int32_t n = 6 * system->count;
    store(system, s->start);
    find_softness(s, system);
    int status = derive(s, system, s->start, s->k[0]);
    double scale = force_scale(system), margin = INFINITY, step;
    bool unsure = find_unsure(s, system, scale);
    if (unsure) *h = fmin(*h, UNSURE);
    for (int tries = 0;; tries++) {
        step = fmin(*h, LONGEST);
        margin = INFINITY;
        for (int i = 1; i < STAGES && status == SIM_OK; i++) {
            status = stage(s, system, i, step);
            margin = fmin(margin, modes_margin(s, system, scale));
        }
        if (status != SIM_OK) return status;
        double error = step_error(s, system, step);
        double factor = !isfinite(error) ? 0.2 : error > 0 ? 0.9 / sqrt(sqrt(sqrt(error))) : 8;
        *h = step * fmin(fmax(factor, 0.2), 8);
        if (error <= 1 || step < 1e-12) break;
        if (tries == PATIENCE) s->relax = RELAX_MORE;
    }
    for (int32_t c = 0; c < n; c++) {
        double sum = 0;
        for (int j = 0; j < STAGES; j++) sum += DOP853_B[j] * s->k[j][c];
        s->end[c] = s->start[c] + step * sum;
    }
    status = derive(s, system, s->end, s->k[STAGES]);
    margin = fmin(margin, modes_margin(s, system, scale));
    for (int i = STAGES + 1; i < ALL_STAGES && status == SIM_OK; i++) status = stage(s, system, i, step);
    for (int32_t i = 0; i < system->count; i++) {
        Motion *m = &motion[i];
        *m = (Motion){.start = from, .end = from + step, .span = step, .degree = MOTION_DEGREE};
        for (int c = 0; c < 3; c++) {
            dense(s, 6 * i + c, step, m->q[c]);
            dense(s, 6 * i + 3 + c, step, m->v[c]);
        }
        m->speed = motion_bound(m, from, from + step).speed;
    }
    *ended = unsure;
    if (margin < 0) {
        double stop = find_end_of_modes(s, system, motion, from, from + step, scale);
        *ended = unsure || stop <= from + step;
        if (stop <= from + step)
            for (int32_t i = 0; i < system->count; i++) motion[i].end = stop;
    }
    return status;
}
