"""lazy: a group of commands, each imported when it is called.

The modules of the commands import their dependencies at the top; loading all of them would take
longer than `geomtorsion --help` takes.
"""

from __future__ import annotations

import gc
import re
import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from functools import partial
from importlib import import_module
from typing import Annotated, Any, ClassVar

import typer
from typer.core import TyperGroup
from typer.main import get_command

from geomtorsion.cli.exits import ExitCode, at_limits, clean_exits, exceeded
from geomtorsion.cli.interrupts import stop_at_once
from geomtorsion.errors import AllowanceError, ArgumentError
from geomtorsion.support import checks
from geomtorsion.support.checks import near_names
from geomtorsion.support.outgoing import plain_streams
from geomtorsion.support.typed_text import is_typed
from geomtorsion.support.workers import Bounds, work_within

# One minus, as before an option of one letter.
_MINUS = re.compile(r"-[^-]")
# typer has a copy of click of its own, older ones use click: contexts and commands are Any here.
# Plain help, and no traceback with the values of all variables.
SETTINGS: dict[str, Any] = {
    "add_completion": False,
    "rich_markup_mode": None,
    "pretty_exceptions_enable": False,
}

# What a context keeps: the arguments of the command line, and the interrupts that came.
_ARGUMENTS, _INTERRUPTS = "geomtorsion.arguments", "geomtorsion.interrupts"


def typed_apart(args: Sequence[str]) -> list[str]:
    """Arguments, with a blank before each line element that begins like an option, with a minus.

    Examples
    --------
    >>> typed_apart(["identify", "-dt^2 + dx^2", "-k", "legs"])
    ['identify', ' -dt^2 + dx^2', '-k', 'legs']
    """
    return [f" {one}" if _MINUS.match(one) and is_typed(one) else one for one in args]


class LazyGroup(TyperGroup):
    """A group that lists its commands from a table and imports the one that is called.

    module: module path of a command's function, with {} for its name.
    summaries: name of a command, and with _ for - of its function -> its line in the help.
    groups: title -> names of the commands that help lists below it.
    settings: name -> settings of its context, where they are not the usual ones.
    limited: names of commands that take limits of time and memory.
    """

    module: ClassVar[str]
    summaries: ClassVar[Mapping[str, str]]
    groups: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    settings: ClassVar[Mapping[str, dict[str, Any]]] = {}
    limited: ClassVar[frozenset[str]] = frozenset()

    def list_commands(self, ctx: Any) -> list[str]:
        """Names in the order of the table."""
        return list(self.summaries)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """The command of this name, imported now; None if there is none, nor one like it."""
        if cmd_name not in self.summaries:
            if near := near_names(cmd_name, self.summaries) or self._about(cmd_name):
                ctx.fail(f"No such command {cmd_name!r}. Did you mean {near!r}?")
            return None
        with _uncollected():
            name = cmd_name.replace("-", "_")
            target = getattr(import_module(self.module.format(name)), name)
        if isinstance(target, typer.Typer):
            return get_command(target)
        command = _command(target, self.settings.get(cmd_name))
        return _limited(command) if cmd_name in self.limited else command

    def _about(self, word: str) -> str:
        """The first command whose line in the help has a word, or an empty text."""
        stem = re.escape(word.lower().removesuffix("s"))
        texts = ((name, text.lower()) for name, text in self.summaries.items())
        return next((name for name, text in texts if re.search(rf"\b{stem}(s|es)?\b", text)), "")

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """The part of `--help` that lists the commands, group by group."""
        grouped = {name for names in self.groups.values() for name in names}
        others = tuple(name for name in self.summaries if name not in grouped)
        for title, names in {**self.groups, "Commands": others}.items():
            if names:
                with formatter.section(title):
                    formatter.write_dl([(name, self.summaries[name]) for name in names])

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """The arguments of the group; a wrong option of the group ends like any other error."""
        args = typed_apart(args)
        ctx.meta.setdefault(_ARGUMENTS, list(args))
        # Without arguments typer shows help and raises it as an error.
        with clean_exits() if args else nullcontext():
            arguments: list[str] = super().parse_args(ctx, args)
        return arguments

    def invoke(self, ctx: Any) -> Any:
        """Run the command that was named."""
        with plain_streams(), clean_exits() as interrupts:
            ctx.meta[_INTERRUPTS] = interrupts
            return super().invoke(ctx)


@contextmanager
def _uncollected() -> Iterator[None]:
    """Import without collecting garbage: modules keep almost all that they make."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


def _command(function: Callable[..., object], settings: dict[str, Any] | None) -> Any:
    """The command made from a function, with options and help from its signature."""
    single = typer.Typer(**SETTINGS)
    single.command(context_settings=settings)(function)
    return _spelled(get_command(single))


def _spelled(command: Any) -> Any:
    """A command whose options have all spellings that options of their kind have elsewhere."""
    for parameter in command.params:
        if "--set" in parameter.opts and "--parameters" not in parameter.opts:
            parameter.opts.append("--parameters")
    # An answer to an exercise may begin with -h, so that its command has no such option.
    spellings = {"-h": "--help"}
    if any("--format" in parameter.opts for parameter in command.params):
        spellings["--json"] = "--format=json"
    read = command.parse_args

    def parse_args(ctx: Any, args: list[str]) -> list[str]:
        own = args.index("--") if "--" in args else len(args)
        arguments: list[str] = read(ctx, [spellings.get(x, x) for x in args[:own]] + args[own:])
        return arguments

    command.parse_args = parse_args
    return command


def _limits(
    seconds: Annotated[
        float | None,
        typer.Option(metavar="S", show_default=False, help="End with an error after S seconds."),
    ] = None,
    megabytes: Annotated[
        float | None,
        typer.Option(
            metavar="MB", show_default=False, help="End with an error above MB megabytes of memory."
        ),
    ] = None,
) -> Bounds:
    """The options --seconds and --megabytes of a command."""
    return Bounds(
        None if seconds is None else checks.positive(seconds, "seconds", ArgumentError),
        None if megabytes is None else checks.positive(megabytes, "megabytes", ArgumentError),
    )


def _limited(command: Any) -> Any:
    """A command with the options of limits; with one of them a worker does its work."""
    options = _command(_limits, None).params
    command.params += options
    work = command.invoke

    def invoke(ctx: Any) -> Any:
        bounds = _limits(**{option.name: ctx.params.pop(option.name) for option in options})
        if bounds == Bounds():
            return work(ctx)
        if ctx.obj is None:
            raise typer.Exit(_by_worker(bounds, ctx.meta[_ARGUMENTS]))
        with at_limits(bounds, ctx.meta[_INTERRUPTS]):
            ctx.obj()
            return work(ctx)

    command.invoke = invoke
    return command


def _by_worker(bounds: Bounds, arguments: list[str]) -> int:
    """Exit code of a worker that runs the whole command line."""
    try:
        return work_within(bounds, partial(_run, arguments), ExitCode.wrong_input)
    except AllowanceError as error:
        raise exceeded(str(error)) from None


def _run(arguments: list[str], begun: Callable[[], None]) -> None:
    """Run a command line in a worker; begun: is called when the work of the command begins."""
    signal.signal(signal.SIGINT, stop_at_once)
    # By its name, since the commands import this file.
    import_module("geomtorsion.cli.app").app(arguments, obj=begun)
