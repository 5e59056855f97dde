/* Sort and sweep (Baraff 1992) along the axis on which the moving boxes are spread the more. */
#include "broad.h"

#include <stdlib.h>

#include "sim.h"

int sweep_create(Sweep *sweep, int32_t count) {
    size_t n = (size_t)count + 1;
    *sweep = (Sweep){.count = count, .pair_capacity = 4 * count + 64};
    sweep->order = malloc(2 * n * sizeof *sweep->order);
    sweep->low = malloc(4 * n * sizeof *sweep->low);
    sweep->moving = malloc(n * sizeof *sweep->moving);
    sweep->pair = malloc((size_t)sweep->pair_capacity * sizeof *sweep->pair);
    if (!sweep->order || !sweep->low || !sweep->moving || !sweep->pair) return SIM_OUT_OF_MEMORY;
    sweep->met = sweep->order + n;
    sweep->high = sweep->low + n;
    sweep->across_low = sweep->low + 2 * n;
    sweep->across_high = sweep->low + 3 * n;
    for (int32_t i = 0; i < count; i++) sweep->order[i] = i;
    return SIM_OK;
}

void sweep_destroy(Sweep *sweep) {
    free(sweep->order);
    free(sweep->low);
    free(sweep->moving);
    free(sweep->pair);
}

static bool spread_in_y(const Sweep *sweep, const Box *box, const bool *moving) {
    Vec sum = {0}, square = {0};
    double n = 0;
    for (int32_t i = 0; i < sweep->count; i++) {
        if (!moving[i]) continue;
        Vec c = vadd(box[i].low, box[i].high);
        sum = vadd(sum, c);
        square = vadd(square, vec(c.x * c.x, c.y * c.y));
        n += 1;
    }
    return square.y * n - sum.y * sum.y > square.x * n - sum.x * sum.x;
}

static void sort(Sweep *sweep, const Box *box, const bool *moving, bool in_y) {
    for (int32_t k = 0; k < sweep->count; k++) {
        int32_t i = sweep->order[k], at = k;
        double low = in_y ? box[i].low.y : box[i].low.x;
        while (at > 0 && sweep->low[at - 1] > low) {
            sweep->low[at] = sweep->low[at - 1];
            sweep->order[at] = sweep->order[at - 1];
            at--;
        }
        sweep->low[at] = low;
        sweep->order[at] = i;
    }
    for (int32_t k = 0; k < sweep->count; k++) {
        int32_t i = sweep->order[k];
        sweep->high[k] = in_y ? box[i].high.y : box[i].high.x;
        sweep->across_low[k] = in_y ? box[i].low.x : box[i].low.y;
        sweep->across_high[k] = in_y ? box[i].high.x : box[i].high.y;
        sweep->moving[k] = moving[i];
    }
}

static int pair_room(Sweep *sweep, int32_t more) {
    if (sweep->pair_count + more <= sweep->pair_capacity) return SIM_OK;
    int32_t capacity = 2 * sweep->pair_capacity + more;
    Pair *pair = realloc(sweep->pair, (size_t)capacity * sizeof *pair);
    if (!pair) return SIM_OUT_OF_MEMORY;
    sweep->pair = pair;
    sweep->pair_capacity = capacity;
    return SIM_OK;
}

static int32_t count_moving(const Sweep *sweep, const bool *moving) {
    int32_t count = 0;
    for (int32_t i = 0; i < sweep->count; i++) count += moving[i];
    return count;
}

/* Where few boxes move each is held against all: nothing needs to be sorted. */
static int few_pairs(Sweep *sweep, const Box *box, const bool *moving) {
    for (int32_t i = 0; i < sweep->count; i++) {
        if (!moving[i]) continue;
        if (pair_room(sweep, sweep->count) != SIM_OK) return SIM_OUT_OF_MEMORY;
        Box own = box[i];
        Pair *pair = sweep->pair + sweep->pair_count;
        for (int32_t j = 0; j < sweep->count; j++) {
            *pair = (Pair){i < j ? i : j, i < j ? j : i};
            pair += (box[j].low.x <= own.high.x) & (own.low.x <= box[j].high.x) & (box[j].low.y <= own.high.y) &
                    (own.low.y <= box[j].high.y) & !(moving[j] & (j <= i));
        }
        sweep->pair_count = (int32_t)(pair - sweep->pair);
    }
    return SIM_OK;
}

int sweep_pairs(Sweep *sweep, const Box *box, const bool *moving) {
    enum { FEW = 12 }; /* one in so many */
    sweep->pair_count = 0;
    if (FEW * count_moving(sweep, moving) <= sweep->count) return few_pairs(sweep, box, moving);
    bool in_y = spread_in_y(sweep, box, moving);
    sort(sweep, box, moving, in_y);
    const double *lows = sweep->low, *lows_across = sweep->across_low, *highs_across = sweep->across_high;
    const bool *moves = sweep->moving;
    int32_t count = sweep->count;
    for (int32_t k = 0; k < count; k++) {
        double high = sweep->high[k], low_across = lows_across[k], high_across = highs_across[k];
        int32_t end = k + 1, i = sweep->order[k];
        while (end < count && lows[end] <= high) end++;
        if (pair_room(sweep, end - k) != SIM_OK) return SIM_OUT_OF_MEMORY;
        int32_t *met = sweep->met, count_met = 0;
        for (int32_t l = k + 1; l < end;
             l++) { /* every one is noted, and kept by counting it: no branch to mispredict */
            met[count_met] = l;
            count_met += (lows_across[l] <= high_across) & (highs_across[l] >= low_across) & (moves[k] | moves[l]);
        }
        Pair *pair = sweep->pair + sweep->pair_count;
        for (int32_t l = 0; l < count_met; l++) {
            int32_t j = sweep->order[met[l]];
            pair[l] = (Pair){i < j ? i : j, i < j ? j : i};
        }
        sweep->pair_count += count_met;
    }
    return SIM_OK;
}
