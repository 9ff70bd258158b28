/* A ring of N spins in C by hand: dS_i/dt = S_i x J (S_(i-1) + S_(i+1)).

   J multiplies the sums of neighbours once. Spins at both ends of the ring stand apart, so that the
   loop over the others needs no remainder of a division; it begins where results stand at multiples
   of 64 bytes, as the arrays begin there. */
#include <stddef.h>

void hand_rhs(size_t n, const double *restrict state, const double *restrict parameters,
              double *restrict out);

static void turn(size_t i, size_t b, size_t a, size_t n, const double *restrict s, double J,
                 double *restrict out)
{
    const double *restrict y = s + n, *restrict z = s + 2 * n;
    const double fx = J * (s[b] + s[a]), fy = J * (y[b] + y[a]), fz = J * (z[b] + z[a]);
    out[i] = y[i] * fz - z[i] * fy;
    out[n + i] = z[i] * fx - s[i] * fz;
    out[2 * n + i] = s[i] * fy - y[i] * fx;
}

void hand_rhs(size_t n, const double *restrict state, const double *restrict parameters,
              double *restrict out)
{
    const double J = parameters[0];
    const double *restrict x = state, *restrict y = state + n, *restrict z = state + 2 * n;
    double *restrict dx = out, *restrict dy = out + n, *restrict dz = out + 2 * n;
    const size_t first = n < 10 ? n - 1 : 8;
    turn(0, n - 1, 1, n, state, J, out);
    turn(n - 1, n - 2, 0, n, state, J, out);
    for (size_t i = 1; i < first; ++i)
        turn(i, i - 1, i + 1, n, state, J, out);
#pragma GCC ivdep
    for (size_t i = first; i < n - 1; ++i) {
        const double fx = J * (x[i - 1] + x[i + 1]);
        const double fy = J * (y[i - 1] + y[i + 1]);
        const double fz = J * (z[i - 1] + z[i + 1]);
        dx[i] = y[i] * fz - z[i] * fy;
        dy[i] = z[i] * fx - x[i] * fz;
        dz[i] = x[i] * fy - y[i] * fx;
    }
}
