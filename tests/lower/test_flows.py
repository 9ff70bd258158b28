"""Flows and their products: proved, Poisson maps, of their order; and Kahan's, which is none."""

from dataclasses import replace
from fractions import Fraction
from functools import partial
from math import isfinite

import pytest

from coadjoint.derive import derive
from coadjoint.derive.flows import Flow, Flows
from coadjoint.derive.splittings import NoSplitting, find_splitting
from coadjoint.errors import CrossCheckError, DerivationError
from coadjoint.lower import flows as lowered
from coadjoint.lower.kahan import _check, lower_kahan
from coadjoint.lower.program import Number, children, walk, with_children
from coadjoint.poisson.structure import PoissonStructure
from coadjoint.spec.reader import read_spec_text
from tests import specs
from tests.lower.maps import (
    apply,
    exact_motion,
    find_defect,
    flows,
    follow,
    kahan,
    kahan_step,
    measure_order,
    mp,
    number,
    split_step,
    splitting,
    take,
)

STARTS = {
    "rigid_body": ("0.4", "0.9", "-0.3"),
    "heavy_top": ("0.4", "0.9", "-0.3", "0.6", "-0.5", "0.7"),
    "kirchhoff": ("0.4", "0.9", "-0.3", "0.6", "-0.5", "0.7"),
    "se2_pendulum": ("0.4", "0.9", "-0.3"),
    "affine_line": ("0.4", "0.9"),
    "maxwell_bloch": ("0.4", "0.9", "-0.3"),
    "three_wave": ("0.4", "0.9", "-0.3", "0.6", "-0.5", "0.7"),
    "rigid_body_attitude": ("0.4", "0.9", "-0.3", "0.5", "0.5", "-0.5", "0.5"),
}
#: Steps at which errors are well above the roundings and well below the first terms left out.
STEPS = {2: 16, 4: 12, 6: 10}


@pytest.mark.parametrize("order", [2, 4, 6])
@pytest.mark.parametrize(
    "name", ["rigid_body", "heavy_top", "se2_pendulum", "maxwell_bloch", "three_wave"]
)
def test_products_of_flows_have_their_order(name, order):
    """On nonlinear problems, within 0.1."""
    state, parameters = take(name, STARTS[name])
    step = lambda name, x, p, h: split_step(name, order, x, p, h)  # noqa: E731
    steps = STEPS[order] * (2 if name == "heavy_top" else 1)
    assert abs(measure_order(step, name, state, parameters, steps) - order) < 0.1


@pytest.mark.parametrize("name", STARTS)
def test_products_of_flows_are_poisson_maps(name):
    """To 24 digits at a long step, whatever the order: rounding is all that is left in doubles."""
    state, parameters = take(name, STARTS[name])
    for order in (2, 4):
        move = partial(split_step, name, order, parameters=parameters, h=mp.mpf("0.3"))
        assert find_defect(name, lambda x, move=move: move(state=x), state, parameters) < 1e-22


@pytest.mark.parametrize("name", STARTS)
def test_products_of_flows_are_reversible(name):
    """A step forth and one back lead to the start, to 36 digits."""
    state, parameters = take(name, STARTS[name])
    for order in (2, 4, 6):
        there = split_step(name, order, state, parameters, mp.mpf("0.2"))
        back = split_step(name, order, there, parameters, -mp.mpf("0.2"))
        assert max(abs(a - b) for a, b in zip(back, state, strict=True)) < 1e-36


def test_a_part_of_two_coordinates_turns_by_the_exact_angle():
    """With the polynomial of the tangent Kirchhoff's parts are no Poisson maps: this is seen."""
    state, parameters = take("kirchhoff", STARTS["kirchhoff"])
    parameters[6:] = [mp.mpf("0.5")] * 3  # the coupling D, zero by default
    found = splitting("kirchhoff")
    turning = next(n for n, part in enumerate(found.parts) if part.flow.rotations)
    part = found.parts[turning]
    rational = tuple(replace(each, is_rational=True) for each in part.flow.rotations)
    spoilt = replace(part, flow=Flow(part.flow.values, rational))
    program = lowered._lower_flow(found.equations, "flow", spoilt)
    for own, bad in ((flows("kirchhoff")[turning], False), (program, True)):
        move = lambda x, own=own: apply(own, x, parameters, mp.mpf(2))  # noqa: E731
        assert (find_defect("kirchhoff", move, state, parameters) > 1e-9) == bad


