"""report: the whole geometry of a space as one page and as data, in a directory."""

from __future__ import annotations

import json
import re
from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from itertools import combinations
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import sympy as sp
from sympy.core.relational import Relational

from geomtorsion.errors import GeomtorsionError, StartError
from geomtorsion.geometry.assumption import assumption_of
from geomtorsion.geometry.quantities import SECTIONS
from geomtorsion.loops import BurgersVector, Loop, burgers_vector
from geomtorsion.ode import RungeKutta
from geomtorsion.pictures.curve_files import Draw, curve_pictures
from geomtorsion.pictures.field_equations import (
    TITLE,
    field_equations_data,
    field_equations_html,
)
from geomtorsion.pictures.formula import FONT_SOURCE, expression_mathml, font_face, mathml
from geomtorsion.pictures.latex import equation_latex, latex_matrix, latex_name, latex_text
from geomtorsion.pictures.loops import draw_closure
from geomtorsion.pictures.quantities import chosen_quantities, geometry_data
from geomtorsion.pictures.sections import section
from geomtorsion.pictures.style import STYLE, can_draw, svg_text
from geomtorsion.pictures.text import greek_words
from geomtorsion.pictures.verdicts import Verdict, of_identity, verdicts
from geomtorsion.spaces import Pair, refuse_unknown_functions, solve_pair
from geomtorsion.spaces.first_motion import first_motion
from geomtorsion.support import checks
from geomtorsion.support.files import write_texts
from geomtorsion.support.outgoing import html_text, measured_text, size_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from geomtorsion.gravity import FieldEquations
    from geomtorsion.pictures.quantities import Quantity
    from geomtorsion.spaces import Space

# A space's own connection may lack these properties: they are not identities.
PROPERTIES = ("metricity",)


_CONVENTIONS = (
    "Γ_{ab}^c: a is the direction of differentiation",
    "S_{ab}^c = (Γ_{ab}^c - Γ_{ba}^c)/2",
    "T_{ab}^c = 2 S_{ab}^c",
    "R_{bc} = R_{abc}^a",
)


@cache
def stylesheet() -> str:
    """The look of a report, font of formulas included: for phones, projectors and paper."""
    return font_face() + Path(__file__).with_name("report.css").read_text("utf-8")


def page(
    space: Space,
    quantities: Sequence[Quantity],
    verdicts: Mapping[str, Sequence[Verdict]],
    seen: Mapping[str, str] | None = None,
) -> str:
    """The whole report as HTML text; `seen` are further sections, title -> HTML."""
    groups = {title: [q for q in quantities if q.entry.section == title] for title in SECTIONS}
    shown = {title: "".join(map(section, those)) for title, those in groups.items() if those}
    shown |= seen or {}
    body = [_header(space, list(shown)), "<main>"]
    body += [f'<h2 id="{_anchor(title)}">{title}</h2>{html}' for title, html in shown.items()]
    body += [_checks(verdicts), _branches(space), "</main>", _footer()]
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        # The page promises to load nothing; the browser holds it to that.
        '<meta http-equiv="Content-Security-Policy" '
        f"content=\"default-src 'none'; style-src 'unsafe-inline'; img-src data:; {FONT_SOURCE}\">"
        f"<title>{html_text(space.name)}: {html_text(space.title)}</title>"
        f"<style>{stylesheet()}</style></head>\n<body>{''.join(body)}</body></html>\n"
    )


def _header(space: Space, sections: Sequence[str]) -> str:
    frame = space.frame
    facts = [
        ("Coordinates", _symbols([symbol.name for symbol in frame.coordinates])),
        ("Parameters", _symbols([symbol.name for symbol in frame.parameters])),
        ("Domain", _domain(frame.domain)),
        ("Region", _prose(assumption_of(frame))),
        ("Names", _names(frame.names)),
        ("Frame metric", _frame_metric(space)),
        ("Source", html_text(space.source)),
        ("Note", _prose(space.notes)),
    ]
    rows = "".join(f"<dt>{name}</dt><dd>{value}</dd>" for name, value in facts if value)
    links = "".join(
        f'<a href="#{_anchor(section)}">{section}</a>' for section in (*sections, "Checks")
    )
    title = html_text(space.title[:1].upper() + space.title[1:])
    return (
        f'<header><p class="name">{html_text(space.name)}</p><h1>{title}</h1>'
        f'<p class="story">{_prose(space.story)}</p><dl class="facts">{rows}</dl>'
        f"<nav>{links}</nav></header>"
    )


def _symbols(names: Sequence[str]) -> str:
    return mathml(", ".join(map(latex_name, names))) if names else ""


