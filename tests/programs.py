"""Programs written by hand in the letters of the textbook, for tests of every later step.

Not lowered from equations: a comparison earns trust when its two sides come by different roads.
"""

from __future__ import annotations

import ast
from dataclasses import replace
from fractions import Fraction

from coadjoint.declared import Bound, KernelContext, Quantity
from coadjoint.lower.program import (
    Add,
    Call,
    Divide,
    Multiply,
    Negate,
    Node,
    Number,
    Output,
    Program,
    Statement,
    Symbol,
    Table,
    walk,
)

KINDS = {ast.Add: Add, ast.Mult: Multiply, ast.Div: Divide}


def node(text: str) -> Node:
    """A node from a Python expression; numbers are read exactly, as decimals."""
    return _node(ast.parse(text, mode="eval").body, text)


def _node(tree: ast.expr, text: str) -> Node:
    match tree:
        case ast.Name(id=name):
            return Symbol(name)
        case ast.Constant():
            return Number(Fraction(ast.get_source_segment(text, tree)))
        case ast.UnaryOp(operand=operand):
            return Negate(_node(operand, text))
        case ast.Call(func=ast.Name(id=function), args=arguments):
            return Call(function, *(_node(argument, text) for argument in arguments))
        case ast.BinOp(left=left, op=ast.Sub(), right=right):
            return Add(_node(left, text), Negate(_node(right, text)))
        case ast.BinOp(left=left, op=operator, right=right):
            return KINDS[type(operator)](_node(left, text), _node(right, text))
    raise AssertionError(ast.dump(tree))


def program(
    name: str,
    state: str,
    parameters: str,
    statements: str,
    outputs: str,
    shape: tuple[int, ...],
    labels: str = "",
) -> Program:
    """A Program from text: ``"p = 1/I1; q = p*Pi1"`` and ``"q; -q"``."""
    alone = set(parameters.split())
    made = []
    for line in filter(None, (part.strip() for part in statements.split(";"))):
        target, value = (side.strip() for side in line.split("="))
        tree = node(value)
        read = {leaf.name for leaf in walk(tree) if isinstance(leaf, Symbol)}
        level = "parameters" if read <= alone else "member"
        alone |= {target} if level == "parameters" else set()
        made.append(Statement(target, tree, level))
    values = [node(text.strip()) for text in outputs.split(";")]
    named = labels.split() or [f"{name}{row}" for row in range(len(values))]
    return Program(
        name,
        tuple(state.split()),
        tuple(parameters.split()),
        tuple(sorted(made, key=lambda statement: statement.level, reverse=True)),
        tuple(map(Output, named, values)),
        shape,
    )


TOP_STATE = "Pi1 Pi2 Pi3 Gamma1 Gamma2 Gamma3"
TOP_PARAMETERS = "I1 I2 I3 m g chi1 chi2 chi3"
OMEGA = "Omega1 = Pi1/I1; Omega2 = Pi2/I2; Omega3 = Pi3/I3;"
ENERGY = "(Pi1*Omega1 + Pi2*Omega2 + Pi3*Omega3)/2 + _p1*(Gamma1*chi1 + Gamma2*chi2 + Gamma3*chi3)"

