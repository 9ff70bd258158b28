"""Counts of integrals: what a search has found up to a degree, as claims and findings.

Comes in: a motion. Goes out: the integrals that are found, each proved, and how many there are:
proved where bounds from both sides meet. How they are bounded says `coadjoint.prove.candidates`.
Read next: `coadjoint.prove.measures`, which asks for a volume instead.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import partial

from coadjoint.derive.integrals import lax_integrals
from coadjoint.exact import Element, element_text
from coadjoint.prove.candidates import CandidateSearch, Degrees, Known
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.completeness import described
from coadjoint.prove.motion import Motion, vector_names
from coadjoint.prove.samples import Samples
from coadjoint.prove.zero import Decision, Discovery, Examined
from coadjoint.spec import Spec

#: Degrees in the velocities and in the positions up to which integrals are looked for: those of
#: Jellett and Routh have the degrees (1, 1) and (2, 2).
DEGREES = (2, 2)
#: Monomials among which integrals are looked for; 200 take about a second.
MONOMIALS = 200
#: How likely it is that more is wrong than what is certain.
LUCK = "an error has a chance below 1e-9"


def about_candidates(motion: Motion) -> Iterator[Examined]:
    """All integrals up to a degree: from those that are known, or found beyond them."""
    known = known_integrals(motion)
    search, where = CandidateSearch(motion, known), _almost_all(motion)
    if search.samples.obstacle:
        yield _passed_over(search)
        return
    degrees = affordable(search)
    if search.independent(search.found(degrees)):
        at_numbers = CandidateSearch(motion, known, default_numbers(motion.equations.spec))
        if not at_numbers.samples.obstacle:
            search, where = at_numbers, _at_defaults(motion)
            for element in search.new(degrees):
                text = f"{described(motion.field, element)} is conserved{where.lstrip(',')}"
                yield text, "integrals", partial(search.drift, element)
    yield _counted(search, degrees, where)


def _counted(search: CandidateSearch, degrees: Degrees, where: str) -> Examined:
    """How many integrals there are: proved where bounds from both sides meet, else found."""
    found, scope = search.found(degrees), f"integrals {_scope(search, degrees)}{where}"
    (certain, names), bounded = search.polynomials(degrees), search.bounded(degrees)
    points = f"ranks at {len(search.values_at)} random points modulo {search.samples.prime}"
    listed = f"polynomials in {', '.join(names)}" if names else "constants"
    size = f"a space of dimension {len(found)} with constants"
    if bounded and certain == len(found):
        decision = Decision(Verdict.PROVED, f"{points}, from above and from below")
        text = f"{size}, all {listed}" if names else "none but constants"
        return f"{scope}: {text}", "integrals", lambda: decision
    others = len(search.independent(found))
    names_of = ", ".join(dict.fromkeys(each.text for each in search.known)) or "constants"
    every = f"{names_of} and of {others} more of them" if others else names_of
    most, sure = "", "that there are so many polynomials is exact"
    if bounded:
        most, sure = " at the most", "the bound, and that there are so many polynomials, are exact"
    text = f"{size}{most}, {certain} of it {listed}; all are functions of {every}"
    discovery = Discovery(points, where.strip(", "), f"{sure}; for the rest {LUCK}")
    return f"{scope}: {text}", "integrals", lambda: discovery


def _almost_all(motion: Motion) -> str:
    almost = ", for almost all parameters" if motion.setting.parameters else ""
    return almost + motion.at_all_times


def _at_defaults(motion: Motion) -> str:
    """The numbers of the parameters, in words."""
    if not motion.setting.parameters:
        return motion.at_all_times
    whole = all(each.default is not None for each in motion.spec.parameters)
    others = "" if whole else " and 1 where there is none"
    return f", at the default parameters{others}{motion.at_all_times}"


def _passed_over(search: CandidateSearch) -> Examined:
    """That nothing was looked for, and why."""
    names = ", ".join(each.text for each in search.known) or "constants"
    text = f"integrals beside {names} were not looked for: {search.samples.obstacle}"
    return text, "integrals", lambda: Discovery("no search")


def known_integrals(motion: Motion) -> list[Known]:
    """What may be conserved as a spec or a theorem has it, as functions of the state.

    What changes at a random point is none; what does not is proved where a proof rests on it.
    """
    setting, spec, where = motion.setting, motion.spec, Samples(motion).where
    names, energy = motion.emitted, motion.equations.exact.energy
    stated = {} if energy is None else {"energy": [motion.closed(energy)]}
    for claim in spec.conserved:
        level = [motion.closed(g) for f in claim.where for g in setting.components(f, names)]
        if all(where.contains(g) for g in level):
            parts = list(map(motion.closed, setting.components(claim.formula, names)))
            stated[claim.formula.in_one_line] = parts
    for casimir in spec.casimirs:
        stated[casimir.in_one_line] = list(map(motion.closed, setting.components(casimir)))
    emitted = dict(motion.equations.exact.observables)
    named = [(each.name, each.components) for each in spec.sections]
    named += [(each.name, each.components) for each in spec.symmetries]
    named += [(each.name, each.components) for each in spec.spatial]
    for name, components in named:
        stated[name] = [motion.closed(emitted[component]) for component in components]
    pair = lax_integrals(setting)
    stated |= {} if pair is None else {name: [motion.closed(x)] for name, x in pair.named}
    known, found = {*setting.state, *setting.parameters}, list[Known]()
    for text, parts in stated.items():
        plain = parts and all(motion.field.reach(part) <= known for part in parts)
        if plain and not _changes(motion, parts):
            found.append(Known(text, tuple(parts)))
    return found


def _changes(motion: Motion, parts: Sequence[Element]) -> bool:
    """Whether functions certainly change along the motion, or have no values at its points."""
    samples = Samples(motion, None, parts)
    point = next(samples.points(), None)
    return point is None or any(point.moved(samples.slopes(part)) for part in parts)


def default_numbers(spec: Spec) -> dict[str, Fraction]:
    """The default of every parameter; 1 where there is none."""
    return {
        name: value
        for each in spec.parameters
        for name, value in zip(
            each.components, each.default or [Fraction(1)] * len(each.components), strict=True
        )
    }


def affordable(search: CandidateSearch) -> Degrees:
    """The degrees that are searched, lower where there are very many monomials."""
    most, degree = DEGREES
    while max(map(len, search.sectors((most, degree)))) > MONOMIALS and most + degree > 1:
        most, degree = (most, degree - 1) if degree else (most - 1, degree)
    return most, degree


def _scope(search: CandidateSearch, degrees: Degrees) -> str:
    """What was searched, in words: polynomials in these names."""
    text = f"of degree <= {degrees[0]} in {_named(search, search.velocities)}"
    if search.positions:
        text += f" and <= {degrees[1]} in {_named(search, search.positions)}"
    lengths = search.samples.where.text
    return f"{text}, where {lengths}" if lengths else text


def _named(search: CandidateSearch, names: Sequence[str]) -> str:
    """Generators as a statement names them: whole vectors by their name."""
    whole, field = {each.name for each in search.motion.spec.state}, search.field
    shown = vector_names(search.motion, names)
    return ", ".join(n if n in whole else element_text(field, field[n]) for n in shown)
