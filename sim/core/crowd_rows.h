/* The rows that a crowd's substep solves for: contact points between moving bodies. */
#ifndef ROWS_H
#define ROWS_H

#include <stdbool.h>
#include <stdint.h>

#include "vec.h"

/* What the rows read and write of a body; the background's inverse masses are 0, so that writing to it does nothing. */
typedef struct Mover {
    Vec velocity;
    double spin;
    Vec moved;     /* since the frame began */
    double turned;
    double inverse_mass, inverse_moment;
} Mover;

/* A number for each of a contact's two points, reckoned with lane by lane (an extension that gcc and clang share). */
typedef double Two __attribute__((vector_size(16), aligned(8)));

/* What the passes read comes first: it is what the cache holds.  The points of a contact lie on one line, along which they
 * slide as one: a single row of friction does for both.  Where there is but one point the second's numbers are 0. */
typedef struct Contact {
    int32_t a, b; /* movers */
    int32_t count;
    int32_t side; /* the normal turns with: 1 a, -1 b, 0 neither */
    Vec normal;   /* from a to b */
    double inverse_mass_a, inverse_mass_b, inverse_moment_a, inverse_moment_b;
    Two spin_na, spin_nb;      /* r x n of either body: the lever of the normal */
    Two mass_n, mobility;      /* effective mass, and 1 / it */
    Two impulse_n;             /* of one substep, kept for warm starting */
    Two limit; /* the fastest that the two may approach in the substep, less than 0: at a gap, not to pass it */
    double coupling; /* of the two points: how a push at one moves the other [1/kg] */
    double pair_mass; /* 1 / determinant of their 2 x 2 matrix; 0: too close together to be solved as a pair */
    double fine; /* of a substep: a way too short to matter [m] */
    double spin_ta, spin_tb; /* r x t */
    double mass_t, impulse_t;
    double friction;
    double rolling; /* lever of the rolling resistance [m]; 0: none */
    double twist_mass; /* 1 / the sum of the inverse moments, where there is rolling resistance */
    double elasticity;
    double slack; /* how far the pair may shift before its points are found anew [m] */
    double slop; /* overlap that is left alone, so that resting contacts do not come and go [m] */
    Two separation; /* when the frame began */
    Two along_na, along_nb; /* r . n of the corner or centre that touches, for the second order of turning */
    Two approach; /* normal velocity before the touch, for restitution; 0 when none is due */
    double turned; /* of b against a when the points were found, in this frame */
    Vec moved; /* likewise */
    uint64_t key; /* the pieces */
    bool touching; /* as has been told (crowd_events.c) */
} Contact;

static inline bool contact_presses(const Contact *c) { return c->impulse_n[0] > 0 || c->impulse_n[1] > 0; }

/* How far apart the two surfaces are now, at each point. */
Two contact_separation(const Contact *contact, const Mover *a, const Mover *b);

/* Before contacts that are new are solved: how fast their points may approach where the bodies are now. */
void contacts_limit(Contact *contact, int32_t count, const Mover *mover, double dt);

/* Once for each contact of a substep, before it is solved: the impulses of the substep before, and how fast points that are
 * about to touch approach.  Whether any does faster than the threshold, and is to bounce. */
void contacts_warm_start(Contact *contact, int32_t count, Mover *mover);
bool contacts_measure(Contact *contact, int32_t count, const Mover *mover, double threshold);

/* One pass.  heat: by mover, the last pass that changed it noticeably; a pass other than the first of a substep goes only
 * to contacts of bodies that the pass before it heated.  Whether this pass heated any. */
bool contacts_solve(Contact *contact, int32_t count, Mover *mover, double dt, int64_t *heat, int64_t pass, bool first);

/* At the velocities that were found bodies may turn so fast that gaps close by the second order of it: then they may approach
 * less fast.  Whether that changed anything; the bodies are hot. */
bool contacts_foresee(Contact *contact, int32_t count, const Mover *mover, double dt, int64_t *heat, int64_t pass);

/* Take a share of the overlaps out of the positions, and set the limits of the next substep. */
void contacts_part(Contact *contact, int32_t count, Mover *mover, double dt);
void contacts_bounce(Contact *contact, int32_t count, Mover *mover);

#endif
