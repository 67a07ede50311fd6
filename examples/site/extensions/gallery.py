"""gallery: every example is run; its page has what it prints, its picture and its code.

Pages are written into gallery/pages before Sphinx reads them; the directive `gallery` shows a small
figure of each. `drawings.py` draws for examples that only print.
"""

# pyright: reportMissingImports=false

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from html import escape
from pathlib import Path
from textwrap import wrap

from docutils import nodes
from drawings import DRAWINGS
from sources import MADE, ROOT, digest, scripts
from sphinx.errors import SphinxError
from sphinx.util.docutils import SphinxDirective

EXAMPLES = ROOT / "examples"
# Options by which examples draw, and the kind of their argument: a file or a folder.
DRAWING = {"--picture": "file", "--map": "file", "--pictures": "folder"}
# Letters of a line of a card, and the size of its text.
CARD = (26, 22)
LONGEST_RUN = 300


@dataclass(frozen=True)
class Example:
    """One example: its file and its docstring."""

    path: Path

    @property
    def name(self) -> str:
        """Name of its page; scenes have a prefix."""
        return ("scene_" if self.path.parent.name == "scenes" else "") + self.path.stem

    @property
    def code(self) -> str:
        """The whole file."""
        return self.path.read_text("utf-8")

    @property
    def title(self) -> str:
        """The first line of the docstring, up to the first colon or stop."""
        return re.split(r"[:.]", self._docstring[0], maxsplit=1)[0]

    @property
    def _docstring(self) -> list[str]:
        return (ast.get_docstring(ast.parse(self.code)) or "").split("\n")

    @property
    def subtitle(self) -> str:
        """The rest of the first line, after the title."""
        return self._docstring[0][len(self.title) :].lstrip(":. ")

    @property
    def text(self) -> str:
        """The docstring without its first line; commands as code."""
        shown: list[str] = []
        for part in "\n".join(self._docstring[1:]).strip().split("\n\n"):
            if "python examples" in part:
                lines = "\n".join(line.strip() for line in part.split("\n"))
                shown.append(f"```sh\n{lines}\n```")
            else:
                shown.append(part)
        return "\n\n".join(shown)


def examples() -> list[Example]:
    """All of them, the numbered ones first."""
    found = [*sorted(EXAMPLES.glob("*.py")), *sorted((EXAMPLES / "scenes").glob("*.py"))]
    return [Example(path) for path in found]


def run(example: Example, folder: Path) -> None:
    """Run one, and write its page and its picture."""
    option = next((one for one in DRAWING if f'"{one}"' in example.code), "")
    picture = folder / f"{example.name}.png"
    arguments: list[str] = []
    if option:
        made = picture if DRAWING[option] == "file" else folder / example.name
        arguments = [option, str(made)]
    printed = _python([str(example.path), *arguments])
    if option and DRAWING[option] == "folder":
        next(iter(sorted((folder / example.name).glob("*.png")))).replace(picture)
    # The shipped scene of an example, which compares it with the known answer, or a drawing.
    drawn = _scene(example) or (example.name if example.name in DRAWINGS else "")
    if not option and drawn:
        _python([str(Path(__file__).with_name("drawings.py")), drawn, str(picture)])
    if not picture.is_file():
        picture = picture.with_suffix(".svg")
        picture.write_text(card(example.title), "utf-8")
    body = re.sub(r"^.*(wrote|Wrote) .*\n?", "", printed, flags=re.MULTILINE)
    drawn = f"![What it draws]({picture.name})\n\n" if picture.suffix == ".png" else ""
    place = Path(os.path.relpath(example.path, folder)).as_posix()
    (folder / f"{example.name}.md").write_text(
        f"# {example.title}\n\n*{example.subtitle}*\n\n{example.text}\n\n{drawn}"
        f"## What it prints\n\n```text\n{body.rstrip()}\n```\n\n"
        f"## The code\n\n```{{literalinclude}} {place}\n```\n",
        "utf-8",
    )


def _scene(example: Example) -> str:
    """The shipped scene that an example builds and compares with, if it is one."""
    if example.path.parent.name != "scenes":
        return ""
    from geomtorsion import scenes  # slow to load, and only scenes need it

    known = scenes.names()
    stem = example.path.stem
    return stem if stem in known else next(one for one in known if f'"{one}"' in example.code)


def _python(arguments: list[str]) -> str:
    done = subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        text=True,
        timeout=LONGEST_RUN,
        check=False,
        env=os.environ | {"MPLBACKEND": "agg"},
    )
    if done.returncode:
        raise SphinxError(f"{arguments[0]} failed:\n{done.stderr}")
    return done.stdout


def card(title: str) -> str:
    """The whole title of an example as a figure."""
    width, size = CARD
    rows = "".join(
        f'<text x="20" y="{(k + 2) * size * 1.4:.0f}">{escape(line)}</text>'
        for k, line in enumerate(wrap(title, width))
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 360 225" font-size="{size}" '
        'font-family="sans-serif" fill="#333"><rect width="360" height="225" fill="#f6f6f6"/>'
        f"{rows}</svg>"
    )


class Gallery(SphinxDirective):
    """`{gallery} examples` or `{gallery} scenes`: small pictures that lead to the pages."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """One link each, in order."""
        wanted = self.arguments[0] == "scenes"
        links = "".join(
            f'<a class="card" href="pages/{one.name}.html">'
            f'<img src="../_images/{_picture(one)}" alt="" loading="lazy">'
            f"<b>{escape(one.title)}</b><span>{escape(one.subtitle)}</span></a>"
            for one in examples()
            if (one.path.parent.name == "scenes") is wanted
        )
        return [nodes.raw("", f'<div class="gallery">{links}</div>', format="html")]


def _picture(example: Example) -> str:
    pages = MADE
    return next(
        one.name for one in pages.glob(f"{example.name}.*") if one.suffix in (".png", ".svg")
    )


def _write_pages(app) -> None:
    MADE.mkdir(exist_ok=True)
    package = digest(scripts())
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(partial(_kept, package=package), examples()))


def _kept(example: Example, package: str) -> None:
    """Run it, unless that was done with the same package."""
    stamp = MADE / f"{example.name}.txt"
    if not stamp.is_file() or stamp.read_text("utf-8") != package:
        run(example, MADE)
        stamp.write_text(package, "utf-8")
        place = examples().index(example) + 1
        print(f"example {place} of {len(examples())}: {example.name}", flush=True)


def _copy_pictures(app, error) -> None:
    """Copy the pictures of the index, which no page refers to."""
    if error is None and app.builder.format == "html":
        target = Path(app.outdir) / "_images"
        target.mkdir(exist_ok=True)
        for example in examples():
            name = _picture(example)
            (target / name).write_bytes((MADE / name).read_bytes())


def setup(app) -> dict[str, bool]:
    """Run the examples before pages are read."""
    app.add_directive("gallery", Gallery)
    app.connect("builder-inited", _write_pages)
    app.connect("build-finished", _copy_pictures)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
