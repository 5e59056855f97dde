#include "smooth.h"

#include <stdlib.h>
#include <string.h>

#define LOCAL 0.04            /* the part of the tolerance that one step may err by */
#define RELAX 1e-10        /* makes redundant rows solvable; refinement takes its effect away again */
#define RELAX_MORE 1e-7    /* the same where rows that nearly repeat each other keep a step from converging */
#define PATIENCE 3         /* tries of a step before that is taken to be so */
#define DECISIVE 1e-9         /* how far past its limit a force is when its event is taken, of the forces about */
#define UNSURE 0.02       /* forces that redundant contacts may share out otherwise: ask again after this time [s] */
#define ROOT_TIME 1e-13  /* how exactly the end of a mode is found [s], and as a part of the time */
#define SAFETY 0.9         /* of the length that would just do */
#define FARTHEST 2.0       /* times the last step: beyond that, its start says little of a step */
#define LAST_TERM 0.3      /* of the tolerance: how large an interpolation's last term may be */
#define LONGEST 2.0       /* a step [s]: within it, the ends of contacts' modes are looked for at the stages */

int smooth_create(Smooth *s, const World *world, double tolerance, Slack slack) {
    *s = (Smooth){.tolerance = tolerance, .slack = slack};
    size_t n = 6 * (size_t)world->body_count;
    double *block = malloc((ALL_STAGES + DENSE + 6) * n * sizeof *block);
    if (!block) return SIM_OUT_OF_MEMORY;
    s->block = s->start = block;
    s->before = block + n;
    s->trial = block + 2 * n;
    s->end = block + 3 * n;
    s->acceleration = block + 4 * n;
    s->slopes_before = block + 5 * n;
    for (size_t i = 0; i < ALL_STAGES; i++) s->k[i] = block + (6 + i) * n;
    for (size_t i = 0; i < DENSE; i++) s->dense[i] = block + (6 + ALL_STAGES + i) * n;
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
    s->relax = active_is_symmetric(system) ? RELAX : RELAX_MORE;
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

/* The step as polynomials in the part of it that has passed, from stages that are made for that. */
static int find_dense(Smooth *s, System *system, double h, Motion *motion) {
    int status = SIM_OK;
    for (int i = STAGES + 1; i < ALL_STAGES && status == SIM_OK; i++) status = stage(s, system, i, h);
    for (int i = 0; i < DENSE; i++) combine(s, DOP853_D[i], ALL_STAGES, h, NULL, 6 * system->count, s->dense[i]);
    for (int32_t c = 0; c < 6 * system->count; c++) {
        Motion *m = &motion[c / 6];
        double delta = s->end[c] - s->start[c], *p = c % 6 < 3 ? m->q[c % 6] : m->v[c % 6 - 3];
        double F[3 + DENSE] = {delta, h * s->k[0][c] - delta, 2 * delta - h * (s->k[STAGES][c] + s->k[0][c])};
        for (int i = 0; i < DENSE; i++) F[3 + i] = s->dense[i][c];
        memset(p, 0, sizeof m->q[0]);
        for (int i = 2 + DENSE; i >= 0; i--) { /* p := (p + F[i]) times x, or times 1 - x */
            p[0] += F[i];
            for (int d = MOTION_DEGREE; d >= 0; d--) {
                double below = d > 0 ? p[d - 1] : 0;
                p[d] = i % 2 == 0 ? below : p[d] - below;
            }
        }
        p[0] += s->start[c];
    }
    return status;
}

/* The polynomial with value, slope and second derivative `at` 0, 1 and -r: Hermite's of the first two, and u^3 times what is
 * quadratic, which those do not feel, with u = x (x - 1). */
static void interpolate(const double at[3][3], double r, double *p) {
    double d = at[1][0] - at[0][0] - at[0][1] - at[0][2] / 2, e = at[1][1] - at[0][1] - at[0][2],
           f = at[1][2] - at[0][2];
    double c[] = {
        at[0][0], at[0][1], at[0][2] / 2, 10 * d - 4 * e + f / 2, 7 * e - 15 * d - f, 6 * d - 3 * e + f / 2, 0, 0, 0};
    double off = at[2][0], slope = at[2][1], bend = at[2][2], x = 1; /* what at -r is not as wanted */
    for (int k = 0; k <= 5; k++, x *= -r) off -= c[k] * x;
    x = 1;
    for (int k = 1; k <= 5; k++, x *= -r) slope -= k * c[k] * x;
    x = 1;
    for (int k = 2; k <= 5; k++, x *= -r) bend -= k * (k - 1) * c[k] * x;
    double u = r * (1 + r), du = -(1 + 2 * r), w = u * u * u, dw = 3 * u * u * du, ddw = 6 * u * (du * du + u);
    double g = off / w, dg = (slope - dw * g) / w, ddg = (bend - 2 * dw * dg - ddw * g) / w; /* the quadratic, there */
    double g2 = ddg / 2, g1 = dg + 2 * g2 * r, g0 = g + g1 * r - g2 * r * r;
    c[3] -= g0, c[4] += 3 * g0 - g1, c[5] += 3 * g1 - 3 * g0 - g2;
    c[6] = g0 - 3 * g1 + 3 * g2, c[7] = g1 - 3 * g2, c[8] = g2;
    memcpy(p, c, sizeof c);
}

/* The same of a step that goes on from one of length `last`: through its ends and the start of the last one, each with speeds and
 * accelerations.  That is free; speeds are the slopes of positions.  Whether its last terms are so small that nothing is
 * missed by it. */
static bool continue_dense(const Smooth *s, const System *system, double h, double last, Motion *motion) {
    double largest = 0;
    for (int32_t i = 0; i < system->count; i++)
        for (int c = 0; c < 3; c++) {
            int32_t q = 6 * i + c, v = q + 3;
            const double at[3][3] = {{s->start[q], h * s->start[v], h * h * s->k[0][v]},
                                     {s->end[q], h * s->end[v], h * h * s->k[STAGES][v]},
                                     {s->before[q], h * s->before[v], h * h * s->slopes_before[v]}};
            double *p = motion[i].q[c], reach = c == 2 ? system->world->body[system->member[i]].reach : 1;
            interpolate(at, last / h, p);
            for (int d = 0; d < MOTION_DEGREE; d++) motion[i].v[c][d] = (d + 1) * p[d + 1] / h;
            motion[i].v[c][MOTION_DEGREE] = 0;
            largest = fmax(largest, fabs(p[MOTION_DEGREE]) * reach);
        }
    return largest <= LAST_TERM * s->tolerance;
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

/* Begin a step where the system is: what was the last one becomes what was before, and where it goes on as that ended, the slopes
 * are known. */
static int begin(Smooth *s, System *system, bool goes_on) {
    double *before = s->before, *slopes = s->slopes_before;
    s->before = s->start, s->start = before;
    s->slopes_before = s->k[0], s->k[0] = s->k[STAGES], s->k[STAGES] = slopes;
    system_store(system, s->start);
    find_softness(s, system);
    bool known = goes_on && !s->projected && system->contact_count == 0;
    return known ? SIM_OK : derive(s, system, s->start, s->k[0]);
}

/* Make the stages of a step of the length to try, and of shorter ones until the error is allowed.  *broken becomes the part of the
 * step at which a mode seems to have ended, or stays INFINITY. */
static int make_stages(Smooth *s, System *system, Pace *pace, double scale, double *broken) {
    int status = SIM_OK;
    for (int tries = 0;; tries++) {
        double step = fmin(pace->step, LONGEST);
        *broken = INFINITY;
        for (int i = 1; i < STAGES && status == SIM_OK; i++) {
            status = stage(s, system, i, step);
            if (modes_margin(s, system, scale) < 0) *broken = fmin(*broken, DOP853_C[i]);
        }
        if (status != SIM_OK) return status;
        double error = step_error(s, system, step), next = next_length(pace, step, error);
        pace->step = tries > 0 ? fmin(next, step) : next;
        if (error <= 1 || step < 1e-12) {
            pace->last = step, pace->error = error;
            break;
        }
        if (tries == PATIENCE) s->relax = RELAX_MORE;
    }
    combine(s, DOP853_B, STAGES, pace->last, s->start, 6 * system->count, s->end);
    status = derive(s, system, s->end, s->k[STAGES]);
    if (modes_margin(s, system, scale) < 0) *broken = fmin(*broken, 1);
    return status;
}

/* The step as motions of the members. It goes on from one of length `last`, or from none: 0. */
static int make_motions(Smooth *s, System *system, double from, double step, double last, Motion *motion) {
    int status = SIM_OK;
    for (int32_t i = 0; i < system->count; i++)
        motion[i] = (Motion){.start = from, .end = from + step, .span = step, .degree = MOTION_DEGREE};
    bool free = step <= FARTHEST * last && system->contact_count == 0; /* contacts' modes end within steps */
    if (!free || !continue_dense(s, system, step, last, motion)) status = find_dense(s, system, step, motion);
    for (int32_t i = 0; i < system->count; i++) motion[i].speed = motion_fastest(&motion[i]);
    return status;
}

int smooth_step(Smooth *s, System *system, double from, Pace *pace, Motion *motion, bool *ended) {
    bool goes_on = s->latest == pace && s->latest_end == from && pace->last > 0;
    double last = goes_on ? pace->last : 0, broken;
    s->latest = NULL;
    int status = begin(s, system, goes_on);
    double scale = force_scale(system);
    bool unsure = find_unsure(s, system, scale);
    if (unsure) pace->step = fmin(pace->step, UNSURE);
    if (status == SIM_OK) status = make_stages(s, system, pace, scale, &broken);
    if (status == SIM_OK) status = make_motions(s, system, from, pace->last, last, motion);
    if (status != SIM_OK) return status;
    pace->relax = s->relax;
    s->latest = pace;
    s->latest_end = from + pace->last;
    s->projected = false;
    *ended = unsure;
    if (broken > 1) return SIM_OK;
    double sound = 0;
    for (int i = 1; i < STAGES; i++)
        if (DOP853_C[i] < broken) sound = fmax(sound, DOP853_C[i]);
    double stop = find_end_of_modes(s, system, motion, from + pace->last * sound, scale);
    if (stop > s->latest_end) return SIM_OK;
    for (int32_t i = 0; i < system->count; i++) motion[i].end = stop;
    *ended = true;
    return SIM_OK;
}
