"""Looped: whether the members of a spec with an index can be looped over.

Comes in: a checked file with a table [index]. Goes out: "" if a generic member tells the equations
of all, so that kernels loop over the members for every number of them; else why not, as a clause,
and then all members are written out. Only what a file says decides, before anything is derived.
Read next: `coadjoint.spec.windows`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from math import inf
from typing import Any

from coadjoint import limits
from coadjoint.families import Index
from coadjoint.spec.copies import make_members
from coadjoint.spec.core.definitions import Definition, expand, functions, signature
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError
from coadjoint.spec.core.members import Members, find_free, reach
from coadjoint.spec.core.totals import (
    find_alone,
    has_sum,
    is_linear,
    is_plain,
    walk_outside,
)
from coadjoint.spec.core.tree import (
    Binary,
    Call,
    Entry,
    Member,
    Name,
    Node,
    Power,
    Sum,
    children,
    evaluate_nodes,
    walk,
)
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
    "symmetries",
    "claims",
)
_HEAD = ("title", "source", "description", "license", "routes")


def find_misfit(file: Any, index: Index) -> str:
    """Why the members cannot be looped over, as a clause; "" if they can.

    A formula that cannot be read is passed over: whoever reads it says what is wrong.
    """
    return next(_list_misfits(file, index), "")


def _list_misfits(file: Any, index: Index) -> Iterator[str]:
    """All reasons."""
    members = make_members(file, index, 1)
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
    couples = file.poisson is not None and any("[" in key for key in file.poisson.brackets or ())
    for table in ("symmetries", "noise", "forces", "dissipation") if couples else ():
        if getattr(file, table):
            yield f"brackets couple members, and there is a table [{table}]"
    definitions = _read_definitions(file)

    def read(texts: Any) -> list[Node]:
        return list(_read_all(list_texts(texts), definitions))

    energy = read(file.hamiltonian)
    observables = [tree for part in file.observables.values() for tree in read(part.expression)]
    forces, friction, claims = read(file.forces), read(file.dissipation), read(file.claims)
    noise = read(file.noise)
    others = [tree for each in (file.poisson, file.lax) for tree in read(each)]
    for tree in (*energy, *observables, *forces, *friction, *noise, *claims, *others):
        yield from _examine(tree, members)
    for tree in (*forces, *others, *(claims if members.periodic else ())):
        yield from _refuse_alone(tree, members)
    for tree in energy:
        yield from _examine_total(tree, members, "the energy")
    for tree in observables:
        if not is_linear(tree, members) and any(
            isinstance(n, Call) and n.function in _SIGNED for n in walk_outside(tree)
        ):
            yield "an observable asks for the sign of a sum"
        if members.periodic:
            yield from _refuse_alone(tree, members)
    if not all(map(has_sum, energy)):
        yield "the energy has no sum over members"
    for tree in friction:
        yield from _examine_total(tree, members, "Rayleigh's function")
    if any(isinstance(n, Sum) and len(n.indices) > 1 for t in friction for n in walk(t)):
        yield "Rayleigh's function has a sum over pairs"
    for tree in noise:
        yield from _examine_noise(tree, members)
    if any(map(has_sum, forces)):
        yield "a force has a sum over members"
    for tree in observables:
        if find_free(tree, members):
            yield "an observable has a value for each member"
    for action in file.symmetries.values():
        yield from _examine_action(action, read(action.generators), read(action.map), members)
    lagrangian = read(file.lagrangian)
    if file.lagrangian is not None:
        yield from _examine_lagrangian(file, lagrangian, members)
    known = (*energy, *lagrangian, *observables)
    sums = [n for tree in known for n in walk(tree) if isinstance(n, Sum)]
    pairs = any(len(each.indices) > 1 for each in sums)
    rubbing = (n for tree in friction for n in walk(tree) if isinstance(n, Sum))
    most = max([0, *(n + 1 if n >= 0 else -n for found in find_ends(file, index) for n in found)])
    if most > limits.NEIGHBOURS:
        yield f"a member stands alone that is not among the first or last {limits.NEIGHBOURS}"
    if couples and pairs:
        yield "brackets couple members, and there are sums over pairs"
    if pairs and any(reach(each.term) != (0, 0) for each in rubbing):
        yield "Rayleigh's function couples neighbours, and there are sums over pairs"


def _examine_noise(tree: Node, members: Members) -> Iterator[str]:
    """Why a Hamiltonian of noise is neither that of each member nor a sum over members."""
    if has_sum(tree):
        yield from _examine_total(tree, members, "a Hamiltonian of noise")
        if find_free(tree, members):
            yield "a Hamiltonian of noise is not linear in sums over members"
    yield from _refuse_alone(tree, members)
    if any(isinstance(node, Sum) and len(node.indices) > 1 for node in walk(tree)):
        yield "a Hamiltonian of noise has a sum over pairs"
    if not has_sum(tree) and not find_free(tree, members):
        yield "a Hamiltonian of noise names no members"


def _examine_lagrangian(file: Any, trees: list[Node], members: Members) -> Iterator[str]:
    """Why a Lagrangian does not tell the momenta of each member by its own velocities."""
    roles = [part.role for part in file.variables.values()]
    moving = {name for name, part in file.variables.items() if part.role == "velocity"}
    if file.hamiltonian is None and any(degree(tree, moving) > 2 for tree in trees):
        yield "the Lagrangian is not quadratic in the velocities"
    for tree in trees:
        yield from _examine(tree, members)
        yield from _examine_total(tree, members, "the Lagrangian")
        if any(map(moving.__contains__, map(_name_alone, walk_outside(tree)))):
            yield "one member alone has a kinetic energy of its own"
        for each in (node for node in walk(tree) if isinstance(node, Sum)):
            if len(each.indices) > 1 and file.algebra is not None and "momentum" not in roles:
                yield "the Lagrangian of velocities along an algebra has a sum over pairs"
            alone = len(each.indices) == 1 and reach(each.term) == (0, 0)
            if not alone and _list_names(each.term) & moving:
                yield "the kinetic energy couples members"


def _examine_action(
    action: Any, generators: list[Node], maps: list[Node], members: Members
) -> Iterator[str]:
    """Why an action does not move each member by itself, with a sum as its momentum map."""
    if action.linear is not None:
        yield "an action is linear in stacked variables"
    if action.time is not None:
        yield "an action moves time"
    for tree in generators:
        yield from _examine(tree, members)
        yield from _refuse_alone(tree, members)
        if has_sum(tree) or reach(tree) != (0, 0):
            yield "an action moves a member by others"
    for tree in maps:
        yield from _examine(tree, members)
        yield from _examine_total(tree, members, "a momentum map")
        yield from _refuse_alone(tree, members)
        sums = [node for node in walk(tree) if isinstance(node, Sum)]
        if any(len(each.indices) > 1 or reach(each.term) != (0, 0) for each in sums):
            yield "a momentum map has terms of several members"


def _examine_total(tree: Node, members: Members, what: str) -> Iterator[str]:
    """Why a tree is no sum of sums with constant factors and of terms of members at the ends."""
    if not is_linear(tree, members):
        yield f"{what} is not linear in sums over members"
    if members.periodic:
        yield from _refuse_alone(tree, members)


def _refuse_alone(tree: Node, members: Members) -> Iterator[str]:
    """A member that stands alone where all are alike."""
    for node in walk_outside(tree):
        if members.find_alone(node) is not None:
            assert isinstance(node, Member | Subscript), node
            yield f"{node.name} stands there of one member alone"


#: Functions that ask for signs, which have no value where sums are symbols.
_SIGNED = frozenset({"abs", "min", "max", "pow", "sign"})
#: Functions whose values are linear in each argument.
_LINEAR = frozenset(
    {
        *("dot", "cross", "commutator", "trace", "transpose", "complex", "hat", "diag", "outer"),
        *("vector", "rows", "qmul", "conjugate", "translation"),
    }
)
#: Functions of several arguments whose values add up these, and do not multiply them.
_SIDE_BY_SIDE = frozenset({"complex", "vector", "rows"})


def degree(tree: Node, moving: Collection[str]) -> float:
    """The degree of a polynomial in some quantities, at the most; infinite for none.

    >>> degree(read_expression("m*dot(v, v)/2 - k*sin(q)"), {"v"})
    2.0
    """

    def find(node: Node, below: list[float]) -> float:
        most = max(below, default=0.0)
        match node:
            case Name(name=name) | Member(name=name) | Subscript(name=name):
                return float(name in moving)
            case Binary(operator="*"):
                return sum(below)
            case Binary(operator="/"):
                return below[0] if not below[1] else inf
            case Power(exponent=exponent):
                return most * exponent if exponent >= 0 or not most else inf
            case Call(function=function) if function in _LINEAR - _SIDE_BY_SIDE:
                return sum(below)
            case Call(function=function) if function not in _SIDE_BY_SIDE:
                return inf if most else 0.0
        return most

    return evaluate_nodes(tree, find)[id(tree)]


def _name_alone(node: Node) -> str:
    """The name of what a node names with an index or a number."""
    return node.name if isinstance(node, Member | Subscript) else ""


def _list_names(tree: Node) -> set[str]:
    """What a tree names with an index or a number."""
    return {*map(_name_alone, walk(tree))} - {""}


def find_ends(file: Any, index: Index) -> tuple[set[int], set[int]]:
    """The numbers of the single members at the ends on which something acts, and of all others.

    They count from 0, or from N as -1, -2 and so on. The others stand in what is claimed.
    """
    members, definitions = make_members(file, index, 1), _read_definitions(file)

    def find(*tables: Any) -> set[int]:
        texts = (text for table in tables for text in list_texts(table))
        found = (find_alone(tree, members) for tree in _read_all(texts, definitions))
        return {number for numbers in found for number in numbers}

    acting = find(file.hamiltonian, file.lagrangian, file.dissipation)
    return acting, find(file.claims, *(part.expression for part in file.observables.values()))


def _examine(tree: Node, members: Members) -> Iterator[str]:
    """What stands in a formula that no generic member has."""
    i = members.index
    for node in _walk_terms(tree):
        match node:
            case Entry(name=name):
                yield f"subscripts of {name} are worked out"
            case Name(name=name) if name == i:
                yield f"a formula has {name} as a number"
            case Member(name=name) if name not in (*members.names, *members.scalars):
                yield f"{i} counts components of {name}"
            case Sum(term=term, indices=[_, _, *_]) if reach(term) != (0, 0):
                yield "a sum over pairs names neighbours"
            case Sum() if not is_plain(node):
                yield "a sum goes over some members, or over pairs other than i < j"
            case Sum(term=term) if has_sum(term):
                yield "a sum stands in a sum"
            case Sum(term=term) if find_alone(term, members):
                yield "a sum names one member alone"
            case Sum(term=term, indices=indices):
                names = {n.name for n in walk(term) if isinstance(n, Name)} & {*indices}
                yield from (f"a formula has {name} as a number" for name in sorted(names))


def names_number(file: Any, index: Index) -> bool:
    """Whether a formula has the number of members as a value, as ``J/n``."""
    tables = (file.hamiltonian, file.lagrangian, file.poisson, file.lax, file.forces, file.noise)
    actions = [(each.generators, each.map) for each in file.symmetries.values()]
    observables = [each.expression for each in file.observables.values()]
    texts = list_texts([*tables, file.dissipation, file.claims, actions, observables])
    trees = _read_all(texts, _read_definitions(file))
    named = (node.name for tree in trees for node in walk(tree) if isinstance(node, Name))
    return bool(index.count) and index.count in named


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
        for typed, tree in _read_both([text], known):
            known[name] = Definition(
                name=name, arguments=arguments, text=text, typed=typed, tree=tree, shape=None
            )
    return known


def _read_all(texts: Iterable[str], definitions: Mapping[str, Definition]) -> Iterator[Node]:
    """The trees of those texts that can be read, with definitions expanded."""
    return (tree for _, tree in _read_both(texts, definitions))


def _read_both(
    texts: Iterable[str], definitions: Mapping[str, Definition]
) -> Iterator[tuple[Node, Node]]:
    """The trees of those texts that can be read, as typed and with definitions expanded."""
    for text in texts:
        try:
            typed = read_expression(text, functions(definitions), indexed=True)
            yield typed, expand(typed, definitions)
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
