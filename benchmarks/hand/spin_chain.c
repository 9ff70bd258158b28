/* A strand of rigid bodies on a circle in C by hand, by differences of order 4 at N points.
   dPi/dt = Pi x Omega + D(K Xi) + Xi x K Xi, dXi/dt = D(Omega) + Xi x Omega, Omega = Pi/I.

   Factors of differences are multiplied by K and 1/I once. The two points at each end stand apart, so
   that the loop over the others needs no remainder of a division. With APART one loop finds dPi/dt and
   another one dXi/dt: fewer rows at once, which at powers of 2 points share places in the cache. */
#include <stddef.h>

void hand_rhs(size_t n, const double *restrict state, const double *restrict parameters,
              double *restrict out);

static inline void momenta(size_t j, size_t b2, size_t b1, size_t a1, size_t a2, size_t n,
                           const double *restrict s, const double *restrict p, double near,
                           double far, double *restrict out)
{
    const double *restrict P1 = s, *restrict P2 = s + n, *restrict P3 = s + 2 * n;
    const double *restrict X1 = s + 3 * n, *restrict X2 = s + 4 * n, *restrict X3 = s + 5 * n;
    const double i1 = p[0], i2 = p[1], i3 = p[2], k1 = p[3], k2 = p[4], k3 = p[5];
    out[j] = (i3 - i2) * P2[j] * P3[j] + (k3 - k2) * X2[j] * X3[j]
             + k1 * (near * (X1[a1] - X1[b1]) + far * (X1[a2] - X1[b2]));
    out[n + j] = (i1 - i3) * P3[j] * P1[j] + (k1 - k3) * X3[j] * X1[j]
                 + k2 * (near * (X2[a1] - X2[b1]) + far * (X2[a2] - X2[b2]));
    out[2 * n + j] = (i2 - i1) * P1[j] * P2[j] + (k2 - k1) * X1[j] * X2[j]
                     + k3 * (near * (X3[a1] - X3[b1]) + far * (X3[a2] - X3[b2]));
}

static inline void strains(size_t j, size_t b2, size_t b1, size_t a1, size_t a2, size_t n,
                           const double *restrict s, const double *restrict p, double near,
                           double far, double *restrict out)
{
    const double *restrict P1 = s, *restrict P2 = s + n, *restrict P3 = s + 2 * n;
    const double i1 = p[0], i2 = p[1], i3 = p[2];
    const double w1 = i1 * P1[j], w2 = i2 * P2[j], w3 = i3 * P3[j];
    const double x1 = s[3 * n + j], x2 = s[4 * n + j], x3 = s[5 * n + j];
    out[3 * n + j] = x2 * w3 - x3 * w2
                     + i1 * (near * (P1[a1] - P1[b1]) + far * (P1[a2] - P1[b2]));
    out[4 * n + j] = x3 * w1 - x1 * w3
                     + i2 * (near * (P2[a1] - P2[b1]) + far * (P2[a2] - P2[b2]));
    out[5 * n + j] = x1 * w2 - x2 * w1
                     + i3 * (near * (P3[a1] - P3[b1]) + far * (P3[a2] - P3[b2]));
}

void hand_rhs(size_t n, const double *restrict state, const double *restrict parameters,
              double *restrict out)
{
    const double p[6] = {1 / parameters[0], 1 / parameters[1], 1 / parameters[2],
                         parameters[3],     parameters[4],     parameters[5]};
    const double over = (double)n / parameters[6], near = over * 2 / 3, far = -over / 12;
    for (size_t k = 0; k < 4; ++k) {
        const size_t j = k < 2 ? k : n - 4 + k;
        const size_t b2 = (j + n - 2) % n, b1 = (j + n - 1) % n, a1 = (j + 1) % n;
        momenta(j, b2, b1, a1, (j + 2) % n, n, state, p, near, far, out);
        strains(j, b2, b1, a1, (j + 2) % n, n, state, p, near, far, out);
    }
#ifdef APART
#pragma GCC ivdep
    for (size_t j = 2; j < n - 2; ++j)
        momenta(j, j - 2, j - 1, j + 1, j + 2, n, state, p, near, far, out);
#pragma GCC ivdep
    for (size_t j = 2; j < n - 2; ++j)
        strains(j, j - 2, j - 1, j + 1, j + 2, n, state, p, near, far, out);
#else
#pragma GCC ivdep
    for (size_t j = 2; j < n - 2; ++j) {
        momenta(j, j - 2, j - 1, j + 1, j + 2, n, state, p, near, far, out);
        strains(j, j - 2, j - 1, j + 1, j + 2, n, state, p, near, far, out);
    }
#endif
}
