/* Ink that goes over an outline or a mark that is there already: a side drawn twice, a barb gone over. */
#include "mark.h"

/* The pieces that run along a closed outline, (n, 2), so well that it takes fewer nats to say them so than freely.
 *
 * pieces, boxes, sizes: as of ink_along; samples: of every stroke of the page; facts: of each; rivals, from: as of ink_apart.
 * reach: as far from the outline's box as they are [pixels].
 * names: of the `count` pieces that the outline is of: they and what shares ink with them are left out.
 * scale: of a body, which is drawn over no more precisely than it is; 0 for a mark [pixels].
 * shaft: of an arrow its length, else 0 [pixels]; its outline goes from the tail to the tip, to a barb's end, to the tip, to
 * the other's.
 * Out: box: as of ink_along; found, costs: the pieces, and the nats to say each. Returns how many. */
INK_API int32_t ink_again(int32_t pieces, const double *boxes, const double *samples, const double *sizes,
                          const Facts *facts, const int32_t *rivals, const int32_t *from, const double *outline,
                          int32_t n, double reach, const int32_t *names, int32_t count, double scale, double shaft,
                          double box[4], int32_t *found, double *costs) {
    const int near = ink_along(pieces, boxes, samples, sizes, outline, n, reach, box, found);
    int kept = 0;
    for (int k = 0; k < near; k++) {
        const int32_t i = found[k];
        const Facts *piece = facts + i;
        int other = 1;
        for (int j = 0; j < count && other; j++) other = names[j] != i && ink_apart(rivals, from, i, names[j]);
        if (!other) continue;
        double off, greatest;
        ink_off_outline(samples, &i, 1, outline, n, &off, &greatest);
        const double own = piece->scale > 1e-9 ? piece->scale : 1e-9;
        double precision = scale > 0 ? (scale < own ? scale : own) : piece->extent / 2;
        double cost = PARAMETER + RETRACE * piece->observations + misfit_of(piece, off, precision);
        const double in_head = PARAMETER + HEAD * piece->observations;
        if (in_head < cost && in_head < piece->unread && piece->extent < SMALL * shaft) {
            const double head[6] = {outline[2], outline[3], outline[4], outline[5], outline[8], outline[9]};
            if (is_within_head(samples, piece, i, head)) cost = in_head;
        }
        if (!(cost < piece->unread)) continue;
        found[kept] = i;
        costs[kept++] = cost;
    }
    return kept;
}
