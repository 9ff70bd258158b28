"""Kahan's method: a step of a quadratic motion as one linear solve.

``(1 - h/2 f'(x)) d = h f(x)``, then x + d: second order, symmetric and birational.
W. Kahan, Unconventional numerical methods for trajectory calculations (1993); E. Celledoni,
R. I. McLachlan, B. Owren and G. R. W. Quispel, Journal of Physics A 46 (2013) 025201: of many
integrable motions it keeps modified integrals. It is no Poisson map.

Comes in: Equations. Goes out: what a step ``_h`` adds to the state as a Program, by elimination in
the order of the state without exchanges: the matrix is the identity to first order. Or, in words,
why there is none.
Read next: `coadjoint.lower.flows`.
"""

from __future__ import annotations

import random
from fractions import Fraction
from functools import partial
from typing import Final

from coadjoint.derive import Equations
from coadjoint.derive.setting import STEP
from coadjoint.errors import CrossCheckError
from coadjoint.exact import Element
from coadjoint.exact.linear import primes
from coadjoint.exact.residues import Residue, residue
from coadjoint.exact.text import brief_text
from coadjoint.lower.check import call_residue
from coadjoint.lower.evaluation import run
from coadjoint.lower.graph import Graph
from coadjoint.lower.naming import Naming
from coadjoint.lower.program import Program
from coadjoint.lower.sums import Lowering

#: Operations of a step beyond which another method takes less time, and compilers take long.
OPERATIONS: Final = 2000
#: Points modulo a prime at which the equation of a step is compared.
POINTS: Final = 3


def why_not_quadratic(equations: Equations) -> str:
    """What keeps rates from being quadratic in the state; "" where they are."""
    setting, field = equations.setting, equations.setting.field
    if equations.kept:
        return "its rates are not in closed form: its kernel solves for them"
    if setting.driving:
        return f"it is driven by {', '.join(setting.driving)}"
    if equations.spec.noise:
        return "it has noise"
    for name, rate in zip(setting.state, equations.exact.rates, strict=True):
        for term in field.terms(field.normal(equations.close(rate))):
            slopes = [s for s in field.gradient(term, setting.state) if s]
            second = [s for slope in slopes for s in field.gradient(slope, setting.state) if s]
            if any(field.reach(each) & {*setting.state} for each in second):
                text = brief_text(field, term)
                told = f"the term {text}" if text else "a term"
                return f"{told} of the rate of {name} is not quadratic"
    return ""


def lower_kahan(equations: Equations) -> Program | str:
    """The step, or why there is none.

    Raises:
        CrossCheckError: It does not solve its equation.
    """
    if reason := why_not_quadratic(equations):
        return reason
    setting, field = equations.setting, equations.setting.field
    state = setting.state
    rates = [field.normal(equations.close(rate)) for rate in equations.exact.rates]
    slopes = [field.gradient(rate, state) for rate in rates]
    program = _eliminate(equations, rates, slopes)
    count = sum(program.operation_counts().values())
    if count > OPERATIONS:
        return f"its linear equation takes {count} operations, more than {OPERATIONS}"
    _check(equations, program, rates, slopes)
    return program


def _eliminate(
    equations: Equations, rates: list[Element], slopes: list[tuple[Element, ...]]
) -> Program:
    """The step as a Program."""
    setting, size = equations.setting, len(rates)
    lowering = Lowering(equations, [*rates, *(each for row in slopes for each in row)])
    graph: Graph = lowering.graph
    lines: list[tuple[str, int]] = []

    def define(name: str, node: int) -> int:
        if graph.kinds[node] == "number":
            return node
        lines.append((name, node))
        return graph.symbol(name)

    def subtract(a: int, b: int, c: int) -> int:
        """``a - b c``."""
        return graph.add(a, graph.negate(graph.multiply(b, c)))

    h, one, zero = graph.symbol(STEP), graph.number(1), graph.number(0)
    half = define("_k", graph.multiply(graph.number(Fraction(1, 2)), h))
    matrix = [
        [
            subtract(one if i == j else zero, half, lowering.node(slope))
            for j, slope in enumerate(row)
        ]
        for i, row in enumerate(slopes)
    ]
    known = [graph.multiply(h, lowering.node(rate)) for rate in rates]
    inverse = []
    for k in range(size):
        matrix[k] = [
            define(f"_k{k + 1}_{j + 1}", e) if j >= k else e for j, e in enumerate(matrix[k])
        ]
        known[k] = define(f"_k{k + 1}_0", known[k])
        inverse.append(define(f"_q{k + 1}", graph.divide(one, matrix[k][k])))
        for i in range(k + 1, size):
            if graph.is_zero(matrix[i][k]):
                continue
            factor = define(f"_l{i + 1}_{k + 1}", graph.multiply(matrix[i][k], inverse[k]))
            matrix[i] = [
                subtract(e, factor, matrix[k][j]) if j > k else e for j, e in enumerate(matrix[i])
            ]
            known[i] = subtract(known[i], factor, known[k])
    change = [zero] * size
    for k in reversed(range(size)):
        rest = known[k]
        for j in range(k + 1, size):
            rest = subtract(rest, matrix[k][j], change[j])
        change[k] = define(f"_d{k + 1}", graph.multiply(rest, inverse[k]))
    outputs = [
        (f"rise of {name} in {STEP}", each)
        for name, each in zip(setting.state, change, strict=True)
    ]
    naming = Naming(graph, lines, outputs, setting.parameters)
    arrays = {"state": (*setting.state, STEP), "parameters": setting.parameters}
    return naming.program("kahan", (size,), **arrays)


def _check(
    equations: Equations, program: Program, rates: list[Element], slopes: list[tuple[Element, ...]]
) -> None:
    """Hold a step to its equation at points modulo primes of 61 bits, which decide but for chance.

    Raises:
        CrossCheckError: It does not satisfy it.
    """
    field, state, source = equations.setting.field, equations.setting.state, random.Random(1)  # noqa: S311
    for _, prime in zip(range(POINTS), primes(), strict=False):
        number, call = partial(residue, prime=prime), partial(call_residue, prime=prime)
        values = {name: Residue(source.randrange(1, prime), prime) for name in program.names}
        change = run(program, values, number, call)
        for name, rate, row, own in zip(state, rates, slopes, change, strict=True):
            moved = field.evaluate(rate, values, number, call)
            for slope, each in zip(row, change, strict=True):
                half = field.evaluate(slope, values, number, call) * number(Fraction(1, 2))
                moved = moved + half * each
            if own != moved * values[STEP]:
                raise CrossCheckError(
                    f"{equations.spec.name}: a step of Kahan's method does not solve its equation "
                    f"for {name}. This is a fault of coadjoint, please report it.",
                    system=equations.spec.name,
                    output=name,
                )
