"""What kernels take, and every wrong array refused with what was expected."""

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError, KernelTypeError
from coadjoint.systems import heavy_top, rigid_body

STATE = np.array([1.0, 2.0, 3.0])
EXPECTED = [-1.0, 2.0, -1.0]  # (1/I3 - 1/I2) Pi2 Pi3 and cyclic, at I = (1, 2, 3)


def test_lists_integers_and_small_floats_are_taken_exactly():
    """What float64 holds exactly is converted."""
    for state in ([1, 2, 3], STATE.astype(np.float32), STATE.astype(np.int8), [True + 0, 2.0, 3]):
        assert rigid_body.rhs(state).tolist() == pytest.approx(EXPECTED, rel=2**-50)


@pytest.mark.parametrize("target", ["c", "numpy", "c-fast"])
@pytest.mark.parametrize("layout", ["fortran", "transposed", "reversed", "strided", "zero", "big"])
def test_every_layout_gives_the_right_value(layout, target):
    """Order, sign and size of strides and the byte order do not matter."""
    plain = np.arange(1.0, 31.0).reshape(3, 10)
    arrays = {
        "fortran": np.asfortranarray(plain),
        "transposed": np.ascontiguousarray(plain.T).T,
        "reversed": np.ascontiguousarray(plain[:, ::-1])[:, ::-1],
        "strided": np.repeat(plain, 2, axis=1)[:, ::2],
        "zero": np.broadcast_to(plain[:, :1], (3, 10)),
        "big": plain.astype(">f8"),
    }
    state = arrays[layout]
    expected = rigid_body.rhs(np.array(state.tolist()), target=target)
    assert np.array_equal(rigid_body.rhs(state, target=target), expected)


@pytest.mark.parametrize(
    ("state", "found"),
    [
        (STATE * 1j, "complex128"),
        (STATE.astype(object), "object"),
        (["1", "2", "3"], r"state is \['1', '2', '3'\]; expected real numbers"),
        (STATE.astype(np.longdouble), "float128"),
        (np.array([2**60 + 1, 0, 0]), "int64"),
        (STATE > 0, "bool"),
        (np.ma.masked_array(STATE, [True, False, False]), "masked array"),
    ],
)
def test_types_that_would_lose_something_are_refused(state, found):
    """TypeError with the type that was found."""
    with pytest.raises(KernelTypeError, match=found) as caught:
        rigid_body.rhs(state)
    assert isinstance(caught.value, TypeError)


@pytest.mark.parametrize("shape", [(), (2,), (4,), (6, 3), (1, 3)])
def test_a_wrong_first_axis_is_refused(shape):
    """ValueError with the rows that are expected."""
    with pytest.raises(KernelArgumentError, match="Pi1, Pi2, Pi3") as caught:
        rigid_body.rhs(np.zeros(shape))
    assert isinstance(caught.value, ValueError)
    assert caught.value.found == list(shape)


def test_ragged_rows_are_refused():
    """Rows of different lengths are no array."""
    with pytest.raises(KernelArgumentError, match="ragged"):
        rigid_body.rhs([[1.0, 2.0], [1.0], [1.0, 2.0]])


def test_out_is_written_in_place_and_returned():
    """The same array comes back."""
    out = np.empty(3)
    assert rigid_body.rhs(STATE, out=out) is out
    assert out.tolist() == pytest.approx(EXPECTED)


@pytest.mark.parametrize(
    ("out", "message"),
    [
        (np.empty(4), r"shape \(4,\)"),
        (np.empty((3, 1)), r"shape \(3, 1\)"),
        (np.empty(3, np.float32), "float32"),
        (np.empty(3, ">f8"), ">f8"),
        ([0.0, 0.0, 0.0], "list"),
        (np.empty(6)[::2], "not C-contiguous"),
    ],
)
def test_an_unsuitable_out_is_refused(out, message):
    """Shape, type or layout: the message says which."""
    with pytest.raises((KernelArgumentError, KernelTypeError), match=message):
        rigid_body.rhs(STATE, out=out)


