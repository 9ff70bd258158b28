"""Tests of B W B, the product of matrices that the isospectral midpoint takes."""

from itertools import combinations

import numpy as np
import pytest

from coadjoint.algebra.matrices import combination, size
from coadjoint.derive import derive
from coadjoint.derive import sandwich as module
from coadjoint.derive.formulas import rows_of
from coadjoint.derive.sandwich import sandwich
from coadjoint.derive.setting import vector_names
from coadjoint.derive.times_vector import times_vector
from coadjoint.lower.evaluation import run
from tests.specs import emitted, lowered, spec

SYSTEMS = {"manakov_so4": 4, "so5_body": 5, "manakov_so6": 6, "so8_body": 8}


def to_matrix(values, n):
    """An antisymmetric matrix from its entries above the diagonal, up to the signs of its rows."""
    matrix = np.zeros((n, n))
    for value, (i, j) in zip(values, combinations(range(n), 2), strict=True):
        matrix[i, j], matrix[j, i] = value, -value
    return matrix


@pytest.mark.parametrize("system", SYSTEMS)
def test_it_is_the_product_of_matrices(system):
    """With the planes of the basis in order, in NumPy."""
    program, n = lowered(system)["sandwich"], SYSTEMS[system]
    count = len(program.state) // 2
    rng = np.random.default_rng(3)
    for _ in range(3):
        x, v = rng.normal(size=(2, count))
        known = dict(zip(program.state, (*x, *v), strict=True))
        known |= dict.fromkeys(program.parameters, 1.0)
        rows = run(program, known, float, None)
        W, B = to_matrix(x, n), to_matrix(v, n)
        expected = (B @ W @ B)[np.triu_indices(n, 1)]
        assert abs(np.array(rows) - expected).max() < 1e-12 * abs(expected).max()


@pytest.mark.parametrize(
    "system", ["rigid_body", "heavy_top", "two_field_top", "kepler", "suslov_so5"]
)
def test_other_motions_have_none(system):
    """Spheres, vectors and attitudes next to an algebra, coordinates, constraints."""
    assert rows_of(emitted(system), "sandwich") is None


def find_rows(system, x, v, **parameters):
    """The product at numbers."""
    program = lowered(system)["sandwich"]
    known = dict(zip(program.state, (*x, *v), strict=True)) | parameters
    known |= {name: 1.0 for name in program.parameters if name not in parameters}
    return np.array(run(program, known, float, None))


def to_symmetric(values, off=1.0):
    """A symmetric matrix of three rows from its entries above the diagonal, with it."""
    matrix = np.zeros((3, 3))
    matrix[np.triu_indices(3)] = values
    return np.diag(np.diag(matrix)) + off * (np.triu(matrix, 1) + np.triu(matrix, 1).T)


def test_between_symmetric_matrices_stands_n():
    """In the bracket of Bloch and Iserles ``B W B`` is ``N B X B N``."""
    x, v = np.random.default_rng(2).normal(size=(2, 6))
    N, B = to_matrix((1.5, -2.0, 0.5), 3), to_symmetric(v, 0.5)  # E12 has the entries 1/2
    expected = N @ B @ to_symmetric(x) @ B @ N
    rows = find_rows("bloch_iserles_3", x, v, N12=1.5, N13=-2.0, N23=0.5)
    assert abs(rows - expected[np.triu_indices(3)]).max() < 1e-13


def test_a_potential_turns_with_its_body():
    """``(Omega + e A) W (Omega + e A)`` with e^2 = 0, by its parts."""
    x, v = np.random.default_rng(4).normal(size=(2, 9))
    m, S = x[:3], to_symmetric(x[3:])
    Omega, A = to_matrix(v[:3], 3), to_symmetric(v[3:], 0.5)
    planes = [to_matrix(row, 3) for row in np.eye(3)]
    moved = [
        m @ (Omega @ E @ Omega)[np.triu_indices(3, 1)]
        + np.trace(S @ (A @ E @ Omega + Omega @ E @ A))
        for E in planes
    ]
    expected = [*moved, *(Omega @ S @ Omega)[np.triu_indices(3)]]
    assert abs(find_rows("quadratic_potential_so3", x, v) - expected).max() < 1e-13


