/* Which ends of open lines rings hold. */
#include "fit.h"

#include <math.h>

/* lines: (count, 4): where each begins and ends. rings: (many, 3): middle and extent [pixels]. in_ring: of a ring's extent: an
 * end so near to its middle is in the ring; through: likewise of a line that goes into it; shorter: times, at least, that the
 * line is as long as the ring's extent.
 * Out: held: (count): how many ends of each some ring holds. */
INK_API void ink_held(const double *lines, int32_t count, const double *rings, int32_t many, double in_ring,
                      double through, double shorter, int32_t *held) {
    for (int n = 0; n < count; n++) {
        const double *e = lines + 4 * n;
        const double u = e[2] - e[0], v = e[3] - e[1], length = hypot(u, v);
        int first = 0, last = 0;
        for (int k = 0; k < many && !(first && last); k++) {
            const double *r = rings + 3 * k, x = r[0] - e[0], y = r[1] - e[1], reach = in_ring * r[2];
            const double far_x = r[0] - e[2], far_y = r[1] - e[3];
            const int in_first = x * x + y * y < reach * reach, in_last = far_x * far_x + far_y * far_y < reach * reach;
            if (!(in_first || in_last) || shorter * r[2] >= length) continue;
            if (fabs(u * y - v * x) >= through * r[2] * length) continue;
            first |= in_first;
            last |= in_last;
        }
        held[n] = first + last;
    }
}
