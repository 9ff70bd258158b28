"""Comparison: a solver that was compiled against its NumPy twin, over a few steps.

Comes in: both. Goes out: whether they went the same way. It is asked once for each object, before
that enters the cache. A comparison of failed steps shows little. So states are near the default
where a domain or constraints require it, and steps are shortened where the twin solves none.
Read next: `coadjoint.solve.solvers`.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.errors import CrossCheckError
from coadjoint.methods import MAPPED
from coadjoint.render.targets.c.loader import ROUNDINGS
from coadjoint.render.targets.modules import KernelModule
from coadjoint.solve.ensemble import Ensemble, Inputs, Status
from coadjoint.solve.family import FamilySystem
from coadjoint.solve.kernels import say_once
from coadjoint.solve.step_records import HEAD, ROOM, Record
from coadjoint.solver_kinds import SOLVER

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.choices import Choice
    from coadjoint.solve.quantities import Quantities
    from coadjoint.solve.solvers import Stepper
    from coadjoint.solve.system import System

#: Members by which a fresh object is compared with its twin: they fill no whole number of vectors.
PROBES: Final = 11
#: The most steps of each.
MOST_STEPS: Final = 4
#: Bounds of random numbers; near a default they are multiplied by this part of its size and added.
DRAWN: Final = (0.5, 2.0)
NEAR: Final = 0.01
#: Factors of the step, tried in turn until the twin solves some steps; all but the first start
#: near the default state.
PARTS: Final = (1.0, 2.0**-6, 2.0**-12)
#: Statuses of members whose steps fail.
FAILED: Final = (Status.NONFINITE, Status.NOT_SOLVED, Status.STEP_UNDERFLOW)


def compare_steps(
    system: System, choice: Choice, target: str, fresh: Stepper, twin: Stepper
) -> None:
    """Compare a fresh object with its NumPy twin by a few steps of a few members.

    Steps that follow tolerances are compared where bits are promised; elsewhere a rounding may
    decide whether a step is accepted, so that steps are fixed. Where nobody records them, C makes
    several fixed steps before it looks at them; this is compared as well. Where the twin
    solves none of the fixed steps, only failures were compared, and a warning says so.

    Raises:
        CrossCheckError: They differ.
        OutputError: The NumPy twin does not run.
    """
    exact = target == "c" and has_same_bits(system, choice.name)
    n = count_rows(system, choice)
    adaptive = exact and choice.name in ("taylor", "dop853")
    kept = ("late", "memory", *["sweeps"] * choice.sweeps_alike)
    runs = [*([(0.0, MOST_STEPS, True)] if adaptive else []), (2.0**-7, MOST_STEPS, True)]
    solved = False
    for asked, most, keeps in [*runs, *([] if choice.name == "taylor" else [(2.0**-9, 9, False)])]:
        room = most * PROBES + ROOM
        for part in PARTS:
            probe = partial(_probe, system, choice, asked * part, most, is_near=part < 1.0)
            expected, other = probe(), Record.make(n, choice.degree, room)
            twin.advance(expected, 0, PROBES, 1000, other if keeps else None)
            if not asked or _has_solved(expected):
                break
        solved |= asked > 0 and _has_solved(expected)
        found, one = probe(), Record.make(n, choice.degree, room)
        while fresh.advance(found, 0, PROBES, 2 if keeps else 6, one if keeps else None):
            pass  # calls that break off now and then, so that this is compared as well
        same = _agree(found, expected, kept, exact=exact)
        if not (same and _agree_steps(one, other, exact=exact)):
            raise CrossCheckError(
                f"a wrong solver was compiled: {choice} of {system.name}, {choice.source.stem}.c, "
                f"for the target {target} differs from its NumPy twin. Set CC to another compiler, "
                "or run `coadjoint crosscheck` to see whether the files are at fault.",
                rung=5,
                system=system.name,
                function=choice.name,
                target=target,
            )
    if not solved:
        say_once(
            f"the compiled {choice} of {system.name} does what its NumPy twin does, but every step "
            "that was compared fails, also short ones near the default state. Give [variables] and "
            "[parameters] defaults from which a motion can be followed."
        )


def move_near(drawn: Array, quantities: Quantities) -> Array:
    """States or parameters ``(n, N)`` near the defaults of quantities, from numbers in `DRAWN`."""
    centers = [np.array(quantity.center) for quantity in quantities.values()]
    sizes = [np.full(len(each), np.abs(each).max() or 1.0) for each in centers]
    center, size = (np.concatenate([*parts, ()])[:, np.newaxis] for parts in (centers, sizes))
    return np.asarray(center + NEAR * size * drawn)


def _has_solved(run: Ensemble) -> bool:
    """Whether at least one member made steps of which none failed."""
    return bool(((run.steps > 0) & ~np.isin(run.status, FAILED)).any())


def has_same_bits(system: System, method: str) -> bool:
    """Whether a method has the same bits in NumPy and exact C: nothing it calls is a library's."""
    if system.elementary:
        return False
    if isinstance(system, FamilySystem):
        return method not in MAPPED or not system.list_called("flow1")
    return method not in MAPPED or bool(KernelModule(system, SOLVER.files[2]).value("EXACT"))


