"""Compositions: how much of each flow, or of each step, stands where in a step of a method.

Comes in: a number of parts and an order. Goes out: a `Schedule`, pairs of a flow and the part of
the step that it takes, from the first that acts to the last one; and lengths of the steps of a
symmetric method of which one of a higher order is composed.

Those of Blanes and Moan are published with 15 digits; here they have 50, by Newton on the
conditions of order, and the tests hold them to these, in the free algebra. In doubles the
coefficient of each flow in the middle is what the others leave, so that a step has its length to a
rounding.
Read next: `coadjoint.lower.flows`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from decimal import Context, Decimal, localcontext
from fractions import Fraction
from functools import cache
from typing import Final

#: Flows, by their places, and parts of a step, in the order in which they act.
Schedule = tuple[tuple[int, float], ...]
Coefficients = tuple[Decimal, ...]
#: Methods that are compositions of flows, with their orders.
SPLITTINGS: Final = {"splitting": 2, "splitting4": 4, "splitting6": 6}
#: Methods of a single map of their own names.
SINGLE: Final = ("kahan", "exact_body")
#: The arithmetic of coefficients.
DIGITS: Final = Context(prec=60)


def _mirror(outer: Sequence[Decimal]) -> Coefficients:
    """Symmetric coefficients with the sum 1."""
    return (*outer, 1 - 2 * sum(outer, Decimal(0)), *reversed(outer))


def _complete(a: Sequence[str], b: Sequence[str]) -> tuple[Coefficients, Coefficients]:
    """Coefficients of two flows from the outer ones of each."""
    with localcontext(DIGITS):
        one, two = list(map(Decimal, a)), list(map(Decimal, b))
        last = Decimal("0.5") - sum(two, Decimal(0))
        return _mirror(one), (*two, last, last, *reversed(two))


def blanes_moan4() -> tuple[Coefficients, Coefficients]:
    """Parts of two flows in turn that make order 4, the first one first and last.

    S. Blanes and P. C. Moan, Journal of Computational and Applied Mathematics 142 (2002) 313, S6.
    """
    a = (
        "0.079203696431195669433663495888268873308015070876608",
        "0.35317290604977398848106131157312105653036945475635",
        "-0.04206508035771953536811029830251703872041104132472",
    )
    b = (
        "0.20951510661336202127407264002950101690213009527187",
        "-0.1438517731798180082751150578565277256482351390507",
    )
    return _complete(a, b)


def blanes_moan6() -> tuple[Coefficients, Coefficients]:
    """The same of order 6: their S10."""
    a = (
        "0.050262764400392686021221654402074109406287588082069",
        "0.41351430042834381506306372013388443897274411529623",
        "0.045079889794398062968897052124513471162080957042855",
        "-0.18805485381956891479912848891887054248560249486645",
        "0.5419606784507801348314147409330724963472567336488",
    )
    b = (
        "0.14881644790104323192090100553557758887775976985757",
        "-0.13238586576778364744884542659893992157530238478965",
        "0.067307604692184458150257896592601046898922503617559",
        "0.43266640257817359752766797088354529805903744905717",
    )
    return _complete(a, b)


def strang() -> tuple[Coefficients, Coefficients]:
    """The symmetric product of two flows, of order 2. G. Strang, SIAM J. Numer. Anal. 5 (1968)."""
    half = Decimal("0.5")
    return (half, half), (Decimal(1),)


#: Parts of two flows in turn, by the order of their product.
PAIRS: Final = {2: strang, 4: blanes_moan4, 6: blanes_moan6}


def find_sweeps(a: Coefficients, b: Coefficients) -> Coefficients:
    """The lengths of sweeps through the flows, forth and back in turn, whose pairs are a and b.

    With ``a_1 = c_1, b_1 = c_1 + c_2, a_2 = c_2 + c_3`` a product of two flows is one of sweeps
    ``exp(c A) exp(c B)`` and ``exp(c B) exp(c A)``. It has the same order for sweeps through any
    number of flows: R. I. McLachlan, SIAM Journal on Scientific Computing 16 (1995) 151.
    """
    sweeps: list[Decimal] = []
    with localcontext(DIGITS):
        for n in range(len(a) + len(b) - 1):
            whole = (a, b)[n % 2][n // 2]
            sweeps.append(whole - sweeps[-1] if sweeps else whole)
    return tuple(sweeps)


@cache
def schedule(parts: int, order: int) -> Schedule:
    """A step of Strang, or of Blanes and Moan, for any number of parts.

    >>> schedule(3, 2)
    ((0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5))
    """
    with localcontext(DIGITS):
        sweeps = find_sweeps(*PAIRS[order]())
        forth = range(parts)
        flows = [(n, c) for k, c in enumerate(sweeps) for n in (forth, forth[::-1])[k % 2]]
        return _round(_merge(flows))


def list_schedules(maps: Iterable[str]) -> dict[str, tuple[tuple[str, float], ...]]:
    """The methods of a system: which map acts for which part of a step, in order.

    Args:
        maps: The names of its maps.
    """
    names = tuple(maps)
    flows = [name for name in names if name.startswith("flow")]
    found: dict[str, tuple[tuple[str, float], ...]] = {}
    for method, order in SPLITTINGS.items() if flows else ():
        own: Schedule = schedule(len(flows), order) if len(flows) > 1 else ((0, 1.0),)
        found[method] = tuple((flows[part], time) for part, time in own)
    return found | {name: ((name, 1.0),) for name in SINGLE if name in names}


def suzuki() -> Coefficients:
    """Order 4 from five steps. M. Suzuki, Physics Letters A 146 (1990) 319."""
    with localcontext(DIGITS):
        outer = 1 / (4 - Decimal(4) ** (Decimal(1) / 3))
        return _mirror((outer, outer))


def kahan_li() -> Coefficients:
    """Order 6 from nine. W. Kahan and R.-C. Li, Mathematics of Computation 66 (1997) 1089, s9odr6a.

    As printed by Hairer, Lubich and Wanner, Geometric Numerical Integration, V.3.2.
    """
    outer = (
        "0.39216144400731413928",
        "0.33259913678935943860",
        "-0.70624617255763935981",
        "0.08221359629355080023",
    )
    with localcontext(DIGITS):
        return _mirror(tuple(map(Decimal, outer)))


def _merge(flows: Sequence[tuple[int, Decimal]]) -> list[tuple[int, Decimal]]:
    """Flows of one part that follow one another, as one."""
    merged: list[tuple[int, Decimal]] = []
    for part, time in flows:
        if merged and merged[-1][0] == part:
            time = merged.pop()[1] + time
        merged.append((part, time))
    return merged


def _round(flows: Sequence[tuple[int, Decimal]]) -> Schedule:
    """Coefficients as doubles, symmetric, those of each part with the sum 1 to a rounding.

    The one in the middle is what the others leave; of a part that has none there, two are.
    """
    rounded = [float(time) for _, time in flows]
    for part in {part for part, _ in flows}:
        places = [n for n, (own, _) in enumerate(flows) if own == part]
        middle = {places[(len(places) - 1) // 2], places[len(places) // 2]}
        rest = 1 - sum(Fraction(rounded[n]) for n in places if n not in middle)
        for n in middle:
            rounded[n] = float(rest / len(middle))
    return tuple((part, time) for (part, _), time in zip(flows, rounded, strict=True))


def _round_steps(lengths: Coefficients) -> tuple[float, ...]:
    """Lengths of steps as doubles with the sum 1."""
    return tuple(length for _, length in _round([(0, each) for each in lengths]))


#: Lengths of the steps of which one of a symmetric method is composed, by its order.
COMPOSITIONS: Final = {2: (1.0,), 4: _round_steps(suzuki()), 6: _round_steps(kahan_li())}
