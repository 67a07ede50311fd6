"""Exercises on the page, and replies to answers."""

import pytest

from geomtorsion import exercises
from geomtorsion.teaching.exercises.question import shown_name
from geomtorsion.teaching.lab.problems import answer, statement
from geomtorsion.teaching.lab.settings import PAGE


@pytest.mark.parametrize("number", exercises.names()[::5])
def test_an_exercise_right_and_wrong(number):
    """The solution is right, other text is wrong; statements come as HTML with mathematics."""
    posed = exercises.load(number)
    shown = statement(number)
    assert "$" not in shown["statement"]
    assert [question["name"] for question in shown["questions"]] == [
        question.name for question in posed.questions
    ]
    for told, question in zip(shown["questions"], posed.questions, strict=True):
        if question.kind not in ("number", "choice"):
            assert all(shown_name(symbol.name) in told["how"] for symbol in question.domain.symbols)
    assert answer(number, 0, posed.answers())["right"]
    first = posed.questions[0].name
    found = answer(number, 0, {first: "17*17"})
    assert not found["right"]
    assert [one["name"] for one in found["questions"]] == [first]


def test_an_endless_answer_is_refused():
    """An answer longer than the limit is refused."""
    with pytest.raises(ValueError, match="enough for every exercise"):
        answer("1.1", 0, {"legs": "1" * (PAGE.answer + 1)})


def test_an_excerpt_of_an_answer_keeps_its_lines():
    """The mark below the place of a mistake stays below it."""
    [one] = answer("3.2", 0, {"christoffel": "cos("})["questions"]
    assert one["state"] == "could not be read"
    excerpt = one["message"].removeprefix("<pre>").removesuffix("</pre>").splitlines()
    assert excerpt[2].index("^") == excerpt[1].index("(")
    assert answer("3.2", 0, {"christoffel": "1/2phi1 phi2"})["questions"][0]["message"].startswith(
        "<p>"
    )
