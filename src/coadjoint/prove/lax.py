"""Lax pairs: the Lax equation entry by entry, and the integrals that it gives.

Comes in: the emitted Equations and those by every route. Goes out: statements with what decides
them. The pair is held against the rates of a route in which it has no part, if there is one: each
entry of each power of the spectral parameter must vanish. Short integrals are differentiated along
the motion; for long ones the trace identity is taken, and with it the Lax equation, once proved.
Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial
from itertools import combinations

from coadjoint.derive import Equations
from coadjoint.derive.integrals import (
    Coefficient,
    Integrals,
    expanded_traces,
    known_integrals,
    lax_integrals,
    slope_row,
)
from coadjoint.derive.pairs import LaxPair, lax_equations, text_of_entry
from coadjoint.exact import Element
from coadjoint.exact.ranks import error_of_ranks, generic_rank, source_of_ranks
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.completeness import ALMOST
from coadjoint.prove.equivalence import LegendreMap
from coadjoint.prove.findings import for_parameters
from coadjoint.prove.identities import drift
from coadjoint.prove.zero import Decision, Discovery, Examined, decide_zero, mark_place

#: Addends of an integral up to which it is differentiated along the motion: 40 take 0.1 seconds in
#: six dimensions, 800 a minute.
LONGEST = 100
#: Products of addends in a bracket of two integrals up to which it is multiplied out.
LARGEST = 2000
TRACE_IDENTITY = "d tr L^k/dt = k tr(L^(k-1) [L, M]) by the proved Lax equation"


def about_pairs(routes: Sequence[Equations]) -> Iterator[Examined]:
    """That each pair says what moves, and that the integrals of the first one are that."""
    first, decisions = routes[0], dict[str, Callable[[], Decision]]()
    others = (each for each in routes if each.pair is None and each.chart is None)
    motion = next(others, first)
    for equations in routes:
        pair = equations.pair
        if pair is None:
            continue
        decisions[" ".join(pair.texts)] = decide = cache(partial(lax_decision, motion, pair))
        statement = (
            f"dL/dt = [L, M] for every {pair.spectral}, with L = {pair.texts[0]} and M = "
            f"{pair.texts[1]}, on the route {equations.route}"
        )
        examined = [(statement, "lax", decide)]
        yield from mark_place(pair.declared, examined, first.setting.field)
    integrals = lax_integrals(first.setting)
    if integrals is not None:
        of_pair = decisions[" ".join(integrals.pair.texts)]
        yield from _about_integrals(first, integrals, of_pair)


def lax_decision(motion: Equations, pair: LaxPair) -> Decision:
    """Whether ``dL/dt = [L, M]`` along a motion, or the entry where it is not."""
    setting = motion.setting
    rates = dict(zip(setting.state, motion.exact.rates, strict=True))
    settled = motion.close
    if LegendreMap.applies(motion):
        settled = partial(LegendreMap(motion).pull_back, motion)
    everything = []
    for equation in lax_equations(setting, pair):
        left = setting.field.sum(slope * rates[x] for x, slope in equation.slopes.items())
        defect = settled(left - equation.right)
        decision = decide_zero([defect], setting.field)
        if decision.verdict is not Verdict.PROVED:
            where = text_of_entry(equation.entry, equation.power, pair.spectral)
            method = f"{decision.method} in {where} of dL/dt - [L, M]"
            return Decision(
                verdict=decision.verdict,
                method=method,
                point=decision.point,
                defect=decision.defect,
            )
        everything.append(defect)
    return decide_zero(everything, setting.field)


def _about_integrals(
    first: Equations, integrals: Integrals, of_pair: Callable[[], Decision]
) -> Iterator[Examined]:
    """How many integrals there are, that they are conserved, and in involution."""
    spec, names = first.spec, [name for name, _ in integrals.named]
    rank = _rank(first, [each.value for each in integrals.coefficients])
    casimirs = [f"casimir{n}" for n in range(1, len(spec.casimirs) + 1)]
    whole = ", ".join([*casimirs, *["energy"] * first.setting.has_energy, *names])
    yield (
        f"{rank} independent integrals: the coefficients of tr L^k, "
        f"k = 1 to {len(integrals.pair.L)}, are functions of {whole}",
        "conserved",
        partial(_complete, first, integrals, rank),
    )
    again = cache(lambda: list(expanded_traces(first.setting, integrals.pair)))
    for name, each in zip(names, integrals.emitted, strict=True):
        power = f"{integrals.pair.spectral}^{each.power}"
        yield (
            f"{name}, from tr L^{each.trace} at {power}, is conserved",
            "conserved",
            partial(_decide_conserved, first, name, each, of_pair, again),
        )
    pairs = list(combinations(integrals.emitted, 2))
    length = first.setting.field.terms
    if first.exact.poisson_tensor is not None and pairs:
        sizes = (len(length(a.value)) * len(length(b.value)) for a, b in pairs)
        if max(sizes) <= LARGEST:
            yield (
                f"{', '.join(names)} are in involution",
                "conserved",
                lambda: [_bracket(first, a.value, b.value) for a, b in pairs],
            )


def _rank(first: Equations, functions: Sequence[Element]) -> int:
    """How many of some functions are independent at almost every point."""
    rows = [slope_row(first.setting, function) for function in functions]
    return generic_rank(first.setting.field, rows)


def _complete(first: Equations, integrals: Integrals, rank: int) -> Decision | Discovery:
    """Every coefficient depends on what is emitted, which is independent.

    That the emitted ones are independent is certain, that the others depend on them is not.
    """
    emitted = dict(first.exact.observables)
    known = known_integrals(first.setting)
    before = _rank(first, known)
    known += [emitted[name] for name, _ in integrals.named]
    own = _rank(first, known)
    values = [each.value for each in integrals.coefficients]
    together = _rank(first, [*known, *values])
    if own == together == before + len(integrals.named):
        gradients = [slope_row(first.setting, f) for f in (*known, *values)]
        source = source_of_ranks(first.setting.field, (gradients, own))
        error = error_of_ranks(first.setting.field, gradients)
        scope = ALMOST + for_parameters(first.setting, [*known, *values])
        return Discovery(f"rank of the gradients {source}", scope, error)
    return Decision(
        verdict=Verdict.REFUTED,
        method=f"gradients of rank {own}, with all coefficients of rank {together}",
        point={},
        defect=str(together - own or before + len(integrals.named) - own),
    )


def _decide_conserved(
    first: Equations,
    name: str,
    each: Coefficient,
    of_pair: Callable[[], Decision],
    again: Callable[[], Sequence[Coefficient]],
) -> Sequence[Element] | Decision:
    """Whether an emitted integral is conserved: by its rate, or if it is long by the pair."""
    value = dict(first.exact.observables)[name]
    if len(first.setting.field.terms(value)) <= LONGEST:
        return drift(first, value)
    if of_pair().verdict is not Verdict.PROVED:
        return Decision(
            verdict=Verdict.REFUTED,
            method="the Lax equation does not hold",
            point={},
            defect="[L, M] - dL/dt",
        )
    (same,) = (c for c in again() if (c.trace, c.power) == (each.trace, each.power))
    decision = decide_zero([same.value - value], first.setting.field)
    proved = decision.verdict is Verdict.PROVED
    return Decision(verdict=Verdict.PROVED, method=TRACE_IDENTITY) if proved else decision


def _bracket(first: Equations, f: Element, h: Element) -> Element:
    """``{f, h}`` by the emitted bracket."""
    field, tensor = first.setting.field, first.exact.poisson_tensor
    assert tensor is not None, "asked for with a bracket alone"
    df, dh = slope_row(first.setting, f), slope_row(first.setting, h)
    return field.sum(
        x * tensor[i][j] * y for i, x in df.items() for j, y in dh.items() if tensor[i][j]
    )
