"""Heads of solvers in C: what they say of the methods that a system has."""

import pytest

from coadjoint.methods import MAPPED, NOISY, STRUCTURED
from coadjoint.pipeline import render
from coadjoint.resources import derivations_folder
from coadjoint.solve.folders import load_texts
from coadjoint.spec.reader import read_spec_text
from tests.families import SHAKEN, SPRINGS, VORTICES
from tests.prove.test_methods import HAMILTONIAN
from tests.solve.test_noisy_orbits import CUBIC, HEAVY

KEEPING = {**STRUCTURED, **MAPPED}
TODA = (derivations_folder() / "toda_lattice.toml").read_text()


@pytest.mark.parametrize(
    ("text", "known", "some"),
    [
        (HAMILTONIAN, KEEPING, {"gauss4", "kahan", "exact_body", "average_gradient"}),
        (HEAVY, NOISY, {*NOISY}),
        (CUBIC, NOISY, {"heun", "midpoint", "coadjoint_mean"}),
        (SHAKEN, NOISY, {"heun", "midpoint"}),
        (SPRINGS, KEEPING, {"discrete_gradient"}),
        (TODA, KEEPING, {"midpoint4", "splitting4"}),
        (VORTICES, KEEPING, {"midpoint"}),
    ],
    ids=["body", "noisy top", "noisy motion", "noisy spins", "springs", "chain", "vortices"],
)
def test_a_head_names_theorem_and_reference_of_each_method(text, known, some):
    """With noise that of paths; and of no method that the certificate does not judge to apply."""
    texts = render(read_spec_text(text, "sample.toml")).texts
    head = texts["solver.c"].partition(" */")[0] + "\n"
    with load_texts(texts) as system:
        own = {each.name for each in system.METHODS}
    assert own >= some
    for name in own:
        assert f"   -D{name.upper()} makes {known[name].theorem}\n" in head
    for name in {*NOISY, *KEEPING} - own:
        assert f"-D{name.upper()} makes " not in head


def test_each_theorem_has_a_source_or_names_the_method_it_is_made_of():
    """A year in brackets, or steps of another one."""
    for each in (*KEEPING.values(), *NOISY.values()):
        assert "(19" in each.theorem or "(20" in each.theorem or " steps " in each.theorem, each
