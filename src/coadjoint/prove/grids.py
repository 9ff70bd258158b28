"""Claims about fields on a grid: what differences keep exactly, and what they do not.

Comes in: a `Grid`. Goes out: statements. The energy is kept since the matrix of the bracket is
antisymmetric. Other sums are kept if the variation of their rate over an endless grid vanishes;
what is no sum of differences changes by terms of the order of the differences. The Jacobi identity
of a bracket with differences fails by Leibniz' rule, which no difference obeys, and a number says
by how much.
Read next: `coadjoint.prove.fields`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Final

from coadjoint.derive import Equations
from coadjoint.derive.fields.grid import Grid
from coadjoint.derive.fields.lattice import name_at
from coadjoint.derive.fields.structure import field_operator
from coadjoint.derive.records import Kept
from coadjoint.exact import Element
from coadjoint.poisson.jacobi import schouten_bracket, slopes_by
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.fluxes import decide_law
from coadjoint.prove.leibniz import tell_defect
from coadjoint.prove.zero import Decision, Discovery, Examined, decide_zero, give
from coadjoint.spec.core.members import member_name

#: Why Fourier derivatives do not obey Leibniz' rule.
WAVES_FAIL: Final = (
    "a product of two fields may have waves that N points show as others, of which Leibniz' rule "
    "fails"
)


def about_grid(grid: Grid) -> Iterator[Examined]:
    """What is proved of fields at N points."""
    first, family = grid.equations, grid.family
    space = first.spec.space
    assert space is not None, first.spec.name
    where = f"at N >= {family.small} points, with differences of order {space.order}"
    where += f" and of order {space.order // 2} near {space.ends} ends" * space.has_ends
    rings = "lines" if space.has_ends else "rings"
    sizes = " and ".join(str(count_points(each, grid)) for each in grid.windows)
    yield (
        f"the motion of the generic point is that of {rings} of {sizes} points by their matrices",
        "equivalence",
        lambda: _compare_rings(grid),
    )
    yield f"the energy is conserved, {where}", "conserved", lambda: _decide_energy(grid)
    if not space.has_ends:
        yield (
            "the energy is conserved, at N points, with Fourier derivatives",
            "conserved",
            lambda: _decide_by_parts(grid),
        )
    yield from _about_sums(grid, where)
    yield from _about_jacobi(grid, where)


def count_points(ring: Equations, grid: Grid) -> int:
    """How many points a ring has."""
    return len(ring.spec.state) // len(grid.declared.variables)


# -- the motion -------------------------------------------------------------------------------


def _compare_rings(grid: Grid) -> Decision:
    """Differences of the rates of the generic point, seen in rings, and those of the rings."""
    decisions = [decide_zero(_differences(grid, each), each.setting.field) for each in grid.windows]
    return next((d for d in decisions if d.verdict is not Verdict.PROVED), decisions[0])


def _differences(grid: Grid, ring: Equations) -> list[Element]:
    """Of each point of a ring and each field: the rate by the generic point minus its own.

    On a circle the brackets with all points, too: those of the generic point are antisymmetric.
    """
    field, size = ring.setting.field, count_points(ring, grid)
    own = dict(zip(ring.setting.state, ring.exact.rates, strict=True))
    known = {each.name: each for each in ring.spec.variables}
    reach, lattice = max(map(abs, grid.family.shifts), default=0), grid.lattice.field
    names = {
        (c, k): name
        for v in grid.equations.spec.state
        for k in range(size)
        for c, name in zip(v.components, known[member_name(v.name, k)].components, strict=True)
    }
    values = {name: field[name] for name in ring.setting.parameters}
    values[grid.count] = field.number(size)
    known_at = {(c, k): field[name] for (c, k), name in names.items()}
    known_at |= grid.velocities[size]
    tensor = ring.exact.poisson_tensor
    assert tensor is not None, ring.spec.name
    pairs = {
        (a, b): x
        for a, row in zip(ring.setting.state, tensor, strict=True)
        for b, x in zip(ring.setting.state, row, strict=True)
        if x and not grid.ends
    }
    space, found = grid.equations.spec.space, list[Element]()
    assert space is not None, grid.equations.spec.name
    inverse = field.number(size) / field[space.length]
    for k in range(size):
        seen = values | {
            name_at(c, r): known_at[c, (k + r) % size]
            for c in grid.lattice.components
            for r in range(-reach, reach + 1)
        }
        rates = grid.ends.get(k, grid.ends.get(k - size, grid.rates))
        for c, rate in zip(grid.equations.setting.state, rates, strict=True):
            value = lattice.evaluate(rate, seen, field.number, field.call)
            found.append(value - own[names[c, k]])
        for (a, b, r), bracket in grid.brackets.items() if not grid.ends else ():
            value = lattice.evaluate(bracket, seen, field.number, field.call) * inverse
            found.append(value - pairs.pop((names[a, k], names[b, (k + r) % size]), field.zero))
    return [*found, *pairs.values()]


# -- what is kept -----------------------------------------------------------------------------


def _decide_energy(grid: Grid) -> Decision:
    """The matrix of the bracket is antisymmetric; rates are this matrix times the gradient.

    That is seen at the generic point: the bracket with a neighbour is minus that of the neighbour
    with the point, whatever the differences are.
    """
    lattice = grid.lattice
    if grid.ends:
        return _decide_energy_of_lines(grid)
    defects = list[Element]()
    for (a, b, r), value in grid.brackets.items():
        back = grid.brackets.get((b, a, -r), lattice.field.zero)
        defects.append(value + lattice.shift(back, r))
    decision = decide_zero(defects, lattice.field)
    method = (
        f"{decision.method}: the matrix of the bracket is antisymmetric at the generic point, and "
        "rates are this matrix times the gradient of the energy"
    )
    return replace(decision, method=method)


def _decide_energy_of_lines(grid: Grid) -> Decision:
    """The same for two lines: of longer ones each pair of points is like one of these.

    Points near one end, those inside and those near the other are coupled to themselves and to the
    next group there, since no difference reaches further.
    """
    decisions = list[Decision]()
    for line in grid.windows:
        tensor, size = line.exact.poisson_tensor, len(line.setting.state)
        assert tensor is not None, line.spec.name
        defects = [tensor[i][j] + tensor[j][i] for i in range(size) for j in range(i + 1)]
        decisions.append(decide_zero([x for x in defects if x], line.setting.field))
    decision = next((d for d in decisions if d.verdict is not Verdict.PROVED), decisions[0])
    method = (
        f"{decision.method}: the matrix of the bracket is antisymmetric with the weights of the "
        "energy, points near both ends and inside among them, and rates are this matrix times the "
        "gradient of the energy"
    )
    return replace(decision, method=method)


def _decide_by_parts(grid: Grid) -> Decision:
    """The matrix of the bracket is antisymmetric whatever D_k are, if they sum by parts."""
    decision = decide_zero(list(grid.defects), grid.lattice.field)
    method = (
        f"{decision.method}: terms f D_k g of the bracket are minus those of its adjoint, and the "
        "matrix of D_k is real and has the transpose (-1)^k D_k"
    )
    return replace(decision, method=method)


def _about_sums(grid: Grid, where: str) -> Iterator[Examined]:
    """The other sums that the fields conserve."""
    kept = {each.name: each.kept for each in grid.windows[0].exact.emitted}
    space = grid.equations.spec.space
    assert space is not None, grid.equations.spec.name
    for each in grid.equations.exact.emitted:
        if each.kept is not Kept.ALWAYS:
            continue
        yield from _about_fourier_sum(grid, each.name)
        if kept[each.name] is Kept.ALWAYS:
            method = "the variation of its rate over the points of an endless grid is 0"
            decision = Decision(verdict=Verdict.PROVED, method=method)
            yield f"{each.name} is conserved, {where}", "conserved", partial(give, decision)
            continue
        law, along = decide_law(grid.equations, each.values)
        if law.verdict is not Verdict.PROVED:
            continue  # what the field changes has no order
        found = Discovery(grid.changes[each.name], "on the grid")
        yield (
            f"{each.name} is conserved up to O(h^{space.order}) by N points, h = L/N"
            f"{',' * bool(along)}{along}",
            "conserved",
            partial(give, found),
        )


def _about_fourier_sum(grid: Grid, name: str) -> Iterator[Examined]:
    """That Fourier derivatives keep a sum; nothing where they need not."""
    field, defects = grid.lattice.field, grid.sums.get(name, ())
    if name not in grid.sums or not all(map(field.is_zero, defects)):
        return
    decision = decide_zero(list(defects), field)
    method = (
        f"{decision.method}: its rate is a sum of f(i) D_k[i, j] g(j) in which f(i) g(j) and "
        "(-1)^k f(j) g(i) cancel but for functions of one point, and D_k, which takes constants "
        "to 0, has the transpose (-1)^k D_k"
    )
    statement = f"{name} is conserved, at N points, with Fourier derivatives"
    yield statement, "conserved", partial(give, replace(decision, method=method))


def _about_jacobi(grid: Grid, where: str) -> Iterator[Examined]:
    """Whether the bracket at N points is a Poisson bracket."""
    ring = grid.windows[0]
    field, tensor = ring.setting.field, ring.exact.poisson_tensor
    assert tensor is not None, ring.spec.name
    operator = field_operator(grid.equations.setting)
    pointwise = all(not t.order for row in operator for entry in row for t in entry)
    found = schouten_bracket(tensor, slopes_by(field, ring.setting.state))
    defects = {triple: x for triple, x in found.items() if not field.is_zero(x)}
    size = count_points(ring, grid)
    if not defects and (pointwise or is_constant(tensor, ring)):
        method = f"normal form, for {size} points; points commute" if pointwise else "constants"
        decision = Decision(verdict=Verdict.PROVED, method=method)
        yield f"the bracket satisfies the Jacobi identity, {where}", "jacobi", lambda: decision
        return
    if not defects:
        method = f"normal form, for {size} points"
        discovery = Discovery(method, f"for {size} points")
        yield "the bracket satisfies the Jacobi identity", "jacobi", lambda: discovery
        return
    triple = ", ".join(ring.setting.state[n] for n in next(iter(defects)))
    by = "" if grid.ends else f" by O(h^{_order(grid)})"  # near ends it is less
    yield (
        f"the Jacobi identity of the bracket fails at N points{by}",
        "jacobi",
        partial(
            _measure,
            grid,
            f"differences do not obey Leibniz' rule, of the triple {triple} and others",
        ),
    )
    if not grid.ends:
        yield (
            "the Jacobi identity of the bracket fails at N points with Fourier derivatives",
            "jacobi",
            partial(_measure, grid, WAVES_FAIL, by_waves=True),
        )


def _measure(grid: Grid, reason: str, *, by_waves: bool = False) -> Discovery:
    """By how much the Jacobi identity fails, at so many points and about such fields."""
    told = tell_defect(grid, by_waves=by_waves)
    return Discovery(f"{reason}: {told}", "for these functions and fields, in doubles")


def is_constant(tensor: Sequence[Sequence[Element]], ring: Equations) -> bool:
    """Whether the brackets of a ring do not depend on the fields."""
    state = {*ring.setting.state}
    return not any(ring.setting.field.reach(x) & state for row in tensor for x in row)


def _order(grid: Grid) -> int:
    space = grid.equations.spec.space
    assert space is not None, grid.equations.spec.name
    return space.order
