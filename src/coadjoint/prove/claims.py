"""Every claim about a system, examined one after the other.

Comes in: a Spec. Goes out: its Certificate: the algebra, the bracket, the Legendre transform, the
equality of the routes, and what the spec itself claims.
Read next: `coadjoint.prove.identities` for what must be zero, `coadjoint.prove.zero` for whether.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache, partial
from itertools import chain
from time import perf_counter

from coadjoint.algebra import LieAlgebra
from coadjoint.derive import Equations, derive, make_setting
from coadjoint.derive.domain import region
from coadjoint.derive.interpret import Quantity
from coadjoint.derive.mechanics.reconstruction import fixed_row
from coadjoint.derive.structure import momentum_algebra
from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, Field, Region
from coadjoint.prove.almost_poisson import about_reduced_bracket, about_reduced_jacobi
from coadjoint.prove.candidates import about_candidates, known_integrals
from coadjoint.prove.certificate import LEAVES, Certificate, Claim, Finding, Verdict
from coadjoint.prove.charts import ChartMap, reach
from coadjoint.prove.completeness import bracket_of, completeness, described
from coadjoint.prove.constrained import ConstrainedRates, about_constraints
from coadjoint.prove.driven import has_moving_momenta, motion_defects, while_constant
from coadjoint.prove.duality import about_duality
from coadjoint.prove.energy import Balance, keeps_energy
from coadjoint.prove.equivalence import LegendreMap, in_velocities
from coadjoint.prove.galilean import about_galilean
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.identities import (
    Tensor,
    antisymmetry_defects,
    casimir_defects,
    drift,
    gradient,
    hamiltonian_defects,
)
from coadjoint.prove.integrability import about_integrability
from coadjoint.prove.lax import about_pairs
from coadjoint.prove.measures import about_measure
from coadjoint.prove.momenta import about_momenta
from coadjoint.prove.points import Points
from coadjoint.prove.projection import about_projection
from coadjoint.prove.reductions import about_reduction, on_section, restriction_of
from coadjoint.prove.relaxation import about_relaxation, lost
from coadjoint.prove.reversibility import about_reversal
from coadjoint.prove.rolling import about_rolling
from coadjoint.prove.searches import within_budget
from coadjoint.prove.symmetries import about_symmetries
from coadjoint.prove.zero import (
    CONSTANTS,
    Decision,
    Discovery,
    Examined,
    UndecidedError,
    claimed_by,
    decide_zero,
    make_entry,
    proved_by_normal_form,
)
from coadjoint.spec import Formula, Spec
from coadjoint.spec.model import Integral
from coadjoint.spec.spatial import SpatialMomentum


def prove(spec: Spec, routes: Sequence[Equations] = ()) -> Certificate:
    """Examine every claim about a declared system.

    Time and memory are not bounded; for specs of strangers there is `coadjoint.prove_bounded`.

    Args:
        spec: What `coadjoint.read_spec` returned.
        routes: Equations by every route of the spec in one Setting, if they were derived before.

    Returns:
        The certificate, refuted claims included; `Certificate.require` raises on those.

    Raises:
        DerivationError: A route cannot be followed.
        UndecidedError: No point is found at which a claim has a value.
    """
    if not routes:
        setting = make_setting(spec)
        routes = [derive(spec, route, setting=setting) for route in spec.routes]
    field = routes[0].setting.field
    field.region = _region(routes[0])
    _check_domain(spec.name, field)
    claims, findings, start = list[Claim](), list[Finding](), perf_counter()
    for statement, kind, examine in _claims(routes):  # what is found out takes its time here
        found = _examined(spec, statement, examine, field)
        seconds, start = perf_counter() - start, perf_counter()
        entry = make_entry(statement, kind, found, seconds)
        if isinstance(entry, Claim):
            claims.append(entry)
        else:
            findings.append(entry)
    return Certificate(spec.name, tuple(claims), tuple(findings))


def _examined(
    spec: Spec,
    statement: str,
    examine: Callable[[], Sequence[Element] | Decision | Discovery],
    field: Field,
) -> Decision | Discovery:
    """What becomes of one claim.

    Raises:
        UndecidedError: No point is found at which it could fail; with the claim.
    """
    try:
        found = examine()
        return found if isinstance(found, Decision | Discovery) else decide_zero(found, field)
    except UndecidedError as error:
        raise UndecidedError(
            f"{spec.name}: undecided: {statement}: {error}", system=spec.name, found=statement
        ) from error


def _region(first: Equations) -> Region:
    """Where claims are looked at: the domain of the spec."""
    momenta = LegendreMap(first).momenta if LegendreMap.applies(first) else {}
    return region(first, momenta)


def _check_domain(name: str, field: Field) -> None:
    """Look for a point of the domain: on an empty one anything is true.

    Raises:
        UndecidedError: None is found at which the motion has a value.
    """
    points = Points(field, ())
    if next(chain(points.near_defaults(), points), None) is None:
        raise UndecidedError(
            f"{name}: no point is found in [domain] at which the motion has a value. Expected real "
            "points with the declared signs. Correct [domain], the energy or the forces, or give "
            "defaults near which there are some.",
            system=name,
        )


def _claims(routes: Sequence[Equations]) -> Iterator[Examined]:
    """All claims in the order of the certificate."""
    first = routes[0]
    yield from _about_algebra(first)
    if first.distribution is not None:
        motion = ConstrainedRates(first)
        yield from about_constraints(motion, routes[1:])
        yield from about_projection(first)
        yield from about_rolling(motion)
        for place, claim in enumerate(first.spec.conserved):
            if _statement(claim) != "energy is conserved" or not keeps_energy(first):
                examine = partial(_constrained_integral, motion, claim)
                statement = _statement(claim) + _held(first, claim)
                claimed = [(statement, "conserved", examine)]
                yield from claimed_by(
                    first.spec, ("claims", "conserved", place), claimed, motion.field
                )
        yield from about_momenta(motion)
        yield from about_reduced_bracket(motion)
        yield from _searched(motion, _emitted(first))
        return
    yield from _about_bracket(first)
    pulled = LegendreMap(first) if first.spec.lagrangian is not None else None
    if pulled is not None:
        yield from _about_legendre(routes, pulled)
    yield from about_reduction(first)
    for other in routes[1:]:
        yield from _about_equality(first, other, pulled)
    yield from _about_motion(first)
    yield from about_pairs(routes)


def _searched(motion: ConstrainedRates, emitted: Mapping[str, Quantity]) -> Iterator[Examined]:
    """What is found out about a constrained motion, each search with a budget of its own.

    Of a driven one only its constraints are examined, if they are the same at all times: the
    unknown coefficients of other searches would count time and inputs among the constants.
    """
    driving = {*motion.equations.setting.driving}
    searches: dict[tuple[str, str], Iterator[Examined]] = {
        ("integrability", "the growth vector"): about_integrability(motion.equations),
        ("jacobi", "the Jacobi identity of the reduced bracket"): about_reduced_jacobi(motion),
        ("transformation", "the reversal of time"): about_reversal(motion),
        ("integrals", "integrals"): _integrals(motion, emitted),
        ("measure", "invariant measures"): about_measure(motion),
    }
    if driving:
        residuals = (equation.residual for equation in motion.distribution.equations)
        moving = frozenset[str]().union(*map(motion.field.reach, residuals)) & driving
        kept = () if moving else ("integrability",)
        searches = {key: found for key, found in searches.items() if key[0] in kept}
    for (kind, subject), examined in searches.items():
        yield from within_budget(motion.field, kind, subject, examined)


def _integrals(motion: ConstrainedRates, emitted: Mapping[str, Quantity]) -> Iterator[Examined]:
    """The search for integrals; what is known already is part of its work."""
    yield from about_candidates(motion, known_integrals(motion, emitted))


def _about_algebra(first: Equations) -> Iterator[Examined]:
    """The algebra."""
    if first.spec.algebra is not None:
        algebra = momentum_algebra(first.setting)
        yield (
            f"{algebra.name} satisfies the Jacobi identity",
            "algebra",
            lambda: _constants(algebra),
        )


def _about_bracket(first: Equations) -> Iterator[Examined]:
    """The bracket."""
    tensor = first.exact.poisson_tensor
    if tensor is None:
        return
    yield (
        "the Poisson tensor is antisymmetric",
        "jacobi",
        lambda: antisymmetry_defects(tensor),
    )
    yield (
        "the Poisson bracket satisfies the Jacobi identity",
        "jacobi",
        lambda: _jacobi(first),
    )


def _jacobi(first: Equations) -> Decision:
    """Jacobi identity of the emitted tensor: of its constants where it is affine in the state."""
    structure = bracket_of(first)
    with suppress(AlgebraError):  # the identity fails; the defects below show where
        if structure.lie_algebra() is not None:
            return Decision(Verdict.PROVED, CONSTANTS)
    defects = list(structure.jacobi_defects().values())
    if defects:
        return decide_zero(defects, structure.field)
    return proved_by_normal_form(structure.field)


def _constants(algebra: LieAlgebra) -> Decision:
    """Jacobi identity of the structure constants; they were refused if it failed."""
    algebra.check_jacobi()
    return Decision(Verdict.PROVED, CONSTANTS)


def _about_legendre(routes: Sequence[Equations], pulled: LegendreMap) -> Iterator[Examined]:
    """The Legendre transform and its energy, on every route."""
    found = pulled.invertible
    yield (
        f"the Legendre transform is invertible {found.where}",
        "legendre",
        lambda: Decision(Verdict.PROVED, found.method),
    )
    for equations in routes:
        yield from about_duality(equations)
        if equations.chart is not None or equations.exact.energy is None:
            continue
        if equations.kept:
            yield (
                f"the kernel solves for the velocities on the route {equations.route}: "
                "L D L^T = d2l/dxi2",
                "legendre",
                partial(pulled.solution_defects, equations),
            )
        yield (
            f"h(dl/dxi) = <dl/dxi, xi> - l on the route {equations.route}",
            "legendre",
            partial(pulled.energy_defects, equations),
        )
        if pulled.momenta:
            yield (
                f"dh/dmu = xi on the route {equations.route}",
                "legendre",
                partial(pulled.velocity_defects, equations),
            )


def _about_equality(
    first: Equations, other: Equations, pulled: LegendreMap | None
) -> Iterator[Examined]:
    """That two routes give the same motion."""
    if other.chart is not None:
        yield from _about_chart(first, other)
    elif pulled is not None and pulled.momenta:
        yield (
            f"{first.route} and {other.route} give the same motion, through the Legendre transform",
            "equivalence",
            partial(pulled.rate_defects, first, other),
        )
    else:
        yield (
            f"{first.route} and {other.route} give the same motion",
            "equivalence",
            lambda: _same_rates(first, other),
        )


def _about_chart(first: Equations, other: Equations) -> Iterator[Examined]:
    """That a route in variables of its own gives the same motion, and where."""
    assert other.chart is not None
    chart_map = ChartMap(first, other)
    relations = ", ".join(relation.text for relation in other.chart.relations)
    where = f", where {relations}" if relations else ""
    elements = [relation.element for relation in other.chart.relations]
    held = while_constant(other, [*elements, *other.chart.state])
    through = f"through {other.chart.through}{where}{held}"
    yield (
        f"{first.route} and {other.route} give the same motion, {through}",
        "equivalence",
        chart_map.related,
    )
    if relations:
        yield f"the route {other.route} keeps {relations}{held}", "equivalence", chart_map.kept
    statement, decision = reach(chart_map)
    yield statement, "equivalence", lambda: decision


def _same_rates(first: Equations, other: Equations) -> list[Element]:
    pairs = zip(first.exact.rates, other.exact.rates, strict=True)
    return [first.closed(a) - other.closed(b) for a, b in pairs]


def _about_motion(first: Equations) -> Iterator[Examined]:
    """The emitted motion: Hamiltonian form, energy, and the claims of the spec."""
    spec, field = first.spec, first.setting.field
    energy, tensor = first.exact.energy, first.exact.poisson_tensor
    if energy is not None and tensor is not None:
        yield (
            f"the motion by {first.route} is {{x, h}}{_beside(first)}",
            "equivalence",
            partial(_bracket_defects, first, energy, tensor),
        )
    if energy is not None:
        yield Balance(first).statement, "conserved", partial(_energy_defects, first, energy)
    yield from about_relaxation(first)
    proved = list[Element]()
    for place, casimir in enumerate(spec.casimirs):
        decide = cache(partial(_casimir, first, casimir))
        examined = [(f"{casimir.in_one_line} is a Casimir", "casimir", decide)]
        yield from claimed_by(spec, ("claims", "casimirs", place), examined, field)
        if decide().verdict is Verdict.PROVED:
            proved += first.setting.components(casimir)
            yield from _about_survival(first, casimir)
    if tensor is not None:
        searched = _about_completeness(first, proved)
        yield from within_budget(field, "casimir", "Casimirs", searched)
    for place, claim in enumerate(spec.conserved):
        statement = _statement(claim) + _held(first, claim)
        claimed = [(statement, "conserved", partial(_integral, first, claim))]
        yield from claimed_by(spec, ("claims", "conserved", place), claimed, field)
    yield from claimed_by(spec, ("claims", "galilean"), about_galilean(first), field)
    yield from about_symmetries(first, _emitted(first))
    for seen in spec.spatial:
        if seen.conserved:
            yield f"{seen.name} is conserved", "conserved", partial(_seen_from_space, first, seen)


def _beside(first: Equations) -> str:
    """What acts beside the energy, as the end of a statement."""
    spec, relaxation = first.spec, first.spec.relaxation
    parts = [" + dx/dt at fixed momenta"] * has_moving_momenta(first)
    parts += [" and the forces"] * spec.is_forced
    return "".join([*parts, *([f" and {relaxation.added}"] if relaxation else [])])


def _bracket_defects(first: Equations, energy: Element, tensor: Tensor) -> list[Element]:
    """The rates minus the brackets with the energy, and minus what time adds to velocities."""
    defects = hamiltonian_defects(first, energy, tensor)
    return motion_defects(first, defects) if has_moving_momenta(first) else defects


def _energy_defects(first: Equations, energy: Element) -> list[Element]:
    """The rate of the energy minus what its balance says, which may hold on a section alone."""
    if first.spec.reduction is None:
        power = _power(first, energy)
    else:
        restriction = restriction_of(first)
        of_whole = restriction.whole.exact.energy
        assert of_whole is not None, "the reader asks for a Hamiltonian"
        power = on_section(restriction, _power(restriction.whole, of_whole))
    return [rate - gain for rate in drift(first, energy) for gain in in_velocities(first, [power])]


def _power(equations: Equations, energy: Element) -> Element:
    """What changes the energy, and by how much."""
    balance = Balance(equations)
    slopes = dict(zip(equations.setting.state, gradient(equations, energy), strict=True))
    return balance.power + balance.work_along_state(slopes) + lost(equations, energy)


def _about_survival(first: Equations, casimir: Formula) -> Iterator[Examined]:
    """What becomes of a Casimir where forces act: no bracket keeps it then."""
    if not first.exact.forces:
        return
    parts = first.setting.components(casimir)
    if all(first.setting.field.is_zero(first.work(part)) for part in parts):
        statement = f"{casimir.in_one_line} is conserved: nothing that acts changes it"
        yield statement, "conserved", lambda: _drifts(first, parts)


def _held(first: Equations, claim: Integral) -> str:
    """The condition on the inputs under which a claim holds."""
    formulas, names = (claim.formula, *claim.where), _emitted(first)
    return while_constant(first, (g for f in formulas for g in first.setting.components(f, names)))


def _seen_from_space(first: Equations, seen: SpatialMomentum) -> Decision:
    """The rates of a momentum as seen from space, at matrices of the group's form."""
    emitted = dict(first.exact.observables)
    fixed = fixed_row(first.setting)
    where = Ideal(
        first.setting.field,
        [relation.element for relation in fixed],
        ", ".join(relation.text for relation in fixed),
    )
    rates = _drifts(first, [emitted[name] for name in seen.components])
    return decide_zero(rates, first.setting.field, where)


