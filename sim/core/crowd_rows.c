/* Sequential impulses with substeps (Catto, "Solver2D", 2024).
 *
 * A pass goes through the rows in order and applies what each still lacks, with the sum clamped (contact: no pull;
 * friction: Coulomb's cone).  Contacts are rigid: soft ones sag under a pile by its load over their stiffness.  Overlap is
 * taken out of the positions themselves (crowd_gap.c), never by velocities: a jam gains no energy from it.
 *
 * Between bodies on which others press a row applies a little more than it lacks (successive over-relaxation, Young 1954; of
 * clamped rows, Cryer 1971): a blow goes through a pile in fewer passes.  A contact alone is solved at once.
 *
 * What a contact does next cannot be foretold: it presses or not, slides or not.  A processor that guesses loses more time
 * than a row takes, so rows choose by arithmetic.
 */
#include "crowd_rows.h"

#include <stdlib.h>
#include <string.h>

#include "broad.h"
#include "sim.h"

static const double OVER = 1.3; /* times what a normal row lacks that it applies then */

int rows_create(Rows *rows, int32_t mover_count) {
    *rows = (Rows){.mover_count = mover_count, .hot = calloc(3 * (size_t)mover_count, sizeof *rows->hot)};
    rows->whirls = rows->hot ? rows->hot + mover_count : NULL;
    rows->was = rows->hot ? rows->hot + 2 * mover_count : NULL;
    rows->contacts = calloc((size_t)mover_count, sizeof *rows->contacts);
    rows->before = calloc((size_t)mover_count, sizeof *rows->before);
    return rows->hot && rows->contacts && rows->before ? SIM_OK : SIM_OUT_OF_MEMORY;
}

int rows_room(Rows *rows, int32_t count) {
    if (count <= rows->capacity) return SIM_OK;
    int32_t capacity = 2 * count + 64;
    size_t n = (size_t)capacity;
    Contact *contact = realloc(rows->contact, n * sizeof *contact);
    if (contact) rows->contact = contact;
    Ends *ends = realloc(rows->ends, n * sizeof *ends);
    if (ends) rows->ends = ends;
    Bounce *bounce = realloc(rows->bounce, n * sizeof *bounce);
    if (bounce) rows->bounce = bounce;
    int32_t *list = realloc(rows->list, 2 * n * sizeof *list);
    if (list) rows->list = list;
    if (!contact || !ends || !bounce || !list) return SIM_OUT_OF_MEMORY;
    rows->stale = list + n;
    rows->stale_count = 0;
    rows->capacity = capacity;
    return SIM_OK;
}

void rows_destroy(Rows *rows) {
    free(rows->contact);
    free(rows->ends);
    free(rows->bounce);
    free(rows->list);
    free(rows->hot);
    free(rows->contacts);
    free(rows->before);
    *rows = (Rows){0};
}

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

static inline void push_pair(const Contact *c, Meeting *m, Two impulse) {
    push(c, m, normal_of(c), sum_of(impulse), sum_of(c->spin_na * impulse), sum_of(c->spin_nb * impulse));
}

static inline void push_point(const Contact *c, int32_t k, Meeting *m, double impulse) {
    push(c, m, normal_of(c), impulse, c->spin_na[k] * impulse, c->spin_nb[k] * impulse);
}

static inline void push_tangent(const Contact *c, Meeting *m, double impulse) {
    push(c, m, tangent_of(c), impulse, c->spin_ta * impulse, c->spin_tb * impulse);
}

/* At which the points of b leave those of a. */
static inline Two pair_speed(const Contact *c, const Meeting *m) {
    double v = sum_of(normal_of(c) * (m->velocity_b - m->velocity_a));
    return both(v) + both(m->spin_b) * c->spin_nb - both(m->spin_a) * c->spin_na;
}

static inline double point_speed(const Contact *c, int32_t k, const Meeting *m) {
    double v = sum_of(normal_of(c) * (m->velocity_b - m->velocity_a));
    return v + m->spin_b * c->spin_nb[k] - m->spin_a * c->spin_na[k];
}

