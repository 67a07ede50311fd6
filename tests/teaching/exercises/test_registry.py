"""The list of exercises: it loads nothing, solves nothing, and names the available exercises."""

import pytest

from geomtorsion.errors import UnknownNameError
from geomtorsion.teaching.exercises import registry
from geomtorsion.teaching.exercises.question import (
    Question,
)


def test_listing_loads_nothing(monkeypatch):
    """Numbers and titles are listed without loading an exercise."""
    monkeypatch.setattr(registry, "import_module", None)
    assert len(registry.names()) == len(registry.titles()) >= 24


def test_loading_solves_nothing(monkeypatch):
    """An exercise is stated without computing its solution."""

    def refuse(question):
        raise AssertionError("a solution was computed")

    monkeypatch.setattr(Question, "solution", property(refuse))
    for entry in registry.EXERCISES:
        exercise = registry._loaded.__wrapped__(*entry, 11)
        assert exercise.statement
        assert exercise.hints


@pytest.mark.parametrize(
    ("number", "seed", "words"),
    [("9.9", 0, "from 1.1 to 7.4, got '9.9'"), ("3.22", 0, "Did you mean 3.2"),
     (3.2, 0, "number of an exercise as text, got 3.2. Write it in quotes: \"3.2\""),
     (None, 0, "as text, got None. Write it in quotes: \"1.1\""),
     (["3.2"], 0, r"as text, got \['3.2'\]. Write it in quotes"),
     ("", 0, "the number of an exercise, .* got ''"),
     ("1.1", -1, "whole number from 0"), ("1.1", True, "whole number"),
     ("1.1", "7", "whole number"),
     ("1.1", 10**12, "whole number")],
)  # fmt: skip
def test_unknown_exercises(number, seed, words):
    """The message names the available exercises or the allowed seeds."""
    with pytest.raises(UnknownNameError, match=words):
        registry.load(number, seed)


@pytest.mark.parametrize("name", [3, None, ["christoffel"], "cristoffel"])
def test_unknown_questions(name):
    """Anything that is not the name of a question is refused, and the names are listed."""
    with pytest.raises(
        UnknownNameError, match=r"3.2: expected .* a question \(christoffel\), got "
    ):
        registry.load("3.2").question(name)


def test_an_exercise_shows_itself():
    """One line in a terminal, the statement in a notebook."""
    exercise = registry.load("3.2", seed=4)
    assert repr(exercise) == (
        "exercise 3.2 (warm-up, seed 4): A Christoffel symbol; asked: christoffel; 2 hints"
    )
    assert exercise.statement in exercise._repr_markdown_()
