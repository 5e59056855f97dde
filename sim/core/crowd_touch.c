/* Finding the crowd's contacts: boxes, then pieces; at once where they touch, in time where they only come near. */
#include <stdlib.h>

#include "crowd_parts.h"

static const double SKIN = 1e-3; /* of the smaller reach: as near as that counts as touching */
static const double MORE =
    0.05; /* of the smaller reach: a contact's other end comes with it when it is as near as that */
static const double ROOM =
    0.1;  /* of a body's reach: what it may stray from its way before its pairs are looked for anew */
static const double FAST =
    0.25; /* of the smaller reach in a substep: a pair as fast as that is followed to its touch */
static const double TURN = 0.03; /* [rad]: a pair that has turned so far in the frame is looked at again */

static void *table(size_t count, size_t size) { return calloc(count + 1, size); }

static int contact_room(Crowd *crowd, int32_t count) {
    if (count <= crowd->contact_capacity) return SIM_OK;
    int32_t capacity = 2 * count + 64;
    Contact *contact = realloc(crowd->contact, (size_t)capacity * sizeof *contact);
    if (!contact) return SIM_OUT_OF_MEMORY;
    crowd->contact = contact;
    crowd->contact_capacity = capacity;
    return SIM_OK;
}

static int near_room(Crowd *crowd, int32_t count) {
    if (count <= crowd->near_capacity) return SIM_OK;
    int32_t capacity = 2 * count + 64;
    Near *near = realloc(crowd->near, (size_t)capacity * sizeof *near);
    if (near) crowd->near = near;
    Near *last = realloc(crowd->last_near, (size_t)capacity * sizeof *last);
    if (last) crowd->last_near = last;
    if (!near || !last) return SIM_OUT_OF_MEMORY;
    crowd->near_capacity = capacity;
    return SIM_OK;
}

int touch_create(Crowd *crowd, const World *world) {
    size_t bodies = (size_t)world->body_count, pieces = (size_t)world->piece_count, shapes = (size_t)world->shape_count;
    crowd->start = table(bodies, sizeof *crowd->start);
    crowd->placed = table(bodies, sizeof *crowd->placed);
    crowd->piece_box = table(pieces, sizeof *crowd->piece_box);
    crowd->shape_box = table(shapes, sizeof *crowd->shape_box);
    crowd->shape_moves = table(shapes, sizeof *crowd->shape_moves);
    crowd->range = table(bodies, sizeof *crowd->range);
    crowd->start_angle = table(bodies, sizeof *crowd->start_angle);
    crowd->body_swing = table(bodies, sizeof *crowd->body_swing);
    crowd->lead = table(bodies, sizeof *crowd->lead);
    crowd->end = table(bodies, sizeof *crowd->end);
    crowd->end_angle = table(bodies, sizeof *crowd->end_angle);
    if (!crowd->end || !crowd->end_angle) return SIM_OUT_OF_MEMORY;
    if (!crowd->start || !crowd->placed || !crowd->piece_box || !crowd->shape_box || !crowd->shape_moves ||
        !crowd->range || !crowd->start_angle || !crowd->body_swing || !crowd->lead)
        return SIM_OUT_OF_MEMORY;
    if (sweep_create(&crowd->sweep, world->shape_count) != SIM_OK) return SIM_OUT_OF_MEMORY;
    if (contact_room(crowd, 2 * world->body_count) != SIM_OK) return SIM_OUT_OF_MEMORY;
    if (posed_create(&crowd->posed, world) != SIM_OK) return SIM_OUT_OF_MEMORY;
    for (int32_t i = 0; i < world->piece_count; i++) {
        int32_t body = world->shape[world->piece[i].shape].body;
        crowd->body_swing[body] = larger(crowd->body_swing[body], crowd->posed.swing[i]);
    }
    return SIM_OK;
}

