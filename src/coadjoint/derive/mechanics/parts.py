"""Parts of forces: the definitions that forces use, which the kernel computes once.

A friction along a slip velocity names that velocity in each of its components. With the definition
substituted, a force is a sum of many products. With ``_a1`` for its value it is what a person
writes. A definition that names a reaction is substituted, since forces are solved for reactions.
Comes in: a Setting over a frame. Goes out: names and values of the parts, and forces in terms of
them. Read next: `coadjoint.derive.mechanics.external`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from coadjoint.derive.interpret import Value, entries, interpret
from coadjoint.derive.setting import Setting, once, shape
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.spec import Formula, Spec
from coadjoint.spec.core.components import component_names
from coadjoint.spec.core.definitions import Definition, expand, functions
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.tree import Index, Name, Node, walk


def part_names(spec: Spec) -> dict[str, tuple[str, ...]]:
    """Names of the components of each part, by the definition that it is; empty without a frame."""
    names: dict[str, tuple[str, ...]] = {}
    count = 0
    for part in _parts(spec):
        assert part.shape is not None, "a part takes no arguments"
        size = len(component_names(part.name, part.shape))
        names[part.name] = tuple(f"_a{count + n + 1}" for n in range(size))
        count += size
    return names


@once
def parts(setting: Setting) -> tuple[tuple[str, Element], ...]:
    """The components of each part, in terms of the state, all velocities and parts before it.

    Raises:
        DerivationError: Division by zero or a singular inverse inside one.
    """
    spec, values = setting.spec, list[tuple[str, Element]]()
    named = part_names(spec)
    for part in _parts(spec):
        try:
            value = interpret(_tree(spec, part.text), _values(setting), setting.field)
        except DerivationError as error:
            key = f"definitions.{part.name}"
            message = f"{spec.path}: {key}: {error}"
            raise DerivationError(message, path=str(spec.path), key=key, found=part.text) from error
        values += zip(named[part.name], entries(value), strict=True)
    return tuple(values)


def slopes(setting: Setting, function: Formula, velocities: Sequence[str]) -> tuple[Element, ...]:
    """The derivatives of a function by the velocities, in parts: by the chain rule."""
    field, inner = setting.field, dict[str, tuple[Element, ...]]()

    def whole(value: Element) -> tuple[Element, ...]:
        own = field.gradient(value, [*velocities, *inner])
        through = [
            [outer * slope for slope in slopes]
            for outer, slopes in zip(own[len(velocities) :], inner.values(), strict=True)
            if outer != 0
        ]
        return tuple(map(field.sum, zip(own[: len(velocities)], *through, strict=True)))

    for name, value in parts(setting):
        inner[name] = whole(value)
    return whole(*in_parts(setting, function))


def in_parts(setting: Setting, formula: Formula) -> tuple[Element, ...]:
    """The components of a force, or of what is observed, in parts and reactions."""
    tree = _tree(setting.spec, formula.text) if part_names(setting.spec) else formula.tree
    return setting.components(replace(formula, tree=tree), _values(setting))


@once
def _values(setting: Setting) -> dict[str, Value]:
    """Reactions and parts by their names, and what a spec declares."""
    known = {each.name: each for each in setting.spec.definitions}
    return {**setting.values, **setting.reactions} | {
        name: shape(setting.elements(components), known[name].shape or ())
        for name, components in part_names(setting.spec).items()
    }


def _tree(spec: Spec, text: str) -> Node:
    """A formula with the definitions substituted that are not parts."""
    known = {each.name: each for each in spec.definitions}
    shown = {name: each for name, each in known.items() if not _is_part(spec, each)}
    inner: dict[str, Definition] = {}
    for name, each in shown.items():
        if each.arguments:
            inner[name] = each
        else:
            inner[name] = replace(each, tree=expand(each.typed, inner))
    return expand(read_expression(text, functions(known)), inner)


def _is_part(spec: Spec, definition: Definition) -> bool:
    """Whether a definition is a value of its own: it takes no argument and names no reaction."""
    reactions = {name for each in spec.constraints for name in (each.reaction, *each.reactions)}
    return not definition.arguments and not _names(definition.tree) & reactions


def _parts(spec: Spec) -> list[Definition]:
    """The definitions that forces use, directly or by way of others, in declared order.

    Those of a spec with an index name members, and have another value in each formula.
    """
    if not spec.in_frame or spec.index:
        return []
    acting = [*spec.forces.values(), *([spec.dissipation] if spec.dissipation else [])]
    used = set[str]().union(*(_names(_tree(spec, each.text)) for each in acting))
    used_parts = []
    for each in reversed(spec.definitions):
        if each.name in used and _is_part(spec, each):
            used |= _names(_tree(spec, each.text))
            used_parts.append(each)
    return used_parts[::-1]


def _names(tree: Node) -> set[str]:
    return {node.name for node in walk(tree) if isinstance(node, Name | Index)}