def _names(found: Mapping[sp.Symbol, sp.Expr]) -> str:
    """Definitions of the names used in printing, as markup."""
    return ", ".join(
        mathml(f"{latex_name(name.name)} = {latex_text(what)}") for name, what in found.items()
    )


def _domain(relations: Sequence[Relational]) -> str:
    """Inequalities as markup; two bounds of one symbol are joined."""
    bounds: dict[sp.Expr, list[Relational]] = {}
    for relation in relations:
        symbol = relation.lhs if relation.lhs.is_Symbol else relation.rhs
        bounds.setdefault(symbol, []).append(relation)
    return ", ".join(mathml(_bounded(symbol, group)) for symbol, group in bounds.items())


def _bounded(symbol: sp.Expr, relations: Sequence[Relational]) -> str:
    """The bounds of one symbol: below it on the left, above it on the right."""
    left = right = ""
    others = []
    for relation in relations:
        sign = "<" if relation.rel_op in "<>" else r"\le "
        if relation.lts == symbol and not right:
            right = f"{sign}{latex_text(relation.gts)}"
        elif relation.gts == symbol and not left:
            left = f"{latex_text(relation.lts)}{sign}"
        else:
            others.append(f"{latex_text(relation.lts)}{sign}{latex_text(relation.gts)}")
    both = [f"{left}{latex_text(symbol)}{right}"] if left or right else []
    return ", ".join([*both, *others])


def _frame_metric(space: Space) -> str:
    """The frame metric as diag(...), or as a matrix where it is not diagonal."""
    eta, n = space.frame.eta, range(space.frame.dimension)
    if all(i == j for i, j in eta.components.nonzero):
        values = ", ".join(latex_text(eta[i, i]) for i in n)
        return mathml(rf"\eta = \operatorname{{diag}}\left({values}\right)")
    return mathml(rf"\eta = {latex_matrix([[latex_text(eta[i, j]) for j in n] for i in n])}")


def _checks(verdicts: Mapping[str, Sequence[Verdict]]) -> str:
    tables = []
    for title, group in verdicts.items():
        rows = "".join(_check(verdict) for verdict in group)
        table = f"<table><caption>{html_text(title)}</caption>{rows}</table>"
        tables.append(f'<section class="card scroll">{table}</section>')
    return f'<h2 id="about-checks">Checks</h2>{"".join(tables)}'


def _check(verdict: Verdict) -> str:
    sign, look, word = {
        True: ("✓", "good", "holds"),
        False: ("✗", "bad", "fails"),
        None: ("?", "unsure", "undecided"),
    }[verdict.holds]
    if not verdict.required and verdict.holds is False:
        sign, look = "–", "unsure"
    detail = html_text(verdict.detail)
    if verdict.equation:
        detail = f"{mathml(equation_latex(verdict.equation))} <small>{detail}</small>"
    return (
        f'<tr><td class="{look}" title="{word}" aria-label="{word}">{sign}</td>'
        f"<td>{html_text(verdict.name)}</td><td>{detail}</td></tr>"
    )


def _branches(space: Space) -> str:
    """How each root was read, if there are any."""
    branches = space.frame.field.branches
    if not branches:
        return ""
    items = "".join(
        f"<p>{expression_mathml(branch.radical)} is read as {expression_mathml(branch.read_as)}"
        f", right where {html_text(greek_words(branch.condition))}.</p>"
        for branch in branches
    )
    return f'<h2 id="about-roots">Branches of roots</h2><section class="card">{items}</section>'


def _prose(text: str) -> str:
    """A sentence as HTML, with Greek letters for their names and indices and powers in place."""
    # Escaped first: the markup inserted afterwards is our own.
    lowered = re.sub(r"\b(\w)_(\w+)", r"\1<sub>\2</sub>", html_text(greek_words(text)))
    return re.sub(r"\^(-?\w+)", r"<sup>\1</sup>", lowered)


def _footer() -> str:
    conventions = "; ".join(mathml(equation_latex(text)) for text in _CONVENTIONS)
    return (
        f"<footer><p>Conventions: {conventions}. A bar marks quantities of the metric; "
        "numbers with a hat are frame vectors, counted from 1 (in the data from 0). Components "
        "that are not shown vanish exactly.</p>"
        '<p>The components as data: <a href="geometry.json">geometry.json</a>. '
        "Made by geomtorsion.</p>"
        "</footer>"
    )


def _anchor(section: str) -> str:
    """The name of a section in links."""
    return "-".join(["about", *section.lower().replace("'", "").split()])


# Large enough for a visible gap, at least 3 % of the length of the loop; small enough for the loop
# to look like one, with a gap below 60 % of its length.
RADIUS = 0.25
NO_PICTURES = (
    "<p class=\"note\">Pictures need matplotlib: <code>pip install 'geomtorsion[plots]'</code>.</p>"
)


