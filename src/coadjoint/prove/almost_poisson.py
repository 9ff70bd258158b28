r"""The almost-Poisson bracket of a constrained motion: that it is one, and how far from Poisson.

In momenta :math:`M_k = \langle p, D_k \rangle` along the distribution the motion is
:math:`J \nabla H` (`coadjoint.derive.mechanics.almost_poisson`). Affine constraints
:math:`\xi = B \eta + \beta` add the drift of the canonical flow of :math:`\langle p, \beta\rangle`,

.. math::
    \dot z = J \nabla H + \beta z, \qquad
    \dot M_k = J \nabla H + \langle p, [\beta, D_k] \rangle, \qquad
    H = E - \langle p, \beta \rangle.

Constraints that are kept are solved for a velocity here, where they have one. Whether J satisfies
the Jacobi
identity is a finding: it does if the constraints are integrable, and for rolling bodies it does
not. The defects are :math:`\{\{a, b\}, c\}` and its cyclic images for a, b, c among momenta and
positions; derivatives by momenta are those by velocities, through the mass matrix,

.. math::
    \frac{\partial (M, z)}{\partial (\eta, z)}
        = \begin{pmatrix} \mathcal{M} & \partial_z M \\ 0 & 1 \end{pmatrix}.

Comes in: Equations with a distribution. Goes out: claims and findings for the certificate.
Read next: `coadjoint.prove.momenta`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cached_property
from itertools import combinations, islice
from typing import Any

import mpmath

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.almost_poisson import Tensor, brackets, momenta_along
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.distribution import Row
from coadjoint.derive.mechanics.driving import explicit
from coadjoint.derive.mechanics.external import external_forces
from coadjoint.derive.mechanics.relaxed import relaxed
from coadjoint.exact import Element
from coadjoint.exact.dense import dot, inverse
from coadjoint.exact.witness import Enclosure, enclose_function, is_entire
from coadjoint.poisson.jacobi import Triple, schouten_bracket
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.findings import for_parameters, nonzero_at
from coadjoint.prove.identities import antisymmetry_defects
from coadjoint.prove.integrability import Basis
from coadjoint.prove.points import Points
from coadjoint.prove.zero import (
    DIGITS,
    Decision,
    Discovery,
    Examined,
    decide_zero,
    prove_by_normal_form,
)

Pair = tuple[int, int]
#: Points at which the Jacobi identity is tried before it is examined as a whole.
TRIED = 3
#: Arithmetic with bounds; its precision is its own.
INTERVALS = mpmath.ctx_iv.MPIntervalContext()
INTERVALS.dps = DIGITS


class ReducedBracket:
    """The bracket of the momenta along a basis of the distribution, and of the positions.

    Args:
        equations: By a route with a distribution.
    """

    def __init__(self, equations: Equations) -> None:
        assert equations.distribution is not None, equations.route
        self.equations, self.distribution = equations, equations.distribution
        self.basis = Basis(self.distribution)
        self.field = equations.setting.field
        self.names = tuple(n for n in equations.setting.state if n not in self.basis.eliminated)

    @cached_property
    def momenta(self) -> dict[str, Element]:
        """``M_k`` in velocities of the basis and positions, by the velocities that they are of."""
        fields = self.basis.fields
        along = momenta_along(self.distribution.setting, list(fields.values()))
        return dict(zip(fields, map(self.basis.close, along), strict=True))

    @cached_property
    def tensor(self) -> Tensor:
        """The brackets: as emitted, or along the basis if constraints are kept."""
        emitted = self.equations.exact.poisson_tensor
        if emitted is None:
            emitted = brackets(self.distribution, self.basis.fields, self.names)
        return tuple(tuple(map(self.basis.close, row)) for row in emitted)

    @cached_property
    def slopes(self) -> Row:
        """``(dH/dM, dH/dz)`` as the theorem has them: ``(eta, -dl_c/dz)``, in state order."""
        constrained = self.basis.close(self.equations.setting.lagrangian)
        return tuple(
            self.field[n] if n in self.momenta else -self.field.derivative(constrained, n)
            for n in self.names
        )

    def gradient_defects(self) -> list[Element]:
        """``dH`` by velocities and positions, minus what the chain rule makes of `slopes`."""
        energy = self.equations.exact.energy
        assert energy is not None, "a Lagrangian has an energy"
        drift = momenta_along(self.distribution.setting, [self.basis.drift])[0]
        closed = self.basis.close(energy - drift)
        return [
            self.field.derivative(closed, by)
            - self.field.sum(
                slope * self.field.derivative(self.momenta.get(n, self.field[n]), by)
                for n, slope in zip(self.names, self.slopes, strict=True)
            )
            for by in self.names
        ]

    @cached_property
    def added(self) -> Row:
        """What is added to ``J grad H``: by a symmetric bracket, and `forces`."""
        along = relaxed(self.distribution.setting)
        if along is None:
            return self.forces
        return tuple(x + along.closed[n] for n, x in zip(self.names, self.forces, strict=True))

    @cached_property
    def forces(self) -> Row:
        """What forces, time and affine terms add, in all velocities and reactions.

        To the momenta the forces along the fields, ``<p, dD/dt>`` where fields depend on time, and
        ``<p, [beta, D]>``; to positions ``beta z``.
        """
        setting, frame = self.distribution.setting, self.distribution.frame
        forces, momenta = external_forces(setting, frame.velocities), mechanics(setting).momenta
        drift, carried = self.basis.drift, frame.rates(self.basis.drift)
        added = []
        for name in self.names:
            if name not in self.basis.fields:
                added.append(carried[name] + frame.drift(self.field[name]))
                continue
            along = self.basis.fields[name]
            turned = frame.bracket(drift, along) if any(drift) else (self.field.zero,) * len(along)
            own = [explicit(setting, a) + frame.drift(a) for a in along]
            moved = [a + x for a, x in zip(own, turned, strict=True)]
            pairs = [*zip(along, forces, strict=True), *zip(moved, momenta, strict=True)]
            added.append(self.field.sum(a * b for a, b in pairs if a and b))
        return tuple(added)

    def motion_defects(self, motion: ConstrainedRates) -> list[Element]:
        """Rates of momenta and positions minus ``J grad H`` and what is added to it."""
        defects = []
        for name, row, added in zip(self.names, self.tensor, self.added, strict=True):
            along = self.basis.fields.get(name, ())  # none of a position
            moved = self.field[name]
            if along:
                (moved,) = momenta_along(self.distribution.setting, [along])
            turned = self.field.sum(a * b for a, b in zip(row, self.slopes, strict=True) if a and b)
            defects.append(motion.balance(moved, added, along) - turned)
        return defects

    # -- the Jacobi identity ------------------------------------------------------------

    @cached_property
    def turn(self) -> Tensor:
        """``d(M, z)/d(eta, z)``."""
        values = (self.momenta.get(n, self.field[n]) for n in self.names)
        return tuple(self.field.gradient(value, self.names) for value in values)

    @cached_property
    def entry_slopes(self) -> dict[Pair, Row]:
        """Derivatives of the brackets by velocities and positions."""
        pairs = combinations(range(len(self.names)), 2)
        return {(b, c): self.field.gradient(self.tensor[b][c], self.names) for b, c in pairs}

    def jacobi_defects(self) -> list[Element]:
        """The components of the Schouten bracket in (M, z), exactly."""
        back = inverse(self.turn)

        def slopes(element: Element) -> list[tuple[int, Element]]:
            parts = self.field.gradient(element, self.names)
            turned = [dot(parts, column) for column in zip(*back, strict=True)]
            return [(m, slope) for m, slope in enumerate(turned) if slope]

        return list(schouten_bracket(self.tensor, slopes).values())

    def defect_somewhere(self) -> tuple[Triple, Decision] | None:
        """A triple whose Jacobi defect is not zero at some point; None if none is found."""
        entries = [e for row in (*self.tensor, *self.turn) for e in row]
        plain = all(map(self.field.is_function_free, entries))
        for point in islice(Points(self.field, entries), TRIED):
            with suppress(ZeroDivisionError, ValueError), mpmath.workdps(DIGITS):
                for triple, value in self._defects_at(point, plain).items():
                    if value:
                        text = str(value) if plain else mpmath.nstr(mpmath.mpf(value.mid), 15)
                        where = {name: str(x) for name, x in point.items()}
                        return triple, Decision(
                            verdict=Verdict.PROVED, method=nonzero_at(text, where)
                        )
        return None

    def _defects_at(self, point: Mapping[str, Fraction], plain: bool) -> dict[Triple, Any]:
        """``J_am d_m J_bc + cyclic`` at a point: fractions, or bounds where functions occur.

        Bounds that do not exclude zero count as zero.
        """
        number = Fraction if plain else _bounds
        values = {name: number(x) for name, x in point.items()}

        def at(rows: Iterable[Row]) -> tuple[tuple[Any, ...], ...]:
            return tuple(
                tuple(self.field.evaluate(e, values, number, _bounds_of) for e in row)
                for row in rows
            )

        tensor, back = at(self.tensor), _inverse_of_numbers(at(self.turn))
        slopes = dict(zip(self.entry_slopes, at(self.entry_slopes.values()), strict=True))
        turned = {
            pair: [dot(row, column) for column in zip(*back, strict=True)]
            for pair, row in slopes.items()
        }
        defects = {}
        for a, b, c in combinations(range(len(self.names)), 3):
            addends = [
                sign * x * y
                for first, pair, sign in ((a, (b, c), 1), (b, (a, c), -1), (c, (a, b), 1))
                for x, y in zip(tensor[first], turned[pair], strict=True)
            ]
            total = sum(addends, number(Fraction(0)))
            defects[a, b, c] = total if plain or total > 0 or total < 0 else 0
        return defects

    def label(self, place: int) -> str:
        """``M_Omega1`` of a momentum, ``Gamma1`` of a position."""
        name = self.names[place]
        return f"M_{name}" if name in self.momenta else name


def about_reduced_bracket(motion: ConstrainedRates) -> Iterator[Examined]:
    """The bracket in momenta, which is emitted: it gives the motion and is antisymmetric."""
    first, affine = motion.equations, not motion.distribution.is_linear
    bracket = ReducedBracket(first)
    momenta = ", ".join(map(bracket.label, range(len(bracket.names))))
    relaxation = first.spec.relaxation
    added = "" if relaxation is None else f" and {relaxation.added}"
    added += " and the forces" * first.spec.is_forced + " and the drift along beta" * affine
    energy = " and H = E - <p, beta>" * affine
    yield (
        f"dH/dM = eta and dH/dz = -dl_c/dz, with M = dl_c/deta along the distribution{energy}",
        "bracket",
        bracket.gradient_defects,
    )
    yield (
        f"the motion of ({momenta}) is the bracket with H{added}",
        "bracket",
        lambda: decide_zero(bracket.motion_defects(motion), motion.field, motion.where),
    )
    yield "the bracket is antisymmetric", "bracket", lambda: antisymmetry_defects(bracket.tensor)


#: Velocities without constraints up to which momenta are inverted: with eight that takes minutes.
SOLVED = 6


def about_reduced_jacobi(motion: ConstrainedRates) -> Iterator[Examined]:
    """Whether the bracket in momenta satisfies the Jacobi identity, which is not claimed."""
    coupled = max(map(len, motion.matrices), default=0)
    is_bound = motion.spec.constraints or motion.spec.rolling is not None
    if coupled > SOLVED and not is_bound:
        text = "whether the bracket satisfies the Jacobi identity was not examined"
        reason = f"{coupled} unknowns are solved for together, more than {SOLVED}"
        yield f"{text}: {reason}", "jacobi", lambda: Discovery("no search")
        return
    bracket = ReducedBracket(motion.equations)
    defect = bracket.defect_somewhere()
    if defect is None:
        few = ", as any of 2 variables" if len(bracket.names) == 2 else ""
        decision = _jacobi(bracket)
        if decision.verdict is Verdict.PROVED:
            yield f"the bracket satisfies the Jacobi identity{few}", "jacobi", lambda: decision
        else:
            text = "whether the bracket satisfies the Jacobi identity was not decided"
            yield text, "jacobi", lambda: Discovery(decision.method)
        return
    triple, shown = defect
    a, b, c = map(bracket.label, triple)
    present = [e for row in (*bracket.tensor, *bracket.turn) for e in row]
    where = "on any open set" if is_entire(bracket.field, present) else "near some point"
    where += for_parameters(motion.equations.setting, present)
    yield (
        f"the bracket is not Poisson {where}: {{{a}, {{{b}, {c}}}}} + cyclic is not zero",
        "jacobi",
        lambda: shown,
    )


def _jacobi(bracket: ReducedBracket) -> Decision:
    """The identity as a whole; of two coordinates, or of constants, it says nothing."""
    defects = bracket.jacobi_defects()
    if defects:
        return decide_zero(defects, bracket.field)
    return prove_by_normal_form(bracket.field)


def _inverse_of_numbers(matrix: Sequence[Sequence[Any]]) -> list[list[Any]]:
    """The inverse of a matrix of fractions or of bounds, by elimination.

    Raises:
        ZeroDivisionError: No pivot is certainly not zero.
    """
    size = len(matrix)
    rows = [[*row, *(int(i == j) for j in range(size))] for i, row in enumerate(matrix)]
    for n in range(size):
        place = next((i for i in range(n, size) if rows[i][n] > 0 or rows[i][n] < 0), None)
        if place is None:
            raise ZeroDivisionError("a matrix that may be singular")
        rows[n], rows[place] = rows[place], rows[n]
        share = 1 / rows[n][n]
        rows[n] = [x * share for x in rows[n]]
        for i, row in enumerate(rows):
            if i != n and row[n] != 0:
                rows[i] = [x - row[n] * y for x, y in zip(row, rows[n], strict=True)]
    return [row[size:] for row in rows]


def _bounds(value: Fraction) -> Any:
    """The smallest interval around a number."""
    return INTERVALS.mpf(value.numerator) / value.denominator


def _bounds_of(function: str, *arguments: Any) -> Any:
    """Bounds of a real elementary function.

    Raises:
        ValueError: The argument may be outside the real domain.
    """
    return enclose_function(function, *map(Enclosure, arguments)).bounds
