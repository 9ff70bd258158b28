/* Underwater vehicle by hand: structure of arrays, restrict rows, the 2 x 2 inverses hoisted.
   Pi = I Omega + D v and P = D Omega + M v along each axis;
   dPi/dt = Pi x Omega + P x v, dP/dt = P x Omega. */
#include <stddef.h>

void hand_rhs(size_t count, const double *state, size_t state_stride, const double *parameters,
              size_t parameters_stride, double *out, size_t out_stride);

void hand_rhs(size_t count, const double *state, size_t state_stride, const double *parameters,
              size_t parameters_stride, double *out, size_t out_stride)
{
    const double *restrict Pi1 = state, *restrict Pi2 = state + state_stride;
    const double *restrict Pi3 = state + 2 * state_stride;
    const double *restrict P1 = state + 3 * state_stride, *restrict P2 = state + 4 * state_stride;
    const double *restrict P3 = state + 5 * state_stride;
    double *restrict r1 = out, *restrict r2 = out + out_stride, *restrict r3 = out + 2 * out_stride;
    double *restrict s1 = out + 3 * out_stride, *restrict s2 = out + 4 * out_stride;
    double *restrict s3 = out + 5 * out_stride;
    const double *I = parameters, *M = parameters + 3, *D = parameters + 6;
    double a[3], b[3], c[3]; /* Omega = a Pi - b P, v = c P - b Pi */
    (void)parameters_stride;
    for (int i = 0; i < 3; ++i) {
        const double inverse = 1 / (I[i] * M[i] - D[i] * D[i]);
        a[i] = inverse * M[i];
        b[i] = inverse * D[i];
        c[i] = inverse * I[i];
    }
    const double a1 = a[0], a2 = a[1], a3 = a[2], b1 = b[0], b2 = b[1], b3 = b[2];
    const double c1 = c[0], c2 = c[1], c3 = c[2];
#pragma GCC ivdep /* gcc does not take the word of restrict for local pointers */
    for (size_t n = 0; n < count; ++n) {
        const double p1 = Pi1[n], p2 = Pi2[n], p3 = Pi3[n];
        const double q1 = P1[n], q2 = P2[n], q3 = P3[n];
        const double w1 = a1 * p1 - b1 * q1, w2 = a2 * p2 - b2 * q2, w3 = a3 * p3 - b3 * q3;
        const double v1 = c1 * q1 - b1 * p1, v2 = c2 * q2 - b2 * p2, v3 = c3 * q3 - b3 * p3;
        r1[n] = p2 * w3 - p3 * w2 + (q2 * v3 - q3 * v2);
        r2[n] = p3 * w1 - p1 * w3 + (q3 * v1 - q1 * v3);
        r3[n] = p1 * w2 - p2 * w1 + (q1 * v2 - q2 * v1);
        s1[n] = q2 * w3 - q3 * w2;
        s2[n] = q3 * w1 - q1 * w3;
        s3[n] = q1 * w2 - q2 * w1;
    }
}
