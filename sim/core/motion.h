/* Motion in closed form: a body's pose and velocity as polynomials of time over a stretch.
 *
 * Free flight is a polynomial of degree 2, rest one of degree 0, and a step of the integrator one of degree 8, so that
 * whatever asks where a body is, or when two bodies touch, asks one kind of thing.
 */
#ifndef MOTION_H
#define MOTION_H

#include "world.h"

#define MOTION_DEGREE 8

/* Pose and velocity of a body at one time. */
typedef struct State {
    Vec p;
    double angle;
    Vec v;
    double spin;
} State;

typedef struct Motion {
    double start, end; /* [s]; end is INFINITY for flight and rest */
    double span;       /* the polynomials' argument is (t - start) / span */
    int degree;
    double speed;      /* at most, of a motion of degree above 2 [m/s] */
    double q[3][MOTION_DEGREE + 1]; /* x, y, angle */
    double v[3][MOTION_DEGREE + 1]; /* vx, vy, spin */
} Motion;

/* What a motion does at most from one time to another. */
typedef struct MotionBound {
    double spin, spin_acceleration, spin_jerk;
    Vec steady; /* the acceleration, where it is constant */
    bool is_steady;
} MotionBound;

State body_state(const Body *body);
void set_body_state(Body *body, const State *state);

Motion motion_at_rest(const State *state, double time);
Motion motion_in_flight(const State *state, double time, Vec gravity);

State motion_state(const Motion *motion, double time);
State motion_acceleration(const Motion *motion, double time); /* in v and spin */
Vec motion_position(const Motion *motion, double time);

/* The speed that a motion does not exceed within its span. */
double motion_fastest(const Motion *motion);

/* Where a body is and goes from some time on, as much of it as a first look at a pair asks. */
typedef struct Course {
    Vec position, velocity, fall; /* of rest and flight; fall: the acceleration */
    double speed, pull;           /* the sizes of the two */
    double stray; /* of other motions, which are taken to stay: how fast they leave the place at most [m/s] */
} Course;

Course motion_course(const Motion *motion, double from);

/* Whether two bodies are too far apart to meet in so long however they go. */
bool course_apart(const Course *a, const Course *b, double time, double reach);

/* No less than so near do two bodies' centres come in so long [m]; two that fall alike go straight past each other. */
double course_nearest(const Course *a, const Course *b, double time);
MotionBound motion_bound(const Motion *motion, double from, double to);

/* What two bodies' centres do at most as one sees them from the other: nothing, where they go alike. */
typedef struct RelativeBound {
    double speed, acceleration, jerk;
} RelativeBound;

RelativeBound motion_against(const Motion *a, const Motion *b, double from, double to);

#endif
