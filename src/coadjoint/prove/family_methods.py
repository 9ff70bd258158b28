"""Methods of integration, judged for systems of equal members.

Comes in: the Equations of windows, the Family, its loops and the certificate. Goes out: the facts
and every method judged by them, as of other systems. Facts are those of a window: its tensor has a
block for each member, and totals are sums of the same terms for every number of members, so that
kinds of tensors, degrees and the split of the energy do not depend on it. Integrals count where the
certificate has them for every number of members. Steps of families are loops over members
(templates/c/methods/family_steps.c.j2): midpoints, spherical midpoints, discrete gradients of an
energy that is not quadratic, and splittings, by shifts of an energy ``T(p) + V(q)`` and of others
by the flows of their parts.
Read next: `coadjoint.prove.methods`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Final

from coadjoint.derive import Equations
from coadjoint.derive.splittings import Splitting
from coadjoint.exact import Element
from coadjoint.families import Family
from coadjoint.lower.compositions import SPLITTINGS, list_schedules
from coadjoint.lower.flows import lower_flows
from coadjoint.lower.kinks import hold_sides
from coadjoint.lower.loops import Loops
from coadjoint.lower.program import Program
from coadjoint.methods import (
    BY_ENERGY,
    MAPPED,
    NOISY,
    STRUCTURED,
    JudgedMethod,
    Sphere,
    StructuredMethod,
)
from coadjoint.prove.certificate import Certificate
from coadjoint.prove.facts import Facts, Kept
from coadjoint.prove.methods import (
    KINKED,
    SWEEPS,
    Judgement,
    count,
    judge,
    judge_spheres,
    keeps,
    prefer,
    refuse_backward,
    refuse_noisy,
)
from coadjoint.spec.core.components import component_names
from coadjoint.spec.core.members import member_name
from coadjoint.spec.model import Windows

#: Files of methods whose steps there are as loops over members.
LOOPED: Final = ("midpoint", "spherical_midpoint", "sequence", *BY_ENERGY)
#: The two flows of a splitting: positions move with the momenta at rest, and the other way round.
FLOWS: Final = ("flow1", "flow2")
_NONE: Final = "this system is solved by loops over {}, which this method lacks"
_SPHERES: Final = (
    "it expects members that are vectors of three components, each with the bracket of so(3) or a "
    "multiple of it"
)
_SPLIT: Final = (
    "it expects coordinates and momenta with the canonical bracket and an energy T(p) + V(q), or "
    "an energy of neighbours in parts with flows in closed form"
)
_QUADRATIC: Final = (
    "its energy is quadratic, so that the gradient at the middle of a step is a discrete gradient, "
    "and the step is that of the midpoint"
)
_BLOCKS: Final = (
    "it expects an energy that is a sum over members and pairs, and a bracket in closed form of "
    "each member and its neighbours"
)
_PLANE: Final = "Python leads the steps of a field in a plane, between transforms"
#: Methods of NOISY whose steps there are as loops over members.
_NOISY: Final = ("heun", "midpoint")


class FamilyFacts(Facts):
    """Facts of a system of equal members.

    Args:
        windows: Equations of small numbers of members, the first route of each.
        declared: What is known of the other members.
        family: Those of the generic member.
        loops: Its functions.
        certificate: What is proved for every number of members.
        splittings: The windows in the parts whose flows the family has.
    """

    def __init__(
        self,
        windows: Sequence[Equations],
        declared: Windows,
        family: Family,
        loops: Mapping[str, Loops],
        certificate: Certificate,
        splittings: Sequence[Splitting] = (),
    ) -> None:
        super().__init__(windows[-1], {}, certificate)
        self.family, self._windows, self._loops = family, windows, loops
        self._declared, self._splittings = declared, splittings

    @cached_property
    def has_kinks(self) -> bool:
        """As of `Facts`."""
        parts = self._loops["rhs"].parts
        return any("kinks" in hold_sides({"rates": part.program}) for part in parts)

    @cached_property
    def _members(self) -> list[list[str]]:
        """Components of each member of the window, in the order of a member's state."""
        known = {each.name: each for each in self.spec.variables}
        count = len(self.state) // len(self.family.states)
        return [
            [c for name in self._declared.variables for c in known[member_name(name, k)].components]
            for k in range(count)
        ]

    # -- spheres --------------------------------------------------------------------------

    @cached_property
    def spheres(self) -> tuple[Sphere, ...]:
        """Vectors of a member, by its components, if it has nothing else and they are on spheres.

        Their brackets are ``{x_a, x_b} = c epsilon_abd x_d``, c free of the state and not zero for
        any member, and they commute with all others.
        """
        count = len(self.family.states)
        if self.structure is None or count % 3 or not self.is_bracket_alone:
            return ()
        places = [
            [self.state.index(c) for c in member[first : first + 3]]
            for member in self._members
            for first in range(0, count, 3)
        ]
        if not all(map(self._is_sphere, places)):
            return ()
        return tuple(Sphere((first, first + 1, first + 2)) for first in range(0, count, 3))

    def _is_sphere(self, rows: Sequence[int]) -> bool:
        """Whether three rows have the bracket of so(3), or a multiple, and commute with others."""
        assert self.structure is not None, self.spec.name
        tensor, field = self.structure.tensor, self.field
        others = [k for k in range(len(self.state)) if k not in rows]
        if any(tensor[row][k] or tensor[k][row] for row in rows for k in others):
            return False
        a, b, c = (field[self.state[row]] for row in rows)
        i, j, k = rows
        pairs = ((tensor[i][j], c), (tensor[j][k], a), (tensor[k][i], b))
        scale = field.gradient(pairs[0][0], [self.state[k]])[0]
        reached = field.reach(scale) & {*self.state}
        return not reached and bool(scale) and all(field.is_zero(x - scale * y) for x, y in pairs)

    # -- splitting ------------------------------------------------------------------------

    @cached_property
    def positions(self) -> tuple[int, ...]:
        """Which components of a member are positions, where its energy is ``T(p) + V(q)``."""
        if not (self.is_hamiltonian and self.is_canonical and self.is_separable):
            return ()
        where = {*self.motion.positions}
        return tuple(n for n, name in enumerate(self._members[0]) if name in where)

    def is_kept_by_flows(self, name: str) -> bool:
        """Whether the flow of each part of the energy keeps an integral.

        Along ``T(p)`` alone and along ``V(q)`` alone what moves it stays, so that the integral does
        where its rate is 0. Each flow is a motion of the form of the whole one: what holds in the
        windows holds for every number of members.
        """
        facts = [Facts(each, {}, self._certificate) for each in self._windows]
        if not self.flows:
            return all(_is_kept_by_shifts(each, name) for each in facts)
        windows = zip(facts, self.flows, strict=True)
        return all(_is_kept_by_maps(each, name, programs) for each, programs in windows)

    @cached_property
    def flows(self) -> tuple[tuple[Program, ...], ...]:
        """Of each window the flows of the parts of its energy, where these are no shifts."""
        return tuple(map(lower_flows, self._splittings))

    # -- discrete gradients ---------------------------------------------------------------

    @cached_property
    def is_bracket(self) -> bool:
        """As of `Facts`."""
        return self.family.action is not None and self.is_hamiltonian

    def is_kept_by_tensor(self, values: Sequence[Element], still: Sequence[int] = ()) -> bool:
        """As of `Facts`, where functions are Casimirs."""
        return self._is_casimir(values)

    @cached_property
    def lacks_action(self) -> str:
        """Why there are no discrete gradients, as a clause; "" where there are."""
        if self.family.action is not None:
            return ""
        if self.family.matrices is not None or self.energy_degree is not None:
            return _QUADRATIC
        return _BLOCKS

    # -- integrals ------------------------------------------------------------------------

    @cached_property
    def integrals(self) -> tuple[Kept, ...]:
        """What is conserved for every number of members, and the squared radii of spheres."""
        proved = [each.partition(",")[0].partition(" where ")[0] for each in self._proved]
        said = {"energy": "the energy is conserved"}
        own = (*super().integrals,)
        named = [x for x in own if said.get(x.name, f"{x.name} is conserved") in proved]
        return (*named, *map(self._describe_sphere, self.spheres))

    def _describe_sphere(self, sphere: Sphere) -> Kept:
        """The squares of the radii of all members."""
        field = self.field
        values: list[Element] = []
        for member in self._members:
            rows = [field[member[n]] for n in sphere.rows]
            values.append(field.sum(x * x for x in rows))
        return Kept(
            name=self.radii[sphere.rows[0]],
            values=tuple(values),
            degree=2,
            is_casimir=self._is_casimir(values),
            is_kept_within_steps=all(map(self._is_still, values)),
        )

    @cached_property
    def radii(self) -> dict[int, str]:
        """Names of the squared radii of spheres, by the first component: ``dot(S[i], S[i])``."""
        first, names = 0, dict[int, str]()
        known = {each.name: each for each in self.spec.variables}
        i = self._declared.index.name
        for name in self._declared.variables:
            own = known[member_name(name, 0)]
            parts = component_names(name, own.shape, own.form)
            for n in range(0, len(parts), 3):
                rows = parts[n : n + 3]
                whole = f"dot({name}[{i}], {name}[{i}])"
                names[first + n] = (
                    whole if len(parts) == 3 else " + ".join(f"{c}[{i}]^2" for c in rows)
                )
            first += len(parts)
        return names

    def as_record(self) -> dict[str, object]:
        """As of `Facts`; spheres by the components of a member."""
        found = super().as_record()
        if self.positions:
            found["positions"] = list(self.positions)
        return found


