/* Who touches whom first: the search for first touches of all bodies that are not in the crowd. */
#include "exact.h"
#include "stopwatch.h"

#include <stdlib.h>

#define ALL_PAIRS_OF 16 /* bodies: fewer are not sorted for the search */
#define STEPS_OF_PAIR 32.0 /* of a search that cost as much again as looking at a pair at all */
#define GLANCE 0.5 /* of a pair: what it costs to see that the two do not come near each other */

/* The features of a pair that are closed: those of the island that both are of, or one with the background. */
static int32_t closed_features(Exact *e, int32_t a, int32_t b) {
    int32_t owner = e->track[a].island >= 0 ? e->track[a].island : e->track[b].island, count = 0;
    if (owner < 0) return 0;
    const Island *island = &e->island[owner];
    for (int32_t k = 0; k < island->contact_count; k++) {
        const Feature *f = &island->contact[k].feature;
        if (!((f->body_a == a && f->body_b == b) || (f->body_a == b && f->body_b == a))) continue;
        if (count == e->closed_capacity) {
            int32_t capacity = count ? 2 * count : 16;
            const Feature **grown = realloc(e->closed, (size_t)capacity * sizeof *grown);
            if (!grown) return count;
            e->closed = grown;
            e->closed_capacity = capacity;
        }
        e->closed[count++] = f;
    }
    return count;
}

/* Whether contacts hold two bodies so that neither moves against the other: at two points, and by friction at one. */
static bool is_one_piece(const Exact *e, int32_t a, int32_t b) {
    int32_t owner = e->track[a].island >= 0 ? e->track[a].island : e->track[b].island;
    if (owner < 0) return false;
    const Island *island = &e->island[owner];
    const Contact *first = NULL;
    bool sticks = false, two = false;
    for (int32_t k = 0; k < island->contact_count; k++) {
        const Contact *c = &island->contact[k];
        const Feature *f = &c->feature;
        if (!((f->body_a == a && f->body_b == b) || (f->body_a == b && f->body_b == a))) continue;
        if (!first) first = c;
        two = two || vlength(vsub(c->gap.point, first->gap.point)) > 8 * e->slack.gap;
        sticks = sticks || (c->slide == 0 && c->friction > 0);
    }
    return two && sticks;
}

static void find_touch(Exact *e, int32_t a, int32_t b, double from) {
    Track *ta = &e->track[a], *tb = &e->track[b];
    if (ta->motion.degree == 0 && tb->motion.degree == 0) return;
    if (b == 0 && e->world->body[0].shape_count == 0) return;
    double to = fmin(e->horizon, fmin(ta->motion.end, tb->motion.end));
    if (a != 0) to = fmin(to, fmax(ta->touch_time, b != 0 ? tb->touch_time : 0)); /* later ones are asked for again */
    if (to <= from) return;
    if (a != 0 && b != 0) { /* most pairs do not come near enough to need a closer look */
        double reach = e->world->body[a].reach + e->world->body[b].reach + e->slack.gap;
        if (course_apart(&e->course[a], &e->course[b], to - from, reach)) return;
        e->spent += GLANCE;
        if (course_nearest(&e->course[a], &e->course[b], to - from) > reach) return;
    }
    if (is_one_piece(e, a, b)) return;
    int32_t closed = closed_features(e, a, b);
    Mover ma = {a, &ta->motion}, mb = {b, &tb->motion};
    e->world->profile.pairs += 1;
    double steps = 0, t = first_touch(e->world, ma, mb, from, to, &e->slack, e->closed, closed, &steps);
    e->spent += 1 + steps / STEPS_OF_PAIR;
    if (t < ta->touch_time) ta->touch_time = t, ta->partner = b;
    if (b != 0 && t < tb->touch_time) tb->touch_time = t, tb->partner = a;
}

