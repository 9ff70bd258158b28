"""Deciding that elements are zero: by normal form, and where that cannot tell, at points.

Comes in: elements that should be zero, everywhere or where relations hold. Goes out: a verdict, a
method, and a counterexample point for what is not zero. Points lie in the domain that is declared
and on the zero set of the relations. A value refutes if interval arithmetic keeps it from zero.
Where no point is found, nothing is decided and an error says so. Points are the same in every run,
so that every run gives the same certificate.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import partial
from typing import Any, TypeVar

import mpmath

from coadjoint.errors import ClaimError
from coadjoint.exact import Element, Field, element_text
from coadjoint.exact.text import text_of_jumps
from coadjoint.exact.witness import enclosure
from coadjoint.prove.certificate import Claim, Finding, Shown, Verdict
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.points import (
    DIGITS,
    ON_BRANCH,
    Branch,
    Points,
    Values,
    random_points,
    real,
    real_function,
)
from coadjoint.spec import Spec
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Place

__all__ = ["DIGITS", "Decision", "Discovery", "decide_zero", "random_points", "real_function"]

#: Points at which a nonzero normal form is tried before it counts as numerically supported.
POINTS = 20
#: Relative size below which a 50-digit value counts as zero; cancellation may cost 20 digits.
NEGLIGIBLE = mpmath.mpf(10) ** -(DIGITS - 20)
#: Digits of the coordinates of a point that lies on a zero set up to rounding.
SHOWN_DIGITS = 30
#: Denominators that a method shows, and the length of each.
SHOWN, SHOWN_TEXT = 3, 40
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
        shown: What the defect is of.
        place: Where the spec makes the claim, or what it is about.
    """

    verdict: Verdict
    method: str
    point: dict[str, str] = field(default_factory=dict)
    defect: str = ""
    accepted: bool | None = None
    shown: Shown = Shown.DIFFERENCE
    place: Place | None = None


@dataclass(frozen=True)
class Discovery:
    """How something was found that is not claimed: a rank, the end of a search, a count.

    Attributes:
        method: How it was found.
        scope: Where it holds; empty for everywhere.
        error: How likely it is wrong, in words; empty where it is exact.
    """

    method: str
    scope: str = ""
    error: str = ""


Found = TypeVar("Found")
#: (statement, kind, what must be zero, or a decision already made, or how it was found)
Examined = tuple[str, str, Callable[[], Sequence[Element] | Decision | Discovery]]


def make_entry(
    statement: str, kind: str, result: Decision | Discovery, seconds: float
) -> Claim | Finding:
    """The entry of the certificate for a statement: a claim if it was decided, else a finding."""
    if isinstance(result, Discovery):
        return Finding(
            statement=statement,
            kind=kind,
            method=result.method,
            scope=result.scope,
            error=result.error,
            seconds=seconds,
        )
    return Claim(
        statement=statement,
        kind=kind,
        verdict=result.verdict,
        method=result.method,
        seconds=seconds,
        counterexample=result.point,
        defect=result.defect,
        accepted=result.accepted,
        shown=result.shown,
        place=result.place,
    )


def give(found: Found) -> Found:
    """What is known already."""
    return found


def mark_claimed(
    spec: Spec, key: KeyPath, place: Place, examined: Iterable[Examined], ring: Field
) -> Iterator[Examined]:
    """Statements that a spec makes, for which it may accept numerical support.

    Args:
        spec: The spec.
        key: Where it makes them, such as ``("claims", "conserved", 0)``.
        place: What stands there.
        examined: The statements.
        ring: Where what must be zero lives.
    """
    return _mark(place, examined, ring, accepted=key in spec.accepted)


def mark_place(
    place: Place | None, examined: Iterable[Examined], ring: Field
) -> Iterator[Examined]:
    """Statements of the engine about what a spec declares; the arguments are as before."""
    return _mark(place, examined, ring, accepted=None)


def _mark(
    place: Place | None, examined: Iterable[Examined], ring: Field, *, accepted: bool | None
) -> Iterator[Examined]:
    """Statements with a place, and with the mark whether support is enough."""
    for statement, kind, examine in examined:
        yield statement, kind, partial(_examine_marked, examine, ring, place, accepted=accepted)


