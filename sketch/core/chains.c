/* Orders of pieces of ink whose ends meet around: the outlines that they may make. */
#include "fit.h"

#include <math.h>
#include <string.h>

enum {
    CHOICES = 6,      /* ends that a chain may go on to, the nearest */
    MOST_PARTS = 6,   /* of one outline: people draw a box in one to five strokes */
    BREADTH = 80, /* ways of so many parts that are gone on with, the tightest: in shading every end has many near it */
    MOST_STEPS = 1 + CHOICES + CHOICES * CHOICES + 3 * BREADTH, /* ways from one piece, at most */
    MOST_SIDES = 3, /* of those that lack a side of another body */
    MOST_OPEN = 24, /* of such ways from one piece: where there are more, each lies near some end by chance */
    TIGHTEST = 5, /* of them that are told */
    UNKNOWN = -1
};

static const double LOOSE = 0.3; /* gaps of a chain, as a share of its ink, overshoots counted as gaps */
/* of a chain's ink: how much looser it is as good as for each rad that it turns back */
static const double REFLEX = 0.06;
static const double ABOUT = 2.5; /* rad: a turn of more may as well go the other way */
static const double CURLED = 0.3; /* of a piece's length: with ends no further apart it goes no certain way */
/* of a way that lacks a side: as far as its ends are apart at least, and as its pieces are from those they go on to at most, */
static const double TIGHT = 0.05, JOINED = 0.12;
static const double BENT = 1.4; /* times as long as what it lacks it is at least, */
static const double STRAIGHT_ON = 0.5; /* and how far it turns back, at most [rad] */
static const double REACH = 1.5 * 0.3; /* the longest single gap, as a share of the pieces on its two sides */

typedef struct {
    int32_t links
        [MOST_PARTS]; /* ends that the pieces begin with: 2 * piece, or one more where it is gone through backward */
    int32_t names[MOST_PARTS]; /* the pieces, in order */
    int parts, from; /* from: the end that the last of them begins with that goes a certain way */
    double gaps, ink; /* lengths [pixels] */
    double left, right; /* how far it turns either way, from piece to piece [rad] */
} Chain;

typedef struct {
    int rows; /* ends: rows 2i and 2i + 1 are of piece i */
    const double *at, *length; /* (rows, 2) [pixels]; (rows) of their pieces */
    const uint8_t *loose; /* (rows) whether chains go through it */
    const int32_t *rivals,
        *from; /* of piece i the pieces, in order, that share ink with it: rivals[from[i] .. from[i + 1]] */
    int32_t *count, *near; /* of each end the nearest others, or UNKNOWN: how many, (rows, CHOICES) which */
    double *gap; /* and how far [pixels] */
    int found, asked;
    int32_t *ends; /* whose neighbours were asked for */
    Chain best[MOST_STEPS];
} Search;

int ink_apart(const int32_t *rivals, const int32_t *from, int i, int j) {
    if (!from) return 1;
    for (int r = from[i]; r < from[i + 1]; r++)
        if (rivals[r] == j) return 0;
    return 1;
}

static int apart(const Search *s, int i, int j) { return ink_apart(s->rivals, s->from, i, j); }

/* The ends of other loose pieces that a chain may go on to from an end: the nearest, as shares of the pieces' lengths, so that
 * small marks beside an end do not hide where a long side goes on. */
static void look_around(Search *s, int end) {
    int32_t *near = s->near + CHOICES * end;
    double *gap = s->gap + CHOICES * end, x = s->at[2 * end], y = s->at[2 * end + 1];
    double share[CHOICES];
    int n = 0;
    for (int j = 0; j < s->rows && s->loose[end]; j++) {
        double dx = s->at[2 * j] - x, dy = s->at[2 * j + 1] - y, reach = REACH * (s->length[j] + s->length[end]);
        if (!s->loose[j] || fabs(dx) > reach || fabs(dy) > reach || j / 2 == end / 2) continue;
        double d = hypot(dx, dy), of = d / reach;
        if (d > reach || (n == CHOICES && of >= share[n - 1]) || !apart(s, end / 2, j / 2)) continue;
        int k = n < CHOICES ? n++ : CHOICES - 1;
        for (; k > 0 && share[k - 1] > of; k--) {
            share[k] = share[k - 1];
            gap[k] = gap[k - 1];
            near[k] = near[k - 1];
        }
        share[k] = of;
        gap[k] = d;
        near[k] = j;
    }
    s->count[end] = n;
}

/* How loose a way is: what bodies are drawn around mostly turns one way, while sides of several turn there and back. */
static double looseness(const Chain *way) { return way->gaps / way->ink + REFLEX * fmin(way->left, way->right); }

/* Let a way turn into the piece that begins with an end, over a gap, from the last one that goes a certain way: none that is
 * curled, or no longer than the gap. */
