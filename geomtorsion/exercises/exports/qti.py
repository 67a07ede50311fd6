"""qti: exercises as a content package of QTI 2.1, items with response processing.

QTI compares numbers, choices and spellings; it does no algebra. Numbers within their tolerance and
choices are graded in full, with what is said about each recognised mistake. What is typed as a
formula is right if it is spelled as the solution (spaces, * and ^ or ** at will), a mistake if it
is spelled as one; any other spelling is left to a person, which the item says.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from xml.etree import ElementTree as ET

from geomtorsion.exercises.answers import answer_text
from geomtorsion.exercises.checking import ROUNDED
from geomtorsion.exercises.compare import Value
from geomtorsion.exercises.exercise import Exercise
from geomtorsion.exercises.exports.tasks import Task, can_be_rounded, feedback, largest
from geomtorsion.exercises.prose import html_of
from geomtorsion.exercises.question import Question, how_to_answer
from geomtorsion.exercises.verdict import MESSAGES

ITEM = "http://www.imsglobal.org/xsd/imsqti_v2p1"
PACKAGE = "http://www.imsglobal.org/xsd/imscp_v1p1"
MATHML = "http://www.w3.org/1998/Math/MathML"
_SCHEMA = "http://www.w3.org/2001/XMLSchema-instance"
_ITEM_SCHEMA = "http://www.imsglobal.org/xsd/qti/qtiv2p1/imsqti_v2p1.xsd"
_PACKAGE_SCHEMA = "http://www.imsglobal.org/xsd/qti/qtiv2p1/qtiv2p1_imscpv1p2_v1p0.xsd"
# What QTI decides by itself, and what it can only compare by its spelling.
DECIDED = ("number", "choice")
_LEFT = (
    "Your answer is not spelled like the solution or a mistake that is recognised. Whether it is "
    "equal to the solution is decided by a person."
)


def item_files(tasks: Sequence[Task]) -> dict[str, str]:
    """Path -> text: imsmanifest.xml, and an item for each exercise and variant.

    Examples
    --------
    >>> from geomtorsion.exercises.exports.tasks import tasks
    >>> list(item_files(tasks(["3.1"], [0])))
    ['imsmanifest.xml', 'items/3-1-which-connection-is-flat-seed0.xml']
    """
    items = {
        f"{task.slug}-seed{exercise.seed}": _written(_item(exercise, task))
        for task in tasks
        for exercise in task.variants
    }
    manifest = ET.Element(
        "manifest",
        {
            "xmlns": PACKAGE,
            "xmlns:xsi": _SCHEMA,
            "xsi:schemaLocation": f"{PACKAGE} {_PACKAGE_SCHEMA}",
            "identifier": "geomtorsion-exercises",
        },
    )
    metadata = ET.SubElement(manifest, "metadata")
    ET.SubElement(metadata, "schema").text = "QTIv2.1 Package"
    ET.SubElement(metadata, "schemaversion").text = "1.0.0"
    ET.SubElement(manifest, "organizations")
    resources = ET.SubElement(manifest, "resources")
    for name in items:
        path = f"items/{name}.xml"
        resource = ET.SubElement(
            resources,
            "resource",
            {"identifier": f"item-{name}", "type": "imsqti_item_xmlv2p1", "href": path},
        )
        ET.SubElement(resource, "file", href=path)
    return {"imsmanifest.xml": _written(manifest)} | {
        f"items/{name}.xml": text for name, text in items.items()
    }


def _written(root: ET.Element) -> str:
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, "unicode") + "\n"


@dataclass(frozen=True, eq=False)
class _Asked:
    """A question with the names of its variables in an item.

    key: of the question in the item, "1", "2", ....
    """

    key: str
    question: Question

    @property
    def responses(self) -> tuple[str, ...]:
        """Names of the response variables: one for each number, else one."""
        question = self.question
        if question.kind == "number" and question.shape:
            return tuple(f"RESPONSE_{self.key}_{k + 1}" for k in range(question.shape[0]))
        return (f"RESPONSE_{self.key}",)

    @property
    def type(self) -> str:
        """Base type of the responses."""
        return {"number": "float", "choice": "identifier"}.get(self.question.kind, "string")

    @property
    def outcomes(self) -> Iterator[tuple[str, Value, str]]:
        """Identifier of what is said, the value it is said about, and what is said."""
        yield f"RIGHT_{self.key}", self.question.solution, "Right."
        for place, mistake in enumerate(self.question.mistakes, 1):
            said = feedback(self.question, mistake)
            yield f"MISTAKE_{self.key}_{place}", mistake.value, said

    @property
    def otherwise(self) -> tuple[str, str]:
        """What is said about any other answer."""
        if self.question.kind in DECIDED:
            return f"WRONG_{self.key}", "That is not right."
        return f"LEFT_{self.key}", _LEFT

    def values(self, value: Value) -> tuple[str, ...]:
        """What each response variable holds for an answer."""
        question = self.question
        if question.kind == "choice":
            return (f"CHOICE_{list(question.options).index(str(value[()])) + 1}",)
        if question.kind == "number":
            keys = [(k,) for k in range(question.shape[0])] if question.shape else [()]
            return tuple(f"{float(value.get(key, 0)):.12g}" for key in keys)
        return (answer_text(question, value),)


def _item(exercise: Exercise, task: Task) -> ET.Element:
    """One item: declarations, body, response processing, feedback."""
    asked = [_Asked(str(k), question) for k, question in enumerate(exercise.questions, 1)]
    item = ET.Element(
        "assessmentItem",
        {
            "xmlns": ITEM,
            "xmlns:xsi": _SCHEMA,
            "xsi:schemaLocation": f"{ITEM} {_ITEM_SCHEMA}",
            "identifier": f"geomtorsion-{task.slug}-seed{exercise.seed}",
            "title": task.heading,
            "adaptive": "false",
            "timeDependent": "false",
        },
    )
    for one in asked:
        for name, value in zip(one.responses, one.values(one.question.solution), strict=True):
            declared = ET.SubElement(
                item,
                "responseDeclaration",
                {"identifier": name, "cardinality": "single", "baseType": one.type},
            )
            ET.SubElement(ET.SubElement(declared, "correctResponse"), "value").text = value
    points = sum(question.points for question in exercise.questions)
    _outcome(item, "SCORE", "single", "float", "0")
    _outcome(item, "MAXSCORE", "single", "float", str(points))
    _outcome(item, "FEEDBACK", "multiple", "identifier", "")
    item.append(_body(exercise, asked))
    processing = ET.SubElement(item, "responseProcessing")
    for one in asked:
        processing.append(_condition(one))
    for one in asked:
        rows = [(name, said) for name, _, said in one.outcomes]
        if can_be_rounded(one.question):
            rows.append((f"ROUNDED_{one.key}", MESSAGES["rounded"]))
        for name, said in [*rows, one.otherwise]:
            shown = ET.SubElement(
                item,
                "modalFeedback",
                {"outcomeIdentifier": "FEEDBACK", "identifier": name, "showHide": "show"},
            )
            shown.extend(_xhtml(f"`{one.question.name}`: {said}"))
    return item


def _outcome(item: ET.Element, name: str, cardinality: str, kind: str, value: str) -> None:
    """The declaration of an outcome, with its value before anything is answered."""
    declared = ET.SubElement(
        item,
        "outcomeDeclaration",
        {"identifier": name, "cardinality": cardinality, "baseType": kind},
    )
    if value:
        ET.SubElement(ET.SubElement(declared, "defaultValue"), "value").text = value


def _body(exercise: Exercise, asked: Sequence[_Asked]) -> ET.Element:
    """Statement, questions with their fields, and what scorers are told."""
    body = ET.Element("itemBody")
    body.extend(_xhtml(exercise.statement))
    for one in asked:
        question = one.question
        block = ET.SubElement(body, "div")
        block.extend(_xhtml(question.prompt))
        if question.kind == "choice":
            choices = ET.SubElement(
                block,
                "choiceInteraction",
                {"responseIdentifier": one.responses[0], "shuffle": "false", "maxChoices": "1"},
            )
            for place, text in enumerate(question.options.values(), 1):
                choice = ET.SubElement(choices, "simpleChoice", identifier=f"CHOICE_{place}")
                choice.text = text
            continue
        block.extend(_xhtml(f"Answer: {_how(question)}."))
        line = ET.SubElement(block, "p")
        length = "15" if question.kind == "number" else "60"
        for name in one.responses:
            given = {"responseIdentifier": name, "expectedLength": length}
            ET.SubElement(line, "textEntryInteraction", given)
        if question.kind not in DECIDED:
            body.append(_rubric(exercise, question))
    return body


def _how(question: Question) -> str:
    """How to answer; a field for a number takes no unit."""
    text = how_to_answer(question)
    if question.kind == "number":
        text = text.replace(" `[x, y, ...]`", ", one in each field")
        return f"{text}, written without unit" if question.unit else text
    return text


def _rubric(exercise: Exercise, question: Question) -> ET.Element:
    """What QTI cannot grade, and how it is graded, told to those who score."""
    rubric = ET.Element("rubricBlock", view="scorer")
    answer = answer_text(question, question.solution)
    where = f"{exercise.number} --seed {exercise.seed}"
    command = f'geomtorsion exercises check {where} "{question.name}=..."'
    rubric.extend(
        _xhtml(
            "QTI compares the spelling only, and algebra is left to you. The solution is "
            f"`{answer}`; any equal form is right. To have an answer graded: `{command}`."
        )
    )
    return rubric


def _xhtml(markdown: str) -> list[ET.Element]:
    """Paragraphs as elements of QTI, formulas as MathML."""
    text = html_of(markdown).replace("<math", f'<math xmlns="{MATHML}"')
    # The names of elements without a prefix are those of QTI, which has taken over XHTML's.
    found = list(ET.fromstring(f"<div>{text}</div>"))
    for element in found:
        _with_plain_names(element)
    return found


def _with_plain_names(element: ET.Element) -> None:
    """Names of MathML without their namespace, which each formula declares by itself."""
    for part in element.iter():
        if part.tag.startswith(f"{{{MATHML}}}"):
            part.tag = part.tag.removeprefix(f"{{{MATHML}}}")
            if part.tag == "math":
                part.set("xmlns", MATHML)


# -- response processing ---------------------------------------------------------------------------


def _condition(one: _Asked) -> ET.Element:
    """Nothing for no answer, else the first of solution and mistakes that fits, else the rest."""
    condition = ET.Element("responseCondition")
    branch = ET.SubElement(condition, "responseIf")
    nothing = branch if len(one.responses) == 1 else ET.SubElement(branch, "or")
    for name in one.responses:
        ET.SubElement(ET.SubElement(nothing, "isNull"), "variable", identifier=name)
    _say(branch, "EMPTY_" + one.key)
    for name, value, _ in one.outcomes:
        branch = ET.SubElement(condition, "responseElseIf")
        branch.append(_test(one, value, one.question.tolerance))
        if name.startswith("RIGHT"):
            summed = ET.SubElement(
                ET.SubElement(branch, "setOutcomeValue", identifier="SCORE"), "sum"
            )
            ET.SubElement(summed, "variable", identifier="SCORE")
            ET.SubElement(summed, "baseValue", baseType="float").text = str(one.question.points)
        _say(branch, name)
    if can_be_rounded(one.question):
        branch = ET.SubElement(condition, "responseElseIf")
        branch.append(_test(one, one.question.solution, ROUNDED))
        _say(branch, f"ROUNDED_{one.key}")
    _say(ET.SubElement(condition, "responseElse"), one.otherwise[0])
    return condition


def _say(branch: ET.Element, name: str) -> None:
    """One more thing that is said."""
    outcome = ET.SubElement(branch, "setOutcomeValue", identifier="FEEDBACK")
    several = ET.SubElement(outcome, "multiple")
    ET.SubElement(several, "variable", identifier="FEEDBACK")
    ET.SubElement(several, "baseValue", baseType="identifier").text = name


def _test(one: _Asked, value: Value, tolerance: float) -> ET.Element:
    """Whether an answer is a value: near, the same choice, or spelled like it."""
    question = one.question
    tests = []
    for name, text in zip(one.responses, one.values(value), strict=True):
        if question.kind == "number":
            allowed = f"{tolerance * largest(question):.12g}"
            test = ET.Element("equal", {"toleranceMode": "absolute", "tolerance": allowed})
            ET.SubElement(test, "variable", identifier=name)
            ET.SubElement(test, "baseValue", baseType="float").text = text
        elif question.kind == "choice":
            test = ET.Element("match")
            ET.SubElement(test, "variable", identifier=name)
            ET.SubElement(test, "baseValue", baseType="identifier").text = text
        else:
            test = ET.Element("patternMatch", pattern=spelling(text))
            ET.SubElement(test, "variable", identifier=name)
        tests.append(test)
    if len(tests) == 1:
        return tests[0]
    whole = ET.Element("and")
    whole.extend(tests)
    return whole


# Signs that are written in several ways -> the ways.
_WAYS: Mapping[str, str] = MappingProxyType(
    {"*": r"[*·×⋅]", "^": r"(\^|\*\*)", "-": r"[\-−–]", "'": "['′’]"}
)
_PIECES = re.compile(r"\w+'*|\S")


def spelling(text: str) -> str:
    """A pattern of XML Schema for the spellings of a formula: spaces at will, several signs.

    Examples
    --------
    >>> pattern = spelling("-r^2*x")
    >>> [bool(re.fullmatch(pattern, text)) for text in ("-r^2*x", " − r**2 · x ", "-r2*x")]
    [True, True, False]
    """
    pieces = (
        "".join(_WAYS.get(sign, re.escape(sign)) for sign in piece)
        for piece in _PIECES.findall(text)
    )
    return r"\s*".join(["", *pieces, ""])
