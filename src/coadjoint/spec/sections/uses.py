"""Uses: every formula of a spec, and whether what it declares is used.

Comes in: a Spec. Goes out: its formulas, or an error for an input that acts on nothing.
Read next: `coadjoint.derive.setting`, which makes room for what formulas call.
"""

from __future__ import annotations

from coadjoint.spec.core.faults import listed
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.tree import Index, Name, walk
from coadjoint.spec.model import Formula, Spec


def formulas(spec: Spec) -> tuple[Formula, ...]:
    """Every formula of a spec."""
    stated = [formula for formula in (spec.lagrangian, spec.hamiltonian) if formula is not None]
    if spec.poisson is not None:
        stated += [*spec.poisson.functions, *(formula for *_, formula in spec.poisson.entries)]
    if spec.lax is not None:
        stated += [spec.lax.L, spec.lax.M]
    if spec.reduction is not None:
        stated += spec.reduction.section.values()
    stated += [formula for law in spec.newton for formula in (law.mass, law.force)]
    stated += [side for each in spec.constraints for side in (each.left, each.right)]
    stated += [*spec.forces.values(), *([spec.dissipation] if spec.dissipation else ())]
    if spec.relaxation is not None:
        stated += [f for f in (spec.relaxation.G, spec.relaxation.S) if f is not None]
    stated += [side for each in spec.domain for side in (each.left, each.right)]
    stated += [spec.rolling.arm] if spec.rolling is not None else []
    stated += [each.rate for each in spec.reconstruction if each.rate is not None]
    stated += [formula for each in spec.sections for formula in each.section.values()]
    declared = [observable.formula for observable in spec.observables]
    claimed = [f for claim in spec.conserved for f in (claim.formula, *claim.where)]
    for symmetry in spec.symmetries:
        claimed += [f for f in (symmetry.time, symmetry.map) if f is not None]
        claimed += symmetry.generators.values()
    for transformation in spec.transformations:
        claimed += [*transformation.map.values(), *transformation.exchanges.values()]
    claimed += [f for each in spec.brackets for f in (each.left, each.right, each.value)]
    return (*stated, *declared, *spec.casimirs, *claimed)


def check_used(source: Source, spec: Spec) -> None:
    """Every input, and the time if it is declared, occurs in some formula.

    Raises:
        SpecError: One does not.
    """
    trees = [formula.tree for formula in formulas(spec)]
    named = {n.name for tree in trees for n in walk(tree) if isinstance(n, Name | Index)}
    named |= {each.rate for each in spec.inputs}
    for each in spec.driving:
        if not named & {each.name, *each.components}:
            table = "time" if each is spec.time else "inputs"
            key: KeyPath = ("time",) if each is spec.time else ("inputs", each.name)
            raise source.fault(
                key,
                f"{each.name!r} occurs in no formula",
                found=each.name,
                expected=f"a formula that names {listed(each.components)}",
                hint=f"Use it in the energy or a force, or remove it from [{table}].",
                at=source.positions.key(key),
            )
