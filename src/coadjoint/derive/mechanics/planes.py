r"""Planes: the Lax pair of Manakov, found from the inertia of a body in the planes of so(n).

Theorem (Manakov 1976; Holm 2011, sections 2.4.2 to 2.4.5 and 2.5.6): with :math:`M_{ij} = I_{ij}
\Omega_{ij}` in the planes of so(n), and diagonal A and B that satisfy

.. math:: [B, \Omega] + [M, A] = 0, \qquad \text{that is} \quad I_{ij}\,(a_i - a_j) = b_i - b_j,

the motion :math:`\dot M = [M, \Omega]` is :math:`\dot L = [L, \Omega + \lambda A]` for :math:`L = M
+ \lambda B`, and that in the potential :math:`V = \frac{\sigma}{2}\mathrm{tr}(SA)` of an advected
symmetric S the same for :math:`L = -\sigma S + \lambda M + \lambda^2 B`. Where :math:`I_{ij} = a_i
+ a_j`, and so always in three dimensions, B is :math:`A^2`.
Comes in: a Setting on an algebra of antisymmetric matrices. Goes out: the pair that is found, or
the equation that has no solution. No structure constant occurs.
Read next: `coadjoint.derive.routes.manakov`, the route.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from coadjoint.algebra.matrices import size
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.pairs import LaxPair
from coadjoint.derive.refusals import refusal
from coadjoint.derive.setting import Setting, once
from coadjoint.errors import DerivationError
from coadjoint.exact import Element, element_text
from coadjoint.exact.dense import Matrix, combine, diagonal
from coadjoint.exact.linear import Span
from coadjoint.spec.core.faults import list_names

ROUTE = "manakov"
#: The spectral parameter; no spec can declare a keyword of Python.
SPECTRAL = "lambda"

Plane = tuple[int, int]


@dataclass(frozen=True)
class Body:
    """What Manakov's equations need to know of a system on so(n).

    Attributes:
        size: n.
        momentum: M as a matrix.
        velocity: Omega as a matrix.
        inertia: ``M_ij / Omega_ij`` for each plane i < j, counted from 0.
        field: The advected S as a matrix, or None.
        slopes: Twice the derivatives of the potential by ``S_ii``; zeros without one.
    """

    size: int
    momentum: Matrix
    velocity: Matrix
    inertia: dict[Plane, Element]
    field: Matrix | None
    slopes: tuple[Element, ...]


@once
def find_pair(setting: Setting) -> LaxPair:
    """Manakov's pair of a system on so(n).

    Raises:
        DerivationError: The algebra or the energy are of another kind, or no A and B satisfy the
            equations of all planes.
    """
    field, body = setting.field, body_of(setting)
    a, b = _by_sums(body) or _by_differences(setting, body)
    spectral, turn = field[SPECTRAL], field.number(setting.sign)
    terms, texts = [(field.one, body.momentum), (spectral, diagonal(b))], _texts(setting)
    A = _diagonal_text(setting, a)
    B = f"{A}^2" if b == tuple(x**2 for x in a) else _diagonal_text(setting, b)
    L = f"{texts[0]} + {SPECTRAL}*{B}"
    if body.field is not None:
        share = _share(setting, body, a)
        terms = [(-share, body.field), *((spectral * factor, matrix) for factor, matrix in terms)]
        lead = {"1": "-", "-1": ""}.get(element_text(field, share))
        lead = f"-({element_text(field, share)})*" if lead is None else lead
        L = f"{lead}S + {SPECTRAL}*{texts[0]} + {SPECTRAL}^2*{B}"
    M = f"{texts[1]} + {SPECTRAL}*{A}"
    turning = combine((turn, body.velocity), (turn * spectral, diagonal(a)))
    pair = L, M if setting.sign == 1 else f"-({M})"
    return LaxPair(spectral=SPECTRAL, L=combine(*terms), M=turning, texts=pair)


# -- the system, as matrices ----------------------------------------------------------------------


@once
def body_of(setting: Setting) -> Body:
    """The system as a body in n dimensions.

    Raises:
        DerivationError: It is none with inertia in the planes of so(n).
    """
    planes = _planes(setting)
    n = size(setting.algebra.matrices)
    inertia = _inertia(setting, planes)
    momentum, velocity = dict[Plane, Element](), dict[Plane, Element]()
    for number, (plane, c) in enumerate(planes):
        # <mu, xi> = tr(M^T Omega)/2 for Omega = sum xi e
        momentum[plane] = setting.field[setting.momenta[number]] / c
        named = bool(setting.velocities)
        velocity[plane] = (
            c * setting.field[setting.velocities[number]]
            if named
            else momentum[plane] / inertia[plane]
        )
    symmetric, slopes = _potential(setting, n)
    M, Omega = (_antisymmetric(setting, n, entries) for entries in (momentum, velocity))
    return Body(size=n, momentum=M, velocity=Omega, inertia=inertia, field=symmetric, slopes=slopes)


def _planes(setting: Setting) -> list[tuple[Plane, Element]]:
    """The plane and the factor of each basis vector ``c (e_i e_j^T - e_j e_i^T)``, i < j."""
    planes: list[tuple[Plane, Element]] = []
    n = size(setting.algebra.matrices)
    for name, matrix in zip(setting.algebra.basis, setting.algebra.matrices, strict=False):
        entries = sorted(matrix.items())
        (place, c) = entries[0]
        if len(entries) != 2 or entries[1] != (place[::-1], -c):
            raise _no_so_n(setting, f"the matrix of {name} spans no plane", name)
        planes.append((place, setting.field.zero + c))
    if not planes or len(planes) != n * (n - 1) // 2:
        problem = f"{setting.algebra.name} is not all of so(n) by its matrices"
        raise _no_so_n(setting, problem, setting.algebra.name)
    return planes


def _no_so_n(setting: Setting, problem: str, found: str) -> DerivationError:
    return refusal(
        setting,
        ROUTE,
        problem,
        found,
        "an algebra so(n) by one antisymmetric matrix for each plane",
        'Write name = "so(4)", or declare a pair under [lax] for the route lax.',
    )


def _inertia(setting: Setting, planes: Sequence[tuple[Plane, Element]]) -> dict[Plane, Element]:
    """``M_ij / Omega_ij``, read off the kinetic energy."""
    spec, field = setting.spec, setting.field
    if spec.lagrangian is not None:
        names, energy = setting.velocities, setting.lagrangian
        second = mechanics(setting).mass
    else:
        names, energy = setting.momenta, setting.hamiltonian
        second = tuple(field.gradient(slope, names) for slope in field.gradient(energy, names))
    rest = dict.fromkeys(names, field.zero)
    for place, (name, row) in enumerate(zip(names, second, strict=True)):
        first = field.substitute(field.derivative(energy, name), rest)
        moving = {each for entry in row for each in field.reach(entry)} - {*setting.parameters}
        coupled = [names[j] for j, entry in enumerate(row) if j != place and entry != 0]
        if first != 0 or moving or coupled or row[place] == 0:
            guilty = list_names(coupled or sorted(moving) or [name])
            raise refusal(
                setting,
                ROUTE,
                f"the kinetic energy of {name} depends on {guilty}"
                if coupled or moving
                else f"the kinetic energy is not a square of {name}",
                guilty,
                "a sum over the planes of a square times a function of parameters",
                "Choose axes that decouple the planes, or declare a pair under [lax].",
            )
    inertia = {}
    for number, (plane, c) in enumerate(planes):
        value = second[number][number]
        inertia[plane] = value / c**2 if spec.lagrangian is not None else 1 / (value * c**2)
    return inertia


def _potential(setting: Setting, n: int) -> tuple[Matrix | None, tuple[Element, ...]]:
    """The advected symmetric matrix with the slopes of the potential, or nothing of both."""
    spec, field = setting.spec, setting.field
    if not setting.advected:
        return None, (field.zero,) * n
    variable = setting.advected[0]
    action = setting.actions[variable.name]
    if len(setting.advected) > 1 or action.name != "symmetric":
        raise refusal(
            setting,
            ROUTE,
            f"{variable.name} is advected by the representation {action.name!r}",
            action.name,
            "one advected symmetric matrix, or nothing advected",
            'Write representation = "symmetric", or declare a pair under [lax].',
        )
    sign = -1 if spec.lagrangian is not None else 1
    energy = setting.lagrangian if spec.lagrangian is not None else setting.hamiltonian
    places = [(i, j) for i in range(n) for j in range(i, n)]
    gradient = field.gradient(energy, variable.components)
    slopes = dict(zip(places, gradient, strict=True))
    for (i, j), slope in slopes.items():
        if (i != j and slope != 0) or not field.reach(slope) <= {*setting.parameters}:
            name = variable.components[places.index((i, j))]
            raise refusal(
                setting,
                ROUTE,
                f"the derivative of the potential by {name} is {element_text(field, slope)}",
                name,
                f"a potential trace({variable.name}*diag(c))/2 with c of parameters alone",
                "Choose axes in which it is diagonal, or declare a pair under [lax].",
            )
    components = dict(zip(places, setting.elements(variable.components), strict=True))
    rows = tuple(tuple(components[min(i, j), max(i, j)] for j in range(n)) for i in range(n))
    return rows, tuple(2 * sign * slopes[i, i] for i in range(n))


def _antisymmetric(setting: Setting, n: int, entries: dict[Plane, Element]) -> Matrix:
    zero = setting.field.zero
    whole = entries | {(j, i): -value for (i, j), value in entries.items()}
    return tuple(tuple(whole.get((i, j), zero) for j in range(n)) for i in range(n))


# -- Manakov's equations --------------------------------------------------------------------------

Pair = tuple[tuple[Element, ...], tuple[Element, ...]]


def _by_sums(body: Body) -> Pair | None:
    """The a_i and ``b = a^2`` from ``a_i + a_j = I_ij``; None if that has no solution."""
    inertia, n = body.inertia, body.size
    if n == 2:
        half = inertia[0, 1] / 2
        return (half, half), (half**2, half**2)
    first = (inertia[0, 1] + inertia[0, 2] - inertia[1, 2]) / 2
    a = (first, *(inertia[0, j] - first for j in range(1, n)))
    if any(a[i] + a[j] != value for (i, j), value in inertia.items()):
        return None
    return a, tuple(x**2 for x in a)


def _by_differences(setting: Setting, body: Body) -> Pair:
    """The a_i and b_i from ``I_ij (a_i - a_j) = b_i - b_j``, with ``a_1 = b_1 = 0``.

    For i, j > 1 that leaves ``(I_ij - I_1i) a_i = (I_ij - I_1j) a_j``.
    """
    field, inertia, n = setting.field, body.inertia, body.size
    span = Span()
    for i, j in combinations(range(1, n), 2):
        own, other = inertia[i, j] - inertia[0, i], inertia[i, j] - inertia[0, j]
        span.add({i: own, j: -other})
        if span.rank == n - 1:
            raise refusal(
                setting,
                ROUTE,
                "I_ij*(a_i - a_j) = b_i - b_j with I_ij = M_ij/Omega_ij has no solution but equal "
                f"a_i: the equations of the planes up to ({i + 1}, {j + 1}) contradict each other, "
                f"where I_{i + 1}{j + 1} = {element_text(field, inertia[i, j])}",
                f"({i + 1}, {j + 1})",
                "inertia such as I_ij = a_i + a_j",
            )
    a = [field.zero] * n
    pivots = {min(row): row for row in span.rows}
    for weight, free in enumerate((n for n in range(1, n) if n not in pivots), 1):
        a[free] += weight
        for pivot, row in pivots.items():
            a[pivot] = a[pivot] - weight * row.get(free, field.zero)
    return tuple(a), (field.zero, *(inertia[0, j] * a[j] for j in range(1, n)))


def _share(setting: Setting, body: Body, a: Sequence[Element]) -> Element:
    """The sigma of ``V = sigma tr(SA)/2 + constant``: ``c_i - c_j = sigma (a_i - a_j)``."""
    apart = [(i, j) for i, j in combinations(range(body.size), 2) if a[i] != a[j]]
    share = setting.field.zero
    if apart:
        i, j = apart[0]
        share = (body.slopes[i] - body.slopes[j]) / (a[i] - a[j])
    for i, j in combinations(range(body.size), 2):
        if body.slopes[i] - body.slopes[j] != share * (a[i] - a[j]):
            name = setting.advected[0].name
            raise refusal(
                setting,
                ROUTE,
                f"c_i - c_j = sigma*(a_i - a_j) for the potential trace({name}*diag(c))/2 has no "
                f"solution in the plane ({i + 1}, {j + 1})",
                f"({i + 1}, {j + 1})",
                "a potential trace(S*A)/2 with the A of the inertia I_ij = a_i + a_j",
            )
    return share


# -- words ----------------------------------------------------------------------------------------


def _texts(setting: Setting) -> tuple[str, str]:
    """The matrices M and Omega as a spec would write them."""
    texts = []
    for role, otherwise in (("momentum", "M"), ("velocity", "Omega")):
        declared = setting.spec.having_role(role)
        name = declared[0].name if len(declared) == 1 else otherwise
        vector = len(declared) == 1 and not declared[0].form
        texts.append(f"hat({name})" if vector and setting.algebra.name == "so(3)" else name)
    return texts[0], texts[1]


def _diagonal_text(setting: Setting, values: Sequence[Element]) -> str:
    entries = (element_text(setting.field, value) for value in values)
    return f"diag({', '.join(entries)})"
