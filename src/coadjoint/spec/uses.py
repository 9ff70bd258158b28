"""Uses: every formula of a spec.

Comes in: a Spec. Goes out: its formulas, table by table.
Read next: `coadjoint.derive.setting`, which makes room for what formulas call.
"""

from __future__ import annotations

from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.model import Spec
from coadjoint.spec.tables import TABLES


def list_formulas(spec: Spec) -> tuple[Formula, ...]:
    """Every formula of a spec."""
    return tuple(formula for table in TABLES for formula in table.formulas_in(spec))
