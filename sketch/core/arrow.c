/* An arrow's reading: a shaft from its tail to the tip, and two barbs from the tip, fitted to all the ink of some strokes. */
#include "mark.h"

#include <math.h>
#include <string.h>

enum {
    BENDS = 6, /* as in core/strokes.c */
    STEPS = 12, /* along each part of an arrow, to look for its ink */
    MOST_STROKES = 3 /* of an arrow: its shaft and two barbs */
};

/* A head is two barbs alike, at some 35 degrees, less than half as long as the shaft; the spreads of these. */
static const double ALIKE = 0.35; /* of the logarithm of one barb over the other */
static const double SIZE = 0.45, SIZES = 0.4; /* of the shaft, and of its logarithm */
static const double BACK = 0.7,
                    BEYOND = 1.3; /* of a barb: how near to the tip ink comes back, how far it may go before */
static const double ANGLE = 0.6, ANGLES = 0.25; /* [rad] */

static const double RARE_ARROW = 2.0; /* nats that an arrow is rarer than an outline: there is one on a page, or none */
static const double SHAFT = 0.55; /* of the shaft: what the distance of an arrow's ink from it is measured in */
/* of the shaft: what the distance of an arrow from the nearest ink is measured in: a barb is drawn */
static const double GAPS = 0.5;
/* times that a shaft and the barbs of an arrow are drawn, at most: the pen comes back along a barb */
static const double OFTEN[] = {1.3, 2.0, 2.0};
static const double LOOP = 0.12; /* of its length: how far apart the ends of a loop are, at most */
static const double THICK = 0.2; /* of its extent: half the thickness of a loop that is no barb drawn forth and back */

typedef struct {
    double head[6]; /* the tip and the barbs' ends [pixels] */
    double lengths[3]; /* of the shaft and of the barbs [pixels] */
    double angles[2]; /* between barb and shaft */
    double unlike; /* nats of how unlike a head its head is */
    double ink[3]; /* length of the ink that is nearest to the shaft, and to each barb [pixels] */
    double bare; /* mean squared distance of the arrow from the ink [pixels²] */
    double off[MOST_STROKES]; /* of each stroke from the arrow */
} Arrow;

/* Whether the pen stops or turns back at a barb's end, sample `at` of a stroke's: from there it goes back toward the tip, to
 * either side, or nowhere. A bow of the shaft is no barb, nor is a leg of something larger. */
static int ends_there(const double *along, const double *across, int at, const double tip[2]) {
    double far = hypot(along[at] - tip[0], across[at] - tip[1]);
    for (int step = -1; step <= 1; step += 2)
        for (int i = at + step; i >= 0 && i < SAMPLES; i += step) {
            double d = hypot(along[i] - tip[0], across[i] - tip[1]);
            if (d < BACK * far) break;
            if (d > BEYOND * far) return 0;
        }
    return 1;
}

/* The arrow on `count` strokes; returns 0 where the ink has no head, a barb on each side that points back, or none that is
 * less than `most` nats unlike one. */
