"""terminal: what standard output can show."""

from __future__ import annotations

import sys


def shows_greek() -> bool:
    """Whether Greek letters, bars and check marks can be written to standard output."""
    try:
        "Γ\u0304θ✓".encode(sys.stdout.encoding or "ascii")
    except (UnicodeEncodeError, LookupError):
        return False
    return True
