# ruff: noqa: E501 - a row of the table of mistakes is one line
"""The tables [space], [profiles] and [diffeomorphisms], and the role strain."""

from fractions import Fraction

import pytest

from coadjoint.errors import SpecError
from coadjoint.spec import read_spec_text
from tests.specs import RIGID_BODY, shipped

STRAND = shipped("spin_chain").path.read_text(encoding="utf-8")
MAGNET = shipped("landau_lifshitz").path.read_text(encoding="utf-8")
KDV = shipped("kdv").path.read_text(encoding="utf-8")
PLANE = shipped("euler_2d").path.read_text(encoding="utf-8")


def read(text, **sizes):
    """A spec of a text."""
    return read_spec_text(text, "fields.toml", sizes)


def test_a_coordinate_has_a_length_points_and_derivatives():
    """Names of derivatives are those of books: Xi_s, with the components Xi1_s, Xi2_s, Xi3_s."""
    space = shipped("spin_chain").space
    assert (space.name, space.length, space.size, space.order) == ("s", "L", 256, 4)
    jets = {each.name: each.components for each in space.jets}
    assert jets["Xi_s"] == ("Xi1_s", "Xi2_s", "Xi3_s")
    assert {"Pi_s", "Omega_s"} < jets.keys()
    assert shipped("rigid_body").space is None
    assert shipped("rigid_body").jets == ()


def test_a_strain_is_advected_by_the_adjoint_representation():
    """It is part of the state and spans the algebra."""
    (strain,) = (v for v in shipped("spin_chain").state if v.strain)
    assert (strain.name, strain.role, strain.representation.name) == ("Xi", "advected", "adjoint")


def test_another_number_of_points_is_chosen_where_a_spec_is_loaded():
    """As with an index, by the name of the coordinate."""
    assert read(STRAND, s=64).space.size == 64


