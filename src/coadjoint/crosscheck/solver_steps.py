"""Cross-check, steps of solvers: against 60 digits, and NumPy against C.

Comes in: a `Subject`, its recurrences and its solvers, in NumPy and compiled. Goes out: figures, or
a `CrossCheckError` that shows a member and the two values.

    rung 4   one step of each method, and a sample within it, against the step in 60 digits from
             the equations: no error is above depth * 2^-53 * envelope, where the envelope is that
             of the recurrences, or of the method run on the Program, and the depth is the number of
             operations that follow one another in it; and the step that the Taylor method chooses
             is the one in which its last two orders are a 64th of what the tolerances allow
    rung 5   some steps of a dozen members with samples between them: NumPy has the same bits as
             exact C; where functions beyond sqrt are called, single steps are within the same bound

Read next: `coadjoint.crosscheck.solvers`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Final

import numpy as np

from coadjoint.crosscheck.bits import find_differing_bits
from coadjoint.crosscheck.compare import Figures
from coadjoint.crosscheck.oracle import (
    OutsideDomain,
    distance_in_envelopes,
    error_in_envelopes,
)
from coadjoint.crosscheck.points import Batch
from coadjoint.crosscheck.solver_exact import (
    START,
    TOLERANCE,
    ExactStep,
    Solvers,
    find_point,
    find_steps,
)
from coadjoint.crosscheck.solver_objects import COMPILED_MAPS, NEWTON, ORDER, list_choices
from coadjoint.crosscheck.subject import Subject
from coadjoint.errors import CrossCheckError
from coadjoint.solve.domain import explain_bound
from coadjoint.solve.ensemble import Ensemble, Status
from coadjoint.solve.methods.lie_poisson import EXACT, FREE
from coadjoint.solve.step_records import ROOM, Record

#: Members of a run: more than lanes, and no multiple of them.
MEMBERS: Final = 13
#: Members that are compared with 60 digits, and what their rates may take together: so(20) has
#: 20 000 operations, and one member alone.
ORACLE_MEMBERS: Final = 3
ORACLE_OPERATIONS: Final = 20_000
#: Methods of which one member is compared with 60 digits, and few over some steps.
OTHERS: Final = tuple(each for each in NEWTON if each != "midpoint_newton")
FEW: Final = 5
#: How far a run may go that takes one step as long as it likes.
FAR: Final = 2.0**30
#: Steps of a run: more than those before from which a search is continued.
MOST_STEPS: Final = 8
#: How far the chosen step may be from the one that is asked for, in octaves: logarithms are within
#: 0.01, a power within one part in 5000.
OCTAVES: Final = 0.02 / (ORDER - 1) + 3e-4
#: The same where the first order bounds it.
ROUGH: Final = 0.02 + 3e-4
_KEPT: Final = (
    "out",
    "state",
    "time",
    "step",
    "next",
    "steps",
    "rejected",
    "status",
    "late",
    "memory",
    "sweeps",
)
#: What is kept of kinks in addition, where there are some.
_KINKED: Final = ("kinks", "brief")


def choose_size(solvers: Solvers, batch: Batch) -> float:
    """A step of ordinary length: the median of those that the Taylor method chooses.

    Where these end outside of the domain, as of a motion that is a straight line, half the way to
    the first exit.
    """
    ensemble = solvers.begin(batch, np.array([START + FAR]), size=0.0, steps=1)
    solvers.advance["taylor"]["numpy"](ensemble, 1)
    moved = np.isfinite(ensemble.time) & (ensemble.time > START)
    taken = (ensemble.time - START)[moved]
    if moved.any() and (ensemble.status[moved] == Status.DOMAIN).all():
        return 2.0 ** math.floor(math.log2(float(np.min(taken)) / 2))
    return 2.0 ** round(math.log2(float(np.median(taken)))) if taken.size else 0.125


# -- rung 4 ---------------------------------------------------------------------------------------


def check_steps(solvers: Solvers, batch: Batch, size: float) -> dict[str, dict[str, Figures]]:
    """Rung 4: single steps against 60 digits.

    Returns:
        The largest k of each method and target, and the members that were compared.

    Raises:
        CrossCheckError: A step is wrong, or none was compared.
    """
    every, figures = _take_few(solvers, batch), {}
    for method, targets in solvers.advance.items():
        members = range(every.size)
        alone = [every.take(slice(n, n + 1)) for n in members] if method in OTHERS else [every]
        for few in alone:  # the first that stays where its motion is defined
            samples, known = find_steps(solvers, method, few, size)
            length = float(samples[-1] - START)
            found = {
                each: solvers.begin(few, samples, size=length, steps=2, method=method)
                for each in targets
            }
            for target, ensemble in found.items():
                targets[target](ensemble, 1)
            if all(any(_is_whole(each, n) for n in known) for each in found.values()):
                break
        figures[method] = {
            target: _measure(solvers, method, target, ensemble, known)
            for target, ensemble in found.items()
        }
    return figures


#: What is left of a step that does not have the rates at its end, for the next one.
SHORTER = 0.4


def _take_few(solvers: Solvers, batch: Batch) -> Batch:
    """The members that are compared with 60 digits."""
    most = ORACLE_OPERATIONS // solvers.subject.work["rhs"]
    return batch.take(slice(min(ORACLE_MEMBERS, max(1, most))))


def _measure(
    solvers: Solvers, method: str, target: str, ensemble: Ensemble, known: Mapping[int, ExactStep]
) -> Figures:
    """The largest error of a target, which no depth may fall below."""
    worst, out, compared = 0.0, ensemble.out, 0
    assert out is not None
    for member, step in known.items():
        if not _is_whole(ensemble, member):
            continue
        compared += 1
        for row, name in enumerate(solvers.subject.programs["rhs"].state):
            pairs = [(out[row, member, 0], step.within[row])]
            pairs.append((ensemble.state[row, member], step.end[row]))
            for value, bounded in pairs:
                k = error_in_envelopes(float(value), bounded)
                if not k <= step.depth:
                    raise solvers.failure(
                        4,
                        f"a step of {method}, {target}: {name} is {float(value)!r}, exactly "
                        f"{float(bounded.value)!r}; k {k:.3g}, allowed {step.depth}",
                        target=target,
                        output=name,
                        found=float(value),
                        expected=float(bounded.value),
                    )
                worst = max(worst, k)
    if not compared:
        problem = explain_start(solvers.subject)
        if problem:
            raise CrossCheckError(problem, rung=4, system=solvers.subject.system.name)
        raise solvers.failure(4, f"no step of {method} was compared with 60 digits")
    return Figures(worst, 0.0, compared)


def explain_start(subject: Subject) -> str:
    """What is wrong with a declared start outside of the domain; "" where it is inside.

    Far from it random points may be inside, and hardly any step from these is.
    """
    if "domain" not in subject.programs:
        return ""
    system = subject.system
    tables = {"state": system.STATE, "parameters": system.PARAMETERS}
    begin = {
        name: np.concatenate(
            [[], *(q.default or [0.0] * len(q.components) for q in table.values())]
        )
        for name, table in tables.items()
    }
    rows = len(subject.programs["domain"].state)
    driving = {name: np.zeros((count, 1)) for name, count in subject.points.driving.items()}
    start = {name: values[:, np.newaxis] for name, values in begin.items()} | driving
    values = subject.evaluate("domain", Batch({**start, "state": start["state"][:rows]}), "numpy")
    for bound, value in zip(system.DOMAIN, values[:, 0].tolist(), strict=True):
        if not (value > 0 or (value == 0 and not bound.strict)):
            problem, advice = explain_bound(bound)
            return (
                f"rung 4: {system.name}: the declared start is outside of the domain, and no step "
                f"was found that could be compared: {problem}; expected a start inside. "
                f"{advice[0].upper()}{advice[1:]}."
            )
    return ""


def _is_whole(ensemble: Ensemble, member: int) -> bool:
    """Whether a member took its step to the end."""
    ended = ensemble.status[member] in (Status.DOMAIN, Status.STEP_UNDERFLOW, Status.NOT_SOLVED)
    return not (ended or _has_met_kink(ensemble, member))


def _has_met_kink(ensemble: Ensemble, member: int) -> bool:
    """Whether a step of a member ended at a kink."""
    return ensemble.kinks is not None and bool(ensemble.kinks[member])


def check_choice(solvers: Solvers, batch: Batch) -> int:
    """Rung 4: the step that the Taylor method chooses, from the power series of the equations.

    Returns:
        How many steps were compared.

    Raises:
        CrossCheckError: One is another.
    """
    few, compared = _take_few(solvers, batch), 0
    for target, advance in solvers.advance["taylor"].items():
        ensemble = solvers.begin(few, np.array([START + FAR]), size=0.0, steps=1)
        advance(ensemble, 1)
        for member in range(few.size):
            taken = float(ensemble.time[member]) - START
            if not ensemble.steps[member]:  # beyond a branch point: a part of it is tried next
                taken = float(ensemble.step[member]) / SHORTER
            if not taken > 0:
                continue
            is_cut = _has_met_kink(ensemble, member) or ensemble.status[member] == Status.DOMAIN
            try:
                octaves, allowed = _choose(solvers, find_point(solvers, few, member))
            except (OutsideDomain, ArithmeticError, ValueError):
                continue
            if octaves < -20:  # the time, to which the step is added, has too few digits for it
                continue
            compared += 1
            octaves_off = math.log2(taken) - octaves
            if is_cut:  # at a kink or at the end of the domain: it is no longer than that
                octaves_off = max(octaves_off, 0.0)
            if abs(octaves_off) > allowed:
                raise solvers.failure(
                    4,
                    f"the Taylor method, {target}, takes the step {taken!r}; expected "
                    f"{2.0**octaves!r}",
                    target=target,
                    found=taken,
                    expected=2.0**octaves,
                )
    if not compared:
        raise solvers.failure(4, "no step that the Taylor method chooses was compared")
    return compared


def _choose(solvers: Solvers, point: Mapping[str, float]) -> tuple[float, float]:
    """The logarithm to base 2 of the step whose last two orders are a 64th of the tolerance.

    With the factor of A. Jorba and M. Zou, Experimental Mathematics 14 (2005) 99. No step is longer
    than all the time there is, or than one in which the first order is four times the state, where
    rates have branch points.

    Returns:
        The logarithm, and by how much that of a step may differ, since it is taken roughly.
    """
    series = solvers.expand(point)
    norms = [max(abs(float(row[k])) for row in series.values()) for k in range(ORDER + 1)]
    size = TOLERANCE / 64 * max(norms[0], 1.0)
    last = [k for k in (ORDER - 1, ORDER) if norms[k]]
    radius = min(((size / norms[k]) ** (1 / k) for k in last), default=math.inf)
    bounded = norms[1] > 0 and solvers.text.branches
    change = 4 * max(norms[0], 1.0) / norms[1] if bounded else math.inf
    radius *= math.exp(-0.7 / (ORDER - 1))
    return math.log2(min(radius, change, FAR)), OCTAVES if radius < change else ROUGH


# -- rung 5 ---------------------------------------------------------------------------------------


def _list_compiled(solvers: Solvers) -> list[str]:
    """The methods that are compared in C as well."""
    return [name for name, targets in solvers.advance.items() if "c" in targets]


def check_bits(
    solvers: Solvers, batch: Batch, size: float, methods: Iterable[str] | None = None
) -> dict[str, int]:
    """Rung 5: NumPy and exact C take the same steps, bit for bit.

    Returns:
        Numbers that were compared, by method.

    Raises:
        CrossCheckError: Two differ in a bit.
    """
    known = list_choices(solvers.functions)
    choices = {
        name: known[name] for name in (_list_compiled(solvers) if methods is None else methods)
    }
    equal = dict.fromkeys(choices, 0)
    samples = START + size * np.array([0.0, 0.375, 0.5, 1.25, 1.5, 2.1])
    for method, given, fixed, keeps in _runs(batch, size):
        if method not in choices:
            continue
        targets = solvers.advance[method]
        found, rows = {}, len(solvers.subject.programs["rhs"].state)
        for target, most in (("numpy", MOST_STEPS), ("c", 3 if keeps else 5)):
            ensemble = solvers.begin(given, samples, size=fixed, steps=MOST_STEPS, method=method)
            record = Record.make(rows, choices[method].degree, given.size * MOST_STEPS + ROOM)
            for _ in range(2 * MOST_STEPS):
                if not targets[target](ensemble, most, record if keeps else None):
                    break
            kept = (*_KEPT, *(_KINKED if ensemble.sides else ()))
            found[target] = {name: np.asarray(getattr(ensemble, name), float) for name in kept}
            found[target]["met"] = ensemble.list_met()
            order = np.argsort(record.member, kind="stable")
            found[target]["record"] = record.rows[: record.count][order]
        for name, one in found["numpy"].items():
            other = found["c"][name]
            if one.shape != other.shape:
                raise solvers.failure(
                    5, f"{method}: {name} has the shape {one.shape} in NumPy, {other.shape} in C"
                )
            differs = find_differing_bits(one, other)
            if name == "sweeps" and not choices[method].sweeps_alike:
                steps = found["numpy"]["steps"]
                further = (EXACT - FREE - 1) * steps  # from the first that may be the last one on
                differs = (other < one - steps) | (other > one + further)
            different = np.argwhere(differs)
            if len(different):
                place = tuple(different[0].tolist())
                raise solvers.failure(
                    5,
                    f"{method}: {name}{list(place)} is {float(one[place])!r} in NumPy, "
                    f"{float(other[place])!r} in C",
                    found=float(other[place]),
                    expected=float(one[place]),
                )
        equal[method] += int(np.isfinite(found["c"]["out"]).sum())
    for method, count in equal.items():
        if not count:
            raise solvers.failure(5, f"nothing of {method} was compared")
    return equal


def _runs(batch: Batch, size: float) -> Iterator[tuple[str, Batch, float, bool]]:
    """Methods with members and fixed steps, and whether steps are recorded.

    Parameters are those of each member, and shared ones. Where nobody records them, C makes several
    fixed steps before it looks at them.
    """
    for given in (batch, batch.share("parameters")):
        yield "taylor", given, 0.0, True
        yield "dop853", given, 0.0, True
        yield "rk4", given, size * 0.3125, True
        yield "heun", given, size * 0.3125, True
        yield "midpoint", given, size * 0.3125, False
        yield "midpoint", given, size * 0.15, True
        yield "coadjoint_mean", given, size * 0.3125, True
        yield "midpoint_newton", given, size * 0.3125, True
        for method in COMPILED_MAPS:
            yield method, given, size * 0.3125, True
    for method in COMPILED_MAPS:
        yield method, batch, size * 0.15, False
    yield "taylor", batch, size * 0.75, True
    yield "dop853", batch, size * 0.75, True
    yield "rk4", batch, size * 0.15, False
    yield "midpoint", batch, size * 0.03, False
    yield "midpoint_newton", batch, size * 0.15, False
    for method in OTHERS:  # which share their search with the midpoint, and cost more
        yield method, batch.take(slice(FEW)), size * 1.125, True
    yield "dop853", batch, size * 0.15, False


def check_together(
    solvers: Solvers, batch: Batch, size: float, methods: Iterable[str] | None = None
) -> dict[str, int]:
    """Rung 5 with functions beyond sqrt: steps of NumPy and of exact C are within the bound.

    Returns:
        Members that were compared, by method.

    Raises:
        CrossCheckError: Two are further apart.
    """
    every = _take_few(solvers, batch)
    together = dict.fromkeys(_list_compiled(solvers) if methods is None else methods, 0)
    for method in together:
        few = every.take(slice(1)) if method in OTHERS else every
        samples, known = find_steps(solvers, method, few, size)
        found, left = [], np.zeros(few.size, bool)
        for target in ("numpy", "c"):
            length = float(samples[-1] - START)
            ensemble = solvers.begin(few, samples, size=length, steps=2, method=method)
            solvers.advance[method][target](ensemble, 1)
            found.append(ensemble.state)
            left |= np.isin(
                ensemble.status, (Status.DOMAIN, Status.STEP_UNDERFLOW, Status.NOT_SOLVED)
            )
            left |= np.array([_has_met_kink(ensemble, n) for n in range(few.size)])
        for member, step in known.items():
            if left[member]:
                continue
            pairs = np.array(found)[:, :, member].T.tolist()
            for (one, other), bounded in zip(pairs, step.end, strict=True):
                k = distance_in_envelopes(one, other, bounded)
                if not k <= step.depth:
                    raise solvers.failure(
                        5,
                        f"a step of {method}: {one!r} in NumPy, {other!r} in C; k {k:.3g}, "
                        f"allowed {step.depth}",
                        found=other,
                        expected=one,
                    )
            together[method] += 1
    return together
