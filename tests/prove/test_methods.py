"""Methods judged by facts: what each keeps of a system, by its theorem, and on runs."""

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.derive import derive
from coadjoint.exact import element_text
from coadjoint.exact.linear import PRIME
from coadjoint.exact.residues import draw, residue
from coadjoint.lower.lowering import lower
from coadjoint.lower.mapped import lower_maps
from coadjoint.methods import BALANCED, FALLING, GROWING, MAPPED, STRUCTURED
from coadjoint.prove import Certificate
from coadjoint.prove.certificate import Claim, Verdict
from coadjoint.prove.completeness import completeness
from coadjoint.prove.methods import judge_methods
from coadjoint.prove.turned import are_linear_symmetries, with_rotations
from coadjoint.solve.folders import load_texts
from coadjoint.spec.reader import read_spec_text
from coadjoint.systems import galilei, heavy_top, kepler, nambu_body, rigid_body, suslov
from tests.prove.test_completeness import SPIRAL
from tests.prove.test_noise import OSCILLATOR
from tests.solve.test_noisy_orbits import CUBIC
from tests.specs import RIGID_BODY, emitted, lowered, spec

HAMILTONIAN = RIGID_BODY.replace(
    'routes = ["euler-poincare", "lie-poisson"]', 'routes = ["lie-poisson"]'
)
HAMILTONIAN = HAMILTONIAN.replace('Omega = { role = "velocity" }\n', "")
HAMILTONIAN = HAMILTONIAN.replace(
    '[lagrangian]\nl = "dot(Omega, diag(I)*Omega)/2"',
    '[hamiltonian]\nh = "Pi[1]^2/(2*I[1]) + Pi[2]^2/(2*I[2]) + Pi[3]^2/(2*I[3])"',
)
END = "Pi[3]^2/(2*I[3])"
PENDULUM = """
title = "A pendulum with a force"
routes = ["canonical"]
[variables]
q = { role = "coordinate" }
v = { role = "velocity", of = "q" }
p = { role = "momentum", of = "q" }
[parameters]
c = { positive = true, default = 1 }
[hamiltonian]
h = "p^2/2 - cos(q)"
[forces]
v = "FORCE"
"""


def judge(declared):
    """Facts and methods by name, of a spec."""
    equations = derive(declared, declared.routes[0])
    return _judge(equations, lower(equations))


def judge_shipped(name):
    """The same of a shipped system."""
    return _judge(emitted(name), lowered(name))


def _judge(equations, programs, claims=()):
    maps = lower_maps(equations, programs["rhs"])
    certificate = Certificate(equations.spec.name, tuple(claims))
    facts, methods = judge_methods(equations, certificate, programs, maps)
    own = ["heun"] if facts.is_noisy else []
    assert [each.name for each in methods] == [*STRUCTURED, *MAPPED, *own]
    return facts, {each.name: each for each in methods}


def default(methods):
    """The first one in rank, or ""."""
    return next((name for name, each in methods.items() if each.rank == 1), "")


# -- facts, from the textbook forms of these systems ----------------------------------------------


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("rigid_body", ("linear", 2, True, False, False, 1)),
        ("heavy_top", ("linear", 2, False, True, False, 1)),
        ("kepler", ("constant", None, False, True, True, 0)),
        ("galilei", ("linear", 2, False, False, False, 0)),
        ("guiding_centre", ("not affine", None, False, False, False, 0)),
        ("suslov", ("", 2, False, False, False, 0)),
    ],
)
def test_facts_are_those_of_the_book(name, expected):
    """Tensor, degree of the energy, whether it is homogeneous, separable, canonical; spheres."""
    facts, _ = judge_shipped(name)
    found = (facts.tensor, facts.energy_degree)
    assert (found, facts.is_separable, facts.is_canonical) == (expected[:2], *expected[3:5])
    assert len(facts.spheres) == expected[5]
    if expected[2]:
        assert facts.is_energy_homogeneous


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("rigid_body", "spherical_midpoint"),
        ("heavy_top", "splitting4"),
        ("galilei", "isospectral_midpoint4"),
        ("kepler", "splitting4"),
        ("c3_oscillators", "gauss4"),
        ("nambu_body", "midpoint"),
        ("suslov", "gauss4"),
        ("chaplygin_sleigh", "gauss4"),
        ("euler_disk", "discrete_gradient"),
        ("guiding_centre", "discrete_gradient"),
        ("bloch", "discrete_gradient"),
        ("stochastic_rigid_body", "spherical_midpoint"),
    ],
)
def test_the_default_is_that_of_the_matrix(name, expected):
    """One for each kind of system; none where nothing is kept."""
    _, methods = judge_shipped(name)
    assert default(methods) == expected


