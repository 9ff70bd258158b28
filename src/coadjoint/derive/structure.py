"""The Poisson structure of a system: that of an algebra's dual, or a declared one.

Comes in: a Setting. Goes out: the bracket ``{x_i, x_j}`` of the state. For an algebra it is the
minus (left) or plus (right) Lie-Poisson bracket of the semidirect product of the algebra with the
duals of the advected representations. Read next: `coadjoint.poisson.structure`.
"""

from __future__ import annotations

from collections.abc import Sequence

from coadjoint.algebra import LieAlgebra, semidirect_product
from coadjoint.derive.setting import Setting
from coadjoint.errors import AlgebraError
from coadjoint.poisson import PoissonStructure, declared, lie_poisson, magnetic, nambu
from coadjoint.spec.model import Poisson


def momentum_algebra(setting: Setting) -> LieAlgebra:
    """The algebra on whose dual the state lives: ``g (s) V`` with every advected a in V*.

    An advected quantity a of the representation rho lives in the dual of V, so V carries the dual
    action (Holm 2011, sections 7.2.1 and 9.4).
    """
    actions = [(name, action.dual()) for name, action in setting.actions.items()]
    return semidirect_product(setting.algebra, actions) if actions else setting.algebra


def poisson_structure(setting: Setting) -> PoissonStructure:
    """The bracket of the state, its components in declared order.

    Raises:
        AlgebraError: A declared bracket cannot be one: its magnetic part is not closed.
    """
    bracket = setting.spec.poisson
    if bracket is not None:
        return _declared(setting, bracket)
    advected = [name for variable in setting.advected for name in variable.components]
    coordinates = (*setting.momenta, *advected)
    sign = -setting.sign  # minus for left-invariant systems
    whole = lie_poisson(momentum_algebra(setting), setting.field, coordinates, sign)
    return _reordered(whole, setting.state)


def _declared(setting: Setting, bracket: Poisson) -> PoissonStructure:
    """The bracket that a spec states."""
    field, names = setting.field, setting.state
    entries = {(i, j): setting.formula(formula) for i, j, formula in bracket.entries}
    try:
        match bracket.kind:
            case "nambu":
                return nambu(field, names, [setting.formula(c) for c in bracket.functions])
            case "brackets":
                return declared(field, names, entries, setting.spec.name)
        pairs = [(names[i], names[j]) for i, j in bracket.pairs]
        fields = {(names[i], names[j]): value for (i, j), value in entries.items()}
        return _reordered(magnetic(field, pairs, fields, bracket.weights), names)
    except AlgebraError as error:
        formula = (*bracket.functions, *(formula for *_, formula in bracket.entries))[0]
        path, key = setting.spec.path, ".".join(formula.key.split(".")[:2])
        raise AlgebraError(
            f"{path}:{formula.line}: {key}: {error}",
            path=str(path),
            line=formula.line,
            key=key,
            **error.parts,
        ) from None


def _reordered(structure: PoissonStructure, names: Sequence[str]) -> PoissonStructure:
    """The same bracket with its coordinates in another order."""
    places = [structure.names.index(name) for name in names]
    tensor = tuple(tuple(structure.tensor[i][j] for j in places) for i in places)
    return PoissonStructure(structure.field, tuple(names), tensor, structure.name)
