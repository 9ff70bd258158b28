"""What is emitted is one list: the same names, values, units and conservation for every reader."""

import pytest

from coadjoint.derive import derive
from coadjoint.derive.records import Kept
from coadjoint.prove.declaration import kernel_context
from coadjoint.prove.integrals import is_conserved
from tests.derive.test_observables import SHAPED
from tests.specs import shipped, spec


def conserved(equations):
    """Names of what the motion conserves."""
    return [each.name for each in equations.exact.emitted if is_conserved(equations, each)]


def test_kernels_declare_what_is_computed():
    """Names, components and units of the declarations are those of the values, in order."""
    equations = derive(shipped("chaplygin_ball"))
    declared, emitted = kernel_context(equations, {}).observables, equations.exact.emitted
    assert [each.components for each in declared] == [each.components for each in emitted]
    assert [name for each in declared for name in each.components] == list(equations.observables)
    assert {each.name: each.unit for each in declared} == {e.name: e.unit for e in emitted}
    units = {each.name: each.unit for each in emitted}
    assert (units["energy"], units["Omega_momentum"]) == ("kg m^2/s^2", "kg m^2/s")
    assert all(len(each.components) == len(each.values) for each in emitted)


def test_damping_takes_the_energy_and_the_casimir_that_it_works_on():
    """The damped top keeps the length of Gamma; the free one its energy and both Casimirs."""
    assert conserved(derive(shipped("heavy_top"))) == ["energy", "casimir1", "casimir2"]
    assert conserved(derive(shipped("heavy_top_damped"))) == ["casimir1"]


@pytest.mark.parametrize(
    ("claim", "kept"),
    [
        ("spin", Kept.ALWAYS),
        ("(spin)", Kept.ALWAYS),
        ("2*spin", Kept.UNKNOWN),
        ("twice", Kept.UNKNOWN),
    ],
)
def test_a_claim_of_a_quantity_marks_it_by_its_name(claim, kept):
    """The name itself, however it is written, and no function of it; nor what a level set keeps."""
    text = SHAPED.replace('conserved = ["twice", {', f'conserved = ["{claim}", {{')
    emitted = {each.name: each for each in derive(spec(text)).exact.emitted}
    assert emitted["spin"].kept is kept
    assert emitted["size"].kept is Kept.UNKNOWN


def test_shapes_are_those_of_formulas():
    """A matrix is rows of components, and a momentum map of its form a whole matrix."""
    emitted = {each.name: each for each in derive(spec(SHAPED)).exact.emitted}
    stress = emitted["S"]
    assert stress.whole == (stress.values[:3], stress.values[3:6], stress.values[6:])
    assert emitted["spin"].whole == emitted["spin"].values[0]