def test_what_each_method_keeps_of_a_heavy_top():
    """By the theorems: Gauss what is quadratic, actions and flows the Casimirs."""
    _, methods = judge_shipped("heavy_top")
    both = ("casimir1", "casimir2")
    assert methods["gauss4"].exactly == ("energy", *both)
    assert not methods["gauss4"].is_poisson
    for name in ("coadjoint_mean", "spherical_midpoint", "splitting4"):
        assert (methods[name].exactly, methods[name].nearly) == (both, ("energy",)), name
        assert methods[name].is_poisson
    assert methods["kahan"].exactly == ()
    assert (
        methods["exact_body"].decides == "it is no free motion of three components in closed form"
    )


def test_flows_are_asked_what_they_keep():
    """Kicks and drifts keep the angular momentum of Kepler's motion, not its energy."""
    _, methods = judge_shipped("kepler")
    assert methods["splitting4"].exactly == ("L",)
    assert "energy" in methods["splitting4"].nearly


def test_what_discrete_gradients_keep():
    """The energy and quadratic Casimirs; with forces those that these leave."""
    _, top = judge_shipped("heavy_top")
    kept = ("energy", "casimir1", "casimir2")
    assert top["discrete_gradient"].exactly == top["average_gradient"].exactly == kept
    assert not top["discrete_gradient"].is_poisson
    _, disk = judge_shipped("euler_disk")
    assert disk["discrete_gradient"].exactly == ("energy",)
    assert disk["average_gradient"].exactly == ()
    assert "not seen to be a polynomial of degree 10" in disk["average_gradient"].decides
    _, bodies = judge_shipped("complex_rigid_body")
    quadratic = {each.name for each in judge_shipped("complex_rigid_body")[0].integrals
                 if each.is_casimir and each.degree == 2}  # fmt: skip
    assert {*bodies["discrete_gradient"].exactly} == quadratic | {"energy"}
    _, damped = judge_shipped("heavy_top_damped")
    assert damped["discrete_gradient"].exactly == ("casimir1",)  # |Gamma|^2, and not Pi.Gamma
    assert "a step adds h g.f to the energy" in damped["discrete_gradient"].decides
    assert "go back in time" in damped["discrete_gradient4"].decides


@pytest.mark.parametrize(
    ("force", "is_refused"),
    [
        ("-c*v", True),
        ("-c*v^3", True),
        ("-c*v + sin(q)", True),
        ("c*q^2", False),  # by the coordinate alone, whether or not it has a potential
        ("c", False),
    ],
)
def test_friction_that_is_written_as_a_force_refuses_steps_back_in_time(force, is_refused):
    """It shrinks volumes."""
    _, methods = judge(spec(PENDULUM.replace("FORCE", force)))
    for name in ("midpoint4", "midpoint6", "discrete_gradient4"):
        assert ("go back in time" in methods[name].decides) == is_refused, name
    assert methods["discrete_gradient"].rank == 1  # no other method keeps anything


