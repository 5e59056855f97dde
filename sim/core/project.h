/* Back onto the constraints: what integrating and touching leave of errors in positions and velocities. */
#ifndef PROJECT_H
#define PROJECT_H

#include "smooth.h"

/* Take the states of a system that smooth_prepare has seen onto its constraints: positions, then velocities. *left becomes
 * the largest speed against a row that is left over: nearly contradictory rows, as of a jammed wedge, cannot all be met. */
int project(Smooth *smooth, System *system, double *left);
int project_velocities(Smooth *smooth, System *system);

#endif
