#include "exact.h"
#include "project.h"
#include "stopwatch.h"

#include <stdlib.h>

#define FIRST_HORIZON 4.0   /* how far ahead touches are looked for at first [s]; doubled when it is reached */
#define BUCKET_LIMIT 1500.0  /* events of one body that may come in a burst */
#define BUCKET_LEAK 200.0   /* and a second in the long run */
#define MOST_REPEATS 30     /* events of one body at one moment */
#define JAMMED 1000.0      /* times the slack: a speed against constraints that says they contradict each other */
#define STEPS_A_SECOND 20000.0 /* of the integrator, a simulated second: what turns faster than that is for the crowd */
#define PAIRS_A_SECOND 16.0 /* pairs looked at that cost as much as a body in the crowd, a simulated second */
#define BOUNCE 0.1 /* of the tolerance: lower bounces are not followed */
#define PAIRS_OF_FEW 1e6 /* a few bodies are worth this many pairs among them: exactness is what is asked for */

int exact_create(Exact *e, World *world, Recorder *recorder, double tolerance) {
    size_t n = (size_t)world->body_count;
    /* A gap of a twentieth of the tolerance moves nothing farther than that, and is small beside every shape; rounding
     * sets the least. */
    double gap = fmin(0.05 * tolerance, 1e-3 * world->thinnest);
    Slack slack = {.gap = fmax(gap, 1e-10 * world->size), .root = 1e-14 * world->size};
    slack.bounce = BOUNCE * tolerance;
    slack.speed = slack.gap;
    slack.unsure = fmax(tolerance / VELOCITY_TIME, slack.speed);
    slack.deep = fmax(4 * slack.gap, 0.05 * world->thinnest);
    *e =
        (Exact){.world = world, .recorder = recorder, .slack = slack, .tolerance = tolerance, .horizon = FIRST_HORIZON};
    e->track = calloc(n, sizeof *e->track);
    e->island = calloc(n, sizeof *e->island);
    e->motion = malloc(n * sizeof *e->motion);
    e->course = malloc(n * sizeof *e->course);
    e->acceleration = malloc(3 * n * sizeof *e->acceleration);
    e->root = malloc(n * sizeof *e->root);
    e->changed = calloc(n, sizeof *e->changed);
    e->fresh = calloc(n, sizeof *e->fresh);
    e->searched = calloc(n, sizeof *e->searched);
    e->box = calloc(n, sizeof *e->box);
    if (!e->track || !e->island || !e->motion || !e->course || !e->acceleration || !e->root) return SIM_OUT_OF_MEMORY;
    if (!e->changed || !e->fresh || !e->searched || !e->box) return SIM_OUT_OF_MEMORY;
    e->box[0] = (Box){vec(INFINITY, 0), vec(-INFINITY, 0)}; /* the background is everywhere, and asked for by itself */
    int status = sweep_create(&e->sweep, world->body_count);
    if (status == SIM_OK) status = system_create(&e->group, world);
    if (status == SIM_OK) status = system_create(&e->part, world);
    if (status == SIM_OK) status = smooth_create(&e->smooth, world, tolerance, slack);
    State still = {0};
    e->track[0] = (Track){.motion = motion_at_rest(&still, 0), .island = -1, .touch_time = INFINITY};
    return status;
}

void exact_destroy(Exact *e) {
    for (int32_t i = 0; e->island && i < e->island_count; i++) {
        free(e->island[i].member);
        free(e->island[i].contact);
    }
    free(e->track);
    free(e->island);
    free(e->motion);
    free(e->course);
    free(e->acceleration);
    free(e->root);
    free(e->changed);
    free(e->fresh);
    free(e->searched);
    free(e->box);
    sweep_destroy(&e->sweep);
    free(e->impulse);
    free(e->touching);
    free(e->closed);
    free(e->before.pair);
    free(e->after.pair);
    system_destroy(&e->group);
    system_destroy(&e->part);
    smooth_destroy(&e->smooth);
    contact_solver_destroy(&e->solver);
    *e = (Exact){0};
}

/* ---------------------------------------------------------------- islands */

void island_dissolve(Exact *e, int32_t island) {
    Island *is = &e->island[island];
    for (int32_t k = 0; k < is->member_count; k++) e->track[is->member[k]].island = -1;
    is->in_use = false;
    is->member_count = is->contact_count = 0;
}

