/* Pairs of pieces that come near: how far apart they are, and whether they become contacts. */
#include "crowd_parts.h"

static const double SKIN = 1e-3; /* of the smaller reach: as near as that counts as touching */

void near_manifold(Crowd *crowd, World *world, int32_t piece_a, int32_t piece_b, int32_t a, int32_t b, double margin,
                   Manifold *m) {
    if (crowd->placed[a] != crowd->moment) range_place(crowd, world, a);
    if (crowd->placed[b] != crowd->moment) range_place(crowd, world, b);
    manifold_find(&crowd->posed.outline[piece_a], &crowd->posed.outline[piece_b], margin, m);
    world->profile.pairs++;
}

/* Look at a pair closely. Whether it became a contact: it may touch within `soon` metres of approach; the points of it that
 * may touch within `later` come with it. */
bool near_look(Crowd *crowd, World *world, Near *near, double soon, double later) {
    Manifold m;
    near_manifold(crowd, world, near->piece_a, near->piece_b, near->a, near->b, later, &m);
    near_set(crowd, near, m.normal, m.gap);
    if (m.count == 0 || m.gap > soon) return false;
    contact_add(crowd, world, near, &m);
    return true;
}

double near_skin(const Crowd *crowd, const Near *near) {
    return SKIN * contact_reach(crowd, near->piece_a, near->piece_b);
}

static void advance(Mover *m, const Mover *from, double time) {
    m->moved = vmad(from->moved, time, from->velocity);
    m->turned = from->turned + time * from->spin;
}

/* Whether a fast pair becomes a contact: it is followed through the substep to where it first touches, if it does, since
 * the sides that face each other now need not be those that meet (conservative advancement, Mirtich 1996). */
bool near_look_along(Crowd *crowd, World *world, Near *near, double dt, double later) {
    enum { STEPS = 32 };
    Mover *a = &crowd->mover[near->a], *b = &crowd->mover[near->b], from_a = *a, from_b = *b;
    double time = 0, close = near_skin(crowd, near);
    bool contact = false;
    Near probe = *near;
    for (int32_t step = 0; step < STEPS && time < dt; step++) {
        advance(a, &from_a, time);
        advance(b, &from_b, time);
        range_place(crowd, world, near->a);
        range_place(crowd, world, near->b);
        contact = near_look(crowd, world, &probe, close, later);
        if (step == 0) *near = probe;
        double rate = near_approach(crowd, &probe, 1);
        if (contact || rate <= 0 || probe.gap <= 0) break;
        time += larger(probe.gap, close) / rate;
    }
    *a = from_a;
    *b = from_b;
    crowd->placed[near->a] = crowd->placed[near->b] = crowd->moment - 1;
    return contact;
}
