/* The public interface, and a run from its start to its end. */
#include <stdlib.h>
#include <string.h>

#include "crowd.h"
#include "exact.h"
#include "stopwatch.h"

struct Sim {
    World world;
    Exact exact;
    Recorder recorder;
    Crowd *crowd; /* made when the first body needs it */
    bool *entering;
    bool *joined; /* by body: it hangs on a joint */
    double *source_mass, *source_moment; /* of the inputs that move; 0 for those that do not */
};

int32_t sim_abi(void) { return SIM_ABI; }

size_t sim_struct_size(int32_t which) {
    const size_t sizes[] = {sizeof(SimBody), sizeof(SimInput), sizeof(SimOptions), sizeof(SimEvent),
                            sizeof(SimProfile)};
    return which >= 0 && which < 5 ? sizes[which] : 0;
}

Sim *sim_create(const SimInput *input) {
    Sim *sim = calloc(1, sizeof *sim);
    size_t n = (size_t)input->body_count;
    if (!sim) return NULL;
    sim->source_mass = malloc((n + 1) * sizeof(double));
    sim->source_moment = malloc((n + 1) * sizeof(double));
    sim->entering = calloc(n + 1, sizeof(bool));
    sim->joined = calloc(n + 1, sizeof(bool));
    if (!sim->source_mass || !sim->source_moment || !sim->entering || !sim->joined ||
        world_create(&sim->world, input) != SIM_OK) {
        sim_destroy(sim);
        return NULL;
    }
    for (int32_t j = 0; j < sim->world.joint_count; j++)
        sim->joined[sim->world.joint[j].a] = sim->joined[sim->world.joint[j].b] = true;
    for (size_t i = 0; i < n; i++) {
        bool moves = sim->world.shape[sim->world.source_shape[i]].body != 0;
        sim->source_mass[i] = moves ? input->bodies[i].mass : 0;
        sim->source_moment[i] = moves ? input->bodies[i].moment : 0;
    }
    return sim;
}

void sim_destroy(Sim *sim) {
    if (!sim) return;
    crowd_destroy(sim->crowd);
    exact_destroy(&sim->exact);
    recorder_destroy(&sim->recorder);
    world_destroy(&sim->world);
    free(sim->source_mass);
    free(sim->source_moment);
    free(sim->entering);
    free(sim->joined);
    free(sim);
}

const char *sim_error(const Sim *sim) { return sim->world.error ? sim->world.error : "out of memory"; }
int64_t sim_event_count(const Sim *sim) { return sim->recorder.event_count; }
void sim_profile(const Sim *sim, SimProfile *out) { *out = sim->world.profile; }

void sim_events(const Sim *sim, SimEvent *out) {
    for (int64_t k = 0; k < sim->recorder.event_count; k++) out[k] = sim->recorder.event[k];
}

/* ---------------------------------------------------------------- the crowd beside the rest */

#define FEW 16 /* bodies of a crowd that the exact way is asked for again */
#define FIRST_WAIT 0.1 /* before it is asked again [s]; doubled each time */

/* Its bodies, and those of them that hang on no joint. */
static int32_t crowd_size(const Sim *sim, int32_t *loose) {
    const World *world = &sim->world;
    int32_t count = 0;
    *loose = 0;
    for (int32_t i = 1; i < world->body_count; i++) {
        count += world->body[i].mode == MODE_CROWD;
        *loose += world->body[i].mode == MODE_CROWD && !sim->joined[i];
    }
    return count;
}

/* Whether a body comes near one of the crowd between two times. */
static bool meets_crowd(const Sim *sim, int32_t body, double from, double to) {
    const World *world = &sim->world;
    State a = exact_state(&sim->exact, body, from), b = exact_state(&sim->exact, body, to);
    double way = vlength(vsub(b.p, a.p)) + world->body[body].reach;
    for (int32_t j = 1; j < world->body_count; j++) {
        const Body *other = &world->body[j];
        if (other->mode != MODE_CROWD) continue;
        double near = way + other->reach + 2 * vlength(other->velocity) * (to - from) + 0.1 * other->reach;
        if (vlength(vsub(other->position, a.p)) <= near) return true;
    }
    return false;
}

