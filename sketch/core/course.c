/* An open line of any course, drawn with few sides. */
#include "fit.h"

#include <math.h>

enum { COURSE = 32 /* sides that it is drawn with */ };

/* The outline of a polyline, (COURSE + 1, 2), drawn with a pen so wide, mitred at its corners: (2 * COURSE + 2, 2). */
static void thicken(const double *line, double pen, double *outline) {
    double before[2] = {0, 0};
    for (int i = 0; i <= COURSE; i++) {
        double normal[2] = {0, 0}, mitre[2];
        if (i < COURSE) {
            double dx = line[2 * i + 2] - line[2 * i], dy = line[2 * i + 3] - line[2 * i + 1], l = length(dx, dy);
            l = l > 1e-9 ? l : 1e-9;
            normal[0] = -(dy / l);
            normal[1] = dx / l;
        }
        mitre[0] = before[0] + normal[0];
        mitre[1] = before[1] + normal[1];
        if (i > 0 && i < COURSE) {
            double square = mitre[0] * mitre[0] + mitre[1] * mitre[1], by = (square > 0.5 ? square : 0.5) / 2;
            mitre[0] /= by;
            mitre[1] /= by;
        }
        for (int e = 0; e < 2; e++) {
            double side = mitre[e] * pen / 2;
            outline[2 * i + e] = line[2 * i + e] + side;
            outline[2 * (2 * COURSE + 1 - i) + e] = line[2 * i + e] - side;
            before[e] = normal[e];
        }
    }
}

/* xy: points of a stroke [pixels], (n, 2), n > 1.  pen: what it is at least as thick as [pixels].
 * Out: line: (COURSE + 1, 2) in equal steps along it. Returns whether it nowhere crosses itself. */
INK_API int32_t ink_course(const double *xy, int32_t n, double pen, double *line) {
    double total = 0, done = 0, outline[4 * (COURSE + 1)];
    for (int j = 1; j < n; j++) total += length(xy[2 * j] - xy[2 * j - 2], xy[2 * j + 1] - xy[2 * j - 1]);
    for (int j = 1, k = 0; j < n; j++) {
        const double *a = xy + 2 * j - 2, *b = xy + 2 * j;
        double l = length(b[0] - a[0], b[1] - a[1]), next = done + l;
        for (; k < COURSE && k * (total / COURSE) < next; k++)
            for (int e = 0; e < 2; e++)
                line[2 * k + e] = (b[e] - a[e]) / (next - done) * (k * (total / COURSE) - done) + a[e];
        done = next;
    }
    line[2 * COURSE] = xy[2 * n - 2];
    line[2 * COURSE + 1] = xy[2 * n - 1];
    thicken(line, pen, outline);
    return ink_is_simple(outline, 2 * COURSE + 2);
}