def _is_kept_by_maps(facts: Facts, name: str, programs: Sequence[Program]) -> bool:
    """The same of one window, by the flows of its parts."""
    named = [each for each in facts.integrals if each.name == name]
    pairs = ((each, program) for each in named for program in programs)
    return bool(named) and all(keeps(facts, *pair, is_flow=True) for pair in pairs)


def _is_kept_by_shifts(facts: Facts, name: str) -> bool:
    """The same of one window, along ``T(p)`` and ``V(q)``."""
    field, state = facts.field, facts.state
    rates = [facts.equations.close(rate) for rate in facts.equations.exact.rates]
    rest = {*facts.motion.positions}
    for each in facts.integrals:
        if each.name != name:
            continue
        for value in each.values:
            slopes = [a * b for a, b in zip(field.gradient(value, state), rates, strict=True)]
            for is_position in (True, False):
                own = (s for s, x in zip(slopes, state, strict=True) if (x in rest) == is_position)
                if not field.is_zero(field.sum(own)):
                    return False
        return True
    return False


def judge_family(
    windows: Sequence[Equations],
    declared: Windows,
    family: Family,
    loops: Mapping[str, Loops],
    certificate: Certificate,
    *,
    over: str = "equal members",
    in_plane: Sequence[str] | None = None,
    splittings: Sequence[Splitting] = (),
) -> tuple[FamilyFacts, tuple[JudgedMethod, ...]]:
    """The facts of a system of equal members, and every method judged by them.

    Args:
        windows: Equations of small numbers of members.
        declared: What is known of the other members.
        family: Those of the generic member.
        loops: Its functions.
        certificate: What is proved for every number of members.
        over: What its solvers are loops over, in words.
        in_plane: Where the members are points of a plane, the integrals that truncated series keep.
        splittings: The windows in the parts whose flows the family has.
    """
    facts = FamilyFacts(windows, declared, family, loops, certificate, splittings)
    looped = {*LOOPED, *(["isospectral_midpoint"] if family.matrices is not None else [])}
    none = _NONE.format(over)
    refusals = {name: none for name, x in STRUCTURED.items() if x.file not in looped}
    refusals |= {name: none for name in MAPPED if name not in SPLITTINGS}
    if not facts.spheres:
        spheres = (name for name, x in STRUCTURED.items() if x.file == "spherical_midpoint")
        refusals |= dict.fromkeys(spheres, _SPHERES)
    if not (facts.positions or facts.flows):
        refusals |= dict.fromkeys(SPLITTINGS, _SPLIT)
    by_energy = [name for name, x in STRUCTURED.items() if x.file in BY_ENERGY]
    if facts.lacks_action:
        refusals |= dict.fromkeys(by_energy, facts.lacks_action)
    refusals |= refuse_backward(facts, refusals)
    if facts.is_noisy:
        refusals = refuse_noisy(_NOISY) | dict.fromkeys(NOISY.keys() - {*_NOISY}, none)
    elif in_plane is not None:
        refusals = dict.fromkeys((*STRUCTURED, *MAPPED), _PLANE)
    elif facts.has_kinks:
        refusals = dict.fromkeys((*STRUCTURED, *MAPPED), KINKED)
    if facts.is_driven and not facts.is_noisy:
        refusals |= dict.fromkeys(SPLITTINGS, "inputs or the time drive its energy")
    rules = {"spherical_midpoint": _judge_spheres, "sequence": _judge_splitting}
    # a sweep of the midpoint is one loop, and one of a discrete gradient has eight
    preferred = [n for n in prefer(facts) if facts.has_balance or n not in by_energy]
    judged = judge(facts, refusals, {}, rules, preferred)
    if in_plane is not None:
        judged = tuple(_judge_plane(each, in_plane) for each in judged)
    return facts, judged


