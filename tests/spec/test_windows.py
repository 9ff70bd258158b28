"""Specs with an index: what is read, what is refused, and what the messages say."""

import pytest

from coadjoint.errors import LimitError, SpecError
from coadjoint.families import Index
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.members import Members, reach
from coadjoint.spec.core.positions import scan
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.written_out import write_out
from coadjoint.spec.looped import find_misfit
from coadjoint.spec.reader import read_spec
from coadjoint.spec.validate import validate
from tests.conftest import FAMILIES, WRITTEN
from tests.families import (
    BEADS,
    CHAIN,
    CLOSED,
    HELD,
    MEAN,
    NECKLACE,
    PLANAR,
    RING,
    SPRINGS,
    VORTICES,
    WALLS,
    read,
)
from tests.specs import RIGID_BODY, shipped

MOMENTA = 'S = { role = "momentum", index = "i" }'
TWIN = 'T = { role = "momentum", block = "rotation_2" }'
M = 'M = "sum(i, S[i, 3])"'
SQUARE = ('"energy", "M"', '"energy", "sum(i, S[i, 3])^2"')
OWN = ("-J*sum(i, dot", "-sum(i, J[i]*dot")
OWN_SHARED = "-sum(i, a[i]*dot"
#: Of each advice: a spec, what is wrong with it, what the message says, and what it says to do.
INDEXED = [
    (
        CHAIN,
        [("i = { size = 6 }", "i = { size = 6 }\nk = { size = 3 }")],
        "Remove k; a sum over pairs has a second index without a declaration.",
        [("\nk = { size = 3 }", "")],
    ),
    (RING, [OWN], 'Write J, or add index = "i" where it is declared.', [OWN[::-1]]),
    (
        RING,
        [OWN],
        'add index = "i" where it is declared.',
        [("J = { default", 'J = { index = "i", default')],
    ),
    (
        RING,
        [(M, 'M = "sum(i, S[3])"')],
        "The second subscript is a component: S[i, 1].",
        [("S[3]", "S[i, 3]")],
    ),
    (
        RING,
        [("size = 6, ", ""), (M, 'M = "abs(sum(i, S[i, 3]))"')],
        'Give the index a size, or choose one: sizes={"i": 5}.',
        [("{ periodic", "{ size = 6, periodic")],
    ),
    (
        RING,
        [(M, 'M = "sum(i, sum(J, J < i, S[i, 3]*S[J, 3]))"')],
        "Count with another letter, as sum(k, ...).",
        [("sum(J, J < i, S[i, 3]*S[J, 3])", "sum(k, k < i, S[i, 3]*S[k, 3])")],
    ),
    (
        RING,
        [("[parameters]", "[parameters]\na = { shape = [6], default = 1 }"), (OWN[0], OWN_SHARED)],
        "Components are counted from 1: write a[i+1]",
        [("a[i]", "a[i+1]")],
    ),
    (
        RING,
        [("[parameters]", "[parameters]\na = { shape = [6], default = 1 }"), (OWN[0], OWN_SHARED)],
        "or begin with member 1, [index] i = { first = 1 }.",
        [("{ size", "{ first = 1, size")],
    ),
    (RING, [("J = { default", "i = { default")], "Rename one of them.", [("i = { de", "J = { de")]),
    (
        RING,
        [
            ('name = "so(3)"', 'direct_sum = ["so(3)", "so(3)"]'),
            (MOMENTA, MOMENTA[:-2] + ', block = "rotation_1" }\n' + TWIN),
        ],
        'Add index = "i".',
        [(TWIN, TWIN[:-2] + ', index = "i" }')],
    ),
    (
        RING,
        [("size = 6, ", ""), SQUARE],
        "Give the index a size.",
        [("{ periodic", "{ size = 6, periodic")],
    ),
    (CHAIN, [("size = 6", "size = 2")], "Choose a larger size.", [("size = 2", "size = 3")]),
    (
        CHAIN,
        [("sum(i, p[i]^2/2)", "sum(i, p[i]^2/2) + q[n]^2")],
        'With count = "n" in [index], n is the number of members, and x[n-1] of the last.',
        [("q[n]^2", "q[n-1]^2"), ("{ size = 6 }", '{ size = 6, count = "n" }')],
    ),
    (
        CHAIN,
        [("sum(i, p[i]^2/2)", "sum(i, p[i]^2/2)/n")],
        'With count = "n" in [index], n is the number of members, and x[n-1] of the last.',
        [("{ size = 6 }", '{ size = 6, count = "n" }')],
    ),
    (
        CHAIN,
        [("sum(i, p[i]^2/2)", "sum(i, p[i]^2/N)"), ("size = 6", "first = 1, size = 6")],
        'With count = "N" in [index], N is the number of members, and x[N] of the last.',
        [("first = 1", 'first = 1, count = "N"')],
    ),
    (
        CHAIN,
        [("sum(i, p[i]^2/2)", "sum(i, p[i]^2/2) + q[7]^2"), ("size = 6", "first = 1, size = 6")],
        'With count = "n" in [index], n is the number of members, and x[n] of the last.',
        [("q[7]^2", "q[n]^2"), ("first = 1", 'first = 1, count = "n"'), ('"P"]', '"energy"]')],
    ),
    (
        RIGID_BODY,
        [("shape = [3]", 'shape = ["n"]')],
        'Declare what it counts: [index] i = { size = 8, count = "n" }.',
        [("[algebra]", '[index]\ni = { size = 3, count = "n" }\n[algebra]')],
    ),
    (
        CHAIN,
        [("[index]\ni = { size = 6 }\n", "")],
        "Write [index] and below it i = { size = 100 }.",
        [("[variables]", "[index]\ni = { size = 100 }\n[variables]")],
    ),
]
LAX = '[lax]\nL = "tridiagonal(p[i], q[i], p[i])"\nM = "tridiagonal(p[i], 0, p[i])"\n[obs'
ENERGY = "-J*sum(i, dot(S[i], S[i+1]))"
#: What is wrong with a spec, and what the message says of it.
BAD = [
    (RING, (ENERGY, "-J*sum(k, dot(S[k], S[k+1]))"), "there is no index 'k'"),
    (RING, (ENERGY, "-J*sum(i, dot(S[i], S[k]))"), "the index 'k' is not that of a sum around it"),
    (RING, (ENERGY, "-J*dot(S[i], S[i])"), "the index 'i' is not that of a sum around it"),
    (RING, (ENERGY, "-J*sum(i, dot(S, S[i]))"), "'S' is one quantity of each member"),
    (RING, (ENERGY, "-J*sum(i, 1)"), "does not name a member 'i'"),
    (RING, (ENERGY, "-J*sum(i, i, i < i, dot(S[i], S[i]))"), "indices of a pair have one name"),
    (RING, (ENERGY, "-J*sum(dot(S[i], S[i+1]))"), "the sum has no index"),
    (RING, (ENERGY, "-J*sum(i, S[i, 4])"), "out of range; expected 1 to 3"),
    (RING, ("size = 6", "size = 0"), "greater than or equal to 1"),
    (RING, ('D = { index = "i"', 'D = { index = "k"'), "there is no index 'k'"),
    (RING, ('D = { index = "i", default = 1', 'D = { index = "i", default = [1, 2]'), "6 entries"),
    (
        RING,
        (
            'D = { index = "i", default = 1',
            'D = { index = "i", repeats = true, default = [1, 2, 3, 4]',
        ),
        "and 6 a multiple of their number",
    ),
    (
        RING,
        ('D = { index = "i", default = 1', 'D = { index = "i", repeats = true, default = 1'),
        "one default for all members, which repeats",
    ),
    (VORTICES, ("size = 6", "size = 1"), "at least 2 for pairs"),
    (
        CHAIN,
        ("p[i]^2/2", "p[i, 2]^2/2"),
        "'p' is one number for each i, found p[i, 2]; expected p[i], without a component",
    ),
    (
        VORTICES,
        ('[poisson.brackets]\n"{x, y}" = "1/c[i]"', '[poisson]\nnambu = ["x[i]"]'),
        "brackets or canonical",
    ),
    (VORTICES, ('"{x, y}"', '"{x, z}"'), "z"),
    (RING, ("[obs", '[lax]\nL = "tridiagonal(J, J, J)"\nM = "hat(S_0)"\n[obs'), "a ring has no"),
    (CHAIN, ("[obs", '[lax]\nL = "tridiagonal(p[i], p[i])"\nM = "J"\n[obs'), "three are needed"),
    (CHAIN, ("[obs", LAX.replace("q[i]", "lambda")), "spectral parameter 'lambda'"),
    (CHAIN, ("[obs", LAX.replace("q[i]", "q[i+1]")), "lies beyond the end of the chain"),
]


