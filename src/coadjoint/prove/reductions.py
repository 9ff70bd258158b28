"""Restricted motions: that the whole motion keeps the submanifold on which they live.

Comes in: Equations restricted to a section. Goes out: statements and what must be zero. The
functions that vanish there have rates in their ideal, in all the whole space; they vanish on the
section; and the section moves with the motion, ``Ds . X = Y``. Forces are part of this motion.
Claimed Casimirs are those of the whole bracket, which are integrals on the section. Where the
section has a bracket of its own, it is shown to be that of functions whose flows keep the section.
Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.reductions import Restriction, section_defects
from coadjoint.derive.section_brackets import InducedBracket, induced_bracket
from coadjoint.derive.submanifold import put_on_section
from coadjoint.derive.symmetries import momentum_maps, moves_of
from coadjoint.exact import Element
from coadjoint.exact.dense import Matrix, apply, dot
from coadjoint.prove.findings import finding, first_nonzero
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.identities import casimir_defects, drift
from coadjoint.prove.relaxation import about_relaxation, derive_whole
from coadjoint.prove.zero import (
    Decision,
    Discovery,
    Examined,
    decide_zero,
    mark_claimed,
    mark_place,
)
from coadjoint.spec import Formula

Found = Sequence[Element] | Decision | Discovery


def about_reduction(first: Equations) -> Iterator[Examined]:
    """What must hold for the restricted motion to be one of the whole system."""
    reduction = first.spec.reduction
    if reduction is None:
        return
    restriction = restriction_of(first)
    whole, field = restriction.whole, first.setting.field
    section = ", ".join(f"{name} = {f.in_one_line}" for name, f in reduction.section.items())
    if reduction.where:
        where = ", ".join(f"{formula.in_one_line} = 0" for formula in reduction.where)
        functions = [g for f in reduction.where for g in whole.setting.components(f)]
        kept = partial(_decide_kept, whole, functions, where)
        vanishing = partial(_on_section, restriction, functions)
        examined: list[Examined] = [
            (f"the whole motion keeps {where}", "reduction", kept),
            (f"where {section}, {where}", "reduction", vanishing),
        ]
        yield from mark_place(reduction.where[0], examined, field)
    keeps = partial(section_defects, restriction)
    examined = [(f"the motion keeps {section}", "reduction", keeps)]
    yield from mark_place(next(iter(reduction.section.values())), examined, field)
    for statement, kind, examine in about_relaxation(whole):
        yield f"{statement} (of the whole system)", kind, partial(_decide, whole, examine)
    yield from _about_bracket(first, restriction)
    for place, casimir in enumerate(first.spec.casimirs):
        examined = [*_about_casimir(first, restriction, casimir)]
        key = ("claims", "casimirs", place)
        yield from mark_claimed(first.spec, key, casimir, examined, field)


def _about_bracket(first: Equations, restriction: Restriction) -> Iterator[Examined]:
    """That the bracket of the section is induced, and what declared symmetries make of it."""
    tensor = first.exact.poisson_tensor
    induced = None if tensor is None else induced_bracket(restriction)
    if tensor is None or induced is None:
        return
    yield (
        "the bracket on the section is that of the whole system: {x_i, x_j} = {X_i, X_j} there, "
        "with X_i = x_i on it and X_i in involution with all that vanishes on it",
        "reduction",
        partial(_induced_defects, restriction, induced, tensor),
    )
    names, field = first.setting.state, first.setting.field
    values = momentum_maps(first.setting, first.exact.energy)
    for symmetry in first.spec.symmetries:
        if symmetry.time is not None:  # its flow is no Hamiltonian vector field at fixed time
            continue
        moves, flows = moves_of(first.setting, symmetry), dict[str, Element]()
        for name, move, value in zip(
            symmetry.components, moves, values[symmetry.name], strict=True
        ):
            slopes = field.gradient(first.close(value), names)
            for x, row in zip(names, tensor, strict=True):
                moved = first.close(move.get(x, field.zero))
                flows[f"{x} by {name}"] = dot(map(first.close, row), slopes) - moved
        where, decision = first_nonzero(flows, field)
        yield finding(
            "symmetry",
            decision,
            f"{symmetry.name} generates its flow by the bracket on the section",
            f"{symmetry.name} does not generate its flow by the bracket on the section: it would "
            f"move {where} otherwise",
        )


def _induced_defects(
    restriction: Restriction, induced: InducedBracket, tensor: Matrix
) -> list[Element]:
    """``{X_i, phi}`` on the section, and ``{X_i, X_j}`` there minus the emitted bracket.

    The brackets are those of the whole state, with ``X_i = x_i - W phi`` as functions of it.
    """
    setting, whole, field = restriction.setting, restriction.whole, restriction.setting.field
    names, P = whole.setting.state, whole.exact.poisson_tensor
    assert P is not None, "only what has a bracket induces one"
    phi = {y: field[y] - value for y, value in restriction.section.items()}
    X = [
        field[x] - field.sum(w * phi[y] for y, w in shift.items())
        for x, shift in zip(setting.state, induced.shifts, strict=True)
    ]
    whole_tensor = [list(map(restriction, row)) for row in P]
    flows = [apply(whole_tensor, field.gradient(f, names)) for f in X]
    slopes = [field.gradient(f, names) for f in X]
    kept = [dot(field.gradient(f, names), flow) for f in phi.values() for flow in flows]
    brackets = [
        dot(slope, flow) - entry
        for slope, row in zip(slopes, tensor, strict=True)
        for flow, entry in zip(flows, row, strict=True)
    ]
    return [put_on_section(setting, defect) for defect in (*kept, *brackets)]


def _about_casimir(
    first: Equations, restriction: Restriction, casimir: Formula
) -> Iterator[Examined]:
    """That it is a Casimir of the whole bracket, and what becomes of it along the motion."""
    whole, name = restriction.whole, casimir.in_one_line
    parts = whole.setting.components(casimir)
    yield (
        f"{name} is a Casimir of the whole system",
        "casimir",
        partial(_decide, whole, lambda: [d for f in parts for d in casimir_defects(whole, f)]),
    )
    if first.exact.poisson_tensor is not None:  # told of the bracket on the section
        return
    field, gained = first.setting.field, [restriction.on_section(whole.work(f)) for f in parts]
    changed = not all(map(field.is_zero, gained))
    law = "changes only by forces and dissipation" if changed else "is conserved"
    yield (
        f"{name}, restricted to the section, {law}",
        "conserved",
        partial(_casimir_defects_on_section, first, casimir, gained),
    )


def _casimir_defects_on_section(
    first: Equations, casimir: Formula, gained: Sequence[Element]
) -> list[Element]:
    """Rates along the restricted motion, minus what forces add."""
    values = first.setting.components(casimir)
    return [drift(first, f)[0] - x for f, x in zip(values, gained, strict=True)]


def restriction_of(first: Equations) -> Restriction:
    """The whole system of a restricted motion, on its section."""
    return Restriction(first.setting, derive_whole(first))


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
    return [restriction.on_section(f) for f in functions]
