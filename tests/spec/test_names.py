"""Names: what is accepted means itself in every target, which the compilers are asked about."""

import keyword
import re
import shutil
import subprocess
import sys

import pytest

from coadjoint.errors import SpecError
from coadjoint.resources import templates_folder
from coadjoint.spec.core.names import (
    NAME,
    derived_names,
    refusal,
    suggest_name,
    system_refusal,
)
from coadjoint.spec.core.shapes import FUNCTIONS
from coadjoint.spec.reader import read_spec_text

COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]
needs_compiler = pytest.mark.skipif(not COMPILERS, reason="no gcc and no clang on this machine")

#: Names that C, its headers, or compilers might give a meaning to.
CANDIDATES = """
    abs acos acosh asin atan atan2 cbrt ceil erf erfc exp2 expm1 fabs floor fma fmax fmin fmod frexp
    gamma hypot ilogb j0 j1 jn ldexp lgamma log10 log1p log2 logb lround modf nan pow remainder rint
    round scalbn signgam sinh tanh tgamma trunc y0 y1 yn alloca bool complex imaginary I i j errno
    linux unix i386 M_PI M_E HUGE NAN INFINITY NULL OVERFLOW TRUE FALSE EOF BUFSIZ CHAR_BIT DBL_MAX
    FLT_MAX INT_MAX RAND_MAX stdin stdout stderr main printf malloc free exit abort atoi rand labs
    div system signal raise time clock restrict inline asm typeof fortran near far
    double_t float_t size_t ptrdiff_t wchar_t int8_t uint64_t intptr_t thread_local constexpr
    new class delete this template try catch throw namespace operator private public friend virtual
    and or not xor bitand compl mutable explicit export typename using wchar char16_t char32_t
    Omega Pi Gamma chi mu nu xi eta A B C D E F G H K L M N P Q R S T U V W X Y Z a b c d e f g h
    l m n o p q r s u v w x y z zero one two
""".split()  # noqa: SIM905


def test_letters_of_the_books_are_free():
    """Greek letters, capitals and I (no macro without <complex.h>) may be declared."""
    free = "Omega Pi Gamma Xi chi mu alpha I J M D P Q R v x1 I1 A12 A1_2 m_l k_b x_0 E e"
    assert [name for name in free.split() if refusal(name) is not None] == []


def test_macros_and_the_type_of_generated_c_are_refused():
    """A preprocessor would put something else in their place; V is what vectors of lanes are."""
    templates = "\n".join(
        path.read_text(encoding="utf-8") for path in templates_folder().glob("c/**/*.j2")
    )
    macros = {*re.findall(r"#\s*define ([A-Za-z]\w*)", templates)}
    assert {"LANES", "STAGES"} < macros
    assert "typedef double V " in templates
    assert [name for name in (*macros, "V") if NAME.fullmatch(name) and not refusal(name)] == []


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("lambda", "keyword of Python"),
        ("match", "keyword of Python"),
        ("type", "keyword of Python"),
        ("double", "keyword of C"),
        ("restrict", "keyword of C"),
        ("constexpr", "keyword of C"),
        ("INFINITY", "C headers"),
        ("M_PI", "C headers"),
        ("size_t", "C headers"),
        ("linux", "C headers"),
        ("dot", "function of the expression language"),
        ("pi", "number of the expression language"),
        ("state", "generated code"),
        ("np", "generated code"),
        ("energy", "generated code"),
        ("projection", "generated code"),
        ("reconstruction", "generated code"),
        ("drift", "generated code"),
        ("t", "generated code"),
        ("casimir2", "generated code"),
        ("COADJOINT_INDEPENDENT", "generated code"),
    ],
)
def test_reserved_name_is_refused_with_a_free_one(name, why):
    """The message says who reserves the name, and the suggestion is free."""
    problem, expected, hint = refusal(name)
    assert repr(name) in problem
    assert why in problem
    assert expected == "a free name"
    suggested = re.search("'(.+)'", hint)[1]
    assert refusal(suggested) is None


def test_every_function_keyword_and_result_label_is_refused():
    """No word of Python's grammar and no function of ours can be declared."""
    for name in (*keyword.kwlist, *keyword.softkwlist, *FUNCTIONS):
        assert refusal(name) is not None, name


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("_x", "'x'"),
        ("x_", "'x'"),
        ("x__y", "'x_y'"),
        ("2x", ""),
        ("x-y", "'x_y'"),
        ("x y", "'x_y'"),
        ("", ""),
        ("\u03a9", ""),
        ("x\n", "'x'"),
        ("K\u212a", "'K'"),
        ("x; }", "'x'"),
        ("__import__", ""),
    ],
)
def test_string_that_is_no_name_is_refused(name, hint):
    """ASCII letters and digits with single underscores inside, nothing else."""
    problem, _, suggestion = refusal(name)
    assert ascii(name) in problem
    assert hint in suggestion
    assert bool(hint) == bool(suggestion) or name == "__import__"


