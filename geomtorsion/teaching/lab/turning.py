"""turning: turnable pictures in space, as complete documents.

matplotlib has no pictures that a reader can turn, and plotly adds 4 MB of script to each page.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from geomtorsion.pictures.style import Stroke
from geomtorsion.teaching.lab.plot import save, saving
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.texts import ENGLISH, code_of, texts

if TYPE_CHECKING:
    # The exercises take longer to load than the rest of these pictures.
    from geomtorsion.teaching.exercises.worker_pool import Json

T = TypeVar("T")
_STYLE = """
* { box-sizing: border-box; }
body { margin: 0; font: 15px/1.4 system-ui, sans-serif; color: #1d2330; background: #fff;
  display: flex; flex-direction: column; min-height: 100vh; }
h1 { font-size: 15px; margin: 2px 0 4px; text-align: center; }
canvas { display: block; width: 54px; height: 16px; }
#space { width: 100%; height: 300px; flex-grow: 1; touch-action: pan-y; cursor: grab; }
canvas:focus-visible, button:focus-visible, input:focus-visible { outline: 3px solid #1f5fa8; }
.player { display: flex; gap: 10px; align-items: center; margin: 4px 8px; }
.player input { flex: 1; min-width: 60px; accent-color: #1f5fa8; }
.player output { min-width: 6.5em; font-variant-numeric: tabular-nums; }
button { font: inherit; padding: 2px 14px; border: 1px solid #1f5fa8; border-radius: 6px;
  background: #fff; color: #1f5fa8; cursor: pointer; }
ul { list-style: none; margin: 4px 8px; padding: 0; display: flex; flex-wrap: wrap; gap: 2px 18px; }
li { display: flex; align-items: center; gap: 8px; }
.save { margin: 2px 8px; }
.save button { font-size: 13px; padding: 1px 10px; }
p { margin: 2px 8px 4px; color: #5c6475; font-size: 13px; }
"""


@dataclass(frozen=True)
class Curve:
    """A line in space.

    points: positions. stroke: colour, dashes, end mark; a mark that is "" is not drawn.
    label: in the legend. tip: text at its moving end. thin: drawn as a thin line.
    cone: with a pale surface to the origin, and for a fixed curve a line to its moving end.
    """

    points: Sequence[Sequence[float]]
    stroke: Stroke
    label: str = ""
    tip: str = ""
    thin: bool = False
    cone: bool = False


@dataclass(frozen=True)
class Film:
    """A picture in space.

    name: key under which the browser stores the view. title, axes: words.
    curves: fixed in space. moving: lines fixed in the body. attitudes: rotation matrices.
    times: of attitudes and of the points of curves; an animation if there are any.
    globe: radius of an opaque sphere; equal: lengths are true.
    turn: initial angle of the eye about the third axis, rad. language: of buttons and hints.
    """

    name: str
    title: str
    axes: tuple[str, str, str]
    curves: tuple[Curve, ...]
    moving: tuple[Curve, ...] = ()
    attitudes: Sequence[Sequence[Sequence[float]]] = ()
    times: Sequence[float] = ()
    globe: float = 0.0
    equal: bool = False
    note: str = field(default="")
    turn: float = -0.9
    language: str = ENGLISH


def turnable(scene: Film) -> str:
    """The picture as an HTML document without references to other files.

    Examples
    --------
    >>> from geomtorsion.pictures.style import SERIES
    >>> line = Curve([(0, 0, 0), (1, 1, 1)], SERIES[0], "a line")
    >>> page = turnable(Film("x", "A line", ("x", "y", "z"), (line,)))
    >>> "http" in page.replace("http://www.w3.org", ""), page.count("<canvas")
    (False, 2)
    """
    text = texts("figures", "figure", scene.language)
    data = {
        "name": scene.name,
        "axes": list(scene.axes),
        "curves": [_plain(curve) for curve in scene.curves],
        "moving": [_plain(part) for part in scene.moving],
        "attitudes": [_rounded([x for row in m for x in row]) for m in scene.attitudes],
        "times": _rounded(scene.times),
        "globe": scene.globe,
        "equal": scene.equal,
        "seconds": PAGE.duration,
        "turn": scene.turn,
        "play": text("play"),
        "pause": text("pause"),
    }
    # In a script element only the end tag of the element ends the text.
    content = json.dumps(data, separators=(",", ":")).replace("</", "<\\/")
    film = ""
    if len(scene.times) > 1:
        film = (
            f'<div class="player"><button id="play" type="button">{escape(text("play"))}</button>'
            f'<input id="time" type="range" min="0" max="{len(scene.times) - 1}" '
            f'value="{len(scene.times) - 1}" aria-label="{escape(text("time"))}">'
            '<output id="clock"></output></div>'
        )
    legend = "".join(
        f'<li><canvas data-curve="{number}" aria-hidden="true"></canvas>{escape(curve.label)}</li>'
        for number, curve in enumerate((*scene.curves, *scene.moving))
        if curve.label
    )
    note = f"{scene.note} " if scene.note else ""
    return (
        f'<!doctype html><html lang="{escape(code_of(scene.language))}">'
        '<head><meta charset="utf-8">'
        f"<title>{escape(scene.title)}</title><style>{_STYLE}</style></head><body>"
        f"<h1>{escape(scene.title)}</h1>"
        f'<canvas id="space" tabindex="0" role="img" aria-label="{escape(scene.title)}; '
        f'{escape(text("keys"))}"></canvas>'
        f"{film}<ul>{legend}</ul>{save(scene.language)}"
        f"<p>{escape(note)}{escape(text('turning'))}</p>"
        f'<script type="application/json" id="data">{content}</script>'
        f"<script>{_script()}{saving()}</script></body></html>"
    )


def in_space(scene: Film) -> Json:
    """A picture in space as part of a reply: `space`, its document, and `title`."""
    text = texts("figures", "figure", scene.language)
    kind = "animation" if len(scene.times) > 1 else "figure"
    return {"space": turnable(scene), "title": text(kind, title=scene.title)}


@cache
def _script() -> str:
    return Path(__file__).with_name("turn.js").read_text("utf-8")


def _plain(curve: Curve) -> Json:
    stroke = curve.stroke
    # matplotlib counts dashes in widths of the line, a canvas in pixels.
    dashes = [] if stroke.dashes == "-" else [stroke.width * part for part in stroke.dashes[1]]
    return {
        "color": stroke.color,
        "dashes": dashes,
        "mark": stroke.end,
        "width": stroke.width,
        "points": [_rounded(point) for point in curve.points],
        "tip": curve.tip,
        "thin": curve.thin,
        "cone": curve.cone,
    }


def _rounded(values: Sequence[float]) -> list[float]:
    return [float(f"{float(x):.{PAGE.digits}g}") for x in values]


def thinned(points: Sequence[T], most: int = PAGE.points) -> list[T]:
    """Evenly spaced points of a long curve, including the last one.

    Examples
    --------
    >>> thinned(range(10), 4)
    [0, 3, 6, 9]
    """
    count = len(points)
    if count <= most:
        return list(points)
    return [points[round(k * (count - 1) / (most - 1))] for k in range(most)]
