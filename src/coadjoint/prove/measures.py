r"""Invariant measures :math:`\rho(z)\, d\eta\, dz` of motions, or that there is none.

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
A Hamiltonian motion has the divergence of its bracket: zero where pairs are canonical (Liouville),
and on the dual of a unimodular algebra.
Comes in: a motion. Goes out: a claim.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations, islice

from coadjoint.exact import Element, element_text
from coadjoint.exact.ansatz import solve_with_right_side
from coadjoint.exact.dense import determinant
from coadjoint.exact.irreducible import find_factors
from coadjoint.exact.linear import SpanModulo
from coadjoint.exact.ranks import CHANCE
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.completeness import SHOWN, described
from coadjoint.prove.findings import shown
from coadjoint.prove.invariant_factors import LONGEST as COMMON
from coadjoint.prove.invariant_factors import SYMBOLS, TERMS, InvariantFactors
from coadjoint.prove.motion import Motion
from coadjoint.prove.samples import Point, Samples, leading
from coadjoint.prove.zero import Decision, Discovery, Examined, decide_zero

#: Largest denominator of an exponent that is taken for one.
DENOMINATOR = 12
#: Unknowns of one solve; the determinants of larger ones take too long, and no measure is claimed.
SIZE = 6
#: Choices of numbers for the parameters, until all square roots of such exist.
SEEDS = 20
#: Points at which exponents are found.
POINTS = 6

#: Characters of a factor with velocities that a statement shows; a longer one is described.
LONGEST = 240
#: Among what densities are looked for that depend on velocities.
SEARCHED = (
    "products of powers of invariant factors: {}, the common divisor of rates of up to "
    f"{COMMON} terms, and in up to {SYMBOLS} symbols of the state and {TERMS} terms the factors of "
    "rates and of det(eta, d eta/dt, ...)"
)

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
        found = self.motion.divergence
        assert found is not None, self.motion.equations.route
        return found

    @cached_property
    def allowed(self) -> Mapping[str, Element]:
        """The velocities that kept constraints give in terms of the others."""
        field, known = self.field, dict[str, Element]()
        for _, residual in self.motion.kept:
            value = field.substitute(self.motion.closed(residual), known)
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
        found = list[Element]()
        for matrix in self.motion.matrices:
            found += [
                determinant(tuple(row[:size] for row in matrix[:size]))
                for size in range(len(matrix), 0, -1)
            ]
        return found

    def exponents(self, factors: Sequence[Element], points: Sequence[Point]) -> Powers | None:
        """``rho = product of factors ** exponents`` that satisfies the conditions at points."""
        rows = list[list[int]]()
        for point, condition in ((p, c) for p in points for c in self.conditions):
            slopes = [self._along(condition, factor) / factor for factor in factors]
            rows.append([point.value(x) for x in (*slopes, condition.parts[-1])])
        return _powers(factors, rows, points[0].samples.prime)

    def powers_along(self, factors: Sequence[Element], samples: Samples) -> Powers | None:
        """``rho`` as before whose rate is right at points, where factors depend on velocities."""
        slopes = [samples.slopes(factor) for factor in factors]
        rows = list[list[int]]()
        for point in islice(samples.points(), len(factors) + POINTS):
            pairs = zip(factors, slopes, strict=True)
            rates = [
                point.moved(each) * pow(point.value(factor), -1, samples.prime)
                for factor, each in pairs
            ]
            rows.append([*rates, -point.value(self.divergence)])
        return _powers(factors, rows, samples.prime)

    def defect(self, powers: Powers) -> Element:
        """``d ln rho / dt + div X``, zero if the measure is invariant."""
        growth = [self.motion.rate(factor) / factor * x for factor, x in powers]
        return self.field.sum([self.divergence, *growth])


def _powers(factors: Sequence[Element], rows: Sequence[Sequence[int]], prime: int) -> Powers | None:
    """Exponents with ``sum of row[n] exponent_n = row[-1]`` in each row; None if there are none."""
    solution = solve_with_right_side(range(len(factors)), rows, prime)
    numbers = None if solution is None else solution.lift()
    if numbers is None or any(x.denominator > DENOMINATOR for x in numbers.values()):
        return None
    return [(factors[n], x) for n, x in numbers.items()]


def about_measure(motion: Motion) -> Iterator[Examined]:
    """Whether a measure is invariant: first with a density of the positions alone."""
    if not motion.matrices and motion.divergence == 0:  # also of many unknowns
        statement = f"an invariant measure: {_form(motion)}{motion.at_all_times}"
        yield statement, "measure", lambda: [Measure(motion).divergence]
        return
    numbers = _numbers(motion)
    measure, samples = Measure(motion.at(numbers)), Samples(motion, numbers)
    coupled = max(map(len, motion.matrices), default=0)
    obstacle = samples.obstacle
    if motion.divergence is None:
        obstacle = "the rates rest on velocities that the kernel solves for"
    elif coupled > SIZE:
        obstacle = f"{coupled} unknowns are solved for together, more than {SIZE}"
    if obstacle:
        skipped = Discovery("no search")
        yield f"an invariant measure was not looked for: {obstacle}", "measure", lambda: skipped
        return
    points = list(islice(samples.points(), POINTS))
    assert points, "a motion without an obstacle has points"
    refusal = _refusal(motion, measure, samples, points[0])
    if refusal is not None:
        yield refusal
    found = _of_positions(motion, measure, samples, points) if refusal is None else None
    yield found or _of_velocities(motion, measure, samples)


def _refusal(motion: Motion, measure: Measure, samples: Samples, point: Point) -> Examined | None:
    """That there is no density of the positions alone; None where nothing speaks against one."""
    moved = [
        v.name for v in motion.equations.spec.state if set(v.components) & {*measure.positions}
    ]
    density = f"a smooth positive density rho({', '.join(moved)})" if moved else "a constant rho"
    none = (
        f"no measure rho {_form(motion)} with {density} is invariant on any open set of states"
        f"{_where(samples)}{_generic(motion)}"
    )
    if not moved and (value := point.value(measure.divergence)):
        proof = Decision(Verdict.PROVED, f"{value} at a random point modulo {samples.prime}")
        shown_text = shown(motion.field, Measure(motion).divergence)
        return f"{none}: div X{shown_text}", "measure", lambda: proof
    if measure.is_affine and any(point.value(second) for second in measure.curved):
        decision = Decision(Verdict.PROVED, f"its value at a random point modulo {samples.prime}")
        return f"{none}: div X is not affine in {motion.fibre_word}", "measure", lambda: decision
    contradiction = measure.contradiction(point)
    if contradiction is None:
        return None
    found, rank = contradiction
    names = [each.name for each in found if each.name != REST]
    places = [f"along {', '.join(names)}"] * bool(names) + [REST] * (len(names) < len(found))
    text = f"what it asks for {' and '.join(places)} contradicts itself"
    count = f"{rank + 1} conditions" if rank else "1 condition"
    method = f"{count} of rank {rank} at a random point modulo {samples.prime}"
    if _is_certain(motion, measure, samples, found, rank):
        proof = Decision(Verdict.PROVED, method)
        return f"{none}: {text}", "measure", lambda: proof
    guess = Discovery(method, _generic(motion).lstrip(", "), CHANCE)
    return f"{none}: {text}", "measure", lambda: guess


def _is_certain(
    motion: Motion,
    measure: Measure,
    samples: Samples,
    found: Sequence[Condition],
    rank: int,
) -> bool:
    """Whether the fields of contradicting conditions have no larger rank at other points.

    Their rank with the right sides is certain, since it is one more at a point.
    """
    if rank == len(measure.positions) - len(samples.unit):
        return True
    whole = {each.name: each for each in Measure(motion).conditions} if rank == 0 else {}
    last = whole.get(found[-1].name)
    return last is not None and all(map(motion.field.is_zero, last.parts[:-1]))


def _of_positions(
    motion: Motion, measure: Measure, samples: Samples, points: Sequence[Point]
) -> Examined | None:
    """A density of the positions alone, as a formula if there is one.

    None where the conditions do not show that there is one: where they are not all, and where they
    were looked at for one value of the inputs.
    """
    powers = measure.exponents(_factors_of_minors(motion, measure), points)
    found = None if powers is None else _stated(motion, powers)
    if found is not None or not measure.is_affine or motion.setting.driving:
        return found
    search = Discovery(
        f"ranks of brackets at a random point modulo {samples.prime}",
        f"near almost every point{_generic(motion)}",
        CHANCE,
    )
    statement = (
        f"an invariant measure rho {_form(motion)} exists, rho a function of the positions; no "
        "formula was found among products of powers of the minors of the mass matrix and their "
        f"factors, with denominators of exponents up to {DENOMINATOR}"
    )
    return statement, "measure", lambda: search


def _of_velocities(motion: Motion, measure: Measure, samples: Samples) -> Examined:
    """A density that depends on velocities: a product of powers of invariant factors."""
    short, tried = InvariantFactors(measure.motion, measure.allowed), list[Element]()
    if short.short() or short.all():
        whole = InvariantFactors(motion, Measure(motion).allowed)
        others = _factors_of_minors(motion, measure)
        for search in (whole.short, whole.all):
            tried = search()
            powers = measure.powers_along([*others, *tried], samples)
            found = None if powers is None else _stated(motion, powers)
            if found is not None:
                return found
    names = ", ".join(described(motion.field, factor) for factor in tried)
    word = motion.fibre_word
    text = f" that is a product of powers of {names}" if names else f" that depends on {word}"
    ended = Discovery(SEARCHED.format(word), _generic(motion).lstrip(", "))
    return f"no invariant measure was found with a density{text}", "measure", lambda: ended


def _stated(motion: Motion, powers: Powers) -> Examined | None:
    """A measure, on vectors of any length if it can be; None if it is refuted."""
    defect, samples = [Measure(motion).defect(powers)], Samples(motion)
    finite = ", where its density is finite" if any(x < 0 for _, x in powers) else ""
    written = f"{_written(motion, powers)}{_form(motion)}{motion.at_all_times}"
    proof = decide_zero(defect, motion.field, motion.where)
    if proof.verdict is Verdict.PROVED:
        return f"an invariant measure{finite}: {written}", "measure", lambda: proof
    proof = decide_zero(defect, motion.field, samples.where)
    if proof.verdict is Verdict.REFUTED:  # as where exponents depend on parameters
        return None
    statement = f"an invariant measure{_where(samples)}{finite}: {written}"
    if proof.verdict is Verdict.PROVED:
        return statement, "measure", lambda: proof
    seen = Discovery(proof.method, error="numbers at some points, no proof")
    return statement, "measure", lambda: seen


def _generic(motion: Motion) -> str:
    """The scope of what was found at random parameters."""
    almost = ", for almost all parameters" if motion.setting.parameters else ""
    return almost + motion.at_all_times


def _where(samples: Samples) -> str:
    """The lengths of vectors at which conditions are examined."""
    lengths = [f"dot({each.name}, {each.name}) = 1" for each in samples.unit]
    return f" where {', '.join(lengths)}" if lengths else ""


def _numbers(motion: Motion) -> dict[str, Fraction]:
    """Numbers for the parameters, without relations among them; the square roots exist."""
    for seed in range(SEEDS):
        source = random.Random(seed)  # noqa: S311 (not for secrets)
        names = motion.equations.setting.parameters
        numbers = {name: Fraction(source.randint(2, 999), 7) for name in names}
        if not Samples(motion, numbers).obstacle:
            break
    return numbers


def _factors_of_minors(motion: Motion, measure: Measure) -> list[Element]:
    """The factors of the minors of the mass matrix that depend on positions.

    With numbers for the parameters it shows at once whether there are factors; the others are not
    tried, since to find that a polynomial of many symbols is irreducible may take minutes.
    """
    whole, found = Measure(motion), list[Element]()
    for short, minor in reversed(list(zip(measure.minors, whole.minors, strict=True))):
        reducible = len(find_factors(measure.field, short)) > 1
        own = find_factors(measure.field, minor, found) if reducible else [minor]
        (written,) = motion.field.quotients(minor.combined())
        found = [*own, *(divisor for divisor, _ in written.divisors), *found]
    known = list[Element]()
    for element in found:
        factor = -element if leading(element) < 0 else element
        moving = motion.field.reach(motion.field.normal(factor)) & set(measure.positions)
        if moving and factor not in known:
            known.append(factor)
    return known


def _form(motion: Motion) -> str:
    """The volume: ``dOmega dGamma``."""
    kept = f" on {motion.where.text}" if motion.kept else ""
    return " ".join(f"d{each.name}" for each in motion.spec.state) + kept


def _written(motion: Motion, powers: Powers) -> str:
    """A density in front of a volume; a long determinant goes by its name."""
    text, velocities = "", {*motion.fibre}
    for factor, exponent in powers:
        base = _name(motion, factor)
        if not base:
            turning = bool(motion.field.reach(factor) & velocities)
            whole = element_text(motion.field, factor) if turning else ""
            short = turning and len(whole) <= LONGEST
            base = f"|{whole if short else described(motion.field, factor)}|"
        text += base + (f"^({exponent})" if exponent != 1 else "") + " "
    return text


def _name(motion: Motion, factor: Element) -> str:
    """The name of a determinant of the kernel's matrix that has too many terms to be shown."""
    if len(described(motion.field, factor)) <= SHOWN // 2:
        return ""
    for matrix in motion.matrices:
        whole = len(motion.fibre) + len(motion.kept)
        if len(matrix) == whole and determinant(tuple(matrix)) == factor:
            return motion.determinant
    return ""
