"""prairielearn: question folders, and what their server.py calls to generate, grade and test.

PrairieLearn hands one dictionary from step to step (https://docs.prairielearn.com): `variant_seed`
and `params` make the variant, `submitted_answers` come in, `partial_scores`, `score` and `feedback`
go out. Answers are read by the grader of the exercises and never run as code.
"""

from __future__ import annotations

import json
from collections.abc import MutableMapping, Sequence
from html import escape
from string import ascii_lowercase
from typing import Any
from uuid import NAMESPACE_URL, uuid5

from geomtorsion import checks
from geomtorsion.errors import ArgumentError
from geomtorsion.exercises.answers import answer_text
from geomtorsion.exercises.exercise import Exercise
from geomtorsion.exercises.exports.tasks import Task
from geomtorsion.exercises.prose import html_of
from geomtorsion.exercises.question import Question, how_to_answer
from geomtorsion.exercises.registry import load
from geomtorsion.exercises.verdict import QuestionVerdict

Data = MutableMapping[str, Any]
# Codes of verdicts whose message repeats what was typed: it is shown as it stands.
_QUOTING = ("unreadable", "too large", "unit")
_SERVER = '''\
"""Exercise {number} of geomtorsion, {title}: generated and graded by the library."""

from geomtorsion.exercises.exports import prairielearn

NUMBER, SEEDS = "{number}", {seeds}


def generate(data):
    prairielearn.generate(data, NUMBER, SEEDS)


def grade(data):
    prairielearn.grade(data, NUMBER)


def test(data):
    prairielearn.test(data, NUMBER)
'''

# Mustache fills in what stands in braces before the elements are read.
_PROMPT = "<pl-question-panel>{{{params.prompts.NAME}}}</pl-question-panel>"
_SAID = (
    "<pl-submission-panel>{{#feedback.NAME}}{{{feedback.NAME}}}{{/feedback.NAME}}"
    "</pl-submission-panel>"
)
_TYPED = (
    '<pl-string-input answers-name="NAME" label="NAME" weight="POINTS" allow-blank="true" '
    'remove-leading-trailing="true" show-help-text="false" size="60"></pl-string-input>'
)
_CHOICE = """\
<pl-multiple-choice answers-name="NAME" weight="POINTS" order="fixed" allow-blank="true">
{{#params.choices.NAME}}<pl-answer correct="{{right}}">{{text}}</pl-answer>{{/params.choices.NAME}}
</pl-multiple-choice>"""


def question_files(task: Task) -> dict[str, str]:
    """The files of a question: info.json, question.html, server.py.

    Examples
    --------
    >>> from geomtorsion.exercises.exports.tasks import tasks
    >>> files = question_files(tasks(["3.2"], [0, 1])[0])
    >>> sorted(files), json.loads(files["info.json"])["type"]
    (['info.json', 'question.html', 'server.py'], 'v3')
    """
    seeds = tuple(exercise.seed for exercise in task.variants)
    info = {
        # The same exercise has the same identity whenever it is exported.
        "uuid": str(uuid5(NAMESPACE_URL, f"geomtorsion/exercises/{task.number}")),
        "title": task.heading,
        "topic": task.chapter,
        "tags": ["geomtorsion", task.variants[0].level],
        "type": "v3",
        "singleVariant": len(seeds) == 1,
    }
    return {
        "info.json": json.dumps(info, indent=2, ensure_ascii=False) + "\n",
        "question.html": _page(task.variants[0]),
        "server.py": _SERVER.format(number=task.number, title=task.title, seeds=seeds),
    }


def _page(exercise: Exercise) -> str:
    """The template: statement, a field for each question, and what was said about each answer."""
    lines = ["<pl-question-panel>{{{params.statement}}}</pl-question-panel>"]
    for question in exercise.questions:
        field = _CHOICE if question.options else _TYPED
        lines += [
            text.replace("NAME", question.name).replace("POINTS", str(question.points))
            for text in (_PROMPT, field, _SAID)
        ]
    return "\n".join(lines) + "\n"


