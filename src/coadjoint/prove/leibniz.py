r"""How far the Jacobi identity of fields at N points fails, as a number.

With matrices :math:`D_k` for :math:`\partial_s^k` a bracket P becomes :math:`P_D`. It stays
antisymmetric, but its cyclic sum (see `coadjoint.prove.fields`)

.. math:: h \sum_i \big(\xi \cdot P_D'[P_D \eta]\, \zeta\big)_i + \text{cyclic}

is what :math:`D(f g)` and :math:`(D f) g + f D g` differ by. That is of the order of differences,
and of Fourier derivatives what waves shorter than two points are mistaken for. Here it is computed
for functionals :math:`h \sum_i \varphi_n u_a`, n = 1, 2, 3, and all components a, about a field:

.. math:: \varphi_n = e^{\cos(\theta - n^2)}, \quad u_a = e^{\sin(\theta + a)}, \quad
    \theta = 2 \pi s/L,

smooth functions in which every wave is there. No reflection of the circle takes the three into each
other, with which the sums of a strand vanish. Matrices are those of the rings with which kernels
are compared, in doubles, at the defaults of the parameters.
Comes in: a `Grid`. Goes out: the largest of these sums over its largest term.
Read next: `coadjoint.prove.grids`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, partial
from typing import TYPE_CHECKING, Any, Final

import mpmath
import numpy as np

from coadjoint.derive.fields.generic import GenericPoint
from coadjoint.derive.fields.grid import Grid
from coadjoint.derive.fields.operators import Term
from coadjoint.derive.fields.rings import Rings
from coadjoint.exact import Element

if TYPE_CHECKING:
    from coadjoint.array_types import Array

    #: Of theta.
    Function = Callable[[Array], Array]
    #: Of the order of a derivative and the number of a row of the bracket, its matrix.
    Matrices = Callable[[int, int], Array]

#: Points at which differences are measured, and Fourier derivatives, whose defect is soon rounding.
POINTS: Final = (32, 64)
WAVES: Final = (12, 24)
#: A defect below which it is rounding, of whose digits nothing is said.
LEAST: Final = 1e-12


def tell_defect(grid: Grid, *, by_waves: bool = False) -> str:
    """What is measured, and how large it is.

    Args:
        grid: The fields.
        by_waves: Whether derivatives are those of Fourier series.
    """
    sizes = WAVES if by_waves else POINTS
    found = [measure_defect(grid, size, by_waves=by_waves) for size in sizes]
    told = [f"{x:.2g}" if x > LEAST else f"less than {LEAST:g}" for x in found]
    space, (few, many) = grid.equations.spec.space, sizes
    assert space is not None, grid.equations.spec.name
    theta = f"2*pi*{space.name}/{space.length}"
    return (
        f"the cyclic sum of the integrals of exp(cos({theta} - n^2))*u_a, n = 1, 2, 3, about the "
        f"fields u_a = exp(sin({theta} + a)), is {told[0]} of its largest term at {few} points and "
        f"{told[1]} at {many}"
    )


#: Smooth functions of theta in which all waves are.
FUNCTIONS: Final = tuple(
    partial(lambda n, theta: np.exp(np.cos(theta - n**2)), n) for n in (1, 2, 3)
)


def measure_defect(grid: Grid, size: int, *, by_waves: bool = False) -> float:
    """The largest cyclic sum over its largest term; 0 where no term is there.

    Args:
        grid: The fields.
        size: N.
        by_waves: Whether derivatives are those of Fourier series.
    """
    parts = list_terms(grid, size, FUNCTIONS, by_waves=by_waves)
    largest = max(float(np.abs(part).max()) for part in parts)
    return float(np.abs(sum(parts)).max()) / largest if largest else 0.0


def list_terms(
    grid: Grid, size: int, functions: Sequence[Function], *, by_waves: bool = False
) -> list[Array]:
    """The three terms of the cyclic sum of the functionals ``h sum_i phi_n u_a``.

    Args:
        grid: The fields.
        size: N.
        functions: The three phi_n, of theta.
        by_waves: Whether derivatives are those of Fourier series.

    Returns:
        Three arrays ``(n, n, n)``, for all components of the three functionals.
    """
    point = GenericPoint(grid.equations)
    rings, steps = Rings(point), size - point.space.has_ends  # a line has a point at each end
    theta = 2 * np.pi * np.arange(size) / steps
    defaults, names = point.setting.field.region.defaults, point.setting.state
    values: dict[str, Any] = {x: float(defaults.get(x, 1)) for x in point.setting.parameters}
    values |= {name: np.exp(np.sin(theta + a)) for a, name in enumerate(names, 1)}
    inverse = steps / values[point.space.length]
    make = wave_matrices if by_waves else difference_matrices
    bracket = _Bracket(point, values, make(rings, size, inverse))
    weights = np.array([float(rings.weigh(i, size)) for i in range(size)]) / inverse
    phi, found = [f(theta) for f in functions], []
    for n in range(3):
        xi, eta, zeta = (phi[(n + k) % 3] for k in range(3))
        terms = bracket.find_terms(weights * xi, eta, zeta)
        found.append(np.transpose(terms, [(k - n) % 3 for k in range(3)]))
    return found


def difference_matrices(rings: Rings, size: int, inverse: float) -> Matrices:
    """Matrices of differences at so many points, with one over the spacing."""
    point = rings.point

    @cache
    def find(order: int, n: int) -> Array:
        matrix = np.zeros((size, size))
        for i in range(size):
            for j, weight in rings.matrix_row(order, i, size, n):
                matrix[i, j] += float(weight) * inverse**order
        return matrix

    return lambda order, n: find(order, n if point.space.has_ends else 0)  # one for all on a circle


def wave_matrices(_: Rings, size: int, inverse: float) -> Matrices:
    """Matrices of the derivatives of trigonometric polynomials; see `coadjoint.solve.spectral`."""
    numbers = 2j * np.pi * np.arange(size // 2 + 1) * inverse / size
    steps = np.arange(size)

    @cache
    def find(order: int) -> Array:
        symbol = numbers**order
        if order % 2 and size % 2 == 0:
            symbol[-1] = 0
        matrix: Array = np.fft.irfft(symbol, n=size)[steps[:, np.newaxis] - steps]
        return matrix

    return lambda order, _: find(order)


class _Bracket:
    """The bracket at N points, in numbers.

    Args:
        point: The fields.
        values: Of parameters numbers, of fields their values at all points.
        matrices: What stands for derivatives.
    """

    def __init__(self, point: GenericPoint, values: Mapping[str, Any], matrices: Matrices) -> None:
        self._field, self._names = point.setting.field, point.setting.state
        self._operator, self._values, self._matrices = point.operator, values, matrices

    def find_terms(self, xi: Array, eta: Array, zeta: Array) -> Array:
        """``sum_i xi_i (P'[P eta] zeta)_i`` for all components of the three, ``(n, n, n)``.

        Args:
            xi: A function at all points, with their weights.
            eta: A function at all points.
            zeta: A function at all points.
        """
        count, size = len(self._names), len(xi)
        moved = np.zeros((count, count, size))  # component a of P times eta in the component b
        for a, c, term in self._terms():
            left, right = self._find(term.left), self._find(term.right)
            moved[a, c] += left * self._differentiate(term, a, right * eta)
        found = np.zeros((count, count, count))
        for a, c, term in self._terms():
            left, right = self._find(term.left), self._find(term.right)
            varied = self._vary(term.left, moved) * self._differentiate(term, a, right * zeta)
            varied += left * self._differentiate(term, a, self._vary(term.right, moved) * zeta)
            found[a, :, c] += varied @ xi
        return found

    def _terms(self) -> Iterator[tuple[int, int, Term]]:
        """The terms of the bracket with their row and column."""
        for a, row in enumerate(self._operator):
            for c, entry in enumerate(row):
                yield from ((a, c, term) for term in entry)

    def _differentiate(self, term: Term, row: int, values: Array) -> Array:
        """The derivative of a term, of values whose last axis is of points."""
        if not term.order:
            return values
        found: Array = values @ self._matrices(term.order, row).T
        return found

    def _vary(self, element: Element, moved: Array) -> Array:
        """How an element changes along the motions in all components, ``(n, N)``."""
        found: Array = np.zeros(moved.shape[1:])
        for n in (n for n, x in enumerate(self._names) if x in self._field.reach(element)):
            found += self._find(self._field.derivative(element, self._names[n])) * moved[n]
        return found

    def _find(self, element: Element) -> Any:
        """The value of an element: of fields and not of their derivatives, along a line."""
        return self._field.evaluate(element, self._values, float, _call)


def _call(function: str, *arguments: Any) -> float:
    """An elementary function of parameters."""
    return float(getattr(mpmath, function)(*arguments))
