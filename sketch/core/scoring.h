/* The scale on which readings are scored, as of sketch/scoring.py. */
#ifndef SKETCH_SCORING_H
#define SKETCH_SCORING_H

#include <math.h>

static const double TREMOR = 0.05; /* spread of ink about what was meant, as a share of its size */
static const double SLOPPY = 0.1;  /* nobody's ink is off by much more than this, as a share of the radius */
static const double PARAMETER = 4.0; /* nats to say one parameter to that precision */
static const double FREE = 4.0;      /* nats an observation to say ink freely, point by point */
static const double STRANGE = 35.0;  /* nats to say that something was drawn that has no meaning here */
static const double LINE = 11.0; /* observations in a straight line: what is less, a tap of the pen, surprises less */

/* Nats to say so many observations freely, of ink that has no meaning in something that has one. */
static inline double meaningless(double count) {
    return STRANGE * (count / LINE < 1 ? count / LINE : 1) + FREE * count;
}

/* Nats to say `count` observations, given a primitive that they are off by `mean_square` [shares of the radius]. */
static inline double misfit(double mean_square, double count) {
    return 0.5 * count * (log1p(mean_square / (TREMOR * TREMOR)) + mean_square / (SLOPPY * SLOPPY));
}

#endif
