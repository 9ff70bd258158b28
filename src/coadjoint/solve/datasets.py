"""Datasets of a solution: xarray, with the names of components as coordinates, and NetCDF 3.

Comes in: a Solution, or a file that `to_netcdf` wrote. Goes out: the other, to the last bit. Files
are NetCDF 3, which SciPy reads and writes and every tool of the format knows.
Read next: `coadjoint.solve.carried`.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from dataclasses import replace
from math import prod
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
from coadjoint.solve.family import FamilySystem
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
    """A dataset: a variable for each quantity, ``(name_component, *members, time)``.

    What equal members or points of fields have is ``(name_component, i, *members, time)``, along
    the index ``i`` or the coordinate ``s``, which has the places of points.
    """
    xarray = import_extra("xarray", "to_xarray")
    quantities, batch = list_quantities(solution), list_batch(solution)
    axes = name_axes(batch, quantities)
    coordinates: dict[str, Any] = {
        axis: (axis, np.arange(size), {"units": "1"})
        for axis, size in zip(axes, batch, strict=True)
    }
    told = {"long_name": solution.system.clock[1], "units": solution.unit("time")}
    coordinates["time"] = ("time", solution.time, told)
    space = _add_space(solution, coordinates, {*quantities, *axes, "time"})
    variables: dict[str, Any] = {}
    for name, quantity in quantities.items():
        along = _is_along(quantity, space)
        own = _take_one(quantity, prod(space.values())) if along else quantity
        lead = _add_components(coordinates, name, own)
        values = solution[name]
        sizes = (*([len(own.components)] * bool(lead)), *(space.values() if along else ()))
        values = values.reshape(*sizes, *values.shape[len(quantity.shape) :])
        dimensions = [*lead, *(space if along else ()), *axes, "time"]
        variables[name] = (dimensions, values, {"units": quantity.unit})
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


def _add_space(
    solution: Solution, coordinates: dict[str, Any], taken: Collection[str]
) -> dict[str, int]:
    """The axes of equal members or of points of fields and how long they are, with their places.

    Entries of matrices have none.
    """
    system = solution.system
    if not isinstance(system, FamilySystem) or system.index.of_rows:
        return {}
    places = system.find_coordinates(solution.parameters)
    sizes: dict[str, int | None] = {system.index.name: system.size}
    if system.torus is not None:
        sizes = dict(zip(system.torus.coordinates, system.torus.sizes, strict=True))
    found = {}
    for name, size in sizes.items():
        assert size is not None, system.name
        axis = name + "_" * (name in taken)
        found[axis] = size
        if name in places:
            unit = solution.unit(name)
            coordinates[axis] = (axis, places[name], {"units": unit})
        elif system.counted == "members":
            numbers = np.arange(size) + system.index.first_name
            coordinates[axis] = (axis, numbers, {"units": "1"})
    return found


def _is_along(quantity: Quantity, space: Mapping[str, int]) -> bool:
    """Whether each member or point has a quantity of its own."""
    sizes = tuple(space.values())
    own = bool(space) and quantity.shape[-len(sizes) :] == sizes
    return own and quantity.components[0].endswith("]")


def _take_one(quantity: Quantity, count: int) -> Quantity:
    """A quantity of all members as that of one."""
    names = tuple(name.partition("[")[0] for name in quantity.components[::count])
    shape = (len(names),) if names != (quantity.name,) else ()
    return replace(quantity, shape=shape, components=names, default=None)


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
        units = {name: {"units": solution.unit("time")} for name in ("begun", "size")}
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
        if not quantity.shape:
            return whole
        count = len(quantity.components)  # along one axis, or along that and those of space
        axes = next(n for n in range(1, whole.ndim) if prod(whole.shape[:n]) == count)
        flat = whole.reshape(count, *whole.shape[axes:])
        row: Array = flat[quantity.components.index(component)]
        return row

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
