"""Export: one method of integration of a system as a file that programs of others include.

Comes in: the rendered files of a system, and the name of a method. Goes out: a header of C, with a
run of the library in it that its self-test repeats.
Read next: `coadjoint.render.header`.
"""

from __future__ import annotations

from typing import Any, Final

from coadjoint.errors import KernelArgumentError
from coadjoint.pipeline import Rendered
from coadjoint.render.header import Sample, find_method, find_obstacle, render_header
from coadjoint.solve.arrays import pack_inputs, pack_parameters
from coadjoint.solve.folders import load_texts
from coadjoint.solve.self_check import Runs
from coadjoint.solve.system import System

#: Steps of the run that the self-test of a header repeats.
STEPS: Final = 48
#: Their length in parts of those of other runs: in short steps few roundings of rates are seen.
LONG: Final = 4
#: How far, in parts of the largest component, it may end elsewhere where functions beyond sqrt are
#: called: libraries round these differently.
ROUNDED: Final = 1e-9


def export_header(rendered: Rendered, method: str) -> str:
    """The header of a method, in C99 and C++17.

    Args:
        rendered: The system.
        method: Its name, or ``"auto"`` for the one that ``"auto"`` takes with a fixed step.

    Raises:
        KernelArgumentError: The method does not apply, with the reason.
        SpecError: A name of the spec is a word of C++.
    """
    system, context = rendered.equations.spec.name, rendered.context
    if context is None:
        many = "points" if rendered.equations.spec.space else "equal members"
        find_method(method, system, (), f"its solvers are loops over {many}")
        raise AssertionError(system)
    chosen, judged = find_method(method, system, rendered.methods, find_obstacle(context))
    with load_texts(rendered.texts) as loaded:
        sample = find_sample(loaded, chosen.name)
    return render_header(context, chosen, judged, sample)


def find_sample(system: System, method: str) -> Sample | None:
    """A run from near the default state; None where nothing near it can be followed.

    It is made by the twin in NumPy, which has the bits of the exact build and compiles nothing. It
    begins where runs do, which move attitudes to rotations first.
    """
    try:
        runs = Runs(system)
    except KernelArgumentError:
        return None
    state = runs.states[:, 0]
    for step in (LONG * runs.step, runs.step):
        run = system.simulate(
            state,
            (0.0, STEPS * step),
            method=method,
            step=step,
            samples=2,
            target="numpy",
            progress=False,
        )
        if run.status == "OK":
            break
    else:
        return None
    end, size = run.state[:, -1], float(abs(run.state).max())
    return Sample(
        state=_write(run.state[:, 0]),
        parameters=_write(pack_parameters(system, None)),
        inputs=_write(pack_inputs(system, None)) if system.INPUTS else (),
        end=_write(end),
        step=step.hex(),
        count=STEPS,
        tolerance=repr(ROUNDED * size),
        size=repr(max(size, 1.0) ** 2),
    )


def _write(values: Any) -> list[str]:
    """Numbers as C reads them back to the bit."""
    return [float(value).hex() for value in values]
