"""plot: curves over two axes as svg text, which differ by dashes and marks as well as by colour.

Not matplotlib: the page draws anew while a slider moves, and the extra `lab` needs no `plots`.
"""

from __future__ import annotations

import base64
import math
import struct
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from html import escape

import numpy as np

from geomtorsion.pictures.style import number

Point = tuple[float, float]


@dataclass(frozen=True)
class Layout:
    """Sizes of a plot, in its own units.

    left, right, top, bottom: margins. entry: height of a line of the legend.
    ticks: about how many an axis has. decades: a logarithmic axis over fewer is marked between the
    powers of ten too.
    """

    left: float = 66.0
    right: float = 16.0
    top: float = 48.0
    bottom: float = 46.0
    entry: float = 22.0
    ticks: int = 5
    decades: float = 2.2


LAYOUT = Layout()


@dataclass(frozen=True)
class Look:
    """How a line looks: colour, dashes and the mark at its end, none of them like another's."""

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
    parts: list[Callable[[Axes], str]] = field(default_factory=list)
    legend: dict[str, Look] = field(default_factory=dict)
    points: list[Point] = field(default_factory=list)

    def line(self, points: Sequence[Point], look: Look, label: str = "") -> Plot:
        """A curve; its label goes into the legend, once."""
        if label:
            self.legend.setdefault(label, look)
        return self._with(lambda axes: polyline([axes.place(one) for one in points], look), points)

    def picture(self, low: Point, high: Point, address: str) -> Plot:
        """A picture of pixels between two corners; its first row lies at the lower corner."""
        return self._with(lambda axes: axes.picture(low, high, address), [low, high])

    def mark(self, point: Point, look: Look, kind: str = "", text: str = "") -> Plot:
        """A mark, with a text next to it."""
        return self._with(lambda axes: axes.mark(point, look, kind or look.mark, text), [point])

    def arrow(self, start: Point, end: Point, look: Look, text: str = "") -> Plot:
        """An arrow, with a text next to its middle."""
        return self._with(lambda axes: axes.arrow(start, end, look, text), [start, end])

    def sense(self, points: Sequence[Point], look: Look) -> Plot:
        """An arrow head on a curve, a sixth of the way along it."""
        one, two = points[len(points) // 6], points[len(points) // 6 + 1]
        return self._with(lambda axes: head(axes.place(one), axes.place(two), look.color, 13), [])

    def _with(self, part: Callable[[Axes], str], points: Sequence[Point]) -> Plot:
        # Drawn later: the range of the axes is known when all parts are.
        self.parts.append(part)
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
        return Axes.of(self).svg()


@dataclass(frozen=True)
class Axes:
    """A plot with the range of its axes.

    low, high: corners of what is seen, in scaled units; foot: height left for the legend.
    """

    plot: Plot
    low: Point
    high: Point
    foot: float

    @classmethod
    def of(cls, plot: Plot) -> Axes:
        """Axes round everything that is drawn, with a margin."""
        spans = []
        for k in (0, 1):
            values = [point[k] for point in plot.points if math.isfinite(point[k])] or [0.0, 1.0]
            low, high = min(values), max(values)
            centre, half = (low + high) / 2, (high - low) / 2
            half = half or abs(centre) * 0.1 or 1.0
            spans.append((centre, half * 1.08))
        foot = LAYOUT.entry * len(plot.legend)
        if plot.equal:
            room = (
                plot.width - LAYOUT.left - LAYOUT.right,
                plot.height - LAYOUT.top - LAYOUT.bottom - foot,
            )
            unit = max(2 * span[1] / size for span, size in zip(spans, room, strict=True))
            spans = [(s[0], unit * size / 2) for s, size in zip(spans, room, strict=True)]
        return cls(
            plot,
            (spans[0][0] - spans[0][1], spans[1][0] - spans[1][1]),
            (spans[0][0] + spans[0][1], spans[1][0] + spans[1][1]),
            foot,
        )

    def place(self, point: Point) -> Point:
        """Where a point lies in the picture."""
        return self._at(self.plot._scaled(point))

    def _at(self, point: Point) -> Point:
        wide = self.plot.width - LAYOUT.left - LAYOUT.right
        tall = self.plot.height - LAYOUT.top - LAYOUT.bottom - self.foot
        x = (point[0] - self.low[0]) / (self.high[0] - self.low[0])
        y = (point[1] - self.low[1]) / (self.high[1] - self.low[1])
        return LAYOUT.left + wide * (1 - x if self.plot.falling else x), LAYOUT.top + tall * (1 - y)

    def svg(self) -> str:
        """The whole picture."""
        plot = self.plot
        drawn = "".join(part(self) for part in plot.parts)
        return (
            f'<svg class="plot" viewBox="0 0 {plot.width:g} {plot.height:g}" role="img" '
            f'aria-label="{escape(plot.title)}" xmlns="http://www.w3.org/2000/svg" '
            'font-family="system-ui, sans-serif">'
            f'<rect width="{plot.width:g}" height="{plot.height:g}" fill="#fff"/>'
            f"{words(plot.width / 2, 20, plot.title, 'middle', 15, INK, 600)}"
            f"{self._grid()}{drawn}{self._key()}</svg>"
        )

    def mark(self, point: Point, look: Look, kind: str, text: str) -> str:
        """A mark and its text, which stands on the other side near the right edge."""
        x, y = self.place(point)
        side, anchor = (-9, "end") if x > 0.85 * self.plot.width else (9, "start")
        label = words(x + side, y - 7, text, anchor, 13, look.color) if text else ""
        return marker((x, y), kind, look.color) + label

    def picture(self, low: Point, high: Point, address: str) -> str:
        """A picture, turned so that its rows go up as the axis does; pixels stay sharp."""
        (left, bottom), (right, top) = self.place(low), self.place(high)
        return (
            f'<image width="{right - left:.2f}" height="{bottom - top:.2f}" '
            f'preserveAspectRatio="none" style="image-rendering: pixelated" href="{address}" '
            f'transform="translate({left:.2f} {bottom:.2f}) scale(1 -1)"/>'
        )

    def arrow(self, start: Point, end: Point, look: Look, text: str) -> str:
        """An arrow and its text; nothing where it would be shorter than two pixels."""
        one, two = self.place(start), self.place(end)
        if math.dist(one, two) < 2:
            return ""
        size = min(12.0, 0.6 * math.dist(one, two))
        middle = ((one[0] + two[0]) / 2, (one[1] + two[1]) / 2)
        label = words(middle[0] + 10, middle[1] - 6, text, "start", 14, look.color, 600)
        return polyline([one, two], look) + head(one, two, look.color, size) + label

    def _grid(self) -> str:
        """Lines, numbers and names of the axes."""
        plot = self.plot
        parts = []
        bottom = plot.height - LAYOUT.bottom - self.foot
        for value, text in self._ticks(0):
            x, _ = self._at((value, self.low[1]))
            parts.append(_rule((x, LAYOUT.top), (x, bottom)))
            parts.append(words(x, bottom + 17, text, "middle", 12, SOFT))
        for value, text in self._ticks(1):
            _, y = self._at((self.low[0], value))
            parts.append(_rule((LAYOUT.left, y), (plot.width - LAYOUT.right, y)))
            parts.append(words(LAYOUT.left - 6, y + 4, text, "end", 12, SOFT))
        middle = (LAYOUT.left + plot.width - LAYOUT.right) / 2
        parts.append(words(middle, bottom + 37, plot.labels[0], "middle", 14))
        parts.append(words(6, LAYOUT.top - 8, plot.labels[1], "start", 14))
        return "".join(parts)

    def _ticks(self, k: int) -> list[tuple[float, str]]:
        low, high = self.low[k], self.high[k]
        if "xy"[k] in self.plot.log:
            step = max(1, math.ceil((high - low) / 7))
            first = math.ceil(low / step) * step
            if high - low < LAYOUT.decades:
                return _between_powers(low, high)
            return [(e, _power(e)) for e in range(first, math.floor(high) + 1, step)]
        return [(value, number(value)) for value in nice_ticks(low, high)]

    def _key(self) -> str:
        """The legend, below the plot."""
        parts = []
        top = self.plot.height - self.foot + 6
        for row, (label, look) in enumerate(self.plot.legend.items()):
            y = top + LAYOUT.entry * row
            parts.append(polyline([(LAYOUT.left, y), (LAYOUT.left + 48, y)], look))
            if look.mark:
                parts.append(marker((LAYOUT.left + 48, y), look.mark, look.color, 4.5))
            parts.append(words(LAYOUT.left + 60, y + 5, label, "start", 13))
        return "".join(parts)


def nice_ticks(low: float, high: float) -> list[float]:
    """Round numbers between two, about five.

    Examples
    --------
    >>> nice_ticks(0.0, 1.0)
    [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]
    """
    rough = (high - low) / LAYOUT.ticks
    unit = 10.0 ** math.floor(math.log10(rough))
    step = unit * min((m for m in (1, 2, 5, 10)), key=lambda m: abs(math.log(m * unit / rough)))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    digits = max(0, 2 - math.floor(math.log10(step)))
    return [round(k * step, digits) + 0.0 for k in range(first, last + 1)]


def _between_powers(low: float, high: float) -> list[tuple[float, str]]:
    """One, two and five times each power of ten in a range, with the numbers themselves."""
    powers = range(math.floor(low), math.ceil(high) + 1)
    values = [(math.log10(m) + e, m * 10.0**e) for e in powers for m in (1, 2, 5)]
    return [(place, number(value)) for place, value in values if low <= place <= high]


def _power(exponent: int) -> str:
    """A power of ten with raised digits."""
    raised = str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return {0: "1", 1: "10"}.get(exponent, f"10{raised}")


def _rule(start: Point, end: Point) -> str:
    (a, b), (c, d) = start, end
    return f'<path d="M{a:.1f} {b:.1f}L{c:.1f} {d:.1f}" stroke="{PALE}"/>'


def polyline(points: Sequence[Point], look: Look) -> str:
    """A curve in the units of the picture."""
    text = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
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


# From dark to bright, so that grey prints and all kinds of colour vision see the same order: the
# scale viridis (Smith and van der Walt, public domain) at equal steps, red, green and blue.
COLOURS = np.array(
    [(68, 1, 84), (71, 45, 123), (59, 82, 139), (44, 114, 142), (33, 145, 140), (40, 174, 128),
     (94, 201, 98), (173, 220, 48), (253, 231, 37)]
)  # fmt: skip
UNKNOWN = (205, 208, 213)


def colours(values: np.ndarray, most: float) -> np.ndarray:
    """Red, green and blue of values between 0 and `most`; grey where nothing is known.

    Examples
    --------
    >>> colours(np.array([0.0, 2.0, np.nan]), 2.0).tolist()
    [[68, 1, 84], [253, 231, 37], [205, 208, 213]]
    """
    known = np.isfinite(values)
    share = np.where(known, values, 0.0) / (most or 1.0)
    place = np.clip(share, 0, 1) * (len(COLOURS) - 1)
    steps = np.arange(len(COLOURS))
    parts = [np.interp(place, steps, COLOURS[:, k]) for k in range(3)]
    found = np.rint(np.stack(parts, axis=-1)).astype(np.uint8)
    found[~known] = UNKNOWN
    return found


def png(pixels: np.ndarray) -> bytes:
    """Red, green and blue, shape (rows, columns, 3), as a PNG file (W3C, second edition).

    Examples
    --------
    >>> png(np.zeros((2, 3, 3), np.uint8))[:8]
    b'\\x89PNG\\r\\n\\x1a\\n'
    """
    rows, columns = pixels.shape[:2]
    # Each line begins with the number of its filter: none.
    lines = np.zeros((rows, 1 + 3 * columns), np.uint8)
    lines[:, 1:] = pixels.reshape(rows, -1)
    head = struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0)
    parts = [(b"IHDR", head), (b"IDAT", zlib.compress(lines.tobytes())), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in parts
    )


