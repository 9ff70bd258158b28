"""Datasets: components have coordinates, axes have units, and NetCDF keeps every bit."""

from __future__ import annotations

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError, OutputError
from coadjoint.solve.solution import Solution
from coadjoint.systems import (
    euler_2d,
    heavy_top,
    kdv,
    point_vortices,
    quadrotor,
    rigid_body,
    so4_body,
    spin_chain,
)
from tests.solve.runs import RUNS, check_same, made

xarray = pytest.importorskip("xarray", reason="the extra 'data' is not installed")


def test_components_are_chosen_by_name():
    """``ds["Pi"].sel(Pi_component="Pi1")`` is the row of that name, with its unit."""
    solution = heavy_top.simulate([1, 2, 3, 0, 0, 1], (0, 1), samples=5, target="numpy")
    found = solution.to_xarray()
    for name in ("Pi1", "Pi2", "Pi3"):
        row = found["Pi"].sel(Pi_component=name)
        np.testing.assert_array_equal(row, solution[name])
    assert found["Pi"].dims == ("Pi_component", "time")
    assert found["Pi"].units == "kg m^2/s"
    assert found["time"].units == "s"
    assert found["energy"].dims == ("time",)
    assert found["Omega"].sel(Omega_component="Omega2").shape == (5,)


def test_a_dataset_says_how_it_was_made():
    """Parameters, method, tolerances, versions and system are attributes."""
    solution = heavy_top.simulate(
        [1, 2, 3, 0, 0, 1], (0, 1), {"I": [2, 3, 4]}, samples=5, rtol=1e-9, target="numpy"
    )
    found = solution.to_xarray().attrs
    assert (found["system"], found["id"]) == ("heavy_top", heavy_top.system.id)
    assert (found["parameter_I"], found["parameter_m"]) == ([2, 3, 4], 1)
    assert (found["method"], found["rtol"], found["atol"]) == ("taylor", 1e-9, 1e-12)
    assert found["status"] == "OK"
    assert {"coadjoint_version", "numpy_version", "scipy_version"} <= found.keys()


def test_components_with_units_of_their_own_have_them_along_the_axis():
    """Units that differ stand next to the names of components."""
    system = quadrotor.system
    state = np.ones((system.STATE.size, 1))
    inputs = np.ones(system.INPUTS.size)
    found = Solution(system, np.zeros(1), state, system.pack(), "OK", "", inputs=inputs).to_xarray()
    mixed = 0
    for name, quantity in [*system.STATE.items(), *system.OBSERVABLES.items()]:
        if "," in quantity.unit:
            units = found[f"{name}_unit"]
            assert units.dims == (f"{name}_component",)
            assert ", ".join(units.values.tolist()) == quantity.unit
            mixed += 1
    assert mixed


def test_matrices_have_one_component_for_each_entry():
    """Components of a quantity with two axes lie along one, by their names."""
    solution = so4_body.simulate(np.ones(6), (0, 0.1), samples=3, target="numpy")
    found = solution.to_xarray()
    for name, quantity in so4_body.system.STATE.items():
        assert found[f"{name}_component"].values.tolist() == list(quantity.components)


def test_points_of_a_field_are_along_space():
    """``ds["Xi"].sel(s=2.5)`` is the strain there; s has the places of points, in its unit."""
    chain = spin_chain.simulate(None, (0, 0.1), {"L": 8}, samples=3)
    found = chain.to_xarray()
    assert found["Xi"].dims == ("Xi_component", "s", "time")
    np.testing.assert_array_equal(found["s"], 8 * np.arange(256) / 256)
    np.testing.assert_array_equal(found["s"], chain["s"])
    row = found["Xi"].sel(Xi_component="Xi2", s=2.5)
    np.testing.assert_array_equal(row, chain["Xi2[80]"])
    wave = kdv.simulate(None, (0, 0.01), samples=3)
    assert wave.to_xarray()["m"].dims == ("s", "time")
    assert "s" in wave
    assert wave.to_xarray()["s"].units == wave.unit("s") == "1"
    assert "s" not in made()
    plane = euler_2d.simulate(None, (0, 0.1), samples=3).to_xarray()
    assert plane["w"].dims == ("x", "y", "time")
    np.testing.assert_allclose(plane["y"], 2 * np.pi * np.arange(32) / 32, rtol=1e-5)


