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
static void set_row(Row *row, int32_t a, int32_t b, Vec direction, Vec ra, Vec rb, double bias) {
    row->member[0] = a, row->member[1] = b;
    row->j[0][0] = row->f[0][0] = direction.x;
    row->j[0][1] = row->f[0][1] = direction.y;
    row->j[0][2] = row->f[0][2] = vcross(ra, direction);
    row->j[1][0] = row->f[1][0] = -direction.x;
    row->j[1][1] = row->f[1][1] = -direction.y;
    row->j[1][2] = row->f[1][2] = -vcross(rb, direction);
    row->bias = bias;
}

static void place_joint(System *s, int32_t k) {
    const Joint *joint = &s->world->joint[s->joint[k]];
    const Placed *a = system_placed(s, joint->a), *b = system_placed(s, joint->b);
    Vec ra = turn(a->at, joint->local_a), rb = turn(b->at, joint->local_b);
    /* d^2/dt^2 of (xa + ra) - (xb + rb): centripetal */
    Vec bias = vsub(vscale(rb, b->spin * b->spin), vscale(ra, a->spin * a->spin));
    int32_t ia = s->place_of[joint->a], ib = s->place_of[joint->b];
    set_row(&joint_row(s, k)[0], ia, ib, vec(1, 0), ra, rb, bias.x);
    set_row(&joint_row(s, k)[1], ia, ib, vec(0, 1), ra, rb, bias.y);
}

static void place_contact(System *s, int32_t k) {
    Contact *c = &s->contact[k];
    const Placed *a = system_placed(s, c->feature.body_a), *b = system_placed(s, c->feature.body_b);
    double normal_bias, along_bias;
    c->gap = feature_gap(&c->feature, a, b);
    feature_bias(&c->feature, a, b, &normal_bias, &along_bias);
    Vec ra = vsub(c->gap.point, a->at.p), rb = vsub(c->gap.point, b->at.p);
    int32_t ia = s->place_of[c->feature.body_a], ib = s->place_of[c->feature.body_b];
    Row *normal = contact_row(s, k), *along = normal + 1;
    set_row(normal, ia, ib, c->gap.normal, ra, rb, normal_bias);
    set_row(along, ia, ib, c->gap.along, ra, rb, along_bias);
    if (c->slide == 0) return;
    for (int side = 0; side < 2; side++) /* friction against the slip, mu times the normal force */
        for (int i = 0; i < 3; i++) normal->f[side][i] -= c->slide * c->friction * along->j[side][i];
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

double row_acceleration(const Row *row, const double *acceleration) {
    double sum = row->bias;
    for (int side = 0; side < 2; side++) {
        if (row->member[side] < 0) continue;
        const double *j = row->j[side], *of = acceleration + 3 * row->member[side];
        sum += j[0] * of[0] + j[1] * of[1] + j[2] * of[2];
    }
    return sum;
}

double row_speed(const Row *row, const State *state) {
    double speed = 0;
    for (int side = 0; side < 2; side++) {
        if (row->member[side] < 0) continue;
        const double *j = row->j[side];
        const State *of = &state[row->member[side]];
        speed += j[0] * of->v.x + j[1] * of->v.y + j[2] * of->spin;
    }
    return speed;
}

void row_push(const System *s, const Row *row, double impulse) {
    for (int side = 0; side < 2; side++) {
        int32_t i = row->member[side];
        if (i < 0) continue;
        const Body *body = &s->world->body[s->member[i]];
        s->state[i].v = vmad(s->state[i].v, impulse * body->inverse_mass, vec(row->f[side][0], row->f[side][1]));
        s->state[i].spin += impulse * body->inverse_moment * row->f[side][2];
    }
}

double row_coupling(const System *s, const Row *i, const Row *j) {
    double sum = 0;
    for (int of_i = 0; of_i < 2; of_i++)
        for (int of_j = 0; of_j < 2; of_j++) {
            if (i->member[of_i] < 0 || i->member[of_i] != j->member[of_j]) continue;
            const Body *body = &s->world->body[s->member[i->member[of_i]]];
            const double *ji = i->j[of_i], *fj = j->f[of_j];
            sum += body->inverse_mass * (ji[0] * fj[0] + ji[1] * fj[1]) + body->inverse_moment * ji[2] * fj[2];
        }
    return sum;
}
