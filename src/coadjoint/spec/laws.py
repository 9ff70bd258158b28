"""Laws: what the tables of a spec demand of the units of what they name.

Comes in: the `Units` of a spec. Goes out: demands. With the energy E and the time T, a momentum
times its velocity is an energy; velocities along an algebra multiply as its brackets say, so that
those along rotations are 1/T; a bracket {x, y} is x y/(E T); a force times its velocity is E/T.
Read next: `coadjoint.spec.reader`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from typing import Any

from coadjoint.algebra.catalogue import ATTITUDES
from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.spec.claimed_laws import (
    BRACKET,
    ENERGY,
    demand_chart,
    demand_claims,
    demand_emitted,
    demand_maps,
    demand_section,
    demand_symmetry,
)
from coadjoint.spec.core.components import kept_places
from coadjoint.spec.core.dimensions import Entry, Measured
from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.units import ONE, Unit, product_of, unknown
from coadjoint.spec.dimensions import Units
from coadjoint.spec.model import Variable
from coadjoint.spec.sections.contacts import Contact
from coadjoint.spec.sections.reduction import Submanifold
from coadjoint.spec.sections.rolling import Rolling

_POWER = "A force times its velocity is an energy over a time."


def demand_laws(units: Units, submanifold: Submanifold | None = None) -> None:
    """Everything that the tables of a spec demand.

    Args:
        units: The units of the names.
        submanifold: What [reduction] says, which a Spec has only where it is restricted.
    """
    spec = units.spec
    if spec.algebra is not None:
        _demand_algebra(units, spec.algebra)
    _demand_partners(units)
    _demand_bracket(units)
    for energy in (spec.lagrangian, spec.hamiltonian):
        if energy is not None:
            what = "the unit of the energy is {found}"
            units.equate(energy, (units.energy,), ENERGY, what=what)
    _demand_newton(units)
    _demand_constraints(units)
    _demand_driving(units)
    _demand_relaxation(units)
    _demand_noise(units)
    _demand_lax(units)
    _demand_followed(units)
    demand_emitted(units)
    for symmetry in spec.symmetries:
        demand_symmetry(units, symmetry)
    demand_maps(units)
    for chart in spec.records.get("charts", ()):
        demand_chart(units, chart)
    demand_claims(units)
    if submanifold is not None:
        demand_section(units, submanifold)


def _over(above: Iterable[Unit], below: Iterable[Unit]) -> Unit:
    """A quotient of products."""
    return product_of([*((unit, 1) for unit in above), *((unit, -1) for unit in below)])


# -- what moves -----------------------------------------------------------------------------------


def _demand_algebra(units: Units, algebra: LieAlgebra) -> None:
    """Velocities along the basis, their momenta, and what they move."""
    spec = units.spec
    along: dict[int, Unit] = {
        i: unknown(f"the velocity of {n}") for i, n in enumerate(algebra.basis)
    }
    keys: dict[int, KeyPath] = {}
    for each in spec.having_role("velocity"):
        if each.block:
            along |= zip(each.block, units.of(each), strict=True)
            keys |= dict.fromkeys(each.block, _unit_key(each))
    for each in spec.having_role("momentum"):
        if not each.block:
            continue
        for place, mu in zip(each.block, units.of(each), strict=True):
            expected = units.energy / along[place]
            units.require(_unit_key(each), mu, expected, ENERGY)
            keys.setdefault(place, _unit_key(each))
    for (i, j), row in algebra.constants.items():
        for k, constant in row.items():
            for unit in _of_constant(units, constant):
                found, expected = along[i] * along[j] * unit * units.time, along[k]
                key = keys.get(i, keys.get(j, ("algebra",)))
                names = [algebra.basis[place] for place in (i, j, k)]
                why = f"[{names[0]}, {names[1]}] contains {names[2]}: the velocities along the "
                why += "first two, times the time, are one along the third."
                # said of the first velocity, which is what the others make of it
                units.require(key, along[i], expected / (found / along[i]), why)
    for each in spec.having_role("advected"):
        _demand_advected(units, each, along)


def _demand_advected(units: Units, each: Variable, along: dict[int, Unit]) -> None:
    """The rate of an advected quantity is what a velocity makes of it."""
    own, action = units.of(each), each.representation
    assert action is not None, each.name
    why = f"{each.name} changes by velocities times {each.name}."
    for place, matrix in enumerate(action.matrices):
        for (row, column), value in matrix.items():
            for unit in _of_constant(units, value):
                moved = along[place] * unit * own[column] * units.time
                units.require(_unit_key(each), own[row], moved, why)
    if action.name in ATTITUDES or each.turning or each.form == "quaternion":
        entries = units.names[each.name]
        fixed = own if each.form == "quaternion" else entries.entries[:: entries.shape[-1] + 1]
        for entry in fixed:
            units.require(_unit_key(each), entry, ONE, "An attitude is made of pure numbers.")


def _unit_key(each: Variable) -> KeyPath:
    """Where the unit of a variable stands, or would."""
    return ("variables", each.name, "unit") if each.unit else ("variables", each.name)


def _of_constant(units: Units, value: Any) -> Iterator[Unit]:
    """The unit of each addend of a structure constant, which may name parameters."""
    if not hasattr(value, "parts"):
        yield ONE
        return
    for quotient in value.parts:
        if quotient.powers:  # a divisor: its addends are not at hand
            return
        symbols = [str(symbol) for symbol in quotient.numer.ring.symbols]
        for exponents, _ in quotient.numer.terms():
            named = [(n, e) for n, e in zip(symbols, exponents, strict=True) if e]
            if all(name in units.names for name, _ in named):
                yield product_of((units.names[n].entries[0] or ONE, e) for n, e in named)


def _demand_partners(units: Units) -> None:
    """Velocities and momenta of coordinates."""
    for each in units.spec.variables:
        if not each.of:
            continue
        whole = next(v for v in units.spec.variables if v.name == each.of)
        for own, q in zip(units.of(each), units.of(whole), strict=True):
            if each.role == "velocity":
                why = f"It is the rate of {each.of}."
                units.require(_unit_key(each), own, q / units.time, why)
            else:
                why = f"Times the rate of {each.of}, a momentum is an energy."
                units.require(_unit_key(each), own, units.action / q, why)


def _demand_bracket(units: Units) -> None:
    """A declared bracket: {x, y} is x y over energy and time."""
    poisson = units.spec.poisson
    if poisson is None:
        return
    state = [(v, unit) for v in units.spec.state for unit in units.of(v)]
    for i, j, formula in poisson.entries:
        expected = _over((state[i][1], state[j][1]), (units.action,))
        units.equate(formula, (expected,), BRACKET)
    for i, j in poisson.pairs:
        expected = units.action / state[i][1]
        why = "A position times its momentum is an energy times a time."
        units.require(_unit_key(state[j][0]), state[j][1], expected, why)
    if poisson.functions:
        values = [units.value(each)[0] for each in poisson.functions]
        if all(values):
            expected = _over((unit for _, unit in state), (*filter(None, values), units.time))
            why = "Times the functions and the time, the energy is the product of the coordinates."
            units.require(("poisson", "nambu", 0), units.energy, expected, why)


def _demand_newton(units: Units) -> None:
    """Mass times acceleration is force."""
    for law in units.spec.newton:
        q = units.names[law.coordinate]
        square = units.time**2
        rate = Measured(q.shape, tuple(None if e is None else e / square for e in q.entries))
        mass = units.value(law.mass)
        if law.mass.shape == ():
            made = [None if e is None or mass[0] is None else e * mass[0] for e in rate.entries]
        else:
            made = _multiply(units, law.mass, Measured(law.mass.shape, mass), rate)
        why = "A force is a mass times an acceleration."
        units.equate(law.force, made, why)


def _multiply(units: Units, mass: Formula, matrix: Measured, rate: Measured) -> list[Entry]:
    """A matrix of masses times accelerations."""
    made: list[Entry] = []
    for row in matrix.rows():
        for column in zip(*rate.rows(), strict=True):
            both = zip(row, column, strict=True)
            terms = [m * a for m, a in both if m is not None and a is not None]
            for term in terms[1:]:
                what = "the terms of mass times acceleration have the units {expected} and {found}"
                units.require(mass.path, term, terms[0], what=what, wanted="terms of one unit")
            made.append(terms[0] if terms else None)
    return made


# -- what binds and drives ------------------------------------------------------------------------


def _demand_constraints(units: Units) -> None:
    """Both sides fit, and a multiplier times what is constrained is a power."""
    for each in (*units.spec.constraints, *units.spec.variational):
        left, right = units.value(each.left), units.value(each.right)
        what = "the left side has the unit {expected} and the right side {found}"
        length = max(len(left), len(right))  # a side that is 0 may stand for a vector
        sides = [side if len(side) == length else (None,) * length for side in (left, right)]
        for one, other in zip(*sides, strict=True):
            units.require(each.left.path, other, one, what=what, wanted="two sides of one unit")
        if each in units.spec.constraints:
            reactions = units.names[each.reaction].entries
            for one, other, reaction in zip(*sides, reactions, strict=True):
                residual = other if one is None else one
                if residual is not None:
                    expected = units.energy / units.time / residual
                    units.require(each.left.path, reaction, expected, _POWER)
    for condition in units.spec.domain:
        units.compare(condition.left, condition.right)


def _demand_driving(units: Units) -> None:
    """Forces, friction and rates of inputs."""
    spec = units.spec
    power = units.energy / units.time
    named = {each.name: each for each in spec.variables}
    for name, formula in spec.forces.items():
        along = named[name]
        own = units.of(along)
        if along.role == "velocity":
            expected, why = [power / unit for unit in own], _POWER
        else:
            expected = [unit / units.time for unit in own]
            why = f"It is added to the rate of {name}."
        if len(formula.shape) > 1:
            units.equate(formula, list(_spread(along, formula, expected)), why)
        else:
            units.equate(formula, expected, why)
    if spec.dissipation is not None:
        why = "Rayleigh's function is an energy over a time, and its derivative a force."
        units.equate(spec.dissipation, (power,), why)
    inputs = {each.name: each for each in spec.inputs}
    for each in spec.inputs:
        if each.rate:
            for unit, rate in zip(units.of(each), units.of(inputs[each.rate]), strict=True):
                why = f"It is the rate of {each.name}."
                units.require(("inputs", each.rate), rate, unit / units.time, why)


def _spread(along: Variable, formula: Formula, expected: Sequence[Unit]) -> Iterator[Entry]:
    """What is expected of the entries of a matrix, by the components that it keeps."""
    rows = formula.shape[0]
    kept = dict(zip(kept_places(rows, along.form), expected, strict=True))
    for i in range(rows):
        for j in range(rows):
            yield kept.get((i, j), kept.get((j, i)))


def _demand_relaxation(units: Units) -> None:
    """The matrix, and the entropy, of a symmetric bracket."""
    relaxation = units.spec.relaxation
    if relaxation is None:
        return
    x = [unit for each in units.spec.state for unit in units.of(each)]
    entropy = units.value(relaxation.S)[0] if relaxation.S is not None else None

    def expect(i: int, j: int) -> Unit:
        if relaxation.S is None:
            return units.action / (x[i] * x[j])
        return x[i] * x[j] / (units.time * (entropy or ONE))

    places = [(i, j) for i in range(len(x)) for j in range(len(x))]
    why = f"The rates have the terms {relaxation.added}."
    if relaxation.G.shape == ():
        (G,) = units.value(relaxation.G)
        for i in range(len(x)):
            units.require(relaxation.G.path, G, expect(i, i), why)
    else:
        units.equate(relaxation.G, [expect(i, j) for i, j in places], why)


def _demand_noise(units: Units) -> None:
    """A Wiener process is the square root of a time, and its Hamiltonian over that an energy."""
    for each in units.spec.noise:
        why = "Times its Wiener process, which is the square root of a time, it is an action."
        units.equate(each.formula, (units.action / units.time ** Fraction(1, 2),), why)


def _demand_lax(units: Units) -> None:
    """dL/dt = [L, M]: each term of an entry of the bracket is one of L over a time."""
    lax = units.spec.lax
    if lax is None:
        return
    names = {lax.spectral: Measured((), (unknown(lax.spectral),))}
    L, M = (Measured(each.shape, units.value(each, names)) for each in (lax.L, lax.M))
    why = "dL/dt = [L, M], entry by entry."
    for i, row in enumerate(L.rows()):
        for k, unit in enumerate(row):
            for j, factor in enumerate(M.rows()[k]):
                whole = L.rows()[i][j]
                if unit is not None and whole is not None:
                    units.require(lax.M.path, factor, whole / (units.time * unit), why)


def _demand_followed(units: Units) -> None:
    """What is reconstructed: its rate times the time; and how a body rolls."""
    spec = units.spec
    for each in spec.reconstruction:
        if each.rate is not None:
            expected = [unit / units.time for unit in units.of(each)]
            units.equate(each.rate, expected, f"It is the rate of {each.name}.")
        if each.attitude:
            for unit in units.of(each):
                why = "An attitude is made of pure numbers."
                units.require(("reconstruction", each.name), unit, ONE, why)
    if spec.rolling is not None:
        _demand_rolling(units, spec.rolling)


def _demand_contact(units: Units, contact: Contact, length: Unit) -> None:
    """Points of contact and radii are lengths, and a surface turns as a body does."""
    for name in filter(None, (contact.place, contact.point)):
        why = "A point of contact is a place."
        units.require(("variables", name), units.names[name].entries[0], length, why)
    if contact.radius is not None:
        units.equate(contact.radius, [length], "A radius is a length.")
    if contact.turning is not None:
        units.equate(contact.turning, [ONE / units.time] * 3, "It is an angular velocity.")
    for surface in filter(None, (contact.surface, contact.body)):
        units.value(surface)


def _demand_rolling(units: Units, rolling: Rolling) -> None:
    """The arm is a length, by which turning makes a velocity."""
    turning, velocity = (units.names[name] for name in (rolling.turning, rolling.velocity))
    length = (velocity.entries[0] or ONE) / (turning.entries[0] or ONE)
    why = f"{rolling.velocity} is {rolling.turning} times the arm."
    units.equate(rolling.arm, [length] * 3, why)
    if rolling.contact is not None:
        _demand_contact(units, rolling.contact, length)
    for each in units.spec.reconstruction:
        if each.of_rolling and not each.attitude:
            units.require(("rolling",), units.of(each)[0], length, why)
