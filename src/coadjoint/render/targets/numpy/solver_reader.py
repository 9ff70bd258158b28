"""The target NumPy, reading solvers: the function ``expand``, line by line.

Comes in: the text. Goes out: a `SolverBody`, and the rest of the text, which is that of the
template.
Read next: `coadjoint.crosscheck.solver_text`.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from coadjoint.lower.program import Node, Symbol
from coadjoint.render.targets.body import Line, Loop, SolverBody, failure
from coadjoint.render.targets.numpy.reader import find_function
from coadjoint.render.targets.python_text import Reader

_ARGUMENTS = ["state", "parameters", "driving", "slopes", "order"]
_BODY = re.compile(r"^    _parts = .*?^    return path$", re.DOTALL | re.MULTILINE)
#: What names the scales of a table and hands them to loops, and what stands before it.
_LOOPED = re.compile(
    r"^    # of the parameters alone\n.*?^    _scales = \([^()]*\)$",
    re.DOTALL | re.MULTILINE,
)
_TABLE = re.compile(r"^((?:TABLE|STAR)_\w+) = \(\n(.*?)^\)$", re.DOTALL | re.MULTILINE)
_MAP_ARGUMENTS = ["state", "parameters", "_h"]
#: The lines of the functions of maps, and the table of what does not apply.
_MAPS = re.compile(
    r'(?<=parameters are \(k,\) or \(k, N\)\."""\n).*?(?=    return _rows$)',
    re.DOTALL | re.MULTILINE,
)
_REFUSALS = re.compile(r"^REFUSALS = (\{.*?^\})$", re.DOTALL | re.MULTILINE)
_INDEX = re.compile(r"\d+|_k|_m|_k \+ 1|_k - _m")
#: Lines that are the same in all systems; those about the path say what a row of the state is.
_FIXED = (
    "_parts = [1.0 / max(k, 1) for k in range(order + 1)]",
    "_orders = [float(k) for k in range(order + 1)]",
    "path = np.empty((len(state), order + 1, state.shape[1]))",
    "path[:, 0] = state",
)
_READ = {
    "parameters": re.compile(r"(\w+) = parameters\[(\d+)\]"),
    "state": re.compile(r"(\w+) = path\[(\d+)\]"),
    "driving": re.compile(r"\(?(\w+)\[0\], \1\[1\]\)? = \(driving\[(\d+)\], slopes\[\2\]\)"),
}
_ROW = re.compile(r"(\w+) = (state|parameters)\[(\d+)\]")
_KEPT = re.compile(r"(\w+) = np\.empty\(path\.shape\[1:\]\)")
_ZEROS = re.compile(r"(\w+) = np\.zeros\(\(order \+ 1, state\.shape\[1\]\)\)")
_TERMS = "range(1, _k)"
#: The functions of a system with kinks, without ``find_``.
HELD = ("rates", "kinks")
_HELD_READ = {
    name: re.compile(rf"(\w+) = {name}\[(\d+)\]") for name in ("state", "parameters", "driving")
}
_HELD_ROWS = re.compile(r"_rows = np\.empty\(\(\d+, state\.shape\[1\]\)\)")
_HELD_BODY = re.compile(
    r"^(def find_\w+\(state, parameters, driving\):\n    \"\"\"[^\n]*\n"
    r"    _rows = [^\n]*\n).*?^    return _rows$",
    re.DOTALL | re.MULTILINE,
)


def read_expand(text: str, file: str, *, is_looped: bool = False) -> SolverBody:
    """What ``expand`` does, before it calls loops if it does.

    Args:
        text: Of the file.
        file: Its name, for messages.
        is_looped: Whether it calls loops.

    Raises:
        CrossCheckError: It has a line that no template prints.
    """
    reading = _Reading(file)
    functions = reading.functions(text, _is_allowed)
    function = functions.get("expand")
    if function is None or [each.arg for each in function.args.args] != _ARGUMENTS:
        raise reading.refusal(f"there is no function expand of {', '.join(_ARGUMENTS)}")
    if is_looped:
        reading.read_scales(function.body)
    else:
        reading.read_body(function.body)
    return reading.body


