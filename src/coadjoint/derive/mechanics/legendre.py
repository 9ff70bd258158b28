"""The Legendre transform of a Lagrangian, exactly.

Comes in: l as an element, a function of the velocities. Goes out: the momenta dl/dxi, the
velocities in terms of the momenta, and the energy. Where l is quadratic in the velocities, or a
function of one quadratic form (`coadjoint.derive.mechanics.radial`), the inverse is written out, of
up to `LARGEST_BLOCK` coupled velocities. So is that of a velocity which is coupled to no other, if
its momentum is a function with a known inverse (`coadjoint.derive.mechanics.inverses`). More
velocities are solved for in the kernel, and so are those of any other l, by
`coadjoint.derive.mechanics.iteration`; they keep their names elsewhere.
Read next: `coadjoint.derive.routes.euler_poincare`, which uses it;
`coadjoint.derive.mechanics.solver`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from coadjoint.derive.mechanics.configuration import (
    LARGEST_BLOCK,
    Matrix,
    Mechanics,
    coupled_blocks,
    inverse_in_blocks,
    mechanics,
    sampled_mechanics,
)
from coadjoint.derive.mechanics.inverses import Inverse, find_inverse
from coadjoint.derive.mechanics.iteration import (
    STEPS,
    Newton,
    guess_name,
    rate_name,
    slope_name,
    tell_iterations,
)
from coadjoint.derive.mechanics.radial import radial_solution
from coadjoint.derive.mechanics.singular import tell_constraints
from coadjoint.derive.mechanics.solver import (
    Definition,
    Solve,
    forward_name,
    names_for,
    solve_in_kernel,
    solver_names,
)
from coadjoint.derive.mechanics.variational import normal_extremals
from coadjoint.derive.setting import Setting, fault, list_components, once
from coadjoint.errors import DerivationError, LimitError
from coadjoint.exact import Element
from coadjoint.exact.dense import determinant, inverse
from coadjoint.exact.ranks import certain_minors, witness_regular
from coadjoint.exact.roots import simplify_roots
from coadjoint.exact.signs import sign
from coadjoint.limits import OPERATIONS
from coadjoint.spec import Spec


@dataclass(frozen=True)
class LegendreTransform:
    """``mu = dl/dxi`` and back.

    Attributes:
        momenta: ``dl/dxi_i`` along the basis of the algebra, in velocities and advected quantities.
        velocities: ``xi_i`` along the basis, in momenta and advected quantities; its own symbol
            where the kernel solves for it.
        energy: ``<mu, xi> - l`` in terms of the momenta; what the kernel solves for keeps its name,
            and so do velocities that are not linear in the momenta.
        definitions: What the kernel computes to solve for velocities, and these; then the other
            velocities by name.
        solves: What the kernel solves; see `coadjoint.derive.mechanics.solver`.
        curved: Those of the definitions that give velocities which are not linear in the momenta.
        alone: The inverses of ``dl/dxi`` that give velocities which are coupled to no other.
    """

    momenta: tuple[Element, ...]
    velocities: tuple[Element, ...]
    energy: Element
    definitions: tuple[Definition, ...]
    solves: tuple[Solve, ...]
    curved: tuple[Definition, ...]
    alone: Mapping[str, Inverse]

    @property
    def iterations(self) -> str:
        """What a statement says of Newton's iterations, where there are some."""
        return tell_iterations([each.newton for each in self.solves if each.newton is not None])


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
    if setting.spec.variational:
        return normal_extremals(setting).energy, ()
    if not setting.momenta:  # velocities are themselves state
        return mechanics(setting).energy, ()
    transform = legendre(setting)
    if transform.curved:
        return _write_out(setting, transform), transform.solves
    return transform.energy, transform.solves


def alone_velocities(setting: Setting) -> dict[str, Element]:
    """Velocities that are coupled to no other and follow in closed form from the momentum."""
    if setting.spec.hamiltonian is not None or setting.spec.variational or not setting.momenta:
        return {}
    return {name: each.value for name, each in legendre(setting).alone.items()}


def _write_out(setting: Setting, transform: LegendreTransform) -> Element:
    """The energy in momenta alone, where velocities are not linear in them."""
    field, curved = setting.field, dict(transform.curved)
    names = [xi for xi, _, _ in setting.conjugates]
    velocities = {name: curved.pop(name) for name in names if name in curved}
    momenta = {
        mu: (field[y] + at_rest(setting, transform.momenta[i])) * w
        for i, (_, mu, w) in enumerate(setting.conjugates)
        if (y := forward_name(i)) in curved
    }
    calls = {g: image for each in transform.alone.values() for g, image in each.known.items()}
    h = field.substitute(field.substitute(transform.energy, calls | momenta), velocities)
    return field.substitute(simplify_roots(field, h), curved)


