"""Labels of pictures are formulas that matplotlib can set."""

from types import SimpleNamespace

import pytest

from coadjoint.files import read_certificate
from coadjoint.resources import systems_folder
from coadjoint.solve.labels import observable_label

parser = pytest.importorskip("matplotlib.mathtext").MathTextParser("path")


def label(casimir, name="casimir1"):
    """The label of a Casimir of a system that has it alone."""
    return observable_label(SimpleNamespace(certificate={"casimirs": [casimir]}), name)


@pytest.mark.parametrize(
    ("casimir", "expected"),
    [
        ("dot(Pi, Pi)", r"$|\Pi|^{2}$"),
        ("dot(Gamma, Pi)", r"$\Gamma \cdot \Pi$"),
        ("x1 + x2", "$x_1 + x_2$"),
        ("dot(Pi, Pi)*dot(Gamma, Gamma) - dot(Pi, Gamma)^2", r"$\mathcal{C}_1$"),  # no room
        ("total of Pi", r"$\mathcal{C}_1$"),  # words
    ],
)
def test_a_casimir_is_called_by_its_formula(casimir, expected):
    """Or by a letter, where that is long or cannot be set."""
    assert label(casimir) == expected


def test_other_observables_are_called_by_their_names():
    """Symbols with what stands below them, and words."""
    assert label("x", "casimir2") == r"$\mathcal{C}_2$"
    assert label("x", "energy") == "energy"
    assert label("x", "total_momentum") == "total momentum"
    assert label("x", "M_normal_force") == "M$_{normal force}$"
    assert label("x", "Gamma_norm") == "Γ$_{norm}$"


def test_the_casimirs_of_all_systems_can_be_set():
    """No label holds the name of the code, and matplotlib knows all of each."""
    count = 0
    for folder in sorted(systems_folder().glob("*/certificate.json")):
        casimirs = read_certificate(folder)["casimirs"]
        system = SimpleNamespace(certificate={"casimirs": casimirs})
        for n in range(1, len(casimirs) + 1):
            shown = observable_label(system, f"casimir{n}")
            assert shown.startswith("$"), shown
            parser.parse(shown)
            count += 1
    assert count > 80
