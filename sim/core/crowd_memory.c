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

void memory_destroy(Memory *memory) {
    free(memory->record);
    free(memory->spare);
    free(memory->slot);
}

static int memory_room(Memory *memory, int32_t count) {
    if (count <= memory->capacity) return SIM_OK;
    int32_t capacity = 2 * count + 64, slots = 128;
    while (slots < 2 * capacity) slots *= 2;
    Record *record = realloc(memory->record, (size_t)capacity * sizeof *record);
    if (record) memory->record = record;
    Record *spare = realloc(memory->spare, (size_t)capacity * sizeof *spare);
    if (spare) memory->spare = spare;
    int32_t *slot = realloc(memory->slot, (size_t)slots * sizeof *slot);
    if (slot) memory->slot = slot;
    if (!record || !spare || !slot) return SIM_OUT_OF_MEMORY;
    memory->slots = slots;
    memory->capacity = capacity;
    return SIM_OK;
}

Record contact_record(const Contact *c) {
    Record r = {.key = c->key, .a = c->a, .b = c->b, .count = c->count};
    for (int32_t k = 0; k < c->count; k++) {
        r.feature[k] = c->point[k].feature;
        r.impulse_n[k] = c->point[k].impulse_n;
        r.impulse_t[k] = c->point[k].impulse_t;
    }
    return r;
}

int memory_store(Memory *memory, const Contact *contact, int32_t count, const Mover *mover) {
    int status = memory_room(memory, memory->count + count);
    if (status != SIM_OK || !memory->slot) return status;
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
    memset(memory->slot, 0xff, (size_t)memory->slots * sizeof *memory->slot);
    uint32_t mask = (uint32_t)memory->slots - 1;
    for (int32_t i = 0; i < kept; i++) {
        uint32_t at = hash(memory->record[i].key) & mask;
        while (memory->slot[at] >= 0) at = (at + 1) & mask;
        memory->slot[at] = i;
    }
    return SIM_OK;
}

const Record *memory_recall(const Memory *memory, uint64_t key) {
    if (memory->count == 0) return NULL;
    uint32_t mask = (uint32_t)memory->slots - 1;
    for (uint32_t at = hash(key) & mask; memory->slot[at] >= 0; at = (at + 1) & mask)
        if (memory->record[memory->slot[at]].key == key) return &memory->record[memory->slot[at]];
    return NULL;
}

static void insert(uint64_t *table, int32_t slots, uint64_t key) {
    uint32_t mask = (uint32_t)slots - 1, at = hash(key) & mask;
    while (table[at] != 0) at = (at + 1) & mask;
    table[at] = key;
}

int keyset_room(KeySet *set, int32_t count) {
    if (2 * count < set->slots) return SIM_OK;
    int32_t slots = 256;
    while (slots < 4 * count) slots *= 2;
    uint64_t *key = calloc((size_t)slots, sizeof *key);
    if (!key) return SIM_OUT_OF_MEMORY;
    for (int32_t i = 0; i < set->slots; i++)
        if (set->key[i] != 0) insert(key, slots, set->key[i]);
    free(set->key);
    set->key = key;
    set->slots = slots;
    return SIM_OK;
}

void keyset_clear(KeySet *set) {
    set->count = 0;
    if (set->key) memset(set->key, 0, (size_t)set->slots * sizeof *set->key);
}

bool keyset_add(KeySet *set, uint64_t key) {
    uint32_t mask = (uint32_t)set->slots - 1;
    for (uint32_t at = hash(key) & mask; set->key[at] != 0; at = (at + 1) & mask)
        if (set->key[at] == key) return false;
    insert(set->key, set->slots, key);
    set->count++;
    return true;
}
