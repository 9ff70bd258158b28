r"""The Manakov route: the Lax route with the pair that `coadjoint.derive.mechanics.planes` finds.

Theorem (Holm 2011, sections 2.4.2 and 2.4.4): the motion :math:`\dot M = [M, \Omega]` with
:math:`M = A\Omega + \Omega A` is the Lax equation of the pair :math:`M + \lambda A^2`,
:math:`\Omega + \lambda A`.
Comes in: a Setting on an algebra of antisymmetric matrices. Goes out: Equations by the pair.
Read next: `coadjoint.derive.routes.lax`, for a pair that is declared.
"""

from __future__ import annotations

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.planes import ROUTE, SPECTRAL, body_of, find_pair
from coadjoint.derive.records import Step, write_step
from coadjoint.derive.routes.lax import equations_of_pair
from coadjoint.derive.setting import Setting
from coadjoint.spec import Spec


def symbols(spec: Spec) -> tuple[str, ...]:
    """The spectral parameter of the pair that is found."""
    return (SPECTRAL,)


def derive(setting: Setting) -> Equations:
    """Equations of motion by the pair that is found.

    Raises:
        DerivationError: There is none.
    """
    return equations_of_pair(setting, ROUTE, find_pair(setting), _search(setting))


def _search(setting: Setting) -> tuple[Step, ...]:
    """What Manakov's equations were solved for."""
    lines = {f"I{i + 1}{j + 1}": value for (i, j), value in body_of(setting).inertia.items()}
    return (
        write_step(
            "Inertia in the planes",
            "M_ij = I_ij Omega_ij",
            r"M_{ij} = I_{ij} \Omega_{ij}",
            lines,
            by="manakov-inertia",
        ),
        write_step(
            "Manakov's equations",
            "[B, Omega] + [M, A] = 0: I_ij (a_i - a_j) = b_i - b_j, solved for A and B",
            r"[B, \Omega] + [M, A] = 0: \quad I_{ij} (a_i - a_j) = b_i - b_j",
            by="manakov-identity",
        ),
    )
