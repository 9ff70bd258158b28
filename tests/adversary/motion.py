"""The motion of a spec in numbers: rates, brackets and points, from the laws of docs/notation.md.

Comes in: the text of a spec. Goes out: a `Motion` that evaluates formulas, rates of change,
brackets and constraints at points of 50 digits. Derivatives are central differences: with steps of
1e-16 their error is below 1e-28, and steps of 1 are exact for what is quadratic in the velocities.
Nothing is shared with the engine. Read next: `tests.adversary.judge`.
"""

from __future__ import annotations

import re
import tomllib
from functools import cached_property

from tests.adversary.algebras import basis_of, blocks_of, constants
from tests.adversary.reader import (
    CONTEXT,
    UndefinedError,
    determinant,
    dot,
    entries,
    factors_of,
    inverse,
    mpf,
    multiply,
    names_in,
    number,
    read,
    solve,
    value,
)

STEP = mpf(10) ** -16
#: The same where a derivative is taken of derivatives.
OUTER_STEP = mpf(10) ** -10
#: How far a point found by iteration may be from its set, relative to the point.
ON_SET = mpf(10) ** -40
#: The same beside coordinates that are known to some 30 digits, as certificates show them.
ON_SHOWN = mpf(10) ** -22
#: How far inside a strict condition a point must be: iteration may end on an edge but for rounding.
EDGE = mpf(10) ** -15
#: Steps of Newton's method; it converges within ten where the set is smooth.
STEPS = 16
PAIR = re.compile(r"\{(.*),(.*)\}")
_RELATION = re.compile(r"(.*?)(==|>=|<=|>|<)(.*)", re.DOTALL)


def component_names(name, shape):
    """``Pi1, Pi2, ...`` of a vector, ``A11, A12, ...`` of a matrix, the name of a scalar."""
    joined = f"{name}_" if name[-1].isdigit() else name
    if not shape:
        return [name]
    if len(shape) == 1:
        return [f"{joined}{n + 1}" for n in range(shape[0])]
    return [f"{joined}{i + 1}{j + 1}" for i in range(shape[0]) for j in range(shape[1])]


class Values(dict):
    """Values by name at a point; whole quantities and emitted ones are computed when asked for."""

    def __init__(self, motion, point):
        super().__init__(point)
        self.motion, self.point = motion, point

    def __missing__(self, name):
        found = self[name] = self.motion.quantity(name, self.point, self)
        return found


