/* Numbers by pair: tables with open addressing. */
#ifndef PAIR_INDEX_H
#define PAIR_INDEX_H

#include <stdbool.h>
#include <stdint.h>

static inline uint64_t pair_key(int32_t a, int32_t b) { return (uint64_t)(uint32_t)a << 32 | (uint32_t)b; }

/* Numbers by pair. */
typedef struct Index {
    uint64_t *key; /* open addressing; 0: empty, as no pair is of 0 twice */
    int32_t *value;
    int32_t slots, count;
} Index;

void index_destroy(Index *index);
int index_room(Index *index, int32_t count); /* keeps what is in it */
void index_clear(Index *index);
bool index_add(Index *index, uint64_t key, int32_t value); /* whether the key is new; there must be room */
int32_t index_find(const Index *index, uint64_t key);      /* -1: not there */

int32_t *index_at(Index *index, uint64_t key);             /* where its value is; NULL: not there */

#endif
