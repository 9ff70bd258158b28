r"""The matrix Euler-Poincare route: products of matrices in the place of structure constants.

Theorem (Holm 2011, section 2.4.3): for a left-invariant system on a group of matrices, with the
variations :math:`\delta\xi = \dot\eta + \xi\eta - \eta\xi` and :math:`\delta S = -(\eta S +
S\eta^T)`, Hamilton's principle is

.. math::
    \tfrac{d}{dt} \mathrm{tr}(M^T e) = \mathrm{tr}\big(M^T (\xi e - e \xi)\big)
        - \mathrm{tr}\big(G (e S + S e^T)\big), \qquad \dot S = -(\xi S + S \xi^T)

for every matrix e of the algebra, with :math:`M = \partial l/\partial\xi` in the span of these and
:math:`G = \partial l/\partial S`; on so(n) it is :math:`\dot M = [M, \Omega]`. Vectors and square
matrices move by products with :math:`\xi`, too; right-invariant systems run the other way.
Comes in: a Setting with a Lagrangian on an algebra of matrices. Goes out: Equations.
Read next: `coadjoint.derive.routes.manakov`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from coadjoint.algebra.matrices import SparseMatrix, pair
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.emission import emit_in_momenta, show_velocities
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.records import Step, sign_text, write_rates, write_slopes, write_step
from coadjoint.derive.refusals import refusal
from coadjoint.derive.setting import Setting, weigh
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Matrix, add, commutator, product, scale, transpose
from coadjoint.exact.linear import Span
from coadjoint.spec.core.faults import list_names
from coadjoint.spec.model import Variable, unpack

ROUTE = "matrix-euler-poincare"
#: A rate and a matrix C whose trace tr(C e) is the torque along e.
Advection = Callable[[Matrix, Matrix, Matrix], tuple[Matrix, Matrix]]


def derive(setting: Setting) -> Equations:
    """Equations of motion by products of matrices.

    Raises:
        DerivationError: The algebra is not given by matrices, a quantity is advected in another
            way, or the Lagrangian has no invertible Legendre transform.
    """
    _check_matrices(setting)
    rates = _rates(setting)
    return emit_in_momenta(setting, ROUTE, rates, _steps(setting, rates))


def _check_matrices(setting: Setting) -> None:
    if not setting.algebra.matrices:
        name = setting.algebra.name
        raise refusal(
            setting,
            ROUTE,
            f"{name} has no matrices whose commutators are its brackets",
            name,
            "an algebra that is declared by matrices, or by name",
            "Declare it by matrices.",
        )


def _rates(setting: Setting) -> tuple[Element, ...]:
    """Right-hand sides in state, velocities and parameters, in the order of the state."""
    field, sign = setting.field, setting.sign
    xi = weigh(setting.elements(setting.velocities), setting.algebra.matrices)
    M = _momentum(setting)
    # tr(M^T (xi e - e xi)) = tr((M^T xi - xi M^T) e)
    torque = commutator(transpose(M), xi)
    advected: dict[str, Sequence[Element]] = {}
    for variable in setting.advected:
        move = _advection(setting, variable)
        a = _as_matrix(setting, variable, setting.elements(variable.components))
        slopes = field.gradient(setting.lagrangian, variable.components)
        speed, push = move(xi, a, _slope_matrix(setting, variable, slopes))
        torque = add(torque, push)
        advected[variable.name] = [sign * x for x in _kept_entries(variable, speed)]
    along = [sign * _trace_with(field, torque, e) for e in setting.algebra.matrices]
    return setting.in_state_order(along, advected)


def _momentum(setting: Setting) -> Matrix:
    """M in the span of the e_i with ``tr(M^T e_i) = mu_i``, by the Gram matrix of the basis."""
    basis = setting.algebra.matrices
    gram = [{j: value for j, b in enumerate(basis) if (value := pair(a, b)) != 0} for a in basis]
    span, mu = Span(gram), setting.elements(setting.momenta)
    weights = []
    for place in range(len(basis)):
        inverse = span.coordinates({place: 1})
        assert inverse is not None, "the matrices of a basis are independent"
        weights.append(setting.field.sum(mu[n] * value for n, value in inverse.items()))
    M: Matrix = weigh(weights, setting.algebra.matrices)
    return M


def _trace_with(field: Field, a: Matrix, e: SparseMatrix) -> Element:
    """``tr(a e)``."""
    return field.sum(a[j][i] * value for (i, j), value in e.items())


# -- advected quantities --------------------------------------------------------------------------


def _column(xi: Matrix, a: Matrix, b: Matrix) -> tuple[Matrix, Matrix]:
    """``da/dt = -xi a``, and ``-tr(b^T e a)``."""
    return scale(-1, product(xi, a)), scale(-1, product(a, transpose(b)))


def _rows(xi: Matrix, a: Matrix, b: Matrix) -> tuple[Matrix, Matrix]:
    """``da/dt = a xi``, and ``tr(b^T a e)``."""
    return product(a, xi), product(transpose(b), a)


def _symmetric(xi: Matrix, a: Matrix, b: Matrix) -> tuple[Matrix, Matrix]:
    """``da/dt = -(xi a + a xi^T)``, and ``-tr(b (e a + a e^T)) = -2 tr(a b e)``."""
    moved = product(xi, a)
    return scale(-1, add(moved, transpose(moved))), scale(-2, product(a, b))


_ADVECTIONS: dict[str, Advection] = {
    "vector": _column,
    "defining": _column,
    "columns": _column,
    "rows": _rows,
    "symmetric": _symmetric,
}


def _advection(setting: Setting, variable: Variable) -> Advection:
    action = setting.actions[variable.name]
    # the vectors of se(3), say, are turned but not moved by its matrices
    foreign = action.name == "vector" and action.matrices != setting.algebra.matrices
    if action.name not in _ADVECTIONS or foreign:
        raise refusal(
            setting,
            ROUTE,
            f"{variable.name} is advected by the representation {action.name!r}",
            action.name,
            f"products with the matrices of {setting.algebra.name}: {list_names(_ADVECTIONS)}",
        )
    return _ADVECTIONS[action.name]


def _as_matrix(setting: Setting, variable: Variable, values: Sequence[Element]) -> Matrix:
    """Components as a column, a symmetric or a square matrix."""
    name = setting.actions[variable.name].name
    if name in ("vector", "defining"):
        return tuple((value,) for value in values)
    return unpack(values, "symmetric" if name == "symmetric" else "matrix")


def _slope_matrix(setting: Setting, variable: Variable, slopes: Sequence[Element]) -> Matrix:
    """``b`` with ``dl = tr(b^T da)``: entries off the diagonal of symmetric ones count twice."""
    b = _as_matrix(setting, variable, slopes)
    if setting.actions[variable.name].name != "symmetric":
        return b
    half = setting.field.one / 2
    return tuple(
        tuple(x if i == j else half * x for j, x in enumerate(row)) for i, row in enumerate(b)
    )


def _kept_entries(variable: Variable, a: Matrix) -> list[Element]:
    """The components of a matrix, in the order of the variable."""
    symmetric = variable.representation is not None and variable.representation.name == "symmetric"
    return [x for i, row in enumerate(a) for j, x in enumerate(row) if j >= i or not symmetric]


def _steps(setting: Setting, rates: tuple[Element, ...]) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    sign = "" if setting.sign == 1 else "-"
    turned = sign_text(setting.sign, "tr(M^T (xi e - e xi)) + tr((dl/da)^T delta a)")
    turned_latex = sign_text(
        setting.sign,
        r"\mathrm{tr}(M^\top (\xi e - e \xi)) "
        r"+ \mathrm{tr}((\partial l/\partial a)^\top \delta a)",
    )
    return (
        write_step(
            "Momentum matrix in the span of the algebra",
            "tr(M^T e) = dl/dxi along each matrix e of the basis",
            r"\mathrm{tr}(M^\top e) = \langle \partial l / \partial \xi, e \rangle",
            write_slopes("l", setting.velocities, legendre(setting).momenta),
            by="matrix-euler-poincare",
        ),
        show_velocities(setting),
        write_step(
            "Matrix Euler-Poincare equations and advection",
            f"d tr(M^T e)/dt = {turned}, with delta a and {sign}da/dt by products of -e and -xi "
            "with a",
            rf"\tfrac{{d}}{{dt}} \mathrm{{tr}}(M^\top e) = {turned_latex}",
            write_rates(setting.state, rates),
            by="matrix-euler-poincare",
        ),
    )
