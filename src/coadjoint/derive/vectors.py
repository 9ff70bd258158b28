r"""Equations of whole vectors and matrices, recognised in the components that a route derived.

Components are searched for products of vectors: from a vocabulary of the spec's own vectors, of
gradients of its energy, and of their products, a candidate is taken whose terms are all among those
that remain, times a scalar of the spec; it is subtracted, and so on until nothing remains. What is
printed has thus been subtracted from the derived components, in the exact field, and the rest was
zero: a line is right or it is not there.

Comes in: Equations. Goes out: trees with the left sides that they equal. Read next:
`coadjoint.derive.vocabulary`, which makes the candidates.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice

from coadjoint.derive.equations import Equations
from coadjoint.derive.gradients import Addend, gradient, total_of
from coadjoint.derive.interpret import Value, entries, interpret
from coadjoint.derive.setting import Setting
from coadjoint.derive.vocabulary import Candidate, Vocabulary, make_vocabulary
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import scale, subtract
from coadjoint.notation.names import name
from coadjoint.notation.written import Written
from coadjoint.spec import Spec
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import Shape
from coadjoint.spec.model import Variable

#: Terms of components beyond which nothing is searched for.
MOST_TERMS = 4000
#: Nodes of a formula beyond which it is no shorter than its components.
LONGEST = 70
#: Words beyond which products whose terms cancel are not searched for.
MOST_WORDS = 20
#: Products that one line may have.
MOST_PRODUCTS = 8


@dataclass(frozen=True)
class VectorLine:
    """An equation of a whole quantity.

    Attributes:
        left: Its left side.
        right: Its right side.
    """

    left: tree.Node
    right: tree.Node


@dataclass(frozen=True)
class VectorForm:
    """What was found.

    Attributes:
        lines: The equations.
        missing: Names of whole quantities of the state whose equations stand in components alone.
        shapes: Shapes of whole quantities, for printing.
        written: How some names are written.
    """

    lines: tuple[VectorLine, ...]
    missing: tuple[str, ...]
    shapes: Mapping[str, Shape]
    written: Mapping[str, Written]


def vector_form(equations: Equations) -> VectorForm:
    """The equations of motion by whole vectors and matrices, as far as they are found."""
    if equations.spec.family is not None:
        return member_form(equations)
    vocabulary = make_vocabulary(equations)
    lines, missing = list[VectorLine](), list[str]()
    for target in vocabulary.targets:
        found = recognise(vocabulary, target.value)
        if found is None or not _is_short(total_of(found)):
            missing.append(tree_name(target.node))
        else:
            lines.append(VectorLine(rate_of(target.node), total_of(found)))
    lines += _named(vocabulary, lines)
    shapes, written = dict(vocabulary.shapes), dict[str, Written]()
    if missing and equations.spec.constraints:
        balance = balance_lines(equations)
        if balance is not None:
            lines[:0], missing = balance.lines, []
            shapes |= balance.shapes
            written |= balance.written
    lines += _momentum_lines(equations, vocabulary)
    lines += _short_names(equations.spec, vocabulary, lines)
    return VectorForm(tuple(lines), tuple(missing), shapes, written)


def _named(vocabulary: Vocabulary, lines: Sequence[VectorLine]) -> Iterator[VectorLine]:
    """What the further names stand for that lines use."""
    for node, right in vocabulary.named:
        if any(node in tree.walk(line.right) for line in lines):
            yield VectorLine(node, right)


def rate_of(node: tree.Node) -> tree.Node:
    """The rate of a quantity."""
    return tree.Call("rate_of", (node,))


def tree_name(node: tree.Node) -> str:
    """The name of a whole quantity."""
    assert isinstance(node, tree.Name), node
    return node.name


def recognise(vocabulary: Vocabulary, value: Value) -> list[Addend] | None:
    """Addends whose sum is a value, exactly; None where none were found.

    Args:
        vocabulary: What may stand in the sum.
        value: A vector or a matrix of elements, closed.
    """
    field = vocabulary.field
    if _count(field, value) > MOST_TERMS:
        return None
    # products of which every term is there; else those whose terms cancel with one another's
    matrix, words = isinstance(value[0], tuple), len(vocabulary.words)
    for whole in (True, False) if not matrix and words <= MOST_WORDS else (True,):
        found = _search(vocabulary, value, whole=whole)
        if found is not None:
            return found
    return None


def _search(vocabulary: Vocabulary, rest: Value, *, whole: bool) -> list[Addend] | None:
    """Addends taken one by one, the simplest kind of product first."""
    like, found = rest, list[Addend]()
    for level in range(vocabulary.levels):
        while len(found) < MOST_PRODUCTS and any(map(bool, entries(rest))):
            step = _best(vocabulary, vocabulary.candidates(like, level), rest, whole=whole)
            if step is None:
                break
            addend, rest = step
            found.append(addend)
        if not any(map(bool, entries(rest))):
            return found
    return None


def _best(
    vocabulary: Vocabulary, candidates: Iterable[Candidate], rest: Value, *, whole: bool
) -> tuple[Addend, Value] | None:
    """The candidate that leaves fewest terms, with what it leaves."""
    field, best = vocabulary.field, None
    fewest = before = _count(field, rest)
    for candidate in candidates:
        for factor in _factors(vocabulary, candidate.value, rest):
            left = subtract(rest, scale(factor, candidate.value))
            count = _count(field, left)
            if count >= fewest or (whole and before - count < _count(field, candidate.value)):
                continue
            written = vocabulary.write_scalar(factor)
            if written is None:
                continue
            fewest, best = count, (_put(written, candidate.node), left)
            if not count:
                return best
    return best


def _put(scalar: Addend, vector: tree.Node) -> Addend:
    """A scalar times a vector; minus a vector product is the product of the factors exchanged."""
    match vector:
        case tree.Call(function="cross" | "commutator" as function, arguments=(a, b)):
            if scalar.number < 0:
                return replace(scalar, number=-scalar.number, vector=tree.Call(function, (b, a)))
    return Addend(scalar.number, scalar.above, scalar.below, vector)


def _factors(vocabulary: Vocabulary, value: Value, rest: Value) -> list[Element]:
    """Scalars of the spec by which a term of a candidate is a term of what remains."""
    field = vocabulary.field
    for own, wanted in zip(entries(value), entries(rest), strict=True):
        if own and wanted:
            first = field.terms(own)[0]
            ratios = (term / first for term in islice(field.terms(wanted), 12))
            return [each for each in ratios if vocabulary.is_scalar(each)]
        if own:
            # a candidate that has an entry where nothing remains can only add terms
            return []
    return []


def _count(field: Field, value: Value) -> int:
    """The number of terms of all components."""
    return sum(len(field.terms(each)) for each in entries(value) if each)


def spoil(value: Sequence[Element]) -> tuple[Element, ...]:
    """Components with the sign of one of them turned, which no vector equation may match."""
    first, *others = value
    return (-first, *others)


# -- constraints ----------------------------------------------------------------------------------


def balance_lines(equations: Equations) -> VectorForm | None:
    """The balance of momenta under constraints, with the forces that these exert; None without one.

    Lagrange and d'Alembert's law is built from the algebra; it is shown only if it is the system
    that the kernel solves, row by row, once the multipliers are put in.
    """
    setting, spec = equations.setting, equations.spec
    field, names = setting.field, setting.velocities
    if spec.algebra is None or spec.lagrangian is None or spec.variational or spec.dissipation:
        return None
    if any(each.left.shape != each.right.shape for each in spec.constraints):
        return None
    left, right = _momentum_balance(equations)
    if not _is_derived(equations, left, right):
        return None
    vocabulary = make_vocabulary(equations, closed=False)
    lines, sides = list[VectorLine](), dict(zip(names, right, strict=True))
    for variable in spec.having_role("velocity"):
        if len(variable.value_shape) != 1 or not set(variable.components) <= sides.keys():
            return None
        found = recognise(vocabulary, tuple(sides[n] for n in variable.components))
        momentum = momentum_of(setting, variable, vocabulary.shapes)
        if found is None or momentum is None or not _is_short(total_of(found)):
            return None
        lines.append(VectorLine(rate_of(momentum), total_of(found)))
    lines += [VectorLine(*_sides(each.left.tree, each.right.tree)) for each in spec.constraints]
    reactions = [each.reaction for each in spec.constraints if each.shape]
    taken = "lambda" in field.names or len(reactions) != 1
    written = {} if taken else {reactions[0]: name("lambda", bold=True)}
    return VectorForm(tuple(lines), (), vocabulary.shapes, written)


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
    return node if value == slopes and _is_short(node) else None


def _is_short(node: tree.Node) -> bool:
    """Whether a formula can be read at one look."""
    return sum(1 for _ in tree.walk(node)) <= LONGEST


def _momentum_lines(equations: Equations, vocabulary: Vocabulary) -> Iterator[VectorLine]:
    """Momenta by velocities, where the Lagrangian gives them as a vector."""
    setting, spec = equations.setting, equations.spec
    if spec.lagrangian is None or spec.algebra is None or spec.family is not None:
        return
    for momentum in spec.having_role("momentum"):
        twins = [v for v in spec.having_role("velocity") if v.block == momentum.block]
        if len(twins) != 1 or momentum.of or len(momentum.value_shape) != 1:
            continue
        node = momentum_of(setting, twins[0], vocabulary.shapes)
        if node is not None:
            yield VectorLine(tree.Name(momentum.name), node)


def _short_names(
    spec: Spec, vocabulary: Vocabulary, lines: Sequence[VectorLine]
) -> Iterator[VectorLine]:
    """What short names of the spec stand for that lines use."""
    used = {n.name for line in lines for n in tree.walk(line.right) if isinstance(n, tree.Name)}
    for each in spec.definitions:
        if each.name in used and not each.arguments:
            yield VectorLine(tree.Name(each.name), each.tree)


def _sides(left: tree.Node, right: tree.Node) -> tuple[tree.Node, tree.Node]:
    """The sides of a constraint, the plainer one first."""
    return (left, right) if isinstance(left, tree.Name) else (right, left)


def _momentum_balance(equations: Equations) -> tuple[list[Element], list[Element]]:
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
        variable = next((v for v in spec.variables if v.name == of), None)
        parts = variable.components if variable else (of,)
        for part, value in zip(parts, setting.components(formula, setting.reactions), strict=True):
            right[places[part]] += value
    work = field.zero
    for each in spec.constraints:
        sides = (setting.components(side) for side in (each.left, each.right))
        multipliers = entries(setting.reactions[each.reaction])
        for a, b, multiplier in zip(*sides, multipliers, strict=False):
            work += multiplier * (a - b)
    right = [r + w for r, w in zip(right, field.gradient(work, names), strict=True)]
    rates = dict(zip(equations.variables, equations.exact.rates, strict=True))
    moving = [*names, *(n for n in equations.variables if n not in names)]
    known = {name for name, _ in equations.exact.definitions}
    speeds = {n: field[f"d{n}_dt"] if f"d{n}_dt" in known else rates[n] for n in moving}
    left = [
        field.sum(field.derivative(p, n) * speed for n, speed in speeds.items()) for p in momenta
    ]
    return left, right


def _is_derived(equations: Equations, left: Sequence[Element], right: Sequence[Element]) -> bool:
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
        row = rows.get(f"d{velocity}_dt")
        if rest and not (row is not None and field.is_zero(rest - row)):
            return False
    return True


# -- members --------------------------------------------------------------------------------------


def member_form(equations: Equations) -> VectorForm:
    """The equations of the generic member, from a member of the window that has all neighbours."""
    declared, vocabulary = equations.spec.family, make_vocabulary(equations)
    assert declared is not None, equations.spec.name
    own, count = declared.ends[0], len(equations.spec.state) // len(declared.variables)
    wanted = {f"{each}_{own}" for each in declared.variables}
    lines, missing = list[VectorLine](), list[str]()
    rename = _Rename(equations, own, count)
    for target in vocabulary.targets:
        label = tree_name(target.node)
        if label not in wanted:
            continue
        found = recognise(vocabulary, target.value)
        generic = None if found is None else rename.gather(found)
        if generic is None:
            missing.append(label.rpartition("_")[0])
            continue
        lines.append(VectorLine(rate_of(rename.node(target.node)), generic))
    shapes = dict(vocabulary.shapes)
    for label, own_shape in list(shapes.items()):
        shapes.setdefault(label.rpartition("_")[0], own_shape)
    return VectorForm(tuple(lines), tuple(missing), shapes, {})


class _Rename:
    """Names of members of a window as those of member i, its neighbours or a partner j."""

    def __init__(self, equations: Equations, own: int, count: int) -> None:
        declared = equations.spec.family
        assert declared is not None, equations.spec.name
        self.index, self.pairs = declared.index.name, declared.pairs
        self.own, self.count = own, count
        self.ring = declared.index.periodic
        self.other = "j" if self.index != "j" else "k"
        self.bases = {*declared.variables, *declared.indexed, *declared.indexed_inputs}

    def member_of(self, label: str) -> tuple[str, int] | None:
        """The quantity and the member that a name means."""
        base, _, number = label.rpartition("_")
        return (base, int(number)) if base in self.bases and number.isdigit() else None

    def node(self, node: tree.Node, partner: int | None = None) -> tree.Node:
        """A tree in names of member i, of its neighbours, and of member j for a partner."""
        if isinstance(node, tree.Name):
            found = self.member_of(node.name)
            if found is None:
                return node
            base, number = found
            if number == partner:
                return tree.Member(base, self.other, 0, ())
            shift = number - self.own
            if self.ring and shift > self.count // 2:
                shift -= self.count
            return tree.Member(base, self.index, shift, ())
        below = [self.node(each, partner) for each in tree.children(node)]
        return tree.rebuild(node, below)

    def gather(self, found: Sequence[Addend]) -> tree.Node | None:
        """The sum of addends; those of each partner, equal but for its name, as a sum over j."""
        if not self.pairs:
            return self.node(total_of(list(found)))
        alone, groups = list[Addend](), dict[int, list[Addend]]()
        for each in _split(found):
            partners = self._partners(each)
            if len(partners) > 1:
                return None
            (groups.setdefault(partners.pop(), []) if partners else alone).append(each)
        if not groups:
            return self.node(total_of(alone))
        sums = [self.node(total_of(group), partner) for partner, group in groups.items()]
        if len(groups) != self.count - 1 or any(each != sums[0] for each in sums):
            return None
        whole, minus = sums[0], isinstance(sums[0], tree.Negate)
        sides = (tree.Name(self.other), tree.Name(self.index))
        operand = whole.operand if isinstance(whole, tree.Negate) else whole
        total: tree.Node = tree.Sum((self.other,), operand, sides, "!=")
        total = tree.Negate(total) if minus else total
        if not alone:
            return total
        return tree.Binary("+", self.node(total_of(alone)), total)

    def _partners(self, addend: Addend) -> set[int]:
        """The members other than the own one that an addend names."""
        names = (n.name for n in tree.walk(addend.tree) if isinstance(n, tree.Name))
        members = (self.member_of(each) for each in names)
        return {each[1] for each in members if each is not None and each[1] != self.own}


def _split(found: Sequence[Addend]) -> list[Addend]:
    """Addends of which none is a number times a sum."""
    split = list[Addend]()
    for each in found:
        vector = each.vector
        match vector:
            case tree.Binary(operator="+" | "-" as sign, left=a, right=b):
                turned = -each.number if sign == "-" else each.number
                pair = [replace(each, vector=a), replace(each, vector=b, number=turned)]
                split += _split(pair)
            case tree.Negate(operand=a):
                split += _split([replace(each, vector=a, number=-each.number)])
            case _:
                split.append(each)
    return split
