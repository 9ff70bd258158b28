"""Validate: every key and value of the wrong form is found, at its line, all at once."""

import pytest

from coadjoint.errors import LimitError
from coadjoint.limits import MESSAGE_ROWS, SPEC_NESTING
from tests.specs import RIGID_BODY, refused, spec

CHANGES = [
    # unknown keys
    (('role = "velocity" }', 'rol = "velocity" }'), "variables.Omega.rol", "rol", "'role'?"),
    (("[lagrangian]", "[lagrangain]"), "lagrangain", "lagrangain", "'lagrangian'?"),
    (("casimirs =", "casimir ="), "claims.casimir", "casimir", "'casimirs'?"),
    # missing keys
    (('title = "Free rigid body"\n', ""), "the file", "title", "Write title ="),
    (('{ role = "velocity" }', "{}"), "variables.Omega", "role", "'velocity', 'momentum'"),
    (('l = "dot(Omega, diag(I)*Omega)/2"', ""), "lagrangian", "l", 'Write for instance l = "'),
    (('[algebra]\nname = "so(3)"', ""), "the file", "algebra", 'name = "so(3)"'),
    # wrong types and values
    (('"Free rigid body"', "7"), "title", 7, "text in quotes"),
    (("[claims]", "[constraints]\nc = 1\n[claims]"), "constraints.c", 1, "expected text in quotes"),
    (('"Free rigid body"', '"a\\u0007b"'), "title", "a\x07b", "printable"),
    (("positive = true", "positive = 1"), "parameters.I.positive", 1, "true or false"),
    (("shape = [3]", "shape = 3"), "parameters.I.shape", 3, "a list"),
    (("shape = [3]", "shape = [0]"), "parameters.I.shape[1]", 0, "greater than or equal to 1"),
    (("shape = [3]", "shape = [true]"), "parameters.I.shape[1]", True, "an integer"),
    (("shape = [3]", "shape = [1, 1, 1]"), "parameters.I.shape", "a list of 3", "at most 2"),
    (('"velocity"', '"velocty"'), "variables.Omega.role", "velocty", "'velocity'?"),
    (('"lie-poisson"]', '"lie-poison"]'), "routes[2]", "lie-poison", "'lie-poisson'?"),
    (('"lie-poisson"]', '"euler-poincare"]'), "routes", "a list of 2", "no entry twice"),
    (('["euler-poincare", "lie-poisson"]', "[]"), "routes", "an empty list", "at least 1"),
    (('["dot(Pi, Pi)"]', '"dot(Pi, Pi)"'), "claims.casimirs", "dot(Pi, Pi)", "a list"),
    (('name = "so(3)"', 'name = "so(3)"\ninvariance = "both"'), "algebra.invariance", "both", "'l"),
    (('Pi = { role = "momentum" }', "Pi = 3"), "variables.Pi", 3, "a table"),
    (('name = "so(3)"', ""), "algebra", "an empty table", "exactly one of name"),
    # numbers
    (("[1, 2, 3]", "[1, 2, nan]"), "parameters.I.default", "a list of 3", "finite"),
    (("[1, 2, 3]", "1e400"), "parameters.I.default", "1E+400", "INTEGER_DIGITS"),
    (("[1, 2, 3]", "0x" + "f" * 200), "parameters.I.default", None, "INTEGER_DIGITS"),
    (("[1, 2, 3]", "1979-05-27"), "parameters.I.default", None, "an exact number"),
    (("[1, 2, 3]", "[1, 2, '3a']"), "parameters.I.default", "a list of 3", "exact number"),
    # texts that are printed in generated files
    (('"momentum" }', '"momentum", unit = "m */ x" }'), "variables.Pi.unit", "m */ x", "kg m^2/s"),
    (('"momentum" }', '"momentum", unit = "/* m" }'), "variables.Pi.unit", "/* m", "kg m^2/s"),
    (('"momentum" }', '"momentum", unit = "m\\nx" }'), "variables.Pi.unit", "m\nx", "kg m^2/s"),
    (('"momentum" }', '"momentum", unit = "\u00b5m" }'), "variables.Pi.unit", "\u00b5m", "letters"),
    (('"Free rigid body"', '"x"\nsource = "\\u001b[1m"'), "source", "\x1b[1m", "printable"),
    (('"Free rigid body"', '"x"\n"\\u001b[1m" = 1'), "'\\x1b[1m'", "\x1b[1m", "one of title"),
    (('"Free rigid body"', '"x"\nlicense = "MIT */"'), "license", "MIT */", "SPDX"),
]