@pytest.mark.parametrize(("force", "first"), [("-c*v[1]", "discrete_gradient"), ("c", "gauss4")])
def test_friction_prefers_the_balance_of_the_energy_to_integrals(force, first):
    """Forces that take no energy by themselves leave the default to what keeps integrals."""
    text = PENDULUM.replace('role = "coordinate"', 'role = "coordinate", shape = [2]')
    text = text.replace("p^2/2 - cos(q)", "dot(p, p)/2 - cos(q[1])")
    text = text.replace("FORCE", f"vector({force}, 0)")
    text += '[observables]\nP = "p[2]"\n[claims]\nconserved = ["P"]\n'
    _, methods = judge(spec(text))
    assert methods["gauss4"].exactly == ("P",)
    assert default(methods) == first


def test_shipped_systems_with_relaxation_refuse_steps_back_in_time():
    """Their forces are not declared as dissipation."""
    for name in ("bloch", "lorenz_gyrostat"):
        _, methods = judge_shipped(name)
        assert "go back in time" in methods["midpoint4"].decides
        assert methods["discrete_gradient"].rank == 1
    _, methods = judge_shipped("quadrotor")
    assert methods["midpoint4"].applies


# -- laws of the energy and the entropy, and inputs -----------------------------------------------


def test_inputs_in_the_energy_are_said_to_take_it():
    """The energy stays while they are constant; a Casimir stays for any inputs."""
    said = "; energy stays only while the inputs are constant"
    driven = HAMILTONIAN.replace(END, f"{END} + u*Pi[1]").replace(
        "[hamiltonian]", "[inputs]\nu = { default = 1 }\n[hamiltonian]"
    )
    _, methods = judge(spec(driven))
    fit = [each for each in methods.values() if each.applies]
    assert {"gauss4", "coadjoint_mean", "discrete_gradient"} <= {each.name for each in fit}
    assert all(each.decides.endswith(said) for each in fit)
    assert methods["gauss4"].exactly == ("energy", "casimir1")
    _, free = judge(spec(HAMILTONIAN))
    assert not [each.name for each in free.values() if "inputs" in each.decides and each.applies]


def test_the_balance_of_the_energy_is_a_law_where_nothing_else_changes_it():
    """Of friction; not where the energy at one state changes with the time or with an input."""
    friction = PENDULUM.replace("FORCE", "-c*v")
    _, methods = judge(spec(friction))
    laws = {name: each.laws for name, each in methods.items() if each.laws}
    assert laws == {"discrete_gradient": (BALANCED,)}  # the mean of a cosine's slopes is none
    assert methods["discrete_gradient"].rank == 1
    _, methods = judge(spec(PENDULUM.replace("FORCE", "c*q^2")))  # no friction: compositions apply
    assert methods["discrete_gradient"].laws == (BALANCED,)
    assert methods["discrete_gradient"].rank == 1  # no other keeps anything
    assert not methods["discrete_gradient4"].laws  # its five steps have middles of their own
    assert methods["discrete_gradient4"].decides.startswith("each of its 5 steps adds h g.f")
    for table, term in (
        ('[time]\nname = "t"', "sin(t)*q"),
        ("[inputs]\nu = { default = 1 }", "u*q"),
    ):
        moved = friction.replace("[hamiltonian]", f"{table}\n[hamiltonian]")
        _, methods = judge(spec(moved.replace("- cos(q)", f"- cos(q) + {term}")))
        assert methods["discrete_gradient"].applies
        assert not methods["discrete_gradient"].laws
        assert "change the energy at a state" in methods["discrete_gradient"].decides
        assert methods["discrete_gradient"].rank == 0


