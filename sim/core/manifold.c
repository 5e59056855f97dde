/* Contact points of convex pieces: separating axes, then the facing sides clipped against each other.
 *
 * The axis of greatest separation: Gottschalk 1996; clipping: Sutherland and Hodgman 1974, here of one side.
 * Pieces of a larger shape touch only as that shape does: nothing catches on the cuts between them.
 */
#include "manifold.h"

#include "broad.h"

enum { SMALL = 8 }; /* outlines up to this size are searched vertex by vertex */

static int32_t after(const Outline *o, int32_t i) { return i + 1 < o->count ? i + 1 : 0; }
static int32_t before(const Outline *o, int32_t i) { return i > 0 ? i - 1 : o->count - 1; }

static bool is_cut(const Outline *o, int32_t i) {
    return o->leaving && (o->leaving[i].x != o->normal[i].x || o->leaving[i].y != o->normal[i].y);
}

/* Whether the whole shape, too, can be touched at this vertex from outside along n: n lies between the normals of its two
 * sides.  No convex body reaches a concave corner. */
static bool exposed(const Outline *o, int32_t i, Vec n) {
    static const double LEEWAY = 1e-3; /* [rad] */
    if (!o->arriving) return true;
    Vec in = o->arriving[i], out = o->leaving[i];
    return vcross(in, out) > -LEEWAY && vcross(in, n) > -LEEWAY && vcross(n, out) > -LEEWAY &&
           vdot(n, vadd(in, out)) > 0;
}

typedef struct Facing {
    double separation; /* of b from the side of a */
    int32_t side, vertex;
    bool touches;      /* the shapes can touch there; if not, it only tells how far they are apart */
} Facing;

/* Of all sides, and of those where the shapes can touch. */
typedef struct Facings {
    Facing any, touching;
} Facings;

/* The vertex farthest against the normal, from `start` on. */
static int32_t descend(const Outline *b, Vec normal, int32_t start) {
    int32_t at = start;
    double least = vdot(normal, b->vertex[at]);
    for (int32_t way = 0; way < 2; way++) {
        for (int32_t k = 0; k < b->count; k++) {
            int32_t next = way ? before(b, at) : after(b, at);
            double value = vdot(normal, b->vertex[next]);
            if (way ? value >= least : value > least) break;
            least = value;
            at = next;
        }
    }
    return at;
}

static int32_t lowest(const Outline *b, Vec normal) {
    int32_t at = 0;
    double least = vdot(normal, b->vertex[0]);
    for (int32_t j = 1; j < b->count; j++) {
        double value = vdot(normal, b->vertex[j]);
        at = value < least ? j : at;
        least = smaller(value, least);
    }
    return at;
}

/* The side of a from which b is farthest, or the first from which it is farther than `enough`.  The lowest vertex of b
 * turns with the sides of a (rotating calipers), so large outlines cost the sum of their vertices. */
static Facings face(const Outline *a, const Outline *b, double enough) {
    Facings best = {{-INFINITY, -1, 0, false}, {-INFINITY, -1, 0, true}};
    int32_t low = 0;
    for (int32_t i = 0; i < a->count; i++) {
        Vec n = a->normal[i];
        low = b->count <= SMALL || i == 0 ? lowest(b, n) : descend(b, n, low);
        double separation = vdot(n, vsub(b->vertex[low], a->vertex[i]));
        if (separation <= best.touching.separation) continue;
        bool touches = !is_cut(a, i) && (b->count == 1 || exposed(b, low, vscale(n, -1)));
        Facing facing = {separation, i, low, touches};
        if (touches) best.touching = facing;
        if (separation > best.any.separation) best.any = facing;
        if (separation > enough) break;
    }
    return best;
}

/* Overlapping outlines touch at the side that is nearest to parting them, or nearly so, if the shapes can touch there; else
 * other pieces of the shapes do. */
static const double NEARLY = 3;

static Facing choose(Facings f, double least) {
    Facing none = {-INFINITY, -1, 0, false};
    if (least > 0) return f.any;
    return f.touching.separation >= NEARLY * least ? f.touching : none;
}

