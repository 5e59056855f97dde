/* The convex pieces of a world's shapes where their bodies are. */
#include "posed.h"

#include <stdlib.h>
#include <string.h>

static Vec side_normal(Vec from, Vec to) {
    Vec side = vsub(to, from);
    double length = vlength(side);
    return vec(side.y / length, -side.x / length);
}

/* A piece of several sees, at each vertex, the sides of the whole shape; a cut has another normal than the side after. */
static void see_whole(Posed *posed, const World *world, const Piece *piece) {
    const Shape *shape = &world->shape[piece->shape];
    const Vec *v = world->vertex + shape->first;
    for (int32_t k = piece->first; k < piece->first + piece->count; k++) {
        int32_t at = world->piece_corner[k] - shape->first;
        int32_t after = at + 1 < shape->count ? at + 1 : 0, before = at > 0 ? at - 1 : shape->count - 1;
        int32_t next = k + 1 < piece->first + piece->count ? k + 1 : piece->first;
        posed->local_arriving[k] = side_normal(v[before], v[at]);
        posed->local_leaving[k] = side_normal(v[at], v[after]);
        if (world->piece_corner[next] == shape->first + after) posed->local_normal[k] = posed->local_leaving[k];
    }
}

int posed_create(Posed *posed, const World *world) {
    size_t vertices = (size_t)world->piece_vertex_count + 1, pieces = (size_t)world->piece_count + 1;
    Vec *all = calloc(7 * vertices, sizeof *all);
    *posed = (Posed){
        .outline = calloc(pieces, sizeof *posed->outline),
        .swing = calloc(pieces, sizeof *posed->swing),
        .local_normal = all,
    };
    if (!posed->outline || !posed->swing || !all) {
        posed_destroy(posed);
        return SIM_OUT_OF_MEMORY;
    }
    posed->local_arriving = all + vertices, posed->local_leaving = all + 2 * vertices;
    posed->vertex = all + 3 * vertices, posed->normal = all + 4 * vertices;
    posed->arriving = all + 5 * vertices, posed->leaving = all + 6 * vertices;
    for (int32_t i = 0; i < world->piece_count; i++) {
        const Piece *piece = &world->piece[i];
        const Vec *v = world->piece_vertex + piece->first;
        int32_t first = piece->first, count = piece->count;
        bool whole = world->shape[piece->shape].piece_count == 1;
        posed->outline[i] = (Outline){posed->vertex + first,
                                      posed->normal + first,
                                      whole ? NULL : posed->arriving + first,
                                      whole ? NULL : posed->leaving + first,
                                      count,
                                      piece->radius};
        for (int32_t k = 0; k < count; k++) {
            posed->swing[i] = larger(posed->swing[i], vlength(v[k]));
            if (count > 1) posed->local_normal[first + k] = side_normal(v[k], v[k + 1 < count ? k + 1 : 0]);
        }
        if (!whole) see_whole(posed, world, piece);
    }
    return SIM_OK;
}

void posed_destroy(Posed *posed) {
    free(posed->outline);
    free(posed->swing);
    free(posed->local_normal);
    *posed = (Posed){0};
}

void posed_place(Posed *posed, const World *world, int32_t body, Pose at) {
    const Body *b = &world->body[body];
    for (int32_t s = b->first_shape; s < b->first_shape + b->shape_count; s++) {
        const Shape *shape = &world->shape[s];
        for (int32_t p = shape->first_piece; p < shape->first_piece + shape->piece_count; p++) {
            const Piece *piece = &world->piece[p];
            for (int32_t k = piece->first; k < piece->first + piece->count; k++) {
                posed->vertex[k] = place(at, world->piece_vertex[k]);
                posed->normal[k] = turn(at, posed->local_normal[k]);
                if (shape->piece_count == 1) continue;
                posed->arriving[k] = turn(at, posed->local_arriving[k]);
                posed->leaving[k] = turn(at, posed->local_leaving[k]);
            }
        }
    }
}

Box posed_box(const Posed *posed, int32_t piece) {
    const Outline *o = &posed->outline[piece];
    Box box = {o->vertex[0], o->vertex[0]};
    for (int32_t k = 1; k < o->count; k++) box = box_join(box, (Box){o->vertex[k], o->vertex[k]});
    return box_grow(box, o->radius);
}
