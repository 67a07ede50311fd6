"""Tasks: exercises in variants, and refused requests."""

import pytest

from geomtorsion import exercises
from geomtorsion.errors import ArgumentError, UnknownNameError
from geomtorsion.teaching.exercises.exports.tasks import tasks


def test_all_exercises():
    """Without numbers, all exercises are taken in order; their folders have different names."""
    found = tasks(None, [0])
    assert [task.number for task in found] == list(exercises.names())
    assert len({task.slug for task in found}) == len(found)
    assert found[0].chapter == "1. Frames and anholonomy"


@pytest.mark.parametrize(
    ("numbers", "seeds", "error", "words"),
    [
        (["9.9"], [0], UnknownNameError, "the number of an exercise, .* got '9.9'"),
        (
            ["3.2"],
            [-1],
            UnknownNameError,
            r"seed \(which variant\): expected a whole number from 0",
        ),
        (
            ["3.2"],
            ["x"],
            UnknownNameError,
            r"seed \(which variant\): expected a whole number from 0",
        ),
        (["3.2"], [], ArgumentError, r"seeds: expected at least one, and none twice, got \[\]"),
        (
            ["3.2"],
            [1, 1],
            ArgumentError,
            r"seeds: expected at least one, and none twice, got \[1, 1\]",
        ),
        ([], [0], ArgumentError, r"numbers: expected at least one, and none twice, got \[\]"),
        ("3.2", [0], ArgumentError, "numbers: expected a list, got "),
        (["3.2", "3.2"], [0], ArgumentError, "numbers: expected at least one, and none twice"),
    ],
)
def test_invalid_requests_are_refused(numbers, seeds, error, words):
    """Unknown, repeated and missing numbers or seeds are refused."""
    with pytest.raises(error, match=words):
        tasks(numbers, seeds)
