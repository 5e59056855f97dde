#include "smooth.h"

#include <stdlib.h>
#include <string.h>

#define LOCAL 0.02            /* the part of the tolerance that one step may err by */
#define RELAX 1e-10        /* makes redundant rows solvable; refinement takes its effect away again */
#define RELAX_MORE 1e-7    /* the same where rows that nearly repeat each other keep a step from converging */
#define PATIENCE 3         /* tries of a step before that is taken to be so */
#define DECISIVE 1e-9         /* how far past its limit a force is when its event is taken, of the forces about */
#define UNSURE 0.02       /* forces that redundant contacts may share out otherwise: ask again after this time [s] */
#define ROOT_TIME 1e-13  /* how exactly the end of a mode is found [s], and as a part of the time */
#define SAFETY 0.9         /* of the length that would just do */
#define LONGEST 2.0       /* a step [s]: within it, the ends of contacts' modes are looked for at the stages */
#define VELOCITY_TIME 1.0 /* an error in velocity counts as what it moves a body by in this time [s] */

int smooth_create(Smooth *s, const World *world, double tolerance, Slack slack) {
    *s = (Smooth){.tolerance = tolerance, .slack = slack};
    size_t n = 6 * (size_t)world->body_count;
    double *block = malloc((ALL_STAGES + DENSE + 4) * n * sizeof *block);
    if (!block) return SIM_OUT_OF_MEMORY;
    s->block = s->start = block;
    s->trial = block + n;
    s->end = block + 2 * n;
    s->acceleration = block + 3 * n;
    for (size_t i = 0; i < ALL_STAGES; i++) s->k[i] = block + (4 + i) * n;
    for (size_t i = 0; i < DENSE; i++) s->dense[i] = block + (4 + ALL_STAGES + i) * n;
    return SIM_OK;
}

void smooth_destroy(Smooth *s) {
    free(s->block);
    active_destroy(&s->active);
    *s = (Smooth){0};
}

/* ---------------------------------------------------------------- accelerations */

int smooth_prepare(Smooth *s, System *system) {
    int status = system_place(system);
    return status == SIM_OK ? active_choose(&s->active, system) : status;
}

/* How much softer than the others each row may be in a step: where sticking contacts share a load in more than one way,
 * friction goes to those that press as it begins, as Coulomb's law wants. */
static void find_softness(Smooth *s, const System *system) {
    double most = 0;
    for (int32_t k = 0; k < system->contact_count; k++) most = fmax(most, system->contact[k].force);
    for (int32_t i = 0; i < s->active.count && most > 0; i++) {
        int32_t k = s->active.pair[i] - system->joint_count;
        if (k >= 0) s->active.softness[2 * i + 1] = most / fmax(system->contact[k].force, 1e-4 * most);
    }
}

/* Factor the rows' matrix as it is; from where it turns out that rows repeat each other on, relaxed. */
static Condition factor(Smooth *s, const System *system) {
    Condition condition = active_factor(&s->active, system, s->relax);
    if (condition != REDUNDANT || s->relax > 0) return condition;
    s->relax = RELAX;
    return active_factor(&s->active, system, s->relax);
}

/* What the rows lack of the accelerations that they want. */
static void find_lacking(const Active *active, const System *system, const double *acceleration) {
    for (int32_t i = 0; i < 2 * active->count; i++) {
        const Row *row = active_row(active, system, i);
        active->unknown[i] = row ? -row_acceleration(row, acceleration) : 0;
    }
}

/* Add the accelerations that the unknown forces make. */
static void push_members(const Active *active, const System *system, double *acceleration) {
    for (int32_t i = 0; i < active->count; i++) {
        const RowPair *rows = &active->rows[i];
        double f0 = active->unknown[2 * i], f1 = active->unknown[2 * i + 1];
        active->force[2 * i] += f0;
        active->force[2 * i + 1] += f1;
        for (int side = 0; side < 2; side++) {
            int32_t member = system->row[2 * active->pair[i]].member[side];
            if (member < 0) continue;
            double *of = acceleration + 3 * member;
            for (int c = 0; c < 3; c++) of[c] += f0 * rows->weight[0][side][c] + f1 * rows->weight[1][side][c];
        }
    }
}

