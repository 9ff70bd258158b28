r"""The exact flow of Euler's top: ``x1' = a1 x2 x3`` and cyclic.

With the integrals ``L = a1 a3 x2^2 - a1 a2 x3^2`` and ``M = a1 a3 x2^2 - a2 a3 x1^2`` let n be the
function of the time with ``n' = c d, c^2 = 1 - L n^2, d^2 = 1 - M n^2`` and n(0) = 0: it is
``sn(v, k)/sqrt(L)`` of ``v = sqrt(L) t``, c and d are cn and dn, and ``k^2 = M/L``. By the addition
theorem of these functions

    x1(t) = (x1 c + a1 n d x2 x3)/D,  x2(t) = (x2 c d + a2 n x1 x3)/D,
    x3(t) = (x3 d + a3 n c x1 x2)/D,  D = 1 - a1 a3 n^2 x2^2.

No phase has to be found, no order of the moments of inertia matters, and nothing is special on the
separatrix, where M = L, or for a symmetric body: everything is a polynomial in L and M. It is the
flow of E. Celledoni, F. Fasso, N. Safstrom and A. Zanna, SIAM Journal on Scientific Computing 30
(2008) 2084, of the momentum alone. n of the 64th part of a step is its series, of which the first
term left out is below 1e-17 where ``sqrt(L) h`` and ``sqrt(M) h`` are less than 2; then it is
doubled six times: ``n -> 2 n c d/(1 - L M n^4)`` and so on.

Comes in: Equations. Goes out: the coefficients a, or why the motion is not of this form.
Read next: `coadjoint.lower.exact_body`.
"""

from __future__ import annotations

from coadjoint.derive.equations import Equations
from coadjoint.exact import Element
from coadjoint.exact.text import brief_text

Three = tuple[Element, Element, Element]
#: Names of n, c and d.
FUNCTIONS = ("_n", "_c", "_d")


def find_top(equations: Equations) -> Three | str:
    """The coefficients a, or why a motion is not of this form."""
    setting, field = equations.setting, equations.setting.field
    if len(setting.state) != 3 or equations.kept or setting.driving or equations.spec.noise:
        return "it is no free motion of three components in closed form"
    found = []
    for i, name in enumerate(setting.state):
        others = [field[other] for other in setting.state if other != name]
        rate = field.normal(equations.close(equations.exact.rates[i]))
        coefficient = field.normal(rate / (others[0] * others[1])) if rate else field.zero
        if field.reach(coefficient) & {*setting.state}:
            text = brief_text(field, rate)
            told = f"is {text}, which is" if text else "is"
            return f"the rate of {name} {told} no multiple of the product of the two others"
        found.append(coefficient)
    return found[0], found[1], found[2]


def integrals(a: Three, x: Three) -> tuple[Element, Element]:
    """L and M."""
    one = a[0] * a[2] * x[1] ** 2
    return one - a[0] * a[1] * x[2] ** 2, one - a[1] * a[2] * x[0] ** 2


def add_time(a: Three, x: Three, functions: Three) -> Three:
    """The state after a time, given n, c and d of it."""
    (x1, x2, x3), (n, c, d) = x, functions
    under = 1 / (1 - a[0] * a[2] * n**2 * x2**2)
    return (
        (x1 * c + a[0] * n * d * x2 * x3) * under,
        (x2 * c * d + a[1] * n * x1 * x3) * under,
        (x3 * d + a[2] * n * c * x1 * x2) * under,
    )
