"""Zero sets that fall apart: what holds on one branch of a level set need not on the others."""

import random
from fractions import Fraction
from itertools import permutations, product

import pytest

from coadjoint.errors import ClaimError, DerivationError
from coadjoint.exact import Condition, Field, Region
from coadjoint.exact.linear import nullspace
from coadjoint.prove import Verdict
from coadjoint.prove.certificate import Shown, failure_text
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.zero import UndecidedError, decide_zero
from tests.specs import prove_claims, spec

PROVED, REFUTED = Verdict.PROVED, Verdict.REFUTED

#: Free particles in a plane, their coordinates named and ordered by a test.
FREE = """
title = "A free particle"
routes = ["poisson"]
[poisson]
canonical = [["q1", "p1"], ["q2", "p2"]]
[variables]
q1 = { role = "coordinate" }
q2 = { role = "coordinate" }
p1 = { role = "coordinate" }
p2 = { role = "coordinate" }
[parameters]
a = { positive = true, default = 1 }
b = { positive = true, default = 2 }
R = { default = 1 }
[hamiltonian]
h = "p1^2/2 + p2^2/2"
[claims]
conserved = [{ claim = "INTEGRAL", where = [WHERE] }]
"""
BODY = """
title = "Free rigid body"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
mu = { role = "momentum" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
[hamiltonian]
h = "mu1^2/(2*I1) + mu2^2/(2*I2) + mu3^2/(2*I3)"
[claims]
conserved = [{ claim = "INTEGRAL", where = [WHERE] }]
"""
BELT = """
title = "Two wheels and a belt"
routes = ["nonholonomic", "hamel"]
[variables]
t1 = { role = "coordinate" }
t2 = { role = "coordinate" }
w1 = { role = "velocity", of = "t1" }
w2 = { role = "velocity", of = "t2" }
[parameters]
J = { positive = true, default = 1 }
R = { default = 1 }
[lagrangian]
l = "J*w1^2/2 + J*w2^2/2 - J*t1"
[constraints]
belt = "BELT"
[claims]
conserved = ["energy", "INTEGRAL"]
"""


#: A function of momenta, which free motions keep.
LEVELS = "(p2^2 + sqrt(p1^2 + 1))"


def claimed(text, integral, *where):
    """The claim that something is conserved where relations hold."""
    listed = ", ".join(f'"{each}"' for each in where)
    declared = spec(text.replace("INTEGRAL", integral).replace("WHERE", listed))
    return last_claim(prove_claims(declared))


def last_claim(certificate):
    """The last claim that something is conserved."""
    return [c for c in certificate.claims if c.kind == "conserved"][-1]


def last_conserved(text, *changes):
    """The same of a changed text."""
    return last_claim(prove_claims(spec(text, *changes)))


#: (p1^2 - p2 - 1)^2 + p2^2 + 1 is positive, and no rule of signs sees it.
EMPTY = "p1^4 - 2*p1^2*p2 - 2*p1^2 + 2*p2^2 + 2*p2 + 2"


