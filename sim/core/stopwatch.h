/* Time spent in the stages of a run. */
#ifndef STOPWATCH_H
#define STOPWATCH_H

#include <time.h>

/* Wall time [s]. */
static inline double seconds_now(void) {
    struct timespec t;
    timespec_get(&t, TIME_UTC);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
