/* What is fitted to a closed chain of ink, and what its readings are made of. */
#ifndef SKETCH_CLOSED_H
#define SKETCH_CLOSED_H

#include "fit.h"

static const double CORNER = 4.0; /* nats to say a corner's coordinate, given those before: less than a free one */
static const double GAP = 4.0;    /* nats for each observation that an outline lacks */

/* Fits to a closed chain of ink, in its frame where not said otherwise. */
typedef struct {
    double mean[2], to[4], back[4]; /* the frame: normal = to * (pixel - mean), pixel = mean + back * normal */
    double ink, gap; /* lengths of the ink and of the gaps */
    double conic[5]; /* a, b, c, d, e of x² + y² = a(x² - y²) + 2bxy + cx + dy + e, */
    double conic_cost; /* and the nats to say the ink, given it */
    double circle[3]; /* centre and radius [pixels], */
    double circle_cost; /* and the nats to say the ink, given it */
    double residual[SIDES + 1]; /* mean squared distance of the best k-gon */
    double cost[SIDES + 1]; /* nats to say the ink, given it, with its bowed sides, flat corners and short sides */
    double lacks[SIDES + 1]; /* nats for what of it nobody drew */
    double vertices[SIDES + 1][2 * SIDES]; /* [pixels] */
    double extra; /* what the nearest rectangle adds to residual[4], infinite for none, */
    double rectangle[8]; /* and its corners [pixels] */
    double turned[SIDES + 1]; /* how much of the ink's turning is at the corners of the k-gon, of up to MOST sides */
    double is_ellipse; /* whether the conic is one that may have been meant: not 0, */
    double middle[2]; /* then its middle, */
    double axes[4]; /* and half axes as columns [pixels] */
    double missing; /* how much of something round is missing along it */
    double arced; /* nats to say an outline of sides and arcs, and the ink, given it; infinite for none */
} Closed;

#endif