/* No contact; `gap` is how far the two are apart at least. */
static void apart(Manifold *m, Vec normal, double gap) {
    m->normal = normal;
    m->gap = gap;
    m->count = m->side = 0;
}

static void one_point(Manifold *m, Vec normal, Vec on_a, Vec on_b, double margin) {
    Vec d = vsub(on_b, on_a);
    double separation = vdot(normal, d);
    m->normal = normal;
    m->gap = separation;
    m->count = separation <= margin;
    m->side = 0;
    m->point[0] = (ManifoldPoint){vmad(on_a, 0.5, d), separation};
}

static void between_circles(const Outline *a, const Outline *b, double margin, Manifold *m) {
    Vec d = vsub(b->vertex[0], a->vertex[0]);
    double distance = vlength(d);
    Vec n = distance > 0 ? vscale(d, 1 / distance) : vec(0, 1);
    one_point(m, n, vmad(a->vertex[0], a->radius, n), vmad(b->vertex[0], -b->radius, n), margin);
}

/* a is a polygon, b a circle. */
static void polygon_circle(const Outline *a, const Outline *b, double margin, Manifold *m) {
    Facings facings = face(a, b, margin + b->radius);
    Facing f = choose(facings, facings.any.separation);
    Vec centre = b->vertex[0];
    if (f.side < 0) {
        apart(m, a->normal[facings.any.side], facings.any.separation - b->radius);
        return;
    }
    Vec n = a->normal[f.side];
    if (f.separation - b->radius > margin) {
        apart(m, n, f.separation - b->radius);
        return;
    }
    int32_t end = f.side;
    Vec p = a->vertex[f.side], side = vsub(a->vertex[after(a, f.side)], p);
    double along = vdot(vsub(centre, p), side);
    bool beyond = along > vdot(side, side);
    if (beyond) end = after(a, f.side);
    if (f.separation > 0 && (along < 0 || beyond)) {
        Vec d = vsub(centre, a->vertex[end]);
        double distance = vlength(d);
        n = vscale(d, 1 / distance);
        if (exposed(a, end, n))
            one_point(m, n, a->vertex[end], vmad(centre, -b->radius, n), margin);
        else
            apart(m, n, distance - b->radius);
    } else if (f.touches) {
        one_point(m, n, vmad(centre, -f.separation, n), vmad(centre, -b->radius, n), margin);
        m->side = 1;
    } else {
        apart(m, n, f.separation - b->radius);
    }
}

/* Whether the vertex lies straight out from the side: then no two points of the outlines are nearer to each other. */
static bool straight_out(const Outline *a, Facing f, const Outline *b) {
    Vec p = a->vertex[f.side], side = vsub(a->vertex[after(a, f.side)], p), d = vsub(b->vertex[f.vertex], p);
    double along = vdot(d, side);
    return along >= 0 && along <= vdot(side, side);
}

/* The nearest points of two outlines that are apart: a corner of one, and a corner or a side of the other. */
typedef struct Nearest {
    double square; /* of the distance */
    int32_t side, vertex, end; /* of the one with the side, of the other; the corner that it is, or -1 */
    bool flip;     /* b has the side */
} Nearest;

static void nearer(const Outline *a, const Outline *b, bool flip, Nearest *best) {
    for (int32_t i = 0; i < a->count; i++) {
        int32_t i2 = after(a, i);
        Vec p = a->vertex[i], side = vsub(a->vertex[i2], p);
        double length = vdot(side, side);
        for (int32_t j = 0; j < b->count; j++) {
            Vec d = vsub(b->vertex[j], p);
            double along = vdot(d, side);
            int32_t end = along <= 0 ? i : along >= length ? i2 : -1;
            Vec away = end < 0 ? vmad(d, -along / length, side) : vsub(b->vertex[j], a->vertex[end]);
            double square = vdot(away, away);
            if (square < best->square) *best = (Nearest){square, i, j, end, flip};
        }
    }
}