TOP_RHS = program(
    "rhs",
    TOP_STATE,
    TOP_PARAMETERS,
    "_p1 = m*g; _p2 = _p1*chi1; _p3 = _p1*chi2; _p4 = _p1*chi3;" + OMEGA,
    "Omega3*Pi2 - Omega2*Pi3 + (_p4*Gamma2 - _p3*Gamma3);"
    "Omega1*Pi3 - Omega3*Pi1 + (_p2*Gamma3 - _p4*Gamma1);"
    "Omega2*Pi1 - Omega1*Pi2 + (_p3*Gamma1 - _p2*Gamma2);"
    "Omega3*Gamma2 - Omega2*Gamma3; Omega1*Gamma3 - Omega3*Gamma1; Omega2*Gamma1 - Omega1*Gamma2",
    (6,),
    "dPi1/dt dPi2/dt dPi3/dt dGamma1/dt dGamma2/dt dGamma3/dt",
)
TOP_ENERGY = program(
    "energy", TOP_STATE, TOP_PARAMETERS, "_p1 = m*g;" + OMEGA, ENERGY, (), "energy"
)
TOP_OBSERVABLES = program(
    "observables",
    TOP_STATE,
    TOP_PARAMETERS,
    "_p1 = m*g;" + OMEGA,
    f"{ENERGY}; Pi1*Gamma1 + Pi2*Gamma2 + Pi3*Gamma3; Omega1; Omega2; Omega3",
    (5,),
    "energy casimir1 Omega1 Omega2 Omega3",
)
TOP_POISSON = program(
    "poisson_tensor",
    TOP_STATE,
    TOP_PARAMETERS,
    "",
    "0; -Pi3; Pi2; 0; -Gamma3; Gamma2; Pi3; 0; -Pi1; Gamma3; 0; -Gamma1; -Pi2; Pi1; 0; -Gamma2;"
    "Gamma1; 0; 0; -Gamma3; Gamma2; 0; 0; 0; Gamma3; 0; -Gamma1; 0; 0; 0; -Gamma2; Gamma1; 0; 0;"
    "0; 0",
    (6, 6),
)
#: The heavy top of textbooks: dPi/dt = Pi x Omega + m g Gamma x chi, dGamma/dt = Gamma x Omega.
HEAVY_TOP = KernelContext(
    name="heavy_top",
    spec="derivations/heavy_top.toml",
    license="BSD-3-Clause",
    routes=("Route: euler-poincare on so(3), left invariant.",),
    equations=("Omega1 = Pi1/I1", "dPi1/dt = Omega3*Pi2 - Omega2*Pi3 + m*g*(chi3*Gamma2 - ...)"),
    state=(
        Quantity("Pi", (3,), "kg m^2/s", ("Pi1", "Pi2", "Pi3")),
        Quantity("Gamma", (3,), "1", ("Gamma1", "Gamma2", "Gamma3")),
    ),
    parameters=(
        Quantity("I", (3,), "kg m^2", ("I1", "I2", "I3"), (1.0, 2.0, 3.0), positive=True),
        Quantity("m", (), "kg", ("m",), (1.0,), positive=True),
        Quantity("g", (), "m/s^2", ("g",), (9.81,)),
        Quantity("chi", (3,), "m", ("chi1", "chi2", "chi3"), (0.0, 0.0, 1.0)),
    ),
    observables=(
        Quantity("energy", (), "kg m^2/s^2", ("energy",), conserved=True),
        Quantity("casimir1", (), "kg m^2/s", ("casimir1",), conserved=True),
        Quantity("Omega", (3,), "1/s", ("Omega1", "Omega2", "Omega3")),
    ),
    programs=(TOP_RHS, TOP_ENERGY, TOP_OBSERVABLES, TOP_POISSON),
)

#: A pendulum with friction, in functions beyond sqrt and with one state variable left unread.
PENDULUM = KernelContext(
    name="pendulum",
    spec="derivations/pendulum.toml",
    license="",
    routes=("Route: typed by hand.",),
    equations=("dq/dt = p", "dp/dt = -k*sin(q) - exp(-q*q)*p"),
    state=(Quantity("q", (), "1", ("q",)), Quantity("p", (), "1/s", ("p",))),
    parameters=(Quantity("k", (), "1/s^2", ("k",), (2.5,), positive=True),),
    observables=(Quantity("speed", (), "1/s", ("speed",)),),
    programs=(
        program(
            "rhs", "q p", "k", "_t1 = q*q", "p; -(k*sin(q)) - exp(-_t1)*p", (2,), "dq/dt dp/dt"
        ),
        program("energy", "q p", "k", "_p1 = sqrt(k)", "p*p/2 - _p1*_p1*cos(q)", (), "energy"),
        program("observables", "q p", "k", "", "sqrt(p*p)", (1,), "speed"),
    ),
)

