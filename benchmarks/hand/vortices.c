/* N point vortices of the plane in C by hand: each moves in the field of all others.

   dx_i/dt = -1/(2 pi) sum G_j (y_i - y_j)/r^2, dy_i/dt = 1/(2 pi) sum G_j (x_i - x_j)/r^2: one quotient
   for each pair, none of which is skipped: the vortex itself has the distance 0, and where it is 0 the
   quotient is 0. BLOCK vortices share the loads of each partner. */
#include <stddef.h>

enum { BLOCK = 8 };

void vortices(size_t n, const double *restrict state, const double *restrict parameters, double *restrict out)
{
    const double *restrict x = state, *restrict y = state + n, *restrict g = parameters;
    const double k = 0.15915494309189535;
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
            out[first + l] = k * u[l];
            out[n + first + l] = k * v[l];
        }
    }
}