void touch_destroy(Crowd *crowd) {
    free(crowd->start);
    free(crowd->placed);
    posed_destroy(&crowd->posed);
    free(crowd->piece_box);
    free(crowd->shape_box);
    free(crowd->shape_moves);
    free(crowd->range);
    free(crowd->start_angle);
    free(crowd->body_swing);
    free(crowd->lead);
    free(crowd->end);
    free(crowd->end_angle);
    index_destroy(&crowd->known);
    index_destroy(&crowd->last_index);
    free(crowd->last_near);
    sweep_destroy(&crowd->sweep);
    free(crowd->near);
    free(crowd->contact);
    memory_destroy(&crowd->memory);
}

/* Bring a body's outlines to where it is now. */
void touch_place(Crowd *crowd, const World *world, int32_t body) {
    const Body *b = &world->body[body];
    const Mover *m = &crowd->mover[body];
    if (m->inverse_mass > 0)
        posed_place(&crowd->posed, world, body, pose(vadd(b->position, m->moved), b->angle + m->turned));
    crowd->placed[body] = crowd->moment;
}

/* All that a box of the body may sweep while the body keeps to its range. */
static Box swept(const Crowd *crowd, Box box, int32_t body) {
    const Range *range = &crowd->range[body];
    Vec lead = crowd->lead[body];
    return box_grow((Box){vadd(box.low, vsub(range->low, lead)), vadd(box.high, vsub(range->high, lead))}, range->room);
}

/* Let a body's range reach as far as it goes from where it is, at its present velocity. */
static void widen_range(Crowd *crowd, const World *world, int32_t body, double left) {
    const Mover *m = &crowd->mover[body];
    Range *range = &crowd->range[body];
    Vec end = vadd(m->moved, vmad(vscale(m->velocity, left), left * left, world->gravity));
    range->low =
        vec(smaller(range->low.x, smaller(m->moved.x, end.x)), smaller(range->low.y, smaller(m->moved.y, end.y)));
    range->high =
        vec(larger(range->high.x, larger(m->moved.x, end.x)), larger(range->high.y, larger(m->moved.y, end.y)));
    range->room += ROOM * world->body[body].reach + smaller(fabs(m->spin) * left, 2.0) * crowd->body_swing[body];
}

static void sweep_boxes(Crowd *crowd, const World *world, int32_t body) {
    const Body *b = &world->body[body];
    for (int32_t s = b->first_shape; s < b->first_shape + b->shape_count; s++) {
        const Shape *shape = &world->shape[s];
        Box box = crowd->piece_box[shape->first_piece];
        for (int32_t p = 1; p < shape->piece_count; p++) box = box_join(box, crowd->piece_box[shape->first_piece + p]);
        crowd->shape_box[s] = swept(crowd, box, body);
        crowd->shape_moves[s] = b->mode == MODE_CROWD;
    }
}

/* A body that does not go far is placed where it will be in the middle of the frame: contacts that stay as they are for
 * the whole frame are then right to second order, and rocking and rolling gain no energy from them. */
static void look_ahead(Crowd *crowd, const World *world, int32_t body, double dt) {
    static const double NOT_FAR = 0.05; /* of its reach */
    const Body *b = &world->body[body];
    Mover *m = &crowd->mover[body];
    double way = 0.5 * dt * (vlength(m->velocity) + b->reach * fabs(m->spin));
    if (way > NOT_FAR * b->reach) return;
    m->moved = vscale(m->velocity, 0.5 * dt);
    m->turned = 0.5 * dt * m->spin;
    crowd->lead[body] = m->moved;
    crowd->range[body].room += fabs(m->turned) * crowd->body_swing[body];
}

