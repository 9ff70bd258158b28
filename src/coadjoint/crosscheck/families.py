"""Cross-check, families: the ladder of a system of equal members.

Comes in: the Equations of windows, the Family read off from them, its `Loops`, texts and the loaded
system. Goes out: a `Report`, or a `CrossCheckError`.

    rung 3   each part of each text reads back as it was lowered, places of names among it, and the
             rest is what the templates print
    rung 4   every target, for the numbers of members of both windows, against their Equations to 50
             digits: these were written out member by member, and know nothing of loops; sums of
             many members, taken in blocks, against a plain loop over all pairs
    rung 5   NumPy equals every exact target bit for bit, for several numbers of members; steps in C
             are those of their twins

Read next: `coadjoint.crosscheck.family_windows`, then `coadjoint.crosscheck.ladder`.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.crosscheck.bits import find_differing_bits
from coadjoint.crosscheck.compare import Figures
from coadjoint.crosscheck.family_loops import evaluate_loops
from coadjoint.crosscheck.family_series import ORDER, check_series
from coadjoint.crosscheck.family_sums import MEMBERS, check_blocks
from coadjoint.crosscheck.family_text import check_family_text
from coadjoint.crosscheck.family_windows import Point, Window
from coadjoint.crosscheck.ladder import NO_COMPILER, Report, available_targets
from coadjoint.crosscheck.oracle import (
    errors,
)
from coadjoint.crosscheck.solver_objects import NOISY
from coadjoint.crosscheck.subject import K_ARITHMETIC, K_ELEMENTARY, depth
from coadjoint.derive.splittings import Splitting
from coadjoint.errors import CrossCheckError
from coadjoint.families import Family
from coadjoint.lower.loops import Loops
from coadjoint.render.families import FamilyContext, render_family
from coadjoint.render.kernels import elementary_functions
from coadjoint.render.targets import BUILDS
from coadjoint.render.targets.c.loader import ROUNDINGS
from coadjoint.solve.choices import Choice
from coadjoint.solve.family_steps import compare, load

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.derive import Equations
    from coadjoint.spec.model import Windows

    Array = NDArray[np.float64]

#: Points of each window, for each function and target; half of them have parameters of their own.
POINTS: Final = 24
#: Members whose bits are compared, beyond the fewest and one more: fewer and more than vectors
#: have, and no multiple of them; and more than pairs need to be taken in blocks.
SIZES: Final = (7, 17, MEMBERS, 64)
#: The most rows of matrices whose bits are compared: products take the cube of their number.
LARGEST_MATRIX: Final = 17
#: Methods whose steps are compared with those of their twins.
METHODS: Final = (
    Choice(name="rk4", order=4),
    Choice(name="dop853", order=8),
    Choice(name="taylor", order=ORDER),
)
#: Trajectories of a batch whose bits are compared.
BATCHES: Final = ((), (9,))


@dataclass(frozen=True)
class RenderedFamily:
    """What the functions of a system of equal members, or of fields, were made from.

    Attributes:
        windows: Equations of two small numbers of members, which kernels are compared with.
        declared: What the spec says of the other members.
        family: Equations of the generic member.
        context: What the generated files say.
        splittings: The windows in the parts whose flows the family has.
    """

    windows: tuple[Equations, ...]
    declared: Windows
    family: Family
    context: FamilyContext
    splittings: tuple[Splitting, ...] = ()

    @property
    def printed(self) -> dict[str, str]:
        """What the templates print, once more."""
        return render_family(self.context)


def crosscheck_family(
    own: RenderedFamily,
    texts: Mapping[str, str],
    system: Any,
    targets: Sequence[str] | None = None,
    printed: Mapping[str, str] | None = None,
) -> Report:
    """Run rungs 3, 4 and 5.

    Args:
        own: What they were made from.
        texts: The files by name.
        system: The loaded system.
        targets: What to compare; by default all, or those that need no compiler without one.
        printed: What the templates print, if that was made before.

    Raises:
        CompilerError: The compiler does not work, or fails on this kernel.
        CrossCheckError: A rung failed.
    """
    chosen = available_targets() if targets is None else tuple(targets)
    family, context = own.family, own.context
    loops, steps = context.loops, context.torus is None  # of a plane Python leads the steps
    system = system.points
    lines = check_family_text(context, texts, own.printed if printed is None else printed)
    for target, source in system.load_kernels(chosen).items():
        if source != hashlib.sha256(texts[BUILDS[target].kernel].encode()).hexdigest():
            raise CrossCheckError.on(
                3, system.name, f"the target {target} was not loaded from this text"
            )
    figures: dict[str, dict[str, Figures]] = {name: {} for name in loops}
    for equations, splitting in zip_longest(own.windows, own.splittings):
        window = Window.of(equations, own.declared, family, splitting)
        for name, each in loops.items():
            _check_window(window, each, system, chosen, figures[name])
        sized = _resize(system, window.size)
        names = (window.state, window.parameters, window.inputs, window.time)
        made = {"c", "numpy"} & set(chosen)
        if made and steps and loops["rhs"].has_series:
            counted = dict.fromkeys(window.count, float(window.size))
            check_series(window.reference, names, sized, sorted(made), counted)
    for each in loops.values():
        if each.partners is not None and "numpy" in chosen:
            check_blocks(system, each)
    equal, together = dict[str, dict[str, int]](), dict[str, dict[str, int]]()
    for name, each in loops.items():
        counts = _compare_targets(system, name, family.small, chosen, calls=_calls(each))
        exact = set() if _calls(each) else {t for t in counts if t in BUILDS[t].exact}
        equal[name] = {target: count for target, count in counts.items() if target in exact}
        together[name] = {target: count for target, count in counts.items() if target not in exact}
    for target in (each for each in chosen if steps and BUILDS[each].needs_compiler):
        for choice in (
            *(each for each in METHODS if each.name != "taylor" or loops["rhs"].has_series),
            *_list_structured(system),
            *(NOISY[name] for name in ("heun", "midpoint") if family.noise),
        ):
            compare(system, choice, target, load(system, choice, target).library)
    rungs = {3: "passed", 4: "passed", 5: "passed"}
    if not set(BUILDS) <= set(chosen):
        rungs[4] = rungs[5] = f"{', '.join(chosen)}; the others {NO_COMPILER}"
    return Report(
        system=system.name,
        rungs=rungs,
        threshold=max(_threshold(each, family.small) for each in loops.values()),
        lines=lines,
        figures=figures,
        equal=equal,
        together=together,
        solvers={},
    )


def _resize(system: Any, members: int) -> Any:
    """The system with so many members."""
    return system.resize({system.index.name: system.index.find_size(members)})


def _list_structured(system: Any) -> list[Choice]:
    """Methods of order 2 that keep structure; the others share their texts with these.

    A fresh object of any of them is compared with its twin before it is used.
    """
    own = {each.name: Choice(name=each.name, order=2) for each in system.METHODS if each.order == 2}
    if "spherical_midpoint" in own:
        own.pop("midpoint")
    if "discrete_gradient" in own:
        own.pop("average_gradient")
    return list(own.values())


def _calls(loops: Loops) -> bool:
    """Whether a function calls functions beyond sqrt."""
    return bool(elementary_functions(part.program for part in loops.parts))


def _threshold(loops: Loops, size: int) -> float:
    """The largest k allowed: operations in a row, one addition for each member among them."""
    allowed = K_ELEMENTARY if _calls(loops) else K_ARITHMETIC
    return max(allowed, float(sum(depth(part.program) for part in loops.parts) + size))


def _points(source: Any, rows: int, count: int) -> Iterator[Array]:
    """Points of ordinary sizes, some of them with numbers of very different sizes."""
    for n in range(count):
        point = source.normal(size=rows)
        yield point * 2.0 ** source.integers(-8, 9, rows) if n % 3 == 2 else point


def _check_window(
    window: Window,
    loops: Loops,
    system: Any,
    targets: Sequence[str],
    figures: dict[str, Figures],
) -> None:
    """A function of all targets for the members of a window, against 50 digits."""
    name = loops.name
    sized = _resize(system, window.size)
    source = np.random.default_rng(window.size)
    rows = loops.blocks * window.size + loops.rows
    largest = _threshold(loops, window.size)
    states = list(_points(source, rows, POINTS))
    parameters = source.uniform(0.5, 2.0, (POINTS, len(window.parameters)))
    times = source.normal(size=POINTS).tolist()
    inputs = source.normal(size=(POINTS, len(window.inputs)))
    if name == "sided_rhs":  # the rates are known for the signs that are those of the state
        for n, state in enumerate(states):
            own = state[: len(window.state)]
            now = times[n] if window.time else None
            given = own, parameters[n], inputs[n] if window.inputs else None
            state[len(own) :] = np.sign(
                sized.evaluate("kinks", *given, time=now, target=targets[0])
            )
    points = [Point(*each) for each in zip(states, parameters, inputs, times, strict=True)]
    known = _evaluate(window, loops, points)
    if not known:
        raise CrossCheckError.on(4, system.name, f"no point of {name} has a value")
    for target in targets:
        k = ulp = 0.0
        for n, expected in known.items():
            given = states[n], parameters[n], inputs[n] if window.inputs else None
            now = times[n] if window.time else None
            computed = sized.evaluate(name, *given, time=now, target=target)
            for row, (value, bounded) in enumerate(zip(np.ravel(computed), expected, strict=True)):
                error, last = errors(float(value), bounded)
                k, ulp = max(k, error), max(ulp, last)
                if error > largest:
                    raise CrossCheckError.on(
                        4,
                        system.name,
                        f"{name} of {target} for {window.size} members is {float(value)!r} in row "
                        f"{row}, and {bounded.value:.17g} to 50 digits: k = {error:.3g}, at most "
                        f"{largest:g} is allowed",
                    )
        old = figures.get(target, Figures(0.0, 0.0, 0))
        figures[target] = Figures(max(k, old.k), max(ulp, old.ulp), old.points + len(known))


def _evaluate(window: Window, loops: Loops, points: Sequence[Point]) -> dict[int, Sequence[Any]]:
    """The exact rows at the points where the equations have a value, by their numbers.

    Their envelopes are those of the equations or of the loops, whichever are larger: they may be
    written in different forms, of which one has cancelled what the other subtracts.
    """
    others = dict[int, Any]()
    for n, point in enumerate(points):
        arrays = {name: getattr(point, name).tolist() for name in ("state", "parameters", "inputs")}
        others[n] = evaluate_loops(loops, {**arrays, "time": [point.time]}, window.size)
    if loops.name == "kinks":  # rung 2 has read these off from the rates
        return {n: rows for n, rows in others.items() if rows is not None}
    return {
        n: [
            replace(row, envelope=max(row.envelope, other.envelope))
            for row, other in zip(rows, others[n] or rows, strict=True)
        ]
        for n, rows in window.evaluate(loops.name, points).items()
    }


def _compare_targets(
    system: Any, name: str, small: int, targets: Sequence[str], *, calls: bool
) -> dict[str, int]:
    """Points at which targets agree with NumPy, for several numbers of members.

    Those that promise bits have the same bits; others, and functions that call more than sqrt,
    agree but for roundings.
    """
    equal = {target: 0 for target in targets if target != "numpy" and "numpy" in targets}
    most = LARGEST_MATRIX if system.index.of_rows else max(SIZES)
    sizes = (small, small + 1, *(size for size in SIZES if small + 1 < size <= most))
    for size in filter(system.index.allows, sizes):
        sized = system.resize({system.index.name: size})
        source = np.random.default_rng(size)
        for batch in BATCHES:
            state = source.normal(size=(sized.rows(name).size, *batch))
            for shape in dict.fromkeys(((), batch)):
                parameters = source.uniform(0.5, 2.0, (sized.PARAMETERS.size, *shape))
                for row, factor in sized.stretched.items():
                    parameters[row] *= factor
                time = source.normal(size=shape) if sized.TIME else None
                inputs = source.normal(size=(sized.INPUTS.size, *shape)) if sized.INPUTS else None
                given = (state, parameters, inputs)
                one = sized.evaluate(name, *given, time=time, target="numpy")
                one = np.reshape(one, (-1, *batch))  # the energy has no rows
                for target in equal:
                    other = sized.evaluate(name, *given, time=time, target=target)
                    exact = target in BUILDS[target].exact and not calls
                    stops = BUILDS[target].stops_at_poles
                    different = find_differences(
                        one, np.reshape(other, one.shape), exact=exact, stops=stops
                    )
                    if different.any():
                        row = np.argwhere(different)[0].tolist()
                        raise CrossCheckError.on(
                            5,
                            system.name,
                            f"{name} of {target} for {size} members differs from NumPy in {row}",
                        )
                    equal[target] += int(_has_values(one).sum())
    nothing = [target for target, count in equal.items() if not count]
    if nothing:
        raise CrossCheckError.on(
            5, system.name, f"nothing of {name} was compared with {nothing[0]}"
        )
    return equal


def find_differences(
    one: Array, other: Array, *, exact: bool, stops: bool = False
) -> NDArray[np.bool_]:
    """Where two results differ: in a bit, or by more than roundings of numbers of the size of 1.

    A ring of one member has results that cancel to 0, but for the roundings of what cancels, which
    is of the order of 1, as states and parameters are. Where one row has no value, some targets
    give none of the others.

    Args:
        one: Results of NumPy, a row for each number and a column for each trajectory.
        other: Those of another target.
        exact: Whether bits are promised.
        stops: Whether the other target stops where one row has no value, and then gives NaN in all.
    """
    if exact:
        stopped = stops & ~_has_values(one) & np.isnan(other).all(axis=0)
        return find_differing_bits(np.where(stopped, np.nan, one), other)
    most = np.abs(one[np.isfinite(one)]).max(initial=1.0)
    close = np.isclose(one, other, rtol=0.0, atol=ROUNDINGS * most)
    lacks_values = ~np.isfinite(other).all(axis=0)
    return np.asarray(~np.where(_has_values(one), close, lacks_values))


def _has_values(result: Array) -> NDArray[np.bool_]:
    """Of each member of a batch, whether all rows have a value."""
    return np.asarray(np.isfinite(result).all(axis=0))
