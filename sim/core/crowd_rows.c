/* Sequential impulses with substeps (Catto, "Solver2D", 2024).
 *
 * A pass goes through the rows in order and applies what each still lacks, with the sum clamped (contact: no pull;
 * friction: Coulomb's cone).  Contacts are rigid: soft ones sag under a pile by its load over their stiffness.  Overlap is
 * taken out of the positions themselves (nonlinear Gauss-Seidel), never by velocities: a jam gains no energy from it.
 */
#include "crowd_rows.h"

#include "broad.h"

static const double RATE = 0.6; /* share of an overlap that a pass drives out */

static inline Two two(Vec v) { return (Two){v.x, v.y}; }
static inline Two both(double x) { return (Two){x, x}; }
static inline Two swapped(Two x) { return (Two){x[1], x[0]}; }
static inline double sum_of(Two x) { return x[0] + x[1]; }

/* A contact's two bodies while its rows are solved, held in registers: through pointers every store might change the rest. */
typedef struct Meeting {
    Two velocity_a, velocity_b; /* x, y */
    double spin_a, spin_b;
} Meeting;

static inline Meeting meet(const Mover *a, const Mover *b) {
    return (Meeting){two(a->velocity), two(b->velocity), a->spin, b->spin};
}

static inline void leave(const Meeting *m, Mover *a, Mover *b) {
    a->velocity = vec(m->velocity_a[0], m->velocity_a[1]);
    a->spin = m->spin_a;
    b->velocity = vec(m->velocity_b[0], m->velocity_b[1]);
    b->spin = m->spin_b;
}

static inline Two normal_of(const Contact *c) { return two(c->normal); }
static inline Two tangent_of(const Contact *c) { return (Two){-c->normal.y, c->normal.x}; }

static inline void push(const Contact *c, Meeting *m, Two direction, double impulse, double twist_a, double twist_b) {
    m->velocity_a -= both(impulse * c->inverse_mass_a) * direction;
    m->spin_a -= c->inverse_moment_a * twist_a;
    m->velocity_b += both(impulse * c->inverse_mass_b) * direction;
    m->spin_b += c->inverse_moment_b * twist_b;
}

static inline void push_normal(const Contact *c, Meeting *m, Two impulse) {
    push(c, m, normal_of(c), sum_of(impulse), sum_of(c->spin_na * impulse), sum_of(c->spin_nb * impulse));
}

static inline void push_tangent(const Contact *c, Meeting *m, double impulse) {
    push(c, m, tangent_of(c), impulse, c->spin_ta * impulse, c->spin_tb * impulse);
}

/* At which the points of b leave those of a. */
static inline Two normal_speed(const Contact *c, const Meeting *m) {
    double v = sum_of(normal_of(c) * (m->velocity_b - m->velocity_a));
    return both(v) + both(m->spin_b) * c->spin_nb - both(m->spin_a) * c->spin_na;
}

static inline double tangent_speed(const Contact *c, const Meeting *m) {
    double v = sum_of(tangent_of(c) * (m->velocity_b - m->velocity_a));
    return v + m->spin_b * c->spin_tb - m->spin_a * c->spin_ta;
}

/* The second order of how the gaps change as two bodies turn by the angles and move apart by `apart` along the side: the
 * corner goes on a circle, the side turns away under it. */
static inline Two second_order(const Contact *c, double turned_a, double turned_b, double apart) {
    Two a = both(turned_a) * c->along_na, b = both(turned_b) * c->along_nb, half = both(0.5);
    Two squares_a = half * both(turned_a) * a, squares_b = half * both(turned_b) * b;
    if (c->side > 0) return both(turned_a) * (b + both(apart)) - squares_a - squares_b;
    if (c->side < 0) return squares_a + squares_b - both(turned_b) * (a - both(apart));
    return squares_a - squares_b;
}

/* When the bodies have moved and turned so in the frame. */
static inline Two separation_at(const Contact *c, Vec apart, double turned_a, double turned_b) {
    return c->separation + both(vdot(apart, c->normal)) + both(turned_b) * c->spin_nb - both(turned_a) * c->spin_na +
           second_order(c, turned_a, turned_b, vcross(c->normal, apart));
}

