/* Which bodies can matter to marks. */
#include "fit.h"

#include <math.h>

static const double SHARE = 0.1; /* of a body's extent: as near to it as what is drawn at its outline is */

/* boxes: (marks, 4): least x and y, greatest x and y of what may be there [pixels]; inside out for nothing. bodies: (count,
 * 5): likewise, and the extent.
 * Out: pairs: (room, 2): numbers of a mark's box and of a body that is no further off than the box or a share of the body is
 * large, as many as there is room for. Returns how many there are. */
INK_API int64_t ink_beside(const double *boxes, int32_t marks, const double *bodies, int32_t count, int32_t *pairs,
                           int64_t room) {
    int64_t found = 0;
    for (int m = 0; m < marks; m++) {
        const double *b = boxes + 4 * m;
        if (!(b[0] <= b[2])) continue;
        double own = hypot(b[2] - b[0], b[3] - b[1]);
        for (int k = 0; k < count; k++) {
            const double *a = bodies + 5 * k, r = SHARE * a[4] > own ? SHARE * a[4] : own;
            if (a[0] - r > b[2] || a[2] + r < b[0] || a[1] - r > b[3] || a[3] + r < b[1]) continue;
            if (found < room) {
                pairs[2 * found] = m;
                pairs[2 * found + 1] = k;
            }
            found++;
        }
    }
    return found;
}
