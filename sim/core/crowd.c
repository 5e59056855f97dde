/* The crowd's steps: frames of collision finding, each of several substeps of the solver (Catto's Solver2D, 2024). */
#include <stdlib.h>

#include "crowd_parts.h"

static const double FRAME = 1.0 / 20;    /* [s]: contacts are found anew this often */
static const double FAR = 0.25;          /* of a body's reach, in such a time */
static const double MANY = 0.35;         /* of the bodies that move */
static const double SUBSTEP = 1.0 / 240; /* [s]: the longest substep */
static const double FALL = 1.0 / 24;     /* of the time in which a body falls by its own reach: likewise */
static const double SHORTER = 1.0 / 16;  /* of the longest: the shortest */
static const int32_t FIRST_PASSES = 1; /* before the first look for new contacts, which are then solved with the rest */
static const int32_t PASSES = 5; /* between other looks, at most */
static const int32_t UNEVEN_PASSES = 30; /* likewise, where masses are very different */
static const int32_t LOOKS = 6; /* of a substep, at most */

/* The longest substep: what is strongly pulled, or small, does not go farther in it than others do for their size. */
static double longest_substep(const World *world) {
    double sum = 0, count = 0, gravity = vlength(world->gravity);
    for (int32_t i = 1; i < world->body_count; i++) {
        if (world->body[i].inverse_mass == 0) continue;
        sum += world->body[i].reach;
        count++;
    }
    if (count == 0 || gravity == 0) return SUBSTEP;
    double fall = FALL * sqrt(2 * sum / count / gravity);
    return smaller(SUBSTEP, larger(SHORTER * SUBSTEP, fall));
}

Crowd *crowd_create(const World *world, Recorder *recorder) {
    Crowd *crowd = calloc(1, sizeof *crowd);
    if (!crowd) return NULL;
    crowd->recorder = recorder;
    crowd->longest_substep = longest_substep(world);
    crowd->body_count = world->body_count;
    crowd->shape_count = world->shape_count;
    crowd->piece_count = world->piece_count;
    crowd->active = calloc((size_t)world->body_count, sizeof *crowd->active);
    crowd->mover = calloc((size_t)world->body_count, sizeof *crowd->mover);
    crowd->pressed = calloc((size_t)world->body_count, sizeof *crowd->pressed);
    crowd->part = calloc((size_t)world->body_count, sizeof *crowd->part);
    crowd->base = calloc((size_t)world->body_count, sizeof *crowd->base);
    crowd->base_angle = calloc((size_t)world->body_count, sizeof *crowd->base_angle);
    bool made = crowd->mover && crowd->active && crowd->pressed && crowd->part && crowd->base && crowd->base_angle &&
                pivots_create(&crowd->pivots, world) == SIM_OK;
    if (!made || touch_create(crowd, world) != SIM_OK || rest_create(crowd, world) != SIM_OK) {
        crowd_destroy(crowd);
        return NULL;
    }
    return crowd;
}

void crowd_destroy(Crowd *crowd) {
    if (!crowd) return;
    touch_destroy(crowd);
    rest_destroy(crowd);
    free(crowd->mover);
    free(crowd->active);
    free(crowd->pressed);
    free(crowd->part);
    free(crowd->base);
    free(crowd->base_angle);
    pivots_destroy(&crowd->pivots);
    free(crowd);
}

static void accelerate(Crowd *crowd, const World *world, double dt) {
    Vec gain = vscale(world->gravity, dt);
    for (int32_t k = 0; k < crowd->active_count; k++) {
        Mover *m = &crowd->mover[crowd->active[k]];
        m->velocity = vadd(m->velocity, gain);
    }
}

static void move(Crowd *crowd, double dt) {
    for (int32_t k = 0; k < crowd->active_count; k++) {
        Mover *m = &crowd->mover[crowd->active[k]];
        m->moved = vmad(m->moved, dt, m->velocity);
        m->turned += dt * m->spin;
    }
}

