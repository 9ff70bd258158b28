/* N vortices of the plane in C by hand, in two ways that take turns in the benchmark.

   dx_i/dt = -sum G_j (y_i - y_j)/r^2/(2 pi), dy_i/dt = sum G_j (x_i - x_j)/r^2/(2 pi). The quotient of
   a vortex and itself is set to 0, so that no partner is left out.

   By default each vortex goes through all others: vectors of vortices, one partner after the other.
   With -DONCE each pair has one quotient for both of its vortices: half as many, and sums in memory,
   for a block of partners that stays in the first cache. Sums have no order then. */
#include <stddef.h>

void hand_rhs(size_t n, const double *restrict state, const double *restrict parameters,
              double *restrict out);

static const double K = 0.15915494309189535; /* 1/(2 pi) */

#ifndef ONCE
enum { BLOCK = 8 };

void hand_rhs(size_t n, const double *restrict state, const double *restrict parameters,
              double *restrict out)
{
    const double *restrict x = state, *restrict y = state + n, *restrict g = parameters;
    for (size_t first = 0; first < n; first += BLOCK) {
        const size_t count = n - first < BLOCK ? n - first : BLOCK;
        double u[BLOCK] = {0}, v[BLOCK] = {0}, xi[BLOCK] = {0}, yi[BLOCK] = {0};
        for (size_t l = 0; l < count; ++l) {
            xi[l] = x[first + l];
            yi[l] = y[first + l];
        }
        for (size_t j = 0; j < n; ++j) {
            const double xj = x[j], yj = y[j], gj = g[j];
#pragma GCC unroll 1
            for (size_t l = 0; l < BLOCK; ++l) {
                const double a = xi[l] - xj, b = yi[l] - yj, r = a * a + b * b;
                const double q = r == 0.0 ? 0.0 : gj / r;
                u[l] -= q * b;
                v[l] += q * a;
            }
        }
        for (size_t l = 0; l < count; ++l) {
            out[first + l] = K * u[l];
            out[n + first + l] = K * v[l];
        }
    }
}
#else
enum { TILE = 512 };

void hand_rhs(size_t n, const double *restrict state, const double *restrict parameters,
              double *restrict out)
{
    const double *restrict x = state, *restrict y = state + n, *restrict g = parameters;
    double *restrict u = out, *restrict v = out + n;
    for (size_t i = 0; i < 2 * n; ++i)
        out[i] = 0.0;
    for (size_t tile = 0; tile < n; tile += TILE) {
        const size_t last = tile + TILE < n ? tile + TILE : n;
        for (size_t i = 0; i < last; ++i) {
            const double xi = x[i], yi = y[i], gi = g[i];
            double ui = 0.0, vi = 0.0;
#pragma GCC ivdep
            for (size_t j = i + 1 > tile ? i + 1 : tile; j < last; ++j) {
                const double a = xi - x[j], b = yi - y[j], r = a * a + b * b;
                const double q = 1.0 / r, at = q * a, bt = q * b;
                ui -= g[j] * bt;
                vi += g[j] * at;
                u[j] += gi * bt;
                v[j] -= gi * at;
            }
            u[i] += ui;
            v[i] += vi;
        }
    }
    for (size_t i = 0; i < 2 * n; ++i)
        out[i] *= K;
}
#endif
