"""The target JavaScript: one member at a time, for web pages; its files are rendered on demand.

A generated folder does not hold them. Numbers of JavaScript are doubles, and ``+ - * /`` and
``Math.sqrt`` round as IEEE 754 says, so that these have the bits of NumPy. Other functions of
``Math`` are those of the engine (docs/decisions/javascript.md).
Read next: `templates/js/kernel.js.j2`.
"""

from coadjoint.render.targets.protocol import Target

TARGET = Target(
    package=__name__,
    builds={"js": "in an engine of JavaScript that Python can call: slow"},
    exact=("js",),
    kernel="kernel.js",
    files={"kernel.js": "js/kernel.js.j2"},
    is_slow=True,
)
