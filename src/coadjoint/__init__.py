"""coadjoint: declared mechanical systems to proved equations and verified NumPy and C kernels.

    >>> from coadjoint.systems import heavy_top  # doctest: +SKIP
    >>> import coadjoint
    >>> mine = coadjoint.load("my_robot.toml")  # doctest: +SKIP
    >>> coadjoint.examine(coadjoint.algebra_by_name("so(3)")).casimirs.found
    (J1**2 + J2**2 + J3**2,)

Importing this package, or a generated system, loads neither SymPy nor NumPy; each public name below
loads what it needs on first use. `load` and the names that end in ``_bounded`` limit the time and
memory that a spec may take, for untrusted specs; `read_spec`, `derive` and `prove` do not. To
read the engine, begin with `coadjoint.pipeline`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from coadjoint.errors import (
    CoadjointError,
    KinkWarning,
    PeriodicityWarning,
    ShockWarning,
    StabilityWarning,
)

if TYPE_CHECKING:
    from coadjoint.algebra import LieAlgebra, algebra_by_name
    from coadjoint.bodies import write_lattice
    from coadjoint.bounded import derive_bounded, prove_bounded, read_bounded
    from coadjoint.derive import Equations, derive
    from coadjoint.loading import load
    from coadjoint.poisson import PoissonStructure
    from coadjoint.prove import Certificate, prove
    from coadjoint.prove.examination import Examination, examine
    from coadjoint.solve.system import System
    from coadjoint.spec import Spec, read_spec

__version__ = "0.1.0"
__all__ = [
    "Certificate",
    "CoadjointError",
    "Equations",
    "Examination",
    "KinkWarning",
    "LieAlgebra",
    "PeriodicityWarning",
    "PoissonStructure",
    "ShockWarning",
    "Spec",
    "StabilityWarning",
    "System",
    "algebra_by_name",
    "derive",
    "derive_bounded",
    "examine",
    "load",
    "prove",
    "prove_bounded",
    "read_bounded",
    "read_spec",
    "write_lattice",
]

#: Module of each public name that is loaded on first use.
_HOMES = {
    "Certificate": "coadjoint.prove",
    "Equations": "coadjoint.derive",
    "Examination": "coadjoint.prove.examination",
    "LieAlgebra": "coadjoint.algebra",
    "PoissonStructure": "coadjoint.poisson",
    "Spec": "coadjoint.spec",
    "System": "coadjoint.solve.system",
    "algebra_by_name": "coadjoint.algebra",
    "derive": "coadjoint.derive",
    "derive_bounded": "coadjoint.bounded",
    "examine": "coadjoint.prove.examination",
    "load": "coadjoint.loading",
    "prove": "coadjoint.prove",
    "prove_bounded": "coadjoint.bounded",
    "read_bounded": "coadjoint.bounded",
    "read_spec": "coadjoint.spec",
    "write_lattice": "coadjoint.bodies",
}


def __getattr__(name: str) -> Any:
    """A public name, from its module.

    `coadjoint.derive` and `coadjoint.prove` are folders of modules as well as functions; importing
    a submodule binds it here, so those two modules can be called (`coadjoint.callable_module`).
    """
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOMES])