@pytest.mark.parametrize(("text", "change", "said"), BAD)
def test_bad_input_is_refused_at_its_place(text, change, said):
    """With the line, and before anything is derived."""
    with pytest.raises(SpecError) as caught:
        read(text, change)
    assert said in str(caught.value)
    assert caught.value.line > 1


HAMILTONIAN = '[hamiltonian]\nh = "sum(i, p[i]^2/(2*m[i])) + sum(i, exp(q[i] - q[i+1]))"\n'
#: What keeps members from being looped over, and the clause that says so.
MISFITS = [
    (("m[i]*v[i]^2/2) -", "m[i]*v[i]*v[i+1]/2) -"), "the kinetic energy couples members"),
    (
        ("- sum(i, exp(q[i] - q[i+1]))", "- sum(i, j, i < j, (v[i] - v[j])^2)"),
        "the kinetic energy couples members",
    ),
    (("c*sum(i, (v[i] - v[i+1])^2)/2", "c*sum(i, v[i])^2/2"), "Rayleigh's function is not linear"),
    (
        ("c*sum(i, (v[i] - v[i+1])^2)/2", "c*sum(i, j, i < j, (v[i] - v[j])^2)/2"),
        "Rayleigh's function has a sum over pairs",
    ),
    (("[dissipation]\nR =", "[forces]\nv ="), "a force has a sum over members"),
    (("[hamiltonian]", "[time]\n[hamiltonian]"), "there are tables [time] and [lagrangian]"),
    (("v[i]^2/2) -", "v[i]^2/2) + v[0]^2 -"), "one member alone has a kinetic energy of its own"),
    (("sum(i, p[i]^2/(2*m[i]))", "p[0]*sum(i, p[i]^2/(2*m[i]))"), "the energy is not linear in"),
    (('P = "sum(i, p[i])"', 'P = "abs(sum(i, p[i]))"'), "an observable asks for the sign of a sum"),
    (('P = "sum(i, p[i])"', 'P = "sum(i, p[0]*p[i])"'), "a sum names one member alone"),
    (('P = "sum(i, p[i])"', 'P = "p[4]"'), "a member stands alone that is not among the first"),
]