static void find_pressed(Crowd *crowd) {
    for (int32_t k = 0; k < crowd->active_count; k++) crowd->pressed[crowd->active[k]] = false;
    for (int32_t i = 0; i < crowd->rows.count; i++) {
        const Contact *c = &crowd->rows.contact[i];
        if (contact_presses(c)) crowd->pressed[c->a] = crowd->pressed[c->b] = true;
    }
    crowd->pressed[0] = false;
}

static int substep(Crowd *crowd, World *world, double left, double dt) {
    Mover *mover = crowd->mover;
    Rows *rows = &crowd->rows;
    double threshold = 4 * dt * vlength(world->gravity);
    int status = SIM_OK;
    touch_refresh(crowd, world, left);
    accelerate(crowd, world, dt);
    bool uneven = rows_weigh(rows, mover);
    rows_measure(rows, 0, mover, threshold);
    if (uneven) rows_note(rows, mover);
    rows_warm_start(rows, 0, mover);
    bool found = true, heated = true; /* new contacts, and bodies that are still to give on what they got */
    for (int32_t look = 0; (found || (heated && look == 1)) && look < LOOKS && status == SIM_OK; look++) {
        int32_t passes = look == 0 ? FIRST_PASSES : uneven ? UNEVEN_PASSES : PASSES;
        heated = true;
        for (int32_t pass = 0; heated && pass < passes; pass++) {
            pivots_solve(&crowd->pivots, mover);
            heated = rows_solve(rows, mover, dt, look == 0 && pass == 0);
        }
        status = touch_near(crowd, world, left, dt, threshold, &found);
        if (gap_foresee(rows, mover, crowd->active, crowd->active_count, dt)) found = true;
    }
    if (status != SIM_OK) return status;
    if (uneven) rows_temper(rows, mover, threshold);
    if (heated) rows_hold(rows, mover, dt);
    move(crowd, dt);
    if (crowd->pivots.count > 0) find_pressed(crowd);
    pivots_join(&crowd->pivots, mover, 1 / dt, crowd->pressed);
    pivots_factor(&crowd->pivots, mover, false);
    crowd->moment++;
    gap_close(rows, mover, dt);
    pivots_join(&crowd->pivots, mover, 0, NULL);
    pivots_factor(&crowd->pivots, mover, true);
    pivots_solve(&crowd->pivots, mover);
    rows_bounce(rows, mover);
    status = events_tell_impacts(crowd, world);
    world->profile.crowd_steps++;
    world->profile.crowd_contacts += rows->count;
    return status;
}

static void store(Crowd *crowd, World *world) {
    for (int32_t k = 0; k < crowd->active_count; k++) {
        const Mover *m = &crowd->mover[crowd->active[k]];
        Body *body = &world->body[crowd->active[k]];
        body->position = crowd_position(crowd, crowd->active[k]);
        body->angle = crowd_angle(crowd, crowd->active[k]);
        body->velocity = m->velocity;
        body->spin = m->spin;
    }
}

static Part part_of(const World *world, int32_t body) {
    Mode mode = world->body[body].mode;
    return mode == MODE_CROWD ? PART_MOVES : mode == MODE_FLIGHT || mode == MODE_SMOOTH ? PART_NONE : PART_STANDS;
}

/* How many steps of dt the next frame is to have: while many bodies go far, contacts come and go, and few are worth keeping. */
static int32_t steps_ahead(const World *world, double dt) {
    int32_t moving = 0, far = 0;
    for (int32_t i = 1; i < world->body_count; i++) {
        const Body *b = &world->body[i];
        if (b->mode != MODE_CROWD) continue;
        double speed = vlength(b->velocity) + b->reach * fabs(b->spin);
        moving++;
        far += speed * FRAME > FAR * b->reach;
    }
    return far > MANY * moving ? 1 : (int32_t)larger(1, floor(FRAME / dt + 1e-6));
}

