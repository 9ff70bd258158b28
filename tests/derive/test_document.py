"""Documents of systems say what their quantities are, in signs of books."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace

import pytest

from coadjoint.derive import derive
from coadjoint.derive.document import document
from coadjoint.derive.lines import formula_line
from coadjoint.notation.names import name
from coadjoint.resources import systems_folder
from tests.specs import emitted, shipped


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
    assert waves["J"].startswith("phases of the waves")
    assert meanings("kepler")["L"] == "angular momentum r x v"
    (turning,) = shipped("kepler").symmetries
    bare = replace(shipped("kepler"), symmetries=(replace(turning, doc=""),))
    rows = {row[1]: row[2] for row in document(derive(bare)).sections[1].rows}
    assert rows["L"] == "momentum map of the action of so(3)"
    assert meanings("body_of_revolution")["L_axis"].startswith("about the axis through the point")
    assert meanings("rigid_body_attitude")["Pi_spatial"] == "Pi as seen from space"
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


def find_equal_in_print(names: Iterable[str]) -> set[tuple[str, ...]]:
    """Names that some format writes alike."""
    found = set[tuple[str, ...]]()
    for form in ("latex", "mathml", "typst"):
        alike = defaultdict[str, list[str]](list)
        for each in sorted(set(names)):
            alike[getattr(name(each), form)].append(each)
        found |= {tuple(each) for each in alike.values() if len(each) > 1}
    return found


def list_names(system):
    """Names of components, of what is emitted, and of intermediates in the generated kernel."""
    of = shipped(system)
    declared = [*of.variables, *of.parameters, *of.inputs, *of.reconstruction]
    names = {part for each in declared for part in (each.name, *each.components)}
    names |= {each.name for each in (*of.observables, *of.definitions, *of.symmetries)}
    names |= {f"casimir{n}" for n, _ in enumerate(of.casimirs, 1)}
    text = (systems_folder() / system / "kernel_python.py").read_text(encoding="utf-8")
    rates = set(re.findall(r"\bd\w+_dt\b", text))
    return names | rates, set(re.findall(r"(?<!\w)_[A-Za-z]\w*\b(?!\()", text))


def test_no_two_names_of_a_system_are_equal_in_print():
    """In no format: what a kernel computes on its way has letters that no spec can name."""
    systems = sorted(each.parent.name for each in systems_folder().glob("*/certificate.json"))
    assert len(systems) > 100
    with_intermediates = 0
    for system in systems:
        names, intermediates = list_names(system)
        with_intermediates += bool(intermediates)
        assert not find_equal_in_print(names | intermediates), system
    assert with_intermediates > 50


def test_names_that_are_equal_in_print_are_found():
    """Two names of one letter; intermediates without their mark would be parameters."""
    names, intermediates = list_names("suslov_so5")
    assert {each.removeprefix("_") for each in intermediates} & names >= {"k1", "k2", "k3"}
    assert find_equal_in_print({"eps1", "epsilon1"}) == {("eps1", "epsilon1")}
    assert find_equal_in_print({"p_phi", "pphi", "p"}) == {("p_phi", "pphi")}


def test_iterates_are_told_from_positions():
    """By letters, and by the words that say what they are, in each format."""
    step = sections("darwin_charges")["Velocities"]
    assert "_x1, _x2 are found by Newton's iteration of 32 steps from rest" in step.law
    assert not step.law_latex
    line = next(line for line in step.lines if line.text.startswith("_y1"))
    assert r"\tilde{x}_1" in line.latex
    assert " x_1" not in line.latex
    assert "tilde(x)_(1)" in line.typst
    assert line.mathml.count("<mo>~</mo>") == 2


def list_idle(section):
    """Lines that say of something that it is itself, in print."""
    sides = (line.latex.split(" &= ") for line in section.lines)
    return [left for left, *right in sides if right == [left]]


@pytest.mark.parametrize(
    "system", ["n_link_chain", "double_spherical_pendulum", "heisenberg_sub_riemannian"]
)
def test_no_line_says_that_something_is_itself(system):
    """Neither a rate that the kernel solves for, nor a velocity that constraints leave free."""
    told = [word for each in sections(system).values() for word in each.words]
    assert (("the other rates", "as the kernel solves for them") in told) == (system[0] == "n")
    assert not [line for each in sections(system).values() for line in list_idle(each)]


def test_the_last_step_of_a_chain_refers_to_its_solve():
    """It has the rates of the angles, and no ``domega_1/dt = domega_1_dt``."""
    step = sections("n_link_chain")["Euler-Lagrange equations"]
    lefts = [line.text.split(" = ")[0] for line in step.lines]
    assert lefts == [f"dtheta_{n}/dt" for n in range(1, 5)]
    assert step.words == (("the other rates", "as the kernel solves for them"),)
    field = emitted("n_link_chain").setting.field
    idle = formula_line(field, name("omega_1", dot=True), field["domega_1_dt"])
    assert list_idle(replace(step, lines=(*step.lines, idle)))  # as it was printed
