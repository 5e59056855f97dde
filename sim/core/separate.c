/* Moving apart what was drawn overlapping.
 *
 * Hands draw a stack with its sides a little in each other.  The bodies are moved by the least motion, weighted by mass,
 * that leaves no overlap: minimize sum w |dx|^2 subject to n . (dx_b - dx_a) >= depth for every point in overlap, solved
 * by projected Gauss-Seidel on the multipliers, and again with the contacts found anew until nothing overlaps (sequential
 * quadratic programming).  The weight w is the root of the mass: with the mass itself a feather under an anvil would take
 * for ever.  Bodies keep their angles, but for those on joints, which are held together by rows of their own.
 */
#include <stdlib.h>

#include "posed.h"

static const double TOO_DEEP = 0.3;    /* of the smaller one's width: drawn over each other, not touching */
static const double TOUCHING = 1e-10;  /* of the scene's size: rounding */
static const double CONVERGED = 1e-13; /* of the scene's size */
static const int32_t ROUNDS = 40, POLISH = 10;
static const double ROW_BUDGET = 1e7;  /* rows looked at, all in all */
static const double COMPLIANCE = 0.1;  /* of a row whose wishes cannot all be met, relative to its mobility */

typedef struct Slide {
    Vec moved;
    double turned;
    double inverse_mass, inverse_moment;
    Vec drawn_position, apart_position; /* as drawn; as first found without overlap */
    double drawn_angle, apart_angle;
    bool jammed; /* its overlaps cannot all be undone */
} Slide;

typedef struct Row {
    int32_t a, b;
    int32_t shape_a, shape_b;
    Vec normal;
    double spin_a, spin_b;
    double gap;      /* negative: overlap */
    double mobility; /* how fast the gap opens with the push */
    double push;
} Row;

typedef struct Separation {
    World *world;
    Posed posed;
    Sweep sweep;
    Box *box;
    bool *moves;
    Slide *slide;
    Row *row, *last; /* of this round and the one before */
    int32_t row_count, row_capacity, last_count;
    double touching, deepest;
    double drawn_deepest, margin;
    double heaviest; /* weight of a body */
    double budget;   /* of rows */
} Separation;

static int create(Separation *s, World *world) {
    *s = (Separation){.world = world, .touching = TOUCHING * world->size, .budget = ROW_BUDGET};
    size_t shapes = (size_t)world->shape_count + 1, bodies = (size_t)world->body_count + 1;
    s->box = calloc(shapes, sizeof *s->box);
    s->moves = calloc(shapes, sizeof *s->moves);
    s->slide = calloc(bodies, sizeof *s->slide);
    if (!s->box || !s->moves || !s->slide) return SIM_OUT_OF_MEMORY;
    if (posed_create(&s->posed, world) != SIM_OK) return SIM_OUT_OF_MEMORY;
    for (int32_t i = 0; i < world->shape_count; i++) s->moves[i] = world->body[world->shape[i].body].inverse_mass > 0;
    for (int32_t i = 0; i < world->body_count; i++) {
        const Body *b = &world->body[i];
        if (b->inverse_mass > 0) s->heaviest = fmax(s->heaviest, 1 / sqrt(b->inverse_mass));
        s->slide[i] =
            (Slide){.inverse_mass = sqrt(b->inverse_mass), .drawn_position = b->position, .drawn_angle = b->angle};
    }
    for (int32_t i = 0; i < world->joint_count; i++)
        for (int32_t side = 0; side < 2; side++) {
            int32_t k = side ? world->joint[i].b : world->joint[i].a;
            const Body *b = &world->body[k];
            if (b->inverse_mass > 0) s->slide[k].inverse_moment = b->inverse_moment / sqrt(b->inverse_mass);
        }
    return sweep_create(&s->sweep, world->shape_count);
}

