/* Contact points of convex pieces: separating axes, then the facing sides clipped against each other.
 *
 * The axis of greatest separation: Gottschalk 1996; clipping: Sutherland and Hodgman 1974, here of one side.
 */
#include "manifold.h"

enum { SMALL = 8 }; /* polygons up to this size are searched vertex by vertex */

#define FROM_B 0x80000000u

typedef struct Facing {
    double separation; /* of b from the side of a */
    int32_t side, vertex;
} Facing;

/* The vertex farthest against the normal, from `start` uphill. */
static int32_t climb(const Outline *b, Vec normal, int32_t start) {
    int32_t at = start, last = b->count - 1;
    double best = vdot(normal, b->vertex[at]);
    for (int32_t k = 0; k < b->count; k++) {
        int32_t next = at < last ? at + 1 : 0;
        double value = vdot(normal, b->vertex[next]);
        if (value > best) break;
        best = value;
        at = next;
    }
    for (int32_t k = 0; k < b->count; k++) {
        int32_t next = at > 0 ? at - 1 : last;
        double value = vdot(normal, b->vertex[next]);
        if (value >= best) break;
        best = value;
        at = next;
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
    Facing best = {-INFINITY, -1, 0};
    int32_t low = 0;
    for (int32_t i = 0; i < a->count; i++) {
        Vec n = a->normal[i];
        low = b->count <= SMALL || i == 0 ? lowest(b, n) : climb(b, n, low);
        double separation = vdot(n, vsub(b->vertex[low], a->vertex[i]));
        if (separation <= best.separation) continue;
        if (a->cut[i] && separation <= 0) continue;
        best = (Facing){separation, i, low};
        if (separation > enough) break;
    }
    return best;
}

static int32_t after(const Outline *a, int32_t i) { return i + 1 < a->count ? i + 1 : 0; }
static int32_t before(const Outline *a, int32_t i) { return i > 0 ? i - 1 : a->count - 1; }

static void one_point(Manifold *m, Vec normal, Vec on_a, Vec on_b, uint32_t feature, double margin) {
    Vec apart = vsub(on_b, on_a);
    double separation = vdot(normal, apart);
    m->normal = normal;
    m->gap = separation;
    m->count = separation <= margin;
    m->point[0] = (ManifoldPoint){vmad(on_a, 0.5, apart), separation, feature};
}

static void between_circles(const Outline *a, const Outline *b, double margin, Manifold *m) {
    Vec d = vsub(b->vertex[0], a->vertex[0]);
    double distance = vlength(d);
    Vec n = distance > 0 ? vscale(d, 1 / distance) : vec(0, 1);
    one_point(m, n, vmad(a->vertex[0], a->radius, n), vmad(b->vertex[0], -b->radius, n), 0, margin);
}

/* a is a polygon, b a circle. */
static void polygon_circle(const Outline *a, const Outline *b, double margin, Manifold *m) {
    Facing facing = face(a, b, margin + b->radius);
    Vec centre = b->vertex[0];
    m->count = 0;
    if (facing.side < 0) { /* beyond cuts alone: another piece of the shape touches */
        m->gap = 0;
        m->normal = vec(0, 1);
        return;
    }
    Vec p = a->vertex[facing.side], q = a->vertex[after(a, facing.side)], n = a->normal[facing.side];
    m->normal = n;
    m->gap = facing.separation - b->radius;
    if (m->gap > margin) return;
    uint32_t feature = (uint32_t)facing.side;
    if (facing.separation > 0) {
        Vec side = vsub(q, p);
        double along = vdot(vsub(centre, p), side);
        bool first = along < 0, last = along > vdot(side, side);
        if (first || last) {
            Vec end = first ? p : q;
            double distance = vlength(vsub(centre, end));
            n = vscale(vsub(centre, end), 1 / distance);
            one_point(m, n, end, vmad(centre, -b->radius, n), feature, margin);
            return;
        }
        if (a->cut[facing.side]) return;
    }
    one_point(m, n, vmad(centre, -facing.separation, n), vmad(centre, -b->radius, n), feature, margin);
}

/* The two sides face each other corner to corner: the contact is between the corners.  Whether it was so. */
static bool corners(Vec p1, Vec q1, Vec p2, Vec q2, uint32_t features[2], double margin, bool flip, Manifold *m) {
    Vec u = vsub(q1, p1), v = vsub(q2, p2), w = vsub(p2, p1);
    double uu = vdot(u, u), vv = vdot(v, v);
    /* side 2 runs against side 1: its end q2 is on p1's hand, its start p2 on q1's */
    Vec c1, c2;
    if (vdot(vsub(p2, p1), u) < 0 && vdot(vsub(q2, p1), u) < 0) {
        c1 = p1;
        c2 = vdot(vsub(p2, p1), u) > vdot(vsub(q2, p1), u) ? p2 : q2;
    } else if (vdot(vsub(p2, q1), u) > 0 && vdot(vsub(q2, q1), u) > 0) {
        c1 = q1;
        c2 = vdot(vsub(p2, p1), u) < vdot(vsub(q2, p1), u) ? p2 : q2;
    } else {
        return false;
    }
    (void)w;
    if (uu <= 0 || vv <= 0) return false;
    /* the point of side 2 nearest to the corner must be its end, or the corner faces the side */
    double t = vdot(vsub(c1, p2), v) / vv;
    if (t > 0 && t < 1) {
        Vec on = vmad(p2, t, v);
        if (vlength(vsub(on, c1)) < vlength(vsub(c2, c1))) c2 = on;
    }
    Vec d = vsub(c2, c1);
    double distance = vlength(d);
    if (distance <= 0) return false;
    Vec n = vscale(d, 1 / distance);
    if (flip)
        one_point(m, vscale(n, -1), c2, c1, features[1], margin);
    else
        one_point(m, n, c1, c2, features[1], margin);
    return true;
}

/* a has the side that b faces; `flip`: the caller's pair is (b, a). */
static void clip(const Outline *a, const Outline *b, Facing facing, bool flip, double margin, Manifold *m) {
    Vec n = a->normal[facing.side], t = vperp(n); /* t runs along the side: counter-clockwise has the outside right */
    int32_t i = facing.side, i2 = after(a, i), j = facing.vertex;
    if (vdot(b->normal[before(b, j)], n) < vdot(b->normal[j], n)) j = before(b, j);
    int32_t j2 = after(b, j);
    Vec p1 = a->vertex[i], q1 = a->vertex[i2], p2 = b->vertex[j], q2 = b->vertex[j2];
    uint32_t mark_a = flip ? FROM_B : 0, mark_b = flip ? 0 : FROM_B;
    m->normal = flip ? vscale(n, -1) : n;
    m->gap = facing.separation;
    m->count = 0;
    uint32_t features[2] = {mark_a | (uint32_t)i, mark_b | (uint32_t)facing.vertex};
    if (facing.separation > 0 && corners(p1, q1, p2, q2, features, margin, flip, m)) return;
    if (a->cut[i]) return;
    double start = vdot(p1, t), end = vdot(q1, t);
    Vec ends[2] = {q2, p2}; /* along t */
    uint32_t feature[2] = {mark_b | (uint32_t)j2, mark_b | (uint32_t)j};
    double at0 = vdot(q2, t), at1 = vdot(p2, t);
    Vec span = vsub(p2, q2);
    if (at0 < start && at1 > start) {
        ends[0] = vmad(q2, (start - at0) / (at1 - at0), span);
        feature[0] = mark_a | (uint32_t)i;
    }
    if (at1 > end && at0 < end) {
        ends[1] = vmad(q2, (end - at0) / (at1 - at0), span);
        feature[1] = mark_a | (uint32_t)i2;
    }
    for (int32_t k = 0; k < 2; k++) {
        double separation = vdot(vsub(ends[k], p1), n);
        if (separation > margin) continue;
        m->point[m->count++] = (ManifoldPoint){vmad(ends[k], -0.5 * separation, n), separation, feature[k]};
    }
}

static void between_polygons(const Outline *a, const Outline *b, double margin, Manifold *m) {
    m->count = 0;
    Facing of_a = face(a, b, margin);
    if (of_a.separation > margin) {
        m->normal = a->normal[of_a.side];
        m->gap = of_a.separation;
        return;
    }
    Facing of_b = face(b, a, margin);
    if (of_b.separation > margin) {
        m->normal = vscale(b->normal[of_b.side], -1);
        m->gap = of_b.separation;
        return;
    }
    if (of_a.side < 0 && of_b.side < 0) {
        m->gap = 0;
        m->normal = vec(0, 1);
        return;
    }
    /* near a tie a keeps the side, so that a resting pair does not change its mind from step to step */
    double tie = 1e-3 * (fabs(of_a.separation) + fabs(of_b.separation));
    if (of_a.side < 0 || of_b.separation > of_a.separation + tie)
        clip(b, a, of_b, true, margin, m);
    else
        clip(a, b, of_a, false, margin, m);
}

static void turn_round(Manifold *m) { m->normal = vscale(m->normal, -1); }

void manifold_find(const Outline *a, const Outline *b, double margin, Manifold *m) {
    if (a->count > 1 && b->count > 1) {
        between_polygons(a, b, margin, m);
    } else if (a->count > 1) {
        polygon_circle(a, b, margin, m);
    } else if (b->count > 1) {
        polygon_circle(b, a, margin, m);
        turn_round(m);
    } else {
        between_circles(a, b, margin, m);
    }
}
