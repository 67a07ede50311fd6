"""stack: exercises as questions of STACK, in the XML that Moodle's question bank imports."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from html import escape
from itertools import pairwise
from types import MappingProxyType
from xml.etree import ElementTree as ET

from geomtorsion.teaching.exercises.exercise import Exercise
from geomtorsion.teaching.exercises.exports.parts import Part, parts_of
from geomtorsion.teaching.exercises.exports.tasks import Task
from geomtorsion.teaching.exercises.prose import html_of
from geomtorsion.teaching.exercises.verdict import MESSAGES
from geomtorsion.teaching.texts import texts

# Fixed settings of a STACK question; an import takes missing ones from the site.
_OPTIONS: Mapping[str, str] = MappingProxyType(
    {
        "questionsimplify": "1", "assumepositive": "0", "assumereal": "1", "decimals": ".",
        "multiplicationsign": "dot", "sqrtsign": "1", "complexno": "i", "inversetrig": "cos-1",
        "logicsymbol": "lang", "matrixparens": "(", "variantsselectionseed": "",
    }
)  # fmt: skip
_INPUT: Mapping[str, str] = MappingProxyType(
    {
        "strictsyntax": "1", "insertstars": "0", "syntaxhint": "", "syntaxattribute": "0",
        "forbidwords": "", "allowwords": "", "forbidfloat": "0", "requirelowestterms": "0",
        "checkanswertype": "1", "mustverify": "1", "showvalidation": "1", "options": "",
    }
)  # fmt: skip


def stack_quiz(tasks: Sequence[Task]) -> str:
    """Moodle XML: a category for each chapter, a question for each exercise.

    Variants are the deployed seeds 1, 2, ... of a question, as STACK deploys systematically. A
    recognised mistake is a node of the potential response tree with its feedback. Variants
    that require different numbers of components are separate questions.

    Examples
    --------
    >>> from geomtorsion.teaching.exercises.exports.tasks import tasks
    >>> quiz = ET.fromstring(stack_quiz(tasks(["3.2"], [0, 1])))
    >>> [question.get("type") for question in quiz]
    ['category', 'stack']
    >>> [seed.text for seed in quiz.iter("deployedseed")]
    ['1', '2']
    """
    quiz = ET.Element("quiz")
    chapter = ""
    for task in tasks:
        if task.chapter != chapter:
            chapter = task.chapter
            category = ET.SubElement(quiz, "question", type="category")
            _text(category, "category", f"$course$/top/geomtorsion/{chapter}")
        groups: dict[tuple[object, ...], list[Exercise]] = {}
        for exercise in task.variants:
            groups.setdefault(_form(exercise), []).append(exercise)
        for group in groups.values():
            seeds = ", ".join(str(exercise.seed) for exercise in group)
            name = task.heading if len(groups) == 1 else f"{task.heading} (seeds {seeds})"
            _question(quiz, name, group)
    ET.indent(quiz)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(quiz, "unicode") + "\n"


def _form(exercise: Exercise) -> tuple[object, ...]:
    """The elements that the variants of one question share."""
    return tuple((q.name, q.kind, q.shape, len(q.unknowns)) for q in exercise.questions)


def _question(quiz: ET.Element, name: str, group: Sequence[Exercise]) -> None:
    """One question with its inputs, response trees, deployed seeds and tests."""
    parts = parts_of(group)
    question = ET.SubElement(quiz, "question", type="stack")
    _text(question, "name", name)
    note = f"<p><em>{escape(group[0].note)}</em></p>" * bool(group[0].note)
    asked = [note + _by_variant([html_of(exercise.statement, tex=True) for exercise in group])]
    asked += [_asked(part) for part in parts]
    _html(question, "questiontext", "\n".join(asked))
    _html(question, "generalfeedback", _by_variant([_worked(exercise) for exercise in group]))
    ET.SubElement(question, "defaultgrade").text = str(sum(part.points for part in parts))
    ET.SubElement(question, "penalty").text = "0.1"
    ET.SubElement(question, "hidden").text = "0"
    _text(question, "questionvariables", "\n".join(_variables(group, parts)))
    _html(question, "specificfeedback", "")
    _html(question, "questionnote", _by_variant([f"seed {exercise.seed}" for exercise in group]))
    for tag, value in _OPTIONS.items():
        ET.SubElement(question, tag).text = value
    text = texts("sheets", "stack", group[0].language)
    _html(question, "prtcorrect", text("right"))
    _html(question, "prtpartiallycorrect", text("partly"))
    _html(question, "prtincorrect", "")
    for part in parts:
        _inputs(question, part)
        _tree(question, part)
    if len(group) > 1:
        for place in range(1, len(group) + 1):
            ET.SubElement(question, "deployedseed").text = str(place)
    for case, (description, code, values) in enumerate(_cases(parts), 1):
        _test(question, case, description, code, values)


def _variables(group: Sequence[Exercise], parts: Sequence[Part]) -> Iterator[str]:
    """Question variables: the variant, relations between symbols, solutions and mistakes."""
    if len(group) > 1:
        yield f"variant: mod(stack_seed-1,{len(group)})+1;"
    relations = list(dict.fromkeys(x for part in parts for x in part.relations))
    if relations:
        yield f"assume({','.join(relations)});"
    for part in parts:
        for variable, values in part.variables():
            yield f"{variable}: {_chosen(values)};"


def _chosen(texts: Sequence[str]) -> str:
    """One of several texts of Maxima, by the variant."""
    return texts[0] if len(set(texts)) == 1 else f"[{','.join(texts)}][variant]"


def _by_variant(texts: Sequence[str]) -> str:
    """One of several displayed texts, by the variant."""
    if len(set(texts)) == 1:
        return texts[0]
    pieces = []
    for place, text in enumerate(texts, 1):
        word = "if" if place == 1 else "elif"
        pieces.append(f'[[{word} test="is(variant={place})"]]{text}')
    return "".join(pieces) + "[[/if]]"


def _asked(part: Part) -> str:
    """Prompt, instructions for the answer, fields, and the position of the feedback."""
    prompts = _by_variant([html_of(question.prompt, tex=True) for question in part.questions])
    how = _by_variant([f"<p><em>{escape(text)}</em></p>" for text in part.how()])
    fields = []
    for name, label in zip(part.inputs, part.labels, strict=True):
        shown = f"{label} " if label else ""
        fields.append(f"<p>{shown}[[input:{name}]] [[validation:{name}]]</p>")
    return "\n".join([prompts, how, *fields, f"[[feedback:{part.tree}]]"])


def _worked(exercise: Exercise) -> str:
    """The solution step by step."""
    items = "".join(f"<li>{html_of(step.text, tex=True)}</li>" for step in exercise.worked)
    return f"<ol>{items}</ol>"


def _inputs(question: ET.Element, part: Part) -> None:
    """The fields of a part."""
    for place, name in enumerate(part.inputs):
        field = ET.SubElement(question, "input")
        ET.SubElement(field, "name").text = name
        ET.SubElement(field, "type").text = part.field
        ET.SubElement(field, "tans").text = part.shown(part.solution, place)
        ET.SubElement(field, "boxsize").text = "5" if part.field == "matrix" else "30"
        own = {"allowwords": ",".join(part.words)}
        if part.field == "matrix":
            own["syntaxhint"] = part.zeros
        if part.field == "dropdown":
            own |= {"mustverify": "0", "showvalidation": "0", "checkanswertype": "0"}
        for tag, value in ({**_INPUT} | own).items():
            ET.SubElement(field, tag).text = value


def _tree(question: ET.Element, part: Part) -> None:
    """The potential response tree: right, then each mistake, then rounding where it can occur."""
    tree = ET.SubElement(question, "prt")
    ET.SubElement(tree, "name").text = part.tree
    ET.SubElement(tree, "value").text = str(part.points)
    ET.SubElement(tree, "autosimplify").text = "1"
    ET.SubElement(tree, "feedbackstyle").text = "1"
    _text(tree, "feedbackvariables", "\n".join(part.feedback_variables()))
    answer = part.given
    rows = [("right", answer, part.solution, part.tolerance, "")]
    for slot in part.slots:
        feedback = _by_variant([html_of(text, tex=True) if text else "" for text in slot.messages])
        rows.append((slot.note, part.compared(slot), slot.variable, part.tolerance, feedback))
    if part.rounding:
        message = MESSAGES.of(part.questions[0].language)["rounded"]
        rows.append(("rounded", answer, part.solution, part.rounding, message))
    numbers = [*map(str, range(len(rows))), "-1"]
    for (note, sans, tans, option, feedback), (own, following) in zip(
        rows, pairwise(numbers), strict=True
    ):
        node = ET.SubElement(tree, "node")
        ET.SubElement(node, "name").text = own
        ET.SubElement(node, "description").text = note
        ET.SubElement(node, "answertest").text = "NumAbsolute" if part.tolerance else "AlgEquiv"
        ET.SubElement(node, "sans").text = sans
        ET.SubElement(node, "tans").text = tans
        ET.SubElement(node, "testoptions").text = option
        ET.SubElement(node, "quiet").text = "1"
        score = "1" if note == "right" else "0"
        _branch(node, "true", score, "-1", f"{part.tree}-{note}", feedback)
        _branch(node, "false", "0", following, f"{part.tree}-not-{note}", "")


def _branch(node: ET.Element, which: str, score: str, to: str, note: str, said: str) -> None:
    """The branch of a node whose test is true, or false."""
    for tag, value in {
        "scoremode": "=", "score": score, "penalty": "", "nextnode": to, "answernote": note,
    }.items():  # fmt: skip
        ET.SubElement(node, which + tag).text = value
    _html(node, which + "feedback", said)


def _cases(parts: Sequence[Part]) -> Iterator[tuple[str, str, Mapping[Part, str]]]:
    """Question tests: all right, then each mistake that every variant has, one part at a time."""
    yield "the solution", "", {part: part.solution for part in parts}
    for part in parts:
        for slot in part.slots:
            if slot.tested:
                yield slot.note, slot.note, {part: slot.variable}


def _test(
    question: ET.Element, case: int, description: str, note: str, values: Mapping[Part, str]
) -> None:
    """One test: the inputs, and the expected end of each tree."""
    test = ET.SubElement(question, "qtest")
    ET.SubElement(test, "testcase").text = str(case)
    ET.SubElement(test, "description").text = description
    for part, variable in values.items():
        for place, name in enumerate(part.inputs):
            field = ET.SubElement(test, "testinput")
            ET.SubElement(field, "name").text = name
            ET.SubElement(field, "value").text = part.typed(variable, place)
    for part in values:
        expected = ET.SubElement(test, "expected")
        ET.SubElement(expected, "name").text = part.tree
        ET.SubElement(expected, "expectedscore").text = "0" if note else "1"
        ET.SubElement(expected, "expectedpenalty").text = "0.1" if note else "0"
        ET.SubElement(expected, "expectedanswernote").text = f"{part.tree}-{note or 'right'}"


def _text(parent: ET.Element, tag: str, text: str) -> None:
    """A text inside its own element, as Moodle writes it."""
    ET.SubElement(ET.SubElement(parent, tag), "text").text = text


def _html(parent: ET.Element, tag: str, text: str) -> None:
    """A text inside its own element, marked as HTML."""
    ET.SubElement(ET.SubElement(parent, tag, format="html"), "text").text = text
