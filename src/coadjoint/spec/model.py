"""The Spec: what a person declared, read, validated and parsed; the first record that travels.

Comes in: the parts checked by `coadjoint.spec.reader`. Goes out: a frozen record with no text in
it that later steps would have to parse. Free text (title, source, docs) is carried for documents
and JSON only and never reaches a template, a C file or a Python file.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from pathlib import Path

from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.algebra.representation import Representation
from coadjoint.spec.tree import Node

Shape = tuple[int, ...]


def component_names(name: str, shape: Shape) -> tuple[str, ...]:
    """Names of the components of a quantity, as books write them, row by row.

    >>> component_names("Pi", (3,))
    ('Pi1', 'Pi2', 'Pi3')
    >>> component_names("A", (2, 2))
    ('A11', 'A12', 'A21', 'A22')
    >>> component_names("Pi1", (2,))  # a digit at the end would run into the index
    ('Pi1_1', 'Pi1_2')
    """
    if not shape:
        return (name,)
    indices = product(*(range(1, length + 1) for length in shape))
    joint = "_" if len(shape) == 2 and max(shape) > 9 else ""
    lead = name + "_" if name[-1].isdigit() or joint else name
    return tuple(lead + joint.join(map(str, index)) for index in indices)


@dataclass(frozen=True)
class Variable:
    """A velocity, momentum or advected quantity.

    Attributes:
        name: As declared, e.g. ``Omega``.
        role: ``"velocity"``, ``"momentum"`` or ``"advected"``.
        shape: ``()`` for a block of one basis element, else ``(n,)``.
        block: Places in the algebra's basis that a velocity or momentum spans; empty if advected.
        representation: How the algebra acts on an advected quantity; None otherwise.
        unit: Unit text of the restricted unit alphabet, ``"1"`` if dimensionless.
        doc: Free text for documents.
    """

    name: str
    role: str
    shape: Shape
    block: tuple[int, ...] = ()
    representation: Representation | None = None
    unit: str = "1"
    doc: str = ""

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, in order."""
        return component_names(self.name, self.shape)


@dataclass(frozen=True)
class Parameter:
    """A constant of the system.

    Attributes:
        name: As declared, e.g. ``chi``.
        shape: ``()``, ``(n,)`` or ``(n, m)``.
        positive: Whether every component may be assumed positive.
        default: One exact value per component, row by row; None if the user must give it.
        unit: Unit text, ``"1"`` if dimensionless.
        doc: Free text for documents.
    """

    name: str
    shape: Shape
    positive: bool = False
    default: tuple[Fraction, ...] | None = None
    unit: str = "1"
    doc: str = ""

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, in order."""
        return component_names(self.name, self.shape)


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


@dataclass(frozen=True)
class Observable:
    """A declared scalar emitted beside the dynamics."""

    name: str
    formula: Formula
    unit: str = "1"
    doc: str = ""


@dataclass(frozen=True)
class Spec:
    """One declared system.

    Attributes:
        name: The file's stem; also the name of the generated module and the prefix of C functions.
        title: Free text, like ``source`` and ``description``; for documents only.
        license: SPDX expression of the spec's own licence, or "".
        routes: Routes to derive by; the first is emitted, the others are proved equal to it.
        algebra: The Lie algebra of the velocities.
        invariance: ``"left"`` (body) or ``"right"`` (space).
        variables: Velocities, momenta and advected quantities in declared order.
        parameters: Constants in declared order.
        lagrangian: l of the velocities and advected quantities, or None.
        hamiltonian: h of the momenta and advected quantities, or None.
        observables: Declared scalars in order.
        casimirs: Claimed Casimirs of the Lie-Poisson bracket.
        conserved: Claimed integrals of the motion.
        path: File the spec was read from, for messages only.
        sha256: Hash of the file's bytes.
    """

    name: str
    title: str
    source: str
    description: str
    license: str
    routes: tuple[str, ...]
    algebra: LieAlgebra
    invariance: str
    variables: tuple[Variable, ...]
    parameters: tuple[Parameter, ...]
    lagrangian: Formula | None
    hamiltonian: Formula | None
    observables: tuple[Observable, ...]
    casimirs: tuple[Formula, ...]
    conserved: tuple[Formula, ...]
    path: Path
    sha256: str

    def having_role(self, role: str) -> tuple[Variable, ...]:
        """The variables of one role, in declared order."""
        return tuple(variable for variable in self.variables if variable.role == role)

    @property
    def state(self) -> tuple[Variable, ...]:
        """Momenta, then advected quantities, each in declared order: the state of the kernels."""
        return self.having_role("momentum") + self.having_role("advected")