static inline double tangent_speed(const Contact *c, const Meeting *m) {
    double v = sum_of(tangent_of(c) * (m->velocity_b - m->velocity_a));
    return v + m->spin_b * c->spin_tb - m->spin_a * c->spin_ta;
}

void rows_link(Rows *rows, int32_t from) {
    if (from == 0) memset(rows->contacts, 0, (size_t)rows->mover_count * sizeof *rows->contacts);
    for (int32_t i = from; i < rows->count; i++) {
        rows->contacts[rows->ends[i].a]++;
        rows->contacts[rows->ends[i].b]++;
    }
    for (int32_t i = 0; i < rows->count; i++) {
        Ends *ends = &rows->ends[i];
        bool others_a = !ends->moves_a || rows->contacts[ends->a] > 1;
        bool others_b = !ends->moves_b || rows->contacts[ends->b] > 1;
        ends->between = others_a && others_b && !ends->uneven;
    }
}

void rows_measure(Rows *rows, int32_t from, const Mover *mover, double threshold) {
    int32_t count = 0;
    if (from == 0) rows->bounce_count = 0;
    for (int32_t i = from; i < rows->count; i++) { /* those with a point that does not press already */
        const Contact *c = &rows->contact[i];
        rows->list[count] = i;
        count += (c->impulse_n[0] == 0) | ((c->impulse_n[1] == 0) & (c->count > 1));
    }
    for (int32_t k = 0; k < count; k++) {
        const Contact *c = &rows->contact[rows->list[k]];
        Meeting m = meet(&mover[c->a], &mover[c->b]);
        Two v = pair_speed(c, &m), none = {0, 0}, approach;
        approach[0] = ((c->count > 0) & (c->impulse_n[0] == 0) & (v[0] < -threshold)) ? v[0] : none[0];
        approach[1] = ((c->count > 1) & (c->impulse_n[1] == 0) & (v[1] < -threshold)) ? v[1] : none[1];
        rows->bounce[rows->bounce_count] = (Bounce){rows->list[k], approach};
        rows->bounce_count += (approach[0] < 0) | (approach[1] < 0);
    }
}

void rows_warm_start(Rows *rows, int32_t from, Mover *mover) {
    for (int32_t i = from; i < rows->count; i++) {
        const Contact *c = &rows->contact[i];
        if (c->impulse_n[0] == 0 && c->impulse_n[1] == 0 && c->impulse_t == 0) continue;
        Mover *a = &mover[c->a], *b = &mover[c->b];
        Meeting m = meet(a, b);
        push_pair(c, &m, c->impulse_n);
        push_tangent(c, &m, c->impulse_t);
        leave(&m, a, b);
    }
}

void rows_note(Rows *rows, const Mover *mover) {
    memcpy(rows->before, mover, (size_t)rows->mover_count * sizeof *mover);
}

void rows_temper(Rows *rows, Mover *mover, double slow) {
    double work = 0, square = 0, fast = 0; /* the energy changes by share * work + share^2 * square / 2 */
    for (int32_t i = 0; i < rows->mover_count; i++) {
        const Mover *m = &mover[i], *before = &rows->before[i];
        if (m->inverse_mass == 0) continue;
        fast +=
            (vdot(m->velocity, m->velocity) - slow * slow) / m->inverse_mass + m->spin * m->spin / m->inverse_moment;
        Vec gain = vsub(m->velocity, before->velocity);
        double turn = m->spin - before->spin;
        work += vdot(before->velocity, gain) / m->inverse_mass + before->spin * turn / m->inverse_moment;
        square += vdot(gain, gain) / m->inverse_mass + turn * turn / m->inverse_moment;
    }
    if (work + 0.5 * square <= 0 || fast <= 0) return;
    double share = larger(0, -work / square);
    for (int32_t i = 0; i < rows->mover_count; i++) {
        const Mover *before = &rows->before[i];
        mover[i].velocity = vmad(before->velocity, share, vsub(mover[i].velocity, before->velocity));
        mover[i].spin = before->spin + share * (mover[i].spin - before->spin);
    }
    for (int32_t i = 0; i < rows->count; i++) {
        rows->contact[i].impulse_n *= both(share);
        rows->contact[i].impulse_t *= share;
    }
}

