"""The exact flow of Euler's top: the theorem, elliptic functions, all orders of inertia."""

import pytest

from coadjoint.derive.euler_top import FUNCTIONS, add_time, find_top, integrals
from coadjoint.exact import Field
from coadjoint.lower.exact_body import DOUBLINGS, SERIES, lower_exact_body
from tests import specs
from tests.lower.maps import apply, exact_motion, find_defect, mp, take


def check_flow(flow, functions, field, a):
    """Its derivative by the time is the motion, and it begins at the identity."""
    names = ("x1", "x2", "x3")
    x = (field["x1"], field["x2"], field["x3"])
    n, c, d = (field[name] for name in functions)
    large, small = integrals(a, x)
    slopes = (c * d, -large * n * d, -small * n * c)
    begin = dict(zip(functions, (field.zero, field.one, field.one), strict=True))
    for i, name in enumerate(names):
        j, k = (i + 1) % 3, (i + 2) % 3
        moved = field.sum(
            field.derivative(flow[i], function) * slope
            for function, slope in zip(functions, slopes, strict=True)
        )
        gap = (moved - a[i] * flow[j] * flow[k]).combine()
        for function, square in (
            (functions[1], 1 - large * n**2),
            (functions[2], 1 - small * n**2),
        ):
            gap = field.reduce_squares(gap, function, square).combine()
        start = field.substitute(flow[i], begin) - field[name]
        assert field.is_zero(gap), f"{name} does not move as it should"
        assert field.is_zero(start), f"{name} does not begin at the identity"


def test_the_formulas_are_the_flow_of_any_top():
    """For all coefficients and states, and a sign that is changed is caught."""
    field = Field(["x1", "x2", "x3", "a1", "a2", "a3", *FUNCTIONS])
    a, x, functions = (
        tuple(field[name] for name in names)
        for names in (("a1", "a2", "a3"), ("x1", "x2", "x3"), FUNCTIONS)
    )
    flow = add_time(a, x, functions)
    check_flow(flow, FUNCTIONS, field, a)
    with pytest.raises(AssertionError, match="x1 does not move"):
        check_flow((flow[0], flow[1], -flow[2] + 2 * x[2]), FUNCTIONS, field, a)


def test_the_series_is_that_of_sn():
    """``n = sn(sqrt(L) t, M/L)/sqrt(L)``: the first term left out is of order t^11."""
    large, small, t = mp.mpf("0.7"), mp.mpf("0.3"), mp.mpf("0.01")
    total = mp.mpf(0)
    for order, numbers in enumerate(SERIES):
        terms = (c * large ** (order - j) * small**j for j, c in enumerate(numbers))
        total += (-1) ** order * sum(terms) * t ** (2 * order + 1) / mp.factorial(2 * order + 1)
    exact = mp.ellipfun("sn", mp.sqrt(large) * t, m=small / large) / mp.sqrt(large)
    assert 0 < abs(total - exact) < 1e-23
    assert DOUBLINGS == 6


@pytest.mark.parametrize("inertia", ["123", "321", "213", "231", "312", "132", "112", "122", "555"])
def test_a_step_is_the_motion_for_every_order_of_inertia(inertia):
    """Near an axis, in between, and on the separatrix, to 1e-24 over half a unit of time."""
    program = lower_exact_body(specs.emitted("rigid_body"))
    parameters = [mp.mpf(each) for each in inertia]
    for text in (("0.4", "0.9", "-0.3"), ("1e-9", "1", "0"), ("1e-7", "0.5", "1e-7")):
        state, h = [mp.mpf(each) for each in text], mp.mpf("0.5")
        end = exact_motion("rigid_body", state, parameters, h)
        found = apply(program, state, parameters, h)
        assert max(abs(a - b) for a, b in zip(end, found, strict=True)) < 1e-24
    separatrix = [mp.sqrt(mp.mpf(1) / 3), mp.mpf(1), mp.mpf(1)]  # of I = 1, 2, 3: H = L^2/(2 I2)
    end = exact_motion("rigid_body", separatrix, [mp.mpf(n) for n in (1, 2, 3)], mp.mpf("0.5"))
    found = apply(program, separatrix, [mp.mpf(n) for n in (1, 2, 3)], mp.mpf("0.5"))
    assert max(abs(a - b) for a, b in zip(end, found, strict=True)) < 1e-22


def test_a_step_is_a_poisson_map():
    """To 22 digits at a step of 0.3."""
    state, parameters = take("rigid_body", ("0.4", "0.9", "-0.3"))
    program = lower_exact_body(specs.emitted("rigid_body"))
    move = lambda x: apply(program, x, parameters, mp.mpf("0.3"))  # noqa: E731
    assert find_defect("rigid_body", move, state, parameters) < 1e-20


def test_a_wrong_series_is_seen(monkeypatch):
    """A number of the series that is changed moves the end of a step."""
    monkeypatch.setattr("coadjoint.lower.exact_body.SERIES", (*SERIES[:2], (1, 15, 1), *SERIES[3:]))
    state, parameters = take("rigid_body", ("0.4", "0.9", "-0.3"))
    end = exact_motion("rigid_body", state, parameters, mp.mpf("0.5"))
    found = apply(lower_exact_body(specs.emitted("rigid_body")), state, parameters, mp.mpf("0.5"))
    assert max(abs(a - b) for a, b in zip(end, found, strict=True)) > 1e-15


def test_other_motions_are_refused_with_the_reason():
    """What is no top is told apart."""
    assert "three components" in find_top(specs.emitted("heavy_top"))
    assert find_top(specs.emitted("se2_pendulum")) == (
        "the rate of m is -b2, which is no multiple of the product of the two others"
    )
    assert find_top(specs.emitted("pt_rigid_body")) == (
        "the rate of x1 is no multiple of the product of the two others"  # it takes ten lines
    )
