"""Constraints: the tables of a constrained motion, read in the scopes of their formulas.

Comes in: the validated tables [constraints], [forces], [dissipation], [domain] and [momenta]. Goes
out: records of `coadjoint.spec.sections.constrained`. Which velocities a constraint gives is found
before there are variables, since that decides what the state is.
Read next: `coadjoint.derive.mechanics.distribution`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from coadjoint.errors import CoadjointError
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError, did_you_mean, listed
from coadjoint.spec.core.formulas import DRIVING, Quantity, Scope, make_scope, read_formula
from coadjoint.spec.core.names import refusal
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.relations import EQUATION, INEQUALITIES, read_relation
from coadjoint.spec.core.shapes import words
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.tree import Index, Name, Node, walk
from coadjoint.spec.model import Formula, Variable
from coadjoint.spec.routes import is_in_frame
from coadjoint.spec.schema import SpecFile
from coadjoint.spec.sections.constrained import (
    Condition,
    Constraint,
    Relaxation,
    Section,
    reaction_shapes,
)
from coadjoint.spec.sections.quantities import state_of

_COMPONENT = re.compile(r"(?P<name>.*?)_?\d+(_\d+)?")
_SIDES = 2


def solved_velocities(file: SpecFile) -> Mapping[str, tuple[str, int]] | None:
    """The velocities that constraints give, each with its constraint and the side it stands on.

    A constraint gives a velocity if one side is that velocity alone and the other one does not
    depend on it, also not through velocities that earlier constraints give.

    Args:
        file: The validated tables; formulas that cannot be read yet are passed over.

    Returns:
        Constraint and side (1 for left, -1 for right) by velocity; None where the state has none
        along a frame.
    """
    if not is_in_frame(file):
        return None
    velocities = {name for name, part in file.variables.items() if part.role == "velocity"}
    found: dict[str, tuple[str, int]] = {}
    reached: dict[str, set[str]] = {}
    for constraint, text in (file.constraints or {}).items():
        sides = [_parsed(side, file) for side in text.split("==")]
        if len(sides) != _SIDES:
            continue
        left, right = sides
        for own, other, sign in ((left, right, 1), (right, left, -1)):
            free = isinstance(own, Name) and own.name in velocities - set(found)
            if not isinstance(own, Name) or not free or other is None:
                continue
            names = _names(other, file) & velocities
            names = names.union(*(reached[name] for name in names if name in reached))
            if own.name not in names:
                found[own.name] = constraint, sign
                reached = {
                    name: {*rest, *names} if own.name in rest else rest
                    for name, rest in reached.items()
                }
                reached[own.name] = names
                break
    return found


def _parsed(text: str, file: SpecFile) -> Node | None:
    """A tree that may call the definitions with arguments; None where it cannot be read yet."""
    called = [key.split("(")[0].strip() for key in file.definitions if "(" in key]
    try:
        return read_expression(text, called)
    except ExpressionError:
        return None


def _names(node: Node, file: SpecFile) -> set[str]:
    """Variables that an expression names, whole or by component, also through definitions."""
    defined = {key.split("(")[0].strip(): text for key, text in file.definitions.items()}
    pending, seen, found = [node], set[str](), set[str]()
    while pending:
        for part in walk(pending.pop()):
            name = str(getattr(part, "name", "") or getattr(part, "function", ""))
            if name in defined and name not in seen:
                seen.add(name)
                inner = _parsed(defined[name], file)
                pending += [] if inner is None else [inner]
            elif isinstance(part, Name | Index):
                match = _COMPONENT.fullmatch(name)
                found |= {name, match["name"]} if match else {name}
    return found


class ConstraintReader:
    """The tables of a constrained motion.

    Args:
        source: The text of the spec.
        file: Its tables.
        variables: All variables.
        quantities: Variables, parameters, inputs, time and definitions.
    """

    def __init__(
        self,
        source: Source,
        file: SpecFile,
        variables: Sequence[Variable],
        quantities: Sequence[Quantity],
    ) -> None:
        self.source, self.file = source, file
        self.variables, self.quantities = variables, quantities
        roles = (variable.role for variable in variables)
        self.motion = tuple(dict.fromkeys(("velocity", *roles)))
        self.velocities = {each.name: each for each in variables if each.role == "velocity"}

    def constraints(self) -> tuple[Constraint, ...]:
        """The constraints in declared order.

        Raises:
            SpecError: One is no equation between velocities, or beside them stands what a
                constrained motion does not have.
        """
        if is_in_frame(self.file):
            _check_unasked(self.source, self.file)
        solved = {
            name: (velocity, sign)
            for velocity, (name, sign) in (solved_velocities(self.file) or {}).items()
        }
        scope = make_scope("a constraint", self.motion, self.quantities, driven=DRIVING)
        found = []
        for name, text in (self.file.constraints or {}).items():
            key: KeyPath = ("constraints", name)
            left, _, right = read_relation(self.source, key, text, EQUATION, scope)
            found.append(Constraint(name, left, right, *solved.get(name, ())))
        return tuple(found)

    def forces(self) -> dict[str, Formula]:
        """The declared forces by what they act along.

        Raises:
            SpecError: There is no such variable, a momentum is named whose velocity has a
                Lagrangian, or the force has another shape.
        """
        scope = make_scope("a force", self.motion, self.quantities, driven=DRIVING)
        return {
            name: self._along(("forces", name), text, scope, self._forced)
            for name, text in self.file.forces.items()
        }

    @property
    def _forced(self) -> Mapping[str, Variable]:
        """What forces may act along: velocities, and what only a Hamiltonian moves.

        With a Lagrangian a force along a velocity says what it does; with a Hamiltonian momenta
        and the coordinates of a declared bracket may have no velocities.
        """
        roles = {"velocity"}
        if self.file.lagrangian is None:
            roles |= {"momentum"}
            roles |= {"coordinate"} if self.file.poisson is not None else set()
        return {each.name: each for each in self.variables if each.role in roles}

    def dissipation(self) -> Formula | None:
        """Rayleigh's function.

        Raises:
            SpecError: It is no formula of velocities.
        """
        if self.file.dissipation is None:
            return None
        key: KeyPath = ("dissipation", "R")
        scope = make_scope("a dissipation", self.motion, self.quantities, driven=DRIVING)
        formula = read_formula(self.source, key, self.file.dissipation.R, scope)
        owners = {part: each.name for each in self.velocities.values() for part in each.components}
        named = {getattr(node, "name", "") for node in walk(formula.tree)}
        if not named & {*owners, *owners.values()}:
            raise self.source.fault(
                key,
                "Rayleigh's function names no velocity",
                found=self.file.dissipation.R,
                expected="a function of velocities, whose force is -dR/dxi",
                hint="Declare velocities, or write what acts along a momentum in [forces]."
                if self.file.reduction is None
                else "Write what acts along a momentum in [forces].",
            )
        return formula

    def relaxation(self) -> Relaxation | None:
        """Dissipation by a symmetric bracket.

        Raises:
            SpecError: There are two, the state has velocities, or G has another size than it.
        """
        if self.file.double_bracket is not None and self.file.metriplectic is not None:
            raise self.source.fault(
                ("metriplectic",),
                "there are both [double_bracket] and [metriplectic]",
                found="metriplectic",
                expected="one of them: the first keeps Casimirs, the second the energy",
                hint="Remove [metriplectic] or [double_bracket].",
            )
        table = "double_bracket" if self.file.double_bracket is not None else "metriplectic"
        part = getattr(self.file, table)
        if part is None:
            return None
        moving = [each for each in state_of(self.variables) if each.role == "velocity"]
        if moving:
            name, of = moving[0].name, moving[0].of or "q"
            raise self.source.fault(
                (table,),
                f"the state has the velocity {name!r}, and G acts by the bracket of momenta",
                found=name,
                expected="momenta in the state",
                hint=f'Declare them, as in p = {{ role = "momentum", of = "{of}" }}.',
            )
        key: KeyPath = (table, "G")
        scope = make_scope("a metric", self.motion, self.quantities, driven=DRIVING)
        G = read_formula(self.source, key, part.G, scope, any_shape=True)
        size = sum(len(each.components) for each in state_of(self.variables))
        if G.shape not in ((), (size, size)):
            raise self.source.fault(
                key,
                f"G is {words(G.shape)}",
                found=words(G.shape),
                expected=f"a number, or a {size} x {size} matrix with a row for each component of "
                "the state",
            )
        if table == "double_bracket":
            return Relaxation(G)
        scope = make_scope("an entropy", self._fixed_state, self.quantities)
        return Relaxation(G, read_formula(self.source, (table, "S"), part.S, scope))

    @property
    def _fixed_state(self) -> tuple[str, ...]:
        """Roles of the state."""
        return tuple(dict.fromkeys(each.role for each in state_of(self.variables)))

    def domain(self, constraints: Sequence[Constraint]) -> tuple[Condition, ...]:
        """The declared inequalities, which may name reactions: a body leaves the plane.

        Args:
            constraints: Those whose reactions may be named.

        Raises:
            SpecError: One is no inequality between scalars, or has a name that none may have.
        """
        reactions = reaction_shapes(constraints)
        scope = make_scope("a condition", self.motion, self.quantities, reactions, driven=DRIVING)
        found = []
        for name, text in self.file.domain.items():
            key: KeyPath = ("domain", name)
            refused = refusal(name)  # a label of rows alone: a variable may have the same name
            if refused is not None:
                problem, expected, hint = refused
                at = self.source.positions.key(key)
                raise self.source.fault(
                    key, problem, found=name, expected=expected, hint=hint, at=at
                )
            left, sign, right = read_relation(self.source, key, text, INEQUALITIES, scope)
            if left.shape:
                raise self.source.fault(
                    key,
                    f"both sides are {words(left.shape)}",
                    found=text,
                    expected="two scalars",
                )
            found.append(Condition(name, left, sign, right))
        return tuple(found)

    def sections(self) -> tuple[Section, ...]:
        """The declared sections, each a formula for every velocity that it names.

        Raises:
            SpecError: There is no such independent velocity, or a shape differs.
        """
        scope = make_scope("a section", self._fixed, self.quantities)
        independent = {name: v for name, v in self.velocities.items() if v.independent}
        return tuple(
            Section(
                name,
                {
                    velocity: self._along(
                        ("momenta", name, "section", velocity), text, scope, independent
                    )
                    for velocity, text in part.section.items()
                },
                part.unit,
                part.doc,
            )
            for name, part in self.file.momenta.items()
        )

    @property
    def _fixed(self) -> tuple[str, ...]:
        """Roles of what positions know: not the velocities."""
        return tuple(role for role in self.motion if role != "velocity") or ("advected",)

    def _along(
        self, key: KeyPath, text: str, scope: Scope, velocities: Mapping[str, Variable]
    ) -> Formula:
        """A formula of the shape of the velocity that its key names."""
        name = str(key[-1])
        if name not in velocities:
            raise self._no_velocity(key, name, velocities)
        formula = read_formula(self.source, key, text, scope, any_shape=True)
        wanted = velocities[name].shape
        if formula.shape != wanted:
            raise self.source.fault(
                key,
                f"the value is {words(formula.shape)}",
                found=words(formula.shape),
                expected=f"{words(wanted)}, as {name!r} is",
            )
        return formula

    def _no_velocity(
        self, key: KeyPath, name: str, velocities: Mapping[str, Variable]
    ) -> CoadjointError:
        roles = {each.role for each in velocities.values()} or {"velocity"}
        what = "velocity" if roles == {"velocity"} else "variable"
        return self.source.fault(
            key,
            f"there is no such {what} as {name!a}",
            found=name,
            expected=f"one of {listed(velocities)}" if velocities else "a declared velocity",
            hint=did_you_mean(name, velocities),
            at=self.source.positions.key(key),
        )


def _check_unasked(source: Source, file: SpecFile) -> None:
    """Nothing is asked of a constrained motion that rests on a Poisson bracket.

    Raises:
        SpecError: Something is, with what to declare instead.
    """
    asked: dict[KeyPath, tuple[str, bool]] = {
        ("claims", "casimirs"): ("claims of Casimirs", bool(file.claims.casimirs)),
        ("claims", "brackets"): ("claims of brackets", bool(file.claims.brackets)),
        ("symmetries",): ("[symmetries]", bool(file.symmetries)),
        ("transformations",): ("[transformations]", bool(file.transformations)),
    }
    for key, (what, there) in asked.items():
        if there:
            raise source.fault(
                key,
                f"there are {what} beside [constraints]",
                found=key[-1],
                expected="none, since the bracket of a constrained motion is almost-Poisson and "
                "symmetries need not keep their momenta",
                hint="Declare momenta along the constraints in [momenta], and name what is "
                "conserved in claims.conserved.",
            )
