"""PrairieLearn: the files of a question, and its server.py from variant to verdict."""

import json
import re
from functools import cache
from html import unescape
from string import ascii_lowercase
from types import SimpleNamespace

import pytest

from geomtorsion import exercises
from geomtorsion.errors import ArgumentError
from geomtorsion.exercises.answers import answer_text
from geomtorsion.exercises.exports import prairielearn
from geomtorsion.exercises.exports.prairielearn import question_files
from geomtorsion.exercises.exports.tasks import tasks
from geomtorsion.exercises.prose import html_of

NUMBERS = exercises.names()
SEEDS = (0, 1)
# Of PrairieLearn's schema of info.json: what must be there, what may, and of which form.
REQUIRED = {"uuid", "type", "title", "topic"}
ALLOWED = REQUIRED | {
    "comment", "tags", "authors", "clientFiles", "clientTemplates", "template", "gradingMethod",
    "singleVariant", "showCorrectAnswer", "partialCredit", "options", "externalGradingOptions",
    "dependencies", "workspaceOptions", "sharingSets", "sharePublicly", "shareSourcePublicly",
    "preferences",
}  # fmt: skip
UUID = r"[0-9a-fA-F]{8}-[0-9a-fA-F]{4}-[0-9a-fA-F]{4}-[0-9a-fA-F]{4}-[0-9a-fA-F]{12}"
# Of its elements: attributes that they take; any other is refused when a question is rendered.
ATTRIBUTES = {
    "pl-string-input": {
        "answers-name", "weight", "correct-answer", "label", "aria-label", "suffix", "display",
        "remove-leading-trailing", "remove-spaces", "allow-blank", "ignore-case", "placeholder",
        "size", "show-help-text", "normalize-to-ascii", "show-score", "multiline",
        "escape-unicode",
    },
    "pl-multiple-choice": {
        "answers-name", "weight", "number-answers", "order", "display", "hide-letter-keys",
        "fixed-order", "inline", "hide-score-badge", "allow-blank", "size", "placeholder",
        "aria-label",
    },
    "pl-answer": {"correct", "feedback", "score"},
    "pl-question-panel": set(),
    "pl-submission-panel": set(),
}  # fmt: skip


@cache
def exported(number: str) -> dict[str, str]:
    [task] = tasks([number], SEEDS)
    return question_files(task)


def server(number: str) -> SimpleNamespace:
    """The functions of server.py, as PrairieLearn loads them."""
    scope: dict = {}
    exec(compile(exported(number)["server.py"], "server.py", "exec"), scope)
    return SimpleNamespace(**{name: scope[name] for name in ("generate", "grade", "test")})


def variant(number: str, place: int) -> dict:
    """The data of a fresh variant."""
    data = {"variant_seed": place, "params": {}, "correct_answers": {}, "partial_scores": {},
            "feedback": {}, "submitted_answers": {}, "raw_submitted_answers": {}}  # fmt: skip
    server(number).generate(data)
    # What goes from step to step is stored as JSON.
    return json.loads(json.dumps(data))


@pytest.mark.parametrize("number", NUMBERS)
def test_files_are_as_prairielearn_wants_them(number):
    """Fields of info.json by its schema; elements, attributes and names in question.html."""
    files = exported(number)
    info = json.loads(files["info.json"])
    assert REQUIRED <= set(info) <= ALLOWED
    assert re.fullmatch(UUID, info["uuid"])
    assert info["type"] == "v3"
    assert info["singleVariant"] is False
    assert all(isinstance(info[key], str) for key in REQUIRED)
    assert all(isinstance(tag, str) for tag in info["tags"])
    page = files["question.html"]
    elements = re.findall(r"<(pl-[a-z-]+)((?:\s+[a-z-]+=\"[^\"]*\")*)>", page)
    assert len(elements) == len(re.findall(r"<pl-", page)) == len(re.findall(r"</pl-", page))
    for element, attributes in elements:
        assert set(re.findall(r"([a-z-]+)=", attributes)) <= ATTRIBUTES[element]
    asked = re.findall(r'answers-name="(\w+)"', page)
    assert asked == [question.name for question in exercises.load(number).questions]
    for name in asked:
        assert f"{{{{{{params.prompts.{name}}}}}}}" in page
        assert f"{{{{{{feedback.{name}}}}}}}" in page


