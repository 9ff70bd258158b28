"""Group actions: matrix groups with AD, Ad, ad and their duals, exact in the group element.

Comes in: a name as books write it. Goes out: matrices of field elements, and actions computed from
them. Read next: `coadjoint.groups.group`.
"""

from coadjoint.groups.catalogue import matrix_group
from coadjoint.groups.group import MatrixGroup
from coadjoint.groups.pairings import TracePairing, trace_pairing

__all__ = ["MatrixGroup", "TracePairing", "matrix_group", "trace_pairing"]
