"""check: identities, known answers, and exit codes."""

from dataclasses import replace
from pathlib import Path

from geomtorsion.spaces import load
from geomtorsion.spaces.space import KnownAnswer
from tests.cli.running import run

DATA = Path(__file__).parent.parent.parent / "data"


def test_check_of_a_shipped_space():
    """Identities of both connections and all known answers hold."""
    text = run("check", "so3").stdout
    for title in ("Cartan connection", "Levi-Civita connection", "Known answers"):
        assert f"{title}\n" in text
    assert "✗" not in text
    assert text.splitlines()[-1] == f"so3: {text.count('✓')} of {text.count('✓')} checks hold."


def test_check_of_a_file_with_its_own_connection():
    """The connection of the file is also checked."""
    text = run("check", str(DATA / "twisted.toml")).stdout
    assert "The space's own connection" in text
    assert text.count("second Bianchi") == 3


def test_nonmetricity_does_not_fail(tmp_path):
    """A connection need not preserve lengths: metricity has a dash and does not count as failed."""
    file = tmp_path / "bent.toml"
    file.write_text(
        'coordinates = ["x", "y"]\ncoframe = [[1, 0], [0, 1]]\nconnection = {"0,0,0" = "y"}\n'
    )
    text = run("check", str(file)).stdout
    assert "– metricity" in text
    assert "checks hold" in text


def test_check_ends_with_1_when_something_fails(monkeypatch):
    """A wrong known answer is marked, named and counted; the command ends with 1."""
    space = replace(load("s2"), known=(KnownAnswer("scalar_curvature", 7),))
    monkeypatch.setattr("geomtorsion.cli.commands.check.open_space", lambda _: space)
    text = run("check", "s2", code=1).stdout
    assert "✗ Scalar curvature" in text
    assert "expected 7" in text
    assert "1 FAILED" in text


def test_an_attempt_at_code_does_nothing(tmp_path):
    """A file with code in an entry is refused, and the code does not run."""
    trace = tmp_path / "trace"
    file = tmp_path / "evil.toml"
    entry = f"__import__('pathlib').Path('{trace}').touch()"
    file.write_text(f'coordinates = ["x"]\ncoframe = [["{entry}"]]\n')
    error = run("check", str(file), code=2).stderr
    assert "expressions are not code" in error
    assert "coframe, row 1, column 1" in error
    assert not trace.exists()
