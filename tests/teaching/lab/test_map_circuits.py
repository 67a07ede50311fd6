"""Circuits in uploaded maps: known Burgers vectors, separate errors, figures."""

from __future__ import annotations

import re
from math import radians, sin
from pathlib import Path

import numpy as np
import pytest

from geomtorsion import SampledFrame
from geomtorsion.errors import GeomtorsionError
from geomtorsion.teaching.lab.controls import map_case
from geomtorsion.teaching.lab.map_circuits import map_circuit, map_facts
from geomtorsion.teaching.lab.maps import uploaded
from geomtorsion.teaching.lab.uploads import read_map
from tests.teaching.lab.maps import STEP, TILT, TWIST, atoms, saved, twisted, wall_ctf


@pytest.mark.parametrize("end", [".npz", ".csv"])
@pytest.mark.parametrize("side", [1, 4, 7])
def test_a_circuit_in_a_frame_of_even_torsion(tmp_path: Path, end: str, side: int):
    """b is the torsion times the area, with a sentence and a figure."""
    found = map_circuit(saved(twisted(), tmp_path, end), "a", [10, 9], side)
    assert found["b"] == pytest.approx([TWIST * (side * STEP) ** 2], abs=1e-9)
    assert found["unit"] == "um"
    assert found["interpolation"] < 1e-9
    assert f"{side} × {side} cells" in found["sentence"]
    assert "hole, boundary or edge" in found["picture"]


def test_noise_excludes_the_interpolation_error(tmp_path: Path):
    """The stated noise is the scatter of b over many circuits, without the interpolation error."""
    rng = np.random.default_rng(5)
    exact, sigma = twisted((60, 60)), 0.01
    noisy = SampledFrame(
        exact.axes, exact.coframe + rng.normal(0, sigma, exact.coframe.shape), unit="um"
    )
    found = uploaded(read_map(saved(noisy, tmp_path, ".npz"), "a", None, None))
    ends = [found.circuit([i, k], 4) for i in range(4, 53, 6) for k in range(4, 53, 6)]
    scatter = np.std([one["b"][0] for one in ends])
    assert ends[40]["noise"][0] == pytest.approx(scatter, rel=0.25)
    assert "noise" in ends[0]["sentence"]
    assert "interpolation" in ends[0]["sentence"]


def test_a_descending_axis_changes_nothing(tmp_path: Path):
    """A map listed backwards along y gives the same b and the same image."""
    frame = twisted()
    x, y = frame.axes
    back = SampledFrame([x, y[::-1]], frame.coframe[..., ::-1], unit="um")
    content = saved(back, tmp_path, ".npz")
    facts = map_facts(content, "a")
    case = map_case(facts, {"x": float(x[10]), "y": float(y[9]), "side": 3 * STEP}, True)
    assert case == {"centre": [10, len(y) - 1 - 9], "side": 3}
    found = map_circuit(content, "a", **case)
    assert found["b"] == pytest.approx([TWIST * (3 * STEP) ** 2], abs=1e-9)
    both = (
        map_circuit(content, "a", [10, len(y) - 1 - 9], 4),
        map_circuit(saved(frame, tmp_path, ".npz"), "a", [10, 9], 4),
    )
    one, two = (re.findall(r"base64,[^\"]*", one["picture"]) for one in both)
    assert one == two


def test_a_tilt_wall_of_a_map_of_orientations():
    """b of a circuit across the wall is 2 sin(theta/2) times its length; beside it b is zero."""
    content = wall_ctf()
    facts = map_facts(content, "wall.ctf")
    assert facts["shape"] == [24, 20]
    assert "Nickel" in facts["sentence"]
    found = map_circuit(content, "wall.ctf", [12, 10], 6)
    assert np.linalg.norm(found["b"]) == pytest.approx(6 * 2 * sin(radians(TILT) / 2), rel=1e-6)
    assert "axes of the crystal" in found["sentence"]
    beside = map_circuit(content, "wall.ctf", [5, 10], 6)
    assert np.linalg.norm(beside["b"]) < 1e-9


