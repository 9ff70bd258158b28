"""The vectors and matrices of which printed equations may be made, each with its exact value.

Comes in: Equations. Goes out: a `Vocabulary`: what the rates of whole quantities are, and products
of the spec's own vectors, its velocities and the gradients of its energy, by how simple they are.
Read next: `coadjoint.derive.vectors`, which searches among them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field as attribute
from fractions import Fraction
from itertools import product as pairs

from coadjoint.derive.equations import Equations
from coadjoint.derive.gradients import Addend, gradient, total_of
from coadjoint.derive.interpret import Value, entries, interpret
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.setting import assemble, weigh
from coadjoint.errors import DerivationError
from coadjoint.exact import Element, Field, dense
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.shapes import shapes
from coadjoint.spec.model import Variable

#: Vectors of a vocabulary; their products are as many as the square of it.
MOST_WORDS = 24


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
        scalars: Names that may stand before a vector: parameters, and inputs, without components.
        named: Further names and what they stand for.
        shapes: Shapes of whole quantities.
    """

    field: Field
    targets: tuple[Candidate, ...]
    words: tuple[Candidate, ...]
    scalars: frozenset[str]
    named: tuple[tuple[tree.Node, tree.Node], ...] = ()
    shapes: Mapping[str, Shape] = attribute(default_factory=dict)
    levels: int = 3

    def candidates(self, like: Value, level: int) -> Iterator[Candidate]:
        """Candidates of the shape of a value: the words; their products; products of products."""
        if isinstance(like[0], tuple):
            yield from self._matrices(like, level)
            return
        own = [word for word in self.words if _size(word.value) == _size(like)]
        yield from own
        if level and len(like) == 3:
            yield from self._crosses(own, own)
        if level > 1 and len(like) == 3:
            plain = [word for word in own if isinstance(word.node, tree.Name | tree.Member)]
            yield from self._crosses(plain, list(self._crosses(plain, plain)))

    def _crosses(self, left: list[Candidate], right: list[Candidate]) -> Iterator[Candidate]:
        for n, a in enumerate(left):
            for b in right[n + 1 :] if right is left else right:
                value = dense.cross(a.value, b.value)
                if any(map(bool, value)):
                    yield Candidate(tree.Call("cross", (a.node, b.node)), value)

    def _matrices(self, like: Value, level: int) -> Iterator[Candidate]:
        own = [w for w in self.words if _size(w.value) == _size(like)]
        yield from own
        if not level:
            return
        for n, a in enumerate(own):
            for b in own[n + 1 :]:
                value = dense.commutator(a.value, b.value)
                yield Candidate(tree.Call("commutator", (a.node, b.node)), value)
        for a, b in pairs(own, own):
            yield Candidate(tree.Binary("*", a.node, b.node), dense.product(a.value, b.value))

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


def _power(base: tree.Node, exponent: int) -> tree.Node:
    return base if exponent == 1 else tree.Power(base, exponent)


def _size(value: Value) -> tuple[int, ...]:
    return (len(value), len(value[0])) if isinstance(value[0], tuple) else (len(value),)


def make_vocabulary(equations: Equations) -> Vocabulary:
    """The vocabulary of Equations in the declared state."""
    return _Maker(equations).make()


class _Maker:
    """The making of one vocabulary."""

    def __init__(self, equations: Equations) -> None:
        self.equations, self.spec = equations, equations.spec
        self.setting, self.field = equations.setting, equations.setting.field
        quantities = [*self.spec.variables, *self.spec.parameters, *self.spec.inputs]
        quantities += self.spec.jets
        self.shapes: dict[str, Shape] = {q.name: _shape(q) for q in quantities}
        self.velocities = self._find_velocities()
        self.values = {name: self._close(self.setting.values[name]) for name in self.shapes}
        self.named = list[tuple[tree.Node, tree.Node]]()

    def make(self) -> Vocabulary:
        targets = tuple(self._targets())
        words = list(self._words())
        words += self._velocity(targets)
        scalars = {q.name for q in (*self.spec.parameters, *self.spec.inputs) if not q.shape}
        return Vocabulary(
            field=self.field,
            targets=targets,
            words=tuple(_without_equal(words)),
            scalars=frozenset(scalars),
            named=tuple(self.named),
            shapes=self.shapes,
        )

    def _close(self, value: Value) -> Value:
        if isinstance(value, tuple):
            return tuple(map(self._close, value))
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
        by_name = {
            name: self._close(rate) for name, rate in zip(names, rates, strict=True)
        }
        for variable in self.spec.state:
            if variable.value_shape:
                yield Candidate(tree.Name(variable.name), assemble(variable, by_name))

    def _words(self) -> Iterator[Candidate]:
        """Declared vectors, then those in formulas, then gradients of the energy."""
        variables = {v.name for v in self.spec.variables}
        order = [n for n in self.shapes if n in variables]
        order += [n for n in self.shapes if n not in variables]
        diagonal = set(_diagonals(self._formulas()))
        for name in order:
            if self.shapes[name] and name not in diagonal:
                yield Candidate(tree.Name(name), self.values[name])
        yield from self._slopes_along_space()
        yield from self._further_slopes()
        formulas = list(self._formulas())
        found = [node for formula in formulas for node in self._vectors_in(formula)]
        found += self._gradients()
        for node in found[:MOST_WORDS]:
            try:
                value = self._close(interpret(node, self.setting.values, self.field))
            except (DerivationError, KeyError):
                continue
            yield Candidate(node, value)

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
        except Exception:  # noqa: BLE001 - names of observables, which this scope has not
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
                    return tree.Binary("*", left, tree.Name(f"{name}_s"))
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
        """Gradients of the declared energies by whole vectors."""
        for formula in (self.spec.hamiltonian, self.spec.lagrangian):
            if formula is None:
                continue
            for variable in self.spec.variables:
                if len(variable.value_shape) != 1:
                    continue
                found = gradient(formula.tree, tree.Name(variable.name), self.shapes)
                if found:
                    yield total_of(found)
                    yield from (each.tree for each in found if len(found) > 1 and each.vector)

    def _velocity(self, targets: Iterable[Candidate]) -> Iterator[Candidate]:
        """The velocity of a momentum that is a matrix, where it has no name: dh/dM."""
        energy, momenta = self.equations.exact.energy, self.setting.momenta
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
        slope = tree.Call("slope_of", (tree.Name("h"), tree.Name(momentum.name)))
        self.named.append((tree.Name(name), slope))
        yield Candidate(tree.Name(name), value)


def _shape(quantity: object) -> Shape:
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
