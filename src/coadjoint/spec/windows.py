"""Windows: a spec with an index, written out for two or three small numbers of members.

Comes in: a checked file with a table [index]. Goes out: the Spec of a few members, as any other
spec has, with all that is known of the others in its attribute ``family``. What a generic member
does not tell (`coadjoint.spec.looped`), and what asks for it, is written out for all members, and
is a Spec as any other.
The numbers are those from which the claims follow for every other number
(docs/decisions/windows.md):

* a ring whose sums have terms of w + 1 neighbouring members: 2 w and 2 w + 1;
* an open chain: w and w + 1, and enough for a member with all its neighbours;
* one in which members at the ends stand alone: twice as many, and two more;
* brackets of members b apart: as if the energy coupled members b further;
* pairs: 2 and 3;
* pairs and neighbours: 4 w, 4 w + 1 and 4 w + 2 in a ring, and in a chain 2 w, 2 w + 1 and 2 w + 2.

Read next: `coadjoint.derive.indexed`, then `coadjoint.prove.indexed`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

from coadjoint import limits
from coadjoint.errors import CoadjointError
from coadjoint.families import Index
from coadjoint.spec.copies import QUANTITIES, differs, make_members, write_out_file
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.faults import ExpressionError
from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.members import Members, find_free, member_name
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.totals import find_alone, has_sum, split_sums, without_sums
from coadjoint.spec.core.tree import Index as Subscript
from coadjoint.spec.core.tree import Name, Node, walk
from coadjoint.spec.core.values import read_default
from coadjoint.spec.counted import count_out, find_counted
from coadjoint.spec.looped import find_ends, find_misfit, list_texts, names_number
from coadjoint.spec.model import Spec, Windows
from coadjoint.spec.sections.indices import make_index
from coadjoint.spec.sections.lax import Lax
from coadjoint.spec.sections.parameters import ParameterPart
from coadjoint.spec.sections.turning import TURNING, read_rotation

_PAIRS = re.compile(r"\bsum\s*\(\s*\w+\s*,\s*\w+\s*,\s*\w+\s*<")
#: What is added to the index in a bracket of two members.
_PLACE = re.compile(r"\[\s*\w+\s*([-+]\s*\d{1,6})?\s*\]")


def read_windows(
    source: Source,
    file: Any,
    read: Callable[[Source, Any], Spec],
    sizes: Mapping[str, int],
) -> Spec:
    """A spec with an index.

    Args:
        source: The text of the spec.
        file: Its checked tables.
        read: How a file without an index becomes a Spec.
        sizes: Chosen sizes by the name of their index.

    Raises:
        SpecError: A size is unknown, a table or a variable does not go with an index.
        LimitError: There are too many members.
    """
    counted = list(find_counted(file))
    index = _choose(source, file, sizes, is_counted=bool(counted))
    misfit = "a size in the name of an algebra or in a shape counts them" if counted else ""
    if counted and index.size is not None:
        file = count_out(source, file, index, file.index[index.name].size)
    _check(source, file, index)
    asked = "written_out = true asks for it" if file.index[index.name].written_out else ""
    far = _measure_brackets(file) > limits.NEIGHBOURS
    apart = f"members more than {limits.NEIGHBOURS} apart have a bracket" if far else ""
    misfit = misfit or asked or apart or find_misfit(file, index)
    if misfit:
        return _write_all(source, file, read, index, misfit)
    reach, width, pairs = _measure(source, file, index)
    acting, claimed = find_ends(file, index)
    ends = max([0, *(n + 1 if n >= 0 else -n for n in acting | claimed)])
    first = _first_window(index, reach, width, ends, pairs=pairs)
    if file.noise:  # what a process of one member does to a sum names so many members
        first = max(first, reach + 2 * width)
    coupled = _measure_brackets(file) > 0
    least = 1 if index.periodic and not (pairs or coupled) else first
    size = index.size
    if size is not None and size < least:
        if pairs and size < 2:
            problem = f"the index {index.name!r} counts one member"
            raise source.fault(("index", index.name), problem, size, "at least 2 for pairs")
        few = f"a chain of fewer than {least} has no member with all its neighbours"
        if coupled and index.periodic:
            few = f"with brackets of neighbours claims are proved for all from {least} members on"
        if ends:
            few = f"the ends of a chain of fewer than {least} do not keep apart"
        if pairs:
            few = f"with pairs and neighbours claims are proved for all from {least} members on"
        return _write_all(source, file, read, index, few)
    index, whole = replace(index, from_zero=True, is_value=names_number(file, index)), file
    if index.is_value:
        told = {"positive": True, "unit": "1", "doc": "number of members"}
        file = file.model_copy(
            update={
                "parameters": {**file.parameters, index.count: ParameterPart.model_validate(told)}
            }
        )
    bare = file.model_copy(update={"lax": None})
    count = 3 if pairs and (reach or width or ends) else 2
    windows = tuple(read(*write_out_file(source, bare, index, first + n)) for n in range(count))
    small = windows[0]
    last = first if file.lax is None else max(first, 2 * max(reach, ends) + width + 3)
    lax = tuple(
        _split_lax(source, read(*write_out_file(source, file, index, count)))
        for count in range(first, last + 1)
        if file.lax is not None
    )
    state = {each.name for each in small.state}
    processes = {each.name for each in small.noise}
    quantities = (*small.variables, *small.parameters, *small.inputs)
    shapes = {each.name: each.shape for each in quantities}
    family = Windows(
        index=index,
        variables=tuple(name for name in file.variables if member_name(name, 0) in state),
        shared=_select_names(whole.parameters, indexed=False),
        indexed=_select_names(file.parameters, indexed=True),
        shared_inputs=_select_names(file.inputs, indexed=False),
        indexed_inputs=_select_names(file.inputs, indexed=True),
        shared_noise=tuple(name for name in file.noise if name in processes),
        indexed_noise=tuple(name for name in file.noise if name not in processes),
        defaults={
            name: _read_defaults(source, (table, name), part, shapes[member_name(name, 0)])
            for table, name, part in _list_quantities(file)
            if part.index is not None and differs(file, part)
        },
        repeating=tuple(
            n for _, n, p in _list_quantities(file) if p.index is not None and _repeats(p)
        ),
        reach=reach,
        alone=(max([0, *(n + 1 for n in acting)]), max([0, *(-n for n in acting)])),
        pairs=pairs,
        least=least,
        windows=windows,
        lax=lax,
    )
    return _with_family(source, whole.model_copy(update={"lax": None}), read, family)


def _select_names(parts: Mapping[str, Any], *, indexed: bool) -> tuple[str, ...]:
    """The names of quantities that each member has, or that all share."""
    return tuple(name for name, part in parts.items() if (part.index is not None) == indexed)


def _write_all(
    source: Source, file: Any, read: Callable[[Source, Any], Spec], index: Index, misfit: str
) -> Spec:
    """The spec with all its members, as any other spec.

    Raises:
        SpecError: Nobody says how many there are.
        LimitError: There are more than a state may have components.
    """
    key, size = ("index", index.name), index.size
    problem = f"all members are written out, since {misfit}"
    if size is None:
        hint = f'Give the index a size, or choose one: sizes={{"{index.name}": 5}}.'
        raise source.fault(key, f"{problem}; no size is given", "", "a size", hint)
    if size > limits.STATE_COMPONENTS:
        raise source.too_many(key, f"{problem}; there are {size}", size, "STATE_COMPONENTS")
    spec = read(*write_out_file(source, file, index, size))
    return replace(spec, index=(index,), written=misfit)


def _split_lax(source: Source, spec: Spec) -> tuple[Spec, Lax]:
    """A Spec and its Lax pair, which has no spectral parameter.

    Raises:
        SpecError: It has.
    """
    lax = spec.lax
    assert lax is not None, spec.name
    for formula in (lax.L, lax.M):
        named = {node.name for node in walk(formula.tree) if isinstance(node, Name)}
        if lax.spectral in named:
            problem = f"the pair depends on the spectral parameter {lax.spectral!r}"
            expected = "a Lax pair of equal members without one"
            raise source.fault(formula.path, problem, lax.spectral, expected)
    return replace(spec, lax=None), lax


def _with_family(
    source: Source, file: Any, read: Callable[[Source, Any], Spec], family: Windows
) -> Spec:
    """The larger window, with the claims that hold for every number of members.

    Raises:
        SpecError: A Casimir is neither of each member nor a sum over members.
    """
    large, index = family.windows[-1], family.index
    kind_of = partial(_kind_of, large, make_members(file, index, 1))
    for formula in large.casimirs:
        _check_casimir(source, formula, kind_of(formula))
    kinds = ["other" if each.where else kind_of(each.formula) for each in large.conserved]
    members = [c for c, kind in zip(large.conserved, kinds, strict=True) if kind == "member"]
    loaded = None
    if "other" in kinds:
        place = kinds.index("other")
        loaded = _read_loaded(source, file, read, family, place)
        loaded = _select(loaded, [n for n, kind in enumerate(kinds) if kind == "other"])
    kept = [n for n, kind in enumerate(kinds) if kind != "other"]
    windows = tuple(_select(each, kept) for each in family.windows)
    family = replace(
        family,
        windows=windows,
        of_members=frozenset(f"{each.formula.in_one_line} is conserved" for each in members),
        loaded=loaded,
    )
    return replace(windows[-1], family=family, index=(index,))


def _select(spec: Spec, places: Sequence[int]) -> Spec:
    """A Spec with some of its claims of what is conserved."""
    key = ("claims", "conserved")
    accepted = {each for each in spec.accepted if each[:2] != key}
    accepted |= {(*key, n) for n, place in enumerate(places) if (*key, place) in spec.accepted}
    claims = tuple(spec.conserved[place] for place in places)
    return replace(spec, conserved=claims, accepted=frozenset(accepted))


def _kind_of(spec: Spec, known: Members, formula: Formula) -> str:
    """What a claim is about: a ``total``, each ``member``, or something ``other``.

    Only what is linear in sums follows for every number of members.
    """
    tree, emitted = formula.sums, _list_emitted(spec)
    assert tree is not None, formula.key
    if isinstance(tree, Name | Subscript) and tree.name in emitted:
        return _kind_of_tree(emitted[tree.name], known)
    named = {node.name for node in walk(tree) if isinstance(node, Name | Subscript)}
    return "other" if named & emitted.keys() else _kind_of_tree(tree, known)


def _list_emitted(spec: Spec) -> dict[str, Node | None]:
    """The trees of what claims may name; none of the energy, which is kept, and of sums."""
    trees: dict[str, Node | None] = {"energy": None}
    for each in spec.observables:
        trees |= dict.fromkeys((each.name, *each.components), each.formula.sums)
    for symmetry in spec.symmetries:  # a momentum map is a sum over members
        trees |= dict.fromkeys((symmetry.name, *symmetry.components))
    return trees


def _kind_of_tree(tree: Node | None, known: Members) -> str:
    """What a tree is about; single members at the ends are as good as none."""
    if tree is None:
        return "total"
    if not has_sum(tree):
        return "member"
    try:
        sums = split_sums(tree)
    except ExpressionError:
        return "other"
    free = find_free(without_sums(tree), known)
    varies = any(find_alone(alone, known) for _, alone in sums)
    pairs = any(len(each.indices) > 1 for each, _ in sums)
    return "other" if free or varies or pairs else "total"


def _check_casimir(source: Source, formula: Formula, kind: str) -> None:
    """A claimed Casimir is one of each member, or a sum over members.

    Raises:
        SpecError: It is not: it may be one for few members alone.
    """
    if kind == "other":
        problem = "the Casimir is neither of each member nor a sum over members"
        expected = "a function of one member, or sums over members with constant factors"
        raise source.fault(formula.path, problem, formula.in_one_line, expected)


def _read_loaded(
    source: Source, file: Any, read: Callable[[Source, Any], Spec], family: Windows, place: int
) -> Spec:
    """The spec with all its members, for claims that are proved for their number alone.

    Raises:
        SpecError: The number is not known.
        LimitError: It is too large for that.
    """
    size, key = family.index.size, ("claims", "conserved", place)
    problem = "this claim is not proved for every number of members"
    if size is None:
        expected = "an observable or a sum over members, or a size for which it is proved"
        raise source.fault(key, problem, "", expected, "Give the index a size.")
    if size > limits.PROVED_MEMBERS:
        raise source.too_many(key, f"{problem}, and there are {size}", size, "PROVED_MEMBERS")
    return read(*write_out_file(source, file, replace(family.index, is_value=False), size))


def _first_window(index: Index, reach: int, width: int, ends: int, *, pairs: bool) -> int:
    """The smallest of the numbers of members from which claims follow for all.

    Args:
        index: Whether there are ends.
        reach: How far the energy couples.
        width: The span of what is claimed.
        ends: How many members at an end stand alone somewhere.
        pairs: Whether pairs are coupled.
    """
    if ends:  # a new member is put in the middle, far from what reads an end
        whole = reach + (width if pairs else max(width, reach))
        return 2 * max(whole, ends + max(width, reach)) + 2 * whole * pairs
    if pairs and not (reach or width):
        return 2
    if pairs:
        whole = reach + width
        return 4 * whole if index.periodic else max(2 * whole, 2 * reach + width, 2)
    whole = reach + max(width, reach)
    return max(2 * whole, 2) if index.periodic else max(whole, 2 * reach + width, 1)


def _choose(source: Source, file: Any, sizes: Mapping[str, int], *, is_counted: bool) -> Index:
    """The index with the size that is chosen."""
    name, part = next(iter(file.index.items()))
    for other, size in sizes.items():
        if other != name:
            problem = f"a size is chosen for {other!a}, which is no index"
            raise source.at_key(("index", name), problem, other, f"the index {name!r}")
        if isinstance(size, bool) or not isinstance(size, int) or size < 1:
            problem = f"the size {size!r} is chosen for {name!r}"
            raise source.at_key(("index", name), problem, str(size), "an integer of 1 or more")
    size = sizes.get(name, part.size)
    varies = is_counted or any(each.index for _, _, each in _list_quantities(file))
    if size != part.size and not varies:
        problem = f"a size is chosen for {name!r}, which counts components"
        expected = f"the size {part.size} of the spec"
        raise source.fault(("index", name), problem, size, expected)
    return make_index(name, part, size)


def _check(source: Source, file: Any, index: Index) -> None:
    """Names of the index are free, quantities have no other one, and there is room for all."""
    for table, name, part in _list_quantities(file):
        if name in (index.name, index.count):
            what = "index" if name == index.name else "number of members"
            problem, expected = f"{name!r} is the {what}, too", "names that differ"
            raise source.at_key((table, name), problem, name, expected, "Rename one of them.")
        if part.index not in (None, index.name):
            key = (table, name, "index")
            problem = f"there is no index {part.index!a}"
            raise source.unknown(key, problem, part.index, [index.name])
        if part.index is not None and differs(file, part):
            _check_count(source, index, (table, name), part)
        elif _repeats(part):
            problem = f"{name!r} has one default for all members, which repeats"
            expected = "a list with an entry for each of some members"
            raise source.fault((table, name, "repeats"), problem, name, expected)
    if index.size is not None and index.size > limits.FAMILY_MEMBERS:
        problem = f"the index {index.name!r} counts {index.size} members"
        raise source.too_many(("index", index.name), problem, index.size, "FAMILY_MEMBERS")


def _list_quantities(file: Any) -> list[tuple[str, str, Any]]:
    """Table, name and keys of each quantity."""
    return [
        (table, name, part) for table in QUANTITIES for name, part in getattr(file, table).items()
    ]


def _repeats(part: Any) -> bool:
    """Whether the default of some members is taken again for others; inputs know no such key."""
    return bool(getattr(part, "repeats", False))


def _check_count(source: Source, index: Index, key: tuple[str, str], part: Any) -> None:
    """A default that differs from member to member has an entry for each, or for some again."""
    count = len(part.default)
    if _repeats(part) and (not count or (index.size or 0) % count):
        problem = f"the default of {key[1]!r} has {count} entries, which repeat"
        expected = f"one entry or more, and {index.size or 'N'} a multiple of their number"
        raise source.fault((*key, "default"), problem, count, expected)
    if count != index.size and not _repeats(part):
        problem = f"the default of {key[1]!r} has {count} entries"
        expected = f"one for all members, or {index.size or 'N'} entries"
        raise source.fault((*key, "default"), problem, count, expected)


def _read_defaults(
    source: Source, key: tuple[str, str], part: Any, shape: Shape
) -> tuple[tuple[Fraction, ...], ...]:
    """The defaults of each component, of all members."""
    role = getattr(part, "role", "")
    read = partial(read_rotation, role=role) if role in TURNING else read_default
    members = (read(source, (*key, "default"), x, shape) or () for x in part.default)
    return tuple(zip(*members, strict=True))


def _measure(source: Source, file: Any, index: Index) -> tuple[int, int, bool]:
    """How far the energy couples, the width of what is claimed, and whether pairs are coupled.

    The widths are bounds: the span of all shifts in the texts concerned.
    """
    shift = re.compile(rf"\[\s*{index.name}\s*([-+]\s*\d{{1,6}})?\s*[\],]")

    def span(texts: Iterable[str]) -> int:
        found = [int((m[1] or "0").replace(" ", "")) for t in texts for m in shift.finditer(t)]
        return max([0, *found]) - min([0, *found])

    shared = list(list_texts(file.definitions))
    energy = [*shared, *list_texts(file.hamiltonian), *list_texts(file.poisson)]
    energy += list_texts(file.lagrangian)
    energy += list_texts(file.noise)
    acting = [text for each in (file.forces, file.dissipation) for text in list_texts(each)]
    reach = span([*energy, *acting]) + _measure_brackets(file)
    width = span(
        [*shared, *list_texts(file.observables), *list_texts(file.claims), *list_texts(file.lax)]
    )
    pairs = any(_PAIRS.search(text) for text in [*energy, *list_texts(file.observables)])
    most = limits.NEIGHBOURS
    if max(reach, width) > 2 * most:
        problem = f"members that are {max(reach, width)} apart stand in one formula"
        raise source.too_many(("hamiltonian",), problem, max(reach, width), "NEIGHBOURS")
    return reach, width, pairs


def _measure_brackets(file: Any) -> int:
    """How far apart two members are that have a bracket, at the most."""
    keys = () if file.poisson is None else file.poisson.brackets or ()
    places = [[int(n.replace(" ", "") or 0) for n in _PLACE.findall(key)] for key in keys]
    return max([0, *(max(shifts) - min(shifts) for shifts in places if shifts)])


def name_fault(source: Source, key: KeyPath, index: str) -> CoadjointError:
    """A quantity with an index where none is declared."""
    problem, name = f"{key[1]!r} has the index {index!a}", str(key[1])
    expected = "a table [index] that declares it"
    hint = f"Write [index] and below it {index} = {{ size = 100 }}."
    return source.fault((*key, "index"), problem, name, expected, hint)
