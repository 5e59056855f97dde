/* Finding the crowd's contacts: boxes, then pieces; at once where they touch, in time where they only come near. */
#include <stdlib.h>
#include <string.h>

#include "crowd_parts.h"

static const double SKIN = 1e-3; /* of the smaller reach: as near as that counts as touching */
static const double MORE = 0.05; /* of the smaller reach: a contact's other end comes with it when it is as near as that */
static const double TURN = 0.03; /* [rad]: a pair that has turned so far in the frame is looked at again */

static void *table(size_t count, size_t size) { return calloc(count + 1, size); }

static int contact_room(Crowd *crowd, int32_t count) {
    if (count <= crowd->contact_capacity) return SIM_OK;
    int32_t capacity = 2 * count + 64, slots = 64;
    while (slots < 3 * capacity) slots *= 2;
    Contact *contact = realloc(crowd->contact, (size_t)capacity * sizeof *contact);
    if (contact) crowd->contact = contact;
    Contact *old = realloc(crowd->memory.contact, (size_t)capacity * sizeof *old);
    if (old) crowd->memory.contact = old;
    if (!contact || !old) return SIM_OUT_OF_MEMORY;
    int32_t *slot = malloc((size_t)slots * sizeof *slot);
    if (!slot) return SIM_OUT_OF_MEMORY;
    free(crowd->memory.slot);
    crowd->memory.slot = slot;
    crowd->memory.slots = slots;
    crowd->contact_capacity = capacity;
    return SIM_OK;
}

static int near_room(Crowd *crowd, int32_t count) {
    if (count <= crowd->near_capacity) return SIM_OK;
    int32_t capacity = 2 * count + 64;
    Near *near = realloc(crowd->near, (size_t)capacity * sizeof *near);
    if (!near) return SIM_OUT_OF_MEMORY;
    crowd->near = near;
    crowd->near_capacity = capacity;
    return SIM_OK;
}

static uint32_t hash(uint64_t key) {
    key ^= key >> 31;
    key *= 0x9e3779b97f4a7c15u;
    return (uint32_t)(key >> 33);
}

/* The contacts of the last frame become memory. */
static void remember(Crowd *crowd) {
    Memory *memory = &crowd->memory;
    Contact *free_again = memory->contact;
    memory->contact = crowd->contact;
    memory->count = crowd->contact_count;
    crowd->contact = free_again;
    crowd->contact_count = 0;
}

static void index_memory(Memory *memory) {
    if (!memory->slot) return;
    memset(memory->slot, 0xff, (size_t)memory->slots * sizeof *memory->slot);
    uint32_t mask = (uint32_t)memory->slots - 1;
    for (int32_t i = 0; i < memory->count; i++) {
        uint32_t at = hash(memory->contact[i].key) & mask;
        while (memory->slot[at] >= 0) at = (at + 1) & mask;
        memory->slot[at] = i;
    }
}

static const Contact *recall(const Memory *memory, uint64_t key) {
    if (!memory->slot || memory->count == 0) return NULL;
    uint32_t mask = (uint32_t)memory->slots - 1;
    for (uint32_t at = hash(key) & mask; memory->slot[at] >= 0; at = (at + 1) & mask)
        if (memory->contact[memory->slot[at]].key == key) return &memory->contact[memory->slot[at]];
    return NULL;
}

int touch_create(Crowd *crowd, const World *world) {
    size_t bodies = (size_t)world->body_count, pieces = (size_t)world->piece_count, shapes = (size_t)world->shape_count;
    crowd->start = table(bodies, sizeof *crowd->start);
    crowd->placed = table(bodies, sizeof *crowd->placed);
    crowd->piece_box = table(pieces, sizeof *crowd->piece_box);
    crowd->shape_box = table(shapes, sizeof *crowd->shape_box);
    crowd->shape_moves = table(shapes, sizeof *crowd->shape_moves);
    if (!crowd->start || !crowd->placed || !crowd->piece_box || !crowd->shape_box || !crowd->shape_moves)
        return SIM_OUT_OF_MEMORY;
    if (sweep_create(&crowd->sweep, world->shape_count) != SIM_OK) return SIM_OUT_OF_MEMORY;
    if (contact_room(crowd, 2 * world->body_count) != SIM_OK) return SIM_OUT_OF_MEMORY;
    return posed_create(&crowd->posed, world);
}

