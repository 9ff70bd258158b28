"""Claims about a field in a plane: its bracket, and what truncated series keep."""

import re
from dataclasses import replace

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.derive.fields.jets import jets_of
from coadjoint.derive.fields.structure import field_operator
from coadjoint.derive.fields.torus import make_torus
from coadjoint.errors import ClaimError, DerivationError
from coadjoint.prove import Verdict, prove
from coadjoint.prove.fields import decide_density, decide_jacobi, decide_skew
from coadjoint.prove.torus import find_aliases, find_defect
from coadjoint.spec import read_spec_text
from tests.specs import emitted, shipped

TEXT = shipped("euler_2d").path.read_text(encoding="utf-8")


def bracket():
    """The bracket of the vorticity, and its jets."""
    setting = emitted("euler_2d").setting
    return field_operator(setting), jets_of(setting).only(setting.state)


def read(old, new):
    """The spec with another text."""
    assert old in TEXT
    return read_spec_text(TEXT.replace(old, new), "plane.toml")


def test_all_claims_are_proved():
    """The bracket, Casimirs, densities with two fluxes, and truncated series."""
    certificate = prove(shipped("euler_2d")).require()
    said = {claim.statement.partition(", with")[0] for claim in certificate.claims}
    assert certificate.count(Verdict.PROVED) == len(certificate.claims) == 12
    assert {"the energy is conserved", "Z is conserved"} <= said
    assert "C is conserved" not in said
    found = [each.statement.partition(", with")[0] for each in certificate.findings]
    assert found == [
        "C may change by the waves that are left out",
        "the Jacobi identity of the bracket fails",
    ]


def test_the_commutator_of_velocities_decides_the_sign():
    """Of u = (psi_y, -psi_x): [u, v] = u.grad v - v.grad u has minus the bracket {psi, eta}."""
    x, y = sympy.symbols("x y")
    psi, eta = (sympy.Function(name)(x, y) for name in ("psi", "eta"))

    def velocity(f):
        return f.diff(y), -f.diff(x)

    def along(u, f):
        return u[0] * f.diff(x) + u[1] * f.diff(y)

    u, v = velocity(psi), velocity(eta)
    commutator = [along(u, b) - along(v, a) for a, b in zip(u, v, strict=True)]
    poisson = psi.diff(x) * eta.diff(y) - psi.diff(y) * eta.diff(x)
    expected = velocity(-poisson)
    assert all(sympy.expand(a - b) == 0 for a, b in zip(commutator, expected, strict=True))


def test_the_motion_is_the_curl_of_the_equation_of_an_ideal_fluid():
    """The curl of u_t + u.grad u + grad p = 0, w being that of u."""
    x, y, t = sympy.symbols("x y t")
    psi, p = sympy.Function("psi")(x, y, t), sympy.Function("p")(x, y, t)
    u = (psi.diff(y), -psi.diff(x))
    parts = [
        each.diff(t) + u[0] * each.diff(x) + u[1] * each.diff(y) + p.diff(name)
        for each, name in zip(u, (x, y), strict=True)
    ]
    curl = parts[1].diff(x) - parts[0].diff(y)
    w = u[1].diff(x) - u[0].diff(y)
    equations = emitted("euler_2d")
    names = {"w": w, "psi": psi}
    values = {
        sympy.Symbol(f"{name}_{c}"): value.diff(c) for name, value in names.items() for c in (x, y)
    }
    (rate,) = equations.exact.rates
    moved = equations.setting.field.to_sympy(rate).subs(values)
    assert sympy.expand(curl - (w.diff(t) - moved)) == 0
    assert sympy.expand(curl - (w.diff(t) + moved)) != 0


@pytest.mark.parametrize("part", [0, 1])
def test_a_wrong_sign_of_one_derivative_breaks_antisymmetry(part):
    """Of w_y D_x or of w_x D_y alone; of both the bracket stays one."""
    operator, jets = bracket()
    terms = list(operator[0][0])
    assert decide_skew(operator, jets).verdict is Verdict.PROVED
    assert decide_jacobi(operator, jets).verdict is Verdict.PROVED
    terms[part] = replace(terms[part], left=-terms[part].left)
    assert decide_skew(((tuple(terms),),), jets).verdict is Verdict.REFUTED


