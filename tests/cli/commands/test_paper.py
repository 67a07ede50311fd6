"""paper: the statements of the paper as text and as JSON."""

import json

import pytest

from geomtorsion.paper import statements
from tests.cli.running import run


@pytest.fixture(scope="module")
def found():
    """All statements, recomputed once."""
    return statements()


def test_text(found):
    """Each statement has its verdict and formula; the last line counts them."""
    text = run("paper").stdout
    for statement in found:
        assert statement.says in text
        assert statement.verdict in text
        assert statement.right in text
    assert text.splitlines()[-1] == "42 claims recomputed: 32 agree, 10 misprints."


def test_json(found):
    """The JSON holds the same statements."""
    data = json.loads(run("paper", "--format", "json").stdout)
    assert [entry["equation"] for entry in data] == [one.equation for one in found]
    assert set(data[0]) == {"equation", "says", "verdict", "right", "note"}


def test_unknown_format():
    """An unknown format is refused with the available ones."""
    assert "'text', 'json'" in run("paper", "--format", "xml", code=2).stderr
