"""Every method of every shipped system that its certificate says applies, against what is claimed.

python benchmarks/methods.py [SYSTEM ...]

- The order is that of runs with steps that are halved, on the system itself.
- The defect of a claimed Poisson map is ``max |D J D^T - J|`` of a step with the derivative D,
  relative to the tensor J, by differences of order 8, which leave roundings alone.
- Reversal: four steps, the change of signs that reverses the motion by its certificate, four
  steps and the change again lead back. All methods are symmetric, and go with changes of signs;
  where states are moved onto constraints a step is not symmetric, and nothing is claimed.
- Drifts are the largest relative changes of what is kept exactly, and of the rest. The growth is
  the exponent p of the best line ``log drift = p log n + c`` through numbers of steps that are
  doubled.

Motions with noise are left out. Systems of equal members and fields have the size of their spec.
Read next: `structure.py`, for drifts over many steps.
"""

from __future__ import annotations

import re
import sys
import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np
from figures import Figure, script
from results import Table, write

from coadjoint.cli.arguments import load_system
from coadjoint.errors import CoadjointError
from coadjoint.methods import tell_order
from coadjoint.resources import derivations_folder
from coadjoint.solve.self_check import DEFECT, LARGE, Measured, Runs, find_defect, measure_method
from coadjoint.solve.shocks import ShockWarning

#: Steps there and back, and how far from its start a state may come, relative to it, times the
#: square of the growth of states.
TURNED, BACK = 4, 1e-12
#: Steps of the first of the runs that tell an order.
FIRST = 4
#: Steps that tell drifts: of the method that is preferred to all others, and of all else.
LONG, SHORT = 4096, 32
#: What grows faster than that, and comes to more, times the square of the growth of states, has a
#: bias.
GROWTH, BIASED = 0.8, 1e-13
#: States that grow so much had close encounters, which long runs with these steps do not resolve:
#: the growth of their drifts says nothing.
UNRESOLVED = 10.0
#: The least defect of maps that are similar to Poisson maps, and are none.
SEEN = 1e-6
#: Rows of a system up to which long runs are cheap.
FEW = 3 * LARGE


@dataclass(frozen=True)
class Row:
    """What runs say of a method of a system.

    Attributes:
        system: Its name.
        found: The method with its order, defect and drifts.
        back: How far from the start it led back; None without a reversal.
        compared: What was compared with claims, counted by kind.
        failures: What contradicts them, as clauses.
    """

    system: str
    found: Measured
    back: float | None
    compared: Counter[str]
    failures: tuple[str, ...]

    def list_cells(self) -> list[Any]:
        """Its line of the table."""
        found, method = self.found, self.found.method
        kept = [found.drifts[n] for n in method.exactly if n in found.drifts]
        powers = [found.exponents[n] for n in method.exactly if n in found.exponents]
        rest = [x for n, x in found.drifts.items() if n not in method.exactly]
        return [
            self.system,
            method.name,
            tell_order(method.name, method.order),
            "rounding" if found.order is None else f"{found.order:.1f}",
            _tell(found.defect),
            _tell(self.back),
            _tell(max(kept, default=None)),
            f"{max(powers):.1f}" if powers else "-",
            _tell(max(rest, default=None)),
            "; ".join(self.failures) or "as claimed",
        ]


def _tell(value: float | None) -> str:
    """A small number as text."""
    return "-" if value is None else f"{value:.0e}"


def find_reversal(system: Any) -> Any:
    """The signs, row by row, that reverse the motion by its certificate; None without such."""
    said = system.certificate.get("structure", {}).get("reversed_by", "")
    turned = {old for old, new in re.findall(r"(\w+) -> -(\w+)", said) if old == new} - {"t"}
    signs = np.ones(system.STATE.size)
    for name in turned:
        signs[system.STATE.rows(name)] = -1.0
    return signs if turned else None


def go_back(runs: Runs, method: str, signs: Any) -> tuple[float, float]:
    """How far steps there and back end from the start, relative to it, and how states grew.

    They end and begin at the time 0, about which a motion that is driven is reversed.
    """
    state, longest = runs.states, TURNED * runs.step
    sizes = [np.abs(state).max(axis=0)]
    for start in (-longest, 0.0):
        found = runs.system.simulate(
            state, (start, start + longest), method=method, step=runs.step, samples=1,
            target=runs.find_target(method), progress=False,
        )  # fmt: skip
        ended = np.where(np.asarray(found.status) == "OK", found.state[..., -1], np.nan)
        state = signs[:, np.newaxis] * ended
        sizes.append(np.abs(state).max(axis=0))
    off = np.abs(state - runs.states).max(axis=0) / sizes[0]
    return float(np.nanmax(off)), float(np.nanmax(sizes / sizes[0]))


