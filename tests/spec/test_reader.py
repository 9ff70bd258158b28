"""The reader: shipped specs are what the books say, and no file whatever does harm."""

import contextlib
import hashlib
import json
import os
import socket
import subprocess
import sys
from fractions import Fraction
from itertools import combinations
from pathlib import Path
from time import process_time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from coadjoint.derive.interpret import interpret
from coadjoint.errors import CoadjointError, LimitError, SpecError, plain
from coadjoint.exact import Field
from coadjoint.resources import derivations_folder
from coadjoint.spec import read_spec, read_spec_text, unpack
from tests.sources import fields, fluids, machines, rods
from tests.sources.textbook import PARAMETERS, STATES
from tests.specs import RIGID_BODY, shipped

# -- the shipped specs --------------------------------------------------------------------------


def upper(size):
    """The places above the diagonal of a matrix, row by row."""
    return [f"{i}{j}" for i, j in combinations(range(1, size + 1), 2)]


def body(size):
    """State, parameters and routes of a rigid body in some dimension."""
    state, moments = (f"M{place}" for place in upper(size)), (f"a{n + 1}" for n in range(size))
    return " ".join(state), " ".join(moments), ("lie-poisson",)


TWO, ONE = ("euler-poincare", "lie-poisson"), ("lie-poisson",)
MANAKOV = ("euler-poincare", "matrix-euler-poincare", "lie-poisson", "lax", "manakov")
ADVECTING = (*TWO, "hamilton-pontryagin", "clebsch", "poincare")
ROTATING = (*ADVECTING, "cayley-klein")
TOPS = (*TWO, "hamilton-pontryagin", "newton-euler", "kaluza-klein")
COMPLEX = ("lie-poisson", "complexification")
BOTH, TURNING = ("nonholonomic", "hamel"), "Omega1 Omega2 Omega3 Gamma1 Gamma2 Gamma3"
CONSTRAINED = (*BOTH, "nonholonomic-hamilton-pontryagin")
CANONICAL = ("canonical", "poisson")
GALILEI = "J1 J2 J3 K1 K2 K3 P1 P2 P3 E"
INERTIA = "I1 I2 I3 A1 A2 A3 B1 B2 B3 c"
SYMMETRIC_S, SYMMETRIC_P = "S11 S12 S13 S22 S23 S33", "P11 P12 P13 P22 P23 P33"
ROWS_Q = "Q11 Q12 Q13 Q21 Q22 Q23 Q31 Q32 Q33"
ROWS_P = ROWS_Q.replace("Q", "P")
ONE_POINT = "r1 r2 r3 v1 v2 v3"
INERTIAL = ("lie-poisson", "euler-poincare", "hamilton-pontryagin", "poincare")
#: Systems of other books.
BEYOND = {
    "gravity_gradient_satellite",
    "orbiting_body",
    "darwin_charges",
    *fields.STATES,
    *fluids.STATES,
    *machines.STATES,
    *rods.STATES,
}
#: Systems whose claims are of integrals alone: they have no Casimir, or those of a rotation.
CONSERVED_ALONE = (
    *("affine_line", "guiding_centre", "guiding_centre_twisted", "orbiting_body"),
    "two_field_top",
)
#: State, parameters and routes of each system.
SHIPPED = {
    **{name: (" ".join(STATES[name]), " ".join(PARAMETERS[name]), TWO) for name in STATES},
    "rigid_body": ("Pi1 Pi2 Pi3", "I1 I2 I3", (*ROTATING, "newton-euler", "nambu", "manakov")),
    "rigid_body_attitude": (
        "q0 q1 q2 q3 Pi1 Pi2 Pi3",
        "I1 I2 I3",
        ("hamilton-pontryagin", "lie-poisson", "euler-poincare", "cayley-klein"),
    ),
    "heavy_top": (
        "Pi1 Pi2 Pi3 Gamma1 Gamma2 Gamma3",
        "I1 I2 I3 m g chi1 chi2 chi3",
        (*ROTATING, "newton-euler", "kaluza-klein"),
    ),
    "underwater_vehicle": (
        " ".join(STATES["underwater_vehicle"]),
        " ".join(PARAMETERS["underwater_vehicle"]),
        ADVECTING,
    ),
    "coupled_bodies": (
        " ".join(STATES["coupled_bodies"]),
        " ".join(PARAMETERS["coupled_bodies"]),
        (*TWO, "hamilton-pontryagin", "poincare"),
    ),
    "kirchhoff": (
        "Pi1 Pi2 Pi3 P1 P2 P3",
        "I1 I2 I3 M1 M2 M3 D1 D2 D3",
        ADVECTING,
    ),
    **dict.fromkeys(
        ("heavy_top_kovalevskaya", "heavy_top_goryachev_chaplygin"),
        ("Pi1 Pi2 Pi3 Gamma1 Gamma2 Gamma3", "I3 m g chi", TOPS),
    ),
    "heavy_top_lagrange": ("Pi1 Pi2 Pi3 Gamma1 Gamma2 Gamma3", "I1 I3 m g chi", TOPS),
    "kirchhoff_clebsch": ("Pi1 Pi2 Pi3 P1 P2 P3", "I1 I2 I3 M theta", TOPS[:3]),
    "complex_rigid_body": ("x1 x2 x3 y1 y2 y3", "K1 K2 K3", COMPLEX),
    "pt_rigid_body": ("x1 x2 x3", "K1 K2 K3", COMPLEX),
    "heisenberg": ("mu1 mu2 mu3", "", (*ONE, "nambu")),
    "se2_pendulum": ("m b1 b2", "", (*ONE, "nambu")),
    "affine_line": ("mu1 mu2", "", ADVECTING),
    "sl2_r2": ("h x y p1 p2", "I1 I2 I3 m", INERTIAL),
    "so4_body": ("M1 M2 M3 N1 N2 N3", "I1 I2 I3 L1 L2 L3", TWO),
    "galilei": (GALILEI, INERTIA, INERTIAL),
    "bargmann": (f"{GALILEI} M", INERTIA, ONE),
    "nambu_body": ("x1 x2 x3", "I1 I2 I3", ("nambu", "poisson")),
    "nambu_pendulum": ("x1 x2 x3", "I1 I2 I3", ("nambu", "poisson")),
    "sp2_momentum": ("X1 X2 X3", "m k b", ("poisson",)),
    "spd_motion": ("S11 S12 S22 P11 P12 P22 q1 q2 p1 p2", "", CANONICAL),
    "spd_motion_3": (f"{SYMMETRIC_S} {SYMMETRIC_P} q1 q2 q3 p1 p2 p3", "", CANONICAL),
    "ellipsoidal_motion": (f"{ROWS_Q} {ROWS_P}", "k b", CANONICAL),
    "chaplygin_ball": (TURNING, "I1 I2 I3 m r g chi1 chi2 chi3", CONSTRAINED),
    "chaplygin_ball_centred": (TURNING, "I1 I2 I3 m r", CONSTRAINED),
    "routh_sphere": (TURNING, "I1 I3 m r g l", CONSTRAINED),
    **dict.fromkeys(("rolling_disk", "euler_disk"), (TURNING, "I1 I3 m r g", CONSTRAINED)),
    "rolling_ellipsoid": (
        TURNING,
        "I11 I12 I13 I22 I23 I33 m g axes1 axes2 axes3",
        BOTH,
    ),
    "body_of_revolution": (TURNING, "I1 I3 m g A C l", BOTH),
    "rattleback": (TURNING, "I1 I2 I3 skew m g axes1 axes2 axes3", CONSTRAINED),
    "tippe_top": (
        "Omega1 Omega2 Omega3 Y1 Y2 Y3 Gamma1 Gamma2 Gamma3",
        "I1 I3 m r g e viscous coulomb slow",
        CONSTRAINED,
    ),
    "relativistic_particle": (
        "x1 x2 x3 p1 p2 p3",
        "m c q E1 E2 E3 B1 B2 B3",
        ("euler-lagrange", "canonical"),
    ),
    "heisenberg_sub_riemannian": ("x y z px py pz", "", ("canonical",)),
    "kepler": (ONE_POINT, "mu", ("poisson", "canonical", "euler-lagrange", "newton", "alignment")),
    "monopole_kepler": (ONE_POINT, "mu lam", ("poisson", "canonical", "newton", "alignment")),
    "n_particles": (
        f"{ROWS_Q} {ROWS_P}".lower().replace("q", "r").replace("p", "v"),
        "m1 m2 m3 G",
        ("newton", "euler-lagrange", "canonical"),
    ),
    "rocking_disk": ("phi phidot", "m r l I g", ("euler-lagrange", "canonical")),
    "c3_oscillators": ("q1 q2 q3 p1 p2 p3", "w1 w2 w3 c k", CANONICAL),
    **{f"so{size}_body": body(size) for size in (5, 6, 8)},
    **{f"manakov_so{size}": (*body(size)[:2], MANAKOV) for size in (4, 6)},
    "quadratic_potential_so3": ("M12 M13 M23 S11 S12 S13 S22 S23 S33", "a1 a2 a3", MANAKOV),
    "quadratic_potential_so4": (
        "M12 M13 M14 M23 M24 M34 S11 S12 S13 S14 S22 S23 S24 S33 S34 S44",
        "a1 a2 a3 a4",
        MANAKOV,
    ),
    "suslov": ("Omega1 Omega2 Omega3", "I11 I12 I13 I22 I23 I33 a1 a2 a3", CONSTRAINED),
    "veselova": ("Omega1 Omega2 Omega3 Gamma1 Gamma2 Gamma3", "I1 I2 I3", CONSTRAINED),
    "chaplygin_sleigh": ("v omega", "m I a", CONSTRAINED),
    "rolling_disk_vertical": ("theta phi x y vtheta vphi", "m r I J", CONSTRAINED),
    "snakeboard": ("v1 v2 omega psi phi vpsi vphi", "m J J0 J1 l", CONSTRAINED),
    "knife_edge_cvt": ("xi x z vxi vx vz", "k eps kx kz g", CONSTRAINED),
    "three_wave": ("q1 q2 q3 p1 p2 p3", "", (*CANONICAL, "lax")),
    "steklov": (
        "Pi1 Pi2 Pi3 P1 P2 P3",
        "a1 a2 a3 kappa nu sigma",
        ("lie-poisson", "euler-poincare", "hamilton-pontryagin"),
    ),
    "zeitlin_su_4": (" ".join(STATES["zeitlin_su_4"]), "hbar", ("lie-poisson", *INERTIAL[1:3])),
    "cosserat_rod": ("m1 m2 m3 n1 n2 n3", "K1 K2 K3 A1 A2 A3", ADVECTING[:4]),
    "kirchhoff_rod": ("m1 m2 m3 n1 n2 n3", "K1 K2 K3", (*ADVECTING[:4], "newton-euler")),
    "hess_appelrot": (
        "Pi1 Pi2 Pi3 Gamma1 Gamma2 Gamma3",
        "I1 I3 d m g chi",
        (*ROTATING, "newton-euler", "kaluza-klein"),
    ),
    "two_field_top": (
        "R11 R12 R13 R21 R22 R23 R31 R32 R33 Pi1 Pi2 Pi3",
        "I a b",
        (*TWO, "hamilton-pontryagin", "poincare", "newton-euler"),
    ),
    "maxwell_bloch": ("x1 x2 x3", "", ("nambu", "poisson", "lax")),
    "magnetic_bottle": (
        "x1 x2 x3 v1 v2 v3",
        "m q B0 L",
        ("euler-lagrange", "canonical", "newton"),
    ),
    "guiding_centre_twisted": ("X1 X2 X3 u", "m q mu B0 k", ("poisson", "first-order")),
    "guiding_centre": ("X1 X2 X3 u", "m q mu B0 L", ("poisson", "first-order")),
    "veselova_so4": (
        "U1 U2 U3 Gamma1 Gamma2 Gamma3 Gamma4 a1 a2 a3 a4",
        "Jx1 Jx2 Jx3 Jy1 Jy2 Jy3",
        CONSTRAINED,
    ),
    "suslov_so5": ("w1 w2 w3 w4", "K1 K2 K3 K4 k1 k2 k3 k4 j", CONSTRAINED),
    "roller_racer": ("v omega phi", "m1 m2 I1 I2 d1 d2", CONSTRAINED),
    "appell_machine": ("omega z phi vphi", "M m A C a b rho g", CONSTRAINED),
    "double_spherical_pendulum": (
        " ".join(f"{name}_{n}" for name in ("gamma1", "gamma2", "v1", "v2") for n in (1, 2, 3)),
        "m1 m2 l1 l2 g",
        CONSTRAINED,
    ),
    "n_link_chain": (
        "theta_1 theta_2 theta_3 theta_4 omega_1 omega_2 omega_3 omega_4",
        "m l g",
        ("euler-lagrange",),
    ),
    "ball_on_turntable": ("omega1 omega2 omega3 x1 x2", "I m r W", CONSTRAINED),
    "ball_in_sphere": ("omega1 omega2 omega3 n1 n2 n3", "I m r a g", CONSTRAINED),
    "heavy_top_damped": (
        "Pi1 Pi2 Pi3 Gamma1 Gamma2 Gamma3",
        "I1 I2 I3 m g chi1 chi2 chi3 d1 d2 d3 tau1 tau2 tau3",
        ("euler-poincare", "lie-poisson", "hamilton-pontryagin", "newton-euler"),
    ),
    "double_bracket_body": (
        "Pi1 Pi2 Pi3",
        "I1 I2 I3 alpha",
        ("euler-poincare", "lie-poisson", "nambu", "newton-euler"),
    ),
    "metriplectic_body": (
        "Pi1 Pi2 Pi3",
        "I1 I2 I3 alpha",
        ("euler-poincare", "lie-poisson", "nambu", "newton-euler"),
    ),
    "stochastic_rigid_body": (
        "Pi1 Pi2 Pi3",
        "I1 I2 I3 sigma1 sigma2 sigma3",
        ("euler-poincare", "lie-poisson", "nambu", "newton-euler"),
    ),
    "landau_lifshitz_gilbert": ("m1 m2 m3", "gamma alpha B1 B2 B3 K", ("lie-poisson", "nambu")),
    "quadrotor": (
        " ".join(STATES["quadrotor"]),
        "J1 J2 J3 m g",
        (*TWO, "hamilton-pontryagin", "poincare", "newton-euler"),
    ),
    "spacecraft_wheels": (
        " ".join(STATES["spacecraft_wheels"]),
        "I1 I2 I3 J1 J2 J3",
        (*TWO, "hamilton-pontryagin", "poincare"),
    ),
    "gravity_gradient_satellite": (
        " ".join(STATES["gravity_gradient_satellite"]),
        "I1 I2 I3 n",
        ROTATING,
    ),
    "orbiting_body": (
        " ".join(STATES["orbiting_body"]),
        "I1 I2 I3 m mu",
        (*TWO, "hamilton-pontryagin"),
    ),
    "darwin_charges": ("x1 x2 p1 p2", "m1 m2 c k", ("euler-lagrange", "canonical")),
    "kapitza_top": (
        "Pi1 Pi2 Pi3 Gamma1 Gamma2 Gamma3",
        "I1 I2 I3 m g chi1 chi2 chi3 a w",
        (*ROTATING, "newton-euler"),
    ),
    "bloch": ("M1 M2 M3", "omega1 omega2 omega3 T1 T2 M0", ("lie-poisson", "nambu")),
    "lorenz_gyrostat": ("x y z", "sigma r b", ("nambu", "poisson")),
    "bloch_iserles_2": ("X11 X12 X22", "N12", ("lax", *TWO)),
    "bloch_iserles_3": ("X11 X12 X13 X22 X23 X33", "N12 N13 N23", ("lax", *TWO)),
}


