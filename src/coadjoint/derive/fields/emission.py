"""Emission: the Equations of fields, in their jets alone.

Comes in: rates of the fields, and the density of the energy. Goes out: Equations with densities in
the place of observables; what kernels give of these is their integral over the circle.
Read next: `coadjoint.derive.fields.grid`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from coadjoint.derive.emitted import declared_observables, emitted_energy
from coadjoint.derive.equations import Equations
from coadjoint.derive.fields.jets import jets_of, list_rows, solved
from coadjoint.derive.fields.operators import Operator
from coadjoint.derive.fields.symbol import look_at_symbol
from coadjoint.derive.interpret import Value
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.records import Emitted, Exact, Step
from coadjoint.derive.setting import Setting, fault, once
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.spec import Formula


def emit_fields(
    setting: Setting,
    route: str,
    rates: Sequence[Element],
    steps: Sequence[Step],
    energy: Element | None,
    operator: Operator | None = None,
) -> Equations:
    """The Equations of a route that moves fields.

    Args:
        setting: The spec and its field.
        route: Name of the route.
        rates: In the order of the state, in jets.
        steps: The derivation.
        energy: The density of the energy, if the route or the spec knows one.
        operator: The bracket by which the route goes, if it does.

    Raises:
        DerivationError: Short waves grow the faster the shorter they are.
    """
    if route == setting.spec.routes[0]:
        _check_posed(setting, rates)
    own = () if energy is None else (emitted_energy(setting, energy),)
    exact = Exact(
        definitions=(),
        rates=tuple(rates),
        energy=energy,
        emitted=(*own, *_list_observables(setting)),
        poisson_tensor=None,
    )
    return Equations(
        setting=setting, route=route, exact=exact, steps=tuple(steps), operator=operator
    )


def _list_observables(setting: Setting) -> tuple[Emitted, ...]:
    """The declared observables, in jets alone."""
    return tuple(
        replace(each, values=tuple(close_jets(setting, x) for x in each.values))
        for each in declared_observables(setting)
    )


def read_density(
    setting: Setting, formula: Formula, known: Mapping[str, Value]
) -> tuple[Element, ...]:
    """The components of what a spec claims, in jets alone; arguments as in `Setting.value`."""
    return tuple(close_jets(setting, x) for x in setting.components(formula, known))


def close_jets(setting: Setting, element: Element) -> Element:
    """An element in which ``dh/dmu`` stands for velocities, and its derivatives for theirs.

    Without this a velocity is a constant to every derivative, and so would be conserved.
    """
    from coadjoint.derive.fields import circle, hamiltonian  # which emit

    spec, field, jets = setting.spec, setting.field, jets_of(setting)
    reached, space, values = field.reach(element), spec.space, dict[str, Element]()
    assert space is not None, spec.name
    pairs = [(xi, mu) for xi, mu, _ in setting.conjugates]
    if spec.diffeomorphisms is not None:
        pairs = [(v.name, setting.state[0]) for v in spec.having_role("velocity")]
    for xi, mu in pairs:
        rows = list_rows(xi, space.coordinates, space.derivatives)
        places = {x: (i, j) for j, row in enumerate(rows) for i, x in enumerate(row)}
        if xi not in solved(spec) and (named := reached & places.keys()):
            value = circle.vary(setting, hamiltonian.density(setting), mu)
            values |= {symbol: jets.total(value, *places[symbol]) for symbol in named}
    return field.substitute(element, values)


def _check_posed(setting: Setting, rates: Sequence[Element]) -> None:
    """The motion depends on its beginning continuously.

    Raises:
        DerivationError: It does not, at the defaults of the parameters.
    """
    growth = look_at_symbol(setting, jets_of(setting), rates).growth
    if growth is None:
        return
    spec = setting.spec
    formula = spec.lagrangian or spec.hamiltonian
    where = ", ".join(f"{name} = {value}" for name, value in growth.point.items())
    where = f"at {where}" if where else "about any fields"
    message = (
        f"the equations of the fields are ill posed: {growth.told}, {where}; expected "
        "real frequencies of short waves. Change the sign of the energy of the strains or "
        "derivatives."
    )
    if formula is None:  # a Lax pair alone
        raise DerivationError(f"{spec.path}: {message}", found=growth.point)
    raise fault(setting, formula, message, formula.text)


@once
def velocities(setting: Setting) -> Mapping[str, Element]:
    """The velocities in momenta and strains, by name.

    Raises:
        DerivationError: A derivative stands in the Lagrangian, or velocities have no closed form.
    """
    formula, field = setting.spec.lagrangian, setting.field
    assert formula is not None, "the reader asks for a Lagrangian on this route"
    named = {name for each in setting.spec.jets for name in each.components}
    found = sorted(field.reach(setting.lagrangian) & named)
    if found:
        message = (
            f"the Lagrangian names the derivative {found[0]}; expected velocities, strains and "
            "advected quantities alone. Give [hamiltonian] and the route lie-poisson instead."
        )
        raise fault(setting, formula, message, found[0])
    transform = legendre(setting)
    names = [xi for xi, _, _ in setting.conjugates]
    closed = dict(zip(names, transform.velocities, strict=True))
    unsolved = [name for name, value in closed.items() if field.reach(value) & closed.keys()]
    if unsolved:
        message = (
            f"the velocities {', '.join(unsolved)} have no closed form; expected a "
            "Lagrangian that is quadratic in them and couples at most three. Give [hamiltonian] "
            "and the route lie-poisson instead."
        )
        raise fault(setting, formula, message, formula.text)
    return closed


def close(setting: Setting, element: Element) -> Element:
    """An element with the velocities substituted: in jets and parameters alone."""
    return setting.field.substitute(element, velocities(setting))


def strand_terms(setting: Setting) -> dict[str, Element]:
    """What derivatives along space add to the rates of a strand, by the names of fields.

    ``d/ds xi`` for strains, and ``-d/ds (dl/dXi)`` for their momenta.
    """
    jets, added = jets_of(setting), dict[str, Element]()
    for each in (each for each in setting.advected if each.strain):
        slopes = setting.field.gradient(setting.lagrangian, each.components)
        triples = zip(setting.momenta, setting.velocities, each.components, slopes, strict=True)
        for mu, xi, strain, slope in triples:
            added[strain] = jets.total(close(setting, setting.field[xi]))
            added[mu] = -jets.total(close(setting, slope))
    return added
