"""The generic member of a system of equal members, as sections of a document.

Comes in: the Equations of a few members. Goes out: the rates of member i, and of the members at the
ends of an open chain. Read next: `coadjoint.derive.indexed`, which reads them off.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import sympy

from coadjoint.derive.abbreviations import abbreviate, number_names
from coadjoint.derive.equations import Equations
from coadjoint.derive.indexed import derive_family
from coadjoint.derive.lines import Line, Section, equal, write_line
from coadjoint.derive.records import Left, Step, member, rate, symbol
from coadjoint.derive.truncated import tell_motion
from coadjoint.families import Family
from coadjoint.notation.elements import write_sympy
from coadjoint.notation.functions import write_sum
from coadjoint.notation.texts import write_text
from coadjoint.notation.written import add, literal, multiply

Names = Mapping[sympy.Symbol, Left]


def show_members(equations: Equations) -> Iterator[Section]:
    """The equations that are the same for every number of members."""
    family = derive_family(equations)
    if family.matrices is not None:
        yield _show_matrices(family)
        return
    i = family.index.name
    kind = "a ring" if family.index.periodic else "an open chain" if family.ends else "a system"
    names = _name_around(family, i, {n: f"{i}{n:+d}" for n in _list_shifts(family)})
    taken = {each.name for each in (*names, *family.shared)} | {each.name for each in family.time}
    short = number_names(taken)
    rates = tuple(_write_rates(names, family.states, family.rates, short))
    told = (
        f"; {rates[0].text.split()[0]} and the like stand for parts of rates"
        if len(rates) > len(family.states)
        else ""
    )
    pairs = [_write_pairs(names, each.symbol, each.term, family) for each in family.pair_sums]
    yield Section(
        title=f"Equations of member {i}",
        law=f"{kind} of N members, N >= {family.small}{told}",
        law_latex="",
        lines=(*rates, *pairs),
    )
    if family.noise:
        yield Section(
            title=f"Noise of member {i}",
            law="what increments of Wiener processes do to it, in the sense of Stratonovich",
            law_latex="",
            lines=tuple(_write_noise(names, family)),
            kind="members",
        )
    ends = tuple(_write_ends(family, short))
    if ends:
        law = "what differs of members that lack a neighbour; the first one is 0, the last one N-1"
        yield Section(title="Ends", law=law, law_latex="", lines=ends, kind="members")


def _write_ends(family: Family, short: Iterator[sympy.Symbol]) -> Iterator[Line]:
    """What differs of members at the ends from the generic one."""
    for end, rates in family.ends.items():
        pairs = zip(family.states, rates, family.rates, strict=True)
        own = {state: rate for state, rate, generic in pairs if rate != generic}
        yield from _write_rates(_name_at(family, end), [*own], [*own.values()], short)


def count_written(equations: Equations) -> str:
    """How many members, or rows of matrices, have equations that are derived one by one."""
    declared = equations.spec.family
    assert declared is not None, equations.spec.name
    count = len(equations.spec.state)
    if declared.index.of_rows:
        return f"{declared.index.find_size(count)} rows"
    return f"{count // len(declared.variables)} members"


def fold_step(equations: Equations, step: Step) -> tuple[Step, tuple[tuple[str, str], ...]]:
    """A step with the lines of one member alone, and what is said of the others.

    The member in the middle has all its neighbours. Rates are left out: they are those of the
    generic member, which the document begins with.
    """
    declared = equations.spec.family
    assert declared is not None, equations.spec.name
    names = "|".join(map(re.escape, (*declared.variables, *declared.indexed)))
    # entries of matrices have two numbers in the place of one
    digits = r"\d+_\d+" if declared.index.of_rows else r"\d+"
    place = re.compile(rf"(?<![A-Za-z0-9_])d?(?:{names})_({digits})(?![0-9])")
    members = [(line, place.search(line[0].text)) for line in step.lines]
    numbers = sorted(
        {found[1] for _, found in members if found}, key=lambda n: [int(x) for x in n.split("_")]
    )
    rates = {rate(name).text for name in equations.setting.state}
    moving = [line for line in step.lines if line[0].text in rates]
    middle = numbers[len(numbers) // 2] if numbers else ""
    kept = tuple(
        line
        for line, found in members
        if line[0].text not in rates and (found is None or found[1] == middle)
    )
    words = []
    if len(kept) + len(moving) < len(step.lines):
        others = ", ".join(n.replace("_", " ") for n in numbers if n != middle)
        shown = middle.replace("_", " ")
        words.append(("shown", f"member {shown}; left out are the lines of {others}"))
    if moving:
        words.append(("rates", "those of the generic member, in the equations of motion above"))
    return replace(step, lines=kept), tuple(words)


def _show_matrices(family: Family) -> Section:
    """The equations of matrices of any number of rows."""
    rows = family.index.name
    odd = "" if family.index.allows(family.small + 1) else " and odd"
    lines = (equal(write_text(left), write_text(right)) for left, right in tell_motion(family))
    return Section(
        title="Equations of motion",
        law=f"matrices of {rows} rows counted from 0, {rows} >= {family.small}{odd}, with what "
        "has no neighbour left out",
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
    names: Names,
    states: Sequence[sympy.Symbol],
    rates: Sequence[sympy.Expr],
    short: Iterator[sympy.Symbol],
) -> Iterator[Line]:
    """The rates of a member, and before them what parts of long ones are called."""
    parts, values = abbreviate(rates, short)
    for part, value in parts:
        yield write_line(symbol(part.name), _write(value, names), value.as_ordered_terms(), names)
    for state, value in zip(states, values, strict=True):
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