def test_shipped_specs_have_the_state_and_parameters_of_the_books(system):
    """Order and names of components are a contract with every user."""
    spec, (state, parameters, routes) = shipped(system), SHIPPED[system]
    assert spec.name == system
    assert [c for variable in spec.state for c in variable.components] == state.split()
    assert [c for p in spec.parameters for c in p.components] == parameters.split()
    assert spec.routes == routes
    assert spec.license == "BSD-3-Clause"
    assert all(p.default is not None and p.doc and p.unit for p in spec.parameters)
    assert all(v.doc and v.unit for v in spec.variables)
    canonical = spec.poisson is None or spec.poisson.kind == "canonical"
    canonical = canonical and spec.algebra is None
    named = spec.reduction or spec.constraints
    assert spec.casimirs or canonical or named or system in CONSERVED_ALONE
    changes = spec.is_driven or spec.noise or spec.time is not None
    assert changes or spec.conserved[0].formula.text == "energy" or system == "ball_on_turntable"
    assert changes or "Holm" in spec.source or system in BEYOND


def check_casimirs(spec):
    """Every claimed Casimir of a Lie-Poisson bracket commutes with every component of the state."""
    names = [c for quantity in (*spec.state, *spec.parameters) for c in quantity.components]
    field = Field(names)
    values = {name: field[name] for name in names}
    for quantity in (*spec.state, *spec.parameters):
        parts = field.vector(field[c] for c in quantity.components)
        values[quantity.name] = parts if quantity.shape else parts[0]
        if getattr(quantity, "form", ""):
            values[quantity.name] = unpack(parts, quantity.form)
    places = [place for variable in spec.state for place in variable.block]
    components = [c for variable in spec.state for c in variable.components]
    named = dict(zip(places, components, strict=True))
    assert spec.casimirs
    for casimir in spec.casimirs:
        value = interpret(casimir.tree, values, field)
        gradient = [field.derivative(value, named[place]) for place in range(len(places))]
        mu = [field[named[place]] for place in range(len(places))]
        assert any(slope != 0 for slope in gradient)
        for rate in spec.algebra.ad_star(gradient, mu):
            assert rate == 0, casimir.text