def test_the_third_order_of_the_modified_energy_is_the_error_of_a_step():
    """``|strang(h) - exact(h)|/h^3`` at the states compared is the norm that is reported."""
    found = splitting("rigid_body")
    _, parameters = take("rigid_body", STARTS["rigid_body"])
    h, total = mp.mpf("0.001"), mp.mpf(0)
    numbers = [mp.mpf(1), mp.mpf(1) / 2, mp.mpf(1) / 3]
    for turn in range(3):
        state = [numbers[(n + turn) % 3] for n in range(3)]
        ends = (
            split_step("rigid_body", 2, state, parameters, h),
            exact_motion("rigid_body", state, parameters, h),
        )
        total += sum(((a - b) / h**3) ** 2 for a, b in zip(*ends, strict=True))
    chosen = found.errors[0, 1, 2]
    assert float(mp.sqrt(total)) == pytest.approx(chosen, rel=1e-3)
    assert chosen == min(found.errors.values())
    assert len(found.errors) == 6


def test_a_flow_with_a_wrong_sign_is_refused():
    """Each row of each flow, negated or left where it is, is caught by the proof."""
    found, caught = splitting("heavy_top"), 0
    field, state = found.equations.setting.field, found.equations.setting.state
    tensor = PoissonStructure(field, state, found.equations.exact.poisson_tensor)
    proof = Flows(field, state, tensor.lie_algebra)
    for part in found.parts:
        proof.check(part.energy, part.flow)
        for row, name in enumerate(state):
            if part.flow.values[row] == field[name]:
                continue
            for wrong in (field[name], field[name] * 2 - part.flow.values[row]):
                values = [*part.flow.values]
                values[row] = wrong
                with pytest.raises(DerivationError, match=r"wrong in its rate: \w+ is off"):
                    proof.check(part.energy, replace(part.flow, values=tuple(values)))
                caught += 1
        shifted = (part.flow.values[0] + 1, *part.flow.values[1:])
        with pytest.raises(DerivationError, match="wrong at the start: Pi1"):
            proof.check(part.energy, replace(part.flow, values=shifted))
    assert caught == 2 * (3 * 4 + 3)


def test_a_flow_that_is_lowered_wrong_is_refused(monkeypatch):
    """A Program that is not the flow is caught."""
    right = lowered.lower_rows

    def wrong(equations, name, lines, state):
        return right(equations, name, [lines[1], lines[0], *lines[2:]], state)

    monkeypatch.setattr(lowered, "lower_rows", wrong)
    with pytest.raises(CrossCheckError, match="lowering changed flow1, output Pi1"):
        lowered.lower_flows(splitting("heavy_top"))


def test_a_sum_without_a_part_is_no_longer_the_motion():
    """The order of a product that lacks a flow is zero."""
    state, parameters = take("rigid_body", STARTS["rigid_body"])

    def step(name, x, p, h):
        for n in (0, 1, 0):
            x = apply(flows(name)[n], x, p, h / 2 if n == 0 else h)
        return x

    assert abs(measure_order(step, "rigid_body", state, parameters, 16)) < 0.2


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("suslov", "no Poisson tensor"),
        ("chaplygin_sleigh", "constraints"),
        ("heavy_top_damped", "the rate of Pi1 is not that of the Poisson tensor and the energy"),
        ("stochastic_rigid_body", "noise, for which a substep back in time"),
        ("quadrotor", "driven by f, M1, M2, M3"),
        ("point_vortices", "depends on x_0 and y_0, whose bracket is not 0"),
        ("hess_appelrot", "depends on Pi1 and Pi3, whose bracket is not 0"),
        ("guiding_centre", "not affine"),
        ("so6_body", "more than 6 parts"),
        ("nambu_pendulum", "no single rational frequency"),
    ],
)
def test_a_system_without_a_splitting_is_refused_with_the_reason(name, reason):
    """What is in the way is named."""
    found = find_splitting(specs.emitted(name))
    assert isinstance(found, NoSplitting)
    assert reason in found.reason


# -- Kahan ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["rigid_body", "heavy_top", "three_wave"])
def test_kahan_is_of_order_2_and_reversible(name):
    """Within 0.1, and to 36 digits."""
    state, parameters = take(name, STARTS[name])
    assert abs(measure_order(kahan_step, name, state, parameters, 40) - 2) < 0.1
    there = kahan_step(name, state, parameters, mp.mpf("0.2"))
    back = kahan_step(name, there, parameters, -mp.mpf("0.2"))
    assert max(abs(a - b) for a, b in zip(back, state, strict=True)) < 1e-36


@pytest.mark.parametrize("name", ["rigid_body", "heavy_top"])
def test_kahan_is_no_poisson_map(name):
    """Its defect at a step of 0.1 is far from zero: the control of the test above."""
    state, parameters = take(name, STARTS[name])
    move = lambda x: kahan_step(name, x, parameters, mp.mpf("0.1"))  # noqa: E731
    assert find_defect(name, move, state, parameters) > 1e-6


