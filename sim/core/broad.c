/* Sort and sweep (Baraff 1992) along the axis on which the moving boxes are spread the more. */
#include "broad.h"

#include <stdlib.h>

#include "sim.h"

int sweep_create(Sweep *sweep, int32_t count) {
    size_t n = (size_t)count + 1;
    *sweep = (Sweep){.count = count, .pair_capacity = 4 * count + 64};
    sweep->order = malloc(n * sizeof *sweep->order);
    sweep->low = malloc(n * sizeof *sweep->low);
    sweep->high = malloc(n * sizeof *sweep->high);
    sweep->pair = malloc((size_t)sweep->pair_capacity * sizeof *sweep->pair);
    if (!sweep->order || !sweep->low || !sweep->high || !sweep->pair) return SIM_OUT_OF_MEMORY;
    for (int32_t i = 0; i < count; i++) sweep->order[i] = i;
    return SIM_OK;
}

void sweep_destroy(Sweep *sweep) {
    free(sweep->order);
    free(sweep->low);
    free(sweep->high);
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

static void sort(Sweep *sweep, const Box *box, bool in_y) {
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
    }
}

int sweep_pairs(Sweep *sweep, const Box *box, const bool *moving) {
    bool in_y = spread_in_y(sweep, box, moving);
    sort(sweep, box, in_y);
    sweep->pair_count = 0;
    for (int32_t k = 0; k < sweep->count; k++) {
        int32_t i = sweep->order[k];
        double high = sweep->high[k];
        for (int32_t l = k + 1; l < sweep->count && sweep->low[l] <= high; l++) {
            int32_t j = sweep->order[l];
            if (!(moving[i] || moving[j]) || !boxes_meet(&box[i], &box[j])) continue;
            if (sweep->pair_count == sweep->pair_capacity) {
                int32_t capacity = 2 * sweep->pair_capacity;
                Pair *more = realloc(sweep->pair, (size_t)capacity * sizeof *more);
                if (!more) return SIM_OUT_OF_MEMORY;
                sweep->pair = more;
                sweep->pair_capacity = capacity;
            }
            sweep->pair[sweep->pair_count++] = i < j ? (Pair){i, j} : (Pair){j, i};
        }
    }
    return SIM_OK;
}
