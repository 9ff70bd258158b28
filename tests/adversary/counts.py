"""Counts of a certificate against numeric ranks: Casimirs, and integrals up to a degree.

Comes in: a statement of a certificate or of its findings. Goes out: faults in words, or None where
it holds no count. A statement about Casimirs or integrals in words that the judge does not know is
a fault: no count passes unread. Ranks are those of NumPy's singular values at random points, which
bound them from below with certainty and from above almost surely. Where values leave no gap nothing
is said.
"""

from __future__ import annotations

import re
from itertools import combinations_with_replacement
from math import prod

import numpy as np

from tests.adversary.algebras import as_number
from tests.adversary.reader import UndefinedError, mpf, read

_ALL = re.compile(r"every Casimir is a function of the (one|\d+) known")
_SOME = re.compile(r"(\d+) of (\d+) independent Casimirs are known")
_NONE = re.compile(r"there are no Casimirs but constants")
_SPACE = re.compile(
    r"integrals of degree <= (?P<first>\d+) in (?P<velocities>.+?)"
    r"(?: and <= (?P<second>\d+) in (?P<positions>.+?))?(?:, where (?P<where>.+?))?"
    r"(?P<scope>, for almost all parameters|, at the default parameters"
    r"(?: as doubles)?(?: and 1 where there is none)?)?: (?P<text>[^:]*)"
)
#: What is said of a space: its dimension, and where that is a bound, how much of it is certain.
_EXACT = re.compile(r"a space of dimension (\d+) with constants, all polynomials in .+")
_FOUND = re.compile(
    r"a space of dimension (\d+) with constants( at the most)?, (\d+) of it "
    r"(?:polynomials in .+|constants); all are functions of .+"
)
#: What says that nothing was counted, and what a claim about one function says.
_SILENT = re.compile(
    r"(?:integrals|Casimirs): not searched further|"
    r"integrals other than .+ were not searched for: .+"
)
_OF_ONE = re.compile(r".+ is (?:a Casimir|conserved)(?: .*| at the default parameters.*)?")
_SQUARE = re.compile(r"(dot\(\w+, \w+\)) = 1")
#: Monomials of the largest space that is counted: one takes as many points.
LARGEST = 500
#: Singular values below the first count as zero, above the second as not.
ZERO, CLEAR = 1e-9, 1e-6
#: Points beyond as many as there are unknowns.
SPARE = 6


#: Rates beyond this beside others of size 1 leave too few digits for a rank.
LONGEST = 1e12


#: Rates below this, beside others of size 1, are zero but for rounding.
ROUNDED = 1e-14


class NoGapError(ArithmeticError):
    """Singular values do not tell the rank."""


def rank_of(rows):
    """The rank of a matrix with rows of any size."""
    matrix = np.array([[float(x) for x in row] for row in rows], dtype=float)
    if matrix.size == 0:
        return 0
    sizes = np.abs(matrix).max(axis=1, keepdims=True)
    matrix = matrix / np.where(sizes > 0, sizes, 1)
    values = np.linalg.svd(matrix, compute_uv=False)
    if not values[0]:
        return 0
    values = values / values[0]
    if ((values > ZERO) & (values < CLEAR)).any():
        raise NoGapError(f"{values}")
    return int((values >= CLEAR).sum())


def judge_count(motion, entry, claims, source):
    """What is wrong with a statement that counts.

    Returns:
        The kind of the count, ``count`` for Casimirs, ``integrals``, or ``unjudged`` where numbers
        do not tell, and faults; None for other statements.
    """
    if entry["kind"] not in ("casimir", "integrals"):
        return None
    statement = entry["statement"]
    space = _SPACE.fullmatch(statement)
    if space is not None:
        faults = _integrals(motion, statement, space, source)
        return ("unjudged", []) if faults is None else ("integrals", faults)
    if any(pattern.match(statement) for pattern in (_ALL, _SOME, _NONE)):
        text = " ".join((statement, entry.get("scope", ""), entry["method"]))
        return "count", _casimirs(motion, text, claims, source)
    if _SILENT.fullmatch(statement) or _OF_ONE.fullmatch(statement):
        return None
    return "count", [f"the judge does not know this kind of statement: {statement}"]


def _casimirs(motion, text, claims, source):
    """The number of Casimirs is the dimension less the rank of the bracket."""
    names, ranks, gradients = motion.state, [], []
    known = [
        claim["statement"].removesuffix(" is a Casimir")
        for claim in claims
        if claim["statement"].endswith(" is a Casimir") and claim["verdict"] != "refuted"
    ]
    written = [t for t in known if "a function with" not in t]
    for point in motion.points(source, tries=60):
        try:
            ranks.append(rank_of(motion.tensor(point)))
            slopes = [
                [motion.along(lambda p, t=t: motion.at(t, p), point, {n: mpf(1)}) for n in names]
                for t in written
            ]
            rows = [[x[i] for x in each] for each in slopes for i in range(len(each[0]))]
            gradients.append(rank_of(rows))
        except (UndefinedError, NoGapError):
            continue
        if len(ranks) == 3:
            break
    if not ranks or not gradients:
        return []
    expected, independent = len(names) - max(ranks), max(gradients)
    stated = _stated_number(text)
    faults = []
    if stated[1] != expected:
        faults.append(f"{text}: the bracket has rank {max(ranks)} of {len(names)}")
    if len(written) == len(known) and stated[0] != independent:
        faults.append(f"{text}: the gradients of those known have rank {independent}")
    if stated[0] > stated[1]:
        faults.append(f"{text}: more are known than there are")
    return faults


