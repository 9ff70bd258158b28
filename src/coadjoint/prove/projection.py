r"""The projection onto constraints that are kept: that it arrives, moves least, and moves no more.

Nothing is solved here. The residuals R are affine, and so is the condition of the least change
:math:`M d + A^T u = 0`, with M the second derivative of the constrained Lagrangian and A that of
R: put into them, the projected state gives the very rows that the kernel solves, line by line.
Comes in: Equations with constraints that are kept. Goes out: claims for the certificate.
Read next: `coadjoint.solve.constraints`, which uses it.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.distribution import Distribution
from coadjoint.derive.mechanics.kinematics import moved_names, multiplier_name, shift_name
from coadjoint.derive.mechanics.solution_defects import solution_defects
from coadjoint.derive.mechanics.turning import turned_back
from coadjoint.exact import Element
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.zero import Decision, Examined, decide_zero


def about_projection(first: Equations) -> Iterator[Examined]:
    """Three claims where constraints are kept, one more with attitudes; none elsewhere."""
    onto = first.onto_constraints if first.spec.turning else first.projection
    if onto is None:
        return
    turning = ", ".join(each.name for each in first.spec.turning)
    if turning:
        yield (
            f"the projection moves {turning} back first, then the state onto the constraints at "
            f"the moved {turning}, and this second move leaves {turning} as it is",
            "constraint",
            partial(_composition, first),
        )
    distribution = onto.distribution
    assert distribution is not None
    if not distribution.kept:  # points of contact: see `coadjoint.prove.rolling`
        return
    names = ", ".join(equation.name for equation, _ in distribution.kept)
    then = f"once {turning} is moved back, " if turning else ""
    arrives = f"the projection moves every state onto {names}, where its equations are regular"
    yield then + arrives, "constraint", partial(_arrival, onto)
    least = "the kinetic energy of the change is stationary: the least one where kinetic energy is"
    if mechanics(distribution.setting).bending:
        least = "d . M d of the change d is stationary, M being d2l_c/deta2 before it: the least "
        least += "one where M is"
    yield (
        f"{then}the projection changes velocities alone, and {least} positive",
        "constraint",
        partial(_least, onto),
    )
    yield (
        f"{then}the projection leaves a state on the constraints",
        "constraint",
        partial(_rest, onto),
    )


def _composition(first: Equations) -> list[Element]:
    """All that is computed minus what each of the two moves computes, by the names before.

    Also what the second move changes of attitudes, and those before that it still reads.
    """
    whole, onto, field = first.projection, first.onto_constraints, first.setting.field
    assert whole is not None, "there is an attitude"
    assert onto is not None, "asked for only where constraints are kept"
    back, names = turned_back(first.setting), moved_names(first.spec)
    given = {moved: field[name] for name, moved in names.items()}
    made = [*whole.exact.definitions, *zip(first.setting.state, whole.exact.rates, strict=True)]
    wanted = [(names[name], value) for name, value in back.items()]
    count = len(wanted)
    wanted += [*onto.exact.definitions, *zip(first.setting.state, onto.exact.rates, strict=True)]
    if [name for name, _ in made] != [name for name, _ in wanted]:
        return [field.one]
    left = dict(zip(onto.setting.state, onto.exact.rates, strict=True))
    moved = [x if n < count else field.substitute(x, given) for n, (_, x) in enumerate(made)]
    return [
        *(x - y for x, (_, y) in zip(moved, wanted, strict=True)),
        *(left[name] - field[name] for name in names),
        *(field[name] for _, x in made[count:] for name in names if name in field.reach(x)),
    ]


def _arrival(projection: Equations) -> list[Element]:
    """Residuals after, minus the rows of the solve that give them; then defects of the solve."""
    field, rows = projection.setting.field, _rows(projection)
    after = dict(zip(projection.setting.state, projection.exact.rates, strict=True))
    definitions = dict(projection.exact.definitions)
    defects = [
        projection.close(field.substitute(residual, after)) - rows[multiplier_name(n)]
        for n, (_, residual) in enumerate(_kept_constraints(projection).kept)
    ]
    return defects + [
        defect
        for solve in projection.exact.solves
        for defect in solution_defects(field, solve, definitions)
    ]


def _least(projection: Equations) -> list[Element]:
    """``M d + A^T u`` minus the rows of the solve that make it vanish; changes of positions."""
    field, distribution = projection.setting.field, _kept_constraints(projection)
    after = zip(projection.setting.state, projection.exact.rates, strict=True)
    changes = {name: value - field[name] for name, value in after}
    rows, eta = _rows(projection), distribution.independent
    energy = field.substitute(projection.setting.lagrangian, distribution.solved)
    defects = [change for name, change in changes.items() if name not in eta]
    for place, (name, slope) in enumerate(zip(eta, field.gradient(energy, eta), strict=True)):
        mass = zip(field.gradient(slope, eta), eta, strict=True)
        pulls = (
            field.derivative(residual, name) * field[multiplier_name(n)]
            for n, (_, residual) in enumerate(distribution.kept)
        )
        total = field.sum([*(m * changes[other] for m, other in mass), *pulls])
        defects.append(total - rows.get(shift_name(place), field.zero))
    return defects


def _rest(projection: Equations) -> Decision:
    """The right sides, which vanish on the constraints: the change solves ``K d = 0`` there."""
    sides = [projection.close(k) for solve in projection.exact.solves for k in solve.known]
    motion = ConstrainedRates(projection)
    return decide_zero(sides, motion.field, motion.where)


def _kept_constraints(projection: Equations) -> Distribution:
    assert projection.distribution is not None, "asked for only where constraints are kept"
    return projection.distribution


def _rows(projection: Equations) -> dict[str, Element]:
    """``A x - b`` of the solves by the name of the unknown of the row, in the state and x."""
    field, close = projection.setting.field, projection.close
    rows = {}
    for solve in projection.exact.solves:
        x = projection.setting.elements(solve.names)
        for name, row, known in zip(solve.names, solve.matrix, solve.known, strict=True):
            left = field.sum(close(a) * value for a, value in zip(row, x, strict=True))
            rows[name] = left - close(known)
    return rows
