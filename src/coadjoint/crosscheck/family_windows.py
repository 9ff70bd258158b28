"""Cross-check, family windows: functions of members that are written out, in the rows of loops.

Comes in: the Equations of a small number of members, which know nothing of loops, and points. Goes
out: values to 50 digits, in the order of the rows of a family.
Read next: `coadjoint.crosscheck.families`, which compares kernels with them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from decimal import localcontext
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.crosscheck.columns import find_exact
from coadjoint.crosscheck.oracle import CONTEXT, OutsideDomain, call, exact, oracle
from coadjoint.crosscheck.replay import Replayed
from coadjoint.derive.mechanics.turning import turning_residuals
from coadjoint.derive.reference import Reference
from coadjoint.derive.setting import STEP
from coadjoint.derive.splittings import Splitting
from coadjoint.families import Family
from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from coadjoint.spec.core.members import member_name
from coadjoint.spec.spatial import turning_rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.derive import Equations
    from coadjoint.spec.model import Windows

    Array = NDArray[np.float64]

#: Functions with a row for each of the state, in its order.
OF_STATE: Final = (
    *("rhs", "jacobian_vector", "projection"),
    *("energy_gradient", "bracket_vector", "sandwich"),
)


@dataclass(frozen=True)
class Point:
    """Where a function is evaluated."""

    state: Array
    parameters: Array
    inputs: Array
    time: float


@dataclass(frozen=True)
class Window:
    """A system that is written out, in the names of its rows as kernels have them.

    Attributes:
        reference: Its Equations.
        replayed: The same, for many points.
        size: Its number of members.
        state: Names of its components in the order of a family: component after component.
        parameters: Likewise.
        totals: Names of the rows of the function ``observables``.
        residuals: Those of the function ``constraint_residual``.
        time: Of the time, if there is one.
        count: Of the number of members, if formulas name it.
        inputs: Names of the rows of the inputs.
        noise: Names of the Wiener processes; those that no member has in a window are missing in
            its equations.
        splitting: The parts of its energy whose flows the family has.
    """

    reference: Reference
    replayed: Replayed
    size: int
    state: tuple[str, ...]
    parameters: tuple[str, ...]
    totals: tuple[str, ...]
    residuals: tuple[str, ...]
    time: tuple[str, ...]
    count: tuple[str, ...]
    inputs: tuple[str, ...]
    noise: tuple[str, ...]
    splitting: Splitting | None

    @classmethod
    def of(
        cls,
        equations: Equations,
        declared: Windows,
        family: Family,
        splitting: Splitting | None = None,
    ) -> Window:
        """The window of Equations of a few members."""
        spec = equations.spec
        quantities = (*spec.variables, *spec.parameters, *spec.inputs)
        known = {each.name: each for each in quantities}
        turning = {each.name: each for each in spec.turning}
        size = len(spec.state) // len(declared.variables)

        def rows(names: Sequence[str]) -> tuple[str, ...]:
            return tuple(
                name
                for each in names
                for same in zip(
                    *(known[member_name(each, k)].components for k in range(size)), strict=True
                )
                for name in same
            )

        def alike(names: Sequence[str]) -> tuple[str, ...]:
            return tuple(c for each in names for c in known[each].components)

        reference = Reference(equations)
        return cls(
            reference=reference,
            replayed=Replayed(reference),
            size=size,
            state=rows(declared.variables),
            parameters=(*alike(declared.shared), *rows(declared.indexed)),
            inputs=(*alike(declared.shared_inputs), *rows(declared.indexed_inputs)),
            totals=tuple(each.name for each in family.totals),
            residuals=tuple(
                name
                for each in declared.variables
                if member_name(each, 0) in turning
                for same in zip(
                    *(turning_rows(spec, turning[member_name(each, k)]) for k in range(size)),
                    strict=True,
                )
                for name in same
            ),
            time=tuple(map(str, family.time)),
            count=(declared.index.count,) if declared.index.is_value else (),
            noise=(
                *declared.shared_noise,
                *(member_name(each, k) for each in declared.indexed_noise for k in range(size)),
            ),
            splitting=splitting,
        )

    def evaluate(self, function: str, points: Sequence[Point]) -> dict[int, list[Any]]:
        """A function to 50 digits at the points where it has a value, by their numbers.

        Rows are in the order of a family.
        """
        inputs = [self._name_inputs(function, point) for point in points]
        if function == "noise_vector":
            found = dict[int, list[Any]]()
            for n, point in enumerate(points):
                with suppress(OutsideDomain):
                    numbers = point.state[len(self.state) :].tolist()
                    found[n] = self._move_by_noise(inputs[n], numbers)
            return found
        if function.startswith("flow"):
            return self._follow(int(function.removeprefix("flow")) - 1, points, inputs)
        own = "rhs" if function == "sided_rhs" else function  # at the signs that the points have
        columns = {name: np.array([each[name] for each in inputs]) for name in inputs[0]}
        known = find_exact(self.replayed, own, columns)
        return {n: self._order(own, values) for n, values in known.items()}

    def _name_inputs(self, function: str, point: Point) -> dict[str, float]:
        """Numbers of a point by the names that the equations have for them."""
        inputs = dict(zip(self.parameters, point.parameters.tolist(), strict=True))
        inputs |= zip(self.state, point.state.tolist(), strict=False)
        inputs |= zip(self.inputs, point.inputs.tolist(), strict=True)
        inputs |= dict.fromkeys(self.time, point.time)
        inputs |= dict.fromkeys(self.count, float(self.size))
        if KERNEL_FUNCTIONS[function].below == "vector":
            place = {name: n for n, name in enumerate(self.reference.state, 1)}
            vector = point.state[len(self.state) :].tolist()
            inputs |= {f"_h{place[name]}": v for name, v in zip(self.state, vector, strict=True)}
        return inputs

    def _order(self, function: str, values: list[Any]) -> list[Any]:
        """Rows of the equations in the order of a family."""
        if function in OF_STATE:
            by_name = dict(zip(self.reference.state, values, strict=True))
            return [by_name[name] for name in self.state]
        if function == "observables":
            labels = [label for label, _ in self.reference.equations.exact.observables]
            by_name = dict(zip(labels, values, strict=True))
            return [by_name[name] for name in self.totals]
        if function == "constraint_residual":
            rows = turning_residuals(self.reference.equations.setting)
            by_name = dict(zip((name for name, _ in rows), values, strict=True))
            return [by_name[name] for name in self.residuals]
        return values

    def _follow(
        self, place: int, points: Sequence[Point], inputs: Sequence[Mapping[str, float]]
    ) -> dict[int, list[Any]]:
        """What the flow of a part adds, as the elements say that were proved for this window."""
        assert self.splitting is not None, place
        field, flow = self.splitting.equations.setting.field, self.splitting.parts[place].flow
        there = dict(zip(self.reference.state, flow.values, strict=True))
        rises, found = [there[name] - field[name] for name in self.state], dict[int, list[Any]]()
        for n, point in enumerate(points):
            given = {**inputs[n], STEP: float(point.state[-1])}
            with suppress(OutsideDomain, ArithmeticError), localcontext(CONTEXT):
                known = {name: exact(value) for name, value in given.items()}
                for name, element in flow.define(field):
                    known[name] = field.evaluate(element, known, exact, call)
                found[n] = [field.evaluate(rise, known, exact, call) for rise in rises]
        return found

    def _move_by_noise(self, inputs: Mapping[str, float], numbers: Sequence[float]) -> list[Any]:
        """What each process does to the state, times a number, one after the other."""
        given = dict(zip(self.noise, numbers, strict=True))
        processes = [each.name for each in self.reference.equations.spec.noise]
        values = iter(oracle(self.reference, "noise", inputs))
        moved = dict[str, Any]()
        with localcontext(CONTEXT):
            for name in self.reference.state:
                parts = [next(values) * exact(given[process]) for process in processes]
                moved[name] = sum(parts[1:], parts[0])
        return [moved[name] for name in self.state]