def test_a_read_only_out_is_refused_and_untouched():
    """Nothing is written into it."""
    out = np.zeros(3)
    out.flags.writeable = False
    with pytest.raises(KernelArgumentError, match="read-only"):
        rigid_body.rhs(STATE, out=out)
    assert not out.any()


def test_an_out_that_overlaps_an_input_is_refused():
    """In place, shifted, and over the parameters."""
    memory = np.arange(1.0, 8.0)
    with pytest.raises(KernelArgumentError, match="shares memory with state"):
        rigid_body.rhs(memory[:3], out=memory[:3])
    with pytest.raises(KernelArgumentError, match="shares memory with state"):
        rigid_body.rhs(memory[:3], out=memory[1:4])
    with pytest.raises(KernelArgumentError, match="shares memory with parameters"):
        rigid_body.rhs(memory[:3], memory[3:6], out=memory[3:6])
    assert memory.tolist() == list(range(1, 8))


def test_parameters_by_name_override_defaults():
    """Quantities and components, the rest from the spec."""
    packed = heavy_top.system.pack({"m": 2.0, "chi": [0.0, 0.5, 1.0], "I3": 7})
    assert packed.tolist() == [1.0, 2.0, 7.0, 2.0, 9.81, 0.0, 0.5, 1.0]


def test_parameters_per_member_broadcast_with_shared_ones():
    """A mass for each member, the rest shared; shapes of any batch."""
    masses = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])
    state = np.random.default_rng(0).normal(size=(6, 3, 2))
    found = heavy_top.rhs(state, {"m": masses})
    assert found.shape == (6, 3, 2)
    for place in np.ndindex(3, 2):
        alone = heavy_top.rhs(state[:, *place], {"m": masses[place]})
        assert np.array_equal(found[:, *place], alone)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"Inertia": [1, 2, 3]}, "'Inertia' is not one of I, m, g, chi"),
        ({"ch": [1, 2, 3]}, "Did you mean 'chi'"),
        ({"I": [1.0, 2.0]}, r"parameters\['I'\] has the shape \(2,\); expected \(3,\)"),
        ({"m": -1.0}, "parameter m of heavy_top is -1; expected a positive value"),
        ({"m": np.nan}, "expected a positive value"),
        ({"I2": 0.0}, "parameter I2"),
        (np.ones(7), r"the shape of parameters of heavy_top is \(7,\)"),
        ({"m": np.ones(3), "g": np.ones(4)}, "do not fit together"),
        ({"I": [1.0, 2.0, 3.0], "I3": 4.0}, "parameters gives I3 twice"),
        ({"m": np.ones(5)}, r"batch shape \(5,\), the state \(\)"),
    ],
)
def test_wrong_parameters_are_refused(parameters, message):
    """Names, shapes, signs and batches: each with what is expected."""
    with pytest.raises(KernelArgumentError, match=message):
        heavy_top.rhs(np.ones(6), parameters)


def test_states_by_name():
    """A mapping is packed in the order of the state; a missing row is named."""
    by_name = heavy_top.rhs({"Gamma": [0.0, 0.0, 1.0], "Pi": [1.0, 2.0, 3.0]})
    assert np.array_equal(by_name, heavy_top.rhs([1.0, 2.0, 3.0, 0.0, 0.0, 1.0]))
    with pytest.raises(KernelArgumentError, match="state lacks Gamma1, Gamma2, Gamma3"):
        heavy_top.rhs({"Pi": [1.0, 2.0, 3.0]})


def test_an_empty_batch_is_an_empty_result():
    """N = 0 is no special case."""
    for target in ("c", "numpy", "c-fast"):
        assert rigid_body.jacobian(np.empty((3, 0)), target=target).shape == (3, 3, 0)