class Motion:
    """What all kinds of motion share: names, formulas, points and derivatives."""

    #: Whether `tensor` is known.
    has_bracket = False

    def __init__(self, table):
        self.table = table
        self.with_steps()
        self.variables = table["variables"]
        self.parameters = {
            name: component_names(name, part.get("shape", []))
            for name, part in table.get("parameters", {}).items()
        }
        self.algebra = table.get("algebra")
        self.basis = basis_of(self.algebra) if self.algebra else []
        self.components = {name: self._components(name) for name in self.variables}
        self.definitions, self.functions = {}, {}
        for signature, text in table.get("definitions", {}).items():
            name, _, inner = signature.partition("(")
            if inner:
                arguments = [each.strip() for each in inner.strip(") ").split(",")]
                self.functions[name.strip()] = (arguments, read(text))
            else:
                self.definitions[name.strip()] = read(text)
        self.observables = {
            name: read(part if isinstance(part, str) else part["expression"])
            for name, part in table.get("observables", {}).items()
        }
        self.relations = self._relations()
        self.domain = [_sides(text) for text in table.get("domain", {}).values()]
        self.positive = {
            name
            for whole, part in table.get("parameters", {}).items()
            if part.get("positive")
            for name in self.parameters[whole]
        }

    # -- names ----------------------------------------------------------------------------

    def _components(self, name):
        part = self.variables[name]
        if part.get("form"):
            raise NotImplementedError("variables with a form")
        of = part.get("of")
        if of is not None:
            return component_names(name, self.variables[of].get("shape", []))
        if part["role"] == "coordinate" or not self.algebra:
            return component_names(name, part.get("shape", []))
        if part["role"] == "advected":
            assert part["representation"] == "vector", part
            return component_names(name, [3])
        count = len(self.places(name))
        return component_names(name, [count] if count > 1 else [])

    def places(self, name):
        """Places in the basis that a velocity or momentum spans."""
        block = self.variables[name].get("block")
        if block is None:
            return list(range(len(self.basis)))
        if isinstance(block, str):
            return blocks_of(self.algebra, self.basis)[block]
        return [self.basis.index(each) for each in block]

    def having(self, role):
        """Names of the variables of a role."""
        return [name for name, part in self.variables.items() if part["role"] == role]

    def flat(self, names):
        """The components of some variables."""
        return [component for name in names for component in self.components[name]]

    @property
    def state(self):
        """All names that move; those that constraints give are among them."""
        return self.flat(self.variables)

    def _relations(self):
        """What vanishes at every state: left minus right of each constraint."""
        pairs = [_sides(text) for text in self.table.get("constraints", {}).values()]
        return [("-", left, right) for left, _, right in pairs]

    # -- values ---------------------------------------------------------------------------

    def quantity(self, name, point, values):
        """A whole variable or parameter, a definition, the energy or an observable."""
        shapes = {**self.variables, **self.table.get("parameters", {})}
        if name in self.components:
            return [point[component] for component in self.components[name]]
        if name in self.parameters:
            found = [point[component] for component in self.parameters[name]]
            shape = shapes[name].get("shape", [])
            if len(shape) == 2:
                return [found[i * shape[1] : (i + 1) * shape[1]] for i in range(shape[0])]
            return found
        if name in self.definitions:
            return value(self.definitions[name], values, self.functions)
        if name in self.observables:
            return value(self.observables[name], values, self.functions)
        if name == "energy":
            return self.energy(point)
        return self.emitted(name, point, values)

    def emitted(self, name, point, values):
        """Components of observables, momentum maps, and what single kinds of motion emit."""
        for whole, part in self.table.get("symmetries", {}).items():
            parts = component_names(whole, [_dimension(part["algebra"])])
            if name == whole:
                return self.charges(part, point)
            if name in parts:
                return self.charges(part, point)[parts.index(name)]
        for whole, part in self.observables.items():
            found = value(part, values, self.functions)
            if isinstance(found, list):
                rows = (
                    [len(found)] if not isinstance(found[0], list) else [len(found), len(found[0])]
                )
                names = component_names(whole, rows)
                if name in names:
                    return entries(found)[names.index(name)]
        raise KeyError(name)

    def at(self, tree, point):
        """The entries of a formula, a text or a tree, at a point."""
        tree = read(tree) if isinstance(tree, str) else tree
        found = entries(value(tree, Values(self, point), self.functions))
        if any(isinstance(x, CONTEXT.mpc) or not CONTEXT.isfinite(x) for x in found):
            raise UndefinedError("no finite real value")
        return found

    def inside(self, point):
        """Whether a point satisfies the conditions of [domain] and the signs of parameters."""
        if any(point[name] <= 0 for name in self.positive):
            return False
        for left, sign, right in self.domain:
            (difference,) = self.at(("-", left, right), point)
            difference = difference if ">" in sign else -difference
            if difference < (0 if "=" in sign else EDGE):
                return False
        return True

    # -- derivatives ----------------------------------------------------------------------

    def along(self, function, point, direction, step=None):
        """Derivatives of the entries of a function of the point along a direction, by name."""
        size = max((abs(x) for x in direction.values()), default=0)
        if not size:
            return [mpf(0)] * len(function(point))
        step = (step or self.step) / max(size, mpf(1))
        ends = [
            function({**point, **{n: point[n] + s * x for n, x in direction.items()}})
            for s in (step, -step)
        ]
        return [(a - b) / (2 * step) for a, b in zip(*ends, strict=True)]

    def with_steps(self, part=1):
        """Take differences over a part of the steps from now on; what was computed is forgotten."""
        self.step, self.outer_step, self._last = STEP * part, OUTER_STEP * part, (None, None)

    def gradient(self, function, point, names):
        """Derivatives of one number by names."""
        return [self.along(lambda p: [function(p)], point, {n: mpf(1)})[0] for n in names]

    def rate(self, tree, point):
        """Time derivatives of the entries of a formula along the motion."""
        if self._last[0] is not point:
            self._last = point, self.rates(point)
        rates = self._last[1]
        return self.along(lambda p: self.at(tree, p), point, rates)

    def bracket(self, one, two, point, tensor=None):
        """``{one_i, two_j}`` of the entries of two formulas, row by row."""
        tensor = self.tensor(point) if tensor is None else tensor
        names, count = self.state, len(self.at(two, point))
        slopes = [self.along(lambda p: self.at(one, p), point, {n: mpf(1)}) for n in names]
        found = []
        for i in range(len(slopes[0])):
            along = {
                n: sum((slopes[k][i] * tensor[k][j] for k in range(len(names))), mpf(0))
                for j, n in enumerate(names)
            }
            found += self.along(lambda p: self.at(two, p), point, along) or [mpf(0)] * count
        return found

    # -- points ---------------------------------------------------------------------------

    def draw(self, source, size):
        """Random numbers for everything: rational, of a size, with the signs of parameters."""
        names = [*self.state, *(n for part in self.parameters.values() for n in part)]
        point = {}
        for name in names:
            drawn = mpf(source.randint(5, 60)) / source.randint(11, 29) * size
            positive = name in self.positive or source.random() < 0.5
            point[name] = drawn if positive else -drawn
        return point

    def project(self, point, trees, names, steps=STEPS, near=ON_SET):
        """The nearest zero of some formulas by Newton's method; None where it finds none.

        Args:
            point: Where it starts.
            trees: The formulas.
            names: What is moved.
            steps: How many at most.
            near: Values below this, relative to the size of what is moved, are zero.
        """
        trees = [read(tree) if isinstance(tree, str) else tree for tree in trees]
        residual = lambda p: [x for tree in trees for x in self.at(tree, p)]  # noqa: E731
        point = dict(point)
        for _ in range(steps):
            values = residual(point)
            size = 1 + max((abs(point[n]) for n in names), default=mpf(0))
            if max(map(abs, values), default=0) <= near * size:
                return point
            columns = [self.along(residual, point, {n: mpf(1)}) for n in names]
            rows = [[column[i] for column in columns] for i in range(len(values))]
            gram = [[dot(a, b) for b in rows] for a in rows]
            scale = max((gram[i][i] for i in range(len(gram))), default=mpf(0))
            if not scale:
                return None
            for i in range(len(gram)):
                gram[i][i] += scale * mpf(10) ** -25  # dependent relations do no harm
            weights = solve(gram, values)
            for n, column in zip(names, columns, strict=True):
                point[n] -= dot(weights, column)
        return None

    def points(self, source, where=(), tries=400, free=None):
        """Points inside the domain where relations and further formulas vanish.

        Every branch that a product shows is looked for by itself.

        Args:
            source: A seeded generator.
            where: Texts of formulas that vanish.
            tries: How many points are drawn at most.
            free: Names that may be moved to get there; by default the state.
        """
        trees = [*self.relations, *map(read, where)]
        branches = [factors_of(tree) or [tree] for tree in map(read, where)]
        yield from self._resting(source, trees if where else None)
        for attempt in range(tries):
            size = (1, 1, 1, 3, mpf(1) / 4, 12, 120)[attempt % 7]
            chosen = [
                branch[(attempt + place) % len(branch)] for place, branch in enumerate(branches)
            ]
            try:
                point = self.draw(source, size)
                if trees:
                    point = self.project(point, [*self.relations, *chosen], free or self.state)
                if point is not None and self.inside(point):
                    yield point
            except UndefinedError:
                continue

    def _resting(self, source, trees):
        """The point with a state of zeros, if it is on a set: the only one of ``dot(x, x) = 0``."""
        if trees is None:
            return
        try:
            point = {**self.draw(source, 1), **dict.fromkeys(self.state, mpf(0))}
            if not any(x for tree in trees for x in self.at(tree, point)) and self.inside(point):
                yield point
        except UndefinedError:
            return

    def fill(self, shown, source, where=(), tries=60):
        """Points with the shown values, the other names drawn so that relations hold.

        Yields:
            Points inside the domain and on the set, as closely as the shown digits allow.
        """
        trees = [*self.relations, *map(read, where)]
        known = {name: number(text) for name, text in shown.items()}
        for attempt in range(tries):
            point = {**self.draw(source, (1, 1, 3, mpf(1) / 4, 12)[attempt % 5]), **known}
            rest = [name for name in self.state if name not in known]
            try:
                moved = self.project(point, trees, rest, near=ON_SHOWN) if trees and rest else point
                point = point if moved is None else moved
                if self.inside(point) and self.is_near(point, trees):
                    yield point
            except UndefinedError:
                continue

    def is_near(self, point, trees, digits=12):
        """Whether formulas vanish at a point to some digits of their derivatives."""
        for tree in trees:
            for place, x in enumerate(self.at(tree, point)):
                slopes = (
                    abs(
                        self.along(lambda p, tree=tree: self.at(tree, p), point, {n: mpf(1)})[place]
                        * point[n]
                    )
                    for n in sorted(self.reach(tree) & set(point))
                )
                if abs(x) > mpf(10) ** -digits * (1 + max(slopes, default=mpf(0))):
                    return False
        return True

    def reach(self, tree):
        """Components of the state and parameters that a formula may depend on."""
        tree, found = read(tree) if isinstance(tree, str) else tree, set()
        for name in names_in(tree):
            if name in self.definitions:
                found |= self.reach(self.definitions[name])
            elif name in self.components or name in self.parameters:
                found |= set({**self.components, **self.parameters}[name])
            elif name in self.observables:
                found |= self.reach(self.observables[name])
            else:
                found.add(name)
        return found

    # -- the laws, one kind after the other -----------------------------------------------

    def charges(self, part, point):
        """``<p, dq/ds> - E dt/ds`` along each member of the basis, or the map as it is written."""
        size, found = _dimension(part["algebra"]), []
        for place in range(size):
            values = Values(self, point)
            unit = [mpf(place == n) for n in range(size)]
            values[part["vector"]] = unit if size > 1 else unit[0]
            if "map" in part:
                found += entries(value(read(part["map"]), values, self.functions))
                continue
            total, conjugate = mpf(0), self.conjugate(point)
            for name, text in part["generators"].items():
                moved = entries(value(read(text), values, self.functions))
                total += dot([conjugate[n] for n in self.components[name]], moved)
            if "time" in part:
                total -= self.energy(point) * entries(value(read(part["time"]), values))[0]
            found.append(total)
        return found

    def conjugate(self, point):
        """The momenta of the coordinates by the names of these."""
        raise NotImplementedError("a motion without momenta")

    def energy(self, point):
        """The Hamiltonian."""
        return self.at(self.table["hamiltonian"]["h"], point)[0]

    def tensor(self, point):
        """The matrix of brackets of the state."""
        raise NotImplementedError("a motion without a bracket")

    def rates(self, point):
        """Time derivatives of the state by name: ``{x, h}``."""
        names, tensor = self.state, self.tensor(point)
        slopes = self.gradient(self.energy, point, names)
        return {n: dot(row, slopes) for n, row in zip(names, tensor, strict=True)}


