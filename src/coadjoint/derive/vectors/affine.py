r"""Motion on the dual of an algebra of affine maps, by matrices.

An algebra whose matrices are :math:`\begin{pmatrix} A & v \\ 0 & 0 \end{pmatrix}` has momenta
:math:`(\mu, p)` with the pairing :math:`\mathrm{tr}(\mu^TA) + p\cdot v`, and moves them by (Holm
2011, section 6.5)

.. math:: \dot\mu = [A^T, \mu] - p \otimes v, \qquad \dot p = A^T p,

where of :math:`p \otimes v` the part stays that the algebra has: that without a trace if all A have
none. It is shown only if it is, component by component, what was derived.

Comes in: Equations. Goes out: lines, or none. Read next: `coadjoint.derive.vectors.form`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from coadjoint.algebra.matrices import SparseMatrix, size
from coadjoint.derive.equations import Equations
from coadjoint.derive.interpret import Value
from coadjoint.derive.setting import weigh
from coadjoint.derive.vectors.gradients import Addend, total_of, write_polynomial
from coadjoint.derive.vectors.lines import VectorLine, list_taken, rate_of
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import apply, commutator, subtract, transpose
from coadjoint.exact.linear import Span
from coadjoint.spec.core import tree
from coadjoint.spec.model import Variable

#: What lines call the momentum and the velocity.
LETTERS = ("mu", "A")


@dataclass(frozen=True)
class AffineParts:
    """An algebra of affine maps.

    Attributes:
        turning: The matrices A of its linear part, with the places of their basis vectors.
        momentum: The momentum of translations.
        velocity: Their velocity.
        rows: How many the matrices A have.
    """

    turning: dict[int, SparseMatrix]
    momentum: Variable
    velocity: Variable
    rows: int


def affine_lines(equations: Equations) -> tuple[list[VectorLine], frozenset[str]]:
    """The lines, and the names of the momenta that are entries of their matrix."""
    setting, parts = equations.setting, _find_parts(equations)
    if parts is None:
        return [], frozenset()
    field, sign = setting.field, setting.sign
    places = list(parts.turning)
    names = [setting.momenta[k] for k in places]
    matrices = list(parts.turning.values())
    rates = dict(zip(equations.variables, map(equations.close, equations.exact.rates), strict=True))
    mu = weigh_dual(setting.elements(names), matrices, parts.rows)
    shown = weigh(setting.elements([setting.velocities[k] for k in places]), matrices)
    p = setting.elements(parts.momentum.components)
    A = tuple(tuple(map(equations.close, row)) for row in shown)
    v = tuple(map(equations.close, setting.elements(parts.velocity.components)))
    rest = subtract(commutator(transpose(A), mu), tuple(tuple(a * b for b in v) for a in p))
    right = [sign * field.sum(rest[i][j] * x for (i, j), x in e.items()) for e in matrices]
    moved = [sign * each for each in apply(transpose(A), p)]
    given = [rates[n] for n in (*names, *parts.momentum.components)]
    if not all(field.is_zero(a - b) for a, b in zip(given, [*right, *moved], strict=True)):
        return [], frozenset()
    lines = _write(parts, sign)
    for letter, value in zip(LETTERS, (mu, shown), strict=True):
        written = _write_matrix(field, value)
        if written is None:
            return [], frozenset()
        lines.append(VectorLine(tree.Name(letter), written))
    return lines, frozenset(names)


def _find_parts(equations: Equations) -> AffineParts | None:
    """The parts of an algebra whose linear part is gl(n) or sl(n), its momenta by components."""
    setting, spec = equations.setting, equations.spec
    if spec.algebra is None or not (setting.velocities and setting.momenta):
        return None
    if not setting.algebra.matrices:
        return None
    matrices = setting.algebra.matrices
    n = size(matrices) - 1
    columns = [{j for _, j in each} for each in matrices]
    turning = {k: m for k, m in enumerate(matrices) if n not in columns[k]}
    moving = [k for k in range(len(matrices)) if k not in turning]
    names = [setting.momenta[k] for k in moving]
    momentum = next((q for q in spec.state if [*q.components] == names), None)
    names = [setting.velocities[k] for k in moving]
    velocity = next((q for q in spec.variables if [*q.components] == names), None)
    traces = [sum(x for (i, j), x in each.items() if i == j) for each in turning.values()]
    whole = len(turning) - n * n + (0 if any(traces) else 1)
    if (
        momentum is None
        or velocity is None
        or whole
        or [matrices[k] for k in moving] != [{(i, n): 1} for i in range(n)]
        or any(i == n for each in matrices for i, _ in each)
        or not list_taken(spec).isdisjoint(LETTERS)
    ):
        return None
    return AffineParts(turning, momentum, velocity, n)


def weigh_dual(
    momenta: Sequence[Element], matrices: Sequence[SparseMatrix], rows: int
) -> tuple[tuple[Element, ...], ...]:
    r"""The matrix :math:`\mu` among some with :math:`\mathrm{tr}(\mu^T E_k) = w_k`."""
    span = Span(
        {j: sum(x * other.get(at, 0) for at, x in e.items()) for j, other in enumerate(matrices)}
        for e in matrices
    )
    zero = 0 * momenta[0]
    found = [[zero] * rows for _ in range(rows)]
    for m, w in enumerate(momenta):
        for k, factor in (span.coordinates({m: Fraction(1)}) or {}).items():
            for (i, j), x in matrices[k].items():
                found[i][j] += factor * x * w
    return tuple(map(tuple, found))


def _write(parts: AffineParts, sign: int) -> list[VectorLine]:
    """The equations, of the sign of a side."""
    mu, A = map(tree.Name, LETTERS)
    p, v = tree.Name(parts.momentum.name), tree.Name(parts.velocity.name)
    turned = tree.Call(function="transpose", arguments=(A,))
    sides = (turned, mu) if sign > 0 else (mu, turned)
    right = [
        Addend(vector=tree.Call(function="commutator", arguments=sides)),
        Addend(Fraction(-sign), vector=tree.Call(function="outer", arguments=(p, v))),
    ]
    if len(parts.turning) < parts.rows**2:
        trace = tree.Call(function="dot", arguments=(p, v))
        ones = (tree.Number(Fraction(1)),) * parts.rows
        along = tree.Call(function="vector", arguments=ones)
        one = tree.Call(function="diag", arguments=(along,))
        right.append(Addend(Fraction(sign, parts.rows), (trace,), vector=one))
    moved = Addend(Fraction(sign), vector=tree.Binary(operator="*", left=turned, right=p))
    return [VectorLine(rate_of(mu), total_of(right)), VectorLine(rate_of(p), total_of([moved]))]


def _write_matrix(field: Field, value: Value) -> tree.Node | None:
    """A matrix of polynomials by its rows."""
    rows = list[tree.Node]()
    for row in value:
        written = [write_polynomial(field, each) for each in row]
        entries = tuple(each for each in written if each is not None)
        if len(entries) < len(row):
            return None
        rows.append(tree.Call(function="vector", arguments=entries))
    return tree.Call(function="rows", arguments=tuple(rows))
