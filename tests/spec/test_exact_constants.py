"""Roots, sines of parts of a turn and pi in algebras: every zero is decided, never by rounding."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from itertools import combinations

import pytest

from coadjoint.algebra import LieAlgebra, algebra_by_name
from coadjoint.errors import AlgebraError, SpecError
from coadjoint.exact.numbers import sign
from coadjoint.prove.examination import examine
from coadjoint.spec import Spec
from coadjoint.spec.reader import read_spec_text
from tests.specs import prove_claims

#: f_abc of Gell-Mann's matrices (Georgi, Lie Algebras in Particle Physics, 2nd ed., section 7.1).
GELL_MANN = {
    "123": "1",
    "147": "1/2",
    "165": "1/2",
    "246": "1/2",
    "257": "1/2",
    "345": "1/2",
    "376": "1/2",
    "458": "sqrt(3)/2",
    "678": "sqrt(3)/2",
}


def read(basis: list[str], brackets: dict[str, str], parameters: str = "") -> Spec:
    """A free motion on an algebra."""
    lines = "\n".join(f'"[{pair}]" = "{value}"' for pair, value in brackets.items())
    names = ", ".join(f'"{name}"' for name in basis)
    size = len(basis)
    text = f"""
title = "Test"
routes = ["euler-poincare", "lie-poisson"]
[algebra]
basis = [{names}]
[algebra.brackets]
{lines}
[parameters]
I = {{ shape = [{size}], positive = true, default = {list(range(1, size + 1))} }}
{parameters}
[variables]
M = {{ role = "momentum" }}
W = {{ role = "velocity" }}
[lagrangian]
l = "dot(W, diag(I)*W)/2"
"""
    return read_spec_text(text, "test.toml")


def algebra_of(basis: list[str], brackets: dict[str, str], parameters: str = "") -> LieAlgebra:
    """The algebra alone."""
    algebra = read(basis, brackets, parameters).algebra
    assert algebra is not None
    return algebra


def antisymmetric(table: dict[str, str]) -> dict[str, str]:
    """Brackets by constants f_abc that change sign under each exchange."""
    rows: dict[str, list[str]] = {}
    for digits, value in table.items():
        i, j, k = map(int, digits)
        for a, b, c in ((i, j, k), (j, k, i), (k, i, j)):
            low, high, minus = (a, b, "") if a < b else (b, a, "-")
            rows.setdefault(f"e{low}, e{high}", []).append(f"{minus}{value}*e{c}")
    return {pair: " + ".join(f"({t})" for t in terms) for pair, terms in rows.items()}


def sines(order: int) -> tuple[list[str], dict[str, str]]:
    """``[T_m, T_n] = sin(2 pi (m x n)/N) T_(m+n)`` modulo N (Zeitlin 1991)."""
    places = [(a, b) for a in range(order) for b in range(order) if a or b]
    name = {place: f"T{place[0]}{place[1]}" for place in places}
    brackets = {}
    for m, n in combinations(places, 2):
        cross, total = m[0] * n[1] - m[1] * n[0], ((m[0] + n[0]) % order, (m[1] + n[1]) % order)
        if cross % order and total in name:
            brackets[f"{name[m]}, {name[n]}"] = f"sin({2 * cross}*pi/{order})*{name[total]}"
    return list(name.values()), brackets


E8 = [f"e{n}" for n in range(1, 9)]
E3, E4 = E8[:3], E8[:4]


def test_su3_in_gell_manns_basis() -> None:
    """The Killing form is -3 times the identity, and the cubic Casimir has Gell-Mann's d_abc."""
    algebra = algebra_of(E8, antisymmetric(GELL_MANN))
    assert algebra.killing_form() == tuple(tuple(-3 * (i == j) for j in range(8)) for i in range(8))
    assert algebra.killing_signature() == algebra_by_name("su(3)").killing_signature()
    found = examine(algebra)
    square, cube = found.casimirs.found
    assert square == found.field.sum(found.field[name] ** 2 for name in E8)
    # d_118 = 1/sqrt(3), d_888 = -1/sqrt(3), d_146 = 1/2, d_448 = -1/(2 sqrt(3)): in
    # sum d_abc e_a e_b e_c they stand 3, 1, 6 and 3 times. The leading coefficient is 1.
    field, root = found.field, found.field.call("sqrt", found.field.number(3))
    e = {n: field[f"e{n}"] for n in range(1, 9)}
    some = e[1] ** 2 * e[8] - e[8] ** 3 / 3 + root * e[1] * e[4] * e[6] - e[4] ** 2 * e[8] / 2
    others = {"e2": 0, "e3": 0, "e5": 0, "e7": 0}
    values = {n: field.number(others[n]) if n in others else field[n] for n in E8}
    values |= {name: field[name] for name in field.adjoined}
    assert field.is_zero(field.evaluate(cube, values, field.number) - some + e[6] ** 2 * e[8] / 2)


