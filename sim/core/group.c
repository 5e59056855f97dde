/* What happens to the bodies about an event. */
#include "project.h"
#include <stdlib.h>
#include <string.h>

#include "exact.h"
#include "stopwatch.h"

#define FIRST_STEP 0.05 /* tried by the integrator [s], of bodies that have taken none */
#define MOST_CONTACTS 10       /* of a group in motion: beyond that the crowd is cheaper */
#define MOST_CONTACTS_REST 160 /* of a group that may be found at rest */
#define UNFELT 0.5             /* of the speed that is unsure: what friction may do too much or too little */
#define ROUNDED 1e-11          /* of the scene's size: gaps of what flies are known to that */
#define CHATTER 40.0           /* events that a body had lately: contacts that take turns would go on to */
#define MOST_RETURNS 4         /* times that lifts are held at an event and the rest looked at again */

/* ---------------------------------------------------------------- who is in it */

static int touching_pair(Exact *e, int32_t a, const State *sa, int32_t b, const State *sb, int32_t *count) {
    for (;;) {
        *count = touching_now(e->world, a, sa, b, sb, &e->slack, e->touching, e->touching_capacity);
        if (*count < e->touching_capacity) return SIM_OK;
        int32_t capacity = e->touching_capacity ? 2 * e->touching_capacity : 16;
        Touching *grown = realloc(e->touching, (size_t)capacity * sizeof *grown);
        if (!grown) return SIM_OUT_OF_MEMORY;
        e->touching = grown;
        e->touching_capacity = capacity;
    }
}

void group_add(Exact *e, int32_t body, double time) {
    Track *track = &e->track[body];
    record_motion(e->recorder, body, &track->motion, time);
    State state = motion_state(&track->motion, time);
    system_add_body(&e->group, body, &state);
}

static bool is_joined(const World *world, int32_t a, int32_t b) {
    for (int32_t j = 0; j < world->joint_count; j++) {
        const Joint *joint = &world->joint[j];
        if ((joint->a == a && joint->b == b) || (joint->a == b && joint->b == a)) return true;
    }
    return false;
}

int group_gather(Exact *e, int32_t body, double time) {
    int32_t first = e->group.count;
    if (e->group.place_of[body] < 0) group_add(e, body, time);
    return group_spread(e, first, time);
}

int group_spread(Exact *e, int32_t first, double time) {
    World *world = e->world;
    for (int32_t head = first; head < e->group.count; head++) {
        int32_t i = e->group.member[head];
        for (int32_t j = 1; j < world->body_count; j++) {
            if (e->group.place_of[j] >= 0 || world->body[j].mode == MODE_CROWD) continue;
            bool held = (e->track[i].island >= 0 && e->track[i].island == e->track[j].island) ||
                        (world->joint_count > 0 && is_joined(world, i, j));
            if (!held) {
                double reach = world->body[i].reach + world->body[j].reach + e->slack.gap;
                Vec apart = vsub(motion_position(&e->track[j].motion, time), e->group.state[head].p);
                if (vdot(apart, apart) > reach * reach) continue;
                State other = motion_state(&e->track[j].motion, time);
                int32_t count;
                int status = touching_pair(e, i, &e->group.state[head], j, &other, &count);
                if (status != SIM_OK) return status;
                held = count > 0;
            }
            if (held) group_add(e, j, time);
        }
    }
    return SIM_OK;
}

/* Whether a gap that is small enough to count as closed closes later, surely: where flights are known to rounding, so is that. */
static bool closes_later(const Exact *e, int32_t a, int32_t b, const Gap *gap) {
    bool known = e->track[a].motion.degree <= 2 && e->track[b].motion.degree <= 2;
    return known && gap->gap > ROUNDED * e->world->size && gap->rate < -e->slack.unsure;
}

static int find_contacts(Exact *e) {
    System *g = &e->group;
    static const State still = {0};
    for (int32_t i = 0; i < g->count; i++)
        for (int32_t j = i; j < g->count; j++) { /* j = i stands for the background */
            int32_t other = j == i ? 0 : g->member[j], count;
            int status = touching_pair(e, g->member[i], &g->state[i], other, j == i ? &still : &g->state[j], &count);
            for (int32_t k = 0; k < count && status == SIM_OK; k++) {
                const Touching *t = &e->touching[k];
                if (closes_later(e, g->member[i], other, &t->gap)) continue;
                const Shape *a = &e->world->shape[t->feature.shape_a], *b = &e->world->shape[t->feature.shape_b];
                /* held where it is: lifting it out would feed energy to a body that rocks on the spot */
                double hold = fmin(t->gap.gap, e->slack.gap);
                Contact contact = {.feature = t->feature,
                                   .friction = pair_friction(a, b),
                                   .elasticity = pair_elasticity(a, b),
                                   .hold = hold};
                status = system_add_contact(g, &contact);
            }
            if (status != SIM_OK) return status;
        }
    return SIM_OK;
}

