r"""The Poisson structures that mechanics uses, each from what determines it.

Comes in: an algebra, pairs of coordinates, Casimirs, or the brackets themselves. Goes out: a
`PoissonStructure`. What could fail to be Poisson is checked: a magnetic two-form for closedness,
declared brackets for the Jacobi identity. Read next: `coadjoint.poisson.structure`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import combinations

from coadjoint.algebra import LieAlgebra
from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, Field, element_text
from coadjoint.exact.dense import minor
from coadjoint.exact.witness import is_nonzero
from coadjoint.poisson.structure import PoissonStructure, antisymmetric, places

Number = int | Fraction | Element


def lie_poisson(
    algebra: LieAlgebra, field: Field, names: Sequence[str], sign: int = -1
) -> PoissonStructure:
    """``{mu_i, mu_j} = -+ c_ij^k mu_k`` on the dual of an algebra.

    Args:
        algebra: Its constants may be numbers or elements of the field.
        field: Where the coordinates are symbols.
        names: The coordinates, one for each basis vector.
        sign: -1 for left-invariant systems (body frame), +1 for right-invariant ones.

    Source:
        Holm (2011), sections 2.5.2 and 9.4.

    >>> from coadjoint.algebra import algebra_by_name
    >>> field = Field(["x", "y", "z"])
    >>> body = lie_poisson(algebra_by_name("so(3)"), field, field.names)
    >>> body.bracket(field["x"], field["y"])
    -z
    """
    _check_count(f"{algebra.name}*", names, algebra.dimension)
    if sign not in (-1, 1):
        raise AlgebraError(
            f"{algebra.name}*: the sign of the Lie-Poisson bracket is {sign!r}; expected -1 (left) "
            "or 1 (right).",
            found=sign,
        )
    mu = field.vector(field[x] for x in names)
    opposite = [-x for x in mu]
    entries = {}
    for pair, row in algebra.constants.items():
        terms = [
            mu[k] if sign * c == 1 else opposite[k] if sign * c == -1 else mu[k] * (sign * c)
            for k, c in row.items()
        ]
        entries[pair] = sum(terms[1:], terms[0])
    tensor = antisymmetric(field, len(names), entries)
    return PoissonStructure(field, tuple(names), tensor, f"{algebra.name}*")


def canonical(field: Field, pairs: Sequence[tuple[str, str]]) -> PoissonStructure:
    """``{q_a, p_b} = delta_ab``, with the coordinates q first, then the momenta.

    >>> field = Field(["q", "p"])
    >>> canonical(field, [("q", "p")]).hamiltonian_vector_field(field["p"] ** 2 / 2)
    (p, 0)
    """
    return magnetic(field, pairs, {})


def magnetic(
    field: Field,
    pairs: Sequence[tuple[str, str]],
    two_form: Mapping[tuple[str, str], Element],
    weights: Sequence[Number] = (),
) -> PoissonStructure:
    """``{q_a, p_b} = w_a delta_ab``, ``{p_a, p_b} = B_ab(q)``: charges in a magnetic field.

    Args:
        field: Where the coordinates are symbols.
        pairs: Each coordinate with its momentum.
        two_form: B by pairs of momenta, each pair once; a function of the coordinates q alone.
        weights: w, 1 by default; off-diagonal entries of symmetric matrices have 1/2, since
            ``tr(P dS/dt)`` counts them twice.

    Raises:
        AlgebraError: B depends on a momentum or is not closed; the message shows the defect.

    Source:
        Holm (2011), exercise 3.1.39: for the monopole ``B_ij = lambda epsilon_ijk r_k / r^3``.
    """
    coordinates, momenta = [q for q, _ in pairs], [p for _, p in pairs]
    names, n = (*coordinates, *momenta), len(pairs)
    scale = field.vector(weights or (1,) * n)
    entries = {(a, n + a): scale[a] for a in range(n)}
    for (first, second), value in two_form.items():
        a, b = places(momenta, (first, second))
        entries[n + a, n + b] = value
    structure = PoissonStructure(field, names, antisymmetric(field, 2 * n, entries), "magnetic")
    if two_form:  # where there is none, zero is closed
        _check_closed(structure, coordinates, momenta, scale)
    return structure


def _check_closed(
    structure: PoissonStructure,
    coordinates: Sequence[str],
    momenta: Sequence[str],
    weights: Sequence[Element],
) -> None:
    """``w_a d_a B_bc + cyclic = 0``, the Jacobi identity of a magnetic bracket."""
    field, n = structure.field, len(coordinates)
    form = [row[n:] for row in structure.tensor[n:]]
    for (i, a), (j, b) in combinations(enumerate(momenta), 2):
        wrong = field.reach(form[i][j]) & set(momenta)
        if wrong:
            raise AlgebraError(
                f"the magnetic term {{{a}, {b}}} = {element_text(field, form[i][j])} depends on "
                f"{min(wrong)}; expected a function of {', '.join(coordinates)} alone.",
                pair=[a, b],
                found=min(wrong),
            )
    for i, j, k in combinations(range(n), 3):
        cycle = ((i, j, k), (j, k, i), (k, i, j))
        total = field.sum(
            weights[a] * field.derivative(form[b][c], coordinates[a]) for a, b, c in cycle
        )
        defect = field.normal(total)
        if defect != 0:
            x, y, z = (coordinates[a] for a in (i, j, k))
            text = element_text(field, defect)
            known = "is not closed" if is_nonzero(field, defect) else "is not known to be closed"
            raise AlgebraError(
                f"the magnetic two-form {known}: dB has the component {text} along "
                f"d{x} d{y} d{z}; expected 0. Check the brackets of "
                f"{momenta[i]}, {momenta[j]} and {momenta[k]}.",
                triple=[momenta[i], momenta[j], momenta[k]],
                defect=text,
            )


def nambu(
    field: Field, names: Sequence[str], casimirs: Sequence[Element], density: Number = 1
) -> PoissonStructure:
    r"""The Nambu bracket with n - 2 distinguished functions, which are its Casimirs.

    .. math:: \{f, h\} = -\rho \nabla c \cdot \nabla f \times \nabla h \quad (n = 3), \qquad
              \{f, h\} = -\rho \det(\nabla f, \nabla h, \nabla c_1, \ldots, \nabla c_{n-2})

    Raises:
        AlgebraError: The number of functions is not n - 2.

    Source:
        Holm (2011), section 2.5.4; the n-dimensional form is its generalisation, derived here.

    >>> field = Field(["x", "y", "z"])
    >>> x, y, z = (field[name] for name in field.names)
    >>> nambu(field, field.names, [(x**2 + y**2 + z**2) / 2]).bracket(x, y)
    -z
    """
    _check_count("Nambu bracket", casimirs, len(names) - 2, "distinguished functions")
    gradients = [field.gradient(c, names) for c in casimirs]
    tensor = nambu_tensor(field, gradients, field.zero + density)
    return PoissonStructure(field, tuple(names), tensor, "Nambu bracket")


def nambu_tensor(
    field: Field, gradients: Sequence[Sequence[Element]], density: Element
) -> tuple[tuple[Element, ...], ...]:
    """``{x_i, x_j} = -density det(e_i, e_j, grad c_1, ...)`` from the gradients."""
    n = len(gradients) + 2
    entries = {}
    for i, j in combinations(range(n), 2):
        columns = tuple(k for k in range(n) if k not in (i, j))
        value = minor(gradients, range(n - 2), columns) if columns else field.one
        # i + (j - 1) exchanges bring columns i and j to the front
        entries[i, j] = density * value * (-1) ** (i + j)
    return antisymmetric(field, n, entries)


def declare_bracket(
    field: Field, names: Sequence[str], brackets: Mapping[tuple[int, int], Element], name: str = ""
) -> PoissonStructure:
    """A structure from its brackets ``{(i, j): {x_i, x_j}}``, each pair once, others zero.

    Raises:
        AlgebraError: A pair is given twice or with itself, or the Jacobi identity fails.

    >>> field = Field(["q", "p"])
    >>> declare_bracket(field, field.names, {(1, 0): -field.one}).bracket(field["q"], field["p"])
    1
    """
    entries: dict[tuple[int, int], Element] = {}
    for (i, j), value in brackets.items():
        if i == j or (j, i) in entries:
            fault = "with itself" if i == j else "twice"
            raise AlgebraError(
                f"{name or 'declared bracket'}: {{{names[i]}, {names[j]}}} is declared {fault}; "
                "expected each pair once, in either order.",
                pair=[names[i], names[j]],
            )
        entries[i, j] = value
    tensor = antisymmetric(field, len(names), entries)
    structure = PoissonStructure(field, tuple(names), tensor, name)
    structure.check_jacobi()
    return structure


def _check_count(
    subject: str, found: Sequence[object], expected: int, what: str = "coordinates"
) -> None:
    if len(found) != expected:
        raise AlgebraError(
            f"{subject}: {len(found)} {what} are given; expected {expected}.",
            found=len(found),
            expected=expected,
        )