static void destroy(Separation *s) {
    posed_destroy(&s->posed);
    sweep_destroy(&s->sweep);
    free(s->box);
    free(s->moves);
    free(s->slide);
    free(s->row);
    free(s->last);
}

static int find_pairs(Separation *s, double margin) {
    const World *world = s->world;
    for (int32_t i = 0; i < world->body_count; i++) posed_place(&s->posed, world, i, body_pose(&world->body[i]));
    for (int32_t i = 0; i < world->shape_count; i++) {
        const Shape *shape = &world->shape[i];
        s->box[i] = posed_box(&s->posed, shape->first_piece);
        for (int32_t p = 1; p < shape->piece_count; p++)
            s->box[i] = box_join(s->box[i], posed_box(&s->posed, shape->first_piece + p));
        s->box[i] = box_grow(s->box[i], margin);
    }
    return sweep_pairs(&s->sweep, s->box, s->moves);
}

static double shape_area(const World *world, const Shape *shape) {
    if (shape->radius > 0) return 3.14159265358979323846 * shape->radius * shape->radius;
    const Vec *v = world->vertex + shape->first;
    double area = 0;
    for (int32_t k = 1; k + 1 < shape->count; k++) area += 0.5 * vcross(vsub(v[k], v[0]), vsub(v[k + 1], v[0]));
    return area;
}

static double pair_depth(const Separation *s, const Shape *a, const Shape *b) {
    double depth = 0;
    for (int32_t p = a->first_piece; p < a->first_piece + a->piece_count; p++)
        for (int32_t q = b->first_piece; q < b->first_piece + b->piece_count; q++) {
            Manifold m;
            manifold_find(&s->posed.outline[p], &s->posed.outline[q], 0, &m);
            if (m.count > 0) depth = fmax(depth, -m.gap);
        }
    return depth;
}

/* Pairs too deep in each other to be meant as touching are let overlap; of the others, how deep the deepest is. */
static int sort_out(Separation *s) {
    World *world = s->world;
    int status = find_pairs(s, 0);
    for (int32_t k = 0; k < s->sweep.pair_count && status == SIM_OK; k++) {
        Pair pair = s->sweep.pair[k];
        if (!world_collides(world, pair.a, pair.b)) continue;
        const Shape *a = &world->shape[pair.a], *b = &world->shape[pair.b];
        double depth = pair_depth(s, a, b);
        if (depth > TOO_DEEP * sqrt(fmin(shape_area(world, a), shape_area(world, b)))) {
            status = world_keep_apart(world, pair.a, pair.b);
            world->profile.let_overlap++;
        } else {
            s->deepest = fmax(s->deepest, depth);
        }
    }
    return status;
}

static int add_rows(Separation *s, const Manifold *m, Pair shapes) {
    const World *world = s->world;
    int32_t a = world->shape[shapes.a].body, b = world->shape[shapes.b].body;
    if (s->row_count + 2 > s->row_capacity) {
        int32_t capacity = 2 * s->row_capacity + 64;
        Row *more = realloc(s->row, (size_t)capacity * sizeof *more);
        if (more) s->row = more;
        Row *last = realloc(s->last, (size_t)capacity * sizeof *last);
        if (last) s->last = last;
        if (!more || !last) return SIM_OUT_OF_MEMORY;
        s->row_capacity = capacity;
    }
    const Slide *sa = &s->slide[a], *sb = &s->slide[b];
    for (int32_t k = 0; k < m->count; k++) {
        double gap = m->point[k].separation;
        if (fabs(gap) <= s->touching) gap = 0; /* touching already: not moved for the sake of rounding */
        Row row = {.a = a, .b = b, .shape_a = shapes.a, .shape_b = shapes.b, .normal = m->normal, .gap = gap};
        row.spin_a = vcross(vsub(m->point[k].point, world->body[a].position), m->normal);
        row.spin_b = vcross(vsub(m->point[k].point, world->body[b].position), m->normal);
        row.mobility = sa->inverse_mass + sb->inverse_mass + sa->inverse_moment * row.spin_a * row.spin_a +
                       sb->inverse_moment * row.spin_b * row.spin_b;
        s->row[s->row_count++] = row;
    }
    return SIM_OK;
}

