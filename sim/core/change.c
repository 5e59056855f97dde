/* Telling what an event changed: contacts that began or ended, bodies that came to rest. */
#include <stdlib.h>

#include "exact.h"

static uint64_t pair_of(const Feature *f) {
    uint64_t low = (uint64_t)(f->shape_a < f->shape_b ? f->shape_a : f->shape_b);
    uint64_t high = (uint64_t)(f->shape_a < f->shape_b ? f->shape_b : f->shape_a);
    return low << 32 | high;
}

static bool knows(const PairList *list, uint64_t pair) {
    for (int32_t k = 0; k < list->count; k++)
        if (list->pair[k] == pair) return true;
    return false;
}

static int add(PairList *list, const Feature *f) {
    uint64_t pair = pair_of(f);
    if (knows(list, pair)) return SIM_OK;
    if (list->count == list->capacity) {
        int32_t capacity = list->capacity ? 2 * list->capacity : 16;
        uint64_t *grown = realloc(list->pair, (size_t)capacity * sizeof *grown);
        if (!grown) return SIM_OUT_OF_MEMORY;
        list->pair = grown;
        list->capacity = capacity;
    }
    list->pair[list->count++] = pair;
    return SIM_OK;
}

int change_note_before(Exact *e) {
    const System *g = &e->group;
    int status = SIM_OK;
    e->before.count = 0;
    for (int32_t i = 0; i < g->count; i++) {
        int32_t index = e->track[g->member[i]].island;
        if (index < 0) continue;
        const Island *island = &e->island[index];
        for (int32_t k = 0; k < island->contact_count && status == SIM_OK; k++)
            status = add(&e->before, &island->contact[k].feature);
    }
    return status;
}

static bool rested(const Exact *e, int32_t body) { return body == 0 || e->world->body[body].mode == MODE_REST; }

static int tell(Exact *e, double time, int32_t kind, uint64_t pair, Vec point) {
    int32_t low = (int32_t)(pair >> 32), high = (int32_t)(pair & 0xffffffff);
    SimEvent event = {.time = time,
                      .kind = kind,
                      .body = {e->world->shape[low].source, e->world->shape[high].source},
                      .point = {point.x, point.y}};
    return record_event(e->recorder, &event);
}

int change_tell_contacts(Exact *e, double time) {
    const System *g = &e->group;
    int status = SIM_OK;
    e->after.count = 0;
    for (int32_t k = 0; k < g->contact_count && status == SIM_OK; k++) {
        const Contact *c = &g->contact[k];
        if (!c->active) continue;
        uint64_t pair = pair_of(&c->feature);
        bool had = knows(&e->before, pair) || (rested(e, c->feature.body_a) && rested(e, c->feature.body_b));
        if (!had && !knows(&e->after, pair)) status = tell(e, time, SIM_CONTACT_BEGUN, pair, g->contact[k].gap.point);
        if (status == SIM_OK) status = add(&e->after, &c->feature);
    }
    for (int32_t k = 0; k < e->before.count && status == SIM_OK; k++) {
        if (knows(&e->after, e->before.pair[k])) continue;
        int32_t shape = (int32_t)(e->before.pair[k] >> 32), body = e->world->shape[shape].body;
        if (body == 0) body = e->world->shape[(int32_t)(e->before.pair[k] & 0xffffffff)].body;
        status = tell(e, time, SIM_CONTACT_ENDED, e->before.pair[k], exact_state(e, body, time).p);
    }
    return status;
}

int change_tell_rest(Exact *e, int32_t body, double time, Vec at) {
    const Body *b = &e->world->body[body];
    int status = SIM_OK;
    for (int32_t i = b->first_shape; i < b->first_shape + b->shape_count && status == SIM_OK; i++) {
        SimEvent event = {
            .time = time, .kind = SIM_REST, .body = {e->world->shape[i].source, -1}, .point = {at.x, at.y}};
        status = record_event(e->recorder, &event);
    }
    return status;
}
