/* A fuzz target: any bytes are a scene, and the scene is run.
 *
 * libFuzzer:  clang -g -O1 -fsanitize=fuzzer,address,undefined -DLIBFUZZER tests/sim/fuzz.c sim/core/[a-z]*.c -lm
 * AFL++:      afl-clang-fast -g -O1 -fsanitize=address,undefined tests/sim/fuzz.c sim/core/[a-z]*.c -lm -o fuzz
 *             afl-fuzz -i seeds -o found -- ./fuzz @@
 * Alone:      ./fuzz --random COUNT SEED    runs so many scenes of random bytes, and mutations of them
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../sim/core/sim.h"

enum { MOST_BODIES = 12, MOST_VERTICES = 10, MOST_JOINTS = 8 };

typedef struct Bytes {
    const uint8_t *at;
    size_t left;
} Bytes;

static uint8_t byte(Bytes *b) {
    if (b->left == 0) return 0;
    b->left--;
    return *b->at++;
}

/* Mostly tame, on a grid so that things touch and line up; now and then of any size. */
static double number(Bytes *b, double scale) {
    uint8_t kind = byte(b), fine = byte(b);
    double coarse = (int8_t)byte(b);
    if (kind < 160) return scale * coarse / 16;
    if (kind < 240) return scale * (coarse + fine / 256.0) / 16;
    return scale * ldexp(coarse, fine % 24 - 16);
}

static double size(Bytes *b) { return fmax(fabs(number(b, 1)), 1e-6); }

typedef struct Scene {
    SimInput input;
    SimBody body[MOST_BODIES];
    int32_t vertex_start[MOST_BODIES + 1], anchored[MOST_BODIES], joint_bodies[2 * MOST_JOINTS];
    double vertices[2 * MOST_BODIES * MOST_VERTICES], joint_points[2 * MOST_JOINTS];
} Scene;

/* A star-shaped outline is simple whatever its radii. */
static int32_t outline(Bytes *b, double *v) {
    int32_t count = 3 + byte(b) % (MOST_VERTICES - 2);
    double width = size(b), height = size(b);
    for (int32_t k = 0; k < count; k++) {
        double angle = 2 * 3.14159265358979323846 * k / count, radius = (1 + byte(b)) / 256.0;
        v[2 * k] = width * radius * cos(angle);
        v[2 * k + 1] = height * radius * sin(angle);
    }
    return count;
}

static void read_scene(Bytes *b, Scene *s) {
    memset(s, 0, sizeof *s);
    int32_t bodies = byte(b) % (MOST_BODIES + 1), joints = bodies ? byte(b) % (MOST_JOINTS + 1) : 0, vertices = 0;
    for (int32_t i = 0; i < bodies; i++) {
        SimBody *body = &s->body[i];
        uint8_t kind = byte(b);
        s->anchored[i] = kind % 5 == 0;
        *body = (SimBody){.x = number(b, 1),
                          .y = number(b, 1),
                          .angle = number(b, 1),
                          .mass = size(b),
                          .moment = size(b),
                          .friction = fabs(number(b, 0.1)),
                          .elasticity = (byte(b) % 5) / 4.0};
        if (!s->anchored[i]) body->vx = number(b, 2), body->vy = number(b, 2), body->spin = number(b, 2);
        if (kind & 64)
            body->radius = size(b);
        else
            vertices += outline(b, &s->vertices[2 * vertices]);
        s->vertex_start[i + 1] = vertices;
    }
    for (int32_t j = 0; j < joints; j++) {
        int32_t a = byte(b) % (bodies + 1) - 1, c = byte(b) % bodies;
        s->joint_bodies[2 * j] = a == c ? -1 : a;
        s->joint_bodies[2 * j + 1] = c;
        s->joint_points[2 * j] = number(b, 1);
        s->joint_points[2 * j + 1] = number(b, 1);
    }
    s->input = (SimInput){bodies,          joints,          s->body,
                          s->vertex_start, s->anchored,     s->vertices,
                          s->joint_bodies, s->joint_points, {number(b, 1), number(b, 1)}};
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t length);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t length) {
    Bytes bytes = {data, length};
    Scene scene;
    read_scene(&bytes, &scene);
    SimOptions options = {30, 31, 1e-4};
    size_t values = 31 * (size_t)scene.input.body_count;
    double *frames = malloc((6 * values + 1) * sizeof *frames), *energy = malloc(93 * sizeof *energy);
    Sim *sim = sim_create(&scene.input);
    int status = sim && frames && energy ? sim_run(sim, &options, frames, energy) : SIM_OUT_OF_MEMORY;
    for (size_t k = 0; status == SIM_OK && k < 6 * values; k++)
        if (!isfinite(frames[k])) abort(); /* a run that is well holds numbers alone */
    if (sim) {
        size_t events = (size_t)sim_event_count(sim);
        SimEvent *event = malloc((events + 1) * sizeof *event);
        SimProfile profile;
        if (event) sim_events(sim, event);
        sim_profile(sim, &profile);
        free(event);
    }
    sim_destroy(sim);
    free(frames);
    free(energy);
    return 0;
}

#ifndef LIBFUZZER

static uint32_t random_state;

static uint32_t next_random(void) { /* xorshift, Marsaglia 2003 */
    random_state ^= random_state << 13;
    random_state ^= random_state >> 17;
    random_state ^= random_state << 5;
    return random_state;
}

static void run_random(long count, uint32_t seed) {
    uint8_t data[640];
    for (long k = 0; k < count; k++) {
        random_state = seed + 0x9e3779b9u * (uint32_t)(k / 8 + 1);
        if (random_state == 0) random_state = 1;
        for (size_t i = 0; i < sizeof data; i++) data[i] = (uint8_t)(next_random() >> 8);
        for (long m = 0; m < 4 * (k % 8); m++) data[next_random() % sizeof data] = (uint8_t)(next_random() >> 8);
        LLVMFuzzerTestOneInput(data, sizeof data);
    }
}

int main(int argc, char **argv) {
    if (argc == 4 && strcmp(argv[1], "--random") == 0) {
        run_random(atol(argv[2]), (uint32_t)strtoul(argv[3], NULL, 10));
        return 0;
    }
    for (int i = 1; i < argc; i++) {
        static uint8_t data[1 << 16];
        FILE *file = fopen(argv[i], "rb");
        if (!file) return 1;
        size_t length = fread(data, 1, sizeof data, file);
        fclose(file);
        LLVMFuzzerTestOneInput(data, length);
    }
    return 0;
}

#endif