MOTION = """
title = "A motion of matrices"
routes = ["lie-poisson"]
[algebra]
name = "so(4)"
[variables]
m = { role = "momentum" }
[hamiltonian]
h = "dot(m, m)/2"
"""


#: Irreducible matrices of sl(2) with four rows, which have no products in it.
FOUR_ROWS = """
[algebra.matrices]
H = [[3, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, -3]]
E = [[0, 3, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1], [0, 0, 0, 0]]
F = [[0, 0, 0, 0], [1, 0, 0, 0], [0, 2, 0, 0], [0, 0, 3, 0]]
"""


def derive_on(algebra):
    """A motion on the dual of an algebra, or a shipped one."""
    if algebra in SHIPPED:
        return emitted(algebra)
    if algebra == ANTISYMMETRIC:
        return derive(spec(algebra), "lie-poisson")
    return derive(spec(MOTION.replace("so(4)", algebra)), "lie-poisson")


#: A body with an antisymmetric matrix that turns with it.
ANTISYMMETRIC = """
title = "A body with a matrix"
routes = ["lie-poisson"]
[algebra.matrices]
E12 = [[0, 1, 0], [-1, 0, 0], [0, 0, 0]]
E13 = [[0, 0, 1], [0, 0, 0], [-1, 0, 0]]
E23 = [[0, 0, 0], [0, 0, 1], [0, -1, 0]]
[variables]
M = { role = "momentum", form = "antisymmetric" }
S = { role = "advected", representation = "adjoint", form = "antisymmetric" }
[hamiltonian]
h = "trace(transpose(M)*M)/4 + S12"
"""
#: Systems with the parameters that brackets have.
SHIPPED = {
    "bloch_iserles_2": {"N12": 1.5},
    "bloch_iserles_3": {"N12": 1.5, "N13": -2.0, "N23": 0.5},
    "quadratic_potential_so3": {},
}


class Step:
    """A step of the isospectral midpoint from its middle on, for an energy that is not quadratic.

    Args:
        algebra: Its name.
        outside: Whether products have what they have outside of the algebra.
    """

    def __init__(self, algebra, outside=True):
        equations = derive_on(algebra)
        self.state, self.outside = equations.setting.state, outside
        self.given = SHIPPED.get(algebra, {})
        self.motion, self.product = times_vector(equations), sandwich(equations)
        matrices = equations.spec.algebra.matrices
        self.E = np.zeros((len(matrices), size(matrices), size(matrices)))
        for own, each in zip(self.E, matrices, strict=True):
            for place, value in each.items():
                own[place] = float(value)
        self.gram = np.einsum("iab,jba->ij", self.E, self.E)

    def turn(self, x, v):
        """The tensor times a vector."""
        return self.evaluate(self.motion, x, v)

    def evaluate(self, equations, x, v):
        """Rates at numbers, definitions first."""
        names = (*self.state, *vector_names(len(x)))
        known = self.given | dict(zip(names, (*x, *v), strict=True))

        def find(value):
            return equations.setting.field.evaluate(value, known, float, None)

        for name, value in equations.exact.definitions:
            known[name] = find(value)
        return np.array([find(rate) for rate in equations.exact.rates])

    def to_matrix(self, x):
        """W of a momentum."""
        return np.einsum("i,iab->ab", np.linalg.solve(self.gram, x), self.E)

    def find_half(self, x):
        """Half of a step times the gradient of the energy at the middle."""
        cubic = 2 * x * np.roll(x, -1) + np.roll(x, 1) ** 2  # of the sum of x_i^2 x_(i+1)
        return 0.05 * (x / np.arange(1, len(x) + 1) + cubic)

    def find_end(self, x, sign):
        """Where a step begins, -1, or ends, 1, whose middle is x."""
        v = self.find_half(x)
        both = self.evaluate(self.product, x, v) if self.product is not None else 0.0
        if not self.outside:
            V = np.einsum("i,iab->ab", v, self.E)
            both = np.einsum("ab,iba->i", V @ self.to_matrix(x) @ V, self.E)
        return x + sign * self.turn(x, v) - both

    def find_turn(self, x):
        """How far ends are from ``W1 Q = Q W0``, Q Cayley's transform of half a step."""
        V = np.einsum("i,iab->ab", self.find_half(x), self.E)
        first, last = (self.to_matrix(self.find_end(x, sign)) for sign in (-1, 1))
        one = np.eye(len(V))
        turns = (np.linalg.solve(one - sign * V, one + sign * V) for sign in (-1, 1))
        return min(abs(last @ Q - Q @ first).max() for Q in turns)

    def find_defect(self, x):
        """How far the step is from a Poisson map, by differences."""
        moved = 1e-5 * np.eye(len(x))

        def differ(sign):
            ends = [self.find_end(x + d, sign) - self.find_end(x - d, sign) for d in moved]
            return np.array(ends).T / 2e-5

        def find_tensor(y):
            return np.array([self.turn(y, e) for e in np.eye(len(x))]).T

        D = differ(1) @ np.linalg.inv(differ(-1))
        first, last = (find_tensor(self.find_end(x, sign)) for sign in (-1, 1))
        return abs(D @ first @ D.T - last).max()


