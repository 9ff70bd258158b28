"""The judge: whether a certificate says what is true of the motion that a spec declares.

Comes in: the text of a spec and the record of its certificate. Goes out: a `Report` with faults in
words, and how many claims there were of each verdict. A claim that is proved or supported must
vanish at every point that the judge finds; a refutation must show a point that lies on the set of
the claim, inside the domain, with the difference that the judge computes there; a support must have
been tried; counts must agree with numeric ranks (`tests.adversary.counts`).
Nothing is shared with the engine. Read next: `tests.adversary.motion`.
"""

from __future__ import annotations

import random
import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import islice

from tests.adversary.counts import judge_count
from tests.adversary.motion import PAIR, Constrained, Motion, Restricted, Values, motion_of
from tests.adversary.reader import CONTEXT, UndefinedError, entries, mpf, number, read, value

#: Points at which a claim that was not refuted is tried.
POINTS = 3
#: How many are drawn at most to find these.
TRIES = 40
#: A difference above this, relative to the size of what is subtracted, refutes a claim.
NOTHING = mpf(10) ** -18
#: The same where a derivative is taken of derivatives.
NOTHING_NESTED = mpf(10) ** -13
#: Digits with which a difference that would refute is computed again, and part of the step.
DIGITS, FINER = 400, mpf(10) ** -4
#: Relative error of a stated difference: points are shown with 15 digits.
STATED = mpf(10) ** -7
VERDICTS = ("proved", "refuted", "numerically supported")
_TRIED = re.compile(r"(\d+)(?: random)? points?")
_MEASURE = re.compile(r"an invariant measure(?:, where its density is finite)?: (\|.*)")
_EXPONENT = re.compile(r"(?:\^\(?([-0-9/]+)\)?)?")
_CHANCE = re.compile(r"\b(?:chance|likely|probab\w+|odds|error)\b")
_OF_A_SEARCH = re.compile(r"\bnot searched for\b|^no \w[\w ]* was found\b")
_NO_MEASURE = re.compile(r"no measure rho .* with (?:a constant rho|a smooth positive density)")
_FLOW = re.compile(r"the flow of (.*) takes motions to motions")
_FOUND = re.compile(
    r"(.*) is (a Casimir|conserved)( at the default parameters| for almost all.*)?$"
)


@dataclass
class Stated:
    """What a statement says.

    Attributes:
        differences: What must vanish at a point.
        where: Texts of what vanishes on the set of the claim.
        defaults: Whether it speaks of the default parameters alone.
        nothing: Differences below this count as rounding.
    """

    differences: Callable
    where: tuple = ()
    defaults: bool = False
    nothing: object = NOTHING


@dataclass
class Report:
    """What the judge found.

    Attributes:
        faults: Sentences about what is wrong; empty if nothing is.
        verdicts: How many claims of the spec got each verdict, and how many counts were tried.
        unjudged: Statements at which the judge found no point.
    """

    faults: list = field(default_factory=list)
    verdicts: Counter = field(default_factory=Counter)
    unjudged: list = field(default_factory=list)


def judge(text, record, seed=0):
    """Judge a certificate.

    Args:
        text: The spec.
        record: ``Certificate.as_record()``.
        seed: Of the points.
    """
    report, motion = Report(), motion_of(text)
    case = _Case(motion, report, random.Random(f"judge {seed} {text}"))
    stated = statements(motion)
    claims = record["claims"]
    seen = Counter(claim["statement"] for claim in claims)
    for statement in stated:
        if not seen[statement] and not _stands_for(statement, seen):
            report.faults.append(f"the claim is missing: {statement}")
    for claim in claims:
        known = stated.get(claim["statement"]) or _engine_claim(motion, claim)
        if claim["verdict"] not in VERDICTS:
            report.faults.append(f"unknown verdict: {claim}")
        if known is not None:
            if claim["statement"] in stated:
                report.verdicts[claim["verdict"]] += 1
            case.judge(known, claim)
        elif _NO_MEASURE.match(claim["statement"]) and claim["verdict"] == "proved":
            case.no_measure(claim)
        elif claim["verdict"] == "refuted" and not case.is_broken(claim):
            report.faults.append(f"a claim of the engine itself is refuted: {claim}")
        elif claim["verdict"] == "numerically supported" and not _points_of(claim):
            report.faults.append(f"supported without a point: {claim}")
    for entry in (*claims, *record.get("findings", ())):
        counted = judge_count(motion, entry, claims, random.Random(f"counts {seed} {text}"))
        if counted is not None and counted[0] == "unjudged":
            report.unjudged.append(entry["statement"])
        elif counted is not None:
            report.verdicts[counted[0]] += 1
            report.faults += counted[1]
    report.faults += [fault for entry in claims for fault in chance_faults(entry)]
    report.faults += [f for entry in record.get("findings", ()) for f in finding_faults(entry)]
    return report