/* The members' accelerations at the system's states into `out` (3 a member), and the contacts' forces. */
static int accelerate(Smooth *s, System *system, double *out) {
    int status = system_place(system);
    if (status != SIM_OK) return status;
    for (int32_t i = 0; i < system->count; i++) {
        out[3 * i] = system->world->gravity.x;
        out[3 * i + 1] = system->world->gravity.y;
        out[3 * i + 2] = 0;
    }
    s->evals += 1;
    Active *active = &s->active;
    s->rows += 2 * active->count;
    memset(active->force, 0, 2 * (size_t)active->count * sizeof *active->force);
    int passes = factor(s, system) == SOUND ? 1 : 2; /* the second takes away what relaxing and rounding left */
    for (int pass = 0; pass < passes; pass++) {
        find_lacking(active, system, out);
        active_solve(active);
        push_members(active, system, out);
    }
    for (int32_t k = 0; k < system->contact_count; k++) {
        Contact *c = &system->contact[k];
        int32_t i = active->rank[system->joint_count + k];
        c->force = i >= 0 ? active->force[2 * i] : 0;
        bool sticks = i >= 0 && active->holds[2 * i + 1];
        c->along_force = sticks ? active->force[2 * i + 1] : -c->slide * c->friction * c->force;
    }
    return SIM_OK;
}

/* ---------------------------------------------------------------- the step */

/* dy/dt at y. */
static int derive(Smooth *s, System *system, const double *y, double *k) {
    system_load(system, y);
    int status = accelerate(s, system, s->acceleration);
    for (int32_t i = 0; i < system->count; i++)
        for (int c = 0; c < 3; c++) {
            k[6 * i + c] = y[6 * i + 3 + c];
            k[6 * i + 3 + c] = s->acceleration[3 * i + c];
        }
    return status;
}

/* out := base + h times the sum of the stages' slopes with these weights: all components of a stage at once, as they lie. */
static void combine(const Smooth *s, const double *weight, int count, double h, const double *base, int32_t n,
                    double *restrict out) {
    if (base)
        memcpy(out, base, (size_t)n * sizeof *out);
    else
        memset(out, 0, (size_t)n * sizeof *out);
    for (int j = 0; j < count; j++) {
        const double *k = s->k[j], part = h * weight[j];
        if (weight[j] == 0) continue;
        for (int32_t c = 0; c < n; c++) out[c] += part * k[c];
    }
}

static int stage(Smooth *s, System *system, int i, double h) {
    combine(s, DOP853_A[i], i, h, s->start, 6 * system->count, s->trial);
    return derive(s, system, s->trial, s->k[i]);
}

/* The estimated error of a step, of what is allowed. */
static double step_error(const Smooth *s, const System *system, double h) {
    double fifth = 0, third = 0, allowed = LOCAL * s->tolerance;
    double *error5 = s->trial, *error3 = s->end;
    combine(s, DOP853_E5, STAGES, 1, NULL, 6 * system->count, error5);
    combine(s, DOP853_E3, STAGES, 1, NULL, 6 * system->count, error3);
    for (int32_t i = 0; i < system->count; i++) {
        double reach = system->world->body[system->member[i]].reach;
        for (int c = 0; c < 6; c++) {
            double scale = (c % 3 == 2 ? reach : 1) * (c >= 3 ? VELOCITY_TIME : 1) / allowed;
            double e5 = error5[6 * i + c], e3 = error3[6 * i + c];
            fifth += e5 * e5 * scale * scale;
            third += e3 * e3 * scale * scale;
        }
    }
    if (fifth == 0 && third == 0) return 0;
    return h * fifth / sqrt((fifth + 0.01 * third)); /* not averaged over components: each must keep to it */
}

/* The dense output's terms of higher order, of all components. */
static void find_dense(const Smooth *s, double h, int32_t n) {
    for (int i = 0; i < DENSE; i++) combine(s, DOP853_D[i], ALL_STAGES, h, NULL, n, s->dense[i]);
}