static inline Two separation(const Contact *c, const Mover *a, const Mover *b) {
    return separation_at(c, vsub(b->moved, a->moved), a->turned, b->turned);
}

Two contact_separation(const Contact *c, const Mover *a, const Mover *b) { return separation(c, a, b); }

static inline void set_limit(Contact *c, Two gap, double inverse_dt) {
    c->limit = (Two){gap[0] > 0 ? -gap[0] * inverse_dt : 0, gap[1] > 0 ? -gap[1] * inverse_dt : 0};
}

void contacts_limit(Contact *contact, int32_t count, const Mover *mover, double dt) {
    for (int32_t i = 0; i < count; i++) {
        Contact *c = &contact[i];
        set_limit(c, separation(c, &mover[c->a], &mover[c->b]), 1 / dt);
    }
}

void contacts_warm_start(Contact *contact, int32_t count, Mover *mover) {
    for (int32_t i = 0; i < count; i++) {
        Contact *c = &contact[i];
        if (c->impulse_n[0] == 0 && c->impulse_n[1] == 0 && c->impulse_t == 0) continue;
        Mover *a = &mover[c->a], *b = &mover[c->b];
        Meeting m = meet(a, b);
        push_normal(c, &m, c->impulse_n);
        push_tangent(c, &m, c->impulse_t);
        leave(&m, a, b);
    }
}

bool contacts_measure(Contact *contact, int32_t count, const Mover *mover, double threshold) {
    bool any = false;
    for (int32_t i = 0; i < count; i++) {
        Contact *c = &contact[i];
        c->approach = both(0);
        if (c->impulse_n[0] > 0 && (c->impulse_n[1] > 0 || c->count < 2)) continue;
        Meeting m = meet(&mover[c->a], &mover[c->b]);
        Two v = normal_speed(c, &m);
        for (int32_t k = 0; k < c->count; k++) {
            if (c->impulse_n[k] > 0 || v[k] >= -threshold) continue;
            c->approach[k] = v[k];
            any = true;
        }
    }
    return any;
}

static inline void solve_friction(Contact *c, Meeting *m, double pressed) {
    if (pressed == 0 && c->impulse_t == 0) return;
    double most = c->friction * pressed;
    double sum = c->impulse_t - c->mass_t * tangent_speed(c, m);
    sum = sum > most ? most : sum < -most ? -most : sum;
    double impulse = sum - c->impulse_t;
    c->impulse_t = sum;
    push_tangent(c, m, impulse);
}

/* Bring the normal velocity of a point to what is wanted, without pulling. Returns the impulse. */
static inline double solve_normal(Contact *c, int32_t k, Meeting *m, double wanted) {
    double sum = c->impulse_n[k] - c->mass_n[k] * (normal_speed(c, m)[k] - wanted);
    sum = sum > 0 ? sum : 0;
    double impulse = sum - c->impulse_n[k];
    if (impulse == 0) return 0;
    c->impulse_n[k] = sum;
    push(c, m, normal_of(c), impulse, c->spin_na[k] * impulse, c->spin_nb[k] * impulse);
    return impulse;
}

/* Rolling resistance: a torque against the spin between the two, as strong as the normal force on a short lever. */
static inline void solve_rolling(const Contact *c, Meeting *m, double pressed) {
    double most = c->rolling * pressed;
    double wanted = (m->spin_a - m->spin_b) * c->twist_mass;
    wanted = wanted > most ? most : wanted < -most ? -most : wanted;
    m->spin_a -= c->inverse_moment_a * wanted;
    m->spin_b += c->inverse_moment_b * wanted;
}

/* Both normal rows of a contact at once, so that neither end of a box goes first: the linear complementarity problem of two
 * rows by its four cases (Catto's Box2D). Returns the larger change of a point's velocity by its own impulse. */
