"""Equations by vectors are those of the books, and are not found where a component is spoiled."""

from __future__ import annotations

from dataclasses import replace

import pytest

from coadjoint.derive import derive
from coadjoint.derive.document import document
from coadjoint.derive.mechanics.noise import noise_fields
from coadjoint.derive.vectors import vector_form
from coadjoint.derive.vectors.affine import affine_lines
from coadjoint.derive.vectors.attitudes import drop_rotations
from coadjoint.derive.vectors.balance import (
    balance_lines,
    is_derived,
    momentum_balance,
    speeds_of,
)
from coadjoint.derive.vectors.brackets import (
    commutator_lines,
    plane_lines,
    weigh_commutators,
)
from coadjoint.derive.vectors.gradients import gradient, total_of
from coadjoint.derive.vectors.recognise import recognise
from coadjoint.derive.vectors.vocabulary import evaluate
from coadjoint.derive.vectors.words import make_vocabulary
from coadjoint.notation.trees import write_tree
from coadjoint.notation.written import add
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.tree import Call, Name
from coadjoint.spec.reader import read_spec_text
from tests.specs import emitted

#: Lines as they are printed. Those up to the first comment stand in the sources letter by letter:
#: Holm (2011), Geometric Mechanics II, 2nd ed., 2.4 (rigid body), 2.4.3 (so(n)), 7.2, 8.2, 10.1,
#: 12.1.2 and appendices; of the others `test_books` compares the sources' formulas.
BOOKS = {
    "rigid_body": ["dPi/dt = Pi x Omega"],
    "heavy_top": ["dPi/dt = Pi x Omega + m g Gamma x chi", "dGamma/dt = Gamma x Omega"],
    "kirchhoff": ["dPi/dt = Pi x Omega + P x v", "dP/dt = P x Omega"],
    "kirchhoff_clebsch": ["dPi/dt = Pi x Omega + P x v", "dP/dt = P x Omega"],
    "so4_body": ["dM/dt = M x Omega + N x Lambda", "dN/dt = N x Omega + M x Lambda"],
    "so5_body": ["dM/dt = [M, Omega]", "Omega = dh/dM"],
    "kepler": ["dr/dt = v", "dv/dt = -mu r/|r|^3"],
    "spin_chain": ["dXi/dt = Omega_s + Xi x Omega"],
    "heisenberg_lattice": ["dS[i]/dt = J S[i] x S[i+1] + J S[i] x S[i-1]"],
    "n_body": ["dp[i]/dt = -sum(j, j != i, G m[i] m[j] (r[i] - r[j])/|r[i] - r[j]|^3)"],
    "chaplygin_ball": [
        "d(diag(I) Omega)/dt = lambda x s + (diag(I) Omega) x Omega + m g Gamma x chi",
        "d(m Y)/dt = lambda + m Y x Omega",
        "Y = Omega x s",
        "s = r Gamma + chi",
    ],
    "stochastic_rigid_body": [
        "dPi = (Pi x Omega) dt + (Pi x (sigma1, 0, 0)) o dW1"
        " + (Pi x (0, sigma2, 0)) o dW2 + (Pi x (0, 0, sigma3)) o dW3"
    ],
    # what the sources write in another order or by other letters
    "affine_line": ["dmu/dt = mu2 J xi", "J = rows((0, -1), (1, 0))", "mu = xi"],
    "galilei": ["dE/dt = a . P"],
    "heavy_top_damped": ["dPi/dt = tau - diag(d) Omega + Pi x Omega + m g Gamma x chi"],
    "kapitza_top": ["dPi/dt = m (g - a w^2 cos(w t)) Gamma x chi + Pi x Omega"],
    "two_field_top": ["dPi/dt = Pi x Omega + (a, 0, 0) x R1 + (0, b, 0) x R2"],
    "coupled_bodies": [
        "dPi1/dt = epsilon (A w2) x w1 + Pi1 x Omega1",
        "dPi2/dt = epsilon (A^T w1) x w2 + Pi2 x Omega2",
        "dA/dt = A hat(Omega2) - hat(Omega1) A",
    ],
    "quadratic_potential_so3": ["dM/dt = [M, Omega] + [diag(a), S]", "dS/dt = [S, Omega]"],
    "ellipsoidal_motion": ["dQ/dt = P", "dP/dt = b Q^-T/det(Q) - k Q"],
    "spd_motion": ["dS/dt = S P S", "dP/dt = -P S P - 1/2 p (x) p", "dq/dt = S p"],
    "sphere_vortices": [
        "dx[i]/dt = sum(j, j != i, Gamma[j] x[j] x x[i]/(4 pi R (R^2 - x[i] . x[j])))"
    ],
    "se3_strand": [
        "dPi/dt = diag(K) k_s + e x (diag(A) d) + Pi x Omega + k x (diag(K) k)",
        "dP/dt = diag(A) d_s + k x (diag(A) d) + P x Omega",
        "dk/dt = Omega_s + k x Omega",
        "de/dt = v_s + e x Omega + k x v",
    ],
    "sp2_strand": ["dM/dt = S_s + [N, T^2] + [S^2, N]", "dS/dt = T_s + T N S - S N T"],
    "two_time_body": [
        "dPi/dt = diag(K) Xi_s - diag(B) Omega_s + Pi x Omega"
        " + (diag(B) Omega) x Xi + Xi x (diag(K) Xi)"
    ],
    "quadrotor": [
        "dP/dt = m g down - (0, 0, f) + P x Omega",
        "ddown/dt = down x Omega",
        "dGamma4/dt = v . down",
    ],
    "zeitlin_su_4": ["dW/dt = [W, V]", "w[k] = -trace(W E[k])", "V = sum(k, Psi[k] E[k])"],
    "euler_2d": [
        "dw/dt = {psi, w}",
        "{psi, w} = psi_x w_y - psi_y w_x",
        "w = -Laplacian psi",
    ],
    "veselova": ["d(diag(I) Omega)/dt = lambda Gamma + (diag(I) Omega) x Omega"],
    "tippe_top": [
        "d(I1 Omega1, I1 Omega2, I3 Omega3)/dt = F x s + (I1 Omega1, I1 Omega2, I3 Omega3) x Omega"
        " + lambda Gamma x s + m g Gamma x s",
        "d(m Y)/dt = F + lambda Gamma + m Y x Omega",
        "0 = Gamma . v",
        "N = lambda + m g",
        "F = -N drag v",
    ],
    "ball_on_turntable": [
        "d(I omega)/dt = (r lambda2, -r lambda1, 0)",
        "d(m v)/dt = lambda",
        "dx/dt = v",
    ],
    "ball_in_sphere": [
        "d(I omega)/dt = r n x lambda/a",
        "d(m a^2 vn)/dt = lambda - (0, 0, m g a)",
        "vn = r n x omega/a",
    ],
    "body_of_revolution": [
        "d(m Y)/dt = lambda + m Y x Omega",
        "Y = Omega x s",
    ],
    "double_spherical_pendulum": [
        "d(m1 l1^2 v1 + m2 l1 (l1 v1 + l2 v2))/dt = lambda1 gamma1 - (0, 0, m1 g l1 + m2 g l1)",
        "d(m2 l2 (l1 v1 + l2 v2))/dt = lambda2 gamma2 - (0, 0, m2 g l2)",
        "0 = gamma1 . v1",
    ],
    "suslov_so5": ["d(j w + diag(K) w)/dt = (w . k) w - (w . w) k", "u = 0"],
    "n_particles": [
        "dv1/dt = m2 G (r2 - r1)/|r2 - r1|^3 + m3 G (r3 - r1)/|r3 - r1|^3",
        "dv3/dt = -m1 G (r3 - r1)/|r3 - r1|^3 - m2 G (r3 - r2)/|r3 - r2|^3",
    ],
    "orbiting_body": [
        "dPi/dt = 3 mu y x (diag(I) y)/|x|^5 + Pi x Omega",
        "dP/dt = 15 mu (x . z) y/(2 |x|^7) - 3 mu diag(I) y/|x|^5"
        " - 3 mu (I1 + I2 + I3) y/(2 |x|^5) - m mu y/|x|^3 + P x Omega",
        "dR/dt = R hat(Omega)",
        "dx/dt = R v",
    ],
    "elastic_chain": [
        "dx[i]/dt = R[i] P[i]/m",
        "dP[i]/dt = k[i] - R[i]^T R[i-1] k[i-1] + P[i] x (diag(I)^(-1) Pi[i])",
        "k[i] = diag(C) (R[i]^T (x[i+1] - x[i])/a - (0, 0, 1))",
    ],
    "spin_chain_lattice": [
        "dR[i]/dt = R[i] hat(diag(I)^(-1) Pi[i])",
        "dPi[i]/dt = vee(R[i]^T R[i+1] diag(n) - diag(n) R[i+1]^T R[i])/(2 a^2)"
        " + vee(R[i]^T R[i-1] diag(n) - diag(n) R[i-1]^T R[i])/(2 a^2)"
        " + Pi[i] x (diag(I)^(-1) Pi[i])",
        "n = (K2 + K3 - K1, K3 + K1 - K2, K1 + K2 - K3)",
    ],
    "sl2_r2": ["dmu/dt = [A^T, mu] - p (x) v + 1/2 (p . v) diag(1, 1)", "dp/dt = A^T p"],
    "se2_pendulum": ["db/dt = -m J b", "J = rows((0, -1), (1, 0))"],
    "sp2_momentum": ["dX/dt = (X2, X1, -2 X3) x (k + b X1, 1/m, 0)"],
    "maxwell_bloch": ["dx/dt = (0, x2, x3) x (x1, 0, 1)"],
    "c3_oscillators": ["dq/dt = (w1 p1, w2 p2, w3 p3) + (c p2, c p1, 0) + k (q x p) x q"],
    "veselova_so4": [
        "d(M/2 + N/2)/dt = rotate(Gamma^*, lambda)/(Gamma . Gamma) + 1/2 U x M + 1/2 U x N",
    ],
}