@pytest.mark.parametrize(
    ("integral", "where", "verdict"),
    [
        ("p1*q1*p2", ["p2*q2"], REFUTED),  # d/dt = p1^2*p2 where q2 = 0
        ("q1", ["p1*q2"], REFUTED),
        ("q1*q2", ["p1*q2 - q1", "p1*p2"], REFUTED),  # p2 = 0: d/dt = p1*q2
        ("q1", ["p1^2 - 4*p2^2"], REFUTED),
        ("p1", ["p1*q2"], REFUTED),  # the motion leaves q2 = 0
        ("q1", ["p1^2*p2^3", "p1 - p2^2"], PROVED),  # p1 = p2 = 0
        ("q1*p2", ["p1^2*p2^2"], PROVED),
        ("q1*p2", ["p1*p2"], PROVED),
        ("q1", ["p1*(q2^2 + 1)"], PROVED),  # over the real numbers one branch
        ("q1 + q2", ["p1^2 + p1*p2 + p2^2"], PROVED),
        ("q1*q2", ["p1^4 + a*p2^4"], PROVED),
        ("q1", ["exp(p2)*p1"], PROVED),
        ("q1", ["sin(p2)*p1"], REFUTED),
        ("q2", ["p1 - sqrt(q1 - 100)"], REFUTED),  # random points have q1 < 100
        ("q1", ["(p1 - p2*cos(q2))*(p1 + p2*cos(q2))"], REFUTED),
        # two levels of a kept function; its root is seen when p1^2 is written by it
        ("q2*(H - 5)".replace("H", LEVELS), [f"({LEVELS} - 3)*({LEVELS} - 5)"], REFUTED),
        ("p1*(H - 5)".replace("H", LEVELS), [f"({LEVELS} - 3)*({LEVELS} - 5)"], PROVED),
        ("q1", ["p1^2*q2^2 - p1^2*q2^2*cos(p2)^2"], REFUTED),  # sin(p2) = 0
        ("q1", ["p1^2*exp(p2) - p1^2*exp(p2)*cos(a)^2"], PROVED),  # for almost all a, p1 = 0
        ("q1", ["sin(p2)*p1 - (1 - cos(p2))*p2"], REFUTED),  # reducible, and no factor shows it
    ],
)
def test_each_branch_of_a_level_set_counts(integral, where, verdict):
    """What is false on one branch is refuted there, what is true on all is proved."""
    found = claimed(FREE, integral, *where)
    assert found.verdict is verdict
    if verdict is REFUTED:
        assert found.counterexample
        assert found.defect not in ("", "0")


@pytest.mark.parametrize("names", list(permutations(["q1", "q2", "p1", "p2"])))
def test_names_and_their_order_decide_nothing(names):
    """All four symbols are renamed and declared in every order, and so are both functions."""
    new = dict(zip(["q1", "q2", "p1", "p2"], names, strict=True))
    old = [
        ("p1*q1*p2", ["p2*q2", "p2*p1*q1 - p2*q1"], REFUTED),
        ("q1*p2", ["p1*p2", "p2*(q1 - q2)"], REFUTED),
        ("q1*p2", ["p1*p2", "p1*p2*q1"], PROVED),
        ("q1", ["p1*(a + q2^2)", "p1*q2 - p1*q1"], PROVED),
    ]
    for integral, where, verdict in old:
        text = FREE.replace("INTEGRAL", integral).replace(
            "WHERE", ", ".join(f'"{each}"' for each in where[:: 1 if names[0] < "q" else -1])
        )
        renamed = "".join(new.get(part, part) for part in _words(text))
        assert last_claim(prove_claims(spec(renamed))).verdict is verdict, (integral, where)


def _words(text):
    """A text as names and what is between them."""
    word = ""
    for letter in text:
        if letter.isalnum() or letter == "_":
            word += letter
            continue
        yield word
        yield letter
        word = ""
    yield word


@pytest.mark.parametrize(("i", "j", "k"), list(permutations((1, 2, 3))))
def test_a_body_may_turn_about_either_axis(i, j, k):
    """Where mu_i mu_j = 0 no component is conserved, whatever the axes are called."""
    for n in (i, j, k):
        assert claimed(BODY, f"mu{n}", f"mu{i}*mu{j}").verdict is REFUTED
    assert claimed(BODY, f"mu{k}", f"mu{i}", f"mu{j}").verdict is PROVED