static inline double solve_pair(Contact *c, Meeting *m) {
    Two k = c->mobility, k12 = both(c->coupling), had = c->impulse_n;
    /* what the velocities would be, beyond the limits, without the impulses so far */
    Two free = normal_speed(c, m) - c->limit - k * had - k12 * swapped(had);
    Two impulse = (k12 * swapped(free) - swapped(k) * free) * both(c->pair_mass);
    if (impulse[0] < 0 || impulse[1] < 0) {
        Two alone = -free * c->mass_n;
        if (alone[0] >= 0 && c->coupling * alone[0] + free[1] >= 0)
            impulse = (Two){alone[0], 0};
        else if (alone[1] >= 0 && c->coupling * alone[1] + free[0] >= 0)
            impulse = (Two){0, alone[1]};
        else
            impulse = both(0);
    }
    Two change = impulse - had;
    c->impulse_n = impulse;
    push_normal(c, m, change);
    change *= k;
    return larger(fabs(change[0]), fabs(change[1]));
}

bool contacts_solve(Contact *contact, int32_t count, Mover *mover, double dt, int64_t *heat, int64_t pass, bool first) {
    bool heated = false;
    for (int32_t i = 0; i < count; i++) {
        Contact *c = &contact[i];
        if (!first && heat[c->a] < pass - 1 && heat[c->b] < pass - 1) continue;
        Mover *a = &mover[c->a], *b = &mover[c->b];
        Meeting m = meet(a, b);
        double change = 0;
        if (c->pair_mass > 0) {
            change = solve_pair(c, &m);
        } else {
            for (int32_t k = 0; k < c->count; k++)
                change = larger(change, fabs(solve_normal(c, k, &m, c->limit[k])) * c->mobility[k]);
        }
        double pressed = sum_of(c->impulse_n);
        solve_friction(c, &m, pressed);
        if (c->rolling > 0) solve_rolling(c, &m, pressed);
        leave(&m, a, b);
        if (change * dt <= c->fine) continue;
        heated = true;
        if (a->inverse_mass > 0) heat[c->a] = pass;
        if (b->inverse_mass > 0) heat[c->b] = pass;
    }
    return heated;
}

bool contacts_foresee(Contact *contact, int32_t count, const Mover *mover, double dt, int64_t *heat, int64_t pass) {
    static const double FAST = 0.03; /* [rad] in the substep */
    bool any = false;
    for (int32_t i = 0; i < count; i++) {
        Contact *c = &contact[i];
        const Mover *a = &mover[c->a], *b = &mover[c->b];
        if (larger(fabs(a->spin), fabs(b->spin)) * dt < FAST) continue;
        Vec apart = vsub(b->moved, a->moved), way = vscale(vsub(b->velocity, a->velocity), dt);
        Meeting m = meet(a, b);
        Two now = separation(c, a, b), linear = both(dt) * normal_speed(c, &m);
        Two then = separation_at(c, vadd(apart, way), a->turned + dt * a->spin, b->turned + dt * b->spin);
        for (int32_t k = 0; k < c->count; k++) {
            double gap = larger(now[k], 0) + smaller(then[k] - now[k] - linear[k], 0);
            double limit = gap > 0 ? -gap / dt : 0; /* never more: to push by a guess could gain energy */
            if (fabs(limit - c->limit[k]) * dt <= c->fine) continue;
            c->limit[k] = limit;
            if (a->inverse_mass > 0) heat[c->a] = pass;
            if (b->inverse_mass > 0) heat[c->b] = pass;
            any = true;
        }
    }
    return any;
}

/* Take a share of the overlaps out of the positions, and set the limits of the next substep. */
void contacts_part(Contact *contact, int32_t count, Mover *mover, double dt) {
    double inverse_dt = 1 / dt;
    for (int32_t i = 0; i < count; i++) {
        Contact *c = &contact[i];
        Mover *a = &mover[c->a], *b = &mover[c->b];
        Two gap = separation(c, a, b), depth = -gap - both(c->slop);
        set_limit(c, gap, inverse_dt);
        if (depth[0] <= 0 && (depth[1] <= 0 || c->count < 2)) continue;
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

void contacts_bounce(Contact *contact, int32_t count, Mover *mover) {
    for (int32_t i = 0; i < count; i++) {
        Contact *c = &contact[i];
        for (int32_t k = 0; k < c->count; k++) {
            if (c->approach[k] == 0 || c->impulse_n[k] <= 0) continue;
            Meeting m = meet(&mover[c->a], &mover[c->b]);
            solve_normal(c, k, &m, -c->elasticity * c->approach[k]);
            leave(&m, &mover[c->a], &mover[c->b]);
        }
    }
}