void touch_destroy(Crowd *crowd) {
    free(crowd->start);
    free(crowd->placed);
    posed_destroy(&crowd->posed);
    free(crowd->piece_box);
    free(crowd->shape_box);
    free(crowd->shape_moves);
    sweep_destroy(&crowd->sweep);
    free(crowd->near);
    free(crowd->contact);
    free(crowd->memory.contact);
    free(crowd->memory.slot);
}

/* Bring a body's outlines to where it is now. */
void touch_place(Crowd *crowd, const World *world, int32_t body) {
    const Body *b = &world->body[body];
    const Mover *m = &crowd->mover[body];
    Pose at = crowd->start[body];
    if (m->turned != 0 || m->moved.x != 0 || m->moved.y != 0)
        at = pose(vadd(b->position, m->moved), b->angle + m->turned);
    posed_place(&crowd->posed, world, body, at);
    crowd->placed[body] = crowd->moment;
}

/* The boxes of a body's pieces now, and those of its shapes over the coming frame. */
static void find_boxes(Crowd *crowd, const World *world, int32_t body, double dt) {
    const Body *b = &world->body[body];
    bool moves = b->mode == MODE_CROWD;
    Vec travel = moves ? vmad(vscale(b->velocity, dt), dt * dt, world->gravity) : vec(0, 0);
    for (int32_t s = b->first_shape; s < b->first_shape + b->shape_count; s++) {
        const Shape *shape = &world->shape[s];
        Box box = {0};
        double swing = 0;
        for (int32_t p = shape->first_piece; p < shape->first_piece + shape->piece_count; p++) {
            crowd->piece_box[p] = posed_box(&crowd->posed, p);
            box = p == shape->first_piece ? crowd->piece_box[p] : box_join(box, crowd->piece_box[p]);
            swing = fmax(swing, crowd->posed.swing[p]);
        }
        if (moves) {
            Box there = {vadd(box.low, travel), vadd(box.high, travel)};
            box = box_grow(box_join(box, there), SKIN * b->reach + fmin(fabs(b->spin) * dt, 2.0) * swing);
        }
        crowd->shape_box[s] = box;
        crowd->shape_moves[s] = moves;
    }
}

/* How much nearer two bodies' pieces can come along the normal in dt, at their present velocities. */
static inline double approach(const Crowd *crowd, const Near *n, double dt) {
    const Mover *a = &crowd->mover[n->a], *b = &crowd->mover[n->b];
    double turning = fabs(a->spin) * crowd->posed.swing[n->piece_a] + fabs(b->spin) * crowd->posed.swing[n->piece_b];
    return dt * (turning - vdot(n->normal, vsub(b->velocity, a->velocity)));
}

static void fill_point(Point *p, const ManifoldPoint *found, const Contact *c, const Mover *a, const Mover *b, Vec at_a,
                       Vec at_b) {
    Vec n = c->normal, t = vperp(n), ra = vsub(found->point, at_a), rb = vsub(found->point, at_b);
    double m = a->inverse_mass + b->inverse_mass;
    *p = (Point){.feature = found->feature};
    p->spin_na = vcross(ra, n);
    p->spin_nb = vcross(rb, n);
    p->spin_ta = vcross(ra, t);
    p->spin_tb = vcross(rb, t);
    p->along_na = vdot(ra, n);
    p->along_nb = vdot(rb, n);
    p->mass_n = 1 / (m + a->inverse_moment * p->spin_na * p->spin_na + b->inverse_moment * p->spin_nb * p->spin_nb);
    p->mass_t = 1 / (m + a->inverse_moment * p->spin_ta * p->spin_ta + b->inverse_moment * p->spin_tb * p->spin_tb);
    /* what a mover has done in the frame so far is in the formula of crowd_rows.c, and taken off here */
    p->separation = found->separation - vdot(vsub(b->moved, a->moved), n) - b->turned * p->spin_nb +
                    a->turned * p->spin_na +
                    0.5 * (b->turned * b->turned * p->along_nb - a->turned * a->turned * p->along_na);
}

