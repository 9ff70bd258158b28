"""Emission: the Equations of a route in the declared state, with all that is emitted with them.

Comes in: the rates of the declared state, and the energy with what gives the velocities in it.
Goes out: Equations with observables and the bracket; and the steps that routes from a Lagrangian
over an algebra have in common. Read next: `coadjoint.derive.structure`.
"""

from __future__ import annotations

from collections.abc import Sequence

from coadjoint.derive.emitted import list_emitted
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.configuration import Matrix, mechanics
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.mechanics.solver import Definition, Solve
from coadjoint.derive.records import Exact, Step, write_slopes, write_step
from coadjoint.derive.setting import Setting
from coadjoint.derive.structure import has_structure, poisson_structure
from coadjoint.exact import Element

Rates = tuple[Element, ...]


def emit(
    setting: Setting,
    route: str,
    rates: Rates,
    steps: Sequence[Step],
    energy: Element | None,
    definitions: Sequence[Definition] = (),
    solves: tuple[Solve, ...] = (),
    forces: Rates = (),
    tensor: Matrix | None = None,
) -> Equations:
    """The Equations of a route that moves the declared state.

    Args:
        setting: The spec and its field.
        route: Name of the route.
        rates: In the order of the state.
        steps: The derivation.
        energy: The energy, if the route or the spec knows one.
        definitions: Velocities that rates and energy name.
        solves: What the kernel solves for these.
        forces: What forces add to the rates, of a route that puts them in itself.
        tensor: The bracket that the route found; by default that of the spec.
    """
    if tensor is None and has_structure(setting):
        tensor = poisson_structure(setting).tensor
    emitted = list_emitted(setting, energy, _momenta_in_frame(setting))
    exact = Exact(
        definitions=tuple(definitions),
        rates=rates,
        energy=energy,
        emitted=emitted,
        poisson_tensor=tensor,
        solves=solves,
        forces=forces,
    )
    return Equations(setting=setting, route=route, exact=exact, steps=tuple(steps))


def _momenta_in_frame(setting: Setting) -> list[tuple[str, Element]]:
    """``dl/dv`` by the names that a route in a frame emits; empty where it emits none."""
    names = [name for each in setting.spec.reduced_momenta for name in each.components]
    return list(zip(names, mechanics(setting).momenta, strict=True)) if names else []


def emit_in_momenta(setting: Setting, route: str, rates: Rates, steps: Sequence[Step]) -> Equations:
    """The Equations of a Lagrangian with momenta as the state, and velocities as definitions."""
    known = legendre(setting)
    return emit(setting, route, rates, steps, known.energy, known.definitions, known.solves)


def show_momenta(setting: Setting, title: str = "Momenta") -> Step:
    """The step that gives the momenta."""
    names = [xi for xi, _, _ in setting.conjugates]
    lines = write_slopes("l", names, legendre(setting).momenta)
    return write_step(
        title, "mu = dl/dxi", r"\mu = \partial l / \partial \xi", lines, by="legendre"
    )


def show_velocities(setting: Setting) -> Step:
    """The step that solves for the velocities."""
    lines, how = legendre(setting).definitions, legendre(setting).iterations
    law = f"xi solved from mu = dl/dxi{how}"
    latex = "" if how else r"\xi = \xi(\mu, a)"
    return write_step("Legendre transform", law, latex, lines, by="legendre")