def test_another_factor_breaks_the_jacobi_identity():
    """W w_y D_x - w w_x D_y, that is {w^2/2, .}, is Poisson; with w_x^2 before it, it is not."""
    operator, jets = bracket()
    w, w_x = jets.field["w"], jets.field["w_x"]

    def turned(factor):
        # {f, .} = f_y D_x - f_x D_y is antisymmetric for any f
        f_x, f_y = jets.total(factor), jets.total(factor, 0, 1)
        first, second = operator[0][0]
        return (((replace(first, left=f_y), replace(second, left=-f_x)),),)

    assert decide_jacobi(turned(w), jets).verdict is Verdict.PROVED
    spoiled = turned(w_x)
    assert decide_skew(spoiled, jets).verdict is Verdict.PROVED
    assert decide_jacobi(spoiled, jets).verdict is Verdict.REFUTED


@pytest.mark.parametrize("name", ["w_x", "psi"])
def test_a_density_that_is_not_conserved_is_refuted(name):
    """The squares of a slope and of the stream function."""
    equations = emitted("euler_2d")
    field = equations.setting.field
    if name == "psi":
        with pytest.raises(DerivationError, match="no multiple of"):
            decide_density(equations, [field["psi"] ** 2])
        return
    assert decide_density(equations, [field[name] ** 2]).verdict is Verdict.REFUTED


def test_wrong_claims_are_refused():
    """A Casimir with derivatives, and a density."""
    with pytest.raises(ClaimError, match="w_x\\^2 is a Casimir"):
        prove(read('"exp(w)"]', '"w_x^2"]')).require()
    with pytest.raises(ClaimError, match="integral of C is conserved"):
        prove(read('expression = "w^3"', 'expression = "w_x^2*w"')).require()


def test_what_the_field_does_not_keep_its_series_do_not_keep():
    """The square of a slope has a linear variation, and both claims of it are refuted."""
    spec = read('expression = "w^2/2"', 'expression = "w_x^2/2"')
    claims = [each for each in prove(spec).claims if "Z" in each.statement.split()]
    claims += [each for each in prove(spec).claims if "integral of Z" in each.statement]
    assert {each.verdict for each in claims} == {Verdict.REFUTED}
    assert any("N > 3 K" in each.statement for each in claims)


def test_waves_come_back_if_there_are_too_few_points():
    """3 K < N strictly: N = 3 K has false waves."""
    assert find_aliases(10, 3) == []
    assert find_aliases(9, 3) == [-6, 6]
    waves = ((2, 0), (1, 1), (-2, 0))
    assert find_defect(waves, most=3) == 0
    assert find_defect(waves, most=2) != 0


def test_densities_of_a_plane_may_call_functions():
    """Each function of the vorticity is a Casimir of the fluid, and is not kept by its waves."""
    text = shipped("euler_2d").path.read_text(encoding="utf-8")
    text = re.sub(r"(?s)\[observables\].*?\n\n", '[observables]\nQ = "exp(w)"\n\n', text)
    certificate = prove(
        read_spec_text(re.sub("conserved = .*", 'conserved = ["Q"]', text), "w.toml")
    )
    (claim,) = (c for c in certificate.claims if c.statement == "the integral of Q is conserved")
    assert claim.verdict is Verdict.PROVED
    assert [f for f in certificate.findings if f.statement.startswith("Q may change")]


def test_a_sum_of_squares_is_expected():
    """Factors of the wrong sign, mixed derivatives, and none at all."""
    old = '"(psi_x^2 + psi_y^2)/2"'
    with pytest.raises(DerivationError, match="expected a positive one"):
        derive(read(old, '"(psi_x^2 - psi_y^2)/2"'))
    with pytest.raises(DerivationError, match="expected even"):
        derive(read(old, '"(psi_x^2 + psi_y^2 + psi_x*psi_y)/2"'))
    with pytest.raises(DerivationError, match="no linear operator"):
        derive(read(old, '"(psi_x^2 + psi_y^4)/2"'))
    with pytest.raises(DerivationError, match="no derivatives of the stream function"):
        make_torus(derive(read(old, '"psi^2/2"')))
