"""Examples: each runs from the command line, ends with code 0 and checks its known answer."""

import os
import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from geomtorsion import scenes

FOLDER = Path(__file__).parent.parent / "examples"
EXAMPLES = sorted(FOLDER.glob("*.py"))
SCENES = sorted((FOLDER / "scenes").glob("*.py"))
ALL = [*EXAMPLES, *SCENES]
EXPECTED = 17
# These take at least a third of a second; `.ci/run` runs all examples as scripts.
LONG = {"dzhanibekov", "18_lines_between_atoms", "04_what_accuracy_costs", "16_dislocation_network",
        "13_paper_equations", "07_tiny_loops", "rolling_disc", "25_a_gait_is_a_loop",
        "22_which_path_does_a_body_take", "23_orbits_of_kerr", "19_how_sure_is_a_number",
        "27_theories_of_your_own", "28_from_a_lagrangian_to_a_universe",
        "29_mass_and_radius_of_stars", "30_symmetries_and_holonomy", "31_is_it_a_new_solution",
        "32_which_effects_matter", "33_parameters_from_data",
        "34_stress_of_dislocations", "35_a_star_that_ends_nowhere", "36_which_particles",
        "37_how_a_hole_rings", "38_does_it_pass_in_the_solar_system",
        "39_how_much_mass_is_inside", "15_burgers_vector_of_an_image",
        "05_through_the_pole", "40_are_my_initial_data_a_solution",
        "41_how_many_degrees_of_freedom", "42_how_fast_are_gravitational_waves",
        "43_theorems_in_three_lines", "44_the_shadow_of_a_hole", "46_motions_in_pieces",
        "47_stars_from_a_table"}  # fmt: skip
RUN = [pytest.param(x, marks=pytest.mark.slow) if x.stem in LONG else x for x in ALL]


def test_examples_are_found_and_numbered():
    """The examples are numbered from 01 without a gap."""
    assert len(EXAMPLES) >= EXPECTED
    assert {path.stem for path in ALL} >= LONG
    assert [path.name[:3] for path in EXAMPLES] == [f"{n + 1:02}_" for n in range(len(EXAMPLES))]


def test_every_shipped_scene_has_an_example():
    """A Python script builds each shipped scene, some scripts several related ones."""
    texts = "".join(path.read_text("utf-8") for path in SCENES)
    assert len(scenes.names()) >= 16
    assert not [name for name in scenes.names() if f'"{name}"' not in texts]


def run(path: Path) -> subprocess.CompletedProcess[str]:
    """Run an example in a fresh process that imports the same package as the tests."""
    return subprocess.run(
        [sys.executable, "-W", "error", str(path)],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        cwd=FOLDER.parent,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )


def test_an_example_runs_as_a_script():
    """An example runs in a process of its own, as in `.ci/run`."""
    done = run(EXAMPLES[0])
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()
    assert not done.stderr


@pytest.mark.parametrize("path", RUN, ids=lambda path: path.stem)
def test_example_runs(path, monkeypatch, capfd, tmp_path):
    """An example prints something, warns of nothing and its assertions hold; modules are loaded."""
    monkeypatch.setattr(sys, "argv", [path.name])
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(path), run_name="__main__")
    printed = capfd.readouterr()
    assert printed.out.strip()
    assert not printed.err


@pytest.mark.parametrize(
    ("name", "arguments"),
    [("scenes/rolling_disc.py", ["--turning", "-2"]), ("scenes/missile.py", ["--spin", "0"]),
     ("scenes/thrown_body.py", ["--t", "20"]),
     ("08_development_and_defects.py", ["--step=-0.2"])],
)  # fmt: skip
def test_other_values_are_as_good(name, arguments, monkeypatch, capfd):
    """Known answers also hold in the other sense and where a formula divides by zero."""
    monkeypatch.setattr(sys, "argv", [name, *arguments])
    runpy.run_path(str(FOLDER / name), run_name="__main__")
    assert capfd.readouterr().out.strip()


@pytest.mark.parametrize("path", ALL, ids=lambda path: path.stem)
def test_example_is_a_lesson(path, monkeypatch, capsys):
    """Each example has a docstring, main(), a command line and an assertion in main."""
    text = path.read_text(encoding="utf-8")
    assert text.startswith('"""')
    assert "argparse.ArgumentParser" in text
    assert re.search(r"^def main\(", text, re.MULTILINE)
    assert re.search(r"^    assert ", text.split("def main(")[1], re.MULTILINE)
    assert text.rstrip().endswith("main()")
    monkeypatch.setattr(sys, "argv", [path.name, "--help"])
    with pytest.raises(SystemExit) as ended:
        runpy.run_path(str(path), run_name="__main__")
    assert ended.value.code == 0
    assert "usage" in capsys.readouterr().out


def test_options_of_the_first_examples(monkeypatch, capfd):
    """The options of the first two examples change their output."""
    any_tetrad, paper = EXAMPLES[:2]
    monkeypatch.setattr(sys, "argv", [any_tetrad.name, "--throat", "1/2", "--at", "0"])
    runpy.run_path(str(any_tetrad), run_name="__main__")
    assert "192" in capfd.readouterr().out  # 12 / b^4 at the throat
    monkeypatch.setattr(sys, "argv", [paper.name, "--order", "zxz"])
    runpy.run_path(str(paper), run_name="__main__")
    assert capfd.readouterr().out.strip()
