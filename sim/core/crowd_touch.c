/* Finding the crowd's contacts: boxes, then pieces; at once where they touch, in time where they only come near. */
#include <stdlib.h>

#include "crowd_parts.h"

static const double MORE =
    0.05; /* of the smaller reach: a contact's other end comes with it when it is as near as that */
static const double FAST =
    0.25; /* of the smaller reach in a substep: a pair as fast as that is followed to its touch */

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
    size_t bodies = (size_t)world->body_count;
    crowd->end = table(bodies, sizeof *crowd->end);
    crowd->end_angle = table(bodies, sizeof *crowd->end_angle);
    if (!crowd->end || !crowd->end_angle) return SIM_OUT_OF_MEMORY;
    if (range_create(crowd, world) != SIM_OK) return SIM_OUT_OF_MEMORY;
    if (sweep_create(&crowd->sweep, world->shape_count) != SIM_OK) return SIM_OUT_OF_MEMORY;
    if (rows_create(&crowd->rows, world->body_count) != SIM_OK) return SIM_OUT_OF_MEMORY;
    return rows_room(&crowd->rows, 2 * world->body_count);
}

void touch_destroy(Crowd *crowd) {
    range_destroy(crowd);
    free(crowd->end);
    free(crowd->end_angle);
    index_destroy(&crowd->known);
    index_destroy(&crowd->last_index);
    free(crowd->last_near);
    sweep_destroy(&crowd->sweep);
    free(crowd->near);
    rows_destroy(&crowd->rows);
    memory_destroy(&crowd->memory);
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
    if (rows_room(&crowd->rows, crowd->rows.count + crowd->near_count + 1) != SIM_OK) return SIM_OUT_OF_MEMORY;
    double skin = near_skin(crowd, &near), rate = near_rate(crowd, &near);
    double later = near_closing(crowd, rate, dt) + skin, soon = near_closing(crowd, rate, substep) + skin;
    bool contact = false;
    Vec normal;
    double gap = box_gap(&crowd->piece_box[near.piece_a], &crowd->piece_box[near.piece_b], &normal);
    near_set(crowd, &near, normal, gap);
    int32_t last = gap <= soon ? index_find(&crowd->last_index, pair_key(near.piece_a, near.piece_b)) : -1;
    if (last >= 0 && came_straight(crowd, world, near.a) && came_straight(crowd, world, near.b)) {
        Near before = near;
        before.normal = crowd->last_near[last].normal;
        before.gap = crowd->last_near[last].gap;
        before.moved = vec(0, 0);
        before.turned_a = before.turned_b = 0;
        double kept = near_gap(crowd, &before);
        if (kept > gap) {
            near = before;
            gap = kept;
        }
    }
    double reach = contact_reach(crowd, near.piece_a, near.piece_b);
    if (gap <= soon && soon <= FAST * reach) contact = near_look(crowd, world, &near, soon, later + MORE * reach);
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
        Box box_a = many ? range_swept(crowd, crowd->piece_box[p], sa->body) : crowd->piece_box[p];
        if (many && !boxes_meet(&box_a, &crowd->shape_box[pair.b])) continue;
        for (int32_t q = sb->first_piece; q < sb->first_piece + sb->piece_count; q++) {
            if (many) {
                Box box_b = range_swept(crowd, crowd->piece_box[q], sb->body);
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
        crowd->rows.whirls[i] = false;
        crowd->base[i] = body->position;
        crowd->base_angle[i] = body->angle;
        *m = (Mover){0};
        if (body->mode != MODE_CROWD) continue;
        crowd->active[crowd->active_count++] = i;
        crowd->touched[i] = false;
        if (!came_straight(crowd, world, i)) rest_forget(crowd, i);
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
    crowd->fall = vlength(world->gravity);
    for (int32_t i = 0; i < world->body_count; i++) crowd->roused[i] = 0;
    crowd->known.count = -1;
    bool woke;
    do {
        woke = rest_wake_joined(crowd, world);
        load(crowd, world);
        crowd->near_count = crowd->rows.count = crowd->rows.stale_count = 0;
        for (int32_t i = 0; i < world->body_count; i++) {
            const Body *body = &world->body[i];
            if (body->mode == MODE_FLIGHT || body->mode == MODE_SMOOTH) {
                for (int32_t s = body->first_shape; s < body->first_shape + body->shape_count; s++)
                    crowd->shape_moves[s] = false;
                continue;
            }
            range_start(crowd, world, i, dt);
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
    for (int32_t i = 0; i < crowd->rows.stale_count; i++) {
        Contact *c = &crowd->rows.contact[crowd->rows.stale[i]];
        Near near = {
            .piece_a = (int32_t)(c->key >> 32), .piece_b = (int32_t)(c->key & 0xffffffffu), .a = c->a, .b = c->b};
        double margin = near_closing(crowd, near_rate(crowd, &near), left) + c->slack;
        Manifold m = {.gap = 0};
        do { /* what is on its way out now may be knocked back: it keeps a point at least */
            margin = larger(margin, m.gap + c->slack);
            near_manifold(crowd, world, near.piece_a, near.piece_b, c->a, c->b, margin, &m);
        } while (m.count == 0 && m.gap > margin);
        Record old = contact_record(c);
        contact_set_points(crowd, world, c, &m, &old);
        gap_limit(c, 1, crowd->mover, crowd->substep);
    }
}

/* All pairs of pieces that are contacts or near ones. */
static int fill_known(Crowd *crowd) {
    Index *known = &crowd->known;
    int status = index_room(known, crowd->near_count + crowd->rows.count + 1);
    if (status != SIM_OK) return status;
    index_clear(known);
    for (int32_t i = 0; i < crowd->rows.count; i++) index_add(known, crowd->rows.contact[i].key, 0);
    for (int32_t i = 0; i < crowd->near_count; i++)
        index_add(known, pair_key(crowd->near[i].piece_a, crowd->near[i].piece_b), 0);
    return SIM_OK;
}

/* A pair of shapes that may meet after all: those of its pieces that are not known yet come near, to be looked at. */
static int add_near(Crowd *crowd, const World *world, int32_t shape_a, int32_t shape_b) {
    const Shape *sa = &world->shape[shape_a], *sb = &world->shape[shape_b];
    for (int32_t p = sa->first_piece; p < sa->first_piece + sa->piece_count; p++)
        for (int32_t q = sb->first_piece; q < sb->first_piece + sb->piece_count; q++) {
            Box box_a = range_swept(crowd, crowd->piece_box[p], sa->body);
            Box box_b = range_swept(crowd, crowd->piece_box[q], sb->body);
            if (!boxes_meet(&box_a, &box_b)) continue;
            if (index_room(&crowd->known, crowd->known.count + 1) != SIM_OK) return SIM_OUT_OF_MEMORY;
            if (!index_add(&crowd->known, pair_key(p, q), 0)) continue;
            if (near_room(crowd, crowd->near_count + 1) != SIM_OK) return SIM_OUT_OF_MEMORY;
            if (rows_room(&crowd->rows, crowd->rows.count + crowd->near_count + 1) != SIM_OK) return SIM_OUT_OF_MEMORY;
            crowd->near[crowd->near_count++] =
                (Near){.piece_a = p, .piece_b = q, .a = sa->body, .b = sb->body, .gap = -INFINITY};
        }
    return SIM_OK;
}

/* A body that was knocked out of its range may meet others: look for the pairs. */
static int follow(Crowd *crowd, const World *world, int32_t body, double left) {
    range_widen(crowd, world, body, left);
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
        /* what nothing pushes keeps to its range */
        if (!crowd->touched[crowd->active[k]] || !range_left(crowd, crowd->active[k], dt)) continue;
        int status = follow(crowd, world, crowd->active[k], left);
        if (status != SIM_OK) return status;
    }
    return SIM_OK;
}

/* After the passes: the near pairs that may touch in the substep at the velocities found become contacts.  Whether there
 * were any; they are hot. */
int touch_near(Crowd *crowd, World *world, double left, double substep, double threshold, bool *found) {
    int status = follow_strays(crowd, world, left, substep);
    if (status != SIM_OK) return status;
    int32_t kept = 0, before = crowd->rows.count;
    for (int32_t i = 0; i < crowd->near_count; i++) {
        Near *near = &crowd->near[i];
        if (near_gap(crowd, near) <= near_approach(crowd, near, substep)) {
            double rate = near_rate(crowd, near), soon = near_closing(crowd, rate, substep),
                   reach = contact_reach(crowd, near->piece_a, near->piece_b);
            double later = soon + near_closing(crowd, rate, left) + MORE * reach;
            bool fast = soon > FAST * reach;
            if (fast ? near_look_along(crowd, world, near, substep, later)
                     : near_look(crowd, world, near, soon, later)) {
                rows_heat(&crowd->rows, crowd->mover, near->a, true);
                rows_heat(&crowd->rows, crowd->mover, near->b, true);
                continue;
            }
        }
        if (kept != i) crowd->near[kept] = *near;
        kept++;
    }
    crowd->near_count = kept;
    *found = crowd->rows.count > before;
    if (!*found) return SIM_OK;
    gap_limit(crowd->rows.contact + before, crowd->rows.count - before, crowd->mover, substep);
    rows_link(&crowd->rows, before);
    rows_measure(&crowd->rows, before, crowd->mover, threshold);
    rows_warm_start(&crowd->rows, before, crowd->mover);
    return SIM_OK;
}

/* Bodies that may meet something in another frame like this one count as touched. */
static void find_near(Crowd *crowd, double dt) {
    for (int32_t i = 0; i < crowd->near_count; i++) {
        const Near *near = &crowd->near[i];
        if (near_gap(crowd, near) <= near_closing(crowd, near_rate(crowd, near), dt) + near_skin(crowd, near))
            crowd->touched[near->a] = crowd->touched[near->b] = true;
    }
}

/* At the end of a frame: who touches, and what is known of the gaps, for the next one. */
int touch_finish(Crowd *crowd, double dt) {
    find_near(crowd, dt);
    if (index_room(&crowd->last_index, crowd->near_count + 1) != SIM_OK) return SIM_OUT_OF_MEMORY;
    index_clear(&crowd->last_index);
    for (int32_t i = 0; i < crowd->near_count; i++) {
        Near *near = &crowd->near[i];
        near->gap = near_gap(crowd, near);
        index_add(&crowd->last_index, pair_key(near->piece_a, near->piece_b), i);
    }
    for (int32_t i = 0; i < crowd->body_count; i++) {
        crowd->end[i] = crowd_position(crowd, i);
        crowd->end_angle[i] = crowd_angle(crowd, i);
    }
    Near *swap = crowd->last_near;
    crowd->last_near = crowd->near;
    crowd->near = swap;
    return SIM_OK;
}