def chance_faults(claim):
    """A claim that is proved rests on no luck, and every claim says how it was decided."""
    if not claim["method"]:
        return [f"no method: {claim}"]
    words = " ".join((claim["statement"], claim["method"], claim.get("error", "")))
    lucky = claim["verdict"] == "proved" and (claim.get("error") or _CHANCE.search(words))
    return [f"proved with luck: {claim}"] if lucky else []


def finding_faults(entry):
    """A finding has a method, and says where it holds or how likely it is wrong.

    What only says that nothing was found, or looked for, holds of the search and not of the motion.
    """
    if not entry["method"]:
        return [f"no method: {entry}"]
    if entry.get("scope") or entry.get("error") or _OF_A_SEARCH.search(entry["statement"]):
        return []
    return [f"a finding without scope and error: {entry}"]


def is_empty(text, statement, seed=0):
    """Whether the judge finds no point either at which a claim of a spec has a value."""
    motion = motion_of(text)
    case = _Case(motion, Report(), random.Random(f"judge {seed} {text}"))
    stated = statements(motion)[statement]
    for point in case.points(stated.where):
        try:
            stated.differences(point)
        except UndefinedError:
            continue
        return False
    return True


def statements(motion):
    """Every claim of a spec by its statement."""
    found, claims = {}, motion.table.get("claims", {})
    for text in map(_text, claims.get("casimirs", ())):
        found[f"{_line(text)} is a Casimir"] = casimir(motion, text)
    for part in claims.get("conserved", ()):
        text = part if isinstance(part, str) else part.get("integral", part.get("claim"))
        where = () if isinstance(part, str) else tuple(part.get("where", ()))
        vanishing = ", ".join(f"{_line(each)} = 0" for each in where)
        statement = f"{_line(text)} is conserved" + (f" where {vanishing}" if where else "")
        found[statement] = conserved(motion, text, where)
    for pair, text in claims.get("brackets", {}).items():
        one, two = PAIR.fullmatch(pair.strip()).groups() if "(" not in pair else _halves(pair)
        statement = f"{{{_line(one)}, {_line(two)}}} = {_line(_text(text))}"
        found[statement] = bracket(motion, one, two, _text(text))
    for name, part in motion.table.get("transformations", {}).items():
        goal = "its reverse" if part.get("reverses_time") else "itself"
        found[f"{name} takes the motion to {goal}"] = transformed(motion, part)
        for observable, text in part.get("exchanges", {}).items():
            statement = f"{name} takes {observable} to {_line(text)}"
            found[statement] = exchanged(motion, part, observable, text)
    return found


def _line(text):
    return " ".join(text.split())


def _text(claim):
    """The text of a claim, which may be a table that accepts numerical support."""
    return claim["claim"] if isinstance(claim, dict) else claim


def _halves(pair):
    """Both sides of ``{f, g}``, where commas may stand inside parentheses."""
    inner, depth = pair.strip()[1:-1], 0
    for place, mark in enumerate(inner):
        depth += (mark in "([") - (mark in ")]")
        if mark == "," and not depth:
            return inner[:place].strip(), inner[place + 1 :].strip()
    raise ValueError(pair)


def _stands_for(statement, seen):
    """The engine claims the energy itself where nothing works on a constrained motion."""
    return statement == "energy is conserved" and seen["the energy is conserved"]