/* ---------------------------------------------------------------- what happens */

/* How fast each contact's gap was being closed by the motion that ends here. */
static int find_pulls(Exact *e, double time) {
    System *g = &e->group;
    int status = system_place(g);
    if (status != SIM_OK) return status;
    for (int32_t i = 0; i < g->count; i++) {
        State a = motion_acceleration(&e->track[g->member[i]].motion, time);
        e->acceleration[3 * i] = a.v.x, e->acceleration[3 * i + 1] = a.v.y, e->acceleration[3 * i + 2] = a.spin;
    }
    for (int32_t k = 0; k < g->contact_count; k++)
        g->contact[k].pull = -row_acceleration(contact_row(g, k), e->acceleration);
    return SIM_OK;
}

/* The strongest pull on a contact's bodies: when they turn from one contact to another, that is what brings them back. */
static double pull_about(const System *g, const Contact *of) {
    double most = 0;
    for (int32_t k = 0; k < g->contact_count; k++) {
        const Feature *f = &g->contact[k].feature, *h = &of->feature;
        bool shared = (f->body_a != 0 && (f->body_a == h->body_a || f->body_a == h->body_b)) ||
                      (f->body_b != 0 && (f->body_b == h->body_a || f->body_b == h->body_b));
        if (shared) most = fmax(most, g->contact[k].pull);
    }
    return most;
}

/* The largest friction of the contacts that slide; none where events have come so fast for so long that they would go on. */
static double find_rub(const Exact *e) {
    const System *g = &e->group;
    double most = 0;
    for (int32_t k = 0; k < g->contact_count; k++) {
        double slip = row_speed(contact_row(g, k) + 1, g->state);
        if (fabs(slip) > e->slack.unsure) most = fmax(most, g->contact[k].friction);
    }
    for (int32_t i = 0; i < g->count; i++)
        if (e->track[g->member[i]].bucket > CHATTER) return 0;
    return most;
}

/* Whether a lift is too low to be seen.  What slides goes without friction while it is up, and is rubbed for it when it lands: to hold
 * it down leaves out the one and gives the other, so that there a lift counts by its speed. */
static bool is_low_lift(const Slack *slack, double pull, double speed, double rub) {
    return speed > slack->speed && is_low(slack, pull, speed) && rub * speed <= UNFELT * slack->unsure;
}

/* Hold the contacts whose lift is too low to be seen, with those that touch. */
static int hold_low(Exact *e) {
    System *g = &e->group;
    for (int32_t k = 0; k < g->contact_count; k++) {
        Contact *c = &g->contact[k];
        double speed = row_speed(contact_row(g, k), g->state), slip = row_speed(contact_row(g, k) + 1, g->state);
        c->active = c->low || fabs(speed) <= e->slack.speed;
        c->slide = fabs(slip) > e->slack.speed ? 1 : 0;
    }
    e->smooth.relax = 0;
    int status = smooth_prepare(&e->smooth, g);
    return status == SIM_OK ? project_velocities(&e->smooth, g) : status;
}

/* A body that rocks from corner to corner, ever lower, comes to rest on both: a lift too low to be seen is none. */
static int settle_low_lifts(Exact *e) {
    System *g = &e->group;
    double rub = find_rub(e);
    bool any = false;
    for (int32_t k = 0; k < g->contact_count; k++) {
        Contact *c = &g->contact[k];
        c->low = is_low_lift(&e->slack, pull_about(g, c), row_speed(contact_row(g, k), g->state), rub);
        any = any || c->low;
    }
    return any ? hold_low(e) : SIM_OK;
}

/* The same by what brings a lift back once the modes are known.  Two contacts of a mechanism, each of which lifts the other
 * when it closes, would take turns for as long as the load is on them. Whether any was settled. */
