r"""Integrability: whether constraints on velocities come from constraints on positions.

Theorem (Frobenius; Holm 2011, section 12.1): the distribution of the fields D_k is integrable if
and only if it has the brackets of its fields; with the constraints as forms A, if and only if
:math:`A([D_i, D_j]) = 0`. How the fields grow by brackets, first once, then again, until they grow
no more, is the growth vector: if they reach every direction the constraints are completely
nonholonomic (Chow 1939, Rashevskii 1938), else some combination of them is holonomic. Of affine
constraints the linear part is spoken of. Ranks are those at almost every point.
Comes in: Equations with a distribution. Goes out: findings for the certificate.
Read next: `coadjoint.prove.almost_poisson`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.distribution import Distribution, Row
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import minor
from coadjoint.exact.ranks import independent_rows
from coadjoint.exact.signs import sign
from coadjoint.exact.witness import is_entire, is_nonzero
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.completeness import ALMOST, IN_PART
from coadjoint.prove.findings import (
    finding,
    first_nonzero,
    for_parameters,
    guess,
    show_value,
)
from coadjoint.prove.zero import Decision, Discovery, Examined, decide_zero


@dataclass(frozen=True)
class Basis:
    """Fields that span a distribution at almost every point.

    Where no constraint is kept these are the columns of B. A constraint that is kept is solved for
    a velocity, which may have a pole: proofs divide by it, kernels do not.

    Attributes:
        distribution: Of the constraints.
    """

    distribution: Distribution

    @cached_property
    def eliminated(self) -> Mapping[str, Element]:
        """The velocities for which kept constraints are solved, in terms of the others."""
        field, known = self.distribution.setting.field, dict[str, Element]()
        for _, residual in self.distribution.kept:
            value = field.substitute(residual, known)
            name = self._choose(value)
            rest = field.substitute(value, {name: field.zero})
            root = -rest / field.derivative(value, name)
            known = {n: field.substitute(v, {name: root}) for n, v in known.items()}
            known[name] = root
        return known

    def _choose(self, residual: Element) -> str:
        """The velocity for which a constraint is solved: without a pole if there is such a one."""
        field, names = self.distribution.setting.field, self.distribution.independent
        slopes = dict(zip(names, field.gradient(residual, names), strict=True))
        free = (name for name, slope in slopes.items() if sign(field, slope))
        generic = (name for name, slope in slopes.items() if is_nonzero(field, slope))
        return next(free, None) or next(generic)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The velocities that stand for the fields."""
        return tuple(n for n in self.distribution.independent if n not in self.eliminated)

    @cached_property
    def fields(self) -> dict[str, Row]:
        """The fields by their velocities, components along the frame."""
        field = self.distribution.setting.field
        return {name: tuple(field.derivative(x, name) for x in self._xi) for name in self.names}

    @cached_property
    def drift(self) -> Row:
        """The velocities where those of the fields are zero: beta, zero without affine terms."""
        field = self.distribution.setting.field
        rest = dict.fromkeys(self.names, field.zero)
        return tuple(field.substitute(x, rest) for x in self._xi)

    @cached_property
    def _xi(self) -> Row:
        """All velocities of the frame by those of the fields."""
        return tuple(map(self.close, self.distribution.xi))

    def close(self, element: Element) -> Element:
        """An element in the velocities of the fields and the positions alone."""
        field = self.distribution.setting.field
        inner = field.substitute(element, self.distribution.solved)
        return field.substitute(inner, self.eliminated)

    def annihilate(self, vector: Sequence[Element]) -> Row:
        """``A v``: zero for vectors of the distribution."""
        field = self.distribution.setting.field
        return tuple(
            field.sum(a * x for a, x in zip(row, vector, strict=True) if a and x)
            for row in self.distribution.A
        )


def about_integrability(first: Equations) -> Iterator[Examined]:
    """Whether the constraints are integrable, and if not, what their brackets reach."""
    distribution = first.distribution
    assert distribution is not None, first.route
    if not distribution.equations:
        return
    basis, field = Basis(distribution), distribution.setting.field
    values = brackets_of(basis)
    name, decision = first_nonzero(values, field)
    many = len(distribution.equations) > 1
    subject = "the constraints are" if many else "the constraint is"
    if not distribution.is_linear:
        subject = f"of the linear parts, {subject}"
    value = values.get(name, field.zero)
    where = "on any open set" if is_entire(field, [value]) else "near some point"
    yield finding(
        "integrability",
        decision,
        f"{subject} integrable: [D_i, D_j] stays in the distribution",
        f"{subject} not integrable {where}{for_parameters(distribution.setting, [value])}: "
        f"{name}{show_value(field, value)}",
    )
    if name:
        growth = Growth(basis)
        yield growth.statement, "integrability", lambda: growth.decision


