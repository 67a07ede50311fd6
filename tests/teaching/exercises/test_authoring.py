"""Texts of exercises: complete and correct on the page, in the terminal and in each variant."""

import re

import pytest
import sympy as sp

from geomtorsion import exercises
from geomtorsion.teaching.exercises.prose import text_of
from geomtorsion.teaching.exercises.sheets import write_sheet

SEEDS = range(12)


def texts(number: str, seed: int):
    """All texts of an exercise that a student reads."""
    exercise = exercises.load(number, seed)
    yield exercise.title
    yield exercise.statement
    yield from exercise.hints
    for question in exercise.questions:
        yield question.prompt


@pytest.mark.parametrize("number", exercises.names())
def test_no_text_needs_another_exercise(number):
    """No text refers to another exercise, because a sheet may contain only this one."""
    for seed in SEEDS:
        for text in texts(number, seed):
            assert not re.search(r"exercises? [1-7]\.[0-9]", text), text


def test_exercises_about_loops_state_the_coframe():
    """Exercises about loops in the rotations state the coframe."""
    for number in ("5.3", "7.2"):
        assert "pmatrix} 0 &" in exercises.load(number, 3).statement


@pytest.mark.parametrize("number", ["2.1", "2.3", "3.1", "3.2", "3.3", "4.2", "4.3"])
def test_no_surface_of_revolution_that_cannot_be_embedded(number):
    """No text claims a surface of revolution, because some of these metrics cannot be embedded."""
    for seed in SEEDS:
        for text in texts(number, seed):
            assert "revolution" not in text
            assert "meridian" not in text


def test_some_profiles_cannot_be_embedded():
    """Some variants have |f'| > 1 on a part of the domain, so they cannot be embedded."""
    x = sp.Symbol("x")
    steep = 0
    for seed in range(1, 30):
        statement = exercises.load("3.2", seed).statement
        assert r"has the length $2\pi f$" in statement
        steep += "sinh" in statement or "{e}^{" in statement
    assert steep > 3
    assert abs(sp.sinh(2 * x).diff(x).subs(x, 1)) > 1


def test_titles_fit_all_variants():
    """A title names the rotations or a body only if each variant is about them."""
    named = {n for n, title in exercises.titles().items() if "rotations" in title}
    assert named == {"5.3"}
    for seed in range(1, 7):  # The variants with stretched forms
        assert "rigid body" not in exercises.load("1.2", seed).statement
        assert "Body-fixed" not in exercises.load("2.4", seed).statement
    assert "rigid body" in exercises.load("1.2").statement


def test_exponentials_in_the_terminal():
    """An exponential in the terminal reads phi_2 exp(3 phi_2), with its exponent in brackets."""
    statements = [text_of(exercises.load("3.2", seed).statement) for seed in range(48)]
    assert any("φ_2 exp(3φ_2)" in text for text in statements)
    assert not any(re.search(r"e\^[0-9]φ", text) for text in statements)


def test_the_teacher_gets_worked_solutions(tmp_path):
    """The teacher's page has the worked solutions; the other files do not."""
    *students, teacher = write_sheet("4", tmp_path, seed=1)
    page = teacher.read_text("utf-8")
    assert page.count("Step by step") == 5
    assert page.count("<code>equations</code>.</p>") == 1
    assert "<ol" in page
    for path in students:
        assert "Step by step" not in path.read_text("utf-8")
