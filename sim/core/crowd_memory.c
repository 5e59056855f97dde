/* What the crowd remembers of pairs of pieces from frame to frame. */
#include "crowd_memory.h"

#include <stdlib.h>

#include "sim.h"

Record contact_record(const Contact *c) {
    Record r = {
        .key = c->key, .a = c->a, .b = c->b, .count = c->count, .impulse_t = c->impulse_t, .touching = c->touching};
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
        if (contact[i].count > 0 || contact[i].touching) memory->spare[kept++] = contact_record(&contact[i]);
    for (int32_t i = 0; i < memory->count; i++) {
        const Record *r = &memory->record[i];
        if (mover[r->a].inverse_mass > 0 || mover[r->b].inverse_mass > 0) continue;
        memory->spare[kept] = *r;
        memory->spare[kept++].seen = false;
    }
    Record *swap = memory->record;
    memory->record = memory->spare;
    memory->spare = swap;
    memory->count = kept;
    if (index_room(&memory->index, kept) != SIM_OK) return SIM_OUT_OF_MEMORY;
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

const Record *memory_recall(Memory *memory, uint64_t key) {
    int32_t at = index_find(&memory->index, key);
    if (at < 0) return NULL;
    memory->record[at].seen = true;
    return &memory->record[at];
}
