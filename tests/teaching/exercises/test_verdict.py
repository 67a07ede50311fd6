"""Diagnoses: which of them applies to which question, and its message."""

import pytest
import sympy as sp

from geomtorsion import exercises
from geomtorsion.errors import UnknownNameError
from geomtorsion.teaching.exercises.checking import check_question
from geomtorsion.teaching.exercises.question import ANGLES
from geomtorsion.teaching.exercises.verdict import TITLES, TORSION, message_of
from tests.chosen import few

SEEDS = range(6)
NUMBERS = exercises.names()
# Question -> the mistakes that are computed for it in any of six variants.
MISTAKES = {
    ("1.1", "legs"): "factor inverse permuted sign",
    ("1.2", "metric"): "factor inverse permuted sign",
    ("1.2", "volume"): "another factor inverse sign",
    ("1.3", "anholonomy"): "factor permuted sign",
    ("1.3", "closed"): "another",
    ("1.4", "rates"): "axes factor inverse sign",
    ("1.4", "lock"): "factor inverse sign",
    ("2.1", "connection"): "factor inverse levi-civita permuted sign",
    ("2.2", "connection"): "factor inverse levi-civita permuted sign",
    ("2.3", "torsion"): "basis factor levi-civita permuted sign",
    ("2.3", "vector"): "basis factor sign",
    ("2.4", "torsion"): "axes basis factor permuted",
    ("2.4", "scalar"): "factor levi-civita",
    ("3.1", "cartan"): "levi-civita",
    ("3.1", "riemann"): "cartan",
    ("3.1", "torsion"): "levi-civita",
    ("3.2", "christoffel"): "cartan factor inverse permuted sign",
    ("3.3", "ricci"): "basis cartan factor sign",
    ("3.3", "scalar"): "cartan factor sign",
    ("3.4", "ricci"): "basis cartan factor sign",
    ("3.4", "scalar"): "cartan factor sign",
    ("3.5", "scalar"): "cartan factor sign",
    ("3.5", "surface"): "cartan sign",
    ("4.1", "radius"): "factor levi-civita sign",
    ("4.1", "angle"): "basis degrees factor levi-civita sign",
    ("4.2", "force"): "basis factor inverse levi-civita sign",
    ("4.3", "equations"): "factor levi-civita sign",
    ("4.4", "compass"): "degrees factor levi-civita sign",
    ("4.4", "circle"): "cartan degrees factor sign",
    ("4.2", "same"): "",
    ("4.5", "torsion"): "factor sign",
    ("4.5", "integrable"): "",
    ("4.4", "cosine"): "",
    ("5.1", "burgers"): "direction factor",
    ("5.2", "burgers"): "direction factor forgotten",
    ("5.3", "burgers"): "basis direction factor forgotten",
    ("5.4", "around"): "direction factor forgotten",
    ("5.4", "beside"): "another",
    ("5.5", "riemann"): "cartan degrees direction factor forgotten",
    ("5.5", "cartan"): "levi-civita",
    ("5.6", "burgers"): "direction factor forgotten",
    ("5.6", "length"): "factor forgotten sign",
    ("5.6", "handed"): "direction",
    ("5.7", "burgers"): "direction factor permuted",
    ("5.7", "place"): "direction",
    ("5.7", "larger"): "forgotten sign",
    ("6.1", "equations"): "axes factor naive principle sign",
    ("6.2", "moment"): "axes basis factor inverse sign",
    ("6.3", "terms"): "axes factor naive sign",
    ("6.4", "body"): "axes factor sign",
    ("6.4", "space"): "axes factor forgotten sign",
    ("6.5", "equations"): "axes forgotten naive principle sign",
    ("6.6", "torsion"): "another factor sign",
    ("6.6", "force"): "factor forgotten sign",
    ("6.6", "radius"): "factor forgotten sign",
    ("6.6", "apart"): "factor forgotten sign",
    ("6.6", "principle"): "naive principle",
    ("6.6", "law"): "principle",
    ("7.1", "line"): "forgotten",
    ("7.1", "flux"): "forgotten",
    ("7.2", "order"): "another forgotten",
    ("7.2", "points"): "forgotten",
    ("7.3", "length"): "another basis factor",
    ("7.3", "twice"): "another",
    ("7.4", "omega"): "forgotten",
    ("7.4", "angles"): "another forgotten",
    ("7.4", "quaternion"): "forgotten",
    ("7.4", "straightest"): "levi-civita",
}
# Only in these questions a message mentions the index that differentiates and S = T/2.
ABOUT_TORSION = {
    ("1.3", "anholonomy"), ("2.3", "torsion"), ("2.3", "vector"), ("2.4", "torsion"),
    ("4.2", "force"), ("6.6", "torsion"), ("6.6", "force"),
}  # fmt: skip
# Mistake -> the chapters or exercises that contain the two notions that it confuses.
WHERE = {
    # Two connections of one frame, or their autoparallels.
    "levi-civita": ("2", "3.1", "4", "5.5", "7.4"),
    "cartan": ("3", "4.4", "5.5"),
    # A frame and coordinates, and components that differ in them.
    "basis": ("1.3", "2.3", "2.4", "3.3", "3.4", "4.1", "4.2", "5.3", "6.2", "7.3"),
    # A loop has a direction.
    "direction": ("5",),
    # A body rotates, described in body axes or in space axes.
    "axes": ("1.4", "2.4", "6.1", "6.2", "6.3", "6.4", "6.5"),
    "naive": ("6",),
    "principle": ("6",),
    # The coframe or the metric is used, and its inverse could be confused with it.
    "inverse": ("1.1", "1.2", "1.4", "2.1", "2.2", "3.2", "4.2", "6.2"),
}