def _examine_marked(
    examine: Callable[[], Sequence[Element] | Decision | Discovery],
    ring: Field,
    place: Place | None,
    *,
    accepted: bool | None,
) -> Decision | Discovery:
    """The decision about a claim, or the error that there is none, with the marks."""
    try:
        result = examine()
        if isinstance(result, Discovery):
            return result
        decision = result if isinstance(result, Decision) else decide_zero(result, ring)
    except UndecidedError as error:
        error.place = place
        raise
    return replace(decision, accepted=accepted, place=place)


def decide_zero(
    elements: Sequence[Element],
    ring: Field,
    where: Ideal | None = None,
    defined: Sequence[Element] = (),
) -> Decision:
    """Whether every element is zero, in the region that is assumed of the field.

    A normal form of zero is a proof. Of anything else values at points refute, or support.

    Args:
        elements: What should be zero.
        ring: Where they live.
        where: Relations on whose zero set alone they should be zero; by default everywhere.
        defined: Functions that must have values where something is decided: those whose rates the
            elements are.

    Raises:
        UndecidedError: The elements are not proved to be zero, and no point is found at which they
            have values; or there is no point where the relations hold.
    """
    if where is not None and where.relations:
        return _decide_where(elements, where, defined)
    left = [element for element in map(ring.normal, elements) if element != 0]
    if not left:
        plain = all(map(ring.is_function_free, defined))
        if not plain and next(iter(Points(ring, (), None, defined)), None) is None:
            raise UndecidedError(f"no point is found at which it has a value. {ADVICE}")
        return prove_by_normal_form(ring)
    outcome = _look(left, ring, Branch(), "", defined)
    if isinstance(outcome, Decision):
        return outcome
    return Decision(
        verdict=Verdict.SUPPORTED, method=f"{DIGITS}-digit values at {outcome} random points"
    )


def refute_at_a_point(element: Element, ring: Field, where: Ideal) -> Decision | None:
    """A point where relations hold and an element is not zero; None where none is found.

    No normal form is taken, which may be long.
    """
    for branch in where.branches:
        with suppress(ZeroDivisionError, UndecidedError):
            value = ring.substitute(element, branch.solved)
            outcome = _look([value], ring, branch, where.scope, where.given)
            if isinstance(outcome, Decision):
                return outcome
    return None


class UndecidedError(ClaimError):
    """Nothing is known of a claim: no point is found at which it could fail.

    Attributes:
        place: As of a claim.
    """

    place: Place | None = None


def prove_by_normal_form(ring: Field) -> Decision:
    """That something is zero by its normal form, and in which field.

    What is zero need not show the functions whose relations made it so, as in ``sin(-x) + sin(x)``.
    """
    method = NORMAL_FORM_WITH_FUNCTIONS if ring.has_called else NORMAL_FORM
    return Decision(verdict=Verdict.PROVED, method=f"{method}{text_of_jumps(ring)}")


def _decide_where(
    elements: Sequence[Element], where: Ideal, defined: Sequence[Element]
) -> Decision:
    """Whether every element is zero where relations hold: on each branch of their zero set."""
    if where.contains(where.field.one):
        raise UndecidedError(f"{where.scope} holds nowhere. {ADVICE}")
    for known in where.field.adjoined.values():
        if known.function == "sign" and where.contains(known.argument):
            kink = element_text(where.field, known.argument)
            raise UndecidedError(f"it is asked for on the kink where {kink} is 0. {ADVICE}")
    if all(map(where.contains, elements)):
        return _proof(elements, where, defined, f"modulo the ideal of {where.scope}")
    try:
        return _decide_on_branches(elements, where, defined)
    except OverflowError:  # no room for the functions of what is solved for
        ring = where.field
        left = [element for element in elements if not where.contains(element)]
        whole = Branch(rest=where.relations, regular=where.nonzero)
        named = (*where.given, *defined)
        outcome = _look(left, ring, whole, where.scope, named)
        return outcome if isinstance(outcome, Decision) else _support(outcome, where)


