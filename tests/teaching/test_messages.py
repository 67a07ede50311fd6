"""Messages of the library in the language of a page."""

from __future__ import annotations

import base64
import re
from typing import Any

import pytest

from geomtorsion import exercises
from geomtorsion.teaching.lab.tasks import TaskRunner, answer
from geomtorsion.teaching.messages import in_language

# Entries of a tetrad in r and phi that cannot be read, each for another reason.
UNREADABLE = (
    "rr", "Phi", "0.1*r", "1e5", "r*", "**r", "sin", "sin()", "sin(r,phi)", "(r", "r)", "a(t)",
    "1/0", "1/(r-r)", "__import__('os')", "r!", "2r/3phi", "sin^-1 r", "sin 2r phi", "log(0)",
    "tan(pi/2)", "r**100", "r^(1/33)", "9" * 60, "f(r)", "r,phi", "1,5", "diff(r,r)",
    "Derivative(r)", "I*r", "r==2", "r = 2", "lambda: 1", "'r'", "r;phi", "r..2", "max(r,1)",
    "floor(r)", "r%2", "r//2", "a" * 700, "(" * 30 + "r" + ")" * 30, "2 phi r'",
)  # fmt: skip
# Words of English messages that no German one has.
ENGLISH = {"expected", "the", "is", "and", "or", "write", "got", "not", "of", "this", "may", "row"}


def problems(name: str, language: str = "de", **arguments: Any) -> list[str]:
    """All messages of a request of the page."""
    reply = answer({"task": name, "arguments": arguments | {"language": language}})
    shown = [reply.get("problem", ""), reply.get("refused", ""), *reply.get("errors", {}).values()]
    return [text for text in shown if text]


def entry(text: str, language: str = "de") -> str:
    """The message about an entry of a tetrad."""
    entries = [["1", "0"], ["0", text]]
    [shown] = problems("tetrad", language, coordinates="r, phi", entries=entries)
    return shown


def words(message: str) -> set[str]:
    """Words of a message in small letters, without quoted input and its excerpt."""
    lines = [line for line in message.splitlines() if not line.startswith("    ")]
    return set(re.findall(r"[^\W\d_]+", re.sub(r"'[^']*'|`[^`]*`", " ", " ".join(lines)).lower()))


@pytest.mark.parametrize("text", UNREADABLE)
def test_an_unreadable_entry_has_a_german_message(text: str):
    """The message has no English word, and shows the same excerpt of the input."""
    german, english = entry(text), entry(text, "en")
    assert not words(german) & ENGLISH, german
    excerpts = [
        [line for line in message.splitlines() if line.startswith("    ")]
        for message in (german, english)
    ]
    assert excerpts[0] == excerpts[1]
    assert entry(text, "fr") != english


@pytest.mark.parametrize(
    ("case", "expected"),
    [
        ({"coordinates": "r, r"}, "verschiedene Namen, r steht zweimal"),
        ({"coordinates": ""}, "Koordinaten: es braucht mindestens einen Namen."),
        ({"coordinates": "a b c d e f g"}, "Koordinaten: höchstens 6 sind möglich"),
        ({"signature": "+"}, "Signatur: hier braucht es 2 Vorzeichen"),
        ({"functions": "a"}, "unbekannte Funktionen: hier braucht es Funktionen mit Argumenten"),
        ({"functions": "a()"}, "a braucht Koordinaten oder Parameter als Argumente"),
        ({"entries": [["1", "r"], ["2", "2*r"]]}, "Zeile 2 ist gleich: (2) * Zeile 1."),
        ({"entries": [["0", "0"], ["1", "r"]]}, "Zeile 1 ist null."),
    ],
)
def test_a_wrong_tetrad_has_a_german_message(case: dict[str, Any], expected: str):
    """Names, signature, functions and dependent rows; rows are also counted from 1."""
    case = {"coordinates": "r, phi", "entries": [["1", "0"], ["0", "r"]]} | case
    [shown] = problems("tetrad", **case)
    assert expected in shown
    assert not words(shown) & ENGLISH


