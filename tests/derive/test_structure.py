"""The bracket of a system: its sign, its order, and declared brackets that are none."""

import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.derive.structure import momentum_algebra, poisson_structure
from coadjoint.errors import AlgebraError
from tests.derive.test_poisson import PAIRS
from tests.specs import RIGID_BODY, prove_claims, shipped, spec

TABLE = """
title = "a table"
routes = ["poisson"]
[variables]
x = { role = "coordinate", shape = [3] }
[parameters]
k = { default = 1 }
[hamiltonian]
h = "dot(x, x)/2"
[poisson.brackets]
"{x1, x2}" = "x3"
"{x2, x3}" = "k*x1*x2"
"{x3, x1}" = "x1"
"""
FIELD = """
title = "a magnetic field"
routes = ["poisson"]
[poisson]
canonical = [["q", "p"]]
magnetic = { "{p1, p2}" = "q3", "{p2, p3}" = "q1^2", "{p3, p1}" = "-q2" }
[variables]
q = { role = "coordinate", shape = [3] }
p = { role = "coordinate", shape = [3] }
[hamiltonian]
h = "dot(p, p)/2"
"""


def test_left_is_minus_and_right_is_plus():
    """{Pi1, Pi2} = -Pi3 in the body and +Pi3 in space, on top of the same algebra."""
    tensors = {}
    for side in ("left", "right"):
        text = RIGID_BODY.replace('name = "so(3)"', f'name = "so(3)"\ninvariance = "{side}"')
        setting = make_setting(spec(text))
        tensors[side] = poisson_structure(setting).tensor
        assert tensors[side][0][1] == (-1 if side == "left" else 1) * setting.field["Pi3"]
        assert (
            derive(spec(text), "lie-poisson", setting=setting).exact.poisson_tensor
            == (tensors[side])
        )


@pytest.mark.parametrize("first", ["Pi", "P"])
def test_the_bracket_follows_the_order_of_the_state(first):
    """{Pi1, P2} = -P3 and {P_i, P_j} = 0, whichever of them is declared first."""
    text = shipped("kirchhoff").path.read_text()
    lines = [line for line in text.splitlines() if line.startswith(("Pi  ", "P   "))]
    if first == "P":
        text = text.replace("\n".join(lines), "\n".join(reversed(lines)))
    structure = poisson_structure(make_setting(spec(text)))
    assert structure.names[0] == f"{first}1"
    x = {name: structure.field[name] for name in structure.names}
    assert structure.bracket(x["Pi1"], x["P2"]) == -x["P3"]
    assert structure.bracket(x["Pi1"], x["Pi2"]) == -x["Pi3"]
    assert structure.bracket(x["P1"], x["P2"]) == 0


def test_the_momentum_algebra_holds_the_advected_quantities():
    """The heavy top lives on se(3)*, the rigid body on so(3)*."""
    top, body = (momentum_algebra(make_setting(shipped(n))) for n in ("heavy_top", "rigid_body"))
    assert (top.name, top.dimension) == ("so(3) (s) R^3", 6)
    assert (body.name, body.dimension) == ("so(3)", 3)


# -- refusals -------------------------------------------------------------------------------------


@pytest.mark.parametrize("ask", [derive, prove_claims])
def test_a_table_that_violates_jacobi_is_refused_with_its_triple(ask):
    """File, line, key, the three coordinates and what is left."""
    with pytest.raises(AlgebraError) as caught:
        ask(spec(TABLE))
    error = caught.value
    assert str(error) == (
        "sample.toml:11: poisson.brackets: sample: the bracket violates the Jacobi identity: "
        "{x1, {x2, x3}} + cyclic = x1*x3*k - x3; expected 0. "
        "Check the brackets between x1, x2 and x3.\n"
        '    "{x1, x2}" = "x3"\n'
        "                 ^^^^"
    )
    assert error.parts["triple"] == ["x1", "x2", "x3"]
    assert (error.parts["path"], error.parts["line"]) == ("sample.toml", 11)
    assert error.parts["key"] == "poisson.brackets"
    assert error.parts["defect"] == "x1*x3*k - x3"


@pytest.mark.parametrize(
    ("entry", "verdict"),
    [
        ("sin(x2)", "violates"),
        ("sqrt(x2 + 1 + 2*sqrt(x2)) - sqrt(x2)", "is not known to satisfy"),
        ("exp(2*x2) - exp(x2)^2 + sin(x2)^2 + cos(-x2)^2", ""),
    ],
)
def test_a_violation_is_shown_at_a_point(entry, verdict):
    """{x1, x2} = 1 and {x2, x3} = f(x2) need f' = 0: it is not, may be not, or is."""
    table = [('= "x3"', '= "1"'), ('"k*x1*x2"', f'"{entry}"'), ('"{x3, x1}" = "x1"', "")]
    if not verdict:
        assert derive(spec(TABLE, *table)).rates
        return
    with pytest.raises(AlgebraError, match=f"the bracket {verdict} the Jacobi identity"):
        derive(spec(TABLE, *table))


def test_the_table_that_is_mended_is_accepted():
    """With k x1 in the place of k x1 x2, and one bracket less, it is an algebra for every k."""
    assert prove_claims(spec(TABLE, ('"k*x1*x2"', '"k*x1"'), ('"{x3, x1}" = "x1"', ""))).holds


@pytest.mark.parametrize(
    ("change", "defect"),
    [(("q1^2", "q1^2"), "2*q1"), (('"-q2"', '"q2"'), "2*q1 + 2")],
)
def test_a_field_with_sources_is_refused(change, defect):
    """The divergence of B is shown."""
    with pytest.raises(
        AlgebraError, match=r"sample.toml:6: poisson.magnetic: .*not closed"
    ) as caught:
        derive(spec(FIELD, change))
    assert caught.value.parts["defect"] == defect
    assert caught.value.parts["triple"] == ["p1", "p2", "p3"]
    assert caught.value.parts["key"] == "poisson.magnetic"
    assert defect in str(caught.value)


def test_a_field_without_sources_is_accepted():
    """Div B = 0: 1 - 1 for q3 and -q2, and q2^2 along the first axis."""
    assert prove_claims(spec(FIELD, ("q1^2", "q2^2"))).holds


def test_a_field_that_depends_on_momenta_is_refused():
    """B(u) is no field: the term, the momentum and the coordinates it may depend on."""
    with pytest.raises(AlgebraError, match=r"sample.toml:6: poisson.magnetic: ") as caught:
        derive(spec(PAIRS, ("(1 + x^2)", "(1 + u^2)")))
    assert "{u, v} = u^2*B + B depends on u; expected a function of x, y alone" in str(caught.value)
    assert caught.value.parts["found"] == "u"
