"""All exercises in five variants: the solution, other forms of it, and expected mistakes."""

import sys
from collections import Counter
from random import Random

import pytest

from geomtorsion import exercises
from geomtorsion.teaching.exercises import registry
from geomtorsion.teaching.exercises.answers import answer_text, component_text
from geomtorsion.teaching.exercises.checking import check_question
from geomtorsion.teaching.exercises.verdict import TITLES
from tests.teaching.exercises.forms import another_form

SEEDS = range(5)
WRONG_ANSWERS = 20
# Numbers of wrong answers, and variants: for the normal run and for the slow run.
FEW_AND_ALL = [3, pytest.param(WRONG_ANSWERS, marks=pytest.mark.slow)]
FIRST_AND_ALL = [range(1), pytest.param(SEEDS, marks=pytest.mark.slow)]
# One mistake of this exercise occurs only in a later variant.
LATER = ("5.2",)
NUMBERS = exercises.names()
# Each diagnosis that an exercise can compute in advance.
COMPUTED = {
    "factor", "sign", "permuted", "levi-civita", "cartan", "inverse", "basis", "direction", "axes",
    "degrees", "naive", "principle", "forgotten",
}  # fmt: skip


def wrong_answers(number: str, seeds=SEEDS):
    """(question, code, value) of each expected mistake in some seeds, by code."""
    found: dict[str, list] = {}
    for seed in seeds:
        for question in exercises.load(number, seed).questions:
            for mistake in question.mistakes:
                found.setdefault(mistake.code, []).append((question, mistake.value))
    return found


def test_there_are_enough():
    """At least 24 exercises in seven chapters, with warm-ups and a project."""
    assert len(NUMBERS) >= 24
    assert {number.partition(".")[0] for number in NUMBERS} == set("1234567")
    assert len(exercises.CHAPTERS) == 7
    levels = {exercises.load(number).level for number in NUMBERS}
    assert levels == {"warm-up", "exercise", "project"}


@pytest.mark.parametrize("seeds", FIRST_AND_ALL, ids=len)
@pytest.mark.parametrize("number", NUMBERS)
def test_the_solution_is_right(number, seeds):
    """The library's solution passes the check in each variant."""
    for seed in seeds:
        exercise = exercises.load(number, seed)
        verdict = exercise.check(exercise.answers())
        assert verdict.right, verdict
        assert verdict.score == 1


def test_heyoka_is_not_needed(monkeypatch):
    """Solutions do not need heyoka, an optional extra; no other test uses variant 77."""
    monkeypatch.setitem(sys.modules, "heyoka", None)
    for number in NUMBERS:
        exercise = exercises.load(number, 77)
        assert exercise.check(exercise.answers()).right, number


@pytest.mark.parametrize("seeds", FIRST_AND_ALL, ids=len)
@pytest.mark.parametrize("number", NUMBERS)
def test_other_forms_are_right(number, seeds):
    """A random equal form of each solution is right."""
    draw = Random(f"right {number}")
    for seed in seeds:
        for question in exercises.load(number, seed).questions:
            answer = another_form(question, question.solution, draw)
            said = check_question(question, answer)
            assert said.right, (seed, question.name, answer, said)


@pytest.mark.parametrize("count", FEW_AND_ALL)
@pytest.mark.parametrize("number", NUMBERS)
def test_mistakes_get_their_diagnosis(number, count):
    """Wrong answers of each expected kind, in random forms, get their diagnosis; the slow run
    covers all kinds in all variants."""
    draw = Random(f"wrong {number}")
    seeds = SEEDS if count == WRONG_ANSWERS or number in LATER else range(1)
    for code, cases in wrong_answers(number, seeds).items():
        for place in range(count if count < WRONG_ANSWERS else max(count, len(cases))):
            question, value = cases[place % len(cases)]
            answer = another_form(question, value, draw)
            said = check_question(question, answer)
            assert not said.right, (code, question.name, answer)
            assert code in said.codes, (code, question.name, answer, said)
            assert said.message


def questions_of(kind: str):
    """All questions of a kind with a nonzero solution, in the first seeds."""
    for number in NUMBERS:
        for seed in range(2):
            for question in exercises.load(number, seed).questions:
                if question.kind == kind and question.solution:
                    yield question


def test_counting_from_zero_is_noticed():
    """Indices counted from 0 are recognised in each question with components."""
    asked = 0
    for question in questions_of("components"):
        text = "; ".join(
            f"{','.join(map(str, key))} = {component_text(x)}"
            for key, x in question.solution.items()
        )
        if any(0 in key for key in question.solution):
            said = check_question(question, text)
            assert said.diagnosis == "counted", (question.name, text, said)
            asked += 1
    assert asked >= WRONG_ANSWERS


def test_rounding_and_units_are_noticed():
    """A number that is rounded too early and a number with a wrong unit are recognised."""
    asked = 0
    for question in questions_of("number"):
        if question.tolerance < 1e-6 or question.tolerance > 1e-2:
            continue
        scale = 1 + 5 * question.tolerance
        value = {key: float(x) * scale for key, x in question.solution.items()}
        said = check_question(question, answer_text(question, value))
        assert said.diagnosis == "rounded", (question.name, said)
        if not question.shape:
            assert check_question(question, "7 kg").diagnosis == "unit"
            assert check_question(question, "7 s").diagnosis == "unit"
        asked += 1
    assert asked >= WRONG_ANSWERS


@pytest.mark.parametrize("seeds", FIRST_AND_ALL, ids=len)
def test_every_diagnosis_occurs(seeds):
    """Each kind of mistake is expected in some exercise, and each has a title."""
    found = Counter(code for number in NUMBERS for code in wrong_answers(number, seeds))
    assert set(found) >= COMPUTED
    assert set(found) <= set(TITLES)


@pytest.mark.parametrize("many", [16, pytest.param(48, marks=pytest.mark.slow)])
@pytest.mark.parametrize("number", NUMBERS)
def test_different_seeds_are_different_tasks(number, many):
    """Each seed has its own statement or prompts, so a class gets as many tasks as students."""

    def read(seed):
        exercise = exercises.load(number, seed)
        return exercise.statement, tuple(question.prompt for question in exercise.questions)

    assert len({read(seed) for seed in range(many)}) == many


@pytest.mark.parametrize("number", NUMBERS)
def test_a_seed_is_a_seed(number):
    """A seed gives the same task again, also without the cache."""
    entry = next(entry for entry in registry.EXERCISES if entry[0] == number)
    before, after = exercises.load(number, 3), registry._loaded.__wrapped__(*entry, 3)
    assert before is not after
    assert before.statement == after.statement
    assert [q.prompt for q in before.questions] == [q.prompt for q in after.questions]


@pytest.mark.parametrize("number", NUMBERS)
def test_exercises_have_complete_texts(number):
    """Each exercise has a statement, two hints, prompts and a nonempty answer."""
    exercise = exercises.load(number)
    assert len(exercise.statement) > 80
    assert len(exercise.hints) >= 2
    assert exercise.title == exercises.titles()[number]
    for question in exercise.questions:
        assert question.prompt
        assert answer_text(question, question.solution)
        assert exercise.question(question.name) is question
