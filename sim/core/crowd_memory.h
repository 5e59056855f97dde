/* What the crowd remembers of pairs of pieces from frame to frame. */
#ifndef CROWD_MEMORY_H
#define CROWD_MEMORY_H

#include "crowd_rows.h"
#include "pair_index.h"

/* The impulses of a contact, for warm starting. */
typedef struct Record {
    uint64_t key;
    int32_t a, b, count;
    double lever[2]; /* where along the contact a point is: how far from a's centre */
    double impulse_n[2], impulse_t;
    bool touching;   /* as has been told */
    bool seen;       /* recalled in this frame */
} Record;

Record contact_record(const Contact *contact);

typedef struct Memory {
    Record *record, *spare;
    int32_t count, capacity;
    Index index;
} Memory;

void memory_destroy(Memory *memory);

/* Take in the frame's contacts.  What is known of other pairs is kept where neither body took part in the frame: it is
 * needed when they wake. Returns SIM_OK or SIM_OUT_OF_MEMORY. */
int memory_store(Memory *memory, const Contact *contact, int32_t count, const Mover *mover);

/* Impulses are of a substep: another length of it scales them. */
void memory_scale(Memory *memory, double by);

/* NULL when nothing is known of the pair; what is, is marked as seen. */
const Record *memory_recall(Memory *memory, uint64_t key);

#endif