CLAIMING = ["heisenberg", "se2_pendulum", "sl2_r2", "so4_body", "galilei", "bargmann"]


@pytest.mark.parametrize("name", [*CLAIMING, "so5_body", "so6_body", "so8_body"])
def test_claimed_casimirs_commute_with_everything(name):
    """By hand from the brackets, the quartic of the Bargmann algebra and the Pfaffian included."""
    check_casimirs(shipped(name))


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("sl2_r2", ("x*p2^2", "2*x*p2^2")),
        ("so4_body", ("dot(N, N)", "2*dot(N, N)")),
        ("bargmann", ("M*J - cross", "M*J + cross")),
        ("bargmann", ('"[K3, P3]" = 1', '"[P3, K3]" = 1')),
        ("galilei", ("cross(K, P), cross", "cross(K, J), cross")),
        ("so6_body", ("- M12*M35*M46", "+ M12*M35*M46")),
    ],
)
def test_check_of_casimirs_sees_one_wrong_sign_or_factor(name, change):
    """The check above can fail."""
    text = (derivations_folder() / f"{name}.toml").read_text(encoding="utf-8")
    assert change[0] in text
    with pytest.raises((AssertionError, CoadjointError)):
        check_casimirs(read_spec_text(text.replace(*change), Path(f"{name}.toml")))


