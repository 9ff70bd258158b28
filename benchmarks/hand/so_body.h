/* Manakov's body on so(N) by hand: M = A Omega + Omega A with A = diag(a), so that
   dM/dt = [M, Omega] = A Omega^2 - Omega^2 A, that is (a_i - a_j) (Omega^2)_ij.
   Eight members are one vector; Omega stays in registers. */
#include <stddef.h>
#include <string.h>

typedef double V __attribute__((vector_size(64)));

void hand_rhs(size_t count, const double *state, size_t state_stride, const double *parameters,
              size_t parameters_stride, double *out, size_t out_stride);

static inline __attribute__((always_inline)) void
eight(const double *state, size_t state_stride, const double *a, const double *over, double *out,
      size_t out_stride, size_t bytes)
{
    V w[N][N];
    size_t row = 0;
#pragma GCC unroll 8
    for (int i = 0; i < N; ++i)
#pragma GCC unroll 8
        for (int j = i + 1; j < N; ++j, ++row) {
            V m = {0};
            memcpy(&m, state + row * state_stride, bytes);
            w[i][j] = over[row] * m;
        }
    row = 0;
#pragma GCC unroll 8
    for (int i = 0; i < N; ++i)
#pragma GCC unroll 8
        for (int j = i + 1; j < N; ++j, ++row) {
            V sum = {0};
#pragma GCC unroll 8
            for (int k = 0; k < N; ++k) {
                if (k < i)
                    sum -= w[k][i] * w[k][j];
                else if (k > i && k < j)
                    sum += w[i][k] * w[k][j];
                else if (k > j)
                    sum -= w[i][k] * w[j][k];
            }
            sum *= a[i] - a[j];
            memcpy(out + row * out_stride, &sum, bytes);
        }
}

void hand_rhs(size_t count, const double *state, size_t state_stride, const double *parameters,
              size_t parameters_stride, double *out, size_t out_stride)
{
    double over[N * (N - 1) / 2], a[N];
    size_t row = 0, n;
    (void)parameters_stride;
    memcpy(a, parameters, sizeof a);
    for (int i = 0; i < N; ++i)
        for (int j = i + 1; j < N; ++j)
            over[row++] = 1 / (a[i] + a[j]);
    for (n = 0; n + 8 <= count; n += 8)
        eight(state + n, state_stride, a, over, out + n, out_stride, sizeof(V));
    if (n < count)
        eight(state + n, state_stride, a, over, out + n, out_stride, (count - n) * sizeof *out);
}
