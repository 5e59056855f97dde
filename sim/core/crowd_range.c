/* Where bodies may be in a frame: their outlines, and the boxes of all that they may sweep. */
#include <stdlib.h>

#include "crowd_parts.h"

static const double ROOM =
    0.1;  /* of a body's reach: what it may stray from its way before its pairs are looked for anew */

int range_create(Crowd *crowd, const World *world) {
    size_t bodies = (size_t)world->body_count, pieces = (size_t)world->piece_count, shapes = (size_t)world->shape_count;
    crowd->start = table(bodies, sizeof *crowd->start);
    crowd->placed = table(bodies, sizeof *crowd->placed);
    crowd->piece_box = table(pieces, sizeof *crowd->piece_box);
    crowd->piece_reach = table(pieces, sizeof *crowd->piece_reach);
    crowd->shape_box = table(shapes, sizeof *crowd->shape_box);
    crowd->shape_moves = table(shapes, sizeof *crowd->shape_moves);
    crowd->range = table(bodies, sizeof *crowd->range);
    crowd->start_angle = table(bodies, sizeof *crowd->start_angle);
    crowd->body_swing = table(bodies, sizeof *crowd->body_swing);
    crowd->lead = table(bodies, sizeof *crowd->lead);
    if (!crowd->start || !crowd->placed || !crowd->piece_box || !crowd->shape_box || !crowd->shape_moves ||
        !crowd->range || !crowd->piece_reach || !crowd->start_angle || !crowd->body_swing || !crowd->lead)
        return SIM_OUT_OF_MEMORY;
    if (posed_create(&crowd->posed, world) != SIM_OK) return SIM_OUT_OF_MEMORY;
    for (int32_t i = 0; i < world->piece_count; i++) {
        int32_t body = world->shape[world->piece[i].shape].body;
        crowd->body_swing[body] = larger(crowd->body_swing[body], crowd->posed.swing[i]);
        crowd->piece_reach[i] = world->shape[world->piece[i].shape].reach;
    }
    return SIM_OK;
}

void range_destroy(Crowd *crowd) {
    free(crowd->start);
    free(crowd->placed);
    posed_destroy(&crowd->posed);
    free(crowd->piece_box);
    free(crowd->piece_reach);
    free(crowd->shape_box);
    free(crowd->shape_moves);
    free(crowd->range);
    free(crowd->start_angle);
    free(crowd->body_swing);
    free(crowd->lead);
}

/* Bring a body's outlines to where it is now. */
void range_place(Crowd *crowd, const World *world, int32_t body) {
    if (crowd->mover[body].inverse_mass > 0)
        posed_place(&crowd->posed, world, body, pose(crowd_position(crowd, body), crowd_angle(crowd, body)));
    crowd->placed[body] = crowd->moment;
}

/* All that a box of the body may sweep while the body keeps to its range. */
Box range_swept(const Crowd *crowd, Box box, int32_t body) {
    const Range *range = &crowd->range[body];
    Vec lead = crowd->lead[body];
    return box_grow((Box){vadd(box.low, vsub(range->low, lead)), vadd(box.high, vsub(range->high, lead))}, range->room);
}

/* Let a body's range reach as far as it goes from where it is, at its present velocity. */
static void widen(Crowd *crowd, const World *world, int32_t body, double left) {
    const Mover *m = &crowd->mover[body];
    Range *range = &crowd->range[body];
    Vec end = vadd(m->moved, vmad(vscale(m->velocity, left), left * left, world->gravity));
    range->low =
        vec(smaller(range->low.x, smaller(m->moved.x, end.x)), smaller(range->low.y, smaller(m->moved.y, end.y)));
    range->high =
        vec(larger(range->high.x, larger(m->moved.x, end.x)), larger(range->high.y, larger(m->moved.y, end.y)));
    range->room += ROOM * world->body[body].reach + smaller(fabs(m->spin) * left, 2.0) * crowd->body_swing[body];
}

static void sweep(Crowd *crowd, const World *world, int32_t body) {
    const Body *b = &world->body[body];
    for (int32_t s = b->first_shape; s < b->first_shape + b->shape_count; s++) {
        const Shape *shape = &world->shape[s];
        Box box = crowd->piece_box[shape->first_piece];
        for (int32_t p = 1; p < shape->piece_count; p++) box = box_join(box, crowd->piece_box[shape->first_piece + p]);
        crowd->shape_box[s] = range_swept(crowd, box, body);
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
void range_start(Crowd *crowd, const World *world, int32_t body, double dt) {
    const Body *b = &world->body[body];
    Pose *start = &crowd->start[body];
    bool moves = b->mode == MODE_CROWD;
    bool known = !moves && crowd->placed[body] != 0 && start->p.x == b->position.x && start->p.y == b->position.y &&
                 crowd->start_angle[body] == b->angle;
    crowd->range[body] = (Range){{0, 0}, {0, 0}, 0};
    crowd->lead[body] = vec(0, 0);
    if (moves) {
        widen(crowd, world, body, dt);
        look_ahead(crowd, world, body, dt);
    }
    if (!known) {
        *start = pose(crowd_position(crowd, body), crowd_angle(crowd, body));
        crowd->start_angle[body] = crowd_angle(crowd, body);
        posed_place(&crowd->posed, world, body, *start);
        for (int32_t s = b->first_shape; s < b->first_shape + b->shape_count; s++) {
            const Shape *shape = &world->shape[s];
            for (int32_t p = 0; p < shape->piece_count; p++)
                crowd->piece_box[shape->first_piece + p] = posed_box(&crowd->posed, shape->first_piece + p);
        }
    }
    crowd->placed[body] = crowd->moment;
    sweep(crowd, world, body);
}

/* Let a body's range reach as far as it goes from where it is, and its boxes with it. */
void range_widen(Crowd *crowd, const World *world, int32_t body, double left) {
    widen(crowd, world, body, left);
    sweep(crowd, world, body);
}
