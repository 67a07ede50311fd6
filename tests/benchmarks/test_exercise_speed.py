"""Speed of the grader: right answers in forms at which known graders fail, each under 50 ms."""

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from geomtorsion.exercises.checking import check_question
from tests.exercises.hard_answers import HARD

SECONDS = 0.05


@pytest.mark.parametrize("name", HARD)
def test_hard_answers(benchmark: BenchmarkFixture, name: str) -> None:
    """All right answers to one solution, which has been solved before; the best of ten rounds."""
    question = HARD[name].question()
    answers = HARD[name].right
    assert all(check_question(question, answer).right for answer in answers)
    benchmark.pedantic(
        lambda: [check_question(question, answer) for answer in answers], rounds=10, iterations=1
    )
    assert benchmark.stats.stats.min < SECONDS * len(answers)
