"""Documents of systems say what their quantities are, in signs of books."""

from __future__ import annotations

import pytest

from coadjoint.derive import derive
from coadjoint.derive.document import document
from tests.specs import shipped


def sections(system):
    """The sections of a system by title."""
    return {each.title: each for each in document(derive(shipped(system))).sections}


def meanings(system):
    """What the table of symbols says of each name."""
    return {row[1]: row[2] for row in sections(system)["Symbols"].rows}


def test_what_is_emitted_has_a_meaning():
    """Where the spec has no words for it: reactions, momenta, momentum maps, integrals."""
    top = meanings("tippe_top")
    assert top["plane_reaction"] == "force of the constraint plane"
    assert top["Omega_momentum"] == "momentum of the velocity Omega"
    waves = meanings("three_wave")
    assert waves["J"] == "momentum map of the symmetry of this name"
    assert waves["integral1"] == "coefficient of a trace of a power of the Lax matrix"


def test_observables_of_fields_are_densities():
    """Their integrals are emitted; of bodies they are emitted as they are."""
    title = "Casimirs, observables and momentum maps"
    assert sections("kdv")[title].law.startswith("densities, whose integrals")
    assert sections("tippe_top")[title].law == "emitted with the motion"


def test_the_forces_of_a_chain_have_places_below():
    """As components of M dv/dt, and not as words."""
    step = sections("n_link_chain")["Accelerations, solved for in the kernel"]
    assert [line.text.split(" = ")[0] for line in step.lines][:2] == ["(M dv/dt)_1", "(M dv/dt)_2"]
    assert all(r"\dot v" in line.latex and "<msub>" in line.mathml for line in step.lines)


def read_bracket(section):
    """Names at the left of rows, those above columns, and entries by both of them."""
    (_, *above), *rows = section.table
    left, columns = [row[0].text for row in rows], [each.text for each in above]
    return left, columns, {
        (a, b): cell.text for a, row in zip(left, rows, strict=True)
        for b, cell in zip(columns, row[1:], strict=True)
    }  # fmt: skip


def is_of_velocities(names, velocities):
    """Whether a bracket is told of velocities, whose own one has the inverse of the mass in it."""
    return not velocities.isdisjoint(names)


@pytest.mark.parametrize(
    ("system", "velocities", "pair", "value"),
    [
        ("n_link_chain", {f"omega_{n}" for n in range(1, 5)}, ("theta_1", "M_omega_1"), "1"),
        ("appell_machine", {"omega", "vphi"}, ("z", "M_vphi"), "-a"),
        ("chaplygin_sleigh", {"v", "omega"}, ("M_v", "M_omega"), "omega*m*a + u*m"),
    ],
)
def test_brackets_of_velocities_are_those_of_their_momenta(system, velocities, pair, value):
    """``{theta, M_omega} = 1``: the heads name momenta, as the claims about the bracket do."""
    section = sections(system)["Bracket"]
    left, above, entries = read_bracket(section)
    assert left == above
    assert entries[pair] == value
    assert not is_of_velocities(left, velocities)
    assert "M_v = dl" in section.law
    named = [name.removeprefix("M_") for name in left]
    assert is_of_velocities(named, velocities)


def test_brackets_of_momenta_name_them():
    """Momenta and positions of a state are what they are called."""
    left, _, _ = read_bracket(sections("heavy_top")["Bracket"])
    assert left == [f"{name}{n}" for name in ("Pi", "Gamma") for n in (1, 2, 3)]
    assert "M_v" not in sections("heavy_top")["Bracket"].law
