#include "system.h"

#include <stdlib.h>

int system_create(System *s, const World *world) {
    size_t n = (size_t)world->body_count;
    *s = (System){.world = world, .capacity = world->body_count};
    s->member = malloc(n * sizeof *s->member);
    s->place_of = malloc(n * sizeof *s->place_of);
    s->state = malloc(n * sizeof *s->state);
    s->placed = malloc(n * sizeof *s->placed);
    s->joint = malloc(((size_t)world->joint_count + 1) * sizeof *s->joint);
    if (!s->member || !s->place_of || !s->state || !s->placed || !s->joint) {
        system_destroy(s);
        return SIM_OUT_OF_MEMORY;
    }
    for (size_t i = 0; i < n; i++) s->place_of[i] = -1;
    return SIM_OK;
}

void system_destroy(System *s) {
    free(s->member);
    free(s->place_of);
    free(s->state);
    free(s->placed);
    free(s->joint);
    free(s->contact);
    free(s->row);
    *s = (System){0};
}

void system_clear(System *s) {
    for (int32_t i = 0; i < s->count; i++) s->place_of[s->member[i]] = -1;
    s->count = s->joint_count = s->contact_count = s->row_count = 0;
}

void system_add_body(System *s, int32_t body, const State *state) {
    s->place_of[body] = s->count;
    s->member[s->count] = body;
    s->state[s->count++] = *state;
}

int system_add_contact(System *s, const Contact *contact) {
    if (s->contact_count == s->contact_capacity) {
        int32_t capacity = s->contact_capacity ? 2 * s->contact_capacity : 32;
        Contact *grown = realloc(s->contact, (size_t)capacity * sizeof *grown);
        if (!grown) return SIM_OUT_OF_MEMORY;
        s->contact = grown;
        s->contact_capacity = capacity;
    }
    s->contact[s->contact_count++] = *contact;
    return SIM_OK;
}

void system_find_joints(System *s) {
    s->joint_count = 0;
    for (int32_t j = 0; j < s->world->joint_count; j++) {
        const Joint *joint = &s->world->joint[j];
        if (s->place_of[joint->a] >= 0 || s->place_of[joint->b] >= 0) s->joint[s->joint_count++] = j;
    }
}

void system_load(System *s, const double *y) {
    for (int32_t i = 0; i < s->count; i++, y += 6) s->state[i] = (State){vec(y[0], y[1]), y[2], vec(y[3], y[4]), y[5]};
}

void system_store(const System *s, double *y) {
    for (int32_t i = 0; i < s->count; i++, y += 6) {
        const State *state = &s->state[i];
        y[0] = state->p.x, y[1] = state->p.y, y[2] = state->angle;
        y[3] = state->v.x, y[4] = state->v.y, y[5] = state->spin;
    }
}

static const Placed BACKGROUND = {{{0, 0}, 1, 0}, {0, 0}, 0};

const Placed *system_placed(const System *s, int32_t body) {
    return s->place_of[body] >= 0 ? &s->placed[s->place_of[body]] : &BACKGROUND;
}

/* A row along `direction` between two material points at arms ra, rb from the centres. */
static Row make_row(int32_t a, int32_t b, Vec direction, Vec ra, Vec rb) {
    Row row = {.a = a, .b = b};
    row.ja[0] = row.fa[0] = direction.x;
    row.ja[1] = row.fa[1] = direction.y;
    row.ja[2] = row.fa[2] = vcross(ra, direction);
    row.jb[0] = row.fb[0] = -direction.x;
    row.jb[1] = row.fb[1] = -direction.y;
    row.jb[2] = row.fb[2] = -vcross(rb, direction);
    return row;
}

static void place_joint(System *s, int32_t k) {
    const Joint *joint = &s->world->joint[s->joint[k]];
    const Placed *a = system_placed(s, joint->a), *b = system_placed(s, joint->b);
    Vec ra = turn(a->at, joint->local_a), rb = turn(b->at, joint->local_b);
    int32_t ia = s->place_of[joint->a], ib = s->place_of[joint->b];
    joint_row(s, k)[0] = make_row(ia, ib, vec(1, 0), ra, rb);
    joint_row(s, k)[1] = make_row(ia, ib, vec(0, 1), ra, rb);
}

