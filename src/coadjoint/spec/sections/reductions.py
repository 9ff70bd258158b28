"""Reductions: a system restricted to a submanifold that its motion keeps.

Comes in: a Spec that has been read whole, and its table [reduction], which says what some of the
variables are on the submanifold: its section. Goes out: the Spec of what is left, where these
variables follow from the state as velocities do. That the motion keeps the submanifold is proved
later, in `coadjoint.prove.reductions`. Read next: `coadjoint.derive.reductions`.
"""

from __future__ import annotations

from dataclasses import replace

from coadjoint.spec.core.faults import did_you_mean, listed
from coadjoint.spec.core.formulas import Quantity, make_scope, read_formula
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.shapes import words
from coadjoint.spec.core.source import Source
from coadjoint.spec.model import Formula, Reduction, Spec, Variable
from coadjoint.spec.schema import ReductionPart


def restricted(source: Source, part: ReductionPart, whole: Spec) -> Spec:
    """The Spec of the motion on a submanifold.

    Args:
        source: The text of the spec.
        part: The table [reduction].
        whole: The spec without it.

    Raises:
        SpecError: What is restricted is no vector or scalar of the state, something is left of no
            variable, or the spec has what a restricted motion cannot.
    """
    _check_whole(source, whole)
    for name in part.section:
        _check_eliminated(source, name, whole)
    kept = tuple(variable for variable in whole.variables if variable.name not in part.section)
    if not kept:
        raise source.fault(
            ("reduction", "section"),
            "no variable is left",
            found=listed(part.section),
            expected="a section over at least one variable",
        )
    quantities: tuple[Quantity, ...] = (
        *kept,
        *whole.parameters,
        *whole.driving,
        *whole.definitions,
    )
    section = {
        name: _section(source, name, text, quantities, whole) for name, text in part.section.items()
    }
    everything: tuple[Quantity, ...] = (
        *whole.variables,
        *whole.parameters,
        *whole.driving,
        *whole.definitions,
    )
    scope = make_scope("a function that vanishes", _roles(whole.variables), everything)
    where = tuple(
        read_formula(source, ("reduction", "where", place), text, scope, any_shape=True)
        for place, text in enumerate(part.where)
    )
    # what follows from the state is named and emitted as velocities are
    variables = tuple(
        replace(
            variable,
            role="velocity" if variable.name in section else "coordinate",
            block=(),
            representation=None,
        )
        for variable in whole.variables
    )
    return replace(
        whole,
        algebra=None,
        poisson=None,
        invariance="left",
        variables=variables,
        reduction=Reduction(replace(whole, observables=(), conserved=()), section, where),
    )


def _roles(variables: tuple[Variable, ...]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(variable.role for variable in variables))


def _check_whole(source: Source, whole: Spec) -> None:
    """There is a Hamiltonian, and nothing that belongs to a bracket of the state."""
    velocities = [variable.name for variable in whole.having_role("velocity")]
    alien: dict[KeyPath, object] = {
        ("claims", "casimirs"): whole.casimirs,
        ("claims", "brackets"): whole.brackets,
        ("symmetries",): whole.symmetries,
        ("transformations",): whole.transformations,
        ("lax",): whole.lax,
        ("newton",): whole.newton,
        ("reconstruction",): whole.reconstruction,
        ("variables", *velocities[:1]): velocities,
    }
    for key, found in alien.items():
        if found:
            name = str(key[-1])
            raise source.fault(
                key,
                f"{name!r} does not go with [reduction], whose motion has no bracket",
                found=name,
                expected="momenta or coordinates, a Hamiltonian, observables and integrals",
                hint="Declare it in a spec of the whole system.",
            )
    if whole.hamiltonian is None:
        raise source.fault(
            ("reduction",),
            "there is no Hamiltonian",
            found="hamiltonian",
            expected="a table [hamiltonian] beside [reduction]",
        )


def _check_eliminated(source: Source, name: str, whole: Spec) -> None:
    """What the section gives is a variable, and no matrix kept as a list."""
    known = {variable.name: variable for variable in whole.variables}
    if name not in known or known[name].form:
        key: KeyPath = ("reduction", "section", name)
        kind = "is a matrix kept as a list" if name in known else "is no variable"
        raise source.fault(
            key,
            f"{name!r} {kind}",
            found=name,
            expected=f"one of {listed(n for n, v in known.items() if not v.form)}",
            hint=did_you_mean(name, known),
            at=source.positions.key(key),
        )


def _section(
    source: Source, name: str, text: str, quantities: tuple[Quantity, ...], whole: Spec
) -> Formula:
    """What one variable is on the submanifold, in those that are left."""
    key: KeyPath = ("reduction", "section", name)
    (variable,) = (each for each in whole.variables if each.name == name)
    scope = make_scope("a section", _roles(whole.variables), quantities)
    formula = read_formula(source, key, text, scope, any_shape=True)
    if formula.shape != variable.value_shape:
        raise source.fault(
            key,
            f"the value is {words(formula.shape)}",
            found=words(formula.shape),
            expected=f"{words(variable.value_shape)}, as {name!r} is",
        )
    return formula
