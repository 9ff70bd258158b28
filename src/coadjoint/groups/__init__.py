"""Group actions: matrix groups with AD, Ad, ad and their duals, exact in the group element.

Comes in: a name as books write it. Goes out: matrices of field elements, and actions computed from
them. Read next: `coadjoint.groups.group`.
"""

from coadjoint.groups.catalogue import matrix_group
from coadjoint.groups.complex_numbers import Complex
from coadjoint.groups.galilean import check_galilean, classify, particles
from coadjoint.groups.group import MatrixGroup
from coadjoint.groups.hopf import hopf_map
from coadjoint.groups.maps import breve, dual_tilde, hat, su2, tilde, unhat, untilde
from coadjoint.groups.pairings import TracePairing, trace_pairing
from coadjoint.groups.quaternions import Coquaternion, Quaternion
from coadjoint.groups.rotations import cayley_klein, euler_rodrigues, unit_quaternion
from coadjoint.groups.vector_fields import VectorField, jacobi_lie_bracket, lie_derivative

__all__ = [
    "Complex",
    "Coquaternion",
    "MatrixGroup",
    "Quaternion",
    "TracePairing",
    "VectorField",
    "breve",
    "cayley_klein",
    "check_galilean",
    "classify",
    "dual_tilde",
    "euler_rodrigues",
    "hat",
    "hopf_map",
    "jacobi_lie_bracket",
    "lie_derivative",
    "matrix_group",
    "particles",
    "su2",
    "tilde",
    "trace_pairing",
    "unhat",
    "unit_quaternion",
    "untilde",
]