@pytest.mark.parametrize(
    ("text", "old", "new", "message", "fix"),
    [
        (STRAND, 'length = "L"', 'length = "M"', "there is no parameter 'M'", "below it M = "),
        (STRAND, "L = { positive = true,", "L = {", "may be negative", "positive = true"),
        (STRAND, 'length = "L"', 'length = "K"', "is no scalar", "Write K = "),
        (STRAND, "order = 4 }", 'order = 4 }\nr = { length = "L" }', "no maps move them", "Remove"),
        (PLANE, "\ny = {", '\nz = { length = "Lx" }\ny = {', "3 coordinates", "Remove the others"),
        (PLANE, "\ny = {", "\nyy = {", "has 2 letters", "Write x and y"),
        (PLANE, "Ly\", size = 32 }", "Ly\", size = 32, order = 6 }", "a plane has order = 6", "Remove order"),
        (PLANE, "Ly\", size = 32 }", "Ly\", size = 32, ends = \"free\" }", "a plane has ends = 'free'", "Remove ends"),
        (PLANE, "[diffeomorphisms]", "[diffeomorphisms]\ncentral = \"Lx\"", "central charge", "Remove central"),
        (PLANE, "[profiles]\nw = \"", "[profiles]\nw = \"z + ", "z", "x"),
        (STRAND, "order = 4", "order = 3", "order", "2, 4, 6 or 8"),
        (STRAND, "order = 4", 'order = 6, ends = "free"', "at free ends have the order 6", "Write order = 4"),
        (STRAND, "order = 4", 'order = 4, ends = "open"', "ends", "'free'"),
        (STRAND, "order = 4", 'order = 4, ends = "free"', "other densities flow", "Remove it"),
        (MAGNET, "order = 4", 'order = 4, ends = "clamped"', "clamped ends, and no strain", 'Write ends = "periodic"'),
        (STRAND.replace(', "P"]', ']\ncasimirs = ["Xi1"]'), "order = 4", 'order = 4, ends = "free"', "Casimirs are claimed", "Remove them"),
        (STRAND, "[claims]", "[forces]\nOmega = \"-Omega\"\n\n[claims]", "[space] and [forces]", "Remove"),
        (STRAND, '"P"]', '{ claim = "P", where = ["Xi1"] }]', "level set", "Remove where"),
        (STRAND, "dot(Xi, diag(K)*Xi)/2", "dot(Xi_ss, Xi_ss)/2", "'Xi_ss' is a derivative of order 2, and fewer", "Write derivatives = 2 in [space]."),
        (STRAND, "dot(Xi, diag(K)*Xi)/2", "dot(Xi_sssss, Xi)/2", "'Xi_sssss' is a derivative of order 5", "derivatives up to 4"),
        (STRAND, "dot(Xi, diag(K)*Xi)/2", "dot(Xi_st, Xi)/2", "'Xi_st' is not declared", "Did you mean 'Xi_s'?"),
        (KDV, "m^3/2 - c*m_s^2/2", "m^3/2 + c*m*m_ss/2", "'m_ss' is a derivative of order 2", "Write derivatives = 2 in [space]."),
        (STRAND, "order = 4", 'order = "fourier"', "found 'fourier'; expected 2, 4, 6 or 8", 'derivatives="fourier"'),
        (STRAND, "Pi = \"vector(cos(2*pi*s/L), sin(2*pi*s/L)/2, 1)\"", 'Pi = "cos(s)"', "a scalar", "vector(a, b, c)"),
        (STRAND, "[profiles]\nPi", "[profiles]\nPhi", "there is no field 'Phi'", "Did you mean"),
        (STRAND, "[profiles]\nPi = \"vector(cos(2*pi*s/L)", "[profiles]\nPi = \"vector(cos(2*pi*s/Pi1)", "'Pi1' is a momentum", "parameters"),
        (STRAND, "default = [3, 2, 1], ", "", "'K' has no default", "default for each parameter"),
        (STRAND, "Xi    = { role = \"strain\"", "Psi = { role = \"strain\" }\nXi    = { role = \"strain\"", "2 strains", "one, along"),
        (STRAND, "\"hamilton-pontryagin\"]", "\"clebsch\"]", "moves no fields", "hamilton-pontryagin"),
        (RIGID_BODY, "Pi = {", "Xi = { role = \"strain\" }\nPi = {", "without [space]", "Write [space]"),
        (RIGID_BODY, "[lagrangian]", "[profiles]\nPi = \"1\"\n\n[lagrangian]", "without [space]", "Remove [profiles]"),
        (RIGID_BODY, "[variables]", "[diffeomorphisms]\n\n[variables]", "both [algebra] and [diff", "one of them"),
        (KDV, "[space]\ns = { length = \"L\", size = 256, order = 6 }\n", "", "no circle", "Write [space]"),
    ],
)  # fmt: skip
def test_mistakes_are_shown_with_the_likely_fix(text, old, new, message, fix):
    """Where, what was found, and what to do."""
    assert old in text
    with pytest.raises(SpecError) as error:
        read(text.replace(old, new))
    assert message in str(error.value)
    assert fix in str(error.value)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[0.5, 3]", "[0.5, 3, 0.5]", "the value 1/2 is there twice"),
        ("[0.5, 3]", '["x"]', "an exact number"),
        ("order = 4 }", 'order = 4, ends = "free" }', "there is no circle.*Remove values"),
    ],
)
def test_values_of_a_spectral_parameter_that_are_none(old, new, message):
    """Twice, no number, and without a circle; whether L is finite there is seen when derived."""
    text = shipped("spin_chain_chiral").path.read_text(encoding="utf-8")
    if "ends" in new:
        text = text.replace('"energy", "P", "M"', '"energy"')
    assert old in text
    with pytest.raises(SpecError, match=f"(?s){message}"):
        read(text.replace(old, new))
    assert read(text.replace("[0.5, 3]", '["1/3"]')).lax.values == (Fraction(1, 3),)


def test_a_plane_has_two_coordinates_and_mixed_derivatives():
    """Named in the order of the coordinates."""
    space = read(PLANE.replace('Lx", size = 32', 'Lx", size = 32, derivatives = 2')).space
    assert space.coordinates == ("x", "y")
    names = {each.name for each in space.jets if each.of.name == "w"}
    assert names == {"w_x", "w_y", "w_xx", "w_xy", "w_yy"}
    sizes = read(PLANE, x=8, y=9).space
    assert (sizes.size, sizes.across.size) == (8, 9)


def test_derivatives_in_a_plane_take_part_in_units():
    """psi_x is psi over the unit of x."""
    text = PLANE.replace('Lx", size = 32', 'Lx", size = 32, unit = "m"')
    text = text.replace('Ly", size = 32', 'Ly", size = 32, unit = "km"')
    text = text.replace('psi = { role = "velocity"', 'psi = { role = "velocity", unit = "m^2/s"')
    with pytest.raises(SpecError, match="m"):
        read(text)
    same = text.replace('unit = "km"', 'unit = "m"')
    assert read(same).space.across.unit == "m"


@pytest.mark.parametrize(("sizes", "message"), [({"i": 4}, "no coordinate"), ({"s": 0}, "integer")])
def test_sizes_that_are_none(sizes, message):
    """Another name, or no number of points."""
    with pytest.raises(SpecError, match=message):
        read_spec_text(STRAND, "fields.toml", sizes)


