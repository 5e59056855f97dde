/* What comes out of a run: samples of every input body, and events. */
#ifndef RECORD_H
#define RECORD_H

#include "motion.h"
#include "pair_index.h"

typedef struct Recorder {
    const World *world;
    double fps;
    int64_t sample_count;
    int64_t still;  /* from this sample on each is as the one before */
    double *frames; /* sample_count x sources x 6 */
    int64_t *next;  /* of every body: its first sample that is not written yet */
    bool *rested;   /* sources that were told to rest, and have neither been struck nor seen to move since */
    SimEvent *event;
    int64_t event_count, event_capacity;
    Index touching; /* by pair of sources, the lower first: 1 while in contact, as told */
} Recorder;

int recorder_create(Recorder *recorder, const World *world, const SimOptions *options, double *frames);
void recorder_destroy(Recorder *recorder);

/* Write a body's samples before `time` from its motion. */
void record_motion(Recorder *recorder, int32_t body, const Motion *motion, double time);

/* Nothing moves any more: write the samples from one on (not the first) as that before it. */
void record_still(Recorder *recorder, int64_t from);

/* Write the samples of a body up to and at `time` from its present state, if one is due. */
void record_state(Recorder *recorder, int32_t body, double time);

/* Events after the last sample are left out. */
/* A contact that begins where it was told to hold already is not told again, nor is an end of none: a pair may go from exact
 * motion to the crowd and back. */
int record_event(Recorder *recorder, const SimEvent *event);

/* Whether a contact of the two sources was told to begin, and not to end. */
bool record_touches(const Recorder *recorder, int32_t source_a, int32_t source_b);

/* Put the events in the order of time. */
void record_sort_events(Recorder *recorder);

#endif