def _drifts(first: Equations, parts: Sequence[Element]) -> list[Element]:
    return [rate for part in parts for rate in drift(first, part)]


def _casimir(first: Equations, casimir: Formula) -> Decision:
    """Whether all components of a claimed Casimir commute with the state."""
    parts = first.setting.components(casimir)
    defects = [defect for part in parts for defect in casimir_defects(first, part)]
    return decide_zero(defects, first.setting.field, None, in_velocities(first, parts))


def _integral(first: Equations, claim: Integral) -> Decision:
    """The rates of all components of a claimed integral: zero everywhere, or on its level set.

    The motion must stay on the level set, too: there the functions that define it keep the value 0.
    """
    names, field = _emitted(first), first.setting.field
    rates = _rates(first, claim.formula)
    parts = in_velocities(first, first.setting.components(claim.formula, names))
    if not claim.where:
        return decide_zero(rates, field, None, parts)
    functions = [g for f in claim.where for g in first.setting.components(f, names)]
    level = in_velocities(first, functions)
    kept = [rate for formula in claim.where for rate in _rates(first, formula)]
    where = Ideal(field, level, _vanishing(claim))
    return _conserved_on(where, kept, rates, parts)


def _conserved_on(
    where: Ideal, kept: Sequence[Element], rates: Sequence[Element], parts: Sequence[Element]
) -> Decision:
    """Whether rates vanish where relations hold, and so do those of the relations themselves."""
    found = decide_zero([*kept, *rates], where.field, where, parts)
    if kept and found.verdict is Verdict.REFUTED:
        with suppress(UndecidedError):  # of a branch without points
            left = decide_zero(kept, where.field, where, parts)
            if left.verdict is Verdict.REFUTED:
                return replace(left, method=f"{left.method}: {LEAVES}")
    return found


