"""What a file of a solution holds: its components by name, and what is known about all of them.

Comes in: a Solution, or what was read of a file. Goes out: the other. State, what is reconstructed
and inputs are read back; observables are written for readers and computed again from the state.
Shapes are general: components are ``(*batch, T)``.
Read next: `coadjoint.solve.tables` and `coadjoint.solve.datasets`, the two forms of files.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module, metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.course import Course, read_record
from coadjoint.solve.ensemble import Status
from coadjoint.solve.event_tables import describe_events, read_events_back
from coadjoint.solve.occurrences import Events
from coadjoint.solve.step_tables import read_dense

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.declared import Quantity
    from coadjoint.solve.dense_output import Dense
    from coadjoint.solve.quantities import Quantities
    from coadjoint.solve.solution import Solution
    from coadjoint.solve.system import System


def import_extra(package: str, asked: str) -> Any:
    """A package of the extra ``data``.

    Raises:
        KernelArgumentError: It is not installed.
    """
    try:
        return import_module(package)
    except ImportError as error:
        raise KernelArgumentError(
            f"{asked} needs {package}, which is not installed. "
            "Run `pip install 'coadjoint[data]'`.",
            found=package,
        ) from error


def list_quantities(solution: Solution) -> dict[str, Quantity]:
    """Every quantity that the solution has values of, state first; a name appears once."""
    system = solution.system
    tables: list[Quantities] = [system.STATE]
    tables += [] if solution.reconstructed is None else [system.RECONSTRUCTED]
    tables += [system.OBSERVABLES]
    tables += [] if solution.inputs is None else [system.INPUTS]
    found: dict[str, Quantity] = {}
    for quantities in tables:
        for name, quantity in quantities.items():
            found.setdefault(name, quantity)
    return found


def list_components(solution: Solution) -> dict[str, str]:
    """Every component that the solution has values of, with its unit."""
    return {
        component: quantity.unit_of(component)
        for quantity in list_quantities(solution).values()
        for component in quantity.components
    }


def list_batch(solution: Solution) -> tuple[int, ...]:
    """The shape of the batch; empty for one trajectory."""
    return tuple(solution.state.shape[1:-1])


def name_axes(batch: tuple[int, ...], taken: Mapping[str, Any]) -> list[str]:
    """A name for each axis of the batch: ``member``, or ``member_0`` and so on if there are more.

    >>> name_axes((5,), {}), name_axes((5, 2), {}), name_axes((5,), {"member": 0})
    (['member'], ['member_0', 'member_1'], ['member_'])
    """
    names = ["member"] if len(batch) == 1 else [f"member_{n}" for n in range(len(batch))]
    return [name + "_" if name in taken else name for name in names]


def describe_run(solution: Solution) -> dict[str, Any]:
    """What a file says once: versions, system and how the solution was made, as JSON values."""
    system = solution.system
    versions = {f"{name}_version": _find_version(name) for name in ("coadjoint", "numpy", "scipy")}
    return {
        "system": system.name,
        "title": system.title,
        "id": system.id,
        "status": np.asarray(solution.status).tolist(),
        "message": np.asarray(solution.message).tolist(),
        **solution.settings,
        **({"seed": str(solution.course.seed)} if solution.course.seed is not None else {}),
        **versions,
        "course": solution.course.as_record(),
        **({"events": describe_events(solution.events)} if solution.events else {}),
    }


#: What `describe_run` says besides the settings of a solution.
_BESIDES = ("system", "title", "id", "status", "message", "course")


def rebuild(
    system: System,
    path: Path,
    said: Mapping[str, Any],
    rows: Callable[[str], Array],
    form: Mapping[str, Any],
) -> Solution:
    """The Solution of what was read.

    Args:
        system: The System.
        path: Where it was read.
        said: What `describe_run` said.
        rows: The values of a component by name, ``(*batch, T)``.
        form: The ``time``, ``(T,)``, the packed ``parameters``, and what `describe_form` says.
    """
    from coadjoint.solve.solution import Solution

    def stack(quantities: Quantities) -> Array:
        return np.array([rows(name) for name in quantities.components], dtype=np.float64)

    inputs = stack(system.INPUTS) if form["inputs"] else None
    if inputs is not None:
        inputs = _take_inputs(inputs, form["inputs"])
    status = np.asarray(said["status"])
    codes = np.array([Status[name] for name in status.ravel()], np.int8) if status.ndim else None
    course = Course(
        method=said.get("method", ""),
        order=said.get("order"),
        rtol=said.get("rtol"),
        atol=said.get("atol"),
        step=said.get("step"),
        stepwise=said.get("stepwise", ""),
        seed=int(said["seed"]) if "seed" in said else None,
        keeps=said.get("keeps", ""),
        projection=said.get("projection", ""),
        codes=None if codes is None else codes.reshape(status.shape),
        **_read_course(said["course"], path),
    )
    parameters = np.array(form["parameters"], dtype=np.float64)
    return Solution(
        system=system,
        time=np.array(form["time"], dtype=np.float64),
        state=stack(system.STATE),
        parameters=parameters,
        status="" if status.ndim else str(status),
        message=said["message"],
        reconstructed=stack(system.RECONSTRUCTED) if form["reconstructed"] else None,
        inputs=inputs,
        course=course,
        events=_read_events(system, parameters, said.get("events", []), path),
        dense=_read_dense(said.get("dense"), path),
    )


def _read_events(system: System, parameters: Array, said: Any, path: Path) -> Events:
    """What a file says of events, a list or its text.

    Raises:
        KernelArgumentError: It is no such list.
    """
    try:
        records = json.loads(said) if isinstance(said, str) else said
        return Events(read_events_back(system, parameters, records))
    except (KeyError, TypeError, ValueError) as error:
        raise explain_unread(path, f"its events are damaged: {error}") from error


def _read_dense(said: Any, path: Path) -> Dense | None:
    """What a file says of the steps, a record; None if it holds none.

    Raises:
        KernelArgumentError: It is no such record.
    """
    try:
        return None if said is None else read_dense(said)
    except (KeyError, TypeError, ValueError) as error:
        raise explain_unread(path, f"its steps are damaged: {error}") from error


def _take_inputs(inputs: Array, form: str) -> Array:
    """Inputs in the form that a Solution has them, from those of each member and sample."""
    if form == "of each":
        return inputs[..., :1].copy()
    first: Any = (slice(None), *(0,) * (inputs.ndim - 2))
    shared: Array = inputs[first]
    return shared[:, 0].copy() if form == "constant" else shared.copy()


def _read_course(said: Any, path: Path) -> dict[str, Any]:
    """What a file says of the course, a table or its text.

    Raises:
        KernelArgumentError: It is no such table.
    """
    try:
        return read_record(json.loads(said) if isinstance(said, str) else said)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise explain_unread(path, f"its course is damaged: {error}") from error


def describe_form(solution: Solution) -> dict[str, str]:
    """What the arrays of a solution are, which their values do not show.

    Returns:
        ``inputs``: ``"constant"``, ``"sampled"``, both for all members, ``"of each"`` for constants
        of each member, or ``""``; ``reconstructed``: ``"yes"`` or ``""``.
    """
    axes = 0 if solution.inputs is None else solution.inputs.ndim
    return {
        "inputs": ("", "constant", "sampled", "of each")[min(axes, 3)],
        "reconstructed": "" if solution.reconstructed is None else "yes",
    }


def check_same_system(
    system: System, said: Mapping[str, Any], path: Path, needed: Iterable[str] = ()
) -> None:
    """A file is of a System, and says all that is needed.

    Raises:
        KernelArgumentError: It is of another one, or of none.
    """
    missing = [name for name in (*_BESIDES, *needed) if name not in said]
    if missing:
        raise KernelArgumentError(
            f"{path} is not a solution: it does not say its {', '.join(missing)}. Expected a file "
            "that to_csv or to_netcdf wrote.",
            found=missing,
            path=str(path),
        )
    found, expected = (said["system"], said["id"]), (system.name, system.id)
    if found != expected:
        raise KernelArgumentError(
            f"{path} is of the system {found[0]} with the id {found[1]}; expected {expected[0]} "
            f"with {expected[1]}. Load the system that made it, or simulate again.",
            found=list(found),
            expected=list(expected),
            path=str(path),
        )


def explain_unread(path: Path, reason: object) -> KernelArgumentError:
    """What to say of a file that cannot be read."""
    return KernelArgumentError(
        f"{path} cannot be read: {reason}. Expected a file that to_csv or to_netcdf wrote.",
        path=str(path),
    )


def _find_version(package: str) -> str:
    """The version of a package."""
    if package == "coadjoint":
        from coadjoint import __version__

        return __version__
    return metadata.version(package)
