"""Complex matrices by their real and imaginary parts: su(2) and su(3) against the books."""

import numpy as np
import pytest

from coadjoint.errors import AlgebraError, SpecError
from coadjoint.prove import Verdict
from coadjoint.solve.formulas import Formula
from tests.specs import prove_claims, spec

#: The matrices -i sigma_k/2, with ``[e1, e2] = e3`` and cyclic.
SU2 = """
title = "A spin"
routes = ["lie-poisson"]
[algebra]
basis = ["e1", "e2", "e3"]
[algebra.matrices]
e2 = [[0, "-1/2"], ["1/2", 0]]
[algebra.imaginary]
e1 = [[0, "-1/2"], ["-1/2", 0]]
e3 = [["-1/2", 0], [0, "1/2"]]
[variables]
S = { role = "momentum" }
[parameters]
B = { shape = [3] }
[hamiltonian]
h = "dot(B, S)"
[claims]
casimirs = ["dot(S, S)"]
"""
#: Gell-Mann's matrices: places, real and imaginary parts of those that are not diagonal.
PAIRS = [((0, 1), (1, 2)), ((0, 2), (4, 5)), ((1, 2), (6, 7))]


def gell_mann():
    """``-i lambda_a/2`` as a spec has them: the last times sqrt(3), which leaves no root."""
    real, imaginary = {}, {}
    for (r, c), (even, odd) in PAIRS:
        imaginary[even] = np.zeros((3, 3))
        imaginary[even][r, c] = imaginary[even][c, r] = -0.5
        real[odd] = np.zeros((3, 3))
        real[odd][r, c], real[odd][c, r] = -0.5, 0.5
    imaginary[3] = np.diag([-0.5, 0.5, 0])
    imaginary[8] = np.diag([-0.5, -0.5, 1.0])
    return real, imaginary


def test_spins_have_the_brackets_of_the_book():
    """``[e_i, e_j] = epsilon_ijk e_k``, whose motion is precession; the Casimir is proved."""
    assert spec(SU2).algebra.constants == {(0, 1): {2: 1}, (0, 2): {1: -1}, (1, 2): {0: 1}}
    certificate = prove_claims(spec(SU2))
    assert {claim.verdict for claim in certificate.claims} == {Verdict.PROVED}


def test_su3_closes():
    """Eight matrices close under commutators, with a Casimir of second degree."""
    real, imaginary = gell_mann()
    tables = "".join(
        f"[algebra.{kind}]\n"
        + "".join(f"e{n} = {matrix.tolist()}\n" for n, matrix in sorted(table.items()))
        for kind, table in (("matrices", real), ("imaginary", imaginary))
    )
    names = [f"e{n}" for n in range(1, 9)]
    text = SU2[: SU2.index("[algebra]")] + f"[algebra]\nbasis = {names}\n" + tables
    text += SU2[SU2.index("[variables]") :].replace("dot(B, S)", "S1*S4 + S8^2")
    text = text.replace("[3]", "[8]").replace(
        "dot(S, S)", "S1^2 + S2^2 + S3^2 + S4^2 + S5^2 + S6^2 + S7^2 + S8^2/3"
    )
    certificate = prove_claims(spec(text))
    assert {claim.verdict for claim in certificate.claims} == {Verdict.PROVED}


def test_a_wrong_sign_does_not_close():
    """A matrix that is not antihermitian is no member of the algebra."""
    with pytest.raises(AlgebraError) as caught:
        spec(SU2, ('[[0, "-1/2"], ["1/2", 0]]', '[[0, "1/2"], ["1/2", 0]]'))
    assert "e1" in str(caught.value)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            ("[algebra.imaginary]\n", "[algebra.imaginary]\ne4 = [[0, 0], [0, 0]]\n"),
            "not in the basis",
        ),
        (('["-1/2", 0], [0, "1/2"]', '["-1/2"]'), "rows of"),
        (('e2 = [[0, "-1/2"], ["1/2", 0]]', "e2 = [[1]]"), "the imaginary parts have 2 rows"),
    ],
)
def test_parts_that_do_not_fit_are_refused(change, said):
    """A name, a size, and sizes of the two parts."""
    with pytest.raises(SpecError) as caught:
        spec(SU2, change)
    assert said in str(caught.value)


def test_complex_products_are_those_of_numpy():
    """The real form of A + iB times the parts of z has the parts of the product."""
    source = np.random.default_rng(3)
    a, b, z = source.normal(size=(2, 2)), source.normal(size=(2, 2)), source.normal(size=4)
    wanted = (a + 1j * b) @ (z[:2] + 1j * z[2:])
    for place, expected in enumerate([*wanted.real, *wanted.imag]):
        unit = f"vector({', '.join(str(int(n == place)) for n in range(4))})"
        formula = Formula(
            f"dot({unit}, complex(A, B)*z)", {"A": (2, 2), "B": (2, 2), "z": (4,)}, "product"
        )
        values = {"A": a[..., None], "B": b[..., None], "z": z[:, None]}
        assert formula.evaluate(values)[0] == pytest.approx(expected, rel=1e-14)