static Vec joint_gap(const World *world, const Joint *joint) {
    return vsub(place(body_pose(&world->body[joint->b]), joint->local_b),
                place(body_pose(&world->body[joint->a]), joint->local_a));
}

/* The rows of all that touches or is near; the deepest overlap, or the widest that a joint has come apart. */
static int find_rows(Separation *s, double margin) {
    const World *world = s->world;
    int status = find_pairs(s, margin);
    Row *swap = s->last;
    s->last = s->row;
    s->last_count = s->row_count;
    s->row = swap;
    s->row_count = 0;
    s->deepest = 0;
    for (int32_t k = 0; k < s->sweep.pair_count; k++) {
        Pair pair = s->sweep.pair[k];
        if (!world_collides(world, pair.a, pair.b)) continue;
        const Shape *a = &world->shape[pair.a], *b = &world->shape[pair.b];
        for (int32_t p = a->first_piece; p < a->first_piece + a->piece_count && status == SIM_OK; p++)
            for (int32_t q = b->first_piece; q < b->first_piece + b->piece_count && status == SIM_OK; q++) {
                Manifold m;
                manifold_find(&s->posed.outline[p], &s->posed.outline[q], margin, &m);
                if (m.count == 0) continue;
                s->deepest = fmax(s->deepest, -m.gap);
                status = add_rows(s, &m, pair);
            }
    }
    for (int32_t i = 0; i < world->joint_count; i++)
        s->deepest = fmax(s->deepest, vlength(joint_gap(world, &world->joint[i])));
    return status;
}

static void apply(Slide *slide, Vec impulse, double spin, double sign) {
    slide->moved = vmad(slide->moved, sign * slide->inverse_mass, impulse);
    slide->turned += sign * slide->inverse_moment * spin;
}

static void push_row(const Row *row, Slide *a, Slide *b, double push) {
    apply(a, vscale(row->normal, push), push * row->spin_a, -1);
    apply(b, vscale(row->normal, push), push * row->spin_b, 1);
}

static double solve_row(Row *row, Slide *a, Slide *b) {
    double soft = a->jammed || b->jammed ? COMPLIANCE * row->mobility : 0;
    double gap = row->gap + vdot(row->normal, vsub(b->moved, a->moved)) + b->turned * row->spin_b -
                 a->turned * row->spin_a + soft * row->push;
    double push = row->push - gap / (row->mobility + soft);
    push = push > 0 ? push : 0;
    double change = push - row->push;
    row->push = push;
    push_row(row, a, b, change);
    return fabs(change) * row->mobility;
}

/* Bring the two points of a joint together. */
static double solve_joint(const World *world, const Joint *joint, Slide *slide) {
    Slide *a = &slide[joint->a], *b = &slide[joint->b];
    const Body *ba = &world->body[joint->a], *bb = &world->body[joint->b];
    Vec ra = turn(pose(ba->position, ba->angle), joint->local_a),
        rb = turn(pose(bb->position, bb->angle), joint->local_b);
    Vec apart =
        vadd(joint_gap(world, joint), vsub(vmad(b->moved, b->turned, vperp(rb)), vmad(a->moved, a->turned, vperp(ra))));
    double m = a->inverse_mass + b->inverse_mass, ia = a->inverse_moment, ib = b->inverse_moment;
    double k11 = m + ia * ra.y * ra.y + ib * rb.y * rb.y, k12 = -ia * ra.x * ra.y - ib * rb.x * rb.y;
    double k22 = m + ia * ra.x * ra.x + ib * rb.x * rb.x, det = k11 * k22 - k12 * k12;
    if (!(det > 0)) return 0;
    Vec j = vec((k12 * apart.y - k22 * apart.x) / det, (k12 * apart.x - k11 * apart.y) / det);
    apply(a, j, vcross(ra, j), -1);
    apply(b, j, vcross(rb, j), 1);
    return vlength(apart);
}

