"""exercises: text in lines that fit a terminal."""

from __future__ import annotations

import textwrap


def wrapped(text: str, taken: int = 0, width: int = 88) -> str:
    """Text in lines of a width; formulas that stand alone (indented) are left alone."""
    found = []
    for line in text.splitlines():
        if line.startswith("    ") or len(line) + taken <= width:
            found.append(line)
        else:
            found.append(textwrap.fill(" " * taken + line, width)[taken:])
        taken = 0
    return "\n".join(found)