@pytest.mark.parametrize("casimirs", ['["dot(Pi, Pi)"]', "[]"])
def test_a_double_bracket_is_followed_by_its_law_whether_casimirs_are_claimed(casimirs):
    """Its default keeps them; without the proof that G is semidefinite it is a balance alone."""
    text = HAMILTONIAN.replace("[hamiltonian]", '[double_bracket]\nG = "1/5"\n[hamiltonian]')
    text = text.replace('casimirs = ["dot(Pi, Pi)"]', f"casimirs = {casimirs}")
    text = text.replace('conserved = ["energy"]', "conserved = []")
    declared = spec(text)
    equations = derive(declared, declared.routes[0])
    shown = Claim("G is positive semidefinite", "bracket", Verdict.PROVED, "sums of squares")
    for claims, law in (([shown], FALLING), ([], BALANCED)):
        _, methods = _judge(equations, lower(equations), claims)
        assert methods["discrete_gradient"].laws == (law,)
        assert (methods["discrete_gradient"].rank == 1) == (law == FALLING)
        assert not methods["gauss4"].laws


#: A motion on the dual of su(3), whose second Casimir is of degree 3, and one on that of the
#: translations of a plane with spirals, whose Casimir mu3/mu2^a is no polynomial.
RELAXED = '\n[double_bracket]\nG = "1/5"\n'
UNITARY = """
title = "A momentum on the dual of su(3) that loses energy"
routes = ["lie-poisson"]
[algebra]
name = "su(3)"
[variables]
Pi = { role = "momentum" }
[hamiltonian]
h = "(Pi[1]^2 + 2*Pi[2]^2 + 3*Pi[3]^2 + Pi[4]^2 + Pi[5]^2 + 4*Pi[6]^2 + 2*Pi[7]^2 + Pi[8]^2)/2"
"""
UNITARY += RELAXED


@pytest.mark.parametrize(
    ("declared", "expected"),
    [
        (spec(UNITARY), "a Casimir that is found and not claimed is of higher degree, a function "),
        (spec(SPIRAL.replace("{a}", "a") + RELAXED), "0 of 1 independent Casimirs are known"),
    ],
    ids=["found", "not found"],
)
def test_a_double_bracket_with_casimirs_that_are_not_quadratic_is_left_to_choice(
    declared, expected
):
    """No method keeps all its laws: what nobody claims counts, too, and what is not found."""
    equations = derive(declared, declared.routes[0])
    shown = Claim("G is positive semidefinite", "bracket", Verdict.PROVED, "sums of squares")
    _, methods = _judge(equations, lower(equations), [shown])
    found = methods["discrete_gradient"]
    assert (found.laws, found.rank) == ((FALLING,), 0)
    assert f"and never adds to it; {expected}" in found.decides
    assert found.decides.endswith("it is taken by name alone")


def test_a_discrete_gradient_keeps_the_casimir_of_degree_2_and_loses_the_other():
    """On su(3), whatever is claimed; both are read from the search for Casimirs."""
    first = pipeline.render(spec(UNITARY, name="unitary"))
    equations = first.equations
    square, cube = completeness(equations).found
    with load_texts(first.texts) as system:
        run = system.simulate(np.linspace(-0.8, 0.9, 8), (0, 5), step=0.125,
                              method="discrete_gradient", target="numpy")  # fmt: skip
        energy = system.energy(run.state, target="numpy")
    state = dict(zip(equations.setting.state, run.state, strict=True))

    def change(casimir):
        text = element_text(equations.setting.field, casimir).replace("^", "**")
        values = eval(text, {"sqrt": np.sqrt}, state)
        return np.abs(values - values[0]).max() / np.abs(values).max()

    assert change(square) < 1e-14
    assert change(cube) > 1e-5
    assert (np.diff(energy) < 0).all()


def test_entropy_grows_where_its_matrix_is_proved_semidefinite():
    """By the projected gradients, and by methods of Gauss as both functions are quadratic."""
    equations = emitted("metriplectic_body")
    shown = Claim("G is positive semidefinite", "bracket", Verdict.PROVED, "sums of squares")
    _, methods = _judge(equations, lowered("metriplectic_body"), [shown])
    laws = {name: each.laws for name, each in methods.items() if each.laws}
    assert {"metriplectic_gradient", "midpoint", "gauss4"} <= laws.keys()
    assert {*laws.values()} == {(GROWING,)}
    _, methods = judge_shipped("metriplectic_body")
    assert not [each.name for each in methods.values() if each.laws]