def _sides(text):
    left, sign, right = _RELATION.fullmatch(text.strip()).groups()
    return read(left), sign, read(right)


def _dimension(algebra):
    """How many members the basis of an algebra has."""
    flat = re.fullmatch(r"R\^(\d+)", algebra)
    return int(flat[1]) if flat else len(basis_of({"name": algebra}))


def zeros(size):
    """A square matrix of zeros."""
    return [[mpf(0)] * size for _ in range(size)]


def matrix_of_second(function, point, names):
    """Second derivatives of what is quadratic in some names: exact with steps of one."""
    found = zeros(len(names))

    def shifted(*signs):
        moved = dict(point)
        for name, sign in signs:
            moved[name] += sign
        return function(moved)

    for i, a in enumerate(names):
        for j, b in enumerate(names[: i + 1]):
            found[i][j] = found[j][i] = (
                shifted((a, 1), (b, 1))
                - shifted((a, 1), (b, -1))
                - shifted((a, -1), (b, 1))
                + shifted((a, -1), (b, -1))
            ) / 4
    return found


def slopes_of_quadratic(function, point, names):
    """First derivatives of what is quadratic in some names: exact with steps of one."""
    return [
        (function({**point, n: point[n] + 1}) - function({**point, n: point[n] - 1})) / 2
        for n in names
    ]