@pytest.mark.parametrize(
    ("belt", "integral", "verdict", "excluded"),
    [
        ("R*w1 == R*w2", "w1", REFUTED, "R not 0"),
        ("R*w1 == R*w2", "w1 - w2", PROVED, "R not 0"),
        ("J*w1 == J*w2", "w1 - w2", PROVED, ""),  # J is positive
        ("J*w1 == J*w2", "w1", REFUTED, ""),
        ("R*w1 == J*w2", "R*w1 - J*w2", PROVED, ""),
        ("R*w1 == J*w2", "w1", REFUTED, ""),
        ("t2*w1 == t2*w2", "w1", REFUTED, "t2 not 0"),  # at t2 = 0 there is no constraint
        ("t2*w1 == t2*w2", "w1 - w2", PROVED, "t2 not 0"),
        ("R*t1*w1 == R*t1*w2", "w1 - w2", PROVED, "R not 0, t1 not 0"),
    ],
)
def test_parameters_are_not_solved_for(belt, integral, verdict, excluded):
    """A belt drives both wheels; that its radius may be zero neither proves nor refutes."""
    for changes in ((), (("t1 = { role", "t3 = { role"), ('of = "t1"', 'of = "t3"'))):
        text = BELT.replace("BELT", belt).replace("INTEGRAL", integral)
        for old, new in changes:
            text = text.replace(old, new).replace("t1", "t3")
        certificate = prove_claims(spec(text))
        energy, own = (c for c in certificate.claims if c.kind == "conserved")
        assert own.verdict is verdict
        assert energy.verdict is PROVED
        stated = excluded.replace("t1", "t3") if changes else excluded
        assert stated in energy.method
        assert stated or "not 0" not in energy.method
        if own.counterexample:
            assert own.counterexample.get("R") != "0"


@pytest.mark.parametrize(
    ("where", "verdict"),
    [
        (["R*p1"], PROVED),  # for almost all R
        (["a*p1"], PROVED),
        (["R*p1", "R - 1"], PROVED),
        (["(R - 1)*p1", "R - 1"], REFUTED),  # where R = 1 this asks for nothing
        (["(a - R)*p1", "a - b", "R - b"], REFUTED),
        (["(a + R)*p1", "a - b", "R - b"], PROVED),
        (["a - 1"], REFUTED),
    ],
)
def test_relations_between_parameters_hold_where_they_are_stated(where, verdict):
    """A factor of parameters alone is dropped for almost all of them, not where it is stated."""
    found = claimed(FREE, "q1", *where)
    assert found.verdict is verdict
    if where == ["R*p1"]:
        assert found.method.endswith("R not 0")


@pytest.mark.parametrize(
    ("where", "text"),
    [
        (["q1 - a", "q1 + b"], "holds nowhere"),  # a and b are positive
        (["q1 - a", "q1 - R"], "a - R not 0 holds nowhere"),
        (["p1^2 + p2^2 + a"], "holds nowhere"),
        (["q1*q2 - 1", "q1*q2"], "holds nowhere"),
        (["p1^4 - 2*p1^2*p2 + 2*p2^2 + 1"], "holds nowhere"),  # (p1^2 - p2)^2 + p2^2 + 1
        ([EMPTY], "no point is found"),
    ],
)
def test_an_empty_level_set_decides_nothing(where, text):
    """Neither a true claim nor a false one is decided where nothing is."""
    for integral in ("p1", "q1"):
        with pytest.raises(UndecidedError, match=text):
            claimed(FREE, integral, *where)


def test_a_claim_with_a_pole_on_all_of_its_set_is_not_decided():
    """Where p1 = p2 = 0 the quotient q1/p2 has no value; elsewhere on p1 = 0 it is conserved."""
    with pytest.raises(UndecidedError, match="no point is found at which it has a value"):
        claimed(FREE, "q1/p2", "p1", "p2")
    found = claimed(FREE, "q1/p2", "p1")
    assert found.verdict is PROVED
    assert found.method.endswith("wherever p2 is not 0")


@pytest.mark.parametrize(
    ("integral", "where", "text"),
    [
        ("q1/p1", "p1", "no value anywhere"),  # its rate is 1 as a rational function
        ("p2/p1", "p1", "no point is found at which it has a value"),  # and of this one 0
        ("q1/(p1*p2)", "p1*p2", "no value anywhere"),
    ],
)
def test_a_claim_is_not_decided_where_its_rate_has_a_value_and_it_has_none(integral, where, text):
    """The pole of a claim is cancelled in its rate, and has no value there all the same."""
    with pytest.raises(UndecidedError, match=text):
        claimed(FREE, integral, where)


