/* What comes out of a run: samples of every input body, and events. */
#ifndef RECORD_H
#define RECORD_H

#include "motion.h"

typedef struct Recorder {
    const World *world;
    double fps;
    int64_t sample_count;
    double *frames; /* sample_count x sources x 6 */
    int64_t *next;  /* of every body: its first sample that is not written yet */
    SimEvent *event;
    int64_t event_count, event_capacity;
} Recorder;

int recorder_create(Recorder *recorder, const World *world, const SimOptions *options, double *frames);
void recorder_destroy(Recorder *recorder);

/* Write a body's samples before `time` from its motion. */
void record_motion(Recorder *recorder, int32_t body, const Motion *motion, double time);

/* Write the samples of a body up to and at `time` from its present state, if one is due. */
void record_state(Recorder *recorder, int32_t body, double time);

/* Events after the last sample are left out. */
int record_event(Recorder *recorder, const SimEvent *event);

#endif
