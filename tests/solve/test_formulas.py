"""Formulas of the state against the same typed by hand in NumPy."""

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.formulas import Formula

SCOPE = {"v": (3,), "w": (3,), "v1": (), "A": (3, 3), "s": (), "q": (4,), "g": (3, 4)}
SOURCE = np.random.default_rng(11)
VALUES = {
    "v": SOURCE.normal(size=(3, 7)),
    "w": SOURCE.normal(size=(3, 7)),
    "A": SOURCE.normal(size=(3, 3, 7)),
    "s": SOURCE.uniform(1, 2, size=7),
}
VALUES["v1"] = VALUES["v"][0]
#: Half a turn about the middle of the first two axes, and a quarter about the third.
TURNS = (([0, 0.5**0.5, 0.5**0.5, 0], [[0, 1, 0], [1, 0, 0], [0, 0, -1]]),
         ([0.5**0.5, 0, 0, 0.5**0.5], [[0, -1, 0], [1, 0, 0], [0, 0, 1]]))  # fmt: skip


def hat(a):
    """The matrix of the vector product."""
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


@pytest.mark.parametrize(
    ("text", "by_hand"),
    [
        ("v1 - 0.5", lambda v, w, a, s: v[0] - 0.5),
        ("dot(v, w)/s + 2*v[2]^3", lambda v, w, a, s: v @ w / s + 2 * v[1] ** 3),
        ("dot(cross(v, w), A*v)", lambda v, w, a, s: np.cross(v, w) @ (a @ v)),
        ("norm(v)*s^(-2)", lambda v, w, a, s: np.linalg.norm(v) / s**2),
        ("det(A) - trace(A*A)", lambda v, w, a, s: np.linalg.det(a) - np.trace(a @ a)),
        ("trace(inverse(A))", lambda v, w, a, s: np.trace(np.linalg.inv(a))),
        ("trace(A^(-2) + A^3 - A^0)", lambda v, w, a, s: np.trace(
            np.linalg.inv(a) @ np.linalg.inv(a) + a @ a @ a - np.eye(3))),
        ("dot(v, hat(w)*v + diag(A))", lambda v, w, a, s: v @ (hat(w) @ v + np.diag(a))),
        ("trace(diag(v)*outer(v, w))", lambda v, w, a, s: np.trace(np.diag(v) @ np.outer(v, w))),
        ("A[1, 2]*s", lambda v, w, a, s: a[0, 1] * s),
        ("cross(v, w)[3] + (A*A)[2, 1]", lambda v, w, a, s: np.cross(v, w)[2] + (a @ a)[1, 0]),
        ("dot(A[3], vector(1, s, v1))", lambda v, w, a, s: a[2] @ [1, s, v[0]]),
        ("det(rows(v, w, vector(1, 2, 3)))", lambda v, w, a, s: np.linalg.det([v, w, [1, 2, 3]])),
        ("trace(commutator(A, hat(v))*A)", lambda v, w, a, s: np.trace(
            (a @ hat(v) - hat(v) @ a) @ a)),
        ("sqrt(s) + sin(s)*cos(s) - tan(s)", lambda v, w, a, s: (
            np.sqrt(s) + np.sin(s) * np.cos(s) - np.tan(s))),
        ("exp(-s) - log(s)", lambda v, w, a, s: np.exp(-s) - np.log(s)),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)  # fmt: skip
def test_formulas_have_the_values_of_numpy(text, by_hand):
    """Each function of the language, at seven points."""
    found, _ = Formula(text, SCOPE, "event").evaluate(VALUES)
    expected = [
        by_hand(VALUES["v"][:, n], VALUES["w"][:, n], VALUES["A"][:, :, n], VALUES["s"][n])
        for n in range(7)
    ]
    assert found.shape == (7,)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(("q", "R"), TURNS)
def test_quaternions_and_poses_turn_vectors(q, R):
    """Two turns that one can see, their product, and the parts of a pose."""
    R, v, w, s = np.array(R), *(VALUES[name] for name in "vws")
    other, back = np.array(TURNS[0][0]), [q[0], *(-x for x in q[1:])]
    quaternions = {"q": np.outer(q, s), "p": np.outer(other, np.ones(7))}  # of the length s
    values = {**VALUES, **quaternions, "g": np.concatenate([VALUES["A"], w[:, np.newaxis]], axis=1)}

    def value(text):
        return Formula(text, {**SCOPE, "p": (4,)}, "event").evaluate(values)[0]

    expected = s**2 * (w * (R @ v)).sum(axis=0)
    np.testing.assert_allclose(value("dot(w, rotate(q, v))"), expected, rtol=1e-12)
    np.testing.assert_allclose(value("dot(w, rotation(q)*v)"), expected, rtol=1e-12)
    both = s**2 * (w * (R @ np.array(TURNS[0][1]) @ v)).sum(axis=0)
    np.testing.assert_allclose(value("dot(w, rotate(qmul(q, p), v))"), both, rtol=1e-12)
    np.testing.assert_allclose(value("dot(q, conjugate(q))"), s**2 * np.dot(q, back), atol=1e-12)
    posed = np.einsum("ijn,jn->n", VALUES["A"], v) + w.sum(axis=0)
    found = value("dot(vector(1, 1, 1), rotation(g)*v + translation(g))")
    np.testing.assert_allclose(found, posed, rtol=1e-12)


def test_the_size_of_a_formula_is_that_of_its_terms():
    """Where terms cancel the value is small and the size is not."""
    found, size = Formula("v1 - (v1 + s) + s", SCOPE, "event").evaluate(VALUES)
    assert np.abs(found).max() < 1e-15
    np.testing.assert_allclose(size, 2 * np.abs(VALUES["v1"]) + 2 * VALUES["s"])


@pytest.mark.parametrize(
    ("text", "offending"),
    [
        ("u1 - 0.5", "'u1' is not declared"),
        ("v11", "Did you mean 'v1'?"),
        ("v", "the value is a 3-vector; expected a scalar"),
        ("v[4]", "expected 1 to 3"),
        ("dot(v, s)", "dot is given a 3-vector and a scalar"),
        ("s +", "ends too early"),
        ("1e-3*s", "Write 0.001"),
        ("__import__('os')", "is not a name"),
        ("", "is empty"),
    ],
)
def test_what_is_no_formula_is_refused(text, offending):
    """With the label of what asked for it; nothing is executed."""
    with pytest.raises(KernelArgumentError) as caught:
        Formula(text, SCOPE, "event 'x'")
    assert offending in str(caught.value)
    assert str(caught.value).startswith("event 'x'")
