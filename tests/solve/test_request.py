"""Bad input of `simulate`: refused with what was found and expected, before any work starts."""

import numpy as np
import pytest
import scipy.integrate

from coadjoint.errors import KernelArgumentError, KernelTypeError
from coadjoint.solve import generated
from coadjoint.systems import heavy_top, rigid_body
from tests.driven_specs import PENDULUM, rendered
from tests.driven_specs import build as build_driven

BATCH = np.random.default_rng(0).normal(size=(6, 4))
ONE = BATCH[:, 0]
LISTED = "expected one of 'auto', 'taylor', 'dop853', 'rk4', .*'scipy:DOP853', .* for heavy_top"
#: What is given, and what the message says of it.
WRONG = [
    # shapes
    (
        {"state": BATCH.T},
        r"\(4, 6\); expected \(6,\) or .*Gamma3. It looks transposed: pass state.T",
    ),
    ({"state": np.ones((2, 6, 4))}, r"Components come first: pass np.moveaxis\(state, 1, 0\)"),
    ({"state": np.ones((6, 2)).T.copy()}, "transposed: pass state.T"),
    ({"state": [1, 2, 3]}, r"the shape of state of heavy_top is \(3,\); expected \(6,\)"),
    ({"state": 1.0}, r"is \(\); expected \(6,\)"),
    ({"state": np.ones((6, 0))}, "holds no member"),
    ({"state": [[1, 2], [1], 1, 1, 1, 1]}, "state is ragged"),
    ({"state": {"Pi": [1, 2, 3]}}, "state lacks Gamma1, Gamma2, Gamma3"),
    ({"state": {"Pi": [1, 2], "Gamma": [1, 2, 3]}}, r"state\['Pi'\] has the shape \(2,\)"),
    ({"state": {"Pj": [1, 2, 3], "Gamma": [1, 2, 3]}}, "'Pj' is not one of Pi, Gamma"),
    ({"state": {"Pi": np.ones((3, 4)), "Gamma": np.ones((3, 5))}}, "do not fit together"),
    ({"parameters": np.ones((4, 8))}, "It looks transposed: pass parameters.T"),
    ({"state": BATCH, "parameters": {"m": np.ones(5)}}, r"batch shape \(5,\), the state \(4,\)"),
    ({"parameters": {"m": np.ones(5)}}, "follows one trajectory for a state without a batch"),
    # types
    ({"state": "abc"}, "state is 'abc'; expected real numbers"),
    ({"state": None}, "state lacks Pi1, Pi2, .*; expected a value of each"),
    ({"state": ONE + 0j}, "the type complex128; .* if a loss is meant"),
    ({"state": ONE.astype(np.longdouble)}, "the type float128"),
    ({"state": np.ones(6, bool)}, "the type bool"),
    ({"state": np.full(6, 2**60)}, "integers beyond 2.53"),
    ({"state": np.ma.masked_greater(ONE, 0)}, "is a masked array"),
    ({"parameters": {"m": None}}, r"parameters\['m'\] is None"),
    ({"t": "10"}, "t is '10'; expected real numbers"),
    # values
    ({"state": [0, 0, np.nan, 0, 0, 1]}, "the initial Pi3 is nan; expected a finite number"),
    ({"state": np.array([[1.0, np.inf]] * 6)}, "initial Pi1 of member 1 is inf"),
    ({"state": np.full((6, 2, 3), np.nan)}, r"initial Pi1 of member \(0, 0\) is nan"),
    ({"parameters": {"I": [1, -2, 3]}}, "parameter I2 of heavy_top is -2; expected a positive"),
    ({"parameters": {"m": 0}}, "parameter m of heavy_top is 0; expected a positive value"),
    ({"parameters": {"m": np.nan}}, "parameter m of heavy_top is nan; expected a positive value"),
    (
        {"state": BATCH, "parameters": {"m": [1, 2, -3, 4]}},
        "parameter m of member 2 of heavy_top is -3; expected a positive value",
    ),
    ({"parameters": {"m": np.inf}}, "m of the parameters is inf; expected a finite number"),
    ({"parameters": {"g": np.nan}}, "g of the parameters is nan; expected a finite number"),
    (
        {"state": BATCH, "parameters": {"g": [1, 2, 3, np.nan]}},
        "g of member 3 of the parameters is nan",
    ),
    ({"inputs": [1.0]}, "heavy_top has no inputs"),
    ({"inputs": lambda t: t}, "heavy_top has no inputs"),
    # times
    ({"t": (1, 1)}, r"t is \(1, 1\); expected \(start, end\) or increasing finite times"),
    ({"t": [0, 2, 1]}, "increasing finite times"),
    ({"t": [0, 1, 1, 2]}, "increasing finite times"),
    ({"t": (1, 0)}, r"Runs go forward in time: for the past, give System\.ode to an integrator"),
    ({"t": [3, 2, 1]}, "Runs go forward in time"),
    ({"t": [1.0]}, "expected .start, end."),
    ({"t": 3.0}, "expected .start, end."),
    ({"t": [[0, 1], [2, 3]]}, "expected .start, end."),
    ({"t": (0, np.nan)}, "finite times"),
    ({"t": (0, np.inf)}, "finite times"),
    ({"t": (-1e308, 1e308)}, "finite times"),
    ({"t": (1, np.nextafter(1, 2))}, r"not so many different numbers from 1\.0 to 1\.00000000000"),
    ({"samples": 0}, "samples is 0; expected a whole number"),
    ({"samples": 2.0}, r"samples is 2\.0; expected a whole number"),
    ({"samples": None}, "samples is None"),
    ({"samples": 10**12}, r"4\.8e\+04 GB.*samples=1 keeps the end alone"),
    ({"state": np.ones((6, 9)), "samples": 10**12}, "states of 54 numbers"),
    # methods
    ({"method": "tailor"}, f"method is 'tailor'; {LISTED}. Did you mean 'taylor'"),
    ({"method": "Radau"}, f"{LISTED}. Write method='scipy:Radau' for that of SciPy"),
    ({"method": "rk45"}, "Write method='scipy:RK45'"),
    ({"method": None}, f"method is None; {LISTED}"),
    ({"method": ["taylor"]}, f"{LISTED}"),
    ({"method": "rk4"}, "'rk4' has no estimate of its error; expected step="),
    ({"method": "rk4", "step": 0.1, "rtol": 1e-3}, "expected one or the other"),
    ({"method": "scipy:BDF", "step": 0.1}, "chooses its steps by the tolerances"),
    ({"method": "dop853", "step": 0.1, "rtol": 1e-6}, "expected one or the other"),
    ({"step": 0.1, "atol": 1e-6}, "which method 'splitting4' does not look at.* one or the other"),
    ({"state": BATCH, "method": "scipy:Radau"}, "follows one trajectory; .* Leave method out"),
    ({"target": "python", "method": "taylor"}, "does not apply.*targets c, c-fast and numpy"),
    ({"target": "python", "step": 0.1}, "with a fixed step is a generated solver, which does not"),
    ({"target": "rust"}, "target is 'rust'; expected 'numpy', 'c', 'c-fast' or 'python'"),
    ({"target": ["c"]}, r"target is \['c'\]"),
    # numbers
    ({"rtol": 0.0}, r"rtol is 0\.0; expected a positive number"),
    ({"rtol": -1e-3}, r"rtol is -0\.001"),
    ({"rtol": 1.0}, r"rtol is 1\.0; expected a positive number below 1"),
    ({"rtol": np.nan}, "rtol is nan"),
    ({"rtol": "1e-3"}, "rtol is '1e-3'"),
    ({"atol": -1}, "atol is -1; expected a positive number"),
    ({"atol": float("nan")}, "atol is nan"),
    ({"step": -0.1}, "step is -0.1; expected a positive number"),
    ({"step": np.inf}, "step is inf; expected a positive number"),
    ({"step": 1e-9}, r"makes 1e\+09 steps to the end, and max_steps is 1000000"),
    ({"max_steps": 0}, "max_steps is 0; expected a whole number"),
    ({"max_steps": 2**70}, r"expected a whole number from 1 to 2\^53"),
    ({"threads": 0}, "threads is 0; expected a whole number"),
    ({"threads": -1}, "threads is -1; expected a whole number"),
    ({"threads": 1.5}, "threads is 1.5; expected a whole number"),
    ({"threads": True}, "threads is True; expected a whole number"),
    ({"dense": "no"}, "dense is 'no'; expected True or False"),
    ({"progress": "yes"}, "progress is 'yes'; expected True, False, or a function"),
    ({"reconstruct": True}, "heavy_top reconstructs nothing"),
]


