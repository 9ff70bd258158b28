"""The target NumPy: formulas over arrays of members.

Read next: `templates/numpy/kernel.py.j2` and its twin `templates/c/kernel.c.j2`.
"""

from coadjoint.render.targets.protocol import Target

TARGET = Target(
    package=__name__,
    builds={"numpy": ""},
    exact=("numpy",),
    kernel="kernel.py",
    files={
        "kernel.py": "numpy/kernel.py.j2",
        "solver.py": "numpy/solver.py.j2",
        "reconstruction.py": "numpy/solver.py.j2",
    },
)
