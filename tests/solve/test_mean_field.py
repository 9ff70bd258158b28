"""The number of members as a value: kernels, steps and the ladder of a mean field."""

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.crosscheck import families
from coadjoint.crosscheck.family_windows import Window
from coadjoint.derive import derive
from coadjoint.errors import CrossCheckError
from coadjoint.solve.folders import load_texts
from coadjoint.spec.reader import read_spec_text
from tests.families import MEAN, read

J, K = 1.0, 0.5
TARGETS = ("c", "numpy", "python", "c-fast")


@pytest.fixture(scope="module")
def rendered():
    """Rotators."""
    return pipeline.render(read_spec_text(MEAN, "mean.toml"))


@pytest.fixture(scope="module")
def rotators(rendered):
    """The same, loaded."""
    with load_texts(rendered.texts) as system:
        yield system


def find_rates(state):
    """Newton's law of the rotators, by hand: ``M sin(phi - q)`` is the force of the mean field."""
    q, p = state.reshape(2, -1)
    n, mean = len(q), np.exp(1j * q).mean()
    force = J * np.imag(mean * np.exp(-1j * q))
    bonds = K * np.sin(np.diff(q))
    force[:-1] += bonds
    force[1:] -= bonds
    force[0] -= q[0] / n**2
    return np.concatenate([p, force])


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("n", [2, 3, 40])
def test_rates_and_observables_are_those_of_the_mean_field(rotators, target, n):
    """With one text for every number, which is a row of no array of parameters."""
    sized = rotators.resize({"i": n})
    state = np.random.default_rng(n).normal(size=2 * n)
    np.testing.assert_allclose(sized.rhs(state, target=target), find_rates(state), atol=1e-13)
    q, p = state.reshape(2, n)
    found = sized.observables(state, target=target)
    named = dict(zip(sized.OBSERVABLES.components, found, strict=True))
    np.testing.assert_allclose(named["M"], abs(np.exp(1j * q).mean()), atol=1e-14)
    np.testing.assert_allclose(named["P"], p.mean(), atol=1e-14)
    assert sized.PARAMETERS.size == 2


@pytest.mark.parametrize("method", ["taylor", "dop853", "midpoint6", "splitting6"])
def test_every_method_knows_the_number(rotators, method):
    """Steps of C and NumPy alike, against the method of SciPy on the law by hand."""
    integrate = pytest.importorskip("scipy.integrate")
    n = 7
    sized, state = rotators.resize({"i": n}), np.random.default_rng(3).normal(size=2 * n)
    found = integrate.solve_ivp(
        lambda _, x: find_rates(x), (0, 2), state, method="DOP853", rtol=1e-12, atol=1e-13
    )
    step = {"step": 0.01} if method[-1] == "6" else {}
    for target in ("c", "numpy"):
        run = sized.simulate(state, (0, 2), method=method, target=target, samples=2, **step)
        np.testing.assert_allclose(run.state[:, -1], found.y[:, -1], atol=3e-9)


def test_the_ladder_sees_another_number(rendered, rotators, monkeypatch):
    """Rung 4 compares kernels with windows in which n is the number of their members."""
    own, texts = rendered.family, rendered.texts
    monkeypatch.setattr(families, "POINTS", 2)
    assert families.crosscheck_family(own, texts, rotators).rungs[4] == "passed"
    once = Window._name_inputs

    def spoil(window, function, point):
        return {**once(window, function, point), "n": window.size + 1.0}

    monkeypatch.setattr(Window, "_name_inputs", spoil)
    with pytest.raises(CrossCheckError, match="50 digits"):
        families.crosscheck_family(own, texts, rotators)


def test_a_document_names_the_number():
    """It stands among the symbols with what it means, and not among the parameters."""
    assert derive(read(MEAN)).spec.parameters[-1].doc == "number of members"