static int settle_returns(Exact *e, bool *any) {
    System *g = &e->group;
    double rub = find_rub(e);
    *any = false;
    for (int32_t k = 0; k < g->contact_count; k++) {
        Contact *c = &g->contact[k];
        double back = -row_acceleration(contact_row(g, k), e->acceleration);
        c->low = is_low_lift(&e->slack, back, row_speed(contact_row(g, k), g->state), rub);
        *any = *any || c->low;
    }
    return *any ? hold_low(e) : SIM_OK;
}

static int resolve(Exact *e, double time) {
    System *g = &e->group;
    if (g->contact_count > e->impulse_capacity) {
        free(e->impulse);
        e->impulse_capacity = 2 * g->contact_count;
        e->impulse = malloc((size_t)e->impulse_capacity * sizeof *e->impulse);
        if (!e->impulse) return e->impulse_capacity = 0, SIM_OUT_OF_MEMORY;
    }
    for (int32_t k = 0; k < g->contact_count; k++) e->impulse[k] = vec(0, 0);
    int32_t rounds = 0;
    int status = resolve_impacts(&e->solver, g, &e->slack, e->impulse, &rounds);
    e->world->profile.impacts += rounds > 0;
    for (int32_t k = 0; k < g->contact_count && status == SIM_OK; k++) {
        const Row *row = contact_row(g, k);
        Vec p = e->impulse[k];
        if (p.x == 0 && p.y == 0) continue;
        const Feature *f = &g->contact[k].feature;
        Vec point = g->contact[k].gap.point;
        SimEvent event = {
            .time = time,
            .kind = SIM_IMPACT,
            .body = {e->world->shape[f->shape_b].source, e->world->shape[f->shape_a].source},
            .point = {point.x, point.y},
            .impulse = {p.x * row[0].j[0][0] + p.y * row[1].j[0][0], p.x * row[0].j[0][1] + p.y * row[1].j[0][1]}};
        status = record_event(e->recorder, &event);
    }
    return status;
}

/* Keep the contacts that press. */
static void drop_inactive(System *g) {
    int32_t kept = 0;
    for (int32_t k = 0; k < g->contact_count; k++)
        if (g->contact[k].active) g->contact[kept++] = g->contact[k];
    g->contact_count = kept;
}

/* ---------------------------------------------------------------- how they go on */

static int32_t find_root(int32_t *root, int32_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
}

static void unite(int32_t *root, int32_t i, int32_t j) {
    if (i < 0 || j < 0) return;
    i = find_root(root, i), j = find_root(root, j);
    if (i != j) root[i > j ? i : j] = i < j ? i : j;
}

static void partition(Exact *e) {
    System *g = &e->group;
    for (int32_t i = 0; i < g->count; i++) e->root[i] = i;
    for (int32_t k = 0; k < g->joint_count; k++) {
        const Joint *joint = &e->world->joint[g->joint[k]];
        unite(e->root, g->place_of[joint->a], g->place_of[joint->b]);
    }
    for (int32_t k = 0; k < g->contact_count; k++)
        unite(e->root, g->place_of[g->contact[k].feature.body_a], g->place_of[g->contact[k].feature.body_b]);
}

static Island *new_island(Exact *e, int32_t *index) {
    for (*index = 0; *index < e->island_count && e->island[*index].in_use; ++*index) {}
    if (*index == e->island_count) e->island_count++;
    Island *island = &e->island[*index];
    island->in_use = true;
    island->member_count = island->contact_count = 0;
    island->pace = (Pace){.step = FIRST_STEP};
    return island;
}

static int island_add(Island *island, const int32_t *member, const Contact *contact) {
    if (member) {
        if (island->member_count == island->member_capacity) {
            int32_t capacity = island->member_capacity ? 2 * island->member_capacity : 8;
            int32_t *grown = realloc(island->member, (size_t)capacity * sizeof *grown);
            if (!grown) return SIM_OUT_OF_MEMORY;
            island->member = grown;
            island->member_capacity = capacity;
        }
        island->member[island->member_count++] = *member;
    }
    if (contact) {
        if (island->contact_count == island->contact_capacity) {
            int32_t capacity = island->contact_capacity ? 2 * island->contact_capacity : 8;
            Contact *grown = realloc(island->contact, (size_t)capacity * sizeof *grown);
            if (!grown) return SIM_OUT_OF_MEMORY;
            island->contact = grown;
            island->contact_capacity = capacity;
        }
        island->contact[island->contact_count++] = *contact;
    }
    return SIM_OK;
}

