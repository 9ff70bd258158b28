"""The target C, reading: a function of ``kernel.c`` by the lines that our template prints.

Comes in: the text. Goes out: a `Body` for each branch. This reader shares no code with the printer.
Read next: `coadjoint.crosscheck.parse_back`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from fractions import Fraction
from math import isfinite

from coadjoint.elementary import ELEMENTARY
from coadjoint.errors import CrossCheckError
from coadjoint.lower.program import Call, Negate, Node, Number, Program, Symbol
from coadjoint.render.targets.body import Body, failure, join, read_loop

_TOKEN = re.compile(
    r"\s+|/\*.*?\*/|(?P<number>\d+\.?\d*(?:e[+-]?\d+)?)|(?P<name>[A-Za-z_]\w*)|(?P<mark>[-+*/(),\[\]])",
    re.DOTALL,
)
_ZEROS = re.compile(
    r"static const unsigned short _zeros\[\] = \{([\d,\s]*)\};\s*"
    r"for \(size_t _z = 0; _z < sizeof _zeros / sizeof \*_zeros; \+\+_z\)\s*"
    r"for \(size_t _n = 0; _n < count; \+\+_n\)\s*"
    r"out\[_zeros\[_z\] \* out_stride \+ _n\] = 0\.0;"
)
#: How far apart rows and members of inputs and time are: 1 and 0 where members share them.
_STEPS = re.compile(
    r"const size_t _(inputs|time)_row = \1_stride \? \1_stride : 1;\s*"
    r"const size_t _\1_member = \1_stride != 0;"
)
_LOOP = re.compile(
    r"COADJOINT_PARTS\s+COADJOINT_INDEPENDENT\s+for \(size_t _n = _first; _n < _last; \+\+_n\) \{"
)
#: The largest number of unknowns that loops solve for, and the loops.
_COUPLED = re.compile(r"enum \{ COUPLED = (\d+) \};")
_EQUATIONS = " ".join(
    """
    static inline void coadjoint_factor(double *restrict entries, size_t size) {
        double column[COUPLED], lower[COUPLED];
        for (size_t j = 0; j < size; ++j) {
            const double pivot = entries[j * (j + 3) / 2];
            for (size_t i = j + 1; i < size; ++i) {
                column[i] = entries[i * (i + 1) / 2 + j];
                lower[i] = column[i] / pivot;
                entries[i * (i + 1) / 2 + j] = lower[i];
            }
            for (size_t i = j + 1; i < size; ++i) {
                double *restrict row = entries + i * (i + 1) / 2;
                for (size_t k = j + 1; k <= i; ++k)
                    row[k] -= column[i] * lower[k];
            }
        }
    }
    static inline void coadjoint_solve(
        const double *restrict entries, double *restrict x, size_t size) {
        for (size_t i = 1; i < size; ++i)
            for (size_t j = 0; j < i; ++j)
                x[i] -= entries[i * (i + 1) / 2 + j] * x[j];
        for (size_t i = 0; i < size; ++i)
            x[i] /= entries[i * (i + 3) / 2];
        for (size_t k = size - 1; k > 0; --k) {
            const double last = x[k];
            for (size_t i = 0; i < k; ++i)
                x[i] -= entries[k * (k + 1) / 2 + i] * last;
        }
    }
    """.replace("(\n        const double", "(const double").split()
)


def read(text: str, program: Program, system: str) -> list[Body]:
    """The branches of the function of a Program."""
    name = f"{system}_{program.name}"
    if program.solves_by_loop:
        _check_equations(text, name)
    if program.table is None:
        return read_c(text, name)
    from coadjoint.render.targets.c.loop_reader import read_loops  # which reads expressions here

    return [read_loops(text, _find_function(text, name), program)]


def _check_equations(text: str, name: str) -> None:
    """The loops that solve equations are those of our template, and fit into their arrays."""
    joined = " ".join(re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL).split())
    found = _COUPLED.findall(joined)
    sizes = [int(size) for size in re.findall(r"coadjoint_factor\(_\w+, (\d+)\);", joined)]
    if len(found) != 1 or joined.count(_EQUATIONS) != 1 or max(sizes, default=0) != int(found[0]):
        raise failure("kernel.c: it solves equations in another way than our template", name)


def _find_function(text: str, name: str) -> str:
    """The body of a function without its comments."""
    function = re.search(rf"^void {name}\([^)]*\)\n\{{\n(.*?)^\}}$", text, re.DOTALL | re.MULTILINE)
    if not function:
        raise failure(f"kernel.c has no function {name!r}", name)
    return re.sub(r"/\*.*?\*/|\(void\)\w+;", "", function[1], flags=re.DOTALL)


def read_c(text: str, name: str) -> list[Body]:
    """The branches of a C function: one, or one for shared and one for separate parameters."""
    body = _find_function(text, name)
    zeros, body = _take_zeros(_STEPS.sub("", body))
    branches = re.fullmatch(
        r"\s*if \(parameters_stride == 0 && count > 0\) \{(.*)\} else \{(.*)\}\s*|(.*)",
        body,
        re.DOTALL,
    )
    assert branches, "the last alternative matches anything"
    if branches[3] is not None:
        return [_read_branch(branches[3], "", zeros, name)]
    return [
        _read_branch(branches[1], "", zeros, name),
        _read_branch(branches[2], " * parameters_stride + _n", zeros, name),
    ]


def _take_zeros(text: str) -> tuple[list[int], str]:
    """The rows that a table sets to zero, and the text without the table and its loop."""
    table = _ZEROS.search(text)
    if not table:
        return [], text
    return [int(row) for row in table[1].split(",") if row.strip()], _ZEROS.sub("", text, count=1)


def _read_branch(text: str, member: str, zeros: list[int], name: str) -> Body:
    """The statements of one branch; ``member`` is what a parameter's index ends with."""
    around = _LOOP.split(text)
    if len(around) != 2 or not around[1].rstrip().endswith("}"):
        raise failure(f"kernel.c: no loop over the members in {text.strip()[:60]!r}", name)
    before, inside = around
    body = Body(outputs=[(row, Number(Fraction(0))) for row in zeros])
    for line in (*_lines(before), *_lines(inside.rstrip()[:-1])):
        _read_line(line, member, body, name)
    return body


