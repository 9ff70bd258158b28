"""Links in the place of strains: their limits, and which strands have such an energy."""

import re
from pathlib import Path

import pytest
import sympy

from coadjoint.bodies import write_lattice
from coadjoint.bodies.energy import pair_components, read_strand
from coadjoint.errors import SpecError
from coadjoint.spec import read_spec_text
from tests.bodies.lattices import STIFF, TOPS, lattice_of, strand
from tests.specs import prove_claims, shipped

a, t = sympy.symbols("a t")
Xi = sympy.Matrix(sympy.symbols("Xi1:4"))


def hat(x):
    """The matrix of the cross product with x."""
    return sympy.Matrix([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])


def turn(U):
    """What tends to the strain."""
    return sympy.Matrix([U[2, 1] - U[1, 2], U[0, 2] - U[2, 0], U[1, 0] - U[0, 1]]) / (2 * a)


def squares(U, sign=1):
    """What tends to the products of its components."""
    return (U + U.T + sign * (1 - U.trace()) * sympy.eye(3)) / a**2


@pytest.mark.parametrize(("sign", "holds"), [(1, True), (-1, False)])
def test_links_tend_to_strains_and_their_products(sign, holds):
    """Of exp(a hat(Xi)), by its series: up to the order a^2; with another sign not at all."""
    U, term = sympy.eye(3), sympy.eye(3)
    for n in range(1, 6):
        term = (term * a * hat(Xi) / n).expand()
        U += term
    rest = (squares(U, sign) - Xi * Xi.T).expand()
    small = all(sympy.expand(x).coeff(a, n) == 0 for x in rest for n in (-2, -1, 0, 1))
    assert small == holds
    first = (turn(U) - Xi).expand()
    assert all(x.coeff(a, n) == 0 for x in first for n in (-1, 0, 1))
    assert sum(x.coeff(a, 2) != 0 for x in first) == 3


def test_products_have_rank_one_for_rotations():
    """S = 2 c c^T (1 - cos t)/a^2: which components are paired does not matter."""
    c = sympy.Matrix([2, 3, 6]) / 7
    U = sympy.eye(3) * sympy.cos(t) + hat(c) * sympy.sin(t) + c * c.T * (1 - sympy.cos(t))
    rest = squares(U) - 2 * c * c.T * (1 - sympy.cos(t)) / a**2
    assert rest.expand() == sympy.zeros(3)


@pytest.mark.parametrize(
    ("exponents", "left", "pairs"),
    [
        ((0, 0, 0), [], []),
        ((0, 1, 0), [1], []),
        ((1, 1, 0), [], [(0, 1)]),
        ((2, 1, 2), [2], [(0, 0), (1, 2)]),
    ],
)
def test_components_are_paired(exponents, left, pairs):
    """In their order; one is left over where their number is odd."""
    assert pair_components(exponents) == (left, pairs)


def test_the_energy_is_split():
    """Into momenta and monomials of strains, with their factors."""
    found = read_strand(
        strand((STIFF, f"{STIFF} - Xi[1]*Xi[2]^3/L0"), ("L = {", "L0 = { default = 2 }\nL = {"))
    )
    texts = {exponents: str(factor) for exponents, factor in found.potential.items()}
    assert texts.keys() == {(2, 0, 0), (0, 2, 0), (0, 0, 2), (1, 3, 0)}
    assert texts[1, 3, 0] == "1/L0"


CLAMPED = ("order = 4", 'order = 4, ends = "clamped"')
ALONE = ('"energy", "P"', '"energy"')
ON = ('name       = "so(3)"', 'name = "so(2,1)"')


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        ([ON], r"strand on so\(2,1\).*one on so\(3\) or se\(3\).*as elastic_chain does"),
        (
            [("Xi    =", 'G = { role = "advected", representation = "symmetric" }\nXi    =')],
            "'G' is advected, and no vector.*as spin_chain_lattice does",
        ),
        (
            [*TOPS, ("w*Gamma[3]", "w*Gamma[3]*dot(Xi, Xi)")],
            "advected quantities and strains together",
        ),
        ([(STIFF, f"{STIFF} - dot(Omega, Xi)")], "momenta and strains together"),
        ([(STIFF, f"{STIFF} - dot(Xi, Xi)/L")], "names the length L"),
        ([(STIFF, f"{STIFF} - sqrt(1 + dot(Xi, Xi))")], "no polynomial.*first terms"),
        ([(STIFF, f"{STIFF} - 1/(1 + Xi1^2)")], "no polynomial.*in a denominator"),
        ([(STIFF, f"{STIFF} - 1/Xi1")], "no polynomial.*in a denominator"),
    ],
)
def test_strands_without_a_lattice_are_refused(changes, found):
    """With what was found, what is expected, and what to do."""
    with pytest.raises(SpecError, match=r"chain\.toml: no lattice of bodies") as caught:
        read_strand(strand(*changes))
    assert re.search(found, str(caught.value)), str(caught.value)