def brackets_of(basis: Basis) -> dict[str, Element]:
    """``rolling1([D_Omega1, D_Omega2])`` for all constraints and pairs of fields."""
    distribution, values = basis.distribution, dict[str, Element]()
    for (a, one), (b, two) in combinations(basis.fields.items(), 2):
        parts = basis.annihilate(distribution.frame.bracket(one, two))
        for equation, part in zip(distribution.equations, parts, strict=True):
            values[f"{equation.name}([D_{a}, D_{b}])"] = part
    return values


class Growth:
    """How a distribution grows by brackets with its fields.

    Args:
        basis: Its fields.
    """

    def __init__(self, basis: Basis) -> None:
        self.basis = basis
        self.ranks = [0]
        self._minors: list[Element] = []
        self._zeros: list[Element] = []
        fields = list(basis.fields.values())
        frame, codimension = basis.distribution.frame, len(basis.distribution.equations)
        rows: list[Row] = []
        newest = [frame.bracket(a, b) for a, b in combinations(fields, 2)]
        while True:
            whole = [*rows, *map(basis.annihilate, newest)]
            chosen = self._choose_rows(whole)
            self.ranks.append(len(chosen))
            if self.ranks[-1] in (self.ranks[-2], codimension):
                break
            kept = [newest[n - len(rows)] for n in chosen if n >= len(rows)]
            rows = [whole[n] for n in chosen]
            newest = [frame.bracket(a, b) for a in fields for b in kept]

    @property
    def _field(self) -> Field:
        return self.basis.distribution.setting.field

    def _choose_rows(self, rows: Sequence[Row]) -> list[int]:
        """Places of rows that span all of them; what proves so is kept."""
        sparse = [{j: e for j, e in enumerate(row) if e != 0} for row in rows]
        chosen = independent_rows(self._field, sparse)
        turned = [
            {i: rows[n][j] for i, n in enumerate(chosen) if rows[n][j] != 0}
            for j in range(len(self.basis.distribution.equations))
        ]
        columns = independent_rows(self._field, turned)
        if not chosen:
            self._zeros += [e for row in rows for e in row]
            return []
        self._minors.append(minor(rows, chosen, columns))
        self._zeros += [
            minor(rows, [*chosen, n], [*columns, j])
            for n in range(len(rows))
            if n not in chosen
            for j in range(len(turned))
            if j not in columns
        ]
        return chosen

    @property
    def vector(self) -> tuple[int, ...]:
        """Dimensions of the distribution, with brackets, with brackets of those, until they end."""
        size = len(self.basis.fields)
        return tuple(size + rank for n, rank in enumerate(self.ranks) if rank not in self.ranks[:n])

    @property
    def holonomic(self) -> int:
        """How many combinations of the constraints are integrable."""
        return len(self.basis.distribution.equations) - self.ranks[-1]

    @property
    def statement(self) -> str:
        """The growth vector, and what it says.

        It may be smaller where a minor vanishes.
        """
        count, many = len(self.basis.distribution.equations), self.holonomic > 1
        text = f"the constraint{' is' if count == 1 else 's are'} completely nonholonomic there"
        if self.holonomic:
            combinations = f"{self.holonomic} independent combinations" if many else "1 combination"
            verb = "are" if many else "is"
            text = f"{combinations} of the {count} constraints {verb} holonomic there, and no more"
        where = ALMOST if is_entire(self._field, self._minors) else IN_PART
        scope = for_parameters(self.basis.distribution.setting, self._minors)
        return f"growth vector {self.vector} {where}{scope}: {text}"

    @cached_property
    def decision(self) -> Decision | Discovery:
        """Ranks from below by minors that are not zero, from above by bordered ones that are."""
        for value in self._minors:
            lower = decide_zero([value], self._field)
            if lower.verdict is not Verdict.REFUTED:
                return guess(lower)
        decision = decide_zero(self._zeros, self._field)
        if decision.verdict is Verdict.PROVED:
            return Decision(verdict=Verdict.PROVED, method="exact minors of the matrix of brackets")
        return decision if decision.verdict is Verdict.REFUTED else guess(decision)
