/* Call a kernel many times from C, so that no Python call is measured. */
#include <stddef.h>

typedef void kernel(size_t, const double *, size_t, const double *, size_t, double *, size_t);

void repeat(size_t times, kernel *function, size_t count, const double *state, size_t state_stride,
            const double *parameters, size_t parameters_stride, double *out, size_t out_stride);

void repeat(size_t times, kernel *function, size_t count, const double *state, size_t state_stride,
            const double *parameters, size_t parameters_stride, double *out, size_t out_stride)
{
    for (size_t n = 0; n < times; ++n) {
        function(count, state, state_stride, parameters, parameters_stride, out, out_stride);
    }
}
