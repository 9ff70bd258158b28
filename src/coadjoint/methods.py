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
    *(
        StructuredMethod(
            name=f"gauss{order}",
            file="gauss",
            order=order,
            needs=(),
            keeps="linear and quadratic integrals, to the rounding of each step",
            theorem=f"the method of Gauss with {order // 2} stages, which keeps quadratic "
            f"integrals ({_QUADRATIC}), with shares of stages that sum to 1 without rounding "
            "(M. Antonana, J. Makazaga and A. Murua, Numerical Algorithms 76 (2017) 861)",
        )
        for order in (4, 6, 8)
    ),
)

_TABLE: Final = {each.name: each for each in _ENTRIES}
#: Every method that keeps structure, by name.
STRUCTURED: Final = MappingProxyType(_TABLE)


def list_structured(functions: Collection[str]) -> tuple[StructuredMethod, ...]:
    """The methods that the functions of a solver allow.

    Motions with noise have methods of their own, and steps that end at kinks are explicit.

    Args:
        functions: Their names, ``kinks`` among them where the rates have some.

    >>> [method.name for method in list_structured(["rhs"])]
    ['midpoint', 'midpoint4', 'midpoint6', 'gauss4', 'gauss6', 'gauss8']
    >>> list_structured(["rhs", "noise"])
    ()
    """
    if "noise" in functions or "kinks" in functions:
        return ()
    return tuple(each for each in _ENTRIES if set(each.needs) <= set(functions))