def test_members_of_a_system_are_along_its_index():
    """Vortices by their numbers, also where trajectories are a batch."""
    start = np.random.default_rng(3).normal(size=(point_vortices.system.STATE.size, 2))
    motion = point_vortices.simulate(start, (0, 0.1), samples=3)
    found = motion.to_xarray()
    (first, *_) = point_vortices.system.STATE
    assert found[first].dims[-3:] == ("i", "member", "time")
    numbers = found["i"].values.tolist()
    assert numbers == list(range(numbers[0], numbers[0] + 6))
    np.testing.assert_array_equal(found[first].sel(member=1), motion[first][..., 1, :])


@pytest.mark.parametrize("module", [spin_chain, point_vortices, euler_2d])
def test_fields_and_members_read_back(module, tmp_path):
    """To the last bit, also of a batch; a value that is spoiled in the file is seen."""
    system = module.system
    state = np.random.default_rng(4).normal(size=(system.STATE.size, 3, 2))
    run = Solution(system, np.array([0.0, 1.0]), state, system.pack(), "OK", "",
                   course=made((3,)).course)  # fmt: skip
    run.to_netcdf(tmp_path / "run.nc")
    again = Solution.from_netcdf(system, tmp_path / "run.nc")
    assert again.state.tobytes() == run.state.tobytes()


def test_members_are_an_axis():
    """A batch of one axis has members; parameters of each member are variables."""
    many = made((5,))
    found = many.to_xarray()
    assert found["Pi"].dims == ("Pi_component", "member", "time")
    assert found["parameter_I"].dims == ("parameter_I_component", "member")
    one = found.sel(member=3, Pi_component="Pi1")
    np.testing.assert_array_equal(one["Pi"], many.state[0, 3])
    np.testing.assert_array_equal(one["parameter_I"], many.parameters[:, 3])
    two = made((3, 2), parameters=np.ones(3)).to_xarray()
    assert two["energy"].dims == ("member_0", "member_1", "time")
    assert two.attrs["parameter_I"] == [1, 1, 1]


def test_members_have_a_status_each(tmp_path):
    """Where each member has its own status and message, these are variables."""
    status = np.array(["OK", "NONFINITE", "OK"])
    many = made((3,), status=status, message=np.array(["", "gone", ""]))
    found = many.to_xarray()
    assert found["status"].dims == ("member",)
    many.to_netcdf(tmp_path / "run.nc")
    again = Solution.from_netcdf(rigid_body.system, tmp_path / "run.nc")
    assert (list(again.status), list(again.message)) == (status.tolist(), ["", "gone", ""])


@pytest.mark.parametrize("kind", RUNS)
def test_a_file_reads_back_to_the_last_bit(kind, tmp_path):
    """As a Solution of ours, and as the dataset that was written."""
    solution, path = RUNS[kind](), tmp_path / "run.nc"
    solution.to_netcdf(path)
    check_same(Solution.from_netcdf(solution.system, path), solution)
    xarray.testing.assert_identical(xarray.load_dataset(path), solution.to_xarray())
    assert list(tmp_path.iterdir()) == [path]


def test_files_of_others_are_refused(tmp_path):
    """A file of another system, a dataset without our attributes, and what is no NetCDF."""
    path = tmp_path / "run.nc"
    made().to_netcdf(path)
    with pytest.raises(KernelArgumentError, match="is of the system rigid_body with the id"):
        Solution.from_netcdf(heavy_top.system, path)
    xarray.load_dataset(path).drop_attrs().to_netcdf(path, engine="scipy")
    with pytest.raises(KernelArgumentError, match="is not a solution: it does not say its system"):
        Solution.from_netcdf(rigid_body.system, path)
    xarray.Dataset(attrs=made().to_xarray().attrs).to_netcdf(path, engine="scipy")
    with pytest.raises(KernelArgumentError, match="cannot be read: it has no"):
        Solution.from_netcdf(rigid_body.system, path)
    path.write_text("no file of this kind")
    with pytest.raises(KernelArgumentError, match=r"run\.nc cannot be read"):
        Solution.from_netcdf(rigid_body.system, path)
    with pytest.raises(KernelArgumentError, match=r"none\.nc cannot be read"):
        Solution.from_netcdf(rigid_body.system, tmp_path / "none.nc")


def test_a_bad_path_is_refused_before_anything_is_made(tmp_path, monkeypatch):
    """The folder is missing, or the path is a folder."""
    monkeypatch.setattr(xarray, "Dataset", None)
    with pytest.raises(OutputError, match="missing is not a folder"):
        made().to_netcdf(tmp_path / "missing" / "run.nc")
    with pytest.raises(OutputError, match=r"it is a folder\. Name a file in it"):
        made().to_netcdf(tmp_path)
