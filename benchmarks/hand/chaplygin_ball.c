/* Chaplygin's ball by hand. With s = r Gamma + chi and Y = Omega x s, Y + r dGamma/dt is Omega x chi, so
   that (I + m s^2 - m s s^T) dOmega/dt = (I Omega) x Omega
       - m s x (Omega (Omega . chi) - chi Omega^2 + g Gamma).
   The symmetric matrix is inverted by its cofactors, with one division. */
#include <stddef.h>

void hand_rhs(size_t count, const double *state, size_t state_stride, const double *parameters,
              size_t parameters_stride, double *out, size_t out_stride);

void hand_rhs(size_t count, const double *state, size_t state_stride, const double *parameters,
              size_t parameters_stride, double *out, size_t out_stride)
{
    const double *restrict Omega1 = state, *restrict Omega2 = state + state_stride;
    const double *restrict Omega3 = state + 2 * state_stride;
    const double *restrict Gamma1 = state + 3 * state_stride;
    const double *restrict Gamma2 = state + 4 * state_stride;
    const double *restrict Gamma3 = state + 5 * state_stride;
    double *restrict r1 = out, *restrict r2 = out + out_stride, *restrict r3 = out + 2 * out_stride;
    double *restrict s1 = out + 3 * out_stride, *restrict s2 = out + 4 * out_stride;
    double *restrict s3 = out + 5 * out_stride;
    const double I1 = parameters[0], I2 = parameters[1], I3 = parameters[2], m = parameters[3];
    const double r = parameters[4], g = parameters[5];
    const double x1 = parameters[6], x2 = parameters[7], x3 = parameters[8];
    const double i23 = I2 - I3, i31 = I3 - I1, i12 = I1 - I2;
    (void)parameters_stride;
#pragma GCC ivdep /* gcc does not take the word of restrict for local pointers */
    for (size_t n = 0; n < count; ++n) {
        const double w1 = Omega1[n], w2 = Omega2[n], w3 = Omega3[n];
        const double g1 = Gamma1[n], g2 = Gamma2[n], g3 = Gamma3[n];
        const double a1 = r * g1 + x1, a2 = r * g2 + x2, a3 = r * g3 + x3; /* s */
        const double along = w1 * x1 + w2 * x2 + w3 * x3, square = w1 * w1 + w2 * w2 + w3 * w3;
        const double v1 = w1 * along - x1 * square + g * g1;
        const double v2 = w2 * along - x2 * square + g * g2;
        const double v3 = w3 * along - x3 * square + g * g3;
        const double b1 = i23 * w2 * w3 - m * (a2 * v3 - a3 * v2);
        const double b2 = i31 * w3 * w1 - m * (a3 * v1 - a1 * v3);
        const double b3 = i12 * w1 * w2 - m * (a1 * v2 - a2 * v1);
        const double m1 = m * a1, m2 = m * a2, m3 = m * a3;
        const double q1 = m1 * a1, q2 = m2 * a2, q3 = m3 * a3;
        const double d1 = I1 + (q2 + q3), d2 = I2 + (q3 + q1), d3 = I3 + (q1 + q2);
        const double e12 = m1 * a2, e23 = m2 * a3, e31 = m3 * a1; /* the others, with a minus */
        const double c11 = d2 * d3 - e23 * e23, c22 = d3 * d1 - e31 * e31;
        const double c33 = d1 * d2 - e12 * e12;
        const double c12 = e12 * d3 + e31 * e23, c23 = e23 * d1 + e12 * e31;
        const double c31 = e31 * d2 + e12 * e23;
        const double over = 1 / (d1 * c11 - e12 * c12 - e31 * c31);
        r1[n] = over * (c11 * b1 + c12 * b2 + c31 * b3);
        r2[n] = over * (c12 * b1 + c22 * b2 + c23 * b3);
        r3[n] = over * (c31 * b1 + c23 * b2 + c33 * b3);
        s1[n] = g2 * w3 - g3 * w2;
        s2[n] = g3 * w1 - g1 * w3;
        s3[n] = g1 * w2 - g2 * w1;
    }
}
