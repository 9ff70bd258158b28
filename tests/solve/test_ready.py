"""The short way: the bits and the refusals of the checks, for parameters and results as well."""

from __future__ import annotations

from threading import Thread

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError, KernelTypeError
from coadjoint.render.targets import BUILDS
from coadjoint.solve.quantities import Quantities, Quantity
from coadjoint.solve.ready import make_pack
from coadjoint.systems import heavy_top, quadrotor, rigid_body

STATE = np.arange(1.0, 7.0)
#: The same parameters in every form that is ready.
FORMS = {
    "array": np.array([2.0, 3.0, 5.0, 1.5, 9.0, 0.25, -0.5, 0.75]),
    "read-only": np.array([2.0, 3.0, 5.0, 1.5, 9.0, 0.25, -0.5, 0.75]),
    "strided": np.repeat([2.0, 3.0, 5.0, 1.5, 9.0, 0.25, -0.5, 0.75], 2)[::2],
    "list": [2, 3.0, 5, 1.5, 9, 0.25, -0.5, np.float64(0.75)],
    "vectors": {"chi": [0.25, -0.5, 0.75], "I": np.array([2.0, 3.0, 5.0]), "m": 1.5, "g": 9},
    "components": {
        **{"I1": 2, "I2": 3.0, "I3": 5.0, "m": 1.5},
        **{"g": np.float64(9.0), "chi1": 0.25, "chi2": -0.5, "chi3": 0.75},
    },
}
FORMS["read-only"].flags.writeable = False
#: What the checks refuse, with what they say.
WRONG = [
    ({"I": [1.0, -2.0, 3.0]}, "I2 of heavy_top is -2"),
    ({"I": [1.0, float("nan"), 3.0]}, "I2 of heavy_top is nan"),
    ({"m": 0}, "m of heavy_top is 0"),
    (np.array([1.0, 2.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0]), "I3 of heavy_top is 0"),
    ({"I": [1.0, 2.0, 3.0], "I1": 4.0}, "I1 twice"),
    ({"J": [1.0, 2.0, 3.0]}, "'J' is not one of"),
    ({"I": [1.0, 2.0]}, "expected \\(3,\\)"),
    ({"m": [1.0, 2.0]}, "batch shape"),
    ([1.0, 2.0], "parameters of heavy_top has the shape"),
    (np.ones(7), "parameters of heavy_top has the shape"),
    ({"m": True}, "type bool"),
    ({"m": "1"}, "type <U1"),
    ({"m": 2**53 + 1}, "2\\^53"),
    ({"m": 1j}, "complex128"),
    ({"I": np.ma.masked_array([1.0, 2.0, 3.0])}, "masked"),
]


def the_short_way(system, function="rhs", target="c"):
    """The function of a system that was called before."""
    getattr(system, function)(np.ones(system.system.STATE.size), target=target)
    return system.system._kernels.ready[function, target]


