"""Signs on a whole domain: what is certain is said, anything else is not."""

import random
from fractions import Fraction

import mpmath
import pytest

from coadjoint.exact import Condition, Field
from coadjoint.exact.signs import Signs, sign
from coadjoint.exact.witness import UNDEFINED, Domain, enclosure

NAMES = ("m", "k", "q", "v")


def written(field, text):
    """An element from Python text."""
    calls = {f: lambda u, f=f: field.call(f, field.zero + u) for f in ("sqrt", "sin", "cos", "exp")}
    return eval(text, {"__builtins__": {}}, {name: field[name] for name in NAMES} | calls)


CASES = [
    ("m", 1, 1),
    ("-m*k", -1, -1),
    ("q", 0, 0),
    ("q**2", 0, 1),
    ("m + k*q**2", 1, 1),
    ("m*q**2 + k*v**2", 0, 1),
    ("m - k", 0, 0),
    ("m**2 - 2*m*k + k**2", 0, 1),
    ("(m + q**2)**3*(-k)", -1, -1),
    ("exp(q)", 1, 1),
    ("exp(q) - 1", 0, 0),
    ("sqrt(q)", 0, 1),
    ("sqrt(m)", 1, 1),
    ("m + sqrt(q)", 1, 1),
    ("1/sqrt(q)", 1, 1),
    ("1/q**2", 1, 1),
    ("m/q", 0, 0),
    ("m + k - k*cos(q)**2", 1, 1),
    ("m - m*cos(q)**2", 0, 1),
    ("m + m*sin(q)", 0, 0),
    ("2*m + m*sin(q)", 1, 1),
    ("m*q**2*cos(v) - 2*m*q**2 - k", -1, -1),
    ("2*q + q*sin(v)", 0, 0),
    ("q**2 - 2*q*v + v**2 + m", 1, 1),
    ("q**2 - 3*q*v + v**2 + m", 0, 0),
    ("q**2 + 2*q*v + v**2", 0, 1),
    ("k + m*(q**2 + v**2 - 2*q*v*cos(m))", 1, 1),
    ("2*q*v - q**2 - v**2 - exp(q)", -1, -1),
    ("m + q*(1 + cos(v))", 0, 0),
    ("m + k*(1 + cos(v))", 1, 1),
    ("m + q**3*v*(1 - sin(v))", 0, 0),
    ("m + q**2 + v**2 + 3*q*v*(1 + cos(m))", 0, 0),
    ("m + q**2 + v**2 + q*v*(1 + cos(m))", 1, 1),
    ("m**2 - m*k + k**2 - 2*m*k", 0, 0),
    ("m**4 + q**4 - 2*m**2*q**2 + k", 1, 1),
]


@pytest.mark.parametrize(("text", "strict", "weak"), CASES)
def test_signs_follow_from_declared_ones(text, strict, weak):
    """Of positive m and k, and q and v of any sign: the sign of each sum is worked out by hand."""
    field = Field(NAMES, slots=4, positive=["m", "k"])
    element = written(field, text)
    assert sign(field, element) == strict
    assert sign(field, element, strict=False) == weak


@pytest.mark.parametrize("text", [text for text, strict, _ in CASES if strict])
def test_a_certain_sign_holds_at_points(text):
    """Interval bounds at points of the domain have the sign that was said."""
    field = Field(NAMES, slots=4, positive=["m", "k"])
    element = written(field, text)
    source, seen = random.Random(4), 0
    for _ in range(60):
        point = {name: Fraction(source.randint(-40, 40), 7) for name in NAMES}
        point |= {name: abs(point[name]) + Fraction(1, 9) for name in ("m", "k")}
        try:
            found = enclosure(field, element, point).sign
        except UNDEFINED:
            continue
        seen += 1
        assert found == sign(field, element)
    assert seen > 10


def test_the_root_of_a_square_keeps_its_sign():
    """sqrt((m + q (1 + cos v))^2) is not m + q (1 + cos v), which is -1 at m = 1, q = -1, v = 0."""
    field = Field(NAMES, slots=4, positive=["m", "k"])
    inner = written(field, "m + q*(1 + cos(v))")
    root = field.call("sqrt", inner**2)
    assert not field.is_zero(root - inner)
    assert not field.is_zero(root + inner)
    known = written(field, "2*m + m*cos(v)")
    assert field.is_zero(field.call("sqrt", known**2) - known)


