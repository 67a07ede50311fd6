"""formulas: LaTeX becomes MathML while the site is built, set in the font that reports use."""

# pyright: reportMissingImports=false
# Sphinx comes with the extra `docs`, which checking types does not need.

from __future__ import annotations

import re
from pathlib import Path

from docutils import nodes
from docutils.nodes import SkipNode
from sphinx.util import logging

from geomtorsion.errors import ExpressionError
from geomtorsion.pictures.formula import font_face, mathml

_STOP = re.compile(r"[.,;:?)]+")
_LOG = logging.getLogger(__name__)


def _element(node, *, display: bool) -> str:
    try:
        return mathml(node.astext(), display=display)
    except ExpressionError as error:
        _LOG.warning("%s", error, location=node)
        return ""


def _inline(visitor, node) -> None:
    element, stop = _element(node, display=False), node.get("stop", "")
    visitor.body.append(f'<span class="together">{element}{stop}</span>' if stop else element)
    raise SkipNode


def _keep_stops(app, doctree, name) -> None:
    """Give formulas the comma or full stop after them: browsers would begin a line with it."""
    for node in doctree.findall(nodes.math):
        after = node.next_node(siblings=True, descend=False)
        if isinstance(after, nodes.Text) and (found := _STOP.match(after)):
            node["stop"] = found[0]
            node.parent.replace(after, nodes.Text(after[found.end() :]))


def _block(visitor, node) -> None:
    visitor.body.append(f'<div class="formula">{_element(node, display=True)}</div>')
    raise SkipNode


def _write_font(app, error) -> None:
    """The font of formulas, once for all pages."""
    if error is None and app.builder.format == "html":
        folder = Path(app.outdir) / "_static"
        folder.mkdir(exist_ok=True)
        (folder / "formulas.css").write_text(font_face(), "utf-8")


def setup(app) -> dict[str, bool]:
    """Register the renderer, and the style that holds the font."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    app.connect("doctree-resolved", _keep_stops)
    app.connect("build-finished", _write_font)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
