#include "angle.h"

#include <math.h>
#include <stdint.h>

/* pi / 2 in three parts, the first of which has 33 bits, so that its multiples up to 2^20 are exact (Cody and Waite 1980),
 * and the polynomials that fit sine and cosine on [-pi/4, pi/4] to less than a unit in the last place, with the numbers of
 * fdlibm (Sun Microsystems 1993, k_sin.c and k_cos.c). */
static const double HALF_PI_1 = 1.57079632673412561417e+00, HALF_PI_2 = 6.07710050630396597660e-11,
                    HALF_PI_3 = 2.02226624879595063154e-21, PARTS = 6.36619772367581382433e-01, /* 2 / pi */
    TO_INTEGER = 6755399441055744.0; /* 1.5 * 2^52: sums with it have no fraction */
static const double S[] = {-1.66666666666666324348e-01, 8.33333333332248946124e-03,  -1.98412698298579493134e-04,
                           2.75573137070700676789e-06,  -2.50507602534068634195e-08, 1.58969099521155010221e-10};
static const double C[] = {4.16666666666666019037e-02,  -1.38888888888741095749e-03, 2.48015872894767294178e-05,
                           -2.75573143513906633035e-07, 2.08757232129817482790e-09,  -1.13596475577881948265e-11};

void angle_sincos(double angle, double *sine, double *cosine) {
    if (!(fabs(angle) < 1e9)) angle = isfinite(angle) ? fmod(angle, 1e9) : 0; /* hardly a digit of it is left */
    double quarters = (angle * PARTS + TO_INTEGER) - TO_INTEGER;
    double x = ((angle - quarters * HALF_PI_1) - quarters * HALF_PI_2) - quarters * HALF_PI_3, z = x * x;
    double s = x + x * z * (S[0] + z * (S[1] + z * (S[2] + z * (S[3] + z * (S[4] + z * S[5])))));
    double c = 1 - (0.5 * z - z * z * (C[0] + z * (C[1] + z * (C[2] + z * (C[3] + z * (C[4] + z * C[5]))))));
    switch ((int64_t)quarters & 3) {
    case 0:
        *sine = s, *cosine = c;
        break;
    case 1:
        *sine = c, *cosine = -s;
        break;
    case 2:
        *sine = -s, *cosine = -c;
        break;
    default:
        *sine = -c, *cosine = s;
    }
}
