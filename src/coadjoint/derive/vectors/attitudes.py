r"""Attitudes and poses in equations by vectors: their own motion, and the torques on them.

A pose is an attitude R and a place x. Where the energy has the slope G by R, the torque in body
axes is that of the skew part of :math:`R^TG`, since :math:`\langle G, R\hat\eta\rangle =
\eta\cdot(R^TG - G^TR)^\vee`, and the force :math:`R^T\partial h/\partial x`.

Comes in: trees and what is declared. Goes out: trees, which nothing here proves. Read next:
`coadjoint.derive.vectors.words`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass

from coadjoint.derive.vectors.lines import VectorLine, list_taken
from coadjoint.derive.vectors.transposes import list_factors, multiply, turn
from coadjoint.spec import Spec
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.shapes import shapes
from coadjoint.spec.model import Variable

#: What the attitude and the place of a pose are called that have no short names.
LETTERS = ("R", "x")
#: The functions that have their values.
FUNCTIONS = ("rotation", "translation")


@dataclass(frozen=True)
class Pose:
    """A pose with the names of its parts.

    Attributes:
        variable: As declared.
        attitude: What its matrix of rotation is called.
        place: What its last column is called.
    """

    variable: Variable
    attitude: str
    place: str

    @property
    def names(self) -> tuple[str, str]:
        """Both."""
        return self.attitude, self.place

    @property
    def components(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """The components of the pose that its parts are made of."""
        names, (_, columns) = self.variable.components, self.variable.value_shape
        places = tuple(n for k, n in enumerate(names, 1) if k % columns == 0)
        return tuple(n for n in names if n not in places), places


def name_poses(spec: Spec) -> list[Pose]:
    """The poses of the state, with the short names that a spec gives their parts, or letters.

    A spec that has other use for a letter has no names of parts.
    """
    taken = list_taken(spec) | {each.name for each in spec.definitions}
    found = list[Pose]()
    for variable in spec.state:
        if variable.turning != "pose":
            continue
        base, mark, member = variable.name.rpartition("_")
        suffix = mark + member if base and spec.family is not None else ""
        names = list[str]()
        for function, letter in zip(FUNCTIONS, LETTERS, strict=True):
            of = tree.Call(function=function, arguments=(tree.Name(variable.name),))
            short = next((d.name for d in spec.definitions if d.tree == of), None)
            names.append(short or letter + suffix)
            if short is None and not taken.isdisjoint([letter, names[-1]]):
                names.pop()
        if len(names) == len(LETTERS):
            found.append(Pose(variable, *names))
    return found if len({n for each in found for n in each.names}) == 2 * len(found) else []


def tell_attitudes(spec: Spec, lines: Iterable[VectorLine]) -> list[str]:
    """What is said of the names of parts of poses, and of the inverse of hat."""
    nodes = [each for line in lines for each in tree.walk(line.right)]
    told, poses = list[str](), name_poses(spec)[:1]
    short = {each.name for each in spec.definitions}
    for pose in poses:
        if not short.isdisjoint(pose.names):
            continue
        names = [pose.variable.name, *pose.names]
        if spec.family is not None:
            names = [f"{each.rpartition('_')[0]}[{spec.family.index.name}]" for each in names]
        told.append(f"{names[0]} has the rotation {names[1]} and the translation {names[2]}")
    if any(isinstance(each, tree.Call) and each.function == "vee" for each in nodes):
        told.append("vee undoes hat")
    return told


def name_parts(node: tree.Node, names: Mapping[tree.Node, str]) -> tree.Node:
    """A formula with the names of parts of poses."""
    if node in names:
        return tree.Name(names[node])
    below = tree.children(node)
    return tree.rebuild(node, [name_parts(each, names) for each in below]) if below else node


def parts_of(poses: list[Pose]) -> dict[tree.Node, str]:
    """The names of parts of poses by the formulas that have their values."""
    return {
        tree.Call(function=function, arguments=(tree.Name(pose.variable.name),)): name
        for pose in poses
        for function, name in zip(FUNCTIONS, pose.names, strict=True)
    }


def torque(
    attitude: tree.Node, slope: tree.Node, left: bool, scope: Mapping[str, Shape]
) -> tree.Node:
    r"""The torque in body axes, or in those of space, of a slope by an attitude.

    That of :math:`a \otimes b` is :math:`b \times R^Ta`, and in space :math:`Rb \times a`.
    """
    match slope:
        case tree.Call(function="outer", arguments=(a, b)):
            sides = (b, multiply(turn(attitude), a)) if left else (multiply(attitude, b), a)
            return tree.Call(function="cross", arguments=sides)
    turned = multiply(*(turn(each) for each in reversed(_factors(slope, scope))))
    pairs = ((turn(attitude), slope), (turned, attitude))
    first, second = (multiply(*(pair if left else pair[::-1])) for pair in pairs)
    skew = tree.Binary(operator="-", left=first, right=second)
    return tree.Call(function="vee", arguments=(skew,))


def drop_rotations(
    node: tree.Node, attitudes: Collection[tree.Node], scope: Mapping[str, Shape]
) -> tree.Node:
    """A formula without ``R^T R`` and ``R R^T``, for rotations R."""
    if not any(each in attitudes for each in tree.walk(node)):
        return node
    below = tree.children(node)
    node = tree.rebuild(node, [drop_rotations(each, attitudes, scope) for each in below])
    if not (isinstance(node, tree.Binary) and node.operator == "*"):
        return node
    left, dropped = list[tree.Node](), False
    for each in _factors(node, scope):
        plain = {each, turn(each)} & {*attitudes}
        if left and plain and left[-1] == turn(each):
            left.pop()
            dropped = True
        else:
            left.append(each)
    if not left or not (dropped or len(left) > len("ab")):
        return node
    whole = left[-1]
    for each in reversed(left[:-1]):  # from the right, where vectors stand, and what is named
        whole = tree.Binary(operator="*", left=each, right=whole)
    return whole


def _factors(node: tree.Node, scope: Mapping[str, Shape]) -> list[tree.Node]:
    """The factors of a product of matrices, of which the last may be a vector."""
    known = shapes(node, scope)

    def down(part: tree.Node) -> Iterator[tree.Node]:
        match part:
            case tree.Binary(operator="*", left=a, right=b) if known[id(a)]:
                yield from down(a)
                yield from down(b)
            case _ if len(known[id(part)]) == 2:
                yield from list_factors(part, known)
            case _:
                yield part

    return list(down(node))
