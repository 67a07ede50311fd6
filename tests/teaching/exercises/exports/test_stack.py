"""STACK: the XML is read and graded again, and Maxima runs its question tests."""

import re
import shutil
import subprocess
from functools import cache
from xml.etree import ElementTree as ET

import pytest

from geomtorsion import exercises
from geomtorsion.teaching.exercises.checking import check_question
from geomtorsion.teaching.exercises.exports.maxima import maxima_matrix
from geomtorsion.teaching.exercises.exports.parts import MISSING
from geomtorsion.teaching.exercises.exports.stack import stack_quiz
from geomtorsion.teaching.exercises.exports.tasks import tasks
from geomtorsion.teaching.exercises.prose import html_of
from tests.benchmarks.maxima import environment
from tests.chosen import few
from tests.teaching.exercises.exports.moodle import (
    StackQuestion,
    as_answered,
    stack_questions,
    text_of,
)

NUMBERS = exercises.names()
SEEDS = (0, 1)
# Fields that Moodle's importer of the question type requires; all others have a default.
NEEDED = (
    "name", "questiontext", "generalfeedback", "defaultgrade", "penalty", "questionvariables",
    "specificfeedback", "questionnote", "questionsimplify", "prtcorrect", "prtincorrect",
)  # fmt: skip
INPUT = ("name", "type", "tans", "boxsize", "insertstars", "forbidfloat", "checkanswertype",
         "mustverify", "showvalidation", "options")  # fmt: skip
NODE = (
    "name", "answertest", "sans", "tans", "testoptions", "quiet", "truescoremode", "truescore",
    "truepenalty", "truenextnode", "trueanswernote", "truefeedback", "falsescoremode",
    "falsescore", "falsepenalty", "falsenextnode", "falseanswernote", "falsefeedback",
)  # fmt: skip


@cache
def exported(number: str) -> list[StackQuestion]:
    return stack_questions(stack_quiz(tasks([number], SEEDS)))


@pytest.mark.parametrize("number", NUMBERS)
def test_references_of_a_question_exist(number):
    """Fields, inputs, trees and tests refer to each other; each node leads to an existing one."""
    for found in exported(number):
        question = found.element
        assert not [tag for tag in NEEDED if question.find(tag) is None]
        asked = text_of(question, "questiontext")
        inputs = [text_of(one, "name") for one in question.findall("input")]
        trees = [text_of(tree, "name") for tree in found.trees]
        assert re.findall(r"\[\[input:(\w+)\]\]", asked) == inputs
        assert re.findall(r"\[\[validation:(\w+)\]\]", asked) == inputs
        assert re.findall(r"\[\[feedback:(\w+)\]\]", asked) == trees
        blocks = r'\[\[(?:(?:input|validation|feedback):\w+|(?:el)?if test="[^"]*"|/if)\]\]'
        shown = ("truefeedback", "falsefeedback", "generalfeedback", "questionnote")
        parts = [asked, *(x.findtext("text", "") for tag in shown for x in question.iter(tag))]
        for part in parts:
            assert not re.search(r"\[\[|\{[@#]", re.sub(blocks, "", part)), part
        for one in question.findall("input"):
            assert not [tag for tag in INPUT if one.find(tag) is None]
        for name in [*found.variables, *inputs]:
            assert re.fullmatch(r"[A-Za-z]+[0-9]*", name), name
        for tree in found.trees:
            nodes = tree.findall("node")
            assert [text_of(node, "name") for node in nodes] == list(map(str, range(len(nodes))))
            assert len({text_of(node, "trueanswernote") for node in nodes}) == len(nodes)
            for place, node in enumerate(nodes):
                assert not [tag for tag in NODE if node.find(tag) is None]
                following = str(place + 1) if place + 1 < len(nodes) else "-1"
                assert text_of(node, "falsenextnode") == following
                assert text_of(node, "truenextnode") == "-1"
                assert text_of(node, "tans") in found.variables
        assert len(question.findall("qtest")) >= 1


@pytest.mark.parametrize("number", few(8, NUMBERS))
def test_variants_are_deployed(number):
    """Each seed of the library is a variant of a question; seeds of STACK count from 1."""
    questions = exported(number)
    assert sorted(seed for found in questions for seed in found.seeds) == list(SEEDS)
    for found in questions:
        deployed = [seed.text for seed in found.element.findall("deployedseed")]
        count = len(found.seeds)
        assert deployed == ([str(k) for k in range(1, count + 1)] if count > 1 else [])
        assert ("stack_seed" in text_of(found.element, "questionvariables")) == (count > 1)


