/* Any bytes make a scene, and any scene runs: no crash, no hang, nothing that is not a number.
 *
 * With libFuzzer:   clang -g -O1 -fsanitize=fuzzer,address,undefined sim/core/?*.c tests/sim/fuzz_scene.c -lm
 * By itself, on seeded random bytes (what the tests run):
 *                   cc -g -O1 -fsanitize=address,undefined -DSEEDS=300 sim/core/?*.c tests/sim/fuzz_scene.c -lm
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../../sim/core/sim.h"

enum { MOST_BODIES = 12, MOST_JOINTS = 8, MOST_VERTICES = 9, SAMPLES = 46 };

typedef struct Bytes {
    const uint8_t *at;
    size_t left;
} Bytes;

static uint8_t next(Bytes *b) {
    if (b->left == 0) return 0;
    b->left--;
    return *b->at++;
}

/* A number from low to high, in 256 steps: few enough that coincidences (touching, aligned, equal) are common. */
static double between(Bytes *b, double low, double high) { return low + (high - low) * next(b) / 255; }

/* An outline about its centroid: corners in the order of their angles, which makes it simple, and dents where a radius is
 * small. Returns the number of its vertices. */
static int32_t outline(Bytes *b, double size, double *out, double *area, double *moment) {
    int32_t count = 3 + next(b) % (MOST_VERTICES - 2);
    double x[MOST_VERTICES], y[MOST_VERTICES], cx = 0, cy = 0, twice = 0, polar = 0;
    for (int32_t k = 0; k < count; k++) {
        double r = size * between(b, 0.3, 1), t = (k + between(b, -0.2, 0.2)) * 6.283185307179586 / count;
        x[k] = r * cos(t), y[k] = r * sin(t);
    }
    for (int32_t k = 0; k < count; k++) {
        int32_t m = (k + 1) % count;
        double cross = x[k] * y[m] - y[k] * x[m];
        twice += cross;
        cx += cross * (x[k] + x[m]), cy += cross * (y[k] + y[m]);
        polar += cross * (x[k] * x[k] + x[k] * x[m] + x[m] * x[m] + y[k] * y[k] + y[k] * y[m] + y[m] * y[m]);
    }
    cx /= 3 * twice, cy /= 3 * twice;
    *area = twice / 2;
    *moment = polar / 12 - *area * (cx * cx + cy * cy);
    for (int32_t k = 0; k < count; k++) out[2 * k] = x[k] - cx, out[2 * k + 1] = y[k] - cy;
    return count;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    Bytes b = {data, size};
    SimBody bodies[MOST_BODIES];
    int32_t start[MOST_BODIES + 1] = {0}, anchored[MOST_BODIES], pairs[2 * MOST_JOINTS], joints = 0;
    double vertices[2 * MOST_BODIES * MOST_VERTICES], points[2 * MOST_JOINTS];
    int32_t count = 1 + next(&b) % MOST_BODIES;
    for (int32_t i = 0; i < count; i++) {
        SimBody *body = &bodies[i];
        double length = between(&b, 0.05, 2), area = 3.14159 * length * length, moment = area * length * length / 2;
        uint8_t kind = next(&b);
        *body = (SimBody){.x = between(&b, -4, 4),
                          .y = between(&b, 0, 6),
                          .angle = between(&b, -3, 3),
                          .vx = between(&b, -9, 9),
                          .vy = between(&b, -9, 9),
                          .spin = between(&b, -9, 9),
                          .friction = between(&b, 0, 1.5),
                          .elasticity = between(&b, 0, 1)};
        start[i + 1] = start[i];
        if (kind & 1)
            body->radius = length;
        else
            start[i + 1] += outline(&b, length, &vertices[2 * start[i]], &area, &moment);
        double density = pow(10, between(&b, -3, 3));
        body->mass = density * area, body->moment = density * moment;
        anchored[i] = (kind & 14) == 0;
        if (anchored[i]) body->vx = body->vy = body->spin = 0;
    }
    for (int32_t k = next(&b) % (MOST_JOINTS + 1); k > 0 && count > 1; k--) {
        int32_t a = next(&b) % count, c = next(&b) % (count + 1) - 1;
        if (a == c) continue;
        pairs[2 * joints] = a, pairs[2 * joints + 1] = c;
        points[2 * joints] = bodies[a].x + between(&b, -1, 1),
                   points[2 * joints + 1] = bodies[a].y + between(&b, -1, 1);
        joints++;
    }
    SimInput input = {.body_count = count,
                      .joint_count = joints,
                      .bodies = bodies,
                      .vertex_start = start,
                      .anchored = anchored,
                      .vertices = vertices,
                      .joint_bodies = pairs,
                      .joint_points = points,
                      .gravity = {between(&b, -3, 3), between(&b, -12, 0)}};
    SimOptions options = {.fps = 30, .sample_count = SAMPLES, .tolerance = pow(10, between(&b, -7, -2))};
    static double frames[SAMPLES * MOST_BODIES * 6], energy[SAMPLES * 3];
    Sim *sim = sim_create(&input);
    if (!sim) return 0;
    if (sim_run(sim, &options, frames, energy) != SIM_OK) {
        fprintf(stderr, "the run failed: %s\n", sim_error(sim));
        abort();
    }
    for (int32_t k = 0; k < SAMPLES * count * 6; k++)
        if (!isfinite(frames[k])) abort();
    sim_destroy(sim);
    return 0;
}

#ifdef SEEDS
int main(void) {
    uint64_t state = 88172645463325252u; /* xorshift, Marsaglia 2003 */
    for (int32_t seed = 0; seed < SEEDS; seed++) {
        uint8_t data[400];
        for (size_t k = 0; k < sizeof data; k++) {
            state ^= state << 13, state ^= state >> 7, state ^= state << 17;
            data[k] = (uint8_t)(state >> 32);
        }
        LLVMFuzzerTestOneInput(data, sizeof data);
    }
    printf("%d scenes ran\n", SEEDS);
    return 0;
}
#endif
