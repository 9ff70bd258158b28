"""A strand as a lattice: from Python, from the command line, and what is told where it is none."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import coadjoint
from coadjoint.cli import main
from coadjoint.errors import KernelArgumentError, SpecError
from coadjoint.resources import derivations_folder
from coadjoint.systems import spin_chain, spin_chain_lattice
from tests.bodies.lattices import CHAIN, STIFF, strand


@pytest.fixture(scope="module")
def chain(tmp_path_factory):
    """The spec of the spin chain, and one cache for all tests of this module."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("COADJOINT_CACHE", str(tmp_path_factory.mktemp("cache")))
        patch.setenv("COADJOINT_OPTIMIZE", "1")
        path = tmp_path_factory.mktemp("chain") / "chain.toml"
        path.write_text(CHAIN, encoding="utf-8")
        yield path


@pytest.fixture
def run(tmp_path, monkeypatch, chain):
    """A command in this process, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return lambda *words: CliRunner().invoke(main, [str(word) for word in words])


@pytest.fixture(scope="module")
def lattice(chain):
    """The lattice of the spin chain, of 32 bodies."""
    return coadjoint.load(chain, sizes={"s": 32}, derivatives="lattice")


def turn_about_y(angle):
    """A rotation about the second axis."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0 * c, s], [0 * c, 1 + 0 * c, 0 * c], [-s, 0 * c, c]])


def test_it_begins_with_the_profiles_of_the_strand(lattice):
    """Attitudes are turned by the integral of sin(2 pi s/L)/2 about the second axis."""
    s = np.arange(32) * 10 / 32
    angle = 10 / (4 * np.pi) * (1 - np.cos(2 * np.pi * s / 10))
    start = lattice.simulate(None, (0, 0.1), samples=2)
    np.testing.assert_allclose(start["R"][..., 0], turn_about_y(angle), atol=1e-9)
    np.testing.assert_allclose(start["Pi"][0, :, 0], np.cos(2 * np.pi * s / 10), atol=1e-13)
    assert np.abs(start["R"][..., 0] - turn_about_y(-angle)).max() > 1


def test_it_has_the_rates_of_the_shipped_lattice(lattice):
    """Which was written by hand: compiled kernels of both agree at a random state."""
    shipped = spin_chain_lattice.system.resize({"i": 32})
    state = np.random.default_rng(4).normal(size=12 * 32)
    parameters = [1, 2, 3, 3, 2, 1, 0.3]
    found, known = (each.rhs(state, parameters) for each in (lattice, shipped))
    np.testing.assert_allclose(found, known, rtol=1e-12, atol=1e-12)
    assert np.abs(found - shipped.rhs(state, [1, 2, 3, 3, 2, 1.1, 0.3])).max() > 1e-2


@pytest.mark.parametrize(("method", "drift"), [("midpoint", 1e-11), ("splitting4", 1e-8)])
def test_its_holonomy_is_one_over_a_long_run(lattice, method, drift):
    """The product of all links, after 2000 steps; turned about in time, it is not."""
    found = lattice.simulate(None, (0, 100), method=method, step=0.05, samples=3)
    assert str(found.status) == "OK"
    assert np.abs(found.drift["energy"]).max() < drift
    R = np.moveaxis(found["R"][..., -1], 2, 0)
    links = [one.T @ other for one, other in zip(R, np.roll(R, -1, axis=0), strict=True)]
    assert np.abs(np.linalg.multi_dot(links) - np.eye(3)).max() < 1e-11
    assert np.abs(np.linalg.multi_dot(links[::-1]) - np.eye(3)).max() > 1e-2
    assert np.abs(R - np.eye(3)).max() > 0.1


@pytest.mark.campaign
def test_a_chain_between_free_ends_follows_a_standing_wave(run, tmp_path):
    """Turns about the first axis, I u_tt = K u_ss with u_s = 0 at both ends: errors of order 2."""
    text = CHAIN.replace("order = 4", 'order = 4, ends = "free"').replace(
        '"energy", "P"', '"energy"'
    )
    head, _, tail = text.partition("[profiles]")
    tail = tail[tail.index("[lagrangian]") :]
    profile = '[profiles]\nPi = "vector(cos(pi*s/L)/10, 0, 0)"\n\n'
    (tmp_path / "open.toml").write_text(head + profile + tail, encoding="utf-8")
    errors = []
    base = coadjoint.load("open.toml", sizes={"s": 16}, derivatives="lattice")
    for N in (16, 32):
        system, s = base.resize({"i": N}), (np.arange(N) + 0.5) / N
        w = np.pi / 10 * 3**0.5  # I = 1, K = 3
        state = np.zeros((12, N))
        state[[0, 4, 8]] = 1
        state[9] = np.cos(np.pi * s) / 10
        options = {"method": "dop853", "samples": 2, "rtol": 1e-10}
        found = system.simulate(state.ravel(), (0, 2), {"a": 10 / N}, **options)
        errors.append(np.abs(found["Pi"][0, :, -1] - state[9] * np.cos(w * 2)).max())
    assert errors[1] < 2e-3
    assert 1.8 < np.log2(errors[0] / errors[1]) < 2.2


