"""Complex rigid bodies, Holm (2011), appendix C.1.2: the book's formulas, then spoiled."""

from dataclasses import replace

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.derive.routes import complexification
from tests.sources.components import cross, dot, plus, times
from tests.specs import emitted, prove_claims, shipped, spec

X, Y, K = (sympy.symbols(f"{name}1:4") for name in "xyK")
BOOK = dict(zip(K, (-1, 0, 1), strict=True))
TEXT = shipped("pt_rigid_body").path.read_text(encoding="utf-8")
WHOLE = shipped("complex_rigid_body").path.read_text(encoding="utf-8")


def same(found, expected):
    """Whether two lists of rational functions are equal."""
    pairs = zip(found, expected, strict=True)
    return all(sympy.cancel(sympy.together(sympy.sympify(a - b))) == 0 for a, b in pairs)


def by(K, z):
    """``K z``."""
    return [k * c for k, c in zip(K, z, strict=True)]


@pytest.mark.parametrize("route", ["lie-poisson", "complexification"])
def test_C_1_2_complex_rigid_body(route):
    """dL/dt = L x KL by real and imaginary parts; with the conjugate of KL it is another motion."""
    rates = emitted("complex_rigid_body", route).rates
    L = [x + sympy.I * y for x, y in zip(X, Y, strict=True)]
    moved = [sympy.expand(z) for z in cross(L, by(K, L))]
    found = [a + sympy.I * b for a, b in zip(rates[:3], rates[3:], strict=True)]
    assert [sympy.expand(a - b) for a, b in zip(found, moved, strict=True)] == [0, 0, 0]
    wrong = cross(L, by(K, [x - sympy.I * y for x, y in zip(X, Y, strict=True)]))
    assert [sympy.expand(a - b) for a, b in zip(found, wrong, strict=True)] != [0, 0, 0]


def test_C_1_2_complex_velocities():
    """That of x is Re KL, that of y is -Im KL by the pairing Re<L, zeta>; on both routes."""
    named = (
        "[parameters.K]",
        'xi = { role = "velocity", block = ["J1", "J2", "J3"] }\n'
        'eta = { role = "velocity", block = ["iJ1", "iJ2", "iJ3"] }\n[parameters.K]',
    )
    for route in ("lie-poisson", "complexification"):
        found = list(derive(spec(WHOLE, named), route).velocities.values())
        assert same(found, [*by(K, X), *times(-1, by(K, Y))])


def test_C_1_2_four_real_integrals():
    """Real and imaginary parts of L.L/2 and L.KL/2, all proved; x.y with another sign is not."""
    certificate = prove_claims(shipped("complex_rigid_body"))
    assert certificate.holds
    proved = {c.statement for c in certificate.claims}
    assert {f"{name} is conserved" for name in ("ReC", "ImC", "ReH", "ImH")} <= proved
    spoiled = spec(
        WHOLE, ('ReC = { expression = "(dot(x, x) - ', 'ReC = { expression = "(dot(x, x) + ')
    )
    assert [c.statement for c in prove_claims(spoiled).refuted] == ["ReC is conserved"]


def test_C_1_2_a_hamiltonian_that_is_no_real_part_is_refuted():
    """With + y . Ky both laws of motion exist, and they differ."""
    spoiled = spec(WHOLE, ('h = "(dot(x, diag(K)*x) - ', 'h = "(dot(x, diag(K)*x) + '))
    statements = [c.statement for c in prove_claims(spoiled).refuted]
    assert "lie-poisson and complexification give the same motion" in statements


def book_rates(sign=1):
    """``dx1/dt = x2 x3 (1 + 2 x1^2 N/D)`` and so on: the book's K = diag(-1, 0, 1), C = 1/2."""
    x1, x2, x3 = X
    N = dot(X, X) - 1
    u = sign * N / (x2**2 * x3**2 + 4 * x1**2 * x3**2 + x1**2 * x2**2)
    return [
        x2 * x3 * (1 + 2 * x1**2 * u),
        -2 * x1 * x3 * (1 - x2**2 * u),
        x1 * x2 * (1 + 2 * x3**2 * u),
    ]


