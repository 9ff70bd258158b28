"""Imports of the package: none turns back while modules are loaded."""

import ast

import pytest

from tests.trees_of_files import ROOT

SOURCE = ROOT / "src"


def list_modules(folder):
    """The modules of a folder by name, as they are parsed."""
    names = {
        ".".join(path.relative_to(folder).with_suffix("").parts).removesuffix(".__init__"): path
        for path in folder.rglob("*.py")
    }
    return {name: ast.parse(path.read_text("utf-8")) for name, path in names.items()}


def statements(body):
    """Statements that run when a module is loaded: not in functions, nor for types alone."""
    for node in body:
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            yield from statements(node.orelse)
        elif not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node
            for part in ("body", "orelse", "handlers", "finalbody"):
                yield from statements(getattr(node, part, ()))


def imports_of(tree, modules):
    """The modules of the package that a module imports when it is loaded."""
    imports = set()
    for node in statements(tree.body):
        if isinstance(node, ast.ImportFrom):
            inner = {f"{node.module}.{alias.name}" for alias in node.names}
            imports |= inner & modules or {node.module}
        elif isinstance(node, ast.Import):
            imports |= {alias.name for alias in node.names}
    return imports & modules


def find_circle(folder):
    """Modules that import each other in a circle, or import one that does; empty if none."""
    trees = list_modules(folder)
    left = {name: imports_of(tree, trees.keys()) - {name} for name, tree in trees.items()}
    while free := {name for name, imports in left.items() if not imports}:
        left = {name: imports - free for name, imports in left.items() if name not in free}
    return sorted(left)


def test_no_modules_import_each_other():
    """Of all modules of the package."""
    assert len(list_modules(SOURCE)) > 300
    assert find_circle(SOURCE) == []


@pytest.mark.parametrize(
    ("text", "circle"),
    [
        ("from box.one import f\n", ["box.one", "box.two"]),
        ("from box import one\n", ["box.one", "box.two"]),
        ("import box.one\n", ["box.one", "box.two"]),
        ("try:\n    from box import one\nexcept ImportError: ...\n", ["box.one", "box.two"]),
        ("def f():\n    from box import one\n", []),
        ("from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from box import one\n", []),
    ],
)
def test_a_circle_is_seen(tmp_path, text, circle):
    """The check above can fail; it passes over what is imported later, or for types."""
    (tmp_path / "box").mkdir()
    (tmp_path / "box" / "__init__.py").write_text("")
    (tmp_path / "box" / "one.py").write_text("from box import two\n")
    (tmp_path / "box" / "two.py").write_text(text)
    assert find_circle(tmp_path) == circle
