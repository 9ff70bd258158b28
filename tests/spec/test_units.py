"""Units of formulas: products, quotients, powers, and not knowing."""

import pytest

from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.units import parse_unit, unit_of, unit_text
from tests.specs import shipped

UNITS = {"m": "kg", "v": "m/s", "I": "kg m^2", "Omega": "1/s", "x": "m", "odd": "(m)"}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("m*dot(v, v)/2", "kg m^2/s^2"),
        ("dot(Omega, diag(I)*Omega)/2 + m*dot(v, v)/2", "kg m^2/s^2"),
        ("norm(v)/norm(x)", "1/s"),
        ("sqrt(dot(x, x))", "m"),
        ("inverse(diag(I))*x", "1/kg/m"),
        ("cos(norm(x)/norm(x)) - x^0", "1"),
        ("x^-2", "1/m^2"),
        ("outer(x, v)", "m^2/s"),
        ("trace(rows(x, x, x))", "m"),
        ("rows(x, v)", ""),
        ("m + v", ""),
        ("sin(x)", ""),
        ("sqrt(x)", ""),
        ("odd", ""),
        ("unknown", ""),
    ],
)
def test_the_unit_of_a_formula(text, expected):
    """Derived where the units tell, empty where they do not."""
    units = {name: parse_unit(unit) for name, unit in UNITS.items()}
    assert unit_text(unit_of(read_expression(text), units)) == expected


@pytest.mark.parametrize("name", ["rigid_body", "heavy_top", "kirchhoff"])
def test_lagrangian_and_hamiltonian_of_shipped_specs_are_energies(name):
    """Both come out as joules: the declared units agree with the formulas."""
    spec = shipped(name)
    units = {
        part: parse_unit(quantity.unit)
        for quantity in (*spec.variables, *spec.parameters)
        for part in (quantity.name, *quantity.components)
    }
    for formula in (spec.lagrangian, spec.hamiltonian):
        assert unit_text(unit_of(formula.tree, units)) == "kg m^2/s^2"
