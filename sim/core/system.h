/* A group of bodies with the joints and contacts between them, and the rows of equations that those impose.
 *
 * A row is a velocity of two bodies against each other that a force can act along: two for a joint (x and y), two for
 * a contact (its normal, then along it).  With J the rows, M the masses and F what a unit of each row's force does, the
 * accelerations are a + M^-1 F' f, and the rows want J (a + M^-1 F' f) + bias = 0 (Featherstone, Rigid Body Dynamics
 * Algorithms, section 3.6).  F differs from J only where a contact slides: its friction is a part of its normal force.
 */
#ifndef SYSTEM_H
#define SYSTEM_H

#include "touch.h"

typedef struct Contact {
    Feature feature;
    double hold; /* the gap that is kept [m]: within the slack of 0 */
    Gap gap;     /* where the members are placed */
    double friction, elasticity;
    int slide;                 /* 0: sticks; +1, -1: slides along, against `along` */
    bool active;               /* presses: its normal row holds */
    double force, along_force; /* the last ones found [N] */
    int unsure;                /* bits of the ends of its mode that were past already when a step began */
    bool low;                  /* it lifts, but so little that it counts as held */
    double pull;               /* how its gap was being closed when an event came [m/s^2] */
} Contact;

typedef struct Row {
    int32_t member[2]; /* -1 for the background */
    double j[2][3];    /* velocity of the row for unit velocities of the members */
    double f[2][3];    /* force and torque on the members for a unit of the row's force */
    double bias;       /* what the row's acceleration has beside J times the accelerations */
} Row;

typedef struct System {
    const World *world;
    int32_t count, joint_count, contact_count, row_count;
    int32_t capacity, contact_capacity, row_capacity;
    int32_t *member;   /* world's bodies */
    int32_t *place_of; /* of every body of the world among the members, or -1 */
    State *state;      /* of the members */
    Placed *placed;
    int32_t *joint; /* world's joints */
    Contact *contact;
    Row *row; /* 2 a joint, then 2 a contact */
} System;

int system_create(System *system, const World *world);
void system_destroy(System *system);

void system_clear(System *system);
void system_add_body(System *system, int32_t body, const State *state);
int system_add_contact(System *system, const Contact *contact);
void system_find_joints(System *system); /* all those that hold a member */

/* The states as 6 numbers a member: position, angle, velocity, spin. */
void system_load(System *system, const double *numbers);
void system_store(const System *system, double *numbers);

/* Work out placed, the contacts' gaps and the rows from the states. */
int system_place(System *system);

const Placed *system_placed(const System *system,
                            int32_t body); /* of a body of the world; the background is no member */

double row_acceleration(const Row *row, const double *acceleration); /* J a + bias, of 3 numbers a member */
double row_speed(const Row *row, const State *state);                  /* J v */
void row_push(const System *system, const Row *row, double impulse);   /* v += M^-1 F' impulse */
double row_coupling(const System *system, const Row *i, const Row *j); /* J_i M^-1 F_j' */

static inline Row *joint_row(const System *s, int32_t k) { return &s->row[2 * k]; }
static inline Row *contact_row(const System *s, int32_t k) { return &s->row[2 * s->joint_count + 2 * k]; }

#endif
