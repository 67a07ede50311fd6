"""svg: plots as text, with dashes, marks and labels, so that they can be read without colour."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Any

Point = tuple[float, float]
# Decimals of a pixel that are written.
_PLACES = 1


@dataclass(frozen=True)
class Look:
    """How a line looks: colour, dashes and the mark at its end, each of which tells it apart."""

    color: str
    dashes: str = ""
    mark: str = "square"
    width: float = 2.2


# The colours of Okabe and Ito, as in the pictures of reports.
LOOKS = (
    Look("#0072B2", "", "square"),
    Look("#C24E00", "9 4", "triangle"),
    Look("#007a59", "10 3 2 3", "diamond"),
    Look("#222222", "2 3", "cross"),
    Look("#b04a86", "16 4", "down"),
    Look("#8a6d00", "6 2 2 2 2 2", "ring"),
)
INK, SOFT, PALE = "#1d2330", "#5c6475", "#e6e8ea"


@dataclass
class Plot:
    """A plane with axes, collecting what is drawn; `svg` gives the whole.

    width, height: of the picture in its own units; title: above it; labels: of the axes.
    equal: one unit is equally long on both axes. log: which axes are logarithmic, of "xy".
    falling: the horizontal axis runs from large to small.
    """

    title: str
    labels: tuple[str, str]
    width: float = 520
    height: float = 400
    equal: bool = False
    log: str = ""
    falling: bool = False
    parts: list[tuple[str, Any]] = field(default_factory=list)
    points: list[Point] = field(default_factory=list)

    def line(self, points: Sequence[Point], look: Look, label: str = "") -> Plot:
        """A curve; its label goes into the legend."""
        return self._with("line", (list(points), look, label), points)

    def mark(self, point: Point, look: Look, kind: str = "", text: str = "") -> Plot:
        """A mark, with a text beside it."""
        return self._with("mark", (point, look, kind or look.mark, text), [point])

    def arrow(self, start: Point, end: Point, look: Look, text: str = "") -> Plot:
        """An arrow, with a text beside its middle."""
        return self._with("arrow", (start, end, look, text), [start, end])

    def sense(self, points: Sequence[Point], look: Look) -> Plot:
        """An arrow head on a curve, a sixth of the way along it."""
        place = len(points) // 6
        return self._with("sense", (points[place], points[place + 1], look), [])

    def level(self, height: float, look: Look, label: str = "") -> Plot:
        """A straight line across."""
        return self._with("level", (height, look, label), [])

    def _with(self, kind: str, what: Any, points: Sequence[Point]) -> Plot:
        self.parts.append((kind, what))
        self.points += [self._scaled(point) for point in points]
        return self

    def _scaled(self, point: Point) -> Point:
        x, y = point
        return (
            math.log10(x) if "x" in self.log else x,
            math.log10(y) if "y" in self.log else y,
        )

    def svg(self) -> str:
        """The picture as an svg element."""
        from geomtorsion.lab.axes import Axes

        return Axes.of(self).svg()


def polyline(points: Sequence[Point], look: Look) -> str:
    """A curve in the units of the picture."""
    text = " ".join(f"{x:.{_PLACES}f},{y:.{_PLACES}f}" for x, y in points)
    dashes = f' stroke-dasharray="{look.dashes}"' if look.dashes else ""
    return (
        f'<polyline points="{text}" fill="none" stroke="{look.color}" '
        f'stroke-width="{look.width:g}" stroke-linejoin="round"{dashes}/>'
    )


def marker(point: Point, kind: str, color: str, size: float = 5.0) -> str:
    """A mark in the units of the picture.

    Examples
    --------
    >>> marker((1, 2), "dot", "#000")
    '<circle cx="1.0" cy="2.0" r="5" fill="#000" stroke="#fff"/>'
    """
    x, y = point
    shapes = {
        "square": [(-1, -1), (1, -1), (1, 1), (-1, 1)],
        "triangle": [(0, -1.3), (1.2, 0.9), (-1.2, 0.9)],
        "down": [(0, 1.3), (1.2, -0.9), (-1.2, -0.9)],
        "diamond": [(0, -1.4), (1.2, 0), (0, 1.4), (-1.2, 0)],
    }
    if kind == "cross":
        d = size
        path = f"M{x - d:.1f} {y - d:.1f}L{x + d:.1f} {y + d:.1f}"
        path += f"M{x - d:.1f} {y + d:.1f}L{x + d:.1f} {y - d:.1f}"
        return f'<path d="{path}" stroke="{color}" stroke-width="2.4" fill="none"/>'
    if kind in shapes:
        points = " ".join(f"{x + size * a:.1f},{y + size * b:.1f}" for a, b in shapes[kind])
        return f'<polygon points="{points}" fill="{color}" stroke="#fff"/>'
    hollow = f'fill="#fff" stroke="{color}" stroke-width="2"'
    filled = hollow if kind == "ring" else f'fill="{color}" stroke="#fff"'
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{size:g}" {filled}/>'


def head(start: Point, end: Point, color: str, size: float = 12.0) -> str:
    """The head of an arrow, in the units of the picture."""
    angle = math.atan2(end[1] - start[1], end[0] - start[0])
    corners = [
        end,
        (end[0] - size * math.cos(angle - 0.42), end[1] - size * math.sin(angle - 0.42)),
        (end[0] - size * math.cos(angle + 0.42), end[1] - size * math.sin(angle + 0.42)),
    ]
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
    return f'<polygon points="{points}" fill="{color}"/>'


def words(
    x: float, y: float, text: str, anchor: str = "start", size: float = 14, color: str = INK,
    weight: int = 400,
) -> str:  # fmt: skip
    """A text in the units of the picture, with a pale edge that keeps it legible over lines."""
    bold = f' font-weight="{weight}"' if weight != 400 else ""
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size:g}" '
        f'fill="{color}" stroke="#fff" stroke-width="3" paint-order="stroke"{bold}>'
        f"{escape(text)}</text>"
    )
