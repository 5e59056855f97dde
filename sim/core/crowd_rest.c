/* Putting bodies to rest, and waking them.
 *
 * A body is still while it stays within a small distance of where it was.  It rests once it, what it is joined to, and
 * all that presses on it have been still for a while: the bottom of a pile rests while its top still moves.
 */
#include <stdlib.h>

#include "crowd_parts.h"

static const double STILL_TIME = 0.1;     /* [s]: two frames of a slow crowd (crowd.c) */
static const double KNOCK = 0.1;          /* of the speed of falling by its own reach: what a woken body passes on */
static const double NUDGE = 3;            /* times what counts as still: what wakes a neighbour */
static const double STILL_SHARE = 7e-3;   /* of a body's reach: what it may move in that time */
static const double SPEEDING = 0.4;       /* of the speed that would take it so far */

int rest_create(Crowd *crowd, const World *world) {
    size_t n = (size_t)world->body_count;
    crowd->still_position = calloc(n, sizeof *crowd->still_position);
    crowd->still_angle = calloc(n, sizeof *crowd->still_angle);
    crowd->still_time = calloc(n, sizeof *crowd->still_time);
    crowd->told = calloc(n, sizeof *crowd->told);
    crowd->told_position = calloc(n, sizeof *crowd->told_position);
    crowd->told_angle = calloc(n, sizeof *crowd->told_angle);
    crowd->island = calloc(n, sizeof *crowd->island);
    crowd->island_time = calloc(n, sizeof *crowd->island_time);
    crowd->ring = calloc(n, sizeof *crowd->ring);
    crowd->touched = calloc(n, sizeof *crowd->touched);
    crowd->roused = calloc(n, sizeof *crowd->roused);
    crowd->nudged = calloc(n, sizeof *crowd->nudged);
    if (!crowd->told || !crowd->told_position || !crowd->told_angle || !crowd->still_position || !crowd->still_angle ||
        !crowd->still_time || !crowd->island || !crowd->island_time || !crowd->ring || !crowd->touched ||
        !crowd->roused || !crowd->nudged)
        return SIM_OUT_OF_MEMORY;
    for (int32_t i = 0; i < world->body_count; i++) crowd->ring[i] = i;
    return SIM_OK;
}

void rest_destroy(Crowd *crowd) {
    free(crowd->still_position);
    free(crowd->still_angle);
    free(crowd->still_time);
    free(crowd->told);
    free(crowd->told_position);
    free(crowd->told_angle);
    free(crowd->island);
    free(crowd->island_time);
    free(crowd->ring);
    free(crowd->touched);
    free(crowd->roused);
    free(crowd->nudged);
}

/* How far a body may move in STILL_TIME and be still.  Without gravity nothing presses bodies together: what drifts goes
 * on drifting. */
static double still_distance(const World *world, const Body *body, double tolerance) {
    bool pulled = world->gravity.x != 0 || world->gravity.y != 0;
    return pulled ? larger(STILL_SHARE * body->reach, 0.1 * tolerance) : 1e-9 * body->reach;
}

/* Wake a body and all that were put to rest with it. */
static void wake(Crowd *crowd, World *world, int32_t body, double strength) {
    int32_t at = body;
    do {
        int32_t next = crowd->ring[at];
        crowd->ring[at] = at;
        if (world->body[at].mode == MODE_REST) world->body[at].mode = MODE_CROWD;
        crowd->still_time[at] = 0;
        crowd->roused[at] = strength;
        at = next;
    } while (at != body);
}

/* A resting body that a moving one is about to meet wakes, unless that one is about to rest itself; a woken one wakes
 * those that it touches (`close`), each less hard than the one before.  What is only nudged wakes when the frame is over.
 * Whether it woke at once. */
bool rest_disturb(Crowd *crowd, World *world, int32_t body, int32_t by, bool close) {
    const Body *mover = &world->body[by], *rester = &world->body[body];
    if (rester->mode != MODE_REST || mover->mode != MODE_CROWD) return false;
    double speed = vlength(mover->velocity) + mover->reach * fabs(mover->spin);
    double strength = larger(speed, close ? crowd->roused[by] : 0);
    if (strength > KNOCK * sqrt(vlength(world->gravity) * mover->reach)) {
        wake(crowd, world, body, strength / 2);
        return true;
    }
    if (speed * STILL_TIME > NUDGE * still_distance(world, mover, crowd->tolerance)) crowd->nudged[body] = true;
    return false;
}

void rest_wake_nudged(Crowd *crowd, World *world) {
    for (int32_t i = 0; i < world->body_count; i++) {
        if (crowd->nudged[i] && world->body[i].mode == MODE_REST) wake(crowd, world, i, 0);
        crowd->nudged[i] = false;
    }
}

