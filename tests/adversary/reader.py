"""The judge's own reader of formulas: text to values of 50 digits, without the engine.

Comes in: the text of a formula as docs/specs.md describes it, and values by name: numbers, vectors
as lists, matrices as lists of rows. Goes out: its value, or `UndefinedError` where it has none.
Nothing here is shared with `coadjoint`. Read next: `tests.adversary.motion`.
"""

from __future__ import annotations

import re
from fractions import Fraction
from functools import cache

import mpmath

#: A context of its own, so that no precision set elsewhere changes what the judge computes.
CONTEXT = mpmath.ctx_mp.MPContext()
CONTEXT.dps = 50
mpf = CONTEXT.mpf

_TOKEN = re.compile(
    r"\s*(?:(\d+(?:\.\d+)?)|([A-Za-z][A-Za-z0-9_]*)|(\*\*|==|>=|<=|[-+*/^(),\[\]<>]))"
)


class UndefinedError(ArithmeticError):
    """A formula has no real value at a point."""


def number(value):
    """A rational number, or its text, in 50 digits."""
    if isinstance(value, str):
        value = Fraction(value)
    return mpf(value.numerator) / value.denominator if isinstance(value, Fraction) else mpf(value)


@cache
def read(text):
    """The tree of a formula: nested tuples, the operation first."""
    tokens, at, text = [], 0, text.strip()
    while at < len(text):
        found = _TOKEN.match(text, at)
        if found is None:
            raise ValueError(f"no formula: {text!r} at {at}")
        tokens.append(found.group(1) or found.group(2) or found.group(3))
        at = found.end()
    reader = _Reader(tokens)
    tree = reader.sum()
    if reader.tokens:
        raise ValueError(f"no formula: {text!r} at {reader.tokens}")
    return tree


class _Reader:
    """Recursive descent; the tokens that are left stand in `tokens`."""

    def __init__(self, tokens):
        self.tokens = tokens

    def next(self):
        return self.tokens[0] if self.tokens else ""

    def take(self, expected=""):
        token = self.tokens.pop(0) if self.tokens else ""
        if expected and token != expected:
            raise ValueError(f"expected {expected!r}, found {token!r}")
        return token

    def sum(self):
        tree = self.product()
        while self.next() in ("+", "-"):
            tree = (self.take(), tree, self.product())
        return tree

    def product(self):
        tree = self.signed()
        while self.next() in ("*", "/"):
            tree = (self.take(), tree, self.signed())
        return tree

    def signed(self):
        if self.next() == "+":
            self.take()
            return self.signed()
        if self.next() == "-":
            self.take()
            return ("negate", self.signed())
        return self.power()

    def power(self):
        base = self.atom()
        if self.next() in ("^", "**"):
            self.take()
            return ("^", base, self.exponent())
        return base

    def exponent(self):
        """An integer, or a fraction in parentheses as certificates write it."""
        closed = self.next() == "(" and bool(self.take())
        sign = -1 if self.next() == "-" and self.take() else 1
        value = Fraction(self.take())
        if closed and self.next() == "/":
            self.take()
            value /= int(self.take())
        if closed:
            self.take(")")
        return sign * value

    def atom(self):
        token = self.take()
        if token == "(":
            tree = self.sum()
            self.take(")")
            return tree
        if token[:1].isdigit():
            return ("number", number(token))
        if not token[:1].isalpha():
            raise ValueError(f"misplaced {token!r}")
        if self.next() == "(":
            return ("call", token, *self.list("(", ")"))
        if self.next() == "[":
            return ("index", token, *(int(i[1]) for i in self.list("[", "]")))
        return ("name", token)

    def list(self, opening, closing):
        self.take(opening)
        found = [self.sum()]
        while self.next() == ",":
            self.take()
            found.append(self.sum())
        self.take(closing)
        return found


def names_in(tree):
    """The names that a tree holds, functions left out."""
    if tree[0] in ("name", "index"):
        return {tree[1]}
    return {name for part in tree[1:] if isinstance(part, tuple) for name in names_in(part)}