# -- facts that are spoiled -----------------------------------------------------------------------


def test_a_cubic_term_takes_the_energy_from_the_midpoint():
    """The energy is no longer of degree 2; the Casimir still is."""
    _, before = judge(spec(HAMILTONIAN))
    assert before["midpoint"].exactly == ("energy", "casimir1")
    assert before["spherical_midpoint"].exactly == ("energy", "casimir1")
    facts, after = judge(spec(HAMILTONIAN, (END, f"{END} + Pi[1]^3")))
    assert "matrix_products" not in facts.as_record()
    assert facts.energy_degree is None
    for name in ("midpoint", "gauss6", "spherical_midpoint"):
        assert (after[name].exactly, after[name].nearly) == (("casimir1",), ("energy",)), name


def test_a_linear_term_takes_the_energy_from_the_spherical_midpoint_alone():
    """A gyrostat's energy is quadratic and not homogeneous."""
    _, methods = judge(spec(HAMILTONIAN, (END, f"{END} + Pi[1]")))
    assert methods["midpoint"].exactly == ("energy", "casimir1")
    assert methods["spherical_midpoint"].exactly == ("casimir1",)


def test_another_algebra_takes_the_spheres():
    """On sl(2,R) orbits are no spheres, and the method of matrices with products is the default."""
    changed = ('name = "so(3)"', 'name = "sl(2,R)"')
    casimir = ('casimirs = ["dot(Pi, Pi)"]', "")
    facts, methods = judge(spec(HAMILTONIAN, changed, casimir))
    assert facts.spheres == ()
    assert not methods["spherical_midpoint"].applies
    assert methods["spherical_midpoint"].decides.startswith("it expects a motion")
    assert default(methods) == "isospectral_midpoint4"
    assert facts.as_record()["matrix_products"] is True
    assert "matrices with all products B A B" in methods["isospectral_midpoint"].decides
    assert "matrices" not in methods["coadjoint_mean"].decides


def test_friction_takes_the_bracket():
    """Methods of orbits do not apply, and the Casimir that friction keeps decides."""
    damped = f'{HAMILTONIAN}\n[double_bracket]\nG = "0.1"\n'
    _, methods = judge(spec(damped))
    assert not methods["coadjoint_mean"].applies
    assert (methods["gauss4"].exactly, methods["gauss4"].nearly) == (("casimir1",), ())
    assert default(methods) == "gauss4"


# -- noise ----------------------------------------------------------------------------------------

#: A body with an axis of symmetry, and noise about it, which keeps the energy and what turns.
ALONG = HAMILTONIAN.replace("I[2]", "I[1]")
ALONG = ALONG.replace("[claims]", '[observables]\nL = "Pi[3]"\n[noise]\ndW1 = "Pi[3]/2"\n[claims]')
ALONG += 'conserved = ["L"]\n'
ACROSS = ALONG.replace("[claims]", 'dW2 = "Pi[1]"\n[claims]')


def list_exactly(methods):
    """What each method keeps exactly, of those that apply."""
    return {name: {*each.exactly} for name, each in methods.items() if each.applies}


def test_noise_has_methods_of_its_own():
    """All others name them."""
    _, methods = judge_shipped("stochastic_rigid_body")
    reasons = {each.decides for each in methods.values() if not each.applies}
    own = "heun, spherical_midpoint, coadjoint_mean, midpoint"
    assert reasons == {f"motions with noise have methods of their own: {own}"}
    kept = list_exactly(methods)
    assert kept.pop("heun") == set()
    assert kept.keys() == {"midpoint", "coadjoint_mean", "spherical_midpoint"}
    assert all(each == {"casimir1"} for each in kept.values())
    maps = [name for name, each in methods.items() if each.is_poisson]
    assert maps == ["coadjoint_mean", "spherical_midpoint"]