def test_long_name_is_refused_with_its_limit():
    """31 characters pass, 32 do not."""
    assert refusal("x" * 31) is None
    assert "NAME_CHARACTERS" in refusal("x" * 32)[1]


def test_rates_have_names_of_their_own():
    """The rate of Pi1 is dPi1_dt, which nothing else may be called."""
    assert list(derived_names(["Pi1", "x"])) == ["dPi1_dt", "dx_dt"]


@pytest.mark.parametrize("name", ["state", "M_PI", "casimir1", "int", "norm", "lambda"])
def test_better_name_is_free(name):
    """A suggestion is never refused in turn."""
    assert refusal(suggest_name(name)) is None


def test_system_names():
    """A file's stem is a module name that shadows nothing."""
    for name in ("heavy_top", "a", "x2", "a" * 31):
        assert system_refusal(name) is None
    for name in ("Heavy", "2x", "", "x-y", "../evil", "a" * 32, "\u00e9", "x.y"):
        assert ascii(name) in system_refusal(name)[0]
    for name in ("random", "numpy", "coadjoint", "class", "match", "sys"):
        assert repr(name) in system_refusal(name)[0]
    assert "heavy_top.toml" in system_refusal("Heavy-Top")[2]


# -- the compilers ------------------------------------------------------------------------------


def macros(compiler, *flags):
    """Names that a compiler gives a meaning to after the headers of the kernels."""
    headers = "#include <stddef.h>\n#include <math.h>\n"
    command = [compiler, *flags, "-dM", "-E", "-x", "c", "-"]
    done = subprocess.run(command, input=headers, capture_output=True, text=True, check=True)
    names = {re.split(r"[ (]", line)[1] for line in done.stdout.splitlines()}
    return {name for name in names if NAME.fullmatch(name)}


@needs_compiler
@pytest.mark.parametrize("compiler", COMPILERS)
def test_every_macro_of_the_headers_is_refused(compiler):
    """No macro that a spec could spell is accepted, in ISO mode or with GNU extensions."""
    for standard in ("-std=c11", "-std=c17", "-std=gnu11"):
        found = macros(compiler, standard)
        assert {"INFINITY", "NAN", "NULL"} <= found
        assert {name for name in found if refusal(name) is None} == set()


@needs_compiler
def test_macro_check_sees_one_that_is_not_refused():
    """The check above can fail: a macro of ours appears in the list."""
    assert "Omega" in macros(COMPILERS[0], "-std=c11", "-DOmega=1")


@needs_compiler
@pytest.mark.parametrize("compiler", COMPILERS)
def test_accepted_names_compile_as_variables(compiler, tmp_path):
    """A kernel whose variables have all accepted candidate names compiles without a warning."""
    accepted = sorted({name for name in CANDIDATES if refusal(name) is None})
    assert len(accepted) > 100
    lines = "\n".join(
        f"    const double {name} = state[{row}]; out[{row}] = sqrt({name}) * {name};"
        for row, name in enumerate(accepted)
    )
    source = tmp_path / "kernel.c"
    source.write_text(
        "#include <stddef.h>\n#include <math.h>\n"
        "void top_rhs(size_t count, const double *restrict state, double *restrict out);\n"
        "void top_rhs(size_t count, const double *restrict state, double *restrict out)\n"
        "{\n    for (size_t _n = 0; _n < count; ++_n) {\n" + lines + "\n    }\n}\n"
    )
    command = [compiler, "-std=c11", "-Wall", "-Wextra", "-Werror", "-pedantic", "-c"]
    done = subprocess.run(
        [*command, str(source), "-o", str(tmp_path / "kernel.o")], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


def test_accepted_names_are_python_variables():
    """A function whose variables have all accepted candidate names computes with them."""
    accepted = sorted({name for name in CANDIDATES if refusal(name) is None})
    body = "".join(f"    {name} = {row}\n" for row, name in enumerate(accepted))
    scope: dict = {}
    code = f"def f():\n{body}    return [{', '.join(accepted)}]\n"
    exec(compile(code, "kernel", "exec"), scope)  # our own list of names
    assert scope["f"]() == list(range(len(accepted)))
    assert sys.version_info >= (3, 11)


def test_what_no_step_reads_may_have_the_name_of_a_type_of_generated_c():
    """Matrices, definitions and observables; a number of that name is read, and is refused."""
    text = """title = "N"
routes = ["canonical"]
[variables]
q = { role = "coordinate" }
p = { role = "momentum", of = "q" }
[parameters]
V = { shape = [2, 2], default = [[1, 0], [0, 1]] }
[definitions]
"STATE(r)" = "V[1, 1]*r^2"
[hamiltonian]
h = "p^2/2 + STATE(q)"
[observables]
STATES = "q^2"
"""
    assert read_spec_text(text, "sample.toml").parameters[0].components[0] == "V11"
    with pytest.raises(SpecError, match="'V' is a type or a macro of generated C"):
        read_spec_text(
            text.replace("V = { shape = [2, 2], default = [[1, 0], [0, 1]] }", "V = {}").replace(
                'V = "q^2"', 'W = "q^2"'
            ),
            "s.toml",
        )