@pytest.mark.parametrize(("first", "verdict"), [("R - 2", PROVED), ("R + 2", REFUTED)])
def test_each_value_that_a_relation_gives_a_parameter_counts(first, verdict):
    """q1' = R p1/2 and q2' = p2: q1 p2 - q2 p1 is conserved at R = 2, and not at R = -2."""
    text = FREE.replace("p1^2/2 + p2^2/2", "R*p1^2/4 + p2^2/2")
    assert claimed(text, "q1*p2 - q2*p1", first).verdict is verdict
    for both in ("R^2 - 4", "(2 + R)*(R - 2)", "(a - 1)*(R - 2)*(R + 2)", "a*R^2 - 4*a"):
        found = claimed(text, "q1*p2 - q2*p1", both)
        assert found.verdict is REFUTED
        assert "not 0" not in found.method


def test_a_set_with_an_interior_has_points():
    """|p2| = p2 on half of the plane, where Newton's method has no slope to follow."""
    assert claimed(FREE, "q1*(sqrt(p2^2) - p2)", "sqrt(p2^2) - p2").verdict is PROVED
    assert claimed(FREE, "q1", "p1*(sqrt(p2^2) - p2)").verdict is REFUTED


@pytest.mark.parametrize("domain", [["q1 > 1", "q1 < 0"], ["p1^2 + p2^2 < -1"], ["a + b < 0"]])
def test_an_empty_domain_proves_nothing(domain):
    """Anything is true where no state is; not even p1 is called conserved there."""
    lines = "\n".join(f'c{n} = "{each}"' for n, each in enumerate(domain))
    text = FREE.replace("[claims]", f"[domain]\n{lines}\n[claims]")
    text = text.replace('{ claim = "INTEGRAL", where = [WHERE] }', '"p1"')
    with pytest.raises(UndecidedError, match=r"no point is found in \[domain\]"):
        prove_claims(spec(text))


def test_an_energy_without_values_proves_nothing():
    """The root of -1 - q1^2 is not real at any state."""
    text = FREE.replace("p1^2/2 + p2^2/2", "p1^2/2 + sqrt(-1 - q1^2)")
    text = text.replace('{ claim = "INTEGRAL", where = [WHERE] }', '"p2"')
    with pytest.raises(UndecidedError, match="at which the motion has a value"):
        prove_claims(spec(text))


@pytest.mark.parametrize(
    ("where", "domain", "verdict"),
    [
        ("p1*q2", "q2 > 0", PROVED),
        ("p1*q2", "q2 < 0", PROVED),
        ("p1*q2", "q2 > -1", REFUTED),
        ("p1*(q2 - 3)", "q2 > 5", PROVED),
        ("p1*(q2 - 6)", "q2 > 5", REFUTED),
        ("p1*(q2 + a)", "q2 > 0", PROVED),
        ("p1*(q1^2 + q2^2)", "q1^2 + q2^2 > 0.1", PROVED),
        ("p1*(q1^2 + q2^2 - R)", "q1^2 + q2^2 > R", PROVED),
        ("p1*cos(q2)", "cos(q2) > 0", PROVED),
        ("p1*cos(q2)", "cos(q2) >= 0", REFUTED),
        ("p1*q2", "q2 >= 0", REFUTED),
    ],
)
def test_branches_outside_the_domain_do_not_count(where, domain, verdict):
    """A factor that [domain] keeps from zero is dropped; one that may vanish at its edge is not."""
    text = FREE.replace("[claims]", f'[domain]\ninside = "{domain}"\n[claims]')
    assert claimed(text, "q1", where).verdict is verdict


@pytest.mark.parametrize(
    ("h", "where", "section", "verdicts"),
    [
        ("x^2/2 + y^2/2", "z", "0", (PROVED, PROVED)),
        ("x^2/2 + y^2/2", "a*z", "0", (PROVED, PROVED)),
        ("x^2/2 + y^2/2", "z*x", "0", (REFUTED, PROVED)),  # x = 0 is left
        ("x^2/2 + y^2/2", "z*(x^2 + y^2 + a)", "0", (PROVED, PROVED)),
        ("x^2/2 + y^2/2", "z*(x - y)", "0", (REFUTED, PROVED)),
        ("x^2/2 + y^2/2", "z - 1", "0", (PROVED, REFUTED)),
    ],
)
def test_what_a_reduction_keeps_is_kept_on_each_branch(h, where, section, verdicts):
    """The functions of [reduction] where vanish for ever, on whichever branch they begin."""
    found = [c.verdict for c in prove_claims(spec(reduced(h, where, section))).claims]
    kinds = [c.kind for c in prove_claims(spec(reduced(h, where, section))).claims]
    assert (
        tuple(v for v, kind in zip(found, kinds, strict=True) if kind == "reduction")[:2]
        == verdicts
    )


