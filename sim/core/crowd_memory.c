/* What the crowd remembers of pairs of pieces from frame to frame: tables with open addressing. */
#include "crowd_memory.h"

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
    int32_t slots = 256;
    while (slots < 4 * count) slots *= 2;
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

Record contact_record(const Contact *c) {
    Record r = {.key = c->key, .a = c->a, .b = c->b, .count = c->count, .impulse_t = c->impulse_t};
    for (int32_t k = 0; k < c->count; k++) {
        r.lever[k] = c->spin_na[k];
        r.impulse_n[k] = c->impulse_n[k];
    }
    return r;
}

void memory_destroy(Memory *memory) {
    free(memory->record);
    free(memory->spare);
    index_destroy(&memory->index);
}

static int memory_room(Memory *memory, int32_t count) {
    if (index_room(&memory->index, count) != SIM_OK) return SIM_OUT_OF_MEMORY;
    if (count <= memory->capacity) return SIM_OK;
    int32_t capacity = 2 * count + 64;
    Record *record = realloc(memory->record, (size_t)capacity * sizeof *record);
    if (record) memory->record = record;
    Record *spare = realloc(memory->spare, (size_t)capacity * sizeof *spare);
    if (spare) memory->spare = spare;
    if (!record || !spare) return SIM_OUT_OF_MEMORY;
    memory->capacity = capacity;
    return SIM_OK;
}

int memory_store(Memory *memory, const Contact *contact, int32_t count, const Mover *mover) {
    int status = memory_room(memory, memory->count + count);
    if (status != SIM_OK) return status;
    int32_t kept = 0;
    for (int32_t i = 0; i < count; i++)
        if (contact[i].count > 0) memory->spare[kept++] = contact_record(&contact[i]);
    for (int32_t i = 0; i < memory->count; i++) {
        const Record *r = &memory->record[i];
        if (mover[r->a].inverse_mass == 0 && mover[r->b].inverse_mass == 0) memory->spare[kept++] = *r;
    }
    Record *swap = memory->record;
    memory->record = memory->spare;
    memory->spare = swap;
    memory->count = kept;
    index_clear(&memory->index);
    for (int32_t i = 0; i < kept; i++) index_add(&memory->index, memory->record[i].key, i);
    return SIM_OK;
}

void memory_scale(Memory *memory, double by) {
    if (by == 1) return;
    for (int32_t i = 0; i < memory->count; i++) {
        Record *r = &memory->record[i];
        for (int32_t k = 0; k < r->count; k++) r->impulse_n[k] *= by;
        r->impulse_t *= by;
    }
}

const Record *memory_recall(const Memory *memory, uint64_t key) {
    int32_t at = index_find(&memory->index, key);
    return at < 0 ? NULL : &memory->record[at];
}