def _support(count: int, where: Ideal) -> Decision:
    method = f"{DIGITS}-digit values at {count} points where {where.scope}"
    return Decision(verdict=Verdict.SUPPORTED, method=method)


def _decide_on_branches(
    elements: Sequence[Element], where: Ideal, defined: Sequence[Element]
) -> Decision:
    """Whether every element is zero on each branch."""
    ring, counts, split = where.field, list[int](), 0
    empty: UndecidedError | None = None  # unless another branch refutes
    for branch in where.branches:
        with suppress(ZeroDivisionError):  # a pole on all of the branch
            named = (*where.given, *defined)
            values = [ring.substitute(each, branch.solved) for each in (*elements, *named)]
            split += 1
            rest = Ideal(ring, branch.rest)
            left = [value for value in values[: len(elements)] if not rest.contains(value)]
            if not left:
                continue
            try:
                outcome = _look(left, ring, branch, where.scope, named)
            except UndecidedError as error:
                empty = error
                continue
            if isinstance(outcome, Decision):
                return outcome
            counts.append(outcome)
    if empty is not None:
        raise empty
    if not where.branches:
        raise UndecidedError(f"{where.scope} holds nowhere. {ADVICE}")
    if not split:
        raise UndecidedError(f"it has no value anywhere where {where.scope}. {ADVICE}")
    if counts:
        return _support(sum(counts), where)
    branches = f"each of {split} branches" if split > 1 else "the solutions"
    return _proof(elements, where, defined, f"on {branches} of {where.scope}")


def _proof(
    elements: Sequence[Element], where: Ideal, defined: Sequence[Element], text: str
) -> Decision:
    """What is proved of elements where relations hold: at one point of theirs at least.

    Raises:
        UndecidedError: No point is found; anything is true of an empty set.
    """
    poles = _poles(elements, where)
    named = [each for each in defined if not _is_polynomial(each, where.field)]
    points = where.points([*named, *poles]) if poles or named else where.some_points
    if not any(_is_regular(poles, *at) for at in points):
        if not where.branches:
            raise UndecidedError(f"{where.scope} holds nowhere. {ADVICE}")
        empty = f"no point is found at which it has a value, where {where.scope}"
        raise UndecidedError(f"{empty}. {ADVICE}")
    method = f"normal form {text}{_but_for(poles, where)}{text_of_jumps(where.field)}"
    return Decision(verdict=Verdict.PROVED, method=method)


def _is_regular(poles: Sequence[Element], points: Points, point: Values) -> bool:
    """Whether no denominator vanishes at a point of a zero set."""
    with mpmath.workdps(DIGITS):
        left = [points.ring.substitute(each, points.branch.solved) for each in poles]
        return all(abs(real(points.value(each, point))) > ON_BRANCH for each in left)


#: What to do about a claim that has no value at any point.
ADVICE = (
    "Expected real points, in [domain] and with the declared signs, at which the claim has a "
    "value. Correct the claim, or give defaults near which there are some."
)


def _is_polynomial(element: Element, ring: Field) -> bool:
    """Whether an element has a value at every point."""
    divided = any(written.divisors for written in ring.quotients(element))
    return ring.is_function_free(element) and not divided


def _poles(elements: Sequence[Element], where: Ideal) -> list[Element]:
    """Denominators in which something moves and which may vanish."""
    ring, poles = where.field, list[Element]()
    for element in elements:
        for written in ring.quotients(ring.normal(element)):
            poles += [divisor for divisor, _ in written.divisors if divisor not in poles]
    return [each for each in poles if where.may_vanish(each)]


def _but_for(poles: Sequence[Element], where: Ideal) -> str:
    """Denominators as what is excluded."""
    texts = [element_text(where.field, each) for each in poles]
    if not texts:
        return ""
    if len(texts) > SHOWN or any(len(text) > SHOWN_TEXT for text in texts):
        return ", wherever no denominator is 0"
    return f", wherever {', '.join(texts)} {'are' if len(texts) > 1 else 'is'} not 0"


