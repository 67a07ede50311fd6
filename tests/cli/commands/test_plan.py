"""plan: what is computed for a quantity or a scene, and what is left out."""

from tests.cli.running import run


def test_plan_shows_what_is_left_out():
    """The plan of the Ricci tensor has no torsion in it; --dot is a graph."""
    text = run("plan", "so3", "ricci").stdout
    assert "christoffel" in text
    assert text.index("christoffel") < text.index("ricci", text.index("christoffel"))
    dot = run("plan", "so3", "ricci", "--dot").stdout
    assert dot.startswith("digraph")
    assert "torsion" not in dot
    assert "Did you mean ricci" in run("plan", "so3", "rici", code=2).stderr


def test_plans_of_scenes(tmp_path):
    """Text, graph and picture; a space still needs its quantity."""
    text = run("plan", "lagrange_cusp", "--watch", "nutation").stdout
    assert "6 equations for nutation" in text
    assert "left out" in text
    dot = run("plan", "lagrange_cusp", "--dot").stdout
    assert dot.startswith("digraph plan {")
    assert '"attitude" -> "watch axis"' in dot
    drawn = tmp_path / "plan.svg"
    run("plan", "dzhanibekov", "-o", str(drawn))
    assert drawn.read_text().count("<svg") == 1
    assert "products at most" in run("plan", "so3", "ricci").stdout
    assert "name a quantity of the space" in run("plan", "so3", code=2).stderr
    assert "'nowhere'" in run("plan", "nowhere", code=2).stderr
    assert "Did you mean the scene helix?" in run("plan", "helx", code=2).stderr
    assert "Did you mean the scene helix?" in run("accuracy", "helx", code=2).stderr
