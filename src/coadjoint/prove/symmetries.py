"""Symmetries: what is claimed of actions, momentum maps, brackets and maps of the state.

Comes in: Equations whose spec declares them. Goes out: statements with what must be zero.
Noether's theorem is used both ways: an invariant Hamiltonian gives an integral, whose rate is then
taken along the emitted motion; and a claimed integral gives a vector field, which must commute with
the motion. Read next: `coadjoint.poisson.momentum_maps`.

Source:
    Holm (2011), Geometric Mechanics II, sections 2.3, 9.4.1 and 11.1 to 11.3.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.interpret import Value, entries
from coadjoint.derive.mechanics.driving import explicit, list_time_reversed
from coadjoint.derive.symmetries import evaluate_components, momentum_map, positions, structure_of
from coadjoint.exact import Element, element_text
from coadjoint.groups.vector_fields import VectorField, lie_derivative
from coadjoint.poisson.momentum_maps import MomentumMap
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.driven import while_constant
from coadjoint.prove.identities import drift
from coadjoint.prove.motion import Motion
from coadjoint.prove.zero import Decision, Examined, decide_zero, mark_claimed
from coadjoint.spec.model import ClaimedBracket, Formula, Symmetry, Transformation

#: Entries of a cocycle that a statement shows.
SHOWN = 6


def about_symmetries(motion: Motion) -> Iterator[Examined]:
    """Claims about actions, their momentum maps, and brackets."""
    first, spec, field, known = motion.equations, motion.spec, motion.field, motion.emitted
    energy = first.exact.energy
    of_motion = spec.constraints or spec.reduction  # these are claimed of the motion
    for symmetry in () if of_motion else spec.symmetries:
        J = momentum_map(first, symmetry)
        of_map = [*_about_map(first, symmetry, J)]
        if energy is not None:
            of_map += _noether(first, symmetry, J, first.close(energy))
        yield from mark_claimed(spec, ("symmetries", symmetry.name), symmetry.place, of_map, field)
    if energy is not None:
        yield from _about_integrals(first, known)
    for place, claim in enumerate(spec.brackets):
        text = f"{{{claim.left.in_one_line}, {claim.right.in_one_line}}}"
        statement = f"{text} = {claim.value.in_one_line}"
        defects = partial(_claimed_bracket, first, claim, known)
        claimed = [(statement, "bracket", partial(decide_on, motion, defects))]
        yield from mark_claimed(spec, ("claims", "brackets", place), claim.value, claimed, field)


def about_transformations(motion: Motion) -> Iterator[Examined]:
    """Claims about maps of the state."""
    for transformation in motion.spec.transformations:
        yield from _about_transformation(motion, transformation)


# -- momentum maps --------------------------------------------------------------------------------


def _about_map(first: Equations, symmetry: Symmetry, J: MomentumMap) -> Iterator[Examined]:
    """The action and its momentum map."""
    name, algebra, kind = symmetry.name, symmetry.algebra.name, "symmetry"
    yield (
        f"the generators of {name} act as {algebra} from the {symmetry.side}",
        kind,
        J.action_defects,
    )
    yield f"the generators of {name} preserve the bracket", kind, J.bracket_defects
    yield f"{name} is their momentum map: {{x, {name}}} = dx/ds", kind, J.field_defects
    sign = "" if symmetry.side == "left" else "-"
    law = f"{{{name}_xi, {name}_eta}} = {sign}{name}_[xi, eta]"
    if J.cocycle:
        yield (
            f"{law} + Sigma(xi, eta) with the constant 2-cocycle {_cocycle(first, symmetry, J)}",
            kind,
            lambda: [*J.constancy_defects(), *J.cocycle_defects()],
        )
    else:
        yield f"{law}: {name} is a Poisson map", kind, lambda: list(J.cocycle.values())


def _cocycle(first: Equations, symmetry: Symmetry, J: MomentumMap) -> str:
    """The entries of a cocycle, as far as they are shown."""
    basis, field = symmetry.algebra.basis, first.setting.field
    texts = [
        f"Sigma({basis[i]}, {basis[j]}) = {element_text(field, value)}"
        for (i, j), value in J.cocycle.items()
    ]
    return ", ".join(texts[:SHOWN] + ["..."] * (len(texts) > SHOWN))


def _noether(
    first: Equations, symmetry: Symmetry, J: MomentumMap, h: Element
) -> Iterator[Examined]:
    """What h, which its flow keeps, leaves of J: nothing is claimed of the other components.

    Without forces it is conserved; else they alone change it, and the law is told.
    """
    rates, setting = J.rates(h), first.setting
    own = [explicit(setting, first.close(value)) + first.work(value) for value in J.values]
    kept = [n for n, rate in enumerate(rates) if rate == 0]
    invariant = [n for n in kept if setting.field.is_zero(own[n])]
    if invariant:
        names = [symmetry.components[n] for n in invariant]
        subject = symmetry.name if len(invariant) == len(rates) else ", ".join(names)
        idle = " and forces and dissipation do not change it" * first.spec.is_driven
        yield (
            f"{subject} is conserved by Noether's theorem, since its flow keeps h{idle}"
            f"{while_constant(first, [J.values[n] for n in invariant])}",
            "symmetry",
            lambda: [defect for n in invariant for defect in drift(first, J.values[n])],
        )
    for n in (n for n in kept if n not in invariant):
        yield (
            f"d{symmetry.components[n]}/dt = {element_text(setting.field, own[n])}, since its flow "
            "keeps h",
            "symmetry",
            partial(_defects_of_law, first, J.values[n], own[n]),
        )


def _defects_of_law(first: Equations, value: Element, rate: Element) -> list[Element]:
    """The rate of a function along the motion, less the one that is claimed."""
    return [defect - rate for defect in drift(first, value)]


# -- integrals and their symmetries ---------------------------------------------------------------


def _about_integrals(first: Equations, known: Mapping[str, Value]) -> Iterator[Examined]:
    """Of each claimed integral, that its Hamiltonian vector field commutes with the motion.

    On phase spaces, where no force acts; over an algebra the reduced space has no positions to be
    moved, and under constraints the bracket does not satisfy the Jacobi identity.
    """
    if first.spec.algebra is not None or first.spec.is_driven or first.spec.constraints:
        return
    for place, claim in enumerate(first.spec.conserved):
        parts = first.setting.components(claim.formula, known)
        reached = frozenset[str]().union(*map(first.setting.field.reach, parts))
        followed = reached & {name for name, _ in first.followed}
        if claim.where or claim.everywhere == "energy" or followed:
            continue
        flows = _flows(first, claim.formula, known)
        statement = (
            f"the flow of {claim.formula.in_one_line} takes motions to motions"
            f"{_kind_of(first, flows)}"
            f"{while_constant(first, first.setting.components(claim.formula, known))}"
        )
        follows = [(statement, "symmetry", partial(_commutators, first, flows))]
        key = ("claims", "conserved", place)  # it follows from the claim there
        yield from mark_claimed(first.spec, key, claim.formula, follows, first.setting.field)


def _flows(first: Equations, formula: Formula, known: Mapping[str, Value]) -> list[VectorField]:
    """The Hamiltonian vector field of each component of an integral."""
    structure = structure_of(first)
    parts = map(first.close, first.setting.components(formula, known))
    return [
        VectorField(structure.field, structure.names, structure.hamiltonian_vector_field(part))
        for part in parts
    ]


def _kind_of(first: Equations, flows: Sequence[VectorField]) -> str:
    """Whether positions move by themselves, or only with the momenta; empty where none can tell.

    The flow moves positions by themselves if their rates along it depend on positions alone.
    """
    field, space = first.setting.field, set(positions(first.setting))
    if not space:
        return ""
    slopes = [
        field.derivative(part, momentum)
        for X in flows
        for name, part in zip(X.names, X.components, strict=True)
        if name in space
        for momentum in X.names
        if momentum not in space
    ]
    verdict = decide_zero(slopes, field).verdict
    if verdict is Verdict.SUPPORTED:
        return ""
    if verdict is Verdict.PROVED:
        return ", a transformation of positions"
    return ", a hidden symmetry: its flow is not a transformation of positions alone"


def _commutators(first: Equations, flows: Sequence[VectorField]) -> list[Element]:
    """``[X_h, X_F] + dX_F/dt`` with the emitted rates as X_h."""
    setting = first.setting
    rates = tuple(map(first.close, first.exact.rates))
    motion = VectorField(setting.field, setting.state, rates)
    return [
        part + explicit(setting, own)
        for X in flows
        for part, own in zip(lie_derivative(motion, X).components, X.components, strict=True)
    ]


# -- brackets and transformations -----------------------------------------------------------------


def _claimed_bracket(
    first: Equations, claim: ClaimedBracket, known: Mapping[str, Value]
) -> list[Element]:
    """``{left_i, right_j} - value_ij``."""
    structure = structure_of(first)

    def parts(formula: Formula) -> list[Element]:
        return [first.close(part) for part in first.setting.components(formula, known)]

    brackets = [structure.bracket(a, b) for a in parts(claim.left) for b in parts(claim.right)]
    return [a - b for a, b in zip(brackets, parts(claim.value), strict=True)]


def _about_transformation(motion: Motion, transformation: Transformation) -> Iterator[Examined]:
    """That a map keeps the motion, and what it does to observables."""
    spec, name = motion.spec, transformation.name
    goal = "its reverse" if transformation.reverses_time else "itself"
    key, kind, field = ("transformations", name), "transformation", motion.field
    moved = partial(_motion_defects, motion, transformation)
    examined = [(f"{name} takes the motion to {goal}", kind, partial(decide_on, motion, moved))]
    yield from mark_claimed(spec, key, next(iter(transformation.map.values())), examined, field)
    for observable, formula in transformation.exchanges.items():
        exchanged = partial(_exchange_defects, motion, transformation, observable, formula)
        statement = f"{name} takes {observable} to {formula.in_one_line}"
        examined = [(statement, kind, partial(decide_on, motion, exchanged))]
        yield from mark_claimed(spec, (*key, "exchanges", observable), formula, examined, field)


def decide_on(motion: Motion, defects: Callable[[], Sequence[Element]]) -> Decision:
    """Whether defects are zero where the motion is."""
    return decide_zero(defects(), motion.field, motion.where)


def _move_state(motion: Motion, transformation: Transformation) -> dict[str, Element]:
    """The image of each component of the state, and of time and rates of inputs."""
    setting, field = motion.setting, motion.field
    images = {name: field[name] for name in setting.state}
    if transformation.reverses_time:
        images |= {name: -field[name] for name in list_time_reversed(setting)}
    moved = evaluate_components(setting, transformation.map)
    return images | {name: motion.close(image) for name, image in moved.items()}


def _motion_defects(motion: Motion, transformation: Transformation) -> list[Element]:
    """``D phi . X + dphi/dt -+ X o phi``, and the kept constraints after the map."""
    setting, field, phi = motion.setting, motion.field, _move_state(motion, transformation)
    rates = motion.written_rates
    whole = VectorField(field, setting.state, tuple(rates.values()))
    sign = -1 if transformation.reverses_time else 1
    return [
        *(
            whole.derivative(phi[name])
            + explicit(setting, phi[name])
            - sign * field.substitute(rate, phi)
            for name, rate in rates.items()
        ),
        *(field.substitute(residual, phi) for _, residual in motion.kept),
    ]


def _exchange_defects(
    motion: Motion, transformation: Transformation, observable: str, formula: Formula
) -> list[Element]:
    """``F o phi`` minus what it should be."""
    field, known = motion.field, motion.emitted
    phi, parts = _move_state(motion, transformation), entries(known[observable])
    moved = [field.substitute(motion.write(part), phi) for part in parts]
    expected = map(motion.write, motion.setting.components(formula, known))
    return [a - b for a, b in zip(moved, expected, strict=True)]
