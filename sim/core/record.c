#include "record.h"

#include <stdlib.h>
#include <string.h>

int recorder_create(Recorder *r, const World *world, const SimOptions *options, double *frames) {
    *r = (Recorder){.world = world,
                    .fps = options->fps,
                    .sample_count = options->sample_count,
                    .still = options->sample_count,
                    .frames = frames};
    r->next = calloc((size_t)world->body_count, sizeof *r->next);
    r->rested = calloc((size_t)world->source_count + 1, sizeof *r->rested);
    return r->next && r->rested ? SIM_OK : SIM_OUT_OF_MEMORY;
}

void recorder_destroy(Recorder *r) {
    free(r->next);
    free(r->rested);
    free(r->event);
    index_destroy(&r->touching);
    *r = (Recorder){0};
}

/* One sample of the sources that a body carries. */
static void write_sample(Recorder *r, int32_t body, int64_t k, const State *state) {
    const World *world = r->world;
    const Body *b = &world->body[body];
    double *frame = r->frames + k * 6 * world->source_count;
    bool alone = body != 0 && b->shape_count == 1; /* then the source's frame is the body's */
    Pose at = alone ? (Pose){state->p, 1, 0} : pose(state->p, state->angle);
    for (int32_t i = b->first_shape; i < b->first_shape + b->shape_count; i++) {
        const Shape *shape = &world->shape[i];
        double *out = frame + 6 * shape->source;
        Vec arm = alone ? vec(0, 0) : turn(at, shape->offset);
        out[0] = state->p.x + arm.x, out[1] = state->p.y + arm.y;
        out[2] = state->angle + (alone ? 0 : shape->turned);
        out[3] = state->v.x - state->spin * arm.y, out[4] = state->v.y + state->spin * arm.x;
        out[5] = state->spin;
        if (state->v.x != 0 || state->v.y != 0 || state->spin != 0) r->rested[shape->source] = false;
    }
}

/* A sample that is as the one before. */
static void repeat_sample(Recorder *r, int32_t body, int64_t k) {
    const World *world = r->world;
    const Body *b = &world->body[body];
    double *frame = r->frames + k * 6 * world->source_count;
    for (int32_t i = b->first_shape; i < b->first_shape + b->shape_count; i++) {
        double *out = frame + 6 * world->shape[i].source;
        memcpy(out, out - 6 * world->source_count, 6 * sizeof *out);
    }
}

void record_motion(Recorder *r, int32_t body, const Motion *motion, double time) {
    int64_t k = r->next[body];
    if (motion->degree == 0) {
        State state = motion_state(motion, motion->start);
        for (int64_t first = k; k < r->sample_count && (double)k / r->fps < time; k++) {
            if (k == first)
                write_sample(r, body, k, &state);
            else
                repeat_sample(r, body, k);
        }
    } else {
        for (; k < r->sample_count && (double)k / r->fps < time; k++) {
            State state = motion_state(motion, (double)k / r->fps);
            write_sample(r, body, k, &state);
        }
    }
    r->next[body] = k;
}

void record_still(Recorder *r, int64_t from) {
    size_t frame = 6 * (size_t)r->world->source_count;
    r->still = from;
    for (int64_t k = from; k < r->sample_count; k++)
        memcpy(r->frames + frame * (size_t)k, r->frames + frame * (size_t)(k - 1), frame * sizeof *r->frames);
}

void record_state(Recorder *r, int32_t body, double time) {
    State state = body_state(&r->world->body[body]);
    int64_t k = r->next[body];
    for (; k < r->sample_count && (double)k / r->fps <= time; k++) write_sample(r, body, k, &state);
    r->next[body] = k;
}

static uint64_t source_key(int32_t a, int32_t b) { return a < b ? pair_key(a, b) : pair_key(b, a); }

bool record_touches(const Recorder *r, int32_t a, int32_t b) { return index_find(&r->touching, source_key(a, b)) == 1; }

/* Note that a contact begins or ends. Whether that is news. */
static int note_contact(Recorder *r, const SimEvent *event, bool *news) {
    int32_t begins = event->kind == SIM_CONTACT_BEGUN;
    uint64_t key = source_key(event->body[0], event->body[1]);
    int32_t *known = index_at(&r->touching, key);
    *news = known ? *known != begins : begins;
    if (known) {
        *known = begins;
    } else if (begins) {
        if (index_room(&r->touching, r->touching.count + 1) != SIM_OK) return SIM_OUT_OF_MEMORY;
        index_add(&r->touching, key, 1);
    }
    return SIM_OK;
}

/* Note that a body is struck, or rests.  Whether that is news: one that its neighbours wake, and that rests again before it has
 * been seen to move, has not come to rest. */
static bool note_rest(Recorder *r, const SimEvent *event) {
    bool news = event->kind != SIM_REST || !r->rested[event->body[0]];
    if (event->kind == SIM_REST) r->rested[event->body[0]] = true;
    for (int k = 0; event->kind == SIM_IMPACT && k < 2; k++)
        if (event->body[k] >= 0) r->rested[event->body[k]] = false;
    return news;
}

int record_event(Recorder *r, const SimEvent *event) {
    if (event->kind == SIM_CONTACT_BEGUN || event->kind == SIM_CONTACT_ENDED) {
        bool news;
        int status = note_contact(r, event, &news);
        if (status != SIM_OK || !news) return status;
    }
    if (!note_rest(r, event)) return SIM_OK;
    if (event->time > (double)(r->sample_count - 1) / r->fps) return SIM_OK;
    if (r->event_count == r->event_capacity) {
        int64_t capacity = r->event_capacity ? 2 * r->event_capacity : 64;
        SimEvent *grown = realloc(r->event, (size_t)capacity * sizeof *grown);
        if (!grown) return SIM_OUT_OF_MEMORY;
        r->event = grown;
        r->event_capacity = capacity;
    }
    r->event[r->event_count++] = *event;
    return SIM_OK;
}

void record_sort_events(
    Recorder *r) { /* nearly in order: only the crowd's last steps and what is beside it interleave */
    for (int64_t k = 1; k < r->event_count; k++) {
        SimEvent event = r->event[k];
        int64_t at = k;
        for (; at > 0 && r->event[at - 1].time > event.time; at--) r->event[at] = r->event[at - 1];
        r->event[at] = event;
    }
}
