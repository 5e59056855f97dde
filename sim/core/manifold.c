/* Contact points of convex pieces: separating axes, then the facing sides clipped against each other.
 *
 * The axis of greatest separation: Gottschalk 1996; clipping: Sutherland and Hodgman 1974, here of one side.
 * Pieces of a larger shape touch only as that shape does: nothing catches on the cuts between them.
 */
#include "manifold.h"

enum { SMALL = 8 }; /* outlines up to this size are searched vertex by vertex */

#define FROM_B 0x80000000u

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
        if (value < least) {
            least = value;
            at = j;
        }
    }
    return at;
}

/* The side of a from which b is farthest, or the first from which it is farther than `enough`.  The lowest vertex of b
 * turns with the sides of a (rotating calipers), so large outlines cost the sum of their vertices. */
static Facing face(const Outline *a, const Outline *b, double enough) {
    Facing best = {-INFINITY, -1, 0, false};
    int32_t low = 0;
    for (int32_t i = 0; i < a->count; i++) {
        Vec n = a->normal[i];
        low = b->count <= SMALL || i == 0 ? lowest(b, n) : descend(b, n, low);
        double separation = vdot(n, vsub(b->vertex[low], a->vertex[i]));
        if (separation <= best.separation) continue;
        bool touches = !is_cut(a, i) && (b->count == 1 || exposed(b, low, vscale(n, -1)));
        if (!touches && separation <= 0) continue;
        best = (Facing){separation, i, low, touches};
        if (separation > enough) break;
    }
    return best;
}

/* No contact; `gap` is how far the two are apart at least. */
static void apart(Manifold *m, Vec normal, double gap) {
    m->normal = normal;
    m->gap = gap;
    m->count = 0;
}

static void one_point(Manifold *m, Vec normal, Vec on_a, Vec on_b, uint32_t feature, double margin) {
    Vec d = vsub(on_b, on_a);
    double separation = vdot(normal, d);
    m->normal = normal;
    m->gap = separation;
    m->count = separation <= margin;
    m->point[0] = (ManifoldPoint){vmad(on_a, 0.5, d), separation, feature};
}

static void between_circles(const Outline *a, const Outline *b, double margin, Manifold *m) {
    Vec d = vsub(b->vertex[0], a->vertex[0]);
    double distance = vlength(d);
    Vec n = distance > 0 ? vscale(d, 1 / distance) : vec(0, 1);
    one_point(m, n, vmad(a->vertex[0], a->radius, n), vmad(b->vertex[0], -b->radius, n), 0, margin);
}

/* a is a polygon, b a circle. */
static void polygon_circle(const Outline *a, const Outline *b, double margin, Manifold *m) {
    Facing f = face(a, b, margin + b->radius);
    Vec centre = b->vertex[0];
    if (f.side < 0) { /* beyond cuts alone: another piece of the shape touches */
        apart(m, vec(0, 1), 0);
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
            one_point(m, n, a->vertex[end], vmad(centre, -b->radius, n), (uint32_t)end, margin);
        else
            apart(m, n, distance - b->radius);
    } else if (f.touches) {
        one_point(m, n, vmad(centre, -f.separation, n), vmad(centre, -b->radius, n), (uint32_t)f.side, margin);
    } else {
        apart(m, n, f.separation - b->radius);
    }
}

/* The nearest points of two facing sides, one of them or both a corner, where the sides are past each other's end.
 * Whether they are; `m` is then done. */
