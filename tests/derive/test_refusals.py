"""Refusals of routes: what the message says to do is done, and the motion is derived."""

import pytest

from coadjoint.derive import derive
from coadjoint.errors import DerivationError
from tests.spec.test_consistency import KIRCHHOFF
from tests.specs import RIGID_BODY, shipped, spec

PAIR = shipped("manakov_so4").path.read_text(encoding="utf-8")
WRONG = ("M + lambda*diag(a)^2", "lambda*diag(a)")
BOTH = 'routes = ["euler-poincare", "lie-poisson"]'
BRACKETS = (
    'name = "so(3)"',
    'basis = ["A", "B", "C"]\nbrackets = { "[A, B]" = "C", "[B, C]" = "A", "[C, A]" = "B" }',
)
RIGHT = ('"so(3)"', '"so(3)"\ninvariance = "right"')


def add(route):
    """A further route of the rigid body and of Kirchhoff's equations."""
    return (BOTH, f'routes = ["euler-poincare", "{route}"]')


def alone(route):
    """The only route of them."""
    return (BOTH, f'routes = ["{route}"]')


#: A spec, what is asked of it, the route, and what the message says.
REFUSED = [
    (KIRCHHOFF, [add("cayley-klein")], "cayley-klein", 'Remove "cayley-klein".'),
    (RIGID_BODY, [add("kaluza-klein")], "kaluza-klein", 'Remove "kaluza-klein".'),
    (KIRCHHOFF, [add("nambu")], "nambu", ', or remove "nambu".'),
    (KIRCHHOFF, [add("manakov")], "manakov", ', or remove "manakov".'),
    (KIRCHHOFF, [alone("nambu")], "nambu", ', or write "lie-poisson" in its place.'),
    (KIRCHHOFF, [alone("manakov")], "manakov", ', or write "lie-poisson" in its place.'),
    (
        RIGID_BODY,
        [BRACKETS, alone("matrix-euler-poincare")],
        "matrix-euler-poincare",
        'Declare it by matrices, or write "lie-poisson" in its place.',
    ),
    (
        RIGID_BODY,
        [RIGHT, add("newton-euler")],
        "newton-euler",
        'Write invariance = "left", or remove "newton-euler".',
    ),
]


@pytest.mark.parametrize(("text", "changes", "route", "said"), REFUSED)
def test_a_route_that_cannot_be_followed_is_left_as_advised(text, changes, route, said):
    """Without it, or with the one that the message names, the motion is derived."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    with pytest.raises(DerivationError, match=f"the route {route} cannot be followed") as caught:
        derive(spec(text), route)
    assert said in str(caught.value)
    is_removed = "remove" in said.lower()
    done = (f', "{route}"', "") if is_removed else (f'"{route}"', '"lie-poisson"')
    assert derive(spec(text, done)).rates


@pytest.mark.parametrize(
    ("routes", "said", "done"),
    [
        ('["euler-poincare", "lax"]', 'or remove "lax" and [lax].', '["euler-poincare"]'),
        (
            '["lax"]',
            'or write "lie-poisson" in its place and remove [lax].',
            '["lie-poisson"]',
        ),
    ],
)
def test_a_table_of_a_route_goes_with_it(routes, said, done):
    """Else no route would use it."""
    (written,) = (line for line in PAIR.splitlines() if line.startswith("routes"))
    text = PAIR.replace(written, f"routes = {routes}")
    with pytest.raises(DerivationError) as caught:
        derive(spec(text, WRONG), "lax")
    assert said in str(caught.value)
    start, end = text.index("[lax]"), text.index("[claims]")
    assert derive(spec(text[:start] + text[end:], (f"routes = {routes}", f"routes = {done}"))).rates


def test_the_advised_route_may_be_declared_already():
    """Where what is left cannot be the first, the message says which one is put first."""
    asked = spec(KIRCHHOFF, (BOTH, 'routes = ["nambu", "clebsch", "lie-poisson"]'))
    with pytest.raises(DerivationError, match='put "lie-poisson" first'):
        derive(asked, "nambu")
    put = spec(KIRCHHOFF, (BOTH, 'routes = ["lie-poisson", "clebsch"]'))
    assert derive(put).rates
