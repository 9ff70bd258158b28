"""Any single sign: of a structure constant, a term of ad*, an entry of the bracket, minus or plus.

Every place is tried, not a sample: what is flipped is the data inside one process. Each flip must
be refused by the engine or contradict the book. `tests.mutation.test_mutants` does the same to the
text of the engine.
"""

from dataclasses import replace

import pytest

from coadjoint.algebra import LieAlgebra
from coadjoint.derive import derive, structure
from coadjoint.derive.setting import Setting
from coadjoint.errors import AlgebraError
from coadjoint.poisson.structure import antisymmetric
from tests.algebra.laws import spoiled_constants
from tests.conftest import SYSTEMS
from tests.sources import textbook
from tests.sources.test_equations import BY_ROUTE, points, values
from tests.specs import shipped, spec

ON_ALGEBRAS = [name for name in SYSTEMS if shipped(name).algebra is not None]
#: A declared Lax pair says by itself which way the motion runs.
BY_ALGEBRA_ROUTE = [pair for pair in BY_ROUTE if pair[0] in ON_ALGEBRAS and pair[1] != "lax"]
BY_EULER_POINCARE = [name for name, route in BY_ROUTE if route == "euler-poincare"]
#: Beyond six dimensions the entries are many and alike.
SMALL = [name for name in ON_ALGEBRAS if len(textbook.STATES[name]) <= 6]
#: Routes on the declared state that reckon with structure constants, not with matrices or points.
BY_CONSTANTS = ("euler-poincare", "lie-poisson")


def by_constants(declared):
    """Those routes of a spec."""
    return [route for route in declared.routes if route in BY_CONSTANTS]


def agrees(equations, name):
    """Whether derived rates are the book's at a random point."""
    ((point, x, p),) = points(name, 1)
    return values(equations.rates, point) == textbook.RATES[name](x, p)


def with_constants(name, constants):
    """A shipped system on an algebra with other structure constants."""
    declared = shipped(name)
    old = declared.algebra
    return replace(declared, algebra=replace(old, constants=constants))


@pytest.mark.parametrize("name", ON_ALGEBRAS)
def test_the_algebra_as_it_is_agrees(name):
    """What the tests below see is the flip, not the way it is made."""
    for route in by_constants(shipped(name)):
        assert agrees(derive(with_constants(name, shipped(name).algebra.constants), route), name)


@pytest.mark.parametrize("name", ON_ALGEBRAS)
def test_every_sign_of_every_structure_constant(name):
    """Jacobi fails, or the action no longer fits, or each route leaves the book."""
    algebra = shipped(name).algebra
    flips = [(pair, k, -c) for pair, row in algebra.constants.items() for k, c in row.items()]
    assert flips
    for flip in flips:
        try:
            changed = with_constants(name, spoiled_constants(algebra, *flip))
            routes = [derive(changed, route) for route in by_constants(changed)]
        except AlgebraError:
            continue
        for equations in routes:
            assert not agrees(equations, name), (flip, equations.route)


@pytest.mark.parametrize("name", BY_EULER_POINCARE)
def test_every_sign_of_every_term_of_ad_star(name, monkeypatch):
    """The Euler-Poincare equations leave the book, whichever term c_ij^k xi_i mu_k is flipped."""
    right = LieAlgebra.ad_star
    terms = list(shipped(name).algebra.structure())
    assert terms
    for i, j, k, _ in terms:

        def ad_star(self, xi, mu, term=(i, j, k)):
            found = list(right(self, xi, mu))
            for i, j, k, c in self.structure():  # in the field of the route
                if (i, j, k) == term:
                    found[j] = found[j] - 2 * c * xi[i] * mu[k]
            return tuple(found)

        monkeypatch.setattr(LieAlgebra, "ad_star", ad_star)
        assert not agrees(derive(shipped(name), "euler-poincare"), name), (i, j, k)
    monkeypatch.undo()
    assert agrees(derive(shipped(name), "euler-poincare"), name)


@pytest.mark.parametrize("name", SMALL)
def test_every_sign_of_every_entry_of_the_bracket(name, monkeypatch):
    """The Lie-Poisson equations leave the book, whichever {x_i, x_j} is flipped."""
    right = structure.lie_poisson
    whole = structure.poisson_structure(derive(shipped(name), "lie-poisson").setting)
    size = whole.dimension
    pairs = [(i, j) for i in range(size) for j in range(i) if whole.tensor[i][j]]
    assert pairs
    for pair in pairs:

        def flipped(algebra, field, names, sign, pair=pair):
            found = right(algebra, field, names, sign)
            entries = {(i, j): found.tensor[i][j] for i in range(size) for j in range(i)}
            entries[pair] = -entries[pair]
            return replace(found, tensor=antisymmetric(field, size, entries))

        monkeypatch.setattr(structure, "lie_poisson", flipped)
        assert not agrees(derive(shipped(name), "lie-poisson"), name), pair


@pytest.mark.parametrize(("name", "route"), BY_ALGEBRA_ROUTE)
def test_minus_and_plus(name, route, monkeypatch):
    """Left taken for right: nothing but the sign of time changes, and the book's rates see it."""
    monkeypatch.setattr(Setting, "sign", property(lambda setting: -1))
    assert not agrees(derive(shipped(name), route), name)


@pytest.mark.parametrize(("name", "route"), BY_ALGEBRA_ROUTE)
def test_minus_and_plus_in_a_spec(name, route):
    """A spec that says right where the book says left is seen, too."""
    text = shipped(name).path.read_text()
    assert text.count('invariance = "left"') == 1
    wrong = spec(text, ('invariance = "left"', 'invariance = "right"'))
    assert not agrees(derive(wrong, route), name)


@pytest.mark.parametrize("name", ON_ALGEBRAS)
def test_minus_and_plus_of_the_bracket(name, monkeypatch):
    """The plus bracket with everything else as it is: no system passes."""
    right = structure.lie_poisson
    monkeypatch.setattr(
        structure, "lie_poisson", lambda a, field, names, sign: right(a, field, names, -sign)
    )
    assert not agrees(derive(shipped(name), "lie-poisson"), name)
