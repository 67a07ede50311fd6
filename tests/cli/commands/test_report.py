"""report: page and data, bases, field equations, and an unwritable directory."""

import json
from pathlib import Path

from tests.cli.running import run

DATA = Path(__file__).parent.parent.parent / "data"


def test_report_of_a_space_and_of_a_file(tmp_path, monkeypatch):
    """The page and the data are written; the default directory has the name of the space."""
    monkeypatch.chdir(tmp_path)
    assert "so3: wrote" in run("report", "so3", "-o", "deep/so3").stdout
    assert json.loads((tmp_path / "deep/so3/geometry.json").read_text("utf-8"))["name"] == "so3"
    run("report", str(DATA / "rindler.toml"))
    assert "rocket" in (tmp_path / "rindler-report" / "index.html").read_text("utf-8")


def test_report_where_it_cannot_be_written(tmp_path):
    """The message names the file that has the name of the directory."""
    (tmp_path / "taken").write_text("")
    error = run("report", "s2", "-o", str(tmp_path / "taken"), code=2).stderr
    assert "taken" in error
    assert "Traceback" not in error


def test_report_in_a_basis(tmp_path):
    """Indices refer to the requested basis."""
    run("report", "s2", "--no-pictures", "--basis", "frame", "-o", str(tmp_path / "frame"))
    run("report", "s2", "--no-pictures", "-o", str(tmp_path / "natural"))
    texts = [
        (tmp_path / name / "geometry.json").read_text("utf-8") for name in ("frame", "natural")
    ]
    bases = [json.loads(text)["quantities"] for text in texts]
    assert bases[0]["ricci"] != bases[1]["ricci"]
    assert "wrong" in run("report", "s2", "--basis", "wrong", code=2).stderr


def test_report_with_field_equations(tmp_path):
    """With -L the page and the data have the equations and identities; motions remain."""
    out = tmp_path / "s2"
    run("report", "schwarzschild_isotropic", "-L", "f(T)", "-o", str(out))
    page = (out / "index.html").read_text("utf-8")
    assert "Field equations" in page
    assert "No motions" not in page
    data = json.loads((out / "geometry.json").read_text("utf-8"))
    assert set(data["field_equations"]["equations"]) == {"E", "E_[ij]"}
    assert [one["holds"] for one in data["checks"]["Field equations"]] == [True, True]
    run(
        *("report", "torsion_bounce", "-L", "R + c*T1 + v", "--constants", "v"),
        *("--no-pictures", "-o", str(out)),
    )
    page = (out / "index.html").read_text("utf-8")
    assert "Connection equation" in page
    assert "Constants: c, v." in page
    assert "-L" in run("report", "s2", "-c", "cartan", code=2).stderr
    assert "-L" in run("report", "s2", "--constants", "n", code=2).stderr
    assert "empty text" in run("report", "s2", "-L", "", "-o", str(out), code=2).stderr
