/* The scale on which readings are scored, as of sketch/scoring.py. */
#ifndef SKETCH_SCORING_H
#define SKETCH_SCORING_H

#include <math.h>

static const double TREMOR = 0.05; /* spread of ink about what was meant, as a share of its size */
static const double SLOPPY = 0.1;  /* nobody's ink is off by much more than this, as a share of the radius */

/* Nats to say `count` observations, given a primitive that they are off by `mean_square` [shares of the radius]. */
static inline double misfit(double mean_square, double count) {
    return 0.5 * count * (log1p(mean_square / (TREMOR * TREMOR)) + mean_square / (SLOPPY * SLOPPY));
}

#endif
