/* The cheapest cover of a drawing's ink by readings: see sketch/scan/strokes/together.py, which says what is looked for
 * and where the method is from.
 *
 * A reading has a few stretches of ink of many, so they are given as lists: all that is reckoned here goes through
 * these. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "api.h"

static const double ALONG = 4.0; /* nats that two readings are rarer for each pen width of ink that both say */
static const double CLOSE = 1.0; /* nats: covers that gain no more than that beyond another are no better */

enum {
    ASCENTS = 30, /* steps by which the prices of stretches are raised or lowered, */
    PATIENCE = 5, /* of which so many without gain halve the steps after, */
    OFTEN = 5, /* and one in so many tries the cover that the prices speak for */
};

typedef struct {
    const int32_t *first, *of; /* of each reading the stretches: of[first[r]] up to of[first[r + 1]] */
    const uint8_t *left; /* whether a reading is what is left over together, which no other shares */
    const double *cost, *free, *length; /* nats to say each reading, and each stretch freely; of each [pen widths] */
    const int32_t *some; /* the readings that may be in a cover, */
    int32_t count, stretches; /* how many, and how many stretches there are */
    double *profit, *rarer; /* scratch, one for each reading */
    double *price, *worth, *slope; /* likewise, for each stretch */
    int32_t *holders;
    uint8_t *open;
} Cover;

static double sum_over(const Cover *c, int32_t reading, const double *values) {
    double sum = 0;
    for (int32_t k = c->first[reading]; k < c->first[reading + 1]; k++) sum += values[c->of[k]];
    return sum;
}

/* How many of some readings have each stretch. */
static void hold(const Cover *c, const int32_t *chosen, int32_t count) {
    memset(c->holders, 0, (size_t)c->stretches * sizeof *c->holders);
    for (int32_t n = 0; n < count; n++)
        for (int32_t k = c->first[chosen[n]]; k < c->first[chosen[n] + 1]; k++) c->holders[c->of[k]]++;
}

/* Nats that a reading is rarer beside others, given how many there are that have each stretch, with itself. */
static double beside(const Cover *c, int32_t reading) {
    double along = 0;
    for (int32_t k = c->first[reading]; k < c->first[reading + 1]; k++)
        along += c->length[c->of[k]] * (c->holders[c->of[k]] - 1);
    return ALONG * along;
}

/* Nats that some readings save together against saying all ink freely. */
static double gain(const Cover *c, const int32_t *chosen, int32_t count) {
    double saved = 0;
    hold(c, chosen, count);
    for (int32_t s = 0; s < c->stretches; s++)
        if (c->holders[s]) saved += c->free[s];
    for (int32_t n = 0; n < count; n++) saved -= c->cost[chosen[n]] + beside(c, chosen[n]) / 2;
    return saved;
}

/* The readings without those that gain nothing beside the others, the worst first; how many are left. */
static int32_t needed(const Cover *c, int32_t *chosen, int32_t count) {
    while (count) {
        double least = INFINITY;
        int32_t worst = 0;
        hold(c, chosen, count);
        for (int32_t n = 0; n < count; n++) {
            double alone = -c->cost[chosen[n]] - beside(c, chosen[n]);
            for (int32_t k = c->first[chosen[n]]; k < c->first[chosen[n] + 1]; k++)
                if (c->holders[c->of[k]] == 1) alone += c->free[c->of[k]];
            if (alone < least) {
                least = alone;
                worst = n;
            }
        }
        if (least >= 0) break;
        memmove(chosen + worst, chosen + worst + 1, (size_t)(--count - worst) * sizeof *chosen);
    }
    return count;
}

/* Choose a reading: its stretches are said, and the others that have some of them are rarer. */
static void choose(const Cover *c, int32_t reading) {
    hold(c, &reading, 1);
    for (int32_t k = c->first[reading]; k < c->first[reading + 1]; k++) {
        c->open[c->of[k]] = 0;
        c->worth[c->of[k]] = 0;
    }
    for (int32_t n = 0; n < c->count; n++) {
        const int32_t r = c->some[n];
        double both = 0;
        for (int32_t k = c->first[r]; k < c->first[r + 1]; k++) both += c->holders[c->of[k]] * c->length[c->of[k]];
        const int never = r == reading || (both > 0 && (c->left[reading] || c->left[r])); /* once is enough */
        c->rarer[n] += never ? INFINITY : ALONG * both;
        c->profit[n] = sum_over(c, r, c->worth) - c->cost[r] - c->rarer[n];
    }
}

/* A cover by the readings that are the cheapest for what they cover, at the prices and then at those of ink that is said
 * freely, without those that others make needless; how many there are. */
static int32_t greedy(const Cover *c, int32_t *chosen) {
    int32_t count = 0;
    memset(c->open, 1, (size_t)c->stretches);
    for (int32_t n = 0; n < c->count; n++) c->rarer[n] = 0;
    for (int phase = 0; phase < 2; phase++) {
        for (int32_t s = 0; s < c->stretches; s++) c->worth[s] = c->open[s] ? (phase ? c->free : c->price)[s] : 0;
        for (int32_t n = 0; n < c->count; n++)
            c->profit[n] = sum_over(c, c->some[n], c->worth) - c->cost[c->some[n]] - c->rarer[n];
        for (;;) {
            int32_t most = -1;
            for (int32_t n = 0; n < c->count; n++)
                if (c->profit[n] > (most < 0 ? 0 : c->profit[most])) most = n;
            if (most < 0) break;
            chosen[count++] = c->some[most];
            choose(c, c->some[most]);
        }
    }
    return needed(c, chosen, count);
}

