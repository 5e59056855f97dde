/* Simple polygons to convex pieces: ear clipping, then merging over the cuts that no corner needs.
 *
 * Ears: Meisters 1975.  Merging: Hertel and Mehlhorn 1983, at most four times the least number of pieces.
 */
#include "decompose.h"

#include <stdlib.h>

#include "world.h"

/* The mesh of triangles as half-edges: edge 3 t + k goes from corner k of triangle t to the next.  After merging,
 * `next` and `previous` run round the pieces. */
typedef struct Mesh {
    const Vec *vertex;
    int32_t triangle_count;
    int32_t *from, *next, *previous, *twin; /* twin -1: an outer side */
} Mesh;

/* What is left to clip: a ring of vertices. */
typedef struct Ring {
    const Vec *vertex;
    int32_t *next, *previous;
    int32_t *side;  /* the half-edge beyond the side that begins at a vertex; -1 on the outline */
    bool *reflex;
    int32_t *reflexes; /* those that were so at the start; corners only ever become sharper */
    int32_t reflex_count;
} Ring;

static double corner(const Vec *v, int32_t a, int32_t b, int32_t c) {
    return vcross(vsub(v[b], v[a]), vsub(v[c], v[a]));
}

/* Twice the area of a triangle below which its corners count as on one line: the rounding of the products. */
static double flat(const Vec *v, int32_t a, int32_t b, int32_t c) {
    Vec p = vsub(v[b], v[a]), q = vsub(v[c], v[a]);
    return 1e-14 * (fabs(p.x * q.y) + fabs(p.y * q.x));
}

static bool same(Vec a, Vec b) { return a.x == b.x && a.y == b.y; }

static bool ring_convex(const Ring *ring, int32_t i) {
    int32_t a = ring->previous[i], c = ring->next[i];
    return corner(ring->vertex, a, i, c) > flat(ring->vertex, a, i, c);
}

/* Whether the triangle at i holds no other vertex of the ring: only reflex ones can be inside. */
static bool ring_ear(Ring *ring, int32_t i) {
    const Vec *v = ring->vertex;
    int32_t a = ring->previous[i], c = ring->next[i], kept = 0;
    double low_x = fmin(v[a].x, fmin(v[i].x, v[c].x)), high_x = fmax(v[a].x, fmax(v[i].x, v[c].x));
    double low_y = fmin(v[a].y, fmin(v[i].y, v[c].y)), high_y = fmax(v[a].y, fmax(v[i].y, v[c].y));
    bool ear = true;
    for (int32_t k = 0; k < ring->reflex_count; k++) {
        int32_t p = ring->reflexes[k];
        if (!ring->reflex[p]) continue;
        ring->reflexes[kept++] = p;
        if (!ear || p == a || p == c) continue;
        if (v[p].x < low_x || v[p].x > high_x || v[p].y < low_y || v[p].y > high_y) continue;
        if (same(v[p], v[a]) || same(v[p], v[i]) || same(v[p], v[c])) continue;
        if (corner(v, a, i, p) >= 0 && corner(v, i, c, p) >= 0 && corner(v, c, a, p) >= 0) ear = false;
    }
    ring->reflex_count = kept;
    return ear;
}

/* How good an ear is: its least height over its longest side, so that slivers come last. */
static double ear_quality(const Ring *ring, int32_t i) {
    const Vec *v = ring->vertex;
    Vec p = v[ring->previous[i]], q = v[ring->next[i]];
    double longest = fmax(vdot(vsub(q, p), vsub(q, p)),
                          fmax(vdot(vsub(v[i], p), vsub(v[i], p)), vdot(vsub(q, v[i]), vsub(q, v[i]))));
    return corner(v, ring->previous[i], i, ring->next[i]) / longest;
}

/* Take the triangle at i off the ring.  Where it is flat only the vertex goes: there is nothing to cover. */
static void ring_clip(Ring *ring, Mesh *mesh, int32_t i) {
    int32_t a = ring->previous[i], c = ring->next[i];
    int32_t edge = 3 * mesh->triangle_count++;
    int32_t from[3] = {a, i, c}, beyond[3] = {ring->side[a], ring->side[i], -1};
    for (int32_t k = 0; k < 3; k++) {
        mesh->from[edge + k] = from[k];
        mesh->next[edge + k] = edge + (k + 1) % 3;
        mesh->previous[edge + k] = edge + (k + 2) % 3;
        mesh->twin[edge + k] = beyond[k];
        if (beyond[k] >= 0) mesh->twin[beyond[k]] = edge + k;
    }
    ring->side[a] = edge + 2;
    ring->next[a] = c;
    ring->previous[c] = a;
    if (ring->reflex[a]) ring->reflex[a] = !ring_convex(ring, a);
    if (ring->reflex[c]) ring->reflex[c] = !ring_convex(ring, c);
}

