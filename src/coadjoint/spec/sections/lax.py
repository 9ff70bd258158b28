"""Lax pairs: the table [lax] of a spec, two matrices that name the spectral parameter.

Comes in: the table and what the spec declares. Goes out: a `Lax` with two square matrices of one
size. Whether ``dL/dt = [L, M]`` is a claim that the certificate decides.
Read next: `coadjoint.derive.routes.lax`.
"""

from __future__ import annotations

from collections.abc import Sequence

from coadjoint.spec.core.formulas import Quantity, Scope, make_scope, read_formula
from coadjoint.spec.core.names import NAME
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.shapes import FUNCTIONS, words
from coadjoint.spec.core.source import Source
from coadjoint.spec.model import Definition, Formula, Lax
from coadjoint.spec.schema import LaxPart


def read_lax(
    source: Source, part: LaxPart, roles: tuple[str, ...], quantities: Sequence[Quantity]
) -> Lax:
    """The declared pair.

    Args:
        source: The text of the spec.
        part: The table.
        roles: Roles of the variables of the state.
        quantities: Everything the spec declares.

    Raises:
        SpecError: The spectral parameter has a taken name, or L and M are not square matrices of
            one size.
    """
    _check_spectral(source, part.spectral, quantities)
    others = {part.spectral: ()}
    of_state = make_scope("L of a Lax pair", roles, quantities, others)
    of_motion = make_scope(
        "M of a Lax pair", tuple(dict.fromkeys((*roles, "velocity"))), quantities, others
    )
    L = _square(source, "L", part.L, of_state)
    M = _square(source, "M", part.M, of_motion)
    if L.shape != M.shape:
        raise source.fault(
            ("lax", "M"),
            f"M is {words(M.shape)} and L is {words(L.shape)}",
            found=words(M.shape),
            expected="two matrices of one size",
        )
    return Lax(part.spectral, L, M)


def _check_spectral(source: Source, name: str, quantities: Sequence[Quantity]) -> None:
    """The spectral parameter has a name of its own; it may be a keyword, since no code names it."""
    taken = {q.name for q in quantities}
    taken |= {c for q in quantities if not isinstance(q, Definition) for c in q.components}
    if not NAME.fullmatch(name) or name in taken or name in FUNCTIONS:
        raise source.fault(
            ("lax", "spectral"),
            f"{name!a} cannot name the spectral parameter",
            found=name,
            expected="a name that nothing else has, such as 'lambda'",
        )


def _square(source: Source, which: str, text: str, scope: Scope) -> Formula:
    key: KeyPath = ("lax", which)
    formula = read_formula(source, key, text, scope, any_shape=True)
    if len(formula.shape) != 2 or formula.shape[0] != formula.shape[1]:
        raise source.fault(
            key,
            f"{which} is {words(formula.shape)}",
            found=words(formula.shape),
            expected="a square matrix",
            hint="Write hat(Pi) for the matrix of a vector, diag(a) for a diagonal one.",
        )
    return formula
