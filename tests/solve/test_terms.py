"""Terms: formulas as programs, and solvers in C that leave out steps by them."""

from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
import pytest

from coadjoint.solve.choices import Choice
from coadjoint.solve.ensemble import Ensemble, Inputs
from coadjoint.solve.events import Event, read_events
from coadjoint.solve.solvers import load
from coadjoint.solve.step_records import Record
from coadjoint.solve.surroundings import Points, Surroundings
from coadjoint.solve.terms import SOUGHT_MOST, TERMS_MOST, Kind, write_terms
from tests.kernels import COMPILER
from tests.solve.runs import find_states
from tests.solve.systems import OSCILLATOR, build

#: Formulas of an oscillator x = sin(w t)/w with w^2 = g, whose observables are v^2/2 and x^2.
FORMULAS = {
    "x": lambda x, v, g, t: x,
    "x*v - 0.2": lambda x, v, g, t: x * v - 0.2,
    "sqrt(x^2 + 2) - v/(v + 4) == 1.5": lambda x, v, g, t: np.sqrt(x**2 + 2) - v / (v + 4) - 1.5,
    "square*g - (3 - x)*0.1": lambda x, v, g, t: x**2 * g - (3 - x) * 0.1,
    "2 - x - t/5 - 1/(v - 5)": lambda x, v, g, t: 2 - x - t / 5 - 1 / (v - 5),
    "energy - 3*square - v^3 + 1": lambda x, v, g, t: v**2 / 2 - 3 * x**2 - v**3 + 1,
}
MEMBERS = 13
G = np.linspace(0.5, 4.0, MEMBERS)
CHOICES = [
    Choice(name="taylor", order=9),
    Choice(name="dop853", order=8),
    Choice(name="rk4", order=4),
]


@cache
def system():
    """The oscillator."""
    return build(OSCILLATOR, Path(mkdtemp()))


def write(event, parameters=G[np.newaxis]):
    """The program of an event."""
    sought = read_events(system(), event)
    return write_terms(sought, Surroundings(system(), parameters, None)), sought


def follow(terms, x, v, g, t):
    """What a program computes: the value and the size of what is sought."""
    found = []
    given = {Kind.COMPONENT: (x, v), Kind.PARAMETER: (g,)}
    for term in terms:
        kind, value = Kind(term["kind"]), term["value"]
        a, b = (found[term[side]] if found else 0 for side in ("left", "right"))
        found.append(
            {
                Kind.CONSTANT: lambda value=value: value,
                Kind.COMPONENT: lambda term=term: given[Kind.COMPONENT][term["row"]],
                Kind.PARAMETER: lambda term=term: given[Kind.PARAMETER][term["row"]],
                Kind.TIME: lambda: t,
                Kind.ADD: lambda a=a, b=b: a + b,
                Kind.SUBTRACT: lambda a=a, b=b: a - b,
                Kind.MULTIPLY: lambda a=a, b=b: a * b,
                Kind.INVERT: lambda a=a: 1 / a,
                Kind.SHIFT: lambda a=a, value=value: a + value,
                Kind.SCALE: lambda a=a, value=value: a * value,
                Kind.ROOT: lambda a=a: np.sqrt(a),
                Kind.SIZE: lambda a=a: np.abs(a),
                Kind.SOUGHT: lambda a=a, b=b: (a, b),
            }[kind]()
        )
    return found[-1]


@pytest.mark.parametrize("formula", FORMULAS)
def test_a_program_is_its_formula(formula):
    """Its value is that of the formula typed in NumPy, its size that of the terms."""
    terms, (sought,) = write(formula)
    x, v, t = np.random.default_rng(2).uniform(-1, 1, (3, MEMBERS))
    value, size = follow(terms, x, v, G, t)
    np.testing.assert_allclose(value, FORMULAS[formula](x, v, G, t), atol=1e-15, rtol=1e-13)
    around = Surroundings(system(), G[np.newaxis], None)
    points = Points(np.array([x, v]), t, np.arange(MEMBERS), 0 * t)
    names = around.find_values(sought.formula.names, points)
    np.testing.assert_allclose(size, sought.formula.evaluate(names)[1], rtol=1e-13)
    shared, _ = write(formula, np.array([2.0]))
    np.testing.assert_allclose(
        follow(shared, x, v, None, t)[0], FORMULAS[formula](x, v, 2.0, t), atol=1e-15, rtol=1e-13
    )