def measure_system(name: str, names: Sequence[str] = ()) -> Iterator[Row]:
    """The methods of a system, or those that are named.

    Raises:
        CoadjointError: No run can be followed.
    """
    system = load_system(name)
    judged = [x for x in system.METHODS if x.applies and (not names or x.name in names)]
    if not judged:
        return
    runs, signs = Runs(system, FIRST), find_reversal(system)
    is_moved = "projection" in system.functions
    for method in judged:
        is_long = method.rank == 1 and len(runs.states) <= FEW
        runs.target = "c" if is_long or len(runs.states) > LARGE else "numpy"
        found = measure_method(runs, method, LONG if is_long else SHORT)
        failures = list(found.failures)
        compared = Counter(
            orders=int(found.order is not None),
            maps=int(found.defect is not None),
            integrals=len(method.exactly),
        )
        back = None
        if signs is not None:
            back, growth = go_back(runs, method.name, signs)
            if not is_moved:
                compared["reversals"] += 1
                if not back < BACK * growth**2:
                    failures.append(f"it leads back with an error of {back:.1e}")
        if is_long and found.grown < UNRESOLVED:
            for kept in set(method.exactly) & found.exponents.keys():
                compared["growths"] += 1
                if found.exponents[kept] > GROWTH and found.drifts[kept] > BIASED * found.grown**2:
                    failures.append(f"the drift of {kept} grows as n^{found.exponents[kept]:.1f}")
        yield Row(name, found, back, compared, tuple(failures))


def measure_controls() -> dict[str, float]:
    """Defects of maps on so(3)* that are similar to Poisson maps, and are none."""
    runs = Runs(load_system("rigid_body"))
    midpoint = find_defect(runs, "midpoint", part=4.0)
    assert midpoint is not None
    plain, system = runs.run, runs.system

    def turn(state: Any, slopes: Any, h: float) -> Any:
        total = term = state
        for k in range(1, 30):
            turned = [system.bracket_vector(x, y) for x, y in zip(term.T, slopes.T, strict=True)]
            term = h / k * np.array(turned).T
            total = total + term
        return total

    def naive(method: str, step: float, count: int, states: Any) -> Any:
        """The turn by the velocity at the end of half of it, which is no mean."""
        slopes = system.energy_gradient(states)
        for _ in range(40):
            slopes = system.energy_gradient(turn(states, slopes, step / 2))
        return turn(states, slopes, step)

    runs.run = naive  # type: ignore[method-assign]
    found = find_defect(runs, "exponential of the middle", part=4.0)
    runs.run = plain  # type: ignore[method-assign]
    assert found is not None
    return {"the implicit midpoint": midpoint, "the naive Lie midpoint": found}


def measure(names: Sequence[str] = ()) -> list[Figure]:
    """All figures; files are written unless systems are named."""
    warnings.simplefilter("ignore", ShockWarning)  # claims are of the points, which know no shock
    rows, unseen, start = list[Row](), list[str](), process_time()
    for name in names or [path.stem for path in sorted(derivations_folder().glob("*.toml"))]:
        print(f"{name}, {process_time() - start:.0f} s", file=sys.stderr, flush=True)
        try:
            found = list(measure_system(name))
        except CoadjointError as error:
            unseen.append(f"{name}: {error}")
            continue
        rows += found
        if not found:
            unseen.append(f"{name}: no method that keeps structure applies")
    compared = sum((row.compared for row in rows), Counter[str]())
    failed = [row for row in rows if row.failures]
    untold = [row for row in rows if row.found.method.is_poisson and row.found.defect is None]
    defects = [row.found.defect for row in rows if row.found.defect is not None]
    rounded = [row for row in rows if row.found.order is None]
    systems = len({row.system for row in rows})
    figures = [
        Figure(
            f"{len(rows)} methods of {systems} systems: claims that fail, of {compared.total()} "
            f"compared ({', '.join(f'{n} {kind}' for kind, n in compared.items())})",
            "0", str(sum(len(row.failures) for row in failed)), not failed,
        ),
        Figure("largest defect of a claimed Poisson map", f"< {DEFECT:.0e}",
               f"{max(defects, default=0.0):.1e}", max(defects, default=0.0) < DEFECT),
        *(Figure(f"rigid body: defect of {who}, which is no Poisson map", f"> {SEEN:.0e}",
                 f"{found:.1e}", found > SEEN) for who, found in measure_controls().items()),
        Figure("Poisson maps that were not compared, of systems without a tensor", "none",
               str(len(untold))),
        Figure("orders that were not compared, as roundings alone are seen", "none",
               str(len(rounded))),
        *(Figure(f"{row.system}, {row.found.method.name}", "as claimed", "; ".join(row.failures),
                 met=False) for row in failed),
    ]  # fmt: skip
    if not names:
        columns = ("system", "method", "order", "measured", "defect", "back", "kept", "growth",
                   "rest", "")  # fmt: skip
        table = Table("Methods", columns, [row.list_cells() for row in rows])
        taken = f"{process_time() - start:.0f} s, without compiling"
        setting = {
            "processor time": taken,
            "steps": f"{LONG} of the first method by rank of systems of {FEW} rows or less, "
            f"{SHORT} of others",
            **{f"left out {n}": text for n, text in enumerate(unseen, 1)},
        }
        write("methods", setting, (), figures, (table,))
    return figures


if __name__ == "__main__":
    script(lambda: measure(sys.argv[1:]))
