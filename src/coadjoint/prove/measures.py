r"""Invariant measures :math:`\rho(z)\, d\eta\, dz` of motions, or that there is none.

The conditions on a density are those of `coadjoint.prove.densities`: their ranks show that there is
none, or that there is one near almost every point.

Closed forms are searched for among products of powers of the minors of the matrix that the kernel
solves with, and of their factors (Chaplygin 1903: the ball; Veselov and Veselova 1986; Fedorov and
Jovanovic 2004; Borisov and Mamaev 2002: bodies of revolution). Kozlov (1987) shows that most
systems with constraints have none.
A Hamiltonian motion has the divergence of its bracket: zero where pairs are canonical (Liouville),
and on the dual of a unimodular algebra. Where a bracket is not degenerate, one over its Pfaffian is
the density of Liouville's measure in any coordinates.
Comes in: a motion. Goes out: a claim. Read next: `coadjoint.prove.densities`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import islice

from coadjoint.derive.setting import once
from coadjoint.derive.symbols import choose_names
from coadjoint.exact import BudgetSpent, Element, element_text
from coadjoint.exact.dense import determinant, pfaffian
from coadjoint.exact.irreducible import find_factors
from coadjoint.exact.ranks import CHANCE
from coadjoint.limits import BRACKET_WORK
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.completeness import SHOWN, UNWRITTEN, describe
from coadjoint.prove.densities import (
    DENOMINATOR,
    POINTS,
    REST,
    Condition,
    Measure,
    Powers,
    measure_of,
)
from coadjoint.prove.findings import show_value
from coadjoint.prove.invariant_factors import LONGEST as COMMON
from coadjoint.prove.invariant_factors import SYMBOLS, TERMS, InvariantFactors
from coadjoint.prove.motion import Motion
from coadjoint.prove.samples import Point, Samples, leading, random_numbers, samples_of
from coadjoint.prove.zero import Decision, Discovery, Examined, decide_zero

#: Unknowns of one solve; the determinants of larger ones take too long, and no measure is claimed.
SIZE = 6

#: Characters of a factor with velocities that a statement shows; a longer one is described.
LONGEST = 240
#: Among what densities are searched for that depend on velocities.
SEARCHED = (
    "products of powers of invariant factors: {}, the common divisor of rates of up to "
    f"{COMMON} terms, and in up to {SYMBOLS} symbols of the state and {TERMS} terms the factors of "
    "rates and of det(eta, d eta/dt, ...)"
)


def volume_statement(motion: Motion) -> str:
    """What a certificate says of a motion that keeps volume in the state."""
    return f"an invariant measure: {_form(motion)}{motion.at_all_times}"


def about_measure(motion: Motion) -> Iterator[Examined]:
    """Whether a measure is invariant: first with a density of the positions alone."""
    by_numbers = bool(motion.matrices)  # which is much shorter where accelerations are solved for
    divergence = None if by_numbers else motion.divergence
    if divergence is not None and divergence == 0:
        yield volume_statement(motion), "measure", lambda: [divergence]
        return
    examined = _of_bracket(motion)
    if examined is not None:
        yield examined
        return
    numbers = random_numbers(motion)
    measure, samples = Measure(motion.at(numbers)), Samples(motion, numbers)
    coupled = max(map(len, motion.matrices), default=0)
    obstacle = samples.obstacle
    if divergence is None and not by_numbers:
        obstacle = "the rates rest on velocities that the kernel solves for"
    elif coupled > SIZE:
        obstacle = f"{coupled} unknowns are solved for together, more than {SIZE}"
    if obstacle:
        skipped = Discovery("no search")
        yield f"an invariant measure was not searched for: {obstacle}", "measure", lambda: skipped
        return
    points = list(islice(samples.points(), POINTS))
    assert points, "a motion without an obstacle has points"
    known = _has_density(measure, points)  # brackets of long conditions would take minutes
    refusal, is_decided = None, True
    try:
        with motion.field.budget(BRACKET_WORK):
            refusal = None if known else _refusal(motion, measure, samples, points[0])
    except BudgetSpent:
        is_decided = False
    if refusal is not None:
        yield refusal
    examined = None
    if refusal is None:
        examined = _of_positions(motion, measure, samples, points, is_decided=is_decided)
    yield examined or _of_velocities(motion, measure, samples)


def _of_bracket(motion: Motion) -> Examined | None:
    """Liouville's measure; None where the motion does not keep it, as where forces act."""
    powers = _liouville(motion)
    return _state(motion, powers) if powers else None


