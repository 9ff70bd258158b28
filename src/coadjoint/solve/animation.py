"""Pictures that move: the picture of a trajectory, and where it is now.

Comes in: a `Solution`. Goes out: a GIF, an MP4 film, or a page with controls that needs no network.
What stands in a picture stands here too; a point moves on paths and spheres, a line over time.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.files import check_writable, write_whole
from coadjoint.solve.labels import tell_time
from coadjoint.solve.panels import COLOURS
from coadjoint.solve.plot import FAR, PALE, draw, new_figure

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.solution import Solution

    Array = NDArray[np.float64]
    #: Moves a mark to the place of a time.
    Move = Callable[[float], None]

#: How long a film is, seconds, and how many pictures it has in one.
SECONDS: Final = 8.0
RATE: Final = 25
#: Resolution, and megabytes that a page may have.
DOTS, MEGABYTES = 80, 200
#: Colour of a point that moves, which neither its start nor its time has.
MOVING: Final = COLOURS[3]
#: Symbols of the buttons of a page.
ICONS: Final = {
    "minus": "&minus;",
    "fast-backward": "|&#9664;&#9664;",
    "step-backward": "|&#9664;",
    "back": "&#9664;",
    "play": "&#9654;",
    "pause": "||",
    "step-forward": "&#9654;|",
    "fast-forward": "&#9654;&#9654;|",
    "plus": "+",
}
#: What writes films, by the ending.
WRITERS: Final = {".gif": "pillow", ".mp4": "ffmpeg", ".html": "html"}


def animate(
    solution: Solution,
    path: str | PathLike[str],
    *,
    seconds: float = SECONDS,
    progress: Callable[[int, int], object] = lambda done, total: None,
) -> None:
    """Draw a trajectory as a film, evenly in time.

    Args:
        solution: What to draw; it has two samples at least.
        path: File to write; its ending is .gif, .mp4 or .html.
        seconds: How long the film is.
        progress: Told of every picture: pictures done, pictures in all.

    Raises:
        KernelArgumentError: matplotlib or ffmpeg is not installed, or the ending is another one, or
            nothing moves.
        OutputError: The file cannot be written.
    """
    place = Path(fspath(path))
    check_film(place)
    if len(solution) < 2:
        raise KernelArgumentError(
            f"nothing moves: the solution has {len(solution)} sample. Ask for more, samples=200.",
            found=len(solution),
        )
    from matplotlib.animation import FuncAnimation

    figure = draw(solution)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # found anew for each picture, it would take most of the time
    moves = list(_list_moves(figure, solution))
    times = np.linspace(solution.time[0], solution.time_reached, max(2, round(seconds * RATE)))

    def show(frame: int) -> list[Any]:
        for move in moves:
            move(float(times[frame]))
        return []

    film = FuncAnimation(figure, show, frames=len(times), interval=1000 / RATE)
    with write_whole(place) as whole:
        film.save(whole, writer=_make_writer(place), dpi=DOTS, progress_callback=progress)
        if place.suffix.lower() == ".html":
            whole.write_text(_without_network(whole.read_text(encoding="utf-8")), encoding="utf-8")


def check_film(path: Path) -> None:
    """A film can be written at a path, as far as that shows without drawing it.

    Raises:
        KernelArgumentError: matplotlib or ffmpeg is not installed, or the ending is another one.
        OutputError: The folder is missing or not writable, or the path is a folder.
    """
    new_figure(headless=True)
    if path.suffix.lower() not in WRITERS:
        raise KernelArgumentError(
            f"{path} cannot be a film: its ending is {path.suffix!r}. "
            f"Expected one of {', '.join(WRITERS)}.",
            found=path.suffix,
            expected=list(WRITERS),
        )
    from matplotlib.animation import writers

    if not writers.is_available(WRITERS[path.suffix.lower()]):
        raise KernelArgumentError(
            f"{path}: films of this kind need ffmpeg, which is not installed. Install it, as by "
            "`apt install ffmpeg`, or take .gif or .html.",
            found=path.suffix,
            expected=[".gif", ".html"],
        )
    check_writable(path)


def _make_writer(path: Path) -> Any:
    """What matplotlib writes films of this ending with."""
    from matplotlib.animation import FFMpegWriter, HTMLWriter, PillowWriter

    match path.suffix.lower():
        case ".gif":
            return PillowWriter(fps=RATE)
        case ".mp4":
            return FFMpegWriter(fps=RATE)
    return HTMLWriter(fps=RATE, embed_frames=True, embed_limit=MEGABYTES, default_mode="loop")


def _without_network(page: str) -> str:
    """The page of matplotlib with characters for a font of symbols that it would fetch."""
    page = re.sub(r"<link[^>]*font-awesome[^>]*>", "", page).replace("play fa-flip", "back fa-flip")
    return re.sub(r'<i class="fa fa-([a-z-]+)[^"]*"></i>', lambda icon: ICONS[icon[1]], page)


def _list_moves(figure: Any, solution: Solution) -> Iterator[Move]:
    """What moves on each of the axes of a picture."""
    for axes in figure.axes:
        path = getattr(axes, "coadjoint_path", None)
        if path is not None:
            time, members = path
            yield from (_move_along(axes, time, each) for each in members)
        elif getattr(axes, "coadjoint_time", False):
            yield _move_over(axes)
        field = getattr(axes, "coadjoint_field", None)
        if field is not None:
            yield _move_field(axes, solution, *field)
        body = getattr(axes, "coadjoint_body", None)
        if body is not None:
            axes.title.set_text(axes.get_title().replace(PALE, ""))
            yield _move_body(solution, body)


def _move_along(axes: Any, time: Array, path: Array) -> Move:
    """A point on a path, ``(d, T)``."""
    marked = {"markersize": 9, "markeredgecolor": "white", "zorder": 6}
    (point,) = axes.plot(*path[:, :1], marker="o", color=MOVING, **marked)
    toward = getattr(axes, "coadjoint_toward", None)

    def move(now: float) -> None:
        place = [np.array([np.interp(now, time, row)]) for row in path]
        point.set_data(*place[:2])
        if len(place) == 3:
            point.set_3d_properties(place[2])
        if toward is not None:
            point.set_alpha(1.0 if toward @ np.concatenate(place) >= 0 else FAR)

    return move


def _move_field(axes: Any, solution: Solution, colours: Any, show: Callable[[int], Array]) -> Move:
    """A field on a surface, shown by the number of a sample: the latest before the film's time."""

    def move(now: float) -> None:
        at = max(0, int(np.searchsorted(solution.time, now, side="right")) - 1)
        colours.set_array(show(at))
        axes.set_title(tell_time(solution, at), fontsize=9)

    return move


def _move_body(solution: Solution, draw_at: Callable[[int], None]) -> Move:
    """A body at the sample that is nearest to the time of the film."""
    middles = (solution.time[1:] + solution.time[:-1]) / 2
    return lambda now: draw_at(int(np.searchsorted(middles, now)))


def _move_over(axes: Any) -> Move:
    """A line at the time of the film."""
    line = axes.axvline(axes.get_xlim()[0], color="#56657a", linewidth=1.0)
    return lambda now: line.set_xdata([now, now])
