r"""The principal symbol: whether the equations of fields are well posed.

About any fields, short waves :math:`e^{i k s - i \omega t}` obey :math:`-i \omega v = (i k)^n A v`,
with :math:`A = \partial \dot u / \partial (\partial_s^n u)` for the highest derivative in the
rates. A wave does not grow if :math:`\omega` is real and A is diagonalizable: of a bracket, whose
eigenvalues come in pairs, for odd n if all eigenvalues of A are real, and for even n if all are
imaginary. With other eigenvalues there are waves that grow faster the shorter they are, and nothing
depends on initial fields continuously (Hadamard). For a strand with :math:`l = \tfrac12 A \Omega^2
+ B \Omega \Xi + \tfrac12 C \Xi^2` they are the roots of :math:`A \tau^2 + 2 B \tau + C`.

Where A is not diagonalizable, derivatives of lower orders decide. About fields that are the same
all along, waves then have the rates of :math:`\sum_n (i k)^n A_n`. Those of a strand whose energy
has derivatives of strains grow like :math:`e^{k^2 t}` where its sign is wrong, while A is
nilpotent.

Roots are counted exactly, at rational points: the defaults of parameters, and a few fields.
Comes in: Equations of fields. Goes out: what is wrong with them, if anything.
Read next: `coadjoint.prove.fields`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from random import Random

import mpmath
import sympy

from coadjoint.derive.fields.jets import Jets
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element

#: Fields at which the symbol is looked at.
POINTS = 5
#: Wave number at which growth is shown.
SHOWN = 10
#: Wave numbers between which the power of a growth is measured, and digits for roots in blocks.
WAVE_NUMBERS, DIGITS = (10**8, 10**12), 120
_ROOT = sympy.Symbol("_root")


@dataclass(frozen=True)
class Growth:
    """A short wave that grows.

    Attributes:
        order: The power of the wave number k.
        speed: How fast it grows: the amplitude has the factor ``exp(speed * k^order * t)``.
        point: Parameters and fields there, as text.
        cause: Why, as a clause.
    """

    order: Fraction
    speed: float
    point: dict[str, str]
    cause: str = "the principal symbol has complex roots"

    @property
    def told(self) -> str:
        """What happens, as a clause."""
        rate = f"{self.speed * SHOWN**self.order:.3g}"
        power = f"k^{self.order}" if self.order != 1 else "k"
        power = power if self.order.denominator == 1 else f"k^({self.order})"
        return (
            f"{self.cause}, so that a wave of wave number k grows like "
            f"exp({self.speed:.3g}*{power}*t), with k = {SHOWN} like exp({rate}*t)"
        )


@dataclass(frozen=True)
class Seen:
    """What was seen of the principal symbol.

    Attributes:
        order: The highest derivative in the rates.
        points: At how many points its roots were counted.
        growth: A short wave that grows, if there is one.
        is_diagonalizable: Whether it is at all of these points.
    """

    order: int
    points: int
    growth: Growth | None = None
    is_diagonalizable: bool = True


def find_matrix(
    setting: Setting, jets: Jets, rates: Sequence[Element]
) -> tuple[int, Sequence[Sequence[Element]]]:
    """The highest derivative in the rates, and the derivatives of the rates by these."""
    jets = jets.only(setting.state)
    order, field = max((_order(jets, rate) for rate in rates), default=0), setting.field
    tops = [tower[order] for tower in jets.towers.values()]
    return order, [field.gradient(rate, tops) for rate in rates]


def look_at_symbol(setting: Setting, jets: Jets, rates: Sequence[Element]) -> Seen:
    """The roots of the principal symbol at some points; none where it calls functions.

    Nor in a plane, where one field is carried by a velocity.
    """
    if setting.spec.in_plane:
        return Seen(1, 0)
    order, matrix = find_matrix(setting, jets, rates)
    points = 0
    if not order:
        return Seen(order, points)
    field, diagonalizable = setting.field, True
    for values in _list_points(setting, matrix):
        numbers = sympy.Matrix(
            [
                [sympy.Rational(x.numerator, x.denominator) for x in row]
                for row in (
                    [field.evaluate(entry, values, Fraction) for entry in row] for row in matrix
                )
            ]
        )
        polynomial = numbers.charpoly(_ROOT).as_expr()
        if _count_bad(sympy.Poly(polynomial, _ROOT, domain="QQ"), odd=order % 2 == 1):
            # the square-free part: multiple roots are found too slowly
            simple = sympy.Poly(polynomial, _ROOT, domain="QQ").sqf_part()
            parts = [complex(root) for root in simple.nroots()]
            speed = max(abs(x.imag if order % 2 else x.real) for x in parts)
            reached = frozenset[str]().union(*(field.reach(x) for row in matrix for x in row))
            point = {name: str(values[name]) for name in field.names if name in reached}
            return Seen(order, points + 1, Growth(Fraction(order), speed, point))
        points += 1
        if not _is_diagonalizable(numbers, polynomial):
            diagonalizable = False
            if (growth := _look_at_all_orders(setting, jets, rates, order)) is not None:
                return Seen(order, points, growth)
    return Seen(order, points, is_diagonalizable=diagonalizable)


def _look_at_all_orders(
    setting: Setting, jets: Jets, rates: Sequence[Element], order: int
) -> Growth | None:
    """A short wave that grows at least like ``exp(k t)`` about fields that are the same all along.

    Fields that change along space change its rate by terms without k, so that slower growth says
    nothing.
    """
    field, towers = setting.field, jets.only(setting.state).towers.values()
    matrices = [
        [field.gradient(rate, [tower[n] for tower in towers]) for rate in rates]
        for n in range(order + 1)
    ]
    slopes = {symbol: Fraction(0) for tower in towers for symbol in tower[1:]}
    flat = [row for matrix in matrices for row in matrix]
    for values in _list_points(setting, flat):
        known = {name: slopes.get(name, value) for name, value in values.items()}
        numbers = [
            [[field.evaluate(entry, known, Fraction) for entry in row] for row in matrix]
            for matrix in matrices
        ]
        least, most = (_find_growth(numbers, k) for k in WAVE_NUMBERS)
        if least > 0 and most > 0:
            ratio = mpmath.log(most / least) / mpmath.log(WAVE_NUMBERS[1] / WAVE_NUMBERS[0])
            power = Fraction(float(ratio)).limit_denominator(6)
            if power >= 1:
                speed = float(most / mpmath.mpf(WAVE_NUMBERS[1]) ** float(power))
                point = {name: str(value) for name, value in known.items() if name not in slopes}
                cause = "frequencies of short waves, by terms of all orders, are complex"
                return Growth(power, speed, point, cause)
    return None


def _find_growth(matrices: Sequence[Sequence[Sequence[Fraction]]], k: int) -> mpmath.mpf:
    """How fast the wave of a wave number grows that does so fastest; 0 but for roundings."""
    with mpmath.workdps(DIGITS):
        whole = mpmath.matrix(len(matrices[0]))
        for n, matrix in enumerate(matrices):
            for i, row in enumerate(matrix):
                for j, x in enumerate(row):
                    whole[i, j] += mpmath.mpc(0, k) ** n * x.numerator / x.denominator
        rates = mpmath.eig(whole, left=False, right=False)
        most = max(mpmath.re(rate) for rate in rates)
        # a rate that is there four times is found to a quarter of the digits
        roundings = max(map(abs, rates)) * mpmath.mpf(10) ** (-DIGITS // 4)
        return most if most > roundings else mpmath.mpf(0)


def _order(jets: Jets, rate: Element) -> int:
    """The highest derivative that a rate names."""
    return max((len(jets.slopes(rate, name)) - 1 for name in jets.towers), default=0)


def _list_points(
    setting: Setting, matrix: Sequence[Sequence[Element]]
) -> Iterator[dict[str, Fraction]]:
    """Defaults of parameters, and fields that are rational numbers."""
    field, source = setting.field, Random(0)  # noqa: S311 - not a secret
    reached = frozenset[str]().union(*(field.reach(x) for row in matrix for x in row))
    if any(field.functions_in(x) for row in matrix for x in row):
        return
    defaults = field.region.defaults
    for _ in range(POINTS):
        yield {
            name: defaults.get(name, Fraction(source.randint(1, 9), source.randint(1, 9)))
            if name in setting.parameters
            else Fraction(source.randint(-9, 9), source.randint(1, 9))
            for name in sorted(reached)
        }


def _is_diagonalizable(matrix: sympy.Matrix, polynomial: sympy.Expr) -> bool:
    """Whether the square-free part of the characteristic polynomial vanishes at the matrix."""
    total = sympy.zeros(*matrix.shape)
    for coefficient in sympy.Poly(polynomial, _ROOT, domain="QQ").sqf_part().all_coeffs():
        total = total * matrix + coefficient * sympy.eye(matrix.shape[0])
    return bool(total.is_zero_matrix)


def _count_bad(polynomial: sympy.Poly, *, odd: bool) -> int:
    """How many roots are neither real, for an odd order, nor imaginary, for an even one."""
    degree = int(polynomial.degree())
    if not odd:  # real y with p(i y) = 0 are the common roots of its real and imaginary parts
        real, imaginary = _split(
            sympy.Poly(polynomial.as_expr().subs(_ROOT, sympy.I * _ROOT), _ROOT)
        )
        polynomial = sympy.Poly(sympy.gcd(real, imaginary), _ROOT, domain="QQ")
    return degree - _count_real(polynomial)


def _split(polynomial: sympy.Poly) -> tuple[sympy.Expr, sympy.Expr]:
    """Real and imaginary parts of a polynomial at real arguments."""
    parts = [sympy.S(0), sympy.S(0)]
    for (power,), value in polynomial.terms():
        real, imaginary = value.as_real_imag()
        parts[0] += real * _ROOT**power
        parts[1] += imaginary * _ROOT**power
    return parts[0], parts[1]


def _count_real(polynomial: sympy.Poly) -> int:
    """Real roots with their multiplicities, by Sturm's theorem."""
    return sum(factor.count_roots() * power for factor, power in polynomial.sqf_list()[1])
