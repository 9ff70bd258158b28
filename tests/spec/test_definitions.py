"""Definitions: short names that mean what they stand for, put in as trees, never as text."""

from functools import partial

import pytest

from coadjoint import limits
from coadjoint.derive import derive
from coadjoint.errors import LimitError
from coadjoint.spec.core.definitions import expand
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.tree import walk
from coadjoint.spec.sections.definitions import signature
from tests import specs
from tests.specs import RIGID_BODY, spec

TOP = RIGID_BODY.replace(
    "[parameters]",
    'Gamma = { role = "advected", representation = "vector" }\n[parameters]\nm = {}',
).replace(
    '[lagrangian]\nl = "dot(Omega, diag(I)*Omega)/2"',
    """[definitions]
u = "cross(Omega, Gamma)"
"V(s, d)" = "s^2 - m*d"
"W(a)" = "V(a[1], dot(a, Gamma)) + a[3]"
height = "m*Gamma3"
unused = "Omega*m"
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 + V(Gamma1, Gamma2)"
[hamiltonian]
h = "dot(Pi, inverse(diag(I))*Pi)/2 - V(Gamma1, Gamma2)"
[observables]
lever = "u"
second = "u[2]"
work = "W(2*Gamma)" """,
)


#: The error that a changed spec gives.
refused = partial(specs.refused, text=TOP)


def guilty(error):
    """The characters above the carets of a message."""
    line, caret = str(error).splitlines()[-2:]
    return line[caret.index("^") : caret.rindex("^") + 1]


@pytest.mark.parametrize(
    ("short", "typed"),
    [
        ("u", "cross(Omega, Gamma)"),
        ("u[2]", "Omega3*Gamma1 - Omega1*Gamma3"),
        ("W(2*Gamma)", "(2*Gamma1)^2 - m*dot(2*Gamma, Gamma) + 2*Gamma3"),
        ("W(diag(u)*Gamma)", "W(diag(cross(Omega, Gamma))*Gamma)"),
        ("V(height - 1, height)*2", "2*((m*Gamma3 - 1)^2 - m^2*Gamma3)"),
    ],
)
def test_a_definition_is_the_expression_that_it_stands_for(short, typed):
    """Arguments, their components and definitions in definitions, as typed out by hand."""
    both = f'work = "{short}"\ntyped = "{typed}"\nother = "height"'
    found = derive(spec(TOP, ('work = "W(2*Gamma)"', both))).observables
    parts = {lead: [v for name, v in found.items() if name.startswith(lead)] for lead in
             ("work", "typed", "other")}  # fmt: skip
    assert parts["work"] == parts["typed"] != parts["other"]
    assert len(parts["work"]) in (1, 3)


def test_a_component_of_an_argument_that_is_a_name_is_that_component():
    """W(Gamma) reads as if it had been typed out; so does u[1] of u = Omega."""
    known = {d.name: d for d in spec(TOP).definitions}
    found = expand(read_expression("W(Gamma)", ["W"]), known)
    assert found == read_expression("Gamma[1]^2 - m*dot(Gamma, Gamma) + Gamma[3]")


def test_what_is_put_in_is_bound_as_if_in_parentheses():
    """V(s, d) with a sum for s is the square of the sum: trees are put in, and not text."""
    known = {d.name: d for d in spec(TOP).definitions}
    found = expand(read_expression("2*V(m + 1, -m)", ["V"]), known)
    assert found == read_expression("2*((m + 1)^2 - m*(-m))")
    assert found != read_expression("2*(m + 1^2 - m*(-m))")


def test_definitions_are_kept_in_order_for_documents():
    """Name, arguments and text, those that nobody uses among them."""
    shown = [(d.signature, d.in_one_line) for d in spec(TOP).definitions]
    assert shown[:2] == [("u", "cross(Omega, Gamma)"), ("V(s, d)", "s^2 - m*d")]
    assert shown[-1] == ("unused", "Omega*m")
    assert signature("V( s ,d )") == ("V", ("s", "d"))