/* What hangs on a moving body moves. Whether anything woke. */
bool rest_wake_joined(Crowd *crowd, World *world) {
    bool woke = false;
    for (int32_t i = 0; i < world->joint_count; i++) {
        int32_t a = world->joint[i].a, b = world->joint[i].b;
        if (crowd_moves(world, b)) {
            int32_t other = a;
            a = b;
            b = other;
        }
        if (!crowd_moves(world, a) || world->body[b].mode != MODE_REST) continue;
        wake(crowd, world, b, 0);
        woke = true;
    }
    return woke;
}

static int32_t root(int32_t *island, int32_t i) {
    while (island[i] != i) i = island[i] = island[island[i]];
    return i;
}

/* The lower index becomes the root, so that islands do not depend on the order of the contacts. */
static void join(int32_t *island, int32_t i, int32_t j) {
    i = root(island, i);
    j = root(island, j);
    if (i < j) island[j] = i;
    if (j < i) island[i] = j;
}

/* Bodies on joints rest together. */
static void find_islands(Crowd *crowd, const World *world) {
    for (int32_t i = 0; i < world->body_count; i++) crowd->island[i] = i;
    for (int32_t i = 0; i < crowd->pivots.count; i++) {
        const Pivot *p = &crowd->pivots.pivot[i];
        if (crowd_moves(world, p->a) && crowd_moves(world, p->b)) join(crowd->island, p->a, p->b);
    }
}

/* Whether a body goes so fast that it did not do so all the time that it has been still: what begins to slide is not at
 * rest, though it has not gone far yet. */
static bool speeds_up(const Crowd *crowd, const World *world, int32_t i) {
    const Body *body = &world->body[i];
    double speed = vlength(body->velocity) + body->reach * fabs(body->spin);
    return speed * STILL_TIME > SPEEDING * still_distance(world, body, crowd->tolerance);
}

/* How long the islands have been still, each with what presses on it. */
static void find_island_times(Crowd *crowd, const World *world) {
    double *time = crowd->island_time;
    for (int32_t i = 0; i < world->body_count; i++) time[i] = INFINITY;
    for (int32_t i = 0; i < world->body_count; i++) {
        if (!crowd_moves(world, i)) continue;
        int32_t r = root(crowd->island, i);
        time[r] = smaller(time[r], crowd->touched[i] && !speeds_up(crowd, world, i) ? crowd->still_time[i] : 0);
    }
    for (int32_t i = 0; i < crowd->rows.count; i++) {
        const Contact *c = &crowd->rows.contact[i];
        if (!contact_presses(c) || !crowd_moves(world, c->a) || !crowd_moves(world, c->b)) continue;
        int32_t a = root(crowd->island, c->a), b = root(crowd->island, c->b);
        time[a] = smaller(time[a], crowd->still_time[c->b]);
        time[b] = smaller(time[b], crowd->still_time[c->a]);
    }
}

/* How far a body is from a pose, any point of it. */
static double distance_from(const Body *body, Vec position, double angle) {
    return vlength(vsub(body->position, position)) + body->reach * fabs(body->angle - angle);
}

/* A body that was told to rest has gone elsewhere: it is to be told again. */
void rest_forget(Crowd *crowd, int32_t body) { crowd->told[body] = false; }

/* What was only stirred where it had come to rest is not told again. */
static int tell_rest(Crowd *crowd, const World *world, int32_t i) {
    if (crowd->told[i]) return SIM_OK;
    crowd->told[i] = true;
    crowd->told_position[i] = world->body[i].position;
    crowd->told_angle[i] = world->body[i].angle;
    return events_tell_rest(crowd, world, i);
}

static void update_still(Crowd *crowd, const World *world, double dt) {
    for (int32_t i = 0; i < world->body_count; i++) {
        const Body *body = &world->body[i];
        if (body->mode != MODE_CROWD) continue;
        double allowed = still_distance(world, body, crowd->tolerance);
        if (crowd->told[i] && distance_from(body, crowd->told_position[i], crowd->told_angle[i]) > allowed)
            rest_forget(crowd, i);
        if (distance_from(body, crowd->still_position[i], crowd->still_angle[i]) > allowed ||
            crowd->still_time[i] == 0) {
            crowd->still_position[i] = body->position;
            crowd->still_angle[i] = body->angle;
            crowd->still_time[i] = 0;
        }
        crowd->still_time[i] += dt;
    }
}

int rest_update(Crowd *crowd, World *world, double dt) {
    update_still(crowd, world, dt);
    find_islands(crowd, world);
    find_island_times(crowd, world);
    for (int32_t i = 0; i < world->body_count; i++) {
        if (!crowd_moves(world, i)) continue;
        int32_t r = root(crowd->island, i);
        if (crowd->island_time[r] < STILL_TIME * (1 - 1e-6)) continue;
        Body *body = &world->body[i];
        body->mode = MODE_REST;
        body->velocity = vec(0, 0);
        body->spin = 0;
        if (i == r) {
            world->profile.rests++;
            crowd->ring[i] = i;
        } else {
            crowd->ring[i] = crowd->ring[r];
            crowd->ring[r] = i;
        }
        int status = tell_rest(crowd, world, i);
        if (status != SIM_OK) return status;
    }
    return SIM_OK;
}
