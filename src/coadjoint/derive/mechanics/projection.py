r"""Projection: a state moved back onto the constraints that are kept.

A motion keeps a residual :math:`R = A\eta - b` as well as the integrator does, and no better: what
it loses in each step stays. The nearest state that satisfies the constraints has the same positions
and velocities :math:`\eta + d`, with the least kinetic energy of the change d,

.. math::
    \min_d \tfrac12 d^T M d, \quad A(\eta + d) = b
    \qquad\Longrightarrow\qquad
    \begin{pmatrix} M & A^T \\ A & 0 \end{pmatrix} \begin{pmatrix} d \\ u \end{pmatrix}
        = \begin{pmatrix} 0 \\ -R \end{pmatrix},

the matrix of the accelerations, so that :math:`L D L^T` is shared with them. It is one step, since
R is affine in the velocities. Points of contact are moved back onto surfaces by a step of Newton.
Attitudes are moved back to rotations first. The nearest state is then that of the moved attitudes,
which it leaves as they are, so that neither undoes the other.
Comes in: exact equations with constraints that are kept. Goes out: exact equations with that state
in place of the rates.
Read next: `coadjoint.prove.projection`.
"""

from __future__ import annotations

from dataclasses import replace

from coadjoint.derive.mechanics.decided import Decided
from coadjoint.derive.mechanics.distribution import Distribution
from coadjoint.derive.mechanics.kinematics import (
    kinematics,
    moved_names,
    multiplier_name,
    rate_name,
    shift_name,
)
from coadjoint.derive.mechanics.solver import Solve, definitions_under, solve_in_kernel
from coadjoint.derive.mechanics.turning import turned_back
from coadjoint.derive.records import Exact
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element


def nearest_state(setting: Setting, of: Distribution | None, exact: Exact) -> Exact | None:
    """The nearest state on the constraints, in place of the rates; None where none is kept.

    Definitions are those of the equations on which matrix and residuals rest, then the solve.
    """
    if of is None or not of.kept:
        return (
            None if of is None or of.frame.touch is None else _nearest_contact(setting, of, exact)
        )
    field = setting.field
    shifts = {rate_name(v): shift_name(n) for n, v in enumerate(of.independent)}
    sides = {multiplier_name(n): -residual for n, residual in enumerate(_residuals(of))}
    solves = tuple(
        Solve(
            matrix=solve.mirrored,  # without what forces add that are proportional to reactions
            known=[sides.get(name, field.zero) for name in solve.names],
            block=solve.block,
            names=[shifts.get(name, name) for name in solve.names],
        )
        for solve in exact.solves
        if sides.keys() & set(solve.names)  # velocities of other blocks stay
    )
    moved = {name for solve in solves for name in solve.names}
    changes = {
        v: field[shifts[rate_name(v)]] for v in of.independent if shifts[rate_name(v)] in moved
    }
    needed = [e for solve in solves for row in (*solve.matrix, solve.known) for e in row]
    needed += [residual for _, residual in exact.residuals]
    definitions = definitions_under(field, exact.definitions, needed)
    decided = Decided(field, setting.state)
    for name, value in definitions:
        decided.define(name, value)
    definitions += [line for solve in solves for line in solve_in_kernel(field, solve, decided)]
    state = tuple(field[name] + changes.get(name, field.zero) for name in setting.state)
    return Exact(
        definitions=tuple(definitions),
        rates=state,
        energy=None,
        emitted=(),
        poisson_tensor=None,
        solves=solves,
        residuals=exact.residuals,
    )


def back_then_onto(setting: Setting, onto: Exact | None) -> Exact:
    """Attitudes moved back to rotations, then the nearest state on the constraints at these.

    Args:
        setting: With attitudes in its state.
        onto: The nearest state at given attitudes; None where no constraint is kept.
    """
    field, back = setting.field, turned_back(setting)
    if onto is None:
        return Exact(
            definitions=(),
            rates=tuple(back.get(name, field[name]) for name in setting.state),
            energy=None,
            emitted=(),
            poisson_tensor=None,
        )
    names = moved_names(setting.spec)
    at = {name: field[moved] for name, moved in names.items()}

    def move(element: Element) -> Element:
        return field.substitute(element, at)

    solves = tuple(
        replace(
            solve,
            matrix=tuple(tuple(map(move, row)) for row in solve.matrix),
            known=tuple(map(move, solve.known)),
        )
        for solve in onto.solves
    )
    onto_definitions = ((name, move(value)) for name, value in onto.definitions)
    return replace(
        onto,
        definitions=(*((names[name], x) for name, x in back.items()), *onto_definitions),
        rates=tuple(map(move, onto.rates)),
        solves=solves,
        residuals=(),
    )


def _nearest_contact(setting: Setting, of: Distribution, exact: Exact) -> Exact:
    """The points of contact moved back onto the surfaces; see `Touch.nearest`."""
    touch, field, known = of.frame.touch, setting.field, kinematics(setting).decided
    assert touch is not None, "asked for only of bodies that touch a surface"
    steps, after = touch.nearest(known.value)
    named = (*touch.missed, *steps)
    state = tuple(after.get(name, field[name]) for name in setting.state)
    needed = [*state, *(value for _, value in (*named, *exact.residuals))]
    return Exact(
        definitions=(*definitions_under(field, exact.definitions, needed), *named),
        rates=state,
        energy=None,
        emitted=(),
        poisson_tensor=None,
        residuals=exact.residuals,
    )


def _residuals(of: Distribution) -> list[Element]:
    """What vanishes on the constraints that are kept, in eta, with entries by their names."""
    field, eta = of.setting.field, of.setting.elements(of.independent)
    name = kinematics(of.setting).name_of_entry
    named = [[name(entry) for entry in row] for row in of.kept_rows]
    return [field.sum([*(a * x for a, x in zip(row, eta, strict=True)), b]) for *row, b in named]