/* Whether something in the crowd is about to rest: it is so slow that rolling resistance ends its motion (crowd_contact.c),
 * which the exact way, where a ball rolls for ever, does not know.  What hangs on joints swings on, and what lies on it with
 * it: then all has to be slow. */
static bool crowd_settles(const Sim *sim) {
    const World *world = &sim->world;
    bool any = false, all = true, swings = false;
    for (int32_t i = 1; i < world->body_count; i++) {
        if (world->body[i].mode != MODE_CROWD) continue;
        bool slow = crowd_is_slow(world, i);
        any = any || slow;
        all = all && slow;
        swings = swings || sim->joined[i];
    }
    return swings ? all : any;
}

/* Bodies that come near the crowd within a step belong to it, and so do those that come near these. */
static int absorb(Sim *sim, double from, double to) {
    World *world = &sim->world;
    for (bool any = true; any;) {
        any = false;
        for (int32_t i = 1; i < world->body_count; i++) {
            Mode mode = world->body[i].mode;
            if ((mode != MODE_FLIGHT && mode != MODE_SMOOTH) || !meets_crowd(sim, i, from, to)) continue;
            int status = exact_hand_over(&sim->exact, i, from);
            if (status != SIM_OK) return status;
            any = true;
        }
    }
    return SIM_OK;
}

/* Step the crowd from `from` to `to`, but not the bodies that entered it at `to`. */
static int step_crowd(Sim *sim, double from, double to, double tolerance) {
    World *world = &sim->world;
    if (!sim->crowd) {
        int status = world->piece ? SIM_OK : world_decompose(world);
        if (status != SIM_OK) return status;
        if (!(sim->crowd = crowd_create(world, &sim->recorder))) return SIM_OUT_OF_MEMORY;
    }
    for (int32_t i = 1; i < world->body_count; i++)
        if (sim->entering[i]) world->body[i].mode = MODE_SMOOTH;
    double start = seconds_now();
    int status = crowd_step(sim->crowd, world, from, to, tolerance);
    world->profile.crowd_time += seconds_now() - start;
    for (int32_t i = 1; i < world->body_count && status == SIM_OK; i++)
        if (sim->entering[i])
            world->body[i].mode = MODE_CROWD;
        else
            status = exact_after_crowd(&sim->exact, i, from, to);
    return status;
}

/* The end of the crowd's step that starts at `time`: steps end at every sample, and 60 times a second at least. */
static double step_end(const SimOptions *options, double time) {
    double parts = ceil(60 / options->fps), rate = options->fps * parts; /* steps a sample, and a second */
    double next = floor(time * rate * (1 + 1e-12) + 1e-6) + 1, samples = floor(next / parts);
    return samples * parts == next ? samples / options->fps : next / rate;
}

/* One step of the crowd, with what is beside it. */
static int advance_crowd(Sim *sim, const SimOptions *options, double *time) {
    World *world = &sim->world;
    double next = step_end(options, *time), reached;
    int status = absorb(sim, *time, next);
    for (int32_t i = 1; i < world->body_count; i++) sim->entering[i] = world->body[i].mode != MODE_CROWD;
    if (status == SIM_OK) status = exact_run(&sim->exact, *time, next, &reached);
    if (status != SIM_OK) return status;
    for (int32_t i = 1; i < world->body_count; i++)
        sim->entering[i] = sim->entering[i] && world->body[i].mode == MODE_CROWD;
    if (reached > *time) status = step_crowd(sim, *time, reached, options->tolerance);
    *time = reached;
    return status;
}

