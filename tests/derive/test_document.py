"""Documents of systems say what their quantities are, in signs of books."""

from __future__ import annotations

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