@pytest.mark.parametrize(("change", "why"), MISFITS)
def test_what_no_generic_member_tells_is_written_out(change, why):
    """Only what the file says decides."""
    assert change[0] in SPRINGS
    assert not read_file_misfit(SPRINGS)
    assert read_file_misfit(SPRINGS.replace(*change)).startswith(why)


#: Actions that do not move each member by itself.
ACTIONS = [
    (('q = "a"', 'q = "q[i+1]*a[1]"'), "an action moves a member by others"),
    (('q = "a"', 'q = "sum(i, q[i])*a[1]"'), "an action moves a member by others"),
    (('q = "a"', 'q = "q[0]*a[1]"'), "q stands there of one member alone"),
    (("dot(a, p[i])", "dot(a, p[i+1])"), "a momentum map has terms of several members"),
    (('q = "a" }', 'q = "a" }\ntime = "a[1]"'), "an action moves time"),
    (
        ('vector = "a"\ngenerators = { q = "a" }\nmap = "sum(i, dot(a, p[i]))"', 'linear = ["q"]'),
        "an action is linear in stacked variables",
    ),
]


@pytest.mark.parametrize(("change", "why"), ACTIONS)
def test_actions_of_looped_members_move_each_by_itself(change, why):
    """Others are written out."""
    assert not read_file_misfit(PLANAR)
    assert change[0] in PLANAR
    assert read_file_misfit(PLANAR.replace(*change)).startswith(why)


#: Kinetic energies of Lagrangians without a Hamiltonian, and whether members are looped over.
KINETIC = [
    ("m[i]*v[i]^2/2", True),
    ("m[i]*v[i]*(v[i] + 2)/exp(q[i])", True),
    ("sin(q[i])^4*v[i]^2 + v[i]", True),
    ("m[i]*v[i]^4", False),
    ("m[i]*v[i]^2*v[i]", False),
    ("-m[i]*sqrt(1 - v[i]^2)", False),
    ("m[i]/v[i]", False),
]


