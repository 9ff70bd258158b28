r"""The Lax route: from a declared pair of matrices with a spectral parameter.

Theorem (Lax 1968; Holm 2011, section 2.4.4): if :math:`\dot L = [L, M]` for every value of
:math:`\lambda`, the motion of L is isospectral, :math:`L(t) = g^{-1} L(0)\, g` with :math:`\dot g =
g M`. Fields have a pair of zero curvature, :math:`L_t - M_s = [L, M]`, which says that
:math:`\psi_s = \psi L` and :math:`\psi_t = \psi M` are compatible: the conjugacy class of the
monodromy of L around the circle stays what it is (Zakharov and Mikhailov 1978). Each entry of each
power of :math:`\lambda` is one linear equation in the rates of the state.
Comes in: a Setting with the table [lax], and an energy that gives the velocities if M names any.
Goes out: Equations by the pair. Read next: `coadjoint.prove.lax`, where all of its equations must
hold.
"""

from __future__ import annotations

from dataclasses import replace

from coadjoint.derive.equations import Equations
from coadjoint.derive.fields.emission import close_jets, emit_fields
from coadjoint.derive.fields.hamiltonian import density
from coadjoint.derive.integrals import lax_integrals
from coadjoint.derive.mechanics.emission import emit
from coadjoint.derive.mechanics.legendre import hamiltonian
from coadjoint.derive.pairs import LaxPair, declared_pair, rates_of, symbols
from coadjoint.derive.records import Step, write_rates, write_step
from coadjoint.derive.routes.poisson import velocities_of
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element

__all__ = ["derive", "equations_of_pair", "symbols"]

ROUTE = "lax"


def derive(setting: Setting) -> Equations:
    """Equations of motion by the declared pair.

    Raises:
        DerivationError: The pair does not determine the rates of the state.
    """
    return equations_of_pair(setting, ROUTE, declared_pair(setting))


def equations_of_pair(
    setting: Setting, route: str, pair: LaxPair, search: tuple[Step, ...] = ()
) -> Equations:
    """Equations by a pair; the energy gives nothing but the velocities that M names.

    Args:
        setting: The spec and the field.
        route: Name of the route.
        pair: Declared or found.
        search: How it was found.
    """
    h, solves = hamiltonian(setting) if setting.has_energy else (None, ())
    definitions = () if h is None else velocities_of(setting, h, solves)
    if setting.spec.space is not None:
        M = tuple(tuple(close_jets(setting, x) for x in row) for row in pair.M)
        pair = replace(pair, M=M)
        return _derive_fields(setting, route, pair, rates_of(setting, pair, route))
    rates = rates_of(setting, pair, route)
    steps = (*search, *_steps(setting, pair, definitions, rates))
    return replace(emit(setting, route, rates, steps, h, definitions, solves), pair=pair)


def _derive_fields(
    setting: Setting, route: str, pair: LaxPair, rates: tuple[Element, ...]
) -> Equations:
    """The equations of fields, whose pair is a connection of zero curvature."""
    steps = (
        write_step("Lax pair", "L, M", "L(\\lambda), M(\\lambda)", _entries(pair), by="lax"),
        write_step(
            "Zero curvature, power by power",
            f"dL/dt - dM/ds = L M - M L for every {pair.spectral}",
            r"\partial_t L - \partial_s M = L M - M L",
            write_rates(setting.state, rates),
            by="zero-curvature",
        ),
    )
    energy = density(setting) if setting.has_energy else None
    return replace(emit_fields(setting, route, rates, steps, energy), pair=pair)


def _steps(
    setting: Setting,
    pair: LaxPair,
    definitions: tuple[tuple[str, Element], ...],
    rates: tuple[Element, ...],
) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    texts = f"L = {pair.texts[0]},  M = {pair.texts[1]}"
    law = ("xi = dh/dmu", r"\xi = \partial h / \partial \mu")
    velocities = write_step("Velocities", *law, definitions, by="hamilton")
    return (
        *([velocities] if setting.has_energy else []),
        write_step("Lax pair", texts, "L(\\lambda), M(\\lambda)", _entries(pair), by="lax"),
        write_step(
            "Lax equation, power by power",
            f"dL/dt = L M - M L for every {pair.spectral}",
            r"\dot L = L M - M L",
            write_rates(setting.state, rates),
            by="lax",
        ),
        _integrals(setting),
    )


def _entries(pair: LaxPair) -> dict[str, Element]:
    """The entries of L and of M that are not zero."""
    return {
        f"{name}_{i}_{j}" if len(matrix) > 9 else f"{name}_{i}{j}": entry
        for name, matrix in (("L", pair.L), ("M", pair.M))
        for i, row in enumerate(matrix, 1)
        for j, entry in enumerate(row, 1)
        if entry != 0
    }


def _integrals(setting: Setting) -> Step:
    """The integrals that are emitted."""
    integrals = lax_integrals(setting)
    assert integrals is not None, "there is a pair"
    words = ", ".join(
        f"integral{n} from tr L^{each.trace} at {integrals.pair.spectral}^{each.power}"
        for n, each in enumerate(integrals.emitted, 1)
    )
    known = ["the energy"] * setting.has_energy
    known += ["the claimed Casimirs"] * bool(known or setting.spec.casimirs)
    return write_step(
        f"Integrals{' in addition to ' * bool(known)}{' and '.join(known)}",
        f"coefficients of tr L^k: {words or 'none'}",
        r"\mathrm{tr}\, L^k = \mathrm{const}",
        integrals.named,
        by="trace-integrals",
    )