@pytest.mark.parametrize("number", NUMBERS)
def test_round_trip(number):
    """Solutions from the XML are right; mistakes from the XML get their own diagnosis."""
    for found in exported(number):
        for variant, seed in enumerate(found.seeds):
            asked = exercises.load(number, seed).questions
            for question, tree in zip(asked, found.trees, strict=True):
                right, *wrong = tree.findall("node")
                choices = f"options{text_of(tree, 'name').removeprefix('prt')}"
                options = found.value(choices, variant) if question.kind == "choice" else ""
                text = found.value(text_of(right, "tans"), variant)
                said = check_question(question, as_answered(question, text, options))
                assert said.right, (seed, question.name, text, said)
                met = 0
                for node in wrong:
                    code = re.sub(r"-[0-9]+$", "", text_of(node, "description"))
                    text = found.value(text_of(node, "tans"), variant)
                    if text == MISSING or code == "rounded":
                        continue
                    met += 1
                    answer = as_answered(question, text, options)
                    said = check_question(question, answer)
                    assert not said.right, (seed, question.name, answer)
                    assert code in said.codes, (seed, question.name, code, answer, said)
                assert met == len(question.mistakes)
                told = " ".join(text_of(node, "truefeedback") for node in wrong)
                for mistake in question.mistakes:
                    assert not mistake.message or html_of(mistake.message, tex=True) in told


def test_points_and_symbols():
    """A part has the weight of its question; allowed symbols are listed and explained."""
    [found] = exported("1.4")
    assert [text_of(tree, "value") for tree in found.trees] == ["2", "1"]
    assert text_of(found.element, "defaultgrade") == "3"
    first = found.element.find("input")
    assert first is not None
    assert "dphi1" in text_of(first, "allowwords").split(",")
    assert "The d before a name means a derivative (its dot or prime)." in text_of(
        found.element, "questiontext"
    )


def test_one_variant_needs_no_seed():
    """With a single variant, no text and no variable depends on the seed."""
    text = stack_quiz(tasks(["2.1"], [4]))
    assert "stack_seed" not in text
    assert "variant]" not in text
    assert "is(variant" not in text
    assert "deployedseed" not in text


def test_other_dimensions_are_other_questions():
    """Exercise 2.3 in two and in three dimensions gives two questions of STACK."""
    questions = stack_questions(stack_quiz(tasks(["2.3"], [0, 1, 2])))
    assert len(questions) == 2
    assert all("(seeds " in text_of(found.element, "name") for found in questions)


# -- in Maxima -------------------------------------------------------------------------------------

# A short form of STACK's tests: a difference vanishes in exponentials; numbers are close.
PRELUDE = """\
kill(all)$ reset()$ display2d:false$ linel:1000000$
vanishes(d) := if atom(d) or not (matrixp(d) or listp(d)) then is(radcan(exponentialize(d))=0)
  else every(vanishes, args(d))$
at_algequiv(a,b,o) := if errcatch(a-b)=[] or (matrixp(a) # matrixp(b)) or (listp(a) # listp(b))
  then false else vanishes(a-b)$
near(a,b,o) := is(abs(float(a)-float(b)) < o)$
at_numabsolute(a,b,o) := if listp(a) then (listp(b) and every(lambda([u,v],near(u,v,o)),a,b))
  else (not listp(b) and b # nomistake and near(a,b,o))$
"""


def script(found: StackQuestion, mark: str) -> str:
    """Maxima code for a question's tests in each variant; mark: the start of each output line."""
    question, lines = found.element, [PRELUDE]
    for variant in range(1, len(found.seeds) + 1):
        lines += ["kill(facts)$", f"stack_seed:{variant}$"]
        lines += [
            line.rstrip(";") + "$" for line in text_of(question, "questionvariables").splitlines()
        ]
        for case in question.findall("qtest"):
            given = {text_of(x, "name"): text_of(x, "value") for x in case.findall("testinput")}
            lines += [f"{name}:{value}$" for name, value in given.items()]
            for expected in case.findall("expected"):
                name = text_of(expected, "name")
                [tree] = [tree for tree in found.trees if text_of(tree, "name") == name]
                lines += [
                    line.rstrip(";") + "$"
                    for line in text_of(tree, "feedbackvariables").splitlines()
                ]
                walk = '"nowhere"'
                for node in reversed(tree.findall("node")):
                    test = f"at_{text_of(node, 'answertest').lower()}"
                    option = text_of(node, "testoptions") or "0"
                    sides = f"{text_of(node, 'sans')},{text_of(node, 'tans')},{option}"
                    note = text_of(node, "trueanswernote")
                    walk = f'(if {test}({sides}) then "{note}" else {walk})'
                wanted = text_of(expected, "expectedanswernote")
                lines.append(f'print("@", "{mark}", {walk}, "{wanted}")$')
    return "\n".join(lines) + "\n"


