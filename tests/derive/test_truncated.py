"""The equations of entries of matrices: an inertia that is no Laplacian is refused."""

from fractions import Fraction
from pathlib import Path

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.derive.indexed import derive_family
from coadjoint.derive.sine_bracket import multiply_waves
from coadjoint.derive.truncated import multiply_out, tell_motion
from coadjoint.errors import DerivationError
from coadjoint.prove import prove
from coadjoint.spec.reader import read_spec_text
from tests.spec.test_truncated import TEXT, TORUS
from tests.specs import shipped

FLUIDS = ("zeitlin_su_n", "zeitlin_torus")


def family_of(text):
    """The equations of an entry."""
    return derive_family(derive(read_spec_text(text, Path("fluid.toml"))))


def test_the_scale_is_that_of_the_inertia():
    """In parameters, and in the number of entries, whose root N is."""
    family = family_of(TEXT)
    assert family.matrices.scale == sympy.Symbol("k")
    family = family_of(TEXT.replace("k*l*(l + 1)", "k*(3*l + 3*l^2)/N^2"))
    assert sympy.simplify(family.matrices.scale - 3 * sympy.Symbol("k") / family.count[0]) == 0
    assert dict(tell_motion(family))["3*k/N^2*L V"] == "W"


@pytest.mark.parametrize("inertia", ["k*l", "l*(l + 1) + k", "k"])
def test_an_inertia_that_is_no_laplacian_is_refused(inertia):
    """Kernels solve an equation on each diagonal, which is that of the Laplacian alone."""
    with pytest.raises(DerivationError, match=r"expected a multiple of l\*\(l \+ 1\)") as error:
        family_of(TEXT.replace("k*l*(l + 1)", inertia))
    assert repr(inertia) in str(error.value)
    with pytest.raises(DerivationError, match="expected a multiple"):
        prove(read_spec_text(TEXT.replace("k*l*(l + 1)", inertia), Path("fluid.toml")))


def test_the_scale_on_the_torus_is_that_of_waves():
    """Over k1^2 + k2^2; what differs along both circles is refused."""
    family = family_of(TORUS)
    assert family.matrices.scale == sympy.Symbol("k")
    assert dict(tell_motion(family))["L T[k]"] == "(k1^2 + k2^2)*T[k]"
    for inertia in ("k*(k1^2 + 2*k2^2)", "k*(k1^2 + k2^2) + 1", "k"):
        with pytest.raises(DerivationError, match=r"a multiple of k1\^2 \+ k2\^2") as error:
            family_of(TORUS.replace("k*(k1^2 + k2^2)", inertia))
        assert "Write it as '4*pi*(k1^2 + k2^2)/N'." in str(error.value)


def compare_with_waves(window, inertia=""):
    """Whether rates by the bracket of u(N) are those by the sine bracket, and how many move."""
    family = shipped("zeitlin_torus").family
    equations = derive(family.windows[window])
    waves = multiply_waves(equations, inertia or family.truncation, "N")
    field, rates = equations.setting.field, map(equations.close, equations.exact.rates)
    pairs = list(zip(rates, waves, strict=True))
    return [field.is_zero(a - b) for a, b in pairs], sum(not field.is_zero(b) for _, b in pairs)


def test_structure_constants_and_the_sine_bracket_are_one_motion():
    """For 3 rows; with half the velocity they are not."""
    same, moving = compare_with_waves(0)
    assert all(same)
    assert moving == 9
    assert not all(compare_with_waves(0, "8*pi*(k1^2 + k2^2)/N")[0])


@pytest.mark.campaign
def test_structure_constants_and_the_sine_bracket_are_one_motion_for_five_rows():
    """With nested square roots: sines of fifths of a turn."""
    same, moving = compare_with_waves(1)
    assert all(same)
    assert moving == 25


@pytest.mark.parametrize("name", FLUIDS)
@pytest.mark.parametrize("window", [0, 1])
def test_structure_constants_and_products_of_matrices_are_one_motion(name, window):
    """Rates by the bracket of u(N), and by commutators; some are not zero."""
    equations = derive(shipped(name).family.windows[window])
    field, compared = equations.setting.field, 0
    for rate, product in zip(equations.exact.rates, multiply_out(equations), strict=True):
        assert field.is_zero(equations.close(rate) - product)
        compared += not field.is_zero(product)
    assert compared == len(equations.variables)


@pytest.mark.parametrize("name", FLUIDS)
@pytest.mark.parametrize("window", [0, 1])
def test_the_energy_of_loops_is_the_one_that_is_written_out(name, window):
    """Half the sum of ``W_ij V_ij``, where V is the derivative of the energy by W."""
    spec = shipped(name)
    family, equations = derive_family(derive(spec)), derive(spec.family.windows[window])
    field, energy, state = equations.setting.field, equations.exact.energy, equations.setting.state
    (total,) = family.totals
    (added,) = total.sums
    assert added.term == family.matrices.state * family.matrices.velocity
    share = Fraction(str(total.formula.coeff(added.symbol)))
    slopes = field.gradient(energy, state)
    whole = field.sum(field[name] * slope for name, slope in zip(state, slopes, strict=True))
    assert field.is_zero(whole * field.number(share) - energy)
    assert not field.is_zero(energy)
