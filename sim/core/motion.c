#include "motion.h"

State body_state(const Body *body) { return (State){body->position, body->angle, body->velocity, body->spin}; }

void set_body_state(Body *body, const State *state) {
    body->position = state->p;
    body->angle = state->angle;
    body->velocity = state->v;
    body->spin = state->spin;
}

Motion motion_at_rest(const State *state, double time) {
    Motion m = {.start = time, .end = INFINITY, .span = 1, .degree = 0};
    m.q[0][0] = state->p.x, m.q[1][0] = state->p.y, m.q[2][0] = state->angle;
    return m;
}

Motion motion_in_flight(const State *state, double time, Vec gravity) {
    Motion m = motion_at_rest(state, time);
    const double v[3] = {state->v.x, state->v.y, state->spin}, g[3] = {gravity.x, gravity.y, 0};
    m.degree = 2;
    for (int k = 0; k < 3; k++) {
        m.q[k][1] = m.v[k][0] = v[k];
        m.q[k][2] = g[k] / 2;
        m.v[k][1] = g[k];
    }
    return m;
}

static double horner(const double *c, int degree, double x) {
    double sum = c[degree];
    for (int k = degree - 1; k >= 0; k--) sum = sum * x + c[k];
    return sum;
}

State motion_state(const Motion *m, double time) {
    double x = (time - m->start) / m->span;
    int d = m->degree;
    return (State){vec(horner(m->q[0], d, x), horner(m->q[1], d, x)), horner(m->q[2], d, x),
                   vec(horner(m->v[0], d, x), horner(m->v[1], d, x)), horner(m->v[2], d, x)};
}

static double slope(const double *c, int degree, double x) {
    double sum = 0;
    for (int k = degree; k >= 1; k--) sum = sum * x + k * c[k];
    return sum;
}

State motion_acceleration(const Motion *m, double time) {
    double x = (time - m->start) / m->span;
    int d = m->degree;
    Vec a = vec(slope(m->v[0], d, x), slope(m->v[1], d, x));
    return (State){.v = vscale(a, 1 / m->span), .spin = slope(m->v[2], d, x) / m->span};
}

Vec motion_position(const Motion *m, double time) {
    double x = (time - m->start) / m->span;
    return vec(horner(m->q[0], m->degree, x), horner(m->q[1], m->degree, x));
}

Course motion_course(const Motion *m, double from) {
    if (m->degree > 2) return (Course){.position = motion_position(m, from), .speed = m->speed, .stray = m->speed};
    double x = (from - m->start) / m->span;
    Vec fall = vec(m->v[0][1], m->v[1][1]), velocity = vmad(vec(m->v[0][0], m->v[1][0]), x, fall);
    return (Course){motion_position(m, from), velocity, fall, vlength(velocity), vlength(fall), 0};
}

bool course_apart(const Course *a, const Course *b, double time, double reach) {
    Vec apart = vsub(a->position, b->position);
    double way = reach + (a->speed + b->speed) * time + (a->pull + b->pull) * 0.5 * time * time;
    return vdot(apart, apart) > way * way;
}

double course_nearest(const Course *a, const Course *b, double time) {
    Vec first = vsub(a->position, b->position), bend = vscale(vsub(a->fall, b->fall), 0.5 * time * time);
    Vec chord = vmad(bend, time, vsub(a->velocity, b->velocity));
    double square = vdot(chord, chord), along = -vdot(first, chord);
    double share = along <= 0 ? 0 : along >= square ? 1 : along / square;
    /* a parabola strays from its chord by an eighth of its acceleration times the time squared */
    return vlength(vmad(first, share, chord)) - 0.25 * vlength(bend) - (a->stray + b->stray) * time;
}

/* The largest |value|, |slope| and |curvature| of a polynomial for arguments in [0, x]: sums of the coefficients' sizes. */
static void polynomial_bound(const double *c, int degree, double x, double *value, double *slope, double *curvature) {
    double power = 1, before = 0;
    *value = fabs(c[0]);
    *slope = *curvature = 0;
    for (int k = 1; k <= degree; k++) {
        *curvature += k * (k - 1) * fabs(c[k]) * before;
        *slope += k * fabs(c[k]) * power;
        before = power;
        power *= x;
        *value += fabs(c[k]) * power;
    }
}

double motion_fastest(const Motion *m) {
    Vec most = {0, 0};
    for (int k = 0; k <= m->degree; k++) most = vadd(most, vec(fabs(m->v[0][k]), fabs(m->v[1][k])));
    return vlength(most);
}

MotionBound motion_bound(const Motion *m, double from, double to) {
    MotionBound bound = {.is_steady = m->degree <= 2};
    if (m->degree == 0) return bound;
    if (bound.is_steady) {
        bound.spin = fabs(motion_state(m, from).spin);
        bound.steady = vec(m->v[0][1], m->v[1][1]);
        return bound;
    }
    double slope, curvature;
    polynomial_bound(m->v[2], m->degree, (to - m->start) / m->span, &bound.spin, &slope, &curvature);
    bound.spin_acceleration = slope / m->span;
    bound.spin_jerk = curvature / (m->span * m->span);
    return bound;
}

/* The polynomial's coefficients in y, where its argument is at + scale y: Horner's scheme again and again (Shaw and Traub 1974). */
static void shift_polynomial(const double *c, int degree, double at, double scale, double *out) {
    for (int k = 0; k <= degree; k++) out[k] = c[k];
    for (int k = 0; k < degree; k++)
        for (int i = degree - 1; i >= k; i--) out[i] += at * out[i + 1];
    double power = 1;
    for (int k = 0; k <= degree; k++, power *= scale) out[k] *= power;
}

RelativeBound motion_against(const Motion *a, const Motion *b, double from, double to) {
    double value[2], slope[2], curvature[2], span = to - from;
    for (int k = 0; k < 2; k++) {
        double first[MOTION_DEGREE + 1] = {0}, second[MOTION_DEGREE + 1] = {0};
        shift_polynomial(a->v[k], a->degree, (from - a->start) / a->span, span / a->span, first);
        shift_polynomial(b->v[k], b->degree, (from - b->start) / b->span, span / b->span, second);
        for (int i = 0; i <= MOTION_DEGREE; i++) first[i] -= second[i];
        polynomial_bound(first, MOTION_DEGREE, 1, &value[k], &slope[k], &curvature[k]);
    }
    return (RelativeBound){vlength(vec(value[0], value[1])), vlength(vec(slope[0], slope[1])) / span,
                           vlength(vec(curvature[0], curvature[1])) / (span * span)};
}
