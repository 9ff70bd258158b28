/* Free rigid body as one would write it by hand for speed: structure of arrays, restrict rows,
   hoisted reciprocals. dPi/dt = Pi x Omega, Omega = Pi/I. */
#include <stddef.h>

void hand_rhs(size_t count, const double *state, size_t state_stride, const double *parameters,
              size_t parameters_stride, double *out, size_t out_stride);

void hand_rhs(size_t count, const double *state, size_t state_stride, const double *parameters,
              size_t parameters_stride, double *out, size_t out_stride)
{
    const double *restrict Pi1 = state, *restrict Pi2 = state + state_stride;
    const double *restrict Pi3 = state + 2 * state_stride;
    double *restrict r1 = out, *restrict r2 = out + out_stride, *restrict r3 = out + 2 * out_stride;
    const double a1 = 1 / parameters[0], a2 = 1 / parameters[1], a3 = 1 / parameters[2];
    (void)parameters_stride;
#pragma GCC ivdep /* gcc does not take the word of restrict for local pointers */
    for (size_t n = 0; n < count; ++n) {
        const double p1 = Pi1[n], p2 = Pi2[n], p3 = Pi3[n];
        const double w1 = a1 * p1, w2 = a2 * p2, w3 = a3 * p3;
        r1[n] = p2 * w3 - p3 * w2;
        r2[n] = p3 * w1 - p1 * w3;
        r3[n] = p1 * w2 - p2 * w1;
    }
}