class Declared(Motion):
    """A bracket of coordinates: by a table, canonical or Nambu's."""

    has_bracket = True

    def tensor(self, point):
        """The matrix of brackets of the state."""
        part, names = self.table["poisson"], self.state
        place, found = {n: i for i, n in enumerate(names)}, zeros(len(names))

        def put(one, two, x):
            i, j = place[one], place[two]
            found[i][j] += x
            found[j][i] -= x

        for key, text in {**part.get("brackets", {}), **part.get("magnetic", {})}.items():
            one, two = (each.strip() for each in PAIR.fullmatch(key.strip()).groups())
            put(one, two, self.at(text, point)[0])
        for one, two in part.get("canonical", []):
            for a, b in zip(self._parts(one), self._parts(two), strict=True):
                put(a, b, mpf(1))
        if "nambu" in part:
            rows = [
                self.gradient(lambda p, text=text: self.at(text, p)[0], point, names)
                for text in part["nambu"]
            ]
            return [[-_minor(rows, i, j) for j in range(len(names))] for i in range(len(names))]
        return found

    def conjugate(self, point):
        """The momenta of the coordinates by the names of these."""
        pairs = self.table["poisson"].get("canonical", [])
        return {
            q: point[p]
            for one, two in pairs
            for q, p in zip(self._parts(one), self._parts(two), strict=True)
        }

    def _parts(self, name):
        return self.components.get(name, [name])


