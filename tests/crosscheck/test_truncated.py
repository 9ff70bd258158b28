"""Products of matrices in kernels: a wrong text is seen by a rung of the ladder."""

from dataclasses import replace

import pytest

from coadjoint.crosscheck import families as ladder
from coadjoint.crosscheck.family_text import check_family_text
from coadjoint.errors import CrossCheckError
from coadjoint.lower.family_check import check_loops
from tests import specs
from tests.crosscheck.test_solved import climb

#: What is spoiled in which file, the targets that are compared, and how it is seen.
WRONG = [
    ("kernel.py", "right[row] - mean", "right[row] + mean", ("numpy",), "rung 4"),
    ("kernel.py", "pivots[row, 1:] - before", "pivots[row, 1:] + before", ("numpy",), "rung 4"),
    ("kernel.py", "a * C[k] - b * D[k]", "a * C[k] + b * D[k]", ("numpy",), "rung 4"),
    ("kernel.py", "real[k] - V[k]", "real[k] + V[k]", ("numpy",), "rung 4"),
    ("kernel.py", "+ product(W, first[1])", "", ("numpy",), "rung 4"),
    ("kernel.py", "V[i, i] = V[i, i] - np", "V[i, i] = V[i, i] + 0 * np", ("numpy",), "rung 4"),
    ("kernel_python.py", "(s - i) * (s - j)", "(s - i) * (s + j)", ("numpy", "python"), "rung 4"),
    ("kernel.c", "(a * d[j] + b * c[j])", "(a * d[j] - b * c[j])", ("c",), "wrong kernel"),
    ("kernel.c", "V[n * n - 1] = 0.0;", "V[n * n - 1] = 1.0;", ("c",), "rung 5"),
    ("kernel.c", "(v * x[j] - w * y[j])", "(v * x[j] + w * y[j])", ("c",), "wrong kernel"),
]


#: The same on the torus, of how V follows from W.
WRONG_WAVES = [
    ("kernel.py", "(2.0 if k else 1.0) * cosines", "1.0 * cosines", ("numpy",), "rung 4"),
    ("kernel.py", "turn = 2 * step % n", "turn = step % n", ("numpy",), "rung 4"),
    ("kernel.py", "np.minimum(d, n - d) ** 2.0", "d**2.0", ("numpy",), "rung 4"),
    ("kernel.py", "np.roll(own, -step", "np.roll(own, 1 - step", ("numpy",), "rung 4"),
    ("kernel.py", "np.where(beyond, -found, found)", "found", ("numpy",), "rung 4"),
    ("kernel.py", "range(8, 0, -1)", "range(5, 0, -1)", ("numpy",), "rung 4"),
    ("kernel_python.py", "min(d, n - d) ** 2", "d**2", ("numpy", "python"), "rung 4"),
    ("kernel.c", "(k ? 2.0 : 1.0)", "2.0", ("c",), "wrong kernel"),
    ("kernel.c", "turn = 2 * step % n", "turn = step % n", ("c",), "wrong kernel"),
    ("kernel.c", "beyond ? -found : found", "found", ("c",), "wrong kernel"),
]


@pytest.fixture(scope="module")
def on_torus():
    """The shipped system on the torus up to its texts."""
    return specs.rendered("zeitlin_torus")


@pytest.mark.parametrize(("file", "old", "new", "targets", "seen"), WRONG_WAVES)
def test_the_ladder_sees_wrong_waves(on_torus, monkeypatch, file, old, new, targets, seen):
    """Cosines, weights and steps along diagonals."""
    texts = dict(on_torus.texts)
    assert old in texts[file]
    texts[file] = texts[file].replace(old, new)
    monkeypatch.setattr(ladder, "POINTS", 2)
    monkeypatch.setattr(ladder, "compare", lambda *_: None)
    with pytest.raises(CrossCheckError, match=seen):
        climb(on_torus, texts, targets)


@pytest.fixture(scope="module")
def rendered():
    """The shipped system up to its texts."""
    return specs.rendered("zeitlin_su_n")


@pytest.mark.parametrize(("file", "old", "new", "targets", "seen"), WRONG)
def test_the_ladder_sees_wrong_products(rendered, monkeypatch, file, old, new, targets, seen):
    """And wrong velocities; a constant that the mean takes away changes bits alone."""
    texts = dict(rendered.texts)
    assert old in texts[file]
    texts[file] = texts[file].replace(old, new)
    monkeypatch.setattr(ladder, "POINTS", 2)
    monkeypatch.setattr(ladder, "compare", lambda *_: None)
    given = ("numpy", *targets) if seen == "rung 5" else targets
    with pytest.raises(CrossCheckError, match=seen if seen != "rung 5" else "rung 5|wrong kernel"):
        climb(rendered, texts, given)


def test_a_wrong_factor_does_not_read_back(rendered):
    """The factor of the equation for V is a part as rates are."""
    texts, old = dict(rendered.texts), "entries - 1.0"
    assert old in texts["kernel.py"]
    texts["kernel.py"] = texts["kernel.py"].replace(old, "entries + 1.0")
    with pytest.raises(CrossCheckError):
        check_family_text(rendered.family.context, texts, texts)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("rhs", {"product": "sandwich"}),
        ("sandwich", {"product": "commutator"}),
        ("energy", {"product": "commutator"}),
        ("rhs", {"scale": None}),
        ("rhs", {"surface": "torus"}),
    ],
)
def test_another_product_than_the_functions_is_seen(rendered, name, change):
    """Before kernels are made."""
    loops = dict(rendered.family.context.loops)
    check_loops(rendered.family.family, loops)
    loops[name] = replace(loops[name], products=replace(loops[name].products, **change))
    with pytest.raises(CrossCheckError, match="rung 2"):
        check_loops(rendered.family.family, loops)


def test_a_wrong_factor_is_seen(rendered):
    """One of another family."""
    family = rendered.family.family
    matrices = replace(family.matrices, scale=2 * family.matrices.scale)
    with pytest.raises(CrossCheckError, match="rung 2"):
        check_loops(replace(family, matrices=matrices), rendered.family.context.loops)
