"""exits: how a command ends: its codes, one message for an error, quiet after Ctrl-C."""

from __future__ import annotations

import re
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import IntEnum
from pathlib import Path
from typing import cast

import typer

from geomtorsion.cli.interrupts import INTERRUPTED, stop_at_once
from geomtorsion.errors import AllowanceError, GeomtorsionError
from geomtorsion.support.allowance import interrupted_work
from geomtorsion.support.checks import cut
from geomtorsion.support.workers import MEMORY, TIME, Bounds, limit_data, machine_memory

# Base of the errors for wrong options; typer brings its own click, and exports only this class.
UsageError = cast("type[typer.BadParameter]", typer.BadParameter.__bases__[0])
_INVALID = re.compile(r"^Invalid value for '([^']*)': ")
# Values that users gave, too long to be printed whole.
_LONG = re.compile(r"'([^']{200,})'")
# Words that no argument of a command takes.
_EXTRA = re.compile(r"Got unexpected extra arguments?(?:\(s\))? \((.*)\)")
# An entry of a matrix, as Python counts.
_ENTRY = re.compile(r"\b(coframe|frame|metric|signature|eta|spin_connection)\[(\d+), (\d+)\]")
_PARAMETERS = re.compile(r"parameters=\{([^{}]*)\}")
# In a checkout and in the source distribution; a wheel has no pages.
SITE = Path(__file__).parents[2] / "examples/site"


class ExitCode(IntEnum):
    """How a command ended.

    failed: the request was carried out, but a check, a loop, an answer or a motion in it failed.
    wrong_input: nothing was done. interrupted: 128 and the number of the signal, as in shells.
    """

    failed = 1
    wrong_input = 2
    interrupted = INTERRUPTED


class ExceededError(KeyboardInterrupt):
    """A limit ends the work of a command, which reports its finished part as on Ctrl-C."""


@contextmanager
def interruptible(came: list[KeyboardInterrupt]) -> Iterator[None]:
    """Raise KeyboardInterrupt on Ctrl-C within the block, so that resources are released.

    came: gets the exception, since C libraries may turn the interrupt into another error.
    """
    if signal.getsignal(signal.SIGINT) is not stop_at_once:
        yield
        return

    def interrupt(*_: object) -> None:
        came.append(KeyboardInterrupt())
        raise came[-1]

    signal.signal(signal.SIGINT, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, stop_at_once)


@contextmanager
def at_limits(bounds: Bounds, came: list[KeyboardInterrupt]) -> Iterator[None]:
    """Raise ExceededError within the block of a worker when its parent reports a limit.

    came: gets the exception, as on Ctrl-C.
    """
    limits = {TIME: f"{bounds.seconds:g} s" if bounds.seconds else "", MEMORY: ""}
    limits[MEMORY] = f"{bounds.megabytes:g} MB" if bounds.megabytes else ""

    def end(number: int, _: object) -> None:
        came.append(ExceededError(limits[number]))
        raise came[-1]

    for number in filter(None, limits):
        signal.signal(number, end)
    yield


@contextmanager
def clean_exits() -> Iterator[list[KeyboardInterrupt]]:
    """End with 2 on an error of this package or of a file, and with 130 on Ctrl-C.

    The block gets the list of the interrupts that came.
    """
    came: list[KeyboardInterrupt] = []
    # A damaged file that requests more causes an error, before the system ends other programs.
    if memory := machine_memory():
        limit_data(memory)
    try:
        with interruptible(came):
            yield came
    except typer.Exit:
        raise
    except KeyboardInterrupt as stop:
        raise stopped(stop) from None
    except Exception as error:
        if came:
            raise stopped(came[-1]) from None
        if isinstance(error, UsageError):
            typer.echo(f"geomtorsion: {wrong_usage(error)}", err=True)
            raise typer.Exit(ExitCode.wrong_input) from None
        if isinstance(error, GeomtorsionError):
            show_error(error)
            raise typer.Exit(ExitCode.wrong_input) from None
        if isinstance(error, MemoryError):
            typer.echo(
                "geomtorsion: the machine has too little memory for this. Request less, or check "
                "that the file is the intended one.",
                err=True,
            )
            raise typer.Exit(ExitCode.wrong_input) from None
        # `| head` closed the pipe: typer ends without a word.
        if isinstance(error, OSError) and not isinstance(error, BrokenPipeError):
            name = f": {cut(str(error.filename))}" if error.filename else ""
            typer.echo(f"geomtorsion: {error.strerror or error}{name}", err=True)
            raise typer.Exit(ExitCode.wrong_input) from None
        raise