def read_map(text: str, name: str, file: str) -> SolverBody:
    """What the function of a map does.

    Args:
        text: Of the file.
        name: Of the map.
        file: Its name, for messages.

    Raises:
        CrossCheckError: There is no such function, or it has a line that no template prints.
    """
    reading = _Reading(file)
    function = reading.functions(text, _is_allowed).get(f"find_{name}")
    if function is None or [each.arg for each in function.args.args] != _MAP_ARGUMENTS:
        raise reading.refusal(f"there is no function find_{name} of {', '.join(_MAP_ARGUMENTS)}")
    reading.read_map(function.body)
    return reading.body


def read_refusals(text: str) -> dict[str, str]:
    """Why some methods do not apply, by their names."""
    found = _REFUSALS.search(text)
    return {} if found is None else ast.literal_eval(found[1])


def read_rows(text: str, function: str, file: str) -> SolverBody:
    """What a function of a system with kinks does, which computes rows.

    Args:
        text: Of the file.
        function: Its name.
        file: Name of the file, for messages.

    Raises:
        CrossCheckError: It has a line that no template prints.
    """
    reading = _Reading(file, function)
    found = reading.functions(text, _is_allowed).get(function)
    if found is None or [each.arg for each in found.args.args] != _ARGUMENTS[:3]:
        raise reading.refusal(f"there is no function {function} of {', '.join(_ARGUMENTS[:3])}")
    reading.read_held(found.body)
    return reading.body


def read_tables(text: str, file: str) -> dict[str, tuple[float, ...]]:
    """What recurrences loop over, by name in small letters."""
    tables = dict[str, tuple[float, ...]]()
    for name, inside in _TABLE.findall(text):
        try:
            tables[name.lower()] = ast.literal_eval(f"({inside})")
        except (SyntaxError, ValueError) as error:
            raise failure(f"{file}: the table {name}: {error}", name) from error
    return tables


def rest(text: str, *, is_looped: bool) -> str:
    """The text without the lines of ``expand``, and without tables."""
    body = _LOOPED if is_looped else _BODY
    text = _TABLE.sub(r"\1 = ()", body.sub("", _MAPS.sub("", text), count=1))
    return _HELD_BODY.sub(r"\1", text)


def _is_allowed(item: ast.stmt) -> bool:
    """Whether a file may have a statement in addition to the function."""
    match item:
        case ast.Import(names=[ast.alias(name="numpy", asname="np")]):
            return True
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.Constant()):
            return name in (
                "ID",
                "BRANCHES",
                "PRODUCTS",
                "OPERATIONS",
                "MEMBERS",
                "EXACT",
                "NEWTON",
                "ORBITS",
            )
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.Dict()):
            return name in ("REFUSALS", "SCHEDULES", "MOVED")
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.Tuple()):
            return name in (
                "KINKS",
                "STRUCTURED",
                "SPHERES",
                "CARRIERS",
                "BANDS",
            ) or name.startswith(("TABLE_", "STAR_"))
    return False


