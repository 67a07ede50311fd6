"""The teacher's guide is executed: its commands have the stated exit codes and outputs."""

from __future__ import annotations

import re
import shlex
from itertools import pairwise
from pathlib import Path

import pytest
from typer.testing import CliRunner

from geomtorsion.cli.app import app

GUIDE = Path(__file__).parents[3] / "examples" / "classroom.md"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
PARTS = re.split(r"^## ", GUIDE.read_text("utf-8"), flags=re.MULTILINE)[1:]
EXPECTED_COMMANDS = 20


def commands(block: str) -> list[tuple[list[str], int]]:
    """Each command with its exit code."""
    found = []
    for line in block.splitlines():
        text, _, remark = line.partition("  # ends with ")
        found.append((shlex.split(text), int(remark or 0)))
    return found


def test_there_is_enough_to_run():
    """The guide has at least 20 commands, and each of them is a geomtorsion command."""
    every = [
        one
        for part in PARTS
        for kind, text in BLOCK.findall(part)
        if kind == "sh"
        for one in commands(text)
    ]
    assert len(every) >= EXPECTED_COMMANDS
    assert all(words[0] == "geomtorsion" for words, _ in every)


def test_the_minutes_add_up():
    """The parts cover ninety minutes without a gap."""
    times = re.findall(r"^(\d+) to (\d+) minutes", "\n".join(PARTS), re.MULTILINE)
    assert times[0][0] == "0"
    assert times[-1][1] == "90"
    assert all(one[1] == two[0] for one, two in pairwise(times))


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.splitlines()[0])
def test_a_part_of_the_lesson(part, tmp_path, monkeypatch):
    """Files are written as shown, commands run in order, each shown line is printed."""
    monkeypatch.chdir(tmp_path)
    printed, shown = "", 0
    for kind, text in BLOCK.findall(part):
        if kind == "toml":
            file = Path(text.splitlines()[0].removeprefix("# "))
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, "utf-8")
        elif kind == "sh":
            printed = ""
            for words, code in commands(text):
                result = CliRunner().invoke(app, words[1:])
                assert result.exit_code == code, f"{shlex.join(words)}: {result.output}"
                printed += result.output
            assert printed.strip()
        elif kind == "text":
            shown += 1
            for line in text.splitlines():
                assert " ".join(line.split()) in " ".join(printed.split())
    assert shown == part.count("```text")
