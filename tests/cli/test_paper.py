"""paper: the statements of the paper as text and as JSON."""

import json

from typer.testing import CliRunner

from geomtorsion.cli.app import app
from geomtorsion.paper import statements


def test_text():
    """Each statement with its verdict and formula; the last line counts."""
    result = CliRunner().invoke(app, ["paper"])
    assert result.exit_code == 0, result.output
    text = result.stdout
    for statement in statements():
        assert statement.says in text
        assert statement.verdict in text
        assert statement.right in text
    assert text.splitlines()[-1] == "42 claims recomputed: 33 agree, 9 misprints."


def test_json():
    """JSON holds the same statements."""
    result = CliRunner().invoke(app, ["paper", "--format", "json"])
    data = json.loads(result.stdout)
    assert [entry["equation"] for entry in data] == [one.equation for one in statements()]
    assert set(data[0]) == {"equation", "says", "verdict", "right", "note"}


def test_unknown_format():
    """A format that does not exist is refused, with those that do."""
    result = CliRunner().invoke(app, ["paper", "--format", "xml"])
    assert result.exit_code == 2
    assert "text or json" in result.stderr
