"""Observables: scalars, vectors and matrices are emitted by component, in their declared order."""

import json

import numpy as np
import pytest

from coadjoint.derive import derive
from coadjoint.derive.document import document
from coadjoint.errors import SpecError
from coadjoint.pipeline import render
from coadjoint.prove.declaration import kernel_context
from coadjoint.prove.record import certificate_json
from coadjoint.solve.folders import load_folder
from tests.specs import RIGID_BODY, spec

SHAPED = RIGID_BODY.replace(
    'casimirs = ["dot(Pi, Pi)"]',
    'casimirs = ["rows(Pi, Pi)*Pi"]\n'
    'conserved = ["twice", { claim = "spin", where = ["Pi1", "Pi2"] }]\n'
    "[definitions]\n"
    '"square(a)" = "dot(a, a)"\n'
    "[observables]\n"
    'S = { expression = "outer(Omega, Pi)", unit = "J", doc = "stress" }\n'
    'twice = "rows(Pi, 2*Pi)*Pi"\n'
    'spin = "Omega3"\n'
    'size = "square(Pi)"',
)


@pytest.fixture(scope="module")
def rendered():
    """The body with observables of every shape, as text."""
    return render(spec(SHAPED))


def test_components_of_observables_have_names_and_values():
    """S_ij = Omega_i Pi_j with Omega = Pi / I, written out for two of the nine."""
    found = derive(spec(SHAPED)).observables
    assert list(found)[:3] == ["energy", "casimir1_1", "casimir1_2"]
    assert [name for name in found if name[0] == "S"] == [
        f"S{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)
    ]
    assert list(found)[-4:] == ["twice1", "twice2", "spin", "size"]
    assert str(found["S12"]) == "Pi1*Pi2/I1"
    assert str(found["S21"]) == "Pi1*Pi2/I2"
    assert str(found["size"]) == "Pi1**2 + Pi2**2 + Pi3**2"


def test_kernels_declare_blocks_and_mark_what_is_conserved_everywhere(rendered):
    """A vector of integrals is marked; what is conserved on a level set alone is not."""
    context = kernel_context(rendered.equations, rendered.programs)
    blocks = {quantity.name: quantity for quantity in context.observables}
    assert blocks["S"].shape == (3, 3)
    assert blocks["S"].components[:4] == ("S11", "S12", "S13", "S21")
    assert blocks["S"].unit == "J"
    conserved = {name for name, quantity in blocks.items() if quantity.conserved}
    assert conserved == {"energy", "casimir1", "twice"}


def test_a_solution_gives_the_block_of_an_observable(rendered, tmp_path):
    """S is a matrix; its trace is twice the energy."""
    for name, text in rendered.texts.items():
        (tmp_path / name).write_text(text)
    solution = load_folder(tmp_path).simulate([1.0, 0.3, -0.8], (0, 2), samples=5, target="numpy")
    assert solution["S"].shape == (3, 3, 5)
    assert np.array_equal(solution["S"][0, 1], solution["S12"])
    trace = solution["S11"] + solution["S22"] + solution["S33"]
    np.testing.assert_allclose(trace, 2 * solution["energy"], rtol=1e-14)  # three roundings
    assert solution["twice"].shape == (2, 5)
    assert 0 <= solution.drift["twice"] < 1e-6  # that of the integrator
    assert "spin" not in solution.drift


def test_definitions_are_told_in_documents(rendered):
    """The derivation begins with them, and the certificate keeps them beside the claims."""
    sections = {each.title: each for each in document(rendered.equations).sections}
    assert sections["Definitions"].words == (("square(a)", "= dot(a, a)"),)
    assert document(derive(spec())).sections[0].title != "Definitions"
    assert '"square(a)": "dot(a, a)"' in rendered.texts["certificate.json"]
    plain = render(spec())
    assert "definitions" not in certificate_json(spec(), plain.certificate)


def test_the_certificate_keeps_the_texts_of_observables(rendered):
    """Claims name them; a system without any has no such key."""
    kept = json.loads(rendered.texts["certificate.json"])["observables"]
    assert list(kept) == list(dict.fromkeys(each.name for each in spec(SHAPED).observables))
    assert kept["S"] in SHAPED
    plain = render(spec())
    assert "observables" not in certificate_json(spec(), plain.certificate)


@pytest.mark.parametrize(
    ("change", "found"),
    [
        (("spin =", "S12 ="), "S12"),
        (("twice =", "Pi ="), "Pi"),
        (('size = "square(Pi)"', 'size1 = "Pi"\nsize = "Pi"'), "size1"),
    ],
)
def test_doubled_component_of_an_observable_is_refused(change, found):
    """The second component of one may not be another one's name."""
    with pytest.raises(SpecError) as caught:
        spec(SHAPED, change)
    assert caught.value.found == found
    assert f"{found!r} is doubled" in str(caught.value)
