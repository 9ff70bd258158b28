"""Linear equations around a ring in kernels: a wrong text is seen by a rung of the ladder."""

import numpy as np
import pytest

from coadjoint.crosscheck import families as ladder
from coadjoint.crosscheck.families import crosscheck_family
from coadjoint.crosscheck.family_text import check_family_text
from coadjoint.errors import CrossCheckError
from coadjoint.solve.folders import load_texts
from tests import specs

#: What is spoiled in which file, the targets that are compared, and how it is seen; of a velocity
#: with the mean 0, below.
WRONG = [
    ("kernel.py", "(-a[r] if r % 2 else a[r])", "a[r]", ("numpy",), "rung 4"),
    ("kernel.py", "range(-len(a) + 1, len(a))", "range(len(a))", ("numpy",), "rung 4"),
    ("kernel.py", "step = 2 * step % size", "step = 2 * step", ("numpy",), ""),
    ("kernel.py", "rows += [run, _solve(", "rows += [run, 2 * _solve(", ("numpy",), "rung 4"),
    ("kernel.py", "2.0**-60", "2.0**-20", ("numpy",), "rung 4"),
    ("kernel_python.py", "u[(i - r * step) % size]", "u[i]", ("numpy", "python"), "rung 4"),
    (
        "kernel.c",
        "behind = u + (first + size - shift)",
        "behind = u + (first + shift)",
        ("c",),
        "wrong kernel",
    ),
    ("kernel.c", "high = size - low;", "high = low;", ("c",), "wrong kernel"),
]
WRONG_LEVEL = [
    ("kernel.py", "[-1] / size", "[-1] / (size + 1)", ("numpy",), "rung 4"),
    ("kernel.py", "_level(-np.add", "_level(np.add", ("numpy",), "rung 4"),
    ("kernel.py", "(slopes[-1:], slopes[:-1])", "(slopes[1:], slopes[:1])", ("numpy",), "rung 4"),
    ("kernel_python.py", "slopes[-1:] + slopes[:-1]", "slopes", ("numpy", "python"), "rung 4"),
    ("kernel.c", "right[0] = -total;", "right[0] = total;", ("c",), "wrong kernel"),
    ("kernel.c", "total = total + slope;", "total = total - slope;", ("c",), "wrong kernel"),
    ("kernel.c", "level(right, size);\n}", "}", ("c",), "wrong kernel"),
]


@pytest.fixture(scope="module")
def rendered():
    """The shipped system up to its texts."""
    return specs.rendered("camassa_holm")


@pytest.fixture(scope="module")
def rendered_level():
    """That with a velocity of mean 0."""
    return specs.rendered("hunter_saxton")


def climb(rendered, texts, targets):
    """All rungs for some targets."""
    own = rendered.family
    with load_texts(texts) as system:
        crosscheck_family(own, texts, system, targets, texts)


@pytest.mark.parametrize("target", ["numpy", "python", "c"])
@pytest.mark.parametrize("N", [9, 16])
def test_texts_solve_their_equations(rendered, rendered_level, N, target):
    """L/N sum m u/2 with u by the pseudoinverse of the matrix a - b D_2, of m with any mean."""
    m, L = np.random.default_rng(N).normal(size=N), 3.0
    matrix = sum(
        c * (np.roll(np.eye(N), r, axis=1) + np.roll(np.eye(N), -r, axis=1))
        for r, c in ((0, 5 / 4), (1, -4 / 3), (2, 1 / 12))
    )
    for own, share, parameters in ((rendered, 1, [0.9, L]), (rendered_level, 0, [L])):
        weight = (parameters[0] ** 2 if share else 1) * (N / L) ** 2
        u = np.linalg.pinv(share * np.eye(N) + weight * matrix, rcond=1e-9) @ m
        with load_texts(own.texts) as system:
            found = system.resize({"s": N}).evaluate("energy", m, parameters, target=target)
        np.testing.assert_allclose(found, L / N * np.sum(m * u) / 2, rtol=1e-12)


@pytest.mark.parametrize(("file", "old", "new", "targets", "seen"), WRONG)
def test_the_ladder_sees_wrong_solutions(rendered, monkeypatch, file, old, new, targets, seen):
    """One that is right although it takes larger numbers for places passes."""
    texts = dict(rendered.texts)
    assert old in texts[file]
    texts[file] = texts[file].replace(old, new)
    monkeypatch.setattr(ladder, "POINTS", 2)
    monkeypatch.setattr(ladder, "compare", lambda *_: None)
    if not seen:
        climb(rendered, texts, targets)
        return
    with pytest.raises(CrossCheckError, match=seen):
        climb(rendered, texts, targets)


@pytest.mark.parametrize(("file", "old", "new", "targets", "seen"), WRONG_LEVEL)
def test_the_ladder_sees_wrong_means(rendered_level, monkeypatch, file, old, new, targets, seen):
    """Sums of the wrong sign or in the wrong place, and rows that keep their mean."""
    test_the_ladder_sees_wrong_solutions(rendered_level, monkeypatch, file, old, new, targets, seen)


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("kernel.py", "alpha = parameters[0]", "alpha = parameters[1]"),
        ("kernel.py", "u_m1 = state[size + (i - 1) % size]", "u_m1 = state[(i - 1) % size]"),
    ],
)
def test_a_wrong_factor_does_not_read_back(rendered, file, old, new):
    """Factors are parts as rates are, and what is solved for has rows below the state."""
    texts = dict(rendered.texts)
    assert old in texts[file]
    texts[file] = texts[file].replace(old, new)
    with pytest.raises(CrossCheckError):
        check_family_text(rendered.family.context, texts, texts)