def _lines(text: str) -> Iterator[str]:
    """Statements up to their semicolons, on one line each."""
    *lines, rest = text.split(";")
    yield from (" ".join(line.split()) for line in lines)
    yield from filter(None, [" ".join(rest.split())])


def _read_line(line: str, member: str, body: Body, name: str) -> None:
    """One statement of C: an input, a statement or an output."""
    state = re.fullmatch(r"const double (\w+) = state\[(\d+) \* state_stride \+ _n\]", line)
    given = re.fullmatch(rf"const double (\w+) = parameters\[(\d+){re.escape(member)}\]", line)
    driving = re.fullmatch(
        r"const double (\w+) = (inputs|time)\[(\d+) \* _\2_row \+ _n \* _\2_member\]", line
    )
    assigned = re.fullmatch(r"(?:const double (?=\w+ ))?(\w+(?:\[\d+\])?) = (.*)", line)
    array = re.fullmatch(r"double (\w+)\[(\d+)\]", line)
    called = re.fullmatch(r"(coadjoint_\w+)\(([\w, ]*)\)", line)
    output = re.fullmatch(r"out\[(\d+) \* out_stride \+ _n\] = (.*)", line)
    if state:
        body.inputs[state[1]] = ("state", int(state[2]))
    elif given:
        body.inputs[given[1]] = ("parameters", int(given[2]))
    elif driving:
        body.inputs[driving[1]] = (driving[2], int(driving[3]))
    elif output:
        body.outputs.append((int(output[1]), read_expression(output[2], name)))
    elif assigned and _is_declared(assigned[1], line, body.arrays):
        body.statements.append((assigned[1], read_expression(assigned[2], name)))
    elif array:
        body.arrays[array[1]] = int(array[2])
    elif called and (loop := read_loop(called[1], called[2].split(", "), body.arrays)):
        body.statements.append(loop)
    elif line:
        raise failure(f"kernel.c: {line!r} is not a line of our template", name)


