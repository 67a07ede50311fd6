"""Worked solutions: each question is answered by a step, with a method apart from the library's."""

# Tests pass wrong types on purpose, as users do, and read attributes that may be missing.
# pyright: reportOperatorIssue=false

import re

import pytest

from geomtorsion import exercises
from geomtorsion.teaching.exercises.answers import answer_text
from geomtorsion.teaching.exercises.checking import check_question
from geomtorsion.teaching.exercises.prose import html_of, text_of
from geomtorsion.teaching.exercises.question import normal
from tests.calls import python_calls

NUMBERS = exercises.names()
# Variants of the normal run, and of the slow one.
SEEDS = [range(1), pytest.param(range(1, 12), marks=pytest.mark.slow)]
# The normal run measures one exercise of middle length, the slow run all others.
MIDDLE = "4.2"
FEW_AND_ALL = [x if x == MIDDLE else pytest.param(x, marks=pytest.mark.slow) for x in NUMBERS]


@pytest.mark.parametrize("seeds", SEEDS, ids=len)
@pytest.mark.parametrize("number", NUMBERS)
def test_the_way_by_hand_leads_to_the_solution(number, seeds):
    """The steps answer each question once, with a value that the checker accepts."""
    for seed in seeds:
        exercise = exercises.load(number, seed)
        steps = exercise.worked
        assert len(steps) >= 2
        assert len(steps) > sum(bool(step.question) for step in steps) or number in (
            "3.1",
            "6.6",
            "7.4",
        )
        reached = [step.question for step in steps if step.question]
        assert sorted(reached) == sorted(question.name for question in exercise.questions)
        for step in steps:
            if step.question:
                question = exercise.question(step.question)
                given = answer_text(question, normal(step.value))
                verdict = check_question(question, given)
                assert verdict.right, (seed, step.question, given, exercise.answers(), verdict)


@pytest.mark.parametrize("seeds", SEEDS, ids=len)
@pytest.mark.parametrize("number", NUMBERS)
def test_steps_can_be_read(number, seeds):
    """Page and terminal show whole sentences, without LaTeX and without undefined values."""
    for seed in seeds:
        for step in exercises.load(number, seed).worked:
            assert "<math" in html_of(step.text) or "$" not in step.text
            plain = text_of(step.text)
            assert not re.search(r"\$|\\[a-zA-Z]|\b(?:None|nan|lambda|Pow)\b", plain), plain
            assert re.search(r"[.](\$\$)?$", step.text), plain


@pytest.mark.parametrize("number", FEW_AND_ALL)
def test_steps_are_made_soon(number):
    """A worked solution takes less than 60 million Python calls; the longest takes 15 million."""
    assert 0 < python_calls(lambda: exercises.load(number, 20).worked) < 60e6


def test_a_wrong_step_would_be_noticed():
    """This check can fail: the value of the step is right, its negative is wrong."""
    exercise = exercises.load("3.2")
    question = exercise.question("christoffel")
    [value] = [step.value for step in exercise.worked if step.question]
    assert check_question(question, answer_text(question, normal(value))).right
    assert not check_question(question, answer_text(question, normal(-value))).right
