"""Equations without an energy or a bracket, as forces with friction give."""

import dataclasses

import pytest

from coadjoint.derive import derive
from coadjoint.errors import KernelArgumentError
from coadjoint.lower.check import check_inverse
from coadjoint.lower.lowering import lower
from coadjoint.prove.declaration import kernel_context
from coadjoint.render.kernels import render_system
from coadjoint.solve.folders import load_folder
from tests.specs import prove_claims, spec


@pytest.fixture
def bare():
    """A rigid body of which only the rates are known, and its velocities."""
    equations = derive(spec())
    kept = tuple(each for each in equations.exact.emitted if each.name == "Omega")
    declared = dataclasses.replace(equations.spec, casimirs=(), lagrangian=None, conserved=())
    setting = dataclasses.replace(equations.setting, spec=declared)
    exact = dataclasses.replace(equations.exact, energy=None, poisson_tensor=None, emitted=kept)
    return dataclasses.replace(equations, setting=setting, exact=exact)


def test_kernels_have_no_such_functions(bare, tmp_path):
    """No energy and no tensor anywhere; asking for one is an error that names the rest."""
    programs = lower(bare)
    assert list(programs) == ["rhs", "jacobian", "parameter_jacobian", "observables"]
    for program in programs.values():
        check_inverse(bare, program)
    folder = tmp_path / "bare"
    folder.mkdir()
    for name, text in render_system(kernel_context(bare, programs)).items():
        (folder / name).write_text(text)
    system = load_folder(folder)
    assert system.OBSERVABLES.components == ("Omega1", "Omega2", "Omega3")
    with pytest.raises(KernelArgumentError, match="no function 'energy'; expected one of rhs"):
        system.energy([1.0, 2.0, 3.0])
    found = system.simulate([1.0, 2.0, 3.0], (0, 1), samples=3, target="numpy")
    assert found.drift == {}


def test_proofs_cope(bare):
    """What is claimed of an energy or a bracket is not claimed."""
    statements = [claim.statement for claim in prove_claims(bare.spec, [bare]).claims]
    assert not any("energy" in s or "Poisson" in s or "{x, h}" in s for s in statements)
