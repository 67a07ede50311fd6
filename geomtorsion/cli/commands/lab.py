"""lab: the page for the classroom, served or written."""

from __future__ import annotations

import webbrowser
from io import StringIO
from pathlib import Path
from typing import Annotated

import typer

from geomtorsion.cli.options import ChapterFolder, Language, option
from geomtorsion.cli.terminal import shows_greek, working
from geomtorsion.errors import UnknownNameError
from geomtorsion.support import checks
from geomtorsion.teaching.lab.address import Address
from geomtorsion.teaching.lab.export import write_pages
from geomtorsion.teaching.lab.server import serve
from geomtorsion.teaching.texts import ENGLISH, languages


def qr_code(text: str) -> str:
    """A text as a QR code of half blocks; a hint where its package is missing."""
    try:
        # An extra.
        import segno
    except ImportError:
        return "(`pip install 'geomtorsion[lab]'` adds a QR code here.)"
    drawn = StringIO()
    segno.make(text, error="l").terminal(drawn, border=2, compact=True)
    return drawn.getvalue()


def lab(
    host: Annotated[
        str,
        typer.Option(
            metavar="HOST", help="Network interface; 0.0.0.0 serves other machines, with a code."
        ),
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(metavar="N", help="Port; 0 chooses a free one.")] = 2718,
    token: Annotated[
        str, option(metavar="TEXT", text="Access code; default: a random one if it is needed.")
    ] = "",
    sessions: Annotated[
        int, typer.Option(metavar="N", min=1, help="Largest number of open pages.")
    ] = 64,
    show: Annotated[
        bool, typer.Option("--open/--no-open", help="Open the page in a browser.")
    ] = False,
    export: Annotated[
        Path | None, option(metavar="DIR", text="Write pages that need no server, and exit.")
    ] = None,
    language: Language = ENGLISH,
    chapter: ChapterFolder = None,
) -> None:
    """Serve the classroom page: tetrads, loops, curves, tops and exercises in a browser.

    By default only this machine can open the page. With --host 0.0.0.0 every machine of the network
    can: the command prints the address, a short code and a QR code. The page loads nothing from the
    network. It needs the extra `lab`; --export needs only the extra `plots`.

    \b
    Examples:
      geomtorsion lab --open
      geomtorsion lab --host 0.0.0.0 --sessions 40
      geomtorsion lab --export pages
      geomtorsion lab --language de
      geomtorsion lab --chapter my_chapter
    """
    if export is not None:
        with working("lab") as progress:
            written = write_pages(export, progress, language, chapter)
        typer.echo(f"wrote {len(written)} pages; open {written[0]} first")
        return

    def ready(url: str) -> None:
        typer.echo(f"Torsion lab: {url}  (Ctrl-C ends it)")
        plain, _, code = url.partition("?access_token=")
        if code:
            typer.echo(f"Other machines: open {plain} and type the code {code}, or scan:")
            # The blocks of the code are signs that some terminals have not.
            if shows_greek():
                typer.echo(qr_code(url))
        if show:
            webbrowser.open(url)

    # Until Ctrl-C.
    # The address of a page names its language: a folder stays on the teacher's machine.
    chosen = checks.choice(language, languages(), "language", UnknownNameError)
    serve(Address(host, port, token), ready, sessions, chosen, chapter)