static void turn(const Search *s, Chain *way, int to, double gap) {
    const double *a = s->at + 2 * way->from, *b = s->at + 2 * (way->from ^ 1), *c = s->at + 2 * to,
                 *d = s->at + 2 * (to ^ 1);
    double ux = b[0] - a[0], uy = b[1] - a[1], vx = d[0] - c[0], vy = d[1] - c[1];
    if (hypot(vx, vy) < fmax(gap, CURLED * s->length[to])) return;
    int curled = hypot(ux, uy) < CURLED * s->length[way->from];
    way->from = to;
    double turned = atan2(ux * vy - uy * vx, ux * vx + uy * vy);
    if (curled || fabs(turned) > ABOUT) return;
    if (turned > 0)
        way->left += turned;
    else
        way->right -= turned;
}

/* Keep a way around if it is the tightest of its pieces. */
static void keep(Search *s, const Chain *way, double gaps) {
    Chain chain = *way;
    chain.gaps = gaps;
    if (chain.parts > 2) turn(s, &chain, chain.links[0], gaps - way->gaps);
    for (int k = 0; k < way->parts; k++) {
        int at = k, name = way->links[k] / 2;
        for (; at > 0 && chain.names[at - 1] > name; at--) chain.names[at] = chain.names[at - 1];
        chain.names[at] = name;
    }
    for (int b = 0; b < s->found; b++) {
        Chain *other = &s->best[b];
        if (other->parts == chain.parts && !memcmp(other->names, chain.names, chain.parts * sizeof *chain.names)) {
            if (gaps < other->gaps) *other = chain;
            return;
        }
    }
    s->best[s->found++] = chain;
}

/* Whether a piece is on a way, or is the same ink as one that is. */
static int on(const Search *s, const Chain *way, int piece) {
    for (int k = 0; k < way->parts; k++)
        if (way->links[k] / 2 == piece || !apart(s, piece, way->links[k] / 2)) return 1;
    return 0;
}

/* Whether a piece may follow on a way: drawn after its first, not on it, and of other ink. */
static int may_follow(const Search *s, const Chain *way, int piece) {
    return piece > way->links[0] / 2 && !on(s, way, piece);
}

/* Close a way, if it is tight enough then, and go on with it: its continuations go among the BREADTH tightest. Returns how
 * many those are. */
static int extend(Search *s, const Chain *way, Chain *longer, int count) {
    int start = way->links[0], last = way->links[way->parts - 1] ^ 1;
    double closing = hypot(s->at[2 * last] - s->at[2 * start], s->at[2 * last + 1] - s->at[2 * start + 1]);
    if (way->gaps + closing <= LOOSE * way->ink) keep(s, way, way->gaps + closing);
    if (way->parts == MOST_PARTS) return 0;
    s->ends[s->asked++] = last;
    if (s->count[last] == UNKNOWN) look_around(s, last);
    for (int c = 0; c < s->count[last]; c++) {
        int next = s->near[CHOICES * last + c];
        double ink = way->ink + s->length[next], gaps = way->gaps + s->gap[CHOICES * last + c];
        if (gaps > 2 * LOOSE * ink || !may_follow(s, way, next / 2)) continue;
        if (count == BREADTH && gaps / ink >= looseness(longer + count - 1)) continue;
        Chain more = *way;
        more.gaps = gaps;
        more.ink = ink;
        turn(s, &more, next, gaps - way->gaps);
        more.links[more.parts++] = next;
        double loose = looseness(&more);
        if (count == BREADTH && loose >= looseness(longer + count - 1)) continue;
        int at = count < BREADTH ? count++ : BREADTH - 1;
        for (; at > 0 && looseness(longer + at - 1) > loose; at--) longer[at] = longer[at - 1];
        longer[at] = more;
    }
    return count;
}

static Search search(int rows, const double *at, const double *length, const uint8_t *loose, const int32_t *rivals,
                     const int32_t *from, int32_t *count, int32_t *near, double *gap, int32_t *ends) {
    Search s;
    s.rows = rows;
    s.at = at;
    s.length = length;
    s.loose = loose;
    s.rivals = rivals;
    s.from = from;
    s.count = count;
    s.near = near;
    s.gap = gap;
    s.found = s.asked = 0;
    s.ends = ends;
    return s;
}

/* Chains that close and of which piece `start` is the first: each set of pieces in its tightest order.
 *
 * rows .. gap: as in Search; from may be null: no two pieces share ink.
 * Out: links (MOST_STEPS, MOST_PARTS), and of each chain parts, gaps [pixels], ink [pixels] and how far it turns
 * back [rad]; ends: those whose neighbours
 * were asked for, MOST_STEPS at most, asked: how many. Returns the number of chains. */
