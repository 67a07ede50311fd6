"""Tests that hold on any machine: tolerances, interrupts, addresses and counts of work."""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path

import pytest

from tests.rounding import tight_tolerances
from tests.test_doctests import MODULES, doctests

TESTS = Path(__file__).parent
FILES = sorted(path for path in TESTS.rglob("*.py") if "benchmarks" not in path.parts)
# Tolerances below a hundred roundings, each with its reason.
EXACT: dict[str, str] = {
    "scenes/brute.py": "tolerances of a solver",
    "spaces/test_rotations.py": "both sides have twenty digits",
}
# Counts of what a solver did: another processor needs another number.
WORK = re.compile(r"\b\d+ (solves|evaluations|iterations|rounds|steps of the engine)\b")


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(TESTS).as_posix())
def test_tolerances_are_a_hundred_roundings(path: Path):
    """No test compares doubles to a written tolerance of less than a hundred roundings."""
    if path.relative_to(TESTS).as_posix() not in EXACT:
        lines = sorted(set(tight_tolerances(ast.parse(path.read_text("utf-8")))))
        assert not lines, "multiply tests.rounding.ROUNDED by the largest intermediate value"


def test_exceptions_are_needed():
    """Each listed exception has a tight tolerance."""
    for name in EXACT:
        assert list(tight_tolerances(ast.parse((TESTS / name).read_text("utf-8")))), name


def test_interrupted_processes_can_be_interrupted():
    """A file that sends SIGINT starts its processes with the default effect of SIGINT."""
    texts = {path.name: path.read_text("utf-8") for path in FILES if path != Path(__file__)}
    senders = {name: text for name, text in texts.items() if "send_signal(signal.SIGINT" in text}
    assert len(senders) > 4
    assert not [name for name, text in senders.items() if "subprocess.Popen(" in text]


def test_pages_are_served():
    """No test opens a page from a file: browsers treat each file as an origin of its own."""
    opened = re.compile(r"goto\([^\n]*as_uri")
    assert not [path.name for path in FILES if opened.search(path.read_text("utf-8"))]


def test_examples_show_no_counts_of_work():
    """No docstring, page or golden value shows how many solves or evaluations were needed."""
    shown = {
        f"{name}: {example.source}": example.want
        for name in MODULES
        for test in doctests(name)
        for example in test.examples
    }
    examples = TESTS.parent / "examples"
    written = [path for path in examples.rglob("*.md") if "pages" not in path.parts]
    assert len(written) > 40
    shown |= {str(path): path.read_text("utf-8") for path in [TESTS.parent / "README.md", *written]}
    golden = json.loads((TESTS / "golden" / "values.json").read_text("utf-8"))
    shown |= {f"golden {key}": json.dumps(value) for key, value in golden.items()}
    assert not [name for name, text in shown.items() if WORK.search(text)]
    assert WORK.search("chi^2 = 4.5 of 5 degrees of freedom (chance 0.48), 7 solves")
