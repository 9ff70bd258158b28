"""The Spec: what a person declared, read, validated and parsed; the first record that travels.

Comes in: the records of the tables, each from its own module of `coadjoint.spec.sections`. Goes
out: a frozen record with no text in it that later steps would have to parse. Free text (title,
source, docs) is carried for documents and JSON only and never reaches a template, a C file or a
Python file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from coadjoint.algebra.catalogue import ATTITUDES
from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.algebra.representation import Representation
from coadjoint.families import Index
from coadjoint.spec.core.components import (
    FORMS,
    Components,
    Shape,
    component_names,
    matrix_size,
    unpack,
)
from coadjoint.spec.core.definitions import Definition
from coadjoint.spec.core.dimensions import KnownUnits
from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.source import Place
from coadjoint.spec.sections.claims import ClaimedBracket, Integral
from coadjoint.spec.sections.constraints import Constraint
from coadjoint.spec.sections.diffeomorphisms import Diffeomorphisms
from coadjoint.spec.sections.domain import Condition
from coadjoint.spec.sections.inputs import Input
from coadjoint.spec.sections.lax import Lax
from coadjoint.spec.sections.momenta import Section
from coadjoint.spec.sections.newton import Force
from coadjoint.spec.sections.noise import Noise
from coadjoint.spec.sections.observables import Observable
from coadjoint.spec.sections.parameters import Parameter
from coadjoint.spec.sections.poisson import Poisson
from coadjoint.spec.sections.reconstruction import Reconstructed
from coadjoint.spec.sections.reduction import Submanifold
from coadjoint.spec.sections.relaxation import Relaxation
from coadjoint.spec.sections.rolling import Rolling
from coadjoint.spec.sections.space import Jet, Space
from coadjoint.spec.sections.state import Variable, find_defined, state_of
from coadjoint.spec.sections.symmetries import Symmetry
from coadjoint.spec.sections.time import Time
from coadjoint.spec.sections.transformations import Transformation

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
    "Jet",
    "Lax",
    "Noise",
    "Observable",
    "Parameter",
    "Poisson",
    "Reconstructed",
    "Reduction",
    "Relaxation",
    "Rolling",
    "Section",
    "Shape",
    "Space",
    "Spec",
    "Symmetry",
    "Time",
    "Transformation",
    "Variable",
    "component_names",
    "matrix_size",
    "state_of",
    "unpack",
]


@dataclass(frozen=True)
class DerivedMomentum(Components):
    """A momentum that is emitted for a variable, with components named like those of it.

    Attributes:
        name: ``Omega_momentum`` along a distribution, ``Pi_spatial`` as seen from space.
        shape: That of the variable.
        of: The variable: an independent velocity, or the momentum in the body.
        form: That of the variable.
        conserved: Whether the energy knows nothing that is advected and no force acts on it, so
            that a momentum in space stays what it is.
    """

    name: str
    shape: Shape
    of: Variable
    form: str = ""
    conserved: bool = False


def derive_momentum(of: Variable, ending: str, *, conserved: bool = False) -> DerivedMomentum:
    """The momentum that is emitted for a variable, under its name with an ending."""
    return DerivedMomentum(
        name=f"{of.name}_{ending}", shape=of.shape, form=of.form, of=of, conserved=conserved
    )


@dataclass(frozen=True)
class Reduction(Submanifold):
    """A submanifold of a system, with the system before.

    Attributes:
        whole: The system before.
    """

    whole: Spec = field(kw_only=True)


@dataclass(frozen=True)
class Windows:
    """What is known of a system of equal members apart from a few of them.

    Attributes:
        index: The index, with its size if that is known.
        variables: Names of the variables of the state that each member has, in declared order.
        shared: Names of the parameters that all members share.
        indexed: Names of the parameters that each member has.
        shared_inputs: Names of the inputs that all members share.
        indexed_inputs: Names of the inputs that each member has.
        shared_noise: Names of the Wiener processes that move all members.
        indexed_noise: Names of those of which each member has one of its own.
        defaults: Defaults of quantities that differ from member to member: of each
            component those of all members.
        repeating: Names of those that have a default for some members, which are taken again.
        reach: How many members further the energy couples.
        alone: How many members at the beginning and at the end of an open chain stand alone in the
            energy or in what else acts.
        pairs: Whether it couples every two members.
        least: The number of members from which on the claims are proved.
        windows: The spec written out for two or three numbers of members, the smallest first.
        of_members: The claims of what each member conserves, as statements.
        lax: The spec and its Lax pair, written out for all numbers of members from the least one
            to that at which both ends of the matrices keep apart.
        loaded: The spec written out for all members, with the claims that are not proved for every
            number of them; None without such claims.
        truncation: Of entries of matrices on a surface the inertia, as text; else "".
    """

    index: Index
    variables: tuple[str, ...]
    shared: tuple[str, ...]
    indexed: tuple[str, ...]
    defaults: Mapping[str, tuple[tuple[Fraction, ...], ...]]
    repeating: tuple[str, ...]
    reach: int
    alone: tuple[int, int]
    pairs: bool
    least: int
    windows: tuple[Spec, ...]
    shared_inputs: tuple[str, ...] = ()
    indexed_inputs: tuple[str, ...] = ()
    shared_noise: tuple[str, ...] = ()
    indexed_noise: tuple[str, ...] = ()
    of_members: frozenset[str] = frozenset()
    loaded: Spec | None = None
    lax: tuple[tuple[Spec, Lax], ...] = ()
    truncation: str = ""

    @property
    def ends(self) -> tuple[int, int]:
        """How many members at the beginning and at the end of a chain have rates of their own."""
        if self.index.periodic:
            return 0, 0
        return max(self.reach, self.alone[0]), max(self.reach, self.alone[1])


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
        clebsch: How the algebra acts on the further pair of the route clebsch, or None.
        definitions: Short names in declared order; formulas hold them no more.
        symmetries: Declared actions; their momentum maps are emitted after the observables.
        transformations: Maps that are claimed to keep the motion.
        brackets: Claimed brackets of observables, momentum maps and state.
        galilean: Where Newton's law is claimed to be that of every Galilean observer.
        reduction: The submanifold to which a motion is restricted, whose state this is, or None.
        constraints: Equations between velocities; empty for motions that are free.
        variational: Equations between velocities that are imposed before the variation.
        forces: What acts in addition to the energy, by the name of the velocity that it works on,
            or of the momentum or coordinate to whose rate it is added.
        dissipation: Rayleigh's function R, whose force is ``-dR/dxi``, or None.
        domain: Where the system is defined, as far as declared.
        relaxation: Dissipation by a symmetric bracket, or None.
        noise: Wiener processes with Hamiltonians of their own.
        rolling: How the body rolls on a plane, if it does.
        reconstruction: Variables that follow from the motion.
        sections: Sections of the constraint distribution with their momenta.
        accepted: Keys of the claims for which support by numbers is enough, such as
            ``("claims", "conserved", 0)``; brackets by their places.
        inputs: What drives the system from outside, in declared order.
        time: The time, if formulas name it.
        clock: The independent variable, also where no formula names it.
        records: What tables gave that have no attribute here, by their keys.
        index: The index that counts equal members, in a spec with one.
        space: The coordinate along which variables are fields, or None.
        diffeomorphisms: The group of motions of the circle itself, or None.
        profiles: The fields at the beginning, by the names of variables.
        family: What is known of the other members, where a few stand for all of them.
        written: Why all members are written out, in a spec with an index; else "".
        units: The units of all names, as far as the spec tells them.
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
    galilean: Place | None = None
    reduction: Reduction | None = None
    constraints: tuple[Constraint, ...] = ()
    variational: tuple[Constraint, ...] = ()
    forces: Mapping[str, Formula] = field(default_factory=dict)
    dissipation: Formula | None = None
    domain: tuple[Condition, ...] = ()
    relaxation: Relaxation | None = None
    noise: tuple[Noise, ...] = ()
    rolling: Rolling | None = None
    reconstruction: tuple[Reconstructed, ...] = ()
    sections: tuple[Section, ...] = ()
    accepted: frozenset[tuple[str | int, ...]] = frozenset()
    inputs: tuple[Input, ...] = ()
    time: Time | None = None
    clock: Time = field(default=Time("t"))
    records: Mapping[str, Any] = field(default_factory=dict)
    index: tuple[Index, ...] = ()
    space: Space | None = None
    diffeomorphisms: Diffeomorphisms | None = None
    profiles: Mapping[str, Formula] = field(default_factory=dict)
    family: Windows | None = field(default=None, repr=False)
    written: str = ""
    units: KnownUnits = field(default=KnownUnits({}, {}), repr=False)

    def __repr__(self) -> str:
        on = self.algebra.name if self.algebra is not None else self.kind
        return f"<Spec {self.name}: {self.title!r} on {on}, routes {', '.join(self.routes)}>"

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        from coadjoint.notebook import show_spec

        return show_spec(self)

    def having_role(self, role: str) -> tuple[Variable, ...]:
        """The variables of one role, in declared order."""
        return tuple(variable for variable in self.variables if variable.role == role)

    @property
    def state(self) -> tuple[Variable, ...]:
        """The state of the kernels, in declared order: all but velocities that others give.

        Velocities follow from momenta; only where a coordinate has no momentum is its velocity
        part of the state. Under constraints, those velocities are that no constraint gives.
        """
        return state_of(self.variables)

    @property
    def jets(self) -> tuple[Jet, ...]:
        """The derivatives of fields along space that formulas may name."""
        return () if self.space is None else self.space.jets

    @property
    def in_plane(self) -> bool:
        """Whether variables are fields along two coordinates."""
        return self.space is not None and self.space.across is not None

    @property
    def driving(self) -> tuple[Input | Time, ...]:
        """What kernels take after the parameters: the inputs, then the time."""
        return (*self.inputs, *([] if self.time is None else [self.time]))

    @property
    def defined(self) -> tuple[Variable, ...]:
        """The variables that follow from the state, emitted with the dynamics."""
        return find_defined(self.variables)

    def partner(self, role: str, coordinate: str) -> Variable | None:
        """The velocity or momentum of a coordinate; None if none is declared."""
        partners = (variable for variable in self.having_role(role) if variable.of == coordinate)
        return next(partners, None)

    @property
    def attitude(self) -> Variable | None:
        """The group element in the state, as a matrix or a unit quaternion; None without one."""
        advected = ((v, v.representation) for v in self.having_role("advected"))
        return next((v for v, action in advected if action and action.name in ATTITUDES), None)

    @property
    def turning(self) -> tuple[Variable, ...]:
        """The attitudes, quaternions and poses of the state."""
        return tuple(each for each in self.variables if each.turning)

    @property
    def reduced_momenta(self) -> tuple[DerivedMomentum, ...]:
        """The momenta of the independent velocities; empty where momenta are the state."""
        moving = [each for each in self.state if each.role == "velocity"]
        return tuple(derive_momentum(v, "momentum") for v in moving if self.in_frame)

    @property
    def is_driven(self) -> bool:
        """Whether anything acts in addition to the energy: forces or dissipation of any kind."""
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
    def is_first_order(self) -> bool:
        """Whether a Lagrangian of first order gives all velocities in the state."""
        return any(variable.follows for variable in self.variables)

    @property
    def kind(self) -> str:
        """What the motion is declared on: an algebra, a bracket, coordinates, or space itself.

        ``algebra``, ``poisson``, ``configuration`` or ``diffeomorphisms``.
        """
        if self.algebra is not None:
            return "algebra"
        if self.diffeomorphisms is not None:
            return "diffeomorphisms"
        return "poisson" if self.poisson is not None else "configuration"

    def restricted_to(self, submanifold: Submanifold) -> Spec:
        """The Spec of the motion on a submanifold, where some variables follow from the others."""
        section, where = submanifold.section, submanifold.where
        # what follows from the state is named and emitted as velocities are
        follows = {*section, *(each.name for each in self.defined)}
        variables = tuple(
            replace(
                variable,
                role="velocity" if variable.name in follows else "coordinate",
                block=(),
                representation=None,
                of="",
                turning="",
                given=given,
            )
            for variable in self.variables
            for given in [
                tuple(c for c in variable.components if c in {*section} - {variable.name})
            ]
        )
        records = {key: each for key, each in self.records.items() if key != "charts"}
        whole = replace(
            self,
            observables=(),
            conserved=(),
            reduction=None,
            records=records,
            symmetries=(),
            transformations=(),
            reconstruction=(),
            lax=self.lax if "lax" in self.routes else None,
            brackets=(),
        )
        return replace(
            self,
            algebra=None,
            poisson=None,
            invariance="left",
            variables=variables,
            reduction=Reduction(section, where, whole=whole),
        )