# -- what must vanish -----------------------------------------------------------------------------


def conserved(motion, text, where=()):
    """The rates of what is conserved, and of what defines its set."""
    trees = [*map(read, where), read(text)]

    def differences(point):
        return [x for tree in trees for x in motion.rate(tree, point)]

    return Stated(differences, tuple(where))


def casimir(motion, text):
    """The brackets of the state with a Casimir."""

    def differences(point):
        tensor = motion.tensor(point)
        rows = [dict(zip(motion.state, row, strict=True)) for row in tensor]
        return [x for row in rows for x in motion.along(lambda p: motion.at(text, p), point, row)]

    return Stated(differences)


def bracket(motion, one, two, text):
    """A bracket minus what it is said to be."""

    def differences(point):
        found = motion.bracket(one, two, point)
        return [a - b for a, b in zip(found, motion.at(text, point), strict=True)]

    return Stated(differences)


def _moved(motion, part, point):
    """The point to which a transformation takes a point."""
    values, found = Values(motion, point), dict(point)
    for name, text in part["map"].items():
        parts = entries(value(read(text), values, motion.functions))
        found.update(zip(motion.components.get(name, [name]), parts, strict=True))
    return found


def transformed(motion, part):
    """``D phi X`` minus the motion at ``phi(x)``, or plus it where time runs back."""
    sign = -1 if part.get("reverses_time") else 1

    def differences(point):
        names = motion.state
        moved = lambda p: [_moved(motion, part, p)[n] for n in names]  # noqa: E731
        pushed = motion.along(moved, point, motion.rates(point))
        there = motion.rates(_moved(motion, part, point))
        return [a - sign * there[n] for a, n in zip(pushed, names, strict=True)]

    return Stated(differences)


def exchanged(motion, part, observable, text):
    """An observable at ``phi(x)`` minus what it becomes."""

    def differences(point):
        there = motion.at(observable, _moved(motion, part, point))
        return [a - b for a, b in zip(there, motion.at(text, point), strict=True)]

    return Stated(differences)


def jacobi(motion):
    """``{x, {y, z}} + cyclic`` of all triples of the state."""

    def differences(point):
        names, tensor = motion.state, motion.tensor(point)
        size, flat = len(names), lambda p: [x for row in motion.tensor(p) for x in row]
        rows = [
            motion.along(flat, point, dict(zip(names, tensor[i], strict=True)), motion.outer_step)
            for i in range(size)
        ]
        inner = lambda i, j, k: rows[i][j * size + k]  # {x_i, {x_j, x_k}}  # noqa: E731
        triples = (
            (i, j, k) for i in range(size) for j in range(i + 1, size) for k in range(j + 1, size)
        )
        return [inner(i, j, k) + inner(j, k, i) + inner(k, i, j) for i, j, k in triples]

    return Stated(differences)


def flow(motion, text):
    """``[X_h, X_F]`` with X_F = {x, F}: the flow of F takes motions to motions."""

    def field(point):
        rows = [dict(zip(motion.state, row, strict=True)) for row in motion.tensor(point)]
        return [x for row in rows for x in motion.along(lambda p: motion.at(text, p), point, row)]

    def differences(point):
        rates, names = motion.rates(point), motion.state
        count = len(motion.at(text, point))
        moved = field(point)  # component after component of each row
        carried = motion.along(field, point, rates, motion.outer_step)
        found = []
        for part in range(count):
            along = dict(zip(names, moved[part::count], strict=True))
            motion_rates = lambda p: [motion.rates(p)[n] for n in names]  # noqa: E731
            turned = motion.along(motion_rates, point, along, motion.outer_step)
            found += [a - b for a, b in zip(carried[part::count], turned, strict=True)]
        return found

    return Stated(differences, nothing=NOTHING_NESTED)


