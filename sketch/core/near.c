/* Which pieces of ink are near a place, for all that their boxes tell. */
#include "fit.h"

/* boxes: (pieces, 4): least x and y, greatest x and y [pixels]; NaN for none.
 * Out: found: the pieces whose boxes have a point in `box`. Returns how many. */
INK_API int32_t ink_touching(int32_t pieces, const double *boxes, double left, double top, double right, double bottom,
                             int32_t *found) {
    int count = 0;
    for (int i = 0; i < pieces; i++) {
        const double *b = boxes + 4 * i;
        if (b[0] <= right && b[1] <= bottom && b[2] >= left && b[3] >= top) found[count++] = i;
    }
    return count;
}

/* boxes: likewise.  measure: of each, as of ink_strokes.  left, top, right, bottom: the box
 * around two places [pixels].
 * Out: found: the pieces that may come within `reach` of both, of a long one within a step of its samples more, and whose
 * boxes come within `reach` of that box. Returns how many. */
INK_API int32_t ink_reaching(int32_t pieces, const double *boxes, const double *measure, double left, double top,
                             double right, double bottom, double reach, int32_t *found) {
    const int near = ink_touching(pieces, boxes, left - reach, top - reach, right + reach, bottom + reach, found);
    int count = 0;
    for (int k = 0; k < near; k++) {
        const double *b = boxes + 4 * found[k], far = reach + measure[8 * found[k]] / SAMPLES;
        if (b[0] - far <= left && b[1] - far <= top && b[2] + far >= right && b[3] + far >= bottom)
            found[count++] = found[k];
    }
    return count;
}
