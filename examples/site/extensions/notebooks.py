"""notebooks: each tutorial is also a Jupyter notebook, and its page has a link to it.

The notebook has the text and the cells of the page without their outputs. Links to other pages
become their text, because a downloaded notebook has no pages beside it.
"""

# pyright: reportMissingImports=false

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

FOLDER = "tutorials/"
# A fenced cell with its options, such as `:tags: [hide-cell]`, and its code.
CELL = re.compile(
    r"^```\{code-cell\}[^\n]*\n((?::\w+:[^\n]*\n)*)(.*?)^```\n", re.MULTILINE | re.DOTALL
)
FRONT = re.compile(r"\A---\n.*?^---\n", re.MULTILINE | re.DOTALL)
# [text](page.md#place), but not [text](https://...).
LOCAL = re.compile(r"\[([^\]]+)\]\((?![a-z]+://)[^)]+\)")
HIDDEN = {"hide-cell", "remove-input", "hide-input"}


def notebook(page: str) -> dict[str, Any]:
    """A page in MyST Markdown as a notebook, format 4.4.

    Examples
    --------
    >>> made = notebook("# Sum\\n\\nSee [one](one.md).\\n\\n```{code-cell}\\n1 + 1\\n```\\n")
    >>> [cell["source"] for cell in made["cells"]]
    ['# Sum\\n\\nSee one.', '1 + 1']
    """
    text = FRONT.sub("", page)
    cells: list[dict[str, Any]] = []
    end = 0
    for found in CELL.finditer(text):
        cells += _text(text[end : found.start()])
        tags = re.findall(r"[\w-]+", found[1].partition(":tags:")[2])
        metadata: dict[str, Any] = {"tags": tags} if tags else {}
        if HIDDEN & set(tags):
            metadata["jupyter"] = {"source_hidden": True}
        cells.append(
            {
                "cell_type": "code",
                "execution_count": None,
                "metadata": metadata,
                "outputs": [],
                "source": found[2].rstrip("\n"),
            }
        )
        end = found.end()
    cells += _text(text[end:])
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    metadata = {"kernelspec": kernel, "language_info": {"name": "python"}}
    return {"cells": cells, "metadata": metadata, "nbformat": 4, "nbformat_minor": 4}


def _text(text: str) -> list[dict[str, Any]]:
    """A cell of text, or none where there is no text."""
    source = LOCAL.sub(r"\1", text).strip("\n")
    return [{"cell_type": "markdown", "metadata": {}, "source": source}] if source else []


def _link(app, pagename: str, templatename: str, context: dict, doctree) -> None:
    """A link below the title of each tutorial."""
    if pagename.startswith(FOLDER) and "body" in context:
        name = f"{pagename.removeprefix(FOLDER)}.ipynb"
        link = f'<p><a href="{name}" download="{name}">Download this page as a notebook</a></p>'
        context["body"] = context["body"].replace("</h1>", f"</h1>\n{link}", 1)


def _write(app, error) -> None:
    if error is not None or app.builder.format != "html":
        return
    for page in sorted((Path(app.srcdir) / FOLDER).glob("*.md")):
        made = json.dumps(notebook(page.read_text("utf-8")), indent=1, ensure_ascii=False)
        (Path(app.outdir) / FOLDER / f"{page.stem}.ipynb").write_text(f"{made}\n", "utf-8")


def setup(app) -> dict[str, bool]:
    """Write the notebooks when the pages are written, before links are checked."""
    app.connect("html-page-context", _link)
    app.connect("build-finished", _write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