def _stated_number(text):
    """How many are known, and how many there are."""
    if _NONE.search(text):
        return 0, 0
    found = _ALL.search(text)
    if found:
        count = 1 if found[1] == "one" else int(found[1])
        return count, count
    found = _SOME.search(text)
    return int(found[1]), int(found[2])


def defaults_of(motion):
    """The default of every parameter, 1 where there is none."""
    found = {}
    for name, parts in motion.parameters.items():
        part = motion.table["parameters"][name]
        values = as_number(part["default"]) if "default" in part else [mpf(1)]
        values = values * len(parts) if len(values) == 1 else values
        found |= dict(zip(parts, values, strict=True))
    return found


def _stated_space(text):
    """The smallest and the largest dimension that a statement allows; None for unknown words."""
    if text == "none but constants":
        return 1, 1
    exact, found = _EXACT.fullmatch(text), _FOUND.fullmatch(text)
    if exact:
        return int(exact[1]), int(exact[1])
    if found:
        return int(found[3]) if found[2] else int(found[1]), int(found[1])
    return None


def _integrals(motion, statement, space, source):
    """The dimension of the space of integrals: functions that rest, less those that vanish.

    Returns:
        Faults; None where the motion is of another kind, or values do not tell.
    """
    allowed = _stated_space(space["text"])
    if allowed is None:
        return [f"the judge does not know this kind of statement: {statement}"]
    try:
        parts = [_names(motion, space[part]) for part in ("velocities", "positions")]
        sets = _relations(motion, space["where"])
    except ValueError as error:
        return [f"{statement}: {error}"]
    degrees = int(space["first"]), int(space["second"] or 0)
    monomials = [
        (*a, *b)
        for da in range(degrees[0] + 1)
        for a in combinations_with_replacement(parts[0], da)
        for db in range(degrees[1] + 1)
        for b in combinations_with_replacement(parts[1], db)
    ]
    if len(monomials) > LARGEST:
        return None
    at_defaults = "default" in (space["scope"] or "")
    values, rates = _tables(motion, monomials, parts, sets, source, at_defaults)
    if len(values) < len(monomials) + SPARE:
        return None
    if max((abs(x) for row in rates for x in row), default=0) > LONGEST:
        return None
    rates = [[x if abs(x) > ROUNDED else 0.0 for x in row] for row in rates]
    try:
        dimension = rank_of(values) - rank_of(rates)
    except NoGapError:
        return None
    if not allowed[0] <= dimension <= allowed[1]:
        return [f"{statement}: singular values give the dimension {dimension}"]
    return []


def _names(motion, text):
    """What a statement says that monomials are products of: components, and functions of such."""
    found = []
    for name in (text or "").split(", ") if text else ():
        found += motion.components.get(name, [name])
        if not motion.reach(name) <= {*motion.state, *defaults_of(motion)}:
            raise ValueError(f"{name} is no function of the state")
    return found


def _relations(motion, text):
    """What vanishes beside the constraints: squares of lengths less 1; constraints have names."""
    found, rest = [], text or ""
    for square in _SQUARE.findall(rest):
        found.append(read(f"{square} - 1"))
    names = [part for part in _SQUARE.sub("", rest).split(", ") if part]
    known = {f"{name} = 0" for name in motion.table.get("constraints", {})}
    for part in names:
        if part not in known and not re.fullmatch(r"\w+[\d_]* = 0", part):
            raise ValueError(f"{part} is no constraint")
    return found


def _tables(motion, monomials, parts, sets, source, at_defaults):
    """Values of monomials and their rates at points, with one choice of parameters for all."""
    defaults = defaults_of(motion)
    if not at_defaults:
        drawn = motion.draw(source, 1)
        defaults = {name: abs(drawn[name]) + mpf(1) / 3 for name in defaults}
    values, rates = [], []
    for _ in range(4 * len(monomials) + 40):
        if len(values) == len(monomials) + SPARE:
            break
        try:
            point = motion.project(
                {**motion.draw(source, mpf(1) / 2), **defaults},
                [*motion.relations, *sets],
                motion.state,
            )
            if point is None or not motion.inside(point):
                continue
            pair = _row(motion, point, *parts, monomials)
        except UndefinedError:
            continue
        values.append(pair[0])
        rates.append(pair[1])
    return values, rates


def _row(motion, point, velocities, generators, monomials):
    """Values of monomials at a point, and their rates."""
    names = [*velocities, *generators]
    tree = read(f"vector({', '.join(names)})")
    at = dict(zip(names, map(float, motion.at(tree, point)), strict=True))
    moved = dict(zip(names, map(float, motion.rate(tree, point)), strict=True))
    values = [prod(at[n] for n in monomial) for monomial in monomials]
    rates = [
        sum(
            moved[n] * prod(at[m] for k, m in enumerate(monomial) if k != place)
            for place, n in enumerate(monomial)
        )
        for monomial in monomials
    ]
    return values, rates
