"""The generic member of a system of equal members, as sections of a document.

Comes in: the Equations of a few members. Goes out: the rates of member i, and of the members at the
ends of an open chain. Read next: `coadjoint.derive.indexed`, which reads them off.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import sympy

from coadjoint.derive.equations import Equations
from coadjoint.derive.indexed import derive_family
from coadjoint.derive.lines import Line, Section, equal, write_line
from coadjoint.derive.records import Left, member, symbol
from coadjoint.derive.truncated import tell_motion
from coadjoint.families import Family
from coadjoint.notation.elements import write_sympy
from coadjoint.notation.trees import write_sum
from coadjoint.notation.written import add, literal, multiply

Names = Mapping[sympy.Symbol, Left]


def show_members(equations: Equations) -> Iterator[Section]:
    """The equations that are the same for every number of members."""
    family = derive_family(equations)
    if family.matrices is not None:
        yield _show_matrices(equations, family)
        return
    i, written = family.index.name, len(equations.spec.state)
    declared = equations.spec.family
    assert declared is not None, equations.spec.name
    kind = "a ring" if family.index.periodic else "an open chain" if family.ends else "a system"
    written //= len(declared.variables)
    names = _name_around(family, i, {n: f"{i}{n:+d}" for n in _list_shifts(family)})
    pairs = [_write_pairs(names, each.symbol, each.term, family) for each in family.pair_sums]
    yield Section(
        title=f"Equations of member {i}",
        law=f"{kind} of N members, N >= {family.small}; the steps that follow are those of "
        f"{written} members",
        law_latex="",
        lines=(*_write_rates(names, family.states, family.rates), *pairs),
    )
    ends = [
        line
        for end, rates in family.ends.items()
        for line in _write_rates(_name_at(family, end), family.states, rates)
    ]
    if family.noise:
        yield Section(
            title=f"Noise of member {i}",
            law="what increments of Wiener processes do to it, in the sense of Stratonovich",
            law_latex="",
            lines=tuple(_write_noise(names, family)),
            kind="members",
        )
    if ends:
        law = "members that lack a neighbour, the first one being 0 and the last one N-1"
        yield Section(title="Ends", law=law, law_latex="", lines=tuple(ends), kind="members")


def _show_matrices(equations: Equations, family: Family) -> Section:
    """The equations of matrices of any number of rows."""
    rows, count = family.index.name, len(equations.spec.state)
    lines = (equal(literal(left), literal(right)) for left, right in tell_motion(family))
    return Section(
        title="Equations of motion",
        law=f"matrices of {rows} rows counted from 0, {rows} >= {family.small}, with what has no "
        f"neighbour left out; the steps that follow are those of {family.index.find_size(count)} "
        "rows",
        law_latex="",
        lines=tuple(lines),
    )


def _list_shifts(family: Family) -> set[int]:
    """Where the neighbours are that have symbols."""
    return {shift for _, shift in family.neighbours}


def _name_at(family: Family, end: int) -> Names:
    """How symbols are written of a member at an end, counted from 0, or from N as -1, -2, ..."""
    places = {n: str(end + n) if end >= 0 else f"N{end + n}" for n in (0, *_list_shifts(family))}
    return _name_around(family, places[0], places)


def _name_around(family: Family, own: str, near: Mapping[int, str]) -> Names:
    """How symbols are written; those of the member itself come first."""
    listed = (*family.own, *family.indexed_noise)
    names = {s: member(s.name, own) for s in listed}
    names |= {s: member(of.name, near[n]) for (of, n), s in family.neighbours.items()}
    names |= {s: member(of.name, _other(family)) for of, s in family.partners.items()}
    return names | {each.symbol: member(each.symbol.name, own) for each in family.pair_sums}


def _other(family: Family) -> str:
    """The index of a partner."""
    return "j" if family.index.name != "j" else "k"


def _write_rates(
    names: Names, states: Sequence[sympy.Symbol], rates: Sequence[sympy.Expr]
) -> Iterator[Line]:
    """The rates of a member."""
    for state, value in zip(states, rates, strict=True):
        place = names[state].text.partition("[")[2].removesuffix("]")
        left = member(state.name, place, dot=True)
        yield write_line(left, _write(value, names), value.as_ordered_terms(), names)


def _write_noise(names: Names, family: Family) -> Iterator[Line]:
    """What the noise does to each component of a member."""
    for state, value in zip(family.states, family.noise, strict=True):
        own = names[state]
        delta = literal(f"noise of {own.text}", r"\delta", "<mi>δ</mi>", "delta")
        left = replace(multiply([delta, own]), text=delta.text)
        yield write_line(left, _write(value, names), value.as_ordered_terms(), names)


def _write_pairs(names: Names, of: sympy.Symbol, term: sympy.Expr, family: Family) -> Line:
    """A sum over the partners of a member."""
    i, j = family.index.name, _other(family)
    known = {s.name: written for s, written in names.items()}
    below = [literal(j), literal(i), write_sympy(term, lambda s: known.get(s) or symbol(s))]
    total = add([write_sum((j,), below, "!=")])
    return equal(names[of], replace(total, text=f"sum({j} != {i}, {_write(term, names)})"))


def _write(value: sympy.Expr, names: Names) -> str:
    """An expression as text."""
    told = str(value.xreplace({s: sympy.Symbol(left.text) for s, left in names.items()}))
    return told.replace("**", "^")