def lines(form):
    """The lines of a form as text."""
    shown = ((form.shapes, form.written),) * len(form.lines)
    return [
        f"{write_tree(line.left, *names).text} = {add([write_tree(line.right, *names)]).text}"
        for line, names in zip(form.lines, shown, strict=True)
    ]


@pytest.mark.parametrize("system", BOOKS)
def test_vector_equations_are_those_of_the_books(system):
    """Each line that its source prints is found."""
    found = lines(vector_form(emitted(system)))
    assert [line for line in BOOKS[system] if line not in found] == []


def test_the_latex_of_the_heavy_top_is_the_books():
    """Bold letters, a dot over the letter alone, and no braces too many."""
    form = vector_form(emitted("heavy_top"))
    first = form.lines[0]
    left, right = (write_tree(node, form.shapes).latex for node in (first.left, first.right))
    assert left == r"\dot{\boldsymbol{\Pi}}"
    assert right == (
        r"\boldsymbol{\Pi} \times \boldsymbol{\Omega} + "
        r"m\,g\,\boldsymbol{\Gamma} \times \boldsymbol{\chi}"
    )


def spoil(equations, place):
    """Equations with the sign of one rate turned."""
    rates = list(equations.exact.rates)
    rates[place] = -rates[place]
    return replace(equations, exact=replace(equations.exact, rates=tuple(rates)))