def test_a_section_on_a_pole_is_refused():
    """The Hamiltonian y^2/(2 z) has no value where z = 0."""
    with pytest.raises(DerivationError, match="the energy has a pole everywhere on the section"):
        prove_claims(spec(reduced("x^2/2 + y^2/(2*z)", "z", "0")))


def reduced(h, where, section):
    """A motion of x and y beside a number z that never changes."""
    return f"""
title = "An oscillator and a constant"
routes = ["poisson"]
[poisson]
brackets = {{ "{{x, y}}" = "1", "{{x, z}}" = "0", "{{y, z}}" = "0" }}
[variables]
x = {{ role = "coordinate" }}
y = {{ role = "coordinate" }}
z = {{ role = "coordinate" }}
[parameters]
a = {{ positive = true, default = 1 }}
[hamiltonian]
h = "{h}"
[reduction]
where = ["{where}"]
section = {{ z = "{section}" }}
"""


# -- against an independent judge --------------------------------------------------------

NAMES = ("w", "x", "y", "z")


def linear_form(source):
    """Coefficients of a linear form, not all zero."""
    while not any(form := [source.choice((0, 0, 1, -1, 2)) for _ in NAMES]):
        pass
    return form


def vanishes(relations, claim):
    """Whether a product of linear forms vanishes where others do, subspace by subspace.

    Each choice of a factor for every relation is a subspace, on which a product of linear forms
    vanishes exactly where one of them does.
    """
    for choice in product(*relations):
        rows = [{n: Fraction(x) for n, x in enumerate(form) if x} for form in choice]
        basis = nullspace(rows, len(NAMES))
        if all(any(_at(form, vector) for vector in basis) for form in claim):
            return False
    return True


def _at(form, vector):
    return sum(x * vector.get(n, 0) for n, x in enumerate(form))


def element(field, forms):
    """A product of linear forms."""
    result = field.one
    for form in forms:
        result *= field.sum(x * field[name] for x, name in zip(form, NAMES, strict=True))
    return result


@pytest.mark.parametrize(
    "seed", [*range(12), *(pytest.param(n, marks=pytest.mark.campaign) for n in range(12, 400))]
)
def test_arrangements_of_subspaces_agree_with_linear_algebra(seed):
    """Products of linear forms where others vanish: proved if and only if true, in any order."""
    source = random.Random(seed)
    relations = [
        [linear_form(source) for _ in range(source.randint(1, 3))]
        for _ in range(source.randint(1, 3))
    ]
    claim = [linear_form(source) for _ in range(source.randint(1, 2))]
    claim += source.sample([form for forms in relations for form in forms], 1)
    for names in (NAMES, NAMES[::-1], ("y", "w", "z", "x")):
        field = Field(names)
        ideal = Ideal(field, [element(field, forms) for forms in relations], "these = 0")
        decision = decide_zero([element(field, claim)], field, ideal)
        assert decision.verdict is (PROVED if vanishes(relations, claim) else REFUTED)
        if decision.point:
            point = dict.fromkeys(NAMES, Fraction(1)) | {
                name: Fraction(value) for name, value in decision.point.items()
            }
            values = {n: point[name] for n, name in enumerate(NAMES)}
            assert all(any(_at(f, values) == 0 for f in forms) for forms in relations)
            assert all(_at(form, values) != 0 for form in claim)


