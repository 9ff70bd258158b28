"""Splittings: an energy as a sum of parts, each with a flow in closed form.

Comes in: Equations. Goes out: a `Splitting`, its parts in the order in which they are to act, or a
`NoSplitting` with the reason. A product of the flows, ``phi_1(h/2) ... phi_k(h) ... phi_1(h/2)``,
moves as the modified energy ``H + h^2 H_3 + ...`` does (R. I. McLachlan, SIAM Journal on Scientific
Computing 16 (1995) 151; E. Hairer, C. Lubich and G. Wanner, Geometric Numerical Integration, IX.4),
with ``H_3 = sum_k -{f_k, {f_k, g_k}}/24 - {g_k, {f_k, g_k}}/12``, where g_k is the sum of the parts
after f_k. F. Fasso, Journal of Computational Physics 189 (2003) 527, found energy errors of the
splittings of one body apart by orders of magnitude; so parts and order are chosen by H_3:

    of all ways to put the terms into at most `MOST` parts of commuting functions, and of all orders
    of these, the one with the least ``work^4 sum |J grad H_3|^2``, where work is the number of
    flows of a step and the sum is over the default state; where a component has no default, over
    states with those of 1, 1/2, 1/3, ... in turn. The first one of equals to 12 digits.

Of equal members terms of the same components are one, so that parts are the same for any number of
members.
Read next: `coadjoint.derive.flows`, and `coadjoint.lower.compositions`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import cached_property
from itertools import permutations, product
from types import MappingProxyType
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

from coadjoint.derive import derive, registry
from coadjoint.derive.equations import Equations
from coadjoint.derive.flows import Flow, Flows, NoFlowError, list_symbols
from coadjoint.elementary import ELEMENTARY
from coadjoint.errors import AlgebraError
from coadjoint.exact import Element
from coadjoint.exact.denominators import BudgetSpent
from coadjoint.exact.text import brief_text
from coadjoint.poisson.structure import PoissonStructure

#: Parts of which every order is tried.
MOST = 6
#: States at which errors are compared, where a component has no default.
STATES = 6
#: Digits with which they are computed, as many of which may cancel.
DIGITS = 40
#: Work of nested brackets, in products of terms; beyond, parts keep their order.
WORK = 300_000
#: Of a part, on which kinds of coordinates its terms depend.
Kinds = frozenset[frozenset[str]]


@dataclass(frozen=True)
class Part:
    """A part of the energy, with its flow.

    Attributes:
        energy: The part.
        flow: Its flow.
        kinds: The kinds of coordinates of its terms: of equal members components, else names.
    """

    energy: Element
    flow: Flow
    kinds: Kinds


@dataclass(frozen=True)
class Splitting:
    """An energy in parts.

    Attributes:
        equations: The motion in a field that has the symbols of flows.
        parts: In order: the first and the last factor of a symmetric product is the first part.
        errors: For each order that was compared, by the places of its parts here, the norm of
            ``J grad H_3``; empty where there was nothing to compare, or brackets are too long.
    """

    equations: Equations
    parts: tuple[Part, ...]
    errors: Mapping[tuple[int, ...], float]


@dataclass(frozen=True)
class NoSplitting:
    """Why an energy has no splitting that is found."""

    reason: str


def find_splitting(
    equations: Equations,
    kinds: Mapping[str, str] = MappingProxyType({}),
    parts: Sequence[Kinds] = (),
) -> Splitting | NoSplitting:
    """The splitting of a system, its flows proved, or why there is none.

    Args:
        equations: Of the system.
        kinds: What coordinates are of one kind, by their names; terms of the same kinds are one.
        parts: The kinds of the terms of each part, in order, where they are known; else they are
            chosen.
    """
    reason = _find_hindrance(equations)
    if reason:
        return NoSplitting(reason)
    size = len(equations.setting.state)
    setting = registry.make_setting(equations.spec, list_symbols(size), 2 * size)
    own = derive(equations.spec, equations.route, setting=setting)
    try:
        return _Search(own, kinds).run(parts)
    except (NoFlowError, AlgebraError) as error:
        return NoSplitting(str(error))


def _find_hindrance(equations: Equations) -> str:
    """What else than the energy itself is in the way; "" for nothing."""
    exact, setting = equations.exact, equations.setting
    if exact.energy is None:
        return "it has no energy"
    if exact.poisson_tensor is None:
        return "it has no Poisson tensor"
    if equations.distribution is not None or exact.residuals or exact.solves:
        return "it has constraints, and its tensor is not Poisson or not in closed form"
    if equations.spec.noise:
        return "it has noise, for which a substep back in time has no meaning"
    if setting.driving:
        return f"it is driven by {', '.join(setting.driving)}: its energy has no flow of its own"
    rates = PoissonStructure(
        setting.field,
        setting.state,
        tuple(tuple(map(equations.close, row)) for row in exact.poisson_tensor),
    ).hamiltonian_vector_field(equations.close(exact.energy))
    for name, rate, own in zip(setting.state, exact.rates, rates, strict=True):
        if not setting.field.is_zero(equations.close(rate) - own):
            return (
                f"the rate of {name} is not that of the Poisson tensor and the energy alone: what "
                "dissipates cannot be followed back in time, as some substeps do"
            )
    return ""


class _Search:
    """The search for the splitting of one system."""

    def __init__(self, equations: Equations, kinds: Mapping[str, str]) -> None:
        self.equations, self.setting = equations, equations.setting
        self.field, self.state = self.setting.field, self.setting.state
        self.kinds = tuple(kinds.get(name, name) for name in self.state)
        exact = equations.exact
        assert exact.poisson_tensor is not None
        assert exact.energy is not None
        tensor = tuple(tuple(map(equations.close, row)) for row in exact.poisson_tensor)
        self.structure = PoissonStructure(self.field, self.state, tensor)
        self.energy = equations.close(exact.energy)

    def run(self, given: Sequence[Kinds]) -> Splitting:
        """The splitting, into parts that are given or chosen.

        Raises:
            NoFlowError: There is none; the text says why.
        """
        algebra = self.structure.lie_algebra
        if algebra is None:
            raise NoFlowError("its Poisson tensor is not affine in the state")
        self.flows = Flows(self.field, self.state, algebra)
        atoms = self._take_apart()
        self._atoms = [function for _, function in atoms]
        chosen, errors = self._choose() if not given else ([*_find_groups(atoms, given)], {})
        parts = tuple(
            Part(function, self.flows.follow(function), frozenset().union(*(k for k, _ in own)))
            for own in ([atoms[n] for n in group] for group in chosen)
            for function in [self.field.sum(each for _, each in own)]
        )
        rest = self.energy - self.field.sum(part.energy for part in parts)
        moved = self.structure.hamiltonian_vector_field(rest)
        assert all(map(self.field.is_zero, moved)), "parts that are not the energy"
        return Splitting(self.equations, parts, errors)

    def _places(self, function: Element) -> list[int]:
        """The coordinates that a function depends on."""
        reach = self.field.reach(function)
        return [n for n, name in enumerate(self.state) if name in reach]

    def _take_apart(self) -> list[tuple[Kinds, Element]]:
        """The terms of the energy, together those of the same kinds, and those of kicks."""
        field, terms = self.field, dict[frozenset[str], list[Element]]()
        first = {kind: n for n, kind in reversed([*enumerate(self.kinds)])}
        for term in field.terms(self.energy):
            if kinds := frozenset(self.kinds[n] for n in self._places(term)):
                terms.setdefault(kinds, []).append(term)
        if not terms:
            raise NoFlowError("its energy does not depend on the state")
        groups: list[tuple[frozenset[int], Kinds, Element]] = []
        for kinds in sorted(terms, key=lambda own: sorted(first[kind] for kind in own)):
            function, one = field.sum(terms[kinds]), frozenset([kinds])
            places = frozenset(self._places(function))
            self._check_term(places, function)
            for n, (known, before, other) in enumerate(groups):
                both = known | places
                if self._are_kicks(both):
                    groups[n] = both, before | one, other + function
                    break
            else:
                groups.append((places, one, function))
        return [(kinds, function) for _, kinds, function in groups]

    def _check_term(self, places: frozenset[int], function: Element) -> None:
        """Refuse what has no flow here."""
        for i, j in product(places, repeat=2):
            if not self.flows.commute(i, j):
                text = brief_text(self.field, function)
                told = f"the term {text}" if text else "a term"
                raise NoFlowError(
                    f"{told} of its energy depends on "
                    f"{self.state[min(i, j)]} and {self.state[max(i, j)]}, whose bracket is not 0"
                )

    def _are_kicks(self, places: frozenset[int]) -> bool:
        """Whether coordinates commute and move the others along straight lines."""
        return all(
            all(self.flows.commute(i, j) for j in places) and self.flows.is_kick(i, [*places])
            for i in places
        )

    def _commute(self, a: int, b: int) -> bool:
        """Whether the coordinates of two atoms commute."""
        pairs = product(self._places(self._atoms[a]), self._places(self._atoms[b]))
        return all(self.flows.commute(i, j) for i, j in pairs)

    # -- the order ------------------------------------------------------------------------------

    def _choose(self) -> tuple[list[list[int]], dict[tuple[int, ...], float]]:
        """Groups of atoms in order, and the errors of all orders of these groups."""
        atoms = range(len(self._atoms))
        everything = [list(atoms)]
        if all(self._commute(a, b) for a, b in product(atoms, repeat=2)):
            return everything, {}
        partitions = [groups for groups in self._group(len(atoms)) if len(groups) <= MOST]
        if not partitions:
            raise NoFlowError(f"its energy has more than {MOST} parts that do not commute")
        try:
            with self.field.budget(WORK), localcontext(prec=DIGITS) as digits:
                digits.clear_traps()  # NaN is an answer
                brackets = self._find_brackets()
        except BudgetSpent:
            return partitions[0], {}
        brackets = brackets[..., np.isfinite(brackets).all(axis=(0, 1, 2))]
        if not brackets.size:  # none of the states has an energy, as that of a declared start
            return partitions[0], {}
        errors: dict[tuple[tuple[int, ...], ...], tuple[float, float]] = {}
        for partition in partitions:
            for order in permutations(partition):
                error = _find_error(brackets, order)
                errors[tuple(map(tuple, order))] = (error, error * self._work(order) ** 2)
        least = min(score for _, score in errors.values())
        best = next(o for o, (_, score) in errors.items() if score <= least * (1 + 1e-12))
        same = {
            tuple(best.index(group) for group in order): error
            for order, (error, _) in errors.items()
            if set(order) == set(best)
        }
        return [list(group) for group in best], same

    def _group(self, count: int) -> Iterator[list[list[int]]]:
        """All partitions of the atoms into groups that commute; of many atoms a greedy one."""

        def extend(groups: list[list[int]], n: int) -> Iterator[list[list[int]]]:
            if n == count:
                yield [list(group) for group in groups]
                return
            for group in groups:
                if all(self._commute(n, other) for other in group):
                    group.append(n)
                    yield from extend(groups, n + 1)
                    group.pop()
                    if count > MOST:
                        return
            yield from extend([*groups, [n]], n + 1)

        return extend([], 0)

    def _work(self, order: Sequence[Sequence[int]]) -> int:
        """Flows of a step: rotations, and a kick for what has none."""
        works = []
        for group in order:
            places = {i for n in group for i in self._places(self._atoms[n])}
            works.append(max(1, sum(map(self.flows.rotates, places))))
        return 2 * sum(works) - works[0] - works[-1]

    def _find_brackets(self) -> NDArray[np.float64]:
        """``J grad {a, {b, c}}`` at the states, for all atoms a, b and c."""
        field, structure, atoms = self.field, self.structure, range(len(self._atoms))
        values, factors = self._sample, dict[int, Any]()
        states = len(next(iter(values.values())))
        found = np.zeros((*[len(atoms)] * 3, states, len(self.state)))
        for b, c in product(atoms, repeat=2):
            if b >= c:
                continue
            inner = structure.bracket(self._atoms[b], self._atoms[c])
            for a in atoms if inner else ():
                outer = structure.bracket(self._atoms[a], inner)
                rows = structure.hamiltonian_vector_field(outer)
                for n, row in enumerate(rows):
                    if row:
                        place = found[a, b, c, :, n]
                        place[:] = field.evaluate(row, values, _number, _call, factors)
                found[a, c, b] = -found[a, b, c]
        return found.reshape(*found.shape[:3], -1)

    @cached_property
    def _sample(self) -> dict[str, NDArray[np.object_]]:
        """The states at which errors are compared: for each name its values, with many digits."""
        defaults, state = dict(self.field.region.defaults), self.state
        parameters = [name for name in self.setting.parameters if name not in defaults]
        defaults |= {name: Fraction(1, n + 1) for n, name in enumerate(parameters)}
        free = [name for name in state if name not in defaults]
        turns = range(min(STATES, len(free)) or 1)
        sample = {name: [value] * len(turns) for name, value in defaults.items()}
        for k, name in enumerate(free):
            sample[name] = [Fraction(1, (k + turn) % len(free) + 1) for turn in turns]
        return {
            name: np.array([_number(value) for value in row], dtype=object)
            for name, row in sample.items()
        }


def _find_groups(
    atoms: Sequence[tuple[Kinds, Element]], parts: Sequence[Kinds]
) -> Iterator[list[int]]:
    """The atoms of each part that is given."""
    for part in parts:
        yield [n for n, (kinds, _) in enumerate(atoms) if kinds <= part]


def _find_error(brackets: NDArray[np.float64], order: Sequence[Sequence[int]]) -> float:
    """The norm of ``J grad H_3`` of a symmetric product of groups in an order."""
    total = np.zeros(brackets.shape[-1])
    for n, group in enumerate(order):
        after = [each for other in order[n + 1 :] for each in other]
        inner = brackets[:, group][:, :, after].sum(axis=(1, 2))
        total -= inner[group].sum(axis=0) / 24 + inner[after].sum(axis=0) / 12
    return float(np.linalg.norm(total))


def _number(value: Fraction) -> Any:
    return Decimal(value.numerator) / value.denominator


def _call(function: str, *arguments: Any) -> Any:
    """An elementary function of numbers with many digits."""
    own = getattr(mpmath, function, None)
    if own is None:
        entry = ELEMENTARY[function]
        raise NoFlowError(f"{entry.name} has no value here")

    def evaluate(*of: Decimal) -> Decimal:
        with mpmath.workdps(DIGITS):
            return Decimal(mpmath.nstr(own(*map(str, of)), DIGITS))

    return np.frompyfunc(evaluate, len(arguments), 1)(*arguments)