def test_more_derivatives_are_named_if_they_are_declared():
    """With derivatives = 2 a density may name S_ss."""
    text = shipped("landau_lifshitz").path.read_text(encoding="utf-8")
    text = text.replace("dot(S_s, S_s)/2", "-dot(S, S_ss)/2")
    with pytest.raises(SpecError, match="S_ss"):
        read(text)
    spec = read(text.replace("order = 4", "order = 4, derivatives = 2"))
    assert {each.name for each in spec.jets} == {"S_s", "S_ss"}


def test_the_advice_about_derivatives_works():
    """As many as are asked for are named then, by components, too."""
    for name, order in (("m_ss", 2), ("m_ssss", 4)):
        wrong = KDV.replace("m^3/2 - c*m_s^2/2", f"m^3/2 + c*m*{name}/2")
        with pytest.raises(SpecError, match=rf"Write derivatives = {order} in \[space\]\."):
            read(wrong)
        assert read(wrong.replace("order = 6", f"order = 6, derivatives = {order}")).jets
    with pytest.raises(SpecError, match=r"'w_xy' is a derivative of order 2, and fewer"):
        read(PLANE.replace('"w^3"', '"w*w_xy"'))
    with pytest.raises(SpecError, match=r"Write derivatives = 2 in \[space\]\."):
        read(STRAND.replace("dot(Pi, Xi)", "Pi1*Xi1_ss"))


def test_derivatives_take_part_in_units():
    """Xi_s is Xi over the unit of s; a sum with another unit is refused."""
    text = STRAND.replace("size = 256, order = 4", 'size = 256, order = 4, unit = "m"')
    text = text.replace('Xi    = { role = "strain"', 'Xi    = { role = "strain", unit = "1/m"')
    assert 'unit = "m"' in text
    assert 'unit = "1/m"' in text
    good = text.replace('expression = "dot(Pi, Xi)"', 'expression = "dot(Xi_s, Xi_s)"')
    (observable,) = read(good.replace('"P"]', "]").replace('"energy", ]', '"energy"]')).observables
    assert observable.unit == "1/m^4"
    bad = text.replace('expression = "dot(Pi, Xi)"', 'expression = "Xi1_s + Xi1"')
    with pytest.raises(SpecError, match="1/m"):
        read(bad)


STRAIN = 'Xi = { role = "strain" }'
SPACE = 's = { length = "L" }'


@pytest.mark.parametrize(
    ("wrong", "cured"),
    [
        (STRAND.replace('length = "L"', 'length = "M"'), ("[parameters]", "[parameters]\nM = { positive = true, default = 1 }")),
        (STRAND.replace("L = { positive = true,", "L = {"), ("L = { default = 10,", "L = { positive = true, default = 1,")),
        (STRAND.replace("order = 4 }", 'order = 4 }\nr = { length = "L" }'), ('\nr = { length = "L" }', "")),
        (PLANE.replace("\ny = {", '\nz = { length = "Lx" }\ny = {'), ('z = { length = "Lx" }\n', "")),
        (PLANE.replace("\ny = {", "\nyy = {"), ("\nyy = {", "\ny = {")),
        (PLANE.replace('Ly", size = 32 }', 'Ly", size = 32, order = 6 }'), (", order = 6", "")),
        (PLANE.replace("[diffeomorphisms]", '[diffeomorphisms]\ncentral = "Lx"'), ('central = "Lx"', "")),
        (STRAND.replace('"P"]', '{ claim = "P", where = ["Xi1"] }]'), (', where = ["Xi1"]', "")),
        (STRAND.replace("[claims]", '[time]\nname = "t"\n\n[claims]'), ('[time]\nname = "t"', "")),
        (STRAND.replace('Xi = "vector(0, sin(2*pi*s/L)/2, 0)"', 'Xi = "sin(2*pi*s/L)"'), ('"sin(2*pi*s/L)"', '"vector(sin(2*pi*s/L), 0, 0)"')),
        (RIGID_BODY + '[profiles]\nPi = "1"\n', ('[profiles]\nPi = "1"\n', "")),
        (RIGID_BODY.replace("Pi = {", f"{STRAIN}\nPi = {{").replace("[parameters]", "[parameters]\nL = { positive = true, default = 1 }").split("[claims]")[0], ("[algebra]", f"[space]\n{SPACE}\n\n[algebra]")),
        (KDV.replace("[space]\ns = { length = \"L\", size = 256, order = 6 }\n", "").split("[profiles]")[0] + "[lagrangian]\nl = \"u^2/2\"\n", ("[diffeomorphisms]", f"[space]\n{SPACE}\n\n[diffeomorphisms]")),
    ],
)  # fmt: skip
def test_the_advice_works(wrong, cured):
    """What a message says is done, and then the spec is read."""
    with pytest.raises(SpecError):
        read(wrong)
    assert cured[0] in wrong
    assert read(wrong.replace(*cured)).title