#: An oscillator on a circle of radius r, as long as q < 1/2 + p and p >= -3/4.
BOUNDED = KernelContext(
    name="bounded",
    spec="derivations/bounded.toml",
    license="",
    routes=("Route: typed by hand.",),
    equations=("dq/dt = p", "dp/dt = -q"),
    state=(Quantity("q", (), "1", ("q",)), Quantity("p", (), "1", ("p",))),
    parameters=(Quantity("r", (), "1", ("r",), (1.0,), positive=True),),
    observables=(Quantity("square", (), "1", ("square",)),),
    programs=(
        program("rhs", "q p", "r", "", "p; -q", (2,), "dq/dt dp/dt"),
        program("energy", "q p", "r", "", "(q*q + p*p)/2", (), "energy"),
        program("observables", "q p", "r", "_p1 = r*r", "(q*q + p*p)/_p1", (1,), "square"),
        program("domain", "q p", "r", "_p1 = r/2", "_p1 + p - q; 3*_p1/2 + p", (2,), "one two"),
        program("constraint_residual", "q p", "r", "", "q*q + p*p - r*r", (1,), "circle"),
        program("projection", "q p", "r", "_t1 = r/sqrt(q*q + p*p)", "_t1*q; _t1*p", (2,), "q p"),
    ),
    domain=(
        Bound("one", "condition", True, ("q", "p", "r")),
        Bound("two", "condition", False, ("p", "r")),
    ),
)

#: Statements of the rates of two places; some have names that the rates of the state have, too.
BELOW = "_p1 = 2*r; _t1 = p*_p1; _t2 = x*x; _t3 = q*y"
#: An oscillator on a circle, with two places that follow from it.
FOLLOWED = replace(
    BOUNDED,
    name="followed",
    programs=(
        program("rhs", "q p", "r", "_p1 = 1/r; _t1 = q*_p1", "p; -_t1*r", (2,)),
        *BOUNDED.programs[1:],
        program("reconstruction", "q p x y", "r", BELOW, "_t1 - _t2; _t3 + r", (2,)),
    ),
    reconstructed=(Quantity("x", (), "1", ("x",)), Quantity("y", (), "1", ("y",))),
)

#: Entries of a table over x, y, z, u = p x and v = 3 z/2: a product that two rates have, one that
#: three entries have, squares, and products of two values that are scaled.
ENTRIES = """
0 1 2 1     0 3 1 1/2   0 4 1 -2
1 0 2 -1    1 3 4 3/4   1 1 1 1/8
2 0 1 1/2   2 1 2 -1/4  2 3 3 -1/8
"""
_numbers = ENTRIES.split()
TABLE = Table(
    entries=tuple(
        (int(i), int(j), int(k), Fraction(c))
        for i, j, k, c in zip(*(_numbers[place::4] for place in range(4)), strict=True)
    ),
    vectors=(("x", "y", "z", "u", "v"),),
    scaled=(0, 2),
    scales=(Symbol("_p1"), Number(Fraction(3, 2))),
    passes=((0, 0),),
)
_RATES = program("rhs", "x y z", "p q", "_p1 = p/q; u = _p1*x; v = 1.5*z", "0; 0; 0", (3,))

#: Rates that loop over this table, in a domain.
LOOPED = KernelContext(
    name="looped",
    spec="derivations/looped.toml",
    license="",
    routes=("Route: typed by hand.",),
    equations=("dx/dt = y*z + u*y/2 - 2*v*y", "dy/dt = ...", "dz/dt = ..."),
    state=(Quantity("X", (3,), "1", ("x", "y", "z")),),
    parameters=(Quantity("p", (), "1", ("p",), (0.75,)), Quantity("q", (), "1", ("q",), (1.5,))),
    observables=(Quantity("sum", (), "1", ("sum",)),),
    programs=(
        replace(
            _RATES,
            outputs=tuple(map(Output, ("dx/dt", "dy/dt", "dz/dt"), TABLE.sums())),
            table=TABLE,
        ),
        program("energy", "x y z", "p q", "", "(x*x + y*y + z*z)/2", (), "energy"),
        program("observables", "x y z", "p q", "", "x + y + z", (1,), "sum"),
        program("domain", "x y z", "p q", "", "8 - x", (1,), "one"),
    ),
    domain=(Bound("one", "condition", True, ("x",)),),
)