/* The rest of a contact's rows, once its normal impulse has changed by `change` and its points press with `pressed` in all:
 * friction between the two, then rolling resistance, a torque against the spin between them that is as strong as the normal
 * force on a short lever.  The speed along the contact is what it was before the change, plus what that makes of it. */
static inline void finish(Contact *c, Meeting *m, double tangent, double change, double twist_a, double twist_b,
                          double pressed) {
    double most = c->friction * pressed, had = c->impulse_t;
    double sum = larger(-most, smaller(most, had - c->mass_t * tangent));
    double along = sum - had;
    c->impulse_t = sum;
    Two impulse = both(change) * normal_of(c) + both(along) * tangent_of(c);
    m->velocity_a -= both(c->inverse_mass_a) * impulse;
    m->velocity_b += both(c->inverse_mass_b) * impulse;
    m->spin_a -= c->inverse_moment_a * (twist_a + c->spin_ta * along);
    m->spin_b += c->inverse_moment_b * (twist_b + c->spin_tb * along);
    if (c->rolling == 0) return;
    double limit = c->rolling * pressed;
    double twist = larger(-limit, smaller(limit, (m->spin_a - m->spin_b) * c->twist_mass));
    m->spin_a -= c->inverse_moment_a * twist;
    m->spin_b += c->inverse_moment_b * twist;
}

/* x, if it is more than 0; else 0.  What a processor cannot guess it shall not try to. */
static inline double no_pull(double x) { return 0.5 * (x + fabs(x)); }

/* All rows of a contact of one point, the normal one by `over` times what it lacks. Returns the change of the point's velocity by its own impulse. */
static inline double solve_one(Contact *c, Meeting *m, double over) {
    double had = c->impulse_n[0];
    double sum = no_pull(had - over * c->mass_n[0] * (point_speed(c, 0, m) - c->limit[0]));
    double change = sum - had;
    c->impulse_n[0] = sum;
    finish(c, m, tangent_speed(c, m) + change * c->cross[0], change, c->spin_na[0] * change, c->spin_nb[0] * change,
           sum);
    return fabs(change) * c->mobility[0];
}

/* Both normal rows of a contact at once, so that neither end of a box goes first: the linear complementarity problem of two
 * rows by its four cases (Catto's Box2D); then the rest. Returns the larger change of a point's velocity by its own impulse. */
static inline double solve_pair(Contact *c, Meeting *m, double over) {
    Two k = c->mobility, k12 = both(c->coupling), had = c->impulse_n, none = {0, 0};
    /* what the velocities would be, beyond the limits, without the impulses so far */
    Two free = pair_speed(c, m) - c->limit - k * had - k12 * swapped(had);
    Two impulse = (k12 * swapped(free) - swapped(k) * free) * both(c->pair_mass);
    Two alone = -free * c->mass_n, other = k12 * alone + swapped(free);
    Mask fits = (Mask)(alone >= none) & (Mask)(other >= none), pressed = (Mask)(impulse >= none);
    fits &= ~(Mask){0, fits[0]}; /* the first point alone, else the second */
    pressed &= (Mask){pressed[1], pressed[0]};
    impulse = (Two)((pressed & (Mask)impulse) | (~pressed & fits & (Mask)alone));
    impulse = positive(had + both(over) * (impulse - had));
    Two change = impulse - had;
    c->impulse_n = impulse;
    finish(c, m, tangent_speed(c, m) + sum_of(change * c->cross), sum_of(change), sum_of(c->spin_na * change),
           sum_of(c->spin_nb * change), sum_of(impulse));
    change *= k;
    return larger(fabs(change[0]), fabs(change[1]));
}

