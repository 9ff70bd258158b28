"""The balance of momenta under constraints, with the forces that these exert.

Comes in: Equations under constraints. Goes out: their vector form. Read next:
`coadjoint.derive.vectors.recognise`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from coadjoint.derive.equations import Equations
from coadjoint.derive.interpret import entries, interpret
from coadjoint.derive.setting import Setting
from coadjoint.derive.vectors.gradients import gradient, total_of
from coadjoint.derive.vectors.recognise import (
    VectorForm,
    VectorLine,
    is_short,
    rate_of,
    recognise,
)
from coadjoint.derive.vectors.words import make_vocabulary
from coadjoint.exact import Element
from coadjoint.notation.names import name
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import Shape
from coadjoint.spec.model import Variable


def balance_lines(equations: Equations) -> VectorForm | None:
    """The balance of momenta under constraints, with the forces that these exert; None without one.

    Lagrange and d'Alembert's law is built from the algebra; it is shown only if it is the system
    that the kernel solves, row by row, once the multipliers are put in. A route in other
    velocities, as Hamel's, has no rates of these.
    """
    setting, spec = equations.setting, equations.spec
    field, names = setting.field, setting.velocities
    if not speeds_of(equations).keys() >= set(names):
        return None
    if spec.algebra is None or spec.lagrangian is None or spec.variational or spec.dissipation:
        return None
    if any(each.left.shape != each.right.shape for each in spec.constraints):
        return None
    left, right = momentum_balance(equations)
    if not is_derived(equations, left, right):
        return None
    vocabulary = make_vocabulary(equations, closed=False)
    lines, sides = list[VectorLine](), dict(zip(names, right, strict=True))
    for variable in spec.having_role("velocity"):
        if len(variable.value_shape) != 1 or not set(variable.components) <= sides.keys():
            return None
        found = recognise(vocabulary, tuple(sides[n] for n in variable.components))
        momentum = momentum_of(setting, variable, vocabulary.shapes)
        if found is None or momentum is None or not is_short(total_of(found)):
            return None
        lines.append(VectorLine(rate_of(momentum), total_of(found)))
    lines += [VectorLine(*_sides(each.left.tree, each.right.tree)) for each in spec.constraints]
    reactions = [each.reaction for each in spec.constraints if each.shape]
    taken = "lambda" in field.names or len(reactions) != 1
    written = {} if taken else {reactions[0]: name("lambda", bold=True)}
    return VectorForm(lines=tuple(lines), missing=(), shapes=vocabulary.shapes, written=written)


def momentum_of(
    setting: Setting, velocity: Variable, shapes: Mapping[str, Shape]
) -> tree.Node | None:
    """The slope of the Lagrangian by a velocity as a tree, found equal to its components."""
    lagrangian, parts = setting.spec.lagrangian, velocity.components
    if lagrangian is None:
        return None
    found = gradient(lagrangian.tree, tree.Name(velocity.name), parts, shapes)
    if not found:
        return None
    node, slopes = total_of(found), setting.field.gradient(setting.lagrangian, parts)
    value = interpret(node, setting.values, setting.field)
    return node if value == slopes and is_short(node) else None


def _sides(left: tree.Node, right: tree.Node) -> tuple[tree.Node, tree.Node]:
    """The sides of a constraint, the plainer one first."""
    return (left, right) if isinstance(left, tree.Name) else (right, left)


def momentum_balance(equations: Equations) -> tuple[list[Element], list[Element]]:
    """``dp/dt`` and ``ad*_xi p + dl/da <> a + f + A^T lambda`` along the basis of the algebra."""
    setting, spec = equations.setting, equations.spec
    field, names = setting.field, setting.velocities
    lagrangian = setting.lagrangian
    momenta = field.gradient(lagrangian, names)
    xi = setting.elements(names)
    right = [setting.sign * each for each in setting.algebra.ad_star(xi, momenta)]
    for variable in setting.advected:
        action = setting.actions[variable.name]
        slopes = field.gradient(lagrangian, variable.components)
        torque = action.diamond(slopes, setting.elements(variable.components))
        right = [r + setting.sign * t for r, t in zip(right, torque, strict=True)]
    places = {n: k for k, n in enumerate(names)}
    for of, formula in spec.forces.items():
        owner = next((v for v in spec.variables if v.name == of), None)
        parts = owner.components if owner else (of,)
        for part, value in zip(parts, setting.components(formula, setting.reactions), strict=True):
            right[places[part]] += value
    work = field.zero
    for each in spec.constraints:
        sides = (setting.components(side) for side in (each.left, each.right))
        multipliers = entries(setting.reactions[each.reaction])
        for a, b, multiplier in zip(*sides, multipliers, strict=False):
            work += multiplier * (a - b)
    right = [r + w for r, w in zip(right, field.gradient(work, names), strict=True)]
    speeds = speeds_of(equations)
    left = [
        field.sum(field.derivative(p, n) * speed for n, speed in speeds.items()) for p in momenta
    ]
    return left, right


def speeds_of(equations: Equations) -> dict[str, Element]:
    """The rates of velocities and variables, by the names of what the kernel solves for."""
    field = equations.setting.field
    rates = dict(zip(equations.variables, equations.exact.rates, strict=True))
    solved = {label for label, _ in equations.exact.definitions}
    for n in (*equations.setting.velocities, *equations.variables):
        if f"d{n}_dt" in solved:
            rates[n] = field[f"d{n}_dt"]
    return rates


def is_derived(equations: Equations, left: Sequence[Element], right: Sequence[Element]) -> bool:
    """Whether the balance is what the kernel solves, with nothing left over."""
    field, exact = equations.setting.field, equations.exact
    unknown = {n for solve in exact.solves for n in (*solve.names, *solve.intermediates)}
    known = dict[str, Element]()
    for label, value in exact.definitions:
        if label not in unknown:
            known[label] = field.substitute(value, known)
    rows = dict[str, Element]()
    for solve in exact.solves:
        for label, row, side in zip(solve.names, solve.matrix, solve.known, strict=True):
            products = [a * field[n] for a, n in zip(row, solve.names, strict=True)]
            rows[label] = field.substitute(field.sum([*products, -side]), known)
    for velocity, a, b in zip(equations.setting.velocities, left, right, strict=True):
        rest = field.substitute(a - b, known)
        own = rows.get(f"d{velocity}_dt")
        if rest and not (own is not None and field.is_zero(rest - own)):
            return False
    return True
