"""Deciding that elements are zero: by normal form, and where that cannot tell, by 50 digits.

Comes in: elements that should be zero. Goes out: a verdict, a method, and a counter-example point
for what is not zero. Points are small rationals from a fixed sequence, so that every run gives the
same certificate.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import partial
from itertools import islice
from typing import Any

import mpmath

from coadjoint.exact import Element, Field, element_text
from coadjoint.prove.certificate import Claim, Finding, Verdict
from coadjoint.prove.ideals import Ideal, real_function
from coadjoint.spec import Spec
from coadjoint.spec.positions import KeyPath

DIGITS = 50
#: Points at which a nonzero normal form is tried before it counts as numerically supported.
POINTS = 20
#: Relative size below which a 50-digit value counts as zero; cancellation may cost 20 digits.
NEGLIGIBLE = mpmath.mpf(10) ** -(DIGITS - 20)
#: Size below which a value counts as zero at points of a zero set found by iteration; where the
#: zero set is singular such points have half the digits.
ON_ZERO_SET = mpmath.mpf(10) ** -12
NORMAL_FORM = "normal form in the field of rational functions"
CONSTANTS = "exact arithmetic on the structure constants"
NORMAL_FORM_WITH_FUNCTIONS = "normal form modulo the relations of the elementary functions"


@dataclass(frozen=True)
class Decision:
    """Whether something is zero, and how we know.

    Attributes:
        verdict: Proved, refuted or numerically supported.
        method: How it was decided.
        point: Where it is not zero, exact values by name.
        defect: Its value there.
        accepted: Whether the spec that makes this claim accepts numerical support; None for a
            claim of the engine, which never does.
    """

    verdict: Verdict
    method: str
    point: dict[str, str] = field(default_factory=dict)
    defect: str = ""
    accepted: bool | None = None


@dataclass(frozen=True)
class Discovery:
    """How something was found that nobody claims: a rank, the end of a search, a count.

    Attributes:
        method: How it was found.
        scope: Where it holds; empty for everywhere.
        error: How likely it is wrong, in words; empty where it is exact.
    """

    method: str
    scope: str = ""
    error: str = ""


#: (statement, kind, what must be zero, or a decision already made, or how it was found)
Examined = tuple[str, str, Callable[[], Sequence[Element] | Decision | Discovery]]


def make_entry(
    statement: str, kind: str, found: Decision | Discovery, seconds: float
) -> Claim | Finding:
    """The entry of the certificate for a statement: a claim if it was decided, else a finding."""
    if isinstance(found, Discovery):
        return Finding(statement, kind, found.method, found.scope, found.error, seconds)
    return Claim(
        statement,
        kind,
        found.verdict,
        found.method,
        seconds,
        found.point,
        found.defect,
        found.accepted,
    )


def claimed_by(
    spec: Spec, key: KeyPath, examined: Iterable[Examined], ring: Field
) -> Iterator[Examined]:
    """Statements that a spec makes, for which it may accept numerical support.

    Args:
        spec: The spec.
        key: Where it makes them, such as ``("claims", "conserved", 0)``.
        examined: The statements.
        ring: Where what must be zero lives.
    """
    accepted = key in spec.accepted
    for statement, kind, examine in examined:
        yield statement, kind, partial(_marked, examine, ring, accepted=accepted)


def _marked(
    examine: Callable[[], Sequence[Element] | Decision | Discovery], ring: Field, *, accepted: bool
) -> Decision | Discovery:
    """The decision about a claim of a spec, with the mark whether support is enough."""
    found = examine()
    if isinstance(found, Discovery):
        return found
    decision = found if isinstance(found, Decision) else decide_zero(found, ring)
    return replace(decision, accepted=accepted)


def decide_zero(elements: Sequence[Element], ring: Field, where: Ideal | None = None) -> Decision:
    """Whether every element is zero.

    A normal form of zero is a proof. A nonzero one refutes where no elementary function occurs;
    otherwise 50-digit values at random points refute, or support and say so.

    Args:
        elements: What should be zero.
        ring: Where they live.
        where: Relations on whose zero set alone they should be zero; by default everywhere.
    """
    if where is not None and where.relations:
        return _decide_where(elements, ring, where)
    left = [element for element in map(ring.normal, elements) if element != 0]
    plain = all(ring.function_free(element) for element in elements)
    if not left:
        return Decision(Verdict.PROVED, NORMAL_FORM if plain else NORMAL_FORM_WITH_FUNCTIONS)
    for element in left:
        counterexample = _counterexample(element, ring)
        if counterexample is not None:
            point, value = counterexample
            named = {name: str(value) for name, value in point.items()}
            method = "exact" if ring.function_free(element) else f"{DIGITS}-digit"
            return Decision(Verdict.REFUTED, f"{method} counter-example", named, value)
    assert not plain, "a nonzero rational function is nonzero at almost every point"
    return Decision(Verdict.SUPPORTED, f"{DIGITS}-digit values at {POINTS} random points")


def _decide_where(elements: Sequence[Element], ring: Field, where: Ideal) -> Decision:
    """Whether every element is zero where relations hold."""
    left = [rest for rest in map(where.remainder, elements) if rest != 0]
    if not left:
        return Decision(Verdict.PROVED, f"normal form modulo the ideal of {where.text}")
    if not where.is_solved:
        return _decide_near(left, ring, where)
    found = decide_zero(list(map(where.on_zero_set, elements)), ring)
    point = found.point
    if point:
        shown = {**point, **_solved_values(point, ring, where)}
        point = {name: shown[name] for name in ring.names if name in shown}
    return Decision(found.verdict, f"{found.method}, where {where.text}", point, found.defect)


def _solved_values(point: Mapping[str, str], ring: Field, where: Ideal) -> dict[str, str]:
    """What relations give at a point as text, to 15 digits where functions occur."""
    free = dict.fromkeys(ring.names, Fraction(1)) | {n: Fraction(v) for n, v in point.items()}
    numbers = {name: _number(value) for name, value in free.items()}
    values = {}
    for name, root in where.solved.items():
        with suppress(ZeroDivisionError, ValueError), mpmath.workdps(DIGITS):  # a pole: no value
            if ring.function_free(root):
                values[name] = str(ring.evaluate(root, free, Fraction, _no_call))
            else:
                value = ring.evaluate(root, numbers, _number, real_function)
                values[name] = mpmath.nstr(value, 15)
    return values


def _decide_near(elements: Sequence[Element], ring: Field, where: Ideal) -> Decision:
    """Whether every element is zero at points of a zero set that only numbers find.

    A remainder that is not zero refutes nothing yet: an ideal need not hold all that vanishes on
    its real zero set, as x is not in the ideal of x^2.
    """
    seen = 0
    with mpmath.workdps(DIGITS):
        for point in where.near(islice(random_points(ring.names, ring.positive), POINTS)):
            values = [ring.evaluate(element, point, _number, real_function) for element in elements]
            largest = max(values, key=abs)
            if abs(largest) > ON_ZERO_SET:
                shown = {
                    name: mpmath.nstr(point[name], 15)
                    for name in ring.names
                    if any(name in ring.reach(e) for e in (*elements, *where.relations))
                }
                method = f"{DIGITS}-digit counter-example, where {where.text}"
                return Decision(Verdict.REFUTED, method, shown, mpmath.nstr(largest, 15))
            seen += 1
    if not seen:
        reason = (
            f"nonzero remainder modulo the ideal of {where.text}, no real point of which is known"
        )
        return Decision(Verdict.REFUTED, reason, {}, element_text(ring, elements[0]))
    method = f"{DIGITS}-digit values at {seen} points where {where.text}"
    return Decision(Verdict.SUPPORTED, method)


def random_points(
    names: Sequence[str], positive: Set[str] = frozenset(), seed: int = 1
) -> Iterator[dict[str, Fraction]]:
    """Endless small nonzero rationals, the same in every run, with the assumed signs."""
    source = random.Random(seed)  # noqa: S311 (not for secrets)
    while True:
        sizes = [Fraction(source.randint(1, 9), source.randint(1, 5)) for _ in names]
        signs = [1 if name in positive else source.choice((-1, 1)) for name in names]
        yield {name: s * size for name, s, size in zip(names, signs, sizes, strict=True)}


def _counterexample(element: Element, ring: Field) -> tuple[dict[str, Fraction], str] | None:
    """A point where an element is not zero, and its value there."""
    names = sorted(ring.reach(element), key=ring.names.index)
    seen = 0
    # Poles and arguments outside a function's domain are passed over, so more points are drawn.
    for point in islice(random_points(names, ring.positive), 50 * POINTS):
        try:
            value = _nonzero_value(element, ring, point)
        except (ZeroDivisionError, ValueError):
            continue
        if value:
            return point, value
        seen += 1
        if seen == POINTS and not ring.function_free(element):
            return None
    return None


def _nonzero_value(element: Element, ring: Field, point: dict[str, Fraction]) -> str:
    """The value of an element at a rational point as text; empty if it is zero there."""
    if ring.function_free(element):
        exact = ring.evaluate(element, point, Fraction, _no_call)
        return str(exact) if exact else ""
    with mpmath.workdps(DIGITS):
        numbers = {name: _number(value) for name, value in point.items()}
        value = ring.evaluate(element, numbers, _number, real_function)
        # Its size is that of its largest addend, so that cancellation shows.
        addends = [
            ring.evaluate(part, numbers, _number, real_function) for part in ring.terms(element)
        ]
        negligible = abs(value) <= NEGLIGIBLE * max(map(abs, addends))
        return "" if negligible else mpmath.nstr(value, 15)


def _number(value: Fraction) -> Any:
    return mpmath.mpf(value.numerator) / value.denominator


def _no_call(function: str, argument: Fraction) -> Fraction:
    raise AssertionError(f"{function}({argument}) in a function-free element")