def _minor(rows, i, j):
    """``det(e_i, e_j, grad c_1, ...)``."""
    size = len(rows[0])
    units = [[mpf(k == place) for k in range(size)] for place in (i, j)]
    return determinant([*units, *rows]) if i != j else mpf(0)


class LiePoisson(Motion):
    """The dual of an algebra with advected vectors; from a Hamiltonian or from a Lagrangian."""

    has_bracket = True

    def __init__(self, table):
        super().__init__(table)
        self.mu = self.flat(self.having("momentum"))
        self.order = [k for name in self.having("momentum") for k in self.places(name)]
        self.xi = self.flat(self.having("velocity"))
        self.along_xi = [k for name in self.having("velocity") for k in self.places(name)]
        self.advected = self.having("advected")
        self._constants, self._known = {}, {}

    @property
    def state(self):
        """The names that make the state."""
        return self.flat([*self.having("momentum"), *self.having("advected")])

    def structure(self, point):
        """c_ij^k at a point of the parameters."""
        known = tuple(point[n] for part in self.parameters.values() for n in part)
        if known not in self._constants:
            values = Values(self, point)
            self._constants[known] = constants(self.algebra, values)[1]
        return self._constants[known]

    def tensor(self, point):
        """The matrix of brackets of the state."""
        c, names = self.structure(point), self.state
        place, found = {n: i for i, n in enumerate(names)}, zeros(len(names))
        sign = -1 if self.algebra.get("invariance", "left") == "left" else 1
        for a, i in zip(self.mu, self.order, strict=True):
            for b, j in zip(self.mu, self.order, strict=True):
                found[place[a]][place[b]] = sign * dot(
                    [c[i][j][k] for k in self.order], [point[n] for n in self.mu]
                )
        for a, i in zip(self.mu, self.order, strict=True):
            for name in self.advected:
                parts = self.components[name]
                moved = act(self.basis[i], [point[n] for n in parts])
                for n, x in zip(parts, moved, strict=True):
                    found[place[a]][place[n]] += -sign * x
                    found[place[n]][place[a]] -= -sign * x
        return found

    def velocities(self, point):
        """The velocities of a state, from a Lagrangian quadratic in them."""
        mass, offset = self._quadratic(point)
        momentum = dict(zip(self.order, (point[n] for n in self.mu), strict=True))
        right = [momentum[k] - b for k, b in zip(self.along_xi, offset, strict=True)]
        return solve(mass, right)

    def _quadratic(self, point):
        """The mass matrix and the momenta at rest; momenta have no part in them."""
        known = tuple(x for n, x in point.items() if n not in self.mu)
        if known not in self._known:
            rest = {**point, **dict.fromkeys(self.xi, mpf(0))}
            mass = matrix_of_second(self._lagrangian, rest, self.xi)
            self._known = {known: (mass, slopes_of_quadratic(self._lagrangian, rest, self.xi))}
        return self._known[known]

    def _lagrangian(self, point):
        return self.at(self.table["lagrangian"]["l"], point)[0]

    def energy(self, point):
        """The energy at a point."""
        if "hamiltonian" in self.table:
            return super().energy(point)
        xi = self.velocities(point)
        momentum = dict(zip(self.order, (point[n] for n in self.mu), strict=True))
        whole = {**point, **dict(zip(self.xi, xi, strict=True))}
        paired = dot([momentum[k] for k in self.along_xi], xi)
        return paired - self._lagrangian(whole)

    def quantity(self, name, point, values):
        """A value by name; velocities follow from the momenta."""
        follows = "lagrangian" in self.table and not all(n in point for n in self.xi)
        if follows and (name in self.xi or name in self.having("velocity")):
            known = dict(zip(self.xi, self.velocities(point), strict=True))
            values.update(known)
            if name in known:
                return known[name]
            return [known[n] for n in self.components[name]]
        return super().quantity(name, point, values)


