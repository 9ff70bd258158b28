"""Rungs 4 and 5: good kernels pass, each kind of spoiled kernel is caught by its rung."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.crosscheck import bits, compare, ladder
from coadjoint.crosscheck.bits import equal_bits, find_differing_bits
from coadjoint.crosscheck.compare import ExactPoints, against_oracle, exact_points
from coadjoint.crosscheck.ladder import crosscheck
from coadjoint.crosscheck.subject import Subject, list_stopping
from coadjoint.derive.reference import Reference
from coadjoint.errors import CompilerError, CrossCheckError
from coadjoint.render.kernels import render_system
from coadjoint.render.targets import BUILDS
from coadjoint.solve.folders import load_texts
from coadjoint.spec.reader import read_spec_text
from tests.kernels import COMPILER, EXACT, FUSED, ProgramReference, TextSystem
from tests.programs import HEAVY_TOP, PENDULUM, program

TARGETS = tuple(BUILDS)
#: The targets that are compared with NumPy.
EXACT_TARGETS = {"c", "python"}
pytestmark = pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")


class TopReference:
    """The heavy top as in the book, dPi/dt = Pi x Omega + m g Gamma x chi, by vectors."""

    def evaluate(self, function, inputs, number, call):
        """All outputs of one function."""

        def vector(name):
            return [inputs[f"{name}{i}"] for i in (1, 2, 3)]

        def cross(a, b):
            return [
                a[1] * b[2] + -(a[2] * b[1]),
                a[2] * b[0] + -(a[0] * b[2]),
                a[0] * b[1] + -(a[1] * b[0]),
            ]

        def dot(a, b):
            return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]

        Pi, Gamma, chi = map(vector, ("Pi", "Gamma", "chi"))
        Omega = [p / i for p, i in zip(Pi, vector("I"), strict=True)]
        weight = inputs["m"] * inputs["g"]
        energy = dot(Pi, Omega) / number(2) + weight * dot(Gamma, chi)
        torque = [weight * each for each in cross(Gamma, chi)]
        zero = number(0)
        hats = [[[zero, -z, y], [z, zero, -x], [-y, x, zero]] for x, y, z in (Pi, Gamma)]
        tensor = [a + b for a, b in zip(*hats, strict=True)]
        tensor += [row + [zero] * 3 for row in hats[1]]
        return {
            "rhs": [p + t for p, t in zip(cross(Pi, Omega), torque, strict=True)]
            + cross(Gamma, Omega),
            "energy": [energy],
            "observables": [energy, dot(Pi, Gamma), *Omega],
            "poisson_tensor": [entry for row in tensor for entry in row],
        }[function]


def compared(subject, function, count):
    """One function of a subject against the equations."""
    return against_oracle(subject, exact_points(subject, function, count))


def programs_of(context):
    """Its Programs by name."""
    return {each.name: each for each in context.programs}


def subject(folder, context=HEAVY_TOP, spoil=lambda texts: texts, c_flags=EXACT, reference=None):
    """A system in every form, its texts spoiled before they are brought to life."""
    texts = spoil(dict(render_system(context)))
    system = TextSystem(context, texts, folder, c_flags)
    return Subject(programs_of(context), reference or TopReference(), system, TARGETS)


def replaced(file, good, bad):
    """A spoiler that replaces text everywhere in one file."""

    def spoil(texts):
        assert good in texts[file]
        return {**texts, file: texts[file].replace(good, bad)}

    return spoil


def test_the_textbook_top_passes_every_rung(tmp_path):
    """All functions of all targets keep k <= 4 against the book, and the bits are equal."""
    texts = render_system(HEAVY_TOP)
    system = TextSystem(HEAVY_TOP, texts, tmp_path)
    report = crosscheck(programs_of(HEAVY_TOP), texts, TopReference(), system, TARGETS, 400, 20_000)
    assert report.passed
    assert report.targets == TARGETS
    assert report.threshold == 6  # as many operations follow one another in the observables
    assert 0.5 < report.k <= 4
    assert set(report.figures) == set(report.equal) == set(programs_of(HEAVY_TOP))
    for targets in report.figures.values():
        assert all(figures.points == 6 * 17 for figures in targets.values())
    assert report.points == 6 * 17 * len(TARGETS) * len(report.figures)
    assert report.together == {name: {} for name in report.figures}  # bits say more
    assert all(lines >= 3 for lines in report.lines.values())
    for equal in report.equal.values():
        assert set(equal) == EXACT_TARGETS
        assert equal["c"] >= 20_000
        assert equal["python"] >= 500
    record = json.loads(json.dumps(report.as_record()))
    assert record["rungs"] == {"3": "passed", "4": "passed", "5": "passed"}
    assert record["figures"]["rhs"]["c"]["k"] == report.figures["rhs"]["c"].k


def test_figures_are_the_same_in_every_run(tmp_path):
    """Two runs of the oracle give the same figures to the last bit."""
    subjects = [subject(tmp_path) for _ in range(2)]
    first, second = (compared(each, "rhs", 100) for each in subjects)
    assert first == second


def test_functions_beyond_sqrt_have_a_wider_threshold(tmp_path):
    """With sin, cos and exp the threshold is 16, and no bits are promised of what calls them."""
    context = PENDULUM
    texts = render_system(context)
    system = TextSystem(context, texts, tmp_path)
    reference = ProgramReference(context.programs)
    report = crosscheck(programs_of(context), texts, reference, system, TARGETS, 300, 1000)
    assert report.passed
    assert report.threshold == 16
    for function in ("rhs", "energy"):
        assert report.equal[function] == dict.fromkeys(EXACT_TARGETS, 0)
        assert set(report.together[function]) == EXACT_TARGETS
        assert min(report.together[function].values()) >= 90


def test_functions_without_sin_stay_bitwise_when_others_call_it(tmp_path):
    """One observable with a sine takes the promise from itself, and from no other function."""
    plain = program("rhs", "q p", "k", "", "p; -k*q", (2,))
    wavy = program("observables", "q p", "k", "", "sin(q)", (1,))
    context = replace(PENDULUM, programs=(plain, wavy))
    texts = render_system(context)
    system = TextSystem(context, texts, tmp_path)
    reference, programs = ProgramReference([plain, wavy]), programs_of(context)
    report = crosscheck(programs, texts, reference, system, TARGETS, 100, 1000)
    assert report.equal["rhs"]["c"] >= 1000
    assert report.equal["observables"] == dict.fromkeys(EXACT_TARGETS, 0)
    assert report.together["rhs"] == {}
    assert report.together["observables"]["c"] >= 50


GOOD = "Omega3 * Pi2 - Omega2 * Pi3"
SPOILED = [
    ("Omega3 * Pi2 + Omega2 * Pi3", "a sign"),
    ("Omega3 * Pi2 - Omega1 * Pi3", "an index"),
    ("Omega3 * Pi2 - 1.0000001 * Omega2 * Pi3", "a constant"),
]


@pytest.mark.parametrize(
    ("file", "target"),
    [("kernel.py", "numpy"), ("kernel.c", "c"), ("kernel_python.py", "python")],
)
@pytest.mark.parametrize(("bad", "fault"), SPOILED, ids=[fault for _, fault in SPOILED])
def test_rung_4_detects_wrong_formulas(file, target, bad, fault, tmp_path):
    """A wrong sign, index or constant in one language alone is far above any threshold."""
    spoiled = subject(tmp_path, spoil=replaced(file, GOOD, bad))
    with pytest.raises(CrossCheckError) as caught:
        compared(spoiled, "rhs", 100)
    error = caught.value
    assert (error.rung, error.system, error.function) == (4, "heavy_top", "rhs")
    assert error.output == "dPi1/dt"
    assert target in error.parts
    assert error.k > 1e7
    assert error.threshold == 6
    for part in (error.parts[target], error.exact, error.point["Pi3"]):
        assert str(part) in str(error)


def test_rung_4_detects_single_precision(tmp_path):
    """One float inside a C kernel is caught."""
    bad = "const float Omega1 = (float)(Pi1 / I1)"
    spoiled = subject(tmp_path, spoil=replaced("kernel.c", "const double Omega1 = Pi1 / I1", bad))
    with pytest.raises(CrossCheckError) as caught:
        compared(spoiled, "observables", 100)
    assert caught.value.k > 1e6


def test_rung_4_detects_exchanged_rows(tmp_path):
    """Two rows exchanged in all languages, so that these agree, are caught."""
    rows = ("Omega1 * Gamma3 - Omega3 * Gamma1", "Omega2 * Gamma1 - Omega1 * Gamma2")

    def exchange(texts):
        spoiled = dict(texts)
        for file in ("kernel.py", "kernel.c", "kernel_python.py"):
            text = texts[file].replace(rows[0], "@").replace(rows[1], rows[0]).replace("@", rows[1])
            assert text != texts[file]
            spoiled[file] = text
        return spoiled

    spoiled = subject(tmp_path, spoil=exchange)
    equal_bits(spoiled, 1000)
    with pytest.raises(CrossCheckError, match=r"dGamma[23]/dt"):
        compared(spoiled, "rhs", 100)


def test_rung_4_detects_wrong_equations(tmp_path):
    """Programs, texts and kernels that agree with each other, but not with the book, are caught."""

    class Other(TopReference):
        def evaluate(self, function, inputs, number, call):
            return super().evaluate(function, {**inputs, "g": -inputs["g"]}, number, call)

    spoiled = subject(tmp_path, reference=Other())
    equal_bits(spoiled, 1000)
    with pytest.raises(CrossCheckError, match="rung 4"):
        compared(spoiled, "energy", 100)


@pytest.mark.parametrize(
    ("good", "bad"),
    [
        (GOOD + " + (_p4 * Gamma2 - _p3 * Gamma3)", GOOD + " + _p4 * Gamma2 - _p3 * Gamma3"),
        ("Pi1 / I1", "1.0 / I1 * Pi1"),
        ("= -Gamma3", "= 0.0 - Gamma3"),
        (" / 2.0", " / 2.0000000000000004"),
    ],
    ids=["order of a sum", "reciprocal", "sign of a zero", "last bit of a constant"],
)
def test_rung_5_compares_plain_python_bit_by_bit(good, bad, tmp_path):
    """What passes rung 4 in Python alone is seen beside NumPy, at fewer points than C has."""
    spoiled = subject(tmp_path, spoil=replaced("kernel_python.py", good, bad))
    for function in spoiled.programs:
        compared(spoiled, function, 50)
    with pytest.raises(CrossCheckError, match="rung 5") as caught:
        equal_bits(spoiled, 20_000)
    assert caught.value.python != caught.value.numpy or caught.value.python == 0


@pytest.mark.parametrize(
    ("value", "expected"),
    [("q/p", False), ("1/(1/p)", False), ("sqrt(q)", False), ("q*p", True), ("sqrt(q*q)", True)],
)
def test_python_is_nan_exactly_where_it_has_no_value(value, expected, tmp_path):
    """A quotient by zero and the root of a negative number stop it; NaN elsewhere is a fault.

    NumPy gives 0 for 1/(1/0), which Python cannot pass through.
    """
    each = program("rhs", "q p", "k", "", f"{value}; p", (2,))
    context = replace(PENDULUM, programs=(each,))
    good = subject(tmp_path, context, reference=ProgramReference([each]))
    batch = good.points.draw_special(1, 400)
    goes_on = bits._has_numbers(good, "rhs", batch)
    found = good.evaluate("rhs", batch, "python")
    assert np.isnan(found[:, ~goes_on]).all()
    assert goes_on.all() == expected
    assert goes_on.any()
    assert equal_bits(good, 1000)["rhs"]["python"] > 100
    lazy = dict.fromkeys(good.programs, lambda *_: np.nan)
    good.system.plain = lazy
    with pytest.raises(CrossCheckError, match=r"rung 5.*python nan"):
        equal_bits(good, 1000)


@pytest.mark.parametrize(
    ("good", "bad"),
    [
        (GOOD + " + (_p4 * Gamma2 - _p3 * Gamma3)", GOOD + " + _p4 * Gamma2 - _p3 * Gamma3"),
        ("Pi1 / I1", "1.0 / I1 * Pi1"),
        ("= -Gamma3", "= 0.0 - Gamma3"),
    ],
    ids=["order of a sum", "reciprocal", "sign of a zero"],
)
def test_rung_5_detects_different_rounding(good, bad, tmp_path):
    """Other orders, reciprocals and the sign of a zero pass rung 4, but not rung 5."""
    spoiled = subject(tmp_path, spoil=replaced("kernel.c", good, bad))
    for function in spoiled.programs:
        compared(spoiled, function, 50)
    with pytest.raises(CrossCheckError, match="rung 5") as caught:
        equal_bits(spoiled, 20_000)
    error = caught.value
    assert repr(error.numpy) in str(error)
    assert repr(error.c) in str(error)
    assert error.output in str(error)


def test_rung_5_detects_the_last_bit_of_a_constant(tmp_path):
    """The double next to 2 in place of 2 is caught by the bits."""
    spoiled = subject(tmp_path, spoil=replaced("kernel.c", " / 2.0", " / 2.0000000000000004"))
    with pytest.raises(CrossCheckError, match="rung 5"):
        equal_bits(spoiled, 1000)


def test_rung_5_detects_fused_multiply_add(tmp_path):
    """Fused multiply-add keeps k, so that only the bits tell."""
    spoiled = subject(tmp_path, c_flags=FUSED)
    compared(spoiled, "rhs", 50)
    if "fma" not in _processor_features():
        pytest.skip("this processor has no fused multiply-add")
    with pytest.raises(CrossCheckError, match="rung 5"):
        equal_bits(spoiled, 20_000)


def _processor_features():
    """What the processor can do, where the system tells."""
    try:
        return set(Path("/proc/cpuinfo").read_text().split())
    except OSError:
        return set()


def test_rung_5_detects_fast_math(tmp_path):
    """A kernel that loses NaN or subnormals is caught, though no ordinary point shows it."""
    bad = "_p1 = m * g * (m * g == m * g)"
    spoiled = subject(tmp_path, spoil=replaced("kernel.c", "_p1 = m * g", bad))
    compared(spoiled, "rhs", 50)
    nan_lost = "const double Omega1 = Pi1 == Pi1 ? Pi1 / I1 : 0.0"
    spoiled = subject(
        tmp_path, spoil=replaced("kernel.c", "const double Omega1 = Pi1 / I1", nan_lost)
    )
    with pytest.raises(CrossCheckError, match="rung 5"):
        equal_bits(spoiled, 1000)


def test_rung_5_checks_the_last_member_of_an_odd_batch(tmp_path):
    """A loop that stops one short of an odd count is caught."""
    spoiled = subject(
        tmp_path, spoil=replaced("kernel.c", "_n < count;", "_n < (count & ~(size_t)1);")
    )
    with pytest.raises(CrossCheckError, match="rung 5"):
        equal_bits(spoiled, 1000)


def test_rung_5_detects_parameters_of_the_wrong_member(tmp_path):
    """Shared parameters taken for all, where each member has its own, are caught."""
    spoil = replaced(
        "kernel.c", "parameters[3 * parameters_stride + _n]", "parameters[3 * parameters_stride]"
    )
    with pytest.raises(CrossCheckError, match="rung 5"):
        equal_bits(subject(tmp_path, spoil=spoil), 1000)


@pytest.mark.parametrize(("apart", "passes"), [(15, True), (17, False)])
def test_rung_5_compares_numpy_and_c_where_bits_may_differ(apart, passes, tmp_path, monkeypatch):
    """Either within 9 units of the exact value, on its two sides, but 17 from each other."""
    reference = ProgramReference(PENDULUM.programs)
    good = subject(tmp_path, PENDULUM, reference=reference)
    points = exact_points(good, "energy", 50)
    whole = good.system._call

    def moved(function, state, parameters, target, out):
        numpy = good.system.python[function](state, parameters)
        whole(function, state, parameters, target, out)
        if target == "c":
            units = {m: float(known[0].envelope) * 2.0**-53 for m, known in exact.items()}
            for member, unit in units.items():
                out[..., member] = numpy[..., member] + apart * unit
        return out

    monkeypatch.setattr(good.system, "_call", moved)
    monkeypatch.setattr(compare, "_check_threshold", lambda *_: None)
    for batch, exact in points.batches:
        one = ExactPoints("energy", [(batch, exact)])
        if passes:
            against_oracle(good, one)
        else:
            with pytest.raises(CrossCheckError, match=r"rung 5: .*threshold 16"):
                against_oracle(good, one)


def test_nan_and_signed_zero_are_compared_correctly():
    """NaN equals NaN whatever its sign, 0 is not -0, and nothing else is forgiven."""
    one = np.array([np.nan, 0.0, 1.0, np.inf, 1.0])
    other = np.array([-np.nan, -0.0, 1.0, np.inf, np.nextafter(1.0, 2.0)])
    assert find_differing_bits(one, other).tolist() == [False, True, False, False, True]


def test_a_system_without_values_is_an_error(tmp_path):
    """A rung fails if the equations have values at almost no point."""
    nothing = [program("rhs", "q p", "k", "", "sqrt(-1 - q*q); p", (2,))]
    empty = subject(tmp_path, PENDULUM, reference=ProgramReference(nothing))
    with pytest.raises(CrossCheckError, match="0 of 54"):
        compared(empty, "rhs", 50)


def test_without_a_compiler_the_c_rungs_are_reported_as_not_run(tmp_path, monkeypatch):
    """Only the Python kernels are checked, and the report says what was not run."""
    monkeypatch.setattr(ladder, "compiler_version", lambda: "none")
    texts = render_system(HEAVY_TOP)
    system = TextSystem(HEAVY_TOP, texts, tmp_path)
    report = crosscheck(programs_of(HEAVY_TOP), texts, TopReference(), system, None, 100, 100)
    assert not report.passed
    assert report.targets == ("numpy", "python")
    assert report.rungs[3] == "passed"
    assert report.rungs[4] == "numpy, python; the others not run: no compiler"
    assert report.rungs[5] == report.rungs[4]


def test_a_broken_compiler_is_an_error(monkeypatch):
    """A compiler that was requested by name must exist."""
    monkeypatch.setenv("CC", "no-such-cc")
    with pytest.raises(CompilerError, match="no-such-cc"):
        ladder.available_targets()


def test_a_spoiled_text_stops_the_ladder(tmp_path):
    """`crosscheck` runs rung 3 on the texts it is given, whatever was loaded."""
    texts = render_system(HEAVY_TOP)
    system = TextSystem(HEAVY_TOP, texts, tmp_path)
    spoiled = replaced("kernel.py", GOOD, "Omega3 * Pi2 + Omega2 * Pi3")(texts)
    with pytest.raises(CrossCheckError, match="rung 3"):
        crosscheck(programs_of(HEAVY_TOP), spoiled, TopReference(), system, TARGETS, 100, 100)


def test_what_a_language_stops_at_is_known_of_a_function():
    """Divisors, roots and what they rest on; nothing of a polynomial."""
    each = program("rhs", "q p", "k", "a = q*p; b = a + k; c = q + p", "c/b; c*p; sqrt(a)", (3,))
    statements, outputs = list_stopping(each)
    assert [statement.name for statement in statements] == ["a", "b", "c"]
    assert outputs == [each.outputs[0].value, each.outputs[2].value]
    assert list_stopping(replace(each, outputs=each.outputs[1:2])) == ([], [])


#: A particle with an angle that has its value at 1 beyond a clamp, where rounding decides on it.
CLAMPED = """
title = "C"
routes = ["canonical"]
[variables]
q = { role = "coordinate" }
p = { role = "momentum", of = "q" }
[hamiltonian]
h = "p^2/2 + q^2/2"
[observables]
a = "acos(min(abs(q), 1))"
"""


def test_points_beyond_a_clamp_are_replaced_by_others(monkeypatch):
    """Half of all points are compared; a wrong value there is seen, and without others none is."""
    rendered = pipeline.render(read_spec_text(CLAMPED, "clamped.toml"))
    reference = Reference(rendered.equations)
    with load_texts(rendered.texts) as system:
        subject = Subject(rendered.programs, reference, system, ("numpy",))
        points = exact_points(subject, "observables", 150)
        reached = sum(len(members) for _, members in points.batches)
        assert points.count / 2 <= reached < points.count
        against_oracle(subject, points)
        batch, members = points.batches[-1]
        wrong = {
            n: [replace(each, value=each.value + 1) for each in rows] for n, rows in members.items()
        }
        spoiled = replace(points, batches=[*points.batches[:-1], (batch, wrong)])
        with pytest.raises(CrossCheckError, match="rung 4"):
            against_oracle(subject, spoiled)
        draw = compare.draw_usable
        monkeypatch.setattr(compare, "draw_usable", lambda *given: draw(*given).take(slice(0)))
        with pytest.raises(CrossCheckError, match="has a value at only"):
            against_oracle(subject, exact_points(subject, "observables", 150))
