"""The table of kernel functions: one entry and one formula are a function of every target."""

import ast
import inspect

import numpy as np
import pytest

from coadjoint import kernel_functions, pipeline
from coadjoint.declared import KernelFunction
from coadjoint.derive import derive, formulas
from coadjoint.errors import CrossCheckError, KernelArgumentError
from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from coadjoint.lower.check import check_inverse
from coadjoint.lower.lowering import lower
from coadjoint.render.targets import BUILDS
from coadjoint.solve.folders import load_folder
from coadjoint.solve.functions import Functions, make_method
from coadjoint.spec.core.names import refusal
from coadjoint.systems import rigid_body
from tests.kernels import COMPILER
from tests.specs import spec
from tests.trees_of_files import ROOT

#: A function that no system has: the squares of the rates, and their sum.
SQUARES = KernelFunction("squares", "Squares of the rates, and their sum", "(n + 1, *batch)")


def squares(equations):
    """Its formula."""
    lines = [(f"square {n}", rate * rate) for n, rate in enumerate(equations.exact.rates)]
    lines.append(("sum", equations.setting.field.sum(value for _, value in lines)))
    return formulas._rows(equations, lines)


@pytest.fixture
def with_squares(monkeypatch):
    """The table with one more entry, and its formula: the two things that one adds."""
    monkeypatch.setitem(kernel_functions._TABLE, "squares", SQUARES)
    monkeypatch.setattr(formulas, "squares", squares, raising=False)


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
def test_an_entry_and_a_formula_make_a_function(with_squares, monkeypatch, tmp_path):
    """It is lowered, printed, read back and cross-checked, and a System has it as a method."""
    monkeypatch.setattr(Functions, "squares", make_method(SQUARES), raising=False)  # as on import
    rendered = pipeline.render(spec())
    report = pipeline.verify(rendered)
    assert report.passed
    assert report.lines["squares"] > 0
    assert "Squares of the rates, and their sum, shape (4, ...)." in rendered.texts["kernel.h"]
    for name, text in rendered.texts.items():
        (tmp_path / name).write_text(text)
    state, inertia = [1.0, 2.0, 3.0], [1.0, 2.0, 4.0]
    system = load_folder(tmp_path)
    # dPi1/dt = (1/I3 - 1/I2) Pi2 Pi3 and cyclic
    expected = [2.25, 5.0625, 1.0, 8.3125]
    assert system.squares(state, inertia).tolist() == expected
    assert system.evaluate("squares", state, inertia, target="numpy").tolist() == expected
    assert "numpy" in system.squares.__doc__


def test_a_wrong_formula_is_seen(with_squares, monkeypatch):
    """Lowering is compared with the formula, so that one of them alone cannot change."""
    rendered = lower(derive(spec()))["squares"]
    with monkeypatch.context() as spoiled:
        spoiled.setattr(
            formulas,
            "squares",
            lambda e: formulas._rows(e, [*squares(e).lines[:-1], ("sum", e.exact.rates[0])]),
        )
        with pytest.raises(CrossCheckError, match="lowering changed squares, output sum"):
            check_inverse(derive(spec()), rendered)


def test_an_entry_needs_a_formula(monkeypatch):
    """Without one, nothing is lowered."""
    monkeypatch.setitem(kernel_functions._TABLE, "squares", SQUARES)
    with pytest.raises(AttributeError, match="squares"):
        lower(derive(spec()))


def test_every_reader_agrees_with_the_table():
    """Formulas, methods and reserved names are those of the entries."""
    tree = ast.parse(inspect.getsource(formulas))
    defined = [item.name for item in tree.body if isinstance(item, ast.FunctionDef)]
    public = [name for name in defined if not name.startswith("_") and name != "rows_of"]
    assert public == list(dict.fromkeys(each.formula for each in KERNEL_FUNCTIONS.values()))
    for name, entry in KERNEL_FUNCTIONS.items():
        text = inspect.getdoc(getattr(rigid_body.system, name))
        assert text.startswith(f"{entry.summary}; shape ``{entry.shape}``.")
        assert refusal(name), name
    assert not any(hasattr(Functions, name) for name in ("squares", "SQUARES"))


def test_the_page_on_functions_lists_the_table():
    """docs/python.md has a row for each entry, in the same order, and no other."""
    text = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    rows = [line for line in text.split("## Targets")[0].splitlines() if line.startswith("| `")]
    entries = KERNEL_FUNCTIONS.values()
    assert rows == [f"| `{e.name}` | `{e.shape}` | {e.summary} |" for e in entries]
    part = text.split("## Targets")[1].split("## Trajectories")[0]
    targets = [line for line in part.splitlines() if line.startswith("| `")]
    shown = [tuple(cell.strip(" `") for cell in row.split("|")[1:3]) for row in targets]
    assert {(f'"{b}"', target.kernel) for b, target in BUILDS.items()} == set(shown)


def test_a_function_that_a_system_lacks_is_refused_with_those_it_has():
    """A free body keeps no constraint."""
    with pytest.raises(KernelArgumentError, match="no function 'projection'; expected one of rhs"):
        rigid_body.system.projection(np.ones(3))