/* A corner of a against a corner of b. */
static void corners(const Outline *a, int32_t i, const Outline *b, int32_t j, double margin, Manifold *m) {
    Vec d = vsub(b->vertex[j], a->vertex[i]);
    double distance = vlength(d);
    Vec n = vscale(d, 1 / distance);
    if (exposed(a, i, n) && exposed(b, j, vscale(n, -1)))
        one_point(m, n, a->vertex[i], b->vertex[j], margin);
    else
        apart(m, n, distance);
}

/* The side of a that b faces, and the side of b that faces it, clipped to each other's span.  `flip`: the caller's pair
 * is (b, a). */
static void clip(const Outline *a, const Outline *b, Facing f, bool flip, double margin, Manifold *m) {
    Vec n = a->normal[f.side], t = vperp(n);
    int32_t i = f.side, i2 = after(a, i), j = f.vertex;
    if (vdot(b->normal[before(b, j)], n) < vdot(b->normal[j], n)) j = before(b, j);
    int32_t j2 = after(b, j);
    apart(m, flip ? vscale(n, -1) : n, f.separation);
    m->side = flip ? -1 : 1;
    if (!f.touches) return;
    Vec p = a->vertex[i], first = b->vertex[j2], span = vsub(b->vertex[j], first); /* b's side along t */
    double start = vdot(p, t), end = vdot(a->vertex[i2], t), s = vdot(first, t), s2 = s + vdot(span, t);
    Vec ends[2] = {first, b->vertex[j]};
    if (s < start && s2 > start) ends[0] = vmad(first, (start - s) / (s2 - s), span);
    if (s2 > end && s < end) ends[1] = vmad(first, (end - s) / (s2 - s), span);
    for (int32_t k = 0; k < 2; k++) {
        double separation = vdot(vsub(ends[k], p), n);
        if (separation > margin) continue;
        m->point[m->count++] = (ManifoldPoint){vmad(ends[k], -0.5 * separation, n), separation};
    }
}

static void between_polygons(const Outline *a, const Outline *b, double margin, Manifold *m) {
    Facings of_a = face(a, b, margin);
    if (of_a.any.separation > margin) {
        apart(m, a->normal[of_a.any.side], of_a.any.separation);
        return;
    }
    Facings of_b = face(b, a, margin);
    if (of_b.any.separation > margin) {
        apart(m, vscale(b->normal[of_b.any.side], -1), of_b.any.separation);
        return;
    }
    double least = larger(of_a.any.separation, of_b.any.separation);
    Facing from_a = choose(of_a, least), from_b = choose(of_b, least);
    if (from_a.side < 0 && from_b.side < 0) {
        apart(m, a->normal[of_a.any.side], least);
        return;
    }
    /* near a tie a keeps the side, so that a resting pair does not change its mind from step to step */
    bool flip = from_b.separation > from_a.separation + 1e-3 * fabs(least);
    Facing f = flip ? from_b : from_a;
    if (f.separation > 0 && !straight_out(flip ? b : a, f, flip ? a : b)) {
        Nearest nearest = {.square = INFINITY};
        nearer(a, b, false, &nearest);
        nearer(b, a, true, &nearest);
        if (nearest.end >= 0) {
            bool b_has_side = nearest.flip;
            corners(a, b_has_side ? nearest.vertex : nearest.end, b, b_has_side ? nearest.end : nearest.vertex, margin,
                    m);
            return;
        }
        flip = nearest.flip;
        const Outline *sided = flip ? b : a, *cornered = flip ? a : b;
        bool touches =
            !is_cut(sided, nearest.side) && exposed(cornered, nearest.vertex, vscale(sided->normal[nearest.side], -1));
        f = (Facing){sqrt(nearest.square), nearest.side, nearest.vertex, touches};
    }
    clip(flip ? b : a, flip ? a : b, f, flip, margin, m);
}

void manifold_find(const Outline *a, const Outline *b, double margin, Manifold *m) {
    if (a->count > 1 && b->count > 1) {
        between_polygons(a, b, margin, m);
    } else if (a->count > 1) {
        polygon_circle(a, b, margin, m);
    } else if (b->count > 1) {
        polygon_circle(b, a, margin, m);
        m->normal = vscale(m->normal, -1);
        m->side = -m->side;
    } else {
        between_circles(a, b, margin, m);
    }
}