def test_definitions_are_put_in_wherever_formulas_stand():
    """Claims, Casimirs and declared brackets have them, too."""
    claimed = spec(TOP, ('["dot(Pi, Pi)"]', '["2*height - height"]\nconserved = ["W(Gamma)"]'))
    assert claimed.casimirs[0].tree == read_expression("2*(m*Gamma3) - m*Gamma3")
    assert claimed.conserved[0].formula.shape == ()
    text = """
title = "Pendulum"
routes = ["poisson"]
[variables]
q = { role = "coordinate" }
p = { role = "coordinate" }
[poisson]
canonical = [["q", "p"]]
[definitions]
T = "p^2/2"
[hamiltonian]
h = "T - cos(q)"
"""
    assert spec(text).hamiltonian.tree == read_expression("p^2/2 - cos(q)")
    bracket = ('canonical = [["q", "p"]]', 'brackets = { "{q, p}" = "1 + T" }')
    ((_, _, formula),) = spec(text, bracket).poisson.entries
    assert formula.tree == read_expression("1 + p^2/2")


@pytest.mark.parametrize(
    ("change", "key", "found", "said"),
    [
        (("V(s, d)", "V(s, )"), "definitions.V(s, )", "V(s, )", "cannot be defined"),
        (("V(s, d)", "V()"), "definitions.V()", "V()", '"V(s, d)"'),
        (("V(s, d)", "V(s, d"), "definitions.V(s, d", "V(s, d", "cannot be defined"),
        (("V(s, d)", "V(s, s)"), "definitions.V(s, s)", "s", "'s' has a name that is taken"),
        (("V(s, d)", "V(m, d)"), "definitions.V(m, d)", "m", "'m' has a name that is taken"),
        (("V(s, d)", "V(s, Pi1)"), "definitions.V(s, Pi1)", "Pi1", "is taken"),
        (("V(s, d)", "V(s, u)"), "definitions.V(s, u)", "u", "is taken"),
        (("V(s, d)", "V(s, sin)"), "definitions.V(s, sin)", "sin", "a function of the expr"),
        (("unused =", "sin ="), "definitions.sin", "sin", "a function of the expression language"),
        (("unused =", '"dot(a)" ='), "definitions.dot(a)", "dot", "a function of the expr"),
        (("unused =", "lambda ="), "definitions.lambda", "lambda", "a keyword of Python"),
        (("unused =", "Pi ="), "definitions.Pi", "Pi", "'Pi' is doubled: variables.Pi"),
        (("unused =", "Pi2 ="), "definitions.Pi2", "Pi2", "'Pi2' is doubled"),
        (("unused =", '"u(x)" ='), "definitions.u(x)", "u", "'u' is doubled: definitions.u"),
        (("unused =", "lever ="), "observables.lever", "lever", "'lever' is doubled"),
        (("unused =", "lever2 ="), "observables.lever", "lever2", "'lever2' is doubled"),
        (("Omega*m", "Omgea*m"), "definitions.unused", "Omgea", "Did you mean 'Omega'?"),
        (("Omega*m", "energy"), "definitions.unused", "energy", "'energy' is not declared"),
        (("Omega*m", "unused + 1"), "definitions.unused", "unused", "is defined no earlier"),
        (("cross(Omega, Gamma)", "height*m"), "definitions.u", "height", "is defined no earlier"),
        (("Omega*m", "Omega + m"), "definitions.unused", None, "a 3-vector + a scalar"),
        (("Omega*m", "V*m"), "definitions.unused", "V", "has no argument; expected V(...)"),
        (("Omega*m", "u(m)"), "definitions.unused", "u", "'u' is not a function"),
        (("Omega*m", "V(m)"), "definitions.unused", "1", "expected V(s, d)"),
        (("Omega*m", "m/(2 - 2)"), "definitions.unused", None, "divides by zero"),
        (('"Omega*m"', "3"), "definitions.unused", 3, "text in quotes"),
    ],
)
def test_a_slip_in_a_definition_is_refused_at_its_place(change, key, found, said):
    """Key, guilty value and fix are in the message."""
    error = refused(change)
    assert (error.key, said in str(error)) == (key, True), str(error)
    assert found is None or error.found == found


