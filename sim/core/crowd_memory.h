/* What the crowd remembers of pairs of pieces from frame to frame. */
#ifndef CROWD_MEMORY_H
#define CROWD_MEMORY_H

#include <stdbool.h>
#include <stdint.h>

#include "crowd_rows.h"

static inline uint64_t pair_key(int32_t piece_a, int32_t piece_b) {
    return (uint64_t)(uint32_t)piece_a << 32 | (uint32_t)piece_b;
}

/* Numbers by pair. */
typedef struct Index {
    uint64_t *key; /* open addressing; 0: empty, as no pair is of piece 0 twice */
    int32_t *value;
    int32_t slots, count;
} Index;

void index_destroy(Index *index);
int index_room(Index *index, int32_t count); /* keeps what is in it */
void index_clear(Index *index);
bool index_add(Index *index, uint64_t key, int32_t value); /* whether the key is new; there must be room */
int32_t index_find(const Index *index, uint64_t key);      /* -1: not there */

/* The impulses of a contact, for warm starting. */
typedef struct Record {
    uint64_t key;
    int32_t a, b, count;
    double lever[2]; /* where along the contact a point is: how far from a's centre */
    double impulse_n[2], impulse_t;
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

/* NULL when nothing is known of the pair. */
const Record *memory_recall(const Memory *memory, uint64_t key);

#endif