def test_defaults_are_exact():
    """9.81 is 981/100, and every coupling is off."""
    defaults = {p.name: p.default for p in shipped("heavy_top").parameters}
    assert defaults == {"I": (1, 2, 3), "m": (1,), "g": (Fraction("9.81"),), "chi": (0, 0, 1)}
    defaults = {p.name: p.default for p in shipped("kirchhoff").parameters}
    assert defaults == {"I": (1, 2, 3), "M": (2, 3, 4), "D": (0, 0, 0)}


def test_hash_is_that_of_the_file():
    """The fingerprint of a spec is the one that sha256sum prints."""
    path = derivations_folder() / "kirchhoff.toml"
    assert read_spec(path).sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert read_spec_text(path.read_text(encoding="utf-8"), path) == read_spec(path)


def test_reader_imports_neither_sympy_nor_numpy():
    """The half of the engine that reads specs is light."""
    code = "import coadjoint.spec, sys; print({'sympy', 'numpy'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


# -- files --------------------------------------------------------------------------------------


def write(folder, text=RIGID_BODY, name="sample.toml"):
    """A spec file."""
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def refused(path, kind=SpecError):
    """The error that reading a path gives, at once."""
    start = process_time()
    with pytest.raises(kind) as caught:
        read_spec(path)
    assert process_time() - start < 2
    assert str(caught.value).startswith(plain(str(path)))
    return caught.value