def test_noise_that_takes_an_integral_takes_it_from_methods():
    """Noise about the axis keeps all three; another process leaves the Casimir alone."""
    _, methods = judge(spec(ALONG))
    along = list_exactly(methods)
    assert along["midpoint"] == {"energy", "L", "casimir1"}
    assert along["heun"] == {"L"}  # which is linear
    assert along["spherical_midpoint"] == along["coadjoint_mean"] == {"L", "casimir1"}
    _, methods = judge(spec(ACROSS))
    across = list_exactly(methods)
    assert across.pop("heun") == set()
    assert all(each == {"casimir1"} for each in across.values())


def test_a_torque_takes_orbits_from_methods_with_noise():
    """No step is the action of an element then, and no Casimir is kept."""
    forces = '[inputs]\nu = { shape = [3] }\n[forces]\nPi = "u"\n[noise]'
    _, methods = judge(spec(ACROSS.replace("[noise]", forces)))
    assert list_exactly(methods) == {"midpoint": set(), "heun": set()}
    assert "in the state, and noise by brackets" in methods["coadjoint_mean"].decides
    assert default(methods) == ""


def test_a_map_of_the_bracket_is_preferred_with_noise():
    """It keeps a cubic Casimir that nobody named; that of a constant tensor is the midpoint."""
    _, cubic = judge(read_spec_text(CUBIC, "cubic.toml"))
    assert default(cubic) == "coadjoint_mean"
    assert not cubic["midpoint"].rank
    facts, shaken = judge(read_spec_text(OSCILLATOR, "shaken.toml"))
    assert (facts.tensor, shaken["midpoint"].is_poisson) == ("constant", True)
    assert not shaken["heun"].is_poisson
    assert default(shaken) == "midpoint"


@pytest.mark.parametrize(("process", "order"), [("3*Pi[3]", 1), ("Pi[1]", 0.5)])
def test_paths_have_order_1_where_all_processes_are_proved_to_commute(process, order):
    """Two about one axis, and two that do not commute."""
    text = ALONG.replace("[claims]", f'dW2 = "{process}"\n[claims]').replace(
        'conserved = ["L"]\n', ""
    )
    rendered = pipeline.render(spec(text))
    assert {each.order for each in rendered.methods if each.applies} == {order}
    _, alone = judge(spec(ALONG))
    assert alone["midpoint"].order == 1
    _, unproved = judge(spec(text))  # without a certificate
    assert unproved["midpoint"].order == 0.5


def test_states_that_are_moved_take_quadratic_integrals():
    """Two pendulums on rods: after each step positions are moved onto spheres."""
    facts, methods = judge_shipped("double_spherical_pendulum")
    assert facts.is_moved
    assert methods["gauss4"].exactly == ()
    assert "the state is moved" in methods["gauss4"].decides


NAMBU = """
title = "Nambu's bracket of a quartic function"
routes = ["nambu"]
[poisson]
nambu = ["x1^4/4 + x2^2/2 + x3^2/2"]
[variables]
x = { role = "coordinate", shape = [3] }
[hamiltonian]
h = "x1^2/2 + cos(x2) + x3"
[claims]
casimirs = ["x1^4/4 + x2^2/2 + x3^2/2"]
"""


def test_nambus_gradient_keeps_both_functions():
    """The default where they are not quadratic; the discrete gradient keeps the energy alone."""
    _, methods = judge(spec(NAMBU))
    assert default(methods) == "nambu_gradient"
    assert methods["nambu_gradient"].exactly == ("energy", "casimir1")
    assert not methods["nambu_gradient4"].is_poisson
    assert methods["discrete_gradient"].exactly == ("energy",)
    _, body = judge_shipped("rigid_body")
    assert "Nambu's bracket alone" in body["nambu_gradient"].decides


# -- on runs --------------------------------------------------------------------------------------