def factors_of(tree):
    """The factors that a tree shows, for the branches of a zero set."""
    if tree[0] == "*":
        return [*factors_of(tree[1]), *factors_of(tree[2])]
    if tree[0] == "negate":
        return factors_of(tree[1])
    if tree[0] == "^" and tree[2] > 0:
        return factors_of(tree[1])
    return [] if tree[0] == "number" else [tree]


def value(tree, names, definitions=None):
    """The value of a tree.

    Args:
        tree: What `read` returned.
        names: Values by name.
        definitions: Functions with arguments: name -> (names of the arguments, tree).
    """
    kind = tree[0]
    if kind == "number":
        return tree[1]
    if kind == "name":
        return names[tree[1]]
    if kind == "index":
        found = names[tree[1]]
        for place in tree[2:]:
            found = found[place - 1]
        return found
    if kind == "call":
        arguments = [value(part, names, definitions) for part in tree[2:]]
        if definitions and tree[1] in definitions:
            inner, body = definitions[tree[1]]
            local = {**names, **dict(zip(inner, arguments, strict=True))}
            return value(body, local, definitions)
        return FUNCTIONS[tree[1]](*arguments)
    if kind == "^":
        return power(value(tree[1], names, definitions), tree[2])
    if kind == "negate":
        return scale(-1, value(tree[1], names, definitions))
    a, b = value(tree[1], names, definitions), value(tree[2], names, definitions)
    return {"+": add, "-": subtract, "*": multiply, "/": divide}[kind](a, b)


def entries(found):
    """The numbers of a value of any shape, row by row."""
    return [x for part in found for x in entries(part)] if isinstance(found, list) else [found]


def add(a, b):
    """The sum of values of one shape."""
    return list(map(add, a, b)) if isinstance(a, list) else a + b


def subtract(a, b):
    """The difference of values of one shape."""
    return list(map(subtract, a, b)) if isinstance(a, list) else a - b


def scale(factor, a):
    """A number times a value of any shape."""
    return [scale(factor, part) for part in a] if isinstance(a, list) else factor * a


def multiply(a, b):
    """A product: scalar times anything, matrix times vector or matrix."""
    if not isinstance(a, list):
        return scale(a, b)
    if not isinstance(b, list):
        return scale(b, a)
    if isinstance(b[0], list):
        return [[dot(row, column) for column in zip(*b, strict=True)] for row in a]
    return [dot(row, b) for row in a]


def divide(a, b):
    """A value divided by a number."""
    if b == 0:
        raise UndefinedError("division by zero")
    return scale(1 / b, a)


def dot(a, b):
    """The sum of products."""
    return sum((x * y for x, y in zip(a, b, strict=True)), mpf(0))


def power(base, exponent):
    """A power of a number or of a square matrix."""
    if isinstance(base, list):
        base, exponent = (inverse(base), -exponent) if exponent < 0 else (base, exponent)
        result = diagonal([mpf(1)] * len(base))
        for _ in range(int(exponent)):
            result = multiply(result, base)
        return result
    if exponent.denominator == 1:
        if base == 0 and exponent < 0:
            raise UndefinedError("division by zero")
        return base ** int(exponent)
    if base <= 0:
        raise UndefinedError("a fractional power of a number that is not positive")
    return base ** number(exponent)


def square_root(x):
    """The root of a number that is not negative."""
    if x < 0:
        raise UndefinedError("square root of a negative number")
    return CONTEXT.sqrt(x)


def logarithm(x):
    """The logarithm of a positive number."""
    if x <= 0:
        raise UndefinedError("logarithm of a number that is not positive")
    return CONTEXT.log(x)


def exponential(x):
    """The exponential function of a number that is not huge."""
    if abs(x) > 2000:
        raise UndefinedError("too large a power for a judge")
    return CONTEXT.exp(x)


def diagonal(a):
    """The diagonal matrix of a vector, or the diagonal of a matrix."""
    if isinstance(a[0], list):
        return [row[i] for i, row in enumerate(a)]
    return [[x if i == j else mpf(0) for j in range(len(a))] for i, x in enumerate(a)]