def questions(number: str, seed: int = 0):
    """The questions of an exercise."""
    return exercises.load(number, seed).questions


@pytest.fixture(scope="module")
def found():
    """(number, question) -> its mistakes in all seeds, each with its question."""
    table: dict[tuple[str, str], list] = {}
    for number in NUMBERS:
        for seed in SEEDS:
            for question in questions(number, seed):
                cases = table.setdefault((number, question.name), [])
                cases += [(question, mistake) for mistake in question.mistakes]
    return table


def test_the_table_is_whole(found):
    """Each question of each exercise has exactly these mistakes."""
    assert {key: set(text.split()) for key, text in MISTAKES.items()} == {
        key: {mistake.code for _, mistake in cases} for key, cases in found.items()
    }
    assert len(MISTAKES) >= 49


def test_each_mistake_makes_sense_where_it_is_looked_for(found):
    """Each mistake has a title and fits its question, such as degrees for an angle."""
    counted = 0
    for (number, name), cases in found.items():
        for question, mistake in cases:
            place = (number, name, mistake.code)
            assert mistake.code in TITLES, place
            allowed = WHERE.get(mistake.code)
            assert allowed is None or number.startswith(allowed), place
            if mistake.code == "degrees":
                assert question.unit in ANGLES, place
            if mistake.code in ("sign", "factor") and not mistake.message:
                assert question.kind != "choice", place
                assert question.solution, place
            if mistake.code == "permuted" and not mistake.message:
                assert len(question.shape) == 3, place
            counted += 1
    assert counted > 1000


def message_for(question, mistake) -> str:
    """The message for a mistake, if it is the only one that fits."""
    return mistake.message or message_of(mistake.code, question.remarks)


def test_only_questions_about_torsion_mention_it(found):
    """Seven questions mention the derivative index and S = T/2; metrics and radii do not."""
    mentioned = set()
    for key, cases in found.items():
        for question, mistake in cases:
            text = message_for(question, mistake)
            if any(remark in text for remark in TORSION.values()):
                mentioned.add(key)
            elif key[0] in ("1.2", "3.2", "3.3", "5.4", "5.5", "6.4"):
                assert "T/2" not in text
                assert "lower index" not in text
    assert mentioned == ABOUT_TORSION


