"""Restricted motions: that the whole motion keeps the submanifold on which they live.

Comes in: Equations restricted to a section. Goes out: statements and what must be zero. The
functions that vanish there have rates in their ideal, in all the whole space; they vanish on the
section; and the section moves with the motion, ``Ds . X = Y``. Forces are part of this motion.
Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.reductions import Restriction
from coadjoint.exact import Element
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.relaxation import about_relaxation, derive_whole
from coadjoint.prove.zero import Decision, Discovery, Examined, decide_zero

Found = Sequence[Element] | Decision | Discovery


def about_reduction(first: Equations) -> Iterator[Examined]:
    """What must hold for the restricted motion to be one of the whole system."""
    reduction = first.spec.reduction
    if reduction is None:
        return
    restriction = restriction_of(first)
    whole = restriction.whole
    section = ", ".join(f"{name} = {f.in_one_line}" for name, f in reduction.section.items())
    if reduction.where:
        where = ", ".join(f"{formula.in_one_line} = 0" for formula in reduction.where)
        functions = [g for f in reduction.where for g in whole.setting.components(f)]
        kept = partial(_decide_kept, whole, functions, where)
        yield f"the whole motion keeps {where}", "reduction", kept
        vanishing = partial(_on_section, restriction, functions)
        yield f"where {section}, {where}", "reduction", vanishing
    yield f"the motion keeps {section}", "reduction", partial(_section_defects, restriction)
    for statement, kind, examine in about_relaxation(whole):
        yield f"{statement} (of the whole system)", kind, partial(_decide, whole, examine)


def restriction_of(first: Equations) -> Restriction:
    """The whole system of a restricted motion, on its section."""
    return Restriction(first.setting, derive_whole(first))


def on_section(restriction: Restriction, function: Element) -> Element:
    """A function of the whole state with the section in the place of y."""
    return restriction.setting.field.substitute(restriction(function), restriction.section)


def _decide(whole: Equations, examine: Callable[[], Found]) -> Decision | Discovery:
    """A claim about the whole system, decided in its field."""
    result = examine()
    if isinstance(result, Decision | Discovery):
        return result
    return decide_zero(result, whole.setting.field)


def _decide_kept(whole: Equations, functions: Sequence[Element], where: str) -> Decision:
    """That the rates of some functions vanish where they do."""
    field, state = whole.setting.field, whole.setting.state
    rates = [whole.close(rate) for rate in whole.exact.rates]
    drifts = [
        field.sum(slope * rate for slope, rate in zip(field.gradient(f, state), rates, strict=True))
        for f in functions
    ]
    return decide_zero(drifts, field, Ideal(field, functions, where, state))


def _on_section(restriction: Restriction, functions: Sequence[Element]) -> list[Element]:
    return [on_section(restriction, f) for f in functions]


def _section_defects(restriction: Restriction) -> list[Element]:
    """``Ds . X - Y``, component by component; y keeps its name, and is replaced at the end."""
    field, names, rates = restriction.setting.field, restriction.setting.state, restriction.rates
    moved = [
        field.sum(s * rates[x] for s, x in zip(field.gradient(value, names), names, strict=True))
        - rates[name]
        for name, value in restriction.section.items()
    ]
    return [field.substitute(defect, restriction.section) for defect in moved]
