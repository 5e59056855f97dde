/* The public interface, and the run from sample to sample. */
#include <stdlib.h>
#include <time.h>

#include "crowd.h"
#include "world.h"

struct Sim {
    World world;
    Crowd *crowd;
};

int32_t sim_abi(void) { return SIM_ABI; }

size_t sim_struct_size(int32_t which) {
    const size_t sizes[] = {sizeof(SimBody), sizeof(SimInput), sizeof(SimOptions), sizeof(SimEvent), sizeof(SimProfile)};
    return which >= 0 && which < 5 ? sizes[which] : 0;
}

Sim *sim_create(const SimInput *input) {
    Sim *sim = calloc(1, sizeof *sim);
    if (!sim) return NULL;
    if (world_create(&sim->world, input) != SIM_OK) {
        free(sim);
        return NULL;
    }
    return sim;
}

void sim_destroy(Sim *sim) {
    if (!sim) return;
    crowd_destroy(sim->crowd);
    world_destroy(&sim->world);
    free(sim);
}

const char *sim_error(const Sim *sim) { return sim->world.error ? sim->world.error : "out of memory"; }
int64_t sim_event_count(const Sim *sim) { return (void)sim, 0; }
void sim_events(const Sim *sim, SimEvent *out) { (void)sim, (void)out; }
void sim_profile(const Sim *sim, SimProfile *out) { *out = sim->world.profile; }

static void record(const World *world, double *frame, double *energy) {
    for (int32_t i = 0; i < world->source_count; i++, frame += 6) {
        const Shape *shape = &world->shape[world->source_shape[i]];
        const Body *body = &world->body[shape->body];
        Pose at = body_pose(body);
        Vec arm = turn(at, shape->offset), p = vadd(at.p, arm), v = vmad(body->velocity, body->spin, vperp(arm));
        frame[0] = p.x, frame[1] = p.y, frame[2] = body->angle + shape->turned;
        frame[3] = v.x, frame[4] = v.y, frame[5] = body->spin;
    }
    energy[0] = energy[1] = 0;
    for (int32_t i = 1; i < world->body_count; i++) {
        const Body *b = &world->body[i];
        energy[0] += 0.5 * b->mass * vdot(b->velocity, b->velocity) + 0.5 * b->moment * b->spin * b->spin;
        energy[1] -= b->mass * vdot(world->gravity, b->position);
    }
}

int32_t sim_run(Sim *sim, const SimOptions *options, double *frames, double *energy) {
    World *world = &sim->world;
    int status = world_decompose(world);
    if (status == SIM_OK) status = world_separate(world, options->tolerance);
    if (status == SIM_OK && !(sim->crowd = crowd_create(world))) status = SIM_OUT_OF_MEMORY;
    for (int32_t i = 1; i < world->body_count; i++) world->body[i].mode = MODE_CROWD;
    for (int64_t k = 0; k < options->sample_count && status == SIM_OK; k++) {
        record(world, frames + k * 6 * world->source_count, energy + 2 * k);
        for (int32_t i = 1; i < world->body_count; i++)
            if (world->body[i].mode == MODE_FLIGHT) world->body[i].mode = MODE_CROWD;
        if (k + 1 < options->sample_count) status = crowd_step(sim->crowd, world, 1 / options->fps, options->tolerance);
    }
    return status;
}
