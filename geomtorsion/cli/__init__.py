"""cli: the command line."""

import io
import os
import sys

from geomtorsion.cli.interrupts import INTERRUPTED, stop_quietly


def main() -> None:
    """Entry point of the command ``geomtorsion``."""
    stop_quietly()
    # Loaded here: the package loads this file before all others, to be ready for Ctrl-C.
    from multiprocessing import active_children

    # As above.
    from geomtorsion.cli.app import app

    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # A name that the terminal cannot show becomes a question mark, not a traceback.
            stream.reconfigure(errors="replace")
    try:
        app()
    except SystemExit as end:
        if end.code == INTERRUPTED and not active_children():
            # Exits at once: interrupted code would print more when Python tidies up.
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(INTERRUPTED)
        raise


__all__ = ["main"]