def motions_card(space: Space, progress: Callable[[str], object] = lambda _: None) -> str:
    """Autoparallel and geodesic from one start as HTML, or the reason why there are none."""
    progress("motions")
    try:
        # Compiling pays for long motions only; a page has one short one.
        pair = solve_pair(space, engine=RungeKutta())
        pictures = [_img(draw(pair), says) for draw, says in _chosen(pair)] if can_draw() else []
    except GeomtorsionError as error:
        return f'<section class="card"><p>No motions: {html_text(str(error))}</p></section>'
    facts = "".join(f"<p>{html_text(sentence)}</p>" for sentence in _sentences(pair))
    return f'<section class="card">{facts}{"".join(pictures) or NO_PICTURES}</section>'


def _chosen(pair: Pair) -> list[tuple[Draw, str]]:
    """The most useful figures: the paths, or the coordinates where paths cannot be drawn."""
    shown = curve_pictures(pair)
    names = [("paths" if "paths" in shown else "coordinates"), "attitude", "distance"]
    return [shown[name] for name in names if name in shown]


def _sentences(pair: Pair) -> list[str]:
    """Captions of the figures."""
    largest = float(pair.distance.max())
    sentence = (
        f"From this start straightest and shortest path are one, to {size_text(largest, 0)}."
        if pair.coincide
        else f"From one start the straightest and the shortest path part: by {largest:.3g} at most."
    )
    return [sentence, *pair.stops.values()]


def loop_card(space: Space, progress: Callable[[str], object] = lambda _: None) -> str:
    """A small circle and its image in the frame, which does not close, as HTML."""
    progress("a loop")
    try:
        b = widest_gap(space)
        picture = _img(draw_closure(b), "A loop and its image in the frame.") if can_draw() else ""
    except GeomtorsionError as error:
        return f'<section class="card"><p>No loop: {html_text(str(error))}</p></section>'
    # A component no larger than its error is shown as zero.
    components = [x if abs(x) > 3 * b.error else 0.0 for x in b.vector.tolist()]
    text = f"A {b.loop.name} fails to close by b = {measured_text(components, b.error)}."
    if b.magnitude <= 3 * b.error:
        text = "Circles close: there is no torsion, or none that a small circle sees here."
    return f'<section class="card"><p>{html_text(text)}</p>{picture or NO_PICTURES}</section>'


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
    vectors = [burgers_vector(space.frame, c, parameters=dict(first.parameters)) for c in circles]
    return max(vectors, key=lambda b: b.magnitude)


def _img(figure: Figure, says: str) -> str:
    """A picture inside the page."""
    coded = b64encode(svg_text(figure).encode()).decode("ascii")
    width = STYLE.rem * figure.get_size_inches()[0]
    return (
        f'<img class="figure" alt="{html_text(says)}" style="width: {width:.1f}rem" '
        f'src="data:image/svg+xml;base64,{coded}">'
    )


def write_report(
    space: Space,
    directory: str | PathLike[str],
    progress: Callable[[str], object] = lambda _: None,
    *,
    pictures: bool = True,
    basis: str = "natural",
    equations: FieldEquations | None = None,
) -> Path:
    """Write index.html and geometry.json and return the path of the page.

    The page needs no network: mathematics is MathML, style and pictures are inside. Without
    matplotlib the pictures are missing, and the page reports it; ``pictures=False`` omits motions
    and loops. Indices refer to the basis: "natural" (each quantity in the one in which it is
    defined), "coordinate" or "frame". ``equations`` are field equations on the space
    (`gravity.equations`), shown after its geometry. The directory is made if it is missing; nothing
    is written before everything is computed.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from geomtorsion.spaces import load
    >>> with TemporaryDirectory() as folder:
    ...     write_report(load("s2"), folder, pictures=False).name
    'index.html'
    """
    directory = checks.file_name(directory, "directory")
    quantities = chosen_quantities(space, (), basis, progress)
    checked = verdicts(space, progress)
    seen = {}
    if equations is not None:
        progress("field equations")
        seen[TITLE] = field_equations_html(equations)
        checked[TITLE] = [of_identity(identity) for identity in equations.identities()]
    if pictures:
        seen |= {"Motions": motions_card(space, progress), "Closure": loop_card(space, progress)}
    progress("writing")
    html = page(space, quantities, checked, seen)
    data = geometry_data(space, quantities)
    data["checks"] = {
        title: [{"name": v.name, "holds": v.holds, "detail": v.detail} for v in group]
        for title, group in checked.items()
    }
    if equations is not None:
        data["field_equations"] = field_equations_data(equations)
    # From here on nothing can fail but the disk.
    texts = {"index.html": html, "geometry.json": json.dumps(data, indent=2) + "\n"}
    return write_texts(directory, texts)[0]