/* A frame of so long, with substeps of h. */
static int begin(Crowd *crowd, World *world, double length, double h) {
    memory_scale(&crowd->memory, crowd->substep > 0 ? h / crowd->substep : 0);
    crowd->substep = h;
    int status = touch_frame(crowd, world, length, h);
    if (status == SIM_OK) status = pivots_load(&crowd->pivots, world, crowd->mover);
    if (status != SIM_OK) return status;
    for (int32_t i = 0; i < crowd->pivots.count; i++)
        crowd->touched[crowd->pivots.pivot[i].a] = crowd->touched[crowd->pivots.pivot[i].b] = true;
    pivots_factor(&crowd->pivots, crowd->mover, true);
    gap_limit(crowd->rows.contact, crowd->rows.count, crowd->mover, h);
    rows_link(&crowd->rows, 0);
    for (int32_t i = 0; i < world->body_count; i++) crowd->part[i] = part_of(world, i);
    crowd->length = crowd->left = length;
    crowd->open = true;
    return SIM_OK;
}

/* Whether the frame goes on for another dt in substeps of h: it has as long to go, and nothing else has changed a body. */
static bool goes_on(const Crowd *crowd, const World *world, double dt, double h) {
    if (!crowd->open || crowd->left < dt * (1 - 1e-6) || fabs(h - crowd->substep) > 1e-6 * h) return false;
    for (int32_t i = 0; i < world->body_count; i++) {
        const Body *b = &world->body[i];
        if (part_of(world, i) != crowd->part[i]) return false;
        if (crowd->part[i] != PART_MOVES) continue;
        Vec at = crowd_position(crowd, i), v = crowd->mover[i].velocity;
        if (b->position.x != at.x || b->position.y != at.y || b->velocity.x != v.x || b->velocity.y != v.y)
            return false;
        if (b->angle != crowd_angle(crowd, i) || b->spin != crowd->mover[i].spin) return false;
    }
    return true;
}

static void release(Crowd *crowd, World *world) {
    for (int32_t i = 0; i < world->body_count; i++)
        if (crowd_moves(world, i) && !crowd->touched[i]) world->body[i].mode = MODE_FLIGHT;
}

/* The frame is over: what touches, and, if nothing broke it off, what rests and what flies on. */
static int finish(Crowd *crowd, World *world, bool whole) {
    crowd->open = false;
    int status = touch_finish(crowd, crowd->length);
    if (status == SIM_OK && whole) status = rest_update(crowd, world, crowd->length);
    if (status != SIM_OK) return status;
    if (whole) rest_wake_nudged(crowd, world);
    status = memory_store(&crowd->memory, crowd->rows.contact, crowd->rows.count, crowd->mover);
    if (whole) release(crowd, world);
    return status;
}

/* From `end` - dt on. */
static int step(Crowd *crowd, World *world, double dt, double end) {
    int32_t substeps = (int32_t)ceil(dt / crowd->longest_substep - 1e-6);
    if (substeps < 1) substeps = 1;
    double h = dt / substeps;
    int status = SIM_OK;
    if (crowd->open && !goes_on(crowd, world, dt, h)) status = finish(crowd, world, false);
    if (status == SIM_OK && !crowd->open) status = begin(crowd, world, steps_ahead(world, dt) * dt, h);
    for (int32_t k = 0; k < substeps && status == SIM_OK; k++) {
        crowd->time = k + 1 < substeps ? end - (substeps - 1 - k) * h : end;
        status = substep(crowd, world, crowd->left - k * h, h);
    }
    if (status != SIM_OK) return status;
    store(crowd, world);
    status = events_tell_contacts(crowd, world);
    if (status != SIM_OK) return status;
    crowd->left -= dt;
    return crowd->left < dt * (1 - 1e-6) ? finish(crowd, world, true) : SIM_OK;
}

int crowd_step(Crowd *crowd, World *world, double from, double to, double tolerance) {
    double dt = to - from;
    bool any = false;
    for (int32_t i = 0; i < world->body_count && !any; i++) any = crowd_moves(world, i);
    if (!any) return SIM_OK;
    crowd->tolerance = tolerance;
    int32_t parts = (int32_t)ceil(dt / FRAME - 1e-6);
    if (parts < 1) parts = 1;
    int status = SIM_OK;
    for (int32_t k = 0; k < parts && status == SIM_OK; k++)
        status = step(crowd, world, dt / parts, k + 1 < parts ? from + (k + 1) * (dt / parts) : to);
    return status;
}