RUNS = {
    "rigid_body": (rigid_body, [0.5, 0.3, 0.9], {"I": [2.0, 1.0, 2 / 3]}),
    "heavy_top": (
        heavy_top,
        [0.4, -0.3, 1.2, 0.6, 0.0, 0.8],
        {"I": [1.0, 1.3, 0.6], "m": 1.0, "g": 1.0, "chi": [0.1, 0.2, 0.6]},
    ),
    "kepler": (kepler, [1.0, 0.0, 0.0, 0.0, 1.1, 0.2], {"mu": 1.0}),
    "nambu_body": (nambu_body, [0.5, 0.3, 0.9], None),
    "galilei": (galilei, np.linspace(0.2, 0.9, galilei.system.STATE.size), None),
    "suslov": (suslov, [0.429, -0.084, 0.0], None),
}
#: An integral that is not kept is missed by more after so many steps.
STEPS, ROUNDING = 24, 1e-12
#: Energies that the mean of a gradient misses by little, of longer steps: they are no polynomials.
LONGER = {("kepler", "average_gradient"): 0.25}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.campaign] * (n == "galilei")) for n in RUNS]
)
def test_what_is_kept_exactly_stays_on_runs(name):
    """Drifts at rounding of all that a method keeps, and above it of all that it does not."""
    system, start, parameters = RUNS[name]
    methods = system.system.METHODS
    assert {each.name for each in methods} >= {"midpoint", "midpoint4", "gauss4"}
    compared = 0
    for method in methods:
        step = LONGER.get((name, method.name), 0.125)
        span = (0, step * STEPS)
        run = system.simulate(
            start, span, parameters, method=method.name, step=step, samples=41, target="numpy"
        )
        assert run.status == "OK", method.name
        assert {*method.exactly, *method.nearly} == {*run.drift}
        for integral in method.exactly:
            assert run.drift[integral] < ROUNDING, (method.name, integral)
        for integral in method.nearly if method.order == 2 else ():
            least = 1e-9 if step == 0.125 else 2e-12
            assert run.drift[integral] > least, (method.name, integral)
        compared += len(run.drift)
    assert compared >= len(methods)


def find_defect(system, start, parameters, method, step=0.3):
    """How far a step is from a Poisson map: ``max |D J D^T - J|`` by differences."""
    start, eps, n = np.array(start), 1e-5, len(start)

    def flow(x):
        options = {"method": method, "step": step, "samples": 1, "target": "numpy"}
        run = system.simulate(x, (0, step), parameters, **options)
        return run.state[..., -1]

    shifts = eps * np.eye(n)
    both = flow(start[:, np.newaxis] + shifts), flow(start[:, np.newaxis] - shifts)
    slope = (both[0] - both[1]) / (2 * eps)
    tensor = system.poisson_tensor(start, parameters)
    return np.abs(slope @ tensor @ slope.T - system.poisson_tensor(flow(start), parameters)).max()


@pytest.mark.parametrize("name", ["rigid_body", "heavy_top", "kepler", "galilei"])
def test_poisson_maps_are_those_that_are_said_to_be(name):
    """Claimed ones to the error of differences, others above 1e-6."""
    system, start, parameters = RUNS[name]
    found = {each.name: find_defect(system, start, parameters, each.name) for each in
             system.system.METHODS if each.order < 6}  # fmt: skip
    for method in system.system.METHODS:
        if method.is_poisson and method.name in found:
            assert found[method.name] < 1e-9, method.name
        elif method.order == 2:
            assert found[method.name] > 1e-6, method.name
    assert len(found) >= 5


def test_a_wrong_claim_would_be_seen():
    """RK4 in place of the methods that keep the Casimir: its drift is far above rounding."""
    run = rigid_body.simulate([0.5, 0.3, 0.9], (0, 50), method="rk4", step=0.125, samples=41)
    assert min(run.drift.values()) > 1e3 * ROUNDING


