"""Methods of integration, judged: which apply to a system, and what each keeps by its theorem.

Comes in: Equations, their certificate, the functions of a kernel and the maps of explicit methods.
Goes out: a `JudgedMethod` for each method of the list, in the order of the list, the default one
first in rank. A method of a new file keeps nothing here until it has a rule.
Read next: `coadjoint.prove.facts`, where the facts are decided.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final

from coadjoint.derive import Equations
from coadjoint.derive.times_vector import find_product
from coadjoint.exact.residues import Residue, call_modulo, vanish
from coadjoint.lower.compositions import SPLITTINGS, list_schedules
from coadjoint.lower.evaluation import run
from coadjoint.lower.kinks import hold_sides
from coadjoint.lower.mapped import Maps
from coadjoint.lower.program import Program
from coadjoint.methods import (
    BACKWARD,
    BALANCED,
    BY_ENERGY,
    FALLING,
    GROWING,
    MAPPED,
    NOISY,
    STEPS,
    STRUCTURED,
    JudgedMethod,
    StructuredMethod,
    list_backward,
)
from coadjoint.prove.certificate import Certificate
from coadjoint.prove.facts import Facts, Kept
from coadjoint.prove.turned import with_rotations
from coadjoint.render.solvers import describe_structured, select_programs

#: Evaluations of the rates that an implicit equation takes for each stage, about.
SWEEPS: Final = "about a dozen sweeps"
#: The degree up to which the mean of a gradient is exact: Gauss's formula has five nodes.
MEAN_DEGREE: Final = 10
#: Why a motion whose rates have corners or jumps has none of them.
KINKED: Final = "its rates have kinks, at which explicit methods end their steps"
#: Why a metriplectic motion has no discrete gradient of the energy alone.
METRIPLECTIC: Final = (
    "of a metriplectic motion G dh = 0 holds for the derivative of the energy, and not for a "
    "discrete gradient; metriplectic_gradient projects G along that"
)
#: What methods for other motions lack.
WITH_NOISE: Final = "motions with noise have methods of their own: "


@dataclass(frozen=True)
class Judgement:
    """What a theorem says of a method for one system.

    Attributes:
        exactly: What is kept to rounding.
        is_poisson: Whether a step is a Poisson map.
        decides: The fact that the theorem asks for.
        cost: Of a step, in words.
        laws: What else holds in each step.
    """

    exactly: tuple[Kept, ...]
    is_poisson: bool
    decides: str
    cost: str
    laws: tuple[str, ...] = ()


#: What a rule takes: the facts, the method, and the maps of the system by name.
Rule = Callable[[Facts, StructuredMethod, Mapping[str, Program]], Judgement]


def judge_methods(
    equations: Equations, certificate: Certificate, programs: Mapping[str, Program], maps: Maps
) -> tuple[Facts, tuple[JudgedMethod, ...]]:
    """The facts of a system that methods ask for, and every method judged by them.

    Args:
        equations: The emitted route.
        certificate: What is proved of it.
        programs: The functions of its kernel.
        maps: What explicit methods make a step of.
    """
    facts = Facts(equations, programs, certificate)
    solved = hold_sides(select_programs(programs.values(), maps=maps.programs))
    own = describe_structured(solved)["structured"]
    if facts.is_noisy:
        return facts, judge(facts, refuse_noisy({each.name for each in own["noisy"]}), {})
    offered = {each.name for each in own["methods"]}
    refusals = dict(maps.refusals)
    refusals |= {name: _refuse(facts, x) for name, x in STRUCTURED.items() if name not in offered}
    refusals |= refuse_backward(facts, refusals)
    known = {program.name: program for program in maps.programs}
    return facts, judge(facts, refusals, known)


def judge(
    facts: Facts,
    refusals: Mapping[str, str],
    maps: Mapping[str, Program],
    rules: Mapping[str, Rule] = MappingProxyType({}),
    preferred: Sequence[str] | None = None,
) -> tuple[JudgedMethod, ...]:
    """Every method of the list, judged.

    Args:
        facts: Of the system.
        refusals: Why methods do not apply, by name, as far as they do not.
        maps: What explicit methods make a step of, by name.
        rules: By files of methods, in the place of those of a system without an index.
        preferred: Names of methods in the order in which ``"auto"`` takes them, in the place of
            that of `prefer`.
    """
    every = {**_RULES, **rules}
    known = {**STRUCTURED, **MAPPED, **(NOISY if facts.is_noisy else {})}
    judged = {
        name: JudgedMethod(name=name, order=method.order, decides=refusals[name])
        if name in refusals
        else _judge(every, facts, method, maps)
        for name, method in known.items()
    }
    # of a symmetric bracket a person chooses which law is exact
    last = ["discrete_gradient"] if facts.spec.relaxation is None else []
    return _rank(prefer(facts) if preferred is None else preferred, judged, last=last)


def refuse_backward(facts: Facts, refusals: Mapping[str, str]) -> dict[str, str]:
    """The same of methods that are not refused yet and go back in time, where energy is lost."""
    backward = list_backward() - refusals.keys() if facts.is_dissipative else ()
    return dict.fromkeys(backward, BACKWARD)


def refuse_noisy(offered: Collection[str]) -> dict[str, str]:
    """Why methods do not apply to a motion with noise, by name, where it has some of those for it.

    Args:
        offered: Names of those that it has.
    """
    reason = WITH_NOISE + ", ".join(name for name in NOISY if name in offered)
    lacking = {name: f"it expects {x.expects}" for name, x in NOISY.items() if name not in offered}
    others = (name for name in (*STRUCTURED, *MAPPED) if name not in NOISY)
    return dict.fromkeys(others, reason) | lacking


def _refuse(facts: Facts, method: StructuredMethod) -> str:
    """Why a method does not apply, as a clause; of one that does, whether it goes back in time."""
    if facts.has_kinks:
        return KINKED
    if method.file in BY_ENERGY or (method.file == "metriplectic_gradient" and facts.has_entropy):
        found = find_product(facts.equations)
        if isinstance(found, str):
            return found
    if method.file in BY_ENERGY and facts.has_entropy:
        return METRIPLECTIC
    return f"it expects {method.expects}"


def _judge(
    rules: Mapping[str, Rule],
    facts: Facts,
    method: StructuredMethod,
    maps: Mapping[str, Program],
) -> JudgedMethod:
    """A method that applies."""
    found = rules.get(method.file, _judge_unknown)(facts, method, maps)
    names = [each.name for each in found.exactly]
    return JudgedMethod(
        name=method.name,
        order=facts.strong_order if facts.is_noisy else method.order,
        exactly=tuple(names),
        nearly=tuple(each.name for each in facts.integrals if each.name not in names),
        is_poisson=found.is_poisson,
        laws=found.laws,
        decides=found.decides + _tell_held([x for x in facts.integrals if x.name in facts.held]),
        cost=found.cost,
    )


def _tell_held(integrals: Sequence[Kept]) -> str:
    """Which integrals inputs that vary take, as the end of a clause."""
    if not integrals:
        return ""
    stay = "stays" if len(integrals) == 1 else "stay"
    return f"; {_list(integrals)} {stay} only while the inputs are constant"


# -- one rule for each theorem --------------------------------------------------------------------


def _judge_unknown(facts: Facts, method: StructuredMethod, _: Mapping[str, Program]) -> Judgement:
    """Of a method without a rule nothing is said."""
    return Judgement(exactly=(), is_poisson=False, decides="nothing is proved of it", cost=SWEEPS)


def _judge_runge_kutta(
    facts: Facts, method: StructuredMethod, _: Mapping[str, Program]
) -> Judgement:
    """Methods of Gauss keep quadratic integrals, and are symplectic where the tensor is constant.

    Of a step ``X = x + h sum b_i f(Y_i)`` a quadratic integral F changes by
    ``h sum b_i dF(Y_i) . f(Y_i)``, which is zero where dF . f is, at all stages. With noise f is
    the drift plus ``sum_k g_k dW_k/h``, and F has to be kept by each of these.
    """
    exactly = tuple(each for each in facts.integrals if each.is_kept_within_steps)
    is_symplectic = facts.is_bracket_alone and facts.tensor == "constant"
    said = [f"{_list(exactly)} {_be(exactly)} of degree 2 at the most"] if exactly else []
    said += ["drift and noise keep each, by Stratonovich's calculus"] * bool(
        exactly and facts.is_noisy
    )
    if facts.is_moved and not exactly:
        said.append("after each step the state is moved, so that quadratic integrals are not kept")
    elif not exactly:
        said.append("no integral is seen to be of degree 2 or less")
    said += ["the Poisson tensor is constant"] * is_symplectic
    if facts.grows and any(each.name == "energy" for each in exactly):
        said.append("the entropy, of degree 2, grows by dS.G dS at the stages")
    laws = (GROWING,) * (facts.grows and not facts.is_moved)
    is_gauss = method.file == "gauss"
    stages = method.order // 2 if is_gauss else STEPS[method.order]
    each = "stage" if is_gauss else "midpoint"
    cost = f"{SWEEPS} of {count(stages, each)}"
    return Judgement(
        exactly=exactly, is_poisson=is_symplectic, decides="; ".join(said), cost=cost, laws=laws
    )


def _on_orbits(facts: Facts) -> tuple[Kept, ...]:
    """What a step ``X = x + h {x, h}(m)`` that is a coadjoint action keeps, m any point.

    Casimirs are those of the orbit. A linear integral changes by h times its rate at m, which is 0.
    """
    return tuple(
        each
        for each in facts.integrals
        if each.is_casimir or (each.is_kept_within_steps and each.degree in (0, 1))
    )


_ACTION: Final = "the motion is the bracket with its energy, and the bracket is linear"
#: What the isospectral midpoint asks for beyond that.
_PRODUCTS: Final = "that of matrices with all products B A B, up to multiples of 1 or i"
_NOISY_ACTION: Final = (
    "drift and noise are brackets with their Hamiltonians, and the bracket is linear: on each path "
    "a step is the action of one element"
)


def _judge_orbits(facts: Facts, method: StructuredMethod, _: Mapping[str, Program]) -> Judgement:
    """Coadjoint actions are Poisson maps where they come from a discrete principle."""
    stages = STEPS[method.order]
    cost = f"{SWEEPS} of {count(stages, 'coadjoint arc')}, each a dozen brackets"
    if method.file == "isospectral_midpoint":
        cost = f"{SWEEPS} of {count(stages, 'midpoint')}, each with two products of matrices"
        return Judgement(
            exactly=_on_orbits(facts), is_poisson=True, decides=f"{_ACTION}, {_PRODUCTS}", cost=cost
        )
    kept = _on_orbits(facts)
    if facts.is_noisy:
        return Judgement(exactly=kept, is_poisson=True, decides=_NOISY_ACTION, cost=cost)
    # the whole state moves by exp(h xi), attitudes with it: what all such elements leave as it is
    moved = [each for each in facts.integrals if each not in kept]
    turned = [each for each in moved if facts.is_kept_by_action(each.values)]
    if not turned:
        return Judgement(exactly=kept, is_poisson=True, decides=_ACTION, cost=cost)
    exactly = tuple(each for each in facts.integrals if each in kept or each in turned)
    decides = f"{_ACTION}; the element of a step moves all of the state, so that {_list(turned)}"
    return Judgement(
        exactly=exactly,
        is_poisson=True,
        decides=f"{decides} {'stays' if len(turned) == 1 else 'stay'}",
        cost=cost,
    )


def judge_spheres(facts: Facts, method: StructuredMethod, _: Mapping[str, Program]) -> Judgement:
    """The spherical midpoint, which on one sphere is the midpoint with another length of step.

    There ``X(s m) = s^2 X(m)`` of a field that is homogeneous and quadratic, so that all quadratic
    integrals are kept. With noise the energy of a step is not homogeneous.
    """
    exactly, decides = (
        _on_orbits(facts),
        f"its orbits are those of {count(len(facts.spheres), 'sphere')}",
    )
    (one, *others) = facts.spheres
    alone = not others and not one.tangent and len(facts.state) == len(one.rows)
    if alone and facts.is_energy_homogeneous and not facts.is_noisy:
        exactly = tuple(
            each
            for each in facts.integrals
            if each in exactly or (each.is_kept_within_steps and each.degree == 2)
        )
        decides += ", on which the energy is quadratic"
    cost = f"{SWEEPS} of {count(STEPS[method.order], 'midpoint')}"
    if facts.is_noisy:
        decides += ", on which drift and noise, brackets with their Hamiltonians, keep each path"
    return Judgement(exactly=exactly, is_poisson=True, decides=decides, cost=cost)


def _judge_heun(facts: Facts, _: StructuredMethod, __: Mapping[str, Program]) -> Judgement:
    """A step adds means of rates: it keeps linear functions that drift and noise keep."""
    exactly = tuple(
        each for each in facts.integrals if each.is_kept_within_steps and each.degree in (0, 1)
    )
    said = f"{_list(exactly)} {_be(exactly)} linear" if exactly else "no integral is linear"
    return Judgement(
        exactly=exactly, is_poisson=False, decides=said, cost="two evaluations of rates and noise"
    )


def _judge_maps(facts: Facts, method: StructuredMethod, maps: Mapping[str, Program]) -> Judgement:
    """Sequences of maps: flows keep all Casimirs; other integrals are asked of each map."""
    schedule = list_schedules(maps)[method.name]
    if method.name == "exact_body":
        return Judgement(
            exactly=facts.integrals,
            is_poisson=facts.is_hamiltonian,
            decides="the motion is that of Euler's top",
            cost="one map",
        )
    is_flow = method.name in SPLITTINGS
    used = [maps[name] for name in dict.fromkeys(name for name, _ in schedule)]
    exactly = tuple(
        each
        for each in facts.integrals
        if (is_flow and each.is_casimir)
        or all(keeps(facts, each, program, is_flow=is_flow) for program in used)
    )
    if not is_flow:
        return Judgement(
            exactly=exactly,
            is_poisson=False,
            decides="the rates are quadratic",
            cost="one linear equation",
        )
    parts = len(used)
    decides = f"the energy is the sum of {count(parts, 'part')} whose flows are in closed form"
    return Judgement(
        exactly=exactly, is_poisson=True, decides=decides, cost=count(len(schedule), "explicit map")
    )


def _judge_gradients(facts: Facts, method: StructuredMethod, _: Mapping[str, Program]) -> Judgement:
    """Discrete gradients keep the energy, and Casimirs C of degree 2 at the most.

    The mean of a gradient is one by Gauss's formula, of polynomials. C changes by its gradient at
    the middle of a step times the tensor there, which is zero.
    """
    steps = count(STEPS[method.order], "middle")
    is_mean = method.file == "average_gradient"
    cost = f"{SWEEPS} of {steps}, each with {'five gradients' if is_mean else 'two energies'}"
    is_moved = facts.is_moved and not facts.is_turned_by_tensor
    seen = [each for each in facts.integrals if not is_moved]
    has_mean = (
        facts.energy is not None and facts.find_degree([facts.energy], MEAN_DEGREE) is not None
    )
    is_exact = has_mean or not is_mean
    exactly = tuple(
        each
        for each in seen
        if (each.name == "energy" and is_exact and facts.is_bracket)
        or (
            each.degree is not None
            and each.is_kept_within_steps
            and facts.is_kept_by_tensor(each.values)
        )
    )
    if not (facts.is_bracket or is_moved):
        number = STEPS[method.order]
        decides = _tell_balance(
            facts, "a step" if number == 1 else f"each of its {number} steps", is_exact=is_exact
        )
        has_law = is_exact and facts.is_energy_steady and number == 1
        law = FALLING if facts.relaxes else BALANCED
        return Judgement(
            exactly=exactly, is_poisson=False, decides=decides, cost=cost, laws=(law,) * has_law
        )
    decides = "the motion is an antisymmetric tensor times the gradient of its energy"
    if is_mean and not has_mean:
        decides += f", which is not seen to be a polynomial of degree {MEAN_DEGREE} or less"
    if not facts.is_bracket:
        decides = "forces, friction or a symmetric bracket change the energy"
    if is_moved:
        decides += (
            "; after each step the state is moved, so that neither integrals nor laws are kept"
        )
    return Judgement(exactly=exactly, is_poisson=False, decides=decides, cost=cost)


def _tell_balance(facts: Facts, step: str, *, is_exact: bool) -> str:
    """How the energy changes in a step with the discrete gradient g, by what acts on the motion."""
    if not is_exact:
        return f"the energy is not seen to be a polynomial of degree {MEAN_DEGREE} or less"
    if not facts.is_energy_steady:
        return "inputs or the time change the energy at a state that stays"
    if facts.relaxes:
        law = (
            "the motion is P + P G P times the gradient of its energy: a step takes "
            "h (P g).G (P g) of the energy, g its discrete gradient, and never adds to it"
        )
        if not facts.open_casimirs:
            return f"{law}; all Casimirs, of degree 2 at the most, stay"
        return (
            f"{law}; {facts.open_casimirs}, and what is of higher degree does not stay: "
            "it is taken by name alone"
        )
    return f"{step} adds h g.f to the energy, f what acts at its middle, g the discrete gradient"


def _judge_nambu(facts: Facts, method: StructuredMethod, _: Mapping[str, Program]) -> Judgement:
    """The product of discrete gradients of all distinguished functions keeps each of them."""
    exactly = tuple(each for each in facts.integrals if each.name == "energy" or each.is_casimir)
    decides = "the motion is the product of the gradients of its energy and Casimirs"
    return Judgement(exactly=exactly, is_poisson=False, decides=decides, cost=SWEEPS)


def _judge_metriplectic(facts: Facts, _: StructuredMethod, __: Mapping[str, Program]) -> Judgement:
    """Projected along discrete gradients, P moves no entropy, and G no energy.

    Of G that is not proved positive semidefinite nothing is said of the entropy.
    """
    seen = [] if facts.is_moved else facts.integrals
    exactly = tuple(each for each in seen if each.name == "energy")
    decides = "the motion is P dh + G dS with P dS = 0 and G dh = 0"
    if facts.is_moved:
        decides += "; after each step the state is moved, so that neither law is exact"
    elif facts.is_semidefinite:
        decides += (
            ": a step adds h (Q s).G (Q s) to the entropy, which never falls, s its discrete "
            "gradient, and Q the projection along that of the energy"
        )
    else:
        decides += "; G is not proved positive semidefinite, and the entropy may fall"
    laws = (GROWING,) * (facts.is_semidefinite and not facts.is_moved)
    return Judgement(
        exactly=exactly,
        is_poisson=False,
        decides=decides,
        cost=f"{SWEEPS}, each with ten gradients",
        laws=laws,
    )


_RULES: Final[Mapping[str, Rule]] = {
    "midpoint": _judge_runge_kutta,
    "gauss": _judge_runge_kutta,
    "heun": _judge_heun,
    "coadjoint_mean": _judge_orbits,
    "isospectral_midpoint": _judge_orbits,
    "spherical_midpoint": judge_spheres,
    "sequence": _judge_maps,
    "discrete_gradient": _judge_gradients,
    "average_gradient": _judge_gradients,
    "nambu_gradient": _judge_nambu,
    "metriplectic_gradient": _judge_metriplectic,
}


def keeps(facts: Facts, each: Kept, program: Program, *, is_flow: bool) -> bool:
    """Whether a map leaves a function as it is, at points modulo primes.

    Flows turn attitudes, so that these are rotations there.
    """
    field = facts.field
    reached = frozenset[str]().union(*map(field.reach, each.values))
    if reached - {*facts.state, *facts.equations.setting.parameters}:
        return False

    def find(at: dict[str, Residue], number: Callable[..., Residue]) -> Iterator[Residue]:
        at = with_rotations(facts.spec.turning, at, number) if is_flow else at
        rises = zip(facts.state, run(program, at, number, call_modulo), strict=True)
        there = at | {name: at[name] + rise for name, rise in rises}
        for value in each.values:
            start, end = (field.evaluate(value, dict(x), number, call_modulo) for x in (at, there))
            yield start + -end

    return vanish(find, (*program.names, *facts.state, *facts.equations.setting.parameters))


# -- the order of preference ----------------------------------------------------------------------


def _rank(
    preferred: Sequence[str], judged: Mapping[str, JudgedMethod], *, last: Sequence[str] = ()
) -> tuple[JudgedMethod, ...]:
    """The methods with their ranks: those that apply and keep something, as they are preferred.

    Those named last are taken where none of these does.
    """

    def fitting(names: Sequence[str]) -> list[str]:
        wanted = [judged[name] for name in names if name in judged and judged[name].applies]
        return [x.name for x in wanted if x.exactly or x.is_poisson or x.laws]

    fit = fitting(preferred) or fitting(last)
    return tuple(
        replace(each, rank=fit.index(name) + 1) if name in fit else each
        for name, each in judged.items()
    )


def prefer(facts: Facts) -> tuple[str, ...]:
    """Names of methods in the order in which ``"auto"`` takes them with a fixed step.

    Names that a system does not have are passed over.
    """
    return tuple(dict.fromkeys((*_prefer_first(facts), "gauss4", "midpoint")))


def _prefer_first(facts: Facts) -> Sequence[str]:
    """What is preferred to the methods of Gauss."""
    if facts.is_noisy:  # a map that keeps the bracket keeps all Casimirs, those nobody named too
        return ["spherical_midpoint", "coadjoint_mean"]
    if facts.has_balance:
        return ["discrete_gradient"]
    if facts.is_constrained:
        is_quadratic = any(x.name == "energy" and x.is_kept_within_steps for x in facts.integrals)
        return [] if is_quadratic else ["discrete_gradient"]
    if facts.is_nambu:
        pair = [each.degree for each in facts.integrals if each.name == "energy" or each.is_casimir]
        is_quadratic = all(degree is not None for degree in pair)
        return ["midpoint"] if is_quadratic else ["nambu_gradient", "discrete_gradient"]
    if facts.has_entropy:
        is_quadratic = any(x.name == "energy" and x.is_kept_within_steps for x in facts.integrals)
        return [] if is_quadratic and facts.grows else ["metriplectic_gradient"]
    if facts.tensor == "linear" and facts.is_hamiltonian:
        if facts.spheres and not any(each.tangent for each in facts.spheres):
            return ["spherical_midpoint", "coadjoint_mean"]
        general = ["spherical_midpoint", "isospectral_midpoint4", "coadjoint_mean"]
        return ["splitting4", *general] if facts.is_separable else general
    if facts.is_canonical:
        return ["splitting4"] if facts.is_separable else []
    if facts.relaxes and not facts.open_casimirs:
        return ["discrete_gradient"]
    return ["splitting4", "discrete_gradient"] if facts.is_hamiltonian else []


def _list(integrals: Sequence[Kept]) -> str:
    """Names: ``energy, casimir1 and casimir2``."""
    *others, last = [each.name for each in integrals]
    return f"{', '.join(others)} and {last}" if others else last


def _be(integrals: Sequence[Kept]) -> str:
    return "is" if len(integrals) == 1 else "are"


def count(number: int, what: str) -> str:
    """A number of things: ``one midpoint``, ``5 midpoints``."""
    return f"one {what}" if number == 1 else f"{number} {what}s"