def count_rows(system: System, choice: Choice) -> int:
    """How many components a method integrates."""
    return system.rows(choice.kind.rates[-1]).size


def list_kinks(system: System, choice: Choice) -> tuple[str, ...]:
    """Arguments at whose zeros the rates of a method have kinks; none without files."""
    if isinstance(system, FamilySystem):
        return system.kink_names
    if system.stepwise or not system._solvers.has_files(choice.kind):
        return ()
    module = KernelModule(system, choice.kind.files[2])
    return tuple(module.value("KINKS")) if module.has("KINKS") else ()


def _probe(
    system: System, choice: Choice, size: float, most: int, *, is_near: bool = False
) -> Ensemble:
    """A few members at the start of a few steps, driven by two lines, with four samples.

    All members start near the default where `is_near` says so, and where states are projected onto
    constraints, since the projection may diverge from elsewhere. Where the system has a domain,
    every second member does; the others may leave the domain, which is compared as well.
    """
    rows = count_rows(system, choice)
    source = np.random.default_rng(0)
    samples = np.array([0.0, 2.0**-8, 2.0**-6, 5 * 2.0**-8])

    def draw(*shape: int) -> Array:
        return source.uniform(*DRAWN, shape)

    state, parameters = draw(rows, PROBES), draw(system.PARAMETERS.size, PROBES)
    is_near |= "projection" in system.functions
    if is_near or system.DOMAIN:
        near = slice(None, None, 1 if is_near else 2)
        for array, quantities in ((state, system.STATE), (parameters, system.PARAMETERS)):
            array[: quantities.size, near] = move_near(array[: quantities.size, near], quantities)
    run = Ensemble(
        state=state,
        parameters=parameters,
        inputs=Inputs(
            knots=np.array([0.0, 3 * 2.0**-8]),
            values=draw(system.INPUTS.size, 2),
            slopes=draw(system.INPUTS.size, 2),
        ),
        has_time=bool(system.TIME),
        samples=samples,
        out=np.full((rows, PROBES, samples.size), np.nan),
        rtol=1e-9,
        atol=1e-9,
        size=size,
        max_steps=most,
        seed=1,
        sides=len(list_kinks(system, choice)),
        remembered=choice.count_memory(rows),
        is_implicit=choice.is_implicit,
    )
    run.begin(0.0)
    return run


def _agree(found: Ensemble, expected: Ensemble, kept: Iterable[str], *, exact: bool) -> bool:
    """Whether two ensembles went the same way: to the bit, or but for roundings."""
    counts = ("status", "steps", "rejected", "next", "kinks", "brief")
    if not all(np.array_equal(getattr(found, n), getattr(expected, n)) for n in counts):
        return False
    if found.list_met().shape != expected.list_met().shape:
        return False
    pairs: Any = [(getattr(found, n), getattr(expected, n)) for n in ("state", "time", "step")]
    pairs.append((found.out, expected.out))
    pairs += [(found.list_met(), expected.list_met())]
    if exact:
        for name in kept:
            if getattr(found, name) is not None:
                pairs.append((getattr(found, name), getattr(expected, name)))
        return all(np.array_equal(a, b, equal_nan=True) for a, b in pairs)
    return all(_are_close(a, b) for a, b in pairs)


def _agree_steps(found: Record, expected: Record, *, exact: bool) -> bool:
    """Whether two records have the same steps, whatever the order of the members."""
    if found.count != expected.count:
        return False
    if not found.count:
        return True
    pair = [
        Record(each.rows[np.argsort(each.member, kind="stable")], each.degree, each.count)
        for each in (found, expected)
    ]
    if exact:
        return np.array_equal(pair[0].rows, pair[1].rows, equal_nan=True)
    heads = np.array_equal(pair[0].rows[:, :HEAD], pair[1].rows[:, :HEAD])
    # what each order comes to at the end of its step, against the largest of the component
    ends = [each.path * each.length[:, None, None] ** np.arange(each.degree + 1) for each in pair]
    rows = zip(*(end.transpose(1, 0, 2) for end in ends), strict=True)
    return heads and all(_are_close(a, b) for a, b in rows)


def _are_close(found: Array, expected: Array) -> bool:
    """Whether arrays are equal but for roundings; NaN equals NaN."""
    with np.errstate(all="ignore"):
        size = np.abs(expected[np.isfinite(expected)]).max(initial=0.0)
        close = np.abs(found - expected) <= ROUNDINGS * size
    same = (found == expected) | (np.isnan(found) & np.isnan(expected))
    return bool((close | same).all())