def test_the_element_of_a_step_turns_attitudes_with_the_momentum():
    """So the coadjoint mean keeps the momentum in space; methods of Gauss do so only nearly."""
    _, methods = judge_shipped("rigid_body_attitude")
    assert methods["coadjoint_mean"].exactly == ("casimir1", "Pi_spatial")
    assert methods["coadjoint_mean"].nearly == ("energy",)
    assert "Pi_spatial stays" in methods["coadjoint_mean"].decides
    assert "Pi_spatial" in methods["midpoint"].nearly
    assert "Pi_spatial" in methods["discrete_gradient"].nearly


def test_vectors_that_the_energy_names_are_no_element_of_the_group():
    """The momentum in space of a free body stays by all elements, that of a top by no method."""
    facts, _ = judge_shipped("rigid_body_attitude")
    spatial = next(each for each in facts.integrals if each.name == "Pi_spatial")
    assert facts.is_kept_by_action(spatial.values)
    assert not facts.is_kept_by_tensor(spatial.values)
    assert not facts.is_kept_by_action([facts.energy])


IN_A_FIELD = (
    RIGID_BODY.replace('routes = ["euler-poincare", "lie-poisson"]', 'routes = ["lie-poisson"]')
    .replace('Omega = { role = "velocity" }\n', 'R = { role = "attitude" }\n')
    .replace(
        '[lagrangian]\nl = "dot(Omega, diag(I)*Omega)/2"',
        '[hamiltonian]\nh = "Pi[1]^2/(2*I[1]) + Pi[2]^2/(2*I[2]) + Pi[3]^2/(2*I[3])'
        ' + R[3, 1] - R[3, 3]"',
    )
)


def with_momentum(text):
    """The spec with the momentum along the third axis of space, which the field leaves."""
    along = 'J = "R[3, 1]*Pi[1] + R[3, 2]*Pi[2] + R[3, 3]*Pi[3]"'
    return text[: text.index("[claims]")] + (
        f'[observables]\n{along}\n\n[claims]\nconserved = ["energy", "J"]\n'
    )


def test_symmetries_of_a_field_keep_the_momentum_along_it():
    """A heavy body with its attitude: the momentum in space along the field, and no other one."""
    facts, methods = judge(spec(with_momentum(IN_A_FIELD)))
    assert "J" in methods["coadjoint_mean"].exactly
    assert "J" in methods["coadjoint_mean4"].exactly
    assert "J" in methods["splitting"].exactly
    assert "J" in methods["discrete_gradient"].nearly
    along, across = (
        sum((facts.field[f"R{n}{k}"] * facts.field[f"Pi{k}"] for k in (1, 2, 3)), facts.field.zero)
        for n in (3, 1)
    )
    assert are_linear_symmetries(facts, [along])
    assert not are_linear_symmetries(facts, [across])
    assert not are_linear_symmetries(facts, [along * along])  # kept as well, and not linear


def test_symmetries_on_rotations_alone_are_none():
    """A mean of rotations is no rotation: the energy has to have the symmetry there, too."""
    more = IN_A_FIELD.replace("- R[3, 3]", "- R[3, 3] + R[1, 1]^2 + R[1, 2]^2 + R[1, 3]^2")
    _, methods = judge(spec(with_momentum(more)))
    assert "J" in methods["coadjoint_mean"].nearly


def test_points_have_rotations():
    """Of matrices and quaternions."""
    q = SimpleNamespace(turning="quaternion", components=("q0", "q1", "q2", "q3"))
    variables = [*emitted("orbiting_body").spec.turning, q]
    number = partial(residue, prime=PRIME)
    names = [name for each in variables for name in each.components]
    at = with_rotations(variables, {name: draw(name) for name in names}, number)
    pose = variables[0]
    R = [[at[pose.components[4 * i + j]] for j in range(3)] for i in range(3)]
    for i in range(3):
        for j in range(3):
            product = sum((a * b for a, b in zip(R[i], R[j], strict=True)), number(0))
            assert product == number(int(i == j))
    assert sum((at[x] * at[x] for x in q.components), number(0)) == number(1)
    assert at[pose.components[3]] == draw(pose.components[3])  # where the body is stays
