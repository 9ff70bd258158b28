"""Counts of a certificate against numeric ranks: Casimirs, and integrals up to a degree.

Comes in: a statement of a certificate or of its findings. Goes out: faults in words, or None where
it holds no count. Ranks are those of NumPy's singular values at random points, which bound them
from below with certainty and from above almost surely. Where values leave no gap nothing is said.
"""

from __future__ import annotations

import re
from itertools import combinations_with_replacement
from math import prod

import numpy as np

from tests.adversary.algebras import as_number
from tests.adversary.motion import Constrained
from tests.adversary.reader import UndefinedError, mpf, read

_ALL = re.compile(r"every Casimir is a function of the (one|\d+) known")
_SOME = re.compile(r"(\d+) of (\d+) independent Casimirs are known")
_NONE = re.compile(r"there are no Casimirs but constants")
_SPACE = re.compile(
    r"of degree <= (\d+) in the velocities(?: and <= (\d+) in the positions)?.*"
    r"a space of dimension (\d+) with constants"
)
#: Singular values below the first count as zero, above the second as not.
ZERO, CLEAR = 1e-9, 1e-6


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
    """Faults of a statement that counts; None if it counts nothing."""
    text = " ".join((entry["statement"], entry.get("scope", ""), entry["method"]))
    if _ALL.search(text) or _SOME.search(text) or _NONE.search(text):
        return _casimirs(motion, text, claims, source) if motion.has_bracket else None
    found = _SPACE.search(text)
    if found and isinstance(motion, Constrained):
        return _integrals(motion, text, found, source)
    return None


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


def _integrals(motion, text, found, source):
    """The dimension of the space of integrals: functions that rest, less those that vanish."""
    degrees = int(found[1]), int(found[2] or 0)
    generators = _generators(motion)
    if generators is None:
        return []
    velocities = [v for v in motion.velocities if v not in motion.given]
    parts = [velocities, generators]
    monomials = [
        (*a, *b)
        for da in range(degrees[0] + 1)
        for a in combinations_with_replacement(parts[0], da)
        for db in range(degrees[1] + 1)
        for b in combinations_with_replacement(parts[1], db)
    ]
    defaults = defaults_of(motion)
    if "default" not in text:  # one choice of parameters for the whole count
        drawn = motion.draw(source, 1)
        defaults = {name: abs(drawn[name]) + mpf(1) / 3 for name in defaults}
    values, rates = [], []
    for _ in range(20 * len(monomials)):
        if len(values) == len(monomials) + 6:
            break
        try:
            point = motion.project(
                {**motion.draw(source, mpf(1) / 2), **defaults}, motion.relations, motion.state
            )
            if point is None or not motion.inside(point):
                continue
            pair = _row(motion, point, velocities, generators, monomials)
        except UndefinedError:
            continue
        values.append(pair[0])
        rates.append(pair[1])
    if len(values) < len(monomials) + 6:
        return []
    try:
        dimension = rank_of(values) - rank_of(rates)
    except NoGapError:
        return []
    if dimension != int(found[3]):
        return [f"{text}: singular values give the dimension {dimension}"]
    return []


def _generators(motion):
    """Positions, with sine and cosine in the place of angles; None if other functions occur."""
    texts = [
        motion.table["lagrangian"]["l"],
        *motion.table.get("constraints", {}).values(),
        *motion.table.get("forces", {}).values(),
        *motion.table.get("definitions", {}).values(),
    ]
    trees = [read(side) for text in texts for side in text.split("==")]
    angles, others = set(), set()

    def walk(tree):
        if tree[0] == "call":
            if tree[1] in ("sin", "cos") and tree[2][0] == "name":
                angles.add(tree[2][1])
            elif tree[1] not in ("dot", "vector", "cross", "diag"):
                others.add(tree[1])
        for part in tree[1:]:
            if isinstance(part, tuple):
                walk(part)

    for tree in trees:
        walk(tree)
    if others or motion.having("advected"):
        return None
    angles &= set(motion.positions)
    plain = [name for name in motion.positions if name not in angles]
    return [*plain, *(f"{f}({name})" for name in sorted(angles) for f in ("sin", "cos"))]


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
