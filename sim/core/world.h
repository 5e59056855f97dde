/* The scene as the engine holds it: rigid bodies that carry shapes, and the joints between them.
 *
 * Body 0 is the background: every anchored body of the scene is one of its shapes.  Bodies that pins hold together
 * are merged into one.  A shape is an input body's outline in the frame of the body that carries it.
 */
#ifndef WORLD_H
#define WORLD_H

#include <stdbool.h>
#include <stdint.h>

#include "sim.h"
#include "vec.h"

typedef enum Mode {
    MODE_FIXED,  /* the background */
    MODE_REST,   /* does not move, and nothing pulls at it that its contacts do not hold */
    MODE_FLIGHT, /* touches nothing: a parabola and a constant spin */
    MODE_SMOOTH, /* joints and contacts hold: integrated */
    MODE_CROWD,  /* too many contacts for that: stepped */
} Mode;

typedef struct Body {
    Vec position; /* centre of mass */
    double angle;
    Vec velocity;
    double spin;
    double mass, moment;                 /* infinite for the background */
    double inverse_mass, inverse_moment; /* 0 for the background */
    double reach;                        /* radius about the centre of mass that holds all its shapes */
    int32_t first_shape, shape_count;    /* into World.shape */
    Mode mode;
} Body;

/* The side of an outline that starts at a vertex. */
typedef struct Side {
    Vec along;     /* unit */
    double length; /* [m] */
    bool reflex;   /* the outline turns inwards at the vertex: nothing convex can touch there */
} Side;

/* A disk that holds as many sides of an outline as follow its first vertex. */
typedef struct Stretch {
    Vec centre; /* in the body's frame */
    double reach;
} Stretch;

enum {
    STRETCH = 8,      /* sides */
    LONG_OUTLINE = 16 /* vertices: an outline of more is looked at by stretches first */
};

typedef struct Shape {
    int32_t body;                     /* that carries it */
    int32_t source;                   /* index among the input's bodies */
    Vec offset;                       /* of the source's centre of mass in the body's frame */
    double turned;                    /* the source's angle in the body's frame */
    double radius;                    /* > 0: a circle about vertex[first]; 0: a polygon */
    int32_t first, count;             /* into World.vertex: in the body's frame, counter-clockwise */
    int32_t first_piece, piece_count; /* into World.piece */
    Vec centre;                       /* of a disk that holds it, in the body's frame */
    double reach;                     /* that disk's radius */
    double friction, elasticity;
} Shape;

/* A convex piece of a shape, for what works on convex shapes only.  A circle is one piece of one vertex. */
typedef struct Piece {
    int32_t shape;
    int32_t first, count; /* into World.piece_vertex */
    double radius;
} Piece;

typedef struct Joint {
    int32_t a, b;         /* bodies */
    Vec local_a, local_b; /* the pivot in their frames */
} Joint;

typedef struct World {
    Vec gravity;
    int32_t body_count, shape_count, vertex_count, joint_count, piece_count, piece_vertex_count, source_count;
    Body *body;
    Shape *shape; /* grouped by body */
    Vec *vertex;
    Side *side;   /* of every vertex */
    Stretch *stretch; /* of every STRETCHth vertex of a shape, by vertex */
    Piece *piece; /* made by world_decompose */
    Vec *piece_vertex;
    int32_t *piece_corner; /* by piece vertex: which one of World.vertex it is */
    Joint *joint;          /* without those inside a merged body */
    int32_t *source_shape; /* the shape of each input body */
    uint64_t *apart;       /* sorted keys of the pairs of shapes that do not collide: joined, or let overlap */
    int32_t apart_count, apart_capacity;
    double size;     /* a length of the scene's order, for tolerances that scale with rounding [m] */
    double thinnest; /* width of the thinnest shape, about [m] */
    SimProfile profile;
    const char *error;
} World;

int world_create(World *world, const SimInput *input);
void world_destroy(World *world);

static inline Pose body_pose(const Body *body) { return pose(body->position, body->angle); }

/* Whether two shapes can touch: of different bodies, not joined, not both of the background. */
bool world_collides(const World *world, int32_t shape_a, int32_t shape_b);

/* Keep a pair of shapes from colliding. */
int world_keep_apart(World *world, int32_t shape_a, int32_t shape_b);

static inline double pair_friction(const Shape *a, const Shape *b) { return sqrt(a->friction * b->friction); }
static inline double pair_elasticity(const Shape *a, const Shape *b) {
    return a->elasticity > b->elasticity ? a->elasticity : b->elasticity;
}

/* Fill World.piece and World.piece_vertex, if they are not yet: every shape cut into convex pieces (decompose.c). */
int world_decompose(World *world);

/* Move bodies that overlap at the start apart by the least motion (separate.c). */
int world_separate(World *world, double tolerance);

#endif