def _look(
    elements: Sequence[Element],
    ring: Field,
    branch: Branch,
    scope: str,
    defined: Sequence[Element],
) -> Decision | int:
    """What values say of elements whose normal form is not zero.

    Returns:
        A refutation, or the number of points at which each of them is zero.

    Raises:
        UndecidedError: One of them has no value at any point that is found.
    """
    counts, where = list[int](), f", where {scope}" if scope else ""
    for element in elements:
        seen = 0
        points = Points(ring, [element], branch, defined)
        for point in points:
            with mpmath.workdps(DIGITS):
                value = _value(element, ring, point, branch)
            if value:
                written = (element, *branch.solved.values())
                exact = not branch.rest and all(map(ring.is_function_free, written))
                method = f"{'exact' if exact else f'{DIGITS}-digit'} counterexample{where}"
                shown = show_point(points, point)
                return Decision(verdict=Verdict.REFUTED, method=method, point=shown, defect=value)
            # without functions the element is not zero, and another point shows it
            seen += value is not None and (bool(branch.rest) or not ring.is_function_free(element))
            if seen == POINTS:
                break
        counts.append(seen)
    if not min(counts):
        raise UndecidedError(f"no point is found at which it has a value{where}. {ADVICE}")
    return min(counts)


def _value(element: Element, ring: Field, point: Values, branch: Branch) -> str | None:
    """The value of an element at a point as text; empty for zero, None where nothing is known."""
    try:
        if branch.rest:
            return _near_value(element, ring, point)
        if ring.is_function_free(element):
            exact = ring.evaluate(element, point, Fraction, real_function)
            return str(exact) if exact else ""
        return _certain_value(element, ring, point)
    except (ZeroDivisionError, ValueError, OverflowError):
        return None


def _near_value(element: Element, ring: Field, point: Values) -> str:
    """The value at a point that lies on a zero set up to rounding."""
    value, size = _with_size(element, ring, point)
    return "" if abs(value) <= ON_BRANCH * max(1, size) else mpmath.nstr(value, 15)


def _certain_value(element: Element, ring: Field, point: Values) -> str | None:
    """The value at a rational point: not zero if an interval says so."""
    value, size = _with_size(element, ring, point)
    if abs(value) <= NEGLIGIBLE * size:
        return ""
    return mpmath.nstr(value, 15) if enclosure(ring, element, point).sign else None


@dataclass(frozen=True, slots=True)
class _Sized:
    """A real value, and the size of the largest addend in it, which shows cancellation."""

    value: Any
    size: Any

    def __add__(self, other: _Sized) -> _Sized:
        return _Sized(self.value + other.value, max(self.size, other.size))

    def __mul__(self, other: _Sized) -> _Sized:
        return _Sized(self.value * other.value, self.size * other.size)

    def __truediv__(self, other: _Sized) -> _Sized:
        return _Sized(self.value / other.value, self.size / abs(other.value))

    @staticmethod
    def of(number: Any) -> _Sized:
        exact = real(number)
        return _Sized(exact, abs(exact))

    @staticmethod
    def call(function: str, *arguments: _Sized) -> _Sized:
        return _Sized.of(real_function(function, *(each.value for each in arguments)))


def _with_size(element: Element, ring: Field, point: Values) -> tuple[Any, Any]:
    """The value of an element and the size of its largest addend."""
    numbers = {name: _Sized.of(value) for name, value in point.items()}
    sized = ring.evaluate(element, numbers, _Sized.of, _Sized.call)
    return sized.value, sized.size


def show_point(points: Points, point: Values) -> dict[str, str]:
    """A point as text: the symbols on which values rest, exact where they are."""
    ring, branch = points.ring, points.branch
    reached = frozenset[str]().union(*map(ring.reach, (*points.elements, *branch.rest)))
    for name, root in branch.solved.items():
        reached |= {name, *ring.reach(root)}
    with mpmath.workdps(DIGITS):
        values = points.complete(point)
    return {name: _text(values[name]) for name in ring.names if name in reached}


def _text(value: Any) -> str:
    return str(value) if isinstance(value, Fraction) else str(mpmath.nstr(value, SHOWN_DIGITS))