def measure(motion, statement):
    """``d ln rho/dt + div X`` of a density that a statement writes out; None if it does not.

    The divergence is that of the independent velocities and the positions; velocities that a
    constraint gives follow from these.
    """
    found = _MEASURE.match(statement)
    if found is None or not isinstance(motion, Constrained):
        return None
    rest, factors = found[1], []
    while rest.startswith("|"):
        base, _, rest = rest[1:].partition("|")
        power = _EXPONENT.match(rest)
        rest = rest[power.end() :].lstrip()
        factors.append((base, number(Fraction(power[1] or 1))))
    try:
        trees = [(read(base), exponent) for base, exponent in factors]
    except ValueError:
        return None
    given = [tree for tree in motion.relations if motion.reach(tree) & set(motion.given)]
    names = [name for name in motion.state if name not in motion.given]

    def rate(point, name):
        moved = motion.project(point, given, motion.given) if given else point
        return [motion.rates(moved)[name]]

    def differences(point):
        growth = sum(
            (x * motion.rate(tree, point)[0] / motion.at(tree, point)[0] for tree, x in trees),
            mpf(0),
        )
        spread = sum(
            (
                motion.along(lambda p, n=n: rate(p, n), point, {n: mpf(1)}, motion.outer_step)[0]
                for n in names
            ),
            mpf(0),
        )
        return [growth + spread]

    return Stated(differences, nothing=NOTHING_NESTED)


def _engine_claim(motion, claim):
    """What the engine claims by itself, as far as the judge can compute it; else None."""
    statement = claim["statement"]
    if statement == "the energy is conserved":
        return conserved(motion, "energy")
    if statement == "the Poisson bracket satisfies the Jacobi identity":
        return jacobi(motion) if motion.has_bracket else None
    if claim["kind"] == "reduction" and isinstance(motion, Restricted):
        return _restricted(motion, statement)
    if claim["kind"] == "measure":
        return measure(motion, statement)
    found = _FLOW.match(statement)
    if found and motion.has_bracket:
        return flow(motion, found[1])
    found = _FOUND.fullmatch(statement)
    if found is None or claim["kind"] not in ("casimir", "integrals", "conserved"):
        return None
    try:
        read(found[1])
    except ValueError:
        return None
    if found[2] == "a Casimir":
        return casimir(motion, found[1])
    stated = conserved(motion, found[1])
    stated.defaults = bool(found[3]) and "default" in found[3]
    return stated


def _restricted(motion, statement):
    """What is claimed of a submanifold."""
    whole, where = motion.whole, tuple(motion.table["reduction"].get("where", ()))
    if statement.startswith("the whole motion keeps"):
        rates = [conserved(whole, text, where).differences for text in where]
        return Stated(lambda point: [x for each in rates for x in each(point)], where)
    if statement.startswith("the motion keeps"):

        def differences(point):
            full = motion.complete(point)
            rates = whole.rates(full)
            moved = motion.along(
                lambda p: [motion.complete(p)[n] for n in motion.flat(motion.section)],
                point,
                {n: rates[n] for n in motion.state},
            )
            return [a - rates[n] for a, n in zip(moved, motion.flat(motion.section), strict=True)]

        return Stated(differences)
    on_section = [x for text in where for x in [read(text)]]
    return Stated(
        lambda point: [x for t in on_section for x in whole.at(t, motion.complete(point))]
    )


# -- verdicts -------------------------------------------------------------------------------------


def _points_of(claim):
    """How many points a method says that it tried."""
    return max((int(n) for n in _TRIED.findall(claim["method"])), default=0)


