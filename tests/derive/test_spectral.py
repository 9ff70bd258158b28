"""Texts of Fourier derivatives: what is differentiated, products of products, and their values."""

from types import SimpleNamespace

import numpy as np
import pytest

from coadjoint.derive import derive
from coadjoint.derive.fields.generic import GenericPoint
from coadjoint.derive.fields.spectral import write_spectral
from coadjoint.render.targets.protocol import Call
from coadjoint.solve.spectral import SpectralKernel
from coadjoint.spec import read_spec_text
from tests.specs import emitted, shipped

#: A magnet with an exchange that depends on the magnetization.
MAGNET = (
    shipped("landau_lifshitz")
    .path.read_text(encoding="utf-8")
    .replace("dot(S_s, S_s)/2", "S3^2*dot(S_s, S_s)/2")
)


def differentiate(N, L, order):
    """The matrix of a Fourier derivative of an odd number of points."""
    waves = (2j * np.pi / L * np.fft.fftfreq(N, 1 / N)) ** order
    return np.fft.ifft(waves[:, None] * np.fft.fft(np.eye(N), axis=0), axis=0).real


def evaluate(spectral, function, fields, parameters):
    """A function by its texts, of rows of fields and parameters by name."""
    names, values = [*fields], np.array([*fields.values()])
    quantities = SimpleNamespace(components=[*parameters])
    own = SimpleNamespace(
        spectral=spectral, name="", size=values.shape[1], own_state=names, PARAMETERS=quantities
    )
    rows = values.size if function == "rhs" else 1
    block = np.empty((rows, 1))
    call = Call(values.reshape(-1, 1), np.array([*parameters.values()]), block)
    for piece in SpectralKernel(own).calls(function, call):
        piece()
    return block.reshape(values.shape) if function == "rhs" else block[0, 0]


def test_the_texts_of_korteweg_and_de_vries():
    """-(m D m + D (m m)) - c D_3 m, the product differentiated as a whole."""
    found = write_spectral(GenericPoint(emitted("kdv")))
    assert found.products == {"product1": "m**2"}
    assert found.derivatives["product1_s"] == ("product1", 1)
    assert found.derivatives["m_sss"] == ("m", 3)
    assert found.rates == {"m": "-c*m_sss - m*m_s - product1_s"}
    assert found.densities["J"] == "c*m*m_ss/2 + m**3/2"
    assert (found.length, found.solved) == ("L", {})
    assert found.slopes == {
        "product1": {"m": "2*m"},
        "m": {"m_s": "-m", "product1_s": "-1", "m_sss": "-c"},
    }


def test_the_velocity_of_camassa_and_holm_is_solved_for():
    """By the operator 1 - alpha^2 d^2, and that of Hunter and Saxton without the first term."""
    for name, factors in (("camassa_holm", {0: "1", 2: "-alpha^2"}), ("hunter_saxton", {2: "-1"})):
        assert write_spectral(GenericPoint(emitted(name))).solved == {"u": ("m", factors)}


@pytest.mark.parametrize("spoiled", [False, True])
def test_products_of_derivatives_are_differentiated_again(spoiled):
    """S x dh/dS with dh/dS = S3 |S_s|^2 e3 - D(S3^2 S_s), by matrices of NumPy."""
    N, L = 21, 5.0
    found = write_spectral(GenericPoint(derive(read_spec_text(MAGNET, "magnet.toml"))))
    assert len(found.products) == 3
    S = np.random.default_rng(0).normal(size=(3, N))
    D = differentiate(N, L, 1)
    slopes = S @ D.T
    gradient = -(S[2] ** 2 * slopes) @ D.T
    gradient[2] += (-1) ** spoiled * S[2] * np.sum(slopes**2, axis=0)
    names = dict(zip(("a1", "a2", "a3", "B1", "B2", "B3", "L"), [0.0] * 6 + [L], strict=True))
    rates = evaluate(found, "rhs", dict(zip(("S1", "S2", "S3"), S, strict=True)), names)
    expected = np.cross(S.T, gradient.T).T
    assert np.allclose(rates, expected, rtol=1e-11, atol=1e-11) != spoiled
    energy = evaluate(found, "energy", dict(zip(("S1", "S2", "S3"), S, strict=True)), names)
    np.testing.assert_allclose(energy, L / N * np.sum(S[2] ** 2 * np.sum(slopes**2, axis=0)) / 2)


def test_factors_of_fields_that_are_constant_stay_outside():
    """Of a strand nothing is a product: derivatives are those of fields alone."""
    found = write_spectral(GenericPoint(emitted("spin_chain")))
    assert not found.products
    assert {order for _, order in found.derivatives.values()} == {1}
    assert "K1*Xi1_s" in found.rates["Pi1"]
