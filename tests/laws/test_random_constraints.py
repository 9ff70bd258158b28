"""Random constrained motions: all lines are proved, and every function is lowered and undone.

Masses, potentials, couplings and constraints that give a velocity or are kept, over coordinates and
over so(3); many have no acceleration somewhere, or blocks that only the closed forms show.
"""

import random
from collections import Counter

import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.errors import DerivationError
from coadjoint.lower.check import check_inverse
from coadjoint.lower.lowering import lower
from coadjoint.prove import Verdict
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.projection import about_projection
from coadjoint.prove.zero import decide_zero
from tests.constrained import about_routes
from tests.specs import spec

PARAMETERS = """[parameters]
a = { positive = true, default = 2 }
b = { default = 3 }
m = { positive = true, default = 4 }
"""
FACTORS = ("1", "2", "-3", "a", "G1", "G2", "G3", "0")
BODIES = ("dot(v, v)/2", "(a*v1^2 + a*v2^2 + m*v3^2)/2", "a*dot(v, v)/2 - b*G3")


def over_algebra(source):
    """A body with one or two constraints that are kept."""
    rows = [
        " + ".join(
            f"({source.choice(['1', '2', '-3', 'a', 'G1', 'G2', 'G3', '0'])})*v{n}"
            for n in (1, 2, 3)
        )
        for _ in range(source.randint(1, 2))
    ]
    variables = 'v = { role = "velocity" }\nG = { role = "advected", representation = "vector" }\n'
    kept = [f'c{n} = "{row} == {source.choice("000b")}"' for n, row in enumerate(rows)]
    return f'[algebra]\nname = "so(3)"\n[variables]\n{variables}', source.choice(BODIES), kept


def coefficient(source, size):
    """A number, a parameter, a position or a function of it; often zero."""
    q = f"q{source.randint(1, size)}"
    return source.choice(["1", "2", "a", q, f"cos({q})", f"a*sin({q})", f"{q}^2", "0", "0", "0"])


def over_coordinates(source):
    """Particles, perhaps coupled or in a potential, with constraints of both kinds."""
    size = source.randint(2, 5)
    names = range(1, size + 1)
    energy = " + ".join(f"{source.choice('1am2')}*v{n}^2/2" for n in names)
    if source.random() < 0.4:
        i, j = source.sample(names, 2)
        energy += f" + cos(q{i})*v{i}*v{j}/4"
    if source.random() < 0.5:
        energy += f" - b*{source.choice(['q1', 'q2^2', 'cos(q1)', 'q1*q2'])}"
    count = source.randint(1, size - 1)
    order = source.sample(names, size)
    constraints = []
    for place in range(count):
        if source.random() < 0.5:
            rest = " + ".join(f"{coefficient(source, size)}*v{n}" for n in order[count:])
            constraints.append(f'c{place} = "v{order[place]} == {rest}"')
        else:
            some = source.sample(names, min(size, source.randint(1, 3)))
            left = " + ".join(f"({coefficient(source, size)})*v{n}" for n in some)
            constraints.append(f'c{place} = "{left} == 0"')
    return f"[variables]\n{variables_of(size)}", energy, constraints


def variables_of(size):
    """Coordinates and their velocities."""
    return "".join(
        f'q{n} = {{ role = "coordinate" }}\nv{n} = {{ role = "velocity", of = "q{n}" }}\n'
        for n in range(1, size + 1)
    )


def generate(seed):
    """The text of a spec, the same for the same seed."""
    source = random.Random(seed)
    family = over_algebra if source.random() < 0.35 else over_coordinates
    variables, energy, constraints = family(source)
    head = 'title = "Random"\nroutes = ["nonholonomic", "hamel"]\n'
    lines = "\n".join(constraints)
    return f'{head}{variables}{PARAMETERS}[lagrangian]\nl = "{energy}"\n[constraints]\n{lines}\n'


def check(text):
    """Every claim on both routes is proved and every Program is right; False where refused."""
    try:
        declared = spec(text)
        setting = make_setting(declared)
        first, second = (derive(declared, r, setting=setting) for r in declared.routes)
    except DerivationError:  # a constraint without a velocity, or one that follows from others
        return False
    for program in lower(first).values():
        check_inverse(first, program)
    motion = ConstrainedRates(first)
    for statement, _, examine in [*about_routes([first, second]), *about_projection(first)]:
        found = examine()
        if isinstance(found, list | tuple):
            found = decide_zero(found, motion.field)
        verdict = getattr(found, "verdict", Verdict.PROVED)  # a finding has none
        assert verdict is Verdict.PROVED, f"{statement}\n{text}"
    return True


#: Where cos(q1) = sin(q3) = 0 both rows that are left vanish for v2, and v4 is 0: no motion.
SINGULAR = f"""title = "Rows that vanish together"
routes = ["nonholonomic", "hamel"]
[variables]
{variables_of(5)}{PARAMETERS}[lagrangian]
l = "m*v1^2/2 + 2*v2^2/2 + 1*v3^2/2 + 2*v4^2/2 + 2*v5^2/2 + cos(q5)*v5*v2/4 - b*cos(q1)"
[constraints]
c0 = "(1)*v5 == 0"
c1 = "(cos(q1))*v2 + (q1)*v5 == 0"
c2 = "v5 == a*sin(q3)*v2 + cos(q4)*v4"
"""


def test_points_where_constraints_lose_rank_are_excluded():
    """The energy is conserved wherever the motion exists; a function nonzero there is refuted."""
    assert check(SINGULAR)
    motion = ConstrainedRates(derive(spec(SINGULAR), "nonholonomic"))
    spoiled = motion.energy_balance() + motion.field["v1"]
    assert decide_zero([spoiled], motion.field, motion.where).verdict is Verdict.REFUTED


def seeds():
    """The parts of every run, and those of campaigns, each of 12 seeds."""
    return [
        pytest.param(part, marks=() if part < 1 else pytest.mark.campaign) for part in range(50)
    ]


@pytest.mark.parametrize("part", seeds())
def test_random_constraints_are_derived_proved_and_lowered(part):
    """No crash and no refusal of a true claim; most random specs have a motion."""
    counts = Counter(check(generate(seed)) for seed in range(12 * part, 12 * part + 12))
    assert counts[True] >= 8, counts
