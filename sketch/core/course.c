/* A line of any course, open or closed, drawn with few sides. */
#include "fit.h"

#include <math.h>

enum { COURSE = 32, DENSE = 4 * COURSE }; /* sides that it is drawn with, and places along it that are looked at */

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

/* Places in equal steps along a polyline, the first and the last at its ends: line is (count, 2).  along: room for n lengths. */
static void in_steps(const double *xy, int32_t n, double *along, double *line, int count) {
    along[0] = 0;
    for (int j = 1; j < n; j++)
        along[j] = along[j - 1] + hypot(xy[2 * j] - xy[2 * j - 2], xy[2 * j + 1] - xy[2 * j - 1]);
    const double step = along[n - 1] / (count - 1);
    for (int k = 0, j = 0; k < count; k++) {
        const double at = k < count - 1 ? k * step : along[n - 1];
        while (j < n - 1 && along[j + 1] <= at) j++;
        for (int e = 0; e < 2; e++)
            line[2 * k + e] =
                j == n - 1
                    ? xy[2 * j + e]
                    : (xy[2 * j + 2 + e] - xy[2 * j + e]) / (along[j + 1] - along[j]) * (at - along[j]) + xy[2 * j + e];
    }
}

/* xy: points of ink that goes once around [pixels], (n, 2), n > 1.  along: room for n numbers.
 * Out: outline: (COURSE, 2), closed, in equal steps along it, without what runs beyond where its ends are nearest to each
 * other. Returns whether it nowhere crosses itself. */
INK_API int32_t ink_course_around(const double *xy, int32_t n, double *along, double *outline) {
    double dense[2 * DENSE], least = INFINITY;
    int first = 0, last = 0;
    in_steps(xy, n, along, dense, DENSE);
    for (int i = 0; i < COURSE / 2; i++)
        for (int j = DENSE - COURSE / 2; j < DENSE; j++) {
            const double apart = hypot(dense[2 * i] - dense[2 * j], dense[2 * i + 1] - dense[2 * j + 1]);
            if (apart < least) {
                least = apart;
                first = i;
                last = j;
            }
        }
    const double step = (double)(last + 1 - first) / COURSE;
    for (int k = 0; k < COURSE; k++) {
        const double *p = dense + 2 * (first + (int)(k * step));
        outline[2 * k] = p[0];
        outline[2 * k + 1] = p[1];
    }
    return ink_is_simple(outline, COURSE);
}
