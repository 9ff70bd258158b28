r"""Integrals of a Lax pair: the coefficients of :math:`\mathrm{tr}\, L^k`, an independent set.

Theorem (Lax 1968; Holm 2011, sections 2.4.4 and 2.4.5): if :math:`\dot L = [L, M]` for every value
of the spectral parameter, then :math:`\frac{d}{dt} \mathrm{tr}\, L^k = k\, \mathrm{tr}(L^{k-1}
[L, M]) = 0`, power by power of the parameter.
Comes in: a Setting whose spec declares a pair, or a route that finds one. Goes out: the
coefficients that depend on the state, and which of them are emitted: as many as there are
independent ones in addition to the claimed Casimirs and the energy, the shortest first.
Read next: `coadjoint.prove.lax`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import gcd, lcm

from coadjoint.derive.mechanics.legendre import hamiltonian
from coadjoint.derive.mechanics.planes import find_pair
from coadjoint.derive.pairs import LaxPair, declared_pair
from coadjoint.derive.setting import Setting, once
from coadjoint.derive.submanifold import put_on_section
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Matrix, diagonal, product
from coadjoint.exact.ranks import independent_rows


@dataclass(frozen=True)
class Coefficient:
    """What depends on the state in the coefficient of a power of the spectral parameter.

    Attributes:
        trace: The power k of L.
        power: The power of the spectral parameter.
        value: The coefficient of the trace without addends of parameters alone, times a number.
    """

    trace: int
    power: int
    value: Element


@dataclass(frozen=True)
class Integrals:
    """The integrals of a Lax pair.

    Attributes:
        pair: The pair.
        coefficients: All coefficients that depend on the state.
        emitted: Those that become observables ``integral1``, ``integral2``, ...
    """

    pair: LaxPair
    coefficients: tuple[Coefficient, ...]
    emitted: tuple[Coefficient, ...]

    @property
    def named(self) -> tuple[tuple[str, Element], ...]:
        """Name and value of each one that is emitted."""
        return tuple((f"integral{n}", each.value) for n, each in enumerate(self.emitted, 1))


@once
def pair_of(setting: Setting) -> LaxPair | None:
    """The declared pair of a system, or else the one that the route manakov finds."""
    if setting.spec.lax is not None:
        return declared_pair(setting)
    own = "manakov" in setting.spec.routes and setting.spec.reduction is None
    return find_pair(setting) if own else None


@once
def lax_integrals(setting: Setting) -> Integrals | None:
    """The integrals that a system has by its Lax pair; None without one."""
    pair = pair_of(setting)
    if pair is None:
        return None
    coefficients = tuple(expanded_traces(setting, pair))
    return Integrals(pair, coefficients, tuple(_choose_independent(setting, coefficients)))


def expanded_traces(setting: Setting, pair: LaxPair) -> Iterator[Coefficient]:
    """The coefficients of ``tr L^k``, k = 1 to the size of L, that depend on the state."""
    field = setting.field
    for k, trace in enumerate(traces(field, pair.L), 1):
        for power, whole in field.coefficients(trace, pair.spectral).items():
            moving = field.sum(_pick_moving(setting, whole))
            if moving:
                yield Coefficient(k, power, moving * _scale(field, moving))


def traces(field: Field, L: Matrix) -> Iterator[Element]:
    """``tr L``, ``tr L^2``, ... up to the size of L."""

    @cache
    def raise_to(k: int) -> Matrix:
        if k == 0:
            return diagonal([field.one] * len(L))
        return L if k == 1 else product(raise_to(k // 2), raise_to(k - k // 2))

    for k in range(1, len(L) + 1):
        a, b = raise_to(k // 2), zip(*raise_to(k - k // 2), strict=True)
        pairs = ((x, y) for p, q in zip(a, b, strict=True) for x, y in zip(p, q, strict=True))
        yield field.sum(x * y for x, y in pairs if x and y)


def _pick_moving(setting: Setting, element: Element) -> Iterable[Element]:
    """The addends of an element in which the state occurs."""
    state = set(setting.state)
    return (term for term in setting.field.terms(element) if setting.field.reach(term) & state)


def _scale(field: Field, element: Element) -> Fraction:
    """What makes the numbers in an element whole, without common factor and the first positive."""
    numbers = [monomial.number for part in field.quotients(element) for monomial in part.monomials]
    common = lcm(*(number.denominator for number in numbers))
    shared = gcd(*(int(number * common) for number in numbers))
    return Fraction(common if numbers[0] > 0 else -common, shared)


def _choose_independent(
    setting: Setting, coefficients: Iterable[Coefficient]
) -> Iterator[Coefficient]:
    """Coefficients independent of what is known and of each other, the shortest first."""
    field, known = setting.field, known_integrals(setting)
    ordered = sorted(coefficients, key=lambda each: len(field.terms(each.value)))
    slopes = [slope_row(setting, value) for value in (*known, *(each.value for each in ordered))]
    for place in independent_rows(field, slopes):
        if place >= len(known):
            yield ordered[place - len(known)]


def known_integrals(setting: Setting) -> list[Element]:
    """What is emitted and conserved whatever the pair: the claimed Casimirs and the energy."""
    casimirs = [
        put_on_section(setting, part)
        for casimir in setting.spec.casimirs
        for part in setting.components(casimir)
    ]
    if not setting.has_energy:
        return casimirs
    energy, solves = hamiltonian(setting)
    # where the kernel solves for velocities, the energy names them next to the momenta
    return [*casimirs, *([] if solves else [put_on_section(setting, energy)])]


def slope_row(setting: Setting, function: Element) -> dict[int, Element]:
    """The nonzero derivatives of a function by the state."""
    slopes = setting.field.gradient(function, setting.state)
    return {n: slope for n, slope in enumerate(slopes) if slope}