@pytest.mark.parametrize("target", list(BUILDS))
@pytest.mark.parametrize("form", list(FORMS))
def test_parameters_in_every_form_give_what_the_checks_give(form, target):
    """A shared set of parameters is packed at once, for one state and for several."""
    ready = the_short_way(heavy_top, target=target)
    for state in (STATE, np.outer(STATE, [1.0, -2.0, 0.5])):
        own = np.repeat(FORMS["array"][:, None], state.size // 6, axis=1)  # never the short way
        expected = heavy_top.rhs(state.reshape(6, -1), own, target=target).reshape(state.shape)
        found = ready(state, FORMS[form])
        assert found is not None
        assert np.array_equal(found, expected)
        assert np.array_equal(heavy_top.rhs(state, FORMS[form], target=target), expected)
        out = np.full_like(state, np.nan)
        assert heavy_top.rhs(state, FORMS[form], target=target, out=out) is out
        assert np.array_equal(out, expected)
    assert expected.any()


def test_defaults_are_as_before_after_a_call_with_parameters():
    """Nothing of the parameters of one call stays for the next."""
    before = heavy_top.rhs(STATE)
    other = heavy_top.rhs(STATE, FORMS["list"])
    assert not np.array_equal(before, other)
    assert np.array_equal(heavy_top.rhs(STATE), before)


@pytest.mark.parametrize(("parameters", "message"), WRONG, ids=lambda value: str(value)[:40])
def test_wrong_parameters_are_refused_as_ever(parameters, message):
    """The short way passes on what it does not take, and the checks say what is wrong."""
    assert the_short_way(heavy_top)(STATE, parameters) is None
    with pytest.raises((KernelArgumentError, KernelTypeError), match=message):
        heavy_top.rhs(STATE, parameters)


def test_parameters_of_each_member_go_through_the_checks():
    """A batch of parameters is computed, not refused."""
    state, own = np.ones((3, 2)), np.array([[1.0, 2.0], [2.0, 3.0], [4.0, 5.0]])
    assert the_short_way(rigid_body)(state, own) is None
    found = rigid_body.rhs(state, own)
    assert np.array_equal(found[:, 1], rigid_body.rhs(np.ones(3), own[:, 1].copy()))


@pytest.mark.parametrize(
    "spoil",
    [
        lambda state: state,
        lambda state: np.zeros(7)[:6],
        lambda state: np.zeros((6, 1)),
        lambda state: np.zeros(6, dtype=np.float32),
        lambda state: np.zeros(12)[::2],
        lambda state: [0.0] * 6,
        lambda state: np.broadcast_to(0.0, 6),
    ],
    ids=["the state", "fits", "a column", "float32", "strided", "list", "read-only"],
)
def test_a_result_that_cannot_be_written_is_refused_as_ever(request, spoil):
    """It is written in place or an error explains; one that fits is taken."""
    state = STATE.copy()
    out = spoil(state)
    taken = the_short_way(heavy_top)(state, None, out)
    if request.node.callspec.id == "fits":
        assert taken is out
        assert np.array_equal(out, heavy_top.rhs(state))
        return
    assert taken is None
    with pytest.raises((KernelArgumentError, KernelTypeError), match="out"):
        heavy_top.rhs(state, out=out)
    assert np.array_equal(state, STATE)


def test_a_system_that_is_driven_has_a_short_way_with_its_default_inputs():
    """Inputs that are given go through the checks."""
    state, ready = np.full(quadrotor.system.STATE.size, 0.5), the_short_way(quadrotor)
    expected = quadrotor.rhs(state, quadrotor.system.pack(), quadrotor.system.INPUTS.packed.copy())
    assert np.array_equal(ready(state), expected)
    assert np.array_equal(ready(state, {}), expected)


def test_threads_with_parameters_of_their_own_do_not_disturb_one_another():
    """Each call has its own copy: the lock is released while C computes."""
    state = np.random.default_rng(3).normal(size=(6, 1000))
    sets = [{"m": float(n + 1)} for n in range(4)]
    expected = [heavy_top.rhs(state, each) for each in sets]
    wrong = []

    def work(n):
        for _ in range(200):
            if not np.array_equal(heavy_top.rhs(state, sets[n]), expected[n]):
                wrong.append(n)

    threads = [Thread(target=work, args=(n,)) for n in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_parameters_without_a_default_are_asked_for():
    """What is missing is left to the checks, in a dict and altogether."""
    pack = make_pack(
        Quantities(Quantity("a", (), "1", ("a",), default=(1.0,)), Quantity("b", (), "1", ("b",)))
    )
    assert pack({"a": 2.0}) is None
    assert list(pack({"b": 3.0})) == [1.0, 3.0]
    assert pack([]) is None


def test_tables_of_parameters_go_through_the_checks():
    """A matrix is a list of lists, which the short way does not take apart."""
    matrix = Quantity("A", (2, 2), "1", ("A11", "A12", "A21", "A22"), default=(1.0,) * 4)
    pack = make_pack(Quantities(matrix))
    assert pack({"A": [[1.0, 2.0], [3.0, 4.0]]}) is None
    assert list(pack({"A12": 2.0})) == [1.0, 2.0, 1.0, 1.0]


def test_no_parameters_are_no_short_way():
    """A system without parameters has nothing to pack."""
    assert make_pack(Quantities())({}) is None