@pytest.mark.parametrize(
    ("number", "name", "answer", "message"),
    [
        ("1.2", "volume", "-sin(phi2)", "The sign is wrong."),
        ("3.2", "christoffel", "-cot(phi2)", "The sign is wrong."),
        ("3.3", "scalar", "-2/R^2", "The sign is wrong."),
        ("3.3", "scalar", "4/R^2", "It is off by a factor 2."),
        ("5.1", "burgers", "3 = A", "The loop was traversed in the opposite direction."),
        ("5.4", "around", "3 = -2*b", "The loop was traversed in the opposite direction."),
        ("5.4", "around", "3 = 4*b", "It is off by a factor 2."),
        ("5.7", "burgers", "2 = -1", "The component along $x$ comes first."),
        ("5.5", "riemann", "-0.148694", "The loop was traversed in the opposite direction."),
        ("6.4", "body", "(A - C)*w/A", "The sign is wrong."),
        ("6.6", "radius", "0.25", "It is off by a factor 2."),
        ("6.6", "radius", "1", "That is the diameter."),
    ],
)
def test_messages_match_their_questions(number, name, answer, message):
    """The message equals the text for this question word by word."""
    assert exercises.load(number).check({name: answer})[name].message == message


@pytest.mark.parametrize(
    "number", few(6, [n for n in NUMBERS if n[0] in "1234" or n in ("5.1", "6.4")])
)
def test_roots_are_named_only_where_there_are_roots(number):
    """An answer in another symbol or by another number is wrong, not "right on a part"."""
    for question in (*questions(number), *questions(number, 1)):
        if question.kind in ("expression", "components") and question.solution:
            key, right = min(question.solution.items())
            for wrong in others(sp.sympify(right), question.domain.symbols):
                value = {**question.solution, key: wrong}
                given = ";".join(f"{','.join(str(k + 1) for k in at)} = {x}"
                                 for at, x in value.items()) if key else str(wrong)  # fmt: skip
                verdict = check_question(question, given.replace("_d", "'"))
                assert verdict.diagnosis not in ("domain", "unreadable"), (wrong, verdict)


def others(right, symbols):
    """Expressions similar to the right one, but not equal to it."""
    first = symbols[0] if symbols else sp.S.One
    found = [right.xreplace({x: y, y: x}) for x in symbols for y in symbols]
    found += [f(x) for x in symbols for f in (lambda x: x / 3, sp.cot)]
    return [x for x in (*found, right + 1, right * first, sp.S.One, sp.pi) if x != right]


def test_messages_for_a_wrong_branch():
    """The message blames the sign of a root, or the single value of an inverse function."""
    exercise = exercises.load("1.1")
    roots = {"1,1": "sqrt(cos(phi)^2)", "1,2": "sin(phi)", "2,1": "-sin(phi)/r",
             "2,2": "cos(phi)/r"}  # fmt: skip
    told = exercise.check({"legs": roots})["legs"]
    assert (told.diagnosis, "a root has the wrong sign" in told.message) == ("domain", True)
    inverse = {**roots, "1,1": "cos(phi) + acos(cos(phi)) - phi"}
    told = exercise.check({"legs": inverse})["legs"]
    assert (told.diagnosis, "an inverse function" in told.message) == ("domain", True)
    assert "root" not in told.message


@pytest.mark.parametrize("name", ["ricc", "", None, 3, ["ricci"]])
def test_a_verdict_on_nothing_is_refused(name):
    """An unknown name is refused; with StopIteration, a loop of the caller would end silently."""
    verdict = exercises.check("3.3", {"scalar": "2/R^2"})
    assert verdict["scalar"].right
    with pytest.raises(UnknownNameError, match=r"exercise 3.3: .* There are ricci, scalar"):
        verdict[name]


def test_rounding_is_not_blamed_for_estimates():
    """An estimate that is far off gets no diagnosis of rounding."""
    for answer, code in (("20", ""), ("8.1", "right")):
        told = exercises.load("7.1").check({"line": answer})["line"]
        assert ("right" if told.right else told.diagnosis) == code
    assert exercises.load("7.2").check({"points": "60"})["points"].diagnosis == ""


def test_numbers_counted_from_zero():
    """Several numbers may be given by indices; indices that start at 0 are recognised."""
    vector = exercises.load("5.3").solution()["burgers"]
    text = "; ".join(f"{key[0]} = {float(x):.6f}" for key, x in vector.items())
    assert exercises.load("5.3").check({"burgers": text})["burgers"].diagnosis == "counted"
