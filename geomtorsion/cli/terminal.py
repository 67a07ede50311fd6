"""terminal: what it can show, lines that fit, and the step that is being computed."""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Callable, Iterator
from contextlib import contextmanager

WIDTH = 88


def shows_greek() -> bool:
    """Whether Greek letters, bars and check marks can be written to standard output."""
    try:
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
    """Show a line that says what is being computed; call the result with each new step."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    # rich takes a tenth of a second to load, and is used only where somebody watches.
    from rich.console import Console

    with Console(stderr=True).status(f"{what}: reading (Ctrl-C stops)") as status:
        yield lambda step: status.update(f"{what}: {step} (Ctrl-C stops)")