/* The wish of every body: back to where it was drawn.  What held it off in the round before does so from the start. */
static void wish(Separation *s) {
    const World *world = s->world;
    for (int32_t i = 0; i < world->body_count; i++) {
        Slide *slide = &s->slide[i];
        slide->moved = vsub(slide->drawn_position, world->body[i].position);
        slide->turned = slide->drawn_angle - world->body[i].angle;
    }
    bool same = s->row_count == s->last_count;
    for (int32_t i = 0; i < s->row_count && same; i++)
        same = s->row[i].a == s->last[i].a && s->row[i].b == s->last[i].b;
    for (int32_t i = 0; i < s->row_count && same; i++) {
        Row *row = &s->row[i];
        row->push = s->last[i].push;
        push_row(row, &s->slide[row->a], &s->slide[row->b], row->push);
    }
}

/* One round. Whether the rows could all be met; the bodies are moved in any case, the farthest so much as `farthest` says. */
static bool solve(Separation *s, bool from_drawn, double *farthest) {
    World *world = s->world;
    double enough = CONVERGED * world->size, rows = s->row_count + world->joint_count + 1;
    double far = 4 * s->drawn_deepest * rows * rows * s->heaviest; /* a stack of all there is would not push as hard */
    double most = INFINITY, hardest = 0;
    if (from_drawn) wish(s);
    while (most > enough && hardest < far && s->budget > 0) {
        most = 0;
        for (int32_t i = 0; i < s->row_count; i++) {
            Row *row = &s->row[i];
            most = fmax(most, solve_row(row, &s->slide[row->a], &s->slide[row->b]));
            hardest = fmax(hardest, row->push);
        }
        for (int32_t i = 0; i < world->joint_count; i++)
            most = fmax(most, solve_joint(world, &world->joint[i], s->slide));
        s->budget -= rows;
    }
    *farthest = 0;
    for (int32_t i = 0; i < world->body_count; i++) {
        Slide *slide = &s->slide[i];
        *farthest = fmax(*farthest, vlength(slide->moved) + world->body[i].reach * fabs(slide->turned));
        world->body[i].position = vadd(world->body[i].position, slide->moved);
        world->body[i].angle += slide->turned;
        slide->moved = vec(0, 0);
        slide->turned = 0;
    }
    return most <= enough;
}

static bool jam(Slide *a, Slide *b) {
    bool new_a = a->inverse_mass > 0 && !a->jammed, new_b = b->inverse_mass > 0 && !b->jammed;
    if (new_a) a->jammed = true;
    if (new_b) b->jammed = true;
    return new_a || new_b;
}

/* What still overlaps, or came off its joint, is jammed, with all that it touches or is joined to. Back to where it was drawn. */
static void mark_jammed(Separation *s) {
    World *world = s->world;
    for (bool more = true; more;) {
        more = false;
        for (int32_t i = 0; i < s->row_count; i++) {
            Slide *a = &s->slide[s->row[i].a], *b = &s->slide[s->row[i].b];
            double gap = s->row[i].gap;
            if (gap < -s->touching || (gap <= s->touching && (a->jammed || b->jammed))) more = jam(a, b) || more;
        }
        for (int32_t i = 0; i < world->joint_count; i++) {
            Slide *a = &s->slide[world->joint[i].a], *b = &s->slide[world->joint[i].b];
            bool apart = vlength(joint_gap(world, &world->joint[i])) > s->touching;
            if (apart || a->jammed || b->jammed) more = jam(a, b) || more;
        }
    }
    for (int32_t i = 0; i < world->body_count; i++) {
        if (!s->slide[i].jammed) continue;
        world->body[i].position = s->slide[i].drawn_position;
        world->body[i].angle = s->slide[i].drawn_angle;
    }
}

