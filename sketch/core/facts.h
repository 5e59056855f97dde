/* What is known of each piece of ink of a page, besides where it is. */
#ifndef SKETCH_FACTS_H
#define SKETCH_FACTS_H

#include "fit.h"
#include "scoring.h"

/* As of Piece of sketch/page/pieces.py. */
typedef struct {
    double observations; /* how many independent ones its ink is worth */
    double scale;        /* what its writer's precision goes with [pixels] */
    double extent;       /* [pixels] */
    double unread;       /* nats to say it freely */
    double gap, length;  /* between its ends, and along it [pixels] */
} Facts;

/* Nats to say where a piece's ink is, given lines that it is off by `mean_square` [pixels²], by a precision of `scale`. */
static inline double misfit_of(const Facts *piece, double mean_square, double scale) {
    scale = scale > 1e-9 ? scale : 1e-9;
    return misfit(mean_square / (scale * scale), piece->observations);
}

#endif
