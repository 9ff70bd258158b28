r"""Motions bound by a singular two-form: Dirac's steps, in the form of Gotay, Nester and Hinds.

The equations :math:`\omega\,\dot x = \partial h` have a solution where
:math:`n \cdot \partial h = 0` for every n with :math:`n\,\omega = 0`. A solution along what is left
asks for

.. math:: \begin{pmatrix} \omega \\ \partial \phi \end{pmatrix} \dot x
    = \begin{pmatrix} \partial h \\ 0 \end{pmatrix}

with the constraints :math:`\phi = 0` so far, which may bind x further, until nothing is added. Then
the rates are determined, if the matrix has full rank there. Each constraint is solved for a
component of x whose factor is a number or of positive parameters, those first that are declared to
follow.
Comes in: a one-form and a Hamiltonian. Goes out: what follows, or why there is no motion.
Read next: `coadjoint.derive.mechanics.first_order`.

Source:
    Dirac (1964), Lectures on Quantum Mechanics, lecture 1; Gotay, Nester and Hinds (1978), Journal
    of Mathematical Physics 19, 2388-2399.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from dataclasses import field as attribute

from coadjoint.derive.mechanics.configuration import Matrix, coupled_blocks
from coadjoint.derive.mechanics.driving import explicit_rate
from coadjoint.derive.setting import Setting, lagrangian_fault
from coadjoint.errors import DerivationError
from coadjoint.exact import Element, Field, element_text
from coadjoint.exact.dense import apply, dot, inverse, pfaffian, transpose
from coadjoint.exact.ranks import independent_rows
from coadjoint.exact.signs import sign
from coadjoint.exact.witness import is_nonzero

#: What a factor has to be, by which a constraint is divided.
FACTOR = "that is a number or of positive parameters"
#: Coupled components of x up to which the inverse of omega is written out, by Pfaffians.
LARGEST = 8
Row = tuple[Element, ...]


@dataclass(frozen=True)
class Form:
    """``theta(x) dx/dt - h(x)``.

    Attributes:
        names: Of the components of x.
        theta: A component for each of them.
        energy: h.
    """

    names: tuple[str, ...]
    theta: Row
    energy: Element

    def two_form(self, field: Field) -> Matrix:
        """``omega_ij = d theta_j/dx_i - d theta_i/dx_j``."""
        slopes = [field.gradient(value, self.names) for value in self.theta]
        size = range(len(self.names))
        return tuple(tuple(slopes[j][i] - slopes[i][j] for j in size) for i in size)

    def put(self, field: Field, name: str, value: Element) -> Form:
        """The same on ``name = value``: theta is pulled back."""
        named = dict(zip(self.names, self.theta, strict=True))
        own = named.pop(name)
        slopes = zip(named, field.gradient(value, list(named)), strict=True)
        pulled = (field.substitute(named[x] + own * slope, {name: value}) for x, slope in slopes)
        return Form(tuple(named), tuple(pulled), field.substitute(self.energy, {name: value}))


def invert(setting: Setting, form: Form) -> Matrix:
    """The inverse of omega, block by block: quotients of Pfaffians.

    Raises:
        DerivationError: It is singular, or couples too many components.
    """
    field, names, omega = setting.field, form.names, form.two_form(setting.field)
    whole = [[field.zero] * len(names) for _ in names]
    for block in coupled_blocks(omega):
        if len(block) > LARGEST:
            message = (
                f"omega couples {len(block)} components of the state; expected at most {LARGEST}, "
                "whose inverse can be written out. Choose coordinates that decouple them."
            )
            raise lagrangian_fault(setting, message, names[block[0]])
        own = [[omega[i][j] for j in block] for i in block]
        root = field.zero + pfaffian(own)
        if not is_nonzero(field, root):
            message = (
                "omega = d theta may be singular everywhere: no point was found at which its "
                f"Pfaffian is certainly not 0 along {', '.join(names[i] for i in block)}; expected "
                "a regular one. Write the Lagrangian in simpler functions, or give its [domain]."
            )
            if field.is_zero(root):
                message = (
                    f"omega = d theta is singular along {', '.join(names[i] for i in block)}, so "
                    "that friction alone determines the motion; expected one that has a bracket "
                    "without friction. Add the kinetic energy of these velocities."
                )
            raise lagrangian_fault(setting, message, names[block[0]])
        for a, i in enumerate(block):
            for b, j in enumerate(block[:a]):
                rest = [k for k in range(len(block)) if k not in (a, b)]
                minor = pfaffian([[own[k][m] for m in rest] for k in rest])
                whole[j][i] = (-1) ** (a + b) * minor / root
                whole[i][j] = -whole[j][i]
    return tuple(map(tuple, whole))


def left_kernel(field: Field, matrix: Sequence[Row]) -> list[Row]:
    """Vectors n with ``n matrix = 0``, which span them all.

    Independent rows have a regular part A in as many columns, and each other row b is a sum of
    them: ``n = e - b A^-1``.

    >>> field = Field(["x"])
    >>> x = field["x"]
    >>> left_kernel(field, ((x**2, x), (x, field.one), (field.zero, x)))
    [(-1/x, 1, 0)]
    """
    kept, vectors = _independent(field, matrix), list[Row]()
    columns = _independent(field, transpose([matrix[i] for i in kept])) if kept else []
    part = tuple(tuple(matrix[i][j] for j in columns) for i in kept)
    turned = transpose(inverse(part)) if kept else ()
    for place in (i for i in range(len(matrix)) if i not in kept):
        factors = apply(turned, [matrix[place][j] for j in columns])
        vector = dict.fromkeys(range(len(matrix)), field.zero) | {place: field.one}
        vector |= {i: -x for i, x in zip(kept, factors, strict=True)}
        values = tuple(vector.values())
        if all(field.is_zero(dot(values, column)) for column in zip(*matrix, strict=True)):
            vectors.append(values)
    return vectors


def _independent(field: Field, matrix: Sequence[Row]) -> list[int]:
    rows = [{j: e for j, e in enumerate(row) if e != 0} for row in matrix]
    return independent_rows(field, rows)


@dataclass
class Constraints:
    """Linear equations ``matrix u = right`` for rates or velocities u at x, bound to have one.

    Attributes:
        field: Where everything lives.
        names: Of the components of x, in the order in which constraints are solved for them.
        matrix: In x, with a row for each equation.
        right: The same.
        tangent: The row and right side by which a function of x stays zero.
        bound: What constraints give, by name in terms of what is left of x.
        steps: Constraints in their order, in words, and what they give.
        lines: The same as they are shown: what is 0, then the component that it gives.
        unsolved: A constraint in which no component has such a factor; None while all are solved.
    """

    field: Field
    names: Sequence[str]
    matrix: Matrix
    right: Row
    tangent: Callable[[Element], tuple[Row, Element]]
    bound: dict[str, Element] = attribute(default_factory=dict)
    steps: list[str] = attribute(default_factory=list)
    lines: list[tuple[str, Element]] = attribute(default_factory=list)
    unsolved: Element | None = None

    def follow(self) -> None:
        """Solve constraints until there are no more, or one cannot be solved."""
        while left := self._conditions():
            solved = next(filter(None, map(self._solve, left)), None)
            if solved is None:
                self.unsolved = left[0]
                self.steps.append(f"{element_text(self.field, left[0])} = 0")
                return
            self._put(*solved)

    def _conditions(self) -> list[Element]:
        """What must vanish for the equations to have a solution."""
        vectors = left_kernel(self.field, self.matrix)
        values = (self.field.normal(dot(each, self.right)).combine() for each in vectors)
        return [value for value in values if not self.field.is_zero(value)]

    def _solve(self, value: Element) -> tuple[str, Element, Element] | None:
        """A component that the value gives at every point, what it is, and the value itself."""
        for name in self.names:
            slope = self.field.derivative(value, name)
            if not self.field.reach(slope) & {*self.names} and sign(self.field, slope) != 0:
                return name, self.field[name] - value / slope, value
        return None

    def _put(self, name: str, solution: Element, value: Element) -> None:
        """Go on where ``name = solution``, and ask that it stays so."""
        given = f"{name} = {element_text(self.field, solution)}"
        found = f"{element_text(self.field, value)} = 0"
        self.steps.append(found if found == given else f"{found}, so {given}")
        self.lines += [("0", value), (name, solution)]
        row, side = self.tangent(self.field[name] - solution)
        put = {name: solution}
        self.bound = {x: self.field.substitute(e, put) for x, e in self.bound.items()} | put
        # the new row last: the others have no poles where it has zeros
        pairs = zip((*self.matrix, row), (*self.right, side), strict=True)
        whole = [self.field.substitute(e, self.bound) for row, side in pairs for e in (*row, side)]
        width = len(row) + 1
        rows = [whole[n : n + width] for n in range(0, len(whole), width)]
        self.matrix = tuple(tuple(each[:-1]) for each in rows)
        self.right = tuple(each[-1] for each in rows)

    def is_contradicted(self) -> bool:
        """Whether the constraint that is not solved holds nowhere: it names no component of x."""
        return self.unsolved is not None and not self.field.reach(self.unsolved) & {*self.names}

    @property
    def free(self) -> list[Row]:
        """Directions of u that nothing gives."""
        return left_kernel(self.field, transpose(self.matrix))

    @property
    def groups(self) -> list[tuple[list[int], list[int]]]:
        """Independent equations that share unknowns, with the places of these."""
        groups = list[tuple[list[int], set[int]]]()
        for i in _independent(self.field, self.matrix):
            linked = {j for j, entry in enumerate(self.matrix[i]) if entry != 0}
            meeting = [group for group in groups if group[1] & linked]
            groups = [group for group in groups if not group[1] & linked]
            rows = sorted([i, *(row for known, _ in meeting for row in known)])
            groups.append((rows, linked.union(*(columns for _, columns in meeting))))
        return [(rows, sorted(columns)) for rows, columns in groups]

    @property
    def solution(self) -> Row:
        """u, where nothing of it is free.

        >>> field = Field(["x"])
        >>> x, zero, one = field["x"], field.zero, field.one
        >>> rows = ((x, zero), (one, x))
        >>> Constraints(field, ["x"], rows, (one, zero), lambda _: (rows[0], zero)).solution
        (1/x, -1/x**2)
        """
        found = dict[int, Element]()
        for rows, columns in self.groups:
            part = tuple(tuple(self.matrix[i][j] for j in columns) for i in rows)
            found |= zip(columns, apply(inverse(part), [self.right[i] for i in rows]), strict=True)
        return tuple(found[j] for j in range(len(found)))

    @property
    def chain(self) -> str:
        """All steps, with their numbers."""
        return "; ".join(f"({n}) {step}" for n, step in enumerate(self.steps, 1)) or "none"


def bind(setting: Setting, form: Form, force: Sequence[Element] = ()) -> Constraints:
    """The constraints of a form, all of them solved.

    Args:
        setting: The spec and its field.
        form: theta and h over all coordinates and momenta.
        force: What works along each of these, at most linear in velocities; empty without any.

    Raises:
        DerivationError: There is no motion, or it is not determined, or a constraint cannot be
            solved; or what follows is not what the spec declares to follow.
    """
    field, omega = setting.field, form.two_form(setting.field)
    resting = [x for x, row in zip(form.names, omega, strict=True) if not any(row)]
    given = [name for name in form.names if name not in setting.state]
    right = field.gradient(form.energy, form.names)
    if force:
        pairs = dict(zip(setting.positions, setting.velocities, strict=True))
        moving = [pairs.get(x, "") for x in form.names]
        slopes = [[field.derivative(f, v) if v else field.zero for v in moving] for f in force]
        omega = tuple(
            tuple(a + b for a, b in zip(*rows, strict=True))
            for rows in zip(omega, slopes, strict=True)
        )
        still = dict.fromkeys(filter(None, moving), field.zero)
        right = tuple(x - field.substitute(f, still) for x, f in zip(right, force, strict=True))
    known = Constraints(
        field=field,
        names=tuple(dict.fromkeys((*given, *resting, *form.names))),
        matrix=omega,
        right=right,
        tangent=lambda value: (field.gradient(value, form.names), -_moved(setting, value)),
    )
    known.follow()
    check_bound(setting, form.names, form.names, known)
    return known


def _moved(setting: Setting, value: Element) -> Element:
    """What time and inputs change of a constraint by themselves."""
    return explicit_rate(setting, value, "a coordinate that constraints give")


def check_bound(
    setting: Setting, names: Sequence[str], along: Sequence[str], known: Constraints
) -> None:
    """There is one motion through each point that constraints leave, and these are as declared.

    Args:
        setting: The spec and its field.
        names: The components of x.
        along: What the unknowns u are the velocities of.
        known: The constraints, followed to their end.

    Raises:
        DerivationError: There is no motion, or it is not determined, or a constraint cannot be
            solved; or what follows is not what the spec declares to follow.
    """
    if known.unsolved is not None:
        text = f"{element_text(setting.field, known.unsolved)} = 0"
        problem = f"the motion is bound to {text}, in which no component has a factor {FACTOR}"
        hint = "Solve it by hand, and write what it gives in the Lagrangian."
        if known.is_contradicted():
            problem, hint = f"no motion satisfies {text}", "Correct the Lagrangian."
        raise _refuse(setting, names, known, problem, hint)
    if free := known.free:
        given = " and ".join(write_direction(setting.field, along, each) for each in free)
        given = given if along == names else given.replace("d/d", "")  # names of velocities
        hint = "Add the term that determines it, or leave that combination out."
        raise _refuse(setting, names, known, f"nothing gives the velocity along {given}", hint)
    longest = max(len(columns) for _, columns in known.groups)
    if longest > LARGEST:
        problem = f"its equations couple {longest} rates; expected at most {LARGEST}"
        hint = "Choose coordinates that decouple them."
        raise _refuse(setting, names, known, problem, hint)
    if len(known.bound) == len(names):
        problem, hint = "constraints give all of it, and nothing moves", "Correct the Lagrangian."
        raise _refuse(setting, names, known, problem, hint)
    _check_declared(setting, names, known)


def _check_declared(setting: Setting, names: Sequence[str], known: Constraints) -> None:
    """What follows is what the spec declares to follow."""
    declared = {name for name in names if name not in setting.state}
    more, less = sorted(known.bound.keys() - declared), sorted(declared - known.bound.keys())
    hint = _advise_following(setting, known)
    if more:
        raise _refuse(setting, names, known, f"constraints give {', '.join(more)}", hint)
    if less:
        raise _refuse(setting, names, known, f"no constraint gives {', '.join(less)}", hint)


def _advise_following(setting: Setting, known: Constraints) -> str:
    """What the spec would declare to follow."""
    advice = []
    for each in setting.spec.variables:
        given = [name for name in each.components if name in known.bound]
        declared = [name for name in each.components if name not in setting.state]
        if each.role == "velocity" or given == declared:
            continue
        if not given:
            advice.append(f"Remove follows of {each.name}.")
        else:
            texts = ", ".join(f'"{name}"' for name in given)
            value = "true" if len(given) == len(each.components) else f"[{texts}]"
            advice.append(f"Write follows = {value} for {each.name}.")
    return " ".join(advice)


def _refuse(
    setting: Setting, names: Sequence[str], known: Constraints, problem: str, hint: str
) -> DerivationError:
    """The error, with all steps."""
    state = ", ".join(names)
    message = (
        f"the Lagrangian does not determine the rates of a state of {state}: {problem}. "
        f"Constraints in their order: {known.chain}. {hint}"
    )
    return lagrangian_fault(setting, message, state)


def write_direction(field: Field, names: Sequence[str], vector: Row) -> str:
    """A direction of x: ``d/dx + (-y) d/dz``."""
    parts = zip(names, vector, strict=True)
    return " + ".join(
        f"d/d{name}" if x == 1 else f"({element_text(field, x)}) d/d{name}"
        for name, x in parts
        if x
    )
