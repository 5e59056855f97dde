/* Where two convex pieces touch, or are about to. */
#ifndef MANIFOLD_H
#define MANIFOLD_H

#include <stdbool.h>
#include <stdint.h>

#include "vec.h"

/* A convex piece in the scene's frame: a polygon, or one vertex with a radius. */
typedef struct Outline {
    const Vec *vertex; /* counter-clockwise */
    const Vec *normal; /* outward unit normal of the side that begins at the vertex */
    /* Of a piece cut from a larger shape, else NULL: by vertex, the normals of the shape's sides before and after it.
     * A side of the piece whose normal is not that after its first vertex is a cut: it touches nothing. */
    const Vec *arriving, *leaving;
    int32_t count;
    double radius;
} Outline;

typedef struct ManifoldPoint {
    Vec point; /* halfway between the two surfaces */
    double separation; /* along the normal; negative when they overlap */
} ManifoldPoint;

typedef struct Manifold {
    Vec normal; /* unit, from a to b */
    double gap; /* how far they are apart along the normal: never more than their distance; negative in overlap */
    int32_t count;
    int32_t side; /* whose side the normal stands on: 1 a's, -1 b's, 0 neither's: it is of corners or circles */
    ManifoldPoint point[2];
} Manifold;

/* The points of contact no farther apart than `margin`: none, one, or the two ends of the sides that face each other.
 * `gap` and `normal` are set in any case. */
void manifold_find(const Outline *a, const Outline *b, double margin, Manifold *manifold);

#endif