@pytest.mark.parametrize(("kinetic", "loops"), KINETIC)
def test_without_a_hamiltonian_velocities_are_solved_for_member_by_member(kinetic, loops):
    """Where the Lagrangian is quadratic in them."""
    text = SPRINGS.replace(HAMILTONIAN, "").replace("m[i]*v[i]^2/2", kinetic, 1)
    misfit = "" if loops else "the Lagrangian is not quadratic in the velocities"
    assert read_file_misfit(text) == misfit


def test_the_number_of_members_is_a_value_and_an_index_is_none():
    """The value keeps its name in what is written out; other indices are numbers of members."""
    spec = read(MEAN)
    assert spec.family.index.is_value
    assert spec.family.shared == ("J", "K")
    assert all(each.parameters[-1].name == "n" for each in spec.family.windows)
    assert not read(WALLS).family.index.is_value
    counted = MEAN.replace("p[i]^2/2)", "i*p[i]^2/2)")
    assert read(counted).written == "a formula has i as a number"


def read_file_misfit(text):
    """Why the members of a text are not looped over; "" if they are."""
    source = Source(path="sample.toml", text=text, positions=scan(text))
    return find_misfit(validate(source), Index("i", 6))


def test_members_at_the_ends_are_read_in_any_chain_that_keeps_them_apart():
    """Where they stand; shorter chains are written out, and a ring has no ends."""
    assert read(WALLS).family.alone == (2, 1)
    assert read(CLOSED).family.alone == (1, 1)
    short = read(WALLS, sizes={"i": 5})
    assert short.written == "the ends of a chain of fewer than 6 do not keep apart"
    assert len(short.state) == 10
    ring = read(CLOSED, ("size = 6", "size = 6, periodic = true"))
    assert ring.written == "q stands there of one member alone"
    with pytest.raises(SpecError, match=r"beyond the end of the chain; expected members 1 to n"):
        read(WALLS, ("q[1]*q[2]", "q[0]*q[2]"))
    with pytest.raises(SpecError, match=r"expected members 0 to n - 1"):
        read(CLOSED, ("q[n-1]", "q[n]"))


def test_limits_of_neighbours_and_members():
    """A neighbour that is too far, and more members than fit into memory."""
    with pytest.raises(LimitError, match="NEIGHBOURS"):
        read(RING, (ENERGY, "-J*sum(i, dot(S[i], S[i+5]))"))
    with pytest.raises(LimitError, match="FAMILY_MEMBERS"):
        read(RING, sizes={"i": 10**9})


