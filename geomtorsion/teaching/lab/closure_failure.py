"""closure failure: a circle, the gap of its image in the frame, and two computations of the gap."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
import scipy  # loads its parts on first use
import sympy as sp

from geomtorsion.codegen import graph
from geomtorsion.curves import edges_of
from geomtorsion.geometry import Frame, cartan
from geomtorsion.loops import Hodograph, Loop, burgers_vector, develop, forms, hodograph
from geomtorsion.pictures.loops import GAP, START
from geomtorsion.pictures.style import SERIES, Stroke, arrow, number, sense
from geomtorsion.pictures.text import greek_name
from geomtorsion.spaces.first_motion import first_motion
from geomtorsion.support.outgoing import size_text
from geomtorsion.support.precision import CALCULATED
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.numbers import names_text, raised, shown, table
from geomtorsion.teaching.lab.plot import beside, mark, plane, svg
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.space_info import is_around_the_axis, space_of
from geomtorsion.teaching.texts import ENGLISH, Texts, texts

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from geomtorsion.loops import BurgersVector, Check, EnclosedDefect

PATH, IMAGE = SERIES[0], SERIES[2]


def closure_failure(
    space: str,
    centre: Sequence[float],
    radius: float,
    plane: Sequence[int],
    language: str = ENGLISH,
) -> Json:
    """A circle about a point of a shipped space and its Burgers vector, drawn and tabulated.

    Parameters
    ----------
    centre, radius
        In coordinates.
    plane
        Two coordinates, by number.
    language
        of the words in pictures, table and sentence.

    Returns
    -------
    pictures: two svg elements. table: HTML, one row a component. sentence: description.
    b, expected: b^i and 2 S_{mn}^i A at the centre, as numbers. error: bound on the error of b.

    Examples
    --------
    >>> found = closure_failure("heisenberg", [0, 0, 0], 0.5, [0, 1])
    >>> max(abs(x - y) for x, y in zip(found["b"], found["expected"])) < 1e-12
    True
    """
    frame = space_of(space).frame
    values = dict(first_motion(frame).parameters)
    first, second = plane
    text = texts("figures", "loop", language)
    if is_around_the_axis(space, centre, plane):
        return _around_the_axis(frame, values, [float(x) for x in centre], float(radius), text)
    loop = Loop.circle([float(x) for x in centre], float(radius), (first, second))
    b = burgers_vector(_without_domain(frame), loop, parameters=values)
    expected = density(frame, b, first, second)
    names = [greek_name(symbol.name) for symbol in frame.coordinates]
    # Enough points for a smooth curve at 520 pixels, few enough to send with each move of a slider.
    drawn = hodograph(b, 160)
    return {
        "pictures": [
            _path_picture(drawn, names, first, second, text),
            _image_picture(drawn, b, text),
        ],
        "table": _table(b, expected, text),
        "sentence": " ".join(
            [*_sentences(b, expected, names, (first, second), text), *_outside(frame, b, text)]
        ),
        "b": np.real(b.vector).tolist(),
        "expected": expected,
        "error": float(b.error),
    }


def _around_the_axis(
    frame: Frame, values: Mapping[str, float], centre: Sequence[float], radius: float, text: Texts
) -> Json:
    """Reply for a circle about the axis of polar coordinates: legs may come back rotated."""
    s = sp.Symbol("s", real=True)
    begin = centre[1]
    curve = [sp.Rational(radius), sp.Rational(begin) + s, *map(sp.Rational, centre[2:])]
    loop = Loop.parametric(curve, s, (0, 2 * sp.pi), periods={1: 2 * sp.pi})
    motion = develop(cartan(frame), loop, parameters=values)
    angles = begin + np.linspace(0, 2 * np.pi, PAGE.samples)
    names = [symbol.name for symbol in (*frame.coordinates, *frame.parameters)]
    legs = graph(names, [frame.coframe[i, 1] for i in range(len(centre))]).numpy()
    place = [radius, angles, *centre[2:], *(values[p.name] for p in frame.parameters)]
    rates = [np.broadcast_to(row, PAGE.samples) for row in legs(*place)]
    image = scipy.integrate.cumulative_simpson(rates, x=angles, initial=0)
    circle = radius * np.array([np.cos(angles), np.sin(angles)])
    closed = bool(np.hypot(*motion.burgers[:2]) <= motion.error)
    turn = motion.angle
    is_turned = abs(turn) > motion.turn_error + motion.error
    sentence = text("turned", angle=f"{turn:.6g}") if is_turned else text("unchanged")
    rows = [[f"b{raised(k)}", shown(x, motion.error)] for k, x in enumerate(motion.burgers)]
    return {
        "pictures": [
            _loop(circle, text("around"), ("r cos φ", "r sin φ"), text("axis"), text),
            _image(image[:2], _image_title(closed, text), ("X¹", "X²"), text, closed=closed),
        ],
        "table": table(("", "b"), rows, text("caption_start")),
        "sentence": sentence,
        "b": motion.burgers.tolist(),
        "expected": [0.0] * len(centre),
        "error": float(motion.error),
    }


@lru_cache(maxsize=16)
def _without_domain(frame: Frame) -> Frame:
    """The frame without its domain: the page reports a circle that leaves it, and continues."""
    return Frame(
        frame.coordinates,
        frame.coframe.to_sympy(),
        signature=frame.eta.to_sympy(),
        parameters=frame.parameters,
        complex=frame.complex,
        name=frame.name,
    )


def _outside(frame: Frame, b: BurgersVector, text: Texts) -> list[str]:
    """A sentence about a loop that leaves the domain of its coordinates; otherwise empty."""
    at = b.loop.points(PAGE.samples)
    names = [symbol.name for symbol in (*frame.coordinates, *frame.parameters)]
    place = [*np.real(at), *(b.parameters[p.name] for p in frame.parameters)]
    for edge in edges_of(frame):
        [inside] = graph(names, [edge.element.sympy]).numpy()(*place)
        if np.min(inside) < 0:
            return [text("outside", relation=edge.relation)]
    return []


def density(frame: Frame, b: BurgersVector, first: int, second: int) -> list[float]:
    """2 S_{mn}^i A at the centre of a loop: the prediction for a small loop, frame components.

    Equation
    --------
    2 S_{mn}^i = d_m e^i_n - d_n e^i_m, A the oriented area of the loop in its plane.
    """
    compiled = forms(frame, b.parameters)
    result = np.zeros(frame.dimension)
    if compiled.curl is not None:
        curls = np.real(compiled.curl.at(np.array(b.loop.centre)[:, None])[:, 0])
        m, n = compiled.pairs[:, compiled.curl.columns]
        sign = ((m == first) & (n == second)) * 1.0 - ((m == second) & (n == first)) * 1.0
        np.add.at(result, compiled.curl.rows, sign * curls)
    area = float(b.loop.area[first, second])
    return [float(x) * area for x in result]


def _loop(points: np.ndarray, title: str, labels: tuple[str, str], centre: str, text: Texts) -> str:
    """A loop around the origin, with its base point and its sense."""
    figure, axes = plane(title, labels, equal=True)
    _curve(axes, points, PATH)
    mark(axes, (0.0, 0.0), START, "X", centre)
    mark(axes, points[:, 0], START, "o", text("both"))
    return svg(figure, text.language)


def _image(
    points: np.ndarray, title: str, labels: tuple[str, str], text: Texts, *, closed: bool
) -> str:
    """The image of a loop; if it is not closed, with an arrow from its start to its end."""
    figure, axes = plane(title, labels, equal=True)
    _curve(axes, points, IMAGE)
    start, end = points[:, 0], points[:, -1]
    if not closed:
        arrow(axes, start, end, GAP, 2.4)
        beside(axes, (start + end) / 2, GAP, "b")
        mark(axes, end, GAP, "^", text("end"))
    mark(axes, start, START, "o", text("start"))
    return svg(figure, text.language)


def _curve(axes: Axes, points: np.ndarray, stroke: Stroke) -> None:
    axes.plot(*points, **stroke.line)
    sense(axes, points, stroke.color)


def _image_title(closed: bool, text: Texts) -> str:
    return text("closed" if closed else "open")


def _path_picture(drawn: Hodograph, names: list[str], first: int, second: int, text: Texts) -> str:
    """The loop in its plane, in coordinates."""
    offsets = (text("offset", name=names[k]) for k in (first, second))
    one, two = (_with_unit(offset, drawn.unit, text) for offset in offsets)
    return _loop(drawn.path[[first, second]], text("title"), (one, two), text("centre"), text)


def _with_unit(label: str, unit: str, text: Texts) -> str:
    return text("label", label=label, unit=unit) if unit else label


def _image_picture(drawn: Hodograph, b: BurgersVector, text: Texts) -> str:
    """The image in the frame, seen from the side from which the gap is widest."""
    curve = np.real(drawn.image)
    widths = np.ptp(curve, axis=1)
    gap = np.abs(curve[:, -1] - curve[:, 0])
    # The gap must be seen: its largest component, and the widest of the other directions.
    main = int(gap.argmax()) if gap.max() > 1e-9 * widths.max() else int(widths.argmax())
    others = [k for k in range(len(widths)) if k != main]
    i, k = sorted((main, max(others, key=lambda j: widths[j])))
    one, two = (_with_unit(f"X{raised(j)}", drawn.unit, text) for j in (i, k))
    title = _image_title(b.vanishes, text)
    if drawn.magnified != 1:
        title = text("grown", title=title, times=number(drawn.magnified))
    return _image(curve[[i, k]], title, (one, two), text, closed=b.vanishes)


def _table(b: BurgersVector, expected: Sequence[float], text: Texts) -> str:
    """Both results, component by component, and the prediction for a small loop."""
    flux = b.check.flux
    rows = []
    for k, value in enumerate(np.real(b.vector)):
        rows.append(
            [
                f"b{raised(k)}",
                shown(value, b.error),
                shown(np.real(b.check.line)[k], b.check.line_error),
                "–" if flux is None else shown(np.real(flux)[k], b.check.flux_error or 0.0),
                shown(expected[k], 0.0),
            ]
        )
    heads = ("", "b", text("line"), text("flux"), text("small"))
    return table(heads, rows, text("caption"))


def _sentences(
    b: BurgersVector,
    expected: Sequence[float],
    names: Sequence[str],
    plane: tuple[int, int],
    text: Texts,
) -> list[str]:
    """Description of the pictures in words."""
    around = names_text([names[k] for k in plane], text.language)
    area, error = float(b.loop.area[plane]), size_text(b.error, 0)
    first = text("area", area=number(float(f"{area:.6g}")), plane=around)
    if b.vanishes:
        return [first, text("closes", error=error), _check(b.check, text)]
    sentences = [first, text("gap", size=f"{b.magnitude:.6g}", error=error)]
    if b.enclosed and not any(expected):
        defects = names_text([_enclosed(one, text) for one in b.enclosed], text.language)
        return [*sentences, text("encloses", defects=defects)]
    largest = max(abs(x) for x in expected)
    if largest:
        miss = max(abs(x - y) for x, y in zip(np.real(b.vector), expected, strict=True)) / largest
        # Where torsion is constant along the loop, 2 S A is b itself: the rest is rounding.
        if miss <= max(b.error / largest, CALCULATED):
            sentences.append(text("agrees"))
        else:
            share = f"{miss:.1%}" if miss > 1e-3 else f"{miss:.0e}"
            sentences.append(text("differs", share=share))
    return [*sentences, _check(b.check, text)]


def _check(check: Check, text: Texts) -> str:
    """Comparison of both results in a sentence."""
    if check.difference is None:
        return text("check.single")
    size = size_text(float(abs(check.difference).max()))
    return text("check.agree" if check.agrees else "check.differ", size=size)


def _enclosed(one: EnclosedDefect, text: Texts) -> str:
    """A line inside the loop: its position and the turns of the loop about it."""
    where = one.defect.equations
    if one.turns == 1:
        return text("line_once", position=where)
    return text("line_turns", position=where, turns=number(one.turns))