def act(name, a):
    """What a member of the basis does to a vector: rotations turn it, translations do not."""
    found = [mpf(0)] * 3
    if re.fullmatch(r"J[123]", name):
        k = int(name[1]) - 1
        found[(k + 2) % 3], found[(k + 1) % 3] = a[(k + 1) % 3], -a[(k + 2) % 3]
    return found


class Canonical(Motion):
    """Coordinates with momenta, from a Hamiltonian or a Lagrangian."""

    has_bracket = True

    @property
    def state(self):
        """The names that make the state."""
        return self.flat([n for n in self.variables if self.variables[n]["role"] != "velocity"])

    def conjugate(self, point):
        """The momenta of the coordinates by the names of these."""
        return {q: point[p] for q, p in self.pairs()}

    def pairs(self):
        """Coordinates with their momenta, by component."""
        for name in self.having("momentum"):
            of = self.variables[name]["of"]
            yield from zip(self.components[of], self.components[name], strict=True)

    def tensor(self, point):
        """The matrix of brackets of the state."""
        names = self.state
        place, found = {n: i for i, n in enumerate(names)}, zeros(len(names))
        for q, p in self.pairs():
            found[place[q]][place[p]], found[place[p]][place[q]] = mpf(1), mpf(-1)
        return found


class Constrained(Motion):
    """Lagrange and d'Alembert: all velocities are kept, constraints are relations.

    Also the motion of a Lagrangian on coordinates without constraints. With p = dl/dxi,

        M dxi/dt = ad*_xi p + dl/da <> a + dl/dq + f - dp/dz dz/dt + A^T lambda.
    """

    def __init__(self, table):
        super().__init__(table)
        self.velocities = self.flat(self.having("velocity"))
        self.positions = self.flat([*self.having("advected"), *self.having("coordinate")])
        self.moving = [name for name in self.having("velocity") if not self._of(name)]
        self.along_basis = {
            component: place
            for name in self.moving
            for component, place in zip(self.components[name], self.places(name), strict=True)
        }
        self.of = {
            v: q
            for name in self.having("velocity")
            if self._of(name)
            for v, q in zip(self.components[name], self.components[self._of(name)], strict=True)
        }

    def _of(self, name):
        return self.variables[name].get("of")

    @cached_property
    def given(self):
        """Velocities that a constraint gives: alone on a side, and not on the other."""
        found = []
        for text in self.table.get("constraints", {}).values():
            left, _, right = _sides(text)
            for one, other in ((left, right), (right, left)):
                parts = self.components.get(one[1], []) if one[0] == "name" else []
                if parts and not set(parts) & self.reach(other):
                    found += parts
                    break
        return found

    def lagrangian(self, point):
        """The Lagrangian at a point."""
        return self.at(self.table["lagrangian"]["l"], point)[0]

    def conjugate(self, point):
        """The momenta of the coordinates by the names of these."""
        momenta = dict(zip(self.velocities, self.momenta(point), strict=True))
        return {q: momenta[v] for v, q in self.of.items()}

    def momenta(self, point):
        """The slopes of the Lagrangian by the velocities."""
        return slopes_of_quadratic(self.lagrangian, point, self.velocities)

    def energy(self, point):
        """The energy at a point."""
        return dot(self.momenta(point), [point[n] for n in self.velocities]) - self.lagrangian(
            point
        )

    def moved(self, point):
        """``dz/dt`` of the positions."""
        rates = {q: point[v] for v, q in self.of.items()}
        sign = self._sign
        for name in self.having("advected"):
            parts = self.components[name]
            for component, place in self.along_basis.items():
                turned = act(self.basis[place], [point[n] for n in parts])
                for n, x in zip(parts, turned, strict=True):
                    rates[n] = rates.get(n, mpf(0)) - sign * point[component] * x
        return rates

    @cached_property
    def _sign(self):
        """1 for left invariance, -1 for right."""
        left = self.algebra is None or self.algebra.get("invariance", "left") == "left"
        return 1 if left else -1

    def forces(self, point):
        """Generalised forces along the velocities, constraint forces left out."""
        p = dict(zip(self.velocities, self.momenta(point), strict=True))
        slopes = dict(
            zip(self.positions, self.gradient(self.lagrangian, point, self.positions), strict=True)
        )
        found = dict.fromkeys(self.velocities, mpf(0))
        for v, q in self.of.items():
            found[v] += slopes[q]
        if self.along_basis:
            c = constants(self.algebra, Values(self, point))[1]
            for a, i in self.along_basis.items():
                for b, j in self.along_basis.items():
                    for e, k in self.along_basis.items():
                        if c[j][i][k]:
                            found[a] += self._sign * p[e] * c[j][i][k] * point[b]
                for name in self.having("advected"):
                    parts = self.components[name]
                    turned = act(self.basis[i], [point[n] for n in parts])
                    found[a] -= self._sign * dot([slopes[n] for n in parts], turned)
        for name, text in self.table.get("forces", {}).items():
            for n, x in zip(self.components[name], self.at(text, point), strict=True):
                found[n] += x
        if "dissipation" in self.table:
            R = lambda q: self.at(self.table["dissipation"]["R"], q)[0]  # noqa: E731
            for n, x in zip(self.velocities, self.gradient(R, point, self.velocities), strict=True):
                found[n] -= x
        return found

    def solved(self, point):
        """Accelerations by velocity, and the multipliers in the order of the relations."""
        moved = self.moved(point)
        mass = matrix_of_second(self.lagrangian, point, self.velocities)
        carried = self.along(self.momenta, point, moved)
        residual = lambda p: [x for tree in self.relations for x in self.at(tree, p)]  # noqa: E731
        forces = self.forces(point)
        right = [forces[n] - x for n, x in zip(self.velocities, carried, strict=True)]
        rows = [list(row) for row in mass]
        if self.relations:
            rest = residual({**point, **dict.fromkeys(self.velocities, mpf(0))})
            columns = []
            for name in self.velocities:
                unit = {**point, **dict.fromkeys(self.velocities, mpf(0)), name: mpf(1)}
                columns.append([a - b for a, b in zip(residual(unit), rest, strict=True)])
            count = len(rest)
            rows = [[*row, *(-x for x in col)] for row, col in zip(rows, columns, strict=True)]
            rows += [[*(col[i] for col in columns), *([mpf(0)] * count)] for i in range(count)]
            right += [-x for x in self.along(residual, point, moved)]
        found = solve(rows, right)
        size = len(self.velocities)
        return dict(zip(self.velocities, found[:size], strict=True)), found[size:]

    def rates(self, point):
        """Time derivatives of the state by name."""
        return {**self.moved(point), **self.solved(point)[0]}

    @property
    def has_bracket(self):
        """Without constraints, forces or an algebra {q, p} = 1 gives the brackets of velocities."""
        return not (self.relations or self.algebra or {"forces", "dissipation"} & set(self.table))

    def tensor(self, point):
        """{q, v} = M^-1 and {v, v} = M^-1 (P^T - P) M^-1 with P = dp/dq, from {p, p} = 0."""
        names, count = self.state, len(self.velocities)
        inner = inverse(matrix_of_second(self.lagrangian, point, self.velocities))
        order = [self.of[v] for v in self.velocities]
        columns = [self.along(self.momenta, point, {q: mpf(1)}) for q in order]
        turned = [[columns[i][j] - columns[j][i] for j in range(count)] for i in range(count)]
        among = multiply(multiply(inner, turned), inner)
        place, found = {n: i for i, n in enumerate(names)}, zeros(len(names))
        for i, v in enumerate(self.velocities):
            for j, w in enumerate(self.velocities):
                found[place[v]][place[w]] = among[i][j]
                found[place[order[i]]][place[w]] = inner[i][j]
                found[place[w]][place[order[i]]] = -inner[i][j]
        return found

    def emitted(self, name, point, values):
        """Reactions beside what every motion emits."""
        if name.endswith("_reaction"):
            return dict(zip(self.reactions, self.solved(point)[1], strict=True))[name]
        return super().emitted(name, point, values)

    @cached_property
    def reactions(self):
        """Names of the multipliers of scalar constraints."""
        return [f"{name}_reaction" for name in self.table.get("constraints", {})]