/* Where the body is as the frame begins, and all that it may sweep in it. */
static void start_body(Crowd *crowd, const World *world, int32_t body, double dt) {
    const Body *b = &world->body[body];
    Pose *start = &crowd->start[body];
    bool moves = b->mode == MODE_CROWD;
    bool known = !moves && crowd->placed[body] != 0 && start->p.x == b->position.x && start->p.y == b->position.y &&
                 crowd->start_angle[body] == b->angle;
    crowd->range[body] = (Range){{0, 0}, {0, 0}, 0};
    crowd->lead[body] = vec(0, 0);
    if (moves) {
        widen_range(crowd, world, body, dt);
        look_ahead(crowd, world, body, dt);
    }
    if (!known) {
        const Mover *m = &crowd->mover[body];
        *start = pose(vadd(b->position, m->moved), b->angle + m->turned);
        crowd->start_angle[body] = b->angle + m->turned;
        posed_place(&crowd->posed, world, body, *start);
        for (int32_t s = b->first_shape; s < b->first_shape + b->shape_count; s++) {
            const Shape *shape = &world->shape[s];
            for (int32_t p = 0; p < shape->piece_count; p++)
                crowd->piece_box[shape->first_piece + p] = posed_box(&crowd->posed, shape->first_piece + p);
        }
    }
    crowd->placed[body] = crowd->moment;
    sweep_boxes(crowd, world, body);
}

/* How far a near pair is apart at least, as the bodies have moved since it was looked at. */
static inline double gap_now(const Crowd *crowd, const Near *n) {
    const Mover *a = &crowd->mover[n->a], *b = &crowd->mover[n->b];
    Vec moved = vsub(vsub(b->moved, a->moved), n->moved);
    return n->gap + vdot(n->normal, moved) - fabs(a->turned - n->turned_a) * crowd->posed.swing[n->piece_a] -
           fabs(b->turned - n->turned_b) * crowd->posed.swing[n->piece_b];
}

/* The gap and its normal hold for where the bodies are now. */
static inline void set_near(const Crowd *crowd, Near *n, Vec normal, double gap) {
    const Mover *a = &crowd->mover[n->a], *b = &crowd->mover[n->b];
    n->normal = normal;
    n->gap = gap;
    n->moved = vsub(b->moved, a->moved);
    n->turned_a = a->turned;
    n->turned_b = b->turned;
}

/* How much nearer two bodies' pieces can come along the normal in dt, at their present velocities. */
static inline double approach(const Crowd *crowd, const Near *n, double dt) {
    const Mover *a = &crowd->mover[n->a], *b = &crowd->mover[n->b];
    double turning = fabs(a->spin) * crowd->posed.swing[n->piece_a] + fabs(b->spin) * crowd->posed.swing[n->piece_b];
    return dt * (turning - vdot(n->normal, vsub(b->velocity, a->velocity)));
}

static void find_manifold(Crowd *crowd, World *world, int32_t piece_a, int32_t piece_b, int32_t a, int32_t b,
                          double margin, Manifold *m) {
    if (crowd->placed[a] != crowd->moment) touch_place(crowd, world, a);
    if (crowd->placed[b] != crowd->moment) touch_place(crowd, world, b);
    manifold_find(&crowd->posed.outline[piece_a], &crowd->posed.outline[piece_b], margin, m);
    world->profile.pairs++;
}

/* Look at a pair closely. Whether it became a contact: it may touch within `soon` metres of approach; the points of it that
 * may touch within `later` come with it. */
static bool look(Crowd *crowd, World *world, Near *near, double soon, double later) {
    Manifold m;
    find_manifold(crowd, world, near->piece_a, near->piece_b, near->a, near->b, later, &m);
    set_near(crowd, near, m.normal, m.gap);
    if (m.count == 0 || m.gap > soon) return false;
    contact_add(crowd, world, near, &m);
    return true;
}

static double skin_of(const World *world, const Near *near) {
    return SKIN * contact_reach(world, near->piece_a, near->piece_b);
}

/* An upper bound of how much nearer two bodies come in dt, whatever the direction. */
static double closing(const Crowd *crowd, const World *world, const Near *near, double dt) {
    const Mover *a = &crowd->mover[near->a], *b = &crowd->mover[near->b];
    double turning =
        fabs(a->spin) * crowd->posed.swing[near->piece_a] + fabs(b->spin) * crowd->posed.swing[near->piece_b];
    return dt * (vlength(vsub(b->velocity, a->velocity)) + turning) + dt * dt * vlength(world->gravity);
}

