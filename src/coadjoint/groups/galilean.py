r"""Group actions: Galilean relativity of a law of motion.

Comes in: forces on N particles as elements in positions, velocities and time. Goes out: which
Galilean transformations map the equations to themselves, with the defect where one does not.

.. math:: (R, v, r_0, \tau):\quad r \mapsto R r + v t + r_0,\quad t \mapsto t + \tau

The four subgroups make the whole group, so each is tried alone and a failure names its own.
Read next: `coadjoint.prove.galilean`.

Source:
    Holm (2011), Geometric Mechanics II, sections 1.1 and 1.2.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Matrix, Vector, add, apply, identity, scale, subtract
from coadjoint.groups.quaternions import Quaternion, euler_rodrigues
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
