"""Theory for library users: groups with their actions, Nambu brackets; the engine does not use it.

The pipeline derives, proves and renders without these modules. They hold matrix groups with AD, Ad,
ad and their duals, exact in the group element; the Hopf map; relativity of force laws; central
forces; and what holds for every Nambu bracket (`coadjoint.theory.nambu`).
Comes in: a name as books write it. Goes out: matrices of field elements, and actions computed from
them. Read next: `coadjoint.theory.group`.
"""

from coadjoint.exact.dense import hat
from coadjoint.groups.complex_numbers import Complex
from coadjoint.groups.galilean import particles
from coadjoint.groups.quaternions import Quaternion, euler_rodrigues
from coadjoint.groups.vector_fields import VectorField, lie_derivative
from coadjoint.theory.catalogue import matrix_group
from coadjoint.theory.coquaternions import Coquaternion
from coadjoint.theory.frozen import freeze_bracket
from coadjoint.theory.group import MatrixGroup
from coadjoint.theory.hopf import hopf_map
from coadjoint.theory.jets import JetField
from coadjoint.theory.maps import breve, dual_tilde, su2, tilde, unhat, untilde
from coadjoint.theory.pairings import TracePairing, trace_pairing
from coadjoint.theory.relativity import check_galilean, classify
from coadjoint.theory.rotations import cayley_klein, unit_quaternion
from coadjoint.theory.vector_fields import jacobi_lie_bracket

__all__ = [
    "Complex",
    "Coquaternion",
    "JetField",
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
    "freeze_bracket",
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