def _judge_plane(judged: JudgedMethod, kept: Sequence[str]) -> JudgedMethod:
    """Gauss's methods of a plane keep what truncated series do, all of which is quadratic."""
    method = STRUCTURED.get(judged.name)
    if method is None or (method.name != "midpoint" and method.file != "gauss"):
        return judged
    searched = "one midpoint" if method.stages == 1 else f"{method.stages} stages"
    return JudgedMethod(
        name=judged.name,
        order=method.order,
        exactly=tuple(kept),
        decides=f"{', '.join(kept)} are quadratic, and kept by truncated series",
        cost=f"{SWEEPS} of {searched}",
        rank=int(method.stages == 1),
    )


def _judge_spheres(
    facts: Facts, method: StructuredMethod, maps: Mapping[str, Program]
) -> Judgement:
    """As of other systems; a member has so many spheres."""
    found = judge_spheres(facts, method, maps)
    return replace(found, decides=f"{found.decides} for each member")


def _judge_splitting(facts: Facts, method: StructuredMethod, _: Mapping[str, Program]) -> Judgement:
    """Products of flows: shifts of positions or of momenta, or those of parts of the energy."""
    assert isinstance(facts, FamilyFacts), method.name
    if facts.flows:
        parts = [program.name for program in facts.flows[0]]
        exactly = tuple(
            x for x in facts.integrals if x.is_casimir or facts.is_kept_by_flows(x.name)
        )
        decides = (
            f"the energy is the sum of {count(len(parts), 'part')} whose flows are in closed form"
        )
        return Judgement(
            exactly=exactly,
            is_poisson=True,
            decides=f"{decides}, for every number of members",
            cost=count(len(list_schedules(parts)[method.name]), "explicit map"),
        )
    exactly = tuple(each for each in facts.integrals if facts.is_kept_by_flows(each.name))
    shifts = len(list_schedules(FLOWS)[method.name])
    return Judgement(
        exactly=exactly,
        is_poisson=True,
        decides="the energy is T of momenta plus V of positions, for every number of members",
        cost=f"{shifts} shifts, each with the rates",
    )
