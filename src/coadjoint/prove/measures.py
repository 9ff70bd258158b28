r"""Invariant measures :math:`\rho(z)\, d\eta\, dz` of constrained motions, or that there is none.

A density of the positions alone is invariant if :math:`d \ln\rho / dt = -\operatorname{div} X`.
The left side is affine in the velocities, so the right side has to be, and with
:math:`\dot z = V_0 + V_k \eta^k`, :math:`\operatorname{div} X = \theta_0 + \theta_k \eta^k`

.. math:: V_k \ln\rho = -\theta_k .

These conditions have a solution near almost every point if and only if the brackets of the fields
:math:`V_k - \theta_k \partial_u`, u standing for :math:`\ln\rho`, never hold a multiple of
:math:`\partial_u`: their rank is that of the fields :math:`V_k` and their brackets (Frobenius). At
a random point modulo a prime both ranks are exact but for a chance of 1e-17.

With kept constraints :math:`A\eta = b` the field X is that of the equations with multipliers, on
all velocities. It has the residuals as integrals, so its divergence on their zero set is that of
the motion there with the volume :math:`d\eta\, dz / d(A\eta - b)`; velocities outside the set do
not count. In the same way the length of a vector that moves rigidly is an integral.

Closed forms are looked for among products of powers of the minors of the matrix that the kernel
solves with, and of their factors (Chaplygin 1903: the ball; Veselov and Veselova 1986; Fedorov and
Jovanovic 2004; Borisov and Mamaev 2002: bodies of revolution). Kozlov (1987) shows that most
systems with constraints have none.
Comes in: the rates of a constrained motion. Goes out: a claim.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations, islice

from sympy.polys.domains import QQ
from sympy.polys.orderings import lex
from sympy.polys.rings import PolyElement, PolyRing

from coadjoint.algebra.linear import echelon_modulo, rational_vector
from coadjoint.derive.interpret import determinant
from coadjoint.exact import Element, Field
from coadjoint.exact.element import remove_factor
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.completeness import SHOWN, described
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.samples import AtNumbers, Point, Samples, leading
from coadjoint.prove.zero import Decision, Examined, decide_zero

#: Largest denominator of an exponent that is taken for one.
DENOMINATOR = 12
#: Unknowns of one solve; the determinants of larger ones take too long, and no measure is claimed.
SIZE = 6
#: Choices of numbers for the parameters, until all square roots of such exist.
SEEDS = 20
#: Points at which exponents are found.
POINTS = 6

#: Factors of a density with their exponents.
Powers = list[tuple[Element, Fraction]]


@dataclass(frozen=True)
class Condition:
    """``V ln rho = -theta`` along one field.

    Attributes:
        name: The velocity along which it is, or the bracket.
        parts: The components of V, then -theta.
    """

    name: str
    parts: tuple[Element, ...]


class Measure:
    """The conditions on a density of the positions.

    Args:
        motion: The motion; at given parameters all is much shorter.
    """

    def __init__(self, motion: ConstrainedRates) -> None:
        self.motion, self.field = motion, motion.field
        found = motion.distribution
        self.velocities = found.independent
        self.positions = tuple(
            name for name in found.frame.positions if name in motion.equations.setting.state
        )

    @cached_property
    def divergence(self) -> Element:
        """``div X`` in velocities and positions."""
        equations, field = self.motion.equations, self.field
        of_positions = [
            field.derivative(rate, name)
            for name, rate in self.motion.rates.items()
            if name in self.positions
        ]
        parts = list[Element]()
        for solve in equations.exact.solves:
            matrix = [tuple(map(self.motion.closed, row)) for row in solve.matrix]
            whole = determinant(tuple(matrix))
            for place, name in enumerate(solve.names):
                velocity = self._accelerated(name)
                if velocity is None:
                    continue
                slopes = [
                    field.derivative(self.motion.closed(known), velocity) for known in solve.known
                ]
                turned = tuple(
                    (*row[:place], k, *row[place + 1 :])
                    for row, k in zip(matrix, slopes, strict=True)
                )
                parts.append(determinant(turned) / whole)  # Cramer's rule
        return field.sum([*of_positions, *parts])

    def _accelerated(self, name: str) -> str | None:
        """The velocity of which a solved name is the rate; None for a multiplier."""
        rates = self.motion.rates.items()
        return next((v for v, rate in rates if rate == self.field[name]), None)

    @cached_property
    def allowed(self) -> Mapping[str, Element]:
        """The velocities that kept constraints give in terms of the others."""
        kept = [residual for _, residual in self.motion.distribution.kept]
        relations = [self.motion.closed(residual) for residual in kept]
        return Ideal(self.field, relations, "", self.velocities).solved

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
        return [*along, *([Condition("rest", still)] if any(x != 0 for x in still) else [])]

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
        kept, rows, waiting = list[Condition](), list[list[int]](), self.conditions
        while waiting:
            grown = False
            for condition in waiting:
                row = [point.value(part) for part in condition.parts]
                if _rank([*rows, row], point.samples.prime) == len(rows):
                    continue
                rows, kept, grown = [*rows, row], [*kept, condition], True
                rank = _rank([known[:-1] for known in rows], point.samples.prime)
                if rank < len(rows):
                    return kept[-1:] if not any(row[:-1]) else kept, rank
            waiting = [self.bracket(a, b) for a, b in combinations(kept, 2)] if grown else []
        return None

    # -- closed forms ---------------------------------------------------------------------

    @cached_property
    def minors(self) -> list[Element]:
        """Leading minors of the matrices of the solve, for each the large ones first."""
        found = list[Element]()
        for solve in self.motion.equations.exact.solves:
            matrix = [tuple(map(self.motion.closed, row)) for row in solve.matrix]
            found += [
                determinant(tuple(row[:size] for row in matrix[:size]))
                for size in range(len(matrix), 0, -1)
            ]
        return found

    def exponents(self, factors: Sequence[Element], points: Sequence[Point]) -> Powers | None:
        """``rho = product of factors ** exponents`` that satisfies the conditions at points."""
        rows, last = list[dict[int, int]](), len(factors)
        for point, condition in ((p, c) for p in points for c in self.conditions):
            slopes = [self._along(condition, factor) / factor for factor in factors]
            entries = [point.value(x) for x in (*slopes, condition.parts[-1])]
            rows.append({n: x for n, x in enumerate(entries) if x})
        prime = points[0].samples.prime
        solved = echelon_modulo(rows, prime)
        if last in solved:
            return None
        vector = {pivot: row.get(last, 0) for pivot, row in solved.items()}
        numbers = rational_vector(vector, prime)
        if numbers is None or any(x.denominator > DENOMINATOR for x in numbers.values()):
            return None
        return [(factors[n], x) for n, x in sorted(numbers.items()) if x]

    def defect(self, powers: Powers) -> Element:
        """``d ln rho / dt + div X``, zero if the measure is invariant."""
        growth = [self.motion.rate(factor) / factor * x for factor, x in powers]
        return self.field.sum([self.divergence, *growth])


def factors(field: Field, element: Element, known: Sequence[Element] = ()) -> list[Element]:
    """The irreducible factors of the numerator of an element, without numbers and repetition.

    Known ones are divided out first: to find factors of many terms takes far longer.

    >>> field = Field(["x", "y"])
    >>> x, y = field["x"], field["y"]
    >>> factors(field, (x**2 - y**2) ** 3 / x)
    [x - y, x + y]
    >>> factors(field, (x**2 - y**2) ** 3 / x, [x + y, x - 2])
    [x + y, x - y]
    """
    if element == 0:
        return []
    rest, found = _numerator(element), list[Element]()
    for divisor in (p for p in map(_numerator, known) if not p.is_ground):
        count, rest = remove_factor(rest, divisor)
        found += [_polynomial(field, divisor)] * bool(count)
    places = [n for n, e in enumerate(map(max, zip(*rest, strict=True))) if e]
    if not places:
        return found
    # among the symbols that occur: one nesting for each of a hundred others takes very long
    ring = PolyRing([rest.ring.symbols[n] for n in places], QQ, lex)
    whole = ring.from_dict({tuple(e[n] for n in places): x for e, x in rest.items()})
    return [*found, *(_polynomial(field, factor) for factor, _ in whole.factor_list()[1])]


def _polynomial(field: Field, p: PolyElement) -> Element:
    """A polynomial in some symbols of a field, as an element of it."""
    names = [str(symbol) for symbol in p.ring.symbols]
    return field.polynomial(names, {e: Fraction(str(x)) for e, x in p.items()})


def _numerator(element: Element) -> PolyElement:
    """The numerator of a nonzero element."""
    (quotient,) = element.combined().parts
    return quotient.numer


def about_measure(motion: ConstrainedRates) -> Iterator[Examined]:
    """Whether a density of the positions alone is kept."""
    if max(len(solve.block) for solve in motion.equations.exact.solves) > SIZE:
        return
    numbers = _numbers(motion)
    measure, samples = Measure(AtNumbers(motion, numbers)), Samples(motion, numbers)
    if samples.obstacle:
        return
    form, points = _form(motion), list(islice(samples.points(), POINTS))
    if any(points[0].value(second) for second in measure.curved):
        decision = Decision(Verdict.PROVED, f"its value at a random point modulo {samples.prime}")
        yield (
            f"no invariant measure rho {form}: div X is not affine in the velocities",
            "measure",
            lambda: decision,
        )
        return
    contradiction = measure.contradiction(points[0])
    if contradiction is not None:
        yield _none(measure, samples, form, *contradiction)
        return
    powers = _closed_form(motion, measure, points)
    if powers is not None:
        proof = decide_zero([Measure(motion).defect(powers)], motion.field, samples.where)
        if proof.verdict is not Verdict.REFUTED:  # as where exponents depend on parameters
            statement = f"an invariant measure: {_written(motion, powers)}{form}"
            yield statement, "measure", lambda: proof
            return
    ranks = f"ranks of brackets at a random point modulo {samples.prime}"
    yield (
        f"an invariant measure rho {form} exists near almost every point, its density no product "
        "of powers of minors of the mass matrix and their factors",
        "measure",
        lambda: Decision(Verdict.SUPPORTED, ranks),
    )


def _numbers(motion: ConstrainedRates) -> dict[str, Fraction]:
    """Numbers for the parameters, without relations among them; the square roots exist."""
    for seed in range(SEEDS):
        source = random.Random(seed)  # noqa: S311 (not for secrets)
        names = motion.equations.setting.parameters
        numbers = {name: Fraction(source.randint(2, 999), 7) for name in names}
        if not Samples(motion, numbers).obstacle:
            break
    return numbers


def _none(
    measure: Measure, samples: Samples, form: str, found: Sequence[Condition], rank: int
) -> Examined:
    """That conditions contradict each other: certain where their fields can have no larger rank."""
    resting = not any(found[-1].parts[:-1])
    certain = resting or rank == len(measure.positions) - len(samples.unit)
    method = f"{rank + 1} conditions of rank {rank} at a random point modulo {samples.prime}"
    decision = Decision(Verdict.PROVED if certain else Verdict.SUPPORTED, method)
    statement = (
        f"no invariant measure rho {form} for almost all parameters: what it asks for along "
        f"{', '.join(each.name for each in found)} contradicts itself"
    )
    return statement, "measure", lambda: decision


def _closed_form(
    motion: ConstrainedRates, measure: Measure, points: Sequence[Point]
) -> Powers | None:
    """A density in all parameters, from exponents at numbers.

    With numbers for the parameters it shows at once whether there are factors; the others are not
    tried, since to find that a polynomial of many symbols is irreducible may take minutes.
    """
    whole, found = Measure(motion), list[Element]()
    for short, minor in reversed(list(zip(measure.minors, whole.minors, strict=True))):
        reducible = len(factors(measure.field, short)) > 1
        own = factors(measure.field, minor, found) if reducible else [minor]
        (written,) = motion.field.quotients(minor.combined())
        found = [*own, *(divisor for divisor, _ in written.divisors), *found]
    known = list[Element]()
    for element in found:
        factor = -element if leading(element) < 0 else element
        moving = motion.field.reach(motion.field.normal(factor)) & set(measure.positions)
        if moving and factor not in known:
            known.append(factor)
    return measure.exponents(known, points)


def _form(motion: ConstrainedRates) -> str:
    """The volume: ``dOmega dGamma``."""
    spec, found = motion.equations.spec, motion.distribution
    moved = {*found.independent, *found.frame.positions}
    names = [v.name for v in spec.state if set(v.components) <= moved]
    kept = f" on {motion.where.text}" if found.kept else ""
    return " ".join(f"d{name}" for name in names) + kept


def _written(motion: ConstrainedRates, powers: Powers) -> str:
    """A density in front of a volume; a long determinant goes by its name."""
    text = ""
    for factor, exponent in powers:
        base = _name(motion, factor) or f"({described(motion.field, factor)})"
        text += base + (f"^({exponent})" if exponent != 1 else "") + " "
    return text


def _name(motion: ConstrainedRates, factor: Element) -> str:
    """The name of a determinant of the kernel's matrix that has too many terms to be shown."""
    if len(described(motion.field, factor)) <= SHOWN // 2:
        return ""
    kept = motion.distribution.kept
    for solve in motion.equations.exact.solves:
        whole = determinant(tuple(tuple(map(motion.closed, row)) for row in solve.matrix))
        if len(solve.block) == len(motion.distribution.independent) + len(kept) and whole == factor:
            return "det [[B^T M B, A^T], [A, 0]]" if kept else "det(B^T M B)"
    return ""


def _rank(rows: Sequence[Sequence[int]], prime: int) -> int:
    """The rank of lists of residues."""
    return len(echelon_modulo(({n: x for n, x in enumerate(row) if x} for row in rows), prime))
