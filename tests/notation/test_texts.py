"""Formulas by their texts are set as formulas, and the text stays as it is."""

import re
from xml.etree import ElementTree as ET

import pytest

from coadjoint.derive.motion import motion_sections
from coadjoint.notation.texts import write_text
from tests.specs import emitted


@pytest.mark.parametrize(
    ("text", "latex"),
    [
        ("dW/dt", r"\dot{W}"),
        ("[W, V]", "[W, V]"),
        ("c[i-1]*V[i, j+1]", r"c_{i - 1}\,V_{i,j + 1}"),
        ("j - i mod N", r"j - i\;\mathrm{mod}\;N"),
        ("|k1|", r"\lvert k_1\rvert"),
        ("T[k][i, j]", "(T_k)_{i,j}"),
        ("sqrt(N^2 - 1)", r"\sqrt{{N}^{2} - 1}"),
    ],
)
def test_a_text_is_set_as_a_formula(text, latex):
    """Rates, commutators, entries of matrices, and signs that bind less than a sum."""
    made = write_text(text)
    assert (made.latex, made.text) == (latex, text)
    ET.fromstring(f"<math>{made.mathml.replace('&', '&amp;')}</math>")


@pytest.mark.parametrize("name", ["zeitlin_su_n", "zeitlin_torus"])
def test_no_formula_of_matrices_is_plain_text(name):
    """No letter of MathML holds a whole formula."""
    (motion,) = motion_sections(emitted(name))
    letters = [each for line in motion.lines for each in re.findall("<mi>(.*?)</mi>", line.mathml)]
    assert len(letters) > 20
    assert all(re.fullmatch("[^*^/\\[ ]+", each) for each in letters), letters