@once
def _liouville(motion: Motion) -> Powers:
    """One over the Pfaffian of the bracket; nothing where this is constant, or long."""
    tensor = motion.equations.exact.poisson_tensor
    if tensor is None or motion.equations.distribution is not None or len(tensor) > SIZE:
        return []
    field = motion.field
    root = field.normal(pfaffian(tensor))
    if not set(motion.setting.state) & field.reach(root):
        return []
    root = -root if leading(root) < 0 else root
    (written,) = field.quotients(root)
    density, exponent = (field.normal(1 / root), 1) if written.divisors else (root, -1)
    return [(density, Fraction(exponent))] if len(field.terms(density)) <= TERMS else []


def _has_density(measure: Measure, points: Sequence[Point]) -> bool:
    """Whether a product of powers of whole minors satisfies the conditions at points."""
    field, moved = measure.field, {*measure.positions}
    state = moved.union(measure.velocities)
    minors = [
        m for m in measure.minors if field.reach(m) & moved and field.reach(m) & state <= moved
    ]
    return bool(minors) and measure.exponents(minors, points) is not None


def _refusal(motion: Motion, measure: Measure, samples: Samples, point: Point) -> Examined | None:
    """That there is no density of the positions alone; None where nothing speaks against one."""
    moved = [
        v.name for v in motion.equations.spec.state if set(v.components) & {*measure.positions}
    ]
    density = f"a smooth positive density rho({', '.join(moved)})" if moved else "a constant rho"
    none = (
        f"no measure rho {_form(motion)} with {density} is invariant on any open set of states"
        f"{_where(samples)}{motion.almost_always}"
    )
    if not moved and (value := point.value(measure.divergence)):
        proof = Decision(
            verdict=Verdict.PROVED, method=f"{value} at a random point modulo {samples.prime}"
        )
        shown_text = show_value(motion.field, measure_of(motion).divergence)
        return f"{none}: div X{shown_text}", "measure", lambda: proof
    if measure.is_affine and any(point.value(second) for second in measure.curved):
        decision = Decision(
            verdict=Verdict.PROVED, method=f"its value at a random point modulo {samples.prime}"
        )
        return f"{none}: div X is not affine in {motion.fibre_word}", "measure", lambda: decision
    contradiction = measure.contradiction(point)
    if contradiction is None:
        return None
    conditions, rank = contradiction
    names = [each.name for each in conditions if each.name != REST]
    places = [f"along {', '.join(names)}"] * bool(names) + [REST] * (len(names) < len(conditions))
    text = f"the conditions {' and '.join(places)} have no solution"
    count = f"{rank + 1} conditions" if rank else "1 condition"
    method = f"{count} of rank {rank} at a random point modulo {samples.prime}"
    if _is_certain(motion, measure, samples, conditions, rank):
        proof = Decision(verdict=Verdict.PROVED, method=method)
        return f"{none}: {text}", "measure", lambda: proof
    guess = Discovery(method, motion.almost_always.lstrip(", "), CHANCE)
    return f"{none}: {text}", "measure", lambda: guess


def _is_certain(
    motion: Motion,
    measure: Measure,
    samples: Samples,
    conditions: Sequence[Condition],
    rank: int,
) -> bool:
    """Whether the fields of contradicting conditions have no larger rank at other points.

    Their rank with the right sides is certain, since it is one more at a point.
    """
    if rank == len(measure.positions) - len(samples.unit):
        return True
    whole = {each.name: each for each in measure_of(motion).conditions} if rank == 0 else {}
    last = whole.get(conditions[-1].name)
    return last is not None and all(map(motion.field.is_zero, last.parts[:-1]))


