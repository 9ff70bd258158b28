r"""What holds for every Nambu bracket: Jacobi, the freedom in (c, h), quadratic c, a pendulum.

.. math:: \{f, h\} = -\rho \nabla c \cdot \nabla f \times \nabla h, \qquad
          \dot x = \rho \nabla c \times \nabla h

Comes in: undetermined functions, a symmetric matrix, or moments of inertia. Goes out: elements that
must be zero, the Lie algebra of a quadratic c, and the rigid body as a pendulum (Holm 2011,
section 2.5.4). The brackets themselves are made in `coadjoint.poisson.brackets`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations

from coadjoint.algebra import LieAlgebra, from_brackets
from coadjoint.algebra.invariants import signature
from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, Field
from coadjoint.poisson.brackets import nambu, nambu_tensor
from coadjoint.poisson.structure import PoissonStructure
from coadjoint.theory.jets import JetField

Number = int | Fraction


# -- the Jacobi identity, for all functions at once -----------------------------------------------


def undetermined_nambu(dimension: int = 3, functions: Sequence[str] = ()) -> PoissonStructure:
    """The Nambu bracket of undetermined functions ``c1, c2, ...`` and an undetermined density.

    It satisfies the Jacobi identity, which is a proof for every smooth c and density: a bracket
    that satisfies Leibniz' rule satisfies the identity once the coordinates do.

    Args:
        dimension: Number n of coordinates x1 ... xn; there are n - 2 functions c.
        functions: Names of further undetermined functions, to be bracketed.

    >>> undetermined_nambu().jacobi_defects()
    {}
    """
    names = [f"x{n + 1}" for n in range(dimension)]
    casimirs = [f"c{n + 1}" for n in range(dimension - 2)]
    field = JetField(names, [*casimirs, "density", *functions], order=2)
    return nambu(field, names, [field[c] for c in casimirs], field["density"])


# -- the freedom in the choice of c and h ---------------------------------------------------------


@dataclass(frozen=True)
class Mixing:
    """The motion of ``(alpha c + beta h, gamma c + delta h)`` and that of ``(c, h)``.

    Attributes:
        field: Holds the derivatives of c and h and the four coefficients as symbols.
        motion: ``grad c x grad h``.
        mixed: The same of the combinations.
        determinant: ``alpha delta - beta gamma``, by which the mixed motion is the faster one.
    """

    field: Field
    motion: tuple[Element, ...]
    mixed: tuple[Element, ...]
    determinant: Element


def mixing() -> Mixing:
    """The motion of combinations of undetermined c and h with undetermined coefficients."""
    names = [f"{f}_{m}" for f in "ch" for m in (1, 2, 3)]
    field = Field([*names, "alpha", "beta", "gamma", "delta"])
    alpha, beta, gamma, delta = (field[x] for x in ("alpha", "beta", "gamma", "delta"))
    dc, dh = ([field[f"{f}_{m}"] for m in (1, 2, 3)] for f in "ch")
    first = [alpha * a + beta * b for a, b in zip(dc, dh, strict=True)]
    second = [gamma * a + delta * b for a, b in zip(dc, dh, strict=True)]
    determinant = alpha * delta - beta * gamma
    return Mixing(field, _motion(field, dc, dh), _motion(field, first, second), determinant)


def _motion(field: Field, dc: Sequence[Element], dh: Sequence[Element]) -> tuple[Element, ...]:
    """``{x_i, h}`` from the gradients of c and h."""
    tensor = nambu_tensor(field, [dc], field.one)
    return tuple(sum((e * b for e, b in zip(row, dh, strict=True)), field.zero) for row in tensor)


# -- quadratic c: a Lie algebra for each signature ------------------------------------------------

#: Algebra by the numbers of positive and negative squares of c, the larger one first.
KINDS = {
    (3, 0): "so(3)",
    (2, 1): "so(2,1)",
    (2, 0): "se(2)",
    (1, 1): "e(1,1)",
    (1, 0): "h(1)",
    (0, 0): "R^3",
}


@dataclass(frozen=True)
class QuadraticNambu:
    """The Lie algebra behind the Nambu bracket of ``c = x.Cx/2``.

    Attributes:
        algebra: ``[e_i, e_j] = epsilon_ijk C_kl e_l``; its minus Lie-Poisson bracket is the Nambu
            bracket ``{x_i, x_j} = -epsilon_ijk C_kl x_l``.
        kind: The name of the algebra up to isomorphism.
        signature: Numbers of positive, negative and zero squares in c.
    """

    algebra: LieAlgebra
    kind: str
    signature: tuple[int, int, int]


def quadratic_nambu(C: Sequence[Sequence[Number]]) -> QuadraticNambu:
    """Classify the Nambu bracket of ``c = x.Cx/2`` by the rank and signature of C.

    C and -C give isomorphic algebras, through x -> -x.

    Raises:
        AlgebraError: C is not symmetric.

    >>> quadratic_nambu([[1, 0, 0], [0, 1, 0], [0, 0, 0]]).kind
    'se(2)'
    """
    for i, j in combinations(range(3), 2):
        if C[i][j] != C[j][i]:
            raise AlgebraError(
                f"the matrix of a quadratic form has {C[i][j]} at ({i + 1}, {j + 1}) and "
                f"{C[j][i]} at ({j + 1}, {i + 1}); expected a symmetric matrix.",
                found=[str(C[i][j]), str(C[j][i])],
            )
    cyclic = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    brackets = {(i, j): {m: Fraction(C[k][m]) for m in range(3) if C[k][m]} for i, j, k in cyclic}
    plus, minus, zero = signature(C)
    kind = KINDS[max(plus, minus), min(plus, minus)]
    algebra = from_brackets(f"Nambu {kind}", ("e1", "e2", "e3"), brackets)
    return QuadraticNambu(algebra, kind, (plus, minus, zero))


# -- the rigid body as a pendulum -----------------------------------------------------------------


@dataclass(frozen=True)
class Pendulum:
    """The rigid body on a level set of ``cylinder``: ``theta'' = -amplitude sin(2 theta)``.

    Attributes:
        cylinder: ``c - I3 h``, with c = x.x/2: an elliptic cylinder about the third axis where I3
            is the smallest or the largest moment of inertia.
        conjugate: ``{theta, x3}``, a constant: angle and axial momentum are canonical on it.
        rate: theta'.
        acceleration: theta''.
        amplitude: A multiple of the cylinder, so constant along the motion.
        sine: ``sin(2 theta)``.
    """

    cylinder: Element
    conjugate: Element
    rate: Element
    acceleration: Element
    amplitude: Element
    sine: Element


def rigid_body_pendulum(field: Field, names: Sequence[str], inertia: Sequence[Element]) -> Pendulum:
    r"""The reduction of the rigid body to pendulum motion on elliptic cylinders.

    .. math:: \tan\theta = \sqrt{k_2/k_1}\, x_2/x_1, \qquad k_i = 1 - I_3/I_i

    The pair (c, h) may be exchanged for (c - I3 h, h), of determinant one, without changing the
    motion; the first of them holds no x3 and is the ellipse ``(k_1 x_1^2 + k_2 x_2^2)/2``.
    Everything is derived from the Nambu bracket of that pair.

    Args:
        field: Has a slot for one square root.
        names: The three components of the body angular momentum.
        inertia: The principal moments.

    Source:
        Holm (2011), section 2.5.4; derived here with the third axis along the cylinder.
    """
    x1, x2, x3 = (field[name] for name in names)
    i1, i2, i3 = inertia
    k1, k2 = 1 - i3 / i1, 1 - i3 / i2
    root = field.call("sqrt", k1 * k2)
    h = x1**2 / (2 * i1) + x2**2 / (2 * i2) + x3**2 / (2 * i3)
    cylinder = (x1**2 + x2**2 + x3**2) / 2 - i3 * h
    structure = nambu(field, names, [cylinder])

    def turning(f: Element) -> Element:
        """``{theta, f}`` by ``d theta = root (x1 dx2 - x2 dx1) / (2 cylinder)``."""
        return (
            root * (x1 * structure.bracket(x2, f) - x2 * structure.bracket(x1, f)) / (2 * cylinder)
        )

    conjugate, rate = field.normal(turning(x3)), field.normal(turning(h))
    return Pendulum(
        cylinder=cylinder,
        conjugate=conjugate,
        rate=rate,
        acceleration=structure.bracket(rate, h),
        amplitude=cylinder * (1 / i2 - 1 / i1) / i3,
        sine=root * x1 * x2 / cylinder,
    )
