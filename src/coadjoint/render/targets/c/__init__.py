"""The target C: loops over members that a compiler turns into vector code, in two builds.

Read next: `templates/c/kernel.c.j2` and its twin `templates/numpy/kernel.py.j2`.
"""

from coadjoint.render.targets.protocol import Target

TARGET = Target(
    package=__name__,
    builds={"c": "", "c-fast": "fused operations: not the same bits"},
    exact=("c",),
    kernel="kernel.c",
    files={
        "kernel.c": "c/kernel.c.j2",
        "kernel.h": "c/kernel.h.j2",
        "solver.c": "c/solver.c.j2",
        "solver.h": "c/solver.h.j2",
        "reconstruction.c": "c/solver.c.j2",
        "reconstruction.h": "c/solver.h.j2",
    },
    needs_compiler=True,
)
