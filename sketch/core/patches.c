/* Which things that have members in common, however indirectly, are in one patch. */
#include "fit.h"

static int32_t root(int32_t *parent, int32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* members: of all things, numbers below `most`; ends: (count): where each one's end, at least one each. parent: (2 * most):
 * scratch.
 * Out: patch: (count): the patch of each, numbered in the order of their first. Returns how many there are. */
INK_API int32_t ink_patches(const int32_t *members, const int32_t *ends, int32_t count, int32_t most, int32_t *parent,
                            int32_t *patch) {
    int32_t *number = parent + most, found = 0;
    for (int32_t i = 0; i < most; i++) {
        parent[i] = i;
        number[i] = -1;
    }
    for (int32_t n = 0, k = 0; n < count; n++)
        for (const int32_t first = members[k]; k < ends[n]; k++) parent[root(parent, members[k])] = root(parent, first);
    for (int32_t n = 0; n < count; n++) {
        const int32_t own = root(parent, members[n ? ends[n - 1] : 0]);
        if (number[own] < 0) number[own] = found++;
        patch[n] = number[own];
    }
    return found;
}
