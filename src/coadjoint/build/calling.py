"""The file that is compiled: a source, and two functions that call it with packed arguments.

Comes in: nothing. Goes out: C text, in which ``SOURCE`` and ``BUILD`` are replaced by names.
Read next: `coadjoint.build.compiler`, which compiles it, and `coadjoint.build.library`.
"""

from typing import Final

#: Names in every object: of its build, and of the two ways to call a kernel.
LABEL: Final = "coadjoint_build"
CALL: Final = "coadjoint_call"
CALL_AT: Final = "coadjoint_call_at"
#: That file. It includes the source, since one file takes the compiler less time than two
#: (docs/decisions/compiler.md). Converting one argument takes ctypes less time than converting
#: seven or more, so that arguments are packed: function, number of arrays, members, then place and
#: stride of each array, the state first and the result last (docs/decisions/loading.md).
SUPPORT: Final = """#include "SOURCE"

#include <stddef.h>
#include <stdint.h>
#include <string.h>

typedef const double *in;
typedef void kernel3(size_t, in, size_t, in, size_t, double *, size_t);
typedef void kernel4(size_t, in, size_t, in, size_t, in, size_t, double *, size_t);
typedef void kernel5(size_t, in, size_t, in, size_t, in, size_t, in, size_t, double *, size_t);
typedef void kernel6(
    size_t, in, size_t, in, size_t, in, size_t, in, size_t, in, size_t, double *, size_t);

extern const char coadjoint_build[];
const char coadjoint_build[] = "BUILD";

void coadjoint_call(const uintptr_t *);
void coadjoint_call_at(const uintptr_t *, size_t, in, in, double *);

void coadjoint_call(const uintptr_t *c)
{
    const uintptr_t *a = c + 3;
    switch (c[1]) {
    case 3:
        ((kernel3 *)c[0])(c[2], (in)a[0], a[1], (in)a[2], a[3], (double *)a[4], a[5]);
        break;
    case 4:
        ((kernel4 *)c[0])(
            c[2], (in)a[0], a[1], (in)a[2], a[3], (in)a[4], a[5], (double *)a[6], a[7]);
        break;
    case 5:
        ((kernel5 *)c[0])(
            c[2], (in)a[0], a[1], (in)a[2], a[3], (in)a[4], a[5], (in)a[6], a[7],
            (double *)a[8], a[9]);
        break;
    default:
        ((kernel6 *)c[0])(
            c[2], (in)a[0], a[1], (in)a[2], a[3], (in)a[4], a[5], (in)a[6], a[7],
            (in)a[8], a[9], (double *)a[10], a[11]);
    }
}

/* The same at another state of so many members, with other parameters or NULL, another result. */
void coadjoint_call_at(const uintptr_t *c, size_t members, in state, in parameters, double *out)
{
    uintptr_t own[15], last = 2 * c[1] + 1;
    memcpy(own, c, (last + 2) * sizeof *own);
    own[2] = own[4] = own[last + 1] = members;
    own[3] = (uintptr_t)state;
    if (parameters)
        own[5] = (uintptr_t)parameters;
    own[last] = (uintptr_t)out;
    coadjoint_call(own);
}
"""
