"""terminal: what it can show, lines and rows that fit, and the step that is being computed."""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager

import numpy as np

from geomtorsion.support.outgoing import moving
from geomtorsion.support.progress import somebody_watches

WIDTH = 88


def shows_greek() -> bool:
    """Whether Greek letters, bars and check marks can be written to standard output."""
    try:
        # A bar above a letter, a Greek letter and a check mark: what the tables use.
        "Γ\u0304θ✓".encode(sys.stdout.encoding or "ascii")
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def wrapped(text: str, taken: int = 0) -> str:
    """Text in lines that fit, the first after so many columns; formulas (indented) stay."""
    lines = []
    for line in text.splitlines():
        if line.startswith("    ") or len(line) + taken <= WIDTH:
            lines.append(line)
        else:
            lines.append(textwrap.fill(" " * taken + line, WIDTH)[taken:])
        taken = 0
    return "\n".join(lines)


@contextmanager
def working(what: str) -> Iterator[Callable[[str], object]]:
    """Show a line that names the current step; call the result with each new step."""
    if not somebody_watches():
        yield lambda _: None
        return
    # rich takes a tenth of a second to load, and is used only on a terminal.
    from rich.console import Console

    with Console(file=moving(sys.stderr)).status(f"{what}: reading (Ctrl-C stops)") as status:
        yield lambda step: status.update(f"{what}: {step} (Ctrl-C stops)")


# Rows of a table that fit on a terminal with the text around them.
ROWS = 9


def some_rows(count: int) -> list[int]:
    """Numbers of the shown rows, evenly spread from the first to the last.

    Examples
    --------
    >>> some_rows(401)
    [0, 50, 100, 150, 200, 250, 300, 350, 400]
    >>> some_rows(3)
    [0, 1, 2]
    """
    shown = np.linspace(0, count - 1, min(ROWS, count))
    return np.unique(shown.round().astype(int)).tolist()


def right_aligned(cells: Iterable[str], width: int) -> str:
    """Cells of one width in a line."""
    return "".join(cell.rjust(width) for cell in cells)
