"""Room for functions: as many places as a spec needs, and few more."""

import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.derive import room as rooms
from coadjoint.spec import read_spec
from tests.specs import shipped, spec

LINKS = 13
ANGLES = LINKS * (LINKS - 1) // 2 + LINKS  # differences, and the angles themselves


@pytest.fixture(scope="module")
def chain():
    """Thirteen links."""
    return read_spec(shipped("n_link_chain").path, {"i": LINKS})


def test_calls_of_equal_arguments_count_once_among_many(chain):
    """A place for each difference, each angle, and each angle minus itself."""
    assert rooms.count_calls(chain) == ANGLES + LINKS


def test_few_calls_are_all_counted(chain, monkeypatch):
    """Below the bound each call counts: the sum over all pairs stands in the energy and in L."""
    monkeypatch.setattr(rooms, "COUNTED_CALLS", 10**6)
    assert rooms.count_calls(chain) == 2 * LINKS**2 + 3 * LINKS


def test_a_chain_has_room_for_its_functions(chain):
    """All functions of the equations are adjoined, and less than half of the places stay empty."""
    setting = make_setting(chain)
    places = setting.field.room
    derive(chain, chain.routes[0], setting=setting)
    taken = places - setting.field.room
    assert taken == 2 * ANGLES
    assert taken > 0.4 * places


def test_functions_of_opposite_differences_need_one_place_alone(monkeypatch):
    """exp(a - b) and exp(b - a) are two functions, and have two places."""
    monkeypatch.setattr(rooms, "COUNTED_CALLS", 0)
    text = """
    title = "Two exponentials"
    routes = ["canonical"]
    [variables]
    q = { role = "coordinate", shape = [2] }
    p = { role = "momentum", of = "q" }
    [hamiltonian]
    h = "dot(p, p)/2 + exp(q1 - q2) + exp(q2 - q1) + exp(q1 - q2)"
    """
    assert rooms.count_calls(spec(text)) == 2
