"""Equations of motion as sections: complete without the steps of a derivation."""

import re
from dataclasses import replace

import pytest

from coadjoint.derive import derive
from coadjoint.derive.document import document
from coadjoint.derive.motion import LONGEST_SOLVE, motion_sections
from tests.specs import emitted, shipped


def test_rates_that_are_solved_for_are_shown_as_what_is_solved():
    """Bloch (2003), 1.7: (I + m a^2) omega' = -m a omega v, v' = a omega^2."""
    (motion,) = motion_sections(emitted("chaplygin_sleigh"))
    assert [line.text for line in motion.lines] == [
        "(m*a^2 + I) domega_dt = -v*omega*m*a",
        "m dv_dt = omega^2*m*a",
    ]
    assert motion.law == "in components, as the linear equations that the kernel solves"


@pytest.mark.parametrize("name", ["snakeboard", "chaplygin_sleigh", "appell_machine"])
def test_a_law_names_what_follows(name):
    """Where lines are announced, there are some; what is left to the steps has none."""
    (motion,) = motion_sections(emitted(name))
    assert motion.lines
    assert "the linear equations that the kernel solves" in motion.law
    assert all("follow" not in part.law for part in (motion,))


def test_no_line_of_a_motion_stands_twice():
    """What a solve rests on tells what velocities are as well."""
    (motion,) = motion_sections(emitted("ball_in_sphere"))
    texts = [line.text for line in motion.lines]
    assert "_b1 = n3*r/a" in texts
    assert len(texts) == len(set(texts))


def test_long_linear_equations_are_left_to_the_steps(monkeypatch):
    """And the law says so."""
    equations = derive(shipped("chaplygin_sleigh"))
    monkeypatch.setattr("coadjoint.derive.motion.LONGEST_SOLVE", 20)
    (motion,) = motion_sections(replace(equations))
    assert LONGEST_SOLVE > 20
    assert motion.lines == ()
    assert "sets up step by step" in motion.law


@pytest.mark.parametrize(
    ("name", "steps"), [("heisenberg_lattice", "members"), ("zeitlin_su_n", "rows")]
)
def test_the_number_of_members_stands_where_the_steps_are(name, steps):
    """With the principle, and not with the motion, which pages show without steps."""
    sections = document(emitted(name)).sections
    assert not any("follow" in part.law for part in sections if part.kind in ("motion", "members"))
    principle = next(part for part in sections if part.kind == "principle")
    assert steps in dict(principle.words)["steps"]


_NAME = re.compile(r"(?<![\w.])_?[A-Za-z]\w*")
_FUNCTIONS = {"diag", "sqrt", "x", "sin", "cos", "T"}


def find_untold(spec, lines):
    """Names on which rates of some lines rest, that are of no state and stand in no other line."""
    quantities = (*spec.state, *spec.parameters, *spec.inputs)
    known = {part for q in quantities for part in (q.name, *q.components)} | _FUNCTIONS
    used, told = set[str](), set[str]()
    for line in lines:
        left, _, right = line.text.partition(" = ")
        names = set(_NAME.findall(re.sub(r"\bd(\w+)/d(\w+)", r"\1 \2", right)))
        if re.fullmatch(r"d\w+/dt", left):
            used |= names
        elif left.startswith("_"):
            told.add(left)
            used |= names
        else:
            told |= names | set(_NAME.findall(left))
    for variable in spec.variables:  # a whole tells its components, and they tell it
        parts = {*variable.components}
        told |= parts if variable.name in told else {variable.name} if parts <= told else set()
    return used - told - known


def is_rate(line):
    """Whether a line is a rate."""
    return re.match(r"d\w+/dt = ", line.text) is not None


@pytest.mark.parametrize(
    "name",
    [
        "guiding_centre",
        "guiding_centre_twisted",
        "landau_lifshitz_gilbert",
        "relativistic_particle",
        "heavy_top",
        "galilei",
        "sl2_r2",
    ],
)
def test_the_first_box_says_what_its_names_are(name):
    """By vectors and in components: velocities and intermediates stand in a line of their own."""
    equations = emitted(name)
    (motion,) = motion_sections(equations)
    assert motion.vectors
    for lines in (motion.vectors, motion.lines):
        assert not find_untold(equations.spec, lines)
        bare = list(filter(is_rate, lines))
        assert len(bare) < len(lines)
        assert find_untold(equations.spec, bare)  # as the box was


def test_velocities_that_an_iteration_finds_are_told_by_their_momenta():
    """Landau and Lifshitz (65.7): p1 = m1 v1 + m1 v1^3/(2 c^2) + k v2/(c^2 r), x1 - x2 = r."""
    equations = emitted("darwin_charges")
    (motion,) = motion_sections(equations)
    told = [line.text for line in motion.lines if not is_rate(line)]
    assert told[0] == "p1 = 1/2*v1^3*m1/c^2 + v1*m1 + v2*k/(c^2*(x1 - x2))"
    assert not find_untold(equations.spec, motion.lines)


def test_a_velocity_that_fills_a_page_is_told_by_the_bracket():
    """V = {X, h} where it is one; of another energy it is not."""
    equations = emitted("guiding_centre")
    (motion,) = motion_sections(equations)
    assert [line.text for line in motion.vectors][2:] == ["V = {X, h}", "a = {u, h}"]
    other = replace(equations.exact, energy=2 * equations.exact.energy)
    (spoiled,) = motion_sections(replace(equations, exact=other))
    assert [line.text for line in spoiled.vectors] == ["dX/dt = V", "du/dt = a"]


def test_slopes_of_energies_are_found_exactly():
    """Omega = dh/dm of a moment; of another energy the line is not there."""
    equations = emitted("landau_lifshitz_gilbert")
    (motion,) = motion_sections(equations)
    assert "omega = dh/dm" in [line.text for line in motion.vectors]
    other = replace(equations.exact, energy=2 * equations.exact.energy)
    (spoiled,) = motion_sections(replace(equations, exact=other))
    assert "omega = dh/dm" not in [line.text for line in spoiled.vectors]


def test_linear_equations_stand_with_vectors_where_they_are_announced(monkeypatch):
    """Plain text has no components below equations by vectors, here of one without a balance."""
    monkeypatch.setattr("coadjoint.derive.vectors.form.balance_lines", lambda _: None)
    (motion,) = motion_sections(emitted("double_spherical_pendulum"))
    texts = [line.text for line in motion.vectors]
    assert "those of v1, v2 in components, as the linear equations" in motion.law
    assert "minus the multipliers" in motion.law
    assert any("dv1_1_dt" in text for text in texts)
    assert any("dv2_3_dt" in text for text in texts)


def test_scalars_stand_with_vectors_and_before_them():
    """Holm (2011), section 6.6, on Bargmann's group: mass times velocity, and tau = E/c."""
    (motion,) = motion_sections(emitted("bargmann"))
    assert [line.text for line in motion.vectors][1:] == [
        "dK/dt = K x (diag(I)^(-1) J) - E P/c - M diag(B)^(-1) P",
        "dP/dt = M diag(A)^(-1) K + P x (diag(I)^(-1) J)",
        "dE/dt = P . (diag(A)^(-1) K)",
        "dM/dt = 0",
    ]
    assert motion.law.startswith("by vectors, each line found equal")
