"""Restricted motions: that the whole motion keeps the submanifold on which they live.

Comes in: Equations restricted to a section. Goes out: statements and what must be zero. The
functions that vanish there have rates in their ideal, in all the whole space; they vanish on the
section; and the section moves with the motion, ``Ds . X = Y``.
Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.domain import region
from coadjoint.derive.reductions import Restriction, whole_equations
from coadjoint.exact import Element
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.zero import Decision, decide_zero

Examined = tuple[str, str, Callable[[], Sequence[Element] | Decision]]


def about_reduction(first: Equations) -> Iterator[Examined]:
    """What must hold for the restricted motion to be one of the whole system."""
    reduction = first.spec.reduction
    if reduction is None:
        return
    whole = whole_equations(first.setting, first.route)
    whole.setting.field.region = region(whole)
    restriction = Restriction(first.setting, whole)
    section = ", ".join(f"{name} = {f.in_one_line}" for name, f in reduction.section.items())
    if reduction.where:
        where = ", ".join(f"{formula.in_one_line} = 0" for formula in reduction.where)
        functions = [g for f in reduction.where for g in whole.setting.components(f)]
        kept = partial(_kept, whole, functions, where)
        yield f"the whole motion keeps {where}", "reduction", kept
        vanishing = partial(_on_section, restriction, functions)
        yield f"where {section}, {where}", "reduction", vanishing
    yield f"the motion keeps {section}", "reduction", partial(_section_defects, restriction)


def _kept(whole: Equations, functions: Sequence[Element], where: str) -> Decision:
    """That the rates of some functions vanish where they do."""
    field, state = whole.setting.field, whole.setting.state
    rates = [whole.closed(rate) for rate in whole.exact.rates]
    drifts = [
        field.sum(slope * rate for slope, rate in zip(field.gradient(f, state), rates, strict=True))
        for f in functions
    ]
    return decide_zero(drifts, field, Ideal(field, functions, where, state))


def _on_section(restriction: Restriction, functions: Sequence[Element]) -> list[Element]:
    """Functions of the whole state with the section in the place of y."""
    field = restriction.setting.field
    return [field.substitute(restriction(f), restriction.section) for f in functions]


def _section_defects(restriction: Restriction) -> list[Element]:
    """``Ds . X - Y``, component by component; y keeps its name, and is put in at the end."""
    field, names, rates = restriction.setting.field, restriction.setting.state, restriction.rates
    moved = [
        field.sum(s * rates[x] for s, x in zip(field.gradient(value, names), names, strict=True))
        - rates[name]
        for name, value in restriction.section.items()
    ]
    return [field.substitute(defect, restriction.section) for defect in moved]