def legendre_transform(of: Mechanics) -> LegendreTransform:
    """Transform l(xi, a), block by block of coupled velocities.

    Raises:
        DerivationError: l has no invertible transform, or none that begins at rest.
        LimitError: l couples more velocities than docs/limits.md allows.
    """
    setting, mass = of.setting, of.mass
    field, names = setting.field, of.frame.velocities
    velocities: dict[str, Element] = {}
    solves: list[Solve] = []
    curved: list[Definition] = []
    alone: dict[str, Inverse] = {}
    for block in coupled_blocks(mass):
        own = tuple(tuple(mass[i][j] for j in block) for i in block)
        if any(names[i] in of.bending for i in block):
            if (single := _solve_alone(of, block)) is not None:
                alone[names[block[0]]] = single
                curved.append((names[block[0]], single.value))
            elif (found := _solve_radially(of, block)) is not None:
                curved += found
            else:
                solves.append(_iterate(of, block))
            continue
        rest = known_side(setting, of.momenta, block)
        if len(block) <= LARGEST_BLOCK:
            velocities |= _invert_block(setting, own, rest, block)
        else:
            _check_pivots(setting, own, block)
            solves.append(
                Solve(matrix=own, known=rest, block=block, names=[names[i] for i in block])
            )
    products = [field[mu] * field[xi] * (1 / w) for xi, mu, w in setting.conjugates]
    energy = field.sum([*products, -of.lagrangian])
    solved = [line for solve in solves for line in solve_in_kernel(field, solve)]
    written = [(name, velocities[name]) for name in names if name in velocities]
    parts = dict(curved)
    closed = velocities | {name: field.substitute(value, parts) for name, value in curved}
    return LegendreTransform(
        momenta=of.momenta,
        velocities=tuple(closed.get(name, field[name]) for name in names),
        energy=field.substitute(energy, velocities),
        definitions=(*solved, *curved, *written),
        solves=tuple(solves),
        curved=tuple(curved),
        alone=alone,
    )


def known_side(setting: Setting, momenta: Sequence[Element], block: Sequence[int]) -> list[Element]:
    """``mu - dl/dxi`` at rest, in some places: the right side of ``mass * xi = known``."""
    return [_paired(setting, i) - at_rest(setting, momenta[i]) for i in block]


def _paired(setting: Setting, place: int) -> Element:
    """A momentum as it pairs with its velocity."""
    _, mu, weight = setting.conjugates[place]
    return setting.field[mu] * (1 / weight)


def at_rest(setting: Setting, momentum: Element) -> Element:
    """``dl/dxi_i`` at rest."""
    rest = dict.fromkeys((xi for xi, _, _ in setting.conjugates), setting.field.zero)
    return setting.field.substitute(momentum, rest)


def symbols(spec: Spec) -> tuple[str, ...]:
    """Names of the intermediates of velocities that are solved for in the kernel, or are curved.

    Which velocities are coupled shows before there is a field; see `sampled_mechanics`.
    """
    if spec.lagrangian is None or spec.in_frame or not spec.having_role("momentum"):
        return ()
    if spec.diffeomorphisms is not None:
        return ()
    try:
        known = sampled_mechanics(spec)
        blocks, velocities = coupled_blocks(known.mass), known.frame.velocities
        bending = {*known.bending}
    except DerivationError:  # of what is real in the domain alone, or the route will say so
        velocities = list_components(spec.having_role("velocity"))
        blocks, bending = [tuple(range(len(velocities)))], {*velocities}
    names = list[str]()
    for block in blocks:
        if any(velocities[i] in bending for i in block):
            names += [*solver_names(block), *map(guess_name, block), *map(rate_name, block)]
            driven = sum(len(each.components) for each in spec.inputs)
            names += [*map(slope_name, range(driven))]
        if len(block) > LARGEST_BLOCK:
            names += names_for(block)
    return tuple(dict.fromkeys(names))


def _invert_block(
    setting: Setting, matrix: Matrix, known: list[Element], block: tuple[int, ...]
) -> dict[str, Element]:
    """Velocities of one block from ``mass * xi = known``, by name."""
    names = [setting.conjugates[i][0] for i in block]
    if witness_regular(setting.field, matrix) is None:
        raise _singular(setting, matrix, names)
    products = (zip(row, known, strict=True) for row in inverse(matrix))
    values = (sum((m * k for m, k in row), setting.field.zero) for row in products)
    return dict(zip(names, values, strict=True))


def _iterate(of: Mechanics, block: tuple[int, ...]) -> Solve:
    """Velocities of a block by Newton's iteration, its last step as an ordinary solve.

    Raises:
        DerivationError: The Hessian of the block at rest is not positive for certain.
    """
    setting, names = of.setting, of.frame.velocities
    _check_cost(setting, [names[i] for i in block])
    own = [names[i] for i in block]
    field, guess = setting.field, {names[i]: setting.field[guess_name(i)] for i in block}
    moved = {place: field.substitute(of.momenta[place], guess) for place in block}
    hessian = tuple(tuple(field.substitute(of.mass[i][j], guess) for j in block) for i in block)
    rest = dict.fromkeys(names, field.zero)
    try:
        still = tuple(tuple(field.substitute(of.mass[i][j], rest) for j in block) for i in block)
    except ZeroDivisionError as error:  # a root, a logarithm or a divisor of 0 at rest
        raise _not_solved(of, own, "d2l/dxi2 is not defined there") from error
    for size in range(1, len(block) + 1):
        minor = determinant(tuple(row[:size] for row in still[:size]))
        if not _is_positive(setting, minor):
            raise _not_solved(of, own, "d2l/dxi2 is not positive definite there for certain")
    mu = [_paired(setting, i) for i in block]
    products = [
        field.sum(entry * x for entry, x in zip(row, guess.values(), strict=True))
        for row in hessian
    ]
    known = [p + m - g for p, m, g in zip(products, mu, moved.values(), strict=True)]
    newton = Newton(block=block, sought=mu, slopes=[*moved.values()], hessian=hessian)
    return Solve(matrix=hessian, known=known, block=block, names=own, newton=newton)


