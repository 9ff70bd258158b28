"""Pictures of motions for documents: drawn from the generated code, as dots, as TikZ or as SVG.

Comes in: a System. Goes out: the picture and its caption. Read next: `coadjoint.solve.plot`.
"""

from __future__ import annotations

import base64
import io
import re
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import ShockWarning

if TYPE_CHECKING:
    from coadjoint.solve.plot import Scene
    from coadjoint.solve.solution import Solution
    from coadjoint.solve.system import System

#: Units of time that a picture covers, and samples along it.
SPAN, SAMPLES = 20.0, 1500
#: Samples of a picture of LaTeX, in which each is a few letters.
FEW_SAMPLES = 500
#: Of what has noise: seeds of paths from one start, the units of time that they cover, and a step.
#: Longer paths would cover each other.
SEEDS, NOISY_SPAN, STEP = (1, 2, 3), 6.0, 1 / 64
#: Dots for an inch of it: two for each point of a page.
RESOLUTION = 100
#: Colours of it: with fewer, time along a path is seen in steps; 256 take a third more room, which
#: colours over time and space need, since their bars would have steps.
COLOURS, MANY_COLOURS = 96, 256
#: Of these, shades of time.
TIMES = 32
#: Why a motion ends before its time, by its status.
ENDS = {
    "MAX_STEPS": "It stops at the largest number of steps.",
    "STEP_UNDERFLOW": "It stops where no step is small enough.",
    "NONFINITE": "It stops where its rates are not finite.",
    "DOMAIN": "It stops where the system is no longer defined.",
}
#: The same of waves that break, after which no smooth solution exists.
BREAKS = "It ends where the waves break."
#: The largest change of an invariant in a picture, over its size, and why it ends before that.
DRIFT = 1e-4
#: Size of an invariant, over that of the state, below which it is 0 but for roundings.
ROUNDINGS = 1e-9
LOSES = "It ends where the digits of doubles do not suffice: invariants drift beyond it."


def illustrate(system: System, state: Sequence[float], form: str = "html") -> dict[str, str]:
    """A motion from a state, with the default parameters.

    Args:
        system: What moves.
        state: Where it begins.
        form: ``"html"`` for dots as an address of data, ``"latex"`` for a ``tikzpicture``,
            ``"typst"`` for an SVG picture as a string of Typst.

    Raises:
        CoadjointError: matplotlib is not installed, or the motion cannot begin there.
    """
    from coadjoint.solve.plot import draw

    samples = SAMPLES if form == "html" else FEW_SAMPLES
    with warnings.catch_warnings(record=True) as told:  # of kinks on the way, which it shows
        warnings.simplefilter("always")
        solutions = _simulate(system, state, samples)
        breaks = [each.message.after for each in told if isinstance(each.message, ShockWarning)]
        if breaks:  # what comes after is no motion
            solutions = _simulate(system, state, samples, span=min(breaks))
        lost = find_loss(solutions[0])
        if lost is not None:
            solutions = _simulate(system, state, samples, span=lost)
    figure, caption = draw(*solutions), describe(*solutions)
    if breaks:
        caption += f" {BREAKS}"
    if lost is not None:
        caption += f" {LOSES}"
    if form == "latex":
        from coadjoint.solve.tikz import write_tikz

        return {"picture": write_tikz(figure), "caption": caption}
    if form == "typst":
        return {"picture": quote_typst(write_svg(figure)), "caption": caption}
    place = io.BytesIO()
    figure.savefig(place, format="png", dpi=RESOLUTION)
    count = MANY_COLOURS if _has_colours_of_values(figure) else COLOURS
    data = base64.b64encode(_take_colours(place, count)).decode("ascii")
    return {"picture": f"data:image/png;base64,{data}", "caption": caption}


def find_loss(solution: Solution) -> float | None:
    """How long after the beginning an invariant has changed by too much; None for never."""
    far = np.zeros(len(solution), dtype=bool)
    least = ROUNDINGS * float(np.abs(solution.state[:, 0]).max())
    for name in solution.conserved:
        size = float(np.abs(solution[name]).reshape(-1, len(solution))[:, 0].max())
        if size > least:  # else it begins at 0, and changes by roundings alone
            change = np.abs(solution.change(name)).reshape(-1, len(solution)).max(axis=0)
            far |= change > DRIFT * size
    if not far.any() or far[:2].any():
        return None
    return float(solution.time[np.argmax(far) - 1] - solution.time[0])


def write_svg(figure: Any) -> str:
    """A figure as SVG, the same each time; letters are curves, since a reader may lack the font."""
    import matplotlib as mpl

    place = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": "coadjoint", "svg.fonttype": "path"}):
        figure.savefig(place, format="svg", metadata={"Date": None, "Creator": None})
    # to a hundredth of a point, which halves the text
    return re.sub(r"(?<= d=)\"[^\"]*\"|(?<= [xy]=)\"[^\"]*\"", _round_places, place.getvalue())


def _round_places(text: re.Match[str]) -> str:
    """Numbers with two digits behind the point."""
    return re.sub(r"(\.\d\d)\d+", r"\1", text[0])