class Restricted(Motion):
    """A submanifold that the whole motion keeps: some variables follow from the others."""

    def __init__(self, table):
        self.whole = kind_of({k: v for k, v in table.items() if k != "reduction"})
        self.section = {name: read(t) for name, t in table["reduction"]["section"].items()}
        super().__init__(table)

    @property
    def state(self):
        """The names that make the state."""
        rest = [name for name in self.whole.variables if name not in self.section]
        names = set(self.whole.state)
        return [n for n in self.flat(rest) if n in names]

    def complete(self, point):
        """The whole state at a point of the submanifold."""
        found = dict(point)
        for name, tree in self.section.items():
            parts = entries(value(tree, Values(self, found), self.functions))
            found.update(zip(self.components[name], parts, strict=True))
        return found

    def rates(self, point):
        """Time derivatives of the state by name."""
        found = self.whole.rates(self.complete(point))
        return {n: found[n] for n in self.state}

    def energy(self, point):
        """The energy at a point."""
        return self.whole.energy(self.complete(point))

    def tensor(self, point):
        """The matrix of brackets of the state, where the section has one: Dirac's.

        The rows of x are made orthogonal to what vanishes on the section, by elimination.
        """
        full, names = self.complete(point), self.whole.state
        tensor, own = self.whole.tensor(full), set(self.state)
        normals = [
            self.whole.gradient(
                lambda p, t=tree, k=k, n=n: p[n] - self.whole.at(t, p)[k], full, names
            )
            for name, tree in self.section.items()
            for k, n in enumerate(self.components[name])
        ]

        def paired(one, two):
            return dot(one, [dot(row, two) for row in tensor])

        rows = [[mpf(n == x) for n in names] for x in names if x in own]
        while normals:
            pairs = [(a, b) for a in range(len(normals)) for b in range(a)]
            sizes = {pair: abs(paired(normals[pair[0]], normals[pair[1]])) for pair in pairs}
            most = max(sizes, key=sizes.get, default=None)
            if most is None or sizes[most] < mpf(10) ** -15:
                break
            (a, b), rest = most, [n for k, n in enumerate(normals) if k not in most]
            one, two = normals[a], normals[b]
            size = paired(one, two)

            def reduced(row, one=one, two=two, size=size):
                to_one, to_two = paired(one, row) / size, paired(two, row) / size
                return [x - to_one * v + to_two * u for x, u, v in zip(row, one, two, strict=True)]

            normals, rows = [reduced(n) for n in rest], [reduced(row) for row in rows]
        if any(abs(paired(normal, row)) > mpf(10) ** -15 for normal in normals for row in rows):
            return super().tensor(point)
        return [[paired(one, two) for two in rows] for one in rows]


