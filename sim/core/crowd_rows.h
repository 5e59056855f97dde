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

/* Of each lane all bits or none, as comparisons give it. */
typedef long long Mask __attribute__((vector_size(16)));

/* How a contact's normal rows are solved. */
typedef enum Kind {
    KIND_OPEN,  /* it has no points now */
    KIND_ONE,   /* one point */
    KIND_PAIR,  /* both points at once */
    KIND_TURNS, /* both points in turn: they are too close together for their matrix */
} Kind;

/* What every pass asks of a contact, apart from what it solves it by: few cache lines hold it for all of them. */
typedef struct Ends {
    int32_t a, b; /* movers */
    uint8_t kind;
    bool moves_a, moves_b; /* the two have finite masses */
    bool uneven;           /* and very different ones */
    bool between;          /* others press on both of them: on each body that moves there is another contact */
} Ends;

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
    Two cross; /* how a push along the normal moves the contact along itself [1/kg] */
    double spin_ta, spin_tb; /* r x t */
    double mass_t, impulse_t;
    double friction;
    double rolling; /* lever of the rolling resistance [m]; 0: none */
    double twist_mass; /* 1 / the sum of the inverse moments, where there is rolling resistance; else 0 */
    Two separation; /* when the frame began */
    /* The second order of how the gaps change: of the squares of the turns of a and b, of their product, and of each times
     * the way along the side (crowd_gap.c). */
    Two bend_aa, bend_bb, bend_ab;
    double slide_a, slide_b;
    double slop; /* overlap that is left alone, so that resting contacts do not come and go [m] */
    double slack; /* how far the pair may shift before its points are found anew [m] */
    double turns_a, turns_b; /* 1; 0 of what is round: it touches where it did however it turns */
    double turned; /* of b against a when the points were found, in this frame, as far as it matters */
    Vec moved; /* likewise */
    double elasticity;
    uint64_t key; /* the pieces */
    bool lightens; /* the heavier body counts as much lighter (crowd_weigh.c) */
    bool touching; /* as has been told (crowd_events.c) */
} Contact;

/* A contact whose points are about to touch so fast that they are to bounce. */
typedef struct Bounce {
    int32_t contact;
    Two approach; /* normal velocities before the touch; 0 where none is due */
} Bounce;

typedef struct Rows {
    Contact *contact;
    Ends *ends; /* of each contact */
    int32_t count, capacity;
    bool *hot, *was; /* by mover: something changed it noticeably in this pass or since the last, and before */
    bool *whirls; /* by mover: it turns fast; of what does not take part in the frame it is false */
    int32_t mover_count;
    int32_t *contacts; /* by mover: how many it has */
    Mover *before; /* the movers as they were noted */
    int32_t *list; /* of contacts, to be gone through */
    int32_t *stale; /* contacts whose bodies have turned or shifted a good deal since their points were found */
    int32_t stale_count;
    Bounce *bounce;
    int32_t bounce_count;
} Rows;

int rows_create(Rows *rows, int32_t mover_count);

/* Room for so many contacts. SIM_OK or SIM_OUT_OF_MEMORY. */
int rows_room(Rows *rows, int32_t count);
void rows_destroy(Rows *rows);

/* A body that can move is hot: its contacts are to be solved again. */
static inline void rows_heat(Rows *rows, const Mover *mover, int32_t body, bool noticed) {
    rows->hot[body] |= noticed & (mover[body].inverse_mass > 0);
}

static inline bool contact_presses(const Contact *c) { return c->impulse_n[0] > 0 || c->impulse_n[1] > 0; }

static inline Two two(Vec v) { return (Two){v.x, v.y}; }
static inline Two both(double x) { return (Two){x, x}; }
static inline Two swapped(Two x) { return (Two){x[1], x[0]}; }
static inline double sum_of(Two x) { return x[0] + x[1]; }
static inline Two positive(Two x) { return (Two)((Mask)x & (Mask)(x > both(0))); } /* else 0 */

/* Masses (crowd_weigh.c): whether those of two bodies are very different; what the levers, once they are known, make of them;
 * and, once for each contact of a substep, before it is measured, which are to count. */
bool contact_is_uneven(const Mover *a, const Mover *b);
void contact_weigh(Contact *contact, Ends *ends, const Mover *a, const Mover *b);
bool rows_weigh(Rows *rows, const Mover *mover); /* whether any are of very different masses */

/* Solving for velocities (crowd_rows.c); `from`: the first contact that it is for. */

/* Once for each contact of a frame: which of all are between bodies that have others. */
void rows_link(Rows *rows, int32_t from);

/* Once for each contact of a substep, before it is solved: how fast points that are about to touch approach; those that do
 * faster than the threshold are to bounce. */
void rows_measure(Rows *rows, int32_t from, const Mover *mover, double threshold);

/* Once for each contact of a substep: the impulses of the substep before. */
void rows_warm_start(Rows *rows, int32_t from, Mover *mover);

/* Where masses are very different the impulses of before, which are those of another moment, may throw bodies farther than the
 * passes take back.  If all that has been applied since the movers were noted added energy, only the share of it is left that
 * takes the most. */
void rows_note(Rows *rows, const Mover *mover);
void rows_temper(Rows *rows, Mover *mover, double slow);

/* One pass, to all contacts or to those of hot bodies only.  Whether it made any body hot. */
bool rows_solve(Rows *rows, Mover *mover, double dt, bool all);

/* What the passes left unsolved is to show among what moves, not as a way through what stands: contacts with that, once more,
 * if they would go in far. */
void rows_hold(Rows *rows, Mover *mover, double dt);
void rows_bounce(Rows *rows, Mover *mover);

/* Gaps and overlaps (crowd_gap.c). */

/* How far apart the two surfaces are now, at each point. */
Two gap_now(const Contact *contact, const Mover *a, const Mover *b);

/* Before contacts that are new are solved: how fast their points may approach where the bodies are now. */
void gap_limit(Contact *contact, int32_t count, const Mover *mover, double dt);

/* At the velocities that were found bodies may turn so fast that gaps close by the second order of it: then they may approach
 * less fast.  Whether that changed anything; the bodies are hot. */
bool gap_foresee(Rows *rows, const Mover *mover, const int32_t *active, int32_t active_count, double dt);

/* Take a share of the overlaps out of the positions, set the limits of the next substep, and note which contacts are stale. */
void gap_close(Rows *rows, Mover *mover, double dt);

#endif
