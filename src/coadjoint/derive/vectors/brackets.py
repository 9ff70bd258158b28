r"""Equations as one bracket: a commutator of matrices of the algebra, or a Jacobian in a plane.

Where a momentum w has components along the basis E_k of an algebra of matrices, the coadjoint
motion is a commutator, :math:`\dot W = [W, V]` with :math:`w_k = -\mathrm{tr}(W E_k)` and
:math:`V = \sum_k \xi_k E_k`. The vorticity of a fluid in the plane moves by
:math:`\dot w = \{\psi, w\}`. Both are shown only if they are, component by component, what was
derived.

Comes in: Equations. Goes out: lines, or none. Read next: `coadjoint.derive.vectors.form`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from coadjoint.algebra.matrices import SparseMatrix, commutator, size
from coadjoint.derive.equations import Equations
from coadjoint.derive.fields.jets import jets_of
from coadjoint.derive.vectors.lines import VectorLine, list_taken, rate_of
from coadjoint.exact.linear import Span
from coadjoint.spec.core import tree
from coadjoint.spec.model import Variable

#: Rows of matrices beyond which their commutators are not worked out.
MOST_ROWS = 10
#: What lines call the basis of the algebra.
BASIS = "E"


def commutator_lines(equations: Equations, momentum: Variable) -> list[VectorLine]:
    """The equation of a momentum as a commutator of matrices; none where it is not one."""
    setting, spec = equations.setting, equations.spec
    if spec.algebra is None or momentum.of:  # of a coordinate, which no matrices turn
        return []
    field, matrices, names = setting.field, setting.algebra.matrices, momentum.components
    velocities = [v for v in spec.having_role("velocity") if v.block == momentum.block]
    if len(velocities) != 1 or momentum.elements or len(names) != len(matrices):
        return []
    if size(matrices) > MOST_ROWS or list_taken(spec) & {"W", "V", BASIS, "k"}:
        return []
    w = setting.elements(names)
    xi = [equations.close(each) for each in setting.elements(velocities[0].components)]
    rates = dict(zip(equations.variables, equations.exact.rates, strict=True))
    found = [
        field.sum([number * w[m] * xi[b] for (m, b), number in row.items()])
        for row in weigh_commutators(matrices)
    ]
    for sign, sides in ((1, "WV"), (-1, "VW")):
        given = [sign * equations.close(rates[name]) for name in names]
        if found and all(field.is_zero(a - b) for a, b in zip(given, found, strict=True)):
            return _write_commutator(momentum.name, velocities[0].name, sides)
    return []


def weigh_commutators(matrices: Sequence[SparseMatrix]) -> list[dict[tuple[int, int], Fraction]]:
    r"""The factors of :math:`w_m \xi_b` in :math:`-\mathrm{tr}([W, V] E_k)`, for each k.

    Empty where not every w is one of :math:`-\mathrm{tr}(W E_k)` for a W of the algebra.

    >>> planes = [{(2, 1): 1, (1, 2): -1}, {(0, 2): 1, (2, 0): -1}, {(1, 0): 1, (0, 1): -1}]
    >>> sorted((mb, int(x)) for mb, x in weigh_commutators(planes)[0].items())
    [((1, 2), 1), ((2, 1), -1)]
    """
    numbers = range(len(matrices))
    span = Span({j: -_trace(e, other) for j, other in enumerate(matrices)} for e in matrices)
    duals = [span.coordinates({m: 1}) for m in numbers]
    if span.dependent:
        return []
    rows = [dict[tuple[int, int], Fraction]() for _ in numbers]
    brackets = {(j, b): commutator(matrices[j], matrices[b]) for j in numbers for b in numbers}
    for k, row in enumerate(rows):
        traces = {at: -_trace(each, matrices[k]) for at, each in brackets.items() if each}
        for m, dual in enumerate(duals):
            for (j, b), trace in traces.items():
                if trace and dual and j in dual:
                    row[m, b] = row.get((m, b), Fraction(0)) + dual[j] * trace
    return [{at: number for at, number in row.items() if number} for row in rows]


def _trace(a: SparseMatrix, b: SparseMatrix) -> Fraction:
    """The trace of a product."""
    return sum((x * b.get((c, r), 0) for (r, c), x in a.items()), Fraction(0))


def _write_commutator(momentum: str, velocity: str, sides: str) -> list[VectorLine]:
    """The commutator, with what stands in it."""
    E, w, xi = (
        tree.Entry(name=name, subscripts=(tree.Name("k"),)) for name in (BASIS, momentum, velocity)
    )
    W, V = tree.Name("W"), tree.Name("V")
    of = tree.Call(function="commutator", arguments=tuple(map(tree.Name, sides)))
    product = tree.Binary(operator="*", left=W, right=E)
    trace = tree.Call(function="trace", arguments=(product,))
    term = tree.Binary(operator="*", left=xi, right=E)
    return [
        VectorLine(rate_of(W), of),
        VectorLine(w, tree.Negate(operand=trace)),
        VectorLine(V, tree.Sum(indices=("k",), term=term)),
    ]


def plane_lines(equations: Equations) -> list[VectorLine]:
    """The motion of a vorticity as the Jacobian of the stream function and of it; else none."""
    setting, spec = equations.setting, equations.spec
    if not spec.in_plane or spec.space is None or spec.space.across is None:
        return []
    field, lagrangian = setting.field, setting.lagrangian
    x, y = spec.space.name, spec.space.across.name
    (psi,), (w,) = (v.components for v in spec.having_role("velocity")), setting.state
    psi_x, psi_y, w_x, w_y = (field[f"{of}_{by}"] for of in (*psi, w) for by in (x, y))
    if not field.is_zero(equations.exact.rates[0] - (psi_x * w_y - psi_y * w_x)):
        return []
    stream, vorticity = tree.Name(psi[0]), tree.Name(w)
    jacobian = tree.Call(function="jacobian", arguments=(stream, vorticity))
    first, second = (
        tree.Binary(operator="*", left=tree.Name(f"{psi[0]}_{a}"), right=tree.Name(f"{w}_{b}"))
        for a, b in ((x, y), (y, x))
    )
    lines = [
        VectorLine(rate_of(vorticity), jacobian),
        VectorLine(jacobian, tree.Binary(operator="-", left=first, right=second)),
    ]
    slope = jets_of(setting).euler(lagrangian, psi[0])
    if field.is_zero(slope + field[f"{psi[0]}_{x}{x}"] + field[f"{psi[0]}_{y}{y}"]):
        laplacian = tree.Call(function="laplacian", arguments=(stream,))
        lines.append(VectorLine(vorticity, tree.Negate(operand=laplacian)))
    return lines
