"""plan: the computed and the omitted steps of a quantity or a scene."""

from tests.cli.running import run


def test_plan_shows_omitted_parts():
    """The plan of the Ricci tensor contains no torsion; --dot prints a graph."""
    text = run("plan", "so3", "ricci").stdout
    assert "christoffel" in text
    assert text.index("christoffel") < text.index("ricci", text.index("christoffel"))
    dot = run("plan", "so3", "ricci", "--dot").stdout
    assert dot.startswith("digraph")
    assert "torsion" not in dot
    assert "Did you mean ricci" in run("plan", "so3", "rici", code=2).stderr


def test_plans_of_scenes(tmp_path):
    """A scene has a plan as text, graph and figure; a space needs a quantity; typos get a hint."""
    text = run("plan", "lagrange_cusp", "--watch", "nutation").stdout
    assert "6 equations for nutation" in text
    assert "omitted" in text
    dot = run("plan", "lagrange_cusp", "--dot").stdout
    assert dot.startswith("digraph plan {")
    assert '"attitude" -> "watch axis"' in dot
    drawn = tmp_path / "plan.svg"
    run("plan", "dzhanibekov", "-o", str(drawn))
    assert drawn.read_text().count("<svg") == 1
    assert "products at most" in run("plan", "so3", "ricci").stdout
    assert "expected a quantity of the space, got none" in run("plan", "so3", code=2).stderr
    assert "'nowhere'" in run("plan", "nowhere", code=2).stderr
    assert "Did you mean the scene helix?" in run("plan", "helx", code=2).stderr
    assert "Did you mean the scene helix?" in run("price", "helx", code=2).stderr


def test_lacking_effects_of_a_scene():
    """The effects that a scene lacks are shown with their influence; spaces have none."""
    text = run("plan", "missile", "--lacking").stdout
    assert "quadratic_drag      7.3e-01  velocity  coefficient = 0.157 kg/m" in text
    assert "Nothing is added" in text
    assert "--lacking: expected a scene" in run("plan", "so3", "ricci", "--lacking", code=2).stderr


def test_angles_at_the_start_have_both_units(tmp_path):
    """A plain number in a scene file is radians; plan and run print radians and degrees."""
    file = tmp_path / "top.toml"
    text = """watch = ["nutation"]
t = 0.01

[body]
moments = [1, 1, 0.5]

[start]
omega = [0, 0, 20]
euler = [0, 0.5, "90 deg"]
"""
    file.write_text(text, "utf-8")
    wanted = "starts at Euler angles (zyz) 0, 0.5, 1.5708 rad, which are 0, 28.6479, 90 degrees"
    assert wanted in run("plan", str(file)).stdout
    assert wanted in run("run", str(file)).stdout


def test_options_of_scenes_are_refused_for_spaces(tmp_path):
    """Options of scenes are refused for spaces, because the figure would never be drawn."""
    drawn = tmp_path / "plan.svg"
    assert "--output: expected a scene, got the space" in run(
        "plan", "so3", "ricci", "-o", str(drawn), code=2
    ).stderr  # fmt: skip
    assert "--watch: expected a scene, got the space" in run(
        "plan", "so3", "ricci", "--watch", "omega", code=2
    ).stderr  # fmt: skip
