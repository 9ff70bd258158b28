r"""External forces and dissipation, which neither a Lagrangian nor a Hamiltonian contains.

Principle of Lagrange and d'Alembert (Holm 2011, section 12.2): a force f does work along every
virtual displacement, so it is added to the rate of the momentum along its velocity; with Rayleigh's
function R,

.. math::
    \frac{d}{dt} \frac{\partial l}{\partial \xi} = \dots + f - \frac{\partial R}{\partial \xi}.

Where velocities of coordinates are the state it gives the acceleration :math:`M^{-1} f`. A force
along a momentum, or along a coordinate of a declared bracket, is added to its rate as it stands.
A symmetric bracket G dissipates as well. With the Poisson bracket P the motion (Bloch,
Krishnaprasad, Marsden and Ratiu 1996; Morrison 1986) is
:math:`\dot x = P\,\partial h + P G P\,\partial h`, or with an entropy S
:math:`\dot x = P\,\partial h + G\,\partial S`.
Comes in: Equations of a motion by its energy alone. Goes out: Equations with the forces.
Read next: `coadjoint.derive.mechanics.frames`, for motions on which constraints act as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from coadjoint.derive.equations import Equations
from coadjoint.derive.interpret import entries
from coadjoint.derive.mechanics.configuration import Matrix, kept_entries, mechanics
from coadjoint.derive.mechanics.driving import explicit
from coadjoint.derive.mechanics.parts import in_parts, slopes
from coadjoint.derive.records import rate, write_step
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element
from coadjoint.exact.dense import apply
from coadjoint.spec import Spec
from coadjoint.spec.model import Variable
from coadjoint.spec.sections.poisson import pairing_weights

#: What may be added, as LaTeX.
LATEX = {
    "f - dR/dxi": r"f - \partial R / \partial \xi",
    "P G P dh": r"P G P\,dh",
    "G dS": r"G\,dS",
}


def symbols(spec: Spec) -> tuple[str, ...]:
    """Names of the components of ``P dh``, from which a double bracket is computed."""
    relaxation = spec.relaxation
    if relaxation is None or relaxation.S is not None:
        return ()
    return tuple(f"_v{n + 1}" for n in range(sum(len(each.components) for each in spec.state)))


def external_forces(setting: Setting, velocities: Sequence[str]) -> tuple[Element, ...]:
    """The declared force ``f - dR/dxi`` along each velocity."""
    field, spec = setting.field, setting.spec
    forces = dict.fromkeys(velocities, field.zero) | _declared_forces(setting, "velocity")
    if spec.dissipation is not None:
        lost = slopes(setting, spec.dissipation, velocities)
        forces = {name: forces[name] - s for name, s in zip(velocities, lost, strict=True)}
    return tuple(forces[name] for name in velocities)


def _declared_forces(setting: Setting, *roles: str) -> dict[str, Element]:
    """The declared forces along variables of some roles, by component."""
    spec = setting.spec
    return {
        name: part
        for variable in spec.variables
        if variable.name in spec.forces and variable.role in roles
        for name, part in zip(
            variable.components,
            force_components(setting, variable, in_parts(setting, spec.forces[variable.name])),
            strict=True,
        )
    }


def force_components(
    setting: Setting, variable: Variable, parts: tuple[Element, ...]
) -> tuple[Element, ...]:
    """What acts along each component of a variable, from the entries of its declared force.

    A force that is a matrix is added to the rate of the momentum, which is paired with the velocity
    as ``{q, p}`` says: by ``tr(P dS/dt)`` where they are symmetric.
    """
    formula = setting.spec.forces[variable.name]
    if formula.shape != variable.value_shape or not variable.form:
        return parts
    kept = kept_entries(setting, parts, variable.form, formula)
    if variable.role != "velocity" or not variable.of:
        return kept
    weights = pairing_weights(len(kept), variable.form)
    return tuple(part / weight for part, weight in zip(kept, weights, strict=True))


def add_forces(free: Equations) -> Equations:
    """Equations of motion with the declared forces and dissipation; unchanged without any.

    Routes with constraints, those with momenta of their own, and those on which velocities follow
    put the forces in themselves.
    """
    setting = free.setting
    own = setting.spec.is_first_order or free.distribution is not None or free.chart is not None
    if not setting.spec.is_driven or own:
        return free
    free, forces = _name_rates(free), added_rates(setting)
    names = {*symbols(setting.spec)}
    shown = [line for line in free.exact.definitions if line[0] in names]
    added = tuple(f + x for f, x in zip(forces, relaxed_rates(free), strict=True))
    rates = tuple(x + f for x, f in zip(free.exact.rates, added, strict=True))
    lines = zip(setting.state, added, rates, strict=True)
    moved = [(name, force, whole) for name, force, whole in lines if force != 0]
    relaxation = setting.spec.relaxation
    text = ["f - dR/dxi"] * setting.spec.is_forced + ([relaxation.added] if relaxation else [])
    step = write_step(
        "Forces and dissipation, added to the rates",
        f"dx/dt = ... + {' + '.join(text)}",
        rf"\dot x = \dots + {' + '.join(LATEX[each] for each in text)}",
        (
            *shown,
            *((f"f_{name}", force) for name, force, _ in moved),
            *((rate(name), whole) for name, _, whole in moved),
        ),
        by=relaxation.table.replace("_", "-") if relaxation else "forces",
    )
    exact = replace(free.exact, rates=rates, forces=added)
    return replace(free, exact=exact, steps=(*free.steps, step))


def _name_rates(free: Equations) -> Equations:
    """The motion with names for the brackets with h where a double bracket uses them twice."""
    names = symbols(free.spec)
    if not names:
        return free
    own = own_rates(free.setting)
    brackets = (x - y for x, y in zip(free.exact.rates, own, strict=True))
    definitions = (*free.exact.definitions, *zip(names, brackets, strict=True))
    rates = tuple(x + y for x, y in zip(free.setting.elements(names), own, strict=True))
    return replace(free, exact=replace(free.exact, definitions=definitions, rates=rates))


def own_rates(setting: Setting) -> tuple[Element, ...]:
    """The rates of the state at fixed momenta: ``-M^-1 dp/dt|explicit`` of velocities, else 0."""
    field = setting.field
    known = dict.fromkeys(setting.state, field.zero)
    if not setting.momenta and setting.spec.lagrangian is not None:
        own = [explicit(setting, p) for p in mechanics(setting).momenta]
        if any(own):
            moved = apply(mechanics(setting).inverse_mass, own)
            known |= {v: -x for v, x in zip(setting.velocities, moved, strict=True)}
    return tuple(known.values())


def added_rates(setting: Setting) -> list[Element]:
    """What the forces add to the rate of each component of the state."""
    field, pairs = setting.field, setting.conjugates
    velocities = [xi for xi, _, _ in pairs] if setting.momenta else setting.velocities
    added = _declared_forces(setting, "momentum", "coordinate")
    along = external_forces(setting, velocities)
    if pairs:
        for (_, name, weight), force in zip(pairs, along, strict=True):
            added[name] = added.get(name, field.zero) + force * weight
    elif any(along):
        moved = apply(mechanics(setting).inverse_mass, along)
        added |= zip(velocities, moved, strict=True)
    return [added.get(name, field.zero) for name in setting.state]


def metric(setting: Setting) -> Matrix:
    """G of the declared double or metriplectic bracket, with a row for each state component."""
    relaxation, field = setting.spec.relaxation, setting.field
    assert relaxation is not None, "asked for only where a bracket dissipates"
    size, value = len(setting.state), setting.value(relaxation.G)
    if isinstance(value, tuple):
        return tuple(tuple(field.zero + x for x in entries(row)) for row in value)
    return tuple(
        tuple(field.zero + value if i == j else field.zero for j in range(size))
        for i in range(size)
    )


def relaxed_rates(free: Equations) -> tuple[Element, ...]:
    """``P G P dh`` with the names of ``P dh``, or ``G dS``."""
    setting, relaxation = free.setting, free.spec.relaxation
    field, tensor = setting.field, free.exact.poisson_tensor
    if relaxation is None:
        return (field.zero,) * len(setting.state)
    if relaxation.S is not None:
        return apply(metric(setting), field.gradient(setting.formula(relaxation.S), setting.state))
    assert tensor is not None, "the reader asks for a bracket"
    return apply(tensor, apply(metric(setting), setting.elements(symbols(free.spec))))