def test_what_has_no_program_is_recorded_as_a_whole():
    """Functions that are no terms, too many formulas, and long ones."""
    assert write("sin(x)")[0] is None
    assert write([f"x == {n}" for n in range(SOUGHT_MOST)])[0] is not None
    assert write([f"x == {n}" for n in range(SOUGHT_MOST + 1)])[0] is None
    assert write("+".join(f"x*{n}" for n in range(1, 15)))[0].size < TERMS_MOST
    assert write("+".join(f"x*{n}" for n in range(1, 40)))[0] is None


def record(choice, terms):
    """All steps to t = 12, or those that a program asks for, by member and time."""
    run = Ensemble(
        state=np.array([np.linspace(-0.3, 0.3, MEMBERS), np.linspace(0.5, 1.5, MEMBERS)]),
        parameters=G[np.newaxis].copy(),
        inputs=Inputs(np.array([0.0]), np.zeros((0, 1)), np.zeros((0, 1))),
        has_time=False,
        samples=np.array([12.0]),
        out=None,
        rtol=1e-9,
        atol=1e-9,
        size=0.02 if choice.name == "rk4" else 0.0,
        max_steps=10**6,
    )
    run.begin(0.0)
    kept = Record.make(2, choice.degree, 10**5, terms)
    while load(system(), choice, "c").advance(run, 0, MEMBERS, 500, kept):
        pass
    rows = kept.rows[: kept.count]
    return Record(rows[np.lexsort((rows[:, 3], rows[:, 0]))], choice.degree, kept.count)


def count_lost(whole, few, formula):
    """Steps that were left out and have a root, or another sign than the step before."""
    parts = np.linspace(0, 1, 33)
    steps = np.arange(whole.count)
    after = whole.length[:, np.newaxis] * parts
    x, v = find_states(whole, np.repeat(steps, 33), after.ravel()).reshape(2, -1, 33)
    g, t = G[whole.member][:, np.newaxis], whole.begun[:, np.newaxis] + after
    sign = np.sign(FORMULAS[formula](x, v, g, t))
    kept = {(m, b) for m, b in few.rows[: few.count, [0, 3]].tolist()}
    left_out = np.array([(m, b) not in kept for m, b in whole.rows[:, [0, 3]].tolist()])
    rooted = np.ptp(sign, axis=1) > 0
    fresh = np.append(True, np.diff(whole.member) != 0)
    turned = np.append(True, sign[1:, 0] != sign[:-1, -1])
    return int((left_out & (rooted | fresh | turned)).sum()), int(left_out.sum())


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
@pytest.mark.parametrize("choice", CHOICES, ids=str)
@pytest.mark.parametrize("formula", FORMULAS)
def test_steps_that_are_left_out_have_no_event(choice, formula):
    """And they are many; the steps that are recorded are those of a full record, to the bit."""
    whole = record(choice, None)
    terms, _ = write(formula)
    few = record(choice, terms)
    lost, left_out = count_lost(whole, few, formula)
    assert lost == 0
    assert left_out > 0.35 * whole.count
    everything = {row.tobytes() for row in whole.rows[: whole.count]}
    assert {row.tobytes() for row in few.rows[: few.count]} <= everything


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
def test_another_program_loses_events():
    """Spoiled: x*v - 0.2 is sought by the program of another level."""
    whole, (terms, _) = record(CHOICES[0], None), write("x*v - 0.25")
    assert count_lost(whole, record(CHOICES[0], terms), "x*v - 0.2")[0] > 0


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
@pytest.mark.parametrize("options", [{}, {"method": "dop853"}, {"step": 0.1}], ids=str)
def test_events_are_those_of_all_steps(options):
    """Of several formulas, some of which end members: as NumPy finds them in all steps."""
    asked = [*FORMULAS][:3]
    asked.append(Event("square == 0.3", terminal=3, name="end"))
    state = np.array([np.linspace(-0.3, 0.3, MEMBERS), np.linspace(0.5, 1.5, MEMBERS)])
    run = {"state": state, "t": (0, 12), "parameters": {"g": G}, "samples": 5, "events": asked}
    c, other = (system().simulate(target=target, **run, **options) for target in ("c", "numpy"))
    assert (c.status == "EVENT").any()
    assert c.time_reached.tobytes() == other.time_reached.tobytes()
    assert c.state.tobytes() == other.state.tobytes()
    assert (c.steps == other.steps).all()
    for name, each in c.events.items():
        for part in ("time", "member", "direction", "state"):
            assert getattr(each, part).tobytes() == getattr(other.events[name], part).tobytes()