@pytest.mark.parametrize(
    "wrong", ["sqrt(2)/2", "-sqrt(3)/2", "8660254037844386467637231707529/10^31"]
)
def test_another_constant_of_su3_is_refuted(wrong: str) -> None:
    """Also one that is right in double precision; the triple is named."""
    with pytest.raises(AlgebraError, match=r"\[e\d, \[e\d, e\d\]\] \+ cyclic = \("):
        algebra_of(E8, antisymmetric(GELL_MANN | {"678": f"({wrong})"}))


def seventh(parts: int, last: str = "1") -> dict[str, str]:
    """Brackets that are closed where ``8 c^3 + 4 c^2 - 4 c = 1`` for the cosine c."""
    c = f"cos(2*pi/{parts})"
    return {
        "e1, e2": "e3",
        "e4, e1": f"8*{c}^3*e1",
        "e4, e2": f"4*{c}^2*e2",
        "e4, e3": f"(4*{c} + {last})*e3",
    }


def test_an_identity_that_holds_by_a_minimal_polynomial() -> None:
    """``cos(2 pi/7)`` is a root of ``8 x^3 + 4 x^2 - 4 x - 1``."""
    algebra = algebra_of(E4, seventh(7))
    assert algebra.derived_series() == (4, 3, 1, 0)
    assert algebra.is_solvable
    assert not algebra.is_unimodular
    assert algebra.generic_rank() == 4


@pytest.mark.parametrize(("parts", "last"), [(9, "1"), (7, "(0 - 1)"), (7, "(1 + 1/10^30)")])
def test_its_spoiled_twins_are_refuted(parts: int, last: str) -> None:
    """Another part of a turn, another sign, and a difference that no double shows."""
    with pytest.raises(AlgebraError, match=r"\[e1, \[e2, e4\]\] \+ cyclic") as caught:
        algebra_of(E4, seventh(parts, last))
    assert caught.value.triple == [0, 1, 3]


def test_what_is_zero_and_what_is_not() -> None:
    """Floating point sees neither: sqrt(2) sqrt(3) - sqrt(6) is 0, and 1e-30 more is not."""
    assert math.sqrt(2) * math.sqrt(3) - math.sqrt(6) != 0
    none = "sqrt(2)*sqrt(3) - sqrt(6)"
    assert algebra_of(E3, {"e1, e2": f"({none})*e3"}).is_abelian
    # A convergent of sqrt(2) by its continued fraction: it differs by 2e-31.
    p, q = 1, 1
    for _ in range(39):
        p, q = p + 2 * q, p + q
    tiny = f"({p}/{q} - sqrt(2))"
    assert 0 < abs(p * p - 2 * q * q) == 1
    assert float(Fraction(p, q)) == math.sqrt(2)
    algebra = algebra_of(E3, {"e1, e2": f"{tiny}*e3", "e2, e3": "e1", "e3, e1": "e2"})
    assert algebra.derived_series() == (3,)
    positive = p * p > 2 * q * q
    assert algebra.killing_signature() == ((0, 3, 0) if positive else (2, 1, 0))
    assert sign(algebra.constants[0, 1][2]) == (1 if positive else -1)


