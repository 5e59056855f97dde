/* Contacts from manifolds: levers, masses, what is remembered of them. */
#include "crowd_parts.h"

static void fill_point(Contact *c, int32_t k, Vec ra, Vec rb, double radius_a, double radius_b) {
    Vec n = c->normal;
    double na = vcross(ra, n), nb = vcross(rb, n);
    c->spin_na[k] = na;
    c->spin_nb[k] = nb;
    /* how far along the normal the corner is that turns; a disk touches with another point of it as it turns: its centre */
    double a = vdot(ra, n) + (c->side > 0 ? radius_b : -radius_a),
           b = vdot(rb, n) + (c->side < 0 ? -radius_a : radius_b);
    c->bend_aa[k] = c->side > 0 ? -0.5 * a : 0.5 * a;
    c->bend_bb[k] = c->side < 0 ? 0.5 * b : -0.5 * b;
    c->bend_ab[k] = c->side > 0 ? b : c->side < 0 ? -a : 0;
}

/* The row of friction acts halfway between the points. */
static void fill_friction(Contact *c, Vec ra, Vec rb) {
    c->spin_ta = vdot(ra, c->normal); /* r x t, as t is n turned by a right angle */
    c->spin_tb = vdot(rb, c->normal);
}

/* The points of a contact from its manifold, with the impulses that the same points had in `old`. */
void contact_set_points(Crowd *crowd, const World *world, Contact *c, const Manifold *m, const Record *old) {
    const Mover *a = &crowd->mover[c->a], *b = &crowd->mover[c->b];
    Vec at_a = crowd_position(crowd, c->a), at_b = crowd_position(crowd, c->b);
    double radius_a = world->piece[c->key >> 32].radius, radius_b = world->piece[c->key & 0xffffffffu].radius;
    Two none = {0, 0}, found = none;
    c->count = m->count;
    c->normal = m->normal;
    c->side = m->side;
    c->turns_a = radius_a == 0;
    c->turns_b = radius_b == 0;
    c->turned = c->turns_b * b->turned - c->turns_a * a->turned;
    c->moved = vsub(b->moved, a->moved);
    c->impulse_t = c->pair_mass = 0;
    c->slide_a = c->side > 0;
    c->slide_b = c->side < 0;
    c->spin_na = c->spin_nb = c->bend_aa = c->bend_bb = c->bend_ab = none;
    c->impulse_n = c->limit = c->separation = none;
    Ends *ends = &crowd->rows.ends[c - crowd->rows.contact];
    if (m->count == 0) {
        contact_weigh(c, ends, a, b);
        return;
    }
    Vec middle = m->count > 1 ? vscale(vadd(m->point[0].point, m->point[1].point), 0.5) : m->point[0].point;
    fill_friction(c, vsub(middle, at_a), vsub(middle, at_b));
    for (int32_t k = 0; k < m->count; k++) {
        Vec point = m->point[k].point;
        fill_point(c, k, vsub(point, at_a), vsub(point, at_b), radius_a, radius_b);
        found[k] = m->point[k].separation;
        int32_t same = -1;
        double nearest = 4 * c->slack;
        for (int32_t l = 0; old && l < old->count; l++) {
            double shift = fabs(old->lever[l] - c->spin_na[k]);
            if (shift < nearest) {
                nearest = shift;
                same = l;
            }
        }
        if (same < 0) continue;
        c->impulse_n[k] = old->impulse_n[same];
        c->impulse_t = old->impulse_t;
    }
    /* what the movers have done in the frame so far is in gap_now(), and taken off here */
    c->separation = found - gap_now(c, a, b);
    contact_weigh(c, ends, a, b);
}

/* Bodies this slow come to rest by rolling resistance, as real ones do: without it a box rocks on a ball for ever. */
bool crowd_is_slow(const World *world, int32_t body) {
    static const double SLOW = 0.1; /* of the speed of falling by its own reach */
    const Body *b = &world->body[body];
    double limit = SLOW * SLOW * vlength(world->gravity) * b->reach;
    return vdot(b->velocity, b->velocity) + b->spin * b->spin * b->reach * b->reach < limit;
}

void contact_add(Crowd *crowd, const World *world, const Near *near, const Manifold *m) {
    static const double SLACK = 0.05, SLOP = 0.005, FINE = 3e-3, ROLLING = 2e-2;
    const Shape *sa = &world->shape[world->piece[near->piece_a].shape];
    const Shape *sb = &world->shape[world->piece[near->piece_b].shape];
    double reach = contact_reach(crowd, near->piece_a, near->piece_b);
    int32_t i = crowd->rows.count++;
    Contact *c = &crowd->rows.contact[i];
    bool moves_a = crowd->mover[near->a].inverse_mass > 0, moves_b = crowd->mover[near->b].inverse_mass > 0;
    crowd->rows.ends[i] = (Ends){.a = near->a,
                                 .b = near->b,
                                 .moves_a = moves_a,
                                 .moves_b = moves_b,
                                 .uneven = contact_is_uneven(&crowd->mover[near->a], &crowd->mover[near->b])};
    c->a = near->a;
    c->b = near->b;
    c->lightens = false;
    c->friction = pair_friction(sa, sb);
    c->elasticity = pair_elasticity(sa, sb);
    c->slack = SLACK * reach;
    c->slop = SLOP * reach;
    c->fine = FINE * reach;
    c->rolling = crowd_is_slow(world, near->a) && crowd_is_slow(world, near->b)
                     ? ROLLING * reach * (c->friction < 1 ? c->friction : 1)
                     : 0;
    c->key = pair_key(near->piece_a, near->piece_b);
    crowd->touched[near->a] = crowd->touched[near->b] = true;
    c->touching = events_touching(crowd, world, c);
    contact_set_points(crowd, world, c, m, memory_recall(&crowd->memory, c->key));
}
