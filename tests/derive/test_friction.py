"""Forces that name reactions, as friction does: solved for with the accelerations, or refused."""

from fractions import Fraction

import pytest

from coadjoint.derive import derive
from coadjoint.derive.domain import bounds
from coadjoint.derive.mechanics.parts import part_names
from coadjoint.errors import DerivationError
from coadjoint.lower.check import check_inverse
from coadjoint.lower.lowering import lower
from coadjoint.prove import Verdict
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.energy import Balance
from tests.constrained import BALL, PENDULUM, ROD, derived
from tests.specs import prove_claims, spec

#: A point of the rod where the roots are rational: cos = 4/5, sin = 3/5, slip 3, eps 4.
AT = {
    **{"x": Fraction(1, 7), "y": Fraction(1, 3), "theta": Fraction(2, 7)},
    **{"u": Fraction(12, 5), "om": Fraction(1, 2), "w": Fraction(4, 5)},
    **{"m": Fraction(3, 2), "I": Fraction(2, 3), "l": Fraction(2), "g": Fraction(7, 5)},
    **{"mu": Fraction(1, 4), "eps": Fraction(4)},
}
COS, SIN = Fraction(4, 5), Fraction(3, 5)


def function(name, value):
    """Functions at the one point."""
    if name == "sqrt":
        return {25: Fraction(5), 9: Fraction(3), 0: Fraction(0)}[value]
    assert value == AT["theta"]
    return {"cos": COS, "sin": SIN}[name]


def rod_by_hand(mu):
    """The normal force and the accelerations of Painleve's rod by Newton's law.

    N follows from the height of the foot, y - l sin(theta), whose second derivative is zero.
    """
    m, I, l, g = (AT[name] for name in ("m", "I", "l", "g"))  # noqa: E741
    share = mu * (AT["u"] + l * SIN * AT["om"]) / 5  # friction over normal force, against the slip
    yields = 1 / m + l**2 / I * COS * (COS + share * SIN)
    N = (g - l * SIN * AT["om"] ** 2) / yields
    torque = -l * N * (COS + share * SIN)
    return N, {"u": -share * N / m, "w": N / m - g, "om": torque / I}, yields


def computed(equations, point):
    """All that the kernel computes at a point, by name."""
    field, known = equations.setting.field, dict(point)
    for name, value in equations.exact.definitions:
        known[name] = field.evaluate(value, known, Fraction, function)
    return known


