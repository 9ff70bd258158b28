"""The gradient of an energy and the bracket of a generic member, against sums that are written out.

The energy of seven members, or of points of a grid, is added up term by term and differentiated as
a whole; the bracket times that is the rates, which were derived in another way.
"""

from __future__ import annotations

from itertools import combinations
from random import Random
from typing import Any

import pytest
import sympy

from coadjoint.derive import action, derive
from coadjoint.derive.fields.grid import make_grid
from coadjoint.derive.indexed import derive_family
from coadjoint.spec import read_spec_text
from tests.families import CHAIN, CLOSED, HELD, PEAKONS, PLANAR, RING, VORTICES, WALLS
from tests.specs import shipped

#: Spins with an energy of degree 4.
QUARTIC = RING.replace("S[i], S[i+1])) +", "S[i], S[i+1])) + sum(i, S[i, 1]^4) +").replace(
    '"energy", "M"]', '"energy"]'
)
CHAINS = {"chain": CHAIN, "closed": CLOSED, "held": HELD, "walls": WALLS, "planar": PLANAR}
CUBIC = CHAIN.replace("exp(q[i] - q[i+1])", "(q[i] - q[i+1])^3")
TEXTS = {**CHAINS, "vortices": VORTICES, "quartic": QUARTIC, "cubic": CUBIC}
#: A strand whose stiffness grows with its turns.
STRAND = (
    shipped("spin_chain")
    .path.read_text(encoding="utf-8")
    .partition("[observables]")[0]
    .replace('"euler-poincare", "lie-poisson", "hamilton-pontryagin"', '"lie-poisson"')
    .partition("[lagrangian]")[0]
    .replace('Omega = { role = "velocity", doc = "angular velocities in body axes" }', "")
    + '[hamiltonian]\nh = "dot(Pi, Pi)/2 + dot(Xi, diag(K)*Xi)/2 + (Xi[1] + Xi[2]/2)^4/4"\n'
)
FIELDS = {
    "circle": STRAND,
    "free": STRAND.replace("order = 4", 'order = 2, ends = "free"'),
    "clamped": STRAND.replace("order = 4", 'order = 4, ends = "clamped"'),
}


def find_family(name: str) -> Any:
    """The generic member, or point."""
    if name in FIELDS:
        return make_grid(derive(read_spec_text(FIELDS[name], "field.toml"))).family
    return derive_family(derive(read_spec_text(TEXTS[name], "members.toml")))


class Members:
    """So many members with numbers of their own.

    Args:
        family: The generic one.
        size: How many.
    """

    def __init__(self, family: Any, size: int) -> None:
        self.family, self.size, source = family, size, Random(size)

        def draw() -> sympy.Rational:
            return sympy.Rational(source.randint(60, 180), 97)

        self.shared = {s: draw() for s in family.shared} | dict.fromkeys(family.count, size)
        self.rows = {(c, i): sympy.Symbol(f"{c}_{i}") for c in family.own for i in range(size)}
        self.values = {row: draw() for row in self.rows.values()}

    def place(self, tree: Any, i: int, j: int = 0) -> Any:
        """What is written of the generic member, of member i."""
        own, size = self.family, self.size
        new = {c: self.rows[c, i] for c in own.own} | self.shared
        new |= {s: self.rows[c, (i + k) % size] for (c, k), s in own.neighbours.items()}
        new |= {s: self.rows[c, j] for c, s in own.partners.items()}
        new |= {s: self.rows[c, n % size] for (c, n), s in own.singles.items()}
        return tree.xreplace(new)

    def evaluate(self, tree: Any) -> Any:
        """Its number, to 40 digits."""
        return tree.xreplace(self.values).evalf(40)

    def find_energy(self) -> Any:
        """The energy, written out."""
        (total,) = (each for each in self.family.totals if each.name == "energy")
        known = dict[Any, Any]()
        for each in total.sums:
            edges = (0, 0) if self.family.index.periodic else (each.before, each.after)
            pairs = [(i, 0) for i in range(edges[0], self.size - edges[1])]
            if each.over == "pairs":
                pairs = [*combinations(range(self.size), 2)]
            known[each.symbol] = sum(self.place(each.term, i, j) for i, j in pairs)
        return self.place(total.formula, 0).xreplace(known)

    def find_rows(self, whole: Any, ends: Any, sums: Any = ()) -> dict[tuple[Any, int], Any]:
        """Rows of all members, by their component and number."""
        found = dict[tuple[Any, int], Any]()
        for i in range(self.size):
            others = [j for j in range(self.size) if j != i]
            known = {x.symbol: sum(self.place(x.term, i, j) for j in others) for x in sums}
            trees = ends.get(i, ends.get(i - self.size, whole))
            for c, tree in zip(self.family.states, trees, strict=True):
                found[c, i] = self.place(tree, i).xreplace(known)
        return found


def compare(name: str) -> int:
    """How many numbers of a gradient and of a bracket were found right."""
    family = find_family(name)
    own = family.action
    assert own is not None, name
    members, compared = Members(family, max(family.small, 7)), 0
    energy = members.find_energy()
    gradient = members.find_rows(own.gradient, own.gradient_ends, own.pair_sums)
    places = {s: (c, k) for (c, k), s in family.neighbours.items()} | {
        c: (c, 0) for c in family.states
    }
    slopes = dict[tuple[Any, int], Any]()
    for (c, i), tree in gradient.items():
        slopes[c, i] = members.evaluate(sympy.diff(energy, members.rows[c, i]))
        assert abs(members.evaluate(tree) - slopes[c, i]) < 1e-30, (name, c, i)
        compared += 1
    rates = members.find_rows(family.rates, family.ends, family.pair_sums)
    turned = members.find_rows(own.bracket, own.bracket_ends)
    for (c, i), tree in turned.items():
        given = {
            v: slopes[places[s][0], (i + places[s][1]) % members.size]
            for s, v in own.vector.items()
        }
        difference = members.evaluate(tree.xreplace(given)) - members.evaluate(rates[c, i])
        assert abs(difference) < 1e-30, (name, c, i)
        compared += 1
    return compared


@pytest.mark.parametrize("name", [*TEXTS, *FIELDS])
def test_the_bracket_with_the_gradient_is_the_motion(name: str) -> None:
    """Both, of every member."""
    assert compare(name) >= 28


@pytest.mark.parametrize(
    ("name", "function", "spoil"),
    [
        ("chain", "_shift", lambda old: lambda self, tree, by: old(self, tree, by + 1)),
        ("chain", "_has_term", lambda old: lambda self, own, shift, end: end != 0),
        ("closed", "_list_alone", lambda old: lambda self, row, end: ()),
        ("vortices", "_weigh", lambda old: lambda self, own: 2 * old(self, own)),
        ("clamped", "find", lambda old: lambda self, c, shift: old(self, c, -shift)),
    ],
)
def test_a_wrong_gradient_is_seen(
    monkeypatch: pytest.MonkeyPatch, name: str, function: str, spoil: Any
) -> None:
    """The comparison can fail."""
    monkeypatch.setattr(action._Terms, function, spoil(getattr(action._Terms, function)))
    with pytest.raises(AssertionError, match=name):
        compare(name)


@pytest.mark.parametrize("text", [RING, PEAKONS], ids=["quadratic", "kinks"])
def test_what_has_none(text: str) -> None:
    """A quadratic energy is that of the midpoint, and steps end at kinks."""
    assert derive_family(derive(read_spec_text(text, "none.toml"))).action is None