static int load_part(Exact *e, const Island *island, double time) {
    system_clear(&e->part);
    for (int32_t k = 0; k < island->member_count; k++) {
        State state = motion_state(&e->track[island->member[k]].motion, time);
        system_add_body(&e->part, island->member[k], &state);
    }
    for (int32_t k = 0; k < island->contact_count; k++) {
        int status = system_add_contact(&e->part, &island->contact[k]);
        if (status != SIM_OK) return status;
    }
    system_find_joints(&e->part);
    return SIM_OK;
}

/* Take the drift of an island's motion off the velocities of the group's members in it: what slips or parts by no more than that
 * does not. */
int island_settle(Exact *e, const Island *island, double time) {
    int status = load_part(e, island, time);
    e->smooth.relax = island->pace.relax;
    if (status == SIM_OK) status = smooth_prepare(&e->smooth, &e->part);
    if (status == SIM_OK) status = project_velocities(&e->smooth, &e->part);
    for (int32_t i = 0; i < e->part.count && status == SIM_OK; i++) {
        int32_t place = e->group.place_of[e->part.member[i]];
        e->group.state[place].v = e->part.state[i].v;
        e->group.state[place].spin = e->part.state[i].spin;
    }
    return status;
}

/* A member's kinetic and potential energy. */
static void add_energy(const Exact *e, int32_t body, const State *s, double *kinetic, double *potential) {
    const Body *b = &e->world->body[body];
    *kinetic += 0.5 * (b->mass * vdot(s->v, s->v) + b->moment * s->spin * s->spin);
    *potential -= b->mass * vdot(e->world->gravity, s->p);
}

/* A wedge with friction can come where no finite forces hold it (Painleve's paradox): the step that meets that makes energy
 * without bound, and is not to be taken. */
static bool step_made_energy(const Exact *e, double from) {
    double start_kinetic = 0, start_potential = 0, kinetic = 0, potential = 0, mass = 0;
    for (int32_t k = 0; k < e->part.count; k++) {
        int32_t member = e->part.member[k];
        State start = motion_state(&e->motion[k], from), end = motion_state(&e->motion[k], e->motion[k].end);
        add_energy(e, member, &start, &start_kinetic, &start_potential);
        add_energy(e, member, &end, &kinetic, &potential);
        mass += e->world->body[member].mass;
    }
    double made = kinetic + potential - start_kinetic - start_potential;
    double unseen = 10 * e->slack.speed, rounding = vlength(e->world->gravity) * e->tolerance + 0.5 * unseen * unseen;
    return !(made <= 0.01 * kinetic + mass * rounding); /* nor one that is no number */
}

int island_advance(Exact *e, int32_t index, double from) {
    Island *island = &e->island[index];
    double start = seconds_now();
    int status = load_part(e, island, from);
    e->smooth.relax = island->pace.relax;
    if (status == SIM_OK) status = smooth_prepare(&e->smooth, &e->part);
    double left = 0;
    if (status == SIM_OK) status = project(&e->smooth, &e->part, &left);
    e->steps = fmax(0, e->steps - STEPS_A_SECOND * (from - e->steps_time)) + 1;
    e->steps_time = from;
    island->jammed = left > JAMMED * e->slack.speed || e->steps > STEPS_A_SECOND;
    if (status == SIM_OK) status = smooth_step(&e->smooth, &e->part, from, &island->pace, e->motion, &island->ended);
    island->jammed = island->jammed || (status == SIM_OK && step_made_energy(e, from));
    island->ended = island->ended || island->jammed;
    for (int32_t k = 0; k < island->contact_count; k++) island->contact[k] = e->part.contact[k];
    for (int32_t k = 0; k < island->member_count; k++) {
        Track *track = &e->track[island->member[k]];
        record_motion(e->recorder, island->member[k], &track->motion, from);
        if (island->jammed) {
            State state = motion_state(&track->motion, from);
            track->motion = motion_in_flight(&state, from, e->world->gravity);
            track->motion.end = from;
        } else {
            track->motion = e->motion[k];
        }
        track->step = island->pace.step;
        e->changed[island->member[k]] = true;
    }
    e->world->profile.smooth_steps += 1;
    e->world->profile.smooth_time += seconds_now() - start;
    return status;
}

/* ---------------------------------------------------------------- the loop */