@pytest.mark.parametrize(
    ("change", "key", "found", "at", "said"),
    [
        (
            ("- V(Gamma1, Gamma2)", "- dot(u, u)"),
            "hamiltonian.h",
            "Omega",
            "u",
            "in the definition of u: 'Omega' is a velocity",
        ),
        (
            ("V(Gamma1, Gamma2)", "V(Gamma1, Pi1)"),
            "lagrangian.l",
            "Pi1",
            "Pi1",
            "l: 'Pi1' is a momentum",
        ),
        (
            ("W(2*Gamma)", "3 + W(m)"),
            "observables.work",
            "m[1]",
            "W(m)",
            "in the definition of W: m is a scalar, found m[1]",
        ),
        (
            ("W(2*Gamma)", "V(m, Gamma)"),
            "observables.work",
            None,
            "V(m, Gamma)",
            "in the definition of V: a scalar - a 3-vector do not fit",
        ),
        (('"u[2]"', '"u[4]"'), "observables.second", "u[4]", "u[4]", "out of range"),
        (('"u[2]"', '"height[1]"'), "observables.second", "height[1]", "height[1]", "a scalar"),
        (('"u[2]"', '"V(m, 1/0)"'), "observables.second", None, "1/0", "divides by zero"),
        (('"u[2]"', '"V(m)"'), "observables.second", "1", "V(m)", "expected V(s, d)"),
    ],
)
def test_a_fault_of_a_definition_is_shown_at_its_call(change, key, found, at, said):
    """The caret is under the call, or the argument, and the message names the definition."""
    error = refused(change)
    assert (error.key, guilty(error)) == (key, at)
    assert found is None or error.found == found
    assert said in str(error)


def doubling(count):
    """Definitions of which each calls the one before it twice."""
    lines = ['"f0(x)" = "x + x"']
    lines += [f'"f{n}(x)" = "f{n - 1}(f{n - 1}(x))"' for n in range(1, count)]
    return "\n".join(lines)


def chain(count):
    """Definitions each of which is minus the one before."""
    return "\n".join(f'z{n} = "-{f"z{n - 1}" if n else "m"}"' for n in range(count))


@pytest.mark.parametrize(
    ("change", "key", "limit"),
    [
        (('unused = "Omega*m"', doubling(40)), "definitions.f4(x)", "EXPRESSION_NODES"),
        (
            ('unused = "Omega*m"', "\n".join(f'y{n} = "{"y" if n else "m"}{n - 1 if n else ""}'
             f' + {"y" if n else "m"}{n - 1 if n else ""}"' for n in range(40))),
            "definitions.y8",
            "EXPRESSION_NODES",
        ),
        (('unused = "Omega*m"', chain(210)), "definitions.z199", "DEFINED_PARTS"),
        pytest.param(
            ('unused = "Omega*m"', chain(1100)), "definitions.z199", "DEFINED_PARTS",
            marks=pytest.mark.campaign,  # 15 seconds, of which reading takes most
        ),
        (('"W(2*Gamma)"', f'"{"V(m, m)*" * 150}m"'), "observables.work", "EXPRESSION_NODES"),
        (('"W(2*Gamma)"', '"V(m + Gamma1, m)^32*V(Pi1 + Pi2, m)^32"'), "observables.work",
         "EXPANDED_TERMS"),
        (('"s^2 - m*d"', f'"{"(" * 60}s{")" * 60}"'), "definitions.V(s, d)", "EXPRESSION_NESTING"),
    ],
)  # fmt: skip
def test_definitions_that_double_are_refused_before_they_explode(change, key, limit):
    """Limits hold for what formulas are with all definitions put in."""
    error = refused(change, kind=LimitError)
    assert (error.key, error.limit) == (key, limit)
    assert limit in str(error)


def test_the_limit_is_the_size_after_putting_in():
    """An expression of exactly the limit passes; one part more does not."""
    known = {d.name: d for d in spec(TOP).definitions}
    call = "V(m, m)"  # 7 parts: m^2 - m*m has 3 names, 3 operations, and no number
    parts = sum(1 for _ in walk(expand(read_expression(call, ["V"]), known)))
    assert parts == 6
    room = limits.EXPRESSION_NODES - parts
    assert room % 2 == 0
    fits = call + " + m" * (room // 2)
    assert sum(1 for _ in walk(expand(read_expression(fits, ["V"]), known))) == 1000
    with pytest.raises(Exception, match="too many parts") as caught:
        expand(read_expression("-(" + fits + ")", ["V"]), known)
    assert caught.value.limit == "EXPRESSION_NODES"