static bool touches_root(Exact *e, const Contact *c, int32_t root) {
    int32_t a = e->group.place_of[c->feature.body_a], b = e->group.place_of[c->feature.body_b];
    return (a >= 0 && find_root(e->root, a) == root) || (b >= 0 && find_root(e->root, b) == root);
}

static bool is_held(Exact *e, int32_t root) {
    System *g = &e->group;
    for (int32_t k = 0; k < g->contact_count; k++)
        if (touches_root(e, &g->contact[k], root)) return true;
    for (int32_t k = 0; k < g->joint_count; k++) {
        const Joint *joint = &e->world->joint[g->joint[k]];
        int32_t a = g->place_of[joint->a], b = g->place_of[joint->b];
        if ((a >= 0 && find_root(e->root, a) == root) || (b >= 0 && find_root(e->root, b) == root)) return true;
    }
    return false;
}

static bool is_at_rest(Exact *e, int32_t root) {
    System *g = &e->group;
    double gravity = vlength(e->world->gravity), none = 1e-9 * (gravity > 0 ? gravity : 1);
    for (int32_t i = 0; i < g->count; i++) {
        if (find_root(e->root, i) != root) continue;
        const State *s = &g->state[i];
        const double *a = &e->acceleration[3 * i];
        double reach = e->world->body[g->member[i]].reach;
        if (vlength(s->v) > 4 * e->slack.speed || fabs(s->spin) * reach > 4 * e->slack.speed) return false;
        if (vlength(vec(a[0], a[1])) > none || fabs(a[2]) * reach > none) return false;
    }
    return true;
}

/* Set the part of the group with this root on its way: at rest, in flight, or in smooth motion. */
static int send_off(Exact *e, int32_t root, double time) {
    System *g = &e->group;
    bool held = is_held(e, root), rest = is_at_rest(e, root);
    Island *island = NULL;
    int32_t index = -1;
    if (held && !rest) island = new_island(e, &index);
    int status = SIM_OK;
    for (int32_t i = 0; i < g->count && status == SIM_OK; i++) {
        if (find_root(e->root, i) != root) continue;
        int32_t body = g->member[i];
        Track *track = &e->track[body];
        State state = g->state[i];
        if (rest) state.v = vec(0, 0), state.spin = 0;
        set_body_state(&e->world->body[body], &state); /* the crowd takes resting bodies for walls where they stand */
        track->motion = rest ? motion_at_rest(&state, time) : motion_in_flight(&state, time, e->world->gravity);
        track->island = index;
        e->changed[body] = true;
        if (rest && held && e->world->body[body].mode != MODE_REST) status = change_tell_rest(e, body, time, state.p);
        e->world->body[body].mode = rest ? MODE_REST : held ? MODE_SMOOTH : MODE_FLIGHT;
        if (island && track->step > 0) island->pace.step = fmin(island->pace.step, track->step);
        if (island && status == SIM_OK) status = island_add(island, &body, NULL);
    }
    e->world->profile.rests += rest && held;
    e->world->profile.flights += !rest && !held;
    for (int32_t k = 0; island && k < g->contact_count && status == SIM_OK; k++)
        if (touches_root(e, &g->contact[k], root)) status = island_add(island, NULL, &g->contact[k]);
    if (island && status == SIM_OK) status = island_advance(e, index, time);
    return status;
}

void group_send_to_crowd(Exact *e, double time) {
    for (int32_t i = 0; i < e->group.count; i++) {
        int32_t member = e->group.member[i];
        Body *body = &e->world->body[member];
        if (e->track[member].island >= 0) island_dissolve(e, e->track[member].island);
        set_body_state(body, &e->group.state[i]);
        body->mode = MODE_CROWD;
        e->changed[member] = true;
        e->track[member].touch_time = INFINITY;
        e->track[member].motion.end = -1; /* the mark of a body that the crowd carries */
        record_state(e->recorder, member, time);
    }
}

static bool all_still(const Exact *e) {
    for (int32_t i = 0; i < e->group.count; i++) {
        const State *s = &e->group.state[i];
        double reach = e->world->body[e->group.member[i]].reach;
        if (vlength(s->v) > e->slack.speed || fabs(s->spin) * reach > e->slack.speed) return false;
    }
    return true;
}

