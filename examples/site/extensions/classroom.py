"""classroom: the page of exercises as a class sees it, with a wrong and a right answer."""

# pyright: reportMissingImports=false

from __future__ import annotations

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx.application import Sphinx

from geomtorsion.lab import exercise_controls, problems, views
from geomtorsion.lab.kept import Kept
from geomtorsion.lab.live.folder import script
from geomtorsion.lab.live.toolkit import Form

NUMBER, QUESTION = "3.2", "christoffel"
ANSWERS = ("-cos(phi2)/sin(phi2)", "1/tan(phi2)")


def picture() -> str:
    """The page as HTML that nobody can type into, made by what makes the page itself.

    It stands in a shadow tree, so that its style sheet and that of the site leave each other alone.
    """
    style = f"{views.style()}{script('live.css')}".replace(":root", ":host")
    style += (
        ":host { display: block; background: var(--card); } main { padding: 0.8rem 1rem 0.6rem; }"
        ".lab form { display: grid; gap: 0 1.6rem;"
        " grid-template-columns: repeat(auto-fit, minmax(min(15rem, 100%), 1fr)); }"
    )
    tabs = "".join(
        f'<button role="tab" aria-selected="{str(tab == views.EXERCISES).lower()}">{tab}</button>'
        for tab in views.TABS
    )
    stated = problems.statement(NUMBER)
    fields = []
    for answer in ANSWERS:
        field = exercise_controls.answers(Form({"q0": answer}), stated, Kept())
        said = views.verdict(problems.answer(NUMBER, 0, {QUESTION: answer}))
        fields.append(f"<div>{field}<p><button>Check</button></p>{said}</div>")
    return (
        '<div class="classroom" role="img" inert aria-label="An exercise with two answers: the '
        'first is wrong, and what is wrong with it is said; the second is right.">'
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
