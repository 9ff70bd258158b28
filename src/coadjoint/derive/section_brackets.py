r"""The bracket that a section has of its own: restricted, or Dirac's.

With the functions :math:`\varphi_a = y_a - s_a(x)` that vanish on the section, let
:math:`C_{ab} = \{\varphi_a, \varphi_b\}` there. If functions :math:`X_i = x_i - W_{ai}
\varphi_a` exist with :math:`\{\varphi_a, X_i\} = 0` on the section, that is
:math:`C_{ab} W_{bi} = \{\varphi_a, x_i\}`, their Hamiltonian flows keep it, and

.. math:: \{x_i, x_j\}_s = \{X_i, X_j\} = \{x_i, x_j\} - \{x_i, \varphi_a\} W_{aj}

is a Poisson bracket on it, the same for every such W. Where C is invertible this is the bracket of
Dirac (Canadian Journal of Mathematics 2 (1950) 129); where all :math:`\{\varphi_a, x_i\}` vanish
the section is a Poisson submanifold. Otherwise it is a Poisson-Dirac submanifold (Crainic and
Fernandes, Journal of Differential Geometry 66 (2004) 71), or has no bracket, as level sets of the
energy.
A motion :math:`X_h + F` that keeps the section is :math:`\{x, h\}_s` and
:math:`F_i - \{x_i, \varphi_a\} U_a` with :math:`C U = F \varphi`.
Comes in: the whole system on the section. Goes out: the bracket, or None.
Read next: `coadjoint.prove.reductions`, which proves what X_i has to satisfy.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from coadjoint.derive.equations import Equations
from coadjoint.derive.records import Step, bracket, write_step
from coadjoint.derive.setting import Setting
from coadjoint.derive.submanifold import section_of
from coadjoint.exact import Element
from coadjoint.exact.dense import Matrix
from coadjoint.exact.linear import Span

#: Coefficients of the functions that vanish on the section, by the names of y.
Shift = Mapping[str, Element]


class Restricted(Protocol):
    """A whole system on a section, see `coadjoint.derive.reductions.Restriction`."""

    @property
    def setting(self) -> Setting:
        """Of what is left."""

    @property
    def whole(self) -> Equations:
        """The equations of the whole system."""

    def on_section(self, function: Element) -> Element:
        """A function of the whole state on the section."""


@dataclass(frozen=True)
class InducedBracket:
    """The bracket of a section.

    Attributes:
        tensor: ``{x_i, x_j}`` on it.
        shifts: W of each x_i: ``X_i = x_i - W_a phi_a``.
        rank: Of C, at almost every point.
        forces: What forces add along the section; empty without any.
    """

    tensor: Matrix
    shifts: tuple[Shift, ...]
    rank: int
    forces: tuple[Element, ...]


def induced_bracket(restricted: Restricted) -> InducedBracket | None:
    """The bracket of a section; None where it has none, or the whole system has none."""
    setting, whole, field = restricted.setting, restricted.whole, restricted.setting.field
    if whole.exact.poisson_tensor is None:
        return None
    names, section = whole.setting.state, section_of(setting)
    rows = [[restricted.on_section(x) for x in row] for row in whole.exact.poisson_tensor]
    P = {a: dict(zip(names, row, strict=True)) for a, row in zip(names, rows, strict=True)}
    state, y = setting.state, [name for name in names if name in section]
    slopes = {a: dict(zip(state, field.gradient(section[a], state), strict=True)) for a in y}

    def along(a: str, row: Mapping[str, Element]) -> Element:
        """The derivative of ``phi_a`` along a field."""
        own = field.sum(slopes[a][x] * row[x] for x in state if slopes[a][x] and row[x])
        return field.normal(row[a] - own)

    # {x, phi_a} and {phi_b, phi_a}
    of_state = {x: {a: along(a, P[x]) for a in y} for x in state}
    between = {}
    for b in y:
        columns = ((x, slopes[b][x]) for x in state if slopes[b][x])
        pulled = [(of_state[x], slope) for x, slope in columns]
        between[b] = {
            a: along(a, P[b]) - field.sum(row[a] * slope for row, slope in pulled) for a in y
        }
    span, chosen = Span(), list[str]()
    for b in y:  # the span numbers dependent columns, too
        span.add(_drop_zeros(field, {a: -value for a, value in between[b].items()}))
        chosen.append(b)

    def solve(target: Mapping[str, Element]) -> Shift | None:
        found = span.coordinates(_drop_zeros(field, target))
        return None if found is None else {chosen[n]: value for n, value in found.items()}

    shifts = [solve({a: -value for a, value in of_state[x].items()}) for x in state]
    known = [shift for shift in shifts if shift is not None]
    if len(known) < len(shifts):
        return None
    tensor = tuple(
        tuple(
            field.normal(P[x][z] - field.sum(of_state[x][a] * w for a, w in shift.items()))
            for z, shift in zip(state, known, strict=True)
        )
        for x in state
    )
    forces: tuple[Element, ...] = ()
    if whole.exact.forces:
        pairs = zip(names, map(restricted.on_section, whole.exact.forces), strict=True)
        F = dict(pairs)
        work = solve({a: along(a, F) for a in y})
        if work is None:  # the forces leave the section, which is refuted
            return None
        forces = tuple(F[x] - field.sum(of_state[x][a] * u for a, u in work.items()) for x in state)
    return InducedBracket(tensor, tuple(known), span.rank, forces)


def _drop_zeros(field: Any, row: Mapping[str, Element]) -> dict[str, Element]:
    """The entries that are not zero, in normal form."""
    normal = ((name, field.normal(value)) for name, value in row.items())
    return {name: value for name, value in normal if value != 0}


def describe_bracket(setting: Setting, induced: InducedBracket | None) -> Step:
    """The step of a derivation that gives the bracket, or says that there is none."""
    if induced is None:
        return write_step(
            "No bracket on it: some x has no X = x - W phi with {phi, X} = 0, phi = y - s(x)",
            "{phi, x} is not in the range of {phi, phi}",
            r"\{\varphi, x\} \notin \mathrm{range}\, \{\varphi, \varphi\}",
            by="dirac",
        )
    state, titles = (
        setting.state,
        {
            0: "Bracket on it, that of the whole system: a Poisson submanifold",
            len(section_of(setting)): "Bracket on it, Dirac's",
        },
    )
    other = "Bracket on it, Dirac's in the functions phi that do not commute with all"
    lines = {
        bracket(a, b): induced.tensor[i][j]
        for i, a in enumerate(state)
        for j, b in enumerate(state)
        if i < j
    }
    return write_step(
        titles.get(induced.rank, other),
        "{x_i, x_j}_s = {x_i, x_j} - {x_i, phi} W_j with {phi, phi} W_j = {phi, x_j}, "
        "phi = y - s(x)",
        r"\{x_i, x_j\}_s = \{x_i, x_j\} - \{x_i, \varphi\} W_j, \quad "
        r"\{\varphi, \varphi\} W_j = \{\varphi, x_j\}",
        lines.items(),
        by="dirac",
    )
