"""Cross-check, texts of families: what each target prints of a part reads back as it was lowered.

Comes in: what the texts of a family say, and the texts. Goes out: how many lines were compared, or
a `CrossCheckError`. Places of names are read as arithmetic: a place has to lead to the right row
for several numbers of members, and every member.
Read next: `coadjoint.crosscheck.families`.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import product

from coadjoint.crosscheck.family_series import check_series_text
from coadjoint.crosscheck.parse_back import as_printed
from coadjoint.errors import CrossCheckError
from coadjoint.lower.loops import SUM, Loops, Part, Read
from coadjoint.lower.program import Node
from coadjoint.render.families import FamilyContext
from coadjoint.render.family_solvers import arrange_family
from coadjoint.render.targets.body import failure
from coadjoint.render.targets.c.reader import read_expression as read_c
from coadjoint.render.targets.numpy.reader import read_expression as read_numpy
from coadjoint.render.targets.python.reader import read_expression as read_python

#: Numbers of members for which places are compared.
_SIZES = (1, 2, 3, 5)
_C_PLACE = re.compile(
    r"_run\.(state|parameters|inputs) \+ \((.*)\) \* _run\.(stride|row|inputs_row)"
    r" \+ _run\.n( \* _run\.(?:own|driven))?"
)
#: How rows of each array, and trajectories in a row, are apart.
_C_STRIDES = {
    "state": ("stride", None),
    "parameters": ("row", " * _run.own"),
    "inputs": ("inputs_row", " * _run.driven"),
}
#: Places that have no row.
_C_FIXED = {"_run.time + _run.n * _run.timed": "time", "_run.sizes": "sizes"}

#: Lines of a tile that add terms to sums, and say where sums are.
_C_ADDS = re.compile(
    r"_parts|_term\d+\[_l\] (\+=|= _out)|_out\d+\[_l\] = _term|double \*const _out\d+ = .* \+ _j"
)


@dataclass
class _Text:
    """What the text of a part does.

    Attributes:
        places: Array and row by name; the row is an expression in ``i``, ``j`` and ``size``.
        steps: In C, what says whether the lanes have values of their own; in a tile, how they read.
        sums: The number of a sum by name.
        lines: Names and values, in order, results among them.
        adds: In C, the lines that add terms of a pair to sums.
    """

    places: dict[str, tuple[str, str]] = field(default_factory=dict)
    steps: dict[str, str] = field(default_factory=dict)
    sums: dict[str, int] = field(default_factory=dict)
    lines: list[tuple[str, Node]] = field(default_factory=list)
    adds: list[str] = field(default_factory=list)


def check_family_text(
    context: FamilyContext, texts: Mapping[str, str], printed: Mapping[str, str]
) -> dict[str, int]:
    """Every part of every text does what was lowered.

    Args:
        context: What the texts say.
        texts: The files by name.
        printed: What the templates print.

    Returns:
        Lines that were compared, by function.

    Raises:
        CrossCheckError: A text does something else.
    """
    for file, text in printed.items():
        if texts.get(file) != text:
            raise failure(f"{file} is another text than that of our template", context.name)
    readers: dict[str, Callable[[str, str, str], _Text]] = {
        "kernel.c": _read_c,
        "kernel.py": _read_numpy,
        "kernel_python.py": _read_python,
    }
    lines = dict.fromkeys(context.loops, 0)
    for name, loops in context.loops.items():
        for part_name, part in _list_parts(loops):
            for file, read in readers.items():
                found = read(texts[file], part_name, name)
                lines[name] += _check_part(part, found, loops.wraps, file, part_name)
        if loops.partners is not None:
            lines[name] += _check_pairs(loops, texts["kernel.c"])
    if context.torus is None:  # of a plane there is no generated solver
        lines["rhs"] += check_series_text(arrange_family(context.held, context.counts), texts)
    return lines


def _list_parts(loops: Loops) -> Iterator[tuple[str, Part]]:
    """The parts of a function by the names that they have in texts."""
    if loops.partners is not None:
        yield f"{loops.name}_partners", loops.partners
    if loops.member is not None:
        yield f"{loops.name}_member", loops.member
    for n, (_, part) in enumerate(loops.ends):
        yield f"{loops.name}_end_{n}", part
    for n, each in enumerate(loops.totals):
        yield f"{loops.name}_terms_{n}", each.part
    if loops.finish is not None:
        yield f"{loops.name}_finish", loops.finish
    if loops.solve is not None:
        yield f"{loops.name}_factors", loops.solve.factors
    if loops.products is not None and loops.products.scale is not None:
        yield f"{loops.name}_factors", loops.products.scale


def _check_part(part: Part, found: _Text, wraps: bool, file: str, name: str) -> int:
    """A text does what a part does; how many lines were compared."""
    program = part.program
    names = [read.name for read in part.reads]
    if sorted(found.places) != sorted(names):
        raise failure(f"{file}: {name} reads {sorted(found.places)}; expected {names}", name)
    for read in part.reads:
        _check_place(read, found, wraps, file, name)
    sums = {each: int(each.removeprefix(SUM)) for each in program.state[len(names) :]}
    if found.sums != sums:
        raise failure(f"{file}: {name} reads the sums {found.sums}; expected {sums}", name)
    wanted = [(each.name, as_printed(each.value)) for each in program.statements]
    wanted += [(f"_out{n}", as_printed(each.value)) for n, each in enumerate(program.outputs)]
    if found.lines != wanted:
        pairs = zip(found.lines, wanted, strict=False)
        first = next((pair for pair in pairs if pair[0] != pair[1]), (found.lines, wanted))
        raise failure(f"{file}: {name} reads back as {first[0]}; expected {first[1]}", name)
    return len(wanted) + len(names) + len(sums)


def _check_pairs(loops: Loops, text: str) -> int:
    """In C, terms of pairs are added to the right sums, and tiles compute what pairs do."""
    part, count, name = loops.partners, loops.pair_sums, f"{loops.name}_partners"
    assert part is not None, loops.name
    pair, tile = _read_c(text, name, loops.name), _Text()
    for own in ("take", "tile"):
        _read_c_body(text, f"{loops.name}_{own}", tile, loops.name)
    chosen = [f"(_turned ? _value{count + k} : _value{k})" for k in range(count)]
    wanted = [
        f"_term{k}[_l] = _left_out ? _term{k}[_l] : _term{k}[_l] + {value}"
        for k, value in enumerate(chosen)
    ]
    if pair.adds != wanted:
        raise failure(f"kernel.c: {name} adds up {pair.adds}; expected {wanted}", loops.name)
    wanted = [f"double *const _out{k} = _run.out + {k} * _run.size + _j" for k in range(count)]
    wanted += [f"_term{k}[_l] = _out{k}[_l]" for k in range(count)]
    for k in range(count):
        wanted += [f"_parts[{k}][_s][_l] += _value{k}", f"_term{k}[_l] += _value{count + k}"]
    wanted += [f"_out{k}[_l] = _term{k}[_l]" for k in range(count)]
    if tile.adds != wanted:
        raise failure(f"kernel.c: {name} of a tile add up {tile.adds}", loops.name)
    reads = {
        each.name: "one" if each.shift is None else "at" if each.of_partner else "block"
        for each in part.reads
    }
    if tile.steps != reads:
        raise failure(f"kernel.c: lanes of a tile read {tile.steps}; expected {reads}", loops.name)
    return _check_part(part, replace(tile, steps=pair.steps), loops.wraps, "kernel.c", name)


def _check_place(read: Read, found: _Text, wraps: bool, file: str, name: str) -> None:
    """A name is read in the right row, for every member."""
    array, text = found.places[read.name]
    for size in _SIZES:
        for i, j in product(range(size), repeat=2):
            member = j if read.of_partner else i + (read.shift or 0)
            if not wraps and not 0 <= member < size:
                continue
            if read.single is not None and not -size <= read.single < size:
                continue
            row = read.rows + read.blocks * size + (0 if read.shift is None else member % size)
            if read.single is not None:
                row += read.single % size
            if array != read.array or _evaluate(text, {"i": i, "j": j, "size": size}) != row:
                raise failure(f"{file}: {name} reads {read.name} at {array}[{text}]", name)
    step = {"time": "_run.timed", "sizes": "0"}.get(read.array, "")
    alike = read.shift is None or read.of_partner
    if read.array == "parameters":
        alike = (read.shift is None and read.single is None) or read.of_partner
        step = "_shared" if alike else "_indexed"
    elif read.array == "inputs":
        step = "_run.driven" if alike else "(!_batch || _run.driven)"
    elif read.array == "state" and alike:
        step = "_batch"
    if file == "kernel.c" and found.steps.get(read.name, "") != step:
        raise failure(f"{file}: the lanes of {name} read {read.name} in other steps", name)


def _evaluate(text: str, values: Mapping[str, int]) -> int:
    """An expression over ``+ - * %`` of whole numbers, and ``before`` and ``after`` of a ring."""

    def value(tree: ast.expr) -> int:
        match tree:
            case ast.Constant(value=int(number)):
                return number
            case ast.Name(id=name):
                return values[name]
            case ast.BinOp(left=left, op=operator, right=right):
                a, b = value(left), value(right)
                match operator:
                    case ast.Add():
                        return a + b
                    case ast.Sub():
                        return a - b
                    case ast.Mult():
                        return a * b
                    case ast.Mod():
                        return a % b
            case ast.Call(ast.Name("before" | "after" as word), [i, places, size], []):
                sign = 1 if word == "after" else -1
                return (value(i) + sign * value(places)) % value(size)
        raise failure(f"{text!r} is no row", text)

    return value(_parse(text))


@lru_cache(maxsize=1024)  # the same text is asked for all members
def _parse(text: str) -> ast.expr:
    return ast.parse(text, mode="eval").body


# -- C ----------------------------------------------------------------------------------------


def _read_c(text: str, part: str, name: str) -> _Text:
    """A part of ``kernel.c``."""
    read = _Text()
    _read_c_body(text, part, read, name)
    return read


def _read_c_body(text: str, part: str, read: _Text, name: str) -> None:
    """A function of ``kernel.c``, of which a part is made."""
    found = re.search(rf"^ALWAYS void {part}\(.*?^}}$", text, re.DOTALL | re.MULTILINE)
    if not found:
        raise failure(f"kernel.c has no function {part!r}", name)
    body = re.sub(r"/\*.*?\*/", "", found[0].split("\n{\n", 1)[1], flags=re.DOTALL)
    for line in (" ".join(each.split()) for each in re.split(r"[;{}]", body)):
        if part.endswith(("_take", "_tile")) and _read_c_lane(line, read, part, name):
            continue
        if "_left_out ?" in line or _C_ADDS.match(line):
            read.adds.append(line)
        else:
            _read_c_line(line, read, part, name)


def _read_c_lane(line: str, read: _Text, part: str, name: str) -> bool:
    """A line of a tile that reads a name in its lanes, or keeps it of a block."""
    kept = re.fullmatch(r"_block->(\w+)\[_l\] = _at_(\w+)\[_l\]", line)
    found = re.fullmatch(
        r"const double (\w+) = _(?:(block)->(\w+)\[_s\]|(at)_(\w+)\[_l\]|(one)_(\w+))", line
    )
    if found:
        read.steps[found[1]] = found[2] or found[4] or found[6]
    names = kept.groups() if kept else (found[1], found[3] or found[5] or found[7]) if found else ()
    if len(set(names)) > 1:
        raise failure(f"kernel.c: {part}: {line!r} reads another name", name)
    return bool(names)


def _read_c_line(line: str, read: _Text, part: str, name: str) -> None:
    """One statement of C: a place, a value, a statement or a result; others belong to the loop."""
    if place := re.fullmatch(r"const double \*const _at_(\w+) = (.*)", line):
        if place[2] in _C_FIXED:
            read.places[place[1]] = (_C_FIXED[place[2]], "0")
            return
        where = _C_PLACE.fullmatch(place[2])
        if not where or (where[3], where[4]) != _C_STRIDES[where[1]]:
            raise failure(f"kernel.c: {part}: {line!r} is no place", name)
        row = where[2].replace("_run.", "").replace("_j", "j")
        read.places[place[1]] = (where[1], row)
    elif step := re.fullmatch(
        r"const double (\w+) = ([\w.]+|\(!_batch \|\| _run\.driven\)) \? _at_\1\[_l\] : _one_\1",
        line,
    ):
        read.steps[step[1]] = step[2]
    elif value := re.fullmatch(r"const double (\w+) = _at_(\w+)\[_l\]", line):
        if value[1] != value[2]:
            raise failure(f"kernel.c: {part}: {line!r} reads another name", name)
    elif total := re.fullmatch(rf"const double ({SUM}\d+) = _sums\[(\d+)\]\[_l\]", line):
        read.sums[total[1]] = int(total[2])
    elif out := re.fullmatch(r"(?:const double )?_(?:out|term|value)(\d+)(?:\[_l\])? = (.*)", line):
        if "_terms[" not in out[2]:
            read.lines.append((f"_out{out[1]}", read_c(out[2], name)))
    elif (stated := re.fullmatch(r"const double (\w+) = (.*)", line)) and not re.match(
        r"_one_", stated[1]
    ):
        read.lines.append((stated[1], read_c(stated[2], name)))


# -- Python -----------------------------------------------------------------------------------


def _read_numpy(text: str, part: str, name: str) -> _Text:
    """A part of ``kernel.py``."""
    return _read_python_part(text, part, name, "kernel.py", read_numpy)


def _read_python(text: str, part: str, name: str) -> _Text:
    """A part of ``kernel_python.py``."""
    return _read_python_part(text, part, name, "kernel_python.py", read_python)


def _read_python_part(
    text: str, part: str, name: str, file: str, read_value: Callable[[str, str], Node]
) -> _Text:
    """A part of a module."""
    found = [item for item in _list_functions(text) if item.name == f"_{part}"]
    if len(found) != 1:
        raise failure(f"{file} has no function {part!r}", name)
    read = _Text()
    *lines, last = found[0].body
    for line in lines:
        match line:
            case ast.Assign([ast.Name(to)], ast.Call(ast.Name("float"), [ast.Name("size")])):
                read.places[to] = ("sizes", "0")
            case ast.Assign([ast.Name(to)], ast.Subscript(ast.Name(array), row)) if array != "sums":
                read.places[to] = (array, ast.unparse(row))
            case ast.Assign(
                [ast.Name(to)],
                ast.Subscript(ast.Subscript(ast.Name("sums"), ast.Constant(int(n))), ast.Name("i")),
            ):
                read.sums[to] = n
            case ast.Assign([ast.Name(to)], value):
                read.lines.append((to, read_value(ast.unparse(value), name)))
            case _:
                raise _refuse(file, part, line, name)
    outs = ", ".join(each for each, _ in read.lines if each.startswith("_out"))
    if ast.unparse(last).rstrip(",)") != f"return ({outs}":
        raise _refuse(file, part, last, name)
    return read


@lru_cache(maxsize=4)
def _list_functions(text: str) -> list[ast.FunctionDef]:
    """The functions of a module, each part of which asks for them."""
    return [item for item in ast.parse(text).body if isinstance(item, ast.FunctionDef)]


def _refuse(file: str, part: str, line: ast.stmt, name: str) -> CrossCheckError:
    """A line that no template prints."""
    return failure(f"{file}: {part}: {ast.unparse(line)!r} is not a line of our template", name)
