"""Constraints imposed before the variation: that h is the one of the normal extremals.

Velocities and h are those of a route; nothing of how they came about is used.
Comes in: a motion in momenta. Goes out: claims for the certificate.
Read next: `coadjoint.derive.mechanics.variational`.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.variational import normal_extremals
from coadjoint.exact import Element
from coadjoint.exact.dense import dot
from coadjoint.prove.motion import Motion
from coadjoint.prove.zero import Examined


def about_extremals(motion: Motion) -> Iterator[Examined]:
    """The constraints hold, the action is stationary within them, and h is its Hamiltonian."""
    first = motion.equations
    names = ", ".join(each.name for each in normal_extremals(first.setting).equations)
    yield "xi = dh/dmu", "legendre", partial(_slopes, first)
    yield f"xi = dh/dmu keeps {names} at every state", "constraint", partial(_residuals, first)
    yield (
        f"<mu - dl/dxi, eta> = 0 at xi = dh/dmu along every direction eta that {names} leaves "
        "free: motions are normal extremals of the action within what is imposed before the "
        "variation, and strictly abnormal extremals do not come from h",
        "constraint",
        partial(_stationarity, first),
    )
    yield "h = <mu, xi> - l at xi = dh/dmu", "legendre", partial(_energy, first)


def _at(first: Equations, element: Element) -> Element:
    """A function of velocities and state, at ``xi = dh/dmu``."""
    return first.close(element)


def _slopes(first: Equations) -> list[Element]:
    setting, energy = first.setting, first.exact.energy
    assert energy is not None, "a Hamiltonian gave the motion"
    slopes = setting.field.gradient(first.close(energy), setting.momenta)
    parts = zip(setting.velocities, slopes, setting.weights, strict=True)
    return [_at(first, setting.field[name]) - slope * weight for name, slope, weight in parts]


def _momenta(first: Equations) -> list[Element]:
    """mu, as it pairs with velocities."""
    setting = first.setting
    pairs = zip(setting.momenta, setting.weights, strict=True)
    return [setting.field[name] * (1 / weight) for name, weight in pairs]


def _residuals(first: Equations) -> list[Element]:
    return [_at(first, each.residual) for each in normal_extremals(first.setting).equations]


def _stationarity(first: Equations) -> list[Element]:
    slopes = mechanics(first.setting).momenta
    rest = [mu - _at(first, slope) for mu, slope in zip(_momenta(first), slopes, strict=True)]
    columns = zip(*normal_extremals(first.setting).B, strict=True)
    return [dot(rest, column) for column in columns]


def _energy(first: Equations) -> list[Element]:
    setting, energy = first.setting, first.exact.energy
    assert energy is not None, "a Hamiltonian gave the motion"
    velocities = [_at(first, setting.field[name]) for name in setting.velocities]
    return [first.close(energy) - dot(_momenta(first), velocities) + _at(first, setting.lagrangian)]
