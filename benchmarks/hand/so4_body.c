/* Rigid body on so(4) by hand: M = I Omega, N = L Lambda;
   dM/dt = M x Omega + N x Lambda, dN/dt = M x Lambda + N x Omega, coefficients hoisted. */
#include <stddef.h>

void hand_rhs(size_t count, const double *state, size_t state_stride, const double *parameters,
              size_t parameters_stride, double *out, size_t out_stride);

void hand_rhs(size_t count, const double *state, size_t state_stride, const double *parameters,
              size_t parameters_stride, double *out, size_t out_stride)
{
    const double *restrict M1 = state, *restrict M2 = state + state_stride;
    const double *restrict M3 = state + 2 * state_stride, *restrict N1 = state + 3 * state_stride;
    const double *restrict N2 = state + 4 * state_stride, *restrict N3 = state + 5 * state_stride;
    double *restrict r1 = out, *restrict r2 = out + out_stride, *restrict r3 = out + 2 * out_stride;
    double *restrict s1 = out + 3 * out_stride, *restrict s2 = out + 4 * out_stride;
    double *restrict s3 = out + 5 * out_stride;
    const double i1 = 1 / parameters[0], i2 = 1 / parameters[1], i3 = 1 / parameters[2];
    const double l1 = 1 / parameters[3], l2 = 1 / parameters[4], l3 = 1 / parameters[5];
    const double i32 = i3 - i2, i13 = i1 - i3, i21 = i2 - i1;
    const double l32 = l3 - l2, l13 = l1 - l3, l21 = l2 - l1;
    const double a1 = l3 - i2, b1 = i3 - l2, a2 = l1 - i3, b2 = i1 - l3, a3 = l2 - i1, b3 = i2 - l1;
    (void)parameters_stride;
#pragma GCC ivdep /* gcc does not take the word of restrict for local pointers */
    for (size_t n = 0; n < count; ++n) {
        const double m1 = M1[n], m2 = M2[n], m3 = M3[n], n1 = N1[n], n2 = N2[n], n3 = N3[n];
        r1[n] = i32 * (m2 * m3) + l32 * (n2 * n3);
        r2[n] = i13 * (m3 * m1) + l13 * (n3 * n1);
        r3[n] = i21 * (m1 * m2) + l21 * (n1 * n2);
        s1[n] = a1 * (m2 * n3) + b1 * (m3 * n2);
        s2[n] = a2 * (m3 * n1) + b2 * (m1 * n3);
        s3[n] = a3 * (m1 * n2) + b3 * (m2 * n1);
    }
}
