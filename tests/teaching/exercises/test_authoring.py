"""Texts: statements say what is there, on the page, in the terminal and in every variant."""

import re

import pytest
import sympy as sp

from geomtorsion import exercises
from geomtorsion.teaching.exercises.prose import text_of
from geomtorsion.teaching.exercises.sheets import write_sheet

SEEDS = range(12)


def texts(number: str, seed: int):
    """All that a student reads of an exercise."""
    exercise = exercises.load(number, seed)
    yield exercise.title
    yield exercise.statement
    yield from exercise.hints
    for question in exercise.questions:
        yield question.prompt


@pytest.mark.parametrize("number", exercises.names())
def test_no_text_needs_another_exercise(number):
    """What is given stands in the exercise itself: it may be on a sheet without the others."""
    for seed in SEEDS:
        for text in texts(number, seed):
            assert not re.search(r"exercises? [1-7]\.[0-9]", text), text


def test_the_coframe_stands_where_it_is_needed():
    """The loops in the rotations give it, where they once referred to exercise 1.2."""
    for number in ("5.3", "7.2"):
        assert "pmatrix} 0 &" in exercises.load(number, 3).statement


@pytest.mark.parametrize("number", ["2.1", "2.3", "3.1", "3.2", "3.3", "4.2", "4.3"])
def test_no_surface_of_revolution_that_cannot_be_embedded(number):
    """Circles that grow faster than the length across them are no surface in flat space."""
    for seed in SEEDS:
        for text in texts(number, seed):
            assert "revolution" not in text
            assert "meridian" not in text


def test_some_profiles_cannot_be_embedded():
    """Why that is so: |f'| > 1 on a part of the domain."""
    x = sp.Symbol("x")
    steep = 0
    for seed in range(1, 30):
        statement = exercises.load("3.2", seed).statement
        assert r"has the length $2\pi f$" in statement
        steep += "sinh" in statement or "{e}^{" in statement
    assert steep > 3
    assert abs(sp.sinh(2 * x).diff(x).subs(x, 1)) > 1


def test_titles_fit_all_variants():
    """A title names the rotations or a body only where every variant is about them."""
    named = {n for n, title in exercises.titles().items() if "rotations" in title}
    assert named == {"5.3"}
    for seed in range(1, 7):  # here the forms are stretched
        assert "rigid body" not in exercises.load("1.2", seed).statement
        assert "Body-fixed" not in exercises.load("2.4", seed).statement
    assert "rigid body" in exercises.load("1.2").statement


def test_exponentials_in_the_terminal():
    """phi_2 exp(3 phi_2), where the exponent was once torn apart."""
    statements = [text_of(exercises.load("3.2", seed).statement) for seed in range(48)]
    assert any("φ_2 exp(3φ_2)" in text for text in statements)
    assert not any(re.search(r"e\^[0-9]φ", text) for text in statements)


def test_the_teacher_gets_worked_solutions(tmp_path):
    """Step by step in the teacher's page, in no other file."""
    *students, teacher = write_sheet("4", tmp_path, seed=1)
    page = teacher.read_text("utf-8")
    assert page.count("Step by step") == 4
    assert page.count("<code>equations</code>.</p>") == 1
    assert "<ol" in page
    for path in students:
        assert "Step by step" not in path.read_text("utf-8")