class Newton(Motion):
    """Mass times acceleration is force."""

    def rates(self, point):
        """Time derivatives of the state by name."""
        found = {}
        for name in self.having("velocity"):
            of = self.variables[name]["of"]
            part = self.table["newton"][of]
            force = self.at(part["force"], point)
            mass = self.at(part.get("mass", "1"), point)
            size = len(force)
            if len(mass) == 1:
                accelerated = [x / mass[0] for x in force]
            else:
                rows = [mass[i * size : (i + 1) * size] for i in range(size)]
                accelerated = solve(rows, force)
            found.update(
                zip(self.components[of], (point[n] for n in self.components[name]), strict=True)
            )
            found.update(zip(self.components[name], accelerated, strict=True))
        return found


def kind_of(table):
    """The motion of a spec."""
    if "reduction" in table:
        return Restricted(table)
    roles = {part["role"] for part in table["variables"].values()}
    if "constraints" in table:
        return Constrained(table)
    if "algebra" in table:
        return LiePoisson(table)
    if "poisson" in table:
        return Declared(table)
    if "newton" in table:
        return Newton(table)
    return Canonical(table) if "momentum" in roles else Constrained(table)


def motion_of(text):
    """The motion that a spec's text declares."""
    return kind_of(tomllib.loads(text, parse_float=lambda x: x))