def test_conditions_are_used_as_they_stand():
    """The condition m > k makes m - k and its multiples positive, m >= k but for zeros."""
    for strict in (True, False):
        field = Field(NAMES, positive=["m", "k"])
        m, k, q = (field[name] for name in "mkq")
        field.assume([Condition(m - k, strict=strict)])
        assert sign(field, k * (k - m)) == (-1 if strict else 0)
        assert sign(field, 3 * m - 3 * k, strict=False) == 1
        assert sign(field, m - k - 1) == sign(field, (m - k) * q) == 0


def test_points_of_a_domain_keep_declared_signs():
    """A point outside is moved inside, with positive symbols left positive."""
    field = Field(NAMES, slots=2, positive=["m"])
    domain = Domain(field, (field.call("sqrt", field["q"] - field["m"] - 50),))
    point = domain.move_inside({"m": Fraction(1), "q": Fraction(1)})
    assert point["m"] > 0
    assert point["q"] > point["m"] + 50
    assert mpmath.sqrt(mpmath.mpf(float(point["q"] - point["m"] - 50))) > 0


@pytest.mark.parametrize(
    ("condition", "strict", "text", "expected"),
    [
        ("q - 3", True, "q - 2", (1, 1)),
        ("q - 3", True, "q - 4", (0, 0)),
        ("q - 3", True, "4 - 2*q", (-1, -1)),
        ("q - 3", True, "q**2 - 4", (1, 1)),
        ("q - 3", False, "q - 3", (0, 1)),
        ("q - 3", False, "q - 2", (1, 1)),
        ("-1 - q", True, "q - 2", (-1, -1)),
        ("1 - q**2 - v**2", True, "2 - q**2 - v**2", (1, 1)),
        ("1 - q**2 - v**2", True, "2 - q**2", (1, 1)),
        ("1 - q**2 - v**2", True, "(1 - 2*q**2)", (0, 0)),
        ("q - m", True, "q + m*v**2", (1, 1)),  # (q - m) + m + m*v^2
        ("q - m", True, "q - 2*m", (0, 0)),
    ],
)
def test_what_exceeds_a_condition_has_its_sign(condition, strict, text, expected):
    """A multiple of what is declared positive, and more of the same sign."""
    field = Field(NAMES, slots=4, positive=["m", "k"])
    field.assume([Condition(written(field, condition), strict)])
    element = written(field, text)
    assert (sign(field, element), sign(field, element, strict=False)) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("q**3 - 5", 1),  # (3 + x)^3 - 5 for positive x
        ("q**3 - 28", 0),
        ("4 - q*q + v", -1),
        ("v**2 - 2*v + m", 1),  # (-1 - x)^2 + 2*(1 + x) + m, since v < -1
        ("v**3 + 1", -1),
        ("v**3 + 2", 0),
        ("cos(q) + q**3 + 2", 1),  # q is positive, and not measured from 3 beside cos(q)
        ("cos(q) - q**3 + 27", 0),
    ],
)
def test_symbols_are_measured_from_their_bounds(text, expected):
    """Where q > 3 and v < -1 polynomials have signs that they have not everywhere."""
    field = Field(NAMES, slots=2, positive=["m"])
    q, v = field["q"], field["v"]
    conditions = [Condition(q - 3, strict=True), Condition(-v - 1, strict=True)]
    element = written(field, text)
    assert Signs(field, strict=True, more=conditions).of(element.combine()) == expected
    assert Signs(field, strict=True).of(element.combine()) == 0


def test_numerators_vanish_nowhere_by_their_terms_or_as_factors():
    """M + q^2 has one sign; q divides q*v, which is given; q - v has no reason."""
    field = Field(NAMES, slots=2, positive=["m"])
    m, q, v = (field[name] for name in "mqv")
    signs = Signs(field, strict=True)
    assert signs.is_nonzero(m + q**2)
    assert signs.is_nonzero(q, [q * v])
    assert not signs.is_nonzero(q, [v])
    assert not signs.is_nonzero(q - v, [q * v])
    given = Signs(field, strict=True, more=[Condition(q - v, strict=True)])
    assert given.is_nonzero(q - v)
    assert given.is_nonzero(2 * q - 2 * v + 1)


def test_sums_of_squares_vanish_where_each_square_does():
    """Addends of one sign, or a definite form; nothing where a term has another sign."""
    field = Field(NAMES, slots=2, positive=["m"])
    m, q, v = (field[name] for name in "mqv")
    signs = Signs(field, strict=True)
    assert signs.squares(q**4 + m * v**2) == [m * v**2, q**4]
    assert len(signs.squares(q**2 + q * v + v**2)) == 2
    assert signs.squares(q**2 + 3 * q * v + v**2) == []
    assert signs.squares(q**4 - 2 * q**2 * v + v**2) == []  # zero on a parabola
    assert signs.squares(q**2 + v**2 + 1) != []
