"""The target C, reading loops: a function of ``kernel.c`` that loops over a table of coefficients.

Comes in: the text. Goes out: a `Body` in which all sums are written out. What all such kernels
share is compared letter by letter, blanks apart. This reader shares no code with the printer.
Read next: `coadjoint.render.targets.loops`.
"""

from __future__ import annotations

import re

from coadjoint.lower.program import Program
from coadjoint.render.targets.body import Body, failure
from coadjoint.render.targets.c.reader import read_expression
from coadjoint.render.targets.loops import TABLES, Loops, unroll

_HELPERS = (
    "static inline void fill_vector( double vector[restrict VALUES + 1][MEMBERS], "
    "double scales[restrict VALUES - ROWS][MEMBERS], "
    "const double *restrict rows, size_t stride, size_t count) { "
    "for (size_t row = 0; row < ROWS; ++row) for (size_t n = 0; n < count; ++n) "
    "vector[row][n] = rows[row * stride + n]; "
    "for (size_t place = 0; place < VALUES - ROWS; ++place) "
    "for (size_t n = 0; n < MEMBERS; ++n) "
    "vector[ROWS + place][n] = scales[place][n] * vector[table_scaled[place]][n]; "
    "for (size_t n = 0; n < MEMBERS; ++n) vector[VALUES][n] = 1.0; }",
    "static inline void add_products( size_t first, size_t rows, size_t passes, "
    "double (*const vectors[][2])[MEMBERS], "
    "double *restrict out, size_t stride, size_t count) { "
    "for (size_t row = first; row < first + rows; ++row) { "
    "double sum[MEMBERS]; for (size_t n = 0; n < MEMBERS; ++n) sum[n] = -0.0; "
    "for (size_t pass = 0; pass < passes; ++pass) "
    "for (size_t entry = table_starts[row]; entry < table_starts[row + 1]; ++entry) { "
    "const double *left = vectors[pass][0][table_left[entry]]; "
    "const double *right = vectors[pass][1][table_right[entry]]; "
    "for (size_t n = 0; n < MEMBERS; ++n) "
    "sum[n] += table_coefficients[entry] * left[n] * right[n]; } "
    "for (size_t n = 0; n < count; ++n) out[(row - first) * stride + n] = sum[n]; } }",
)
_SIZES = re.compile(r"enum \{ MEMBERS = 8, ROWS = (\d+), VALUES = (\d+) \};")
_FUNCTION = re.compile(
    r"const size_t _row = parameters_stride \? parameters_stride : 1; "
    r"const size_t _member = parameters_stride != 0; "
    r"double _scales\[VALUES - ROWS\]\[MEMBERS\] = \{\{0\.0\}\}; "
    r"(?P<vectors>(?:double _vector\d+\[VALUES \+ 1\]\[MEMBERS\] = \{\{0\.0\}\}; )+)"
    r"double \(\*const _passes\[\]\[2\]\)\[MEMBERS\] = "
    r"\{ (?P<passes>(?:\{_vector\d+, _vector\d+\}, )+)\}; "
    r"for \(size_t _first = 0; _first < count; _first \+= MEMBERS\) \{ "
    r"const size_t _count = count - _first < MEMBERS \? count - _first : MEMBERS; "
    r"if \(_first == 0 \|\| parameters_stride != 0\) \{ COADJOINT_INDEPENDENT "
    r"for \(size_t _n = 0; _n < _count; \+\+_n\) \{ (?P<lines>[^{}]*)\} \} "
    r"(?P<fills>(?:fill_vector\([^;]*\); )+)"
    r"add_products\((?P<first>\d+), (?P<rows>\d+), (?P<count>\d+), _passes, "
    r"out \+ _first, out_stride, _count\); \}"
)
_FILL = re.compile(
    r"fill_vector\(_vector(\d+), _scales, state \+ (\d+) \* ROWS \* state_stride \+ _first, "
    r"state_stride, _count\); "
)
_GIVEN = re.compile(
    r"const double (\w+) = parameters\[(\d+) \* _row \+ \(_first \+ _n\) \* _member\]"
)


def read_loops(text: str, function: str, program: Program) -> Body:
    """A function that loops over a table.

    Args:
        text: Of the kernel.
        function: The text of its body, without comments.
        program: What it was printed from.
    """
    name, joined = program.name, _join(re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL))
    sizes, parts = _SIZES.findall(joined), _FUNCTION.fullmatch(_join(function))
    if parts is None or len(sizes) != 1 or any(joined.count(each) != 1 for each in _HELPERS):
        raise failure(f"kernel.c: {name} loops in another form than that of our template", name)
    rows, values = map(int, sizes[0])
    loops = Loops(tables={part: _read_table(joined, part, name) for part in TABLES})
    fills, count = _FILL.findall(parts["fills"]), parts["vectors"].count(";")
    if [int(vector) for vector, _ in fills] != list(range(count)):
        raise failure(f"kernel.c: {name} fills {len(fills)} of {count} vectors", name)
    loops.vectors = [int(place) * rows for _, place in fills]
    passes = re.findall(r"_vector(\d+), _vector(\d+)", parts["passes"])
    loops.passes, loops.first = [(int(a), int(b)) for a, b in passes], int(parts["first"])
    for line in filter(None, map(str.strip, parts["lines"].split(";"))):
        _read_line(line, loops, name)
    counts = int(parts["rows"]), int(parts["count"]), values - rows
    if counts != (len(program.outputs), len(passes), len(loops.scales)):
        raise failure(f"kernel.c: {name} counts rows, passes or scales wrongly", name)
    return unroll(loops, program)


def _join(text: str) -> str:
    """A text on one line."""
    return " ".join(text.split())


def _read_table(text: str, part: str, name: str) -> list[float]:
    """One part of the table."""
    kind = "double" if part == "coefficients" else "unsigned short"
    found = re.findall(rf"static const {kind} table_{part}\[\] = \{{([^{{}}]*)\}};", text)
    try:
        (entries,) = found
        return [TABLES[part](entry) for entry in entries.split(",") if entry.strip()]
    except ValueError as error:
        raise failure(f"kernel.c: the table {part}: {error}", name) from error


def _read_line(line: str, loops: Loops, name: str) -> None:
    """A parameter, a statement of them, or a scale."""
    given = _GIVEN.fullmatch(line)
    assigned = re.fullmatch(r"const double (\w+) = ([^\[]*)", line)
    scale = re.fullmatch(r"_scales\[(\d+)\]\[_n\] = ([^\[]*)", line)
    if given:
        loops.body.inputs[given[1]] = ("parameters", int(given[2]))
    elif assigned:
        loops.body.statements.append((assigned[1], read_expression(assigned[2], name)))
    elif scale and int(scale[1]) == len(loops.scales):
        loops.scales.append(read_expression(scale[2], name))
    else:
        raise failure(f"kernel.c: {line!r} is not a line of our template", name)
