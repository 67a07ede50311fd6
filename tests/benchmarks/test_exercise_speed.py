"""Speed of the grader: right answers in forms at which known graders fail.

The goal is 50 ms for each answer; the table shows the total time of all answers of a name.
"""

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from geomtorsion.teaching.exercises.checking import check_question
from tests.teaching.exercises.hard_answers import HARD


@pytest.mark.parametrize("name", HARD)
def test_hard_answers(benchmark: BenchmarkFixture, name: str) -> None:
    """Time of all right answers to one solution that has been computed before; best of ten runs."""
    question = HARD[name].question()
    answers = HARD[name].right
    assert all(check_question(question, answer).right for answer in answers)
    benchmark.pedantic(
        lambda: [check_question(question, answer) for answer in answers], rounds=10, iterations=1
    )
