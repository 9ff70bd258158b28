r"""Constrained motions: what is claimed of constraints, of both roads and of the energy.

Comes in: Equations with a distribution. Goes out: claims for the certificate. A rate is affine in
the accelerations, which solve :math:`\mathcal{M} x = k`; its value is written with
determinants,

.. math:: c \cdot x + d = d - \det \begin{pmatrix} \mathcal{M} & k \\ c & 0 \end{pmatrix}
    \Big/ \det \mathcal{M},

so that it is a rational function with a decidable zero. Constraints that are kept are relations.
Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property, partial

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.configuration import LARGEST_BLOCK
from coadjoint.derive.mechanics.constrained import section_components
from coadjoint.derive.mechanics.distribution import Distribution, Row
from coadjoint.derive.mechanics.driving import explicit
from coadjoint.derive.mechanics.kinematics import kept_rows, rate_name
from coadjoint.derive.mechanics.solver import Solve, solution_defects
from coadjoint.exact import Element, element_text
from coadjoint.exact.dense import determinant, dot
from coadjoint.exact.ranks import generic_rank, source_of_ranks
from coadjoint.exact.witness import is_entire
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.energy import Balance
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.zero import Decision, Examined, decide_zero

#: Characters of a determinant that a statement shows.
SHORT = 60


class ConstrainedRates:
    """Rates of functions along a constrained motion, as functions of the state alone.

    Args:
        equations: By a route with constraints.
    """

    def __init__(self, equations: Equations) -> None:
        assert equations.distribution is not None, equations.route
        self.equations, self.distribution = equations, equations.distribution
        self.field = equations.setting.field

    def closed(self, element: Element) -> Element:
        """An element in the state, the parameters and the accelerations alone."""
        return self.equations.closed(element)

    @cached_property
    def where(self) -> Ideal:
        """The constraints that are kept, as relations of the state.

        No motion is defined where they depend on each other, as where one has no velocity left:
        ``q*u == q*v`` at q = 0. There a claim says nothing, and the certificate says so.
        """
        kept = self.distribution.kept
        text = ", ".join(f"{equation.name} = 0" for equation, _ in kept)
        nonzero = _rank_drops(self.distribution)
        return Ideal(self.field, [residual for _, residual in kept], text, nonzero=nonzero)

    @cached_property
    def rates(self) -> dict[str, Element]:
        """``dx/dt`` of the state, the accelerations by their names."""
        names = self.equations.setting.state
        return dict(zip(names, map(self.closed, self.equations.exact.rates), strict=True))

    def rate(self, function: Element) -> Element:
        """The time derivative of a function of state and velocities, or of reactions."""
        return self.value(self._carried(self.in_state(function)))

    def _carried(self, function: Element) -> Element:
        """The time derivative of a function of state and time, in accelerations."""
        own = explicit(self.equations.setting, function)
        names = self.equations.setting.state
        slopes = zip(self.field.gradient(function, names), names, strict=True)
        return own + self.field.sum(s * self.rates[name] for s, name in slopes if s != 0)

    def in_state(self, function: Element) -> Element:
        """A function of the state alone, also where it names reactions."""
        closed = self.closed(function)
        rests = self.field.reach(closed) & set(self.equations.kept)
        return self.value(closed) if rests else closed

    def value(self, element: Element) -> Element:
        """An element affine in accelerations and multipliers, in the state alone."""
        rest = self.field.substitute(self.closed(element), self._resting)
        parts = []
        for block in self._blocks:
            slopes = self.field.gradient(rest, block.names)
            if any(slope != 0 for slope in slopes):
                parts.append(self._along(block, slopes))
        unknown = {name: self.field.zero for block in self._blocks for name in block.names}
        return self.field.sum([self.field.substitute(rest, unknown), *parts])

    def _along(self, block: Solve, c: Row) -> Element:
        """``c . x`` where x solves a block.

        No determinant is needed where ``c = w M``: for the energy w is eta, for the momentum along
        a section of the distribution it is that section, and a unit vector for its basis.
        """
        field = self.field
        for weights in self._weights(block):
            turned = (dot(weights, column) for column in zip(*block.matrix, strict=True))
            if all(field.is_zero(x - y) for x, y in zip(turned, c, strict=True)):
                return dot(weights, block.known)
        bordered = (
            *((*row, k) for row, k in zip(block.matrix, block.known, strict=True)),
            (*c, field.zero),
        )
        return -determinant(bordered) / determinant(tuple(map(tuple, block.matrix)))

    def _weights(self, block: Solve) -> Iterator[Row]:
        """Combinations of the equations of a block that are worth a trial."""
        one, zero = self.field.one, self.field.zero
        for name in block.names:
            yield tuple(one if name == other else zero for other in block.names)
        for values in self._directions:
            yield tuple(values.get(name, zero) for name in block.names)

    @cached_property
    def _directions(self) -> list[dict[str, Element]]:
        """The velocities and the declared sections, by the names of the accelerations."""
        found = self.distribution
        sections = (section_components(found, each) for each in found.setting.spec.sections)
        velocities = self.equations.setting.elements(found.independent)
        return [
            dict(zip(map(rate_name, found.independent), map(self.closed, values), strict=True))
            for values in (velocities, *sections)
        ]

    @cached_property
    def _resting(self) -> dict[str, Element]:
        """What rests on the accelerations, written out in them: other rates and the reactions."""
        solved = {name for solve in self.equations.exact.solves for name in solve.names}
        names = set(self.equations.kept) - solved - self.equations.intermediates
        known: dict[str, Element] = {}
        for name, value in self.equations.exact.definitions:
            if name in names:
                known[name] = self.closed(self.field.substitute(value, known))
        return known

    @cached_property
    def _blocks(self) -> list[Solve]:
        """Every solve, in the state alone."""
        return [
            Solve(
                tuple(tuple(map(self.closed, row)) for row in solve.matrix),
                list(map(self.closed, solve.known)),
                solve.block,
                solve.names,
            )
            for solve in self.equations.exact.solves
        ]

    def energy_balance(self) -> Element:
        """``dE/dt`` minus the power of declared forces and of constraints that move."""
        energy = self.equations.exact.energy
        assert energy is not None, "a Lagrangian has an energy"
        return self.value(self._carried(self.closed(energy)) - Balance(self.equations).power)


def about_constraints(motion: ConstrainedRates, others: Sequence[Equations]) -> Iterator[Examined]:
    """The constraints, the solve in the kernel, the equality with other routes and the energy."""
    first, found = motion.equations, motion.distribution
    if found.equations:
        count = len(found.equations)
        text = f"the {count} constraints are" if count > 1 else "the constraint is"
        rank, decision = _rank(found)
        yield f"{text} independent: {rank}", "constraint", lambda: decision
    yield (
        "the kernel solves for the accelerations: L D L^T = B^T M B",
        "constraint",
        lambda: _solved(first),
    )
    for other in others:
        yield (
            f"{first.route} and {other.route} give the same motion",
            "equivalence",
            partial(_same_solves, first, other),
        )
    yield (
        Balance(first).statement,
        "conserved",
        lambda: decide_zero([motion.energy_balance()], motion.field, motion.where),
    )
    for equation, residual in found.kept:
        yield (
            f"the motion keeps {equation.name}",
            "constraint",
            partial(_kept, motion, residual),
        )


def _kept(motion: ConstrainedRates, residual: Element) -> list[Element]:
    return [motion.rate(residual)]


def _rank(found: Distribution) -> tuple[str, Decision]:
    """The rank of A, which the derivation has refused to be less, where it is certain, and how."""
    field, rank = found.setting.field, f"rank {len(found.equations)}"
    rows = [{k: e for k, e in enumerate(row) if e != 0} for row in found.A]
    assert generic_rank(field, rows) == len(rows), "distribution refuses these"
    if not found.kept:
        minor = Decision(Verdict.PROVED, "a minor of A that is 1 or -1")
        return f"{rank} everywhere, each gives a velocity", minor
    gram = _gram(found)
    text = "" if gram is None else element_text(field, gram)
    if gram is None or len(text) > SHORT:
        entire = is_entire(field, (entry for row in rows for entry in row.values()))
        where = "almost every point" + ("" if entire else " of a connected part of the domain")
        method = f"rank of A {source_of_ranks(field, (rows, len(rows)))}"
        return f"{rank} at {where}", Decision(Verdict.PROVED, method)
    where = "everywhere" if field.as_number(gram) is not None else f"wherever {text} is not 0"
    method = "det(A A^T) of the constraints that give no velocity"
    return f"{rank} {where}", Decision(Verdict.PROVED, method)


def _gram(found: Distribution) -> Element | None:
    """``det(A A^T)`` of the constraints that are kept, in the velocities of the state.

    Over the real numbers it is zero exactly where these depend on each other. None of more than
    three, whose determinant would fill a page.
    """
    products = _products(found)
    if len(products) > LARGEST_BLOCK:
        return None
    return found.setting.field.normal(determinant(products))


def _rank_drops(found: Distribution) -> list[Element]:
    """What is zero where the constraints that are kept depend on each other."""
    products = _products(found)
    rows = [row[n] for n, row in enumerate(products)]
    return [*rows, determinant(products)] if 1 < len(products) <= LARGEST_BLOCK else rows


def _products(found: Distribution) -> tuple[Row, ...]:
    """``A A^T`` of the constraints that are kept, in the velocities of the state."""
    field, rows = found.setting.field, [row[:-1] for row in kept_rows(found)]
    return tuple(
        tuple(field.sum(x * y for x, y in zip(a, b, strict=True)) for b in rows) for a in rows
    )


def _solved(first: Equations) -> list[Element]:
    """What vanishes if the definitions solve the linear equations."""
    definitions = dict(first.exact.definitions)
    return [
        defect
        for solve in first.exact.solves
        for defect in solution_defects(first.setting.field, solve, definitions)
    ]


def _same_solves(first: Equations, other: Equations) -> list[Element]:
    """Differences of the linear equations of two routes, and of the rates.

    The equations are compared entry by entry, whatever blocks each route has found in them.
    """
    one, two = _linear_equations(first), _linear_equations(other)
    field = first.setting.field
    defects = [one.get(at, field.zero) - two.get(at, field.zero) for at in {**one, **two}]
    solved = {name for solve in first.exact.solves for name in solve.names}
    for x, a, b in zip(first.setting.state, first.exact.rates, other.exact.rates, strict=True):
        if rate_name(x) in solved:  # each is what its own equations are solved for
            defects += [a - field[rate_name(x)], b - field[rate_name(x)]]
        else:
            defects.append(first.closed(a) - other.closed(b))
    return defects


def _linear_equations(equations: Equations) -> dict[tuple[str, str], Element]:
    """A and b of all solves in the state: entries by the names of row and column, "" for b."""
    found = dict[tuple[str, str], Element]()
    for solve in equations.exact.solves:
        for name, row, known in zip(solve.names, solve.matrix, solve.known, strict=True):
            entries = zip((*solve.names, ""), (*row, known), strict=True)
            found |= {(name, by): equations.closed(entry) for by, entry in entries}
    return found
