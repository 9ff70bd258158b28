"""The vectors and matrices of which printed equations may be made, each with its exact value.

Comes in: Equations. Goes out: a `Vocabulary`: what the rates of whole quantities are, and products
of the spec's own vectors, its velocities and the gradients of its energy, by how simple they are.
Read next: `coadjoint.derive.vectors.recognise`, which searches among them.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from dataclasses import field as attribute
from fractions import Fraction
from functools import cached_property
from itertools import product as pairs
from typing import Any

from coadjoint.derive.equations import Equations
from coadjoint.derive.interpret import Value, entries, interpret
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.setting import assemble, weigh
from coadjoint.derive.vectors.gradients import Addend, gradient, total_of
from coadjoint.errors import DerivationError
from coadjoint.exact import Element, Field, dense
from coadjoint.groups.quaternions import Quaternion
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.faults import ExpressionError
from coadjoint.spec.core.shapes import shapes
from coadjoint.spec.model import Variable

#: Vectors of a vocabulary; their products are as many as the square of it.
MOST_WORDS = 24
#: Rows of matrices beyond which products of matrices cost too much.
MOST_ROWS = 10
#: Matrices beyond which their products are too many.
MOST_MATRICES = 8
#: Vectors beyond which products of three are too many.
MOST_PLAIN = 8


@dataclass(frozen=True)
class Candidate:
    """A vector or matrix as a tree, and its value in the field, definitions put in."""

    node: tree.Node
    value: Value


@dataclass
class Vocabulary:
    """What may stand in equations of whole quantities.

    Attributes:
        field: Where the values live.
        targets: The whole quantities of the state, each with the value of its rate.
        words: Vectors and matrices, the simplest first.
        scalars: Names that may stand before a vector: parameters, inputs and parts of the state,
            without components.
        named: Further names and what they stand for.
        shapes: Shapes of whole quantities.
        values: The value of each name that a printed tree may hold.
        levels: How many kinds of candidates there are, the simplest first.
        products: Products of two vectors that were made, by the trees of both.
    """

    field: Field
    targets: tuple[Candidate, ...]
    words: tuple[Candidate, ...]
    scalars: frozenset[str]
    named: tuple[tuple[tree.Node, tree.Node], ...] = ()
    shapes: Mapping[str, Shape] = attribute(default_factory=dict)
    values: Mapping[str, Value] = attribute(default_factory=dict)
    levels: int = 4
    products: dict[tuple[tree.Node, tree.Node], Candidate] = attribute(default_factory=dict)

    def evaluate(self, node: tree.Node) -> Value:
        """The value of a printed tree, from that of each name in it."""
        names, spare = dict(self.values), list[tree.Node]()

        def plain(part: tree.Node) -> tree.Node:
            rebuilt = tree.rebuild(part, [plain(each) for each in tree.children(part)])
            match rebuilt:
                case tree.Call(function="qmul", arguments=(a, b)):
                    sides = (interpret(each, names, self.field) for each in (a, b))
                    left, right = (
                        Quaternion(*x) if len(x) == len("wxyz") else Quaternion.pure(x)
                        for x in sides
                    )
                    spare.append(rebuilt)
                    names[f"_q{len(spare)}"] = (left * right).components
                    return tree.Name(f"_q{len(spare)}")
            return rebuilt

        return interpret(plain(node), names, self.field)

    def candidates(self, like: Value, level: int) -> Iterator[Candidate]:
        """Candidates of the shape of a value: the words; their products; products of products."""
        if isinstance(like[0], tuple):
            yield from self._matrices(like, level)
            return
        whole = [word for word in self.words if _size(word.value) == _size(like)]
        own = [word for word in whole if level > 1 or not _is_sum(word.node)]
        yield from own
        if level and len(like) == 4:
            yield from self._turns(own)
        if level and len(like) == 3:
            yield from self._crosses(own, own)
        if level > 2 and len(like) == 3:
            plain = [word for word in own if isinstance(word.node, tree.Name | tree.Member)]
            plain = plain[:MOST_PLAIN]
            yield from self._crosses(plain, list(self._crosses(plain, plain)))

    def _crosses(self, left: list[Candidate], right: list[Candidate]) -> Iterator[Candidate]:
        for n, a in enumerate(left):
            for b in right[n + 1 :] if right is left else right:
                found = self._cross(a, b)
                if any(map(bool, found.value)):
                    yield found

    def _cross(self, a: Candidate, b: Candidate) -> Candidate:
        """A product, made once: each level of each search begins with the same."""
        known = self.products.get((a.node, b.node))
        if known is None:
            node = tree.Call(function="cross", arguments=(a.node, b.node))
            known = self.products[a.node, b.node] = Candidate(node, dense.cross(a.value, b.value))
        return known

    def _turns(self, own: list[Candidate]) -> Iterator[Candidate]:
        """Quaternions times vectors, from either side."""
        for q, w in pairs(own, self.words):
            if _size(w.value) == (3,):
                a, b = Quaternion(*q.value), Quaternion.pure(w.value)
                yield Candidate(
                    tree.Call(function="qmul", arguments=(q.node, w.node)), (a * b).components
                )
                yield Candidate(
                    tree.Call(function="qmul", arguments=(w.node, q.node)), (b * a).components
                )

    def _matrices(self, like: Value, level: int) -> Iterator[Candidate]:
        own = [w for w in self.words if _size(w.value) == _size(like)]
        if len(like) == 3:
            vectors = [w for w in self.words if _size(w.value) == (3,)]
            own += [
                Candidate(tree.Call(function="hat", arguments=(w.node,)), dense.hat(w.value))
                for w in vectors
            ]
        yield from own
        if not level or not len(like[0]) == len(like) <= MOST_ROWS:
            return
        if len(own) > MOST_MATRICES:
            return
        if level > 1:
            squares = [
                Candidate(tree.Power(base=w.node, exponent=2), dense.product(w.value, w.value))
                for w in own
            ]
            own += squares
        for n, a in enumerate(own):
            for b in own[n + 1 :]:
                value = dense.commutator(a.value, b.value)
                yield Candidate(tree.Call(function="commutator", arguments=(a.node, b.node)), value)
        for a, b in pairs(own, own):
            yield Candidate(
                tree.Binary(operator="*", left=a.node, right=b.node),
                dense.product(a.value, b.value),
            )

    def powers_outside(self, term: Element) -> list[int]:
        """Exponents of what is no scalar, of one term: those of its ratio to another are 0."""
        return self.field.powers_in(term, self._outside)

    @cached_property
    def _outside(self) -> list[int]:
        """Places of the symbols that are no scalars."""
        names = enumerate(self.field.names)
        return [place for place, name in names if name not in self.scalars]

    def is_scalar(self, factor: Element) -> bool:
        """Whether a factor is made of scalars of the spec alone, one term over others."""
        return self.field.reach(factor) <= self.scalars and len(self.field.terms(factor)) == 1

    def write_scalar(self, factor: Element) -> Addend | None:
        """A factor as a number times names over names."""
        parts = self.field.quotients(factor)
        if len(parts) != 1 or len(parts[0].monomials) != 1:
            return None
        (monomial,), below = parts[0].monomials, list[tree.Node]()
        for divisor, exponent in parts[0].divisors:
            name = next((n for n in self.scalars if self.field[n] == divisor), None)
            if name is None:
                return None
            below.append(_power(tree.Name(name), exponent))
        if any(name in self.field.adjoined for name, _ in monomial.powers):
            return None
        above = tuple(_power(tree.Name(name), e) for name, e in monomial.powers)
        return Addend(Fraction(monomial.number), above, tuple(below))


def _is_sum(node: tree.Node) -> bool:
    """Whether a vector is a sum, which is written addend by addend where that goes."""
    while isinstance(node, tree.Negate):
        node = node.operand
    return isinstance(node, tree.Binary) and node.operator in "+-"


def _power(base: tree.Node, exponent: int) -> tree.Node:
    return base if exponent == 1 else tree.Power(base=base, exponent=exponent)


def _is_power_of(node: tree.Node, names: Collection[str]) -> bool:
    """Whether a factor is a power of one of some names."""
    base = node.base if isinstance(node, tree.Power) else node
    return isinstance(base, tree.Name) and base.name in names


def _size(value: Value) -> tuple[int, ...]:
    return (len(value), len(value[0])) if isinstance(value[0], tuple) else (len(value),)


def make_vocabulary(equations: Equations, *, closed: bool = True) -> Vocabulary:
    """The vocabulary of Equations in the declared state.

    Args:
        equations: What was derived.
        closed: Whether definitions are put in; else velocities and multipliers are symbols.
    """
    return _Maker(equations, closed=closed).make()


class _Maker:
    """The making of one vocabulary."""

    def __init__(self, equations: Equations, *, closed: bool) -> None:
        self.equations, self.spec, self.closed = equations, equations.spec, closed
        self.setting, self.field = equations.setting, equations.setting.field
        spec = self.spec
        quantities: list[Any] = [*spec.variables, *spec.parameters, *spec.inputs, *spec.jets]
        self.shapes: dict[str, Shape] = {q.name: value_shape(q) for q in quantities}
        self.shapes |= {name: () for q in quantities for name in q.components}
        self.velocities = self._find_velocities()
        whole = [name for name, shape in self.shapes.items() if shape]
        self.values = {name: self._close(self.setting.values[name]) for name in whole}
        self.named = list[tuple[tree.Node, tree.Node]]()

    def make(self) -> Vocabulary:
        targets = tuple(self._targets())
        words = list(self._words())
        words += self._velocity(targets)
        return Vocabulary(
            field=self.field,
            targets=targets,
            words=tuple(_without_equal(words)),
            scalars=self._scalar_names(),
            named=tuple(self.named),
            shapes=self.shapes,
            values=self._name_values(words),
        )

    def _name_values(self, words: Iterable[Candidate]) -> dict[str, Value]:
        """What every name stands for in a printed tree."""
        field, setting = self.field, self.setting
        values = {name: self._close(value) for name, value in setting.values.items()}
        values |= {word.node.name: word.value for word in words if isinstance(word.node, tree.Name)}
        values |= {name: field[name] for name in self._scalar_names() if name not in values}
        uses = {each.function for each in field.adjoined.values()}
        if "atan" in uses:
            values.setdefault("pi", 4 * field.call("atan", field.one))
        return values

    def _close(self, value: Value) -> Value:
        if isinstance(value, tuple):
            return tuple(map(self._close, value))
        if not self.closed:
            return value
        closed = self.equations.close(value)
        return self.field.substitute(closed, self.velocities) if self.velocities else closed

    def _find_velocities(self) -> dict[str, Element]:
        """The velocities of fields, which rates do not name, by momenta."""
        spec, setting = self.spec, self.setting
        if spec.space is None or spec.lagrangian is None or spec.diffeomorphisms is not None:
            return {}
        return dict(zip(setting.velocities, legendre(setting).velocities, strict=True))

    def _targets(self) -> Iterator[Candidate]:
        """The rates of whole vectors and matrices of the state."""
        names, rates = self.equations.variables, self.equations.exact.rates
        by_name = {name: self._close(rate) for name, rate in zip(names, rates, strict=True)}
        for variable in self.spec.state:
            if variable.value_shape and set(variable.components) <= by_name.keys():
                yield Candidate(tree.Name(variable.name), assemble(variable, by_name))

    def _words(self) -> Iterator[Candidate]:
        """Declared vectors, then those in formulas, then gradients of the energy."""
        variables = {v.name for v in self.spec.variables}
        given = {v.name for v in self.spec.defined} if self.spec.constraints and self.closed else ()
        order = [n for n in self.shapes if n in variables]
        order += [n for n in self.shapes if n not in variables]
        diagonal = set(_diagonals(self._formulas()))
        for name in order:
            if self.shapes[name] and name not in diagonal and name not in given:
                yield Candidate(tree.Name(name), self.values[name])
        yield from self._others()
        yield from self._slopes_along_space()
        yield from self._further_slopes()
        formulas = list(self._formulas())
        found = list(self._gradients())
        found += [node for formula in formulas for node in self._vectors_in(formula)]
        for node in found[:MOST_WORDS]:
            if any(isinstance(n, tree.Name) and n.name in given for n in tree.walk(node)):
                continue
            try:
                value = self._close(interpret(node, self.setting.values, self.field))
            except (DerivationError, KeyError):
                continue
            yield Candidate(node, value)

    def _others(self) -> Iterator[Candidate]:
        """Multipliers of constraints, and vectors that the spec gives short names."""
        if not self.closed:
            for each in self.spec.constraints:
                if len(each.shape) == 1:
                    self.shapes[each.reaction] = each.shape
                    yield Candidate(tree.Name(each.reaction), self.setting.reactions[each.reaction])
        for short in self.spec.definitions:
            if short.shape and not short.arguments and len(short.shape) == 1:
                try:
                    value = self._close(interpret(short.tree, self.setting.values, self.field))
                except (DerivationError, KeyError):
                    continue
                self.shapes[short.name] = short.shape
                yield Candidate(tree.Name(short.name), value)

    def _formulas(self) -> Iterator[tree.Node]:
        spec = self.spec
        declared = [spec.lagrangian, spec.hamiltonian, *spec.forces.values()]
        declared += [each.left for each in spec.constraints]
        declared += [each.right for each in spec.constraints]
        declared += [force.formula for force in spec.newton if hasattr(force, "formula")]
        yield from (each.tree for each in declared if each is not None)

    def _vectors_in(self, formula: tree.Node) -> Iterator[tree.Node]:
        """Vectors that a formula is made of: matrices times vectors, and other parts of it."""
        try:
            known = shapes(formula, self.shapes)
        except ExpressionError:  # names of multipliers, which this scope has not
            return
        for node in tree.walk(formula):
            if len(known[id(node)]) == 1 and not isinstance(node, tree.Name):
                if isinstance(node, tree.Negate):
                    continue
                yield node
                moved = self._along(node)
                if moved is not None:
                    yield moved

    def _along(self, node: tree.Node) -> tree.Node | None:
        """A constant matrix times a field, differentiated along space."""
        jets = {jet.name for jet in self.spec.jets}
        match node:
            case tree.Binary(operator="*", left=left, right=tree.Name(name=name)):
                if f"{name}_s" in jets:
                    return tree.Binary(operator="*", left=left, right=tree.Name(f"{name}_s"))
        return None

    def _slopes_along_space(self) -> Iterator[Candidate]:
        """Derivatives of velocities along space, by the chain rule."""
        jets = {jet.name: jet for jet in self.spec.jets}
        for variable in self.spec.defined:
            name = f"{variable.name}_s"
            if name not in jets or not variable.value_shape:
                continue
            slopes = []
            for value in entries(self.values[variable.name]):
                parts = [
                    self.field.derivative(value, state) * self.field[f"{state}_s"]
                    for state in self.setting.state
                    if f"{state}_s" in self.setting.values
                ]
                slopes.append(self.field.sum(parts))
            yield Candidate(tree.Name(name), tuple(slopes))

    def _further_slopes(self) -> Iterator[Candidate]:
        """Higher derivatives of fields along space, as far as rates name them."""
        for variable in self.spec.state:
            for order in ("ss", "sss", "ssss"):
                parts = [f"{name}_{order}" for name in variable.components]
                if variable.value_shape and set(parts) <= set(self.field.names):
                    name = f"{variable.name}_{order}"
                    self.shapes[name] = variable.value_shape
                    yield Candidate(tree.Name(name), self.setting.elements(parts))

    def _gradients(self) -> Iterator[tree.Node]:
        """Gradients of the declared energies by whole vectors, and of Hamiltonians of noise."""
        noise = [each.formula for each in self.spec.noise]
        for formula in (self.spec.hamiltonian, self.spec.lagrangian, *noise):
            if formula is None:
                continue
            for variable in self.spec.variables:
                if len(variable.value_shape) != 1:
                    continue
                node, parts = tree.Name(variable.name), variable.components
                found = gradient(formula.tree, node, parts, self.shapes)
                if found:
                    yield from (self._without_scalars(each).tree for each in found if each.vector)
                    yield total_of(found)

    def _without_scalars(self, addend: Addend) -> Addend:
        """An addend without its number and its parameters, which a line has before it."""
        names = self._scalar_names()
        above, below = (
            tuple(each for each in part if not _is_power_of(each, names))
            for part in (addend.above, addend.below)
        )
        return Addend(Fraction(1), above, below, addend.vector)

    def _scalar_names(self) -> frozenset[str]:
        scalars = {q.name for q in (*self.spec.parameters, *self.spec.inputs) if not q.shape}
        scalars |= {v.name for v in self.spec.state if not v.value_shape}
        if not self.closed:
            scalars |= {each.reaction for each in self.spec.constraints if not each.shape}
        return frozenset(scalars)

    def _velocity(self, targets: Iterable[Candidate]) -> Iterator[Candidate]:
        """The velocity of a momentum that is a matrix, where it has no name: dh/dM."""
        energy = self.equations.exact.energy
        if energy is None or self.setting.velocities or self.spec.algebra is None:
            return
        whole = [v for v in self.spec.state if v.role == "momentum" and v.value_shape]
        if len(whole) != 1:
            return
        (momentum,) = whole
        name = "Omega" if "Omega" not in self.shapes else "xi"
        slopes = self.field.gradient(self.equations.close(energy), momentum.components)
        value = (
            assemble(momentum, dict(zip(momentum.components, slopes, strict=True)))
            if not momentum.elements
            else weigh(slopes, momentum.elements)
        )
        self.shapes[name] = momentum.value_shape
        slope = tree.Call(function="slope_of", arguments=(tree.Name("h"), tree.Name(momentum.name)))
        self.named.append((tree.Name(name), slope))
        yield Candidate(tree.Name(name), value)


def value_shape(quantity: object) -> Shape:
    """The shape of a declared quantity in formulas."""
    if isinstance(quantity, Variable) and quantity.elements:
        from coadjoint.algebra.matrices import size

        return (size(quantity.elements),) * 2
    return getattr(quantity, "value_shape", getattr(quantity, "shape", ()))


def _diagonals(formulas: Iterable[tree.Node]) -> Iterator[str]:
    """Names that formulas use as diagonal matrices: moments of inertia are no vectors."""
    for formula in formulas:
        for node in tree.walk(formula):
            match node:
                case tree.Call(function="diag", arguments=(tree.Name(name=name),)):
                    yield name


def _without_equal(words: Iterable[Candidate]) -> Iterator[Candidate]:
    """Words without zeros and without those whose value an earlier word has."""
    seen = set[tuple[Element, ...]]()
    for word in words:
        key = entries(word.value)
        if key not in seen and any(map(bool, key)):
            seen.add(key)
            yield word
