"""The Poisson tensor of a motion times a vector, in a field with components of the vector.

Comes in: Equations. Goes out: Equations with the products in place of the rates. Methods that keep
the structure of a motion ask for them: the motion is the tensor times the gradient of the energy.
Read next: `coadjoint.derive.formulas`.
"""

from __future__ import annotations

from dataclasses import replace

from coadjoint.derive.equations import Equations
from coadjoint.derive.records import Exact
from coadjoint.derive.setting import Setting, once, vector_names
from coadjoint.exact import Field


@once
def times_vector(equations: Equations) -> Equations | None:
    """``J(x) v`` in place of the rates; None where the motion is not ``J`` times a gradient.

    It is for free motions by a route with an energy and a bracket, whose momenta do not move at a
    fixed state, and to which no relaxation is added. The certificate proves it of each. Tensors
    with functions of the state or with velocities that the kernel solves for are left out.
    """
    setting, exact = equations.setting, equations.exact
    tensor, spec = exact.poisson_tensor, equations.spec
    if exact.energy is None or tensor is None or equations.distribution is not None:
        return None
    if spec.constraints or spec.relaxation or equations.chart is not None:
        return None
    field, state = setting.field, setting.state
    named, vector = (*state, *setting.parameters, *setting.driving), vector_names(len(state))
    closed = [[equations.close(entry) for entry in row] for row in tensor]
    for entry in (entry for row in closed for entry in row):
        if not field.is_function_free(entry) or field.reach(entry) - {*named}:
            return None
    wide = Field([*state, *vector, *named[len(state) :]], 0, field.positive & {*named})
    products = tuple(
        wide.sum(wide.adopt(entry) * wide[v] for entry, v in zip(row, vector, strict=True) if entry)
        for row in closed
    )
    own = Exact(definitions=(), rates=products, energy=None, emitted=(), poisson_tensor=None)
    return replace(
        equations, setting=Setting(spec=spec, field=wide, values={}), exact=own, steps=()
    )