/* Whether a body's events come so fast that it belongs to the crowd. */
static bool overflows(Exact *e, int32_t body, double time) {
    Track *t = &e->track[body];
    t->repeats = time - t->bucket_time <= 1e-12 * (1 + time) ? t->repeats + 1 : 0;
    t->bucket = fmax(0, t->bucket - BUCKET_LEAK * (time - t->bucket_time)) + 1;
    t->bucket_time = time;
    return t->bucket > BUCKET_LIMIT || t->repeats > MOST_REPEATS;
}

/* Whether the search for touches costs more than stepping all bodies as a crowd would.  An event asks about all bodies, a
 * crowd's step about neighbours: few bodies may have many events, many bodies only few. */
static bool is_over_budget(Exact *e, double time) {
    double n = e->world->body_count, leak = PAIRS_A_SECOND * n + PAIRS_OF_FEW / n;
    e->spent = fmax(0, e->spent - leak * (time - e->spent_time));
    e->spent_time = time;
    return e->spent > 0.5 * leak;
}

/* Everything that is about to touch something goes to the crowd. */
static int hand_over_all(Exact *e, double time) {
    e->world->profile.budget_spent += 1;
    system_clear(&e->group);
    for (int32_t i = 1; i < e->world->body_count; i++)
        if (is_tracked(e, i) && e->world->body[i].mode != MODE_REST && e->track[i].touch_time < e->horizon)
            group_add(e, i, time);
    int status = group_spread(e, 0, time);
    group_send_to_crowd(e, time);
    return status;
}

static int handle_touch(Exact *e, int32_t body, double time, bool *crowded) {
    int32_t partner = e->track[body].partner;
    system_clear(&e->group);
    bool overflow = overflows(e, body, time);
    int status = group_gather(e, body, time);
    if (status == SIM_OK && partner != 0) status = group_gather(e, partner, time);
    if (status != SIM_OK) return status;
    if (overflow) {
        e->world->profile.budget_spent += 1;
        *crowded = true;
        for (int32_t k = 0; k < e->group.count; k++) e->world->body[e->group.member[k]].mode = MODE_CROWD;
    }
    status = group_reform(e, time);
    for (int32_t k = 0; k < e->group.count; k++) *crowded = *crowded || !is_tracked(e, e->group.member[k]);
    return status;
}

/* Look at the bodies that have just been given to the exact way: what touches, what rests, what moves how. */
static int take_up(Exact *e, double time) {
    int32_t n = e->world->body_count;
    int status = search_neighbours(e, time);
    if (status != SIM_OK) return status;
    for (int32_t i = 1; i < n; i++) {
        if (!e->fresh[i] || e->world->body[i].mode != MODE_SMOOTH) continue;
        system_clear(&e->group);
        if (e->searched[i])
            status = group_gather(e, i, time);
        else
            group_add(e, i, time);
        for (int32_t k = 0; k < e->group.count; k++) e->fresh[e->group.member[k]] = false;
        if (status == SIM_OK) status = group_reform(e, time);
        if (status != SIM_OK) return status;
    }
    return search_touches(e, time);
}

static void adopt(Exact *e, int32_t body, double time) {
    State state = body_state(&e->world->body[body]);
    e->track[body] = (Track){.motion = motion_in_flight(&state, time, e->world->gravity),
                             .island = -1,
                             .touch_time = INFINITY,
                             .bucket_time = time};
    e->world->body[body].mode = MODE_SMOOTH;
    e->fresh[body] = true;
}

int exact_start(Exact *e, double time) {
    for (int32_t i = 1; i < e->world->body_count; i++) adopt(e, i, time);
    return take_up(e, time);
}

int exact_take_back(Exact *e, double time) {
    for (int32_t i = 1; i < e->world->body_count; i++)
        for (int32_t j = 0; j < e->world->body_count && !is_tracked(e, i); j++)
            if (j != i && (j == 0 || !is_tracked(e, j) || e->world->body[j].mode == MODE_REST) &&
                too_deep(e->world, i, j, &e->slack))
                return SIM_OK; /* not yet */
    for (int32_t i = 1; i < e->world->body_count; i++)
        if (!is_tracked(e, i)) adopt(e, i, time);
    e->from_crowd = true;
    int status = take_up(e, time);
    e->from_crowd = false;
    return status;
}

