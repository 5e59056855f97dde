/* Sequential impulses with substeps (Catto, "Solver2D", 2024).
 *
 * A pass goes through the rows in order and applies what each still lacks, with the sum clamped (contact: no pull;
 * friction: Coulomb's cone).  Contacts are rigid: soft ones sag under a pile by its load over their stiffness.  Overlap is
 * taken out of the positions themselves (nonlinear Gauss-Seidel), never by velocities: a jam gains no energy from it.
 */
#include "crowd_rows.h"

#include "broad.h"

static const double RATE = 0.6; /* share of an overlap that a pass drives out */

/* A contact's two bodies while its rows are solved, held in registers: through pointers every store might change the rest. */
typedef struct Meeting {
    Vec velocity_a, velocity_b;
    double spin_a, spin_b;
    double inverse_mass_a, inverse_moment_a, inverse_mass_b, inverse_moment_b;
} Meeting;

static inline Meeting meet(const Contact *c, const Mover *a, const Mover *b) {
    return (Meeting){a->velocity,       b->velocity,         a->spin,           b->spin,
                     c->inverse_mass_a, c->inverse_moment_a, c->inverse_mass_b, c->inverse_moment_b};
}

static inline void leave(const Meeting *m, Mover *a, Mover *b) {
    a->velocity = m->velocity_a;
    a->spin = m->spin_a;
    b->velocity = m->velocity_b;
    b->spin = m->spin_b;
}

static inline void push(Meeting *m, Vec direction, double lever_a, double lever_b, double impulse) {
    m->velocity_a = vmad(m->velocity_a, -impulse * m->inverse_mass_a, direction);
    m->spin_a -= impulse * m->inverse_moment_a * lever_a;
    m->velocity_b = vmad(m->velocity_b, impulse * m->inverse_mass_b, direction);
    m->spin_b += impulse * m->inverse_moment_b * lever_b;
}

static inline double speed(const Meeting *m, Vec direction, double lever_a, double lever_b) {
    return vdot(direction, vsub(m->velocity_b, m->velocity_a)) + m->spin_b * lever_b - m->spin_a * lever_a;
}

/* The second order of how a gap changes as two bodies turn by the angles and move apart by `apart` along the side: the corner
 * goes on a circle, the side turns away under it. */
static inline double second_order(const Contact *c, int32_t k, double turned_a, double turned_b, double apart) {
    double a = c->place[k].along_na, b = c->place[k].along_nb;
    if (c->side > 0) return -0.5 * (turned_a * turned_a * a + turned_b * turned_b * b) + turned_a * (turned_b * b + apart);
    if (c->side < 0) return 0.5 * (turned_a * turned_a * a + turned_b * turned_b * b) - turned_b * (turned_a * a - apart);
    return 0.5 * (turned_a * turned_a * a - turned_b * turned_b * b);
}

/* How far apart a point's two surfaces are when the bodies have moved and turned so in the frame. */
static inline double separation_at(const Contact *c, int32_t k, Vec apart, double turned_a, double turned_b) {
    const Point *p = &c->point[k];
    return c->place[k].separation + vdot(apart, c->normal) + turned_b * p->spin_nb - turned_a * p->spin_na +
           second_order(c, k, turned_a, turned_b, vcross(c->normal, apart));
}

double contact_separation(const Contact *c, int32_t k, const Mover *a, const Mover *b) {
    return separation_at(c, k, vsub(b->moved, a->moved), a->turned, b->turned);
}

void contacts_warm_start(Contact *contact, int32_t count, Mover *mover, double dt) {
    double inverse_dt = 1 / dt;
    for (int32_t i = 0; i < count; i++) {
        Contact *c = &contact[i];
        Mover *a = &mover[c->a], *b = &mover[c->b];
        Vec n = c->normal, t = vperp(n);
        Meeting m = meet(c, a, b);
        for (int32_t k = 0; k < c->count; k++) {
            Point *p = &c->point[k];
            double gap = contact_separation(c, k, a, b);
            p->limit = gap > 0 ? -gap * inverse_dt : 0;
            if (p->impulse_n != 0) push(&m, n, p->spin_na, p->spin_nb, p->impulse_n);
        }
        if (c->impulse_t != 0) push(&m, t, c->spin_ta, c->spin_tb, c->impulse_t);
        leave(&m, a, b);
    }
}

