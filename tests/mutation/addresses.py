"""Addresses: a change named by the function, the operator and what it acts upon.

One line says it, and no text of the engine is quoted:

    _known: drop gyroscopic              the term of a sum that mentions gyroscopic
    _rates: swap diamond a               the last two arguments of this call
    _known: flip b in carried            ... in what assigns `carried`, or in a call of it
    lie_poisson: use act for dual        one name in the place of another
    derive: let kinetic = lagrangian     another value of a variable, or of what is returned
    _rates: rewrite add(_1, b) -> b      an expression of a form; _1, _2 stand for any

A line that fits nowhere or at more than one place fails and lists what it could mean.
Comes in: a tree and a line. Goes out: the changed source. Read next: `tests.mutation.mutants`.
"""

from __future__ import annotations

import ast
import copy
from functools import cache
from pathlib import Path

from tests.mutation.operators import Edit, Function, edits, names_in, places_of, walk


class AddressError(Exception):
    """A line that names no change, or several."""


@cache
def tree_of(path: Path) -> ast.Module:
    """The tree of a module; nobody changes it."""
    return ast.parse(path.read_text(encoding="utf-8"))


def functions(tree: ast.Module) -> dict[str, Function]:
    """Functions by their qualified names; what stands outside them has the name ``module``."""
    found: dict[str, Function] = {"module": tree}

    def enter(node: ast.AST, prefix: str) -> None:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, (ast.FunctionDef, ast.ClassDef)):
                name = f"{prefix}{child.name}"
                if isinstance(child, ast.FunctionDef):
                    found[name] = child
                enter(child, f"{name}.")
            else:
                enter(child, prefix)

    enter(tree, "")
    return found


def function_of(tree: ast.Module, name: str) -> Function:
    """The only function of this name, which may leave out the class or function around it."""
    known = functions(tree)
    fitting = [each for each in known if each == name] or [
        each for each in known if each.endswith(f".{name}")
    ]
    if len(fitting) != 1:
        raise AddressError(f"{name!r} is {len(fitting)} functions; there are: {', '.join(known)}")
    return known[fitting[0]]


def find_edit(tree: ast.Module, line: str) -> Edit:
    """The edit that a line names.

    Raises:
        AddressError: The line fits nowhere, or at several places.
    """
    fitting, candidates = _fitting(tree, line)
    inner = [each for each in fitting if not any(_contains(each, other) for other in fitting)]
    if len(inner) != 1:
        listed = "\n".join(f"  {each.label}" for each in inner or candidates)
        raise AddressError(f"{line!r} fits {len(inner)} places:\n{listed}")
    return inner[0]


def find_edits(tree: ast.Module, line: str) -> list[Edit]:
    """All edits that a line fits; those that it names letter by letter where there are some.

    Raises:
        AddressError: It fits none.
    """
    fitting, candidates = _fitting(tree, line)
    if not fitting:
        listed = "\n".join(f"  {each.label}" for each in candidates)
        raise AddressError(f"{line!r} fits no place:\n{listed}")
    return [each for each in fitting if line.endswith(f": {each.label}")] or fitting


def _fitting(tree: ast.Module, line: str) -> tuple[list[Edit], list[Edit]]:
    """The edits that a line fits, and those with its operator in its function."""
    name, _, what = line.partition(": ")
    operator, _, rest = what.partition(" ")
    function = function_of(tree, name)
    if operator == "use":
        candidates = _replacing(function, *split_once(rest, " for "))
        rest = rest.partition(" for ")[2].partition(" ")[2]
    elif operator == "let":
        target, value = split_once(rest, " = ")
        candidates, rest = _assigning(function, target, value), ""
    elif operator == "rewrite":
        old, new = split_once(rest, " -> ")
        candidates, rest = _rewriting(function, new, old), ""
    else:
        candidates = [each for each in edits(function) if each.operator == operator]
    words, _, places = rest.partition("in ") if rest.startswith("in ") else rest.partition(" in ")
    fitting = [
        each
        for each in candidates
        if each.words >= set(words.split()) and each.places >= set(places.split())
    ]
    return fitting, candidates


def split_once(text: str, mark: str) -> tuple[str, str]:
    """The two sides of a mark."""
    before, found, after = text.partition(mark)
    if not found:
        raise AddressError(f"{text!r} lacks {mark!r}")
    return before, after


def _contains(outer: Edit, inner: Edit) -> bool:
    """Whether an edit acts upon something around what the other acts upon."""
    return outer.acts_on is not inner.acts_on and any(
        node is inner.acts_on for node in ast.walk(outer.acts_on)
    )


