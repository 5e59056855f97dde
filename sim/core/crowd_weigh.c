/* What the bodies of a contact weigh in it.
 *
 * Sequential impulses take as many passes as a body is heavier than the other to hold it on that.  So the heavy one counts as
 * a good deal lighter than it is, as far as that only takes energy: most while it is what comes, and is stopped the sooner,
 * and less when the light one strikes it, or the blow would send it off with more than the light one had.
 */
#include "crowd_rows.h"

#include "broad.h"

static const double HEAVIER = 30; /* times as heavy as the other a body counts at most, when it counts as lighter */
static const double ITS_SHARE = 0.5; /* of the approach: what the heavy one does of it, to be what comes */
static const double APART = 1e3;  /* conditioning up to which two points are solved as a pair */

bool contact_is_uneven(const Mover *a, const Mover *b) {
    double low = a->inverse_mass, high = b->inverse_mass;
    return low > 0 && high > 0 && (low * HEAVIER < high || high * HEAVIER < low);
}

/* How many times as light as it is a body counts, of these inverse masses.  A light one that strikes it with the mass m and
 * the speed v gives it m v (1 + e) at most.  Sent off by s times its due it has no more energy from that than the light one
 * had, if s is not above the root of the ratio of their masses over 1 + e. */
static double scale(double own, double other, bool lightens) {
    if (own == 0 || own * HEAVIER >= other) return 1;
    double heavier = other / own, counts = larger(HEAVIER, (lightens ? 1 : 2) * sqrt(heavier));
    return larger(1, heavier / counts);
}

void contact_weigh(Contact *c, Ends *ends, const Mover *a, const Mover *b) {
    double scale_a = scale(a->inverse_mass, b->inverse_mass, c->lightens);
    double scale_b = scale(b->inverse_mass, a->inverse_mass, c->lightens);
    c->inverse_mass_a = scale_a * a->inverse_mass;
    c->inverse_moment_a = scale_a * a->inverse_moment;
    c->inverse_mass_b = scale_b * b->inverse_mass;
    c->inverse_moment_b = scale_b * b->inverse_moment;
    double along = c->inverse_mass_a + c->inverse_mass_b, turn_a = c->inverse_moment_a, turn_b = c->inverse_moment_b;
    c->twist_mass = c->rolling > 0 ? 1 / (turn_a + turn_b) : 0;
    c->mass_t = 1 / (along + turn_a * c->spin_ta * c->spin_ta + turn_b * c->spin_tb * c->spin_tb);
    c->mobility = c->mass_n = c->cross = (Two){0, 0};
    c->pair_mass = 0;
    ends->kind = c->count == 0 ? KIND_OPEN : c->count == 1 ? KIND_ONE : KIND_TURNS;
    for (int32_t k = 0; k < c->count; k++) {
        double na = c->spin_na[k], nb = c->spin_nb[k];
        c->mobility[k] = along + turn_a * na * na + turn_b * nb * nb;
        c->mass_n[k] = 1 / c->mobility[k];
        c->cross[k] = turn_a * na * c->spin_ta + turn_b * nb * c->spin_tb;
    }
    if (c->count < 2) return;
    double k11 = c->mobility[0], k22 = c->mobility[1];
    c->coupling = along + turn_a * c->spin_na[0] * c->spin_na[1] + turn_b * c->spin_nb[0] * c->spin_nb[1];
    double determinant = k11 * k22 - c->coupling * c->coupling;
    if (k11 * k22 >= APART * determinant) return;
    c->pair_mass = 1 / determinant;
    ends->kind = KIND_PAIR;
}

bool rows_weigh(Rows *rows, const Mover *mover) {
    bool any = false;
    for (int32_t i = 0; i < rows->count; i++) {
        if (!rows->ends[i].uneven) continue;
        any = true;
        Contact *c = &rows->contact[i];
        const Mover *a = &mover[c->a], *b = &mover[c->b];
        double of_a = vdot(c->normal, a->velocity), of_b = -vdot(c->normal, b->velocity);
        double own = a->inverse_mass < b->inverse_mass ? of_a : of_b;
        bool lightens = own > 0 && own >= ITS_SHARE * (of_a + of_b);
        if (lightens == c->lightens) continue;
        c->lightens = lightens;
        contact_weigh(c, &rows->ends[i], a, b);
    }
    return any;
}
