"""figures: the part of a report that is seen: motions from one start, and a loop that opens."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable
from html import escape
from io import BytesIO
from itertools import combinations
from typing import TYPE_CHECKING

from geomtorsion.errors import GeomtorsionError, StartError
from geomtorsion.loops import BurgersVector, Loop, burgers_vector
from geomtorsion.ode import RungeKutta
from geomtorsion.pictures.curve_files import Draw, curve_pictures
from geomtorsion.pictures.loops import draw_closure
from geomtorsion.pictures.pair import Pair
from geomtorsion.pictures.pair_solving import refuse_unknown_functions, solve_pair
from geomtorsion.pictures.style import STYLE, can_draw
from geomtorsion.spaces.first_motions import first_motion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from geomtorsion.spaces.space import Space

# Enough for the eye; `geomtorsion curve` gives more.
ACCURACY = 1e-8
# Large enough for a gap that is seen, small enough to stay within a chart.
RADIUS = 0.25
NO_PICTURES = (
    '<p class="note">Pictures need matplotlib: <code>pip install geomtorsion[plots]</code>.</p>'
)


def motions_card(space: Space, progress: Callable[[str], object] = lambda _: None) -> str:
    """Autoparallel and geodesic from one start as HTML, or the reason why there are none."""
    progress("motions")
    try:
        # Compiling pays for long motions only; a page has one short one.
        pair = solve_pair(space, accuracy=ACCURACY, engine=RungeKutta())
        pictures = [_img(draw(pair), says) for draw, says in _chosen(pair)] if can_draw() else []
    except GeomtorsionError as error:
        return f'<section class="card"><p>No motions: {escape(str(error))}</p></section>'
    facts = "".join(f"<p>{escape(sentence)}</p>" for sentence in _sentences(pair))
    return f'<section class="card">{facts}{"".join(pictures) or NO_PICTURES}</section>'


def _chosen(pair: Pair) -> list[tuple[Draw, str]]:
    """The pictures that say most: the paths, or the coordinates where paths cannot be drawn."""
    shown = curve_pictures(pair)
    names = [("paths" if "paths" in shown else "coordinates"), "attitude", "distance"]
    return [shown[name] for name in names if name in shown]


def _sentences(pair: Pair) -> list[str]:
    """What the pictures show, in words."""
    largest = float(pair.distance.max())
    found = (
        f"From this start straightest and shortest path are one, to {largest:.0e}."
        if pair.coincide
        else f"From one start the straightest and the shortest path part: by {largest:.3g} at most."
    )
    return [found, *pair.stops.values()]


def loop_card(space: Space, progress: Callable[[str], object] = lambda _: None) -> str:
    """A small circle and its image in the frame, which does not close, as HTML."""
    progress("a loop")
    try:
        b = widest_gap(space)
        picture = _img(draw_closure(b), "A loop and its image in the frame.") if can_draw() else ""
    except GeomtorsionError as error:
        return f'<section class="card"><p>No loop: {escape(str(error))}</p></section>'
    # What is no more than its error is shown as zero.
    components = ", ".join(f"{x if abs(x) > 3 * b.error else 0:.6g}" for x in b.vector)
    text = f"A {b.loop.name} fails to close by b = ({components}), error below {b.error:.0e}."
    if b.magnitude <= 3 * b.error:
        text = "Circles close: there is no torsion, or none that a small circle sees here."
    return f'<section class="card"><p>{escape(text)}</p>{picture or NO_PICTURES}</section>'


def widest_gap(space: Space) -> BurgersVector:
    """The largest Burgers vector among small circles about the usual start, one in each plane.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> widest_gap(load("heisenberg")).magnitude > 0.1
    True
    """
    refuse_unknown_functions(space)
    if space.frame.complex:
        raise StartError(f"{space.name} is complex (a null tetrad), so the gap has no picture.")
    first = first_motion(space.frame)
    names = [symbol.name for symbol in space.frame.coordinates]
    circles = [
        Loop.circle(
            first.start, RADIUS, (i, k), f"circle of radius {RADIUS} in {names[i]}, {names[k]}"
        )
        for i, k in combinations(range(len(names)), 2)
    ]
    found = [burgers_vector(space.frame, c, parameters=dict(first.parameters)) for c in circles]
    return max(found, key=lambda b: b.magnitude)


def _img(figure: Figure, says: str) -> str:
    """A picture inside the page."""
    # Whoever has a figure has matplotlib.
    import matplotlib as mpl

    data = BytesIO()
    with mpl.rc_context({"svg.hashsalt": "geomtorsion"}):
        figure.savefig(data, format="svg", metadata={"Date": None, "Creator": None})
    coded = b64encode(data.getvalue()).decode("ascii")
    width = STYLE.rem * figure.get_size_inches()[0]
    return (
        f'<img class="figure" alt="{escape(says)}" style="width: {width:.1f}rem" '
        f'src="data:image/svg+xml;base64,{coded}">'
    )
