/* An X: two bars that cross near their middles, in two strokes or in one. */
#include "facts.h"

#include <math.h>
#include <string.h>

enum {
    BENDS = 6, /* as in core/strokes.c */
    LEGS = 12, /* likewise */
    SINGLE = 3,
    PAIRS = 6, /* ways in which one stroke, or two, may be such bars and what joins them */
    MOST = 6 /* sides of all strokes of an X */
};

static const double CROSS = 24.0;    /* nats to say its bars: six parameters */
static const double JOINING = 0.5;   /* of an X's ink: what joins its bars, at most */
static const double ONE_SIDE = 0.35; /* of an X's ink: what a side takes that joins its bars; the rest is said freely */
static const double JOINED = 0.3; /* of a bar's length: as near to its end is what joins it */
static const double MOSTLY = 0.6; /* of an X's ink: what lies on its bars, where what joins them goes any way */
static const double OFF_BAR = 0.22; /* of an X's half extent: ink further from its bars is rather said freely */
static const double LEAST_SINE = 0.3; /* of the angle at which bars cross: 17 degrees */
static const double UNLIKE = 3.0; /* times that one bar is as long as the other, at most */
static const double AT_END = 0.1; /* of a bar's length: nearer to its end no other crosses it */
static const double OFF_MIDDLE = 0.12; /* of a bar's length: how far from its middle the other usually crosses it */
static const double AS_LONG =
    0.3; /* of the logarithm of the bars' lengths' ratio: how much it usually differs from 0 */

/* A side of a stroke that may be a bar. */
typedef struct {
    int part, at, bends; /* of the X the stroke, of that the side, of so many */
    const double *from, *to;
    double length;
} Side;

typedef struct {
    double cost, rough; /* nats; and of these, to say the ink */
    double figure[9][2]; /* a closed polygon along it, the ends of its bars first [pixels] */
} Cross;

/* Nats of how far from their middles two bars cross, and of how unlike they are.  Returns 0 for no X. */
INK_API int32_t ink_crossing(const double *a, const double *b, const double *c, const double *d, double odd[2]) {
    double ux = b[0] - a[0], uy = b[1] - a[1], vx = d[0] - c[0], vy = d[1] - c[1], wx = c[0] - a[0], wy = c[1] - a[1];
    double p = hypot(ux, uy), q = hypot(vx, vy), det = ux * vy - uy * vx;
    if (fabs(det) < LEAST_SINE * p * q || fmax(p, q) > UNLIKE * fmin(p, q)) return 0;
    double t = (wx * vy - wy * vx) / det, s = (wx * uy - wy * ux) / det;
    if (!(AT_END < t && t < 1 - AT_END && AT_END < s && s < 1 - AT_END)) return 0;
    double alike = log(p / q) / AS_LONG;
    odd[0] = ((t - 0.5) * (t - 0.5) + (s - 0.5) * (s - 0.5)) / (2 * OFF_MIDDLE * OFF_MIDDLE);
    odd[1] = 0.5 * alike * alike;
    return 1;
}

static double distance(const double *a, const double *b) { return hypot(a[0] - b[0], a[1] - b[1]); }

/* Nats to say a stroke's ink, given two bars on which most of it lies, and what joins them freely. */
static double joined(const double *ink, const Facts *piece, const Side *one, const Side *other) {
    const double half = piece->extent / 2, near = OFF_BAR * half;
    double sum = 0, on = 0;
    for (int i = 0; i < SAMPLES; i++) {
        const double off2 = fmin(segment_distance2(ink[2 * i], ink[2 * i + 1], one->from, one->to),
                                 segment_distance2(ink[2 * i], ink[2 * i + 1], other->from, other->to));
        if (off2 >= near * near) continue;
        sum += off2;
        on++;
    }
    const double share = on / SAMPLES;
    if (share < MOSTLY) return INFINITY;
    return misfit(sum / on / (half * half), share * piece->observations) + FREE * (1 - share) * piece->observations;
}

/* How much of a stroke of an X goes on beyond its bar to no end of the other [pixels]. */
static double elsewhere(const Side *bar, const Side *other) {
    double found = 0;
    for (int step = -1; step <= 1; step += 2) { /* to where the stroke begins, and to where it ends */
        const double *begin = step < 0 ? bar->from : bar->to;
        const int sides = step < 0 ? bar->at : bar->bends - bar->at - 1;
        const double *end = begin + 2 * step * sides;
        if (fmin(distance(end, other->from), distance(end, other->to)) <= JOINED * other->length) continue;
        for (int k = 0; k < sides; k++, begin += 2 * step) found += distance(begin, begin + 2 * step);
    }
    return found;
}

/* An X of one stroke or two, the cheapest; returns 0 where there is none in `most` nats.
 *
 * samples, residual, vertices: of every stroke of the page, as of ink_strokes; facts: of each.
 * names: of the `count` strokes. */
INK_API int32_t ink_cross(const double *samples, const double *residual, const double *vertices, const Facts *facts,
                          const int32_t *names, int32_t count, double most, Cross *out) {
    static const int one[SINGLE][2] = {{3}, {4}, {5}};
    static const int two[PAIRS][2] = {{1, 1}, {1, 2}, {2, 1}, {1, 3}, {3, 1}, {2, 2}};
    const int single = count == 1;
    double length = 0, observations = 0;
    for (int k = 0; k < count; k++) {
        length += facts[names[k]].length;
        observations += facts[names[k]].observations;
    }
    int found = 0;
    for (int w = 0; w < (single ? SINGLE : PAIRS); w++) {
        const int *bends = single ? one[w] : two[w];
        double off = 0;
        for (int k = 0; k < count; k++) {
            const Facts *piece = facts + names[k];
            off += misfit_of(piece, residual[(LEGS + 1) * names[k] + bends[k]], piece->scale);
        }
        if (CROSS + off > most && !single) continue;
        Side sides[MOST];
        int n = 0;
        for (int k = 0; k < count; k++) {
            const double *v = vertices + 2 * (BENDS + 1) * ((BENDS + 1) * names[k] + bends[k]);
            for (int at = 0; at < bends[k]; at++, v += 2)
                sides[n++] = (Side){k, at, bends[k], v, v + 2, distance(v, v + 2)};
        }
        for (const Side *s = sides; s < sides + n; s++)
            for (const Side *t = s + 1; t < sides + n; t++) {
                double odd[2];
                if (s->part == t->part && (t->at < s->at + 2 || !single)) continue;
                const double joining = 1 - (s->length + t->length) / length;
                if (joining > JOINING || !ink_crossing(s->from, s->to, t->from, t->to, odd)) continue;
                double said = off;
                if (n > 2) said += PARAMETER + FREE * observations * fmax(joining - ONE_SIDE, 0);
                if (single && CROSS + PARAMETER + FREE * observations * joining + odd[0] + odd[1] < most)
                    said = fmin(said, PARAMETER + joined(samples + 2 * SAMPLES * names[0], facts + names[0], s, t));
                const double cost = CROSS + said + odd[0] + odd[1];
                if (!(cost <= most) || (found && cost >= out->cost)) continue;
                const double away = n > 2 && !single ? elsewhere(s, t) + elsewhere(t, s) : 0;
                found = 1;
                most = out->cost = cost;
                out->rough = off + odd[0] + odd[1] + meaningless(observations * away / length);
                const double *a = s->from, *b = s->to, *c = t->from, *d = t->to;
                const double *along[] = {a, b, d, a, c, b, c, d, c};
                for (int k = 0; k < 9; k++) memcpy(out->figure[k], along[k], sizeof out->figure[k]);
            }
    }
    return found;
}
