"""Routes: invariance, advected quantities of other kinds, and refusals."""

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.errors import DerivationError, LimitError
from tests.specs import RIGID_BODY, prove_claims, spec


def test_right_invariance_runs_the_other_way():
    """A right-invariant body obeys the same equations with the opposite sign (Holm 2011, 9.1)."""
    left = derive(spec())
    right = derive(spec(RIGID_BODY, ('name = "so(3)"', 'name = "so(3)"\ninvariance = "right"')))
    assert left.rates[0] != 0
    assert [sympy.expand(a + b) for a, b in zip(left.rates, right.rates, strict=True)] == [0, 0, 0]


@pytest.mark.parametrize("invariance", ["left", "right"])
@pytest.mark.parametrize("representation", ["vector", "adjoint", "coadjoint"])
def test_routes_agree_for_every_representation(representation, invariance):
    """Advected quantities of each kind, on both sides: the routes are proved equal."""
    text = RIGID_BODY.replace('name = "so(3)"', f'name = "so(3)"\ninvariance = "{invariance}"')
    text = text.replace(
        'Pi = { role = "momentum" }',
        'Pi = { role = "momentum" }\n'
        f'a = {{ role = "advected", representation = "{representation}" }}',
    ).replace('diag(I)*Omega)/2"', 'diag(I)*Omega)/2 - a1^2*a3 - dot(a, I)"')
    text = text.replace('["dot(Pi, Pi)"]', '["dot(a, a)", "dot(Pi, a)"]')
    certificate = prove_claims(spec(text))
    assert certificate.holds, str(certificate)
    assert sum(claim.kind == "equivalence" for claim in certificate.claims) >= 2


def test_a_lagrangian_without_legendre_transform_is_refused():
    """A missing kinetic term is named, with the place."""
    with pytest.raises(DerivationError, match=r"sample.toml:\d+: lagrangian.l: .*Omega3") as caught:
        derive(spec(RIGID_BODY, ("dot(Omega, diag(I)*Omega)/2", "I1*Omega1^2 + I2*Omega2^2")))
    assert caught.value.velocity == "Omega3"


def test_a_lagrangian_without_positive_kinetic_energy_at_rest_is_refused():
    """Omega1^4 alone has no Hessian at rest, where Newton's iteration begins."""
    changes = ("dot(Omega, diag(I)*Omega)/2", "Omega1^4 + I2*Omega2^2 + I3*Omega3^2")
    with pytest.raises(DerivationError, match=r"not quadratic in the velocities Omega1"):
        derive(spec(RIGID_BODY, changes))


def test_a_lagrangian_linear_in_velocities_shifts_the_momenta():
    """A rotor of momentum s: Pi = I Omega + s, dPi/dt = Pi x Omega (Holm 2011, section 2.4)."""
    changes = [
        ("default = [1, 2, 3] }", "default = [1, 2, 3] }\ns = { shape = [3] }"),
        ('/2"', '/2 + dot(Omega, s)"'),
    ]
    sample = spec(RIGID_BODY, *changes)
    equations = derive(sample)
    pi, inertia, s = (sympy.symbols(f"{name}1:4") for name in ("Pi", "I", "s"))
    omega = [(pi[n] - s[n]) / inertia[n] for n in range(3)]
    expected = sympy.Matrix(pi).cross(sympy.Matrix(omega))
    assert [sympy.expand(a - b) for a, b in zip(equations.rates, expected, strict=True)] == [0] * 3
    assert prove_claims(sample).holds


def test_a_leading_minus_is_a_minus():
    """-T and 0 - T are one formula, and T another."""
    minus, difference, plus = (
        derive(spec(RIGID_BODY, ("dot(Omega", text + "dot(Omega"))).rates
        for text in ("-", "0 - ", "")
    )
    assert minus == difference
    assert minus != plus


def test_a_full_inertia_tensor_is_inverted_symbolically():
    """Three coupled velocities: J Omega = Pi holds exactly for the derived velocities."""
    changes = [
        ("I = { shape = [3], positive = true, default = [1, 2, 3] }", "J = { shape = [3, 3] }"),
        ("diag(I)*Omega)/2", "(J + transpose(J))*Omega)/4"),
    ]
    equations = derive(spec(RIGID_BODY, *changes))
    matrix = sympy.Matrix(3, 3, lambda i, j: sympy.Symbol(f"J{i + 1}{j + 1}"))
    omega = sympy.Matrix(list(equations.velocities.values()))
    residual = (matrix + matrix.T) / 2 * omega - sympy.Matrix(equations.state)
    assert residual.applyfunc(sympy.cancel) == sympy.zeros(3, 1)


