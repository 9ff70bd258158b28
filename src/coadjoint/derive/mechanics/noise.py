r"""Noise by Hamiltonians: the fields of Wiener processes, and what Ito's drift has in addition.

With the bracket of the state the motion is, in the sense of Stratonovich,

.. math:: dx = \{x, h\}\,dt + \sum_k \{x, h_k\} \circ dW_k

(Lazaro-Cami and Ortega 2008; Arnaudon, De Castro and Holm 2018). Stratonovich's calculus has the
chain rule, so that every function moves by :math:`dF = \{F, h\}\,dt + \{F, h_k\} \circ dW_k`. In
the sense of Ito the drift has in addition

.. math:: \frac12 \sum_k \frac{\partial g_k}{\partial x}\, g_k, \qquad g_k = \{x, h_k\}.

Comes in: Equations of the motion without noise, which are the drift. Goes out: the fields g_k, and
Equations that show them. Read next: `coadjoint.prove.noise`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

from coadjoint.derive.equations import Equations
from coadjoint.derive.records import Left, symbol, write_step
from coadjoint.derive.setting import Setting, fault, once
from coadjoint.derive.structure import has_structure, poisson_structure
from coadjoint.exact import Element
from coadjoint.exact.dense import apply, dot
from coadjoint.notation.elements import write_element
from coadjoint.notation.functions import write_noise, write_sum
from coadjoint.notation.names import differential
from coadjoint.notation.written import (
    Written,
    add,
    attach,
    enclose,
    multiply,
    negate,
    number,
)


@dataclass(frozen=True)
class NoiseField:
    """What a Wiener process moves.

    Attributes:
        name: Of the process.
        hamiltonian: Its Hamiltonian.
        field: ``{x, h_k}`` of each component of the state.
    """

    name: str
    hamiltonian: Element
    field: tuple[Element, ...]


@once
def noise_fields(setting: Setting) -> tuple[NoiseField, ...]:
    """The field of each Wiener process, by the bracket of the state.

    Raises:
        DerivationError: The state has no bracket.
    """
    noise = setting.spec.noise
    if noise and not has_structure(setting):
        message = "[noise] acts by a Poisson bracket, and the state has none. Declare momenta."
        raise fault(setting, noise[0].formula, message, noise[0].name)
    fields = []
    for each in noise:
        h, ring = setting.formula(each.formula), setting.field
        slopes = ring.gradient(h, setting.state)
        moved = ring.vector(apply(poisson_structure(setting).tensor, slopes))
        fields.append(NoiseField(each.name, h, moved))
    return tuple(fields)


def ito_drift(setting: Setting) -> tuple[Element, ...]:
    """What the drift has in the sense of Ito in addition: ``1/2 sum_k Dg_k g_k``."""
    ring, half = setting.field, Fraction(1, 2)
    return tuple(
        ring.sum(
            dot(ring.gradient(each.field[i], setting.state), each.field) * half
            for each in noise_fields(setting)
        )
        for i in range(len(setting.state))
    )


def show_noise(drift: Equations) -> Equations:
    """Equations with the steps that give the noise; unchanged without any.

    The rates stay those of Stratonovich's drift.
    """
    setting, fields = drift.setting, noise_fields(drift.setting)
    if not fields or drift.chart is not None:
        return drift
    hamiltonians = write_step(
        "Noise: a Hamiltonian for each Wiener process, in the sense of Stratonovich",
        "dx = {x, h} dt + sum_k {x, h_k} o dW_k",
        r"dx = \{x, h\}\,dt + \sum_k \{x, h_k\} \circ dW_k",
        (
            *((_hamiltonian_of(each), each.hamiltonian) for each in fields),
            *(line for each in fields for line in _show_field(setting, each)),
        ),
        by="noise",
    )
    added = zip(setting.state, ito_drift(setting), strict=True)
    ito = write_step(
        "What the drift has in the sense of Ito in addition",
        "1/2 sum_k (dg_k/dx) g_k with g_k = {x, h_k}",
        r"\frac{1}{2} \sum_k \frac{\partial g_k}{\partial x} g_k, \quad g_k = \{x, h_k\}",
        ((_ito_of(name), value) for name, value in added),
        by="ito",
    )
    return replace(drift, steps=(*drift.steps, hamiltonians, ito))


def _show_field(setting: Setting, each: NoiseField) -> Iterator[tuple[Left, Element]]:
    """Lines for the components of a field: ``{Pi1, h_dW1}``."""
    for name, value in zip(setting.state, each.field, strict=True):
        yield enclose([symbol(name), _hamiltonian_of(each)], "{}"), value


def _hamiltonian_of(each: NoiseField) -> Left:
    """The Hamiltonian of a process: ``h_dW1``."""
    return replace(attach(symbol("h"), below=[symbol(each.name)]), text=f"h_{each.name}")


def _ito_of(name: str) -> Left:
    """What the drift of a component has in addition: ``1/2 sum(k, {{Pi1, h_k}, h_k})``."""
    h = replace(attach(symbol("h"), below=[symbol("k")]), text="h_k")
    twice = enclose([enclose([symbol(name), h], "{}"), h], "{}")
    return multiply([number(Fraction(1, 2)), write_sum(("k",), [twice], "")])


def write_moves(setting: Setting, name: str, rate: Element) -> tuple[Left, Written]:
    """The equation of a component with its noise: ``dPi1 = rate dt + field o dW1``."""
    ring, place = setting.field, setting.state.index(name)
    parts = [multiply([write_element(ring, rate), symbol("dt")])] if rate else []
    for each in noise_fields(setting):
        process, moved = symbol(each.name), each.field[place]
        plain, turned = write_element(ring, moved), write_element(ring, -moved)
        if len(turned.text) < len(plain.text):  # one minus before it, and no brackets
            parts.append(negate(write_noise(turned, process)))
        elif moved:
            parts.append(write_noise(plain, process))
    return differential(symbol(name)), add(parts)
