#include "feature.h"

/* Numbers of features: circles touch sides then corners, polygons a's corners on b's sides, then b's on a's. */
int32_t feature_count(const World *world, int32_t shape_a, int32_t shape_b) {
    int32_t a = world->shape[shape_a].count, b = world->shape[shape_b].count;
    return a > 1 && b > 1 ? 2 * a * b : a > 1 || b > 1 ? 2 * a * b : 1;
}

bool feature_make(const World *world, int32_t shape_a, int32_t shape_b, int32_t number, Feature *out) {
    const Shape *a = &world->shape[shape_a], *b = &world->shape[shape_b];
    bool swap = a->count > 1 && b->count == 1; /* the circle is a */
    if (a->count > 1 && b->count > 1 && number >= a->count * b->count) {
        swap = true;
        number -= a->count * b->count;
    }
    if (swap) {
        const Shape *s = a;
        a = b, b = s;
        int32_t k = shape_a;
        shape_a = shape_b, shape_b = k;
    }
    bool is_side = b->count > 1 && number < a->count * b->count;
    int32_t i = a->count > 1 ? number / b->count : 0, j = number % b->count;
    const Vec *va = &world->vertex[a->first], *vb = &world->vertex[b->first];
    const Side *side = &world->side[b->first];
    *out = (Feature){.shape_a = shape_a,
                     .shape_b = shape_b,
                     .body_a = a->body,
                     .body_b = b->body,
                     .index_a = i,
                     .index_b = j,
                     .is_side = is_side,
                     .point_a = va[i],
                     .point_b = vb[j],
                     .radius_a = a->radius,
                     .radius_b = b->radius};
    if (a->count > 1 && world->side[a->first + i].reflex) return false;
    if (b->count == 1) return true;
    out->along = side[j].along;
    out->length = side[j].length;
    if (is_side) return true;
    out->is_corner = true;
    out->along = side[(j + b->count - 1) % b->count].along;
    out->after = side[j].along;
    return !side[j].reflex;
}

/* The velocity of a body's material point at arm r from its centre. */
static Vec velocity_at(const Placed *b, Vec r) { return vmad(b->v, b->spin, vperp(r)); }

/* With P the point of a, E the start of b's side (or the point of b), rho = P - E, w = dP/dt - dE/dt, and n turning
 * with the side:  gap = rho.n - ra,  rate = w.n + spin_b rho.t;  between points n = rho / |rho|,  rate = w.n. */
Gap feature_gap(const Feature *f, const Placed *a, const Placed *b) {
    Vec ra = turn(a->at, f->point_a), rb = turn(b->at, f->point_b);
    Vec rho = vsub(vadd(a->at.p, ra), vadd(b->at.p, rb));
    Vec w = vsub(velocity_at(a, ra), velocity_at(b, rb));
    Gap g;
    if (f->is_side) {
        g.along = turn(b->at, f->along);
        g.normal = vec(g.along.y, -g.along.x); /* outwards, for sides that run counter-clockwise */
        double foot = vdot(rho, g.along), height = vdot(rho, g.normal);
        g.gap = height - f->radius_a;
        g.rate = vdot(w, g.normal) + b->spin * foot;
        g.slip = vdot(w, g.along) - f->radius_a * a->spin - b->spin * (height - f->radius_a);
        g.margin = fmin(foot, f->length - foot);
    } else {
        double distance = vlength(rho);
        g.normal = distance > 0 ? vscale(rho, 1 / distance) : vec(0, 1);
        g.along = vperp(g.normal);
        g.gap = distance - f->radius_a - f->radius_b;
        g.rate = vdot(w, g.normal);
        g.slip = vdot(w, g.along) - f->radius_a * a->spin - f->radius_b * b->spin;
        g.margin = f->is_corner ? fmin(vdot(rho, turn(b->at, f->along)), -vdot(rho, turn(b->at, f->after))) : INFINITY;
    }
    g.point = vmad(vadd(a->at.p, ra), -f->radius_a, g.normal);
    return g;
}

void feature_bias(const Feature *f, const Placed *a, const Placed *b, double *normal_bias, double *along_bias) {
    Vec ra = turn(a->at, f->point_a), rb = turn(b->at, f->point_b);
    Vec rho = vsub(vadd(a->at.p, ra), vadd(b->at.p, rb));
    Vec w = vsub(velocity_at(a, ra), velocity_at(b, rb));
    Vec centripetal = vsub(vscale(rb, b->spin * b->spin), vscale(ra, a->spin * a->spin));
    if (f->is_side) { /* n and t turn with b: dn/dt = spin_b t, dt/dt = -spin_b n */
        Vec t = turn(b->at, f->along), n = vec(t.y, -t.x);
        double wn = vdot(w, n), wt = vdot(w, t), foot = vdot(rho, t), height = vdot(rho, n), spin = b->spin;
        *normal_bias = vdot(centripetal, n) + 2 * spin * wt - spin * spin * height;
        *along_bias = vdot(centripetal, t) - spin * wn - spin * (wn + spin * foot);
    } else { /* dn/dt = (w.t / |rho|) t */
        double distance = vlength(rho);
        Vec n = distance > 0 ? vscale(rho, 1 / distance) : vec(0, 1), t = vperp(n);
        double wn = vdot(w, n), wt = vdot(w, t), turning = distance > 0 ? wt / distance : 0;
        *normal_bias = vdot(centripetal, n) + wt * turning;
        *along_bias = vdot(centripetal, t) - turning * wn;
    }
}

bool feature_same(const Feature *f, const Feature *g) {
    return f->shape_a == g->shape_a && f->shape_b == g->shape_b && f->index_a == g->index_a &&
           f->index_b == g->index_b && f->is_side == g->is_side;
}
