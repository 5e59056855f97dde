/* The linear complementarity problem: w = M z + q, w >= 0, z >= 0, w.z = 0. */
#ifndef LCP_H
#define LCP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Doubles that lcp_solve needs as work space. */
static inline size_t lcp_work(int32_t n) { return (size_t)n * (2 * (size_t)n + 2); }

/* M is n x n by rows. False where Lemke's path ends in a ray or runs too long; z is then unusable.
 * basis: n ints of work space. */
bool lcp_solve(int32_t n, const double *M, const double *q, double *z, double *work, int32_t *basis);

/* The same, but of more than one solution that of least size, about: it has no more zeros than need be. */
bool lcp_share(int32_t n, const double *M, const double *q, double *z, double *work, int32_t *basis);

#endif
