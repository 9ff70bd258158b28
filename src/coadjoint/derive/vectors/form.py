"""The vector form of equations of motion: what is shown above their components.

Comes in: Equations. Goes out: a `VectorForm`. Read next: `coadjoint.derive.vectors.recognise`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.noise import noise_fields
from coadjoint.derive.setting import assemble
from coadjoint.derive.vectors.affine import affine_lines
from coadjoint.derive.vectors.attitudes import tell_attitudes
from coadjoint.derive.vectors.balance import balance_lines, momentum_of
from coadjoint.derive.vectors.brackets import BASIS, commutator_lines, plane_lines
from coadjoint.derive.vectors.gradients import total_of
from coadjoint.derive.vectors.lines import VectorForm, VectorLine, rate_of
from coadjoint.derive.vectors.members import member_form
from coadjoint.derive.vectors.recognise import (
    is_short,
    owner_name,
    recognise,
    recognise_scalar,
)
from coadjoint.derive.vectors.vocabulary import Candidate, Vocabulary, measure
from coadjoint.derive.vectors.words import make_vocabulary
from coadjoint.notation.trees import BY_PROCESS, DIFFERENTIAL, IN_TIME
from coadjoint.notation.written import Written
from coadjoint.spec import Spec
from coadjoint.spec.core import tree


def vector_form(equations: Equations) -> VectorForm:
    """The equations of motion by whole vectors and matrices, as far as they are found."""
    if equations.spec.family is not None:
        return member_form(equations)
    vocabulary = make_vocabulary(equations)
    lines, missing, told = plane_lines(equations), list[str](), ""
    balance = balance_lines(equations) if equations.spec.constraints else None
    for target in vocabulary.targets:
        if balance is not None and _is_solved(equations, target):
            missing.append(owner_name(target.node))
            continue
        found, left = _find_lines(equations, vocabulary, target)
        lines += found
        missing += left
    within = frozenset[str]()
    if missing:
        found, within = affine_lines(equations)
        covered = {line.left for line in found}
        missing = [each for each in missing if rate_of(tree.Name(each)) not in covered]
        lines += found
    if not equations.spec.noise:
        products = list(_scalar_lines(equations, vocabulary, missing))
        within |= {owner_name(left) for left, _ in products}
        missing = [each for each in missing if each not in within]
        lines += [VectorLine(rate_of(left), right) for left, right in products]
    lines += _named(vocabulary, lines)
    shapes, written = dict(vocabulary.shapes), dict[str, Written]()
    if missing and balance is not None:
        lines = [*balance.lines, *_by_velocity(equations, lines)]
        missing = []
        shapes |= balance.shapes
        written |= balance.written
        told = balance.told
    lines += _momentum_lines(equations, vocabulary)
    lines += _short_names(equations.spec, vocabulary, lines)
    if _names_basis(lines):
        told = f"E_k is the basis of {equations.setting.algebra.name}"
    told = "; ".join(filter(None, (told, *tell_attitudes(equations.spec, lines))))
    return VectorForm(
        lines=tuple(lines),
        missing=tuple(missing),
        shapes=shapes,
        written=written,
        told=told,
        within=within,
    )


def _scalar_lines(
    equations: Equations, vocabulary: Vocabulary, missing: Collection[str]
) -> Iterator[tuple[tree.Name, tree.Node]]:
    """Scalars of the state, and components without vectors, whose rates are scalar products."""
    setting = equations.setting
    for name, rate in zip(equations.variables, equations.exact.rates, strict=True):
        owner = next((v for v in equations.spec.state if name in v.components), None)
        if owner is None or (owner.value_shape and name not in missing):
            continue
        value = equations.close(rate)
        reached = setting.field.reach(value)
        if reached & set(setting.velocities):  # of fields, whose rates do not name momenta
            continue
        found = recognise_scalar(vocabulary, value)
        if found and is_short(total_of(found)):
            yield tree.Name(name), total_of(found)


def _is_solved(equations: Equations, target: Candidate) -> bool:
    """Whether the kernel solves for the rates of a velocity, which its balance tells without."""
    variable = next(v for v in equations.spec.state if v.name == owner_name(target.node))
    unknown = {name for each in equations.exact.solves for name in each.names}
    rates = dict(zip(equations.variables, equations.exact.rates, strict=True))
    return any(unknown & equations.setting.field.reach(rates[n]) for n in variable.components)


def _by_velocity(equations: Equations, lines: Sequence[VectorLine]) -> Iterator[VectorLine]:
    """Lines, with the rates of coordinates by the velocities that constraints give."""
    rates = dict(zip(equations.variables, equations.exact.rates, strict=True))
    for line in lines:
        right = line.right
        for v in equations.spec.having_role("velocity"):
            moved = next((q for q in equations.spec.state if q.name == v.of), None)
            if moved is not None and line.left == rate_of(tree.Name(moved.name)):
                own = [rates[n] for n in moved.components]
                right = (
                    tree.Name(v.name)
                    if own == [*equations.setting.elements(v.components)]
                    else right
                )
        yield VectorLine(line.left, right)


def _names_basis(lines: Sequence[VectorLine]) -> bool:
    """Whether lines name the basis of the algebra."""
    nodes = (node for line in lines for node in tree.walk(line.right))
    return any(isinstance(node, tree.Entry) and node.name == BASIS for node in nodes)


def _find_lines(
    equations: Equations, vocabulary: Vocabulary, target: Candidate
) -> tuple[list[VectorLine], list[str]]:
    """The equation of a whole quantity, or those of its parts, and what is left of it."""
    whole = _find_line(equations, vocabulary, target)
    if whole is not None:
        return [whole], []
    name = owner_name(target.node)
    lines, told = list[VectorLine](), set[str]()
    for part in vocabulary.parts.get(name, ()) if not equations.spec.noise else ():
        line = _find_line(equations, vocabulary, part.rate)
        if line is not None:
            lines.append(line)
            told |= set(part.components)
    (variable,) = (v for v in equations.spec.state if v.name == name)
    if not lines and variable.role == "momentum" and not equations.spec.noise:
        lines = commutator_lines(equations, variable)
        told = {*variable.components} if lines else told
    return lines, [n for n in variable.components if n not in told] if lines else [name]


def _find_line(
    equations: Equations, vocabulary: Vocabulary, target: Candidate
) -> VectorLine | None:
    """The equation of a whole quantity, with what each Wiener process does to it; None if unfound.

    The drift and the field of each process are found equal to their components one by one.
    """
    found = recognise(vocabulary, target.value)
    if found is None and measure(target.value) == (2,):
        # in a plane a component of the state may stand before a turn by a right angle
        wider = replace(vocabulary, scalars=vocabulary.scalars | vocabulary.moving)
        found = recognise(wider, target.value)
    if found is None or not is_short(total_of(found)):
        return None
    fields = noise_fields(equations.setting)
    if not fields:
        return VectorLine(rate_of(target.node), total_of(found))
    (variable,) = (v for v in equations.spec.state if v.name == owner_name(target.node))
    parts = [tree.Call(function=IN_TIME, arguments=(total_of(found),))] * bool(found)
    for each in fields:
        moved = dict(zip(equations.setting.state, each.field, strict=True))
        found = recognise(vocabulary, assemble(variable, moved))
        if found is None or not is_short(total_of(found)):
            return None
        if found:
            process = tree.Name(each.name)
            parts.append(tree.Call(function=BY_PROCESS, arguments=(total_of(found), process)))
    whole: tree.Node = tree.Number(Fraction(0))
    for n, part in enumerate(parts):
        whole = tree.Binary(operator="+", left=whole, right=part) if n else part
    return VectorLine(tree.Call(function=DIFFERENTIAL, arguments=(target.node,)), whole)


def _named(vocabulary: Vocabulary, lines: Sequence[VectorLine]) -> Iterator[VectorLine]:
    """What the further names stand for that lines use."""
    for node, right in vocabulary.named:
        if any(node in tree.walk(line.right) for line in lines):
            yield VectorLine(node, right)


def _momentum_lines(equations: Equations, vocabulary: Vocabulary) -> Iterator[VectorLine]:
    """Momenta by velocities, where the Lagrangian gives them as a vector."""
    setting, spec = equations.setting, equations.spec
    if spec.lagrangian is None or spec.algebra is None or spec.family is not None:
        return
    for momentum in spec.having_role("momentum"):
        twins = [v for v in spec.having_role("velocity") if v.block == momentum.block]
        if len(twins) != 1 or momentum.of or len(momentum.value_shape) != 1:
            continue
        node = momentum_of(setting, twins[0], vocabulary.shapes)
        if node is not None:
            yield VectorLine(tree.Name(momentum.name), node)


def _short_names(
    spec: Spec, vocabulary: Vocabulary, lines: Sequence[VectorLine]
) -> Iterator[VectorLine]:
    """What short names of the spec stand for that lines use, or that these use themselves."""
    shown = list[VectorLine]()
    for each in reversed(spec.definitions):
        if not each.arguments and any(
            tree.Name(each.name) in (*tree.walk(line.left), *tree.walk(line.right))
            for line in (*lines, *shown)
        ):
            shown.append(VectorLine(tree.Name(each.name), each.typed))
    return reversed(shown)