def count(found: StackQuestion) -> int:
    """Number of end nodes that the tests of a question reach, in all variants."""
    tests = sum(len(x.findall("expected")) for x in found.element.findall("qtest"))
    return tests * len(found.seeds)


HALVES = ("1.2", "1.3", "2.3", "3.4")


def half(number: str) -> StackQuestion:
    """A question with one test, which answers only with the components i <= j."""
    question = exercises.load(number).questions[0]
    given = {key: x for key, x in question.solution.items() if key[0] <= key[1]}
    assert len(given) < len(question.solution) or question.symmetry == "symmetric"
    slices = [
        {key[1:]: x for key, x in given.items() if key[0] == k} for k in range(question.shape[0])
    ]
    stacked = len(question.shape) == 3
    texts = [maxima_matrix(x, question.shape[1:]) for x in slices] if stacked else [
        maxima_matrix(given, question.shape)]  # fmt: skip
    [found] = stack_questions(stack_quiz(tasks([number], [0])))
    first, *rest = found.element.findall("qtest")
    for case in rest:
        found.element.remove(case)
    for entry, text in zip(first.findall("testinput"), texts, strict=False):
        value = entry.find("value")
        assert value is not None
        value.text = text
    return found


@pytest.fixture(scope="module")
def ends(tmp_path_factory) -> dict[str, list[tuple[str, str]]]:
    """For each mark, the reached and the expected end node of each question test in Maxima.

    All questions share one process, which takes longer to start than most questions to run.
    """
    settings = environment()
    if settings is None:
        pytest.skip("Maxima is not installed")
    program = shutil.which("maxima", path=settings["PATH"])
    assert program is not None
    file = tmp_path_factory.mktemp("maxima") / "questions.mac"
    asked = [(number, found) for number in NUMBERS for found in exported(number)]
    asked += [(f"half of {number}", half(number)) for number in HALVES]
    file.write_text("".join(script(found, mark) for mark, found in asked), "utf-8")
    done = subprocess.run(
        [program, "--very-quiet", "-b", str(file)], capture_output=True, text=True,
        env=settings, timeout=300, check=True,
    )  # fmt: skip
    rows: dict[str, list[tuple[str, str]]] = {}
    found_rows = re.findall(
        r"^@ (half of [0-9.]+|[0-9.]+) (\S+) (\S+)\s*$", done.stdout, re.MULTILINE
    )
    for mark, end, wanted in found_rows:
        rows.setdefault(mark, []).append((end, wanted))
    assert len(found_rows) == sum(count(found) for _, found in asked), done.stdout[-3000:]
    return rows


@pytest.mark.parametrize("number", NUMBERS)
def test_maxima_ends_at_the_expected_nodes(number, ends):
    """Each question test of each variant ends at its expected node."""
    assert len(ends[number]) == sum(map(count, exported(number))) > 0
    assert not [row for row in ends[number] if row[0] != row[1]]


@pytest.mark.parametrize("number", HALVES)
def test_half_of_a_symmetric_answer_in_maxima(number, ends):
    """Components with i <= j are enough for a right answer, as in the library."""
    trees = len(half(number).trees)
    assert set(ends[f"half of {number}"]) == {
        (f"prt{k}-right", f"prt{k}-right") for k in range(1, trees + 1)
    }


def test_the_export_is_xml_of_one_kind():
    """The file is declared as UTF-8, and an XML parser reads it."""
    text = stack_quiz(tasks(["3.1"], [0]))
    assert text.startswith('<?xml version="1.0" encoding="UTF-8"?>')
    assert ET.fromstring(text).tag == "quiz"