def cross(a, b):
    """The cross product."""
    return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]


def determinant(a):
    """The determinant, by expansion along the first row."""
    if len(a) == 1:
        return a[0][0]
    minors = ([row[:j] + row[j + 1 :] for row in a[1:]] for j in range(len(a)))
    return sum(((-1) ** j * a[0][j] * determinant(m) for j, m in enumerate(minors)), mpf(0))


def inverse(a):
    """The inverse matrix, column by column."""
    columns = [solve(a, [mpf(i == j) for i in range(len(a))]) for j in range(len(a))]
    return [list(row) for row in zip(*columns, strict=True)]


def solve(matrix, right):
    """The solution of linear equations by elimination with pivots."""
    rows = [[*row, x] for row, x in zip(matrix, right, strict=True)]
    size = len(rows)
    scales = [max(map(abs, row[:-1]), default=0) for row in rows]
    for k in range(size):
        pivot = max(range(k, size), key=lambda i: abs(rows[i][k]))
        if abs(rows[pivot][k]) <= mpf(10) ** -30 * max(scales):
            raise UndefinedError("singular equations")
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(k + 1, size):
            factor = rows[i][k] / rows[k][k]
            if factor:
                rows[i] = [x - factor * y for x, y in zip(rows[i], rows[k], strict=True)]
    found = [mpf(0)] * size
    for k in reversed(range(size)):
        found[k] = (rows[k][-1] - dot(rows[k][k + 1 : -1], found[k + 1 :])) / rows[k][k]
    return found


def transpose(a):
    """Rows as columns."""
    return [list(row) for row in zip(*a, strict=True)]


def multiply_quaternions(p, q):
    """Hamilton's product by his rules i^2 = j^2 = k^2 = ijk = -1, unit by unit."""
    units = {(0, n): (1, n) for n in range(4)} | {(n, 0): (1, n) for n in range(4)}
    units |= {(n, n): (-1, 0) for n in (1, 2, 3)}
    for i, j, k in ((1, 2, 3), (2, 3, 1), (3, 1, 2)):
        units |= {(i, j): (1, k), (j, i): (-1, k)}
    found = [mpf(0)] * 4
    for (i, j), (sign, k) in units.items():
        found[k] += sign * p[i] * q[j]
    return found


def conjugate(q):
    """The quaternion with the other sign of its vector."""
    return [q[0], *(-x for x in q[1:])]


def rotate(q, v):
    """``q v q*`` of a quaternion, without its real part."""
    return multiply_quaternions(multiply_quaternions(q, [mpf(0), *v]), conjugate(q))[1:]


def rotation(g):
    """The matrix that turns as a quaternion does; the square part of a pose ``[R, x]``."""
    if isinstance(g[0], list):
        return [row[:-1] for row in g]
    return transpose([rotate(g, [mpf(i == j) for i in range(3)]) for j in range(3)])


FUNCTIONS = {
    "qmul": multiply_quaternions,
    "conjugate": conjugate,
    "rotate": rotate,
    "rotation": rotation,
    "translation": lambda g: [row[-1] for row in g],
    "sqrt": square_root,
    "log": logarithm,
    "exp": exponential,
    "sin": CONTEXT.sin,
    "cos": CONTEXT.cos,
    "tan": CONTEXT.tan,
    "dot": dot,
    "cross": cross,
    "norm": lambda a: square_root(dot(a, a)),
    "hat": lambda a: [[mpf(0), -a[2], a[1]], [a[2], mpf(0), -a[0]], [-a[1], a[0], mpf(0)]],
    "trace": lambda a: sum(diagonal(a), mpf(0)),
    "transpose": transpose,
    "det": determinant,
    "inverse": inverse,
    "diag": diagonal,
    "outer": lambda a, b: [[x * y for y in b] for x in a],
    "rows": lambda *rows: list(rows),
    "vector": lambda *components: list(components),
    "commutator": lambda a, b: subtract(multiply(a, b), multiply(b, a)),
}
