"""Specs with a table [truncation]: what is read, what is refused, and what the messages say."""

from pathlib import Path

import numpy as np
import pytest

from coadjoint.errors import LimitError, SpecError
from coadjoint.spec.reader import read_spec, read_spec_text
from tests.specs import shipped
from tests.torus_matrices import sample
from tests.truncated import pack

TEXT = """
title = "Fluid by matrices"
routes = ["lie-poisson"]
[truncation]
N = { size = 5, inertia = "k*l*(l + 1)" }
[variables]
W = { role = "momentum", default = [1, 0, 0, 0, "0.5"], unit = "1/s" }
[parameters]
k = { positive = true, default = 2 }
"""
TORUS = TEXT.replace('inertia = "k*l*(l + 1)"', 'surface = "torus", inertia = "k*(k1^2 + k2^2)"')
VARIABLE = 'W = { role = "momentum"'


def read(text, sizes=None):
    """A spec from its text."""
    return read_spec_text(text, Path("fluid.toml"), sizes or {})


def test_a_few_rows_are_written_out():
    """3 and 4 rows, with a momentum of u(N) for each entry; the index counts the rows."""
    spec = read(TEXT)
    family = spec.family
    assert [len(each.state) for each in family.windows] == [9, 16]
    assert [each.algebra.name for each in family.windows] == ["entries(3)", "entries(4)"]
    assert family.variables == ("W",)
    assert family.shared == ("k",)
    assert (family.index.size, family.index.of_rows, family.least) == (5, True, 2)
    assert len(family.defaults["W"][0]) == 25
    assert {each.unit for each in spec.state} == {"1/s"}


def test_a_size_is_chosen_when_it_is_read():
    """The default is that of the chosen number of rows."""
    assert len(read(TEXT, {"N": 7}).family.defaults["W"][0]) == 49
    bare = read(TEXT.replace("size = 5, ", ""))
    assert bare.family.index.size is None
    assert bare.family.defaults == {}


def test_on_the_torus_there_are_odd_numbers_of_rows():
    """3 and 5 are written out; another number is refused, declared or chosen."""
    family = read(TORUS).family
    assert [len(each.state) for each in family.windows] == [9, 25]
    assert (family.index.surface, family.least) == ("torus", 3)
    assert len(read(TORUS, {"N": 9}).family.defaults["W"][0]) == 81
    for text, sizes in ((TORUS.replace("size = 5", "size = 4"), {}), (TORUS, {"N": 8})):
        with pytest.raises(SpecError, match=r"on the torus.*an odd number of 3 or more"):
            read(text, sizes)
    with pytest.raises(SpecError, match="an integer of 3 or more"):
        read(TORUS, {"N": 1})
    with pytest.raises(SpecError, match=r"'k1' is the number of a wave, too"):
        read(TORUS.replace("k = {", "k1 = { default = 1 }\nk = {"))
    with pytest.raises(SpecError, match="'sphere' or 'torus'"):
        read(TORUS.replace('"torus"', '"cylinder"'))


def test_parts_are_those_of_waves():
    """The cosine of x and half the sine of (1, 1), by the order of their lengths."""
    parts = TORUS.replace('[1, 0, 0, 0, "0.5"]', '[1, 0, 0, 0, 0, "0.5"]')
    (found,) = read(parts).family.defaults["W"]
    expected = pack(sample({(1, 0): (1, 0), (1, 1): (0, 0.5)}, 5))
    np.testing.assert_allclose(np.array(found, float), expected, atol=1e-15)


REFUSED = [
    (
        [("[parameters]", '[time]\nname = "t"\n[parameters]')],
        "there are tables [truncation] and [time]",
    ),
    ([("[variables]", 'M = { inertia = "l*(l + 1)" }\n[variables]')], "there are 2 truncations"),
    ([('["lie-poisson"]', '["lie-poisson", "lax"]')], "the routes are lie-poisson, lax"),
    ([('"momentum"', '"velocity"')], "the variables are velocity"),
    ([(VARIABLE, f'V = {{ role = "momentum" }}\n{VARIABLE}')], "momentum, momentum"),
    ([(VARIABLE, f'{VARIABLE}, form = "matrix"')], "'W' has the key 'form'"),
    ([(VARIABLE, f'{VARIABLE}, index = "i"')], "'W' has the key 'index'"),
    ([("default = 2", 'default = 2, index = "i"')], "'k' has an index"),
    ([("[parameters]", '[claims]\nconserved = ["k"]\n[parameters]')], "'k' is claimed"),
    ([("[parameters]", '[claims]\ncasimirs = ["W_0"]\n[parameters]')], "claims about casimirs"),
    ([("k = {", "N = { default = 1 }\nk = {")], "'N' is the number of rows, too"),
    ([("k = {", "l = { default = 1 }\nk = {")], "'l' is the degree of harmonics, too"),
    ([("N = {", "l = {")], "'l' is the number of rows, too"),
    ([("size = 5", "size = 2")], "the default has 5 parts"),
    ([('[1, 0, 0, 0, "0.5"]', "1")], "the default is no list"),
    ([("size = 5", "size = 1")], "greater than or equal to 2"),
    ([("k*l*", "j*l*")], "j"),
]


@pytest.mark.parametrize(("changes", "said"), REFUSED)
def test_what_matrices_of_any_size_do_not_have_is_refused(changes, said):
    """With what was found, in a message that names the file."""
    text = TEXT
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    with pytest.raises(SpecError) as error:
        read(text)
    assert said in str(error.value)
    assert "fluid.toml:" in str(error.value)


@pytest.mark.parametrize(
    ("sizes", "said"), [({"i": 5}, "counts no rows"), ({"N": 1}, "an integer of 2 or more")]
)
def test_sizes_count_the_rows(sizes, said):
    """Those of another name, and too few, are refused."""
    with pytest.raises(SpecError, match=said):
        read(TEXT, sizes)


def test_the_number_of_entries_is_limited():
    """As that of all members."""
    with pytest.raises(LimitError, match="FAMILY_MEMBERS"):
        read(TEXT, {"N": 10**5})


def test_the_shipped_fluid_is_read_for_any_size():
    """From its file."""
    spec = shipped("zeitlin_su_n")
    few = read_spec(spec.path, {"N": 3})
    assert len(few.family.windows[0].state) == 9
    assert few.family.defaults == {}  # it has no harmonics of degree 3
    assert len(read_spec(spec.path, {"N": 33}).family.defaults["W"][0]) == 33**2
