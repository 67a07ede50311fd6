"""The commands together: list, help, completion, style of errors, and lazy loading."""

import subprocess
import sys

import pytest
from typer.testing import CliRunner

from geomtorsion.cli.app import Commands, app
from geomtorsion.cli.commands.exercises import ExerciseCommands
from tests.cli.running import run

GROUPS = {"": Commands, "exercises": ExerciseCommands}
COMMANDS = [(group, name) for group, commands in GROUPS.items() for name in commands.summaries]


def test_version_of_the_package_is_printed():
    """--version prints the name of the package."""
    assert run("--version").stdout.startswith("geomtorsion ")


def test_help_lists_the_commands():
    """The overview lists all commands."""
    assert len(COMMANDS) == 40
    for group, commands in GROUPS.items():
        text = run(*group.split(), "--help").stdout
        for name in commands.summaries:
            assert f"\n  {name} " in text


@pytest.mark.parametrize(("group", "name"), COMMANDS)
def test_every_command_explains_itself(group, name):
    """The help begins with the summary of the list, and its example names the command."""
    text = run(*group.split(), name, "--help").stdout
    _, first, *_ = text.split("\n\n")
    assert " ".join(first.split()) == GROUPS[group].summaries[name]
    assert " ".join(["geomtorsion", *group.split(), name]) in text
    assert "Example" in text


def test_a_wrong_name_is_refused():
    """The message suggests the right name."""
    error = run("geometri", "so3", code=2).stderr
    assert "No such command 'geometri'. Did you mean 'geometry'?" in error
    # A subject is answered with the command whose line in the help names it.
    error = CliRunner().invoke(app, ["torsion"]).stderr
    assert "Did you mean 'geometry'?" in error
    assert "Did you mean" not in CliRunner().invoke(app, ["t"]).stderr
    # Quantities and spaces are arguments of a command.
    error = CliRunner().invoke(app, ["ricci", "kerr"]).stderr
    assert "Did you mean 'geometry SPACE --only ricci'?" in error
    assert "Did you mean 'geometry kerr'?" in CliRunner().invoke(app, ["kerr"]).stderr


def test_help_lists_the_commands_in_groups():
    """Each command is below exactly one title."""
    text = run("--help").stdout
    titles = [text.index(f"\n{title}:\n") for title in Commands.groups]
    assert titles == sorted(titles)
    assert "\nCommands:" not in text
    grouped = [name for names in Commands.groups.values() for name in names]
    assert sorted(grouped) == sorted(Commands.summaries)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [(["bogus"], "No such command 'bogus'"), (["--bogus"], "No such option"),
     (["curve"], "Missing argument"), (["curve", "so3", "--bogus"], "No such option"),
     (["curve", "so3", "--samples", "x"], "--samples: "),
     (["curve", "so3", "--picture-format", "gif"], "--picture-format: 'gif' is not one of"),
     (["exercises", "bogus"], "No such command"), (["curve", "bogus"], "'bogus'"),
     (["exercises", "show", "9.9"], "9.9"), (["burgers", "so3", "--circle", "3"], "--circle 3")],
)  # fmt: skip
def test_all_errors_have_one_style(arguments, words):
    """One line that begins with the program's name, code 2, an empty standard output."""
    done = run(*arguments, code=2)
    first, *rest = done.stderr.splitlines()
    assert first.startswith("geomtorsion: ")
    assert words in first
    assert all(line.startswith("(") for line in rest)
    assert not done.stdout


@pytest.mark.parametrize(
    "arguments",
    [["burgers", "screw_dislocation", "--circle", "1,0,0:2"],
     ["burgers", "screw_dislocation", "--circle", "1,0,0:2", "--proved"]],
)  # fmt: skip
def test_missing_values_name_the_option(arguments):
    """The message names the option, not the Python argument."""
    error = run(*arguments, code=2).stderr
    assert "--set b=1" in error
    assert "parameters=" not in error


def completed(*words: str) -> list[str]:
    """Completions that the shell offers for the last word."""
    line = " ".join(["geomtorsion", *words])
    asked = {"_GEOMTORSION_COMPLETE": "complete_bash", "COMP_WORDS": line}
    asked["COMP_CWORD"] = str(len(words))
    done = CliRunner().invoke(app, [], prog_name="geomtorsion", env=asked)
    return done.stdout.split()


@pytest.mark.parametrize(
    ("words", "offered"),
    [(["cur"], "curve"), (["curve", "so3_z"], "so3_zxz"), (["run", "dzh"], "dzhanibekov"),
     (["exercises", "show", "3."], "3.2"), (["curve", "--frame"], "--frame-velocity")],
)  # fmt: skip
def test_the_shell_completes(words, offered):
    """Commands, options, and names of spaces, scenes and exercises are completed."""
    found = completed(*words)
    assert offered in found
    assert all(name.startswith(words[-1]) for name in found)


def loaded(*arguments: str) -> set[str]:
    """Modules that `geomtorsion ARGUMENTS` loads in a process of its own."""
    code = (
        "import sys; from typer.testing import CliRunner; from geomtorsion.cli.app import app; "
        f"CliRunner().invoke(app, {arguments!r}); print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_help_loads_no_command():
    """The list of commands loads no command and no library that a command needs."""
    found = loaded("--help")
    assert not {name for name in found if name.startswith("geomtorsion.cli.commands")}
    assert not found & {
        f"geomtorsion.{part}" for part in ("ode", "curves", "loops", "scenes", "pictures")
    }


def test_a_command_loads_what_it_needs():
    """The list of exercises loads no exercise, no frame and no engine."""
    found = loaded("exercises")
    assert "geomtorsion.teaching.exercises.registry" in found
    assert not any(name.startswith("geomtorsion.teaching.exercises.frames") for name in found)
    assert not found & {
        "scipy",
        "heyoka",
        "geomtorsion.ode",
        "geomtorsion.curves",
        "geomtorsion.loops",
    }
    assert "geomtorsion.cli.commands.geometry" not in found
