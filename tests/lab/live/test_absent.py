"""Absent: what stands where numpy would may be named, and is never taken for a value."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from geomtorsion.errors import MissingExtraError
from geomtorsion.exercises import names
from geomtorsion.lab.live.absent import Absent
from geomtorsion.lab.live.guides import UNGRADED

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize(
    "use",
    [bool, float, int, complex, str, len, iter, list, lambda x: x == 0, lambda x: x < 1,
     lambda x: f"{x}", lambda x: 1 in x, round, lambda x: {"a": x, "b": float(x)},
     lambda x: [0, 1][x], lambda x: x.__setitem__(0, 1), lambda x: x.__enter__()],
)  # fmt: skip
def test_no_value_comes_of_it(use: Callable[[Absent], object]):
    """Whoever wants to know what is there is told that nothing is, and what to do."""
    value = (2 * Absent("numpy").linspace(0, 1, 3) ** 2 - 1)[0].T
    with pytest.raises(MissingExtraError, match="this needs numpy .*geomtorsion lab"):
        use(value)


def test_types_may_be_mentioned():
    """Annotations, unions and bases of classes are made at import, and nothing is an instance."""
    # For a checker of types it is what it stands for.
    absent: Any = Absent("numpy")
    assert not isinstance(1.0, absent.ndarray)
    assert not issubclass(float, absent.floating)
    assert (int | absent.ndarray) is not None

    class Moment(absent.generic, dict):
        """A class over a type that is not there."""

    assert Moment.__mro__[1] is dict


SCRIPT = """
from geomtorsion.lab.live.absent import stand_in
stand_in(("numpy", "scipy", "networkx", "typer", "marimo", "matplotlib", "rich"))
import json, sys
from geomtorsion.lab.live.browser import answer
from geomtorsion.lab.live.tabs import TASKS
for tab in TASKS:
    reply = json.loads(answer(json.dumps({"tab": tab, "values": {}})))
    assert "problem" not in reply and "notice" not in reply["parts"]["result"], (tab, reply)
assert type(sys.modules["numpy"]).__name__ == "_AbsentModule"
from geomtorsion import exercises
from geomtorsion.errors import MissingExtraError
from geomtorsion.lab.tasks import answer as task
graded, told = [], []
for number in exercises.names():
    stated = task({"task": "exercise", "arguments": {"number": number}})
    if "problem" in stated:
        told.append(stated["problem"])
        continue
    exercise = exercises.load(number)
    try:
        right = exercise.check(exercise.answers())
    except MissingExtraError as error:
        told.append(str(error))
        continue
    wrong = exercise.check({question.name: "7" for question in exercise.questions})
    assert right.right and not wrong.right, number
    graded.append(number)
assert all("this needs numpy" in text for text in told), told
print(*graded)
"""


def test_what_is_exact_needs_no_numpy():
    """All tabs, and the exercises that need no numbers of motions or loops, without numpy."""
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        cwd=ROOT, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    graded = done.stdout.split()
    assert {"1.1", "2.1", "3.2", "4.3", "5.1", "6.1", "6.4"} <= set(graded)
    assert sorted({*graded, *UNGRADED}) == sorted(names())
    assert not set(graded) & set(UNGRADED)
