/* What the round readings of a closed outline and its polygons have in common. */
#ifndef SKETCH_OUTLINE_H
#define SKETCH_OUTLINE_H

#include "fit.h"

static const double PI = 3.14159265358979323846;
static const double TREMOR = 0.045; /* spread of ink about what was meant, in the frame: a share of the radius */
static const double SLOPPY = 0.1;   /* nobody's ink is off by much more than this */

static const double STIFFNESS =
    0.6; /* (tremor / bow)², while lines are fitted: how much rather a side trembles than bows */

/* Where the pen was lifted on the way around: which sample is the first behind, where the ink ends and goes on, and what is
 * missing of it at least. */
typedef struct {
    int next;
    double end[2], begin[2], gap;
} Lift;

/* A closed chain of ink in its frame, and how its distances from a reading count. */
typedef struct {
    const double *factor; /* of each sample, by its part's own size; twice over, as of Runs */
    double cap2; /* squared distances count up to this */
    double length; /* of the ink */
    double observations; /* independent ones, that it is worth */
    double side; /* nats to say one more side */
    const Lift *lifts; /* one behind each part, in order; the last one closes it */
    int lift_count;
    double gaps; /* what is missing of it at least, */
    double undrawn; /* nats for each length of a reading's outline where no ink is */
    double round; /* nats to say it as something round */
    double longer; /* how many times as long as wide it is */
    double hopeless; /* a first split that costs more [nats] is not looked into further */
} Ink;

/* A polygon over the ink's samples: its sides are the runs bounded by `cut`, counted from `start`; corner q is where side q
 * begins. One side, `bridge`, may have no samples: nobody drew it, it goes straight from where the ink ends to where it goes
 * on. Of outlines that are drawn long `stretch` says how much so. */
typedef struct {
    const Runs *runs;
    double stretch[2];
    int k, start, cut[SIDES + 1];
    int bridge; /* the side that was not drawn, or -1, */
    const Lift *lift; /* and where that is; without one, where it would save most, */
    double saving; /* and how much of what is undrawn */
    Line side[SIDES];
    double cost, square; /* nats to say the ink, given it, and the mean squared distance */
    double undrawn; /* of those, for what of it nobody drew */
    double arced; /* likewise of both, if sides that bow far were meant to; infinite where none does */
} Polygon;

/* Nats to say the ink's distances from an outline: Student's t for the tremor, unknown but about TREMOR, and a normal prior
 * on how careless people are. */
static inline double misfit(double mean_square, double observations) {
    return 0.5 * observations * (log1p(mean_square / (TREMOR * TREMOR)) + mean_square / (SLOPPY * SLOPPY));
}

/* Nats to say that ink runs along the outline more often than once. */
static inline double retraced(const Ink *ink, double perimeter) {
    return RETRACE * ink->observations * fmax(1 - perimeter / fmax(ink->length, 1e-9), 0);
}

/* The best polygons of 3 .. SIDES sides over samples in their frame; of cost infinite where there is none. They keep
 * `square` and `longer`, which hold the samples as they are and, where `stretch` is not 1, drawn longer.
 * Out: arced: nats to say the best outline of sides and arcs, and the ink, given it; infinite for none. */
void best_polygons(const Ink *ink, Runs *square, Runs *longer, double stretch, Polygon best[SIDES + 1], double *arced);

/* A polygon's corners, (k, 2), in the frame. */
void polygon_corners(const Polygon *p, double *corners);

#endif
