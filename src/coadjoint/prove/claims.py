"""Every claim about a system, and every search, examined one after the other.

Comes in: a Spec. Goes out: its Certificate. One table lists what is examined, each part with the
motions for which it has a meaning: with constraints or without, forced, driven or neither.
Read next: `coadjoint.prove.motion` for what all parts ask of a motion, `coadjoint.prove.zero` for
how something is decided to be zero.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from time import perf_counter
from typing import Any

from coadjoint.derive import Equations, derive, make_setting
from coadjoint.derive.domain import region
from coadjoint.errors import check_type
from coadjoint.exact import Element, Field, Region
from coadjoint.prove import indexed
from coadjoint.prove.agreement import about_equality, about_legendre
from coadjoint.prove.almost_poisson import about_reduced_bracket, about_reduced_jacobi
from coadjoint.prove.attitudes import about_attitudes
from coadjoint.prove.bound_symmetries import about_motion_symmetries
from coadjoint.prove.brackets import (
    about_algebra,
    about_bracket,
    about_casimirs,
    about_hamiltonian,
)
from coadjoint.prove.candidates import about_candidates
from coadjoint.prove.carried import carry_over
from coadjoint.prove.certificate import Certificate, Claim, Finding
from coadjoint.prove.constrained import motion_of
from coadjoint.prove.constraints import about_constraints, about_kept
from coadjoint.prove.equivalence import LegendreMap
from coadjoint.prove.fields import about_fields
from coadjoint.prove.first_order import about_form, about_stationarity
from coadjoint.prove.galilean import about_galilean
from coadjoint.prove.integrability import about_integrability
from coadjoint.prove.integrals import about_energy, about_integrals, about_spatial
from coadjoint.prove.lax import about_pairs
from coadjoint.prove.measures import about_measure
from coadjoint.prove.momenta import about_momenta
from coadjoint.prove.motion import Motion
from coadjoint.prove.noise import about_noise, has_noise
from coadjoint.prove.points import Points
from coadjoint.prove.projection import about_projection
from coadjoint.prove.reductions import about_reduction
from coadjoint.prove.relaxation import about_relaxation
from coadjoint.prove.reversibility import about_reversal
from coadjoint.prove.rolling import about_rolling
from coadjoint.prove.searches import within_budget
from coadjoint.prove.symmetries import about_symmetries, about_transformations
from coadjoint.prove.truncated import extend_truncated
from coadjoint.prove.variational import about_extremals
from coadjoint.prove.zero import (
    Decision,
    Discovery,
    Examined,
    UndecidedError,
    decide_zero,
    make_entry,
)
from coadjoint.spec import Spec
from coadjoint.spec.core.source import Place


@dataclass(frozen=True)
class Examination:
    """One part of a certificate.

    Attributes:
        about: Its statements; of a motion, or of the Equations by all routes.
        applies: Whether it has a meaning for a motion.
        of_routes: Whether it is about the routes and not about one motion.
        kind: Of a search, which ends after some work, the kind of its findings; else "".
        subject: Of a search, what is searched for.
    """

    about: Callable[[Any], Iterator[Examined]]
    applies: Callable[[Motion], bool] = lambda motion: True
    of_routes: bool = False
    kind: str = ""
    subject: str = ""


def has_frame(motion: Motion) -> bool:
    """Whether velocities along a frame are the state, which constraints may bind."""
    return motion.equations.distribution is not None


def is_written_out(motion: Motion) -> bool:
    """Whether the rates are functions of the state that can be differentiated by it."""
    return not motion.equations.opaque


def has_reduced_bracket(motion: Motion) -> bool:
    """Whether velocities along a frame are the state, and the bracket of theirs is looked at."""
    return has_frame(motion) and is_written_out(motion)


def has_fixed_constraints(motion: Motion) -> bool:
    """Whether there are constraints that are the same at all times."""
    distribution = motion.equations.distribution
    if distribution is None or not distribution.equations or not is_written_out(motion):
        return False
    reached = (motion.field.reach(equation.residual) for equation in distribution.equations)
    return not frozenset[str]().union(*reached) & {*motion.setting.driving}


def is_free(motion: Motion) -> bool:
    """Whether momenta or velocities of coordinates are the state, or a bracket is declared."""
    return not has_frame(motion)


def has_bracket(motion: Motion) -> bool:
    """Whether a free motion has a Poisson bracket."""
    return is_free(motion) and motion.equations.exact.poisson_tensor is not None


def names_bracket(motion: Motion) -> bool:
    """Whether a motion along a frame is claimed to have Casimirs, brackets or momentum maps.

    Under constraints symmetries are claimed of the motion and not of its bracket.
    """
    spec = motion.spec
    symmetric = spec.symmetries and not spec.constraints
    return has_frame(motion) and bool(spec.casimirs or spec.brackets or symmetric)


def relaxes_along_frame(motion: Motion) -> bool:
    """Whether a symmetric bracket acts where velocities along a frame are the state."""
    return has_frame(motion) and motion.spec.relaxation is not None


def _about_relaxation_along(motion: Motion) -> Iterator[Examined]:
    """The same conditions by the bracket that is carried over to velocities."""
    whole = carry_over(motion)
    yield from about_relaxation(whole.equations, whole.others)


def lacks_bracket(motion: Motion) -> bool:
    """Whether symmetries are claimed of the motion alone: no Poisson bracket is declared."""
    spec, named = motion.spec, has_frame(motion) or has_bracket(motion)
    return bool(spec.constraints) or spec.reduction is not None or not named


def has_energy(motion: Motion) -> bool:
    """Whether the motion has an energy."""
    return motion.equations.exact.energy is not None


def is_searched(motion: Motion) -> bool:
    """Whether the rates are the whole motion, and written out: searches look at these alone."""
    return is_written_out(motion) and not has_noise(motion)


def has_transform(motion: Motion) -> bool:
    """Whether a Lagrangian is there for a free motion."""
    spec = motion.spec
    regular = spec.lagrangian is not None and not spec.is_first_order
    return is_free(motion) and regular and not spec.variational


def is_variational(motion: Motion) -> bool:
    """Whether constraints are imposed before the variation."""
    return bool(motion.spec.variational)


def is_first_order(motion: Motion) -> bool:
    """Whether the Lagrangian is singular in the velocities."""
    return motion.spec.is_first_order


#: All that is examined, in the order of the certificate.
EXAMINATIONS = (
    Examination(about=about_algebra),
    Examination(about=about_bracket, applies=has_bracket),
    Examination(about=about_constraints, applies=has_frame),
    Examination(about=about_legendre, applies=has_transform, of_routes=True),
    Examination(about=about_extremals, applies=is_variational),
    Examination(about=about_stationarity, applies=is_first_order),
    Examination(about=about_form, applies=is_first_order, of_routes=True),
    Examination(about=lambda motion: about_reduction(motion.equations)),
    Examination(about=about_equality, of_routes=True),
    Examination(about=about_hamiltonian, applies=has_bracket),
    Examination(about=about_energy, applies=has_energy),
    Examination(about=about_kept, applies=has_frame),
    Examination(about=lambda motion: about_projection(motion.equations), applies=has_frame),
    Examination(about=about_rolling, applies=has_frame),
    Examination(about=lambda motion: about_relaxation(motion.equations), applies=is_free),
    Examination(about=_about_relaxation_along, applies=relaxes_along_frame),
    Examination(about=about_noise, applies=has_noise),
    Examination(about=about_casimirs, applies=has_bracket),
    Examination(about=lambda motion: about_casimirs(carry_over(motion)), applies=names_bracket),
    Examination(about=about_integrals),
    Examination(about=about_galilean),
    Examination(about=about_momenta),
    Examination(about=about_reduced_bracket, applies=has_reduced_bracket),
    Examination(about=about_symmetries, applies=has_bracket),
    Examination(about=lambda motion: about_symmetries(carry_over(motion)), applies=names_bracket),
    Examination(about=about_motion_symmetries, applies=lacks_bracket),
    Examination(about=about_transformations),
    Examination(about=about_attitudes),
    Examination(about=about_spatial),
    Examination(about=about_pairs, of_routes=True),
    Examination(
        about=lambda motion: about_integrability(motion.equations),
        applies=has_fixed_constraints,
        kind="integrability",
        subject="the growth vector",
    ),
    Examination(
        about=about_reduced_jacobi,
        applies=has_reduced_bracket,
        kind="jacobi",
        subject="the Jacobi identity of the reduced bracket",
    ),
    Examination(
        about=about_reversal,
        applies=is_searched,
        kind="transformation",
        subject="the reversal of time",
    ),
    Examination(about=about_candidates, applies=is_searched, kind="integrals", subject="integrals"),
    Examination(
        about=about_measure, applies=is_searched, kind="measure", subject="invariant measures"
    ),
)


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
    check_type("prove", spec, Spec, "what coadjoint.read_spec returns")
    if spec.family is None:
        return replace(indexed.bind_size(spec, _certify(spec, routes)), spec=spec)
    windows = indexed.list_windows(spec)
    extend = extend_truncated if spec.family.truncation else indexed.extend
    known = [_certify(each, searched=False) for each in windows]
    return replace(extend(spec, known), spec=spec)


def _certify(spec: Spec, routes: Sequence[Equations] = (), *, searched: bool = True) -> Certificate:
    """The certificate of a system whose state is written out, with or without searches."""
    if not routes:
        setting = make_setting(spec)
        routes = [derive(spec, route, setting=setting) for route in spec.routes]
    field = routes[0].setting.field
    field.region = _region(routes[0])
    _check_domain(spec, field)
    claims, findings, start = list[Claim](), list[Finding](), perf_counter()
    for statement, kind, examine in _claims(routes, searched=searched):  # finding takes its time
        result = _examine(spec, statement, examine, field)
        seconds, start = perf_counter() - start, perf_counter()
        entry = make_entry(statement, kind, result, seconds)
        if isinstance(entry, Claim):
            claims.append(entry)
        else:
            findings.append(entry)
    return Certificate(spec.name, tuple(claims), tuple(findings))


def _claims(routes: Sequence[Equations], *, searched: bool) -> Iterator[Examined]:
    """All statements in the order of the certificate, those of searches included or not."""
    if routes[0].spec.space is not None:
        yield from about_algebra(motion_of(routes[0]))
        yield from about_fields(routes)
        return
    motion = motion_of(routes[0])
    for part in EXAMINATIONS:
        if part.applies(motion) and (searched or not part.kind):
            examined = part.about(routes if part.of_routes else motion)
            if part.kind:
                examined = within_budget(motion.field, part.kind, part.subject, examined)
            yield from examined


def _examine(
    spec: Spec,
    statement: str,
    examine: Callable[[], Sequence[Element] | Decision | Discovery],
    field: Field,
) -> Decision | Discovery:
    """The decision about one claim.

    Raises:
        UndecidedError: No point is found at which it could fail; with the claim.
    """
    try:
        result = examine()
        return result if isinstance(result, Decision | Discovery) else decide_zero(result, field)
    except UndecidedError as error:
        message = f"undecided: {statement}: {error}"
        raise _fault(spec, error.place, message, statement) from error


def _fault(spec: Spec, place: Place | None, message: str, found: str) -> UndecidedError:
    """An error that points at a place, if there is one."""
    if place is None:
        return UndecidedError(f"{spec.path}: {message}", system=spec.name, found=found)
    return UndecidedError(
        place.locate(spec.path, message),
        system=spec.name,
        path=str(spec.path),
        line=place.line,
        key=place.key,
        found=found,
    )


def _region(first: Equations) -> Region:
    """Where claims are looked at: the domain of the spec."""
    if first.spec.space is not None:
        return first.setting.field.region
    momenta = LegendreMap(first).momenta if LegendreMap.applies(first) else {}
    return region(first, momenta)


def _check_domain(spec: Spec, field: Field) -> None:
    """Look for a point of the domain: on an empty one anything is true.

    Raises:
        UndecidedError: None is found at which the motion has a value.
    """
    points = Points(field, ())
    if next(chain(points.near_defaults(), points), None) is None:
        message = (
            "no point is found in [domain] at which the motion has a value. Expected real points "
            "with the declared signs. Correct [domain], the energy or the forces, or give defaults "
            "near which there are some."
        )
        conditions = [each.left for each in spec.domain]
        formulas = (*conditions, spec.hamiltonian, spec.lagrangian)
        raise _fault(spec, next(filter(None, formulas), None), message, spec.name)