/* The next thing to happen: a body's touch, or an island's end of motion. */
static double next_event(const Exact *e, int32_t *body, int32_t *island) {
    double first = INFINITY;
    *body = *island = -1;
    for (int32_t i = 1; i < e->world->body_count; i++)
        if (is_tracked(e, i) && e->track[i].touch_time < first) first = e->track[i].touch_time, *body = i;
    for (int32_t k = 0; k < e->island_count; k++) {
        if (!e->island[k].in_use) continue;
        double end = e->track[e->island[k].member[0]].motion.end;
        if (end < first) first = end, *island = k;
    }
    return first;
}

int exact_run(Exact *e, double from, double until, double *reached) {
    bool crowded = false;
    *reached = from;
    int status = search_touches(e, from); /* of what came back from the crowd */
    while (status == SIM_OK && !crowded) {
        int32_t body, island;
        double time = next_event(e, &body, &island);
        if (e->horizon <= fmin(time, until)) {
            status = search_farther(e);
            continue;
        }
        if (time >= until) {
            *reached = until;
            return SIM_OK;
        }
        *reached = time;
        if (island >= 0 && !e->island[island].ended) {
            status = island_advance(e, island, time);
        } else if (island >= 0 && e->island[island].jammed) {
            e->world->profile.budget_spent += 1;
            status = exact_hand_over(e, e->island[island].member[0], time);
            crowded = true;
        } else if (island >= 0) {
            int32_t member = e->island[island].member[0];
            e->track[member].partner = 0;
            status = handle_touch(e, member, time, &crowded);
        } else {
            status = handle_touch(e, body, time, &crowded);
        }
        if (status == SIM_OK) status = search_touches(e, time);
        if (status == SIM_OK && is_over_budget(e, time)) {
            status = hand_over_all(e, time);
            crowded = crowded || e->group.count > 0;
        }
    }
    return status;
}

/* The first sample from which on nothing moves; after the last one if something goes on. */
static int64_t first_still(const Exact *e) {
    int64_t first = 1;
    for (int32_t i = 0; i < e->world->body_count; i++) {
        if (!is_tracked(e, i) || e->track[i].motion.degree > 0) return e->recorder->sample_count;
        if (e->recorder->next[i] >= first) first = e->recorder->next[i] + 1;
    }
    return first;
}

void exact_finish(Exact *e) {
    enum { ABREAST = 4 }; /* samples written of a body before the next body's, which lie beside them */
    int64_t still = first_still(e);
    for (int64_t k = 0; k < still + ABREAST; k += ABREAST)
        for (int32_t i = 0; i < e->world->body_count; i++)
            if (is_tracked(e, i) && e->recorder->next[i] < k)
                record_motion(e->recorder, i, &e->track[i].motion, (double)k / e->recorder->fps);
    record_still(e->recorder, still);
}

/* ---------------------------------------------------------------- beside the crowd */

State exact_state(const Exact *e, int32_t body, double time) { return motion_state(&e->track[body].motion, time); }

int exact_hand_over(Exact *e, int32_t body, double time) {
    system_clear(&e->group);
    int status = group_gather(e, body, time);
    group_send_to_crowd(e, time);
    return status;
}

int exact_after_crowd(Exact *e, int32_t body, double from, double to) {
    Mode mode = e->world->body[body].mode;
    Track *track = &e->track[body];
    bool was_in = track->motion.end < 0; /* the mark of a body that the crowd carries */
    if (mode == MODE_CROWD && !was_in) { /* woken */
        record_motion(e->recorder, body, &track->motion, nextafter(from, INFINITY));
        track->motion.end = -1;
        was_in = true;
    }
    if (!was_in) return SIM_OK;
    record_state(e->recorder, body, to);
    if (mode == MODE_FLIGHT && is_over_budget(e, to)) e->world->body[body].mode = mode = MODE_CROWD;
    if (mode == MODE_CROWD) return SIM_OK;
    if (mode == MODE_FLIGHT) e->spent += e->world->body_count; /* what looking for its touches will cost */
    State state = body_state(&e->world->body[body]);
    *track = (Track){.motion = mode == MODE_REST ? motion_at_rest(&state, to)
                                                 : motion_in_flight(&state, to, e->world->gravity),
                     .island = -1,
                     .touch_time = INFINITY,
                     .bucket_time = to};
    e->world->profile.rests += mode == MODE_REST;
    e->world->profile.flights += mode == MODE_FLIGHT;
    e->changed[body] = true;
    return SIM_OK;
}