static double smaller_reach(const World *world, int32_t piece_a, int32_t piece_b) {
    return fmin(world->shape[world->piece[piece_a].shape].reach, world->shape[world->piece[piece_b].shape].reach);
}

/* The points of a contact from its manifold, with the impulses that the same points had in `old`. */
static void set_points(Crowd *crowd, const World *world, Contact *c, const Manifold *m, const Contact *old) {
    const Mover *a = &crowd->mover[c->a], *b = &crowd->mover[c->b];
    Vec at_a = vadd(world->body[c->a].position, a->moved), at_b = vadd(world->body[c->b].position, b->moved);
    Point last[2];
    int32_t last_count = old ? old->count : 0;
    for (int32_t l = 0; l < last_count; l++) last[l] = old->point[l];
    c->count = m->count;
    c->normal = m->normal;
    c->turned = b->turned - a->turned;
    c->moved = vsub(b->moved, a->moved);
    for (int32_t k = 0; k < m->count; k++) {
        fill_point(&c->point[k], &m->point[k], c, a, b, at_a, at_b);
        for (int32_t l = 0; l < last_count; l++)
            if (last[l].feature == m->point[k].feature) {
                c->point[k].impulse_n = last[l].impulse_n;
                c->point[k].impulse_t = last[l].impulse_t;
                c->point[k].approach = last[l].approach;
            }
    }
}

/* Bodies this slow come to rest by rolling resistance, as real ones do: without it a box rocks on a ball for ever. */
static bool slow(const World *world, int32_t body) {
    static const double SLOW = 0.1; /* of the speed of falling by its own reach */
    const Body *b = &world->body[body];
    double limit = SLOW * SLOW * vlength(world->gravity) * b->reach;
    return vdot(b->velocity, b->velocity) + b->spin * b->spin * b->reach * b->reach <= limit;
}

static void add_contact(Crowd *crowd, const World *world, const Near *near, const Manifold *m) {
    static const double PUSH = 20, SLACK = 0.05, ROLLING = 2e-3; /* per second, of the smaller reach, of it */
    const Shape *sa = &world->shape[world->piece[near->piece_a].shape];
    const Shape *sb = &world->shape[world->piece[near->piece_b].shape];
    double reach = smaller_reach(world, near->piece_a, near->piece_b);
    Contact *c = &crowd->contact[crowd->contact_count++];
    c->a = near->a;
    c->b = near->b;
    c->walled = crowd->mover[near->a].inverse_mass == 0 || crowd->mover[near->b].inverse_mass == 0;
    c->friction = pair_friction(sa, sb);
    c->elasticity = pair_elasticity(sa, sb);
    c->push = PUSH * reach;
    c->slack = SLACK * reach;
    c->rolling = slow(world, near->a) && slow(world, near->b) ? ROLLING * reach * (c->friction < 1 ? c->friction : 1) : 0;
    c->key = (uint64_t)(uint32_t)near->piece_a << 32 | (uint32_t)near->piece_b;
    set_points(crowd, world, c, m, recall(&crowd->memory, c->key));
}

static void find_manifold(Crowd *crowd, World *world, int32_t piece_a, int32_t piece_b, int32_t a, int32_t b, double margin,
                          Manifold *m) {
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
    near->normal = m.normal;
    near->gap = m.gap;
    if (m.count == 0 || m.gap > soon) return false;
    add_contact(crowd, world, near, &m);
    return true;
}

static double skin_of(const World *world, const Near *near) {
    return SKIN * smaller_reach(world, near->piece_a, near->piece_b);
}

