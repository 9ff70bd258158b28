"""Brackets: the Poisson bracket of a motion, that it gives the motion, and its Casimirs.

Comes in: a motion with a bracket. Goes out: statements, and what must be zero. Of each Casimir it
is said whether what acts in addition to the bracket leaves it alone.
Read next: `coadjoint.prove.completeness`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cache, partial
from itertools import zip_longest

from coadjoint.algebra import LieAlgebra
from coadjoint.derive import Equations
from coadjoint.derive.structure import exact_momentum_algebra
from coadjoint.errors import AlgebraError
from coadjoint.exact import Element
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.completeness import bracket_of, completeness, describe
from coadjoint.prove.driven import has_moving_momenta, motion_defects
from coadjoint.prove.equivalence import in_velocities
from coadjoint.prove.identities import (
    Tensor,
    antisymmetry_defects,
    casimir_defects,
    hamiltonian_defects,
)
from coadjoint.prove.motion import Motion
from coadjoint.prove.searches import within_budget
from coadjoint.prove.zero import (
    CONSTANTS,
    Decision,
    Examined,
    decide_zero,
    mark_claimed,
    mark_place,
    prove_by_normal_form,
)
from coadjoint.spec import Formula


def about_algebra(motion: Motion) -> Iterator[Examined]:
    """The algebra."""
    if motion.spec.algebra is not None:
        algebra = exact_momentum_algebra(motion.setting)
        yield (
            f"{algebra.name} satisfies the Jacobi identity",
            "algebra",
            lambda: _constants(algebra),
        )


def _constants(algebra: LieAlgebra) -> Decision:
    """Jacobi identity of the structure constants; they were refused if it failed."""
    algebra.check_jacobi()
    return Decision(verdict=Verdict.PROVED, method=CONSTANTS)


def about_bracket(motion: Motion) -> Iterator[Examined]:
    """The bracket of a free motion."""
    first, tensor = motion.equations, motion.equations.exact.poisson_tensor
    assert tensor is not None, first.route
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
        if structure.lie_algebra is not None:
            return Decision(verdict=Verdict.PROVED, method=CONSTANTS)
    defects = list(structure.jacobi_defects().values())
    if defects:
        return decide_zero(defects, structure.field)
    return prove_by_normal_form(structure.field)


def about_hamiltonian(motion: Motion) -> Iterator[Examined]:
    """That the motion is the bracket with the energy, and what acts in addition to it."""
    first = motion.equations
    energy, tensor = first.exact.energy, first.exact.poisson_tensor
    if energy is not None and tensor is not None:
        yield (
            f"{_name_motion(first)} by {first.route} is {{x, h}}{_name_added_terms(first)}",
            "equivalence",
            partial(_bracket_defects, first, energy, tensor),
        )


def _name_motion(first: Equations) -> str:
    """What the rates are: of a motion with noise its drift."""
    return "the drift of the motion" if first.spec.noise else "the motion"


def _name_added_terms(first: Equations) -> str:
    """What acts in addition to the energy, as the end of a statement."""
    spec, relaxation = first.spec, first.spec.relaxation
    parts = [" + dx/dt at fixed momenta"] * has_moving_momenta(first)
    along = " along the section" * (spec.reduction is not None)
    parts += [f" and the forces{along}"] * spec.is_forced
    return "".join([*parts, *([f" and {relaxation.added}"] if relaxation else [])])


def _bracket_defects(first: Equations, energy: Element, tensor: Tensor) -> list[Element]:
    """The rates minus the brackets with the energy, and minus what time adds to velocities."""
    defects = hamiltonian_defects(first, energy, tensor)
    return motion_defects(first, defects) if has_moving_momenta(first) else defects


# -- Casimirs -------------------------------------------------------------------------------------


def about_casimirs(motion: Motion) -> Iterator[Examined]:
    """The claimed Casimirs, whether they survive what acts, and whether these are all."""
    first, spec, field = motion.equations, motion.spec, motion.field
    proved = list[Element]()
    for place, casimir in enumerate(spec.casimirs):
        decide = cache(partial(_casimir, motion, casimir))
        examined = [(f"{casimir.in_one_line} is a Casimir", "casimir", decide)]
        yield from mark_claimed(spec, ("claims", "casimirs", place), casimir, examined, field)
        if decide().verdict is Verdict.PROVED:
            proved += first.setting.components(casimir)
            yield from mark_place(casimir, _about_survival(motion, casimir), field)
    searched = _about_completeness(motion, proved)
    yield from within_budget(field, "casimir", "Casimirs", searched)


def _casimir(motion: Motion, casimir: Formula) -> Decision:
    """Whether all components of a claimed Casimir commute with the state."""
    first, parts = motion.equations, motion.setting.components(casimir)
    defects = [defect for part in parts for defect in casimir_defects(first, part)]
    return decide_zero(defects, motion.field, motion.where, in_velocities(first, parts))


def _about_survival(motion: Motion, casimir: Formula) -> Iterator[Examined]:
    """What becomes of a Casimir where something acts in addition to the bracket."""
    first = motion.equations
    if not first.exact.forces:
        return
    *others, last = motion.acting
    acting = ", ".join(others) + " and " * bool(others) + last
    parts = first.setting.components(casimir)
    if all(first.setting.field.is_zero(first.work(part)) for part in parts):
        verb = "do" if others else "does"
        statement = f"{casimir.in_one_line} is conserved: {acting} {verb} not change it"
        yield statement, "conserved", lambda: _decide_rates(motion, parts)
        return
    gained = in_velocities(first, map(first.work, parts))
    statement = f"{casimir.in_one_line} changes only by {acting}"
    yield statement, "conserved", lambda: _decide_rates(motion, parts, gained)


def _decide_rates(
    motion: Motion, parts: Sequence[Element], gained: Sequence[Element] = ()
) -> Decision:
    """Whether functions have given rates, or none."""
    rates = map(motion.rate, parts)
    rest = [a - b for a, b in zip_longest(rates, gained, fillvalue=motion.field.zero)]
    return decide_zero(rest, motion.field, motion.where)


def _about_completeness(motion: Motion, proved: Sequence[Element]) -> Iterator[Examined]:
    """Casimirs other than those claimed and proved, and whether these are all."""
    first = motion.equations
    known = completeness(first, proved=proved, reach=motion.reach)
    for casimir in known.found:
        yield (
            f"{describe(first.setting.field, casimir)} is a Casimir",
            "casimir",
            partial(casimir_defects, first, casimir, known.generating),
        )
    yield known.statement, "casimir", lambda: known.decision
