"""Looped: whether the members of a spec with an index can be looped over.

Comes in: a checked file with a table [index]. Goes out: "" if a generic member tells the equations
of all, so that kernels loop over the members for every number of them; else why not, as a clause,
and then all members are written out. Only what a file says decides, before anything is derived.
Read next: `coadjoint.spec.windows`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from coadjoint.families import Index
from coadjoint.spec.copies import make_members
from coadjoint.spec.core.definitions import Definition, expand, functions, signature
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError
from coadjoint.spec.core.members import Members, find_free, reach
from coadjoint.spec.core.totals import has_sum, is_plain, split_sums
from coadjoint.spec.core.tree import Entry, Member, Name, Node, Sum, children, walk
from coadjoint.spec.core.tree import Index as Subscript

#: Tables that a spec has whose members are looped over.
TABLES = (
    "index",
    "algebra",
    "representations",
    "poisson",
    "variables",
    "parameters",
    "inputs",
    "time",
    "definitions",
    "lagrangian",
    "hamiltonian",
    "noise",
    "forces",
    "dissipation",
    "lax",
    "observables",
    "claims",
)
_HEAD = ("title", "source", "description", "license", "routes")


def find_misfit(file: Any, index: Index) -> str:
    """Why the members cannot be looped over, as a clause; "" if they can.

    A formula that cannot be read is passed over: whoever reads it says what is wrong.
    """
    return next(_list_misfits(file, make_members(file, index, 1)), "")


def _list_misfits(file: Any, members: Members) -> Iterator[str]:
    """All reasons."""
    for table in type(file).model_fields:
        if table not in (*TABLES, *_HEAD) and getattr(file, table) not in (None, {}):
            yield f"there is a table [{table}]"
    for name, part in file.variables.items():
        if part.index is None:
            yield f"the variable {name} has no index"
    for driving in ("time", "inputs", "noise"):
        for table in ("lagrangian", "lax"):
            if getattr(file, driving) and getattr(file, table) is not None:
                yield f"there are tables [{driving}] and [{table}]"
    definitions = _read_definitions(file)

    def read(texts: Any) -> list[Node]:
        return list(_read_all(list_texts(texts), definitions))

    energy = read(file.hamiltonian)
    observables = [tree for part in file.observables.values() for tree in read(part.expression)]
    forces = read(file.forces)
    others = [tree for each in (file.poisson, file.lax, file.claims) for tree in read(each)]
    friction = read(file.dissipation)
    noise = read(file.noise)
    others += [*forces, *friction, *noise]
    for tree in (*energy, *observables, *others):
        yield from _examine(tree, members)
    for tree in (*energy, *observables):
        if not _is_total(tree):
            yield "the energy or an observable is not linear in sums over members"
    if not all(map(_is_total, friction)):
        yield "Rayleigh's function is not linear in sums over members"
    if any(isinstance(n, Sum) and len(n.indices) > 1 for t in friction for n in walk(t)):
        yield "Rayleigh's function has a sum over pairs"
    for tree in noise:
        yield from _examine_noise(tree, members)
    if any(map(has_sum, forces)):
        yield "a force has a sum over members"
    for tree in observables:
        if find_free(tree, members):
            yield "an observable has a value for each member"
    if file.lagrangian is not None:
        yield from _examine_lagrangian(file, read(file.lagrangian), members)
    sums = [n for t in (*energy, *observables) for n in walk(t) if isinstance(n, Sum)]
    pairs = any(len(each.indices) > 1 for each in sums)
    if pairs and any(reach(tree) != (0, 0) for tree in friction):
        yield "Rayleigh's function couples neighbours, and there are sums over pairs"


def _examine_noise(tree: Node, members: Members) -> Iterator[str]:
    """Why a Hamiltonian of noise is neither that of each member nor a sum over members."""
    if has_sum(tree) and (find_free(tree, members) or not _is_total(tree)):
        yield "a Hamiltonian of noise is not linear in sums over members"
    if any(isinstance(node, Sum) and len(node.indices) > 1 for node in walk(tree)):
        yield "a Hamiltonian of noise has a sum over pairs"
    if not has_sum(tree) and not find_free(tree, members):
        yield "a Hamiltonian of noise names no members"


def _examine_lagrangian(file: Any, trees: list[Node], members: Members) -> Iterator[str]:
    """Why a Lagrangian does not tell the momenta of each member by its own velocities."""
    if file.hamiltonian is None:
        yield "the energy follows from a Lagrangian"
    moving = {name for name, part in file.variables.items() if part.role == "velocity"}
    for tree in trees:
        yield from _examine(tree, members)
        if not _is_total(tree):
            yield "the Lagrangian is not linear in sums over members"
        for each in (node for node in walk(tree) if isinstance(node, Sum)):
            named = {node.name for node in walk(each.term) if isinstance(node, Member)}
            if len(each.indices) > 1:
                yield "the Lagrangian has a sum over pairs"
            elif named & moving and reach(each.term) != (0, 0):
                yield "the kinetic energy couples members"


def _is_total(tree: Node) -> bool:
    """Whether a tree is a sum of sums with constant factors."""
    try:
        return bool(split_sums(tree))
    except ExpressionError:
        return False


def _examine(tree: Node, members: Members) -> Iterator[str]:
    """What stands in a formula that no generic member has."""
    i, counted = members.index, {members.index, *filter(None, [members.number])}
    for node in _walk_terms(tree):
        match node:
            case Entry(name=name):
                yield f"subscripts of {name} are worked out"
            case Name(name=name) if name in counted:
                yield f"a formula has {name} as a number"
            case Member(name=name, index=index) if index == members.number:
                yield f"{name} stands there of one member alone"
            case Subscript(name=name) if name in members.names:
                yield f"{name} stands there of one member alone"
            case Member(name=name) if name not in (*members.names, *members.scalars):
                yield f"{i} counts components of {name}"
            case Sum(term=term, indices=[_, _, *_]) if reach(term) != (0, 0):
                yield "a sum over pairs names neighbours"
            case Sum() if not is_plain(node):
                yield "a sum goes over some members, or over pairs other than i < j"
            case Sum(term=term) if has_sum(term):
                yield "a sum stands in a sum"
            case Sum(term=term, indices=indices):
                names = {n.name for n in walk(term) if isinstance(n, Name)} & {*indices}
                yield from (f"a formula has {name} as a number" for name in sorted(names))


def _walk_terms(tree: Node) -> Iterator[Node]:
    """Every node of a tree, but not the conditions of sums."""
    pending = [tree]
    while pending:
        node = pending.pop()
        yield node
        pending.extend((node.term,) if isinstance(node, Sum) else reversed(children(node)))


def _read_definitions(file: Any) -> dict[str, Definition]:
    """The definitions that can be read."""
    known: dict[str, Definition] = {}
    for key, text in file.definitions.items():
        name, arguments = signature(key)
        for tree in _read_all([text], known):
            known[name] = Definition(
                name=name, arguments=arguments, text=text, tree=tree, shape=None
            )
    return known


def _read_all(texts: Iterable[str], definitions: Mapping[str, Definition]) -> Iterator[Node]:
    """The trees of those texts that can be read, with definitions expanded."""
    for text in texts:
        try:
            yield expand(read_expression(text, functions(definitions), indexed=True), definitions)
        except ExpressionError:
            continue


def list_texts(value: Any) -> Iterator[str]:
    """All texts in tables that hold formulas."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for each in value.values():
            yield from list_texts(each)
    elif isinstance(value, list | tuple):
        for each in value:
            yield from list_texts(each)
    elif hasattr(type(value), "model_fields"):
        for name in type(value).model_fields:
            yield from list_texts(getattr(value, name))