def _replacing(function: Function, new: str, rest: str) -> list[Edit]:
    """One name, attribute, operation or number in the place of another."""
    old, found = rest.split(" ")[0], []
    for node, above in walk(function):
        changed = copy.copy(node)
        if isinstance(node, ast.Name) and node.id == old:
            changed = ast.parse(new, mode="eval").body
        elif isinstance(node, ast.Attribute) and node.attr == old:
            changed.attr = new
        elif isinstance(node, ast.Constant) and str(node.value) == old:
            changed = ast.parse(new, mode="eval").body
        else:
            continue
        statement = next(
            (each for each in reversed(above) if isinstance(each, (ast.Call, ast.stmt))), function
        )
        edit = Edit("use", node, node, changed, places_of((*above, node)) | names_in(statement))
        found.append(edit)
    return found


def _assigning(function: Function, target: str, value: str) -> list[Edit]:
    """Another value of a variable, of an argument by default, or of what is returned."""
    new, found = ast.parse(value, mode="eval").body, []
    for node, above in walk(function):
        if isinstance(node, (ast.Assign, ast.AnnAssign, ast.AugAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            fits = any(ast.unparse(each) == target for each in targets)
        else:
            fits = isinstance(node, ast.Return) and target == "return"
        if fits:
            found.append(Edit("let", node, node.value, new, places_of((*above, node))))
    return found


#: What an expression of the engine stands for in a pattern.
Bindings = dict[str, ast.AST]


def _rewriting(function: Function, new: str, old: str) -> list[Edit]:
    """An expression in the place of another of a given form."""
    pattern, result = _expression(old), _expression(new)
    found = []
    for node, above in walk(function):
        bound = _match(pattern, node, {})
        if bound is not None:
            found.append(
                Edit("rewrite", node, node, _filled(result, bound), places_of((*above, node)))
            )
    return found


def _expression(text: str) -> ast.expr:
    return ast.parse(text.strip(), mode="eval").body


def _match(pattern: object, found: object, bound: Bindings) -> Bindings | None:
    """What the names ``_1, _2, ...`` of a pattern stand for; None if it does not fit."""
    if isinstance(pattern, ast.Name) and pattern.id.startswith("_") and pattern.id[1:].isdigit():
        known = bound.get(pattern.id)
        if not isinstance(found, ast.AST) or (known and ast.dump(known) != ast.dump(found)):
            return None
        return bound | {pattern.id: found}
    if isinstance(pattern, list):
        if not isinstance(found, list) or len(pattern) != len(found):
            return None
        pairs = list(zip(pattern, found, strict=True))
    elif isinstance(pattern, ast.AST):
        if type(pattern) is not type(found):
            return None
        fields = [name for name in pattern._fields if name not in ("ctx", "kind")]
        pairs = [(getattr(pattern, name), getattr(found, name)) for name in fields]
    else:
        return bound if pattern == found else None
    for inner, other in pairs:
        step = _match(inner, other, bound)
        if step is None:
            return None
        bound = step
    return bound


def _filled(tree: ast.expr, bound: Bindings) -> ast.AST:
    """A pattern with what its names stand for."""

    class Filling(ast.NodeTransformer):
        def visit_Name(self, node: ast.Name) -> ast.AST:
            return bound.get(node.id, node)

    return Filling().visit(copy.deepcopy(tree))


def rebuild(tree: ast.AST, old: ast.AST, new: ast.AST) -> ast.AST:
    """A copy of a tree with one node replaced; what is beside it is shared."""
    if tree is old:
        return new
    changed = copy.copy(tree)
    for name, value in ast.iter_fields(tree):
        if isinstance(value, ast.AST):
            setattr(changed, name, rebuild(value, old, new))
        elif isinstance(value, list):
            setattr(
                changed,
                name,
                [rebuild(v, old, new) if isinstance(v, ast.AST) else v for v in value],
            )
    return changed


def source_with(tree: ast.Module, edit: Edit) -> str:
    """The source of a tree with one edit; what it does not touch is written once for all edits."""
    texts, places = _statements(tree)
    changed = rebuild(tree.body[places[id(edit.old)]], edit.old, edit.new)
    return "\n".join(
        ast.unparse(ast.fix_missing_locations(changed)) if k == places[id(edit.old)] else text
        for k, text in enumerate(texts)
    )


@cache
def _statements(tree: ast.Module) -> tuple[list[str], dict[int, int]]:
    """The statements of a module as text, and in which of them each node stands."""
    places = {id(node): k for k, each in enumerate(tree.body) for node in ast.walk(each)}
    return [ast.unparse(each) for each in tree.body], places
