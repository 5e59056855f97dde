/* Tracing: a thinned mask to chains of pixels between junctions and ends.
 *
 * A pixel with three or more neighbours is a junction; junction pixels that touch are one node.  All others have
 * two neighbours (along a chain), one (an end) or none (a dot).
 */
#include <stdint.h>
#include <stdlib.h>

#include "api.h"
#include "rows.h"

enum { FREE_END = -1, CLOSED = -2 };

typedef struct {
    const uint8_t *mask; /* 1 on the skeleton, 0 elsewhere; 0 along the border */
    int32_t width;
    int32_t offset[8];
    int32_t *node; /* a pixel: 0 chain not yet walked, node + 1, or -1 chain walked */
} Grid;

typedef struct {
    int32_t *points; /* pixel indices of all chains, one after the other */
    int32_t *start;  /* of each chain in points; one more than there are chains */
    int32_t *ends;   /* two a chain: node, FREE_END, or CLOSED for a ring that meets no junction */
    int32_t point_count, chain_count, node_count;
} Chains;

static int degree(const Grid *g, int32_t at) {
    int n = 0;
    for (int k = 0; k < 8; k++) n += g->mask[at + g->offset[k]];
    return n;
}

/* Mark the junction pixels that hang together with `at` as one node. `stack` has room for all pixels. */
static void flood_node(Grid *g, int32_t at, int32_t id, int32_t *stack) {
    int32_t top = 0;
    stack[top++] = at;
    g->node[at] = id + 1;
    while (top) {
        const int32_t p = stack[--top];
        for (int k = 0; k < 8; k++) {
            const int32_t q = p + g->offset[k];
            if (g->mask[q] && !g->node[q] && degree(g, q) >= 3) {
                g->node[q] = id + 1;
                stack[top++] = q;
            }
        }
    }
}

/* Walk the chain that leaves `from` (a node's pixel, or -1) by `at` until a node or an end. */
static void walk(Grid *g, int32_t from, int32_t at, Chains *out) {
    int32_t end = FREE_END, before = from;
    const int32_t first = at;
    int32_t *ends = out->ends + 2 * (size_t)out->chain_count;
    while (at >= 0) {
        out->points[out->point_count++] = at;
        g->node[at] = -1;
        int32_t next = -1;
        for (int k = 0; k < 8; k++) {
            const int32_t q = at + g->offset[k];
            if (!g->mask[q] || q == before) continue;
            if (g->node[q] > 0)
                end = g->node[q] - 1;
            else if (g->node[q] == 0)
                next = q;
            else if (q == first && from < 0 && at != first)
                end = CLOSED;
        }
        if (end >= 0) break;
        before = at;
        at = next;
    }
    ends[0] = end == CLOSED ? CLOSED : from < 0 ? FREE_END : g->node[from] - 1;
    ends[1] = end;
    out->start[++out->chain_count] = out->point_count;
}

static void walk_all(Grid *g, const int32_t *pixels, int32_t count, Chains *out) {
    for (int32_t i = 0; i < count; i++) {
        if (g->node[pixels[i]] <= 0) continue;
        for (int k = 0; k < 8; k++) {
            const int32_t q = pixels[i] + g->offset[k];
            if (g->mask[q] && g->node[q] == 0) walk(g, pixels[i], q, out);
        }
    }
    for (int32_t i = 0; i < count; i++) /* then from free ends, then what is left: rings */
        if (g->node[pixels[i]] == 0 && degree(g, pixels[i]) <= 1) walk(g, -1, pixels[i], out);
    for (int32_t i = 0; i < count; i++)
        if (g->node[pixels[i]] == 0) walk(g, -1, pixels[i], out);
}

/* Trace a skeleton of `count` pixels, as ink_thin leaves it.
 *
 * points, nodes: room for `count` each; start: count + 1; ends: 2 count.  nodes gets a node + 1 for every pixel of
 * `points`' page order that belongs to one: pairs are written to node_pixels (pixel index) and node_ids.
 * counts gets the numbers of chains, nodes and node pixels.  Returns 0, or -1 where memory is short. */
INK_API int32_t ink_trace(const uint8_t *mask, int32_t width, int32_t height, int32_t count, int32_t *points,
                          int32_t *start, int32_t *ends, int32_t *node_pixels, int32_t *node_ids, int32_t counts[3]) {
    Grid g = {mask, width, {-width, -width + 1, 1, width + 1, width, width - 1, -1, -width - 1}, NULL};
    Chains out = {points, start, ends, 0, 0, 0};
    int32_t status = -1, found = 0;
    const size_t size = (size_t)width * height;
    int32_t *pixels = malloc(((size_t)count + 1) * 2 * sizeof *pixels);
    g.node = calloc(size, sizeof *g.node);
    if (!pixels || !g.node) goto out;
    int32_t *stack = pixels + count + 1;
    const int32_t end = width * height;
    for (int32_t i = next_ink(mask, 0, end); i < end && found < count; i = next_ink(mask, i + 1, end))
        pixels[found++] = i;
    for (int32_t i = 0; i < found; i++)
        if (!g.node[pixels[i]] && degree(&g, pixels[i]) >= 3) flood_node(&g, pixels[i], out.node_count++, stack);
    counts[2] = 0;
    for (int32_t i = 0; i < found; i++) {
        if (g.node[pixels[i]] > 0) {
            node_pixels[counts[2]] = pixels[i];
            node_ids[counts[2]++] = g.node[pixels[i]] - 1;
        }
    }
    start[0] = 0;
    walk_all(&g, pixels, found, &out);
    counts[0] = out.chain_count;
    counts[1] = out.node_count;
    status = 0;
out:
    free(pixels);
    free(g.node);
    return status;
}