def _is_positive(setting: Setting, element: Element) -> bool:
    """Whether an element is positive for certain: by itself, or times a condition of the domain."""
    field = setting.field
    if sign(field, element) == 1:
        return True
    conditions = (each for each in setting.spec.domain if not each.sign.endswith("="))
    excesses = (setting.excess(each) for each in conditions)
    return any(sign(field, element / each) == 1 for each in excesses if not field.is_zero(each))


def _solve_alone(of: Mechanics, block: tuple[int, ...]) -> Inverse | None:
    """A velocity that is coupled to no other, in closed form; None where there is none."""
    if len(block) > 1:
        return None
    (place,), setting = block, of.setting
    field, momentum, name = setting.field, of.momenta[place], of.frame.velocities[place]
    called = sorted(field.functions_in(of.lagrangian))
    domains = (field.domain_of(field.adjoined[g]) for g in called if name in field.reach(field[g]))
    asked = [each for each in domains if each is not None]
    return find_inverse(field, momentum, name, _paired(setting, place), asked)


def _solve_radially(of: Mechanics, block: tuple[int, ...]) -> list[Definition] | None:
    """Velocities of a block in which l is a function of one quadratic form; None where it is none.

    They are written in ``y = mu - dl/dxi`` at rest, which has a name where that is not 0.
    """
    setting, names = of.setting, [of.frame.velocities[i] for i in block]
    field = setting.field
    try:
        moving = [of.momenta[i] - at_rest(setting, of.momenta[i]) for i in block]
        known = dict(
            zip(map(forward_name, block), known_side(setting, of.momenta, block), strict=True)
        )
    except ZeroDivisionError as error:  # a root of 0 at rest
        raise _not_solved(of, names, "momenta are not defined there") from error
    parts = [(name, value) for name, value in known.items() if len(field.terms(value)) > 1]
    y = known | {name: field[name] for name, _ in parts}
    invert = partial(inverse_in_blocks, field, refuse=of.refusal)
    found = radial_solution(field, moving, names, [*y.values()], invert)
    return None if found is None else [*parts, *zip(names, found, strict=True)]


def _not_solved(of: Mechanics, names: Sequence[str], problem: str) -> DerivationError:
    """What is wrong with velocities that the kernel cannot solve for from rest on."""
    spec = of.setting.spec
    route = "euler-lagrange" if spec.algebra is None else "nonholonomic"
    momenta = " and ".join(each.name for each in spec.having_role("momentum"))
    message = (
        f"the Lagrangian is not quadratic in the velocities {', '.join(names)}, and the kernel "
        f"cannot solve mu = dl/dxi by Newton's iteration from rest: {problem}; expected one that "
        f"is certainly convex at rest. Give {_way_out(of.setting)} instead, or remove {momenta} "
        f"and take the route {route}, where velocities are the state."
    )
    return _refusal(of.setting, message, names[0])


def _check_pivots(setting: Setting, matrix: Matrix, block: tuple[int, ...]) -> None:
    """The leading minors of a block, of which the pivots are quotients, are not zero everywhere."""
    names = [setting.conjugates[i][0] for i in block]
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


def _check_cost(setting: Setting, names: Sequence[str]) -> None:
    """An iteration, each of whose steps is written out, is not too long for the kernel."""
    operations = STEPS * len(names) ** 3 // 3
    if operations > OPERATIONS:
        refused = _refusal(
            setting,
            f"the Lagrangian couples {len(names)} velocities ({', '.join(names)}) and is not "
            f"quadratic in them; Newton's iteration takes about {operations} operations; expected "
            f"at most {OPERATIONS} (OPERATIONS). Choose axes that decouple them, or give "
            f"{_way_out(setting)}.",
            names[0],
        )
        raise LimitError(str(refused), **refused.parts | {"limit": OPERATIONS})


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
        remedy += f"{' and '.join(names)}.{tell_constraints(mechanics(setting))}"
        if setting.spec.algebra is None:
            remedy += " Or take the route first-order, without the momenta that these are of."
        elif setting.spec.having_role("momentum") and not setting.spec.constraints:
            zero = ", ".join(f"{name} == 0" for name in names)
            remedy += " Or, of curves that are shortest within constraints, write [constraints] "
            remedy += f"with {zero} and variational = true, and take the route lie-poisson."
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
