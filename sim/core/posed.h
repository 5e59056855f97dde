/* The convex pieces of a world's shapes where their bodies are. */
#ifndef POSED_H
#define POSED_H

#include "broad.h"
#include "manifold.h"
#include "world.h"

typedef struct Posed {
    Outline *outline;    /* by piece */
    double *swing;       /* by piece: how far it reaches from the body's centre of mass, for what turning moves */
    Vec *local_normal, *local_arriving, *local_leaving; /* by piece vertex, in the body's frame */
    Vec *vertex, *normal, *arriving, *leaving;          /* the same in the scene's */
} Posed;

int posed_create(Posed *posed, const World *world);
void posed_destroy(Posed *posed);

/* Bring the pieces of a body to a pose. */
void posed_place(Posed *posed, const World *world, int32_t body, Pose at);

Box posed_box(const Posed *posed, int32_t piece);

#endif