/* The next ear from `start` on: the best of the first few, so that fans of slivers are rare.  Where rounding leaves
 * none, the sharpest corner: it is as flat as rounding is. */
static int32_t ring_next_ear(Ring *ring, int32_t start, int32_t left) {
    enum { LOOK = 8 };
    int32_t best = -1, found = 0, sharpest = start;
    double best_quality = 0, sharpest_corner = -INFINITY;
    for (int32_t k = 0, i = start; k < left && found < LOOK; k++, i = ring->next[i]) {
        double turn = corner(ring->vertex, ring->previous[i], i, ring->next[i]);
        if (turn > sharpest_corner) {
            sharpest_corner = turn;
            sharpest = i;
        }
        if (ring->reflex[i] || !ring_convex(ring, i) || !ring_ear(ring, i)) continue;
        double quality = ear_quality(ring, i);
        found++;
        if (quality > best_quality) {
            best_quality = quality;
            best = i;
        }
    }
    return best >= 0 ? best : sharpest;
}

static void triangulate(Ring *ring, Mesh *mesh, int32_t count) {
    for (int32_t i = 0; i < count; i++) {
        ring->next[i] = i + 1 < count ? i + 1 : 0;
        ring->previous[i] = i > 0 ? i - 1 : count - 1;
        ring->side[i] = -1;
    }
    for (int32_t i = 0; i < count; i++) {
        ring->reflex[i] = !ring_convex(ring, i);
        if (ring->reflex[i]) ring->reflexes[ring->reflex_count++] = i;
    }
    int32_t at = 0, left = count;
    while (left > 3) {
        int32_t ear = ring_next_ear(ring, at, left);
        at = ring->next[ear];
        ring_clip(ring, mesh, ear);
        left--;
    }
    ring_clip(ring, mesh, at);
}

/* Whether the corner at the start of `b`, coming along `a`, is convex once both bound one piece. */
static bool joint_convex(const Mesh *mesh, int32_t a, int32_t b) {
    int32_t p = mesh->from[a], q = mesh->from[b], r = mesh->from[mesh->next[b]];
    Vec u = vsub(mesh->vertex[q], mesh->vertex[p]), v = vsub(mesh->vertex[r], mesh->vertex[q]);
    return vcross(u, v) >= -1e-12 * vlength(u) * vlength(v);
}

static void merge(Mesh *mesh) {
    for (int32_t e = 0; e < 3 * mesh->triangle_count; e++) {
        int32_t t = mesh->twin[e];
        if (t < e) continue; /* outer, or done from the other side */
        int32_t before_e = mesh->previous[e], after_e = mesh->next[e];
        int32_t before_t = mesh->previous[t], after_t = mesh->next[t];
        if (!joint_convex(mesh, before_e, after_t) || !joint_convex(mesh, before_t, after_e)) continue;
        mesh->next[before_e] = after_t;
        mesh->previous[after_t] = before_e;
        mesh->next[before_t] = after_e;
        mesh->previous[after_e] = before_t;
        mesh->next[e] = mesh->next[t] = -1; /* gone */
    }
}

/* Twice a piece's area, for leaving out what is flat. */
static double piece_area(const Mesh *mesh, int32_t first) {
    const Vec *v = mesh->vertex;
    double area = 0;
    for (int32_t e = mesh->next[first]; e != first; e = mesh->next[e])
        area += corner(v, mesh->from[first], mesh->from[e], mesh->from[mesh->next[e]]);
    return area;
}

static void collect(const Mesh *mesh, Cutting *cutting, bool *seen) {
    for (int32_t e = 0; e < 3 * mesh->triangle_count; e++) {
        if (mesh->next[e] < 0 || seen[e]) continue;
        int32_t at = e;
        int32_t begin = cutting->index_count;
        do {
            seen[at] = true;
            cutting->index[cutting->index_count++] = mesh->from[at];
            at = mesh->next[at];
        } while (at != e);
        if (piece_area(mesh, e) > 0)
            cutting->start[++cutting->piece_count] = cutting->index_count;
        else
            cutting->index_count = begin;
    }
}

static bool already_convex(const Vec *v, int32_t count) {
    int32_t turns = 0; /* sides whose x direction changes sign: a convex outline has two, a star more */
    double last = 0;
    for (int32_t i = 0; i < count; i++) {
        int32_t j = (i + 1) % count, k = (i + 2) % count;
        if (corner(v, i, j, k) < 0) return false;
        double dx = v[j].x - v[i].x;
        if (dx * last < 0) turns++;
        if (dx != 0) last = dx;
    }
    return turns <= 2;
}