static void place_contact(System *s, int32_t k) {
    const Contact *c = &s->contact[k];
    const Placed *a = system_placed(s, c->feature.body_a), *b = system_placed(s, c->feature.body_b);
    Gap g = feature_gap(&c->feature, a, b);
    Vec ra = vsub(g.point, a->at.p), rb = vsub(g.point, b->at.p);
    int32_t ia = s->place_of[c->feature.body_a], ib = s->place_of[c->feature.body_b];
    Row *normal = contact_row(s, k), *along = normal + 1;
    *normal = make_row(ia, ib, g.normal, ra, rb);
    *along = make_row(ia, ib, g.along, ra, rb);
    if (c->slide != 0) /* friction against the slip, mu times the normal force */
        for (int i = 0; i < 3; i++) {
            normal->fa[i] -= c->slide * c->friction * along->ja[i];
            normal->fb[i] -= c->slide * c->friction * along->jb[i];
        }
}

int system_place(System *s) {
    s->row_count = 2 * (s->joint_count + s->contact_count);
    if (s->row_count > s->row_capacity) {
        Row *grown = realloc(s->row, 2 * (size_t)s->row_count * sizeof *grown);
        if (!grown) return SIM_OUT_OF_MEMORY;
        s->row = grown;
        s->row_capacity = 2 * s->row_count;
    }
    for (int32_t i = 0; i < s->count; i++) s->placed[i] = placed(&s->state[i]);
    for (int32_t k = 0; k < s->joint_count; k++) place_joint(s, k);
    for (int32_t k = 0; k < s->contact_count; k++) place_contact(s, k);
    return SIM_OK;
}

void system_find_bias(System *s) {
    for (int32_t k = 0; k < s->joint_count; k++) { /* d^2/dt^2 of (xa + ra) - (xb + rb): centripetal */
        const Joint *joint = &s->world->joint[s->joint[k]];
        const Placed *a = system_placed(s, joint->a), *b = system_placed(s, joint->b);
        Vec bias = vsub(vscale(turn(b->at, joint->local_b), b->spin * b->spin),
                        vscale(turn(a->at, joint->local_a), a->spin * a->spin));
        joint_row(s, k)[0].bias = bias.x;
        joint_row(s, k)[1].bias = bias.y;
    }
    for (int32_t k = 0; k < s->contact_count; k++) {
        const Feature *f = &s->contact[k].feature;
        Row *normal = contact_row(s, k);
        feature_bias(f, system_placed(s, f->body_a), system_placed(s, f->body_b), &normal[0].bias, &normal[1].bias);
    }
}

Vec contact_point(const System *s, int32_t k) {
    const Feature *f = &s->contact[k].feature;
    return feature_gap(f, system_placed(s, f->body_a), system_placed(s, f->body_b)).point;
}

double row_acceleration(const Row *row, const double *acceleration) {
    double sum = row->bias;
    for (int i = 0; i < 3; i++) {
        if (row->a >= 0) sum += row->ja[i] * acceleration[3 * row->a + i];
        if (row->b >= 0) sum += row->jb[i] * acceleration[3 * row->b + i];
    }
    return sum;
}

double row_speed(const Row *row, const State *state) {
    double speed = 0;
    if (row->a >= 0) {
        const State *a = &state[row->a];
        speed += row->ja[0] * a->v.x + row->ja[1] * a->v.y + row->ja[2] * a->spin;
    }
    if (row->b >= 0) {
        const State *b = &state[row->b];
        speed += row->jb[0] * b->v.x + row->jb[1] * b->v.y + row->jb[2] * b->spin;
    }
    return speed;
}

static void push(const System *s, int32_t i, const double *force, double impulse) {
    if (i < 0) return;
    const Body *body = &s->world->body[s->member[i]];
    State *state = &s->state[i];
    state->v = vmad(state->v, impulse * body->inverse_mass, vec(force[0], force[1]));
    state->spin += impulse * body->inverse_moment * force[2];
}

void row_push(const System *s, const Row *row, double impulse) {
    push(s, row->a, row->fa, impulse);
    push(s, row->b, row->fb, impulse);
}

static double coupling(const System *s, int32_t i, const double *j, const double *f) {
    const Body *body = &s->world->body[s->member[i]];
    return body->inverse_mass * (j[0] * f[0] + j[1] * f[1]) + body->inverse_moment * j[2] * f[2];
}

double row_coupling(const System *s, const Row *i, const Row *j) {
    double sum = 0;
    if (i->a >= 0 && i->a == j->a) sum += coupling(s, i->a, i->ja, j->fa);
    if (i->a >= 0 && i->a == j->b) sum += coupling(s, i->a, i->ja, j->fb);
    if (i->b >= 0 && i->b == j->a) sum += coupling(s, i->b, i->jb, j->fa);
    if (i->b >= 0 && i->b == j->b) sum += coupling(s, i->b, i->jb, j->fb);
    return sum;
}