/* Bring the normal velocity of a point to what is wanted, without pulling. Returns the impulse. */
static inline double solve_point(Contact *c, int32_t k, Meeting *m, double wanted) {
    double sum = larger(0, c->impulse_n[k] - c->mass_n[k] * (point_speed(c, k, m) - wanted));
    double impulse = sum - c->impulse_n[k];
    c->impulse_n[k] = sum;
    push_point(c, k, m, impulse);
    return impulse;
}

/* Two points that are too close together for their matrix: one after the other. */
static double solve_in_turn(Contact *c, Meeting *m) {
    double first = fabs(solve_point(c, 0, m, c->limit[0])) * c->mobility[0];
    double second = fabs(solve_point(c, 1, m, c->limit[1])) * c->mobility[1];
    finish(c, m, tangent_speed(c, m), 0, 0, 0, sum_of(c->impulse_n));
    return larger(first, second);
}

/* All rows of a contact. Returns the larger change of a point's velocity by its own impulse. */
static inline double solve(Contact *c, int32_t kind, Mover *a, Mover *b, double over) {
    Meeting m = meet(a, b);
    double change = kind == KIND_ONE    ? solve_one(c, &m, over)
                    : kind == KIND_PAIR ? solve_pair(c, &m, over)
                                        : solve_in_turn(c, &m);
    leave(&m, a, b);
    return change;
}

bool rows_solve(Rows *rows, Mover *mover, double dt, bool all) {
    bool *was = rows->was, *hot = rows->hot, heated = false;
    memcpy(was, hot, (size_t)rows->mover_count * sizeof *was);
    memset(hot, 0, (size_t)rows->mover_count * sizeof *hot);
    for (int32_t i = 0; i < rows->count; i++) {
        const Ends *ends = &rows->ends[i];
        /* what this pass heats counts at once: a blow goes on through a row of bodies in one pass */
        if (!(all | was[ends->a] | was[ends->b] | hot[ends->a] | hot[ends->b])) continue;
        if (ends->kind == KIND_OPEN) continue;
        Contact *c = &rows->contact[i];
        double change = solve(c, ends->kind, &mover[ends->a], &mover[ends->b], ends->between ? OVER : 1);
        bool noticed = change * dt > c->fine;
        hot[ends->a] |= noticed & ends->moves_a;
        hot[ends->b] |= noticed & ends->moves_b;
        heated |= noticed;
    }
    return heated;
}

void rows_hold(Rows *rows, Mover *mover, double dt) {
    int32_t count = 0;
    for (int32_t i = 0; i < rows->count; i++) {
        const Ends *ends = &rows->ends[i];
        rows->list[count] = i;
        count += !(ends->moves_a & ends->moves_b) & (ends->kind != KIND_OPEN);
    }
    for (int32_t k = 0; k < count; k++) {
        int32_t i = rows->list[k];
        Contact *c = &rows->contact[i];
        Mover *a = &mover[c->a], *b = &mover[c->b];
        Meeting m = meet(a, b);
        Two gap = gap_now(c, a, b) + both(dt) * pair_speed(c, &m);
        if (gap[0] < -c->slack || (c->count > 1 && gap[1] < -c->slack)) solve(c, rows->ends[i].kind, a, b, 1);
    }
}

void rows_bounce(Rows *rows, Mover *mover) {
    for (int32_t i = 0; i < rows->bounce_count; i++) {
        Contact *c = &rows->contact[rows->bounce[i].contact];
        Two approach = rows->bounce[i].approach;
        for (int32_t k = 0; k < c->count; k++) {
            if (approach[k] == 0 || c->impulse_n[k] <= 0) continue;
            Meeting m = meet(&mover[c->a], &mover[c->b]);
            solve_point(c, k, &m, -c->elasticity * approach[k]);
            leave(&m, &mover[c->a], &mover[c->b]);
        }
    }
}
