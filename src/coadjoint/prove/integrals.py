"""Integrals: what a spec claims to be conserved, and the balance of the energy.

Comes in: a motion, constrained or free. Goes out: statements, and what must be zero. An integral
that is claimed on a level set alone has to be kept there, and so has the set.
Read next: `coadjoint.prove.candidates`, which looks for further ones.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.reconstruction import fixed_row
from coadjoint.derive.mechanics.turning import rational_rotation, rotation_relations
from coadjoint.derive.records import Emitted, Kept
from coadjoint.exact import Element
from coadjoint.prove.certificate import Shown, Verdict
from coadjoint.prove.constrained import motion_of
from coadjoint.prove.driven import while_constant
from coadjoint.prove.energy import Balance, keeps_energy
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.identities import noise_rates
from coadjoint.prove.motion import Motion
from coadjoint.prove.zero import Decision, Examined, UndecidedError, decide_zero, mark_claimed
from coadjoint.spec.model import DerivedMomentum, Integral
from coadjoint.spec.spatial import spatial_momenta


def about_energy(motion: Motion) -> Iterator[Examined]:
    """The balance of the energy."""
    yield (
        Balance(motion.equations).statement,
        "conserved",
        partial(_balance, motion),
    )


def _balance(motion: Motion) -> Decision:
    """Whether the energy changes by nothing else than is said: by no noise where none is named."""
    equations = motion.equations
    noise = noise_rates(equations, Balance(equations).energy) if keeps_energy(equations) else []
    return decide_zero([motion.energy_balance(), *noise], motion.field, motion.where)


def about_integrals(motion: Motion) -> Iterator[Examined]:
    """What the spec claims to be conserved; of an energy that is, the balance has said so."""
    first, spec = motion.equations, motion.spec
    said = "energy" if first.exact.energy is not None and keeps_energy(first) else None
    for place, claim in enumerate(spec.conserved):
        if claim.everywhere != said:
            claimed = [(_statement(motion, claim), "conserved", partial(_integral, motion, claim))]
            key = ("claims", "conserved", place)
            yield from mark_claimed(spec, key, claim.formula, claimed, motion.field)


def _statement(motion: Motion, claim: Integral) -> str:
    """The claim, where it holds, and what inputs must do for it."""
    where, setting, names = (
        _vanishing(claim, _rotations(motion, claim)),
        motion.setting,
        motion.emitted,
    )
    parts = (g for f in (claim.formula, *claim.where) for g in setting.components(f, names))
    held = while_constant(motion.equations, parts)
    return f"{claim.formula.in_one_line} is conserved" + (f" where {where}" if where else "") + held


def _vanishing(claim: Integral, rotations: Sequence[tuple[str, Sequence[Element]]]) -> str:
    """The level set of a claim: ``dot(Pi, Gamma) = 0``; of attitudes what makes them rotations."""
    level = [f"{formula.in_one_line} = 0" for formula in claim.where]
    return ", ".join([*level, *(text for text, _ in rotations)])


def _rotations(motion: Motion, claim: Integral) -> list[tuple[str, Sequence[Element]]]:
    """What makes attitudes rotations, if a claim without a level set needs it of some of them."""
    if claim.where or not motion.spec.turning:
        return []
    parts = motion.setting.components(claim.formula, motion.emitted)
    reached = [motion.field.reach(rate) for rate in _list_rates(motion, parts) if rate != 0]
    named = frozenset[str]().union(*reached)
    needed = (each for each in motion.spec.turning if named & {*each.components})
    return [relation for each in needed for relation in rotation_relations(motion.setting, each)]


def _integral(motion: Motion, claim: Integral) -> Decision:
    """The rates of all components of a claimed integral: zero everywhere, or on its level set.

    The motion must stay on the level set, too: there the functions that define it keep the value 0.
    """
    setting, names = motion.setting, motion.emitted
    parts, rotations = setting.components(claim.formula, names), _rotations(motion, claim)
    level = [g for f in claim.where for g in setting.components(f, names)]
    level += [defect for _, defects in rotations for defect in defects]
    kept, rates = (list(_list_rates(motion, functions)) for functions in (level, parts))
    text = ", ".join(filter(None, (_vanishing(claim, rotations), motion.where.text)))
    written = list(map(motion.in_state, parts))
    if rotations and (seen := _look_at_rotations(motion, rates, written)):
        return seen
    where = motion.where.also(list(map(motion.in_state, level)), text)
    return _conserved_on(where, kept, rates, written)


def _look_at_rotations(
    motion: Motion, rates: Sequence[Element], parts: Sequence[Element]
) -> Decision | None:
    """A counterexample where attitudes are one rotation of rational entries; None without one."""
    field, entries = motion.field, dict[str, Fraction]()
    for each in motion.spec.turning:
        entries |= rational_rotation(each)
    at = {name: field.number(value) for name, value in entries.items()}
    values = ([field.substitute(x, at) for x in elements] for elements in (rates, parts))
    seen = decide_zero(next(values), field, motion.where, next(values))
    if seen.verdict is not Verdict.REFUTED:
        return None
    return replace(seen, point={n: str(x) for n, x in entries.items()} | dict(seen.point or {}))


def _list_rates(motion: Motion, functions: Sequence[Element]) -> Iterator[Element]:
    """Rates of functions: by the motion, and by each Wiener process."""
    for function in functions:
        yield motion.rate(function)
        yield from noise_rates(motion.equations, function)


def _conserved_on(
    where: Ideal, kept: Sequence[Element], rates: Sequence[Element], parts: Sequence[Element]
) -> Decision:
    """Whether rates vanish where relations hold, and so do those of the relations themselves."""
    decision = decide_zero([*kept, *rates], where.field, where, parts)
    if kept and decision.verdict is Verdict.REFUTED:
        with suppress(UndecidedError):  # of a branch without points
            left = decide_zero(kept, where.field, where, parts)
            if left.verdict is Verdict.REFUTED:
                return replace(left, shown=Shown.RATE_OF_RELATION)
    return decision


def is_conserved(equations: Equations, each: Emitted) -> bool:
    """Whether the motion conserves what is emitted, by claims that are proved."""
    if each.kept is Kept.AS_ENERGY:
        return keeps_energy(equations)
    if each.kept is Kept.UNLESS_WORKED_ON:
        motion = motion_of(equations)
        rates = (r for x in each.values for r in (motion.rate(x), *noise_rates(equations, x)))
        return all(map(motion.where.contains, rates))
    return each.kept is Kept.ALWAYS


def about_spatial(motion: Motion) -> Iterator[Examined]:
    """The momenta as seen from space."""
    for seen in spatial_momenta(motion.spec):
        if seen.conserved:
            yield f"{seen.name} is conserved", "conserved", partial(_seen_from_space, motion, seen)


def _seen_from_space(motion: Motion, seen: DerivedMomentum) -> Decision:
    """The rates of a momentum as seen from space, at matrices of the group's form."""
    emitted, fixed = dict(motion.equations.exact.observables), fixed_row(motion.setting)
    text = ", ".join(relation.text for relation in fixed)
    where = Ideal(motion.field, [relation.element for relation in fixed], text)
    rates = list(_list_rates(motion, [emitted[name] for name in seen.components]))
    return decide_zero(rates, motion.field, where)