void contacts_measure(Contact *contact, int32_t count, const Mover *mover, double threshold) {
    for (int32_t i = 0; i < count; i++) {
        Contact *c = &contact[i];
        if (c->elasticity <= 0) continue;
        Meeting m = meet(c, &mover[c->a], &mover[c->b]);
        for (int32_t k = 0; k < c->count; k++) {
            const Point *p = &c->point[k];
            c->place[k].approach = 0;
            if (p->impulse_n > 0) continue;
            double v = speed(&m, c->normal, p->spin_na, p->spin_nb);
            if (v < -threshold) c->place[k].approach = v;
        }
    }
}

static inline void solve_friction(Contact *c, Meeting *m, double pressed) {
    if (pressed == 0 && c->impulse_t == 0) return;
    Vec t = vperp(c->normal);
    double v = speed(m, t, c->spin_ta, c->spin_tb), most = c->friction * pressed;
    double sum = c->impulse_t - c->mass_t * v;
    sum = sum > most ? most : sum < -most ? -most : sum;
    double impulse = sum - c->impulse_t;
    c->impulse_t = sum;
    push(m, t, c->spin_ta, c->spin_tb, impulse);
}

/* Bring the normal velocity to what is wanted, without pulling. Returns the impulse. */
static inline double solve_normal(const Contact *c, Point *p, Meeting *m, double wanted) {
    double v = speed(m, c->normal, p->spin_na, p->spin_nb);
    double sum = p->impulse_n - p->mass_n * (v - wanted);
    sum = sum > 0 ? sum : 0;
    double impulse = sum - p->impulse_n;
    if (impulse == 0) return 0;
    p->impulse_n = sum;
    push(m, c->normal, p->spin_na, p->spin_nb, impulse);
    return impulse;
}

/* Rolling resistance: a torque against the spin between the two, as strong as the normal force on a short lever. */
static inline void solve_rolling(const Contact *c, Meeting *m, double pressed) {
    double most = c->rolling * pressed;
    double wanted = (m->spin_a - m->spin_b) / (m->inverse_moment_a + m->inverse_moment_b);
    wanted = wanted > most ? most : wanted < -most ? -most : wanted;
    m->spin_a -= m->inverse_moment_a * wanted;
    m->spin_b += m->inverse_moment_b * wanted;
}

/* Both normal rows of a contact at once, so that neither end of a box goes first: the linear complementarity problem of two
 * rows by its four cases (Catto's Box2D). wanted: the normal velocities. Returns the larger change relative to its mass. */
static inline double solve_pair(Contact *c, Meeting *m) {
    Point *p = &c->point[0], *q = &c->point[1];
    double k11 = p->mobility, k22 = q->mobility, k12 = c->coupling;
    double vp = speed(m, c->normal, p->spin_na, p->spin_nb) - p->limit;
    double vq = speed(m, c->normal, q->spin_na, q->spin_nb) - q->limit;
    /* what the velocities would be without the impulses so far */
    double bp = vp - k11 * p->impulse_n - k12 * q->impulse_n, bq = vq - k12 * p->impulse_n - k22 * q->impulse_n;
    double x = (k12 * bq - k22 * bp) * c->pair_mass, y = (k12 * bp - k11 * bq) * c->pair_mass;
    if (x < 0 || y < 0) {
        x = -bp * p->mass_n, y = 0;
        if (x < 0 || k12 * x + bq < 0) {
            x = 0, y = -bq * q->mass_n;
            if (y < 0 || k12 * y + bp < 0) x = y = 0;
        }
    }
    double dx = x - p->impulse_n, dy = y - q->impulse_n;
    p->impulse_n = x;
    q->impulse_n = y;
    push(m, c->normal, p->spin_na, p->spin_nb, dx);
    push(m, c->normal, q->spin_na, q->spin_nb, dy);
    double ax = fabs(dx) * k11, ay = fabs(dy) * k22;
    return ax > ay ? ax : ay;
}