/* Where a body can be from some time until it is as late as `to` or its motion ends. */
static Box reached_box(const Exact *e, int32_t body, double from, double to) {
    const Course *c = &e->course[body];
    double time = fmax(0, fmin(to, e->track[body].motion.end) - from);
    double way = e->world->body[body].reach + e->slack.gap + c->speed * time + 0.5 * c->pull * time * time;
    return box_grow((Box){c->position, c->position}, way);
}

/* First touches of two bodies, of which one at least is marked as changed: few are all looked at, of many those whose
 * boxes meet. */
static int find_pairs_touches(Exact *e, double from) {
    int32_t n = e->world->body_count;
    if (n <= ALL_PAIRS_OF) {
        for (int32_t i = 1; i < n; i++)
            for (int32_t j = 1; e->changed[i] && is_tracked(e, i) && j < n; j++)
                if (j != i && is_tracked(e, j) && !(e->changed[j] && j < i)) find_touch(e, i, j, from);
        return SIM_OK;
    }
    double to = 0;
    for (int32_t i = 1; i < n; i++)
        if (e->changed[i] && is_tracked(e, i)) to = fmax(to, fmin(e->horizon, e->track[i].motion.end));
    for (int32_t i = 1; i < n; i++) {
        e->searched[i] = e->changed[i] && is_tracked(e, i);
        e->box[i] = is_tracked(e, i) ? reached_box(e, i, from, to) : (Box){vec(INFINITY, 0), vec(-INFINITY, 0)};
    }
    int status = sweep_pairs(&e->sweep, e->box, e->searched);
    for (int32_t k = 0; k < e->sweep.pair_count && status == SIM_OK; k++) {
        int32_t a = e->sweep.pair[k].a, b = e->sweep.pair[k].b;
        find_touch(e, e->searched[a] ? a : b, e->searched[a] ? b : a, from);
    }
    return status;
}

int search_touches(Exact *e, double from) {
    int32_t n = e->world->body_count;
    int status = SIM_OK;
    double start = seconds_now();
    for (int32_t i = 1; i < n; i++)
        if (!e->changed[i] && is_tracked(e, i) && isfinite(e->track[i].touch_time) && e->changed[e->track[i].partner])
            e->changed[i] = true; /* its partner goes another way now: look at all its pairs again */
    bool any = false;
    for (int32_t i = 1; i < n; i++) {
        if (!e->changed[i]) continue;
        e->track[i].touch_time = INFINITY;
        any = true;
    }
    for (int32_t i = 1; any && i < n; i++) e->course[i] = motion_course(&e->track[i].motion, from);
    for (int32_t i = 1; i < n; i++)
        if (e->changed[i] && is_tracked(e, i)) find_touch(e, i, 0, from);
    status = any ? find_pairs_touches(e, from) : SIM_OK;
    for (int32_t i = 1; i < n; i++) e->changed[i] = false;
    e->world->profile.search_time += seconds_now() - start;
    return status;
}

int search_farther(Exact *e) {
    double from = e->horizon;
    e->horizon *= 2;
    for (int32_t i = 1; i < e->world->body_count; i++)
        e->changed[i] = is_tracked(e, i) && e->track[i].motion.degree > 0;
    return search_touches(e, from);
}

int search_neighbours(Exact *e, double time) {
    int32_t n = e->world->body_count;
    for (int32_t i = 1; i < n; i++) {
        e->searched[i] = is_tracked(e, i);
        Vec at = e->searched[i] ? motion_position(&e->track[i].motion, time) : vec(INFINITY, INFINITY);
        e->box[i] = box_grow((Box){at, at}, e->world->body[i].reach + e->slack.gap);
    }
    int status = sweep_pairs(&e->sweep, e->box, e->searched);
    for (int32_t i = 1; i < n; i++) e->searched[i] = e->world->joint_count > 0;
    for (int32_t k = 0; k < e->sweep.pair_count && status == SIM_OK; k++)
        e->searched[e->sweep.pair[k].a] = e->searched[e->sweep.pair[k].b] = true;
    return status;
}
