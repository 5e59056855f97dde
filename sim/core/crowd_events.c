/* Telling what happened in the crowd: impacts by the substep, contacts and rest by the frame. */
#include "crowd_parts.h"

static int32_t source_of(const World *world, int32_t piece) { return world->shape[world->piece[piece].shape].source; }

static int32_t piece_a(uint64_t key) { return (int32_t)(key >> 32); }
static int32_t piece_b(uint64_t key) { return (int32_t)(key & 0xffffffffu); }

/* Where a contact acts: its arm from a's centre by its levers, between its points or at one of them. */
static Vec contact_point_at(const Crowd *crowd, const Contact *c, double lever) {
    Vec centre = crowd_position(crowd, c->a);
    return vmad(vmad(centre, c->spin_ta, c->normal), -lever, vperp(c->normal));
}

static int tell(Crowd *crowd, const World *world, int32_t kind, uint64_t key, Vec point, Vec impulse) {
    SimEvent event = {.time = crowd->time,
                      .kind = kind,
                      .body = {source_of(world, piece_a(key)), source_of(world, piece_b(key))},
                      .point = {point.x, point.y},
                      .impulse = {impulse.x, impulse.y}};
    return record_event(crowd->recorder, &event);
}

/* Contacts whose points closed faster than a bounce is worth have had the whole impulse in this substep. */
int events_tell_impacts(Crowd *crowd, const World *world) {
    if (!crowd->recorder) return SIM_OK;
    for (int32_t i = 0; i < crowd->rows.bounce_count; i++) {
        const Bounce *bounce = &crowd->rows.bounce[i];
        const Contact *c = &crowd->rows.contact[bounce->contact];
        double sum = 0, levers = 0;
        for (int32_t k = 0; k < c->count; k++) {
            if (bounce->approach[k] == 0 || c->impulse_n[k] <= 0) continue;
            sum += c->impulse_n[k];
            levers += c->impulse_n[k] * c->spin_na[k];
        }
        if (sum == 0) continue;
        Vec impulse = vmad(vscale(c->normal, sum), c->impulse_t, vperp(c->normal));
        int status = tell(crowd, world, SIM_IMPACT, c->key, contact_point_at(crowd, c, levers / sum), impulse);
        if (status != SIM_OK) return status;
    }
    return SIM_OK;
}

bool events_touching(const Crowd *crowd, const World *world, const Contact *c) {
    if (!crowd->recorder) return false;
    return record_touches(crowd->recorder, source_of(world, piece_a(c->key)), source_of(world, piece_b(c->key)));
}

/* What touches goes on to while it is no farther than an overlap that is left alone: a load that shifts from one corner to
 * another is no end. */
static bool touches(const Crowd *crowd, const Contact *c) {
    if (contact_presses(c)) return true;
    if (!c->touching || c->count == 0) return false;
    Two gap = gap_now(c, &crowd->mover[c->a], &crowd->mover[c->b]);
    return gap[0] <= c->slop || (c->count > 1 && gap[1] <= c->slop);
}

/* Whether other pieces of the two shapes touch still. */
static bool others_touch(const Crowd *crowd, const World *world, uint64_t key) {
    int32_t a = world->piece[piece_a(key)].shape, b = world->piece[piece_b(key)].shape;
    if (world->shape[a].piece_count == 1 && world->shape[b].piece_count == 1) return false;
    for (int32_t i = 0; i < crowd->rows.count; i++) {
        const Contact *c = &crowd->rows.contact[i];
        if (c->key == key || !touches(crowd, c)) continue;
        if (world->piece[piece_a(c->key)].shape == a && world->piece[piece_b(c->key)].shape == b) return true;
    }
    return false;
}

static int tell_end(Crowd *crowd, const World *world, uint64_t key) {
    if (others_touch(crowd, world, key)) return SIM_OK;
    int32_t a = world->shape[world->piece[piece_a(key)].shape].body;
    int32_t b = world->shape[world->piece[piece_b(key)].shape].body, of = a != 0 ? a : b;
    Vec at = crowd_position(crowd, of);
    return tell(crowd, world, SIM_CONTACT_ENDED, key, at, vec(0, 0));
}

int events_tell_contacts(Crowd *crowd, const World *world) {
    int status = SIM_OK;
    if (!crowd->recorder) return SIM_OK;
    for (int32_t i = 0; i < crowd->rows.count && status == SIM_OK; i++) {
        Contact *c = &crowd->rows.contact[i];
        bool now = touches(crowd, c);
        if (now && !c->touching) {
            double lever = c->count > 1 ? 0.5 * (c->spin_na[0] + c->spin_na[1]) : c->spin_na[0];
            status = tell(crowd, world, SIM_CONTACT_BEGUN, c->key, contact_point_at(crowd, c, lever), vec(0, 0));
        } else if (!now && c->touching) {
            status = tell_end(crowd, world, c->key);
        }
        c->touching = now;
    }
    for (int32_t i = 0; i < crowd->memory.count && status == SIM_OK; i++) {
        const Record *r = &crowd->memory.record[i];
        bool took_part = crowd->mover[r->a].inverse_mass > 0 || crowd->mover[r->b].inverse_mass > 0;
        if (r->touching && !r->seen && took_part) status = tell_end(crowd, world, r->key);
    }
    return status;
}

int events_tell_rest(Crowd *crowd, const World *world, int32_t body) {
    const Body *b = &world->body[body];
    for (int32_t i = b->first_shape; crowd->recorder && i < b->first_shape + b->shape_count; i++) {
        SimEvent event = {.time = crowd->time,
                          .kind = SIM_REST,
                          .body = {world->shape[i].source, -1},
                          .point = {b->position.x, b->position.y}};
        int status = record_event(crowd->recorder, &event);
        if (status != SIM_OK) return status;
    }
    return SIM_OK;
}