#: A body in a fluid whose rotation and translation the kinetic energy couples.
COUPLED = """
routes = ["euler-poincare"]
title = "coupled"
[algebra]
name = "se(3)"
[variables]
Omega = { role = "velocity", block = "rotation" }
v = { role = "velocity", block = "translation" }
Pi = { role = "momentum", block = "rotation" }
P = { role = "momentum", block = "translation" }
[parameters]
C = { shape = [3, 3] }
[lagrangian]
l = "dot(Omega, Omega)/2 + dot(v, v)/2 + dot(Omega, C*v)"
"""


def test_velocities_coupled_beyond_three_are_solved_for_in_the_kernel():
    """At a rational point the six velocities give back the momenta Omega + C v and v + C^T Omega.

    A momentum that is another is noticed.
    """
    equations = derive(spec(COUPLED))
    names = [str(symbol) for symbol in (*equations.state, *equations.parameters)]
    values = {name: sympy.Rational(7 * n % 11 + 1, 3) for n, name in enumerate(names)}
    for name, value in equations.velocities.items():
        values[name] = sympy.sympify(value).subs(values)
    velocity, momentum = (
        sympy.Matrix([values[f"{name}{i}"] for name in pair for i in (1, 2, 3)])
        for pair in (("Omega", "v"), ("Pi", "P"))
    )
    C = sympy.Matrix(3, 3, lambda i, j: values[f"C{i + 1}{j + 1}"])
    mass = sympy.Matrix(sympy.BlockMatrix([[sympy.eye(3), C], [C.T, sympy.eye(3)]]))
    assert mass * velocity == momentum
    assert mass * momentum != momentum


def test_velocities_that_take_too_long_are_refused_with_a_way_out(monkeypatch):
    """What the kernel would not solve either asks for a Hamiltonian."""
    monkeypatch.setattr("coadjoint.derive.mechanics.legendre.OPERATIONS", 2000)
    curved = COUPLED.replace("dot(v, v)/2", "dot(v, v)/2 + v1^4/4")
    with pytest.raises(LimitError, match=r"couples 6 velocities.*at most 2000 .*lie-poisson"):
        derive(spec(curved))


def test_an_undeclared_route_is_refused():
    """derive(spec, route) asks for declared routes."""
    with pytest.raises(DerivationError, match="'lie-poisson' is not declared"):
        derive(spec(RIGID_BODY, (', "lie-poisson"', "")), "lie-poisson")


def test_division_by_zero_in_a_formula_names_the_place():
    """1/(m - m) is found when the formula is interpreted."""
    with pytest.raises(DerivationError, match=r"lagrangian.l: .*divides by zero") as caught:
        derive(spec(RIGID_BODY, ("/2", "/(I1 - I1)")))
    assert "I1 - I1" in caught.value.found


def test_equations_show_themselves_in_a_notebook():
    """The LaTeX has the definitions and the rates; what a notebook shows, their vectors."""
    equations = derive(spec())
    assert r"\Omega_1 &= \frac{\Pi_1}{I_1}" in equations.latex()
    assert r"\dot{\Pi}_1 &=" in equations.latex()
    assert r"\dot{\boldsymbol{\Pi}} &=" in equations._repr_latex_()


def test_elementary_functions_are_derived_through():
    """A potential sin(Gamma3) gives a torque with cos(Gamma3), by both routes."""
    text = RIGID_BODY.replace(
        'Pi = { role = "momentum" }',
        'Pi = { role = "momentum" }\nGamma = { role = "advected", representation = "vector" }',
    ).replace('diag(I)*Omega)/2"', 'diag(I)*Omega)/2 - sin(Gamma3)*sqrt(1 + Gamma1^2)"')
    text = text.replace('["dot(Pi, Pi)"]', '["dot(Gamma, Gamma)", "dot(Pi, Gamma)"]')
    sample = spec(text)
    assert prove_claims(sample).holds
    third = derive(sample).rates[2]
    assert third.has(sympy.sin)
    assert not third.has(sympy.cos)
    assert derive(sample).rates[0].has(sympy.cos)
