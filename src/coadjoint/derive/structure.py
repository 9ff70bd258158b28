"""The Poisson structure of a system: that of an algebra's dual, a declared or a canonical one.

Comes in: a Setting. Goes out: the bracket ``{x_i, x_j}`` of the state. For an algebra it is the
minus (left) or plus (right) Lie-Poisson bracket of the semidirect product of the algebra with the
duals of the advected representations, and next to it the canonical bracket of coordinates with
momenta: that of a product. Read next: `coadjoint.poisson.structure`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from coadjoint.algebra import LieAlgebra, semidirect_product
from coadjoint.derive.mechanics.bound_momenta import bound_momenta
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.first_order import first_order
from coadjoint.derive.setting import Setting, once
from coadjoint.errors import AlgebraError
from coadjoint.exact.dense import product
from coadjoint.poisson import PoissonStructure, declare_bracket, lie_poisson, magnetic, nambu
from coadjoint.spec.model import Poisson
from coadjoint.spec.sections.poisson import pairing_weights


@once
def momentum_algebra(setting: Setting) -> LieAlgebra:
    """The algebra on whose dual the state lives: ``g (s) V`` with every advected a in V*.

    An advected quantity a of the representation rho lives in the dual of V, so V carries the dual
    action (Holm 2011, sections 7.2.1 and 9.4).
    """
    return exact_momentum_algebra(setting).over(setting.take_constant)


@once
def exact_momentum_algebra(setting: Setting) -> LieAlgebra:
    """The same algebra with constants as they are declared, in which every zero is decided."""
    algebra = setting.spec.algebra
    assert algebra is not None, f"{setting.spec.name} has a declared bracket and no algebra"
    declared = {each.name: each.representation for each in setting.advected}
    actions = [(name, action.dual()) for name, action in declared.items() if action is not None]
    return semidirect_product(algebra, actions) if actions else algebra


@once
def poisson_structure(setting: Setting) -> PoissonStructure:
    """The bracket of the state, its components in declared order.

    Raises:
        AlgebraError: A declared bracket cannot be one: its magnetic part is not closed.
    """
    bracket = setting.spec.poisson
    if bracket is not None:
        return _declared_structure(setting, bracket)
    if setting.spec.algebra is None:
        return _of_configuration(setting)
    whole = lie_poisson_structure(setting)
    if setting.spec.is_first_order:
        tensor = bound_momenta(setting).restrict(whole)
        return PoissonStructure(setting.field, setting.state, tensor, setting.spec.name)
    return _reorder(_add_pairs(whole, setting), setting.state)


@once
def canonical_pairs(setting: Setting) -> tuple[tuple[str, str, Fraction], ...]:
    """Coordinates next to an algebra with their momenta, and ``{q, p}``, by component."""
    spec, triples = setting.spec, list[tuple[str, str, Fraction]]()
    for q in spec.having_role("coordinate") if spec.algebra is not None else ():
        if (p := spec.partner("momentum", q.name)) is not None:
            weights = pairing_weights(len(p.components), p.form)
            triples += zip(q.components, p.components, weights, strict=True)
    return tuple(triples)


def _add_pairs(whole: PoissonStructure, setting: Setting) -> PoissonStructure:
    """The bracket of a product: of the dual of an algebra, and of coordinates with momenta."""
    if not canonical_pairs(setting):
        return whole
    field, names = whole.field, [*whole.names]
    names += [x for q, p, _ in canonical_pairs(setting) for x in (q, p)]
    known = {
        (a, b): entry
        for a, row in zip(whole.names, whole.tensor, strict=True)
        for b, entry in zip(whole.names, row, strict=True)
    }
    for q, p, weight in canonical_pairs(setting):
        known |= {(q, p): field.number(weight), (p, q): field.number(-weight)}
    tensor = tuple(tuple(known.get((a, b), field.zero) for b in names) for a in names)
    return PoissonStructure(field, tuple(names), tensor, whole.name)


@once
def lie_poisson_structure(setting: Setting) -> PoissonStructure:
    """The bracket of all momenta along the algebra, and of what is advected."""
    coordinates = (*setting.momenta, *setting.advected_names)
    sign = -setting.sign  # minus for left-invariant systems
    return lie_poisson(momentum_algebra(setting), setting.field, coordinates, sign)


def has_structure(setting: Setting) -> bool:
    """Whether a spec says enough for a bracket: velocities have one through a Lagrangian alone."""
    spec = setting.spec
    if spec.in_frame and spec.kind == "algebra":  # the bracket is one of momenta
        return False
    return spec.kind != "configuration" or bool(setting.momenta) or spec.lagrangian is not None


def _of_configuration(setting: Setting) -> PoissonStructure:
    """The canonical bracket of coordinates and momenta, or what it is in velocities.

    A Lagrangian of first order gives that of its one-form.

    With ``p = dl/dv``, the brackets {q, q}, {q, p} and {p, p} are canonical if

        {q, v} = M^-1,   {v, v} = M^-1 (A^T - A) M^-1,   M = dp/dv,  A = dp/dq.

    Raises:
        DerivationError: The mass matrix M cannot be inverted.
    """
    field, q = setting.field, setting.positions
    if setting.spec.is_first_order:
        name = setting.spec.name
        return PoissonStructure(field, setting.state, first_order(setting).tensor, name)
    if setting.momenta:
        pairs = list(zip(q, setting.momenta, strict=True))
        return _reorder(magnetic(field, pairs, {}, setting.weights), setting.state)
    known = mechanics(setting)
    W, A = known.inverse_mass, known.mixed
    turning = tuple(tuple(A[j][i] - A[i][j] for j in range(len(q))) for i in range(len(q)))
    velocities = product(product(W, turning), W)
    zero = (field.zero,) * len(q)
    rows = [(*zero, *row) for row in W]
    rows += [(*(-w for w in column), *row) for column, row in zip(W, velocities, strict=True)]
    names = (*q, *setting.velocities)
    return _reorder(PoissonStructure(field, names, tuple(rows), setting.spec.name), setting.state)


def _declared_structure(setting: Setting, bracket: Poisson) -> PoissonStructure:
    """The bracket that a spec states."""
    field, names = setting.field, setting.state
    entries = {(i, j): setting.formula(formula) for i, j, formula in bracket.entries}
    try:
        match bracket.kind:
            case "nambu":
                return nambu(field, names, [setting.formula(c) for c in bracket.functions])
            case "brackets":
                return declare_bracket(field, names, entries, setting.spec.name)
        pairs = [(names[i], names[j]) for i, j in bracket.pairs]
        fields = {(names[i], names[j]): value for (i, j), value in entries.items()}
        return _reorder(magnetic(field, pairs, fields, bracket.weights), names)
    except AlgebraError as error:
        formula = (*bracket.functions, *(formula for *_, formula in bracket.entries))[0]
        path, key = setting.spec.path, ".".join(formula.key.split(".")[:2])
        raise AlgebraError(
            f"{path}:{formula.line}: {key}: {error}\n{formula.excerpt}".rstrip(),
            path=str(path),
            line=formula.line,
            key=key,
            **error.parts,
        ) from None


def _reorder(structure: PoissonStructure, names: Sequence[str]) -> PoissonStructure:
    """The same bracket with its coordinates in another order; others commute with everything."""
    places = dict(zip(structure.names, range(len(structure.names)), strict=True))
    tensor = tuple(
        tuple(
            structure.tensor[places[a]][places[b]]
            if {a, b} <= places.keys()
            else structure.field.zero
            for b in names
        )
        for a in names
    )
    return PoissonStructure(structure.field, tuple(names), tensor, structure.name)