/* How far two boxes are apart, and along which axis: at least so far are the pieces in them. */
static double box_gap(const Box *a, const Box *b, Vec *normal) {
    double right = b->low.x - a->high.x, left = a->low.x - b->high.x;
    double above = b->low.y - a->high.y, below = a->low.y - b->high.y;
    double x = larger(right, left), y = larger(above, below);
    *normal = x > y ? vec(right > left ? 1 : -1, 0) : vec(0, above > below ? 1 : -1);
    return larger(x, y);
}

/* Whether a body is where the last frame left it: it may have been in other motion since. */
static bool came_straight(const Crowd *crowd, const World *world, int32_t body) {
    const Body *b = &world->body[body];
    Vec end = crowd->end[body];
    return b->position.x == end.x && b->position.y == end.y && b->angle == crowd->end_angle[body];
}

static int consider(Crowd *crowd, World *world, Near near, double dt, double substep, bool *woke) {
    if (near_room(crowd, crowd->near_count + 1) != SIM_OK) return SIM_OUT_OF_MEMORY;
    if (contact_room(crowd, crowd->contact_count + crowd->near_count + 1) != SIM_OK) return SIM_OUT_OF_MEMORY;
    double skin = skin_of(world, &near), later = closing(crowd, world, &near, dt) + skin;
    double soon = closing(crowd, world, &near, substep) + skin;
    bool contact = false;
    Vec normal;
    double gap = box_gap(&crowd->piece_box[near.piece_a], &crowd->piece_box[near.piece_b], &normal);
    set_near(crowd, &near, normal, gap);
    int32_t last = gap <= soon ? index_find(&crowd->last_index, pair_key(near.piece_a, near.piece_b)) : -1;
    if (last >= 0 && came_straight(crowd, world, near.a) && came_straight(crowd, world, near.b)) {
        Near before = near;
        before.normal = crowd->last_near[last].normal;
        before.gap = crowd->last_near[last].gap;
        before.moved = vec(0, 0);
        before.turned_a = before.turned_b = 0;
        double kept = gap_now(crowd, &before);
        if (kept > gap) {
            near = before;
            gap = kept;
        }
    }
    double reach = contact_reach(world, near.piece_a, near.piece_b);
    if (gap <= soon && soon <= FAST * reach) contact = look(crowd, world, &near, soon, later + MORE * reach);
    if (!contact) crowd->near[crowd->near_count++] = near;
    if (near.gap > later) return SIM_OK;
    bool close = near.gap <= skin;
    *woke = rest_disturb(crowd, world, near.a, near.b, close) || *woke;
    *woke = rest_disturb(crowd, world, near.b, near.a, close) || *woke;
    return SIM_OK;
}

static bool takes_part(const World *world, const Shape *shape) {
    Mode mode = world->body[shape->body].mode;
    return mode != MODE_FLIGHT && mode != MODE_SMOOTH;
}

static int consider_shapes(Crowd *crowd, World *world, Pair pair, double dt, double substep, bool *woke) {
    const Shape *sa = &world->shape[pair.a], *sb = &world->shape[pair.b];
    if (!takes_part(world, sa) || !takes_part(world, sb) || !world_collides(world, pair.a, pair.b)) return SIM_OK;
    bool many = sa->piece_count > 1 || sb->piece_count > 1;
    for (int32_t p = sa->first_piece; p < sa->first_piece + sa->piece_count; p++) {
        Box box_a = many ? swept(crowd, crowd->piece_box[p], sa->body) : crowd->piece_box[p];
        if (many && !boxes_meet(&box_a, &crowd->shape_box[pair.b])) continue;
        for (int32_t q = sb->first_piece; q < sb->first_piece + sb->piece_count; q++) {
            if (many) {
                Box box_b = swept(crowd, crowd->piece_box[q], sb->body);
                if (!boxes_meet(&box_a, &box_b)) continue;
            }
            Near near = {.piece_a = p, .piece_b = q, .a = sa->body, .b = sb->body};
            int status = consider(crowd, world, near, dt, substep, woke);
            if (status != SIM_OK) return status;
        }
    }
    return SIM_OK;
}

