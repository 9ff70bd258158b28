r"""The rates of matrices on the torus by the sine bracket of waves, without a product of matrices.

With :math:`W = i \sum_k w_k T_k` and :math:`V = i \sum_k v_k T_k` (`coadjoint.algebra.waves`) the
motion :math:`\dot W = [W, V]` is

.. math:: \dot w_k = 2 \sum_{m + n = k} \sin(2 \pi\, m \times n/N)\, w_m v_n, \qquad
    v_n = w_n / \mathrm{inertia}(n)

(Zeitlin, Physica D 49 (1991) 353, with :math:`v_n = N w_n/(4 \pi |n|^2)`). That both are one motion
is decided for a few N.
Comes in: the Equations of matrices of a few rows. Goes out: rates of the entries.
Read next: `coadjoint.prove.truncated`.
"""

from __future__ import annotations

from itertools import product
from math import isqrt
from typing import TYPE_CHECKING

from coadjoint.algebra.waves import residue, write_cosine, write_sine
from coadjoint.derive.interpret import interpret
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.truncated import put_numbers

if TYPE_CHECKING:
    from coadjoint.derive.equations import Equations
    from coadjoint.exact import Element

#: A complex number by its real and imaginary part.
Pair = tuple["Element", "Element"]
Wave = tuple[int, int]


def multiply_waves(equations: Equations, inertia: str, count: str) -> tuple[Element, ...]:
    """The rates of the entries.

    Args:
        equations: Of 3 or 5 rows.
        inertia: Of a wave, in k1, k2 and the number of rows.
        count: What it calls the number of rows.
    """
    field, state = equations.setting.field, equations.setting.state
    n = isqrt(len(state))
    X = [[field[state[i * n + j]] for j in range(n)] for i in range(n)]
    circle = _Circle(equations, n)
    w, v = dict[Wave, Pair](), dict[Wave, Pair]()
    for k1, k2 in product(range(n), repeat=2):
        places = [(i, (i + k2) % n) for i in range(n)]
        # of W = A + i B over i the real part is B and the imaginary one is -A
        pairs = [((X[i][j] + X[j][i]) / 2, (X[j][i] - X[i][j]) / 2) for i, j in places]
        turned = [circle.turn(z, -k1 * (i + j)) for z, (i, j) in zip(pairs, places, strict=True)]
        real, imaginary = (field.sum(each) / n for each in zip(*turned, strict=True))
        w[k1, k2] = (real, imaginary)
        if (k1, k2) != (0, 0):
            numbers = {"k1": residue(k1, n), "k2": residue(k2, n), count: n}
            size = circle.read(put_numbers(inertia, numbers))
            v[k1, k2] = (real / size, imaginary / size)
    rates = {k: _multiply(circle, k, w, v) for k in w}
    found = []
    for i, j in product(range(n), repeat=2):
        terms = [circle.turn(rates[k1, (j - i) % n], k1 * (i + j)) for k1 in range(n)]
        found.append(field.sum(real - imaginary for real, imaginary in terms))
    return tuple(found)


def _multiply(circle: _Circle, k: Wave, w: dict[Wave, Pair], v: dict[Wave, Pair]) -> Pair:
    """``2 sum sin(2 pi m x n/N) w_m v_n`` over m + n = k."""
    real, imaginary, rows = [], [], circle.rows
    for n, (c, d) in v.items():
        m = ((k[0] - n[0]) % rows, (k[1] - n[1]) % rows)
        sine = 2 * circle.sine(m[0] * n[1] - m[1] * n[0])
        (a, b) = w[m]
        real.append(sine * (a * c - b * d))
        imaginary.append(sine * (a * d + b * c))
    field = circle.field
    return field.sum(real), field.sum(imaginary)


class _Circle:
    """Cosines and sines of whole parts of a turn, as elements.

    Args:
        equations: In whose field they are.
        rows: How many parts a turn has.
    """

    def __init__(self, equations: Equations, rows: int) -> None:
        self.rows, self.field = rows, equations.setting.field
        self._setting = equations.setting
        places = range(rows // 2 + 1)
        self._cosines = [self.read(write_cosine(t, rows)) for t in places]
        self._sines = [self.read(write_sine(t, rows)) for t in places]

    def read(self, text: str) -> Element:
        """A formula without variables, as an element."""
        value: Element = interpret(read_expression(text), self._setting.values, self.field)
        return value

    def cosine(self, k: int) -> Element:
        """``cos(2 pi k/rows)``."""
        return self._cosines[abs(residue(k, self.rows))]

    def sine(self, k: int) -> Element:
        """``sin(2 pi k/rows)``."""
        own = residue(k, self.rows)
        return self._sines[own] if own >= 0 else -self._sines[-own]

    def turn(self, z: Pair, k: int) -> Pair:
        """``z exp(2 pi i k/rows)``."""
        (a, b), c, s = z, self.cosine(k), self.sine(k)
        return a * c - b * s, a * s + b * c