@pytest.mark.parametrize(("change", "key", "found", "said"), CHANGES)
def test_wrong_form_is_refused_at_its_line(change, key, found, said):
    """The key, the value and what is accepted are in the message, beside the line."""
    error = refused(change)
    assert error.key == key
    assert found is None or error.found == found
    assert said in str(error)
    changed = RIGID_BODY.replace(*change)
    shown = str(error).splitlines()[1].strip()
    assert shown[:60].strip() in changed.splitlines()[error.line - 1] or error.key == "the file"
    if isinstance(found, str) and found.isprintable() and "a " not in found:
        assert found in str(error)


def test_all_faults_are_reported_at_once():
    """Three mistakes, three messages with three lines."""
    error = refused(("velocity", "velo"), ("positive", "positiv"), ("casimirs", "casi"))
    assert [part["key"] for part in error.faults] == [
        "variables.Omega.role",
        "parameters.I.positiv",
        "claims.casi",
    ]
    assert all(f"sample.toml:{part['line']}:" in str(error) for part in error.faults)


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        ("title = ", 1, "invalid value"),
        ("title = 'x'\nroutes = [", 2, "invalid value"),
        ("title = 'x'\n= 3", 2, "not TOML"),
        ("\ufefftitle = 'x'", 1, "invalid statement"),
        ("title = 'x'\x00", 1, "not TOML"),
    ],
)
def test_text_that_is_no_toml_is_refused_at_its_place(text, line, said):
    """The message of the TOML reader, at our place, with our caret."""
    error = refused(text=text)
    assert error.line == line
    assert said in str(error)
    assert str(error).endswith("^")


def test_doubled_key_is_shown_with_its_first_line():
    """A name declared twice in one table is an error of the file, said in our words."""
    error = refused(
        ('Pi = { role = "momentum" }', 'Pi = { role = "momentum" }\nPi = { role = "x" }')
    )
    assert error.found == "Pi"
    assert "'Pi' is declared twice" in str(error)
    assert f"The first is in line {error.line - 1}." in str(error)


@pytest.mark.parametrize(
    "text",
    [
        "a = " + "[" * 5000,
        "a = " + "{b = " * 5000,
        "a." * 30_000 + "b = 1",
        "[" + "a." * 30_000 + "b]",
        "a." * SPEC_NESTING + "b = 1",
    ],
)
def test_deep_nesting_is_refused(text):
    """Without the limit, tomllib needs 20 s for the third and all its stack for the first."""
    error = refused(text=text)
    assert isinstance(error, LimitError)
    assert error.limit == "SPEC_NESTING"


def test_integer_that_python_refuses_to_read():
    """More than 4300 digits end in our error, not in Python's."""
    error = refused(("[1, 2, 3]", "1" * 5000))
    assert isinstance(error, LimitError)
    assert error.limit == "INTEGER_DIGITS"


def test_too_long_title_names_the_limit():
    """200 characters pass, 201 do not."""
    assert spec(RIGID_BODY, ("Free rigid body", "x" * 200)).title == "x" * 200
    error = refused(("Free rigid body", "x" * 201))
    assert isinstance(error, LimitError)
    assert error.limit == "TITLE_CHARACTERS"
    assert "200" in str(error)


def test_too_long_unit_names_the_limit():
    """Units are printed in generated files, one to a line."""
    error = refused(('"momentum" }', '"momentum", unit = "' + "m" * 41 + '" }'))
    assert error.limit == "UNIT_CHARACTERS"


def test_thousands_of_faults_make_a_short_message():
    """As many faults are shown as a screen has room for, and the others counted."""
    error = refused(('["dot(Pi, Pi)"]', "[" + "1, " * 5000 + "]"))
    assert len(error.faults) == 6
    assert str(error).endswith("... and 4994 more faults.")
    assert len(str(error).splitlines()) <= MESSAGE_ROWS
