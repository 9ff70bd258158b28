"""Emission: what a route from a Lagrangian over an algebra hands over beside its rates.

Comes in: the rates of the declared state. Goes out: the `Exact` part of
its Equations: velocities, energy, observables and the bracket, the same on every such route.
Read next: `coadjoint.derive.structure`.
"""

from __future__ import annotations

from coadjoint.derive.emitted import list_emitted
from coadjoint.derive.mechanics.legendre import LegendreTransform, legendre
from coadjoint.derive.records import Exact, Step, symbol
from coadjoint.derive.setting import Setting
from coadjoint.derive.structure import poisson_structure
from coadjoint.exact import Element


def emission(setting: Setting, rates: tuple[Element, ...]) -> Exact:
    """The equations in momenta, velocities as definitions."""
    transform = legendre(setting)
    seen = list_emitted(setting, transform.energy)
    tensor = poisson_structure(setting).tensor
    return Exact(transform.definitions, rates, transform.energy, seen, tensor, transform.solves)


def velocities_step(transform: LegendreTransform) -> Step:
    """The step that solves for the velocities."""
    return Step(
        "Legendre transform",
        "xi solved from mu = dl/dxi",
        r"\xi = \xi(\mu, a)",
        tuple((symbol(name), value) for name, value in transform.definitions),
    )
