"""The reader: a spec file to a `Spec`, the first step of all.

Comes in: a path, or a text. Goes out: a frozen, checked `Spec`; or an error with file, line,
column, source line and likely fix. Faults are looked for in the order in which they are worth
reporting: the file, its form (`validate`), the parameters, the algebra (`algebras`) and what is
declared over it (`structure`) or a bracket without one (`poisson`), the names and routes
(`consistency`), the formulas (`formulas`).
Read next: `coadjoint.derive.setting`.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.algebra.representation import Representation
from coadjoint.errors import CoadjointError, LimitError, SpecError
from coadjoint.limits import SPEC_BYTES
from coadjoint.spec.consistency import (
    check_blocks,
    check_claims,
    check_covered,
    check_names,
    check_routes,
    check_sizes,
    check_tables,
)
from coadjoint.spec.core.coefficients import Scalars
from coadjoint.spec.core.faults import did_you_mean
from coadjoint.spec.core.formulas import DRIVING, Quantity, Scope, make_scope, read_formula
from coadjoint.spec.core.names import system_refusal
from coadjoint.spec.core.positions import KeyPath, scan
from coadjoint.spec.core.source import Source
from coadjoint.spec.model import (
    Constraint,
    Definition,
    Force,
    Formula,
    Input,
    Integral,
    Lax,
    Observable,
    Parameter,
    Section,
    Spec,
    Symmetry,
    Time,
    Variable,
    state_of,
)
from coadjoint.spec.routes import is_in_frame
from coadjoint.spec.schema import (
    SpecFile,
)
from coadjoint.spec.sections.algebras import read_algebra
from coadjoint.spec.sections.constrained import reaction_shapes
from coadjoint.spec.sections.constraints import ConstraintReader, solved_velocities
from coadjoint.spec.sections.definitions import defined_names, read_definitions
from coadjoint.spec.sections.followed import FollowedReader
from coadjoint.spec.sections.lax import read_lax
from coadjoint.spec.sections.newton import read_newton
from coadjoint.spec.sections.poisson import read_poisson
from coadjoint.spec.sections.reductions import restricted
from coadjoint.spec.sections.representations import read_representations, representation_of
from coadjoint.spec.sections.structure import read_inputs, read_parameter, read_variable
from coadjoint.spec.sections.symmetries import SymmetryReader, emitted_shapes
from coadjoint.spec.sections.uses import check_used
from coadjoint.spec.validate import validate


def read_spec(path: str | os.PathLike[str]) -> Spec:
    """Read a spec from a file.

    What the text may ask for is limited (docs/limits.md); the time that reading takes is not, and
    nor is that of `coadjoint.derive` and `coadjoint.prove`. For a file of a stranger there are
    `coadjoint.read_bounded`, `derive_bounded` and `prove_bounded`.

    Args:
        path: A regular file in TOML; its stem names the system.

    Raises:
        SpecError: The file cannot be read, or is not a spec; the message points at the place.
        LimitError: It asks for more than docs/limits.md allows.
        AlgebraError: The declared brackets or matrices make no Lie algebra.

    >>> from coadjoint.resources import derivations_folder
    >>> spec = read_spec(derivations_folder() / "heavy_top.toml")
    >>> [name for variable in spec.state for name in variable.components]
    ['Pi1', 'Pi2', 'Pi3', 'Gamma1', 'Gamma2', 'Gamma3']
    """
    data = read_file(os.fspath(path))
    try:
        return read_spec_text(data.decode("utf-8"), path)
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise _file_fault(
            f"{os.fspath(path)}:{line}",
            f"the byte 0x{data[error.start]:02x} is not UTF-8",
            "a text in UTF-8",
            found=data[error.start],
        ) from None


def read_spec_text(text: str, path: str | os.PathLike[str]) -> Spec:
    """Read a spec from its text.

    Args:
        text: What the file would hold.
        path: Where it comes from, for messages; the stem names the system.

    Raises:
        SpecError: The text is not a spec; the message points at the place.
        LimitError: It asks for more than docs/limits.md allows.
        AlgebraError: The declared brackets or matrices make no Lie algebra.
    """
    data, name = text.encode("utf-8", "surrogatepass"), Path(path).stem
    refused = system_refusal(name)
    if refused is not None:
        raise _file_fault(os.fspath(path), refused[0], *refused[1:], found=name)
    _check_bytes(os.fspath(path), len(data))
    plain = text.replace("\r\n", "\n")
    source = Source(os.fspath(path), plain, scan(plain))
    file = validate(source)
    check_tables(source, file)
    parameters = tuple(
        read_parameter(source, parameter, part) for parameter, part in file.parameters.items()
    )
    inputs = read_inputs(source, file.inputs)
    time = None if file.time is None else Time(file.time.name, file.time.unit, file.time.doc)
    driving: tuple[Input | Time, ...] = (*inputs, *([] if time is None else [time]))
    given = (*parameters, *driving)
    check_sizes(source, (), parameters, inputs)
    check_names(source, (), given)  # the algebra may depend on them
    algebra, variables, pair = _read_structure(source, file, name, Scalars(parameters, driving))
    check_sizes(source, variables, parameters)
    defined = defined_names(source, file.definitions)
    named: dict[KeyPath, str] = {("observables", each): each for each in file.observables}
    check_names(source, variables, given, (), defined | named)
    definitions = read_definitions(source, file.definitions, (*variables, *given))
    if algebra is not None:
        check_blocks(source, variables, algebra)
    poisson = None
    if file.poisson is not None:
        constants: list[Parameter | Input | Time | Definition] = [*given, *definitions]
        moved = file.variables if file.metriplectic is not None else file.forces
        poisson = read_poisson(source, file.poisson, state_of(variables), constants, moved)
    check_routes(source, file)
    check_covered(source, file, variables, algebra)
    check_claims(source, file, variables)
    quantities: tuple[Quantity, ...] = (*variables, *given, *definitions)
    constrained = ConstraintReader(source, file, variables, quantities)
    constraints = constrained.constraints()
    formulas = _Formulas(source, file, variables, quantities)
    observables = formulas.observables(constraints)
    actions = SymmetryReader(source, state_of(variables), formulas.quantities, observables)
    symmetries = actions.symmetries(file.symmetries, name, Scalars(parameters, driving))
    sections = constrained.sections()
    follower = FollowedReader(source, file, algebra, variables, quantities)
    rolling = follower.rolling()
    followed = follower.followed(rolling)
    emitted: list[Observable | Symmetry | Section] = [*observables, *symmetries, *sections]
    check_names(source, variables, given, emitted, defined)  # now with their components
    spec = Spec(
        name=name,
        title=file.title,
        source=file.source,
        description=file.description,
        license=file.license,
        routes=tuple(file.routes),
        algebra=algebra,
        poisson=poisson,
        invariance=file.algebra.invariance if file.algebra is not None else "left",
        variables=variables,
        parameters=parameters,
        lagrangian=formulas.lagrangian(),
        hamiltonian=formulas.hamiltonian(),
        observables=observables,
        casimirs=formulas.casimirs(),
        conserved=formulas.conserved(emitted),
        path=Path(path),
        sha256=sha256(data).hexdigest(),
        lax=formulas.lax(),
        clebsch=pair,
        newton=formulas.newton(variables),
        galilean=file.claims.galilean.claim,
        definitions=definitions,
        symmetries=symmetries,
        transformations=actions.transformations(file.transformations),
        brackets=actions.brackets(file.claims.brackets),
        constraints=constraints,
        forces=constrained.forces(),
        dissipation=constrained.dissipation(),
        domain=constrained.domain(constraints),
        relaxation=constrained.relaxation(),
        rolling=rolling,
        reconstruction=followed,
        sections=sections,
        accepted=_accepted(file),
        inputs=inputs,
        time=time,
    )
    others = [*emitted, *spec.spatial, *spec.reduced_momenta, *constraints, *followed]
    check_names(source, variables, given, others, defined)
    check_used(source, spec)
    return spec if file.reduction is None else restricted(source, file.reduction, spec)


def _accepted(file: SpecFile) -> frozenset[KeyPath]:
    """The keys of the claims for which support by numbers is enough."""
    claims = file.claims
    parts: dict[KeyPath, Any] = {
        **{("claims", "casimirs", n): part for n, part in enumerate(claims.casimirs)},
        **{("claims", "conserved", n): part for n, part in enumerate(claims.conserved)},
        **{("claims", "brackets", n): part for n, part in enumerate(claims.brackets.values())},
        ("claims", "galilean"): claims.galilean,
        **{
            (table,): part
            for table in ("double_bracket", "metriplectic")
            if (part := getattr(file, table)) is not None
        },
        **{("symmetries", name): part for name, part in file.symmetries.items()},
        **{("transformations", name): part for name, part in file.transformations.items()},
        **{
            ("transformations", name, "exchanges", observable): each
            for name, part in file.transformations.items()
            for observable, each in part.exchanges.items()
        },
    }
    return frozenset(key for key, part in parts.items() if part.accept is not None)


def _read_structure(
    source: Source, file: SpecFile, name: str, scalars: Scalars
) -> tuple[LieAlgebra | None, tuple[Variable, ...], Representation | None]:
    """The algebra, where there is one, the variables over it, and the pair of the route clebsch."""
    algebra, representations, pair = None, dict[str, Representation](), None
    if file.algebra is not None:
        algebra = read_algebra(source, file.algebra, name, scalars)
        representations = read_representations(source, file.representations, algebra, scalars)
        if file.clebsch is not None:
            at: KeyPath = ("clebsch", "representation")
            named = file.clebsch.representation
            pair = representation_of(source, at, algebra, named, representations)
    invariance = file.algebra.invariance if file.algebra is not None else "left"
    solved = solved_velocities(file)
    variables = tuple(
        read_variable(
            source, variable, part, algebra, representations, file.variables, invariance, solved
        )
        for variable, part in file.variables.items()
    )
    return algebra, variables, pair


class _Formulas:
    """The formulas of a spec, each in its scope."""

    def __init__(
        self,
        source: Source,
        file: SpecFile,
        variables: Sequence[Variable],
        quantities: Sequence[Quantity],
    ) -> None:
        self.source, self.file, self.quantities = source, file, quantities
        # all momenta or, of coordinates without them, velocities; the reader refuses a mixture
        self.state = tuple(dict.fromkeys(variable.role for variable in state_of(variables)))
        self.motion = tuple(dict.fromkeys(("velocity", *self.state)))
        self.fixed: tuple[str, ...] = ("advected",) if file.algebra is not None else ("coordinate",)
        if is_in_frame(file):  # an algebra and coordinates may stand side by side
            present = [variable.role for variable in variables if variable.role != "velocity"]
            self.fixed = tuple(dict.fromkeys(present)) or self.fixed

    def lagrangian(self) -> Formula | None:
        if self.file.lagrangian is None:
            return None
        scope = make_scope(
            "a Lagrangian", ("velocity", *self.fixed), self.quantities, driven=DRIVING
        )
        return read_formula(self.source, ("lagrangian", "l"), self.file.lagrangian.l, scope)

    def hamiltonian(self) -> Formula | None:
        if self.file.hamiltonian is None:
            return None
        scope = make_scope("a Hamiltonian", self.state, self.quantities, driven=DRIVING)
        return read_formula(self.source, ("hamiltonian", "h"), self.file.hamiltonian.h, scope)

    def lax(self) -> Lax | None:
        if self.file.lax is None:
            return None
        return read_lax(self.source, self.file.lax, self.state, self.quantities)

    def newton(self, variables: Sequence[Variable]) -> tuple[Force, ...]:
        if self.file.newton is None:
            return ()
        return read_newton(self.source, self.file.newton, variables, self.quantities)

    def observables(self, constraints: Sequence[Constraint]) -> tuple[Observable, ...]:
        reactions = reaction_shapes(constraints)
        scope = make_scope("an observable", self.motion, self.quantities, reactions, driven=DRIVING)
        found = []
        for name, part in self.file.observables.items():
            key: KeyPath = ("observables", name)
            # An observable may be its expression alone.
            inner = (*key, "expression")
            key = inner if inner in self.source.positions.values else key
            formula = read_formula(self.source, key, part.expression, scope, any_shape=True)
            found.append(Observable(name, formula, part.unit, part.doc))
        return tuple(found)

    def casimirs(self) -> tuple[Formula, ...]:
        scope = make_scope("a Casimir", self.state, self.quantities)
        key: KeyPath = ("claims", "casimirs")
        found = []
        for place, part in enumerate(self.file.claims.casimirs):
            at = self.source.claim_key((*key, place))
            found.append(read_formula(self.source, at, part.claim, scope, any_shape=True))
        return tuple(found)

    def conserved(self, emitted: Sequence[Observable | Symmetry | Section]) -> tuple[Integral, ...]:
        named = emitted_shapes(emitted)
        if self.file.hamiltonian is None and self.file.lagrangian is None:
            del named["energy"]
        scope = make_scope("an integral", self.motion, self.quantities, named, driven=DRIVING)
        found = []
        for place, part in enumerate(self.file.claims.conserved):
            key: KeyPath = ("claims", "conserved", place)
            at = self.source.claim_key(key)
            formula = read_formula(self.source, at, part.claim, scope, any_shape=True)
            where = self._formulas((*key, "where"), part.where, scope)
            found.append(Integral(formula, where))
        return tuple(found)

    def _formulas(self, key: KeyPath, texts: Sequence[str], scope: Scope) -> tuple[Formula, ...]:
        """The formulas of a list, scalars or not."""
        return tuple(
            read_formula(self.source, (*key, place), text, scope, any_shape=True)
            for place, text in enumerate(texts)
        )


# -- files ----------------------------------------------------------------------------------------


def read_file(path: str) -> bytes:
    """The bytes of a regular file, never waiting for a pipe and never more than the limit."""
    try:
        # Not following a link, so that the file that was checked is the file that is read; not
        # blocking, because opening a pipe would wait for a writer.
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW | os.O_CLOEXEC)
    except (OSError, ValueError) as error:
        raise _not_opened(path, error) from None
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            kind = _kind(status.st_mode)
            raise _file_fault(path, f"this is {kind}", "a regular file", found=kind)
        _check_bytes(path, status.st_size)
        with os.fdopen(os.dup(descriptor), "rb") as file:
            data = file.read(SPEC_BYTES + 1)  # it may have grown since
    except OSError as error:
        raise _not_opened(path, error) from None
    finally:
        os.close(descriptor)
    _check_bytes(path, len(data))
    if not data.strip():
        raise _file_fault(
            path,
            "the file is empty",
            "a spec",
            "Write one with: coadjoint new NAME.",
            found="",
        )
    return data


def _not_opened(path: str, error: OSError | ValueError) -> CoadjointError:
    """Why a file could not be opened, and which one may have been meant."""
    number = error.errno if isinstance(error, OSError) else None
    if number == errno.ELOOP and Path(path).is_symlink():
        target = str(Path(path).readlink())
        hint = f"Give the file that it points to: {target}."
        return _file_fault(path, "this is a symbolic link", "a regular file", hint, found=target)
    if number == errno.ENOENT:
        beside = [str(p) for p in Path(path).parent.glob("*.toml")]
        hint = did_you_mean(path, beside)
        return _file_fault(path, "there is no such file", "a spec in TOML", hint, found=path)
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return _file_fault(
        path, f"cannot be read: {reason}", "a readable regular file", found=str(reason)
    )


def _kind(mode: int) -> str:
    """What a path is if not a regular file."""
    kinds = (
        (stat.S_ISDIR, "a directory"),
        (stat.S_ISFIFO, "a named pipe (FIFO)"),
        (stat.S_ISSOCK, "a socket"),
    )
    return next((name for is_kind, name in kinds if is_kind(mode)), "a device")


def _check_bytes(path: str, size: int) -> None:
    if size > SPEC_BYTES:
        raise _file_fault(
            path,
            f"the file has {size} bytes",
            f"at most {SPEC_BYTES} (SPEC_BYTES)",
            found=size,
            kind=LimitError,
        )


def _file_fault(
    path: str,
    problem: str,
    expected: str,
    hint: str = "",
    *,
    found: object,
    kind: type[CoadjointError] = SpecError,
) -> CoadjointError:
    """An error about a file as a whole."""
    return kind(
        f"{path}: {problem}; expected {expected}. {hint}".rstrip(),
        path=path,
        line=0,
        column=0,
        key="",
        found=found,
        expected=expected,
        hint=hint,
    )
