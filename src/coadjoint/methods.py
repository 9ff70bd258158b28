"""Methods: the one list of methods of integration that keep the structure of a motion.

Comes in: nothing. Goes out: an entry for each method, which choices, solvers, texts in C, messages
and documents read. For another method add an entry here, its step in NumPy as a module of
`coadjoint.solve.methods`, and the same in C below ``templates/c/methods``.
Read next: `coadjoint.solve.methods`.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final


@dataclass(frozen=True)
class StructuredMethod:
    """A method that keeps some structure of a motion, with steps of fixed length.

    Attributes:
        name: As a person writes it.
        file: Its module of `coadjoint.solve.methods`, and its file below ``templates/c/methods``.
        order: By what power of the step an error falls.
        needs: Functions of the kernel that its steps call, the rates apart.
        keeps: What it keeps exactly, as a clause.
        theorem: What it is and why it keeps that, with the source.
    """

    name: str
    file: str
    order: int
    needs: tuple[str, ...]
    keeps: str
    theorem: str

    @property
    def macro(self) -> str:
        """What chooses it in C."""
        return self.name.upper()


_QUADRATIC: Final = (
    "E. Hairer, C. Lubich and G. Wanner, Geometric Numerical Integration (2006), theorem IV.2.1"
)

_ENTRIES: Final = (
    StructuredMethod(
        name="midpoint",
        file="midpoint",
        order=2,
        needs=(),
        keeps="linear and quadratic integrals, to the rounding of each step",
        theorem=f"the implicit midpoint, which keeps quadratic integrals ({_QUADRATIC})",
    ),
    StructuredMethod(
        name="midpoint4",
        file="midpoint",
        order=4,
        needs=(),
        keeps="linear and quadratic integrals, to the rounding of each step",
        theorem="five steps of the implicit midpoint with Suzuki's lengths (Physics Letters A 146 "
        "(1990) 319), which keep quadratic integrals",
    ),
    StructuredMethod(
        name="midpoint6",
        file="midpoint",
        order=6,
        needs=(),
        keeps="linear and quadratic integrals, to the rounding of each step",
        theorem="nine steps of the implicit midpoint with the lengths of Kahan and Li (Mathematics "
        "of Computation 66 (1997) 1089), which keep quadratic integrals",
    ),
)

_POISSON: Final = (
    "R. I. McLachlan, SIAM Journal on Scientific Computing 16 (1995) 151; E. Hairer, C. Lubich and "
    "G. Wanner, Geometric Numerical Integration (2006), IX"
)
_KEPT_BY_FLOWS: Final = (
    "the Poisson tensor, all Casimirs and leaves, to rounding; the energy within a bound"
)
_BLANES: Final = (
    "with the parts of S. Blanes and P. C. Moan, Journal of Computational and Applied Mathematics "
    "142 (2002) 313"
)

_MAPS: Final = (
    StructuredMethod(
        name="splitting",
        file="sequence",
        order=2,
        needs=("flow1",),
        keeps=_KEPT_BY_FLOWS,
        theorem=f"a symmetric product of flows of parts of the energy, a Poisson map ({_POISSON})",
    ),
    StructuredMethod(
        name="splitting4",
        file="sequence",
        order=4,
        needs=("flow1",),
        keeps=_KEPT_BY_FLOWS,
        theorem=f"a product of flows of parts of the energy {_BLANES}, a Poisson map ({_POISSON})",
    ),
    StructuredMethod(
        name="splitting6",
        file="sequence",
        order=6,
        needs=("flow1",),
        keeps=_KEPT_BY_FLOWS,
        theorem=f"a product of flows of parts of the energy {_BLANES}, a Poisson map ({_POISSON})",
    ),
    StructuredMethod(
        name="kahan",
        file="sequence",
        order=2,
        needs=("kahan",),
        keeps="nothing exactly; quadratic motions that are integrable keep modified integrals",
        theorem="(1 - h/2 f'(x)) d = h f(x), symmetric and birational, and no Poisson map (E. "
        "Celledoni, R. I. McLachlan, B. Owren and G. R. W. Quispel, Journal of Physics A 46 (2013) "
        "025201)",
    ),
    StructuredMethod(
        name="exact_body",
        file="sequence",
        order=10,
        needs=("exact_body",),
        keeps="all that the free motion of a body keeps, to rounding",
        theorem="the exact flow of Euler's top by elliptic functions (E. Celledoni, F. Fasso, N. "
        "Safstrom and A. Zanna, SIAM Journal on Scientific Computing 30 (2008) 2084)",
    ),
)

_TABLE: Final = {each.name: each for each in _ENTRIES}
#: Every method that keeps structure, by name.
STRUCTURED: Final = MappingProxyType(_TABLE)
_MAPPED: Final = {each.name: each for each in _MAPS}
#: Those whose steps are a sequence of maps: explicit, or with one linear equation.
MAPPED: Final = MappingProxyType(_MAPPED)


def list_structured(functions: Collection[str]) -> tuple[StructuredMethod, ...]:
    """The methods that the functions of a solver allow.

    Motions with noise have methods of their own, and steps that end at kinks are explicit.

    Args:
        functions: Their names, ``kinks`` among them where the rates have some.

    >>> [method.name for method in list_structured(["rhs"])]
    ['midpoint', 'midpoint4', 'midpoint6']
    >>> list_structured(["rhs", "noise"])
    ()
    """
    if "noise" in functions or "kinks" in functions:
        return ()
    return tuple(each for each in _ENTRIES if set(each.needs) <= set(functions))