def test_file_is_read_from_text_paths_and_with_dos_newlines(tmp_path):
    """Paths may be strings, and lines may end as on DOS; the hash is of the bytes."""
    path = write(tmp_path, RIGID_BODY.replace("\n", "\r\n"))
    spec = read_spec(str(path))
    assert spec.title == "Free rigid body"
    assert spec.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


def test_pipe_is_refused_without_waiting(tmp_path):
    """Opening a FIFO would wait for a writer for ever."""
    path = tmp_path / "sample.toml"
    os.mkfifo(path)
    assert "FIFO" in refused(path).found


def test_device_directory_and_socket_are_refused(tmp_path):
    """Only a regular file is a spec."""
    assert refused("/dev/zero").found == "a device"
    folder = tmp_path / "sample.toml"
    folder.mkdir()
    assert refused(folder).found == "a directory"
    path = tmp_path / "sock.toml"
    with contextlib.closing(socket.socket(socket.AF_UNIX)) as listener:
        listener.bind(str(path))
        refused(path)


def test_symbolic_link_is_refused_with_its_target(tmp_path):
    """The file that is checked is the file that is read; the message says which one to give."""
    path = tmp_path / "link.toml"
    path.symlink_to(write(tmp_path))
    error = refused(path)
    assert str(tmp_path / "sample.toml") in str(error)
    path.unlink()
    path.symlink_to(path)
    assert "symbolic link" in str(refused(path))