/* Jammed bodies on joints are let overlap as they were drawn: what they were held by is not known. Whether there are any. */
static int let_joined_overlap(Separation *s, bool *any) {
    *any = false;
    for (int32_t i = 0; i < s->row_count; i++) {
        const Row *row = &s->row[i];
        const Slide *a = &s->slide[row->a], *b = &s->slide[row->b];
        bool joined = (a->jammed && a->inverse_moment > 0) || (b->jammed && b->inverse_moment > 0);
        if (!joined || row->gap >= -s->touching || !world_collides(s->world, row->shape_a, row->shape_b)) continue;
        if (world_keep_apart(s->world, row->shape_a, row->shape_b) != SIM_OK) return SIM_OUT_OF_MEMORY;
        s->world->profile.let_overlap++;
        *any = true;
    }
    return SIM_OK;
}

static void report(const Separation *s) {
    World *world = s->world;
    for (int32_t i = 0; i < world->body_count; i++) {
        double moved = vlength(vsub(world->body[i].position, s->slide[i].drawn_position));
        if (moved <= s->touching) continue;
        world->profile.separated++;
        world->profile.separation = fmax(world->profile.separation, moved);
    }
}

/* Rounds until nothing overlaps, and until none moves any more where each starts from the drawing. Whether that was reached. */
static int iterate(Separation *s, int32_t rounds, bool from_drawn, bool *reached) {
    double farthest = from_drawn ? INFINITY : 0;
    bool met = true;
    *reached = false;
    for (int32_t round = 0; round <= rounds && met; round++) {
        int status = find_rows(s, s->margin);
        if (status != SIM_OK) return status;
        *reached = s->deepest <= s->touching && farthest <= s->touching;
        if (*reached || round == rounds) break;
        met = solve(s, from_drawn, &farthest);
        if (!from_drawn) farthest = 0;
    }
    return SIM_OK;
}

/* The overlaps that cannot all be undone, shared out. */
static int share_out(Separation *s) {
    double farthest;
    int status = find_rows(s, s->margin);
    s->budget = ROW_BUDGET / 10;
    if (status == SIM_OK) solve(s, false, &farthest);
    return status;
}

static int move_apart(Separation *s) {
    World *world = s->world;
    bool reached, joined = true;
    int status = iterate(s, ROUNDS, false, &reached);
    while (status == SIM_OK && !reached && joined) {
        mark_jammed(s);
        status = find_rows(s, s->margin);
        if (status == SIM_OK) status = let_joined_overlap(s, &joined);
        if (status != SIM_OK || !joined) break;
        for (int32_t i = 0; i < world->body_count; i++) s->slide[i].jammed = false;
        s->budget = ROW_BUDGET / 10;
        status = iterate(s, ROUNDS, false, &reached);
    }
    if (status != SIM_OK) return status;
    if (!reached) return share_out(s);
    /* Each round took the least motion from the last; all together need not have: again, from the drawing. */
    for (int32_t i = 0; i < world->body_count; i++) {
        s->slide[i].apart_position = world->body[i].position;
        s->slide[i].apart_angle = world->body[i].angle;
    }
    status = iterate(s, POLISH, true, &reached);
    for (int32_t i = 0; i < world->body_count && !reached; i++) {
        world->body[i].position = s->slide[i].apart_position;
        world->body[i].angle = s->slide[i].apart_angle;
    }
    return status;
}

int world_separate(World *world, double tolerance) {
    (void)tolerance;
    int status = world_decompose(world);
    if (status != SIM_OK) return status;
    Separation s;
    status = create(&s, world);
    if (status == SIM_OK) status = sort_out(&s);
    if (status == SIM_OK && s.deepest > s.touching) {
        s.drawn_deepest = s.deepest;
        s.margin = 2 * s.deepest;
        status = move_apart(&s);
        report(&s);
    }
    destroy(&s);
    return status;
}
