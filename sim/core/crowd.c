/* Placeholder: free motion only, until the crowd solver lands. */
#include "crowd.h"

#include <stdlib.h>

struct Crowd {
    int unused;
};
Crowd *crowd_create(const World *world) { return (void)world, calloc(1, sizeof(Crowd)); }
void crowd_destroy(Crowd *crowd) { free(crowd); }
int crowd_step(Crowd *crowd, World *world, double dt, double tolerance) {
    (void)crowd, (void)tolerance;
    for (int32_t i = 1; i < world->body_count; i++) {
        Body *b = &world->body[i];
        b->position = vmad(vmad(b->position, dt, b->velocity), dt * dt / 2, world->gravity);
        b->velocity = vmad(b->velocity, dt, world->gravity);
        b->angle += dt * b->spin;
    }
    return SIM_OK;
}
int world_decompose(World *world) { return (void)world, SIM_OK; }
int world_separate(World *world, double tolerance) { return (void)world, (void)tolerance, SIM_OK; }
