"""The ladder of solvers with noise: good ones pass, and each kind of spoiled one is caught."""

from dataclasses import replace

import numpy as np
import pytest

from coadjoint.crosscheck import solver_steps
from coadjoint.crosscheck.solver_exact import Solvers
from coadjoint.crosscheck.solver_objects import (
    NOISY,
    NumpySolver,
    compile_solvers,
    load_numpy,
    load_solver,
)
from coadjoint.crosscheck.solver_steps import check_bits, check_steps
from coadjoint.crosscheck.solver_text import check_solver_texts
from coadjoint.crosscheck.solvers import _list_functions
from coadjoint.errors import CrossCheckError
from coadjoint.render.kernels import render_system
from coadjoint.solve import stochastic
from coadjoint.solver_kinds import SOLVER
from tests.crosscheck import test_solvers as plain
from tests.programs import PENDULUM, program

#: A swing with noise along both of its components, which do not commute.
SWING = replace(
    PENDULUM,
    name="swing",
    programs=(
        program("rhs", "q p", "k", "", "p; -k*q - q*q*q", (2,)),
        program("noise", "q p", "k", "_t1 = k*q", "0; p; -_t1; q*q", (2, 2)),
    ),
)
needs_compiler = plain.needs_compiler


@pytest.fixture
def made(monkeypatch):
    """Solvers of one method of the swing."""
    texts = dict(render_system(SWING))
    monkeypatch.setattr(plain, "texts_by_name", lambda name: texts)

    def make(method, folder=None, spoil=lambda texts: texts):
        system, files = plain.subject(SWING), plain.texts_of(SWING, spoil).files
        functions = _list_functions(system, load_numpy(texts["kernel.py"]), SOLVER)
        numpy = NumpySolver(load_numpy(files["solver.py"]), functions)
        advance = {method: {"numpy": numpy.advance(method)}}
        if folder:
            path = compile_solvers(files, folder, "swing", [method], "exact")
            advance[method]["c"] = load_solver(path, "swing", method)
        return Solvers(subject=system, text=plain.recurrences_of(SWING), advance=advance)

    return make


METHODS = pytest.mark.parametrize("method", ["heun", "midpoint"])


@METHODS
def test_steps_with_noise_are_exact_within_the_bound(method, made):
    """Against 60 digits of the equations with the same noise; errors are not all zero."""
    one = made(method)
    figures = check_steps(one, plain.points(one), 0.03125)[method]["numpy"]
    assert figures.points == 3
    assert 0 < figures.k < 20


@METHODS
@pytest.mark.parametrize("wrong", ["sign", "process", "step"])
def test_wrong_noise_of_numpy_is_caught(method, wrong, made, monkeypatch):
    """Another sign, processes exchanged, and the noise of another step."""
    right = stochastic._Noisy.find_noise

    def find_noise(self, lanes, h, process):
        if wrong == "process":
            return right(self, lanes, h, 1 - process)
        if wrong == "step":
            lanes = replace(lanes, steps=lanes.steps + np.uint64(1))
        return right(self, lanes, h, process) * (-1 if wrong == "sign" else 1)

    monkeypatch.setattr(stochastic._Noisy, "find_noise", find_noise)
    one = made(method)
    with pytest.raises(CrossCheckError, match="rung 4"):
        check_steps(one, plain.points(one), 0.125)


@pytest.mark.parametrize(
    ("good", "bad"),
    [
        ("_rows[2] = -_t1;", "_rows[2] = _t1;"),
        ("_rows[1] = p;", "_rows[1] = q;"),
        ("3528531795", "3528531797"),
        ("round < 10", "round < 7"),
        ("3.3871328727963665", "3.3871328727963666"),
        ("h * 0.5 * (first[i] + later[i])", "h * 0.5 * (first[i] - later[i])"),
        ("fields[i * NOISE + k]", "fields[k * STATE + i]"),
    ],
)
def test_a_spoiled_text_is_caught(good, bad, made, monkeypatch):
    """Fields, words, normals and steps, before anything is compiled."""
    made("heun")
    with pytest.raises(CrossCheckError, match="rung 3"):
        check_solver_texts(plain.texts_of(SWING, plain.replaced("solver.c", good, bad)))


@needs_compiler
def test_bits_of_c_are_those_of_numpy_and_a_wrong_bit_is_caught(made, tmp_path, monkeypatch):
    """Members, steps, samples and noise; then all lanes with the noise of the first."""
    method = "midpoint"
    monkeypatch.setattr(solver_steps, "list_choices", lambda functions: {method: NOISY[method]})
    one = made(method, tmp_path)
    assert check_bits(one, plain.points(one), 0.125)[method] > 100
    (tmp_path / "wrong").mkdir()
    off = plain.replaced("solver.c", "run->seed, block->member[w]", "run->seed, block->member[0]")
    one = made(method, tmp_path / "wrong", off)
    with pytest.raises(CrossCheckError, match="rung 5"):
        check_bits(one, plain.points(one), 0.125)


#: Noise about two axes of a body, which do not commute.
BODY = (
    plain.QUARTIC
    + """
[noise]
dW1 = "Pi1/5"
dW2 = "Pi2*Pi3/4"
"""
)


@needs_compiler
@pytest.mark.parametrize(
    ("good", "bad"),
    [
        ("STATE", "STATE"),
        ("slopes[i * NOISE + k] * block->noise[k]", "slopes[k * STATE + i] * block->noise[k]"),
    ],
)
def test_the_element_of_a_step_has_the_noise(good, bad, tmp_path):
    """Steps of the coadjoint mean, with noise by Hamiltonians; slopes by other rows are caught."""
    method = "coadjoint_mean"
    context = plain.context_of("noisy_body", BODY)
    made = plain.solvers(context, (method,), tmp_path, plain.replaced("solver.c", good, bad))
    batch = plain.points(made)
    if good == bad:
        assert 0 < check_steps(made, batch, 0.125)[method]["c"].k < 1
        assert check_bits(made, batch, 0.125)[method] > 400
    else:
        with pytest.raises(CrossCheckError, match="rung 4"):
            check_steps(made, batch, 0.125)