INK_WIDE static int fit_arrow(const double *samples, const double *length, const int32_t *names, int count,
                              const double *tail, const double *toward, double most, Arrow *out) {
    double *head = out->head, *lengths = out->lengths, *angles = out->angles, *ink = out->ink, *off = out->off;
    double ux = toward[0] - tail[0], uy = toward[1] - tail[1], l = hypot(ux, uy);
    if (l <= 0) return 0;
    ux /= l;
    uy /= l;
    double along[MOST_STROKES * SAMPLES], across[MOST_STROKES * SAMPLES]; /* the shaft */
    double reach = 0, left[2] = {0, 0}, right[2] = {0, 0};
    int total = count * SAMPLES, at_left = 0, at_right = 0;
    for (int k = 0; k < count; k++)
        for (int i = 0; i < SAMPLES; i++) {
            const double *p = samples + 2 * (SAMPLES * names[k] + i), x = p[0] - tail[0], y = p[1] - tail[1];
            along[k * SAMPLES + i] = x * ux + y * uy;
            across[k * SAMPLES + i] = y * ux - x * uy;
        }
    for (int i = 0; i < total; i++) {
        double s = along[i], h = across[i];
        if (s > reach) reach = s;
        if (h > left[1]) {
            left[0] = s;
            left[1] = h;
            at_left = i;
        }
        if (h < right[1]) {
            right[0] = s;
            right[1] = h;
            at_right = i;
        }
    }
    double sum = 0, n = 0;
    for (int i = 0; i < total; i++)
        if (along[i] > 0.96 * reach) {
            sum += across[i];
            n++;
        }
    if (reach <= 0) return 0;
    double tip[2] = {reach, sum / n}, origin[2] = {0, 0};
    lengths[0] = reach;
    lengths[1] = hypot(tip[0] - left[0], tip[1] - left[1]);
    lengths[2] = hypot(tip[0] - right[0], tip[1] - right[1]);
    angles[0] = atan2(left[1] - tip[1], tip[0] - left[0]);
    angles[1] = atan2(tip[1] - right[1], tip[0] - right[0]);
    for (int e = 0; e < 2; e++)
        if (angles[e] < 0.13 || angles[e] > 1.4 || lengths[e + 1] < 0.1 * reach) return 0;
    double alike = log(lengths[1] / lengths[2]) / ALIKE;
    double size = log((lengths[1] + lengths[2]) / 2 / lengths[0] / SIZE) / SIZES;
    double spread[2] = {(angles[0] - ANGLE) / ANGLES, (angles[1] - ANGLE) / ANGLES};
    out->unlike = 0.5 * (alike * alike + size * size + (spread[0] * spread[0] + spread[1] * spread[1]));
    if (out->unlike > most) return 0;
    for (int e = 0; e < 2; e++) {
        int at = e ? at_right : at_left, first = at - at % SAMPLES;
        if (!ends_there(along + first, across + first, at - first, tip)) return 0;
    }
    ink[0] = ink[1] = ink[2] = 0;
    for (int k = 0; k < count; k++) off[k] = 0;
    for (int i = 0; i < total; i++) {
        double s = along[i], h = across[i];
        const double d[3] = {segment_distance2(s, h, origin, tip), segment_distance2(s, h, tip, left),
                             segment_distance2(s, h, tip, right)};
        int nearest = d[1] < d[0] ? (d[2] < d[1] ? 2 : 1) : (d[2] < d[0] ? 2 : 0);
        off[i / SAMPLES] += d[nearest] / SAMPLES;
        ink[nearest] += length[8 * names[i / SAMPLES]] / SAMPLES;
    }
    /* An arrow has ink along all of it: a barb that nobody drew is as far off as ink that no arrow has. */
    const double *part[3][2] = {{origin, tip}, {tip, left}, {tip, right}};
    double s[3 * STEPS], h[3 * STEPS], nearest[3 * STEPS], whole = lengths[0] + lengths[1] + lengths[2];
    for (int i = 0; i < 3 * STEPS; i++) {
        const double *a = part[i / STEPS][0], *b = part[i / STEPS][1], t = (i % STEPS + 0.5) / STEPS;
        s[i] = a[0] + t * (b[0] - a[0]);
        h[i] = a[1] + t * (b[1] - a[1]);
        nearest[i] = INFINITY;
    }
    for (int j = 0; j < total; j++)
        for (int i = 0; i < 3 * STEPS; i++) {
            double ds = along[j] - s[i], dh = across[j] - h[i], d2 = ds * ds + dh * dh;
            nearest[i] = d2 < nearest[i] ? d2 : nearest[i];
        }
    out->bare = 0;
    for (int i = 0; i < 3 * STEPS; i++) out->bare += nearest[i] / STEPS * lengths[i / STEPS] / whole;
    const double *at[3] = {tip, left, right};
    for (int e = 0; e < 3; e++) {
        head[2 * e] = tail[0] + at[e][0] * ux - at[e][1] * uy;
        head[2 * e + 1] = tail[1] + at[e][0] * uy + at[e][1] * ux;
    }
    return 1;
}

int is_within_head(const double *samples, const Facts *piece, int32_t name, const double head[6]) {
    if (piece->gap < LOOP * piece->length && piece->scale > THICK * piece->extent) return 0;
    const double left = hypot(head[2] - head[0], head[3] - head[1]),
                 right = hypot(head[4] - head[0], head[5] - head[1]);
    return ink_within(samples, name, head, STRAY * (left + right));
}

/* Whether a stroke comes nearer to a place than `reach` [pixels]. */
static int comes_near(const double *samples, int32_t name, const double *place, double reach) {
    const double *p = samples + 2 * SAMPLES * name;
    for (int i = 0; i < SAMPLES; i++)
        if (hypot(p[2 * i] - place[0], p[2 * i + 1] - place[1]) < reach) return 1;
    return 0;
}

