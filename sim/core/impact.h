/* What contacts do at one moment: the impulses of impacts, and the forces that decide which contacts hold and how. */
#ifndef IMPACT_H
#define IMPACT_H

#include "system.h"

/* Work space, grown as needed. */
typedef struct ContactSolver {
    double *block;
    size_t size;
    int32_t *index;
    size_t index_size;
    double *rounds;
    size_t rounds_size; /* bytes */
} ContactSolver;

void contact_solver_destroy(ContactSolver *solver);

/* Resolve all impacts among the system's contacts: on return none approaches faster than slack.speed.
 * Restitution is each contact's `elasticity`.  impulse[k] sums up what contact k got, along its normal and along its
 * tangent; *count says how many impacts there were.  SIM_BAD_INPUT when the contacts admit no solution. */
int resolve_impacts(ContactSolver *solver, System *system, const Slack *slack, Vec *impulse, int32_t *count);

/* Where sliding contacts admit no forces (Painleve's paradox), the slightest approach brings an impulse that ends the
 * sliding (Brogliato, Nonsmooth Mechanics, section 5.5: impact without collision). Give that impulse. */
int resolve_shock(ContactSolver *solver, System *system, const Slack *slack);

/* Decide how each contact goes on from here, when nothing approaches: `active`, `slide` and the forces are set, and
 * acceleration (3 a member) is what follows.  Contacts that part or slip are told by their velocities, those at rest
 * by the forces.  SIM_BAD_INPUT when there is no solution. */
int find_modes(ContactSolver *solver, System *system, const Slack *slack, double *acceleration);

#endif
