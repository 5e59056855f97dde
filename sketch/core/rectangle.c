/* The rectangle that a quadrilateral may be meant as. */
#include "fit.h"

#include <math.h>

/* The mean over a side of a squared distance that is linear along it, from p to q. */
static double mean_square(double p, double q) { return (p * p + p * q + q * q) / 3; }

/* Its direction is the mean of the sides', modulo a right angle, weighted by their lengths; its sides go through the middles
 * of the quadrilateral's. */
double nearest_rectangle(const double *corners, const double to[4], double *box) {
    double side[4][2], along[4], across[4], four[2] = {0, 0};
    for (int k = 0; k < 4; k++) {
        const double *a = corners + 2 * k, *b = corners + 2 * ((k + 1) % 4);
        double x = side[k][0] = b[0] - a[0], y = side[k][1] = b[1] - a[1], l = fmax(hypot(x, y), 1e-9);
        double xx = x * x - y * y, xy = 2 * x * y; /* four times the angle: right angles do not count */
        four[0] += (xx * xx - xy * xy) / (l * l * l);
        four[1] += 2 * xx * xy / (l * l * l);
    }
    if (four[0] == 0 && four[1] == 0) return INFINITY;
    double angle = 0.25 * atan2(four[1], four[0]), c = cos(angle), s = sin(angle);
    int level[4];
    for (int k = 0; k < 4; k++) {
        double x = corners[2 * k] + side[k][0] / 2, y = corners[2 * k + 1] + side[k][1] / 2;
        along[k] = c * x + s * y; /* of the side's middle */
        across[k] = c * y - s * x;
        level[k] = fabs(c * side[k][0] + s * side[k][1]) > fabs(c * side[k][1] - s * side[k][0]);
    }
    if (level[0] == level[1] || level[0] != level[2] || level[1] != level[3]) return INFINITY;
    double at[4][2], off[4][2], extra = 0; /* in the frame */
    for (int k = 0; k < 4; k++) {          /* corner k is where side k - 1 meets side k */
        int before = (k + 3) % 4, x = level[before] ? k : before, y = level[before] ? before : k;
        double *b = box + 2 * k;
        b[0] = c * along[x] - s * across[y];
        b[1] = s * along[x] + c * across[y];
        double dx = corners[2 * k] - b[0], dy = corners[2 * k + 1] - b[1];
        for (int e = 0; e < 2; e++) {
            at[k][e] = to[2 * e] * b[0] + to[2 * e + 1] * b[1];
            off[k][e] = to[2 * e] * dx + to[2 * e + 1] * dy;
        }
    }
    for (int k = 0; k < 4; k++) {
        int n = (k + 1) % 4;
        double x = at[n][0] - at[k][0], y = at[n][1] - at[k][1], l = fmax(hypot(x, y), 1e-9);
        extra += mean_square((off[k][1] * x - off[k][0] * y) / l, (off[n][1] * x - off[n][0] * y) / l) / 4;
    }
    return extra < 1 ? extra : INFINITY;
}