def test_identities_differ_and_stay():
    """One for each exercise, whatever variants are exported."""
    found = {json.loads(exported(number)["info.json"])["uuid"] for number in NUMBERS}
    assert len(found) == len(NUMBERS)
    [task] = tasks(["3.2"], [5])
    again = json.loads(question_files(task)["info.json"])
    assert again["uuid"] == json.loads(exported("3.2")["info.json"])["uuid"]
    assert again["singleVariant"] is True


@pytest.mark.parametrize("number", NUMBERS)
def test_round_trip(number):
    """Right answers and mistakes, through server.py, in each variant."""
    hooks = server(number)
    for place, seed in enumerate(SEEDS):
        fresh = variant(number, place + 7 * len(SEEDS))
        assert fresh["params"]["seed"] == seed
        asked = exercises.load(number, seed).questions
        letters = {q.name: dict(zip(q.options, ascii_lowercase, strict=False)) for q in asked}
        right = dict(fresh["correct_answers"])
        for name, rows in fresh["params"]["choices"].items():
            [row] = [k for k, one in enumerate(rows) if one["right"] == "true"]
            right[name] = ascii_lowercase[row]
        assert set(right) == {question.name for question in asked}
        data: dict = fresh | {"submitted_answers": right}
        hooks.grade(data)
        assert data["score"] == 1
        assert {row["score"] for row in data["partial_scores"].values()} == {1}
        for question in asked:
            for mistake in question.mistakes:
                text = answer_text(question, mistake.value)
                wrong = right | {question.name: letters[question.name].get(text, text)}
                data = fresh | {"submitted_answers": wrong}
                hooks.grade(data)
                assert data["partial_scores"][question.name]["score"] < 1
                said = exercises.check(number, {question.name: text}, seed)[question.name]
                assert mistake.code in said.codes
                assert data["feedback"][question.name] == html_of(said.message, tex=True)


@pytest.mark.parametrize("kind", ["correct", "incorrect", "invalid"])
@pytest.mark.parametrize("number", ["1.4", "3.1", "4.2"])
def test_what_prairielearn_tests_with(number, kind):
    """The submissions of the question's own test get what it says."""
    fresh = variant(number, 1)
    data = fresh | {"test_type": kind}
    server(number).test(data)
    if kind == "invalid":
        assert "score" not in data
        assert not data["raw_submitted_answers"]
        return
    graded = fresh | {"submitted_answers": data["raw_submitted_answers"]}
    server(number).grade(graded)
    assert (data["score"] == 1) == (kind == "correct")
    assert graded["score"] == data["score"]
    assert graded["partial_scores"] == data["partial_scores"]


@pytest.mark.parametrize(
    "typed", ["<script>alert(1)</script>", r"\(\href{javascript:alert(1)}{x}\)", "$x$ <b", None]
)
def test_what_was_typed_is_escaped(typed):
    """Neither HTML nor formulas of a student's own come back."""
    data = variant("3.2", 0) | {"submitted_answers": {"christoffel": typed}}
    server("3.2").grade(data)
    said = data["feedback"]["christoffel"]
    assert data["score"] == 0
    assert "<script" not in said
    assert "<b" not in said.replace("<br", "")
    if typed is not None:
        assert said.startswith('<pre class="mathjax_ignore tex2jax_ignore">')
        assert "&lt;" in said or "<" not in unescape(typed)


def test_a_variant_needs_a_number():
    """PrairieLearn's seed is a whole number."""
    with pytest.raises(ArgumentError, match="variant_seed: a whole number was needed"):
        prairielearn.generate({"variant_seed": "x", "params": {}}, "3.2", (0,))
