/* The whole public interface of the impulse engine: a scene in, sampled poses out.
 *
 *     Sim *sim = sim_create(&input);
 *     if (sim_run(sim, &options, frames, energy) != SIM_OK) puts(sim_error(sim));
 *     sim_profile(sim, &profile);
 *     sim_destroy(sim);
 *
 * SI units, y up, angles counter-clockwise in radians.  Nothing is global: runs in several threads do not meet.
 */
#ifndef SIM_H
#define SIM_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#define SIM_API __declspec(dllexport)
#else
#define SIM_API __attribute__((visibility("default")))
#endif

#define SIM_ABI 3 /* goes up with any change below; the caller compares it and sim_struct_size() */

enum { SIM_OK = 0, SIM_OUT_OF_MEMORY = 1, SIM_BAD_INPUT = 2, SIM_NOT_FINITE = 3 };

typedef struct SimBody {
    double x, y, angle;  /* pose of the centre of mass [m, rad] */
    double vx, vy, spin; /* [m/s, rad/s] */
    double mass, moment; /* [kg, kg m^2] */
    double friction, elasticity;
    double radius; /* of a circle [m]; 0 for a polygon */
} SimBody;

typedef struct SimInput {
    int32_t body_count, joint_count;
    const SimBody *bodies;
    const int32_t *vertex_start; /* body_count + 1: body i has vertices [start[i], start[i+1]); a circle none */
    const int32_t *anchored;     /* body_count, 0 or 1 */
    const double *vertices;      /* x, y in the body's frame [m], either way round */
    const int32_t *joint_bodies; /* two a joint; -1 is the background */
    const double *joint_points;  /* x, y of each pivot in the scene's frame [m] */
    double gravity[2];           /* [m/s^2] */
} SimInput;

typedef struct SimOptions {
    double fps;           /* samples are at k / fps [1/s] */
    int64_t sample_count; /* k = 0 ... sample_count - 1 */
    double tolerance;     /* the error asked for [m] */
} SimOptions;

typedef struct SimEvent {
    double time;
    int32_t kind;    /* SIM_IMPACT ... */
    int32_t body[2]; /* indices of the input's bodies; -1 for none */
    int32_t reserved;
    double point[2];   /* [m] */
    double impulse[2]; /* on body[1] [N s] */
} SimEvent;

enum { SIM_IMPACT = 0, SIM_CONTACT_BEGUN = 1, SIM_CONTACT_ENDED = 2, SIM_REST = 3 };

/* What a run did: a scene that does not need a stage shows zeros there. Times in seconds. */
typedef struct SimProfile {
    double total_time;
    double separate_time;  /* moving apart what was drawn overlapping */
    double search_time;    /* first touches */
    double impact_time;    /* impacts, and how contacts go on */
    double smooth_time;    /* integrating */
    double crowd_time;     /* stepping the crowd */
    double flights;        /* stretches of free flight */
    double events;         /* times at which something changed */
    double impacts;        /* impacts, several at one time counted once */
    double smooth_steps;   /* accepted steps of the integrator */
    double smooth_evals;   /* accelerations solved for */
    double crowd_steps;    /* substeps of the crowd */
    double crowd_contacts; /* contact points solved, summed over substeps */
    double pairs;          /* pairs of bodies looked at closely */
    double rows;           /* constraint rows solved for in smooth motion, summed */
    double rests;          /* islands put to rest */
    double separated;      /* bodies moved apart before the start */
    double separation;     /* the farthest that one was moved [m] */
    double let_overlap;    /* pairs too deep in one another at the start: they do not collide */
    double budget_spent;   /* islands handed to the crowd because their events came too fast */
} SimProfile;

typedef struct Sim Sim;

SIM_API int32_t sim_abi(void);
SIM_API size_t sim_struct_size(int32_t which); /* 0 SimBody, 1 SimInput, 2 SimOptions, 3 SimEvent, 4 SimProfile */

/* NULL when out of memory. The input is copied. */
SIM_API Sim *sim_create(const SimInput *input);

/* frames: sample_count x body_count x 6 doubles (x, y, angle, vx, vy, spin); energy: sample_count x 3 (kinetic,
 * potential, sum). Returns SIM_OK or the kind of failure, which sim_error() describes. */
SIM_API int32_t sim_run(Sim *sim, const SimOptions *options, double *frames, double *energy);

SIM_API const char *sim_error(const Sim *sim);
SIM_API int64_t sim_event_count(const Sim *sim);
SIM_API void sim_events(const Sim *sim, SimEvent *out); /* sim_event_count of them */
SIM_API void sim_profile(const Sim *sim, SimProfile *out);
SIM_API void sim_destroy(Sim *sim);

/* Cut a simple polygon (x, y of count vertices, counter-clockwise) into convex pieces: piece k has the vertices
 * index[piece_start[k]] ... index[piece_start[k + 1] - 1].  Room: count + 1 and 3 count. Returns how many; -1 when out
 * of memory. */
SIM_API int32_t sim_decompose(const double *vertices, int32_t count, int32_t *piece_start, int32_t *index);

#endif