def _is_declared(name: str, line: str, arrays: Mapping[str, int]) -> bool:
    """Whether a name is declared where it is assigned, or is an entry of an array that was made."""
    array, bracket, _ = name.partition("[")
    return (array in arrays) if bracket else line.startswith("const ")


def read_expression(text: str, name: str) -> Node:
    """A node from a C expression; ``name`` is the function it stands in, for messages.

    >>> read_expression("a - 2.0", "rhs")
    Add(left=Symbol(name='a'), right=Negate(operand=Number(value=Fraction(2, 1))))
    """
    try:
        return Reader(text, name).whole()
    except RecursionError as error:
        raise failure(f"kernel.c: {text[:60]!r} is nested too deeply", name) from error


class Reader:
    """Reads one C expression over ``+ - * /``, unary minus, calls and parentheses."""

    file, token = "kernel.c", _TOKEN
    #: What stands behind the name of a function.
    suffix = ""

    def __init__(self, text: str, name: str) -> None:
        self.text, self.name = text, name
        self.tokens = list(self._tokens())
        self.at = 0

    def _tokens(self) -> Iterator[tuple[str, str]]:
        end = 0
        for token in self.token.finditer(self.text):
            if token.start() != end:
                break
            end = token.end()
            if token.lastgroup:
                yield token.lastgroup, token[0]
        if end != len(self.text):
            raise failure(f"{self.file}: {self.text[end:]!r} is not a form of a Program", self.name)
        yield "end", ""

    def whole(self) -> Node:
        """The expression, to its last token."""
        node = self.sum()
        if self.tokens[self.at][0] != "end":
            raise self.refusal()
        return node

    def sum(self) -> Node:
        """Products, added up."""
        node = self.product()
        while self.tokens[self.at][1] in ("+", "-"):
            node = join(node, self.take(), self.product())
        return node

    def product(self) -> Node:
        """Factors and divisors."""
        node = self.read_sign()
        while self.tokens[self.at][1] in ("*", "/"):
            node = join(node, self.take(), self.read_sign())
        return node

    def read_sign(self) -> Node:
        """An atom, perhaps with a sign."""
        if self.tokens[self.at][1] != "-":
            return self.atom()
        self.take()
        if self.tokens[self.at][1] == "-":
            raise self.refusal()  # a decrement
        return Negate(self.read_sign())

    def atom(self) -> Node:
        """A number, a name, a call, or a sum in parentheses."""
        kind, text = self.tokens[self.at]
        self.at += 1
        # An integer would divide as integers do, and 1e999 is not a number.
        if kind == "number" and not text.isdigit() and isfinite(float(text)):
            return Number(Fraction(float(text)))
        if kind == "name" and self.tokens[self.at][1] == "[":
            return self._read_item(text)
        if kind == "name" and self.tokens[self.at][1] != "(":
            return Symbol(text)
        called = text.removesuffix(self.suffix)
        if called in ELEMENTARY and text.endswith(self.suffix):
            return Call(called, *self.read_arguments(ELEMENTARY[called].arity))
        if text == "(":
            inner = self.sum()
            if self.take() != ")":
                raise self.refusal()
            return inner
        raise self.refusal()

    def _read_item(self, name: str) -> Node:
        """An entry of an array over which a loop has run."""
        self.take()
        place = self.take()
        if not place.isdigit() or self.take() != "]" or not name.startswith("_"):
            raise self.refusal()
        return Symbol(f"{name}[{place}]")

    def read_arguments(self, count: int) -> list[Node]:
        """The arguments of a function, in parentheses."""
        found = list[Node]()
        for mark in ("(", *"," * (count - 1)):
            if self.take() != mark:
                raise self.refusal()
            found.append(self.read_argument())
        if self.take() != ")":
            raise self.refusal()
        return found

    def read_argument(self) -> Node:
        """One argument of a function."""
        return self.sum()

    def take(self) -> str:
        """The next token."""
        self.at += 1
        return self.tokens[self.at - 1][1]

    def refusal(self) -> CrossCheckError:
        """The failure of rung 3."""
        return failure(f"{self.file}: {self.text!r} is not a form of a Program", self.name)
