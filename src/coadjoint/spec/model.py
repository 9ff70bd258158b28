"""The Spec: what a person declared, read, validated and parsed; the first record that travels.

Comes in: the parts checked by `coadjoint.spec.reader`. Goes out: a frozen record with no text in
it that later steps would have to parse. Free text (title, source, docs) is carried for documents
and JSON only and never reaches a template, a C file or a Python file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

from coadjoint.algebra.catalogue import ATTITUDES, inverse_by
from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.algebra.representation import Representation
from coadjoint.spec.core.components import FORMS, Shape, component_names, matrix_size, unpacked
from coadjoint.spec.core.tree import Name, Node, walk
from coadjoint.spec.sections.constrained import (
    Condition,
    Constraint,
    Reconstructed,
    ReducedMomentum,
    Relaxation,
    Rolling,
    Section,
)
from coadjoint.spec.sections.quantities import Input, Parameter, Time, Variable, state_of

__all__ = [
    "FORMS",
    "ClaimedBracket",
    "Condition",
    "Constraint",
    "Definition",
    "Force",
    "Formula",
    "Input",
    "Integral",
    "Lax",
    "Observable",
    "Parameter",
    "Poisson",
    "Reconstructed",
    "ReducedMomentum",
    "Relaxation",
    "Rolling",
    "Section",
    "Shape",
    "Spec",
    "Symmetry",
    "Time",
    "Transformation",
    "Variable",
    "component_names",
    "matrix_size",
    "state_of",
    "unpacked",
]


@dataclass(frozen=True)
class Formula:
    """A parsed expression, its text as typed (for messages and documents) and where it stands.

    Attributes:
        text: As typed, ASCII; used in messages, JSON and documents only.
        tree: The parsed, shape-checked tree.
        shape: Shape of its value.
        key: Dotted key in the spec, e.g. ``lagrangian.l``.
        line: Line of the text in the file, counted from 1.
    """

    text: str
    tree: Node
    shape: Shape
    key: str
    line: int

    @property
    def in_one_line(self) -> str:
        """The text without its line breaks, for statements and tables."""
        return " ".join(self.text.split())


@dataclass(frozen=True)
class Definition:
    """A short name for an expression, put in as a tree wherever it occurs.

    Attributes:
        name: As declared, ``V`` of ``V(s, d)``.
        arguments: Names of its arguments; empty if it takes none.
        text: The expression as typed.
        tree: The parsed expression, with earlier definitions put in.
        shape: Shape of its value; None with arguments, whose shapes only a call has.
    """

    name: str
    arguments: tuple[str, ...]
    text: str
    tree: Node
    shape: Shape | None

    @property
    def signature(self) -> str:
        """How it is called: ``V(s, d)``."""
        return f"{self.name}({', '.join(self.arguments)})" if self.arguments else self.name

    @property
    def in_one_line(self) -> str:
        """The expression without its line breaks, for documents."""
        return " ".join(self.text.split())


@dataclass(frozen=True)
class Observable:
    """A declared scalar, vector or matrix emitted beside the dynamics."""

    name: str
    formula: Formula
    unit: str = "1"
    doc: str = ""

    @property
    def shape(self) -> Shape:
        """Shape of its value."""
        return self.formula.shape

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, row by row."""
        return component_names(self.name, self.shape)


@dataclass(frozen=True)
class Integral:
    """A claimed integral of the motion: everywhere, or where some functions vanish.

    Attributes:
        formula: What is conserved, of any shape; it may name the energy and observables.
        where: The functions that are zero on the level set; empty for an integral everywhere.
    """

    formula: Formula
    where: tuple[Formula, ...] = ()

    @property
    def name(self) -> str:
        """The name that is claimed to be conserved everywhere; "" for another formula."""
        tree = self.formula.tree
        return tree.name if isinstance(tree, Name) and not self.where else ""


@dataclass(frozen=True)
class Poisson:
    """A declared Poisson bracket of the coordinates.

    Attributes:
        kind: ``"nambu"``, ``"brackets"`` or ``"canonical"``.
        functions: The n - 2 distinguished functions of a Nambu bracket, else empty.
        entries: ``(i, j, {x_i, x_j})`` by places among the components of the state, each pair once:
            the declared brackets, or the magnetic terms of a canonical one.
        pairs: ``(i, j)`` of a position and its momentum of a canonical bracket, else empty.
        weights: ``{x_i, x_j}`` of each pair: 1, but 1/2 for an entry of symmetric matrices beside
            the diagonal, since there the pairing is ``tr(P dS/dt)``, which counts it twice.
    """

    kind: str
    functions: tuple[Formula, ...] = ()
    entries: tuple[tuple[int, int, Formula], ...] = ()
    pairs: tuple[tuple[int, int], ...] = ()
    weights: tuple[Fraction, ...] = ()


@dataclass(frozen=True)
class Lax:
    """A declared Lax pair: ``dL/dt = [L, M]`` for every value of the spectral parameter."""

    spectral: str
    L: Formula
    M: Formula


@dataclass(frozen=True)
class Force:
    """Newton's law of one coordinate: ``mass * acceleration = force``."""

    coordinate: str
    mass: Formula
    force: Formula