static int cutting_reserve(Cutting *cutting, int32_t count) {
    size_t edges = 3 * (size_t)count;
    *cutting = (Cutting){0};
    cutting->start = calloc((size_t)count + 1, sizeof *cutting->start);
    cutting->index = malloc(edges * sizeof *cutting->index);
    return cutting->start && cutting->index ? SIM_OK : SIM_OUT_OF_MEMORY;
}

void cutting_destroy(Cutting *cutting) {
    free(cutting->start);
    free(cutting->index);
    *cutting = (Cutting){0};
}

int polygon_cut(Cutting *cutting, const Vec *vertex, int32_t count) {
    if (cutting_reserve(cutting, count) != SIM_OK) {
        cutting_destroy(cutting);
        return SIM_OUT_OF_MEMORY;
    }
    if (already_convex(vertex, count)) {
        for (int32_t i = 0; i < count; i++) cutting->index[i] = i;
        cutting->piece_count = 1;
        cutting->index_count = cutting->start[1] = count;
        return SIM_OK;
    }
    size_t edges = 3 * (size_t)count, n = (size_t)count;
    int32_t *numbers = malloc((4 * edges + 4 * n) * sizeof *numbers);
    bool *flags = calloc(edges + n, sizeof *flags);
    int status = numbers && flags ? SIM_OK : SIM_OUT_OF_MEMORY;
    if (status == SIM_OK) {
        Mesh mesh = {vertex, 0, numbers, numbers + edges, numbers + 2 * edges, numbers + 3 * edges};
        int32_t *rest = numbers + 4 * edges;
        Ring ring = {vertex, rest, rest + n, rest + 2 * n, flags + edges, rest + 3 * n, 0};
        triangulate(&ring, &mesh, count);
        merge(&mesh);
        collect(&mesh, cutting, flags);
    } else {
        cutting_destroy(cutting);
    }
    free(numbers);
    free(flags);
    return status;
}

int world_decompose(World *world) {
    if (world->piece) return SIM_OK;
    int32_t room = 0, pieces = 0;
    for (int32_t i = 0; i < world->shape_count; i++) room += 3 * world->shape[i].count;
    world->piece = malloc(((size_t)room + 1) * sizeof *world->piece); /* a triangle has 3 vertices: enough pieces */
    world->piece_vertex = malloc(((size_t)room + 1) * sizeof *world->piece_vertex);
    world->piece_corner = malloc(((size_t)room + 1) * sizeof *world->piece_corner);
    if (!world->piece || !world->piece_vertex || !world->piece_corner) return SIM_OUT_OF_MEMORY;
    room = 0;
    for (int32_t i = 0; i < world->shape_count; i++) {
        Shape *shape = &world->shape[i];
        const Vec *vertex = world->vertex + shape->first;
        shape->first_piece = pieces;
        if (shape->radius > 0) {
            world->piece_vertex[room] = vertex[0];
            world->piece_corner[room] = shape->first;
            world->piece[pieces++] = (Piece){i, room++, 1, shape->radius};
        } else {
            Cutting cutting;
            int status = polygon_cut(&cutting, vertex, shape->count);
            if (status != SIM_OK) return status;
            for (int32_t p = 0; p < cutting.piece_count; p++) {
                int32_t first = room;
                for (int32_t k = cutting.start[p]; k < cutting.start[p + 1]; k++, room++) {
                    world->piece_vertex[room] = vertex[cutting.index[k]];
                    world->piece_corner[room] = shape->first + cutting.index[k];
                }
                world->piece[pieces++] = (Piece){i, first, room - first, 0};
            }
            cutting_destroy(&cutting);
        }
        shape->piece_count = pieces - shape->first_piece;
    }
    world->piece_count = pieces;
    world->piece_vertex_count = room;
    return SIM_OK;
}

int32_t sim_decompose(const double *vertices, int32_t count, int32_t *piece_start, int32_t *index) {
    Cutting cutting;
    if (polygon_cut(&cutting, (const Vec *)vertices, count) != SIM_OK) return -1;
    for (int32_t i = 0; i <= cutting.piece_count; i++) piece_start[i] = cutting.start[i];
    for (int32_t i = 0; i < cutting.index_count; i++) index[i] = cutting.index[i];
    int32_t pieces = cutting.piece_count;
    cutting_destroy(&cutting);
    return pieces;
}