/* Nats to say the ink of an arrow's `count` strokes; infinite where they are more than `worse` above what it takes freely. */
static double price(const Arrow *arrow, const double *samples, const Facts *facts, const int32_t *names, int count,
                    double worse) {
    const double shaft = arrow->lengths[0], *ink = arrow->ink, model = RARE_ARROW + 4 * PARAMETER;
    double observations = 0, unread = 0, wrong = 0, off = 0;
    for (int k = 0; k < count; k++) {
        observations += facts[names[k]].observations;
        unread += facts[names[k]].unread;
    }
    /* what lacks, and what goes over the arrow more often than a hand does, takes as much to say as free ink */
    for (int e = 0; e < 3; e++)
        wrong += fmax(fmax(arrow->lengths[e] - ink[e], ink[e] - OFTEN[e] * arrow->lengths[e]), 0);
    const double gaps = GAPS * shaft, again = FREE * wrong / (ink[0] + ink[1] + ink[2]) * observations +
                                              misfit(arrow->bare / (gaps * gaps), observations);
    const double said = model + again + arrow->unlike, most = unread + worse;
    int at_tip = count == 1; /* an X that stands on a line is no head of it */
    for (int k = 0; k < count; k++) {
        const Facts *piece = facts + names[k];
        const int small = piece->extent < SMALL * shaft;
        at_tip |= k > 0 && comes_near(samples, names[k], arrow->head, piece->extent);
        /* an arrow whose ends meet is no loop, nor a barb that was drawn forth and back */
        const double scale = count == 1 ? SHAFT * shaft : small ? piece->extent / 2 : piece->scale;
        const double cost = misfit_of(piece, arrow->off[k], scale), freely = HEAD * piece->observations;
        if (said + off + (small ? fmin(cost, freely) : cost) > most) return INFINITY;
        off += cost > freely && small && is_within_head(samples, piece, names[k], arrow->head) ? freely : cost;
    }
    if (!at_tip) return INFINITY;
    const double cost = model + off + again + arrow->unlike;
    return cost > most ? INFINITY : cost;
}

/* An arrow as a reading. */
typedef struct {
    double cost; /* nats */
    double figure[6][2]; /* a closed polygon along it: tail, tip, a barb's end, tip, the other's, tip [pixels] */
} ReadArrow;

/* Add the arrow on a group of strokes, if it is one that is not dear. Returns how many there are then. */
static int add_arrow(const double *samples, const double *length, const Facts *facts, const int32_t *group, int count,
                     const double *tail, const double *toward, double worse, ReadArrow *arrows, int32_t *groups,
                     int found) {
    double slack = worse - (RARE_ARROW + 4 * PARAMETER);
    for (int k = 0; k < count; k++) slack += facts[group[k]].unread;
    Arrow fit;
    if (!fit_arrow(samples, length, group, count, tail, toward, slack, &fit)) return found;
    ReadArrow *read = arrows + found;
    read->cost = price(&fit, samples, facts, group, count, worse);
    if (!isfinite(read->cost)) return found;
    const double *along[] = {tail, fit.head, fit.head + 2, fit.head, fit.head + 4, fit.head};
    for (int k = 0; k < 6; k++) memcpy(read->figure[k], along[k], sizeof read->figure[k]);
    for (int k = 0; k < MOST_STROKES; k++) groups[MOST_STROKES * found + k] = k < count ? group[k] : -1;
    return found + 1;
}

/* Arrows of shafts with their heads.
 *
 * samples: of every stroke of the page, (strokes, SAMPLES, 2) [pixels]; length: of each stroke, a row of `measure` apart
 * [pixels]; vertices: as of ink_strokes; facts: of each.
 * names: of each shaft its stroke, then those that may be its head, one shaft after another; ends: where each of `count`
 * shafts ends; heads: (count, 2): how many strokes may make the head, at least and at most, up to two: none where the stroke
 * is the whole arrow; given: (count, 4): the shaft's tail and a point on the way to the tip, not of a whole arrow.
 * worse: nats more than their ink takes freely that arrows are looked for up to.
 * Out: arrows, in order; groups: (arrows, MOST_STROKES) the strokes of each, the shaft's first, -1 for none. There is room
 * for all combinations. Returns how many there are. */
INK_API int32_t ink_arrows(const double *samples, const double *length, const double *vertices, const Facts *facts,
                           const int32_t *names, const int32_t *ends, int32_t count, const int32_t *heads,
                           const double *given, double worse, ReadArrow *arrows, int32_t *groups) {
    int found = 0;
    for (int g = 0, first = 0; g < count; first = ends[g++]) {
        const int32_t *name = names + first, least = heads[2 * g], most = heads[2 * g + 1];
        const int near = ends[g] - first;
        for (int k = 3; k <= 5 && most == 0; k++) { /* its shaft is the first of some sides, or the last */
            const double *v = vertices + 2 * (BENDS + 1) * ((BENDS + 1) * name[0] + k), *end = v + 2 * k;
            found = add_arrow(samples, length, facts, name, 1, v, v + 2, worse, arrows, groups, found);
            found = add_arrow(samples, length, facts, name, 1, end, end - 2, worse, arrows, groups, found);
        }
        for (int size = least > 1 ? least : 1; size <= most; size++)
            for (int a = 1; a < near; a++)
                for (int b = a + 1; b < (size > 1 ? near : a + 2); b++) {
                    const int32_t group[] = {name[0], name[a], size > 1 ? name[b] : -1};
                    const double *tail = given + 4 * g;
                    found = add_arrow(samples, length, facts, group, size + 1, tail, tail + 2, worse, arrows, groups,
                                      found);
                }
    }
    return found;
}