@pytest.mark.parametrize("system", ["rigid_body", "so4_body", "kepler", "so5_body"])
@pytest.mark.parametrize("place", [0, -1])
def test_no_line_is_printed_for_a_spoiled_component(system, place):
    """One wrong sign, and the equation of its vector is not there."""
    equations = emitted(system)
    spoiled = vector_form(spoil(equations, place))
    name = vector_form(equations).lines[0 if place == 0 else len(spoiled.missing) - 1].left
    assert len(spoiled.missing) == 1
    assert not any(line.left == name for line in spoiled.lines) or place == -1
    whole = {line.left for line in vector_form(equations).lines}
    assert len([line for line in spoiled.lines if line.left in whole]) < len(whole)


def test_a_part_is_printed_only_if_its_own_components_are_right():
    """With the strain's fifth rate spoiled the rod keeps its turns and loses its steps."""
    equations = emitted("se3_strand")
    place = equations.variables.index("X5")
    spoiled = vector_form(spoil(equations, place))
    found = [line.split(" = ")[0] for line in lines(spoiled)]
    assert "dk/dt" in found
    assert "de/dt" not in found
    assert spoiled.missing == ("X4", "X5", "X6")
    text = document(spoil(equations, place)).sections[0].law
    assert "those of X4, X5, X6 in components" in text


