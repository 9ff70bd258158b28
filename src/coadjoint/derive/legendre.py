"""The Legendre transform of a Lagrangian quadratic in the velocities, exactly.

Comes in: l as an element. Goes out: the momenta dl/dxi, the velocities in terms of the momenta, and
the energy. Read next: `coadjoint.derive.euler_poincare`, which uses it.
"""

from __future__ import annotations

from dataclasses import dataclass

from coadjoint.derive.interpret import determinant, inverse
from coadjoint.derive.setting import Setting
from coadjoint.errors import DerivationError
from coadjoint.exact import Element

#: Largest set of coupled velocities solved symbolically; the cofactors of more would explode.
LARGEST_BLOCK = 3


@dataclass(frozen=True)
class LegendreTransform:
    """``mu = dl/dxi`` and back.

    Attributes:
        momenta: ``dl/dxi_i`` along the basis of the algebra, in velocities and advected quantities.
        velocities: ``xi_i`` along the basis, in momenta and advected quantities.
        energy: ``<mu, xi> - l`` with mu the symbols of the momenta.
    """

    momenta: tuple[Element, ...]
    velocities: tuple[Element, ...]
    energy: Element


def legendre_transform(setting: Setting, lagrangian: Element) -> LegendreTransform:
    """Transform l(xi, a), quadratic in xi, block by block of coupled velocities.

    Raises:
        DerivationError: l is not quadratic in the velocities, has no invertible transform, or
            couples more than `LARGEST_BLOCK` velocities.
    """
    field, names = setting.field, setting.velocities
    momenta = field.gradient(lagrangian, names)
    mass = tuple(field.gradient(momentum, names) for momentum in momenta)
    _check_quadratic(setting, mass)
    rest = dict.fromkeys(names, field.zero)
    known = [
        field[mu] - field.substitute(momentum, rest)
        for mu, momentum in zip(setting.momenta, momenta, strict=True)
    ]
    velocities: dict[int, Element] = {}
    for block in coupled_blocks(mass):
        velocities |= _solve_block(setting, mass, known, block)
    pairs = zip(setting.momenta, names, strict=True)
    energy = sum((field[mu] * field[xi] for mu, xi in pairs), -lagrangian)
    return LegendreTransform(momenta, tuple(velocities[i] for i in range(len(names))), energy)


def _check_quadratic(setting: Setting, mass: tuple[tuple[Element, ...], ...]) -> None:
    """The second derivatives of l may depend on anything but velocities."""
    for row, name in zip(mass, setting.velocities, strict=True):
        for entry in row:
            found = setting.field.names_in(entry) & set(setting.velocities)
            if found or not setting.field.function_free(entry):
                raise _refusal(
                    setting,
                    f"the Lagrangian is not quadratic in the velocities: its second derivative by "
                    f"{name} depends on {', '.join(sorted(found)) or 'functions of them'}; expected"
                    " a kinetic energy quadratic in the velocities. Give a [hamiltonian] and the "
                    "route lie-poisson instead.",
                    name,
                )


def coupled_blocks(mass: tuple[tuple[Element, ...], ...]) -> list[tuple[int, ...]]:
    """Positions that the mass matrix couples, as its connected blocks."""
    blocks: list[set[int]] = []
    for i, row in enumerate(mass):
        linked = {i} | {j for j, entry in enumerate(row) if entry != 0}
        meeting = [block for block in blocks if block & linked]
        blocks = [block for block in blocks if not block & linked]
        blocks.append(linked.union(*meeting))
    return sorted(tuple(sorted(block)) for block in blocks)


def _solve_block(
    setting: Setting,
    mass: tuple[tuple[Element, ...], ...],
    known: list[Element],
    block: tuple[int, ...],
) -> dict[int, Element]:
    """Velocities of one block from ``mass * xi = known``."""
    names = [setting.velocities[i] for i in block]
    if len(block) > LARGEST_BLOCK:
        raise _refusal(
            setting,
            f"the Lagrangian couples {len(block)} velocities ({', '.join(names)}); at most "
            f"{LARGEST_BLOCK} coupled ones are solved symbolically. Choose axes that decouple "
            "them, or give a [hamiltonian] and the route lie-poisson.",
            names[0],
        )
    matrix = tuple(tuple(mass[i][j] for j in block) for i in block)
    if setting.field.is_zero(determinant(matrix)):
        raise _refusal(
            setting,
            f"the Lagrangian has no invertible Legendre transform: det d2l/d({', '.join(names)})2 "
            f"is 0; expected every velocity in the kinetic energy. Add the missing kinetic term of "
            f"{' and '.join(names)}.",
            names[0],
        )
    inverted = inverse(matrix)
    return {
        i: sum((entry * known[j] for entry, j in zip(row, block, strict=True)), setting.field.zero)
        for i, row in zip(block, inverted, strict=True)
    }


def _refusal(setting: Setting, message: str, velocity: str) -> DerivationError:
    """An error that points at the Lagrangian."""
    formula = setting.spec.lagrangian
    assert formula is not None
    return DerivationError(
        f"{setting.spec.path}:{formula.line}: {formula.key}: {message}",
        path=str(setting.spec.path),
        line=formula.line,
        key=formula.key,
        found=formula.text,
        velocity=velocity,
    )
