r"""Galilean relativity of a law of motion, and what Newton's laws then conserve.

Comes in: forces on N particles. Goes out: which Galilean transformations map the equations to
themselves, and which of energy E, momentum P, angular momentum J and ``K = t P - sum m r`` are
conserved. Read next: `coadjoint.groups.galilean`.

Source:
    Holm (2011), Geometric Mechanics II, sections 1.1 and 1.2.1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from coadjoint.errors import ClaimError
from coadjoint.exact import Element
from coadjoint.exact.dense import Vector, add, cross, dot, scale, subtract
from coadjoint.groups.galilean import TIME, Forces, Particles, subgroups, transformation_defects


def pair_forces(
    system: Particles, law: Callable[[Vector, Vector], Sequence[Element]]
) -> tuple[Vector, ...]:
    """``F_i = sum over j of f(r_i - r_j, v_i - v_j)`` for one law f of differences."""
    forces = []
    for i in system.numbers:
        total: Vector = system.field.vector((0, 0, 0))
        for j in system.numbers:
            if j != i:
                r, v = (subtract(of(i), of(j)) for of in (system.position, system.velocity))
                total = add(total, tuple(law(r, v)))
        forces.append(total)
    return tuple(forces)


def check_galilean(system: Particles, forces: Forces) -> None:
    """Check that a law of motion maps to itself under every Galilean transformation.

    Raises:
        ClaimError: It does not; the message names the transformation, the component and the defect.
    """
    for name, g in subgroups(system).items():
        for place, defect in enumerate(transformation_defects(system, forces, g)):
            if defect != 0:
                component = f"F{place // 3 + 1}_{place % 3 + 1}"
                raise ClaimError(
                    f"the force {component} is not Galilean: a {name} changes it by {defect}; "
                    "expected 0. Let it depend on differences of positions and velocities only, "
                    "through scalar products and along them.",
                    transformation=name,
                    component=component,
                    defect=str(defect),
                )


# -- conservation ---------------------------------------------------------------------------------


def conserved_quantities(system: Particles, potential: Element | int = 0) -> dict[str, Vector]:
    """E, P, J and K of particles with a potential energy, each as a tuple of components."""
    field = system.field
    energy, nothing = field.zero + potential, field.vector((0, 0, 0))
    P, J, moment = nothing, nothing, nothing
    for n in system.numbers:
        m, r, v = system.mass(n), system.position(n), system.velocity(n)
        energy += m * dot(v, v) / 2
        P, moment = add(P, scale(m, v)), add(moment, scale(m, r))
        J = add(J, scale(m, cross(r, v)))
    return {"E": (energy,), "P": P, "J": J, "K": subtract(scale(field[TIME], P), moment)}


def drifts(system: Particles, forces: Forces, potential: Element | int = 0) -> Mapping[str, Vector]:
    """Time derivatives of E, P, J and K along the motion, as normal forms."""
    motion = system.motion(forces)
    return {
        name: tuple(map(system.field.normal, motion.rates(quantity)))
        for name, quantity in conserved_quantities(system, potential).items()
    }


@dataclass(frozen=True)
class Classification:
    """What a force law respects.

    Attributes:
        symmetries: Those of rotation, boost, translation and time shift that map it to itself.
        conserved: Those of E, P, J and K that do not drift.
    """

    symmetries: frozenset[str]
    conserved: frozenset[str]

    @property
    def is_galilean(self) -> bool:
        """Whether the law is admissible (theorem of section 1.2.1)."""
        return len(self.symmetries) == 4


def classify(system: Particles, forces: Forces, potential: Element | int = 0) -> Classification:
    """Symmetries and conserved quantities of a force law, decided by normal forms.

    >>> from coadjoint.groups.galilean import particles
    >>> system = particles(2, parameters=["k"])
    >>> spring = pair_forces(system, lambda r, v: scale(-system.field["k"], r))
    >>> sorted(classify(system, spring).symmetries)
    ['boost', 'rotation', 'time shift', 'translation']
    """
    kept = [
        name
        for name, g in subgroups(system).items()
        if not any(transformation_defects(system, forces, g))
    ]
    still = [name for name, rates in drifts(system, forces, potential).items() if not any(rates)]
    return Classification(frozenset(kept), frozenset(still))