def test_a_derivative_along_space_is_that_of_the_matrix_that_is_printed():
    """Off the diagonal the strain of Sp(2) is half of its component, and so is its slope."""
    equations = emitted("sp2_strand")
    field, values = equations.setting.field, make_vocabulary(equations).values
    assert values["S"][0][1] == field["S12"] / 2
    assert values["S_s"][0][1] == field["S12_s"] / 2


def test_a_commutator_is_printed_only_if_every_component_is_one():
    """Each of the 15 rates decides alone."""
    equations = emitted("zeitlin_su_4")
    (momentum,) = equations.spec.having_role("momentum")
    assert len(commutator_lines(equations, momentum)) == 3
    own = equations.setting.field["w4"]  # the first three rates are 0 once velocities are put in
    for place in range(15):
        rates = [r + own if n == place else r for n, r in enumerate(equations.exact.rates)]
        spoiled = replace(equations, exact=replace(equations.exact, rates=tuple(rates)))
        assert commutator_lines(spoiled, momentum) == [], place


def test_no_commutator_stands_where_traces_do_not_see_the_algebra():
    """The affine group's nilpotent matrix has the trace 0 with every other."""
    equations = emitted("affine_line")
    (momentum,) = equations.spec.having_role("momentum")
    assert commutator_lines(equations, momentum) == []
    assert weigh_commutators([{(0, 0): 1}, {(0, 1): 1}]) == []


def test_no_commutator_stands_for_the_momentum_of_a_coordinate():
    """Which no matrices turn: there is no algebra."""
    text = """title = "C"
routes = ["canonical"]
[variables]
x = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "x" }
p = { role = "momentum", of = "x" }
[parameters]
b = { positive = true }
[lagrangian]
l = "dot(v, v)/2 + exp(-x1^2 - x2^2/b^2)"
"""
    equations = derive(read_spec_text(text, "sample.toml"))
    (momentum,) = equations.spec.having_role("momentum")
    assert commutator_lines(equations, momentum) == []


def test_a_jacobian_is_printed_only_if_it_is_the_rate():
    """With the other sign there is none."""
    equations = emitted("euler_2d")
    assert len(plane_lines(equations)) == 3
    assert plane_lines(spoil(equations, 0)) == []


@pytest.mark.parametrize("process", [0, 1, 2])
def test_no_line_is_printed_for_spoiled_noise(process, monkeypatch):
    """One wrong sign in what a process does, and the equation is not there."""
    equations = emitted("stochastic_rigid_body")
    assert not vector_form(equations).missing
    fields = list(noise_fields(equations.setting))
    own = fields[process]
    place = next(n for n, value in enumerate(own.field) if value)
    moved = tuple(-v if n == place else v for n, v in enumerate(own.field))
    fields[process] = replace(own, field=moved)
    monkeypatch.setattr("coadjoint.derive.vectors.form.noise_fields", lambda _: tuple(fields))
    spoiled = vector_form(equations)
    assert spoiled.missing == ("Pi",)


def test_components_of_a_motion_with_noise_have_it():
    """As Pi x sigma_k e_k gives by hand."""
    motion = document(emitted("stochastic_rigid_body")).sections[0]
    assert "Stratonovich" in motion.law
    assert [line.text for line in motion.lines] == [
        "dPi1 = (Pi2*Omega3 - Pi3*Omega2) dt - sigma2 Pi3 o dW2 + sigma3 Pi2 o dW3",
        "dPi2 = (-Pi1*Omega3 + Pi3*Omega1) dt + sigma1 Pi3 o dW1 - sigma3 Pi1 o dW3",
        "dPi3 = (Pi1*Omega2 - Pi2*Omega1) dt - sigma1 Pi2 o dW1 + sigma2 Pi1 o dW2",
        "Omega1 = Pi1/I1",
        "Omega2 = Pi2/I2",
        "Omega3 = Pi3/I3",
    ]


