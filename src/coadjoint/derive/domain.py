"""Domain: where a system is defined and regular, as values that are positive there.

Comes in: Equations. Goes out: a bound for each declared condition, the side that is to be larger
minus the other, then those of a contact of surfaces, then, for constrained motions, one for each
pivot of the solves in the kernel, with the sign that it has for a positive kinetic energy: plus for
accelerations, minus for multipliers, since ``[[M, A^T], [A, 0]]`` has the pivots of M and of ``-A
M^-1 A^T``. Where velocities are no linear functions of momenta, the Legendre transform has a
solution where the arguments of its roots are positive; where an iteration finds velocities, it
needs positive pivots of the Hessian. It is one place for every route, since
conditions are the spec's, and pivots and roots those of the emitted motion.
Claims are looked at in the same domain, which is a `Region` of the field.
Read next: `coadjoint.lower.lowering`, and `coadjoint.solve.domain` for what becomes of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from coadjoint.declared import Bound
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.contact import touch_of
from coadjoint.derive.mechanics.kinematics import kinematics, multiplier_name
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.mechanics.solver import pivot_name
from coadjoint.exact import Condition, Element, Region
from coadjoint.exact.signs import sign


def bounds(equations: Equations) -> tuple[tuple[Bound, Element], ...]:
    """All bounds of a system with what is positive there.

    None where nothing is declared and nothing is constrained.
    """
    setting, conditions = equations.setting, list[tuple[Bound, Element]]()
    for condition in equations.spec.domain:
        value = setting.excess(condition, setting.reactions)
        strict = not condition.sign.endswith("=")
        inputs = _inputs(equations, value)
        conditions.append((Bound(condition.name, "condition", strict, inputs), value))
    return (*conditions, *_contact(equations), *_transforms(equations), *_pivots(equations))


def region(equations: Equations, momenta: Mapping[str, Element] = MappingProxyType({})) -> Region:
    """Where claims about a system are looked at: where its bounds hold and its motion has values.

    Args:
        equations: By the emitted route.
        momenta: The momenta in terms of velocities, for what is written in these.
    """
    known = equations.setting.field.region
    conditions = [Condition(value, bound.strict) for bound, value in bounds(equations)]
    conditions += [each for each in _arguments(equations) if each not in conditions]
    return replace(
        known,
        bounds=tuple(each for each in conditions if each not in known.conditions),
        definitions=_definitions(equations),
        momenta=_definitions(equations) if equations.iterations else momenta,
        loops=equations.loops,
    )


def _definitions(equations: Equations) -> dict[str, Element]:
    """The definitions; of velocities that iterations find, the other way round.

    These are free, and momenta follow from them.
    """
    setting, given = equations.setting, dict[str, Element]()
    for newton in equations.iterations:
        names = [setting.conjugates[place][0] for place in newton.block]
        found = dict(zip(newton.names, setting.elements(names), strict=True))
        given |= found
        for place, slope in zip(newton.block, newton.slopes, strict=True):
            at = setting.field.substitute(slope, found)
            _, mu, weight = setting.conjugates[place]
            given[mu] = at * weight
    places = (place for newton in equations.iterations for place in newton.block)
    free = {setting.conjugates[place][0] for place in places}
    return given | {n: value for n, value in equations.exact.definitions if n not in free}


def _arguments(equations: Equations) -> list[Condition]:
    """What the functions in the energy and the rates ask to be positive, as ``u`` of ``sqrt(u)``.

    A root has no slope where its argument is zero.
    """
    field, exact = equations.setting.field, equations.exact
    written = [value for _, value in exact.definitions] + list(exact.rates)
    written += [exact.energy] if exact.energy is not None else []
    called = {name for each in written for name in field.functions_in(each)}
    return [
        Condition(positive, strict=True)
        for known in field.adjoined.values()
        if known.generator in called
        and (positive := field.domain_of(known)) is not None
        and field.as_number(positive) is None
    ]


def _contact(equations: Equations) -> list[tuple[Bound, Element]]:
    """What is positive while a body touches a surface at one point."""
    touch = touch_of(equations.setting)
    if touch is None:
        return []
    known = kinematics(equations.setting).decided
    found = [(name, known.value(value)) for name, value in touch.bounds]
    return [(Bound(name, "contact", True, _inputs(equations, v)), v) for name, v in found]


def _transforms(equations: Equations) -> list[tuple[Bound, Element]]:
    """Bounds of momenta that have velocities, where that is not certain.

    One for each root and logarithm by which these follow, and others of the range of ``dl/dxi``.
    """
    setting = equations.setting
    velocities = {xi for xi, _, _ in setting.conjugates}
    field, pairs, seen = setting.field, list[tuple[Bound, Element]](), set[str]()
    if setting.spec.lagrangian is None or not setting.momenta or setting.spec.is_first_order:
        return []
    bending = {} if setting.spec.variational else mechanics(setting).bending
    for solve in equations.exact.solves if bending else ():
        for place, name in zip(solve.block, solve.names, strict=True):
            if solve.newton is not None:
                pivot = field[pivot_name(place)]
                pairs.append((Bound(name, "iteration", True, _inputs(equations, pivot)), pivot))
    for name, value in equations.exact.definitions:
        if name not in velocities or name not in bending or name in equations.kept:
            continue
        alone = legendre(setting).alone
        for positive in alone[name].range if name in alone else ():
            bound = Bound(name, "range", True, _inputs(equations, positive))
            pairs.append((bound, positive))
        for generator in sorted(field.functions_in(value) - seen):
            seen.add(generator)
            called = field.adjoined[generator]
            asked = field.domain_of(called)
            if asked is not None and sign(field, asked) != 1:
                kind = "transform" if called.function == "sqrt" else "range"
                pairs.append((Bound(name, kind, True, _inputs(equations, asked)), asked))
    return pairs


def _pivots(equations: Equations) -> list[tuple[Bound, Element]]:
    """A bound for each pivot of the solves of a constrained motion.

    A free motion may have a kinetic energy of either sign, which is regular all the same.
    """
    if equations.distribution is None or not equations.spec.in_frame:
        return []
    kept = enumerate(equations.distribution.kept)
    reactions = {multiplier_name(n): equation.reaction for n, (equation, _) in kept}
    pairs = list[tuple[Bound, Element]]()
    for solve in equations.exact.solves:
        for place, name in zip(solve.block, solve.names, strict=True):
            pivot = equations.setting.field[pivot_name(place)]
            kind = "reaction" if name in reactions else "acceleration"
            value = -pivot if name in reactions else pivot
            inputs = _inputs(equations, pivot)
            pairs.append((Bound(reactions.get(name, name), kind, True, inputs), value))
    return pairs


def _inputs(equations: Equations, element: Element) -> tuple[str, ...]:
    """Components that a value depends on, through the definitions too: see `Bound.inputs`."""
    field, setting = equations.setting.field, equations.setting
    names = (*setting.state, *setting.parameters, *setting.driving)
    reached = set(field.reach(element))
    for name, value in reversed(equations.exact.definitions):
        if name in reached:
            reached |= field.reach(value)
    for newton in equations.iterations:
        if reached.intersection(newton.names):
            reached = reached.union(*map(field.reach, newton.elements))
    return tuple(name for name in names if name in reached)
