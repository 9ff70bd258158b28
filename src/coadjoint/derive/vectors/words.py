"""The vectors and matrices of which printed equations may be made, and what they are found for.

Comes in: Equations. Goes out: a `Vocabulary`: what the rates of whole quantities are, the spec's
own vectors and matrices, its velocities, and the gradients of its energy.
Read next: `coadjoint.derive.vectors.recognise`, which searches among their products.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import Any

from coadjoint.derive.equations import Equations
from coadjoint.derive.interpret import Value, entries, interpret
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.setting import assemble, shape, weigh
from coadjoint.derive.vectors.attitudes import (
    drop_rotations,
    name_parts,
    name_poses,
    parts_of,
    torque,
)
from coadjoint.derive.vectors.gradients import (
    Addend,
    count_nodes,
    gradient,
    total_of,
    write_polynomial,
)
from coadjoint.derive.vectors.transposes import multiply, turn
from coadjoint.derive.vectors.vocabulary import Candidate, Part, Vocabulary, evaluate, measure
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.faults import ExpressionError
from coadjoint.spec.core.shapes import shapes
from coadjoint.spec.model import Variable

#: Vectors of a vocabulary; their products are as many as the square of it.
MOST_WORDS = 24
#: Nodes of gradients by components up to which they are vectors to be shown.
LONGEST_SLOPES = 20


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
        if spec.time is not None:
            self.shapes[spec.time.name] = ()
        self.values = {name: self._close(self.setting.values[name]) for name in whole}
        self.poses = name_poses(spec)
        self.parts = parts_of(self.poses)
        for pose in self.poses:
            matrix = self.values[pose.variable.name]
            attitude, place = tuple(r[:-1] for r in matrix), tuple(r[-1] for r in matrix)
            for name, value in zip(pose.names, (attitude, place), strict=True):
                self.values[name], self.shapes[name] = value, measure(value)
        self.short = dict(self._short_values())
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
            parts=self._parts(),
            moving=frozenset(self.setting.state),
            attitudes=frozenset(attitude for attitude, _ in self._turns()),
            shorten=self._shorten,
        )

    def _name_values(self, words: Iterable[Candidate]) -> dict[str, Value]:
        """What every name stands for in a printed tree."""
        field, setting = self.field, self.setting
        values = {name: self._close(value) for name, value in setting.values.items()}
        values |= {name: self.values[name] for pose in self.poses for name in pose.names}
        values |= {} if self.closed else setting.reactions
        values |= {word.node.name: word.value for word in words if isinstance(word.node, tree.Name)}
        values |= {name: field[name] for name in self._scalar_names() if name not in values}
        return {**self._pi(), **values}

    def _pi(self) -> dict[str, Element]:
        """Half a turn, where a formula of the spec has it."""
        uses = {each.function for each in self.field.adjoined.values()}
        return {"pi": 4 * self.field.call("atan", self.field.one)} if "atan" in uses else {}

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

    @cached_property
    def _rates(self) -> dict[str, Element]:
        """The rates of the components of the state."""
        names, rates = self.equations.variables, self.equations.exact.rates
        return {name: self._close(rate) for name, rate in zip(names, rates, strict=True)}

    def _targets(self) -> Iterator[Candidate]:
        """The rates of whole vectors and matrices of the state, or of rows."""
        for variable in self.spec.state:
            if variable.value_shape and set(variable.components) <= self._rates.keys():
                value = assemble(variable, self._rates)
                if variable.name in self._stacked:
                    for row in self._list_rows(variable.name):
                        yield Candidate(row, value[row.indices[0] - 1])
                else:
                    yield Candidate(tree.Name(variable.name), value)

    @cached_property
    def _stacked(self) -> frozenset[str]:
        """Names of matrices whose rows are vectors of their own: formulas add up such rows."""
        sums = [node for node in self._nodes() if isinstance(node, tree.Binary)]
        sides = [side for node in sums if node.operator in "+-" for side in (node.left, node.right)]
        names = {n.name for n in sides if isinstance(n, tree.Index) and len(n.indices) == 1}
        matrices = {v.name for v in self.spec.state if len(v.value_shape) == 2}
        return frozenset(v.name for v in self.spec.variables if {v.name, v.of} & names & matrices)

    def _list_rows(self, name: str) -> Iterator[tree.Index]:
        """The rows of a matrix."""
        for place in range(1, len(self.values[name]) + 1):
            yield tree.Index(name=name, indices=(place,))

    def _nodes(self) -> Iterator[tree.Node]:
        """The nodes of all formulas."""
        return (node for formula in self._formulas() for node in tree.walk(formula))

    def _parts(self) -> dict[str, list[Part]]:
        """The rates of those parts of a quantity that the spec gives short names."""
        owners = {n: v.name for v in self.spec.state for n in v.components if n in self._rates}
        symbols, parts = {self.field[n]: n for n in owners}, dict[str, list[Part]]()
        for short, value in self.short.items():
            names = tuple(symbols.get(entry, "") for entry in value)
            whole = {owners.get(n, "") for n in names}
            if len(whole) == 1 and "" not in whole:
                rate = Candidate(tree.Name(short), tuple(self._rates[n] for n in names))
                parts.setdefault(whole.pop(), []).append(Part(rate, names))
        for pose in self.poses:
            parts[pose.variable.name] = [
                Part(Candidate(tree.Name(name), shape(self.elements(own), self.shapes[name])), own)
                for name, own in zip(pose.names, pose.components, strict=True)
            ]
        return parts

    def elements(self, names: Iterable[str]) -> list[Element]:
        """The rates of components."""
        return [self._rates[name] for name in names]

    def _short_values(self) -> Iterator[tuple[str, tuple[Element, ...]]]:
        """Vectors that the spec gives short names, with their values, nothing put in."""
        values = self.setting.values
        if not self.closed:
            values = {**values, **self.setting.reactions}
        for short in self.spec.definitions:
            if len(short.shape or ()) == 1 and not short.arguments:
                try:
                    yield short.name, interpret(short.tree, values, self.field)
                except (DerivationError, KeyError):
                    continue

    def _words(self) -> Iterator[Candidate]:
        """Declared vectors, then those in formulas, then gradients of the energy."""
        variables = {v.name for v in self.spec.variables}
        given = {v.name for v in self.spec.defined} if self.spec.constraints and self.closed else ()
        diagonal = set(_diagonals(self._formulas()))
        hidden = {*diagonal, *given, *self._slopes}
        hidden |= {pose.variable.name for pose in self.poses}
        variables |= {name for pose in self.poses for name in pose.names}
        whole = [n for n in self.values if n not in hidden]
        yield from (Candidate(tree.Name(n), self.values[n]) for n in whole if n in variables)
        yield from self._slopes_along_space()
        yield from (Candidate(tree.Name(n), self.values[n]) for n in whole if n not in variables)
        rows = [
            *self._rows(),
            *(row for name in sorted(self._stacked) for row in self._list_rows(name)),
        ]
        for row in rows:
            yield Candidate(row, self.values[row.name][row.indices[0] - 1])
        yield from self._loads()
        yield from self._others()
        yield from self._right_angle()
        yield from self._further_slopes()
        formulas, gradients = list(self._formulas()), list(self._gradients())
        found = gradients + [node for each in formulas for node in self._vectors_in(each)]
        found += [node for each in gradients for node in self._vectors_in(each)]
        values = {**self._pi(), **self.setting.values, **self.short, **self._slopes}
        values |= {} if self.closed else self.setting.reactions
        values |= {name: self.values[name] for pose in self.poses for name in pose.names}
        for node in list(dict.fromkeys(found))[:MOST_WORDS]:
            if any(isinstance(n, tree.Name) and n.name in given for n in tree.walk(node)):
                continue
            try:
                value = self._close(interpret(node, values, self.field))
            except (DerivationError, KeyError):
                continue
            yield Candidate(node, value)

    def _right_angle(self) -> Iterator[Candidate]:
        """The turn by a right angle of vectors in a plane."""
        if any(v.value_shape == (2,) for v in self.spec.state) and "J" not in self.values:
            self.shapes["J"] = (2, 2)
            one, zero = self.field.one, self.field.zero
            value = ((zero, -one), (one, zero))
            rows = (
                tuple(tree.Number(Fraction(int(x == one) - int(x == -one))) for x in row)
                for row in value
            )
            pair = [tree.Call(function="vector", arguments=row) for row in rows]
            self.named.append((tree.Name("J"), tree.Call(function="rows", arguments=tuple(pair))))
            yield Candidate(tree.Name("J"), value)

    def _others(self) -> Iterator[Candidate]:
        """Multipliers of constraints, and vectors that the spec gives short names."""
        if not self.closed:
            for each in self.spec.constraints:
                if len(each.shape) == 1:
                    self.shapes[each.reaction] = each.shape
                    yield Candidate(tree.Name(each.reaction), self.setting.reactions[each.reaction])
        for name, value in self.short.items():
            self.shapes[name] = (len(value),)
            yield Candidate(tree.Name(name), self._close(value))

    def _formulas(self) -> Iterator[tree.Node]:
        spec = self.spec
        declared = [spec.lagrangian, spec.hamiltonian, *spec.forces.values(), spec.dissipation]
        declared += [each.left for each in spec.constraints]
        declared += [each.right for each in spec.constraints]
        declared += [each.force for each in spec.newton]
        for each in declared:
            if each is not None:  # names of members as typed are those of any member
                of_members = any(isinstance(n, tree.Member) for n in tree.walk(each.typed))
                found = (each.tree,) if of_members else (each.typed, each.tree)
                yield from dict.fromkeys(self._name_parts(node) for node in found)

    def _name_parts(self, node: tree.Node) -> tree.Node:
        """A formula with the names of attitudes and places."""
        return name_parts(node, self.parts) if self.parts else node

    def _vectors_in(self, formula: tree.Node) -> Iterator[tree.Node]:
        """Vectors that a formula is made of: matrices times vectors, and other parts of it."""
        try:
            known = shapes(formula, {"pi": (), **self.shapes})
        except (ExpressionError, KeyError):  # of multipliers, or of functions of the spec
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
        match node:
            case tree.Binary(operator="*", left=left, right=tree.Name(name=name)):
                slope = f"{name}_s"
                if slope in self._slopes or any(slope == jet.name for jet in self.spec.jets):
                    return tree.Binary(operator="*", left=left, right=tree.Name(slope))
        return None

    @cached_property
    def _slopes(self) -> dict[str, Value]:
        """Derivatives along space of fields and of short names, by the chain rule."""
        if self.spec.space is None or self.spec.space.across is not None:
            return {}
        jets = {jet.name for jet in self.spec.jets}
        fields = (*self.spec.defined, *self.spec.state)
        own = [v.name for v in fields if v.value_shape and f"{v.name}_s" in jets]
        whole = {name: self.values[name] for name in own}
        whole |= {name: self._close(value) for name, value in self.short.items()}
        return {f"{name}_s": self._slope(value) for name, value in whole.items()}

    def _slope(self, value: Value) -> Value:
        """The derivative of a function of the state along space."""
        if isinstance(value, tuple):
            return tuple(map(self._slope, value))
        field = self.field
        moved = [n for n in self.setting.state if f"{n}_s" in field.names]
        return field.sum([field.derivative(value, n) * field[f"{n}_s"] for n in moved])

    def _slopes_along_space(self) -> Iterator[Candidate]:
        for name, value in self._slopes.items():
            self.shapes[name] = measure(value)
            yield Candidate(tree.Name(name), value)

    def _further_slopes(self) -> Iterator[Candidate]:
        """Higher derivatives of fields along space, as far as rates name them."""
        reached = frozenset[str]().union(*map(self.field.reach, self._rates.values()))
        for variable in self.spec.state:
            for order in ("ss", "sss", "ssss"):
                parts = [f"{name}_{order}" for name in variable.components]
                if variable.value_shape and reached & set(parts):
                    name = f"{variable.name}_{order}"
                    self.shapes[name] = variable.value_shape
                    yield Candidate(tree.Name(name), self.setting.elements(parts))

    def _gradients(self) -> Iterator[tree.Node]:
        """Gradients of the declared energies by whole vectors, and of Hamiltonians of noise."""
        noise = [each.formula for each in self.spec.noise]
        symmetric = [v.name for v in self.spec.variables if v.form == "symmetric"]
        scope = {"pi": (), **self.shapes}
        casimirs = [each for each in self.spec.casimirs if not each.shape]
        casimirs = casimirs if self.spec.algebra is None else []  # of an algebra ad* tells more
        declared = (self.spec.hamiltonian, self.spec.lagrangian, *noise, *casimirs)
        formulas = [self._name_parts(each.tree) for each in declared if each is not None]
        formulas += [] if self.closed else self._powers()
        for formula, (node, parts) in product(formulas, list(self._unknowns())):
            found = gradient(formula, node, parts, scope, symmetric)
            if found is None:
                yield from self._write_slopes(formula, parts)
            if found:
                own = [self._without_scalars(each).tree for each in found if each.vector]
                yield from map(self._shorten, (*own, total_of(found)))

    def _turns(self) -> Iterator[tuple[tree.Node, tree.Node | None]]:
        """Attitudes, with the places of bodies that have a pose."""
        for pose in self.poses:
            yield tree.Name(pose.attitude), tree.Name(pose.place)
        for variable in self.spec.state:
            if variable.turning == "attitude":
                yield tree.Name(variable.name), None

    def _loads(self) -> Iterator[Candidate]:
        """Torques and forces of the energy on attitudes and places."""
        declared = (self.spec.hamiltonian, self.spec.lagrangian)
        formulas = [self._name_parts(each.tree) for each in declared if each is not None]
        scope, left = {"pi": (), **self.shapes}, self.setting.sign > 0
        values = {**self._pi(), **self.setting.values, **self.values}
        for formula, (attitude, place) in product(formulas[:1], list(self._turns())):
            found = [
                replace(each, vector=torque(attitude, each.vector, left, scope))
                for each in gradient(formula, attitude, (), scope) or ()
                if each.vector is not None
            ]
            if place is not None and left:
                found += (
                    replace(each, vector=multiply(turn(attitude), each.vector))
                    for each in gradient(formula, place, (), scope) or ()
                    if each.vector is not None
                )
            for each in found:
                node = self._without_scalars(each).tree
                yield Candidate(node, evaluate(node, values, self.field))

    def _write_slopes(self, formula: tree.Node, parts: Sequence[str]) -> Iterator[tree.Node]:
        """Short gradients of the addends of a formula, by their components."""
        match formula:
            case tree.Binary(operator="+" | "-", left=left, right=right):
                yield from self._write_slopes(left, parts)
                yield from self._write_slopes(right, parts)
                return
        try:
            value = interpret(formula, {**self._pi(), **self.setting.values}, self.field)
        except (DerivationError, KeyError):
            return
        field, first = self.field, self.setting.parameters
        slopes = [write_polynomial(field, field.derivative(value, n), first) for n in parts]
        shown = [each for each in slopes if each is not None]
        vector = tree.Call(function="vector", arguments=tuple(shown))
        if len(shown) == len(parts) > 1 and count_nodes(vector) <= LONGEST_SLOPES:
            yield vector

    def _powers(self) -> Iterator[tree.Node]:
        """What constraints work, of which the slopes by velocities are their forces."""
        for each in self.spec.constraints:
            if len(each.shape) == 1:
                sides = tree.Binary(operator="-", left=each.left.tree, right=each.right.tree)
                yield tree.Call(function="dot", arguments=(tree.Name(each.reaction), sides))

    def _shorten(self, node: tree.Node) -> tree.Node:
        """A formula in which vectors stand by their short names."""
        attitudes, scope = [each for each, _ in self._turns()], {"pi": (), **self.shapes}
        known = {
            drop_rotations(self._name_parts(each.tree), attitudes, scope): each.name
            for each in self.spec.definitions
            if each.name in self.short
        }
        if not known:
            return node
        below = [self._shorten(each) for each in tree.children(node)]
        return tree.Name(known[node]) if node in known else tree.rebuild(node, below)

    def _unknowns(self) -> Iterator[tuple[tree.Node, tuple[str, ...]]]:
        """What gradients are taken by: vectors with their components, matrices, rows of these."""
        for variable in self.spec.variables:
            if variable.value_shape:
                is_vector = len(variable.value_shape) == 1
                yield tree.Name(variable.name), tuple(variable.components) if is_vector else ()
        rows = (
            *self._rows(),
            *(row for name in sorted(self._stacked) for row in self._list_rows(name)),
        )
        for row in rows:
            yield row, tuple(f"{row.name}{row.indices[0]}{n}" for n in (1, 2, 3))

    def _rows(self) -> Iterator[tree.Index]:
        """Rows of attitudes of which formulas name entries, and of matrices that are stacked."""
        for name in sorted(self._stacked):
            yield from self._list_rows(name)
        attitudes = [v.name for v in self.spec.state if v.value_shape == (3, 3)]
        nodes = (node for formula in self._formulas() for node in tree.walk(formula))
        named = [node for node in nodes if isinstance(node, tree.Index) and len(node.indices) == 2]
        rows = dict.fromkeys((n.name, n.indices[0]) for n in named if n.name in attitudes)
        for name, place in rows:
            yield tree.Index(name=name, indices=(place,))

    def _without_scalars(self, addend: Addend) -> Addend:
        """An addend without its number and its parameters, which a line has before it."""
        names = {"pi", *self._scalar_names()}
        above, below = (
            tuple(each for each in part if not _is_power_of(each, names))
            for part in (addend.above, addend.below)
        )
        return Addend(Fraction(1), above, below, addend.vector)

    def _scalar_names(self) -> frozenset[str]:
        scalars = {q.name for q in (*self.spec.parameters, *self.spec.inputs) if not q.shape}
        named = {n.name for n in self._nodes() if isinstance(n, tree.Name)}
        named |= {
            n.name + "".join(map(str, n.indices))
            for n in self._nodes()
            if isinstance(n, tree.Index)
        }
        scalars |= {n for q in self.spec.parameters if q.shape for n in q.components if n in named}
        scalars |= {self.spec.time.name} if self.spec.time is not None else set()
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


def _is_power_of(node: tree.Node, names: Collection[str]) -> bool:
    """Whether a factor is a power of one of some names."""
    base = node.base if isinstance(node, tree.Power) else node
    return isinstance(base, tree.Name) and base.name in names
