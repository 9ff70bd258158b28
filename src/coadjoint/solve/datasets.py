"""Datasets of a solution: xarray, with the names of components as coordinates, and NetCDF 3.

Comes in: a Solution, or a file that `to_netcdf` wrote. Goes out: the other, to the last bit. Files
are NetCDF 3, which SciPy reads and writes and every tool of the format knows.
Read next: `coadjoint.solve.carried`.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.files import check_writable, write_whole
from coadjoint.solve.carried import (
    check_same_system,
    describe_form,
    describe_run,
    explain_unread,
    import_extra,
    list_batch,
    list_components,
    list_quantities,
    name_axes,
    rebuild,
)
from coadjoint.solve.event_tables import list_columns
from coadjoint.solve.step_tables import as_json, describe_dense

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.declared import Quantity
    from coadjoint.solve.solution import Solution
    from coadjoint.solve.system import System

    Array = NDArray[np.float64]

#: What stands before the name of a parameter, whose names a variable may have as well.
PARAMETER = "parameter_"
#: Before the columns of the table of events.
EVENT = "event_"
#: Before what `describe_dense` says.
STEP = "dense_"
#: Before what `describe_form` says.
FORM = "form_"


def to_xarray(solution: Solution) -> Any:
    """A dataset: a variable for each quantity, ``(name_component, *members, time)``."""
    xarray = import_extra("xarray", "to_xarray")
    quantities, batch = list_quantities(solution), list_batch(solution)
    axes = name_axes(batch, quantities)
    coordinates: dict[str, Any] = {
        axis: (axis, np.arange(size), {"units": "1"})
        for axis, size in zip(axes, batch, strict=True)
    }
    coordinates["time"] = ("time", solution.time, {"units": solution.unit("time")})
    variables: dict[str, Any] = {}
    for name, quantity in quantities.items():
        lead = _add_components(coordinates, name, quantity)
        attributes = {"units": quantity.unit}
        values = solution[name]
        if len(quantity.shape) > 1:  # a matrix, along the one axis of its components
            values = values.reshape(-1, *values.shape[2:])
        variables[name] = ([*lead, *axes, "time"], values, attributes)
    attributes = describe_run(solution) | {
        FORM + name: value for name, value in describe_form(solution).items()
    }
    for name in ("status", "message"):  # of members, each has its own
        if not isinstance(attributes[name], str | int):
            variables[name] = (axes, np.asarray(attributes.pop(name)))
    for name in ("course", "events"):
        if name in attributes:
            attributes[name] = json.dumps(attributes[name])
    _add_events(solution, variables)
    _add_steps(solution, coordinates, variables, attributes)
    _add_parameters(solution, axes, coordinates, variables, attributes)
    return xarray.Dataset(variables, coords=coordinates, attrs=attributes)


def _add_components(coordinates: dict[str, Any], name: str, quantity: Quantity) -> list[str]:
    """The axis of components of a quantity, if it has one; their units where they differ."""
    if not quantity.shape:
        return []
    axis, components = f"{name}_component", list(quantity.components)
    coordinates[axis] = (axis, components, {"long_name": f"component of {name}"})
    units = [quantity.unit_of(component) for component in components]
    if len(set(units)) > 1:
        coordinates[f"{name}_unit"] = (axis, units)
    return [axis]


def _add_events(solution: Solution, variables: dict[str, Any]) -> None:
    """The table of events for readers, along an axis of its own; read back is the attribute."""
    if not solution.events:
        return
    units = {name: solution.unit(name) for name in ("time", *list_components(solution))}
    for name, values in list_columns(solution.events).items():
        kind = np.dtype(np.str_) if name == "event" else None
        attributes = {"units": units[name]} if name in units else {}
        title = EVENT + ("name" if name == "event" else name)
        variables[title] = (EVENT + "number", np.asarray(values, kind), attributes)


def _add_steps(
    solution: Solution,
    coordinates: dict[str, Any],
    variables: dict[str, Any],
    attributes: dict[str, Any],
) -> None:
    """The steps of dense output, along an axis of their own; those of SciPy as an attribute."""
    said = describe_dense(solution.dense)
    if said is None:
        return
    if "coefficients" in said and len(said["begun"]):
        coefficients, system = said.pop("coefficients"), solution.system
        names = [*system.STATE.components, *system.RECONSTRUCTED.components]
        axes = [STEP + name for name in ("step", "component", "order")]
        coordinates[axes[1]] = (axes[1], names[: coefficients.shape[1]])
        units = {"begun": {"units": "s"}, "size": {"units": "s"}}
        for name in ("member", "begun", "size"):
            variables[STEP + name] = (axes[0], said.pop(name), units.get(name, {}))
        variables[STEP + "coefficients"] = (axes, coefficients)
    attributes["dense"] = json.dumps(said, default=as_json)


def _find_steps(said: dict[str, Any], dataset: Any) -> Any:
    """The record of dense output, from an attribute and variables."""
    if "dense" not in said:
        return None
    held = ("member", "begun", "size", "coefficients")
    arrays = {name: dataset[STEP + name].values for name in held if STEP + name in dataset}
    return json.loads(said["dense"]) | arrays


def _add_parameters(
    solution: Solution,
    axes: list[str],
    coordinates: dict[str, Any],
    variables: dict[str, Any],
    attributes: dict[str, Any],
) -> None:
    """Parameters that all members share as attributes, others as variables."""
    table, values = solution.system.PARAMETERS, solution.parameters
    for name, quantity in table.items():
        own = values[table.rows(name)]
        if values.ndim == 1:
            attributes[PARAMETER + name] = own.tolist()
        else:
            lead = _add_components(coordinates, PARAMETER + name, quantity)
            variables[PARAMETER + name] = ([*lead, *axes], own, {"units": quantity.unit})


def to_netcdf(solution: Solution, path: Path) -> None:
    """Write the dataset."""
    check_writable(path)
    dataset = to_xarray(solution)
    with write_whole(path) as place:
        dataset.to_netcdf(place, engine="scipy", format="NETCDF3_64BIT")


def read_netcdf(system: System, path: Path) -> Solution:
    """The solution that a file holds."""
    xarray = import_extra("xarray", "from_netcdf")
    try:
        dataset = xarray.load_dataset(path, engine="scipy")
    except (OSError, ValueError, TypeError, KeyError, IndexError, EOFError) as error:
        raise explain_unread(path, getattr(error, "strerror", None) or error) from error
    said = {name: _as_plain(value) for name, value in dataset.attrs.items()}
    said |= {
        name: dataset[name].values.tolist() for name in ("status", "message") if name in dataset
    }
    form = {name.removeprefix(FORM): said.pop(name) for name in list(said) if FORM in name}
    check_same_system(system, said, path)
    try:
        form |= {"time": dataset["time"].values, "parameters": _read_parameters(system, dataset)}
        shared = {name: value for name, value in said.items() if not name.startswith(PARAMETER)}
        shared["dense"] = _find_steps(said, dataset)
        return rebuild(system, path, shared, _find_rows(system, dataset), form)
    except KeyError as error:
        raise explain_unread(path, f"it has no {error}") from error


def _find_rows(system: System, dataset: Any) -> Any:
    """The values of a component by name."""
    tables = (system.STATE, system.RECONSTRUCTED, system.INPUTS)

    def rows(component: str) -> Array:
        table = next(table for table in tables if component in table.components)
        quantity = table.of_component(component)
        whole: Array = dataset[quantity.name].values
        return whole[quantity.components.index(component)] if quantity.shape else whole

    return rows


def _read_parameters(system: System, dataset: Any) -> Array:
    """Packed parameters, ``(k,)`` or ``(k, *batch)``."""
    parts = []
    for name, quantity in system.PARAMETERS.items():
        key = PARAMETER + name
        found = np.asarray(dataset.attrs[key] if key in dataset.attrs else dataset[key].values)
        batch = found.shape[1:] if quantity.shape and key not in dataset.attrs else found.shape
        shape = () if key in dataset.attrs else batch
        parts.append(found.reshape(len(quantity.components), *shape))
    return np.concatenate(parts) if parts else np.empty(0)


def _as_plain(value: Any) -> Any:
    """An attribute as a JSON value."""
    return value.tolist() if isinstance(value, np.generic | np.ndarray) else value