static bool past_end(const Outline *a, int32_t i, const Outline *b, int32_t j, bool flip, double margin, Manifold *m) {
    int32_t i2 = after(a, i), j2 = after(b, j);
    Vec p = a->vertex[i], q = a->vertex[i2], u = vsub(q, p);
    double uu = vdot(u, u), s = vdot(vsub(b->vertex[j], p), u), s2 = vdot(vsub(b->vertex[j2], p), u);
    int32_t corner_a, corner_b;
    if (s < 0 && s2 < 0) {
        corner_a = i;
        corner_b = s > s2 ? j : j2;
    } else if (s > uu && s2 > uu) {
        corner_a = i2;
        corner_b = s < s2 ? j : j2;
    } else {
        return false;
    }
    Vec c = a->vertex[corner_a], d = b->vertex[corner_b], v = vsub(b->vertex[j2], b->vertex[j]);
    double t = vdot(vsub(c, b->vertex[j]), v), vv = vdot(v, v);
    bool on_side = t > 0 && t < vv;
    if (on_side) d = vmad(b->vertex[j], t / vv, v);
    double distance = vlength(vsub(d, c));
    if (distance <= 0) return false;
    Vec n = vscale(vsub(d, c), 1 / distance), back = vscale(n, -1);
    bool touches = exposed(a, corner_a, n) && (on_side ? !is_cut(b, j) : exposed(b, corner_b, back));
    uint32_t feature = (uint32_t)corner_a | (flip ? FROM_B : 0);
    if (!touches)
        apart(m, flip ? back : n, distance);
    else if (flip)
        one_point(m, back, d, c, feature, margin);
    else
        one_point(m, n, c, d, feature, margin);
    return true;
}

/* The side of a that b faces, and the side of b that faces it, clipped to each other's span.  `flip`: the caller's pair
 * is (b, a). */
static void clip(const Outline *a, const Outline *b, Facing f, bool flip, double margin, Manifold *m) {
    Vec n = a->normal[f.side], t = vperp(n);
    int32_t i = f.side, i2 = after(a, i), j = f.vertex;
    if (vdot(b->normal[before(b, j)], n) < vdot(b->normal[j], n)) j = before(b, j);
    int32_t j2 = after(b, j);
    if (f.separation > 0 && past_end(a, i, b, j, flip, margin, m)) return;
    apart(m, flip ? vscale(n, -1) : n, f.separation);
    if (!f.touches) return;
    Vec p = a->vertex[i], first = b->vertex[j2], span = vsub(b->vertex[j], first); /* b's side along t */
    double start = vdot(p, t), end = vdot(a->vertex[i2], t), s = vdot(first, t), s2 = s + vdot(span, t);
    uint32_t mark_a = flip ? FROM_B : 0, mark_b = flip ? 0 : FROM_B;
    Vec ends[2] = {first, b->vertex[j]};
    uint32_t feature[2] = {mark_b | (uint32_t)j2, mark_b | (uint32_t)j};
    if (s < start && s2 > start) {
        ends[0] = vmad(first, (start - s) / (s2 - s), span);
        feature[0] = mark_a | (uint32_t)i;
    }
    if (s2 > end && s < end) {
        ends[1] = vmad(first, (end - s) / (s2 - s), span);
        feature[1] = mark_a | (uint32_t)i2;
    }
    for (int32_t k = 0; k < 2; k++) {
        double separation = vdot(vsub(ends[k], p), n);
        if (separation > margin) continue;
        m->point[m->count++] = (ManifoldPoint){vmad(ends[k], -0.5 * separation, n), separation, feature[k]};
    }
}

static void between_polygons(const Outline *a, const Outline *b, double margin, Manifold *m) {
    Facing of_a = face(a, b, margin);
    if (of_a.separation > margin) {
        apart(m, a->normal[of_a.side], of_a.separation);
        return;
    }
    Facing of_b = face(b, a, margin);
    if (of_b.separation > margin) {
        apart(m, vscale(b->normal[of_b.side], -1), of_b.separation);
        return;
    }
    if (of_a.side < 0 && of_b.side < 0) { /* across cuts alone: other pieces of the shapes touch */
        apart(m, vec(0, 1), 0);
        return;
    }
    /* near a tie a keeps the side, so that a resting pair does not change its mind from step to step */
    double tie = 1e-3 * (fabs(of_a.separation) + fabs(of_b.separation));
    if (of_a.side < 0 || of_b.separation > of_a.separation + tie)
        clip(b, a, of_b, true, margin, m);
    else
        clip(a, b, of_a, false, margin, m);
}

void manifold_find(const Outline *a, const Outline *b, double margin, Manifold *m) {
    if (a->count > 1 && b->count > 1) {
        between_polygons(a, b, margin, m);
    } else if (a->count > 1) {
        polygon_circle(a, b, margin, m);
    } else if (b->count > 1) {
        polygon_circle(b, a, margin, m);
        m->normal = vscale(m->normal, -1);
    } else {
        between_circles(a, b, margin, m);
    }
}
