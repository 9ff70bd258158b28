"""Positions: keys and values are found where they stand, for any document that tomllib reads."""

import string
import tomllib
from datetime import date

from hypothesis import given
from hypothesis import strategies as st

from coadjoint.limits import SPEC_NESTING
from coadjoint.spec.core.positions import scan

SAMPLE = '''# a comment with "quotes" and [brackets]
title = "a \\"b\\" \\u00e9"  # after
"quoted key".'other' = [1, 2.5, # inside
  "x",
]
inline = { a = 1, b.c = [true, {d = 'e'}] }
when = 1979-05-27 07:32:00

[table.sub]
text = """
first \\
   joined "quote" second"""
raw = \'\'\'
C:\\path''\'\'\'

[[many]]
x = 1
[[many]]
x = 2
[many.below]
y = 3
'''


def paths(value, path=()):
    """Every path of a document, tables and arrays included."""
    parts = value.items() if isinstance(value, dict) else enumerate(value)
    for part, below in parts:
        yield (*path, part)
        if isinstance(below, (dict, list)):
            yield from paths(below, (*path, part))


def at(document, path):
    """The value at a path."""
    for part in path:
        document = document[part]
    return document


def check_positions(text):
    """The scanner finds the paths of tomllib, and reads each string as tomllib does."""
    document, found = tomllib.loads(text), scan(text)
    assert found.keys.keys() | found.values.keys() == set(paths(document))
    assert found.doubled is None
    for path, offsets in found.characters.items():
        value = at(document, path)
        assert len(offsets) == len(value) + 1
        for letter, offset in zip(value, offsets[:-1], strict=True):
            assert text[offset] in (letter, "\\")
    return found


def test_sample_document_is_found_whole():
    """Comments, quoted and dotted keys, all strings, nested arrays, arrays of tables."""
    found = check_positions(SAMPLE)

    def cut(span):
        return SAMPLE[slice(*span)]

    assert cut(found.values["title",]) == '"a \\"b\\" \\u00e9"'
    assert cut(found.keys["quoted key", "other"]) == "'other'"
    assert cut(found.values["quoted key", "other", 2]) == '"x"'
    assert cut(found.values["inline", "b", "c", 1, "d"]) == "'e'"
    assert cut(found.values["when",]) == "1979-05-27 07:32:00"
    assert cut(found.values["table", "sub"]) == "[table.sub]"
    assert cut(found.values["many", 1, "x"]) == "2"
    assert cut(found.values["many", 1, "below", "y"]) == "3"


def test_characters_of_a_joined_line_are_found():
    """The map of a multi-line string goes through escapes and line joins."""
    text = tomllib.loads(SAMPLE)["table"]["sub"]["text"]
    offset = scan(SAMPLE).characters["table", "sub", "text"][text.index("second")]
    assert SAMPLE[offset : offset + 6] == "second"


def test_doubled_key_is_noticed():
    """A key or table that is given twice is noted with its second place."""
    text = "a = 1\nb = 2\na = 3"
    assert scan(text).doubled == (("a",), (12, 13))
    assert scan("[a]\n[b]\n[a]").doubled == (("a",), (8, 11))
    assert scan("[a.b]\n[a]").doubled is None


def test_deep_nesting_is_noticed_at_once():
    """Tables and arrays beyond the limit stop the scanner before they cost anything."""
    for text in ("a." * 30000 + "a = 1", "[" + "a." * 30000 + "a]", "a = " + "[" * 60000):
        assert scan(text).too_deep is not None
    assert scan("a." * (SPEC_NESTING - 1) + "a = 1").too_deep is None


@given(st.text(max_size=200))
def test_any_text_is_scanned(text):
    """The scanner never raises, whatever the text."""
    scan(text)


@given(st.text(alphabet="a.=[]{}\"'\\#\n \tu0", max_size=60))
def test_whatever_tomllib_reads_is_found(text):
    """On texts made of TOML's own marks, what tomllib accepts is found whole."""
    try:
        tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return
    check_positions(text)


KEYS = st.text(alphabet=string.ascii_letters + "_-0123 .é\"'", min_size=1, max_size=6)
STRINGS = st.text(
    alphabet=st.characters(blacklist_categories=["Cs", "Cc"]) | st.sampled_from('\n\t"\\'),
    max_size=20,
)


def basic(text):
    """A string in double quotes."""
    escapes = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\x7f": "\\u007F"}
    return '"' + "".join(escapes.get(c, c) for c in text) + '"'


def long(text):
    """A multi-line string, with a line join in front of each space."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\x7f", "\\u007F")
    return '"""\n' + escaped.replace(" ", "\\u0020\\\n  ") + '"""'


SCALARS = st.one_of(
    st.integers(-(10**9), 10**9).map(str),
    st.floats(allow_nan=False, allow_infinity=False).map(repr),
    st.booleans().map(lambda b: str(b).lower()),
    st.dates(min_value=date(1000, 1, 1)).map(str),
    STRINGS.map(basic),
    STRINGS.map(long),
)
TABLES = st.deferred(lambda: st.dictionaries(KEYS, VALUES, max_size=3))
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3).map(lambda v: "[" + ", # note\n ".join(v) + "\n]"),
        st.dictionaries(KEYS, inner, max_size=3).map(
            lambda v: "{ " + ", ".join(f"{basic(k)} = {x}" for k, x in v.items()) + " }"
        ),
    ),
    max_leaves=6,
)


@given(
    TABLES, st.lists(st.tuples(KEYS, TABLES), max_size=3, unique_by=lambda t: t[0]), st.booleans()
)
def test_random_documents_are_found_whole(top, tables, several):
    """Paths and strings of random documents are those of tomllib."""
    lines = [f"{basic(key)} = {value}" for key, value in top.items()]
    for name, table in tables:
        if name in top:
            continue
        header = f"[[ {basic(name)} ]]" if several else f"[{basic(name)} . sub]"
        for _ in range(2 if several else 1):
            lines += [header, *(f"{basic(key)} = {value}" for key, value in table.items())]
    text = "\n".join(lines)
    check_positions(text)