/* The dense output of one component as a polynomial in the part of the step that has passed. */
static void dense(const Smooth *s, int32_t c, double h, double *out) {
    double F[7], delta = s->end[c] - s->start[c], p[MOTION_DEGREE + 1] = {0};
    F[0] = delta;
    F[1] = h * s->k[0][c] - delta;
    F[2] = 2 * delta - h * (s->k[STAGES][c] + s->k[0][c]);
    for (int i = 0; i < DENSE; i++) F[3 + i] = s->dense[i][c];
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

static bool sticks(const Contact *c) { return c->active && c->slide == 0 && c->friction > 0; }

/* What is left of Coulomb's cone for a sticking contact [N].  Contacts of two bodies that stick along one line share their
 * friction out as it comes: all that it does, and all that is known of it, is its sum. */
static double cone_left(const Smooth *s, const System *system, const Contact *of) {
    const Gap *gap = &of->gap;
    double most = of->friction * of->force, along = of->along_force;
    for (int32_t k = 0; k < system->contact_count; k++) {
        const Contact *c = &system->contact[k];
        const Feature *f = &c->feature, *g = &of->feature;
        bool same = f->body_a == g->body_a && f->body_b == g->body_b,
             turned = f->body_a == g->body_b && f->body_b == g->body_a;
        if (c == of || !sticks(c) || !(same || turned)) continue;
        if (fabs(vcross(c->gap.along, gap->along)) > 1e-6) continue;
        if (fabs(vdot(vsub(c->gap.point, gap->point), gap->normal)) > 8 * s->slack.gap) continue;
        double way = vdot(c->gap.along, gap->along);
        most += c->friction * c->force;
        along += (same ? way : -way) * c->along_force;
    }
    return most - fabs(along);
}

/* How far a contact is from where its mode ends, in each of three ways: its force would pull; it slips, or its slip comes
 * to rest; its point leaves the side. Negative past it; forces are those last found. */
static void mode_ends(const Smooth *s, const System *system, const Contact *c, double scale, double ends[3]) {
    ends[0] = c->force / scale + DECISIVE;
    ends[1] = INFINITY;
    if (c->slide != 0)
        ends[1] = c->slide * c->gap.slip + 0.01 * s->slack.speed;
    else if (c->friction > 0)
        ends[1] = cone_left(s, system, c) / scale + DECISIVE;
    ends[2] = c->gap.margin + s->slack.gap;
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

/* Where a margin that is `high` >= 0 before and `low` < 0 after becomes negative: inverse quadratic interpolation where
 * that is safe, else bisection (Chandrupatla 1997). Returns the far end of the last bracket. */
static double find_root_of_margin(Smooth *s, System *system, const Motion *motion, double before, double high,
                                  double after, double low, double scale) {
    double a = after, fa = low, b = before, fb = high, c = b, fc = fb, part = 0.5;
    for (int i = 0; i < 100; i++) {
        double least = ROOT_TIME * (1 + fabs(after)) / fabs(b - a);
        if (least > 0.5) break;
        double t = a + fmin(fmax(part, least), 1 - least) * (b - a), m = margin_at(s, system, motion, t, scale);
        if ((m < 0) == (fa < 0)) {
            c = a, fc = fa;
        } else {
            c = b, fc = fb, b = a, fb = fa;
        }
        a = t, fa = m;
        after = fa < 0 ? a : b;
        double x = (a - b) / (c - b), y = (fa - fb) / (fc - fb);
        part = 0.5;
        if (y * y < x && (1 - y) * (1 - y) < 1 - x)
            part = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb);
    }
    return after;
}

/* The first moment of the step past which the modes do not hold, searched on its dense output from `sound` on, up to
 * which they seem to; INFINITY if there is none. */
static double find_end_of_modes(Smooth *s, System *system, const Motion *motion, double sound, double scale) {
    const int parts = 8;
    double from = motion->start, to = motion->end, none = INFINITY;
    double before = sound, high = margin_at(s, system, motion, sound, scale);
    if (high < 0 && sound > from) before = from, high = margin_at(s, system, motion, from, scale);
    if (high < 0) { /* redundant contacts share out forces in another way than when the step was made */
        find_unsure(s, system, scale);
        none = to = fmin(to, from + UNSURE);
        high = modes_margin(s, system, scale);
    }
    for (int i = 1; i <= parts; i++) {
        double t = from + (to - from) * i / parts;
        if (t <= before) continue;
        double m = margin_at(s, system, motion, t, scale);
        if (m < 0) return find_root_of_margin(s, system, motion, before, high, t, m, scale);
        before = t, high = m;
    }
    return none;
}

static double force_scale(const System *system) {
    double scale = 0;
    for (int32_t k = 0; k < system->contact_count; k++) scale = fmax(scale, fabs(system->contact[k].force));
    return scale > 0 ? scale : 1;
}

static double eighth_root(double x) { return sqrt(sqrt(sqrt(x))); }

/* The length to try after a step with this error: errors grow as its eighth power.  Where they grow from step to step
 * beyond that, they are taken to go on so (Gustafsson 1994): a step that is tried in vain costs as much as one that is made. */
static double next_length(const Pace *pace, double step, double error) {
    if (!isfinite(error)) return 0.2 * step;
    if (error == 0) return 8 * step;
    double factor = SAFETY / eighth_root(error);
    if (error <= 1 && pace->error > 0) factor *= fmin(1, step / pace->last * eighth_root(pace->error / error));
    return step * fmin(fmax(factor, 0.2), 8);
}

/* The slopes at the start: those at the end of the island's last step, if it has not been moved since. */
static int find_first_slopes(Smooth *s, System *system, double from, const Pace *pace) {
    bool known = s->known_of == pace && s->known_at == from && pace->last > 0 && system->contact_count == 0;
    s->known_of = NULL;
    if (!known) return derive(s, system, s->start, s->k[0]);
    double *first = s->k[0];
    s->k[0] = s->k[STAGES];
    s->k[STAGES] = first;
    return SIM_OK;
}

int smooth_step(Smooth *s, System *system, double from, Pace *pace, Motion *motion, bool *ended) {
    int32_t n = 6 * system->count;
    system_store(system, s->start);
    find_softness(s, system);
    int status = find_first_slopes(s, system, from, pace);
    double scale = force_scale(system), broken = INFINITY, step; /* the part of it where the modes may end */
    bool unsure = find_unsure(s, system, scale);
    if (unsure) pace->step = fmin(pace->step, UNSURE);
    for (int tries = 0;; tries++) {
        step = fmin(pace->step, LONGEST);
        broken = INFINITY;
        for (int i = 1; i < STAGES && status == SIM_OK; i++) {
            status = stage(s, system, i, step);
            if (modes_margin(s, system, scale) < 0) broken = fmin(broken, DOP853_C[i]);
        }
        if (status != SIM_OK) return status;
        double error = step_error(s, system, step);
        double next = next_length(pace, step, error);
        pace->step = tries > 0 ? fmin(next, step) : next;
        if (error <= 1 || step < 1e-12) {
            pace->last = step, pace->error = error;
            break;
        }
        if (tries == PATIENCE) s->relax = RELAX_MORE;
    }
    combine(s, DOP853_B, STAGES, step, s->start, n, s->end);
    status = derive(s, system, s->end, s->k[STAGES]);
    if (modes_margin(s, system, scale) < 0) broken = fmin(broken, 1);
    for (int i = STAGES + 1; i < ALL_STAGES && status == SIM_OK; i++) status = stage(s, system, i, step);
    find_dense(s, step, n);
    for (int32_t i = 0; i < system->count; i++) {
        Motion *m = &motion[i];
        *m = (Motion){.start = from, .end = from + step, .span = step, .degree = MOTION_DEGREE};
        for (int c = 0; c < 3; c++) {
            dense(s, 6 * i + c, step, m->q[c]);
            dense(s, 6 * i + 3 + c, step, m->v[c]);
        }
        m->speed = motion_fastest(m);
    }
    pace->relax = s->relax;
    s->known_of = pace;
    s->known_at = from + step;
    *ended = unsure;
    if (broken <= 1) {
        double sound = 0;
        for (int i = 1; i < STAGES; i++)
            if (DOP853_C[i] < broken) sound = fmax(sound, DOP853_C[i]);
        double stop = find_end_of_modes(s, system, motion, from + step * sound, scale);
        *ended = unsure || stop <= from + step;
        if (stop <= from + step)
            for (int32_t i = 0; i < system->count; i++) motion[i].end = stop;
    }
    return status;
}
