"""cli: what a person types."""

import sys
from io import TextIOWrapper

from geomtorsion.cli.app import app


def main() -> None:
    """Entry point of the command ``geomtorsion``."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            # A name that the terminal cannot show becomes a question mark, not a traceback.
            stream.reconfigure(errors="replace")
    app()


__all__ = ["main"]