@pytest.mark.parametrize("name", ["rigid_body", "landau_lifshitz", "camassa_holm", "euler_2d"])
def test_what_is_no_strand_is_refused(name):
    """A body, fields without a strain, and motions of a circle or of a plane."""
    with pytest.raises(SpecError, match="it has no strain; expected a strand"):
        read_strand(shipped(name))


def test_strands_on_other_algebras_are_refused():
    """With the system that shows how such bodies are declared, which is there."""
    with pytest.raises(SpecError, match="elastic_chain"):
        read_strand(shipped("sp2_strand"))
    assert shipped("elastic_chain").index


def test_walls_hold_a_chain_between_clamped_ends():
    """Their links are proved to keep Jacobi and the energy; the momentum in space is not claimed.

    Free ends have no walls, and their certificate claims it.
    """
    held, free = (
        lattice_of(strand(("order = 4", f'order = 4, ends = "{ends}"'), ALONE))
        for ends in ("clamped", "free")
    )
    assert not held.index[0].periodic
    assert not free.index[0].periodic
    certificate = prove_claims(held)
    assert certificate.holds, str(certificate)
    statements = [each.statement for each in certificate.claims]
    jacobi = "the Poisson bracket satisfies the Jacobi identity, for every N >= 4"
    assert jacobi in statements
    assert [each.formula.text for each in held.conserved] == ["energy"]
    assert [each.formula.text for each in free.conserved] == ["energy", "J"]


def test_walls_turn_the_total_momentum_in_space():
    """Claimed all the same, it is refuted."""
    text = write_lattice(strand(CLAMPED, ALONE), 6)
    old = 'conserved = ["energy"]'
    assert old in text
    text = text.replace(old, 'conserved = ["energy", "J"]')
    verdicts = {
        each.statement.partition(" ")[0]: each.verdict
        for each in prove_claims(read_spec_text(text, Path("lattice.toml"))).claims
        if each.kind == "conserved"
    }
    assert verdicts["J"] == "refuted"


@pytest.mark.parametrize(
    ("old", "new", "holds"), [("", "", True), ("squares(transpose(R[i])*", "squares(", False)]
)
def test_the_certificate_proves_jacobi_and_the_total_momentum(old, new, holds):
    """For every number of bodies; a link as seen from space loses the momentum alone."""
    text = write_lattice(strand(), 16).replace(old, new)
    certificate = prove_claims(read_spec_text(text, Path("lattice.toml")))
    verdicts = {each.statement: each.verdict for each in certificate.claims}
    jacobi = "the Poisson bracket satisfies the Jacobi identity, for every N >= 1"
    assert verdicts[jacobi] == "proved"
    (kept,) = (v for s, v in verdicts.items() if s.startswith("J is conserved"))
    assert (kept == "proved") == holds


def test_a_right_invariant_chain_keeps_momenta_in_body_axes():
    """In axes of space they change: claimed, they are refuted."""
    alike = (STIFF, "- dot(Xi, Xi)/2")
    text, total = write_lattice(strand(('"left"', '"right"'), alike), 16), "transpose(R[i])*Pi[i]"
    for old, new, verdict in (("", "", "proved"), (total, "R[i]*Pi[i]", "refuted")):
        assert old in text
        declared = read_spec_text(text.replace(old, new), Path("lattice.toml"))
        claims = prove_claims(declared).claims
        (kept,) = (each.verdict for each in claims if each.statement.startswith("J is conserved"))
        assert kept == verdict


def test_vectors_that_a_right_invariant_chain_advects_stay_in_body_axes():
    """Each is proved to, by its components."""
    tops = lattice_of(strand(('"left"', '"right"'), *TOPS), 4)
    certificate = prove_claims(tops)
    assert certificate.holds, str(certificate)
    assert "(transpose(R[i])*Gamma[i])[3]" in {each.in_one_line for each in tops.casimirs}


@pytest.mark.parametrize(
    ("new", "verdict"), [("(R[i]*Gamma[i])[3]", "proved"), ("Gamma[i, 3]", "refuted")]
)
def test_advected_vectors_stay_in_space(new, verdict):
    """In body axes they turn; the total momentum in space is not claimed, as they turn bodies."""
    text, old = write_lattice(strand(*TOPS), 4), '"(R[i]*Gamma[i])[3]"'
    assert old in text
    declared = read_spec_text(text.replace(old, f'"{new}"'), Path("lattice.toml"))
    assert [each.formula.text for each in declared.conserved] == ["energy"]
    claims = prove_claims(declared).claims
    verdicts = {each.verdict for each in claims if each.statement.startswith(f"{new} is a Casimir")}
    assert verdicts == {verdict}
    rest = {each.verdict for each in claims if not each.statement.startswith(new)}
    assert rest == {"proved"}


def test_what_the_strand_keeps_in_body_axes_stays():
    """Of spheres the total angular momentum in body axes, by the lattice's own certificate."""
    declared = lattice_of(shipped("spin_chain_chiral"))
    assert [each.formula.text for each in declared.conserved] == ["energy", "J", "M"]
    certificate = prove_claims(declared)
    assert certificate.holds, str(certificate)
