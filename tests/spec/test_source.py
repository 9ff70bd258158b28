"""Source: one form for all errors, with a caret under the guilty characters."""

import tomllib

from coadjoint.errors import LimitError, SpecError
from coadjoint.spec.core.faults import ExpressionError, did_you_mean, list_names
from coadjoint.spec.core.positions import scan
from coadjoint.spec.core.source import Source, join_faults, show_value, write_key

TEXT = 'title = "x"\n\n[lagrangian]\n\tl = "dot(Omgea, Omega)/2"  # a comment\n'


def source(text=TEXT):
    """A source with a path of its own."""
    return Source("derivations/x.toml", text, scan(text))


def caret(error):
    """What the caret line of a message points at."""
    line, mark = str(error).splitlines()[-2:]
    return line[mark.index("^") : mark.rindex("^") + 1]


def test_fault_has_one_form():
    """File, line, column, key, found, expected, hint, source line, caret line."""
    fault = ExpressionError(
        "'Omgea' is unknown", 4, 9, found="Omgea", expected="a name", hint="Did you?"
    )
    error = source().expression_fault(("lagrangian", "l"), fault)
    assert str(error) == (
        "derivations/x.toml:4:11: lagrangian.l: 'Omgea' is unknown; expected a name. Did you?\n"
        '    l = "dot(Omgea, Omega)/2"  # a comment\n'
        "             ^^^^^"
    )
    assert (error.line, error.column, error.key) == (4, 11, "lagrangian.l")
    assert (error.found, error.expected, error.hint) == ("Omgea", "a name", "Did you?")
    assert type(error) is SpecError


def test_passed_limit_is_a_limit_error():
    """The kind of the error tells limits from mistakes."""
    fault = ExpressionError("too long", 0, 3, limit="EXPONENT")
    error = source().expression_fault(("lagrangian", "l"), fault)
    assert isinstance(error, LimitError)
    assert error.limit == "EXPONENT"


def test_caret_follows_escapes_and_joined_lines():
    """The place in the string's value is found in the file, through every way to write it."""
    for text in (
        'l = "\\u0078 + bad"',
        "l = 'x + bad'",
        'l = """\n  x + \\\n     bad"""',
        "l = '''\nx +\n  bad'''",
    ):
        start = tomllib.loads(text)["l"].index("bad")
        error = source(text).expression_fault(("l",), ExpressionError("?", start, start + 3))
        assert caret(error) == "bad", text


def test_long_line_is_cut_around_the_place():
    """A line of 4000 characters shows the part that matters."""
    text = 'l = "' + "x + " * 1000 + "bad" + " + x" * 1000 + '"'
    error = source(text).expression_fault(("l",), ExpressionError("?", 4000, 4003))
    assert caret(error) == "bad"
    assert max(map(len, str(error).splitlines())) < 120


def test_place_at_the_end_and_in_an_empty_text():
    """An end that lies after the text still has a caret."""
    error = source('l = ""').expression_fault(("l",), ExpressionError("?", 0, 0))
    assert str(error).endswith("^")
    assert source("").fault((), "empty").line == 1


def test_several_faults_are_one_error():
    """All messages in order, the parts of the first, and all parts."""
    faults = [source().fault(("title",), f"fault {n}", found=n) for n in (1, 2)]
    error = join_faults(faults)
    assert str(error).count("fault") == 2
    assert error.found == 1
    assert [part["found"] for part in error.faults] == [1, 2]
    assert join_faults(faults[:1]) is faults[0]


def test_words_of_messages():
    """Paths, values and suggestions on one line each."""
    assert write_key(("claims", "casimirs", 0)) == "claims.casimirs[1]"
    assert write_key(()) == "the file"
    assert write_key(("a", "\x1b[31m")) == "a.'\\x1b[31m'"
    assert show_value(1 << 5000) == "an integer of 5001 bits"
    assert show_value([1, 2]) == "a list of 2"
    assert show_value("a\nb" * 50).endswith("...")
    assert did_you_mean("zzz", ["Omega"], "else") == "else"
    assert list_names("abc", most=2) == "a, b, ..."
