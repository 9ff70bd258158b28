"""The target Python: one member at a time, of numbers and `math` alone, to be read and pasted.

Read next: `templates/python/kernel_python.py.j2`.
"""

from coadjoint.render.targets.protocol import Target

TARGET = Target(
    package=__name__,
    builds={"python": "no NumPy, one member after the other: slow"},
    exact=("python",),
    kernel="kernel_python.py",
    files={"kernel_python.py": "python/kernel_python.py.j2"},
    is_slow=True,
    stops_at_poles=True,
)