def test_missing_file_is_refused_with_the_nearest_name(tmp_path):
    """A misspelt file is guessed from those beside it."""
    write(tmp_path, name="heavy_top.toml")
    error = refused(tmp_path / "hevy_top.toml")
    assert "there is no such file" in str(error)
    assert "heavy_top.toml'?" in str(error)
    refused(tmp_path / "nowhere" / "sample.toml")


def test_unreadable_paths_are_refused(tmp_path):
    """What the system says is passed on."""
    assert "null byte" in str(refused("a\0b.toml"))
    refused(tmp_path / ("x" * 300))


@pytest.mark.parametrize("size", [64 * 1024 + 1, 10 * 1024 * 1024])
def test_large_file_is_refused_with_its_size(tmp_path, size):
    """A file of 10 MB is not even read."""
    error = refused(write(tmp_path, b"#" * size), LimitError)
    assert error.found == size
    assert "SPEC_BYTES" in str(error)


def test_file_at_the_limit_is_read(tmp_path):
    """64 KiB pass."""
    text = RIGID_BODY + "#" * (64 * 1024 - len(RIGID_BODY))
    assert read_spec(write(tmp_path, text)).name == "sample"


def test_empty_file_is_refused(tmp_path):
    """Nothing but blanks is no spec; the message says how to begin."""
    for text in ("", "\n \n"):
        assert "coadjoint new" in str(refused(write(tmp_path, text)))


def test_bytes_that_are_no_text_are_refused_with_their_line(tmp_path):
    """The offending byte and its line are in the message."""
    error = refused(write(tmp_path, RIGID_BODY.encode() + b"\xff"))
    assert "0xff" in str(error)
    assert f":{RIGID_BODY.count(chr(10)) + 1}:" in str(error)


@pytest.mark.parametrize("name", ["Heavy", "random", "2x", "a-b", "numpy", "class"])
def test_file_name_names_the_system(tmp_path, name):
    """The stem becomes a module, so it must be a name that is free."""
    assert refused(write(tmp_path, name=f"{name}.toml")).found == name


def test_free_text_may_be_in_any_language(tmp_path):
    """Titles and docs are for people; they reach documents alone."""
    text = RIGID_BODY.replace("Free rigid body", "Kr\u00e4ftefreier Kreisel")
    assert read_spec(write(tmp_path, text)).title == "Kr\u00e4ftefreier Kreisel"


# -- any text -----------------------------------------------------------------------------------


def read_or_refuse(text):
    """Read a text; only our own errors may come out, and soon."""
    start, error = process_time(), None
    try:
        read_spec_text(text, Path("sample.toml"))
    except CoadjointError as caught:
        error = caught
    assert process_time() - start < 2
    if error is not None:
        assert str(error).startswith("sample.toml")
        assert json.loads(json.dumps(error.as_record()))["message"] == str(error)


@given(st.text(max_size=300))
def test_random_text_is_refused_by_our_own_errors(text):
    """Whatever the text, no other exception comes out."""
    read_or_refuse(text)


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_damaged_specs_are_read_or_refused(data):
    """A shipped spec with pieces cut, moved and doubled gives our errors alone."""
    text = (derivations_folder() / "heavy_top.toml").read_text(encoding="utf-8")
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        end = data.draw(st.integers(start, min(len(text), start + 30)))
        piece = data.draw(
            st.sampled_from(
                ["", "[", "]", "{", "}", '"', "=", "\n", "nan", "1e999", "Omega", "^99"]
            )
            | st.text(max_size=5)
        )
        text = text[:start] + piece + text[end:]
    read_or_refuse(text)


@given(st.text(alphabet="OmegaPiI123 ()[],.+-*/^dotcrssinverhagt'\"", max_size=60))
def test_random_lagrangians_are_read_or_refused(formula):
    """Formulas made of the language's own letters give our errors alone."""
    quoted = formula.replace('"', '\\"')
    read_or_refuse(RIGID_BODY.replace("dot(Omega, diag(I)*Omega)/2", quoted))
