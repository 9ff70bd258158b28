"""Records with many fields: built by keyword, so that no two values can be exchanged unseen."""

import ast

import pytest

from tests.trees_of_files import ROOT

SOURCE = ROOT / "src"
#: Fields up to which a record may be built by position.
SHORT = 4


class Sources:
    """The modules of a folder, their classes, and where each name is imported from."""

    def __init__(self, folder):
        names = {
            path: ".".join(path.relative_to(folder).with_suffix("").parts).removesuffix(".__init__")
            for path in folder.rglob("*.py")
        }
        self.trees = {name: ast.parse(path.read_text("utf-8")) for path, name in names.items()}
        self.classes, self.imports, self.known = {}, {}, {}
        for module, tree in self.trees.items():
            for node in ast.walk(tree):
                if isinstance(node, ast.ClassDef):
                    self.classes[module, node.name] = node
                elif isinstance(node, ast.ImportFrom) and node.module:
                    for alias in node.names:
                        given = (module, alias.asname or alias.name)
                        self.imports[given] = (node.module, alias.name)

    def resolve(self, place):
        """Where a class is defined that a module names, or None."""
        seen = set()
        while place not in self.classes and place in self.imports and place not in seen:
            seen.add(place)
            place = self.imports[place]
        return place if place in self.classes else None

    def fields(self, place):
        """The fields of a dataclass or named tuple, inherited ones too; none of another class."""
        if place not in self.known:
            self.known[place] = self._list_fields(place)
        return self.known[place]

    def _list_fields(self, place):
        """The same, not looked up."""
        node = self.classes[place]
        decorators = " ".join(map(ast.unparse, node.decorator_list))
        bases = [self.resolve((place[0], ast.unparse(base))) for base in node.bases]
        if "dataclass" not in decorators and "NamedTuple" not in map(ast.unparse, node.bases):
            return set()
        own = {
            each.target.id
            for each in node.body
            if isinstance(each, ast.AnnAssign) and "ClassVar" not in ast.unparse(each.annotation)
        }
        return own.union(*(self.fields(base) for base in bases if base))

    def built_by_position(self):
        """``module: class`` of each call that gives a value of a long record by position."""
        for module, tree in self.trees.items():
            for node in ast.walk(tree):
                if isinstance(node, ast.Call) and node.args:
                    place = self._called(module, node.func)
                    if place and len(self.fields(place)) > SHORT:
                        yield f"{module}: {place[1]}"

    def _called(self, module, function):
        """The class that is called by its name, or as an attribute of an imported module."""
        if isinstance(function, ast.Name):
            return self.resolve((module, function.id))
        if isinstance(function, ast.Attribute) and isinstance(function.value, ast.Name):
            origin = self.imports.get((module, function.value.id))
            return self.resolve((".".join(origin), function.attr)) if origin else None
        return None


def test_long_records_are_built_by_keyword():
    """Every dataclass with more than four fields."""
    sources = Sources(SOURCE)
    long = [place for place in sources.classes if len(sources.fields(place)) > SHORT]
    assert len(long) > 40
    assert list(sources.built_by_position()) == []


RECORD = "from dataclasses import dataclass\n@dataclass\nclass Base:\n    a: int\n    b: int\n"
LONG = f"{RECORD}@dataclass\nclass Long(Base):\n    c: int\n    d: int\n    e: int = 0\n"


@pytest.mark.parametrize(
    ("call", "places"),
    [
        ("from box.records import Long\nLong(1, 2, c=3, d=4)\n", ["box.use: Long"]),
        ("from box.records import Long\nLong(*values)\n", ["box.use: Long"]),
        ("from box import records\nrecords.Long(1, b=2, c=3, d=4)\n", ["box.use: Long"]),
        ("from box.records import Long as L\nL(a=1, b=2, c=3, d=4)\n", []),
        ("from box.records import Base\nBase(1, 2)\n", []),
        ("def Long(a, b): ...\nLong(1, 2)\n", []),
    ],
)
def test_the_check_sees_a_call_by_position(tmp_path, call, places):
    """Of a long record alone, whatever name it is imported by."""
    (tmp_path / "box").mkdir()
    (tmp_path / "box" / "records.py").write_text(LONG)
    (tmp_path / "box" / "use.py").write_text(call)
    assert list(Sources(tmp_path).built_by_position()) == places