class _Reading(Reader):
    """The function being read."""

    def __init__(self, file: str, function: str = "expand") -> None:
        super().__init__(file, function, find_function)
        self.body = SolverBody()
        self._told: list[str] = []

    def node(self, tree: ast.expr) -> Node:
        """A node; an entry of an array is a name with its order."""
        match tree:
            case ast.Subscript(ast.Name(id=name), index) if _INDEX.fullmatch(ast.unparse(index)):
                return Symbol(f"{name}[{ast.unparse(index)}]")
        return super().node(tree)

    def read_body(self, lines: list[ast.stmt]) -> None:
        """All lines, the last of which returns the path."""
        docs, *inside, last, returned = lines
        if not isinstance(docs, ast.Expr) or ast.unparse(returned) != "return path":
            raise self.refusal("does not return the path", returned)
        for line in inside:
            if not self._read_setup(ast.unparse(line), line):
                self.body.lines += self._read_lines(line)
        told = [line for line in _FIXED if line in self._told]
        if told != self._told or not set(told) >= set(_FIXED) - {_FIXED[1]}:
            raise self.refusal(f"begins with {self._told}")
        match last:
            case ast.For(ast.Name("_k"), over, body, []) if ast.unparse(over) == "range(1, order)":
                self.body.orders += self._read_orders(body)
            case _:
                raise self.refusal("is no loop over orders", last)

    def read_map(self, lines: list[ast.stmt]) -> None:
        """All lines of the function of a map."""
        docs, *inside, returned = lines
        if not isinstance(docs, ast.Expr) or ast.unparse(returned) != "return _rows":
            raise self.refusal("does not return the rows", returned)
        made = False
        for line in inside:
            text = ast.unparse(line)
            found = _ROW.fullmatch(text)
            if text == "_rows = np.empty(state.shape)":
                made = True
            elif found and not self.body.lines:
                self.body.inputs[found[1]] = (found[2], int(found[3]))
            else:
                self.body.lines += self._read_lines(line)
        if not made:
            raise self.refusal("makes no rows")

    def read_held(self, lines: list[ast.stmt]) -> None:
        """All lines of a function that computes rows."""
        docs, made, *inside, returned = lines
        told = isinstance(docs, ast.Expr) and _HELD_ROWS.fullmatch(ast.unparse(made))
        if not told or ast.unparse(returned) != "return _rows":
            raise self.refusal("does not return rows", returned)
        for line in inside:
            text = ast.unparse(line)
            for array, form in _HELD_READ.items():
                found = form.fullmatch(text)
                if found and not self.body.lines and found[1] not in self.body.inputs:
                    self.body.inputs[found[1]] = (array, int(found[2]))
                    break
            else:
                self.body.lines += self._read_lines(line)

    def read_scales(self, lines: list[ast.stmt]) -> None:
        """Lines of the parameters, and the scales that loops begin with."""
        docs, *inside, scales, returned = lines
        wanted = "return _expand_products(state, _scales, order)"
        if not isinstance(docs, ast.Expr) or ast.unparse(returned) != wanted:
            raise self.refusal("does not hand scales to the loops", returned)
        for line in inside:
            if not self._read_setup(ast.unparse(line), line):
                self.body.lines.append(self._assignment(line))
        match scales:
            case ast.Assign([ast.Name("_scales")], ast.Tuple(elts=names)):
                self.body.scales = [ast.unparse(name) for name in names]
            case _:
                raise self.refusal("does not name scales", scales)

    def _read_setup(self, text: str, line: ast.stmt) -> bool:
        """Whether a line names something that is read."""
        if text in _FIXED:
            self._told.append(text)
            return True
        for array, form in _READ.items():
            found = form.fullmatch(text)
            if found:
                self._name_input(found[1], array, int(found[2]), line)
                return True
        kept, zeros = _KEPT.fullmatch(text), _ZEROS.fullmatch(text)
        if kept:
            self.body.kept.append(kept[1])
        elif zeros:
            self.body.inputs[zeros[1]] = ("zeros", 0)
        return bool(kept or zeros)

    def _name_input(self, name: str, array: str, row: int, line: ast.stmt) -> None:
        """A name for a row of an array, before anything that moves is computed."""
        made = self.body.inputs.pop(name, None)
        late = any("[" in assigned for assigned, _ in self.body.lines)
        if late or made != (("zeros", 0) if array == "driving" else None):
            raise self.refusal("is out of place", line)
        self.body.inputs[name] = (array, row)

    def _read_lines(self, line: ast.stmt) -> list[Line]:
        """What a line computes: nothing where it makes an array for a loop."""
        loop = self.read_loop(line, self.body.arrays)
        return [self._assignment(line)] if loop is None else loop

    def _assignment(self, line: ast.stmt) -> tuple[str, Node]:
        """A name and its value."""
        match line:
            case ast.Assign([ast.Name(id=name)], value):
                return name, self.node(value)
            case ast.Assign([ast.Subscript() as entry], value):
                assigned = self.node(entry)
                if isinstance(assigned, Symbol):
                    return assigned.name, self.node(value)
        raise self.refusal("is no line of a recurrence", line)

    def _read_orders(self, lines: list[ast.stmt]) -> Iterator[tuple[str, Node] | Loop]:
        """The loop over orders."""
        for line in lines:
            match line:
                case ast.For(ast.Name("_m"), over, body, []) if ast.unparse(over) == _TERMS:
                    yield Loop(tuple(map(self._assignment, body)))
                case _:
                    yield from self._read_lines(line)