/* An upper bound of how much nearer two bodies come in dt, whatever the direction. */
static double closing(const Crowd *crowd, const World *world, const Near *near, double dt) {
    const Mover *a = &crowd->mover[near->a], *b = &crowd->mover[near->b];
    double turning = fabs(a->spin) * crowd->posed.swing[near->piece_a] + fabs(b->spin) * crowd->posed.swing[near->piece_b];
    return dt * (vlength(vsub(b->velocity, a->velocity)) + turning) + dt * dt * vlength(world->gravity);
}

/* Whether a body wakes a resting one at this distance: a fast one that may hit it, or one just woken that touches it. */
static bool wakes(const Crowd *crowd, const World *world, int32_t body, double gap, double skin) {
    return rest_rouses(crowd, world, body) && (gap <= skin || !crowd->roused[body]);
}

static int consider(Crowd *crowd, World *world, Near near, double dt, double substep, bool *woke) {
    if (near_room(crowd, crowd->near_count + 1) != SIM_OK) return SIM_OUT_OF_MEMORY;
    if (contact_room(crowd, crowd->contact_count + crowd->near_count + 1) != SIM_OK) return SIM_OUT_OF_MEMORY;
    double skin = skin_of(world, &near), later = closing(crowd, world, &near, dt) + skin;
    double more = MORE * smaller_reach(world, near.piece_a, near.piece_b);
    double soon = closing(crowd, world, &near, substep) + skin;
    bool contact = look(crowd, world, &near, soon, later + more);
    if (near.gap > later) return SIM_OK;
    if (!contact) crowd->near[crowd->near_count++] = near;
    crowd->touched[near.a] = crowd->touched[near.b] = true;
    if (world->body[near.a].mode == MODE_REST && wakes(crowd, world, near.b, near.gap, skin)) {
        rest_wake(crowd, world, near.a);
        *woke = true;
    }
    if (world->body[near.b].mode == MODE_REST && wakes(crowd, world, near.a, near.gap, skin)) {
        rest_wake(crowd, world, near.b);
        *woke = true;
    }
    return SIM_OK;
}

static int consider_shapes(Crowd *crowd, World *world, Pair pair, double dt, double substep, bool *woke) {
    const Shape *sa = &world->shape[pair.a], *sb = &world->shape[pair.b];
    Mode ma = world->body[sa->body].mode, mb = world->body[sb->body].mode;
    if (ma == MODE_FLIGHT || mb == MODE_FLIGHT || ma == MODE_SMOOTH || mb == MODE_SMOOTH) return SIM_OK;
    if (!world_collides(world, pair.a, pair.b)) return SIM_OK;
    bool many = sa->piece_count > 1 || sb->piece_count > 1;
    double margin_a = 0, margin_b = 0;
    if (many) { /* as far as the shapes' boxes are swept */
        Near whole = {sa->first_piece, sb->first_piece, sa->body, sb->body, {0, 0}, 0};
        margin_a = closing(crowd, world, &whole, dt) + skin_of(world, &whole);
        margin_b = margin_a;
    }
    for (int32_t p = sa->first_piece; p < sa->first_piece + sa->piece_count; p++) {
        Box box_a = box_grow(crowd->piece_box[p], margin_a);
        if (many && !boxes_meet(&box_a, &crowd->shape_box[pair.b])) continue;
        for (int32_t q = sb->first_piece; q < sb->first_piece + sb->piece_count; q++) {
            if (many) {
                Box box_b = box_grow(crowd->piece_box[q], margin_b);
                if (!boxes_meet(&box_a, &box_b)) continue;
            }
            Near near = {p, q, sa->body, sb->body, {0, 0}, 0};
            int status = consider(crowd, world, near, dt, substep, woke);
            if (status != SIM_OK) return status;
        }
    }
    return SIM_OK;
}

static void load(Crowd *crowd, const World *world) {
    for (int32_t i = 0; i < world->body_count; i++) {
        const Body *body = &world->body[i];
        Mover *m = &crowd->mover[i];
        *m = (Mover){0};
        crowd->touched[i] = false;
        if (body->mode == MODE_CROWD) {
            m->velocity = body->velocity;
            m->spin = body->spin;
            m->inverse_mass = body->inverse_mass;
            m->inverse_moment = body->inverse_moment;
        }
    }
}

