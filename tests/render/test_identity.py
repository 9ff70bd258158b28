"""The identity of a kernel: its bytes change with what determines it, and with nothing else."""

import json

import pytest

from coadjoint import pipeline
from coadjoint.build import library
from coadjoint.build.compiler import find_compiler
from coadjoint.solve.folders import load_texts
from tests.kernels import COMPILER
from tests.specs import RIGID_BODY, spec

CLAIMED = RIGID_BODY.replace(
    'casimirs = ["dot(Pi, Pi)"]',
    'casimirs = ["dot(Pi, Pi)"]\nconserved = ["energy", "Pi[1]^2 + Pi[2]^2 + Pi[3]^2"]',
)
SUM = "Pi[1]^2 + Pi[2]^2 + Pi[3]^2"
KERNELS = {"kernel.py", "kernel.c", "kernel.h", "kernel_python.py", "__init__.py", "__main__.py"}
KERNELS |= {"solver.c", "solver.h", "solver.py"}


def texts(*changes):
    """The files of the rigid body, its spec changed."""
    return pipeline.render(spec(CLAIMED, *changes)).texts


@pytest.fixture(scope="module")
def body():
    """The files of the rigid body."""
    return texts()


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("Free rigid body", "A body without torque"),
        ('routes = ["', '# a comment\nroutes   =   ["'),
        ('title = "Free', 'source = "Holm 2011"\ndescription = "Any text."\ntitle = "Free'),
        ("default = [1, 2, 3] }", 'default = [1, 2, 3], doc = "principal moments" }'),
        (f'"{SUM}"', '"dot(Pi, Pi)"'),
        (f'"{SUM}"', f'"2*({SUM})"'),
        (f', "{SUM}"', ""),
        ("[claims]", "\n\n[claims]"),
    ],
    ids=["title", "comment", "source", "doc", "claim", "other claim", "no claim", "lines"],
)
def test_words_leave_kernels_alone(body, old, new):
    """Title, source, docs, comments and the texts of claims stand in the certificate at most."""
    found = texts((old, new))
    assert set(found) == set(body) == KERNELS | {"certificate.json"}
    for name in KERNELS:
        assert found[name] == body[name], name


def test_words_stand_in_the_certificate(body):
    """What leaves kernels alone is not lost."""
    found = texts(("Free rigid body", "A body"), (SUM, f"2*({SUM})"))
    record = json.loads(found["certificate.json"])
    assert record["title"] == "A body"
    assert any(f"2*({SUM})" in claim["statement"] for claim in record["claims"])
    assert found["certificate.json"] != body["certificate.json"]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("default = [1, 2, 3]", "default = [1, 2, 4]"),
        ("diag(I)*Omega)/2", "diag(I)*Omega)/3"),
        ("positive = true, ", "positive = true, unit = 'kg m^2', "),
        ('routes = ["euler-poincare", "lie-poisson"]', 'routes = ["euler-poincare"]'),
    ],
    ids=["default", "formula", "unit", "route"],
)
def test_what_determines_a_kernel_changes_it(body, old, new):
    """A default, a formula, a unit or a route that proves it gives other files with another id."""
    found = texts((old, new))
    assert not [name for name in KERNELS if found[name] == body[name]]


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
def test_a_reworded_system_takes_its_library_from_the_cache(body, tmp_path, monkeypatch):
    """The object of a kernel is found by its content, which words do not touch."""
    monkeypatch.setenv("COADJOINT_CACHE", str(tmp_path / "cache"))
    with load_texts(body) as system:
        expected = system.rhs([1.0, 2.0, 3.0])
    find_compiler()

    def fails(*_):
        raise AssertionError("compiled again")

    monkeypatch.setattr(library, "compile_kernel", fails)
    with load_texts(texts(("Free rigid body", "A body"))) as system:
        assert (system.rhs([1.0, 2.0, 3.0]) == expected).all()
