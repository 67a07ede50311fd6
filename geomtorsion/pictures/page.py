"""page: a report as one HTML file that needs no script and no network."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cache
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import sympy as sp
from sympy.core.relational import Relational

from geomtorsion.pictures.catalogue import SECTIONS
from geomtorsion.pictures.latex import equation_latex, latex_matrix, latex_name, latex_text
from geomtorsion.pictures.math_font import FONT_SOURCE, font_face
from geomtorsion.pictures.mathml import expression_mathml, mathml
from geomtorsion.pictures.sections import section
from geomtorsion.pictures.text import greek_words

if TYPE_CHECKING:
    from geomtorsion.pictures.quantities import Quantity
    from geomtorsion.pictures.verdicts import Verdict
    from geomtorsion.spaces.space import Space

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
    found = {title: [q for q in quantities if q.entry.section == title] for title in SECTIONS}
    shown = {title: "".join(map(section, those)) for title, those in found.items() if those}
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
        f"<title>{escape(space.name)}: {escape(space.title)}</title>"
        f"<style>{stylesheet()}</style></head>\n<body>{''.join(body)}</body></html>\n"
    )


def _header(space: Space, sections: Sequence[str]) -> str:
    frame = space.frame
    facts = [
        ("Coordinates", _symbols([symbol.name for symbol in frame.coordinates])),
        ("Parameters", _symbols([symbol.name for symbol in frame.parameters])),
        ("Domain", _domain(frame.domain)),
        ("Frame metric", _frame_metric(space)),
        ("Source", escape(space.source)),
        ("Note", _prose(space.notes)),
    ]
    rows = "".join(f"<dt>{name}</dt><dd>{value}</dd>" for name, value in facts if value)
    links = "".join(
        f'<a href="#{_anchor(section)}">{section}</a>' for section in (*sections, "Checks")
    )
    title = escape(space.title[:1].upper() + space.title[1:])
    return (
        f'<header><p class="name">{escape(space.name)}</p><h1>{title}</h1>'
        f'<p class="story">{_prose(space.story)}</p><dl class="facts">{rows}</dl>'
        f"<nav>{links}</nav></header>"
    )


def _symbols(names: Sequence[str]) -> str:
    return mathml(", ".join(map(latex_name, names))) if names else ""


def _domain(relations: Sequence[Relational]) -> str:
    """Inequalities as markup; two bounds of one symbol stand together."""
    bounds: dict[sp.Expr, list[Relational]] = {}
    for relation in relations:
        symbol = relation.lhs if relation.lhs.is_Symbol else relation.rhs
        bounds.setdefault(symbol, []).append(relation)
    return ", ".join(mathml(_bounded(symbol, found)) for symbol, found in bounds.items())


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
    for title, found in verdicts.items():
        rows = "".join(_check(verdict) for verdict in found)
        table = f"<table><caption>{escape(title)}</caption>{rows}</table>"
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
    detail = escape(verdict.detail)
    if verdict.equation:
        detail = f"{mathml(equation_latex(verdict.equation))} <small>{detail}</small>"
    return (
        f'<tr><td class="{look}" title="{word}" aria-label="{word}">{sign}</td>'
        f"<td>{escape(verdict.name)}</td><td>{detail}</td></tr>"
    )


def _branches(space: Space) -> str:
    """How each root was read, if there are any."""
    branches = space.frame.field.branches
    if not branches:
        return ""
    items = "".join(
        f"<p>{expression_mathml(branch.radical)} is read as {expression_mathml(branch.read_as)}"
        f", right where {escape(greek_words(branch.condition))}.</p>"
        for branch in branches
    )
    return f'<h2 id="about-roots">Branches of roots</h2><section class="card">{items}</section>'


def _prose(text: str) -> str:
    """A sentence as HTML, with Greek letters for their names and indices and powers in place."""
    # Escaped first: what is put in afterwards is our own markup.
    lowered = re.sub(r"\b(\w)_(\w+)", r"\1<sub>\2</sub>", escape(greek_words(text)))
    return re.sub(r"\^(-?\w+)", r"<sup>\1</sup>", lowered)


def _footer() -> str:
    conventions = "; ".join(mathml(equation_latex(text)) for text in _CONVENTIONS)
    return (
        f"<footer><p>Conventions: {conventions}. A bar marks what belongs to the metric alone; "
        "numbers with a hat are frame vectors, counted from 1 (in the data from 0). Components "
        "that are not shown vanish: that is decided, not guessed.</p>"
        '<p>The same as data: <a href="geometry.json">geometry.json</a>. Made by geomtorsion.</p>'
        "</footer>"
    )


def _anchor(section: str) -> str:
    """The name of a section as it stands in links."""
    return "-".join(["about", *section.lower().replace("'", "").split()])