static int advance(Sim *sim, const SimOptions *options, double end) {
    double time = 0, wait = FIRST_WAIT, again = INFINITY;
    /* loose bodies that the crowd has had since it was last empty: what is left of a pile ends in it */
    int32_t most = 0;
    int status = exact_start(&sim->exact, 0);
    while (status == SIM_OK && time <= end) { /* what happens at the last sample's time belongs to it */
        int32_t loose, crowd = crowd_size(sim, &loose);
        most = crowd == 0 ? 0 : loose > most ? loose : most;
        if (crowd == 0) {
            status = exact_run(&sim->exact, time, nextafter(end, INFINITY), &time);
            again = time + wait;
        } else if (crowd <= FEW && most <= FEW && time >= again && !crowd_settles(sim)) {
            status = exact_take_back(&sim->exact, time);
            wait *= 2;
            again = time + wait;
        } else {
            status = advance_crowd(sim, options, &time);
        }
    }
    if (status == SIM_OK) exact_finish(&sim->exact);
    return status;
}

/* ---------------------------------------------------------------- the run */

/* Kinetic and potential energy of every sample [J]; potential is 0 at the scene's origin. Returns whether all is finite. */
static bool find_energy(const Sim *sim, int64_t samples, const double *frames, double *energy) {
    const World *world = &sim->world;
    double broken = 0; /* what is finite adds nothing to it */
    for (int64_t k = 0; k < samples; k++) {
        double kinetic = 0, potential = 0;
        if (k >= sim->recorder.still) {
            memcpy(energy + 3 * k, energy + 3 * (k - 1), 3 * sizeof *energy);
            continue;
        }
        for (int32_t i = 0; i < world->source_count; i++, frames += 6) {
            double m = sim->source_mass[i], speed = frames[3] * frames[3] + frames[4] * frames[4];
            kinetic += 0.5 * (m * speed + sim->source_moment[i] * frames[5] * frames[5]);
            potential -= m * (world->gravity.x * frames[0] + world->gravity.y * frames[1]);
            broken += (frames[0] - frames[0]) + (frames[1] - frames[1]) + (frames[2] - frames[2]);
        }
        energy[3 * k] = kinetic;
        energy[3 * k + 1] = potential;
        energy[3 * k + 2] = kinetic + potential;
    }
    return broken == 0;
}

#define LOOKED_AT_ALL 64 /* bodies, pair by pair */

/* Whether something may have been drawn overlapping: few bodies are looked at, of many it is taken to be so. */
static bool may_overlap(const World *world) {
    if (world->body_count > LOOKED_AT_ALL) return true;
    for (int32_t i = 1; i < world->body_count; i++)
        for (int32_t j = 0; j < i; j++)
            if (!surely_apart(world, i, j, 1e-10 * world->size)) return true;
    return false;
}

int32_t sim_run(Sim *sim, const SimOptions *options, double *frames, double *energy) {
    World *world = &sim->world;
    double start = seconds_now(), end = (double)(options->sample_count - 1) / options->fps;
    int status = SIM_OK;
    if (may_overlap(world)) status = world_decompose(world);
    if (status == SIM_OK && world->piece) status = world_separate(world, options->tolerance);
    double separated = seconds_now();
    if (status == SIM_OK) status = recorder_create(&sim->recorder, world, options, frames);
    if (status == SIM_OK) status = exact_create(&sim->exact, world, &sim->recorder, options->tolerance);
    if (status == SIM_OK) status = advance(sim, options, end);
    record_sort_events(&sim->recorder);
    if (status == SIM_OK && !find_energy(sim, options->sample_count, frames, energy)) status = SIM_NOT_FINITE;
    world->profile.separate_time = separated - start;
    world->profile.smooth_evals = sim->exact.smooth.evals;
    world->profile.rows = sim->exact.smooth.rows;
    world->profile.total_time = seconds_now() - start;
    if (status == SIM_NOT_FINITE) world->error = "the motion went beyond the range of numbers";
    return status;
}
