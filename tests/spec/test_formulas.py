"""Formulas: each kind sees the names that its theorem allows, and must be a scalar."""

from functools import partial

import pytest

from coadjoint.errors import LimitError
from coadjoint.spec.core.tree import Name
from tests import specs
from tests.specs import RIGID_BODY, spec

TOP = RIGID_BODY.replace(
    "[parameters]",
    'Gamma = { role = "advected", representation = "vector" }\n[parameters]\nm = {}',
).replace(
    "[claims]",
    """[hamiltonian]
h = "dot(Pi, inverse(diag(I))*Pi)/2 + m*Gamma[3]"

[observables]
spin = "Omega3 - m"
tilt = { expression = "Gamma[3]", unit = "1", doc = "cosine" }

[claims]
conserved = ["energy", "spin + tilt"]""",
)


#: The error that a changed spec gives.
refused = partial(specs.refused, text=TOP)


def test_formulas_carry_text_key_and_line():
    """What messages and documents need stays with the tree."""
    declared = spec(TOP)
    assert declared.lagrangian.text == "dot(Omega, diag(I)*Omega)/2"
    assert declared.lagrangian.key == "lagrangian.l"
    assert TOP.splitlines()[declared.lagrangian.line - 1].startswith("l = ")
    claimed = [claim.formula for claim in declared.conserved]
    assert [f.key for f in claimed] == ["claims.conserved[1]", "claims.conserved[2]"]
    assert claimed[0].tree == Name("energy")
    assert [o.name for o in declared.observables] == ["spin", "tilt"]
    assert declared.observables[1].doc == "cosine"
    assert declared.observables[1].formula.key == "observables.tilt.expression"


@pytest.mark.parametrize(
    ("change", "key", "found", "said"),
    [
        (
            ("dot(Omega,", "dot(Omgea,"),
            "lagrangian.l",
            "Omgea",
            "'Omgea' is not declared; expected a variable or parameter of this spec. "
            "Did you mean 'Omega'?",
        ),
        (
            ("diag(I)*Omega)/2", "diag(I)*Pi)/2"),
            "lagrangian.l",
            "Pi",
            "a Lagrangian in terms of velocities, advected quantities and parameters",
        ),
        (
            ("+ m*Gamma[3]", "+ m*Omega[3]"),
            "hamiltonian.h",
            "Omega",
            "a Hamiltonian in terms of momenta, advected quantities and parameters",
        ),
        (("+ m*Gamma[3]", "+ m*Omega3"), "hamiltonian.h", "Omega3", "is a velocity"),
        (('["dot(Pi, Pi)"]', '["dot(Pi, Omega)"]'), "claims.casimirs[1]", "Omega", "a Casimir in"),
        (('["dot(Pi, Pi)"]', '["energy"]'), "claims.casimirs[1]", "energy", "is not declared"),
        (('"spin + tilt"', '"spim"'), "claims.conserved[2]", "spim", "'spin'?"),
        (('spin = "Omega3 - m"', 'spin = "energy"'), "observables.spin", "energy", "not declared"),
        (('"Omega3 - m"', '"tilt"'), "observables.spin", "tilt", "not declared"),
        (("diag(I)*Omega)/2", "diag(I)*Omega)/2*I"), "lagrangian.l", "a 3-vector", "a scalar"),
        (('"Gamma[3]"', '"Gamma[4]"'), "observables.tilt.expression", "Gamma[4]", "1 to 3"),
        (('"Gamma[3]"', '"Gamma[0]"'), "observables.tilt.expression", "Gamma[0]", "from 1"),
        (
            ('"Gamma[3]"', "\"__import__('os')\""),
            "observables.tilt.expression",
            "__import__",
            "is not a name",
        ),
        (('"Gamma[3]"', '"Gamma.__class__"'), "observables.tilt.expression", ".", "attributes"),
        (('"Gamma[3]"', '"9**9**9"'), "observables.tilt.expression", "9**9**", "parentheses"),
        (('"Gamma[3]"', '"m/0"'), "observables.tilt.expression", None, "divides by zero"),
        (('"Gamma[3]"', '"\u0393[3]"'), "observables.tilt.expression", "\u0393", "Write Gamma."),
        (('"Gamma[3]"', '""'), "observables.tilt.expression", "", "empty"),
    ],
)
def test_fault_in_a_formula_is_shown_at_its_characters(change, key, found, said):
    """Key, guilty characters and fix are in the message; the caret is under them."""
    error = refused(change)
    assert error.key == key
    assert found is None or error.found == found
    assert said in str(error)
    line, caret = str(error).splitlines()[-2:]
    guilty = line[caret.index("^") : caret.rindex("^") + 1]
    if found in ("Omgea", "Pi", "Omega", "Gamma[4]", "__import__", "9**9**", "spim"):
        assert guilty.removesuffix("[3]") == found


def test_limits_of_expressions_are_limit_errors():
    """100 000 parentheses and a hopeless power are refused by name."""
    for text, limit in (
        ("(" * 9000 + "m" + ")" * 9000, "EXPRESSION_CHARACTERS"),
        ("(" * 100 + "m" + ")" * 100, "EXPRESSION_NESTING"),
        ("(m + Gamma1 + Gamma2 + Gamma3)^32*(m + 1)^9", "EXPANDED_TERMS"),
    ):
        error = refused(('"Gamma[3]"', f'"{text}"'), kind=LimitError)
        assert error.limit == limit
        assert limit in str(error)