def show_error(error: GeomtorsionError) -> None:
    """Print the message of an error, and the page that helps."""
    typer.echo(f"geomtorsion: {in_options(str(error))}", err=True)
    if pages := more_on(error):
        typer.echo(pages, err=True)


def wrong_usage(error: typer.BadParameter) -> str:
    """The error in the arguments of a command, and where its options are listed."""
    message = error.format_message().removeprefix("Invalid value: ")
    message = _INVALID.sub(r"\1: ", message).replace("Value error, ", "")
    message = _LONG.sub(lambda match: f"'{cut(match[1])}'", message)
    path = error.ctx.command_path if error.ctx else "geomtorsion"
    extra = _EXTRA.fullmatch(message)
    takes = error.ctx.command.params if error.ctx else []
    if extra and any("-L" in one.opts for one in takes):
        message = (
            f"expected a Lagrangian after -L, got {extra[1]} without it. Give -L '{extra[1]}'."
        )
    message = message if message.endswith((".", "?", ")")) else f"{message}."
    return f"{message}\n(Arguments and options: {path} --help)"


def in_options(message: str) -> str:
    """A message of the library in words of the command line: options, and counting from 1.

    Examples
    --------
    >>> in_options("parameters: expected a value for b, got none. Give parameters={'b': ...}.")
    'parameters: expected a value for b, got none. Give --set b=1.'
    >>> in_options("Name another file, or give overwrite=True.")
    'Name another file, or give --overwrite.'
    >>> in_options("coframe[1, 0]: this bracket is never closed")
    'coframe, row 2, column 1: this bracket is never closed'
    """
    message = message.replace("overwrite=True", "--overwrite")
    message = message.replace("conserved=[...]", "--conserved")
    message = _ENTRY.sub(
        lambda found: f"{found[1]}, row {int(found[2]) + 1}, column {int(found[3]) + 1}", message
    )
    return _PARAMETERS.sub(lambda found: _settings(found[1]), message)


def _settings(table: str) -> str:
    """A table of parameters in Python as options."""
    names = re.findall(r"['\"]?([^\W\d]\w*)['\"]?\s*:", table)
    return " ".join(f"--set {name}=1" for name in names if name != "name") or "--set NAME=VALUE"


def more_on(error: GeomtorsionError, site: Path = SITE) -> str:
    """Title and file of the page that helps; empty if the package was installed without the pages.

    Examples
    --------
    >>> more_on(GeomtorsionError("no"), Path("nowhere"))
    ''
    """
    page = site / f"{error.page}.md"
    if not page.is_file():
        return ""
    lines = page.read_text("utf-8").splitlines()
    title = next(line[2:] for line in lines if line.startswith("# "))
    return f'(More on this: "{title}", examples/site/{error.page}.md)'


@contextmanager
def resumable(left: Callable[[], str]) -> Iterator[None]:
    """End with 130 on Ctrl-C, and report which results exist.

    left: returns these results and how to resume, after a semicolon; or empty.
    """
    try:
        yield
    except KeyboardInterrupt as stop:
        raise stopped(stop, left()) from None


def stopped(stop: KeyboardInterrupt, more: str = "") -> typer.Exit:
    """Report that Ctrl-C or a limit ended the command; the exit that this leads to."""
    if isinstance(stop, ExceededError):
        quantity, place = interrupted_work(stop.__traceback__, functions=False)
        show_error(exceeded(f"{quantity} takes more than {stop}{place}{more}"))
        return typer.Exit(ExitCode.wrong_input)
    typer.echo(f"geomtorsion: stopped{more}", err=True)
    return typer.Exit(ExitCode.interrupted)


def exceeded(message: str) -> AllowanceError:
    """The error about a limit of a command, with the options that set it."""
    return AllowanceError(f"{message}. Give larger --seconds or --megabytes, or request less")