@dataclass(frozen=True)
class Symmetry:
    """An infinitesimal action, whose momentum map is emitted beside the dynamics.

    Attributes:
        name: Of the momentum map.
        algebra: What acts.
        element: Name of its generic element in the formulas; "" if they are none.
        as_matrix: Whether the element is a matrix there, not the vector of its coefficients.
        generators: How variables move, by name.
        linear: Variables on whose stacked components the matrices of the algebra act.
        time: How time moves, or None.
        map: The momentum map paired with the element, where it is declared, or None.
        side: ``"left"`` or ``"right"``.
        form: One of `FORMS` if the components are the entries of a matrix, else "".
        unit: Unit text of the momentum map.
        doc: Free text for documents.
    """

    name: str
    algebra: LieAlgebra
    element: str = ""
    as_matrix: bool = False
    generators: Mapping[str, Formula] = field(default_factory=dict)
    linear: tuple[str, ...] = ()
    time: Formula | None = None
    map: Formula | None = None
    side: str = "left"
    form: str = ""
    unit: str = "1"
    doc: str = ""

    @property
    def shape(self) -> Shape:
        """Shape of the components as they are kept: the whole matrix, or a list."""
        if self.form == "matrix":
            return self.value_shape
        return (self.algebra.dimension,) if self.algebra.dimension > 1 or self.form else ()

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, one for each basis vector."""
        return component_names(self.name, self.shape, "" if self.form == "matrix" else self.form)

    @property
    def value_shape(self) -> Shape:
        """Shape in formulas: that of the whole matrix where there is a form."""
        size = matrix_size(self.algebra.dimension, self.form) if self.form else None
        return self.shape if size is None else (size, size)


@dataclass(frozen=True)
class SpatialMomentum:
    """A momentum as seen from space, emitted where the state has the attitude: ``Pi_spatial``.

    Attributes:
        momentum: What it is in the body.
        conserved: Whether the energy knows nothing that is advected and no force acts, so that it
            stays what it is.
    """

    momentum: Variable
    conserved: bool

    @property
    def name(self) -> str:
        """Name of the observable."""
        return f"{self.momentum.name}_spatial"

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, along the basis of the algebra."""
        return component_names(self.name, self.momentum.shape, self.momentum.form)


@dataclass(frozen=True)
class Transformation:
    """A map of the state that keeps the motion.

    Attributes:
        name: As declared.
        map: What variables become; those left out stay.
        reverses_time: Whether the motion becomes its reverse.
        exchanges: What observables and momentum maps become.
    """

    name: str
    map: Mapping[str, Formula]
    reverses_time: bool
    exchanges: Mapping[str, Formula]


@dataclass(frozen=True)
class ClaimedBracket:
    """``{left, right} = value``, of scalars or vectors."""

    left: Formula
    right: Formula
    value: Formula


@dataclass(frozen=True)
class Reduction:
    """A submanifold of a system, on which some of its variables follow from the others.

    Attributes:
        whole: The system before.
        section: What these variables are, by name.
        where: Functions of all variables that vanish on the submanifold.
    """

    whole: Spec
    section: Mapping[str, Formula]
    where: tuple[Formula, ...] = ()