def test_short_names_are_shown_by_short_names():
    """Definitions of the tippe top name one another, as in the spec, and so does what is seen."""
    sections = {each.title: each for each in document(emitted("tippe_top")).sections}
    found = [line.text for line in sections["Definitions"].lines]
    assert found[2:] == [
        "drag = viscous + coulomb/sqrt(v . v + slow^2)",
        "N = lambda + m g",
        "F = -N drag v",
    ]
    seen = [line.text for line in sections["Casimirs, observables and momentum maps"].lines]
    assert "friction = F" in seen


def test_what_is_printed_is_evaluated_once_more():
    """A vocabulary whose words have wrong values prints nothing, though a search succeeds."""
    vocabulary = make_vocabulary(emitted("rigid_body"))
    (target,) = vocabulary.targets
    assert recognise(vocabulary, target.value)
    vocabulary.values = {**vocabulary.values, "Omega": vocabulary.values["Pi"]}
    assert recognise(vocabulary, target.value) is None


def test_a_balance_is_shown_only_if_it_is_what_the_kernel_solves():
    """Lagrange and d'Alembert's law passes; with one component's sign turned it does not."""
    equations = emitted("chaplygin_ball")
    left, right = momentum_balance(equations)
    assert is_derived(equations, left, right)
    for place in range(len(right)):
        wrong = [-side if n == place else side for n, side in enumerate(right)]
        assert not is_derived(equations, left, wrong), place


@pytest.mark.parametrize("system", ["ball_in_sphere", "double_spherical_pendulum", "suslov_so5"])
def test_balances_of_coordinates_are_those_that_the_kernel_solves(system):
    """Next to an algebra, without one, and with velocities at rest; a turned sign is seen."""
    equations = emitted(system)
    left, right = momentum_balance(equations)
    assert is_derived(equations, left, right)
    for place in (place for place, side in enumerate(right) if side):
        wrong = [-side if n == place else side for n, side in enumerate(right)]
        assert not is_derived(equations, left, wrong), place


#: A body that cannot turn about its third axis: one component of a velocity rests.
SUSLOV = """
title = "Suslov's body under a vertical"
routes = ["nonholonomic"]

[algebra]
name = "so(3)"

[variables]
Omega = { role = "velocity" }
Gamma = { role = "advected", representation = "vector" }

[parameters]
I = { shape = [6], form = "symmetric" }

[lagrangian]
l = "dot(Omega, I*Omega)/2 - Gamma1"

[constraints]
axis = "Omega3 == 0"
"""


def test_one_component_at_rest_is_no_whole_velocity_at_rest():
    """What is known of the rest by vectors is shown, and nothing is said of the whole velocity."""
    form = vector_form(derive(read_spec_text(SUSLOV, "suslov_top")))
    assert lines(form) == ["dGamma/dt = Gamma x Omega"]


@pytest.mark.parametrize("place", range(5))
def test_affine_motion_is_printed_only_if_every_component_is_right(place):
    """Those of the matrix mu, and those of the vector p."""
    equations = emitted("sl2_r2")
    assert len(affine_lines(equations)[0]) == 4
    assert affine_lines(spoil(equations, place)) == ([], frozenset())


def test_no_affine_motion_is_found_where_the_linear_part_is_not_all_of_it():
    """The rotations are a part of the matrices without a trace."""
    assert affine_lines(emitted("kirchhoff")) == ([], frozenset())


@pytest.mark.parametrize(
    ("system", "component", "lost"),
    [
        ("n_particles", "v12", "dv1/dt"),
        ("orbiting_body", "g12", "dR/dt"),
        ("orbiting_body", "g14", "dx/dt"),
        ("orbiting_body", "Pi3", "dPi/dt"),
        ("se2_pendulum", "b1", "db/dt"),
        ("sp2_momentum", "X3", "dX/dt"),
        ("c3_oscillators", "q2", "dq/dt"),
    ],
)
def test_the_line_of_a_spoiled_component_is_lost(system, component, lost):
    """With one rate's sign turned its row, part or vector has no line, and others stay."""
    equations = emitted(system)
    whole = {line.split(" = ")[0] for line in lines(vector_form(equations))}
    spoiled = vector_form(spoil(equations, equations.variables.index(component)))
    found = {line.split(" = ")[0] for line in lines(spoiled)}
    assert lost in whole
    assert lost not in found
    assert spoiled.missing