def quote_typst(text: str) -> str:
    r"""A string of Typst.

    >>> quote_typst('<a b="1\\2"/>')
    '"<a b=\\"1\\\\2\\"/>"'
    """
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _simulate(
    system: System, state: Sequence[float], samples: int, span: float = SPAN
) -> list[Solution]:
    """The motion from a state; with noise some paths, one for each seed."""
    from coadjoint.solve.noisy import has_noise

    if has_noise(system):
        ends = 1 + round(NOISY_SPAN / STEP)  # of steps
        return [
            system.simulate(
                state, (0.0, NOISY_SPAN), step=STEP, seed=seed, samples=ends, progress=False
            )
            for seed in SEEDS
        ]
    # what follows from a motion, as a place, is drawn where there is some
    reconstruct = bool(system.RECONSTRUCTED)
    return [
        system.simulate(
            state, (0.0, span), samples=samples, progress=False, reconstruct=reconstruct
        )
    ]


def _has_colours_of_values(figure: Any) -> bool:
    """Whether values over time or over space are drawn as colours."""
    from matplotlib.collections import QuadMesh

    shown = [axes for axes in figure.axes if axes.get_label() != "<colorbar>"]
    return any(isinstance(each, QuadMesh) for axes in shown for each in axes.collections)


def _take_colours(place: io.BytesIO, count: int = COLOURS) -> bytes:
    """A picture with a palette of its colours, which takes a third of the room."""
    from PIL import Image  # matplotlib needs it

    small = io.BytesIO()
    with Image.open(place) as picture:
        whole, own = picture.convert("RGB"), [*_list_line_colours(), *_list_time_colours()]
        few = whole.quantize(count - len(own) // 3).getpalette() or []
        palette = Image.new("P", (1, 1))
        palette.putpalette([*few, *own])
        # thin lines are too few dots for colours of their own, among those of a surface
        shown = whole.quantize(palette=palette, dither=Image.Dither.NONE)
        shown.save(small, format="png", optimize=True)
    return small.getvalue()


def _list_line_colours() -> list[int]:
    """The colours of lines: red, green and blue of one after the other."""
    from matplotlib.colors import to_rgb

    from coadjoint.solve.panels import COLOURS as LINES

    return [round(255 * part) for colour in LINES for part in to_rgb(colour)]


def _list_time_colours() -> list[int]:
    """Those of times: the last ones are few dots, and would become colours of other lines."""
    import matplotlib as mpl

    from coadjoint.solve.scenes import TIME_MAP

    shades = mpl.colormaps[TIME_MAP]([n / (TIMES - 1) for n in range(TIMES)])[:, :3]
    return [round(255 * part) for shade in shades for part in shade]


def describe(solution: Solution, *others: Solution) -> str:
    """What the picture shows; with others, paths of noise by the seeds that they have."""
    from coadjoint.solve.plot import find_scene

    unit = solution.unit("time").removeprefix("1")  # of what has no dimension
    length = solution.time_reached - solution.time[0]
    span = f"{length:.3g} {unit}" if unit else f"a {solution.system.clock[1]} of {length:.3g}"
    if others:
        return (
            f"{len(SEEDS)} paths from one start with the default parameters over {span}, by the "
            f"generated code, the implicit midpoint and the seeds {', '.join(map(str, SEEDS))}. "
            "Each has a colour of its own."
        )
    lead = f"A motion with the default parameters over {span}, by the generated code."
    if solution.status in ENDS:
        lead += f" {ENDS[solution.status]}"
    return f"{lead} {_tell_colours(find_scene(solution), solution.system.clock[1])}".rstrip()


def _tell_colours(scene: Scene | None, clock: str) -> str:
    """What the colours of a picture are; those of components stand in its legend."""
    from coadjoint.solve.curves import Curves
    from coadjoint.solve.rolling_bodies import RollingBody
    from coadjoint.solve.scenes import Paths, Sphere
    from coadjoint.solve.vehicles import Vehicle

    match scene:
        case Paths(linked=True, unit=unit):
            parts = "; lengths are parts of that of all rods, found by the energy" * (unit == "1")
            return f"The path of each mass has the colour of its rod{parts}."
        case Paths(labels=labels) if labels:
            return "Each vector has a colour of its own."
        case Paths(members=members, counted=counted) if len(members) > 1:
            return f"Each {counted} has a colour of its own."
        case (Sphere(labels=labels),) if labels:
            return "Each member has a colour of its own."
        case Curves(title=title):
            return f"Above, {title}: the colour of a curve is its {clock}, dark at the start."
        case Paths() | (Sphere(), *_):
            return f"Colour is {clock}, dark at the start."
        case RollingBody():
            told = (
                f"The trace of the contact is coloured by {clock}, dark at the start; the gray "
                "line is the path of the centre of mass. Sectors of the body in two blues show how "
                "it turns; the body is pale where it was before."
            )
            cap = " The orange cap is where the third axis of the body leaves it."
            return told + cap * (not scene.is_flat)
        case Vehicle():
            return (
                f"The path is coloured by {clock}, dark at the start. The vehicle is black at the "
                "end, and gray where it was before."
            )
    return ""
