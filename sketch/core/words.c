/* Which strokes are as near to one another, and as alike in size, as those of a word. */
#include "fit.h"

static const double UNLIKE =
    6.0;  /* times that strokes of one word are as large as others: a letter's bar, and its stem */

enum { STEP = 3 }; /* every so many samples of a stroke are compared with others */

/* Whether the ink of two strokes, (SAMPLES, 2) each, comes nearer than `reach` [pixels]. */
static int comes_near(const double *one, const double *other, double reach) {
    for (int i = 0; i < SAMPLES; i += STEP)
        for (int j = 0; j < SAMPLES; j += STEP) {
            double x = one[2 * i] - other[2 * j], y = one[2 * i + 1] - other[2 * j + 1];
            if (x * x + y * y < reach * reach) return 1;
        }
    return 0;
}

/* which: (count): strokes. boxes: (count, 4): their least x and y, greatest x and y; extents: (count) [pixels]. samples: of
 * all strokes, (strokes, SAMPLES, 2).
 * Out: pairs: (room, 2): numbers of those that may be in one word, in order, as many as there is room for. Returns how many
 * there are. */
INK_API int64_t ink_words(const int32_t *which, int32_t count, const double *boxes, const double *extents,
                          const double *samples, double of_larger, double of_smaller, int32_t *pairs, int64_t room) {
    int64_t found = 0;
    for (int i = 0; i < count; i++) {
        const double *a = boxes + 4 * i;
        for (int j = i + 1; j < count; j++) {
            const double *b = boxes + 4 * j;
            int larger = extents[i] > extents[j];
            double large = larger ? extents[i] : extents[j], small = larger ? extents[j] : extents[i];
            double reach = of_larger * large < of_smaller * small ? of_larger * large : of_smaller * small;
            if (!(b[0] < a[2] + reach && b[2] > a[0] - reach && b[1] < a[3] + reach && b[3] > a[1] - reach)) continue;
            if (large > UNLIKE * small) continue;
            if (!comes_near(samples + 2 * SAMPLES * which[i], samples + 2 * SAMPLES * which[j], reach)) continue;
            if (found < room) {
                pairs[2 * found] = i;
                pairs[2 * found + 1] = j;
            }
            found++;
        }
    }
    return found;
}