def address(picture: bytes) -> str:
    """A PNG file as an address that holds it."""
    return f"data:image/png;base64,{base64.b64encode(picture).decode()}"


def scale(most: float, unit: str) -> str:
    """What the colours mean, as an svg element: a strip from 0 to `most`, and grey.

    Examples
    --------
    >>> scale(2.0, "1/um").count("<text")
    3
    """
    strip = address(png(colours(np.linspace(0, 1, 64)[None], 1.0)))
    end = f"{number(float(f'{most:.3g}'))} {unit}".strip()
    grey = "rgb({},{},{})".format(*UNKNOWN)
    return (
        '<svg class="plot" viewBox="0 0 520 44" role="img" aria-label="scale of colours" '
        'xmlns="http://www.w3.org/2000/svg" font-family="system-ui, sans-serif">'
        '<rect width="520" height="44" fill="#fff"/>'
        f'<image x="66" y="4" width="260" height="16" preserveAspectRatio="none" href="{strip}"/>'
        f"{words(66, 38, '0', 'start', 13, INK)}"
        f"{words(326, 38, end, 'end', 13, INK)}"
        f'<rect x="362" y="4" width="16" height="16" fill="{grey}"/>'
        f"{words(384, 17, 'hole, boundary or edge', 'start', 13, INK)}</svg>"
    )
