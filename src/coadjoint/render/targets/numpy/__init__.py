"""The target NumPy: formulas over arrays of members.

Read next: ``kernel.py.j2``, and its twin in `coadjoint.render.targets.c`.
"""

from coadjoint.render.targets.protocol import Target

TARGET = Target(
    package=__name__,
    builds={"numpy": ""},
    exact=("numpy",),
    kernel="kernel.py",
    files={"kernel.py": "numpy/kernel.py.j2"},
)
