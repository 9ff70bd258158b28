"""Preferences: the method that ``"auto"`` takes with a fixed step, and wishes for what is kept.

Comes in: the methods of a system, judged when it was derived. Goes out: a name, with the reason;
or a refusal by the theorem that is in the way.
Read next: `coadjoint.solve.request`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from coadjoint.errors import KernelArgumentError
from coadjoint.methods import PLAIN

if TYPE_CHECKING:
    from coadjoint.solve.system import System

#: Words of a wish for the bracket, with the energy.
_BRACKET: Final = frozenset({"poisson", "symplectic"})
#: Why both are not to be had.
GE_MARSDEN: Final = (
    "a method that keeps the energy and the Poisson structure is the exact motion up to a "
    "reparametrisation of time, where there are no other integrals (Z. Ge and J. E. Marsden, "
    "Physics Letters A 133 (1988) 134)"
)


@dataclass(frozen=True)
class Preferred:
    """A method that was chosen for a person, and why, as a clause."""

    name: str
    why: str


def find_default(system: System, obstacles: Mapping[str, str], plain: str = PLAIN) -> Preferred:
    """The first method of the system that applies to a run, with a fixed step.

    Args:
        system: The System.
        obstacles: Why methods do not apply to the run, by name, as far as they do not.
        plain: The method where none of those applies that are known to keep something.
    """
    ranked = sorted((each for each in system.METHODS if each.rank), key=lambda each: each.rank)
    for method in ranked:
        if method.name not in obstacles:
            return Preferred(method.name, f"the default of {system.name}: {method.decides}")
    reason = next(
        (f"{each.name} does not apply: {obstacles[each.name]}" for each in ranked),
        f"none is known to keep anything of {system.name}",
    )
    return Preferred(plain, f"it keeps no structure, and {reason}")


def is_wish(method: Any) -> bool:
    """Whether energy and bracket are asked for in place of a method.

    >>> is_wish("energy+poisson"), is_wish("Poisson and energy"), is_wish("energy")
    (True, True, False)
    """
    if not isinstance(method, str):
        return False
    words = {*re.findall("[a-z]+", method.lower())} - {"and"}
    return len(words) == 2 and "energy" in words and bool(words & _BRACKET)


def grant_wish(system: System, method: str, obstacles: Mapping[str, str]) -> Preferred:
    """The method that keeps energy and bracket of this very system.

    Raises:
        KernelArgumentError: None is known to; with the theorem, and methods that keep one of them.
    """
    here = [each for each in system.METHODS if each.name not in obstacles]
    both = [each for each in here if each.is_poisson and "energy" in each.exactly]
    if both:
        best = max(both, key=lambda each: each.order)
        return Preferred(best.name, f"it keeps energy and bracket of {system.name}: {best.decides}")
    energy = [each.name for each in here if "energy" in each.exactly]
    bracket = [each.name for each in here if each.is_poisson]
    named = [
        f"{', '.join(map(repr, names))} for the {what}"
        for names, what in ((energy, "energy"), (bracket, "bracket"))
        if names
    ]
    advice = f"; expected one of {' or '.join(named)}" if named else "; expected method='auto'"
    raise KernelArgumentError(
        f"method is {method!r}, and no method is known to keep both exactly for {system.name}: "
        f"{GE_MARSDEN}{advice}.",
        found=method,
        expected=[*energy, *bracket],
    )