INK_API int32_t ink_chains(int32_t rows, const double *at, const double *length, const uint8_t *loose,
                           const int32_t *rivals, const int32_t *from, int32_t *count, int32_t *near, double *gap,
                           int32_t start, int32_t *links, int32_t *parts, double *gaps, double *ink, double *back,
                           int32_t *ends, int32_t *asked) {
    Search s = search(rows, at, length, loose, rivals, from, count, near, gap, ends);
    /* Of few parts first: what two pieces make is seen however many others lie about. */
    Chain ways[2][BREADTH] = {{{.links = {2 * start}, .parts = 1, .from = 2 * start, .ink = length[2 * start]}}};
    for (int parts = 1, count = 1; count > 0; parts++) {
        const Chain *now = ways[(parts + 1) % 2];
        Chain *longer = ways[parts % 2];
        int more = 0;
        for (int k = 0; k < count; k++) more = extend(&s, now + k, longer, more);
        count = more;
    }
    for (int c = 0; c < s.found; c++) {
        memcpy(links + MOST_PARTS * c, s.best[c].links, sizeof s.best[c].links);
        parts[c] = s.best[c].parts;
        gaps[c] = s.best[c].gaps;
        ink[c] = s.best[c].ink;
        back[c] = fmin(s.best[c].left, s.best[c].right);
    }
    *asked = s.asked;
    return s.found;
}

/* Whether the side that would close a way at an end may be another body's: not where the only other piece that ends there is no
 * longer than what is missing, and so is that side. */
static int may_lack(Search *s, const Chain *way, int end, double closing) {
    int others = 0, sides = 0;
    if (s->count[end] == UNKNOWN) look_around(s, end);
    for (int c = 0; c < s->count[end]; c++) {
        int other = s->near[CHOICES * end + c];
        if (s->gap[CHOICES * end + c] >= TIGHT * way->ink || on(s, way, other / 2)) continue;
        others++;
        sides += s->length[other] < BENT * closing;
    }
    return others != 1 || sides != 1;
}

/* Note a way if a side of another body may close it, and go on with it. */
static void go_on(Search *s, const Chain *way) {
    int start = way->links[0], last = way->links[way->parts - 1] ^ 1;
    double closing = hypot(s->at[2 * last] - s->at[2 * start], s->at[2 * last + 1] - s->at[2 * start + 1]);
    if (s->asked < MOST_STEPS) s->ends[s->asked++] = last;
    if (s->count[last] == UNKNOWN) look_around(s, last);
    if (way->parts > 1 && start / 2 < last / 2 && closing > TIGHT * way->ink && BENT * closing < way->ink &&
        may_lack(s, way, start, closing) && may_lack(s, way, last, closing)) {
        int at = s->found < TIGHTEST ? s->found : TIGHTEST - 1;
        if (at == s->found || looseness(way) < looseness(s->best + at)) {
            for (; at > 0 && looseness(s->best + at - 1) > looseness(way); at--) s->best[at] = s->best[at - 1];
            s->best[at] = *way;
        }
        s->found++;
    }
    if (s->found > MOST_OPEN) return;
    if (way->parts == MOST_SIDES) return;
    for (int c = 0; c < s->count[last]; c++) {
        int next = s->near[CHOICES * last + c];
        Chain more = *way;
        more.ink += s->length[next];
        more.gaps += s->gap[CHOICES * last + c];
        if (s->gap[CHOICES * last + c] > JOINED * more.ink || on(s, way, next / 2)) continue;
        turn(s, &more, next, more.gaps - way->gaps);
        more.links[more.parts++] = next;
        if (fmin(more.left, more.right) < STRAIGHT_ON) go_on(s, &more);
    }
}

/* Ways of two pieces or more, of which `start` is at an end, and drawn before that at the other, that lack a side which may
 * be another body's.
 *
 * rows .. gap: as in Search.  Out: links (TIGHTEST, MOST_PARTS) and parts of each; ends: those whose neighbours were asked
 * for, MOST_STEPS at most, asked: how many. Returns the number of ways. */
INK_API int32_t ink_open_ways(int32_t rows, const double *at, const double *length, const uint8_t *loose,
                              const int32_t *rivals, const int32_t *from, int32_t *count, int32_t *near, double *gap,
                              int32_t start, int32_t *links, int32_t *parts, int32_t *ends, int32_t *asked) {
    Search s = search(rows, at, length, loose, rivals, from, count, near, gap, ends);
    for (int back = 0; back < 2; back++) {
        int end = 2 * start + back;
        Chain way = {.links = {end}, .parts = 1, .from = end, .ink = length[end]};
        if (s.asked < MOST_STEPS) s.ends[s.asked++] = end;
        go_on(&s, &way);
    }
    int told = s.found > MOST_OPEN ? 0 : s.found < TIGHTEST ? s.found : TIGHTEST;
    for (int w = 0; w < told; w++) {
        memcpy(links + MOST_PARTS * w, s.best[w].links, sizeof s.best[w].links);
        parts[w] = s.best[w].parts;
    }
    *asked = s.asked;
    return told;
}