@pytest.mark.parametrize("route", ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"])
@pytest.mark.parametrize("mu", [AT["mu"], Fraction(-2, 3)])
def test_the_rod_of_painleve_moves_by_newtons_law(route, mu):
    """N, the accelerations and the pivot are those typed by hand; not those of friction -mu."""
    equations = derived(ROD)[route]
    known = computed(equations, AT | {"mu": mu})
    for tried in (mu, -mu):
        N, rates, yields = rod_by_hand(tried)
        right = known["_u1"] == -N and all(known[f"d{v}_dt"] == a for v, a in rates.items())
        (pivot,) = (element for bound, element in bounds(equations) if bound.kind == "reaction")
        value = equations.setting.field.evaluate(pivot, known, Fraction, function)
        assert (right and value == yields) == (tried == mu)


def test_where_the_floor_jams_the_rod_its_pivot_is_not_positive():
    """Painleve's paradox: pushed forwards with large friction the normal force has no solution."""
    slides, jams = (rod_by_hand(mu)[2] for mu in (Fraction(-1), Fraction(-10)))
    assert slides > 0 > jams


def test_all_of_the_rod_is_proved():
    """Both routes agree, energy changes by the power of friction, and no claim is numerical."""
    certificate = prove_claims(spec(ROD))
    texts = {claim.statement: claim for claim in certificate.claims}
    assert all(claim.verdict is Verdict.PROVED for claim in certificate.claims)
    assert "nonholonomic and hamel give the same motion" in texts
    assert "the energy changes by the power of the forces" in texts
    assert any("W U = [[B^T M B, A^T + C], [A, 0]]" in text for text in texts)
    assert any(text.startswith("the motion is not time reversible") for text in texts)


def test_a_wrong_power_is_seen(monkeypatch):
    """Half the power, or none of it, is not what the energy changes by."""
    motion = ConstrainedRates(derive(spec(ROD)))
    assert motion.where.contains(motion.energy_balance())
    power = Balance(motion.equations).power
    for share in (Fraction(0), Fraction(1, 2)):
        monkeypatch.setattr(Balance, "power", power * share)
        assert not motion.where.contains(motion.energy_balance())


@pytest.mark.parametrize("driven", [False, True])
def test_lowering_friction_is_undone_exactly(driven):
    """Every Program gives back what it came from, the Jacobians among them, by inputs too."""
    change = ("mu = { positive = true, default = 3 }", "[inputs]\nmu = { default = 3 }")
    move = ("eps = { positive = true, default = 1 }\n", "")
    changes = [move, (change[0], move[0] + change[1])] if driven else []
    equations = derive(spec(ROD, *changes))
    programs = lower(equations)
    assert {"jacobian", "parameter_jacobian", "domain", "projection"} <= set(programs)
    assert ("input_jacobian" in programs) == driven
    for program in programs.values():
        check_inverse(equations, program)


#: A particle on a wedge of slope a, its friction linear in the velocity u; no functions occur.
WEDGE = (
    ROD.replace(ROD[ROD.index("[definitions]") :], "")
    + """
[lagrangian]
l = "m*(u^2 + w^2)/2 + I*om^2/2 - m*g*y"
[constraints]
wedge = "w - l*y*u == 0"
[forces]
u = "-mu*u*wedge_reaction"
"""
)


def test_the_divergence_of_a_motion_with_friction(monkeypatch):
    """It is the sum of the slopes of the rates; not if the matrix did not depend on velocities."""
    equations = derive(spec(WEDGE))
    motion = ConstrainedRates(equations)
    field, names = motion.field, equations.setting.state
    slopes = [field.derivative(motion.rate(field[name]), name) for name in names]
    assert field.is_zero(motion.divergence - field.sum(slopes))

    def of_side(self, solve, row, velocity):
        return field.derivative(solve.known[row], velocity)

    monkeypatch.setattr(ConstrainedRates, "_slope", of_side)
    assert not field.is_zero(ConstrainedRates(equations).divergence - field.sum(slopes))


def test_rayleighs_function_may_name_reactions():
    """R = mu N sqrt(slip^2 + eps^2) is the friction that the forces declare."""
    text = ROD.replace('[forces]\nu = "F"\nom = "F*l*sin(theta)"\n', "")
    text = text.replace('F = "-mu*floor_reaction*slip/sqrt(slip^2 + eps^2)"\n', "")
    text += '[dissipation]\nR = "mu*floor_reaction*sqrt(slip^2 + eps^2)"\n'
    known = computed(derive(spec(text)), AT)
    N, rates, _ = rod_by_hand(AT["mu"])
    assert known["floor_reaction"] == N
    assert all(known[f"d{v}_dt"] == a for v, a in rates.items())
    motion = ConstrainedRates(derive(spec(text)))
    assert Balance(motion.equations).statement == "the energy changes by -<dR/dxi, xi>"
    assert motion.where.contains(motion.energy_balance())


def test_a_constraint_whose_reaction_a_force_names_is_kept():
    """A ball with rolling friction has Y in its state, and without friction the same motion."""
    pressed = '[forces]\nOmega = "-k*(dot(Gamma, rolling_reaction) + m*g)*Omega"\n'
    parameter = ("[definitions]", "k = { default = 0 }\n[definitions]")
    rough, plain = derive(spec(BALL + pressed, parameter)), derive(spec(BALL))
    assert "Y1" in rough.setting.state
    assert "Y1" not in plain.setting.state
    point = {name: Fraction(n * n + 3, n + 2) for n, name in enumerate(plain.setting.field.names)}
    known = computed(
        plain, {n: point[n] for n in (*plain.setting.state, *plain.setting.parameters)}
    )
    for k, same in ((Fraction(0), True), (Fraction(1, 2), False)):
        at = {n: known[n] for n in (*rough.setting.state, *plain.setting.parameters)}
        found = computed(rough, at | {"k": k})
        assert found["dGamma1_dt"] == known["dGamma1_dt"]
        assert (found["dOmega1_dt"] == known["dOmega1_dt"]) == same
        assert (found["rolling_reaction2"] == known["rolling_reaction2"]) == same


#: A block on a floor; v points upwards.
BLOCK = (
    PENDULUM.replace('rod = "x*u + y*v == 0"', 'floor = "v == 0"')
    + '[definitions]\nlaw = "-m*u"\n[forces]\nu = "law*floor_reaction"\n'
)


@pytest.mark.parametrize(
    ("force", "said", "mended"),
    [
        ('v = "-floor_reaction"', "the forces cancel floor_reaction", 'u = "-floor_reaction"'),
        ('u = "-u*floor_reaction^2"', "not linear in floor_reaction", 'u = "-u*floor_reaction"'),
        ('u = "-norm(vector(floor_reaction, m))"', "are not linear", 'u = "-u*floor_reaction"'),
        ('v = "-floor_reaction"', "Remove floor_reaction from the force", 'v = "-m"'),
    ],
)
def test_what_the_kernel_cannot_solve_for_is_refused_and_the_advice_works(force, said, mended):
    """At the force that is wrong; with what the message advises there is a motion."""
    with pytest.raises(DerivationError, match=said) as caught:
        derive(spec(BLOCK, ('u = "law*floor_reaction"', force)))
    assert f"forces.{force[0]}" in str(caught.value)
    assert caught.value.parts["found"] == "floor_reaction"
    assert derive(spec(BLOCK, ('u = "law*floor_reaction"', mended))).exact.rates


def test_definitions_that_forces_use_are_computed_once():
    """Those without reactions have names of their own, in the order in which they are declared."""
    assert part_names(spec(ROD)) == {"slip": ("_a1",)}
    assert part_names(spec(BLOCK)) == {"law": ("_a1",)}
    assert part_names(spec(BALL)) == {}  # no force
    equations = derived(ROD)["nonholonomic"]
    defined = [name for name, _ in equations.exact.definitions]
    assert defined.index("_a1") < defined.index("_d1")
    field, known = equations.setting.field, dict(equations.exact.definitions)
    assert known["_a1"] == field["u"] + field["l"] * field.call("sin", field["theta"]) * field["om"]


DRY = ("sqrt(slip^2 + eps^2)", "sqrt(slip^2)")
#: On a belt that runs with the speed eps.
BELT = ("sqrt(slip^2 + eps^2)", "sqrt((slip - eps)^2)")
#: A particle with dry friction on a route without constraints, by forces or Rayleigh's function.
SLIDER = """
title = "A particle on a rough plane"
routes = ["euler-lagrange", "canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "q" }
[parameters]
mu = { positive = true, default = 1 }
slow = { default = 1 }
[lagrangian]
l = "dot(v, v)/2 - dot(q, q)/2"
"""
SLIDES = SLIDER + '[forces]\nv = "-mu*v/norm(v)"\n'
LOGS = SLIDER + '[forces]\nv = "mu*log(dot(v, v))*v"\n'
LOSES = SLIDER + '[dissipation]\nR = "mu*norm(v)"\n'


@pytest.mark.parametrize(
    ("text", "changes", "root", "slow"),
    [
        (ROD, [DRY], DRY[1], "sqrt(slip^2 + eps^2)"),
        (ROD, [BELT], BELT[1], "sqrt((slip - eps)^2 + eps^2)"),
        (SLIDES, [], "norm(v)", "sqrt(dot(v, v) + slow^2)"),
        (LOGS, [], "dot(v, v))*v", "dot(v, v) + slow^2)*v"),
        (LOSES, [], "norm(v)", "sqrt(dot(v, v) + slow^2)"),
    ],
)
def test_friction_without_a_slip_speed_or_a_domain_is_refused(text, changes, root, slow):
    """The error points at the force; both its ways out are followed and lead on."""
    with pytest.raises(DerivationError, match="the force has no value where") as caught:
        derive(spec(text, *changes))
    assert caught.value.parts["key"] in ("forces.u", "forces.v", "dissipation.R")
    advice = str(caught.value).partition("or write [domain] with ")[2]
    advice = advice.splitlines()[0].removesuffix(".")
    assert derive(spec(f"{text}[domain]\n{advice}\n", *changes)).exact.rates
    assert derive(spec(text, *changes, (root, slow))).exact.rates


@pytest.mark.parametrize(
    ("condition", "excludes"),
    [
        ("slip > eps", True),
        ("slip >= eps", False),
        ("slip - eps >= 0.01", True),
        ("sqrt((slip - eps)^2) > 0.01", True),
        ("slip > -eps", False),
        ("y > 0", False),
    ],
)
def test_a_domain_excludes_zero_slip_or_does_not(condition, excludes):
    """On the belt zero slip is the speed eps of the foot, and rest is not."""
    declared = spec(f'{ROD}[domain]\nhere = "{condition}"\n', BELT)
    if excludes:
        assert derive(declared).exact.rates
    else:
        with pytest.raises(DerivationError, match="as friction at zero slip"):
            derive(declared)


MOMENTUM = ("[parameters]", 'p = { role = "momentum", of = "q" }\n[parameters]')
HAMILTONIAN = ('l = "dot(v, v)/2 - dot(q, q)/2"', 'h = "dot(p, p)/2 + dot(q, q)/2"')
ONE_ROUTE = ('"euler-lagrange", "canonical"', '"canonical"')


@pytest.mark.parametrize(("least", "excludes"), [("0.01", True), ("-1", False)])
@pytest.mark.parametrize(
    "changes",
    [[MOMENTUM], [MOMENTUM, HAMILTONIAN, ("[lagrangian]", "[hamiltonian]"), ONE_ROUTE]],
    ids=["lagrangian", "hamiltonian"],
)
def test_a_domain_of_momenta_excludes_zero_slip_or_does_not(changes, least, excludes):
    """The momenta at rest are those of the Lagrangian or the Hamiltonian: zero."""
    declared = spec(f'{SLIDES}[domain]\nmoves = "dot(p, p) > {least}"\n', *changes)
    if excludes:
        assert derive(declared).exact.rates
    else:
        with pytest.raises(DerivationError, match="as friction at zero slip"):
            derive(declared)


@pytest.mark.parametrize(
    "force", ["-mu*norm(v)*v", "-mu*v/(norm(v) + slow)", "-q/norm(q)^3", "v/(mu + v1)"]
)
def test_what_has_a_value_at_rest_needs_no_domain(force):
    """Drag grows with the speed; a law of gravitation has a pole at a position."""
    assert derive(spec(SLIDES, ("-mu*v/norm(v)", force))).exact.rates


def test_friction_that_is_not_regularised_excludes_rest():
    """Coulomb's law with |slip| below has no value at rest, which [domain] keeps out."""
    slipping = '[domain]\nslipping = "slip^2 > eps^2"\n'
    equations = derive(spec(ROD + slipping, DRY))
    (condition,) = (element for bound, element in bounds(equations) if bound.name == "slipping")
    field, rest = equations.setting.field, AT | {"u": -2 * SIN / 2}
    assert field.evaluate(condition, rest, Fraction, function) == -16
    assert computed(equations, AT)["_a1"] == 3
    with pytest.raises(ZeroDivisionError):
        computed(equations, rest)
