"""The ladder on driven systems: they pass it, and texts that lose an input or the time do not."""

from dataclasses import replace

import pytest

from coadjoint.errors import CoadjointError
from coadjoint.pipeline import verify
from tests.driven_specs import PENDULUM, ROD, SUSLOV, TOP, VELOCITIES, rendered


@pytest.mark.parametrize("text", [PENDULUM, ROD, SUSLOV, TOP, VELOCITIES])
def test_driven_systems_pass(text):
    """All rungs pass, with inputs and time sampled like the state."""
    assert verify(rendered(text)).passed


SPOILED = [
    ("kernel.py", "    u = inputs[0]\n", "    u = parameters[0]\n"),
    ("kernel.py", "    t = time[0]\n", "    t = inputs[0]\n"),
    ("kernel.py", "[inputs if inputs.ndim", "[0 * inputs if inputs.ndim"),
    ("kernel.py", "else inputs.reshape(", "else 0 * inputs.reshape("),
    ("kernel.py", "else time.reshape(", "else 0 * time.reshape("),
    ("kernel.py", "own = [each[:, chunk]", "own = [each[:, : len(rows[0, chunk])]"),
    ("kernel.py", "state, parameters, inputs, time, out)", "state, parameters, time, inputs, out)"),
    ("kernel_python.py", "    u = inputs[0]\n", "    u = parameters[0]\n"),
    ("kernel_python.py", "    t = time\n", "    t = inputs[0]\n"),
    ("kernel_python.py", "inputs, *, time)", "time, *, inputs)"),
    ("kernel.c", "= inputs[0 * _inputs_row", "= time[0 * _inputs_row"),
    ("kernel.c", "_n * _time_member]", "_n * 0]"),
    ("kernel.c", "_time_member = time_stride != 0", "_time_member = 0"),
    ("kernel.c", "_inputs_member = inputs_stride != 0", "_inputs_member = 1"),
]


@pytest.fixture(scope="module")
def pendulum():
    """The pendulum, with an input and with time."""
    return rendered(PENDULUM)


@pytest.mark.parametrize(("file", "right", "wrong"), SPOILED, ids=range(len(SPOILED)))
def test_texts_that_lose_inputs_are_caught(pendulum, file, right, wrong):
    """Reading back, 50 digits or the bits detect each."""
    assert right in pendulum.texts[file], right
    spoiled = pendulum.texts | {file: pendulum.texts[file].replace(right, wrong)}
    with pytest.raises(CoadjointError, match=r"rung|wrong kernel|cannot be"):
        verify(replace(pendulum, texts=spoiled))


def test_signatures_of_driven_kernels(pendulum):
    """Inputs follow the parameters, time goes by name in Python and follows them in C."""
    assert "def rhs(state, parameters, inputs, *, time, out=None):" in pendulum.texts["kernel.py"]
    assert "def rhs(state, parameters, inputs, *, time):" in pendulum.texts["kernel_python.py"]
    prototype = """void sample_input_jacobian(
    size_t count,
    const double *state, size_t state_stride,
    const double *parameters, size_t parameters_stride,
    const double *inputs, size_t inputs_stride,
    const double *time, size_t time_stride,
    double *out, size_t out_stride);
"""
    assert prototype in pendulum.texts["kernel.h"]
    assert "def rhs(state, parameters, inputs, out=None):" in rendered(TOP).texts["kernel.py"]
