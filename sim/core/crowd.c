/* The crowd's steps: frames of collision finding, each of several substeps of the solver (Catto's Solver2D, 2024). */
#include <stdlib.h>

#include "crowd_parts.h"

static const double FRAME = 1.0 / 60;  /* [s]: contacts are found anew this often */
static const int32_t SUBSTEPS = 4;     /* of a frame */
static const int32_t PASSES = 6;       /* between looks for new contacts, at most */
static const int32_t LOOKS = 6;        /* of a substep, at most */

Crowd *crowd_create(const World *world, Recorder *recorder) {
    Crowd *crowd = calloc(1, sizeof *crowd);
    if (!crowd) return NULL;
    crowd->recorder = recorder;
    crowd->body_count = world->body_count;
    crowd->shape_count = world->shape_count;
    crowd->piece_count = world->piece_count;
    crowd->active = calloc((size_t)world->body_count, sizeof *crowd->active);
    crowd->mover = calloc((size_t)world->body_count, sizeof *crowd->mover);
    crowd->pressed = calloc((size_t)world->body_count, sizeof *crowd->pressed);
    bool made = crowd->mover && crowd->active && crowd->pressed && pivots_create(&crowd->pivots, world) == SIM_OK;
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
    rows_measure(rows, 0, mover, threshold);
    rows_warm_start(rows, 0, mover);
    bool found = true;
    for (int32_t look = 0; found && look < LOOKS && status == SIM_OK; look++) {
        bool heated = true;
        for (int32_t pass = 0; heated && pass < PASSES; pass++) {
            pivots_solve(&crowd->pivots, mover);
            heated = rows_solve(rows, mover, dt, look == 0 && pass == 0);
        }
        status = touch_near(crowd, world, left, dt, threshold, &found);
        if (gap_foresee(rows, mover, crowd->active, crowd->active_count, dt)) found = true;
    }
    if (status != SIM_OK) return status;
    move(crowd, dt);
    if (crowd->pivots.count > 0) find_pressed(crowd);
    pivots_join(&crowd->pivots, mover, 1 / dt, crowd->pressed);
    pivots_factor(&crowd->pivots, mover);
    crowd->moment++;
    gap_close(rows, mover, dt);
    pivots_join(&crowd->pivots, mover, 0, NULL);
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
        body->position = vadd(body->position, m->moved);
        body->angle += m->turned;
        body->velocity = m->velocity;
        body->spin = m->spin;
    }
}

/* From `end` - dt on. */
static int frame(Crowd *crowd, World *world, double dt, double end) {
    int32_t substeps = (int32_t)ceil(SUBSTEPS * dt / FRAME - 1e-9);
    if (substeps < 1) substeps = 1;
    double h = dt / substeps;
    double scale = crowd->substep > 0 ? h / crowd->substep : 0;
    crowd->substep = h;
    memory_scale(&crowd->memory, scale);
    int status = touch_frame(crowd, world, dt, h);
    if (status != SIM_OK) return status;
    status = pivots_load(&crowd->pivots, world, crowd->mover);
    if (status != SIM_OK) return status;
    pivots_factor(&crowd->pivots, crowd->mover);
    gap_limit(crowd->rows.contact, crowd->rows.count, crowd->mover, h);
    for (int32_t k = 0; k < substeps && status == SIM_OK; k++) {
        crowd->time = k + 1 < substeps ? end - (substeps - 1 - k) * h : end;
        status = substep(crowd, world, dt - k * h, h);
    }
    if (status != SIM_OK) return status;
    status = touch_finish(crowd, world, dt);
    if (status != SIM_OK) return status;
    store(crowd, world);
    status = events_tell_contacts(crowd, world);
    if (status == SIM_OK) status = rest_update(crowd, world, dt);
    if (status != SIM_OK) return status;
    rest_wake_nudged(crowd, world);
    return memory_store(&crowd->memory, crowd->rows.contact, crowd->rows.count, crowd->mover);
}

static void release(Crowd *crowd, World *world) {
    for (int32_t i = 0; i < world->body_count; i++)
        if (crowd_moves(world, i) && !crowd->touched[i]) world->body[i].mode = MODE_FLIGHT;
}

int crowd_step(Crowd *crowd, World *world, double from, double to, double tolerance) {
    double dt = to - from;
    bool any = false;
    for (int32_t i = 0; i < world->body_count && !any; i++) any = crowd_moves(world, i);
    if (!any) return SIM_OK;
    crowd->tolerance = tolerance;
    int32_t frames = (int32_t)ceil(dt / FRAME - 1e-6);
    if (frames < 1) frames = 1;
    for (int32_t k = 0; k < frames; k++) {
        int status = frame(crowd, world, dt / frames, k + 1 < frames ? from + (k + 1) * (dt / frames) : to);
        if (status != SIM_OK) return status;
    }
    release(crowd, world);
    return SIM_OK;
}