class _Case:
    """The claims of one spec, with the points at which they are tried."""

    def __init__(self, motion: Motion, report, source):
        self.motion, self.report, self.source = motion, report, source
        self._points = {}

    def points(self, where=()):
        """A few points of a set, drawn once."""
        if where not in self._points:
            drawn = self._set(where).points(self.source, where, TRIES)
            self._points[where] = list(islice(drawn, POINTS + len(where) * 2))
        return self._points[where]

    def _set(self, where):
        """The motion whose state has the points: the whole one for functions that vanish there."""
        motion = self.motion
        return motion.whole if isinstance(motion, Restricted) and where else motion

    def no_measure(self, claim):
        """Judge that no density of the positions is invariant: it is, where div X is zero."""
        stated = measure(self.motion, "an invariant measure: |1|")
        if stated is None or not self.points():
            self.report.unjudged.append(claim["statement"])
        elif not self._is_false(stated):
            self.fault("a constant density is invariant", claim)
        else:
            self.report.verdicts["no measure"] += 1

    def is_broken(self, claim):
        """Whether it is about a symmetry that the spec declares and the motion does not have."""
        maps = self.motion.table.get("symmetries", {})
        return claim["kind"] == "symmetry" and any(
            self._is_false(conserved(self.motion, name)) for name in maps
        )

    def fault(self, words, claim, **more):
        told = ", ".join(f"{name} = {_short(x)}" for name, x in more.items())
        self.report.faults.append(f"{words}: {claim}" + (f" ({told})" if told else ""))

    def judge(self, stated, claim):
        """Judge one claim of which the judge knows what must vanish."""
        if claim["verdict"] == "refuted":
            self.refuted(stated, claim)
            return
        if claim["verdict"] == "numerically supported" and not _points_of(claim):
            self.fault("supported without a point", claim)
        tried = 0
        for point in self.points(stated.where):
            point = self._with_defaults(point) if stated.defaults else point
            try:
                worst = self.worst(stated, point)
            except UndefinedError:
                continue
            tried += 1
            if worst:
                self.fault(f"{claim['verdict']}, but false", claim, difference=worst, **point)
                return
        if not tried:
            self.report.unjudged.append(claim["statement"])

    def _with_defaults(self, point):
        from tests.adversary.counts import defaults_of

        moved = {**point, **defaults_of(self.motion)}
        if not self.motion.relations:
            return moved
        found = self.motion.project(moved, self.motion.relations, self.motion.state)
        if found is None:
            raise UndefinedError("no point at the defaults")
        return found

    def worst(self, stated, point):
        """The largest difference at a point; 0 if all are rounding.

        Rounding depends on the step of the differences and on the digits, a true difference does
        not: at a = 373, sqrt(exp(a) + 1 + 2*exp(a/2)) - exp(a/2) - 1 loses all of 50 digits.
        """
        motion, found = self._set(stated.where), stated.differences(point)
        size = 1 + max(map(abs, point.values()), default=mpf(0))
        place = max(range(len(found)), key=lambda n: abs(found[n]), default=None)
        if place is None or abs(found[place]) <= stated.nothing * size**4:
            return mpf(0)
        motion.with_steps(FINER)
        with CONTEXT.workdps(DIGITS):
            again = stated.differences(point)[place]
        motion.with_steps()
        return found[place] if abs(again - found[place]) <= abs(again) / 1000 else mpf(0)

    def refuted(self, stated, claim):
        """Judge a refutation by its point."""
        shown = claim.get("counterexample", {})
        defect = _plain_number(claim.get("defect", ""))
        if "holds nowhere" in claim["method"]:
            if self.points(stated.where):
                self.fault("the set has points", claim, **self.points(stated.where)[0])
            return
        if defect is None or not defect:
            self.fault("refuted without a difference", claim)
            return
        near, reached = [], 0
        motion = self._set(stated.where)
        for point in motion.fill(shown, self.source, stated.where):
            try:
                found = stated.differences(point)
            except UndefinedError:
                continue
            reached += 1
            near = [x for x in found if abs(x - defect) <= STATED * abs(defect) + mpf(10) ** -13]
            if near or reached == 4:
                break
        if not reached:
            self.fault("refuted at a point outside the set or the domain", claim)
        elif not near:
            self.fault("refuted with another difference", claim, found=max(found, key=abs))
        elif abs(defect) < mpf(10) ** -9 and not self._is_false(stated):
            self.fault("refuted by rounding", claim)

    def _is_false(self, stated):
        for point in self.points(stated.where):
            try:
                if self.worst(stated, point):
                    return True
            except UndefinedError:
                continue
        return False


def _plain_number(text):
    try:
        return number(Fraction(text))
    except (ValueError, ZeroDivisionError):
        return None


def _short(x):
    return str(x)[:24]