def _of_positions(
    motion: Motion,
    measure: Measure,
    samples: Samples,
    points: Sequence[Point],
    *,
    is_decided: bool,
) -> Examined | None:
    """A density of the positions alone, as a formula if there is one.

    None where the conditions do not show that there is one: where they are not all, and where they
    were looked at for one value of the inputs. Whether there is one is left open if the search for
    a contradiction between them ended early.
    """
    powers = measure.exponents(_factors_of_minors(motion, measure, measure.positions), points)
    examined = None if powers is None else _state(motion, powers)
    if examined is not None or not measure.is_affine or motion.setting.driving:
        return examined
    if not is_decided:
        count = len(measure.conditions)
        method = f"the brackets of {count} conditions on it were not compared further: they take "
        method += f"more than {BRACKET_WORK} operations of exact arithmetic"
        ended = Discovery(method, "no statement")
        statement = (
            f"whether an invariant measure rho {_form(motion)} exists, rho a function of the "
            "positions, is not decided; no formula was found among products of powers of the "
            f"minors of the mass matrix and their factors, with denominators of exponents up to "
            f"{DENOMINATOR}"
        )
        return statement, "measure", lambda: ended
    search = Discovery(
        f"ranks of brackets at a random point modulo {samples.prime}",
        f"near almost every point{motion.almost_always}",
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
    others = _factors_of_minors(motion, measure, (*measure.positions, *measure.velocities))
    turning = any(motion.field.reach(each) & {*motion.fibre} for each in others)
    if turning or short.short() or short.all():
        whole = InvariantFactors(motion, measure_of(motion).allowed)
        for search in (whole.short, whole.all):
            tried = search()
            powers = measure.powers_along([*others, *tried], samples)
            examined = None if powers is None else _state(motion, powers)
            if examined is not None:
                return examined
    names = ", ".join(describe(motion.field, factor) for factor in tried)
    word = motion.fibre_word
    text = f" that is a product of powers of {names}" if names else f" that depends on {word}"
    ended = Discovery(SEARCHED.format(word), motion.almost_always.lstrip(", "))
    return f"no invariant measure was found with a density{text}", "measure", lambda: ended


def _state(motion: Motion, powers: Powers) -> Examined | None:
    """A measure, on vectors of any length if it can be; None if it is refuted."""
    defect, samples = [motion.grow(powers)], samples_of(motion)
    finite = ", where its density is finite" if any(x < 0 for _, x in powers) else ""
    density, told = _write(motion, powers)
    written = f"{density}{_form(motion)}{motion.at_all_times}{told}"
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


def _where(samples: Samples) -> str:
    """The lengths of vectors at which conditions are examined."""
    lengths = [f"dot({each.name}, {each.name}) = 1" for each in samples.unit]
    return f" where {', '.join(lengths)}" if lengths else ""


def _factors_of_minors(motion: Motion, measure: Measure, names: Sequence[str]) -> list[Element]:
    """The factors of the minors of the mass matrix that depend on some of the state alone.

    With numbers for the parameters it shows at once whether there are factors; the others are not
    tried, since to find that a polynomial of many symbols is irreducible may take minutes.
    """
    whole, factors = measure_of(motion), list[Element]()
    for short, minor in reversed(list(zip(measure.minors, whole.minors, strict=True))):
        reducible = len(find_factors(measure.field, short)) > 1
        own = find_factors(measure.field, minor, factors) if reducible else [minor]
        (written,) = motion.field.quotients(minor.combine())
        factors = [*own, *(divisor for divisor, _ in written.divisors), *factors]
    known = list[Element]()
    for element in factors:
        factor = -element if leading(element) < 0 else element
        moving = motion.field.reach(motion.field.normal(factor)) & {*motion.setting.state}
        if moving and moving <= {*names} and factor not in known:
            known.append(factor)
    return known


def _form(motion: Motion) -> str:
    """The volume: ``dOmega dGamma``."""
    kept = f" on {motion.where.text}" if motion.kept else ""
    return " ".join(f"d{each.name}" for each in motion.spec.state) + kept


def _write(motion: Motion, powers: Powers) -> tuple[str, str]:
    """A density in front of a volume, and what its letters are behind it.

    A long determinant goes by its name, another long factor by a letter.
    """
    text, told = "", list[str]()
    letters = choose_names(motion.spec, [f"f{n}" for n in range(1, len(powers) + 1)])
    for factor, exponent in powers:
        turning = bool(motion.field.reach(factor) & {*motion.fibre})
        whole = element_text(motion.field, factor) if turning else ""
        shown = whole if turning and len(whole) <= LONGEST else describe(motion.field, factor)
        long = len(whole) > LONGEST if turning else len(shown) > SHOWN // 2
        name = _name(motion, factor) if long else ""
        if not name and shown.startswith(UNWRITTEN):
            letter = letters[len(told)]
            told.append(f"{letter} is {shown}")
            shown = letter
        base = f"|{name.strip('|') or shown}|" if turning or not name else name
        text += base + (f"^({exponent})" if exponent != 1 else "") + " "
    return text, "; where " * bool(told) + ", and ".join(told)


def _name(motion: Motion, factor: Element) -> str:
    """The name of a long density: Liouville's, or a determinant of the kernel; "" if none."""
    if any(factor == density for density, _ in _liouville(motion)):
        return "|1/Pf {x, x}|"
    for matrix in motion.matrices:
        whole = len(motion.fibre) + len(motion.kept)
        if len(matrix) == whole and determinant(tuple(matrix)) == factor:
            return motion.determinant
    return ""
