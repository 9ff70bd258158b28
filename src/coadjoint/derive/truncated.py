r"""The equations of the entries of matrices on a surface, for any number of rows.

The route of the spec is followed for matrices of a few rows, by structure constants of u(N). For
all others the coadjoint motion is a commutator of matrices,

.. math:: \dot W = [W, V], \qquad V = \partial h/\partial W,

which loops compute as products, and V follows from W diagonal by diagonal. That both are one motion
is decided for the few rows (`coadjoint.prove.truncated`).
Comes in: the Equations of matrices of a few rows. Goes out: a `Family`.
Read next: `coadjoint.families`.
"""

from __future__ import annotations

from math import isqrt
from typing import Final

import sympy

from coadjoint.derive.equations import Equations
from coadjoint.derive.symbols import choose_names
from coadjoint.derive.written import Written
from coadjoint.errors import DerivationError
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Matrix, product
from coadjoint.families import Family, MatrixMotion, Sum, Total
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.surfaces import SURFACES


def derive_truncated(equations: Equations) -> Family:
    """The equations of an entry.

    Args:
        equations: Of matrices of a few rows.

    Raises:
        DerivationError: The inertia is no multiple of the Laplacian.
    """
    spec = equations.spec
    declared = spec.family
    assert declared is not None, spec.name
    (name,) = declared.variables
    names = choose_names(spec, ["entries", f"{name}_velocity", f"{name}_product", f"{name}_energy"])
    count, velocity, product_of, energy = map(sympy.Symbol, names)
    state = sympy.Symbol(name)
    return Family(
        index=declared.index,
        states=(state,),
        shifts=(),
        neighbours={},
        shared=tuple(map(sympy.Symbol, equations.setting.parameters)),
        indexed=(),
        partners={},
        rates=(product_of,),
        pair_sums=(),
        ends={},
        totals=(
            Total(
                name="energy", formula=energy / 2, sums=(Sum(symbol=energy, term=state * velocity),)
            ),
        ),
        small=declared.least,
        count=(count,),
        matrices=MatrixMotion(
            state=state,
            velocity=velocity,
            product=product_of,
            scale=_find_scale(equations, declared.truncation, count),
        ),
    )


def _find_scale(equations: Equations, text: str, count: sympy.Symbol) -> sympy.Expr:
    """The inertia over minus the Laplacian, which no mode changes.

    Raises:
        DerivationError: It does.
    """
    spec = equations.spec
    assert spec.family is not None, spec.name
    rows, surface = spec.family.index.name, SURFACES[spec.family.index.surface]
    modes = {name: sympy.Symbol(name) for name in surface.modes}
    known = {**modes, rows: sympy.sqrt(count)}
    inertia, laplacian = (
        Written(equations).value(read_expression(each), known) for each in (text, surface.laplacian)
    )
    scale = sympy.simplify(inertia / laplacian)
    if scale.has(*modes.values()):
        raise DerivationError(
            f"{spec.path}: truncation.{rows}.inertia is {text!a}; expected a multiple of "
            f"{surface.laplacian}, as that of an ideal fluid. Write it as {surface.inertia!a}.",
            found=text,
        )
    return scale


def tell_motion(family: Family) -> tuple[tuple[str, str], ...]:
    """The equations of matrices, left and right sides as texts."""
    matrices = family.matrices
    assert matrices is not None, "of entries of matrices alone"
    rows = sympy.Symbol(family.index.name, positive=True)
    (count,) = family.count
    scale = str(sympy.factor_terms(matrices.scale.xreplace({count: rows**2}))).replace("**", "^")
    return (
        (f"d{matrices.state}/dt", f"[{matrices.state}, V]"),
        (f"{scale}*L V", str(matrices.state)),
        *_LAPLACIANS[family.index.surface](str(rows)),
    )


def _tell_on_sphere(rows: str) -> tuple[tuple[str, str], ...]:
    """The Laplacian of Hoppe and Yau."""
    return (
        (
            "(L V)[i, j]",
            "2*(s*(s + 1) - z[i]*z[j])*V[i, j] - c[i]*c[j]*V[i+1, j+1] - c[i-1]*c[j-1]*V[i-1, j-1]",
        ),
        ("s, z[i]", f"({rows} - 1)/2, s - i"),
        ("c[i]", f"sqrt((i + 1)*({rows} - 1 - i))"),
    )


def _tell_on_torus(rows: str) -> tuple[tuple[str, str], ...]:
    """That of waves."""
    return (
        ("L T[k]", "(k1^2 + k2^2)*T[k]"),
        ("T[k][i, j]", f"exp(2*pi*i*k1*(i + j)/{rows})"),
        ("k2", f"j - i mod {rows}"),
        ("|k1|, |k2|", f"0 to ({rows} - 1)/2"),
    )


_LAPLACIANS: Final = {"sphere": _tell_on_sphere, "torus": _tell_on_torus}


def multiply_out(equations: Equations) -> tuple[Element, ...]:
    """The rates of the entries as a commutator of matrices, whatever the structure constants are.

    Of ``A + i B``, A antisymmetric and B symmetric, an entry is that of A + B.
    """
    field, energy = equations.setting.field, equations.exact.energy
    assert energy is not None, equations.spec.name
    state = equations.setting.state
    own = tuple(field[name] for name in state)
    return commute_entries(field, own, tuple(field.gradient(energy, state)))


def commute_entries(
    field: Field, W: tuple[Element, ...], V: tuple[Element, ...]
) -> tuple[Element, ...]:
    """The entries of the commutator of two matrices, by theirs."""
    n = isqrt(len(W))
    own, other = _split(W), _split(V)
    parts = [
        _commute(own[0], other[0], 1),
        _commute(own[1], other[1], -1),
        _commute(own[0], other[1], 1),
        _commute(own[1], other[0], 1),
    ]
    return tuple(field.sum(part[i][j] for part in parts) for i in range(n) for j in range(n))


def _split(entries: tuple[Element, ...]) -> tuple[Matrix, Matrix]:
    """A and B of entries of A + B."""
    n = isqrt(len(entries))
    rows = [entries[i * n : (i + 1) * n] for i in range(n)]
    turned = list(zip(*rows, strict=True))
    pairs = [list(zip(a, b, strict=True)) for a, b in zip(rows, turned, strict=True)]
    return (
        tuple(tuple((a - b) / 2 for a, b in row) for row in pairs),
        tuple(tuple((a + b) / 2 for a, b in row) for row in pairs),
    )


def _commute(a: Matrix, b: Matrix, sign: int) -> list[list[Element]]:
    """``sign [a, b]``."""
    pairs = zip(product(a, b), product(b, a), strict=True)
    return [[sign * (x - y) for x, y in zip(*both, strict=True)] for both in pairs]
