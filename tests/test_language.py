"""Plain English: the number of hits of `tests.language` falls in each package."""

from pathlib import Path

import pytest

from tests import language

# Occurrences in each package. A number may only fall; it is lowered when the count is lower.
CEILINGS = {
    "exact": 1,
    "geometry": 1,
    "paper": 1,
    "pictures": 5,
    "site": 1,
    "support files": 1,
    "tests": 1,
}


def test_no_package_exceeds_its_ceiling():
    """Each package has at most as many occurrences as its ceiling, which is zero by default."""
    found = {name: one.total() for name, one in language.counts().items()}
    over = {name: count for name, count in found.items() if count > CEILINGS.get(name, 0)}
    assert not over, "python -m tests.language NAME lists them"


def test_ceilings_fall_with_the_counts():
    """No ceiling is far above its count."""
    found = {name: one.total() for name, one in language.counts().items()}
    assert set(CEILINGS) <= set(found)
    high = {name: found[name] for name, most in CEILINGS.items() if found[name] < 0.9 * most - 5}
    assert not high


def test_the_readme_has_none():
    """The README has no ceiling, so it must have no hits."""
    assert "README" not in CEILINGS
    assert language.places()["README"]


@pytest.mark.parametrize(
    ("pattern", "wrong", "right"),
    [
        ("was needed, but", "a number was needed, but 'x' came.", "expected a number, got 'x'."),
        ("is no noun", "it is no number.", "there is no number; it is no longer there."),
        ("what is", "It shows what is left.", "What is torsion?"),
        ("told, said", "The error is told.", "The error is reported."),
        ("stands, lies", "It stands in a file and lies there.", "a Lie group; understand."),
        ("alone", "of the metric alone", "only of the metric"),
        ("round", "once round the loop", "a round metric, around the loop"),
        (", too", "That works, too.", "too many"),
        ("asked for", "the accuracy asked\nfor", "the requested accuracy"),
        ("in the place of", "in the place of a name", "instead of a name"),
        ("anew", "begins anew", "a new one"),
        ("go on", "Motions go on.", "Motions continue."),
        ("left out", "what it left out", "what it omitted"),
        ("that of", "the sign is that of Nye", "the sign of Nye"),
        ("film", "a film of a top", "an animation of a top"),
        ("floor", "the lowest floor", "the lowest layer"),
        ("fronted of", "It ends. Of a grain all is known.", "Of course."),
        ("has not one", "A list has not one number.", "A list does not have one number."),
        ("that they are", "Floats are the numbers that they are.", "Floats are exact fractions."),
        ("drowns", "The value drowns in rounding.", "The value is lost in rounding."),
        ("how sure", "It reports how sure the ranks are.", "How sure is a number?"),
        ("wanted", "Wanted relative error.", "Requested relative error."),
        ("moment of a force", "the moment of a force", "a torque"),
        ("that is none", "periods that are none", "none of them"),
    ],
)
def test_each_pattern_is_found(tmp_path: Path, pattern: str, wrong: str, right: str):
    """A pattern matches its example and not the plain form."""
    for text, expected in ((wrong, True), (right, False)):
        file = tmp_path / "page.md"
        file.write_text(text, "utf-8")
        assert any(hit.pattern == pattern for hit in language.hits_of(file)) is expected


def test_every_pattern_has_an_example():
    """The table above has an example of each pattern."""
    [mark] = getattr(test_each_pattern_is_found, "pytestmark")  # noqa: B009
    assert [row[0] for row in mark.args[1]] == list(language.PATTERNS)


def test_names_in_tests_are_prose(tmp_path: Path):
    """The name of a function in a test counts, at the line of its definition."""
    file = tmp_path / "test_code.py"
    file.write_text("x = 1\n\n\ndef test_periods_that_are_none():\n    alone = said\n", "utf-8")
    assert [(hit.line, hit.pattern) for hit in language.hits_of(file)] == [(4, "that is none")]


def test_code_is_not_prose(tmp_path: Path):
    """Strings and comments count; code, doctests and formulas do not."""
    file = tmp_path / "code.py"
    file.write_text(
        'def said(alone):\n    """It stands\n\n    >>> round(1.5)\n    "told"\n    """\n'
        '    # what is\n    # alone\n    return f"`told` " "as said"\n',
        "utf-8",
    )
    found = [(hit.line, hit.pattern) for hit in language.hits_of(file)]
    assert found == [(2, "stands, lies"), (7, "what is"), (7, "alone"), (9, "told, said")]