def test_a_circuit_that_leaves_the_map_is_refused_with_a_picture(tmp_path: Path):
    """The reason is a sentence, and the figure shows the requested circuit."""
    for content in (saved(twisted(), tmp_path, ".npz"), wall_ctf()):
        found = map_circuit(content, "a", [0, 0], 6)
        assert "b" not in found
        assert found["refused"]
        assert found["picture"].count('id="circuit"') == 2
    said = map_circuit(wall_ctf(), "a", [0, 5], 6)["refused"]
    assert said == (
        "expected a circuit inside the map, got a corner at column -3, row 2. Choose another "
        "centre, or a smaller side."
    )


def test_a_hole_is_grey_and_refused_where_it_is_touched(tmp_path: Path):
    """A side through the hole is refused with the reason; a circuit around the hole has a b."""
    content = saved(twisted(hole=True), tmp_path, ".npz")
    assert "holes: 1" in map_facts(content, "a")["sentence"]
    assert "hole" in map_circuit(content, "a", [4, 5], 2)["refused"]
    around = map_circuit(content, "a", [4, 4], 6)
    assert around["b"] == pytest.approx([TWIST * (6 * STEP) ** 2], abs=1e-9)


def test_invalid_sides_are_refused(tmp_path: Path):
    """A side of zero, or larger than the map, is refused."""
    for side in (0, 500):
        with pytest.raises(GeomtorsionError):
            map_circuit(saved(twisted(), tmp_path, ".npz"), "a", [5, 5], side)


def test_three_axes_are_seen_in_their_middle(tmp_path: Path):
    """In a volume, the plane of the first two axes in the middle of the third is used."""
    axes = [np.arange(8.0), np.arange(9.0), np.arange(7.0)]
    x, y, z = np.meshgrid(*axes, indexing="ij")
    volume = SampledFrame(axes, np.array([[-y * z, x * z, 0 * z]]) / 2)
    content = saved(volume, tmp_path, ".npz")
    assert "middle" in map_facts(content, "a")["sentence"]
    assert map_circuit(content, "a", [4, 4], 2)["b"] == pytest.approx([3 * 4.0])


def test_whole_numbers_of_a_picture():
    """b is (-1, 0) around the core and zero beside it, for each size; outside it is refused."""
    content = atoms(".npy")
    facts = map_facts(content, "atoms.npy")
    assert (facts["shape"], facts["least"], facts["settings"]) == ([256, 256], 2, {})
    for side in (40, 61):
        found = map_circuit(content, "a", [128, 128], side)
        assert found["b"] == [-1, 0]
        assert max(found["noise"]) < 1e-3
        assert "exactly" in found["sentence"]
        assert map_circuit(content, "a", [60, 190], side)["b"] == [0, 0]
    assert "leaves the image" in map_circuit(content, "a", [3, 3], 40)["refused"]
    # Through the core, which is a hole.
    assert "hole" in map_circuit(content, "a", [148, 128], 40)["refused"]
    assert "hole, boundary or edge" not in found["picture"]


def test_choices_about_orientations():
    """A threshold, a Laue group for all phases or one, and the shown phase can be chosen."""
    content = wall_ctf()
    known = map_facts(content, "a")["settings"]
    assert known["phases"] == [[1, "Nickel"]]
    assert len(known["groups"]) == 11
    assert "2 grains at 1°" in map_facts(content, "a", threshold=1.0)["sentence"]
    assert "Nickel: 4/m" in map_facts(content, "a", laue="4/m", phase=1)["sentence"]
    assert "boundary" in map_circuit(content, "a", [12, 10], 6, threshold=1.0)["refused"]
    with pytest.raises(GeomtorsionError, match="Laue group"):
        map_facts(content, "a", laue="cubic")


def test_a_file_without_a_symmetry_asks_for_one():
    """Readable facts are shown with the remedy of the page; a chosen group solves the problem."""
    content = wall_ctf().replace(b"Nickel\t11", b"Nickel\t0")
    facts = map_facts(content, "wall.ctf")
    assert "Choose a Laue group below" in facts["problem"]
    assert "laue={" not in facts["problem"]
    assert facts["shape"] == [24, 20]
    assert facts["settings"]["groups"]
    assert "problem" not in map_facts(content, "wall.ctf", laue="m-3m")
    found = map_circuit(content, "wall.ctf", [12, 10], 6, laue="m-3m")
    assert np.linalg.norm(found["b"]) == pytest.approx(6 * 2 * sin(radians(TILT) / 2), rel=1e-6)
