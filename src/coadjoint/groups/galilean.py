r"""Group actions: Galilean relativity of a law of motion, and what Newton's laws then conserve.

Comes in: forces on N particles as elements in positions, velocities and time. Goes out: which
Galilean transformations map the equations to themselves, with the defect where one does not, and
which of energy E, momentum P, angular momentum J and ``K = t P - sum m r`` are conserved.

.. math:: (R, v, r_0, \tau):\quad r \mapsto R r + v t + r_0,\quad t \mapsto t + \tau

The four subgroups make the whole group, so each is tried alone and a failure names its own.
Read next: `coadjoint.groups`.

Source:
    Holm (2011), Geometric Mechanics II, sections 1.1 and 1.2.1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from coadjoint.errors import ClaimError
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Matrix, Vector, add, apply, cross, dot, identity, scale, subtract
from coadjoint.groups.quaternions import Quaternion
from coadjoint.groups.rotations import euler_rodrigues
from coadjoint.groups.vector_fields import VectorField

TIME = "t"
#: Symbols of a transformation: three of the rotation, the boost, the translation, the time shift.
_ROTATION, _BOOST, _SHIFT = (tuple(f"{word}{n}" for n in "123") for word in ("turn", "boost", "to"))
_DELAY = "delay"

#: One vector for each particle.
Forces = Sequence[Sequence[Element]]


@dataclass(frozen=True)
class Particles:
    """N particles in R^3, as symbols: ``r1_1, r1_2, ..., v1_1, ..., t, m1, ...``.

    Attributes:
        field: Where everything lives.
        count: N.
    """

    field: Field
    count: int

    def position(self, n: int) -> Vector:
        """``r_n``, counted from 1."""
        return tuple(self.field[name] for name in _names("r", n))

    def velocity(self, n: int) -> Vector:
        """``v_n``, counted from 1."""
        return tuple(self.field[name] for name in _names("v", n))

    def mass(self, n: int) -> Element:
        """``m_n``, counted from 1."""
        return self.field[f"m{n}"]

    @property
    def numbers(self) -> range:
        """1 to N."""
        return range(1, self.count + 1)

    def motion(self, forces: Forces) -> VectorField:
        """``dr_n/dt = v_n, m_n dv_n/dt = F_n, dt/dt = 1``."""
        rates = {TIME: self.field.one}
        for n, force in zip(self.numbers, forces, strict=True):
            rates |= zip(_names("r", n), self.velocity(n), strict=True)
            rates |= zip(_names("v", n), scale(1 / self.mass(n), force), strict=True)
        return VectorField(self.field, tuple(rates), tuple(rates.values()))


def particles(count: int, parameters: Sequence[str] = (), functions: int = 0) -> Particles:
    """Particles with free masses.

    Args:
        count: How many.
        parameters: Names of the constants of the force law.
        functions: How many roots and other functions the law is written with.
    """
    numbers = range(1, count + 1)
    state = [name for letter in "rv" for n in numbers for name in _names(letter, n)]
    masses = [f"m{n}" for n in numbers]
    transformation = [*_ROTATION, *_BOOST, *_SHIFT, _DELAY]
    # A law that is not invariant has functions of other arguments after each of the four.
    field = Field([*state, TIME, *masses, *parameters, *transformation], slots=5 * functions)
    return Particles(field, count)


def _names(letter: str, n: int) -> tuple[str, ...]:
    return tuple(f"{letter}{n}_{axis}" for axis in "123")


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


# -- relativity -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Galilean:
    """A Galilean transformation ``(R, v, r0, tau)`` with elements of a field."""

    rotation: Matrix
    boost: Vector
    translation: Vector
    time_shift: Element

    def state(self, system: Particles) -> dict[str, Element]:
        """What positions, velocities and time become."""
        t = system.field[TIME]
        image = {TIME: t + self.time_shift}
        moved = add(scale(t, self.boost), self.translation)
        for n in system.numbers:
            r = add(apply(self.rotation, system.position(n)), moved)
            v = add(apply(self.rotation, system.velocity(n)), self.boost)
            image |= zip(_names("r", n), r, strict=True)
            image |= zip(_names("v", n), v, strict=True)
        return image


def subgroups(system: Particles) -> dict[str, Galilean]:
    """The generic element of each of the four subgroups, by its name.

    The rotation is that of the quaternion [1, a], which leaves out half turns only.
    """
    field = system.field
    none = field.vector((0, 0, 0))
    turn, boost, shift = (
        tuple(field[name] for name in names) for names in (_ROTATION, _BOOST, _SHIFT)
    )
    rotation = euler_rodrigues(Quaternion(field.one, *turn))
    return {
        "rotation": Galilean(rotation, none, none, field.zero),
        "translation": Galilean(identity(3), none, shift, field.zero),
        "boost": Galilean(identity(3), boost, none, field.zero),
        "time shift": Galilean(identity(3), none, none, field[_DELAY]),
    }


def transformation_defects(system: Particles, forces: Forces, g: Galilean) -> Vector:
    """``F(g . state) - R F(state)``, normal forms, component by component; all 0 if admissible."""
    image, field = g.state(system), system.field
    defects: list[Element] = []
    for force in forces:
        moved = [field.substitute(field.zero + component, image) for component in force]
        defects += map(field.normal, subtract(moved, apply(g.rotation, force)))
    return tuple(defects)


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
