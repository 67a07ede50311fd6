"""classroom: the page of exercises as a class sees it, with a wrong and a right answer."""

# pyright: reportMissingImports=false

from __future__ import annotations

from html import escape

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx.application import Sphinx

from geomtorsion.teaching.lab import guides, problems, views

NUMBER, QUESTION = "3.2", "christoffel"
ANSWERS = ("-cos(phi2)/sin(phi2)", "1/tan(phi2)")
STYLE = """
:host { display: block; background: var(--card); }
main { padding: 0.8rem 1rem 0.6rem; }
.lab [role="tablist"] { display: flex; gap: 0.2rem 1.2rem; border-bottom: 1px solid var(--line); }
.lab [role="tab"] { font: inherit; color: var(--soft); background: none; border: 0; }
.lab [role="tab"][aria-selected="true"] { color: var(--ink); box-shadow: 0 2px 0 var(--accent); }
.lab form { display: grid; gap: 0 1.6rem;
  grid-template-columns: repeat(auto-fit, minmax(min(15rem, 100%), 1fr)); }
.lab label { display: grid; gap: 0.1rem; color: var(--soft); font-size: 0.9rem; }
.lab input { font-family: monospace; color: var(--ink); background: var(--card); width: 100%;
  border: 1px solid var(--soft); border-radius: 0.35rem; padding: 0.2rem 0.45rem; }
.lab form p button { font: inherit; color: var(--accent); background: var(--card);
  border: 1px solid var(--accent); border-radius: 0.35rem; padding: 0.25rem 0.9rem; }
"""


def picture() -> str:
    """The page as HTML that nobody can type into, with the statement and verdicts of the page.

    A shadow tree keeps its style sheet apart from the style sheet of the site.
    """
    style = views.style().replace(":root", ":host") + STYLE
    tabs = "".join(
        f'<button role="tab" aria-selected="{str(tab == guides.EXERCISES).lower()}">{tab}</button>'
        for tab in guides.TABS
    )
    stated = problems.statement(NUMBER)
    fields = []
    for answer in ANSWERS:
        field = f'<label>{QUESTION}<input type="text" value="{escape(answer)}"></label>'
        said = views.verdict(problems.answer(NUMBER, 0, {QUESTION: answer}))
        fields.append(f"<div>{field}<p><button>Check</button></p>{said}</div>")
    return (
        '<div class="classroom" role="img" inert aria-label="An exercise with two answers: the '
        'first is wrong, and the page names the mistake; the second is right.">'
        f'<template shadowrootmode="open"><style>{style}</style><main class="lab">'
        f'<h1>Torsion lab</h1><div role="tablist">{tabs}</div>{views.exercise(stated)}'
        f"<form>{''.join(fields)}</form></main></template></div>"
    )


class Classroom(Directive):
    """``{classroom}``: the picture."""

    def run(self) -> list[nodes.Node]:
        """One node of HTML."""
        return [nodes.raw("", picture(), format="html")]


def setup(app: Sphinx) -> dict[str, object]:
    """The directive."""
    app.add_directive("classroom", Classroom)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