@pytest.mark.parametrize(
    "algebra", ["sp(4)", "so(3,1)", "su(3)", "harmonics(3)", "sl(3,R)", "u(2)"]
)
def test_a_step_is_a_poisson_map_by_cayleys_transform(algebra):
    """On every algebra that has the product; on su(n) and sl(n) the part outside makes it one."""
    own = Step(algebra)
    x = np.random.default_rng(5).normal(size=len(own.E))
    assert own.find_turn(x) < 1e-13
    assert own.find_defect(x) < 1e-7
    defect = Step(algebra, outside=False).find_defect(x)
    assert (defect > 1e-5) == (algebra in ("su(3)", "harmonics(3)", "sl(3,R)"))


@pytest.mark.parametrize("system", ["se(3)", "se(2)", "g(3)", ANTISYMMETRIC, *SHIPPED])
def test_a_step_is_a_poisson_map_where_traces_are_degenerate(system):
    """Or where elements are no matrices under the commutator; without the product it is none."""
    own = Step(system)
    x = np.random.default_rng(5).normal(size=len(own.state))
    assert own.find_defect(x) < 1e-7
    own.product = None
    assert own.find_defect(x) > 1e-5


def test_algebras_without_the_product_have_none():
    """Of sl(2) matrices of two and three rows have it, and these of four rows do not."""
    text = MOTION.replace('[algebra]\nname = "so(4)"', FOUR_ROWS)
    assert sandwich(derive(spec(text), "lie-poisson")) is None
    assert sandwich(derive_on("sl(2,R)")) is not None


def test_products_that_are_zero_are_left_out():
    """The step of Heisenberg's algebra is the midpoint."""
    assert sandwich(derive_on("h(1)")) is None


def test_any_basis_will_do():
    """Of so(4) one that is not orthogonal, with the constants that belong to it."""
    equations = emitted("so5_body")
    matrices = equations.spec.algebra.matrices
    assert module._find_products(equations, matrices) is not None
    mixed = (combination([(1, matrices[0]), (2, matrices[1])]), *matrices[1:])
    duals = module._find_duals(mixed, mixed)
    traces = [[module._trace(a, b) for b in duals] for a in mixed]
    assert traces == [[int(i == j) for j in range(10)] for i in range(10)]
    twice = (*matrices[:9], matrices[0])
    assert module._find_duals(twice, twice) is None


def test_a_bracket_that_is_no_commutator_is_seen():
    """One matrix has another sign than the bracket has it."""
    equations = emitted("so5_body")
    matrices = equations.spec.algebra.matrices
    first = {place: -x for place, x in matrices[0].items()}
    assert module._find_products(equations, (first, *matrices[1:])) is None
