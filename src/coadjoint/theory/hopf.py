r"""Group actions: the Poincare sphere, the Hopf map C^2 -> S^2 and the brackets that it carries.

Comes in: two complex amplitudes ``a_j = q_j + i p_j`` with ``{a_j, a_k^*} = -2i delta_jk``. Goes
out: the quadratic phase invariants (n0, n), with

.. math:: n_1 + i n_2 = 2 a_1^* a_2,\quad n_3 = |a_1|^2 - |a_2|^2,\quad n_0 = |a_1|^2 + |a_2|^2,

their canonical brackets ``{n_i, n_j} = 4 epsilon_ijk n_k``, ``{n_0, n} = 0`` and the motion on the
sphere. The fibres over a point of the sphere are the orbits of a common phase.
Read next: `coadjoint.theory.charts`.

Source:
    Holm (2011), Geometric Mechanics II, sections 3.2.5 and 3.2.6.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Matrix, Vector, add, cross, identity, scale
from coadjoint.groups.complex_numbers import Complex
from coadjoint.theory.maps import HALF, PAULI
from coadjoint.theory.vector_fields import hamiltonian_vector_field

POSITIONS = ("q1", "q2")
MOMENTA = ("p1", "p2")


def amplitudes(field: Field) -> Vector:
    """``(a_1, a_2)`` of a field that has the symbols q1, q2, p1 and p2."""
    return tuple(Complex(field[q], field[p]) for q, p in zip(POSITIONS, MOMENTA, strict=True))


def coherence_matrix(a: Sequence[Complex]) -> Matrix:
    """``Q = a (x) a*``, the Hermitian matrix ``a_i a_j^*`` of rank one."""
    return tuple(tuple(x * y.conjugate for y in a) for x in a)


def hopf_map(a: Sequence[Complex]) -> Vector:
    """``(n0, n1, n2, n3)``, with ``n . n = n0^2``.

    >>> [str(n) for n in hopf_map((Complex(1), Complex(0, 1)))]
    ['2', '0', '2', '0']
    """
    a1, a2 = a
    flip = 2 * (a1.conjugate * a2)
    return (a1.norm + a2.norm, flip.re, flip.im, a1.norm - a2.norm)


def from_sphere(n: Sequence[Any]) -> Matrix:
    """``(n0 + n . sigma) / 2``, which is the coherence matrix where n is the Hopf map of a."""
    total = scale(n[0], identity(2))
    for component, pauli in zip(n[1:], PAULI, strict=True):
        total = add(total, scale(component, pauli))
    return scale(HALF, total)


def canonical_bracket(field: Field, f: Element, h: Element) -> Element:
    """``{f, h} = f_q . h_p - f_p . h_q``; it makes ``{a_j, a_k^*} = -2i delta_jk``."""
    return hamiltonian_vector_field(field, POSITIONS, MOMENTA, h).derivative(f)


def reduced_motion(n: Sequence[Any], dH_dn: Sequence[Any]) -> Vector:
    """``dn/dt = {n, H} = -4 n x dH/dn`` on the sphere, for a function H of n."""
    return scale(-4, cross(n, dH_dn))
