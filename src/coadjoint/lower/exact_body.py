"""The exact flow of Euler's top as a Program: sums, products, quotients and two roots.

Comes in: Equations. Goes out: what a step ``_h`` adds to the state, or in words why there is none.
Read next: `coadjoint.derive.euler_top`, which proves the formulas.
"""

from __future__ import annotations

from fractions import Fraction
from math import factorial
from typing import Final

from coadjoint.derive import Equations
from coadjoint.derive.euler_top import find_top
from coadjoint.derive.setting import STEP
from coadjoint.lower.graph import Graph
from coadjoint.lower.naming import Naming
from coadjoint.lower.program import Program
from coadjoint.lower.sums import Lowering

#: How often the time of the series is doubled.
DOUBLINGS: Final = 6
#: Of the series of n: numbers in front of ``L^i M^j`` for i + j = 0, 1, 2 and so on, those of sn.
SERIES: Final = (
    (1,),
    (1, 1),
    (1, 14, 1),
    (1, 135, 135, 1),
    (1, 1228, 5478, 1228, 1),
)


def lower_exact_body(equations: Equations) -> Program | str:
    """The step, or why there is none."""
    top = find_top(equations)
    if isinstance(top, str):
        return top
    setting, lowering = equations.setting, Lowering(equations, top)
    graph: Graph = lowering.graph
    lines: list[tuple[str, int]] = []
    one, two = graph.number(1), graph.number(2)

    def define(name: str, node: int) -> int:
        lines.append((name, node))
        return graph.symbol(name)

    def multiply(*factors: int) -> int:
        return graph.product(factors)

    def subtract(a: int, b: int) -> int:
        return graph.add(a, graph.negate(b))

    def share(a: int, b: int) -> int:
        """A product of coefficients, which depends on parameters alone."""
        return define(f"_a{len(lines) + 1}", multiply(a, b))

    a1, a2, a3 = (define(f"_b{i + 1}", lowering.node(each)) for i, each in enumerate(top))
    x1, x2, x3 = map(graph.symbol, setting.state)
    a12, a13, a23 = share(a1, a2), share(a1, a3), share(a2, a3)
    middle = define("_m", multiply(a13, multiply(x2, x2)))
    large = define("_k", subtract(middle, multiply(a12, multiply(x3, x3))))
    small = define("_l", subtract(middle, multiply(a23, multiply(x1, x1))))
    both = define("_kl", multiply(large, small))
    part = define("_n0", multiply(graph.number(Fraction(1, 2**DOUBLINGS)), graph.symbol(STEP)))
    square = define("_q", multiply(part, part))
    series = graph.number(0)
    for order in reversed(range(len(SERIES))):
        sign = Fraction((-1) ** order, factorial(2 * order + 1))
        terms = [
            multiply(graph.number(sign * c), *[large] * (order - j), *[small] * j)
            for j, c in enumerate(SERIES[order])
        ]
        series = graph.add(graph.sum(terms), multiply(square, series))
    n = define("_n1", multiply(part, series))
    nn = define("_nn1", multiply(n, n))
    # 1 - c and 1 - d are kept: what is lost in c itself would grow fourfold with each doubling
    short_c, short_d = (
        define(name, graph.divide(lost, graph.add(one, graph.call("sqrt", subtract(one, lost)))))
        for name, lost in (("_c1", multiply(large, nn)), ("_d1", multiply(small, nn)))
    )
    for k in range(2, DOUBLINGS + 2):
        c, d = subtract(one, short_c), subtract(one, short_d)
        under = define(f"_u{k}", graph.divide(two, subtract(one, multiply(both, multiply(nn, nn)))))
        cd, twice = define(f"_cd{k}", multiply(c, d)), define(f"_w{k}", multiply(nn, under))
        short_c = define(f"_c{k}", multiply(multiply(large, twice), multiply(d, d)))
        short_d = define(f"_d{k}", multiply(multiply(small, twice), multiply(c, c)))
        n = define(f"_n{k}", multiply(n, cd, under))
        nn = define(f"_nn{k}", multiply(n, n))
    c, d = subtract(one, short_c), subtract(one, short_d)
    lost = define("_e", multiply(middle, nn))
    under = define("_u1", graph.divide(one, subtract(one, lost)))
    both_short = subtract(graph.add(short_c, short_d), multiply(short_c, short_d))
    results = (
        (x1, short_c, multiply(a1, multiply(n, d), multiply(x2, x3))),
        (x2, both_short, multiply(a2, n, multiply(x1, x3))),
        (x3, short_d, multiply(a3, multiply(n, c), multiply(x1, x2))),
    )
    outputs = [
        (
            f"rise of {name} in {STEP}",
            multiply(graph.add(multiply(x, subtract(lost, short)), moved), under),
        )
        for name, (x, short, moved) in zip(setting.state, results, strict=True)
    ]
    naming = Naming(graph, lines, outputs, setting.parameters)
    arrays = {"state": (*setting.state, STEP), "parameters": setting.parameters}
    return naming.program("exact_body", (3,), **arrays)
