"""The Legendre transform of a Lagrangian quadratic in the velocities, exactly.

Comes in: l as an element. Goes out: the momenta dl/dxi, the velocities in terms of the momenta, and
the energy. Of up to `LARGEST_BLOCK` coupled velocities the inverse is written out; more of them are
solved for in the kernel, and then keep their names everywhere else.
Read next: `coadjoint.derive.routes.euler_poincare`, which uses it;
`coadjoint.derive.mechanics.solver`.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass

from coadjoint.derive.mechanics.configuration import (
    LARGEST_BLOCK,
    Matrix,
    Mechanics,
    coupled_blocks,
    mechanics,
)
from coadjoint.derive.mechanics.solver import Definition, Solve, solve_in_kernel, solver_names
from coadjoint.derive.setting import Setting, fault, once, sampled_setting
from coadjoint.errors import DerivationError, LimitError
from coadjoint.exact import Element
from coadjoint.exact.dense import determinant, inverse
from coadjoint.exact.ranks import certain_minors, witness_regular
from coadjoint.limits import COUPLED_VELOCITIES
from coadjoint.spec import Spec


@dataclass(frozen=True)
class LegendreTransform:
    """``mu = dl/dxi`` and back.

    Attributes:
        momenta: ``dl/dxi_i`` along the basis of the algebra, in velocities and advected quantities.
        velocities: ``xi_i`` along the basis, in momenta and advected quantities; its own symbol
            where the kernel solves for it.
        energy: ``<mu, xi> - l`` in terms of the momenta; what the kernel solves for keeps its name.
        definitions: What the kernel computes to solve for velocities, and these; then the other
            velocities by name.
        solves: What the kernel solves; see `coadjoint.derive.mechanics.solver`.
    """

    momenta: tuple[Element, ...]
    velocities: tuple[Element, ...]
    energy: Element
    definitions: tuple[Definition, ...]
    solves: tuple[Solve, ...]


@once
def legendre(setting: Setting) -> LegendreTransform:
    """The transform of the declared Lagrangian; see `legendre_transform`."""
    return legendre_transform(mechanics(setting))


@once
def hamiltonian(setting: Setting) -> tuple[Element, tuple[Solve, ...]]:
    """The declared Hamiltonian, or the energy of the declared Lagrangian.

    Returns:
        h, and what the kernel solves for velocities, which keep their names in h. Partial
        derivatives of such an h at fixed velocities are those of h, since ``<mu, xi> - l`` is
        stationary in xi.
    """
    if setting.spec.hamiltonian is not None:
        return setting.hamiltonian, ()
    if not setting.momenta:  # velocities are themselves state
        return mechanics(setting).energy, ()
    transform = legendre(setting)
    return transform.energy, transform.solves


def legendre_transform(of: Mechanics) -> LegendreTransform:
    """Transform l(xi, a), quadratic in xi, block by block of coupled velocities.

    Raises:
        DerivationError: l is not quadratic in the velocities, or has no invertible transform.
        LimitError: l couples more velocities than docs/limits.md allows.
    """
    setting, mass = of.setting, of.mass
    field, names = setting.field, setting.velocities
    of.check_quadratic(f"Give {_way_out(setting)} instead.")
    known = known_side(setting, of.momenta)
    velocities: dict[str, Element] = {}
    solves: list[Solve] = []
    for block in coupled_blocks(mass):
        own = tuple(tuple(mass[i][j] for j in block) for i in block)
        rest = [known[i] for i in block]
        if len(block) <= LARGEST_BLOCK:
            velocities |= _invert_block(setting, own, rest, block)
        else:
            _check_pivots(setting, own, block)
            solves.append(
                Solve(matrix=own, known=rest, block=block, names=[names[i] for i in block])
            )
    pairs = zip(setting.momenta, names, setting.weights, strict=True)
    products = [field[mu] * field[xi] * (1 / w) for mu, xi, w in pairs]
    energy = field.sum([*products, -of.lagrangian])
    solved = [line for solve in solves for line in solve_in_kernel(field, solve)]
    written = [(name, velocities[name]) for name in names if name in velocities]
    return LegendreTransform(
        momenta=of.momenta,
        velocities=tuple(velocities.get(name, field[name]) for name in names),
        energy=field.substitute(energy, velocities),
        definitions=(*solved, *written),
        solves=tuple(solves),
    )


def known_side(setting: Setting, momenta: Sequence[Element]) -> list[Element]:
    """``mu - dl/dxi`` at rest: the right side of ``mass * xi = known``."""
    rest = dict.fromkeys(setting.velocities, setting.field.zero)
    field, pairs = setting.field, zip(setting.momenta, momenta, setting.weights, strict=True)
    return [field[mu] * (1 / w) - field.substitute(slope, rest) for mu, slope, w in pairs]


def symbols(spec: Spec) -> tuple[str, ...]:
    """Names of the intermediates, if velocities of a spec must be solved for in the kernel.

    Which velocities are coupled shows with random numbers for everything else, before there is a
    field; unused symbols would slow down every operation in it.
    """
    count = sum(len(variable.components) for variable in spec.having_role("velocity"))
    if spec.lagrangian is None or spec.in_frame or count <= LARGEST_BLOCK:
        return ()
    setting = sampled_setting(spec, "velocity", random.Random(1))  # noqa: S311 (no secret)
    try:
        mass = mechanics(setting).mass
    except DerivationError:  # the route will say so
        return ()
    blocks = coupled_blocks(mass)
    coupled = (block for block in blocks if LARGEST_BLOCK < len(block) <= COUPLED_VELOCITIES)
    return tuple(name for block in coupled for name in solver_names(block))


def _invert_block(
    setting: Setting, matrix: Matrix, known: list[Element], block: tuple[int, ...]
) -> dict[str, Element]:
    """Velocities of one block from ``mass * xi = known``, by name."""
    names = [setting.velocities[i] for i in block]
    if witness_regular(setting.field, matrix) is None:
        raise _singular(setting, matrix, names)
    products = (zip(row, known, strict=True) for row in inverse(matrix))
    values = (sum((m * k for m, k in row), setting.field.zero) for row in products)
    return dict(zip(names, values, strict=True))


def _check_pivots(setting: Setting, matrix: Matrix, block: tuple[int, ...]) -> None:
    """The leading minors of a block, of which the pivots are quotients, are not zero everywhere."""
    names = [setting.velocities[i] for i in block]
    if len(block) > COUPLED_VELOCITIES:
        refused = _refusal(
            setting,
            f"the Lagrangian couples {len(block)} velocities ({', '.join(names)}); at most "
            f"{COUPLED_VELOCITIES} (COUPLED_VELOCITIES) are solved for in the kernel. Choose axes "
            f"that decouple them, or give {_way_out(setting)}.",
            names[0],
        )
        raise LimitError(str(refused), **refused.parts)
    minors = certain_minors(setting.field, matrix)
    if minors == len(matrix):
        return
    if witness_regular(setting.field, matrix) is None:
        raise _singular(setting, matrix, names)
    raise _refusal(
        setting,
        f"the kinetic energy of {', '.join(names[: minors + 1])} alone is degenerate, and the "
        "kernel solves for velocities in the order of the algebra; expected a kinetic energy that "
        f"is positive for each. Give {_way_out(setting)} instead.",
        names[minors],
    )


def _way_out(setting: Setting) -> str:
    """What does without solving for velocities."""
    route = "canonical" if setting.spec.algebra is None else "lie-poisson"
    return f"a [hamiltonian] and the route {route}"


def _singular(setting: Setting, matrix: Matrix, names: list[str]) -> DerivationError:
    """What is wrong with a block whose determinant no point shows to be other than 0."""
    what = f"det d2l/d({', '.join(names)})2"
    if len(matrix) > LARGEST_BLOCK or setting.field.is_zero(determinant(matrix)):
        problem = f"the Lagrangian has no invertible Legendre transform: {what} is 0"
        remedy = "expected every velocity in the kinetic energy. Add the missing kinetic term of "
        remedy += f"{' and '.join(names)}."
    else:
        problem = "the Legendre transform may be invertible nowhere: no point was found at which "
        problem += f"{what} is certainly not 0"
        remedy = "expected a kinetic energy that is positive. Write it in simpler functions."
    return _refusal(setting, f"{problem}; {remedy}", names[0])


def _refusal(setting: Setting, message: str, velocity: str) -> DerivationError:
    """An error that points at the Lagrangian."""
    formula = setting.spec.lagrangian
    assert formula is not None
    return fault(setting, formula, message, formula.text, velocity=velocity)