def test_a_component_where_slopes_vanish_is_found():
    """Where x*y = z and y*w = 0 there is the plane y = z = 0, off the graph x = z/y."""
    field = Field(["x", "y", "z", "w"])
    x, y, z, w = (field[name] for name in "xyzw")
    ideal = Ideal(field, [x * y - z, y * w], "these = 0")
    assert decide_zero([w * z], field, ideal).verdict is PROVED
    assert decide_zero([w], field, ideal).verdict is REFUTED
    assert decide_zero([z], field, ideal).verdict is REFUTED
    umbrella = Ideal(field, [x * y**2 - z**2], "x*y^2 = z^2")  # with its handle y = z = 0
    assert decide_zero([y], field, umbrella).verdict is REFUTED
    assert decide_zero([x * y**2 * w - z**2 * w], field, umbrella).verdict is PROVED


def test_positive_factors_are_dropped_from_regions_alone():
    """A condition of the region, not the wish of a caller, keeps a factor from zero."""
    field = Field(["x", "y"])
    x, y = field["x"], field["y"]
    assert decide_zero([x], field, Ideal(field, [x * y], "x*y = 0")).verdict is REFUTED
    field.region = Region(conditions=(Condition(y, strict=True),))
    assert decide_zero([x], field, Ideal(field, [x * y], "x*y = 0")).verdict is PROVED
    field.region = Region(conditions=(Condition(y, strict=False),))
    assert decide_zero([x], field, Ideal(field, [x * y], "x*y = 0")).verdict is REFUTED


@pytest.mark.parametrize("side", [1, -1])
def test_a_bound_gives_no_sign_where_a_symbol_is_not_measured_from_it(side):
    """The zero of q + exp(q) near -0.567 is inside q > -5, that of q - exp(-q) inside q < 5."""
    field = Field(["q", "x"], slots=2)
    q, x = field["q"], field["x"]
    factor = q + side * field.call("exp", side * q)
    field.region = Region(conditions=(Condition(side * q + 5, strict=True),))
    decision = decide_zero([x], field, Ideal(field, [x * factor], "x*(q + ...) = 0"))
    assert decision.verdict is REFUTED
    assert float(Fraction(decision.point["q"])) == pytest.approx(-0.5671432904 * side)
    field.region = Region(conditions=(Condition(q - 1, strict=True),))
    positive = x * (q + field.call("exp", side * q))
    assert decide_zero([x], field, Ideal(field, [positive], "x*(q + ...) = 0")).verdict is PROVED


def test_undecided_claims_name_the_system_and_the_claim():
    """The message says which claim, what is wrong with it and what to do; its status is 1."""
    with pytest.raises(ClaimError) as caught:
        claimed(FREE, "q1", "p1^2 + 1")
    text = str(caught.value)
    place = f"sample.toml:{caught.value.line}: claims.conserved[1].claim: "
    assert text.startswith(f"{place}undecided: q1 is conserved where p1^2 + 1 = 0: ")
    line, carets = text.splitlines()[-2:]
    assert line[carets.index("^") : len(carets)] == '"q1"'
    assert "Expected real points" in text
    assert caught.value.exit_status == 1
    assert caught.value.found == "q1 is conserved where p1^2 + 1 = 0"


def test_no_point_shows_anything_where_the_rank_drops_on_a_whole_branch():
    """Rows (x + y, y) that act on u: either u = 0, or both vanish, and there is no motion there.

    No factor of a relation is the determinant x^2 + y^2, which vanishes on the branch x = y = 0.
    """
    field = Field(["x", "y", "u"])
    x, y, u = (field[name] for name in field.names)
    rows = [(x + y) * u, y * u]
    assert decide_zero([u], field, Ideal(field, rows, "rows = 0")).verdict is REFUTED
    regular = Ideal(field, rows, "rows = 0", nonzero=[x**2 + y**2])
    proof = decide_zero([u], field, regular)
    assert proof.verdict is PROVED
    assert "x^2 + y^2 not 0" in proof.method
    assert decide_zero([u - x], field, regular).verdict is REFUTED


