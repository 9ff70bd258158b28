r"""Figures as TikZ, for documents that LaTeX compiles: lines, surfaces, colours and words.

A renderer of matplotlib that writes commands in the place of dots. Colours are those of a short
palette, so that a path coloured by time is a few long lines, and a field a few long strips.
Comes in: a figure. Goes out: a ``tikzpicture``. Read next: `coadjoint.solve.illustrate`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from matplotlib.backend_bases import RendererBase
from matplotlib.colors import to_rgb

from coadjoint.notation.names import GREEK

#: Points of an inch, the unit of all lengths here.
DPI: Final = 72
#: Steps of each of red, green and blue.
STEPS: Final = 24
#: Strips of a field, which has more points: each is one of its rows.
MOST_STRIPS: Final = 24
#: Cells of a strip, each of one colour.
MOST_CELLS: Final = 48
#: Characters beyond which a picture is left out.
LONGEST: Final = 600_000
#: Names of letters and signs that pdflatex does not know as they are.
_SIGNS: Final = {letter: f"${latex}$" for latex, letter in GREEK.values()} | {
    "\u2212": "$-$", "×": r"$\times$", "·": r"$\cdot$", "°": r"$^\circ$", "∞": r"$\infty$",
    "|": "$|$", "<": "$<$", ">": "$>$", "→": r"$\to$", "²": "$^2$", "³": "$^3$", "⁻": "$^-$",
    "\\": r"\textbackslash{}", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}",
    **{sign: f"\\{sign}" for sign in "{}$&#_%"},
}  # fmt: skip


def write_tikz(figure: Any) -> str:
    """A figure as one ``tikzpicture``; empty where it would be too long."""
    figure.set_dpi(DPI)
    renderer = Renderer(*(float(size) * DPI for size in figure.get_size_inches()))
    figure.draw(renderer)
    text = renderer.finish()
    return text if len(text) <= LONGEST else ""


class Renderer(RendererBase):
    """What writes paths, strips and words.

    Args:
        width: Of the figure, in points.
        height: Of it.
    """

    def __init__(self, width: float, height: float) -> None:
        super().__init__()
        self.width, self.height = width, height
        self.lines: list[str] = []
        self.colours: dict[tuple[int, ...], str] = {}
        self._open = ("", (0.0, 0.0))
        self._clip: tuple[str, ...] = ()

    def finish(self) -> str:
        """The picture."""
        self._close()
        self._set_clip(None)
        defined = [
            rf"\definecolor{{{name}}}{{RGB}}{{{','.join(map(str, rgb))}}}"
            for rgb, name in self.colours.items()
        ]
        head = r"\begin{tikzpicture}[x=1pt, y=1pt, line join=round, line cap=round]"
        return "\n".join([head, *defined, *self.lines, r"\end{tikzpicture}"])

    # -- what matplotlib asks -------------------------------------------------------------------

    def flipy(self) -> bool:
        """Heights count from below."""
        return False

    def get_canvas_width_height(self) -> tuple[float, float]:
        """In points."""
        return self.width, self.height

    def points_to_pixels(self, points: Any) -> Any:
        """They are points."""
        return points

    def draw_path(self, gc: Any, path: Any, transform: Any, rgbFace: Any = None) -> None:
        """A line, or a surface with its edge."""
        box = (-self.width, -self.height, 2 * self.width, 2 * self.height)
        clip = None if rgbFace is not None else box
        parts, start, end = list[str](), None, (0.0, 0.0)
        for points, code in path.iter_segments(transform, clip=clip, simplify=rgbFace is None):
            places = [(points[n], points[n + 1]) for n in range(0, len(points), 2)]
            if not np.isfinite(points).all():
                continue
            word = {1: "", 2: "--", 3: "..controls", 4: "..controls"}.get(code)
            if word is None:
                parts.append("--cycle")
                continue
            shown = [_place(each) for each in places]
            if code == 2 and parts and shown[0] == _place(end):
                continue
            end = places[-1]
            start = start or end
            if code in (1, 2):
                parts.append(word + shown[0])
            else:
                parts.append(f"..controls{' and '.join(shown[:-1])}..{shown[-1]}")
        style = self._style(gc, rgbFace)
        if not style or len(parts) < 2 or start is None:
            return
        self._set_clip(gc.get_clip_rectangle())
        opened, last = self._open
        joined = rgbFace is None and opened == style and _place(last) == _place(start)
        if joined:
            self.lines[-1] += "".join(parts[1:])
        else:
            self._close()
            self.lines.append(f"\\path[{style}]{''.join(parts)}")
        self._open = (style, end)
        if rgbFace is not None:
            self._close()

    def draw_quad_mesh(
        self, gc: Any, master_transform: Any, meshWidth: int, meshHeight: int, coordinates: Any,
        offsets: Any, offsetTrans: Any, facecolors: Any, antialiased: Any, edgecolors: Any,
    ) -> None:  # fmt: skip
        """Cells of a grid along the axes, those of one colour next to each other as one."""
        self._close()
        self._set_clip(gc.get_clip_rectangle())
        places = master_transform.transform(np.reshape(coordinates, (-1, 2)))
        places = places.reshape(meshHeight + 1, meshWidth + 1, 2)
        names = [self._colour(each) for each in facecolors]
        if meshWidth < meshHeight:
            places = places.transpose(1, 0, 2)
            names = list(np.reshape(names, (meshHeight, meshWidth)).T.ravel())
        rows, count = places.shape[0] - 1, places.shape[1] - 1
        step, stride = -(-rows // MOST_STRIPS), -(-count // MOST_CELLS)
        for i in range(0, rows, step):
            above, j = min(i + step, rows), 0
            while j < count:
                k, name = j, names[i * count + j]
                while k < count and names[i * count + k] == name:
                    k = min(k + stride, count)
                first, last = _place(places[i, j]), _place(places[above, k])
                self.lines.append(f"\\fill[{name}]{first}rectangle{last};")
                j = k

    def draw_image(self, gc: Any, x: float, y: float, im: Any, transform: Any = None) -> None:
        """Dots are left out."""

    def draw_text(
        self, gc: Any, x: float, y: float, s: str, prop: Any, angle: float, ismath: Any = False,
        mtext: Any = None,
    ) -> None:  # fmt: skip
        """Words; formulas as LaTeX has them."""
        self._close()
        self._set_clip(None)
        size = prop.get_size_in_points()
        options = ["anchor=base west", "inner sep=0pt", f"text={self._colour(gc.get_rgb())}"]
        options += [f"rotate={angle:g}"] * bool(angle)
        font = rf"\fontsize{{{size:.3g}}}{{{1.2 * size:.3g}}}\selectfont"
        self.lines.append(
            f"\\node[{', '.join(options)}] at {_place((x, y))} {{{font} {spell(s)}}};"
        )

    # -- how it is written ----------------------------------------------------------------------

    def _close(self) -> None:
        """End a line that may go on."""
        if self._open[0]:
            self.lines[-1] += ";"
        self._open = ("", (0.0, 0.0))

    def _set_clip(self, box: Any) -> None:
        """Show what follows within a box alone."""
        wanted = () if box is None else (_place((box.x0, box.y0)), _place((box.x1, box.y1)))
        if wanted != self._clip:
            self._close()
            if self._clip:
                self.lines.append(r"\end{scope}")
            if wanted:
                self.lines.append(rf"\begin{{scope}}\clip{wanted[0]}rectangle{wanted[1]};")
            self._clip = wanted

    def _style(self, gc: Any, face: Any) -> str:
        """Colours, width and dashes; empty for what is not seen."""
        options, edge = list[str](), gc.get_rgb()
        alpha = gc.get_alpha() if gc.get_forced_alpha() else None
        if face is not None and (len(face) < 4 or face[3] > 0):
            options.append(f"fill={self._colour(face)}")
            seen = alpha if alpha is not None else face[3] if len(face) > 3 else 1
            options += [f"fill opacity={seen:.2g}"] * bool(seen < 1)
        width, seen = gc.get_linewidth(), edge[3] if len(edge) > 3 else 1
        if width > 0 and seen > 0:
            options += [f"draw={self._colour(edge)}", f"line width={width:.2g}pt"]
            options += [f"draw opacity={seen:.2g}"] * bool(seen < 1)
            _, dashes = gc.get_dashes()
            if dashes is not None:
                pairs = zip(("on", "off") * len(dashes), dashes, strict=False)
                pattern = " ".join(f"{word} {size:.2g}pt" for word, size in pairs)
                options.append(f"dash pattern={pattern}")
        return ", ".join(options)

    def _colour(self, colour: Any) -> str:
        """The name of the colour of the palette that is nearest."""
        rgb = tuple(round(round(part * STEPS) * 255 / STEPS) for part in to_rgb(colour[:3]))
        return self.colours.setdefault(rgb, f"c{len(self.colours)}")


def _place(point: Sequence[float]) -> str:
    """A point to a tenth of a unit."""
    x, y = (f"{each:.1f}".removesuffix(".0") for each in point)
    return f"({x},{y})".replace("-0,", "0,").replace(",-0)", ",0)")


def spell(text: str) -> str:
    r"""Words of a figure for LaTeX.

    >>> spell("φ\u0307 [m/s]"), spell("a_1"), spell(r"$\Pi_1$")
    ('$\\dot{\\phi}$ [m/s]', 'a\\_1', '$\\Pi_1$')
    """
    parts = re.split(r"((?<!\\)\$[^$]*\$)", text)
    return "".join(each if n % 2 else _spell_plain(each) for n, each in enumerate(parts))


def _spell_plain(text: str) -> str:
    """Words without formulas."""
    letters = list[str]()
    for letter in text.replace("\n", " "):
        if letter == "\u0307" and letters:
            letters[-1] = rf"$\dot{{{letters[-1].strip('$')}}}$"
        elif letter in _SIGNS or letter.isascii():
            letters.append(_SIGNS.get(letter, letter))
    return "".join(letters)
