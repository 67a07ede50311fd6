"""guard: errors become one clean message, an interruption becomes a quiet end."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import wraps
from io import TextIOWrapper
from typing import Any

import typer

WRONG_INPUT = 2
INTERRUPTED = 130


def guarded(command: Callable[..., Any]) -> Callable[..., Any]:
    """A command that ends with 2 on an error of this package and with 130 on Ctrl-C."""

    @wraps(command)
    def outer(*args: Any, **kwargs: Any) -> Any:
        from geomtorsion.errors import GeomtorsionError

        try:
            return command(*args, **kwargs)
        except GeomtorsionError as error:
            typer.echo(f"geomtorsion: {error}", err=True)
            raise typer.Exit(WRONG_INPUT) from None
        except OSError as error:
            if isinstance(error, BrokenPipeError):
                raise
            name = f": {error.filename}" if error.filename else ""
            typer.echo(f"geomtorsion: {error.strerror or error}{name}", err=True)
            raise typer.Exit(WRONG_INPUT) from None
        except KeyboardInterrupt:
            typer.echo("geomtorsion: stopped", err=True)
            raise typer.Exit(INTERRUPTED) from None

    return outer


def run() -> None:
    """Run the command line; Ctrl-C and a closed pipe end it without a traceback."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            # A name that the terminal cannot show becomes a question mark, not a traceback.
            stream.reconfigure(errors="replace")
    try:
        from geomtorsion.cli.app import app

        app()
    except KeyboardInterrupt:
        print("geomtorsion: stopped", file=sys.stderr)
        sys.exit(INTERRUPTED)