@pytest.mark.parametrize(
    ("name", "case", "expected"),
    [
        ("top", {"moments": [1, 2, 3], "omega": [0, 1, 0], "tilt": 0.3, "t": 1.0,
                 "effects": ["torsion", "pivot"]}, "pivot (ein Punkt des Körpers ist fest)"),
        ("top", {"moments": [1, 1, 5], "omega": [0, 1, 0], "tilt": 0.3, "t": 1.0},
         "sind unmöglich, weil 5 > 1 + 1."),
        ("costs", {"kind": "loop", "case": {"space": "wedge_disclination", "centre": [0, 0, 0],
                                            "radius": 0.2, "plane": [0, 1]}}, "Kreis um die Achse"),
        ("loop", {"space": "schwarzschild", "centre": [0, 3, 1, 1], "radius": 5.0,
                  "plane": [0, 1]}, "keinen endlichen Wert"),
        ("answer", {"number": "1.1", "seed": 0, "answers": {"legs": "1" * 5000}},
         "höchstens 4\u202f000 Zeichen"),
    ],
)  # fmt: skip
def test_other_tabs_have_german_messages(name: str, case: dict[str, Any], expected: str):
    """A contradiction, impossible moments, a loop beyond its chart, and a long answer."""
    [shown] = problems(name, **case)
    assert expected in shown
    assert not words(shown) & ENGLISH


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "aber die Datei ist leer."),
        (b"a,b\n1,2", "a.csv: Zeile 1: Die Spalten brauchen verschiedene Namen"),
        (b"x,y,e_0_0,e_0_1\n0,0,1", "a.csv: Zeile 2: Hier braucht es 4 Spalten"),
        (b"\x89PNG\r\n", "a.csv: Die Datei ist nicht lesbar"),
        (b"\xff\xd8\xff", "nicht ein JPEG-Bild"),
        (b"PK\x03\x04", "aber dieses Archiv ist nicht lesbar"),
    ],
)
def test_an_unreadable_file_has_a_german_message(content: bytes, expected: str):
    """An empty file, wrong columns, a short row, and damaged files of three formats."""
    attached = base64.b64encode(content).decode()
    request = {"task": "map_facts", "arguments": {"name": "a.csv", "language": "de"}}
    assert expected in answer(request | {"attached": attached})["problem"]


@pytest.mark.parametrize(
    ("space", "velocity", "expected"),
    [
        ("flat_polar", [-1, 0], "Sie endet bei t = 1, bei r = 0, phi = 0"),
        ("schwarzschild_falling", [1.2, -0.6, 0, 0.2], "(r > 0 gilt nicht mehr)"),
    ],
)
def test_a_curve_that_ends_has_a_german_reason(space: str, velocity: list[float], expected: str):
    """The sentence below two curves ends with the reason why one of them ends early."""
    case = {"space": space, "velocity": velocity, "t": 25.0, "language": "de"}
    sentence = answer({"task": "paths", "arguments": case})["sentence"]
    assert expected in sentence
    assert not words(sentence) & ENGLISH


@pytest.mark.parametrize(
    ("number", "text", "expected"),
    [
        ("1.1", "1", "legs: hier braucht es Komponenten, nicht '1'."),
        ("1.1", "1,3 = 2", "ein Index liegt hier zwischen 1 und 2"),
        ("1.1", "1,1,1 = 2", "hier braucht es 2 Indizes, in '1,1,1' sind es 3."),
        ("3.2", "sin(q)", "q kommt in dieser Frage nicht vor"),
        ("3.2", "1/2r phi2", "kann man auf zwei Arten lesen. Schreibe (1/2)*r oder 1/(2*r)."),
        (
            "4.1",
            "1,5",
            "radius: hier braucht es eine Zahl mit Dezimalpunkt, nicht 1,5. Schreibe 1.5.",
        ),
    ],
)
def test_an_unreadable_answer_has_a_german_message(number: str, text: str, expected: str):
    """Components, indices, names, ambiguous products, units, and a decimal comma."""
    exercise = exercises.load(number, language="de")
    first = exercise.questions[0].name
    message = exercise.check({first: text})[first].message
    assert expected in message
    assert not words(message) & ENGLISH


def test_limits_of_the_page_have_german_messages():
    """A request that is too long, and a task that does not exist."""
    runner = TaskRunner(workers=1)
    try:
        shown = runner.ask("tetrad", coordinates="r" * 30_000, entries=[], language="de")["problem"]
        assert shown.startswith("höchstens 24\u202f000 Zeichen sind möglich, hier sind es 30")
        unknown = runner.ask("dance", language="de")["problem"]
        assert unknown.startswith("Diese Meldung gibt es nur auf Englisch: expected the name of")
        assert runner.ask("dance", language="xx")["problem"].startswith("expected the name of")
    finally:
        runner.close()


def test_input_in_a_message_stays():
    """Quoted input is not translated, even where it reads as a part of a message."""
    for text in ("'row 1 or row 2'", "'@'"):
        assert in_language(f"{text} is not part of an expression", "de").startswith(text)
    assert in_language("", "de") == ""
    assert in_language("division by zero") == "division by zero"
    assert in_language("a sentence that nobody wrote", "fr").endswith("that nobody wrote")