def test_vee_undoes_hat():
    """The vector of the skew matrix of a x."""
    field = make_vocabulary(emitted("rigid_body")).field
    names = ("Pi1", "Pi2", "Pi3")
    node = read_expression("hat(a)")
    value = evaluate(
        Call(function="vee", arguments=(node,)), {"a": tuple(field[n] for n in names)}, field
    )
    assert value == tuple(field[n] for n in names)


def test_rotations_cancel_in_what_is_printed():
    """R^T R goes, from products of any length, and R S does not."""
    scope = {"R": (3, 3), "S": (3, 3), "x": (3,)}
    formulas = ("transpose(R)*R*diag(x)*x", "R*S*x", "S*R*transpose(R)*x", "transpose(S)*S*x")
    found = [
        write_tree(drop_rotations(read_expression(each), {Name("R")}, scope), scope).text
        for each in formulas
    ]
    assert found == ["diag(x) x", "R S x", "S x", "S^T S x"]


def test_velocities_that_a_route_replaces_have_no_balance():
    """Hamel's equations have no rates of some velocities: none of their lines is printed."""
    equations = emitted("chaplygin_ball", "hamel")
    assert not speeds_of(equations).keys() >= set(equations.setting.velocities)
    assert balance_lines(equations) is None
    assert document(equations).sections


@pytest.mark.parametrize(
    ("formula", "by", "expected"),
    [
        ("m*g*dot(Gamma, chi)", "Gamma", "m g chi"),
        ("dot(Omega, diag(I)*Omega)/2", "Omega", "diag(I) Omega"),
        ("-mu/norm(Gamma)", "Gamma", "mu Gamma/|Gamma|^3"),
        ("dot(Gamma, cross(chi, Omega))", "Omega", "Gamma x chi"),
        ("I1*Omega1^2/2", "Omega", "(I1 Omega1, 0, 0)"),
        ("exp(dot(Gamma, chi))", "Gamma", "exp(Gamma . chi) chi"),
        ("dot(Gamma, Gamma)^2", "Gamma", "4 (Gamma . Gamma) Gamma"),
        ("trace(transpose(A)*A)/2", "A", "A"),
        ("trace(A^3)", "A", "3 A^T A^T"),
        ("g/det(A)^2", "A", "-2 g A^-T/det(A)^2"),
        ("dot(chi, A*Gamma)", "A", "chi (x) Gamma"),
        ("trace(A*S*transpose(A))/2 + trace(S*S)", "S", "1/2 A^T A + 2 S"),
        ("trace(S*A*S*A)/2", "S", "A^T S A^T"),
        ("dot(Gamma, vector(Omega3, m*Omega1, 0))", "Omega", "(m Gamma2, 0, Gamma1)"),
        ("dot(chi, diag(transpose(A)*S))", "A", "S diag(chi)"),
    ],
)
def test_gradients_are_those_done_by_hand(formula, by, expected):
    """The adjoint of each operation."""
    names = ("Gamma", "chi", "Omega", "I")
    scope = dict.fromkeys(names, (3,)) | dict.fromkeys(("m", "g", "mu"), ())
    scope |= dict.fromkeys(("A", "S"), (3, 3))
    parts = [f"{by}{n}" for n in (1, 2, 3)] if len(scope[by]) == 1 else []
    scope |= dict.fromkeys([*parts, "I1"], ())
    found = gradient(read_expression(formula), Name(by), parts, scope, symmetric=["S"])
    assert add([write_tree(total_of(found), scope)]).text == expected


def test_a_matrix_times_a_product_of_vectors_is_in_brackets():
    """A (b x c) is not (A b) x c."""
    scope = {"A": (3, 3), "b": (3,), "c": (3,), "m": ()}
    formulas = ("A*cross(b, c)", "cross(A*b, c)", "m*cross(b, c)", "transpose(A)*cross(b, c)")
    found = [write_tree(read_expression(each), scope).text for each in formulas]
    assert found == ["A (b x c)", "(A b) x c", "m b x c", "A^T (b x c)"]


def test_a_gradient_that_is_not_known_is_none():
    """An inverse of what the variable is in."""
    scope = {"A": (3,), "b": (3,)}
    formula = read_expression("dot(b, inverse(diag(A))*b)")
    assert gradient(formula, Name("A"), (), scope) is None
