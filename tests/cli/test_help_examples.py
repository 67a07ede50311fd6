"""Examples of help texts and pages: each is a valid command line; those without own files run."""

import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer

import geomtorsion as gt
from geomtorsion.cli.app import app
from geomtorsion.cli.lazy import typed_apart
from tests.cli.running import run
from tests.test_readme import COMMANDS

# Commands whose examples are computed in seconds; test_readme.py runs one of each other, and those
# that are on its pages.
QUICK = ("burgers", "curve", "exercises", "fit", "geometry", "plan", "scenes", "spaces")
# Files of a user, which only examples of other pages have.
FOREIGN = re.compile(r"\b(my-|my_|answers|loops\.json|sheets|moodle|nbgrader|export|grade)")


def commands(group: Any, context: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Names of all commands with their parsers, also inside of groups."""
    for word in group.list_commands(context):
        command = group.get_command(context, word)
        path = f"{name} {word}".strip()
        yield path, command
        if hasattr(command, "list_commands"):
            inner = command.make_context(word, [], parent=context, resilient_parsing=True)
            yield from commands(command, inner, path)


def all_commands() -> dict[str, Any]:
    """Name of each command -> its parser."""
    group: Any = typer.main.get_command(app)
    context = group.make_context("geomtorsion", [], resilient_parsing=True)
    return dict(commands(group, context))


def examples() -> dict[str, Any]:
    """Line of each example -> the command that it names."""
    table = all_commands()
    found = {}
    for command in table.values():
        text = (command.help or "").partition("Example")[2].replace("\\\n", " ")
        for line in re.findall(r"^ +geomtorsion (.*)$", text, re.MULTILINE):
            words = re.split(r" [|>] ", line)[0]
            name = max((x for x in table if f"{words} ".startswith(f"{x} ")), key=len)
            found[words] = name, table[name]
    return found


EXAMPLES = examples()


def test_examples_are_found() -> None:
    """More than a hundred lines, at least one for each command, each on a line of its own."""
    assert len(EXAMPLES) > 100
    assert {name for name, _ in EXAMPLES.values()} == set(all_commands())
    assert not [name for name, one in all_commands().items() if "\\b" in (one.help or "")]


@pytest.mark.parametrize("line", EXAMPLES)
def test_an_example_is_a_valid_command_line(line: str) -> None:
    """Its options exist, and its values are of their kinds."""
    name, command = EXAMPLES[line]
    words = shlex.split(line)[len(name.split()) :]
    if not hasattr(command, "list_commands"):
        assert command.make_context(name, words).info_name == name


ROOT = Path(__file__).parent.parent.parent
PAGES = (ROOT / "README.md", *sorted((ROOT / "examples").rglob("*.md")))


def page_lines(page: Path) -> list[str]:
    """Command lines of a page: in code blocks, and in text between backticks."""
    text = page.read_text("utf-8").replace("\\\n", " ")
    blocks = "".join(re.findall(r"^```.*?^```", text, re.MULTILINE | re.DOTALL))
    lines = re.findall(r"^(?:\$ |!\S+ -m )?geomtorsion +(.*)$", blocks, re.MULTILINE)
    return [*lines, *(" ".join(x.split()) for x in re.findall(r"`geomtorsion\s+([^`]+)`", text))]


LINES = sorted({line for page in PAGES for line in page_lines(page)})


@pytest.mark.parametrize("line", LINES)
def test_a_command_line_of_a_page_is_valid(line: str) -> None:
    """The command exists, its options exist, and their values are of their kinds."""
    assert len(LINES) > 100
    table = all_commands()
    words = shlex.split(re.split(r"\s[#|>]", line)[0])
    if words[0].startswith("-") or words[0] == "COMMAND":
        return
    name = " ".join(words[:2]) if " ".join(words[:2]) in table else words[0]
    rest = typed_apart(words[len(name.split()) :])
    assert name in table
    # Some sentences only name a command.
    if rest and not hasattr(table[name], "list_commands"):
        assert table[name].make_context(name, rest).info_name == name


@pytest.fixture
def tracks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The recorded motions that the examples of `fit` read, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    times = np.linspace(1, 6, 12)
    circle = gt.geodesic("s2", [1.0, 0.0], [0.01, 1.0], parameters={"R": 1})
    gt.solve(circle, times).to_pandas()[["t", "theta", "phi"]].assign(
        sigma_theta=1e-3, sigma_phi=1e-3
    ).to_csv("track.csv", index=False)
    orbit = gt.geodesic(
        "kerr", [0, 10, 1.2, 0], [1.2, 0, 0.012, 0.034], parameters={"M": 1.0, "a": 0.6}
    )
    gt.solve(orbit, 20 * times).to_pandas()[["t", "r", "phi"]].set_axis(
        ["tau", "r", "phi"], axis=1
    ).to_csv("orbit.csv", index=False)


RUNNING = [
    line
    for line, (name, _) in EXAMPLES.items()
    if name.split()[0] in QUICK
    and not FOREIGN.search(line)
    and f"geomtorsion {line}" not in COMMANDS
]


@pytest.mark.usefixtures("tracks")
@pytest.mark.parametrize("line", RUNNING)
def test_an_example_runs(line: str) -> None:
    """It ends without an error."""
    assert len(RUNNING) > 15
    assert run(*shlex.split(line)).stdout
