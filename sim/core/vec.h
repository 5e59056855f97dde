/* Vectors and poses in the plane. */
#ifndef VEC_H
#define VEC_H

#include <math.h>

#include "angle.h"

typedef struct Vec {
    double x, y;
} Vec;

/* A pose: p = position + rotation (c, s) of the local point. */
typedef struct Pose {
    Vec p;
    double c, s;
} Pose;

static inline Vec vec(double x, double y) { return (Vec){x, y}; }
static inline Vec vadd(Vec a, Vec b) { return vec(a.x + b.x, a.y + b.y); }
static inline Vec vsub(Vec a, Vec b) { return vec(a.x - b.x, a.y - b.y); }
static inline Vec vscale(Vec a, double k) { return vec(a.x * k, a.y * k); }
static inline Vec vmad(Vec a, double k, Vec b) { return vec(a.x + k * b.x, a.y + k * b.y); }
static inline double vdot(Vec a, Vec b) { return a.x * b.x + a.y * b.y; }
static inline double vcross(Vec a, Vec b) { return a.x * b.y - a.y * b.x; }
static inline double vlength(Vec a) { return sqrt(a.x * a.x + a.y * a.y); }

/* a turned by a quarter: the velocity of a point at a under unit spin */
static inline Vec vperp(Vec a) { return vec(-a.y, a.x); }

static inline Pose pose(Vec p, double angle) {
    Pose t = {.p = p};
    angle_sincos(angle, &t.s, &t.c);
    return t;
}
static inline Vec turn(Pose t, Vec a) { return vec(t.c * a.x - t.s * a.y, t.s * a.x + t.c * a.y); }
static inline Vec unturn(Pose t, Vec a) { return vec(t.c * a.x + t.s * a.y, -t.s * a.x + t.c * a.y); }
static inline Vec place(Pose t, Vec a) { return vadd(t.p, turn(t, a)); }
static inline Vec unplace(Pose t, Vec a) { return unturn(t, vsub(a, t.p)); }

#endif
