"""Lines that name changes: what they find, what leaves them alone, and what they refuse."""

import ast

import pytest

from tests.mutation.addresses import AddressError, find_edit, source_with
from tests.mutation.texts import changed_spec, changed_template

MODULE = """
def rates(a, b, c):
    total = a - b * c + cross(a, b)
    return [-x for x in total], c if a else b

class Motion:
    def rates_of_all(self, m):
        return m[0][1] / 2
"""


def changed(line, module=MODULE):
    """The statements of a module with one change."""
    tree = ast.parse(module)
    return source_with(tree, find_edit(tree, line))


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("rates: flip c", "a + b * c + cross(a, b)"),
        ("rates: drop b c", "total = a + cross(a, b)"),
        ("rates: omit c in total", "a - b + cross(a, b)"),
        ("rates: swap cross", "cross(b, a)"),
        ("rates: flip x", "[x for x in total]"),
        ("rates: then c", "total], c)"),
        ("rates: use dot for cross", "dot(a, b)"),
        ("rates: let total = b", "total = b"),
        ("rates: rewrite _1 - _2 -> _2 - _1", "b * c - a + cross(a, b)"),
        ("rates: skip total", "pass"),
        ("rates: turn c", "def rates(a, c, b)"),
        ("rates_of_all: transpose m", "m[1][0] / 2"),
        ("Motion.rates_of_all: invert 2", "m[0][1] * 2"),
    ],
)
def test_a_line_makes_its_change(line, expected):
    """And nothing else: the other statements stay."""
    found, before = changed(line), "\n".join(map(ast.unparse, ast.parse(MODULE).body))
    assert expected in found
    lines = zip(found.split("\n"), before.split("\n"), strict=True)
    assert sum(a != b for a, b in lines) == 1


def test_moving_and_reformatting_leave_a_line_alone():
    """Another place, layout, neighbour or comment is no matter."""
    moved = MODULE.replace("- b * c +", "- (b\n * c  # the push\n) +")
    moved = f"def first(b, c):\n    return b - b * c\n{moved}"
    assert "a + b * c + cross(a, b)" in changed("rates: flip c", moved)


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("rate: flip c", "'rate' is 0 functions; there are: module, rates"),
        ("rates: flip m", "fits 0 places:\n  flip a\n  flip b * c\n  flip cross"),
        ("rates: drop a in total", "fits 2 places:\n  drop a\n  drop cross"),
        ("rates: let c = d", "fits 0 places"),
        ("rates: use d", "lacks ' for '"),
    ],
)
def test_a_line_that_names_no_change_says_what_there_is(line, complaint):
    """A name that is gone, or that stands at two places, is an error, never a mutant."""
    with pytest.raises(AddressError) as error:
        changed(line)
    assert complaint in str(error.value)


def test_formulas_are_found_by_the_path_of_their_key():
    """The rest of the spec keeps its text; a path that is gone is an error."""
    spec = '[lax]\nL = "-S + lambda*M^2"  # printed\n[claims]\ncasimirs = ["X1", "X2 - X3"]\n'
    found = changed_spec(spec, "lax.L: flip S; claims.casimirs[2]: drop X3")
    assert found == (
        '[lax]\nL = "S + lambda * M ** 2"  # printed\n[claims]\ncasimirs = ["X1", "X2"]\n'
    )
    with pytest.raises(AddressError, match=r"no formula stands at 'lax.M'; there are: lax.L"):
        changed_spec(spec, "lax.M: flip S")


def test_lines_of_templates_are_found_by_their_block():
    """Of several lines with the same words the one in the block is changed."""
    template = "{% for row in state %}\na[{{ row }} + n]\n{% endfor %}\na[{{ row }} + n]"
    assert changed_template(template, "state: flip n in row") == template.replace("+", "-", 1)
    with pytest.raises(AddressError, match="fits 0 lines"):
        changed_template(template, "parameters: flip n in row")


def test_lines_of_templates_without_a_block_are_found_anywhere():
    """Of several lines with the same words the one that has what is changed, once."""
    template = "a = b + c;\nif (a == b)\n    a = b - c;\n{% if x %}\nc = a - b;\n{% endif %}"
    found = changed_template(template, "anywhere: use + c for - c in a b")
    assert found == template.replace("- c", "+ c")
    assert changed_template(template, "x: use a + for a - in c") == template.replace("a - ", "a + ")
    with pytest.raises(AddressError, match="fits 2 lines:\na = b"):
        changed_template(template, "anywhere: use d for = b in c")
    with pytest.raises(AddressError, match="fits 0 lines:\na = b"):
        changed_template(template, "anywhere: use d for * c in b")