def test_kahan_keeps_the_integral_of_hirota_and_kimura():
    """Of the free body ``(1 - h^2 a1 a2 x3^2/4...)``: the quotient that they found stays.

    R. Hirota and K. Kimura, Journal of the Physical Society of Japan 69 (2000) 627: with
    ``x1' = a1 x2 x3`` and cyclic, ``(1 - (h/2)^2 a2 a3 x1^2)/(1 - (h/2)^2 a3 a1 x2^2)``.
    """
    state, parameters = take("rigid_body", STARTS["rigid_body"])
    i1, i2, i3 = parameters
    a1, a2, a3 = 1 / i3 - 1 / i2, 1 / i1 - 1 / i3, 1 / i2 - 1 / i1
    h = mp.mpf("0.3")

    def integral(x):
        return (1 - h**2 / 4 * a2 * a3 * x[0] ** 2) / (1 - h**2 / 4 * a3 * a1 * x[1] ** 2)

    end = follow(kahan_step, "rigid_body", state, parameters, h, 20)
    assert abs(end[0] - state[0]) > 0.1
    assert abs(integral(end) - integral(state)) < 1e-36


def test_kahan_is_refused_where_a_term_is_not_quadratic():
    """The term is named."""
    assert lower_kahan(specs.emitted("toda_lattice")) == (
        "the term -exp(q_0 - q_1) of the rate of p_0 is not quadratic"
    )
    assert "driven by t" in lower_kahan(specs.emitted("kapitza_top"))
    assert "has noise" in lower_kahan(specs.emitted("stochastic_rigid_body"))
    assert lower_kahan(specs.emitted("suslov")) == (
        "its rates are not in closed form: its kernel solves for them"
    )
    assert lower_kahan(specs.emitted("guiding_centre")) == (
        "a term of the rate of X1 is not quadratic"  # which has no room in a sentence
    )
    assert "operations, more than" in lower_kahan(specs.emitted("so6_body"))


def test_kahan_takes_functions_of_numbers_and_parameters():
    """They are constants of a quadratic motion, also in the check of its equation."""
    for factor in ("sqrt(2)", "2^(1/3)", "exp(cos(I1))"):
        energy = ("dot(Omega, diag(I)*Omega)/2", "dot(Omega, diag(I)*Omega)/2 + Omega1^2/4")
        turned = specs.spec(specs.RIGID_BODY, energy, ("Omega1^2/4", f"{factor}*Omega1^2"))
        assert not isinstance(lower_kahan(derive(turned)), str)


def test_a_step_of_kahan_that_does_not_solve_its_equation_is_refused():
    """Each number of the Program, changed, is caught."""
    equations, program, caught = specs.emitted("rigid_body"), kahan("rigid_body"), 0
    field, names = equations.setting.field, equations.setting.state
    rates = [equations.close(rate) for rate in equations.exact.rates]
    slopes = [field.gradient(rate, names) for rate in rates]
    _check(equations, program, rates, slopes)

    def replace_in(node, place):
        """The number 3 in the place of another one."""
        if node == place:
            return Number(Fraction(3))
        return with_children(node, [replace_in(each, place) for each in children(node)])

    for n, statement in enumerate(program.statements):
        numbers = [each for each in walk(statement.value) if isinstance(each, Number)]
        for place in numbers:
            wrong = replace(statement, value=replace_in(statement.value, place))
            changed = [*program.statements]
            changed[n] = wrong
            with pytest.raises(CrossCheckError, match="does not solve its equation"):
                _check(equations, replace(program, statements=tuple(changed)), rates, slopes)
            caught += 1
    assert caught >= 3


def test_numbers_are_exact():
    """A fraction has 40 digits."""
    assert abs(number(Fraction(1, 3)) * 3 - 1) < mp.mpf(10) ** -38


#: A particle on a line whose momentum is bounded; at the declared start its energy has no value.
BOUNDED = """
title = "A bounded momentum"
routes = ["canonical"]
[variables]
x = { role = "coordinate", default = 0 }
p = { role = "momentum", of = "x", default = START }
[hamiltonian]
h = "x^2/2 - sqrt(1 - p^2)"
"""


def test_an_order_of_flows_is_chosen_where_the_start_has_no_energy():
    """Errors are compared at states with an energy; without any, the first order stays."""
    found = {}
    for start in ('"0.5"', "3"):
        spec = read_spec_text(BOUNDED.replace("START", start), "bounded.toml")
        found[start] = find_splitting(derive(spec))
        assert len(found[start].parts) == 2
    assert found['"0.5"'].errors
    assert all(map(isfinite, found['"0.5"'].errors.values()))
    assert not found["3"].errors
