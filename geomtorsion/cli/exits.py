"""exits: how a command ends: its codes, one message for an error, quiet after Ctrl-C."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import typer

from geomtorsion.errors import GeomtorsionError

# What was asked for was done, but something in it failed: a check, a loop, an answer, a motion.
FAILED = 1
# Nothing was done, since the input is wrong.
WRONG_INPUT = 2
# 128 and the number of the signal, as shells have it.
INTERRUPTED = 130


@contextmanager
def clean_exits() -> Iterator[None]:
    """End with 2 on an error of this package or of a file, and with 130 on Ctrl-C."""
    try:
        yield
    except GeomtorsionError as error:
        typer.echo(f"geomtorsion: {error}", err=True)
        raise typer.Exit(WRONG_INPUT) from None
    except BrokenPipeError:
        raise
    except OSError as error:
        name = f": {error.filename}" if error.filename else ""
        typer.echo(f"geomtorsion: {error.strerror or error}{name}", err=True)
        raise typer.Exit(WRONG_INPUT) from None
    except KeyboardInterrupt:
        stopped()
        raise typer.Exit(INTERRUPTED) from None


def stopped(more: str = "") -> None:
    """Say that Ctrl-C ended the command."""
    typer.echo(f"geomtorsion: stopped{more}", err=True)
