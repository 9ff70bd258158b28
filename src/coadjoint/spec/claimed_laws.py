"""Claimed laws: what observables, symmetries, maps, charts and claims demand of units.

Comes in: the `Units` of a spec. Goes out: demands; see `coadjoint.spec.laws`, which has those of
the motion itself.
"""

from __future__ import annotations

from collections.abc import Sequence

from coadjoint.algebra.matrices import SparseMatrix, size
from coadjoint.spec.core.dimensions import Measured
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.units import Unit, unknown
from coadjoint.spec.dimensions import Units
from coadjoint.spec.model import Symmetry
from coadjoint.spec.sections.charts import DeclaredChart
from coadjoint.spec.sections.reduction import Submanifold

ENERGY = "A momentum times its velocity is an energy."
BRACKET = "A bracket {x, y} has the unit of x y over that of energy and time."


def demand_emitted(units: Units) -> None:
    """Observables, and momenta along sections."""
    for each in units.spec.observables:
        units.equate(each.formula, units.of(each), f"That is the declared unit of {each.name}.")
    velocities = {part.name: part for each in units.spec.variables for part in each.parts}
    for section in units.spec.sections:
        (own,) = units.of(section)
        for name, formula in section.section.items():
            along = units.of(velocities[name])
            expected = [own * unit / units.energy for unit in along]
            why = f"{section.name} is a momentum along this field."
            units.equate(formula, expected, why)


def demand_symmetry(units: Units, symmetry: Symmetry) -> None:
    """A momentum map times the element that acts is an action, where there is a bracket."""
    spec, algebra = units.spec, symmetry.algebra
    key: KeyPath = ("symmetries", symmetry.name)
    element = [unknown(f"{symmetry.name} along {n}") for n in algebra.basis]
    names = _name_element(symmetry, element)
    has_bracket = (spec.lagrangian or spec.hamiltonian) and not spec.constraints
    action = units.action if has_bracket else unknown(f"{symmetry.name} times its element")
    state = {each.name: each for each in spec.state}
    for name, formula in symmetry.generators.items():
        units.equate(formula, units.names[name].entries, f"It moves {name}.", names)
    moved = [unit for name in symmetry.linear for unit in units.of(state[name])]
    if moved:
        for unit, matrix in zip(element, algebra.matrices, strict=True):
            for row, column in matrix:
                units.require((*key, "linear"), moved[row], unit * moved[column])
    if symmetry.time is not None:
        units.equate(symmetry.time, (units.time,), "It moves the time.", names)
    if symmetry.map is not None:
        why = "It generates the motion of the symmetry."
        units.equate(symmetry.map, (action,), why, names)
    for own, unit in zip(units.of(symmetry), element, strict=True):
        at: KeyPath = (*key, "unit") if symmetry.unit else key
        why = "Times the element that acts, a momentum map is an energy times a time."
        units.require(at, own, action / unit, why)


def _name_element(symmetry: Symmetry, element: Sequence[Unit]) -> dict[str, Measured]:
    """The generic element and its blocks as formulas name them."""
    algebra, name = symmetry.algebra, symmetry.element
    if not name:
        return {}
    if symmetry.as_matrix:
        return {name: _weigh(element, algebra.matrices)}
    runs: dict[str, Sequence[int]] = {name: range(algebra.dimension)}
    runs |= {f"{name}_{block}": run for block, run in algebra.blocks.items()}
    return {
        each: Measured((len(run),) if len(run) > 1 else (), tuple(element[i] for i in run))
        for each, run in runs.items()
    }


def _weigh(element: Sequence[Unit], matrices: Sequence[SparseMatrix]) -> Measured:
    """The units of a sum of matrices, as those of the first that has an entry."""
    rows = size(matrices)
    entries: dict[tuple[int, int], Unit] = {}
    for unit, matrix in zip(element, matrices, strict=True):
        for place in matrix:
            entries.setdefault(place, unit)
    places = [(i, j) for i in range(rows) for j in range(rows)]
    return Measured((rows, rows), tuple(entries.get(place) for place in places))


def demand_maps(units: Units) -> None:
    """A map of the motion to itself, and a submanifold, keep the units."""
    for each in units.spec.transformations:
        for table in (each.map, each.exchanges):
            for name, formula in table.items():
                units.equate(formula, units.names[name].entries, f"It takes the place of {name}.")


def demand_section(units: Units, submanifold: Submanifold) -> None:
    """What is given on a submanifold has its own unit."""
    parts = {part.name: part for each in units.spec.variables for part in each.parts}
    for name, formula in submanifold.section.items():
        entries = units.names[name].entries if name in units.names else units.of(parts[name])
        units.equate(formula, entries, f"It takes the place of {name}.")
    for formula in submanifold.where:
        units.value(formula)


def demand_chart(units: Units, chart: DeclaredChart) -> None:
    """The same motion in other variables, whose units its map tells."""
    names: dict[str, Measured] = {}
    for each in chart.variables:
        entries = tuple(unknown(name) for name in each.components)
        names |= {n: Measured((), (u,)) for n, u in zip(each.components, entries, strict=True)}
        names[each.name] = Measured(each.shape, entries)
    for name, formula in chart.map.items():
        units.equate(formula, units.names[name].entries, f"It takes the place of {name}.", names)
    for formula in chart.where:
        units.value(formula, names)
    energy = unknown(f"the energy of {chart.name}")
    for name, formula in chart.motion.items():
        if chart.kind == "rates":
            wanted = [None if u is None else u / units.time for u in names[name].entries]
            units.equate(formula, wanted, f"It is the rate of {name}.", names)
        else:
            units.equate(formula, (energy,), ENERGY, names)
    for first, second in chart.pairs:
        for q, p in zip(names[first].entries, names[second].entries, strict=True):
            assert q is not None, first
            made = q / units.time if chart.kind == "lagrangian" else energy * units.time / q
            units.require(("charts", chart.name), p, made, f"{first} and {second} are a pair.")


def demand_claims(units: Units) -> None:
    """Claimed formulas fit in themselves; claimed brackets are brackets."""
    spec = units.spec
    for formula in spec.casimirs:
        units.value(formula)
    for integral in spec.conserved:
        for formula in (integral.formula, *integral.where):
            units.value(formula)
    for claim in spec.brackets:
        sides = [units.value(claim.left), units.value(claim.right)]
        made = [
            None if one is None or other is None else one * other / units.action
            for one in sides[0]
            for other in sides[1]
        ]
        units.equate(claim.value, made, BRACKET)
