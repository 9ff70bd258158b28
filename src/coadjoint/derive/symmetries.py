r"""The momentum maps of declared symmetries, and the vector fields of their actions.

Theorem (Holm 2011, sections 9.4.1 and 11.2): the cotangent lift of an action on positions has the
momentum map :math:`J^\xi = \langle p, \xi_Q(q)\rangle`, and :math:`\langle p, \xi_Q\rangle - E\tau`
where time moves, too (section 2.3.1). Actions on the whole phase space have the function whose
Hamiltonian vector field they are.
Comes in: a Setting, or Equations. Goes out: components by name, or a `MomentumMap` to be proved.
Read next: `coadjoint.poisson.momentum_maps`, then `coadjoint.prove.symmetries`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType

from coadjoint.derive.equations import Equations
from coadjoint.derive.interpret import Value, entries
from coadjoint.derive.mechanics.configuration import kept_entries, mechanics
from coadjoint.derive.setting import Setting, fault, once, shape
from coadjoint.derive.structure import canonical_pairs, has_structure, poisson_structure
from coadjoint.errors import AlgebraError, DerivationError
from coadjoint.exact import Element
from coadjoint.exact.dense import scale
from coadjoint.groups.vector_fields import VectorField
from coadjoint.poisson.momentum_maps import MomentumMap, Pair, generating_function, lift
from coadjoint.poisson.structure import PoissonStructure
from coadjoint.spec import Formula
from coadjoint.spec.core.components import FORMS
from coadjoint.spec.model import Symmetry, unpack

#: Components that move, by name.
Moves = Mapping[str, Element]
_NOTHING: Mapping[str, Value] = MappingProxyType({})


def momentum_maps(setting: Setting, energy: Element | None) -> dict[str, tuple[Element, ...]]:
    """The components of each declared momentum map, by its name.

    Raises:
        DerivationError: A generator has no momentum map that could be found, or does not keep the
            form of a matrix.
    """
    return {each.name: _values(setting, each, energy) for each in setting.spec.symmetries}


def share_of(setting: Setting, symmetry: Symmetry, names: Iterable[str]) -> tuple[Element, ...]:
    """The share that some components of the state have in J: those of one of equal members.

    Args:
        setting: Of the state.
        symmetry: An action that moves each member by itself, and whose J is not declared.
        names: Components of the state.

    Raises:
        DerivationError: As `momentum_maps`.
    """
    elements, own = _elements(setting, symmetry), frozenset(names)
    moved = ((x, _moves(setting, symmetry, x)) for x in elements)
    shares = ({n: value for n, value in moves.items() if n in own} for _, moves in moved)
    return tuple(_lift(setting, symmetry, moves) for moves in shares)


def evaluate_map(
    setting: Setting, symmetry: Symmetry, evaluate: Callable[[Mapping[str, Value]], Element]
) -> tuple[Element, ...]:
    """A part of a declared J along each basis vector.

    Args:
        setting: Of the state.
        symmetry: With a declared J.
        evaluate: The value of the part where the names of the element have these values.
    """
    elements = _elements(setting, symmetry)
    return tuple(evaluate(_name_element(symmetry, element)) for element in elements)


def in_formulas(symmetry: Symmetry, components: Sequence[Element]) -> Value:
    """The components of a momentum map as what it is in formulas."""
    if symmetry.form in ("antisymmetric", "symmetric"):
        return unpack(components, symmetry.form)
    return shape(components, symmetry.shape)


def momentum_map(equations: Equations, symmetry: Symmetry) -> MomentumMap:
    """A declared momentum map with the bracket and the generators that it is proved with.

    The generators are as declared; of an action on positions alone the lift gives the rest where
    momenta are canonical, and elsewhere J itself.
    """
    setting, structure = equations.setting, structure_of(equations)
    values = tuple(map(equations.close, _values(setting, symmetry, equations.exact.energy)))
    motion = _flow_of_energy(equations)
    generators = []
    for element, value in _maps_at_rest(setting)[symmetry.name]:
        resting = equations.close(value)
        X, is_lifted = _generator(setting, structure, symmetry, element, resting)
        if symmetry.time is not None:
            energy = equations.exact.energy
            assert energy is not None, "the values were refused without one"
            tau = equations.close(_evaluate_at(setting, symmetry.time, symmetry, element))
            X = X - motion.like(scale(tau, motion.components))
            if is_lifted:  # of positions and time together: the momentum of time is -E
                turned = structure.hamiltonian_vector_field(tau)
                X = X - motion.like(scale(equations.close(energy), turned))
        generators.append(X)
    algebra = symmetry.algebra.over(setting.take_constant)
    sign = 1 if symmetry.side == "left" else -1
    return MomentumMap(
        algebra=algebra, structure=structure, generators=tuple(generators), values=values, sign=sign
    )


def _flow_of_energy(equations: Equations) -> VectorField:
    """The motion without what forces add."""
    setting, exact = equations.setting, equations.exact
    forces = exact.forces or (setting.field.zero,) * len(exact.rates)
    free = (x - force for x, force in zip(exact.rates, forces, strict=True))
    return VectorField(setting.field, setting.state, tuple(map(equations.close, free)))


def moves_of(setting: Setting, symmetry: Symmetry) -> list[Moves]:
    """The components that each basis vector of the algebra moves, as declared."""
    return [_moves(setting, symmetry, element) for element in _elements(setting, symmetry)]


def shifts_of(setting: Setting, symmetry: Symmetry) -> list[Element]:
    """The shift of time along each basis vector: zero unless it is declared."""
    if symmetry.time is None:
        return [setting.field.zero] * symmetry.algebra.dimension
    elements = _elements(setting, symmetry)
    return [_evaluate_at(setting, symmetry.time, symmetry, each) for each in elements]


def structure_of(equations: Equations) -> PoissonStructure:
    """The emitted bracket, velocities substituted."""
    tensor = equations.exact.poisson_tensor
    assert tensor is not None, "only what has a bracket is asked for it"
    closed = tuple(tuple(map(equations.close, row)) for row in tensor)
    return PoissonStructure(equations.setting.field, equations.setting.state, closed)


def positions(setting: Setting) -> tuple[str, ...]:
    """Components whose momenta are known; empty where the bracket pairs nothing."""
    bracket = setting.spec.poisson
    if bracket is not None:
        return tuple(setting.state[i] for i, _ in bracket.pairs)
    return setting.positions


# -- elements of the algebra and what they move ---------------------------------------------------


def _elements(setting: Setting, symmetry: Symmetry) -> list[Value]:
    """Each basis vector as formulas have it: a scalar, a vector, a matrix, or its place."""
    field, algebra = setting.field, symmetry.algebra
    n = algebra.dimension
    if symmetry.linear or symmetry.as_matrix:
        count = 1 + max(max(place) for matrix in algebra.matrices for place in matrix)
        return [
            tuple(
                tuple(
                    field.zero + setting.take_constant(matrix.get((r, c), 0)) for c in range(count)
                )
                for r in range(count)
            )
            for matrix in algebra.matrices
        ]
    if n == 1:
        return [field.one]
    return [field.vector(int(i == k) for i in range(n)) for k in range(n)]


def _evaluate_at(setting: Setting, formula: Formula, symmetry: Symmetry, element: Value) -> Element:
    """A scalar formula at one element."""
    return setting.formula(formula, _name_element(symmetry, element))


def _name_element(symmetry: Symmetry, element: Value) -> dict[str, Value]:
    """An element, and its parts along the blocks of the algebra, by the names in formulas."""
    named = {symmetry.element: element}
    if not symmetry.as_matrix and isinstance(element, tuple):
        for block, places in symmetry.algebra.blocks.items():
            part = tuple(element[place] for place in places)
            named[f"{symmetry.element}_{block}"] = part if len(part) > 1 else part[0]
    return named


def _moves(setting: Setting, symmetry: Symmetry, element: Value) -> Moves:
    """The components that an element moves, as declared."""
    if symmetry.linear:
        by_name = {variable.name: variable for variable in setting.spec.state}
        names = [x for name in symmetry.linear for x in by_name[name].components]
        symbols = setting.elements(names)
        return {
            name: setting.field.sum(a * x for a, x in zip(row, symbols, strict=True) if a)
            for name, row in zip(names, element, strict=True)
        }
    return evaluate_components(setting, symmetry.generators, _name_element(symmetry, element))


def evaluate_components(
    setting: Setting, formulas: Mapping[str, Formula], known: Mapping[str, Value] = _NOTHING
) -> dict[str, Element]:
    """Values of formulas for variables of the state, by the components of these.

    Raises:
        DerivationError: A matrix is not of the form of its variable.
    """
    components: dict[str, Element] = {}
    for variable in setting.spec.state:
        formula = formulas.get(variable.name)
        if formula is not None:
            parts = entries(setting.value(formula, known))
            if variable.form in FORMS:
                parts = kept_entries(setting, parts, variable.form, formula)
            components |= zip(variable.components, parts, strict=True)
    return components


# -- the map and the vector field -----------------------------------------------------------------


def _values(setting: Setting, symmetry: Symmetry, energy: Element | None) -> tuple[Element, ...]:
    """J of each basis vector."""
    values = []
    for element, value in _maps_at_rest(setting)[symmetry.name]:
        if symmetry.time is not None:
            if energy is None:
                problem = "time moves, and the motion has no energy"
                raise _fault(setting, symmetry.time, problem, "Leave time out.")
            value = value - energy * _evaluate_at(setting, symmetry.time, symmetry, element)
        values.append(value)
    return tuple(values)


@once
def _maps_at_rest(setting: Setting) -> dict[str, list[tuple[Value, Element]]]:
    """J of each basis vector without the part of time, by the names of the momentum maps."""
    return {
        each.name: [(x, _value(setting, each, x)) for x in _elements(setting, each)]
        for each in setting.spec.symmetries
    }


def _value(setting: Setting, symmetry: Symmetry, element: Value) -> Element:
    """J of one element, without the part of time."""
    if symmetry.map is not None:
        return _evaluate_at(setting, symmetry.map, symmetry, element)
    return _lift(setting, symmetry, _moves(setting, symmetry, element))


def _lift(setting: Setting, symmetry: Symmetry, moves: Moves) -> Element:
    """The momentum map of moves of positions, or of the state."""
    covector = _covector(setting)
    if moves.keys() <= covector.keys():
        return setting.field.sum(covector[q] * moved for q, moved in moves.items())
    formula = next(iter(symmetry.generators.values()), None)
    if setting.spec.constraints or not has_structure(setting):
        problem = "only a Poisson bracket says what generates it, and none is declared here"
        raise _fault(setting, formula, problem, "Declare the momentum map as map.", symmetry)
    try:
        structure = poisson_structure(setting)
        return generating_function(structure, _extend_moves(setting, moves))
    except AlgebraError as error:
        raise _fault(setting, formula, str(error).rstrip("."), "", symmetry) from None


def _pairs(setting: Setting) -> list[Pair]:
    """Positions with canonical momenta; empty with magnetic terms, and without momenta."""
    bracket, field, names = setting.spec.poisson, setting.field, setting.state
    if setting.spec.is_first_order:
        return []
    if canonical_pairs(setting):
        return [(q, p, field.zero + weight) for q, p, weight in canonical_pairs(setting)]
    if bracket is None:
        weights = setting.weights if setting.momenta else ()
        return [
            (q, p, field.zero + weight)
            for q, p, weight in zip(setting.positions, setting.momenta, weights, strict=False)
        ]
    if bracket.entries:
        return []
    return [
        (names[i], names[j], field.number(weight))
        for (i, j), weight in zip(bracket.pairs, bracket.weights, strict=True)
    ]


def _covector(setting: Setting) -> dict[str, Element]:
    """What pairs with the velocity of each position; empty with magnetic terms."""
    field = setting.field
    pairs = _pairs(setting)
    if pairs or setting.spec.poisson is not None or setting.spec.lagrangian is None:
        return {q: field[p] / weight for q, p, weight in pairs}
    slopes = mechanics(setting).momenta  # those of coordinates are the last of a frame
    own = len(slopes) - len(setting.positions)
    return dict(zip(setting.positions, slopes[own:], strict=True))


def _generator(
    setting: Setting,
    structure: PoissonStructure,
    symmetry: Symmetry,
    element: Value,
    resting: Element,
) -> tuple[VectorField, bool]:
    """The vector field of one element on the whole state, time standing still.

    Args:
        setting: The spec and its field.
        structure: The bracket.
        symmetry: What is declared.
        element: A basis vector of the algebra.
        resting: J of it without the part of time.

    Returns:
        The field, and whether it is lift from the positions, not declared on the whole state.
    """
    moves, pairs = _moves(setting, symmetry, element), _pairs(setting)
    if not moves.keys() <= set(positions(setting)):
        return _extend_moves(setting, moves), False
    if pairs:
        return lift(structure, pairs, moves), True
    by_map = structure.hamiltonian_vector_field(resting)
    declared = dict.fromkeys(positions(setting), setting.field.zero) | dict(moves)
    named = dict(zip(setting.state, by_map, strict=True)) | declared
    whole = VectorField(setting.field, setting.state, tuple(named[x] for x in setting.state))
    return whole, True


def _extend_moves(setting: Setting, moves: Moves) -> VectorField:
    """A vector field on the state; what is not named stands still."""
    zero = setting.field.zero
    return VectorField(
        setting.field, setting.state, tuple(moves.get(x, zero) for x in setting.state)
    )


def _fault(
    setting: Setting,
    formula: Formula | None,
    problem: str,
    hint: str,
    symmetry: Symmetry | None = None,
) -> DerivationError:
    """An error at a formula, or at a symmetry without one."""
    message = f"{problem}. {hint}".rstrip()
    if formula is not None:
        return fault(setting, formula, message, formula.text)
    path, key = str(setting.spec.path), f"symmetries.{symmetry.name if symmetry else ''}"
    return DerivationError(f"{path}: {key}: {message}", path=path, key=key, found="")
