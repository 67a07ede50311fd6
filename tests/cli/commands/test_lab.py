"""lab: folders that need no server, and what is said where one cannot be made."""

from pathlib import Path

import pytest

from tests.cli.running import run


@pytest.mark.parametrize("option", [["--live"], ["--cache", "x"]])
def test_live_is_for_export(option: list[str]):
    """A served page is live anyhow."""
    error = run("lab", *option, code=2).stderr
    assert "--export" in error
    assert "Traceback" not in error


def test_live_without_a_network(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """What was needed, what came, what to do; and nothing is written."""
    monkeypatch.setenv("PATH", str(tmp_path))
    cache, target = tmp_path / "cache", tmp_path / "course"
    error = run("lab", "--export", str(target), "--live", "--cache", str(cache), code=2).stderr
    assert "npm is not installed" in " ".join(error.split())
    assert "Traceback" not in error
    assert not target.exists()