@pytest.mark.parametrize(
    ("zero", "spoiled"),
    [
        ("(2^(1/3))^3 - 2", "(3^(1/3))^3 - 2"),
        ("2^(1/3)*4^(1/3) - 2", "2^(1/3)*4^(1/4) - 2"),
        ("3^0.25*sqrt(sqrt(27)) - 3", "3^0.25*sqrt(sqrt(28)) - 3"),
        ("sqrt(2 + sqrt(3)) - (sqrt(6) + sqrt(2))/2", "sqrt(2 - sqrt(3)) - (sqrt(6) + sqrt(2))/2"),
        ("(7 + 5*sqrt(2))^(1/3) - 1 - sqrt(2)", "(7 + 4*sqrt(2))^(1/3) - 1 - sqrt(2)"),
    ],
)
def test_roots_of_any_degree_and_of_sums(zero: str, spoiled: str) -> None:
    """The last one is the root of Cardano's formula: ``(1 + sqrt(2))^3 = 7 + 5 sqrt(2)``."""
    assert algebra_of(E3, {"e1, e2": f"({zero})*e3"}).is_abelian
    assert not algebra_of(E3, {"e1, e2": f"({spoiled})*e3"}).is_abelian


def test_a_root_in_a_casimir_is_that_of_the_algebra() -> None:
    """``[e1, e2] = c e3`` and cyclic ones without c: ``M1^2 + M2^2 + c M3^2``, c its cubic root."""
    brackets = {"e1, e2": "2^(1/3)*e3", "e2, e3": "e1", "e3, e1": "e2"}
    claim = '[claims]\ncasimirs = ["M1^2 + M2^2 + {}*M3^2"]'
    for factor, holds in (("2^(1/3)", True), ("2^(1/4)", False)):
        certificate = prove_claims(read(list(E3), brackets, claim.format(factor)))
        assert certificate.holds is holds


@pytest.mark.parametrize("number", ["2^(1/30)", "2^(1/100003)", "2^(1/3) + 3^(1/5) + 5^(1/7)"])
def test_a_field_of_too_large_a_degree_is_refused(number: str) -> None:
    """Before polynomials of this degree are made."""
    with pytest.raises(SpecError, match="Name a parameter for one of them") as caught:
        algebra_of(E3, {"e1, e2": f"({number})*e3"})
    assert caught.value.parts["limit"] == "ALGEBRAIC_DEGREE"


@pytest.mark.parametrize("number", ["(2 - sqrt(5))^(1/2)", "sqrt(2 - sqrt(5))"])
def test_a_root_without_a_real_value_is_refused(number: str) -> None:
    """As it is written, with its parentheses."""
    with pytest.raises(SpecError, match=rf"{re.escape(number)} is not a real number"):
        algebra_of(E3, {"e1, e2": f"{number}*e3"})


def test_parameters_roots_and_pi_together() -> None:
    """One field has all of them; the twin with another bracket is refuted for all k."""
    brackets = {"e1, e2": "k*sqrt(2)*e3", "e2, e3": "pi*e1", "e3, e1": "e2/sqrt(2)"}
    algebra = algebra_of(E3, brackets, "k = { default = 2 }")
    assert algebra.is_semisimple
    assert algebra.generic_rank() == 2
    with pytest.raises(AlgebraError, match="signature"):
        algebra.killing_signature()
    with pytest.raises(AlgebraError, match=r"k\*sqrt\(2\)"):
        algebra_of(E3, brackets | {"e3, e1": "e2/sqrt(2) + e1"}, "k = { default = 2 }")
    # pi is no algebraic number: 22/7 < pi < 355/113 + 1e-6 decides signs.
    lower, upper = {"e1, e2": "(22/7 - pi)*e3"}, {"e1, e2": "(355/113 - pi)*e3"}
    signs = [sign(algebra_of(E3, each).constants[0, 1][2]) for each in (lower, upper)]
    assert signs == [1, 1]


def test_the_sine_algebra_is_a_real_form_of_su() -> None:
    """For N = 3 with real T it is su(2, 1): the Killing form has 2 p q = 4 positive squares."""
    basis, brackets = sines(3)
    found = examine(algebra_of(basis, brackets))
    assert found.signature == (4, 4, 0)
    assert len(found.casimirs.found) == 2
    assert found.rank == 6


@pytest.mark.parametrize("number", ["sin(1)", "log(2)", "exp(1)"])
def test_numbers_that_are_not_known_to_be_algebraic(number: str) -> None:
    """They are named, with what to do."""
    with pytest.raises(SpecError, match="not known to be an algebraic number"):
        algebra_of(E3, {"e1, e2": f"{number}*e3"})