bool contacts_solve(Contact *contact, int32_t count, Mover *mover, double dt, int64_t *heat, int64_t pass, bool first) {
    bool heated = false;
    for (int32_t i = 0; i < count; i++) {
        Contact *c = &contact[i];
        if (!first && heat[c->a] < pass - 1 && heat[c->b] < pass - 1) continue;
        Mover *a = &mover[c->a], *b = &mover[c->b];
        Meeting m = meet(c, a, b);
        double change = 0, pressed = 0;
        if (c->count == 2 && c->pair_mass > 0) {
            change = solve_pair(c, &m);
        } else {
            for (int32_t k = 0; k < c->count; k++) {
                Point *p = &c->point[k];
                double impulse = solve_normal(c, p, &m, p->limit);
                change = larger(change, fabs(impulse) * p->mobility);
            }
        }
        for (int32_t k = 0; k < c->count; k++) pressed += c->point[k].impulse_n;
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
        double turn_a = dt * a->spin, turn_b = dt * b->spin;
        for (int32_t k = 0; k < c->count; k++) {
            Point *p = &c->point[k];
            double now = separation_at(c, k, apart, a->turned, b->turned);
            double then = separation_at(c, k, vadd(apart, way), a->turned + turn_a, b->turned + turn_b);
            double linear = vdot(way, c->normal) + turn_b * p->spin_nb - turn_a * p->spin_na;
            double limit = -(larger(now, 0) + smaller(then - now - linear, 0)) / dt;
            if (fabs(limit - p->limit) * dt <= c->fine) continue;
            p->limit = limit;
            if (a->inverse_mass > 0) heat[c->a] = pass;
            if (b->inverse_mass > 0) heat[c->b] = pass;
            any = true;
        }
    }
    return any;
}

static inline double overlap(const Contact *c, int32_t k, const Mover *a, const Mover *b) {
    double depth = -contact_separation(c, k, a, b) - c->slop;
    return depth < c->slack ? depth : c->slack;
}

static inline void part(const Contact *c, const Point *p, Mover *a, Mover *b, double push) {
    a->moved = vmad(a->moved, -push * c->inverse_mass_a, c->normal);
    a->turned -= push * c->inverse_moment_a * p->spin_na;
    b->moved = vmad(b->moved, push * c->inverse_mass_b, c->normal);
    b->turned += push * c->inverse_moment_b * p->spin_nb;
}

/* Take a share of the overlaps out of the positions. */
void contacts_part(Contact *contact, int32_t count, Mover *mover) {
    for (int32_t i = 0; i < count; i++) {
        Contact *c = &contact[i];
        Mover *a = &mover[c->a], *b = &mover[c->b];
        if (c->count == 2 && c->pair_mass > 0) {
            const Point *p = &c->point[0], *q = &c->point[1];
            double dp = overlap(c, 0, a, b), dq = overlap(c, 1, a, b);
            if (dp <= 0 && dq <= 0) continue;
            double x = (dp * q->mobility - c->coupling * dq) * c->pair_mass;
            double y = (dq * p->mobility - c->coupling * dp) * c->pair_mass;
            if (x < 0 || y < 0) {
                x = dp > dq ? dp * p->mass_n : 0;
                y = dp > dq ? 0 : dq * q->mass_n;
            }
            part(c, p, a, b, RATE * x);
            part(c, q, a, b, RATE * y);
            continue;
        }
        for (int32_t k = 0; k < c->count; k++) {
            double depth = overlap(c, k, a, b);
            if (depth > 0) part(c, &c->point[k], a, b, RATE * depth * c->point[k].mass_n);
        }
    }
}

void contacts_bounce(Contact *contact, int32_t count, Mover *mover) {
    for (int32_t i = 0; i < count; i++) {
        Contact *c = &contact[i];
        for (int32_t k = 0; k < c->count; k++) {
            PointPlace *at = &c->place[k];
            if (at->approach == 0 || c->point[k].impulse_n <= 0) continue;
            Meeting m = meet(c, &mover[c->a], &mover[c->b]);
            solve_normal(c, &c->point[k], &m, -c->elasticity * at->approach);
            leave(&m, &mover[c->a], &mover[c->b]);
            at->approach = 0;
        }
    }
}
