/* Doors into the core for the tests: parts of it alone, without the run around them. */
#include <stdlib.h>
#include <string.h>

#include "../../sim/core/crowd.h"
#include "../../sim/core/manifold.h"

#define PROBE __attribute__((visibility("default")))

static Outline outline(const double *v, int32_t count, double radius, Vec *normal) {
    const Vec *p = (const Vec *)v;
    for (int32_t k = 0; k < count && count > 1; k++) {
        Vec side = vsub(p[(k + 1) % count], p[k]);
        normal[k] = vscale(vec(side.y, -side.x), 1 / vlength(side));
    }
    return (Outline){p, normal, NULL, NULL, count, radius};
}

/* out: normal x, y, gap, then x, y, separation of each point. Returns the count. */
PROBE int32_t probe_manifold(const double *a, int32_t count_a, double radius_a, const double *b, int32_t count_b,
                             double radius_b, double margin, double *out) {
    Vec normal_a[256], normal_b[256];
    Outline oa = outline(a, count_a, radius_a, normal_a), ob = outline(b, count_b, radius_b, normal_b);
    Manifold m = {0};
    manifold_find(&oa, &ob, margin, &m);
    out[0] = m.normal.x, out[1] = m.normal.y, out[2] = m.gap;
    for (int32_t k = 0; k < m.count; k++) {
        out[3 + 3 * k] = m.point[k].point.x, out[4 + 3 * k] = m.point[k].point.y;
        out[5 + 3 * k] = m.point[k].separation;
    }
    return m.count;
}

static void record(const World *world, double *frame) {
    for (int32_t i = 0; i < world->source_count; i++, frame += 6) {
        const Shape *shape = &world->shape[world->source_shape[i]];
        const Body *body = &world->body[shape->body];
        Vec arm = turn(body_pose(body), shape->offset);
        Vec p = vadd(body->position, arm), v = vmad(body->velocity, body->spin, vperp(arm));
        double values[6] = {p.x, p.y, body->angle + shape->turned, v.x, v.y, body->spin};
        memcpy(frame, values, sizeof values);
    }
}

/* Run a scene by the crowd alone. modes: by sample and input, the mode of its body. Returns SIM_OK or the failure. */
PROBE int32_t probe_crowd(const SimInput *input, double dt, int32_t samples, double tolerance, double *frames,
                          int32_t *modes) {
    World world;
    int status = world_create(&world, input);
    if (status != SIM_OK) return status;
    status = world_separate(&world, tolerance);
    if (status == SIM_OK) status = world_decompose(&world);
    Crowd *crowd = status == SIM_OK ? crowd_create(&world, NULL) : NULL;
    if (!crowd) status = SIM_OUT_OF_MEMORY;
    for (int32_t i = 1; i < world.body_count; i++) world.body[i].mode = MODE_CROWD;
    for (int32_t k = 0; k < samples && status == SIM_OK; k++) {
        record(&world, frames + (size_t)k * 6 * (size_t)world.source_count);
        for (int32_t i = 0; i < world.source_count; i++) {
            Body *body = &world.body[world.shape[world.source_shape[i]].body];
            modes[k * world.source_count + i] = body->mode;
            if (body->mode == MODE_FLIGHT) body->mode = MODE_CROWD;
        }
        if (k + 1 < samples) status = crowd_step(crowd, &world, (double)k * dt, (double)(k + 1) * dt, tolerance);
    }
    crowd_destroy(crowd);
    world_destroy(&world);
    return status;
}
