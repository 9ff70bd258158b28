r"""The motion of fields by their bracket: :math:`\dot u = P\, \delta h/\delta u`.

Comes in: a Setting with a density of the energy and a bracket. Goes out: Equations in jets.
Read next: `coadjoint.derive.fields.structure`, which makes the bracket.
"""

from __future__ import annotations

from collections.abc import Iterator

from coadjoint.derive.equations import Equations
from coadjoint.derive.fields import circle
from coadjoint.derive.fields.emission import close, emit_fields
from coadjoint.derive.fields.jets import jets_of
from coadjoint.derive.fields.operators import Operator, Term, apply
from coadjoint.derive.fields.structure import field_operator
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.records import Left, bracket, write_rates, write_slopes, write_step
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element


def field_equations(setting: Setting, route: str) -> Equations:
    """Equations of motion by the bracket of the fields.

    Raises:
        DerivationError: Neither a Hamiltonian nor an invertible Legendre transform is there.
    """
    jets, operator, h = jets_of(setting), field_operator(setting), density(setting)
    slopes = [circle.vary(setting, h, name) for name in setting.state]
    rates = apply(operator, slopes, jets.total)
    space = setting.spec.space
    assert space is not None, setting.spec.name
    power, s = ("D_x and D_y", "x") if space.across else ("D^k = d^k/ds^k", "s")
    steps = (
        write_step("Density of the energy", "h", "h", {"h": h}, by="hamilton"),
        write_step(
            "Variational derivatives",
            *_write_euler(setting),
            write_slopes("h", setting.state, slopes),
            by="variational-derivative",
        ),
        write_step(
            f"Bracket of the fields: factors of {power}, what stands behind D is differentiated, "
            "too",
            f"{{u_i({s}), u_j({s}')}} = P_ij delta({s} - {s}')",
            rf"\{{u_i({s}), u_j({s}')\}} = P_{{ij}}\, \delta({s} - {s}')",
            _entries(setting, operator),
            by="field-bracket",
        ),
        write_step(
            "Equations of motion",
            "du_i/dt = sum_j P_ij dh/du_j",
            r"\dot u_i = \sum_j P_{ij}\, \delta h / \delta u_j",
            write_rates(setting.state, rates),
            by="hamilton",
        ),
    )
    return emit_fields(setting, route, rates, steps, h, operator)


def density(setting: Setting) -> Element:
    """The density of the energy: declared, or that of the declared Lagrangian."""
    if setting.spec.hamiltonian is not None:
        return setting.hamiltonian
    if setting.spec.diffeomorphisms is not None:
        return circle.energy(setting)
    return close(setting, legendre(setting).energy)


def _write_euler(setting: Setting) -> tuple[str, str]:
    """The variational derivative, as text and in LaTeX."""
    if not setting.spec.in_plane:
        return (
            "dh/du = sum (-D)^k dh/du_k",
            r"\delta h / \delta u = \sum (-\partial_s)^k \partial h / \partial u_k",
        )
    return (
        "dh/du = sum (-D_x)^i (-D_y)^j dh/du_ij",
        r"\delta h / \delta u = "
        r"\sum (-\partial_x)^i (-\partial_y)^j \partial h / \partial u_{ij}",
    )


def _entries(setting: Setting, operator: Operator) -> Iterator[tuple[Left, Element]]:
    """The terms of the bracket on and above the diagonal, each with its order."""
    for i, a in enumerate(setting.state):
        for j, b in enumerate(setting.state[i:], i):
            for term in operator[i][j]:
                named = _name_term(bracket(a, b), term, in_plane=setting.spec.in_plane)
                yield named, term.left * term.right


def _name_term(of: Left, term: Term, *, in_plane: bool) -> Left:
    """A bracket and what its value is a factor of."""
    if not (term.order or term.across):
        return of
    power = f"D^{term.order}" if term.order > 1 else "D"
    if in_plane:
        power = "D_y" if term.across else "D_x"
    after = f" behind {power}" if term.right != 1 else f" before {power}"
    return Left(
        of.text + after,
        rf"{of.latex}\text{{{after}}}",
        f"<mrow>{of.mathml}<mtext>{after}</mtext></mrow>",
        f'{of.typst} "{after}"',
    )
