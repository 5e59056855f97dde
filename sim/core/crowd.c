/* The crowd's steps: frames of collision finding, each of several substeps of the solver (Catto's Solver2D, 2024). */
#include <stdlib.h>

#include "crowd_parts.h"

static const double FRAME = 1.0 / 60;  /* [s]: contacts are found anew this often */
static const int32_t SUBSTEPS = 4;     /* of a frame */
static const int32_t PASSES = 6;       /* between looks for new contacts, at most */
static const int32_t LOOKS = 3;        /* of a substep, at most */
static const double STIFFNESS = 0.5;   /* of a pivot: its frequency times the substep */
static const double DAMPING = 5;       /* its ratio */

Crowd *crowd_create(const World *world) {
    Crowd *crowd = calloc(1, sizeof *crowd);
    if (!crowd) return NULL;
    crowd->body_count = world->body_count;
    crowd->shape_count = world->shape_count;
    crowd->piece_count = world->piece_count;
    size_t joints = (size_t)world->joint_count + 1;
    crowd->active = calloc((size_t)world->body_count, sizeof *crowd->active);
    crowd->heat = calloc((size_t)world->body_count, sizeof *crowd->heat);
    crowd->mover = calloc((size_t)world->body_count, sizeof *crowd->mover);
    crowd->pivot = calloc(joints, sizeof *crowd->pivot);
    crowd->pivot_joint = calloc(joints, sizeof *crowd->pivot_joint);
    crowd->joint_impulse = calloc(joints, sizeof *crowd->joint_impulse);
    bool made = crowd->mover && crowd->active && crowd->heat && crowd->pivot && crowd->pivot_joint && crowd->joint_impulse;
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
    free(crowd->heat);
    free(crowd->pivot);
    free(crowd->pivot_joint);
    free(crowd->joint_impulse);
    free(crowd);
}

static void load_pivots(Crowd *crowd, const World *world) {
    crowd->pivot_count = 0;
    for (int32_t i = 0; i < world->joint_count; i++) {
        const Joint *j = &world->joint[i];
        if (!crowd_moves(world, j->a) && !crowd_moves(world, j->b)) continue;
        Pose a = body_pose(&world->body[j->a]), b = body_pose(&world->body[j->b]);
        crowd->pivot_joint[crowd->pivot_count] = i;
        crowd->pivot[crowd->pivot_count++] = (Pivot){
            .a = j->a,
            .b = j->b,
            .local_a = j->local_a,
            .local_b = j->local_b,
            .arm_a = turn(a, j->local_a),
            .arm_b = turn(b, j->local_b),
            .apart = vsub(place(b, j->local_b), place(a, j->local_a)),
            .impulse = crowd->joint_impulse[i],
        };
    }
}

static void touch_pivots(Crowd *crowd) {
    for (int32_t i = 0; i < crowd->pivot_count; i++)
        crowd->touched[crowd->pivot[i].a] = crowd->touched[crowd->pivot[i].b] = true;
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

static int substep(Crowd *crowd, World *world, double left, double dt) {
    static const Soft rigid = {0, 1, 0};
    Mover *mover = crowd->mover;
    Soft hinge = soft(STIFFNESS / dt, DAMPING, dt);
    double threshold = 4 * dt * vlength(world->gravity);
    int status = SIM_OK;
    touch_refresh(crowd, world, left, threshold);
    accelerate(crowd, world, dt);
    contacts_measure(crowd->contact, crowd->contact_count, mover, threshold);
    pivots_warm_start(crowd->pivot, crowd->pivot_count, mover);
    contacts_warm_start(crowd->contact, crowd->contact_count, mover, dt);
    bool found = true;
    for (int32_t look = 0; found && look < LOOKS && status == SIM_OK; look++) {
        bool heated = true;
        for (int32_t pass = 0; heated && pass < PASSES; pass++) {
            pivots_solve(crowd->pivot, crowd->pivot_count, mover, hinge);
            crowd->passes++;
            heated = contacts_solve(crowd->contact, crowd->contact_count, mover, dt, crowd->heat, crowd->passes,
                                    look == 0 && pass == 0);
        }
        status = touch_near(crowd, world, left, dt, threshold, &found);
    }
    if (status != SIM_OK) return status;
    move(crowd, dt);
    crowd->moment++;
    pivots_solve(crowd->pivot, crowd->pivot_count, mover, rigid);
    contacts_part(crowd->contact, crowd->contact_count, mover);
    contacts_bounce(crowd->contact, crowd->contact_count, mover);
    world->profile.crowd_steps++;
    world->profile.crowd_contacts += crowd->contact_count;
    return SIM_OK;
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
    for (int32_t i = 0; i < crowd->pivot_count; i++) crowd->joint_impulse[crowd->pivot_joint[i]] = crowd->pivot[i].impulse;
}

static int frame(Crowd *crowd, World *world, double dt) {
    int32_t substeps = (int32_t)ceil(SUBSTEPS * dt / FRAME - 1e-9);
    if (substeps < 1) substeps = 1;
    double h = dt / substeps;
    double scale = crowd->substep > 0 ? h / crowd->substep : 0;
    crowd->substep = h;
    memory_scale(&crowd->memory, scale);
    for (int32_t i = 0; i < world->joint_count; i++) crowd->joint_impulse[i] = vscale(crowd->joint_impulse[i], scale);
    int status = touch_frame(crowd, world, dt, h);
    if (status != SIM_OK) return status;
    load_pivots(crowd, world);
    touch_pivots(crowd);
    for (int32_t k = 0; k < substeps && status == SIM_OK; k++) status = substep(crowd, world, dt - k * h, h);
    if (status != SIM_OK) return status;
    store(crowd, world);
    rest_update(crowd, world, dt);
    status = touch_store_near(crowd);
    if (status != SIM_OK) return status;
    return memory_store(&crowd->memory, crowd->contact, crowd->contact_count, crowd->mover);
}

static void release(Crowd *crowd, World *world) {
    for (int32_t i = 0; i < world->body_count; i++)
        if (crowd_moves(world, i) && !crowd->touched[i]) world->body[i].mode = MODE_FLIGHT;
}

int crowd_step(Crowd *crowd, World *world, double dt, double tolerance) {
    bool any = false;
    for (int32_t i = 0; i < world->body_count && !any; i++) any = crowd_moves(world, i);
    if (!any) return SIM_OK;
    crowd->tolerance = tolerance;
    int32_t frames = (int32_t)ceil(dt / FRAME - 1e-6);
    if (frames < 1) frames = 1;
    for (int32_t k = 0; k < frames; k++) {
        int status = frame(crowd, world, dt / frames);
        if (status != SIM_OK) return status;
    }
    release(crowd, world);
    return SIM_OK;
}