def test_a_determinant_vanishes_at_no_point_that_is_shown(monkeypatch):
    """The only real zero of a definite quartic is the origin, where x is zero; no ideal tells."""
    monkeypatch.setattr("coadjoint.prove.points.ON_ZERO_SET", 2)  # each takes many steps
    field = Field(["x", "y", "u"])
    x, y, u = (field[name] for name in field.names)
    quartic = [x**4 + x**2 * y**2 + x * y**3 + y**4]
    assert decide_zero([u], field, Ideal(field, quartic, "that = 0")).verdict is REFUTED
    with pytest.raises(UndecidedError, match="that = 0"):
        decide_zero([u], field, Ideal(field, quartic, "that = 0", nonzero=[x]))


def test_a_pole_at_a_point_that_is_found_by_iteration_is_no_value():
    """Where sin(r) = 0 and cos(q) = -q*sin(r), cos(q) is 0, and 1/cos(q) has a pole.

    In numbers it is 1e50, which would refute.
    """
    field = Field(["q", "r"], slots=8)
    cosine, sine = field.call("cos", field["q"]), field.call("sin", field["r"])
    ideal = Ideal(field, [cosine + field["q"] * sine, sine], "both = 0")
    with pytest.raises(UndecidedError, match="has a value"):
        decide_zero([field["r"] / cosine], field, ideal)
    assert decide_zero([field["r"] - 1], field, ideal).verdict is REFUTED


KNIFE = """
title = "A knife edge"
routes = ["nonholonomic", "hamel"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
z = { role = "coordinate" }
u = { role = "velocity", of = "x" }
v = { role = "velocity", of = "y" }
w = { role = "velocity", of = "z" }
[lagrangian]
l = "u^2/2 + v^2/2 + w^2/2"
[constraints]
edge = "u*sin(z) == v*cos(z)"
[claims]
conserved = ["w", "u"]
"""


def test_nothing_is_excluded_that_never_vanishes():
    """The squares of a sine and a cosine add up to 1; where both are 0 there is no point at all."""
    claims = prove_claims(spec(KNIFE)).claims
    excluded = {claim.method.partition("edge = 0")[2] for claim in claims}
    assert excluded == {"", ", wherever sin(z) is not 0"}  # by which the edge is solved
    (refuted,) = [claim for claim in claims if claim.verdict is REFUTED]
    assert "." in refuted.counterexample["u"]  # u = v cos(z)/sin(z) has no exact value there
    assert refuted.method == "50-digit counterexample, where edge = 0"


def test_a_power_of_what_is_excluded_is_not_named_again():
    """Two constraints that agree where y (z - 1) = 0: y not 0 and z - 1 not 0 say it all."""
    edges = 'first = "w == y*u"\nsecond = "z*w == y*u"'
    text = KNIFE.replace('edge = "u*sin(z) == v*cos(z)"', edges)
    (energy,) = [
        c for c in prove_claims(spec(text)).claims if c.statement == "the energy is conserved"
    ]
    assert energy.method.endswith("of second = 0, y not 0, z - 1 not 0")


@pytest.mark.parametrize(
    ("integral", "where", "leaves"),
    [("p1", "q1 - p2", True), ("q1", "p1*p2", False), ("q1", "q2", True), ("p2", "p1*q1", True)],
)
def test_a_set_that_the_motion_leaves_is_named(integral, where, leaves):
    """The momenta are conserved everywhere; where q1 = p2 is not, and the rate shown is its."""
    found = claimed(FREE, integral, where)
    assert found.verdict is REFUTED
    assert (found.shown is Shown.RATE_OF_RELATION) is leaves
    assert found.as_record()["method"].endswith(": the motion leaves this set") is leaves
    assert (
        "the motion leaves this set: the rate of a relation is" in failure_text(found)
    ) is leaves


@pytest.mark.parametrize(("empty", "other"), [(EMPTY, "p2"), (EMPTY.replace("p1", "q2"), "p2")])
def test_a_branch_without_points_hides_no_refutation(empty, other):
    """q1 changes where p2 = 0; whether the other factor comes first decides nothing."""
    for text in (f"({empty})*{other}", f"{other}*({empty})"):
        assert claimed(FREE, "q1", text).verdict is REFUTED
        with pytest.raises(UndecidedError, match="no point is found"):
            claimed(FREE, "q2*p1", text)