static void load(Crowd *crowd, const World *world) {
    crowd->active_count = 0;
    for (int32_t i = 0; i < world->body_count; i++) {
        const Body *body = &world->body[i];
        Mover *m = &crowd->mover[i];
        *m = (Mover){0};
        if (body->mode != MODE_CROWD) continue;
        crowd->active[crowd->active_count++] = i;
        m->velocity = body->velocity;
        m->spin = body->spin;
        m->inverse_mass = body->inverse_mass;
        m->inverse_moment = body->inverse_moment;
    }
}

/* Begin a frame: all pairs that may touch in it, as contacts or as near ones. Bodies at rest that a moving one may reach are
 * woken, and those that they reach in turn. */
int touch_frame(Crowd *crowd, World *world, double dt, double substep) {
    crowd->moment++;
    for (int32_t i = 0; i < world->body_count; i++) crowd->roused[i] = 0;
    crowd->known.count = -1;
    bool woke;
    do {
        woke = rest_wake_joined(crowd, world);
        load(crowd, world);
        crowd->near_count = crowd->contact_count = 0;
        for (int32_t i = 0; i < world->body_count; i++) {
            const Body *body = &world->body[i];
            if (body->mode == MODE_FLIGHT || body->mode == MODE_SMOOTH) {
                for (int32_t s = body->first_shape; s < body->first_shape + body->shape_count; s++)
                    crowd->shape_moves[s] = false;
                continue;
            }
            start_body(crowd, world, i, dt);
        }
        if (sweep_pairs(&crowd->sweep, crowd->shape_box, crowd->shape_moves) != SIM_OK) return SIM_OUT_OF_MEMORY;
        for (int32_t k = 0; k < crowd->sweep.pair_count; k++) {
            int status = consider_shapes(crowd, world, crowd->sweep.pair[k], dt, substep, &woke);
            if (status != SIM_OK) return status;
        }
    } while (woke);
    for (int32_t k = 0; k < crowd->active_count; k++) {
        Mover *m = &crowd->mover[crowd->active[k]];
        m->moved = vec(0, 0);
        m->turned = 0;
    }
    crowd->moment++; /* the outlines are ahead of the bodies */
    return SIM_OK;
}

/* Find the points anew of contacts whose bodies have turned or shifted a good deal since. */
void touch_refresh(Crowd *crowd, World *world, double left) {
    for (int32_t i = 0; i < crowd->contact_count; i++) {
        Contact *c = &crowd->contact[i];
        const Mover *a = &crowd->mover[c->a], *b = &crowd->mover[c->b];
        Vec shifted = vsub(vsub(b->moved, a->moved), c->moved);
        double turned = b->turned - a->turned - c->turned;
        if (fabs(turned) < TURN && fabs(shifted.x) + fabs(shifted.y) < c->slack) continue;
        Near near = {
            .piece_a = (int32_t)(c->key >> 32), .piece_b = (int32_t)(c->key & 0xffffffffu), .a = c->a, .b = c->b};
        Manifold m;
        find_manifold(crowd, world, near.piece_a, near.piece_b, c->a, c->b,
                      closing(crowd, world, &near, left) + c->slack, &m);
        Record old = contact_record(c);
        contact_set_points(crowd, world, c, &m, &old);
        contacts_limit(c, 1, crowd->mover, crowd->substep);
    }
}

/* All pairs of pieces that are contacts or near ones. */
static int fill_known(Crowd *crowd) {
    Index *known = &crowd->known;
    int status = index_room(known, crowd->near_count + crowd->contact_count + 1);
    if (status != SIM_OK) return status;
    index_clear(known);
    for (int32_t i = 0; i < crowd->contact_count; i++) index_add(known, crowd->contact[i].key, 0);
    for (int32_t i = 0; i < crowd->near_count; i++)
        index_add(known, pair_key(crowd->near[i].piece_a, crowd->near[i].piece_b), 0);
    return SIM_OK;
}

