"""Spellings of options: the same words mean the same in every command."""

import json
from typing import Any

import pytest
import typer

from geomtorsion.cli.app import app
from tests.cli.running import run


def options() -> dict[str, set[str]]:
    """Name of each command -> its options."""
    group: Any = typer.main.get_command(app)
    context = group.make_context("geomtorsion", [], resilient_parsing=True)
    commands = {name: group.get_command(context, name) for name in group.list_commands(context)}
    return {
        name: {word for one in command.params for word in one.opts}
        for name, command in commands.items()
        if not hasattr(command, "list_commands")
    }


OPTIONS = options()


def test_one_spelling_for_values_formats_and_limits() -> None:
    """--set is --parameters, --format is of the printed result, --seconds comes with megabytes."""
    assert len(OPTIONS) > 25
    for name, words in OPTIONS.items():
        assert ("--set" in words) == ("--parameters" in words), name
        assert ("--seconds" in words) == ("--megabytes" in words), name
        assert "--json" not in words, name
        assert "--format" in words or "--picture-format" not in words, name


def test_each_option_occurs_once() -> None:
    """No command has two options of one spelling, in groups of commands as well."""
    group: Any = typer.main.get_command(app)
    context = group.make_context("geomtorsion", [], resilient_parsing=True)
    commands = [group.get_command(context, name) for name in group.list_commands(context)]
    inner = [one for one in commands if hasattr(one, "list_commands")]
    assert inner
    for one in inner:
        commands += [one.get_command(context, name) for name in one.list_commands(context)]
    for command in commands:
        words = [word for parameter in command.params for word in parameter.opts]
        assert len(words) == len(set(words)), command.name


LINES = [
    "fit s2 FILE --free theta --start 1,0 --velocity 0,1 --sigma 0.1",
    "curve s2 --t 1 --parameters R=2",
    "price s2 --t 1 --parameters R=1 --proofs none --accuracies 1e-3 --engines rungekutta",
    "run dzhanibekov --t 1",
    "ringing schwarzschild --parameters M=1 -L -X/2 -l 0",
    "burgers screw_dislocation --parameters b=1 --circle 0,0,0:1",
]


@pytest.mark.parametrize("line", LINES)
def test_json_is_all_that_is_printed(line: str, tmp_path) -> None:
    """--json prints one JSON document, as --format json does, and no other text."""
    file = tmp_path / "track.csv"
    file.write_text("t,theta\n0.5,1.05\n1,1.2\n")
    words = line.replace("FILE", str(file)).split()
    assert json.loads(run(*words, "--json").stdout)


@pytest.mark.parametrize("command", [*OPTIONS, "exercises", "exercises check"])
def test_h_is_help(command: str) -> None:
    """-h shows the help of every command."""
    assert run(*command.split(), "-h").stdout.startswith("Usage: geomtorsion")


def test_a_line_of_an_example_may_be_continued() -> None:
    """An example that does not fit in a line of the help ends in a backslash."""
    text = run("gravity", "-h").stdout
    assert '"Y = A_a A^a" \\\n' in text
    assert '        --maxwell "A(t), 0, 0, 0"' in text


REFUSALS = [
    ("fit s2 FILE --free theta --bounds theta=1", "Write M=0:2"),
    ("fit s2 FILE --free theta --loss square", "soft_l1"),
    ("fit s2 FILE --free theta", "Give sigma, or a column sigma_theta"),
]


@pytest.mark.parametrize(("line", "words"), REFUSALS)
def test_bad_options_of_a_fit_are_refused(line: str, words: str, tmp_path) -> None:
    """Bounds, losses and noise that cannot be read."""
    file = tmp_path / "track.csv"
    file.write_text("t,theta\n0.5,1.05\n1,1.2\n")
    done = run(*line.replace("FILE", str(file)).split(), code=2)
    assert words in done.stderr