/* Whether a member is so deep in something that its contact could not be told from lying behind the side. */
static bool any_too_deep(Exact *e) {
    System *g = &e->group;
    for (int32_t i = 0; i < g->count; i++) set_body_state(&e->world->body[g->member[i]], &g->state[i]);
    for (int32_t i = 0; i < g->count; i++) {
        int32_t member = g->member[i];
        if (too_deep(e->world, member, 0, &e->slack)) return true;
        for (int32_t j = 1; j < e->world->body_count; j++) {
            const Body *a = &e->world->body[member], *b = &e->world->body[j];
            bool is_where_it_says = g->place_of[j] > i || (g->place_of[j] < 0 && b->mode == MODE_REST);
            double reach = a->reach + b->reach;
            Vec apart = vsub(a->position, b->position);
            if (is_where_it_says && vdot(apart, apart) < reach * reach && too_deep(e->world, member, j, &e->slack))
                return true;
        }
    }
    return false;
}

static double kinetic_energy(const Exact *e) {
    double sum = 0;
    for (int32_t i = 0; i < e->group.count; i++) {
        const Body *body = &e->world->body[e->group.member[i]];
        const State *s = &e->group.state[i];
        sum += 0.5 * (body->mass * vdot(s->v, s->v) + body->moment * s->spin * s->spin);
    }
    return sum;
}

/* Jams with joints and friction can have impulses that make energy; then the group is as it was before them. */
static bool made_energy(Exact *e, double before, double time) {
    System *g = &e->group;
    double mass = 0, unseen = 10 * e->slack.speed;
    for (int32_t i = 0; i < g->count; i++) mass += e->world->body[g->member[i]].mass;
    if (kinetic_energy(e) <= before * (1 + 1e-5) + 0.5 * mass * unseen * unseen) return false;
    for (int32_t i = 0; i < g->count; i++) g->state[i] = motion_state(&e->track[g->member[i]].motion, time);
    return true;
}

int group_reform(Exact *e, double time) {
    System *g = &e->group;
    e->world->profile.events += 1;
    int status = change_note_before(e);
    for (int32_t i = 0; i < g->count && status == SIM_OK; i++) {
        int32_t island = e->track[g->member[i]].island;
        if (island < 0) continue;
        status = island_settle(e, &e->island[island], time);
        island_dissolve(e, island);
    }
    bool crowded = e->world->body[g->member[0]].mode == MODE_CROWD || any_too_deep(e);
    if (status == SIM_OK && !crowded) status = find_contacts(e);
    if (status != SIM_OK) return status;
    /* what rests in the crowd is put to rest there: the exact way need not find it out, at the cube of its contacts */
    bool may_rest = !e->from_crowd && all_still(e);
    if (crowded || g->contact_count > (may_rest ? MOST_CONTACTS_REST : MOST_CONTACTS)) {
        group_send_to_crowd(e, time);
        return SIM_OK;
    }
    system_find_joints(g);
    double start = seconds_now(), energy = kinetic_energy(e);
    status = find_pulls(e, time);
    if (status == SIM_OK) status = resolve(e, time);
    if (status == SIM_OK) status = settle_low_lifts(e);
    if (status == SIM_OK) status = resolve(e, time);
    if (status == SIM_OK) status = find_modes(&e->solver, g, &e->slack, e->acceleration);
    if (status == SIM_BAD_INPUT) {
        status = resolve_shock(&e->solver, g, &e->slack);
        if (status == SIM_OK) status = find_modes(&e->solver, g, &e->slack, e->acceleration);
    }
    bool returns = true;
    for (int round = 0; returns && round < MOST_RETURNS && status == SIM_OK; round++) {
        status = settle_returns(e, &returns);
        if (returns && status == SIM_OK) status = resolve(e, time);
        if (returns && status == SIM_OK) status = find_modes(&e->solver, g, &e->slack, e->acceleration);
    }
    e->world->profile.impact_time += seconds_now() - start;
    if (status == SIM_OK && made_energy(e, energy, time)) status = SIM_BAD_INPUT;
    if (status == SIM_BAD_INPUT) { /* contacts that admit no rigid motion: the crowd's, met one after another, do */
        group_send_to_crowd(e, time);
        return SIM_OK;
    }
    if (status == SIM_OK) status = change_tell_contacts(e, time);
    if (status != SIM_OK) return status;
    drop_inactive(g);
    partition(e);
    for (int32_t i = 0; i < g->count && status == SIM_OK; i++)
        if (find_root(e->root, i) == i) status = send_off(e, i, time);
    return status;
}
