/* Building the world from the input: anchored bodies become the background, pinned ones merge. */
#include "world.h"

#include <stdlib.h>
#include <string.h>

/* ---------------------------------------------------------------- which inputs are one rigid body */

static int32_t find(int32_t *parent, int32_t i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

typedef struct Tie { /* a joint between two groups of inputs, the lower first */
    int32_t low, high, joint;
} Tie;

static int compare_ties(const void *a, const void *b) {
    const Tie *p = a, *q = b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    if (p->high != q->high) return p->high < q->high ? -1 : 1;
    return p->joint < q->joint ? -1 : p->joint > q->joint;
}

/* Merge groups until no two of them share two pivots: node 0 is the background, node i + 1 the input body i. */
static void merge_pinned(const SimInput *input, int32_t *parent, Tie *ties, double same_point) {
    for (bool merged = true; merged;) {
        merged = false;
        int32_t count = 0;
        for (int32_t j = 0; j < input->joint_count; j++) {
            int32_t a = find(parent, input->joint_bodies[2 * j] + 1),
                    b = find(parent, input->joint_bodies[2 * j + 1] + 1);
            if (a != b) ties[count++] = (Tie){a < b ? a : b, a < b ? b : a, j};
        }
        qsort(ties, (size_t)count, sizeof *ties, compare_ties);
        for (int32_t k = 1, first = 0; k < count; k++) {
            if (ties[k].low != ties[first].low || ties[k].high != ties[first].high) {
                first = k;
                continue;
            }
            const double *p = &input->joint_points[2 * ties[first].joint], *q = &input->joint_points[2 * ties[k].joint];
            int32_t low = find(parent, ties[k].low), high = find(parent, ties[k].high);
            if (vlength(vec(p[0] - q[0], p[1] - q[1])) > same_point && low != high) {
                parent[low < high ? high : low] = low < high ? low : high; /* the background's node 0 stays a root */
                merged = true;
            }
        }
    }
}

/* ---------------------------------------------------------------- bodies and shapes */

/* The rigid body of a group of inputs: total mass, centre of mass, momentum kept. */
static void gather_mass(Body *body, const SimInput *input, const int32_t *member, int32_t count) {
    const SimBody *first = &input->bodies[member[0]];
    body->angle = first->angle;
    if (count == 1) {
        body->position = vec(first->x, first->y);
        body->velocity = vec(first->vx, first->vy);
        body->spin = first->spin;
        body->mass = first->mass;
        body->moment = first->moment;
    } else {
        Vec moment_of_mass = {0, 0}, momentum = {0, 0};
        body->mass = 0;
        for (int32_t k = 0; k < count; k++) {
            const SimBody *b = &input->bodies[member[k]];
            body->mass += b->mass;
            moment_of_mass = vmad(moment_of_mass, b->mass, vec(b->x, b->y));
            momentum = vmad(momentum, b->mass, vec(b->vx, b->vy));
        }
        body->position = vscale(moment_of_mass, 1 / body->mass);
        body->velocity = vscale(momentum, 1 / body->mass);
        body->moment = 0;
        double turning = 0;
        for (int32_t k = 0; k < count; k++) {
            const SimBody *b = &input->bodies[member[k]];
            Vec r = vsub(vec(b->x, b->y), body->position);
            body->moment += b->moment + b->mass * vdot(r, r);
            turning += b->moment * b->spin + b->mass * vcross(r, vsub(vec(b->vx, b->vy), body->velocity));
        }
        body->spin = turning / body->moment;
    }
    body->inverse_mass = 1 / body->mass;
    body->inverse_moment = 1 / body->moment;
    body->mode = MODE_FLIGHT;
}

/* Copy an outline counter-clockwise, without the vertices that lie on the line between their neighbours. */
static int32_t copy_outline(Vec *out, const double *in, int32_t count, Pose frame) {
    double area = 0;
    for (int32_t i = 0; i < count; i++) {
        int32_t j = (i + 1) % count;
        area += (in[2 * i] - in[0]) * (in[2 * j + 1] - in[1]) - (in[2 * i + 1] - in[1]) * (in[2 * j] - in[0]);
    }
    int32_t kept = 0;
    for (int32_t i = 0; i < count; i++) {
        int32_t k = area > 0 ? i : count - 1 - i, before = (k + count - 1) % count, after = (k + 1) % count;
        Vec p = vec(in[2 * k], in[2 * k + 1]);
        Vec u = vsub(p, vec(in[2 * before], in[2 * before + 1])), v = vsub(vec(in[2 * after], in[2 * after + 1]), p);
        if (fabs(vcross(u, v)) > 1e-9 * vlength(u) * vlength(v) || vdot(u, v) < 0) out[kept++] = place(frame, p);
    }
    return kept;
}

static void bound_shape(Shape *shape, const Vec *v) {
    Vec low = v[0], high = v[0];
    for (int32_t i = 1; i < shape->count; i++) {
        low = vec(fmin(low.x, v[i].x), fmin(low.y, v[i].y));
        high = vec(fmax(high.x, v[i].x), fmax(high.y, v[i].y));
    }
    shape->centre = vscale(vadd(low, high), 0.5);
    shape->reach = 0;
    for (int32_t i = 0; i < shape->count; i++) shape->reach = fmax(shape->reach, vlength(vsub(v[i], shape->centre)));
    shape->reach += shape->radius;
}

static void measure_sides(Side *side, const Vec *v, int32_t count) {
    for (int32_t i = 0; i < count && count > 1; i++) {
        Vec to = vsub(v[(i + 1) % count], v[i]), from = vsub(v[i], v[(i + count - 1) % count]);
        double length = vlength(to);
        side[i] = (Side){vscale(to, 1 / length), length, vcross(from, to) <= 0};
    }
}

static void measure_stretches(Stretch *stretch, const Vec *v, int32_t count) {
    for (int32_t i = 0; i < count; i += STRETCH) {
        int32_t last = i + STRETCH < count ? i + STRETCH : count; /* the vertex that ends the last side */
        Vec low = v[i], high = v[i];
        for (int32_t j = i + 1; j <= last; j++) {
            Vec at = v[j % count];
            low = vec(fmin(low.x, at.x), fmin(low.y, at.y));
            high = vec(fmax(high.x, at.x), fmax(high.y, at.y));
        }
        stretch[i] = (Stretch){vscale(vadd(low, high), 0.5), 0.5 * vlength(vsub(high, low))};
    }
}

static void add_shape(World *world, const SimInput *input, int32_t source, int32_t carrier) {
    const SimBody *b = &input->bodies[source];
    Body *body = &world->body[carrier];
    Pose frame = body_pose(body);
    Shape *shape = &world->shape[world->shape_count];
    *shape = (Shape){.body = carrier,
                     .source = source,
                     .radius = b->radius,
                     .first = world->vertex_count,
                     .friction = b->friction,
                     .elasticity = b->elasticity,
                     .offset = unplace(frame, vec(b->x, b->y)),
                     .turned = b->angle - body->angle};
    Vec *out = &world->vertex[world->vertex_count];
    Pose local = pose(shape->offset, shape->turned);
    if (b->radius > 0) {
        out[0] = shape->offset;
        shape->count = 1;
    } else {
        int32_t start = input->vertex_start[source];
        shape->count = copy_outline(out, &input->vertices[2 * start], input->vertex_start[source + 1] - start, local);
    }
    bound_shape(shape, out);
    measure_sides(&world->side[shape->first], out, shape->count);
    measure_stretches(&world->stretch[shape->first], out, shape->count);
    world->vertex_count += shape->count;
    world->source_shape[source] = world->shape_count++;
    body->shape_count++;
    body->reach = fmax(body->reach, vlength(shape->centre) + shape->reach);
}

/* ---------------------------------------------------------------- joints and pairs that do not collide */

static uint64_t pair_key(int32_t a, int32_t b) {
    return a < b ? (uint64_t)a << 32 | (uint32_t)b : (uint64_t)b << 32 | (uint32_t)a;
}

int world_keep_apart(World *world, int32_t shape_a, int32_t shape_b) {
    if (world->apart_count == world->apart_capacity) {
        int32_t capacity = world->apart_capacity ? 2 * world->apart_capacity : 16;
        uint64_t *grown = realloc(world->apart, (size_t)capacity * sizeof *grown);
        if (!grown) return SIM_OUT_OF_MEMORY;
        world->apart = grown;
        world->apart_capacity = capacity;
    }
    uint64_t key = pair_key(shape_a, shape_b);
    int32_t at = world->apart_count;
    while (at > 0 && world->apart[at - 1] > key) at--;
    if (at > 0 && world->apart[at - 1] == key) return SIM_OK;
    memmove(&world->apart[at + 1], &world->apart[at], (size_t)(world->apart_count - at) * sizeof *world->apart);
    world->apart[at] = key;
    world->apart_count++;
    return SIM_OK;
}

bool world_collides(const World *world, int32_t shape_a, int32_t shape_b) {
    if (world->shape[shape_a].body == world->shape[shape_b].body) return false;
    uint64_t key = pair_key(shape_a, shape_b);
    int32_t low = 0, high = world->apart_count;
    while (low < high) {
        int32_t middle = (low + high) / 2;
        if (world->apart[middle] < key)
            low = middle + 1;
        else
            high = middle;
    }
    return low == world->apart_count || world->apart[low] != key;
}

static int add_joints(World *world, const SimInput *input) {
    for (int32_t j = 0; j < input->joint_count; j++) {
        int32_t a = input->joint_bodies[2 * j], b = input->joint_bodies[2 * j + 1];
        if (a >= 0 && b >= 0) {
            int status = world_keep_apart(world, world->source_shape[a], world->source_shape[b]);
            if (status != SIM_OK) return status;
        }
        int32_t body_a = a < 0 ? 0 : world->shape[world->source_shape[a]].body;
        int32_t body_b = b < 0 ? 0 : world->shape[world->source_shape[b]].body;
        if (body_a == body_b) continue;
        Vec p = vec(input->joint_points[2 * j], input->joint_points[2 * j + 1]);
        world->joint[world->joint_count++] = (Joint){body_a, body_b, unplace(body_pose(&world->body[body_a]), p),
                                                     unplace(body_pose(&world->body[body_b]), p)};
    }
    return SIM_OK;
}

/* Twice the area over the perimeter: a bar's thickness. */
static double shape_width(const World *world, const Shape *shape) {
    if (shape->count == 1) return shape->radius;
    const Vec *v = &world->vertex[shape->first];
    double area = 0, perimeter = 0;
    for (int32_t i = 0; i < shape->count; i++) {
        area += vcross(vsub(v[i], v[0]), vsub(v[(i + 1) % shape->count], v[0])) / 2;
        perimeter += world->side[shape->first + i].length;
    }
    return 2 * area / perimeter;
}

/* ---------------------------------------------------------------- the whole */

/* The carrier of each input, bodies numbered in the order of their first member, the background 0. */
static void make_bodies(World *world, const SimInput *input, int32_t *parent, int32_t *member, int32_t *group_size) {
    int32_t n = input->body_count;
    for (int32_t i = 0; i <= n; i++) group_size[i] = 0;
    for (int32_t i = 1; i <= n; i++) group_size[find(parent, i)]++;
    world->body[0] = (Body){.mass = INFINITY, .moment = INFINITY, .mode = MODE_FIXED};
    world->body_count = 1;
    for (int32_t root = 0; root <= n; root++) { /* a group's root is its lowest node */
        if (find(parent, root) != root) continue;
        int32_t count = 0;
        for (int32_t i = root > 0 ? root - 1 : 0; count < group_size[root]; i++)
            if (find(parent, i + 1) == root) member[count++] = i;
        int32_t carrier = root == 0 ? 0 : world->body_count++;
        Body *body = &world->body[carrier];
        if (carrier > 0) {
            *body = (Body){0};
            gather_mass(body, input, member, count);
        }
        body->first_shape = world->shape_count;
        for (int32_t k = 0; k < count; k++) add_shape(world, input, member[k], carrier);
    }
}

int world_create(World *world, const SimInput *input) {
    size_t n = (size_t)input->body_count, joints = (size_t)input->joint_count;
    size_t vertices = (size_t)input->vertex_start[n] + n;
    *world = (World){.gravity = {input->gravity[0], input->gravity[1]}, .source_count = input->body_count};
    world->body = malloc((n + 1) * sizeof *world->body);
    world->shape = malloc((n + 1) * sizeof *world->shape);
    world->vertex = malloc((vertices + 1) * sizeof *world->vertex);
    world->side = malloc((vertices + 1) * sizeof *world->side);
    world->stretch = malloc((vertices + 1) * sizeof *world->stretch);
    world->joint = malloc((joints + 1) * sizeof *world->joint);
    world->source_shape = malloc((n + 1) * sizeof *world->source_shape);
    int32_t *parent = malloc((n + 1) * sizeof *parent), *member = malloc((n + 1) * sizeof *member);
    int32_t *group_size = malloc((n + 1) * sizeof *group_size);
    Tie *ties = malloc((joints + 1) * sizeof *ties);
    int status = SIM_OUT_OF_MEMORY;
    if (!world->body || !world->shape || !world->vertex || !world->side || !world->stretch || !world->joint ||
        !world->source_shape)
        goto out;
    if (!parent || !member || !group_size || !ties) goto out;
    double size = 1e-9;
    for (int32_t i = 0; i < input->body_count; i++) {
        size = fmax(size, fabs(input->bodies[i].x) + fabs(input->bodies[i].y));
        parent[i + 1] = input->anchored[i] ? 0 : i + 1;
    }
    parent[0] = 0;
    merge_pinned(input, parent, ties, 1e-9 * size);
    make_bodies(world, input, parent, member, group_size);
    for (int32_t i = 0; i < world->shape_count; i++) size = fmax(size, world->shape[i].reach);
    world->size = size;
    world->thinnest = INFINITY;
    for (int32_t i = 0; i < world->shape_count; i++)
        world->thinnest = fmin(world->thinnest, shape_width(world, &world->shape[i]));
    status = add_joints(world, input);
out:
    free(parent);
    free(member);
    free(group_size);
    free(ties);
    if (status != SIM_OK) world_destroy(world);
    return status;
}

void world_destroy(World *world) {
    free(world->body);
    free(world->shape);
    free(world->vertex);
    free(world->side);
    free(world->stretch);
    free(world->piece);
    free(world->piece_vertex);
    free(world->piece_corner);
    free(world->joint);
    free(world->source_shape);
    free(world->apart);
    *world = (World){0};
}
