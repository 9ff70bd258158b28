"""The vector form of equations of motion: what is shown above their components.

Comes in: Equations. Goes out: a `VectorForm`. Read next: `coadjoint.derive.vectors.recognise`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from coadjoint.derive.equations import Equations
from coadjoint.derive.vectors.balance import balance_lines, momentum_of
from coadjoint.derive.vectors.gradients import total_of
from coadjoint.derive.vectors.members import member_form
from coadjoint.derive.vectors.recognise import (
    VectorForm,
    VectorLine,
    is_short,
    rate_of,
    recognise,
    tree_name,
)
from coadjoint.derive.vectors.vocabulary import Vocabulary, make_vocabulary
from coadjoint.notation.written import Written
from coadjoint.spec import Spec
from coadjoint.spec.core import tree


def vector_form(equations: Equations) -> VectorForm:
    """The equations of motion by whole vectors and matrices, as far as they are found."""
    if equations.spec.family is not None:
        return member_form(equations)
    vocabulary = make_vocabulary(equations)
    lines, missing = list[VectorLine](), list[str]()
    for target in vocabulary.targets:
        found = recognise(vocabulary, target.value)
        if found is None or not is_short(total_of(found)):
            missing.append(tree_name(target.node))
        else:
            lines.append(VectorLine(rate_of(target.node), total_of(found)))
    lines += _named(vocabulary, lines)
    shapes, written = dict(vocabulary.shapes), dict[str, Written]()
    if missing and equations.spec.constraints:
        balance = balance_lines(equations)
        if balance is not None:
            lines[:0], missing = balance.lines, []
            shapes |= balance.shapes
            written |= balance.written
    lines += _momentum_lines(equations, vocabulary)
    lines += _short_names(equations.spec, vocabulary, lines)
    return VectorForm(tuple(lines), tuple(missing), shapes, written)


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
    """What short names of the spec stand for that lines use."""
    used = {n.name for line in lines for n in tree.walk(line.right) if isinstance(n, tree.Name)}
    for each in spec.definitions:
        if each.name in used and not each.arguments:
            yield VectorLine(tree.Name(each.name), each.tree)