@pytest.mark.parametrize("route", ["lie-poisson", "complexification"])
def test_C_1_2_pt_symmetric_body(route):
    """The reduced flow of the book for its K, and dx/dt = x x Kx - (N/D) w x Kw for every K."""
    rates = emitted("pt_rigid_body", route).rates
    assert same([rate.subs(BOOK) for rate in rates], book_rates())
    assert not same([rate.subs(BOOK) for rate in rates], book_rates(-1))
    w = cross(X, by(K, X))
    u = (dot(X, X) - 1) / dot(w, w)
    assert same(rates, plus(w, times(-u, cross(w, by(K, w)))))


def test_C_1_2_y_is_along_the_motion_of_the_real_sphere():
    """Where x . y = 0 = x . Ky, y is along x x Kx: y x (x x Kx) is x (y . Kx) - Kx (y . x)."""
    w = cross(X, by(K, X))
    expected = plus(times(dot(Y, by(K, X)), X), times(-dot(Y, X), by(K, X)))
    assert [sympy.expand(a - b) for a, b in zip(cross(Y, w), expected, strict=True)] == [0, 0, 0]


def test_C_1_2_the_submanifold_is_proved_invariant():
    """Its functions stay zero, vanish on the section, and the section moves along."""
    certificate = prove_claims(shipped("pt_rigid_body"))
    assert certificate.holds
    kinds = [c.statement for c in certificate.claims if c.kind == "reduction"]
    assert len(kinds) == 3
    assert kinds[0].startswith("the whole motion keeps dot(x, y) = 0")
    assert "the energy is conserved" in {c.statement for c in certificate.claims}


@pytest.mark.parametrize(
    ("old", "new", "refuted"),
    [
        ('"dot(x, diag(K)*y)", ', '"x1*y1", ', "the whole motion keeps"),
        ("dot(x, x) - 1)/dot(w, w)", "dot(x, x) - 2)/dot(w, w)", "where y = "),
        ("dot(x, x) - 1)/dot(w, w)", "dot(x, x) - 1)/dot(x, x)", "the motion keeps y"),
        ("dot(w, w))*w", "dot(w, w))*x", "the motion keeps y"),
    ],
)
def test_C_1_2_a_section_that_is_not_kept_is_refuted(old, new, refuted):
    """A relation that is no integral, another level, another length, another direction of y."""
    statements = [c.statement for c in prove_claims(spec(TEXT, (old, new))).refuted]
    assert any(statement.startswith(refuted) for statement in statements), statements


def test_C_1_2_another_level_of_c_is_another_motion():
    """L . L = 2 throughout is kept as well; the motion is not that of the book."""
    other = spec(TEXT, ("dot(y, y) - 1", "dot(y, y) - 2"), ("dot(x, x) - 1)/", "dot(x, x) - 2)/"))
    assert prove_claims(other).holds
    assert not same([rate.subs(BOOK) for rate in derive(other).rates], book_rates())


@pytest.mark.parametrize("route", ["lie-poisson", "complexification"])
def test_C_1_2_right_invariance_runs_the_other_way(route, monkeypatch):
    """dL/dt = KL x L from the right, at complex momenta; a route that forgets the side is found."""
    right = spec(WHOLE, ('invariance       = "left"', 'invariance       = "right"'))
    rates = derive(right, route).rates
    L = [x + sympy.I * y for x, y in zip(X, Y, strict=True)]
    moved = [sympy.expand(-z) for z in cross(L, by(K, L))]
    found = [a + sympy.I * b for a, b in zip(rates[:3], rates[3:], strict=True)]
    assert [sympy.expand(a - b) for a, b in zip(found, moved, strict=True)] == [0, 0, 0]
    assert prove_claims(right).holds
    follow = complexification.derive

    def forgetful(setting):
        whole = follow(setting)
        turned = replace(whole.exact, rates=tuple(-rate for rate in whole.exact.rates))
        return replace(whole, exact=turned)

    monkeypatch.setattr(complexification, "derive", forgetful)
    assert not prove_claims(right).holds
