/* Heavy top by hand: structure of arrays, restrict rows, hoisted reciprocals and products.
   dPi/dt = Pi x Omega + m g Gamma x chi, dGamma/dt = Gamma x Omega, Omega = Pi/I. */
#include <stddef.h>

void hand_rhs(size_t count, const double *state, size_t state_stride, const double *parameters,
              size_t parameters_stride, double *out, size_t out_stride);

void hand_rhs(size_t count, const double *state, size_t state_stride, const double *parameters,
              size_t parameters_stride, double *out, size_t out_stride)
{
    const double *restrict Pi1 = state, *restrict Pi2 = state + state_stride;
    const double *restrict Pi3 = state + 2 * state_stride;
    const double *restrict Gamma1 = state + 3 * state_stride;
    const double *restrict Gamma2 = state + 4 * state_stride;
    const double *restrict Gamma3 = state + 5 * state_stride;
    double *restrict r1 = out, *restrict r2 = out + out_stride, *restrict r3 = out + 2 * out_stride;
    double *restrict s1 = out + 3 * out_stride, *restrict s2 = out + 4 * out_stride;
    double *restrict s3 = out + 5 * out_stride;
    const double a1 = 1 / parameters[0], a2 = 1 / parameters[1], a3 = 1 / parameters[2];
    const double mg = parameters[3] * parameters[4];
    const double x1 = mg * parameters[5], x2 = mg * parameters[6], x3 = mg * parameters[7];
    (void)parameters_stride;
#pragma GCC ivdep /* gcc does not take the word of restrict for local pointers */
    for (size_t n = 0; n < count; ++n) {
        const double p1 = Pi1[n], p2 = Pi2[n], p3 = Pi3[n];
        const double g1 = Gamma1[n], g2 = Gamma2[n], g3 = Gamma3[n];
        const double w1 = a1 * p1, w2 = a2 * p2, w3 = a3 * p3;
        r1[n] = p2 * w3 - p3 * w2 + (g2 * x3 - g3 * x2);
        r2[n] = p3 * w1 - p1 * w3 + (g3 * x1 - g1 * x3);
        r3[n] = p1 * w2 - p2 * w1 + (g1 * x2 - g2 * x1);
        s1[n] = g2 * w3 - g3 * w2;
        s2[n] = g3 * w1 - g1 * w3;
        s3[n] = g1 * w2 - g2 * w1;
    }
}