/* A pair of shapes that may meet after all: those of its pieces that are not known yet come near, to be looked at. */
static int add_near(Crowd *crowd, const World *world, int32_t shape_a, int32_t shape_b) {
    const Shape *sa = &world->shape[shape_a], *sb = &world->shape[shape_b];
    for (int32_t p = sa->first_piece; p < sa->first_piece + sa->piece_count; p++)
        for (int32_t q = sb->first_piece; q < sb->first_piece + sb->piece_count; q++) {
            Box box_a = swept(crowd, crowd->piece_box[p], sa->body);
            Box box_b = swept(crowd, crowd->piece_box[q], sb->body);
            if (!boxes_meet(&box_a, &box_b)) continue;
            if (index_room(&crowd->known, crowd->known.count + 1) != SIM_OK) return SIM_OUT_OF_MEMORY;
            if (!index_add(&crowd->known, pair_key(p, q), 0)) continue;
            if (near_room(crowd, crowd->near_count + 1) != SIM_OK) return SIM_OUT_OF_MEMORY;
            if (contact_room(crowd, crowd->contact_count + crowd->near_count + 1) != SIM_OK) return SIM_OUT_OF_MEMORY;
            crowd->near[crowd->near_count++] =
                (Near){.piece_a = p, .piece_b = q, .a = sa->body, .b = sb->body, .gap = -INFINITY};
        }
    return SIM_OK;
}

/* A body that was knocked out of its range may meet others: look for the pairs. */
static int follow(Crowd *crowd, const World *world, int32_t body, double left) {
    widen_range(crowd, world, body, left);
    sweep_boxes(crowd, world, body);
    if (crowd->known.count < 0 && fill_known(crowd) != SIM_OK) return SIM_OUT_OF_MEMORY;
    const Body *b = &world->body[body];
    for (int32_t s = b->first_shape; s < b->first_shape + b->shape_count; s++)
        for (int32_t k = 0; k < world->shape_count; k++) {
            if (!boxes_meet(&crowd->shape_box[s], &crowd->shape_box[k])) continue;
            if (!takes_part(world, &world->shape[k]) || !world_collides(world, s, k)) continue;
            int status = add_near(crowd, world, s < k ? s : k, s < k ? k : s);
            if (status != SIM_OK) return status;
        }
    return SIM_OK;
}

static int follow_strays(Crowd *crowd, const World *world, double left, double dt) {
    for (int32_t k = 0; k < crowd->active_count; k++) {
        int32_t i = crowd->active[k];
        const Mover *m = &crowd->mover[i];
        const Range *range = &crowd->range[i];
        Vec to = vmad(m->moved, dt, m->velocity);
        double out = larger(larger(range->low.x - to.x, to.x - range->high.x),
                            larger(range->low.y - to.y, to.y - range->high.y));
        double turning = smaller(fabs(m->turned) + fabs(m->spin) * dt, 2.0) * crowd->body_swing[i];
        if (larger(out, 0) + turning <= range->room) continue;
        int status = follow(crowd, world, i, left);
        if (status != SIM_OK) return status;
    }
    return SIM_OK;
}

static void advance(Mover *m, const Mover *from, double time) {
    m->moved = vmad(from->moved, time, from->velocity);
    m->turned = from->turned + time * from->spin;
}

/* Whether a fast pair becomes a contact: it is followed through the substep to where it first touches, if it does, since
 * the sides that face each other now need not be those that meet (conservative advancement, Mirtich 1996). */
static bool look_along(Crowd *crowd, World *world, Near *near, double dt, double later) {
    enum { STEPS = 32 };
    Mover *a = &crowd->mover[near->a], *b = &crowd->mover[near->b], from_a = *a, from_b = *b;
    double time = 0, close = skin_of(world, near);
    bool contact = false;
    Near probe = *near;
    for (int32_t step = 0; step < STEPS && time < dt; step++) {
        advance(a, &from_a, time);
        advance(b, &from_b, time);
        touch_place(crowd, world, near->a);
        touch_place(crowd, world, near->b);
        contact = look(crowd, world, &probe, close, later);
        if (step == 0) *near = probe;
        double rate = approach(crowd, &probe, 1);
        if (contact || rate <= 0 || probe.gap <= 0) break;
        time += larger(probe.gap, close) / rate;
    }
    *a = from_a;
    *b = from_b;
    crowd->placed[near->a] = crowd->placed[near->b] = crowd->moment - 1;
    return contact;
}

