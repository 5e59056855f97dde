/* What arrows have in common with what is drawn over them once more. */
#ifndef SKETCH_MARK_H
#define SKETCH_MARK_H

#include "facts.h"

static const double HEAD = 2.0;   /* nats an observation to say ink freely, where it lies within an arrow's head */
static const double SMALL = 0.6;  /* of the shaft: what is smaller may be part of a head */
static const double STRAY = 0.08; /* of a mark's extent: how far beyond it ink may be that belongs to it */

/* Whether a piece, `name`, lies within an arrow's head, given its tip and the ends of its barbs [pixels]. A wide loop does
 * not: a barb that was gone over is a thin one, and a wheel is no part of a head. */
int is_within_head(const double *samples, const Facts *piece, int32_t name, const double head[6]);

#endif