@pytest.mark.parametrize(
    ("text", "change", "numbers"),
    [
        (WALLS, None, (6, 7)),
        (CLOSED, None, (4, 5)),
        (HELD, None, (2, 3, 4)),
        (BEADS, ("sum(i, p[i]^2/2)", "sum(i, p[i]^2/2) + q[0]^2"), (6, 7, 8)),
        (VORTICES, None, (2, 3)),
        (BEADS, None, (2, 3, 4)),
        (NECKLACE, None, (4, 5, 6)),
        (NECKLACE, ('P = "sum(i, p[i])', 'P = "sum(i, p[i]*p[i+1])'), (8, 9, 10)),
        (BEADS, ("q[i+1] - q[i]", "q[i+2] - q[i]"), (4, 5, 6)),
        (
            RING.replace('"energy", "M"', '"energy"'),
            (M, 'M = "sum(i, j, i < j, dot(S[i], S[j]))"'),
            (4, 5, 6),
        ),
    ],
)
def test_windows_have_the_numbers_of_members_of_the_proof(text, change, numbers):
    """4 w and two more in a ring, 2 w and two more in a chain; w is the span of both sums."""
    spec = read(text, *([change] if change else []), sizes={"i": 60})
    found = [len(each.state) // len(spec.family.variables) for each in spec.family.windows]
    assert tuple(found) == numbers


@pytest.mark.parametrize("size", [0, -3, 2.5, True, "6"])
def test_a_chosen_size_is_a_positive_integer(size):
    """And nothing else."""
    with pytest.raises(SpecError, match="an integer of 1 or more"):
        read(RING, sizes={"i": size})


def test_sizes_are_chosen_by_the_name_of_the_index():
    """Of a spec that has it."""
    assert read(RING, sizes={"i": 17}).family.index.size == 17
    assert read(RING, ("size = 6, ", "")).family.index.size is None
    with pytest.raises(SpecError, match="a size is chosen for 'k', which is no index"):
        read(RING, sizes={"k": 3})
    with pytest.raises(SpecError, match=r"Leave sizes out, or declare \[index\]"):
        read(RIGID_BODY, sizes={"i": 3})
    assert read(RIGID_BODY).family is None


@pytest.mark.parametrize("name", FAMILIES)
def test_shipped_families_have_units_docs_and_defaults(name):
    """As other shipped systems have."""
    spec = shipped(name)
    assert spec.license == "BSD-3-Clause"
    assert spec.source
    assert all(each.doc for each in (*spec.variables, *spec.parameters))
    assert all(each.default is not None for each in spec.parameters)
    assert "energy" in [each.everywhere for each in spec.conserved]


def test_systems_whose_members_are_written_out():
    """They have an index, all their members, and the size in each statement."""
    for name in WRITTEN:
        found = shipped(name)
        assert found.written
        assert found.family is None
        assert found.index[0].size in (4, 8)


def test_what_counts_components_has_the_size_of_the_spec():
    """Another one would leave out entries of the matrix."""
    path = shipped("so8_body").path
    with pytest.raises(SpecError, match="which counts components"):
        read_spec(path, {"i": 5})


def names_in(text, count, *, periodic):
    """What a sum over members of S is, as text."""
    members = Members("i", count, periodic, frozenset({"S"}))
    tree = write_out(read_expression(text, indexed=True), members, ("hamiltonian", "h"))
    return show(tree)


def show(node):
    """A tree of sums and products of names."""
    if hasattr(node, "operator"):
        return f"{show(node.left)}{node.operator}{show(node.right)}"
    return node.name if hasattr(node, "name") else str(node.value)


def test_sums_go_over_the_members_that_have_their_neighbours():
    """A ring closes, an open chain ends, and a pair is counted once."""
    assert names_in("sum(i, S[i]*S[i+1])", 3, periodic=True) == "S_0*S_1+S_1*S_2+S_2*S_0"
    assert names_in("sum(i, S[i]*S[i+1])", 3, periodic=False) == "S_0*S_1+S_1*S_2"
    assert names_in("sum(i, S[i-1]*S[i+1])", 4, periodic=False) == "S_0*S_2+S_1*S_3"
    assert names_in("sum(i, S[i-1]*S[i])", 2, periodic=True) == "S_1*S_0+S_0*S_1"
    pairs = "S_0*S_1+S_0*S_2+S_1*S_2"
    assert names_in("sum(i, j, i < j, S[i]*S[j])", 3, periodic=True) == pairs
    assert reach(read_expression("S[i-2]*S[i+1]", indexed=True)) == (2, 1)


def test_windows_are_large_enough_for_what_is_claimed():
    """Twice the width of a rate in a ring; the width in an open chain; two and three of pairs."""

    def counts(spec):
        return [len(each.state) // len(spec.family.variables) for each in spec.family.windows]

    assert counts(read(RING)) == [4, 5]
    wide = (SQUARE[0], '"energy", "sum(i, dot(S[i], S[i+2]))"')
    assert counts(read(RING, wide)) == [6, 7]
    assert counts(read(CHAIN)) == [4, 5]
    assert counts(read(VORTICES)) == [2, 3]


def test_a_fault_in_what_is_written_out_names_the_key_of_the_text():
    """Members have names of their own, which stand in no file."""
    lists = ('index = "i" }\nv', 'index = "i", default = [[0], [1], [2], [3], [4], [5]] }\nv')
    with pytest.raises(SpecError, match=r"variables\.q\.default: the default of 'q'") as found:
        read(SPRINGS, lists)
    assert "a list with one such entry for each member" in str(found.value)
    read(SPRINGS, (lists[0], 'index = "i", default = [0, 1, 2, 3, 4, 5] }\nv'))
