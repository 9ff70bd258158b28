"""The balance of momenta under constraints, with the forces that these exert.

Comes in: Equations under constraints. Goes out: their vector form. Read next:
`coadjoint.derive.vectors.recognise`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from coadjoint.derive.equations import Equations
from coadjoint.derive.interpret import entries, interpret
from coadjoint.derive.mechanics.frames import frame_of
from coadjoint.derive.setting import Setting
from coadjoint.derive.vectors.gradients import count_nodes, gradient, total_of
from coadjoint.derive.vectors.lines import VectorForm, VectorLine, list_taken, rate_of
from coadjoint.derive.vectors.recognise import is_short, recognise
from coadjoint.derive.vectors.vocabulary import Vocabulary
from coadjoint.derive.vectors.words import make_vocabulary
from coadjoint.exact import Element
from coadjoint.exact.roots import simplify_roots
from coadjoint.notation.names import name
from coadjoint.notation.written import Written
from coadjoint.spec import Spec
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
    field, names = setting.field, frame_of(setting).velocities
    if not speeds_of(equations).keys() >= set(names):
        return None
    if spec.lagrangian is None or spec.variational or spec.dissipation:
        return None
    if any(each.left.shape != each.right.shape for each in spec.constraints):
        return None
    left, right = momentum_balance(equations)
    if not is_derived(equations, left, right):
        return None
    resting = dict.fromkeys(_find_resting(spec), field.zero)
    vocabulary = make_vocabulary(equations, closed=False)
    lines, sides = list[VectorLine](), dict(zip(names, right, strict=True))
    for variable in spec.having_role("velocity"):
        if variable.components[0] in resting:
            continue
        if len(variable.value_shape) != 1 or not set(variable.components) <= sides.keys():
            return None
        found = recognise(
            vocabulary, tuple(field.substitute(sides[n], resting) for n in variable.components)
        )
        momentum = _write_momentum(vocabulary, variable, setting, resting)
        if found is None or momentum is None or not is_short(total_of(found)):
            return None
        lines.append(VectorLine(rate_of(momentum), total_of(found)))
    lines += [VectorLine(*_sides(each.left.typed, each.right.typed)) for each in spec.constraints]
    written, told = _write_multipliers(spec, lines)
    return VectorForm(
        lines=tuple(lines), missing=(), shapes=vocabulary.shapes, written=written, told=told
    )


def _find_resting(spec: Spec) -> Iterator[str]:
    """Components of whole velocities that constraints keep at 0."""
    whole = {each.name: each.components for each in spec.variables}
    for each in spec.constraints:
        sides = (each.left.tree, each.right.tree)
        if each.solves and any(isinstance(side, tree.Number) and not side.value for side in sides):
            yield from whole.get(each.solves, ())


def _write_momentum(
    vocabulary: Vocabulary, velocity: Variable, setting: Setting, resting: Mapping[str, Element]
) -> tree.Node | None:
    """The momentum of a velocity: the slope of the Lagrangian, where some velocities are 0."""
    node = momentum_of(setting, velocity, vocabulary.shapes)
    slopes = setting.field.gradient(setting.lagrangian, velocity.components)
    found = recognise(vocabulary, tuple(setting.field.substitute(x, resting) for x in slopes))
    nodes = [node] if node is not None and not resting else []
    nodes += [total_of(found)] if found else []
    return min(nodes, key=count_nodes, default=None)


def _write_multipliers(spec: Spec, lines: Sequence[VectorLine]) -> tuple[dict[str, Written], str]:
    """The multipliers in lines as lambda, by numbers if they are several; and what they are."""
    used = {n.name for line in lines for n in tree.walk(line.right) if isinstance(n, tree.Name)}
    shown = [each for each in spec.constraints if each.reaction in used]
    labels = ["lambda"] if len(shown) == 1 else [f"lambda{n}" for n in range(1, len(shown) + 1)]
    if not list_taken(spec).isdisjoint(labels):
        return {}, ""
    pairs = [(each, label) for each, label in zip(shown, labels, strict=True)]
    written = {each.reaction: name(label, bold=bool(each.shape)) for each, label in pairs}
    for each, label in pairs if len(pairs) == 1 else ():
        parts = [name(f"{label}{n}") for n in range(1, len(each.reactions) + 1)]
        written |= zip(each.reactions, parts, strict=True) if each.shape else ()
    told = ", ".join(f"{label} is the force of the constraint {each.name}" for each, label in pairs)
    return written, told


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
    if value == slopes == setting.elements(parts):
        return tree.Name(velocity.name)
    return node if value == slopes and is_short(node) else None


def _sides(left: tree.Node, right: tree.Node) -> tuple[tree.Node, tree.Node]:
    """The sides of a constraint, the plainer one first."""
    return (left, right) if isinstance(left, tree.Name) else (right, left)


def momentum_balance(equations: Equations) -> tuple[list[Element], list[Element]]:
    """``dp/dt`` and ``ad*_xi p + dl/da <> a + f + A^T lambda`` along the frame of velocities.

    Along velocities of coordinates q, the second and the third are ``dl/dq``.
    """
    setting, spec = equations.setting, equations.spec
    field, frame = setting.field, frame_of(setting)
    names, lagrangian = frame.velocities, setting.lagrangian
    momenta = field.gradient(lagrangian, names)
    inertial = frame.inertial(momenta, setting.elements(names))
    slopes = [simplify_roots(field, each) for each in frame.slopes(lagrangian)]
    right = [f + s for f, s in zip(inertial, slopes, strict=True)]
    places = {n: k for k, n in enumerate(names)}
    for of, formula in spec.forces.items():
        owner = next((v for v in spec.variables if v.name == of), None)
        parts = owner.components if owner else (of,)
        for part, value in zip(parts, setting.components(formula, setting.reactions), strict=True):
            right[places[part]] += value
    work = field.zero
    for each in spec.constraints:
        multipliers = entries(setting.reactions[each.reaction])
        one, other = (setting.components(side) for side in (each.left, each.right))
        others = other if len(other) == len(one) else other * len(one)  # 0, in the place of zeros
        for a, b, multiplier in zip(one, others, multipliers, strict=True):
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
    for n in (*frame_of(equations.setting).velocities, *equations.variables):
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
    for velocity, a, b in zip(frame_of(equations.setting).velocities, left, right, strict=True):
        rest = field.substitute(a - b, known)
        own = rows.get(f"d{velocity}_dt")
        if rest and not (own is not None and field.is_zero(rest - own)):
            return False
    return True