@pytest.mark.parametrize(
    ("change", "message"), WRONG, ids=lambda each: str(each).split(" at 0x")[0][:60]
)
def test_what_cannot_be_simulated_is_refused(change, message, monkeypatch):
    """Each with what was found and what is expected; no solver is looked for and nothing is run."""
    monkeypatch.setattr(generated, "march", None)
    for name in ("DOP853", "Radau", "BDF"):
        monkeypatch.setattr(scipy.integrate, name, None)
    usual = {"state": ONE, "t": (0, 1)}
    with pytest.raises((KernelArgumentError, KernelTypeError), match=message) as caught:
        heavy_top.simulate(**usual | change)
    assert len(str(caught.value).splitlines()) == 1


def test_what_can_be_simulated_passes_the_checks_above(monkeypatch):
    """The test above can fail: it would see a run that begins."""
    monkeypatch.setattr(generated, "march", None)
    with pytest.raises(TypeError, match="not callable"):
        heavy_top.simulate(ONE, (0, 1))


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({"u": [1.0, 2.0, 3.0]}, r"inputs have the batch shape \(3,\), the state \(2,\)"),
        ({"u": [1.0, np.nan]}, "u of member 1 of the inputs is nan; expected a finite number"),
        ({"w": 1.0}, "'w' is not one of u"),
        (([0.0, 1.0], [[1.0, 2.0]]), "expected samples as"),
        (([0.0, 0.5], [[1.0, 2.0]], "linear"), "the run is from 0 to 1; expected samples over all"),
        (([1.0, 0.0], [[1.0, 2.0]], "linear"), "expected two or more increasing finite times"),
        (([0.0, 1.0], [[1.0, np.inf]], "previous"), "are not all finite"),
        (lambda t: [1.0, 2.0], "values of the function inputs at t = 0: "),
    ],
    ids=lambda each: str(each).split(" at 0x")[0],
)
def test_inputs_of_members_are_refused(inputs, message, monkeypatch, tmp_path):
    """Of another batch, not finite, of another name, or over another time."""
    monkeypatch.setattr(generated, "march", None)
    system = build_driven(rendered(PENDULUM, name="driven").texts, tmp_path / "driven")
    with pytest.raises(KernelArgumentError, match=message):
        system.simulate(np.ones((2, 2)), (0, 1), None, inputs)