def generate(data: Data, number: str, seeds: Sequence[int]) -> None:
    """Put an exercise into the parameters of a variant, and its solution into the right answers.

    Parameters
    ----------
    data
        of PrairieLearn; `variant_seed`, a whole number, decides which of the seeds is taken.
    number, seeds
        of the exercise.

    Raises
    ------
    ArgumentError
        `variant_seed` is no whole number.
    UnknownNameError
        There is no such exercise or seed.

    Examples
    --------
    >>> data = {"variant_seed": 4, "params": {}, "correct_answers": {}}
    >>> generate(data, "3.2", (0, 1, 2))
    >>> data["params"]["seed"], data["correct_answers"]
    (1, {'christoffel': '3/(sinh(3*phi2)*cosh(3*phi2))'})
    """
    variant = checks.whole(data.get("variant_seed"))
    if variant is None:
        came = checks.shown(data.get("variant_seed"))
        raise ArgumentError(
            f"variant_seed: a whole number was needed, but {came} came. "
            "PrairieLearn puts it into the data of generate."
        )
    exercise = load(number, seeds[variant % len(seeds)])
    params = data["params"]
    params["seed"] = exercise.seed
    params["statement"] = html_of(exercise.statement, tex=True)
    params["prompts"] = {
        question.name: html_of(question.prompt, tex=True) + _how(question)
        for question in exercise.questions
    }
    params["choices"] = {
        question.name: [
            {"text": text, "right": str(key == question.solution[()]).lower()}
            for key, text in question.options.items()
        ]
        for question in exercise.questions
        if question.options
    }
    # Those of choices are set by their element.
    data["correct_answers"] |= {
        question.name: answer_text(question, question.solution)
        for question in exercise.questions
        if not question.options
    }


def _how(question: Question) -> str:
    """How to answer, as HTML; of choices nothing."""
    if question.options:
        return ""
    return f"<p><small>{escape(f'Answer: {how_to_answer(question)}.'.replace('`', ''))}</small></p>"


def grade(data: Data, number: str) -> None:
    """Grade the submitted answers: a score and what is said about it for each question.

    Parameters
    ----------
    data
        of PrairieLearn, with the parameters that `generate` put in; `partial_scores`, `score` and
        `feedback` are set. Feedback is HTML; what was typed is escaped in it.
    number
        of the exercise.

    Raises
    ------
    UnknownNameError
        There is no such exercise or seed.

    Examples
    --------
    >>> data = {"params": {"seed": 0}, "submitted_answers": {"christoffel": "-cot(phi2)"},
    ...         "partial_scores": {}, "feedback": {}}
    >>> grade(data, "3.2")
    >>> data["score"], data["feedback"]["christoffel"]
    (0.0, '<p>The sign is wrong.</p>')
    """
    exercise = load(number, data["params"]["seed"])
    submitted = data["submitted_answers"]
    answers = {
        question.name: _typed(question, submitted.get(question.name))
        for question in exercise.questions
    }
    verdict = exercise.check(answers)
    for said in verdict.questions:
        data["partial_scores"][said.name] = {"score": said.score, "weight": said.points}
        data["feedback"][said.name] = _shown(said)
    data["score"] = verdict.score


def _typed(question: Question, given: object) -> object:
    """What was answered; of a choice PrairieLearn gives the letter."""
    if not question.options:
        return given
    table = dict(zip(ascii_lowercase, question.options, strict=False))
    return table.get(str(given), "")


def _shown(said: QuestionVerdict) -> str:
    """What is said about an answer, as HTML."""
    if said.diagnosis in _QUOTING:
        # MathJax leaves this alone: whoever typed it shall not typeset anything on this page.
        return f'<pre class="mathjax_ignore tex2jax_ignore">{escape(said.message)}</pre>'
    return html_of(said.message, tex=True)


def test(data: Data, number: str) -> None:
    """Make the submission with which PrairieLearn tests a variant, and what it is to get.

    Parameters
    ----------
    data
        of PrairieLearn; `test_type` is "correct" or "incorrect" (the first mistake that is
        recognised); anything else is left to the elements.
    number
        of the exercise.

    Examples
    --------
    >>> data = {"params": {"seed": 0}, "test_type": "incorrect", "raw_submitted_answers": {},
    ...         "partial_scores": {}}
    >>> test(data, "3.2")
    >>> data["raw_submitted_answers"], data["score"]
    ({'christoffel': '0'}, 0.0)
    """
    kind = data["test_type"]
    if kind not in ("correct", "incorrect"):
        return
    exercise = load(number, data["params"]["seed"])
    answers = {}
    for question in exercise.questions:
        wrong = kind == "incorrect" and question.mistakes
        value = question.mistakes[0].value if wrong else question.solution
        answers[question.name] = answer_text(question, value)
        letters = dict(zip(question.options, ascii_lowercase, strict=False))
        data["raw_submitted_answers"][question.name] = letters.get(
            answers[question.name], answers[question.name]
        )
    verdict = exercise.check(answers)
    for said in verdict.questions:
        data["partial_scores"][said.name] = {"score": said.score, "weight": said.points}
    data["score"] = verdict.score