def test_the_command_line_writes_and_simulates_it(run, chain, lattice, tmp_path):
    """The text is that of `write_lattice`; a file that is there is not overwritten."""
    result = run("new", "bodies", "--lattice-of", chain, "--bodies", "8")
    assert result.exit_code == 0, result.output
    text = (tmp_path / "bodies.toml").read_text(encoding="utf-8")
    declared = coadjoint.read_spec(chain)
    assert text == coadjoint.write_lattice(declared, 8)
    assert coadjoint.read_spec(tmp_path / "bodies.toml").index[0].size == 8
    again = run("new", "bodies", "--lattice-of", chain)
    assert again.exit_code == 2
    assert "already exists" in again.output
    words = ("--derivatives", "lattice", "--size", "s=32", "--time", "0.2", "--json")
    result = run("simulate", chain, *words)
    assert result.exit_code == 0, result.output
    record = json.loads(result.stdout)
    assert record["system"] == "chain_lattice"
    assert run("new", "more", "--bodies", "8").exit_code == 2


def test_another_system_is_told_how_to_become_one(run, lattice):
    """A loaded strand is refused with two ways, and both are followed."""
    with pytest.raises(KernelArgumentError, match="another system") as caught:
        spin_chain.system.with_derivatives("lattice")
    assert "coadjoint.load(path, derivatives='lattice')" in str(caught.value)
    words = "coadjoint new NAME --lattice-of spin_chain"
    assert words in str(caught.value)
    result = run(*words.replace("NAME", "mine").split()[1:])
    assert result.exit_code == 0, result.output
    assert [*lattice.STATE] == ["R", "Pi"]  # which was loaded in the other way


def test_what_has_no_lattice_is_refused_by_both(run, tmp_path):
    """With the same reason, and nothing is written."""
    result = run("new", "mine", "--lattice-of", "rigid_body")
    assert result.exit_code == 2
    assert "it has no strain" in result.output
    assert not (tmp_path / "mine.toml").exists()
    with pytest.raises(SpecError, match="it has no strain"):
        coadjoint.load(derivations_folder() / "rigid_body.toml", derivatives="lattice")


def test_numbers_of_bodies_are_checked():
    """None, too few, and a strand without a number of points, whose advice is followed."""
    with pytest.raises(SpecError, match="0 bodies; expected at least 1"):
        coadjoint.write_lattice(strand(), 0)
    unsized = strand(("size = 256, ", ""))
    with pytest.raises(SpecError, match=r"no number of points.*--bodies 16"):
        coadjoint.write_lattice(unsized)
    assert "size = 16" in coadjoint.write_lattice(unsized, 16)


def test_a_long_polynomial_is_refused():
    """Of degree 6; without the terms of the highest degree it is written."""
    long = strand((STIFF, f"{STIFF} - dot(Xi, Xi)^2 - dot(Xi, Xi)^3"))
    with pytest.raises(SpecError, match=r"too many terms.*EXPRESSION_NODES.*highest degree"):
        coadjoint.write_lattice(long, 4)
    assert coadjoint.write_lattice(strand((STIFF, f"{STIFF} - dot(Xi, Xi)^2")), 4)


def test_many_bodies_begin_with_a_state_of_their_own(lattice):
    """A spec with the attitudes of 1000 is too long; the advice is followed."""
    with pytest.raises(SpecError, match=r"too long.*resize\(\{'i': 1000\}\)"):
        coadjoint.write_lattice(strand(), 1000)
    assert lattice.resize({"i": 1000}).rhs(np.ones(12000)).shape == (12000,)


def test_names_of_the_strand_are_left_alone():
    """The attitude has another name where the strand has a parameter R; three names are enough."""
    text = coadjoint.write_lattice(strand(("L = {", "R = { default = 1 }\nL = {")), 2)
    assert "\nQ = {" in text
    taken = "".join(f"{name} = {{ default = 1 }}\n" for name in ("a", "b", "d"))
    with pytest.raises(SpecError, match="one of them free for the distance"):
        coadjoint.write_lattice(strand(("L = {", taken + "L = {")), 2)


def test_a_strain_that_closes_no_ring_is_said():
    """Bodies then stand alike, and the description says why."""
    open_one = strand(('"vector(0, sin(2*pi*s/L)/2, 0)"', '"vector(0, 1/10, 0)"'))
    text = coadjoint.write_lattice(open_one, 4)
    assert "all stand alike: the holonomy of its strain is not 1 but for 0.84" in text
    assert "from a body to space" in text
    assert 'R = { role = "attitude", index = "i", doc' in text