@pytest.mark.parametrize(
    "lay_out",
    [
        np.asfortranarray,
        lambda a: np.repeat(a, 2, axis=1)[:, ::2],
        lambda a: a[::-1].copy()[::-1],
        lambda a: a.astype(">f8"),
        lambda a: a.tolist(),
        lambda a: {"Pi": a[:3], "Gamma": a[3:]},
        lambda a: {"Pi": a[:3].astype(">f8"), "Gamma": a[3:].T.copy().T},
    ],
    ids=["columns", "gaps", "backwards", "other bytes", "lists", "names", "mixed"],
)
def test_the_layout_of_arrays_changes_no_bit(lay_out):
    """Strides, byte order and lists; what was given stays as it was."""
    given = lay_out(BATCH)
    found = heavy_top.simulate(given, (0, 1), samples=3, target="numpy")
    expected = heavy_top.simulate(BATCH.copy(), (0, 1), samples=3, target="numpy")
    assert found.state.tobytes() == expected.state.tobytes()
    same = lay_out(BATCH)
    if isinstance(given, dict):
        given, same = (np.concatenate([*each.values()]) for each in (given, same))
    assert np.array_equal(given, same)


def test_small_numbers_are_taken_exactly():
    """float32, integers and a state that nobody can write into."""
    small = BATCH.astype(np.float32)
    for given in (small, np.ones((6, 2), int), np.broadcast_to(ONE[:, None], (6, 3))):
        found = heavy_top.simulate(given, (0, 1), samples=2, target="numpy")
        assert np.array_equal(found.state[..., 0], np.asarray(given, float))


def test_times_are_a_span_or_an_array():
    """One sample is the end alone; integers of NumPy count; an array of times is taken as it is."""
    state = [0.3, 0.2, 1.0]
    one = rigid_body.simulate(state, (0, 2), samples=1)
    assert one.time.tolist() == [2.0]
    assert one.state.shape == (3, 1)
    for samples in (np.int32(5), np.uint8(5), 5):
        assert rigid_body.simulate(state, (0, 2), samples=samples).time.tolist() == [
            0,
            0.5,
            1,
            1.5,
            2,
        ]
    times = np.array([-1.0, 0.5, 1.0])
    found = rigid_body.simulate(state, times, samples=77)
    assert found.time.tolist() == times.tolist()
    assert found.state[:, 0].tolist() == state
    long = rigid_body.simulate(state, (-1, 1), samples=1)
    assert np.array_equal(long.state[:, 0], found.state[:, -1])


def test_the_past_is_found_by_another_integrator():
    """What the message says of a decreasing time works: there and back."""
    state = np.array([0.3, 0.2, 1.0])
    past = scipy.integrate.solve_ivp(
        rigid_body.system.ode().fun, (1, 0), state, "DOP853", rtol=1e-11, atol=1e-13
    ).y[:, -1]
    back = rigid_body.simulate(past, (0, 1), samples=1).state[:, 0]
    np.testing.assert_allclose(back, state, atol=1e-9)
