r"""Conditions on the density :math:`\rho(z)\, d\eta\, dz` of an invariant measure.

A density of the positions alone is invariant if :math:`d \ln\rho / dt = -\operatorname{div} X`.
The left side is affine in the velocities, so the right side has to be, and with
:math:`\dot z = V_0 + V_k \eta^k`, :math:`\operatorname{div} X = \theta_0 + \theta_k \eta^k`

.. math:: V_k \ln\rho = -\theta_k .

These conditions have a solution near almost every point if and only if the brackets of the fields
:math:`V_k - \theta_k \partial_u`, u standing for :math:`\ln\rho`, never hold a multiple of
:math:`\partial_u`: their rank is that of the fields :math:`V_k` and their brackets (Frobenius). At
a random point modulo a prime both ranks are exact but for a probability of 1e-17.

With kept constraints :math:`A\eta = b` the field X is that of the equations with multipliers, on
all velocities. It has the residuals as integrals, so its divergence on their zero set is that of
the motion there with the volume :math:`d\eta\, dz / d(A\eta - b)`; velocities outside the set do
not count. In the same way the length of a vector that moves rigidly is an integral.

Comes in: a motion. Goes out: the conditions along fields, contradictions between them, and
exponents of factors with which a product of powers satisfies them at points.
Read next: `coadjoint.prove.measures`, which states what follows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations, islice
from operator import mul

from coadjoint.derive.setting import once
from coadjoint.exact import Element
from coadjoint.exact.ansatz import solve_with_right_side
from coadjoint.exact.dense import minor
from coadjoint.exact.linear import SpanModulo
from coadjoint.prove.motion import Motion
from coadjoint.prove.samples import Point, Samples

#: Largest denominator of an exponent that is taken for one.
DENOMINATOR = 12
#: Points at which exponents are found.
POINTS = 6
#: Where a condition does not rest on velocities.
REST = "at rest"
#: Factors of a density with their exponents.
Powers = list[tuple[Element, Fraction]]


@dataclass(frozen=True)
class Condition:
    """``V ln rho = -theta`` along one field.

    Attributes:
        name: The velocity along which it is, or the bracket; or that it is at rest.
        parts: The components of V, then -theta.
    """

    name: str
    parts: tuple[Element, ...]


class Measure:
    """The conditions on a density of the positions.

    Args:
        motion: The motion; at given parameters all is much shorter.
    """

    def __init__(self, motion: Motion) -> None:
        self.motion, self.field = motion, motion.field
        self.velocities, self.positions = motion.fibre, motion.positions

    @cached_property
    def divergence(self) -> Element:
        """``div X`` in velocities and positions, which is asked for only where it is known."""
        divergence = self.motion.divergence
        assert divergence is not None, self.motion.equations.route
        return divergence

    @cached_property
    def allowed(self) -> Mapping[str, Element]:
        """The velocities that kept constraints give in terms of the others."""
        field, known = self.field, dict[str, Element]()
        for _, residual in self.motion.kept:
            value = field.substitute(self.motion.close(residual), known)
            slopes = zip(self.velocities, field.gradient(value, self.velocities), strict=True)
            name, slope = next((n, s) for n, s in slopes if not field.is_zero(s))
            root = -field.substitute(value, {name: field.zero}) / slope
            known = {n: field.substitute(v, {name: root}) for n, v in known.items()}
            known[name] = root
        return known

    @cached_property
    def free(self) -> list[str]:
        """The velocities that no kept constraint gives."""
        return [name for name in self.velocities if name not in self.allowed]

    @cached_property
    def conditions(self) -> list[Condition]:
        """One for each free velocity, and one for rest where things move without any."""
        field, rest = self.field, dict.fromkeys(self.free, self.field.zero)
        rates = [self.motion.rates[name] for name in self.positions]
        values = [field.substitute(v, self.allowed) for v in (*rates, -self.divergence)]
        still = tuple(field.substitute(value, rest) for value in values)
        along = [
            Condition(
                name,
                tuple(field.substitute(field.derivative(value, name), rest) for value in values),
            )
            for name in self.free
        ]
        return [*along, *([Condition(REST, still)] if any(x != 0 for x in still) else [])]

    @cached_property
    def is_affine(self) -> bool:
        """Whether positions move by rates that are affine in the velocities.

        With constraints they do; a Hamiltonian that is not quadratic in momenta makes others. The
        conditions above then are some of those that a density must satisfy, and not all.
        """
        field = self.field
        rates = [field.substitute(self.motion.rates[n], self.allowed) for n in self.positions]
        slopes = (s for rate in rates for s in field.gradient(rate, self.free))
        return not any(x for slope in slopes for x in field.gradient(slope, self.free))

    @cached_property
    def curved(self) -> list[Element]:
        """Second derivatives of div X by the velocities: not zero, they exclude a density."""
        field = self.field
        divergence = field.substitute(self.divergence, self.allowed)
        return [
            second
            for v in self.free
            for second in field.gradient(field.derivative(divergence, v), self.free)
            if second != 0
        ]

    def bracket(self, a: Condition, b: Condition) -> Condition:
        """The condition that follows from two."""
        parts = tuple(
            self._along(a, y) - self._along(b, x) for x, y in zip(a.parts, b.parts, strict=True)
        )
        return Condition(f"[{a.name}, {b.name}]", parts)

    def _along(self, condition: Condition, function: Element) -> Element:
        slopes = self.field.gradient(function, self.positions)
        pairs = zip(condition.parts, slopes, strict=False)  # but for ln rho
        return self.field.sum(v * s for v, s in pairs if v and s)

    def contradiction(self, point: Point) -> tuple[list[Condition], int] | None:
        """Conditions that contradict each other at a point, and the rank of their fields.

        None if none do, nor any of their brackets.
        """
        prime, kept, waiting = point.samples.prime, list[Condition](), self.conditions
        fields, whole = SpanModulo(prime), SpanModulo(prime)  # without and with the right sides
        while waiting:
            grown = False
            for condition in waiting:
                row = dict(enumerate(map(point.value, condition.parts)))
                if not whole.add(row):
                    continue
                grown, kept, right = True, [*kept, condition], len(row) - 1
                along = {n: x for n, x in row.items() if x and n < right}
                if not fields.add(along):
                    return (kept, fields.rank) if along else (kept[-1:], 0)
            waiting = [self.bracket(a, b) for a, b in combinations(kept, 2)] if grown else []
        return None

    # -- closed forms ---------------------------------------------------------------------

    @cached_property
    def minors(self) -> list[Element]:
        """Leading minors of the matrices of the solve, for each the large ones first."""
        return [
            minor(matrix, range(size), range(size))
            for matrix in self.motion.matrices
            for size in range(len(matrix), 0, -1)
        ]

    def exponents(self, factors: Sequence[Element], points: Sequence[Point]) -> Powers | None:
        """``rho = product of factors ** exponents`` that satisfies the conditions at points."""
        prime, rows = points[0].samples.prime, list[list[int]]()
        slopes = [self.field.gradient(factor, self.positions) for factor in factors]
        for point in points:
            shares = [pow(point.value(factor), -1, prime) for factor in factors]
            gradients = [tuple(map(point.value, row)) for row in slopes]
            for condition in self.conditions:
                *along, right = map(point.value, condition.parts)
                grown = (sum(map(mul, along, row)) for row in gradients)
                rows.append([*(x * y % prime for x, y in zip(grown, shares, strict=True)), right])
        return _powers(factors, rows, prime)

    def powers_along(self, factors: Sequence[Element], samples: Samples) -> Powers | None:
        """``rho`` as before whose rate is right at points, where factors depend on velocities."""
        slopes = [samples.slopes(factor) for factor in factors]
        rows = list[list[int]]()
        for point in islice(samples.points(), len(factors) + POINTS):
            pairs = zip(factors, slopes, strict=True)
            rates = [
                point.differentiate(each) * pow(point.value(factor), -1, samples.prime)
                for factor, each in pairs
            ]
            rows.append([*rates, -point.value(self.divergence)])
        return _powers(factors, rows, samples.prime)


@once
def measure_of(motion: Motion) -> Measure:
    """The conditions for a motion, made once."""
    return Measure(motion)


def _powers(factors: Sequence[Element], rows: Sequence[Sequence[int]], prime: int) -> Powers | None:
    """Exponents with ``sum of row[n] exponent_n = row[-1]`` in each row; None if there are none."""
    solution = solve_with_right_side(range(len(factors)), rows, prime)
    numbers = None if solution is None else solution.lift()
    if numbers is None or any(x.denominator > DENOMINATOR for x in numbers.values()):
        return None
    return [(factors[n], x) for n, x in numbers.items()]