@dataclass(frozen=True)
class Spec:
    """One declared system.

    Attributes:
        name: The file's stem; also the name of the generated module and the prefix of C functions.
        title: Free text, like ``source`` and ``description``; for documents only.
        license: SPDX expression of the spec's own licence, or "".
        routes: Routes to derive by; the first is emitted, the others are proved equal to it.
        algebra: The Lie algebra of the velocities; None without one.
        poisson: The declared bracket of the coordinates; None where there is an algebra, or where
            coordinates have velocities or momenta and nothing else is said.
        invariance: ``"left"`` (body, and without an algebra) or ``"right"`` (space).
        variables: Velocities, momenta, advected quantities or coordinates in declared order.
        parameters: Constants in declared order.
        lagrangian: l of the velocities and advected quantities, or None.
        hamiltonian: h of the state, or None.
        observables: Declared scalars, vectors and matrices in order.
        casimirs: Claimed Casimirs of the bracket, scalars or vectors of them.
        conserved: Claimed integrals of the motion, some of them on a level set alone.
        path: File the spec was read from, for messages only.
        sha256: Hash of the file's bytes.
        lax: The declared Lax pair, or None.
        newton: Declared forces, one for each coordinate; empty if none.
        clebsch: How the algebra acts on a pair of its own of the route clebsch, or None.
        definitions: Short names in declared order; formulas hold them no more.
        symmetries: Declared actions; their momentum maps are emitted after the observables.
        transformations: Maps that are claimed to keep the motion.
        brackets: Claimed brackets of observables, momentum maps and state.
        galilean: Whether Newton's law is claimed to be that of every Galilean observer.
        reduction: The submanifold to which a motion is restricted, whose state this is, or None.
        constraints: Equations between velocities; empty for motions that are free.
        forces: What acts beside the energy, by the name of the velocity that it works on, or of the
            momentum or coordinate to whose rate it is added.
        dissipation: Rayleigh's function R, whose force is ``-dR/dxi``, or None.
        domain: Where the system is defined, as far as declared.
        relaxation: Dissipation by a symmetric bracket, or None.
        rolling: How the body rolls on a plane, if it does.
        reconstruction: Variables that follow from the motion.
        sections: Sections of the constraint distribution with their momenta.
        accepted: Keys of the claims for which support by numbers is enough, such as
            ``("claims", "conserved", 0)``; brackets by their places.
        inputs: What drives the system from outside, in declared order.
        time: The time, if formulas name it.
    """

    name: str
    title: str
    source: str
    description: str
    license: str
    routes: tuple[str, ...]
    algebra: LieAlgebra | None
    poisson: Poisson | None
    invariance: str
    variables: tuple[Variable, ...]
    parameters: tuple[Parameter, ...]
    lagrangian: Formula | None
    hamiltonian: Formula | None
    observables: tuple[Observable, ...]
    casimirs: tuple[Formula, ...]
    conserved: tuple[Integral, ...]
    path: Path
    sha256: str
    lax: Lax | None = None
    newton: tuple[Force, ...] = ()
    clebsch: Representation | None = None
    definitions: tuple[Definition, ...] = ()
    symmetries: tuple[Symmetry, ...] = ()
    transformations: tuple[Transformation, ...] = ()
    brackets: tuple[ClaimedBracket, ...] = ()
    galilean: bool = False
    reduction: Reduction | None = None
    constraints: tuple[Constraint, ...] = ()
    forces: Mapping[str, Formula] = field(default_factory=dict)
    dissipation: Formula | None = None
    domain: tuple[Condition, ...] = ()
    relaxation: Relaxation | None = None
    rolling: Rolling | None = None
    reconstruction: tuple[Reconstructed, ...] = ()
    sections: tuple[Section, ...] = ()
    accepted: frozenset[tuple[str | int, ...]] = frozenset()
    inputs: tuple[Input, ...] = ()
    time: Time | None = None

    def having_role(self, role: str) -> tuple[Variable, ...]:
        """The variables of one role, in declared order."""
        return tuple(variable for variable in self.variables if variable.role == role)

    @property
    def state(self) -> tuple[Variable, ...]:
        """The state of the kernels, in declared order: what is no velocity that another gives.

        Velocities follow from momenta; only where a coordinate has no momentum is its velocity
        part of the state. Under constraints, those velocities are that no constraint gives.
        """
        return state_of(self.variables)

    @property
    def driving(self) -> tuple[Input | Time, ...]:
        """What kernels take after the parameters: the inputs, then the time."""
        return (*self.inputs, *([] if self.time is None else [self.time]))

    @property
    def defined(self) -> tuple[Variable, ...]:
        """The velocities that follow from the state, emitted beside the dynamics."""
        state = self.state
        return tuple(each for each in self.having_role("velocity") if each not in state)

    def partner(self, role: str, coordinate: str) -> Variable | None:
        """The velocity or momentum of a coordinate; None if none is declared."""
        found = (variable for variable in self.having_role(role) if variable.of == coordinate)
        return next(found, None)

    @property
    def attitude(self) -> Variable | None:
        """The group element in the state, as a matrix or a unit quaternion; None without one."""
        advected = ((v, v.representation) for v in self.having_role("advected"))
        return next((v for v, action in advected if action and action.name in ATTITUDES), None)

    @property
    def spatial(self) -> tuple[SpatialMomentum, ...]:
        """The momenta seen from space; empty without an attitude that can be inverted."""
        if self.attitude is None or self.algebra is None:
            return ()
        if self.attitude.form != "quaternion" and not inverse_by(self.algebra):
            return ()
        advected = self.having_role("advected")
        names = {name for each in advected for name in (each.name, *each.components)}
        energies = [f.tree for f in (self.lagrangian, self.hamiltonian) if f is not None]
        used = {getattr(node, "name", "") for tree in energies for node in walk(tree)}
        momenta = self.having_role("momentum")
        free = not names & used and not self.is_driven
        return tuple(SpatialMomentum(each, free) for each in momenta)

    @property
    def reduced_momenta(self) -> tuple[ReducedMomentum, ...]:
        """The momenta of the independent velocities; empty where momenta are the state."""
        moving = [each for each in self.state if each.role == "velocity"]
        return tuple(map(ReducedMomentum, moving)) if self.in_frame else ()

    @property
    def is_driven(self) -> bool:
        """Whether anything acts beside the energy: forces or dissipation of any kind."""
        return self.is_forced or self.relaxation is not None

    @property
    def is_forced(self) -> bool:
        """Whether forces act, or friction by Rayleigh's function."""
        return bool(self.forces) or self.dissipation is not None

    @property
    def in_frame(self) -> bool:
        """Whether the state has velocities along a frame, which constraints may bind."""
        return any(variable.independent is not None for variable in self.variables)

    @property
    def kind(self) -> str:
        """``algebra``, ``poisson`` or ``configuration``: what the motion is declared on."""
        if self.algebra is not None:
            return "algebra"
        return "poisson" if self.poisson is not None else "configuration"
