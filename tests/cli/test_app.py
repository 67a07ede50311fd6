"""The commands together: their list, their help, and that none is loaded before it is called."""

import subprocess
import sys

import pytest

from geomtorsion.cli.app import Commands
from geomtorsion.cli.commands.exercises import ExerciseCommands
from tests.cli.running import run

GROUPS = {"": Commands, "exercises": ExerciseCommands}
COMMANDS = [(group, name) for group, commands in GROUPS.items() for name in commands.summaries]


def test_version_is_that_of_the_package():
    """--version says one line."""
    assert run("--version").stdout.startswith("geomtorsion ")


def test_help_lists_the_commands():
    """No command is missing from the overview."""
    assert len(COMMANDS) == 24
    for group, commands in GROUPS.items():
        text = run(*group.split(), "--help").stdout
        for name in commands.summaries:
            assert f"\n  {name} " in text


@pytest.mark.parametrize(("group", "name"), COMMANDS)
def test_every_command_explains_itself(group, name):
    """What the list says of a command is how its help begins; an example names it."""
    text = run(*group.split(), name, "--help").stdout
    _, first, *_ = text.split("\n\n")
    assert " ".join(first.split()) == GROUPS[group].summaries[name]
    assert " ".join(["geomtorsion", *group.split(), name]) in text
    assert "Example" in text


def test_a_wrong_name_is_refused():
    """With the right one."""
    error = run("geometri", "so3", code=2).stderr
    assert "No such command 'geometri'" in error
    assert "geometry" in error


def loaded(*arguments: str) -> set[str]:
    """Modules that `geomtorsion ARGUMENTS` loads in a process of its own."""
    code = (
        "import sys; from typer.testing import CliRunner; from geomtorsion.cli.app import app; "
        f"CliRunner().invoke(app, {arguments!r}); print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_help_loads_no_command():
    """The list of commands is shown without any of them, and without what they need."""
    found = loaded("--help")
    assert not {name for name in found if name.startswith("geomtorsion.cli.commands")}
    assert not found & {
        f"geomtorsion.{part}" for part in ("ode", "curves", "loops", "scenes", "pictures")
    }


def test_a_command_loads_what_it_needs():
    """The list of exercises needs no exercise, no frame and no engine."""
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