/* What each stretch costs in a cover: what is open its price, and what a reading says its part of that one's.  If no
 * reading costs less than its stretches do then, no cover is cheaper. */
static void price_by(const Cover *c, const int32_t *chosen, int32_t count) {
    memcpy(c->price, c->free, (size_t)c->stretches * sizeof *c->price);
    for (int32_t n = 0; n < count; n++) {
        const double whole = sum_over(c, chosen[n], c->free), cost = fmax(c->cost[chosen[n]], 0);
        const double share = whole > 0 ? cost / whole : 0;
        for (int32_t k = c->first[chosen[n]]; k < c->first[chosen[n] + 1]; k++)
            c->price[c->of[k]] = fmin(c->price[c->of[k]], share * c->free[c->of[k]]);
    }
}

/* Where the prices would rise and fall, into `slope`: stretches that no reading wants at these prices, and those that
 * several want; the least that any cover costs. */
static double bound_by(const Cover *c) {
    double bound = 0;
    for (int32_t s = 0; s < c->stretches; s++) {
        bound += c->price[s];
        c->slope[s] = 1;
    }
    for (int32_t n = 0; n < c->count; n++) {
        const int32_t r = c->some[n];
        const double profit = sum_over(c, r, c->price) - c->cost[r];
        if (profit <= CLOSE / 10) continue;
        bound -= profit;
        for (int32_t k = c->first[r]; k < c->first[r + 1]; k++) c->slope[c->of[k]]--;
    }
    return bound;
}

/* Move the prices along their slope, by a step of that share of the gap to the best cover; whether any moves. */
static int ascend(const Cover *c, double step, double gap) {
    double steep = 0;
    for (int32_t s = 0; s < c->stretches; s++) {
        double *slope = c->slope + s;
        if ((*slope > 0 && c->price[s] >= c->free[s]) || (*slope < 0 && c->price[s] <= 0)) *slope = 0;
        steep += *slope * *slope;
    }
    for (int32_t s = 0; s < c->stretches && steep > 0; s++)
        c->price[s] = fmin(fmax(c->price[s] + step * gap / steep * c->slope[s], 0), c->free[s]);
    return steep > 0;
}

/* The cover that gains the most of those that are found, beginning with one, in `best`; how many readings it has.
 * tried: scratch, as long. */
static int32_t cheapest(const Cover *c, int32_t *best, int32_t count, int32_t *tried, double *most) {
    double everything = 0, step = 1, least = -INFINITY;
    int waited = 0;
    *most = gain(c, best, count);
    for (int32_t s = 0; s < c->stretches; s++) everything += c->free[s];
    price_by(c, best, count);
    for (int ascent = 0; ascent < ASCENTS; ascent++) {
        const double bound = bound_by(c), gap = everything - *most - bound;
        if (gap < CLOSE) break;
        const int32_t others = ascent % OFTEN ? 0 : greedy(c, tried);
        const double its = others ? gain(c, tried, others) : 0;
        if (its > *most + CLOSE) {
            *most = its;
            memcpy(best, tried, (size_t)(count = others) * sizeof *best);
        }
        waited = bound > least ? 0 : waited + 1;
        least = fmax(bound, least);
        if (waited == PATIENCE) {
            step /= 2;
            waited = 0;
        }
        if (!ascend(c, step, gap)) break;
    }
    return count;
}

/* The cheapest cover of `stretches` stretches of ink by some readings: see Cover for what they are given by.
 *
 * chosen: room for `count` readings, with the `begun` of a first cover in it; the best one's after.  most: nats that it
 * saves against saying all ink freely.  Returns how many readings it has, or -1 where memory is short. */
INK_API int32_t ink_cover(const int32_t *first, const int32_t *of, const uint8_t *left, const double *cost,
                          const double *free_, const double *length, int32_t stretches, const int32_t *some,
                          int32_t count, int32_t *chosen, int32_t begun, double *most) {
    const size_t reals = (size_t)2 * count + (size_t)3 * stretches, ints = (size_t)count + stretches;
    double *room = malloc(reals * sizeof(double) + ints * sizeof(int32_t) + (size_t)stretches + 1);
    if (!room) return -1;
    double *price = room + 2 * (size_t)count;
    int32_t *tried = (int32_t *)(room + reals);
    const Cover c = {.first = first,
                     .of = of,
                     .left = left,
                     .cost = cost,
                     .free = free_,
                     .length = length,
                     .some = some,
                     .count = count,
                     .stretches = stretches,
                     .profit = room,
                     .rarer = room + count,
                     .price = price,
                     .worth = price + stretches,
                     .slope = price + 2 * (size_t)stretches,
                     .holders = tried + count,
                     .open = (uint8_t *)(tried + ints)};
    const int32_t found = cheapest(&c, chosen, begun, tried, most);
    free(room);
    return found;
}
