"""The target C, reading solvers: what their file says of its system, and what it says of all.

Comes in: the text. Goes out: a `SolverBody` for each function that the system has a part in, the
tables, and the rest of the text, which is that of the template. It shares no code with the printer.
Read next: `coadjoint.crosscheck.solver_text`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from coadjoint.lower.program import Node
from coadjoint.methods import ASKED, JACOBIAN
from coadjoint.render.targets.body import Line, Loop, SolverBody, failure, read_loop
from coadjoint.render.targets.c.reader import Reader

#: The functions that the system has a part in, by name, with the text before their bodies.
_FUNCTIONS = {
    "find_fixed": "INLINE void find_fixed(Block *restrict _block)",
    "expand": "APART void expand(const Block *restrict _block, V _path[restrict STATE][ORDER + 1])",
    **{
        f"find_{name}": f"{kind} void find_{name}(\n    const Block *restrict _block, V _after, "
        "const V *restrict _state, V *restrict _rows)"
        for name, kind in {
            "rates": "LINKAGE",
            **dict.fromkeys(("domain", "projection", "noise", "kinks", JACOBIAN), "static"),
            **dict.fromkeys((*ASKED, "noise_gradient"), "SPARED"),
            **dict.fromkeys((*(f"flow{n}" for n in range(1, 7)), "kahan", "exact_body"), "INLINE"),
        }.items()
    },
}
#: The functions that are loops where the rates are, which belong to the template then.
LOOPED = ("expand", "find_rates")
_TABLE = re.compile(
    r"^static const (?:double|unsigned char|unsigned short) "
    r"(nodes|starts|columns|weights|(?:table|star)_\w+)\[\] = \{\n(.*?)^\};$",
    re.DOTALL | re.MULTILINE,
)
_STATEMENT = re.compile(
    r"\s*(?:(?P<loop>for \([^)]*\)) \{|(?P<end>\})|(?P<plain>[^;{}]*(?:\{[^{}]*\}[^;{}]*)?);)\s*"
)
_ORDERS = "for (int _k = 1; _k < ORDER; ++_k)"
#: How the loop over orders is to be compiled, which changes no value.
_UNROLLED = re.compile(
    r"^#if defined\(__GNUC__\) && !defined\(__clang__\) && \d+ \* ORDER \* \(ORDER \+ 1\) <= 1000\n"
    r"#pragma GCC unroll 32\n#endif\n",
    re.MULTILINE,
)
_TERMS = "for (int _m = 1; _m < _k; ++_m)"
_ASSIGNED = re.compile(r"((?:const )?V )?(\w+(?:\[(?:\d+|_k|_k \+ 1)\])?) = (.*)", re.DOTALL)
_DRIVING = (
    "V _driving[DRIVING + 1]; for (int _i = 0; _i < DRIVING; ++_i) "
    "_driving[_i] = _block->inputs[_i] + _after * _block->slopes[_i]; (void)_driving; (void)_state;"
)
#: Lines that name what a function reads: the array, by the form of the line.
_READ = {
    "parameters": re.compile(r"const V (\w+) = _block->parameters\[(\d+)\]"),
    "fixed": re.compile(r"const V (\w+) = _block->fixed\[(\d+)\]"),
    "path": re.compile(r"V \*restrict const (\w+) = _path\[(\d+)\]"),
    "state": re.compile(r"(\w+)\[0\] = _block->state\[(\d+)\]"),
    "row": re.compile(r"const V (\w+) = _state\[(\d+)\]"),
    "driven": re.compile(r"const V (\w+) = _driving\[(\d+)\]"),
    "driving": re.compile(
        r"V (\w+)\[ORDER \+ 1\] = \{_block->inputs\[(\d+)\], _block->slopes\[\2\]\}"
    ),
}
#: An array that a loop runs over, and the call of one.
_ARRAY = re.compile(r"V (\w+)\[(\d+)\]")
_CALLED = re.compile(r"(coadjoint_\w+)\(([\w, ]*)\)")
_KEPT = re.compile(r"V (\w+)\[ORDER \+ 1\]")
_COUNTS = {
    "_parts": "0.0, " + ", ".join(f"1.0 / {k}" for k in range(1, 42)),
    "_orders": ", ".join(str(k) for k in range(42)),
}
_CONSTANTS = re.compile(r"static const double (_parts|_orders)\[\] = \{([^{}]*)\}")


class VectorReader(Reader):
    """Reads an expression over vectors, some of which are entries of arrays."""

    token = re.compile(
        r"\s+|(?P<number>\d+\.?\d*(?:e[+-]?\d+)?)"
        r"|(?P<name>[A-Za-z_]\w*(?:\[(?:\d+|_k(?: [-+] 1)?|_m|_k - _m)\])?)|(?P<mark>[-+*/(),])"
    )
    suffix = "_of"

    def __init__(self, text: str, name: str, file: str) -> None:
        self.file = file
        super().__init__(text, name)

    def read_argument(self) -> Node:
        """One argument; a number goes to all lanes."""
        if self.tokens[self.at][1] != "all":
            return self.sum()
        self.take()
        self.suffix, own = "", self.suffix
        (inner,) = self.read_arguments(1)
        self.suffix = own
        return inner


class NumberReader(VectorReader):
    """Reads a number that goes to all lanes."""

    suffix = ""


def read_function(text: str, function: str, file: str) -> SolverBody:
    """One of the functions that the system has a part in.

    Args:
        text: Of the file.
        function: Its name.
        file: Name of the file, for messages.

    Raises:
        CrossCheckError: It has a line that no template prints.
    """
    _, begin, end = _find_body(text, function)
    if end < 0:
        raise failure(f"{file} has no function {function!r}", function)
    inside = re.sub(r"/\*.*?\*/", "", text[begin:end], flags=re.DOTALL)
    return _Reading(function, file).read(_UNROLLED.sub("", inside, count=1))


def read_tables(text: str, file: str) -> dict[str, tuple[float, ...]]:
    """The tables by name: those of the method of order 8, and what recurrences loop over."""
    tables = dict[str, tuple[float, ...]]()
    for name, inside in _TABLE.findall(text):
        if name in tables:
            raise failure(f"{file} has the table {name} twice", name)
        try:
            tables[name] = tuple(float(entry) for entry in inside.split(",") if entry.strip())
        except ValueError as error:
            raise failure(f"{file}: the table {name}: {error}", name) from error
    return tables


def rest(text: str, *, is_looped: bool) -> str:
    """The text without what belongs to the system: bodies of its functions, and tables."""
    for function in _FUNCTIONS:
        if not (is_looped and function in LOOPED):
            head, _, end = _find_body(text, function)
            if end >= 0:
                text = f"{text[:head]}{function} {{}}{text[end + 1 :]}"
    return _TABLE.sub(r"\1 {}", text)


def _find_body(text: str, function: str) -> tuple[int, int, int]:
    """Where a function begins, its body, and where that ends, at its brace; -1 where there is none.

    Texts are long, and a pattern would try each of their letters.
    """
    head = f"\n{_FUNCTIONS[function]}\n{{\n"
    at = text.find(head)
    begin = at + len(head)
    end = text.find("\n}\n", begin - 1) if at >= 0 else -1
    return at + 1, begin, end + 1 if end >= 0 else -1


class _Reading:
    """A function being read."""

    def __init__(self, function: str, file: str) -> None:
        self.function, self.file, self.body = function, file, SolverBody()
        self._stored: list[str] = []

    def read(self, text: str) -> SolverBody:
        """All lines of a body."""
        if self.function not in ("find_fixed", "expand"):
            text = self._without_driving(text)
        statements, ended = self._statements(text), False
        for kind, statement in statements:
            if kind == "loop" and statement == _ORDERS and self.function == "expand" and not ended:
                self._read_orders(statements)
                ended = True
            elif kind != "plain" or ended:
                raise self._refusal(statement)
            elif not self._read_setup(statement):
                self._read_line(statement)
        if self.function == "find_fixed" and self._stored != [name for name, _ in self.body.lines]:
            raise self._refusal(f"it stores {self._stored}")
        if self.function == "expand" and not ended:
            raise self._refusal("it has no loop over orders")
        return self.body

    def _without_driving(self, text: str) -> str:
        """The body of a function of the state after the lines that find inputs."""
        joined = " ".join(text.split())
        if not joined.startswith(_DRIVING):
            raise self._refusal(joined[: len(_DRIVING)])
        return joined.removeprefix(_DRIVING)

    def _statements(self, text: str) -> Iterator[tuple[str, str]]:
        """Statements and loops as they follow one another, each on one line."""
        at, text = 0, text.strip()
        while at < len(text):
            found = _STATEMENT.match(text, at)
            if not found:
                raise self._refusal(text[at:])
            at = found.end()
            kind = found.lastgroup or ""
            yield kind, " ".join(found[kind].split())

    def _read_setup(self, line: str) -> bool:
        """Whether a line names something that is read; none may follow what is computed."""
        if self.function == "find_fixed":
            stored = re.fullmatch(r"_block->fixed\[(\d+)\] = (\w+)", line)
            if line == "(void)_block" or (stored and int(stored[1]) == len(self._stored)):
                self._stored += [stored[2]] if stored else []
                return True
        for array, form in _READ.items():
            found = form.fullmatch(line)
            if found:
                self._name_input(found[1], array, int(found[2]))
                return True
        constants, kept = _CONSTANTS.fullmatch(line), _KEPT.fullmatch(line)
        if constants:
            if " ".join(constants[2].split()).rstrip(", ") != _COUNTS[constants[1]]:
                raise self._refusal(line)
            return True
        if kept:
            self.body.kept.append(kept[1])
        return bool(kept)

    def _name_input(self, name: str, array: str, row: int) -> None:
        """A name for a row of an array; the state is both a row of the path and of the block."""
        if self.body.lines:
            raise self._refusal(f"{name} is named after it may have been read")
        if array == "state" and self.body.inputs.get(name) == ("path", row):
            del self.body.inputs[name]
        if name in self.body.inputs:
            raise self._refusal(f"{name} is named twice")
        array = {"row": "state", "driven": "driving"}.get(array, array)
        self.body.inputs[name] = (array, row)

    def _read_line(self, line: str) -> None:
        """A line that computes something, or makes an array for a loop."""
        loop = self._read_loop(line)
        if loop is not None:
            self.body.lines += loop
            return
        declared, name, value = self._assignment(line)
        if declared != ("" if "[" in name else "const V "):
            raise self._refusal(line)
        self.body.lines.append((name, value))

    def _read_orders(self, statements: Iterator[tuple[str, str]]) -> None:
        """The loop over orders, to its end."""
        for kind, statement in statements:
            if kind == "loop" and statement == _TERMS:
                self.body.orders.append(Loop(tuple(self._read_terms(statements))))
            elif kind == "plain" and (loop := self._read_loop(statement)) is not None:
                self.body.orders += loop
            elif kind == "plain":
                declared, name, value = self._assignment(statement)
                if declared == "V ":
                    self.body.starts.add(name)
                elif declared != ("" if "[" in name else "const V "):
                    raise self._refusal(statement)
                self.body.orders.append((name, value))
            elif kind == "end":
                return
            else:
                raise self._refusal(statement)
        raise self._refusal("the loop over orders does not end")

    def _read_terms(self, statements: Iterator[tuple[str, str]]) -> Iterator[tuple[str, Node]]:
        """What is added to sums that were made before."""
        for kind, statement in statements:
            if kind == "end":
                return
            declared, name, value = self._assignment(statement)
            if kind != "plain" or declared or name not in self.body.starts:
                raise self._refusal(statement)
            yield name, value

    def _read_loop(self, line: str) -> list[Line] | None:
        """What a line computes that makes an array for a loop or calls one; None of others."""
        array, called = _ARRAY.fullmatch(line), _CALLED.fullmatch(line)
        if array:
            self.body.arrays[array[1]] = int(array[2])
            return []
        loop = called and read_loop(called[1], called[2].split(", "), self.body.arrays)
        return [loop] if loop else None

    def _assignment(self, line: str) -> tuple[str, str, Node]:
        """How a name is declared, the name, and its value."""
        found = _ASSIGNED.fullmatch(line)
        if not found:
            raise self._refusal(line)
        constant = re.fullmatch(r"all\((.*)\)", found[3])
        reader = NumberReader if constant else VectorReader
        text = constant[1] if constant else found[3]
        value = reader(text, self.function, self.file).whole()
        return found[1] or "", found[2], value

    def _refusal(self, line: str) -> Exception:
        return failure(
            f"{self.file}, {self.function}: {line[:80]!r} is no line of it", self.function
        )