/* After the passes: the near pairs that may touch in the substep at the velocities found become contacts.  Whether there
 * were any, and whether any is to bounce; they are hot. */
int touch_near(Crowd *crowd, World *world, double left, double substep, double threshold, bool *found, bool *bounces) {
    int status = follow_strays(crowd, world, left, substep);
    if (status != SIM_OK) return status;
    int32_t kept = 0, before = crowd->contact_count;
    for (int32_t i = 0; i < crowd->near_count; i++) {
        Near *near = &crowd->near[i];
        if (gap_now(crowd, near) <= approach(crowd, near, substep)) {
            double soon = closing(crowd, world, near, substep),
                   reach = contact_reach(world, near->piece_a, near->piece_b);
            double later = soon + closing(crowd, world, near, left) + MORE * reach;
            bool fast = soon > FAST * reach;
            if (fast ? look_along(crowd, world, near, substep, later) : look(crowd, world, near, soon, later)) {
                if (crowd->mover[near->a].inverse_mass > 0) crowd->heat[near->a] = crowd->passes;
                if (crowd->mover[near->b].inverse_mass > 0) crowd->heat[near->b] = crowd->passes;
                continue;
            }
        }
        if (kept != i) crowd->near[kept] = *near;
        kept++;
    }
    crowd->near_count = kept;
    *found = crowd->contact_count > before;
    if (!*found) return SIM_OK;
    int32_t more = crowd->contact_count - before;
    contacts_limit(crowd->contact + before, more, crowd->mover, substep);
    *bounces = contacts_measure(crowd->contact + before, more, crowd->mover, threshold) || *bounces;
    contacts_warm_start(crowd->contact + before, more, crowd->mover);
    return SIM_OK;
}

/* Which bodies touch something, hang on something, or may meet something in another frame like this one. */
static void find_touched(Crowd *crowd, const World *world, double dt) {
    bool *touched = crowd->touched;
    for (int32_t k = 0; k < crowd->active_count; k++) touched[crowd->active[k]] = false;
    for (int32_t i = 0; i < crowd->pivots.count; i++)
        touched[crowd->pivots.pivot[i].a] = touched[crowd->pivots.pivot[i].b] = true;
    for (int32_t i = 0; i < crowd->contact_count; i++)
        touched[crowd->contact[i].a] = touched[crowd->contact[i].b] = true;
    for (int32_t i = 0; i < crowd->near_count; i++) {
        const Near *near = &crowd->near[i];
        if (gap_now(crowd, near) <= closing(crowd, world, near, dt) + skin_of(world, near))
            touched[near->a] = touched[near->b] = true;
    }
}

/* At the end of a frame: who touches, and what is known of the gaps, for the next one. */
int touch_finish(Crowd *crowd, const World *world, double dt) {
    find_touched(crowd, world, dt);
    if (index_room(&crowd->last_index, crowd->near_count + 1) != SIM_OK) return SIM_OUT_OF_MEMORY;
    index_clear(&crowd->last_index);
    for (int32_t i = 0; i < crowd->near_count; i++) {
        Near *near = &crowd->near[i];
        near->gap = gap_now(crowd, near);
        index_add(&crowd->last_index, pair_key(near->piece_a, near->piece_b), i);
    }
    for (int32_t i = 0; i < world->body_count; i++) {
        const Body *b = &world->body[i];
        const Mover *m = &crowd->mover[i];
        crowd->end[i] = vadd(b->position, m->moved);
        crowd->end_angle[i] = b->angle + m->turned;
    }
    Near *swap = crowd->last_near;
    crowd->last_near = crowd->near;
    crowd->near = swap;
    return SIM_OK;
}
