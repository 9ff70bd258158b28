r"""Dissipation by a symmetric bracket: what makes it one, and what it does.

With the Poisson bracket P and a symmetric, positive semidefinite G the double bracket

.. math:: \dot x = P\,\partial h + P G P\,\partial h, \qquad
    \dot h = -(P\,\partial h) \cdot G (P\,\partial h) \le 0

keeps every Casimir (Bloch, Krishnaprasad, Marsden and Ratiu 1996), and the metriplectic motion

.. math:: \dot x = P\,\partial h + G\,\partial S, \qquad P\,\partial S = 0, \quad G\,\partial h = 0,
    \qquad \dot S = \partial S \cdot G\,\partial S \ge 0

keeps the energy (Morrison 1986). Comes in: Equations whose spec declares one. Goes out: each of
these conditions as a claim. Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.domain import region
from coadjoint.derive.mechanics.external import added_rates, metric, own_rates
from coadjoint.derive.mechanics.relaxed import relaxed
from coadjoint.derive.reductions import whole_equations
from coadjoint.exact import Element
from coadjoint.exact.dense import apply, dot
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.driven import has_moving_momenta
from coadjoint.prove.equivalence import in_velocities
from coadjoint.prove.identities import Tensor, casimir_defects, drift, gradient
from coadjoint.prove.semidefinite import decide_semidefinite
from coadjoint.prove.zero import Examined, UndecidedError, mark_claimed


def about_relaxation(
    first: Equations, others: Sequence[Element] | None = None
) -> Iterator[Examined]:
    """The conditions, and the balance of the entropy; that of the energy is told of all motions.

    Args:
        first: With their bracket in the state.
        others: What is added to the rates besides; by default the forces and what time adds.
    """
    spec, relaxation = first.spec, first.spec.relaxation
    energy, tensor = first.exact.energy, first.exact.poisson_tensor
    if relaxation is None or energy is None or tensor is None or spec.reduction is not None:
        return  # on a section it acts on the whole system, of which the conditions are told
    known = _Relaxed(first, energy, tensor, others)
    grows = ": the entropy never falls" if is_dissipative(first) else ""
    claims: list[Examined] = [
        ("G is symmetric", "dissipation", known.asymmetry),
        (
            "G is positive semidefinite",
            "dissipation",
            lambda: decide_semidefinite(known.G, known.field),
        ),
    ]
    if relaxation.S is not None:
        entropy = first.setting.formula(relaxation.S)
        claims += [
            ("P dS = 0: S is a Casimir", "dissipation", partial(casimir_defects, first, entropy)),
            ("G dh = 0", "dissipation", known.on_energy),
        ]
        if not any(known.others):
            claims.append((f"dS/dt = <dS, G dS>{grows}", "conserved", known.entropy))
    terms = f"{{x, h}} + {relaxation.added}{' + the forces' * spec.is_forced}"
    terms += " + dx/dt at fixed momenta" * has_moving_momenta(first)
    claims.append((f"the rates are {terms}", "dissipation", known.list_added))
    yield from mark_claimed(spec, (relaxation.table,), relaxation.G, claims, first.setting.field)


def derive_whole(first: Equations) -> Equations:
    """The equations of the whole system of a restricted motion."""
    whole = whole_equations(first.setting, first.route)
    whole.setting.field.region = region(whole)
    return whole


def is_dissipative(first: Equations) -> bool:
    """Whether G is proved positive semidefinite, so that what it does has a sign."""
    if first.spec.reduction is not None:  # G acts on the whole system
        first = derive_whole(first)
    if first.spec.relaxation is None or first.exact.energy is None:
        return False
    with suppress(UndecidedError):
        G = metric(first.setting)
        if first.distribution is None:  # else it is a function of the state alone
            G = tuple(tuple(in_velocities(first, row)) for row in G)
        return decide_semidefinite(G, first.setting.field).verdict is Verdict.PROVED
    return False


def lost(first: Equations, energy: Element) -> Element:
    """What a double bracket adds to the rate of the energy: ``-<P dh, G P dh>``; 0 without one.

    Along a frame ``P dh`` is what the kernel computes, and the rest of the law checks it.
    """
    relaxation, tensor = first.spec.relaxation, first.exact.poisson_tensor
    if relaxation is None or relaxation.S is not None or tensor is None:
        return first.setting.field.zero
    along = relaxed(first.setting)
    if along is not None:
        rates = [value for _, value in along.definitions]
        return -dot(rates, apply(metric(first.setting), rates))
    return _Relaxed(first, energy, tensor).power()


class _Relaxed:
    """G and what it acts on, by the bracket and the derivatives of the energy."""

    def __init__(
        self,
        first: Equations,
        energy: Element,
        tensor: Tensor,
        others: Sequence[Element] | None = None,
    ) -> None:
        self.first, self.field = first, first.setting.field
        if others is None:
            pairs = zip(added_rates(first.setting), own_rates(first.setting), strict=True)
            others = [force + own for force, own in pairs]
        self.others = in_velocities(first, others)
        self.G = tuple(tuple(in_velocities(first, row)) for row in metric(first.setting))
        self._P = [in_velocities(first, row) for row in tensor]
        self._dh = gradient(first, energy)
        self._free = apply(self._P, self._dh)
        self._energy = energy

    def asymmetry(self) -> list[Element]:
        """``G_ij - G_ji``."""
        size = range(len(self.G))
        return [self.G[i][j] - self.G[j][i] for i in size for j in range(i)]

    def on_energy(self) -> tuple[Element, ...]:
        """``G dh``."""
        return apply(self.G, self._dh)

    def entropy(self) -> list[Element]:
        """``dS/dt - <dS, G dS>``."""
        relaxation = self.first.spec.relaxation
        assert relaxation is not None
        assert relaxation.S is not None
        S = self.first.setting.formula(relaxation.S)
        slopes = gradient(self.first, S)
        gained = dot(slopes, apply(self.G, slopes))
        return [rate - gained for rate in drift(self.first, S)]

    def list_added(self) -> list[Element]:
        """The rates minus ``P dh``, the forces and what G adds."""
        relaxation = self.first.spec.relaxation
        assert relaxation is not None
        if relaxation.S is None:
            expected = apply(self._P, apply(self.G, self._free))
        else:
            S = self.first.setting.formula(relaxation.S)
            expected = apply(self.G, gradient(self.first, S))
        rates = in_velocities(self.first, self.first.exact.rates)
        parts = zip(rates, self._free, self.others, expected, strict=True)
        return [rate - free - force - own for rate, free, force, own in parts]

    def power(self) -> Element:
        """What the double bracket takes from the energy."""
        return -dot(self._free, apply(self.G, self._free))
