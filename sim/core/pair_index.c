#include "pair_index.h"

#include <stdlib.h>
#include <string.h>

#include "sim.h"

static uint32_t hash(uint64_t key) {
    key ^= key >> 31;
    key *= 0x9e3779b97f4a7c15u; /* 2^64 over the golden ratio (Knuth 6.4) */
    return (uint32_t)(key >> 33);
}

/* Where the key is, or the empty slot where it would be. */
static int32_t slot_of(const uint64_t *table, int32_t slots, uint64_t key) {
    uint32_t mask = (uint32_t)slots - 1, at = hash(key) & mask;
    while (table[at] != 0 && table[at] != key) at = (at + 1) & mask;
    return (int32_t)at;
}

void index_destroy(Index *index) {
    free(index->key);
    free(index->value);
}

int index_room(Index *index, int32_t count) {
    if (2 * count < index->slots) return SIM_OK;
    int32_t slots = 256; /* no more than are needed: to clear them costs the cache's contents */
    while (slots <= 2 * count) slots *= 2;
    uint64_t *key = calloc((size_t)slots, sizeof *key);
    int32_t *value = malloc((size_t)slots * sizeof *value);
    if (!key || !value) {
        free(key);
        free(value);
        return SIM_OUT_OF_MEMORY;
    }
    for (int32_t i = 0; i < index->slots; i++) {
        if (index->key[i] == 0) continue;
        int32_t at = slot_of(key, slots, index->key[i]);
        key[at] = index->key[i];
        value[at] = index->value[i];
    }
    index_destroy(index);
    index->key = key;
    index->value = value;
    index->slots = slots;
    return SIM_OK;
}

void index_clear(Index *index) {
    index->count = 0;
    if (index->key) memset(index->key, 0, (size_t)index->slots * sizeof *index->key);
}

bool index_add(Index *index, uint64_t key, int32_t value) {
    int32_t at = slot_of(index->key, index->slots, key);
    if (index->key[at] == key) return false;
    index->key[at] = key;
    index->value[at] = value;
    index->count++;
    return true;
}

int32_t index_find(const Index *index, uint64_t key) {
    if (index->count <= 0) return -1;
    int32_t at = slot_of(index->key, index->slots, key);
    return index->key[at] == key ? index->value[at] : -1;
}

int32_t *index_at(Index *index, uint64_t key) {
    if (index->count <= 0) return NULL;
    int32_t at = slot_of(index->key, index->slots, key);
    return index->key[at] == key ? &index->value[at] : NULL;
}
