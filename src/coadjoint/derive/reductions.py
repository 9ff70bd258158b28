r"""Restricted motions: any route on a whole system, restricted to a section that the motion keeps.

If the motion :math:`\dot x = X(x, y), \dot y = Y(x, y)` keeps the submanifold :math:`y = s(x)`,
that is :math:`Ds(x)\, X(x, s(x)) = Y(x, s(x))`, then on it :math:`\dot x = X(x, s(x))`.
Forces and dissipation act on the whole system, and must keep it on the section as well.
Comes in: a Setting of what is left, and a route. Goes out: Equations of what is left, derived by
that route for the whole system in a field of its own. What must hold for it is proved in
`coadjoint.prove.reductions`.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

from coadjoint.derive.emitted import list_emitted
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics import external
from coadjoint.derive.pairs import declared_pair
from coadjoint.derive.records import Exact, Step, write_rates, write_step
from coadjoint.derive.refusals import refusal
from coadjoint.derive.registry import load_route, make_setting
from coadjoint.derive.section_brackets import describe_bracket, induced_bracket
from coadjoint.derive.setting import Setting, fault
from coadjoint.derive.submanifold import put_on_section, section_of
from coadjoint.errors import DerivationError
from coadjoint.exact import Element


class Restriction:
    """A whole system on the section, in the field of what is left; y keeps its name there.

    Args:
        setting: Of what is left.
        whole: The equations of the whole system.
    """

    def __init__(self, setting: Setting, whole: Equations) -> None:
        assert setting.spec.reduction is not None, f"{setting.spec.name} is not restricted"
        self.setting, self.whole, self.section = setting, whole, section_of(setting)

    def __call__(self, function: Element) -> Element:
        """A function of the whole state."""
        field, own = self.setting.field, self.whole.setting
        values = {name: field[name] for name in (*own.state, *own.parameters, *own.driving)}
        return own.field.evaluate(self.whole.close(function), values, field.number, field.call)

    def on_section(self, function: Element) -> Element:
        """A function of the whole state with the section in the place of y."""
        return self.setting.field.normal(put_on_section(self.setting, self(function)))

    @cached_property
    def rates(self) -> dict[str, Element]:
        """Rates of the whole state, by name."""
        pairs = zip(self.whole.setting.state, self.whole.exact.rates, strict=True)
        return {name: self(value) for name, value in pairs}

    @cached_property
    def velocities(self) -> dict[str, Element]:
        """Velocities of the whole system, by name."""
        named = {x for v in self.whole.spec.defined for x in v.components}
        own = self.whole.exact.definitions
        return {name: self(value) for name, value in own if name in named}


def section_defects(restriction: Restriction) -> list[Element]:
    """``Ds . X - Y``, component by component; y keeps its name, and is replaced at the end."""
    setting, rates = restriction.setting, restriction.rates
    field, names = setting.field, setting.state
    moved = [
        field.sum(s * rates[x] for s, x in zip(field.gradient(value, names), names, strict=True))
        - rates[name]
        for name, value in restriction.section.items()
    ]
    return [put_on_section(setting, defect) for defect in moved]


def is_kept(restriction: Restriction) -> bool:
    """Whether the normal form shows that the motion keeps the section."""
    return all(map(restriction.setting.field.is_zero, section_defects(restriction)))


def restrict(setting: Setting, route: str) -> Equations:
    """The equations of what is left, by a route for the whole system.

    Raises:
        DerivationError: The route cannot be followed, or moves in variables of its own.
    """
    restriction = Restriction(setting, whole_equations(setting, route))
    whole, rates = restriction.whole, restriction.rates
    assert whole.exact.energy is not None, "the reader asks for a Hamiltonian"
    energy = restriction(whole.exact.energy)
    _check_regular(restriction, energy)
    kept = tuple(rates[name] for name in setting.state)
    induced = induced_bracket(restriction) if is_kept(restriction) else None
    if induced is None and setting.spec.brackets:
        raise _refuse_brackets(setting)
    defined = (*restriction.section.items(), *restriction.velocities.items())
    exact = Exact(
        definitions=defined,
        rates=kept,
        energy=energy,
        emitted=list_emitted(setting, energy),
        poisson_tensor=None if induced is None else induced.tensor,
        forces=() if induced is None else induced.forces,
    )
    return Equations(
        setting=setting,
        route=whole.route,
        exact=exact,
        steps=(*_steps(restriction, energy, kept), describe_bracket(setting, induced)),
        pair=declared_pair(setting) if _takes_pair(setting, route) else None,
    )


def _takes_pair(setting: Setting, route: str) -> bool:
    """Whether a Lax pair is proved on a route: on its own, and without that on the first one."""
    routes = setting.spec.routes
    own = "lax" if "lax" in routes else routes[0]
    return setting.spec.lax is not None and route == own


def _refuse_brackets(setting: Setting) -> DerivationError:
    """Brackets are claimed, and the section has none."""
    claim = setting.spec.brackets[0]
    message = (
        "the section has no bracket of its own: a function with the same values on it whose "
        "Hamiltonian flow keeps the section does not exist for each of its coordinates; expected "
        "claims of integrals. Claim the bracket in a spec of the whole system."
    )
    return fault(setting, claim.value, message, claim.value.text)


def _check_regular(restriction: Restriction, energy: Element) -> None:
    """The section does not lie where the motion of the whole system has a pole."""
    field = restriction.setting.field
    values = {f"the rate of {name}": value for name, value in restriction.rates.items()}
    values |= {f"the velocity {name}": value for name, value in restriction.velocities.items()}
    for what, value in {"the energy": energy, **values}.items():
        try:
            field.substitute(value, restriction.section)
        except ZeroDivisionError as error:
            formula = restriction.setting.spec.hamiltonian
            assert formula is not None, "the reader asks for a Hamiltonian"
            message = (
                f"{what} has a pole everywhere on the section; expected a section on which the "
                "motion of the whole system is defined. Correct [reduction], or the Hamiltonian."
            )
            raise fault(restriction.setting, formula, message, what) from error


def whole_equations(setting: Setting, route: str) -> Equations:
    """The equations of the system before the restriction, in a field of its own."""
    reduction = setting.spec.reduction
    assert reduction is not None, f"{setting.spec.name} is not restricted"
    whole = external.add_forces(load_route(route)(make_setting(reduction.whole)))
    if whole.chart is not None:
        raise refusal(
            setting,
            whole.route,
            "it moves in variables of its own, and the section is one over the state",
            whole.route,
            "a route on the declared state, such as lie-poisson",
        )
    return whole


def _steps(
    restriction: Restriction, energy: Element, rates: tuple[Element, ...]
) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    setting, route = restriction.setting, restriction.whole.route
    return (
        write_step(
            f"Motion of the whole system by the route {route}",
            "dx/dt = X(x, y),  dy/dt = Y(x, y)",
            r"\dot x = X(x, y), \quad \dot y = Y(x, y)",
            write_rates(tuple(restriction.rates), restriction.rates.values()),
            by=route,
        ),
        write_step(
            "Section that it keeps", "y = s(x)", lines=restriction.section, by="invariant-section"
        ),
        write_step("Hamiltonian on it", "h(x, y)", lines={"h": energy}, by="hamilton"),
        *_of_velocities(restriction),
        write_step(
            "Motion on it",
            "dx/dt = X(x, y)",
            r"\dot x = X(x, y)",
            write_rates(setting.state, rates),
            by="invariant-section",
        ),
    )


def _of_velocities(restriction: Restriction) -> Iterator[Step]:
    """The velocities that the spec names, on the section."""
    if restriction.velocities:
        yield write_step(
            "Velocities on it", "v(x, y)", lines=restriction.velocities, by="invariant-section"
        )