/* Begin a frame: all pairs that may touch in it, as contacts or as near ones. Bodies at rest that a moving one may reach are
 * woken, and those that they reach in turn. */
int touch_frame(Crowd *crowd, World *world, double dt, double substep) {
    crowd->moment++;
    remember(crowd);
    index_memory(&crowd->memory);
    for (int32_t i = 0; i < world->body_count; i++) crowd->roused[i] = false;
    bool woke;
    do {
        woke = rest_wake_joined(crowd, world);
        load(crowd, world);
        crowd->near_count = crowd->contact_count = 0;
        for (int32_t i = 0; i < world->body_count; i++) {
            Body *body = &world->body[i];
            if (body->mode == MODE_FLIGHT || body->mode == MODE_SMOOTH) {
                for (int32_t s = body->first_shape; s < body->first_shape + body->shape_count; s++)
                    crowd->shape_moves[s] = false;
                continue;
            }
            bool still = body->mode != MODE_CROWD && crowd->placed[i] != 0;
            if (!still || crowd->start[i].p.x != body->position.x || crowd->start[i].p.y != body->position.y) {
                crowd->start[i] = body_pose(body);
                touch_place(crowd, world, i);
            }
            crowd->placed[i] = crowd->moment;
            find_boxes(crowd, world, i, dt);
        }
        if (sweep_pairs(&crowd->sweep, crowd->shape_box, crowd->shape_moves) != SIM_OK) return SIM_OUT_OF_MEMORY;
        for (int32_t k = 0; k < crowd->sweep.pair_count; k++) {
            int status = consider_shapes(crowd, world, crowd->sweep.pair[k], dt, substep, &woke);
            if (status != SIM_OK) return status;
        }
    } while (woke);
    return SIM_OK;
}

/* Find the points anew of contacts whose bodies have turned or shifted a good deal since. */
void touch_refresh(Crowd *crowd, World *world, double left, double threshold) {
    for (int32_t i = 0; i < crowd->contact_count; i++) {
        Contact *c = &crowd->contact[i];
        const Mover *a = &crowd->mover[c->a], *b = &crowd->mover[c->b];
        Vec shifted = vsub(vsub(b->moved, a->moved), c->moved);
        double turned = b->turned - a->turned - c->turned;
        if (fabs(turned) < TURN && fabs(shifted.x) + fabs(shifted.y) < c->slack) continue;
        Near near = {(int32_t)(c->key >> 32), (int32_t)(c->key & 0xffffffffu), c->a, c->b, c->normal, 0};
        Manifold m;
        find_manifold(crowd, world, near.piece_a, near.piece_b, c->a, c->b, closing(crowd, world, &near, left) + c->slack, &m);
        set_points(crowd, world, c, &m, c);
        contacts_measure(c, 1, crowd->mover, threshold);
    }
}

/* In a substep: the near pairs that may touch in it at the present velocities become contacts. */
int touch_near(Crowd *crowd, World *world, double left, double substep, double threshold, bool *found) {
    int32_t kept = 0, first = crowd->contact_count;
    for (int32_t i = 0; i < crowd->near_count; i++) {
        Near near = crowd->near[i];
        if (near.gap - approach(crowd, &near, substep) <= 0) {
            double soon = closing(crowd, world, &near, substep);
            if (look(crowd, world, &near, soon, closing(crowd, world, &near, left) + soon + MORE * smaller_reach(world, near.piece_a, near.piece_b)))
                continue;
        }
        crowd->near[kept++] = near;
    }
    crowd->near_count = kept;
    *found = crowd->contact_count > first;
    if (*found)
        contacts_measure(crowd->contact + first, crowd->contact_count - first, crowd->mover, threshold);
    return SIM_OK;
}

/* After the bodies have moved: what is left of the gaps. */
void touch_advance(Crowd *crowd, double substep) {
    for (int32_t i = 0; i < crowd->near_count; i++)
        crowd->near[i].gap -= approach(crowd, &crowd->near[i], substep);
}