def _statement(claim: Integral) -> str:
    where = _vanishing(claim)
    return f"{claim.formula.in_one_line} is conserved" + (f" where {where}" if where else "")


def _constrained_integral(motion: ConstrainedRates, claim: Integral) -> Decision:
    """The rates of a claimed integral of a constrained motion, where its constraints hold."""
    first = motion.equations
    names = _emitted(first)
    parts = first.setting.components(claim.formula, names)
    level = [g for f in claim.where for g in first.setting.components(f, names)]
    kept, rates = ([motion.rate(each) for each in functions] for functions in (level, parts))
    text = ", ".join(filter(None, (_vanishing(claim), motion.where.text)))
    where = motion.where.also(list(map(motion.in_state, level)), text)
    return _conserved_on(where, kept, rates, list(map(motion.in_state, parts)))


def _vanishing(claim: Integral) -> str:
    """The level set of a claim: ``dot(Pi, Gamma) = 0``."""
    return ", ".join(f"{formula.in_one_line} = 0" for formula in claim.where)


def _rates(first: Equations, formula: Formula) -> list[Element]:
    """Time derivatives of the components of a formula, which may name what is emitted."""
    parts = first.setting.components(formula, _emitted(first))
    return _drifts(first, parts)


def _about_completeness(first: Equations, proved: Sequence[Element]) -> Iterator[Examined]:
    """Casimirs beside those claimed and proved, and whether these are all."""
    known = completeness(first, proved=proved)
    for casimir in known.found:
        yield (
            f"{described(first.setting.field, casimir)} is a Casimir",
            "casimir",
            partial(casimir_defects, first, casimir, known.generating),
        )
    yield known.statement, "casimir", lambda: known.decision


def _emitted(first: Equations) -> dict[str, Quantity]:
    """The energy and the observables, by the names that claims use."""
    known: dict[str, Quantity] = dict(first.exact.observables)
    return known | {each.name: each.whole for each in first.exact.emitted}
