r"""Lagrangians that are singular in the velocities, by their form of first order.

Where :math:`M = \partial^2 l/\partial v^2` has no inverse, some momenta are functions of the rest
of phase space. Let the coordinates be r, whose momenta p are declared, and s. Then

.. math::
    \frac{\partial l}{\partial v_s} = \theta_s(q, p), \qquad
    L = p \cdot \dot r + \theta_s(q, p) \cdot \dot s - h(q, p)

has the motions of l, where velocities of r are solved for in momenta, and velocities of s drop out
of :math:`\theta_s` and of :math:`h = \langle \partial l/\partial v, v \rangle - l`. With
:math:`x = (q, p)`,

.. math:: \omega\,\dot x = \partial h - f, \qquad
    \omega_{ij} = \partial_i \theta_j - \partial_j \theta_i,

with the forces f along coordinates, if there are any. The inverse of omega is the Poisson tensor.
Where it has none x is bound to where there is a solution along it, by the steps of
`coadjoint.derive.mechanics.bound`.
Comes in: a Setting with a Lagrangian. Goes out: one-form, Hamiltonian and bracket.
Read next: `coadjoint.derive.routes.first_order`.

Source:
    Faddeev and Jackiw (1988), Physical Review Letters 60, 1692-1694.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import field as attribute

from coadjoint.derive.mechanics.bound import Form, bind, invert
from coadjoint.derive.mechanics.configuration import Matrix, inverse_in_blocks, mechanics
from coadjoint.derive.mechanics.driving import explicit
from coadjoint.derive.mechanics.external import external_forces
from coadjoint.derive.setting import Setting, fault, lagrangian_fault, list_components, once
from coadjoint.exact import Element
from coadjoint.exact.dense import apply


@dataclass(frozen=True)
class FirstOrder:
    """A Lagrangian in its form of first order.

    Attributes:
        setting: The spec and its field.
        solved: Velocities in terms of the momenta that are declared.
        whole: theta and h over all coordinates and momenta.
        bound: What the constraints give, by name, in the state.
        lines: How they were found, as `Constraints.lines`.
        form: theta and h over the state.
        force: What works along each of coordinates and momenta; empty without forces.
        rates: Of coordinates and momenta in the state, where forces act; else the bracket has them.
    """

    setting: Setting
    solved: Mapping[str, Element]
    whole: Form
    bound: Mapping[str, Element]
    lines: tuple[tuple[str, Element], ...]
    form: Form
    force: tuple[Element, ...] = ()
    rates: Mapping[str, Element] = attribute(default_factory=dict)

    @property
    def pulled_force(self) -> tuple[Element, ...]:
        """What works along the state: also along what follows as the state moves."""
        field = self.setting.field
        along = dict(zip(self.whole.names, self.force, strict=True))
        whole = {name: along[name] for name in self.form.names}
        for name, value in self.bound.items():
            slopes = field.gradient(value, self.form.names)
            pairs = zip(whole.items(), slopes, strict=True)
            whole = {x: force + along[name] * slope for (x, force), slope in pairs}
        return tuple(whole.values())

    @property
    def tensor(self) -> Matrix:
        """``{x_i, x_j}``, the inverse of omega on the state.

        Raises:
            DerivationError: It has none, or one that is too long.
        """
        return invert(self.setting, self.form)


@once
def first_order(setting: Setting) -> FirstOrder:
    """The declared Lagrangian in its form of first order, within its constraints.

    Raises:
        DerivationError: It is regular in a velocity whose momentum is not declared, not quadratic
            in velocities, or its one-form moves by itself; or it does not determine the motion.
    """
    solved, whole = _whole_form(setting)
    force = _forces(setting, solved, whole) if setting.spec.is_forced else ()
    known, form = bind(setting, whole, force), whole
    for name, value in known.bound.items():
        form = form.put(setting.field, name, value)
    return FirstOrder(
        setting=setting,
        solved=solved,
        whole=whole,
        bound=known.bound,
        lines=tuple(known.lines),
        form=form,
        force=force,
        rates=dict(zip(whole.names, known.solution, strict=True)) if force else {},
    )


def _forces(setting: Setting, solved: Mapping[str, Element], whole: Form) -> tuple[Element, ...]:
    """What works along coordinates and momenta, in these and the velocities that none gives.

    Raises:
        DerivationError: It is not linear in these velocities.
    """
    field, spec = setting.field, setting.spec
    acting = external_forces(setting, setting.velocities)
    along = dict.fromkeys(whole.names, field.zero)
    along |= {
        q: field.substitute(f, solved) for q, f in zip(setting.positions, acting, strict=True)
    }
    for name, force in along.items():
        slopes = field.gradient(force, setting.velocities)
        curved = [v for v in setting.velocities if any(v in field.reach(x) for x in slopes)]
        if curved:
            formula = next(iter((*spec.forces.values(), *filter(None, [spec.dissipation]))))
            message = (
                f"the force along {name} is not linear in {curved[0]}, which no momentum gives; "
                "expected forces that are linear in such velocities on the route first-order. "
                "Write one that is."
            )
            raise fault(setting, formula, message, curved[0])
    return tuple(along.values())


def _whole_form(setting: Setting) -> tuple[dict[str, Element], Form]:
    """Velocities that momenta give, and theta and h over all coordinates and momenta."""
    field, known = setting.field, mechanics(setting)
    if known.bending:
        name = next(iter(known.bending))
        message = (
            f"the Lagrangian is not quadratic in {name}; expected one that is at most quadratic in "
            "the velocities on the route first-order. Take euler-lagrange if it is regular."
        )
        raise lagrangian_fault(setting, message, name)
    places, free = _places(setting)
    names = [setting.velocities[i] for i in places]
    rest = dict.fromkeys(names, field.zero)
    inner = tuple(tuple(known.mass[i][j] for j in places) for i in places)
    scaled = zip(setting.momenta, setting.weights, strict=True)
    momenta = [field[p] * (1 / weight) for p, weight in scaled]
    moved = (field.substitute(known.momenta[i], rest) for i in places)
    right = [p - slope for p, slope in zip(momenta, moved, strict=True)]
    values = apply(inverse_in_blocks(field, inner, known.refusal), right) if places else ()
    solved = dict(zip(names, values, strict=True))
    still = dict.fromkeys((setting.velocities[i] for i in free), field.zero)

    def reduce(element: Element) -> Element:
        return field.substitute(field.substitute(element, solved), still)

    form = dict.fromkeys((*setting.positions, *setting.momenta), field.zero)
    for i in free:
        _check_singular(setting, i, field.substitute(known.momenta[i], solved))
        form[setting.positions[i]] = reduce(known.momenta[i])
    form |= {setting.positions[i]: p for i, p in zip(places, momenta, strict=True)}
    _check_still(setting, form)
    return solved, Form(tuple(form), tuple(form.values()), reduce(known.energy))


def _check_still(setting: Setting, form: Mapping[str, Element]) -> None:
    """The one-form moves with the state alone."""
    for name, value in form.items():
        if explicit(setting, value) != 0 or setting.field.reach(value) & {*setting.driving}:
            message = (
                f"the momentum of {name} depends on time or inputs; expected momenta that do not "
                "move by themselves on the route first-order. Let time and inputs act in the "
                "potential."
            )
            raise lagrangian_fault(setting, message, name)


def _places(setting: Setting) -> tuple[list[int], list[int]]:
    """The coordinates whose momenta are declared, and the others."""
    spec = setting.spec
    coordinates = spec.having_role("coordinate")
    regular = list_components(q for q in coordinates if spec.partner("momentum", q.name))
    places = range(len(setting.positions))
    chosen = [i for i in places if setting.positions[i] in regular]
    return chosen, [i for i in places if i not in chosen]


def _check_singular(setting: Setting, place: int, momentum: Element) -> None:
    """No velocity is left in a momentum: the rank of M is that of its declared part."""
    field, name = setting.field, setting.velocities[place]
    if any(not field.is_zero(slope) for slope in field.gradient(momentum, setting.velocities)):
        position = setting.positions[place]
        message = (
            f"dl/d{name} depends on velocities, so that it gives one of them; expected momenta of "
            "all coordinates in whose velocities the Lagrangian is regular. Declare the momentum "
            f"of {position}."
        )
        raise lagrangian_fault(setting, message, name)
