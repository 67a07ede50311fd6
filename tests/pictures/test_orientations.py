"""Orientations: what is drawn is what was found."""

from typing import Any

import numpy as np

from geomtorsion.orientations import Circuit, OrientationMap
from geomtorsion.pictures.orientations import draw_grains, draw_orientations
from geomtorsion.pictures.style import save


def bent():
    """A bent grain, a hole and a grain that is turned by 30 degrees."""
    angles = np.zeros((12, 16, 3))
    angles[..., 0] = 0.3 * np.arange(16)
    angles[:, 11:, 0] += 30
    angles[5, 2] = np.nan
    return OrientationMap.from_euler(angles, 0.5, "m-3m", sigma=0.05)


def test_a_map_of_circuits(tmp_path):
    """Both panels hold the numbers, at the middles of the circuits; what crosses is left out."""
    crystal = bent()
    found = crystal.burgers_map(4)
    figure = draw_orientations(crystal, found)
    density, _, ratio, _ = figure.axes
    mesh: Any = density.collections[0]
    drawn = np.ma.filled(mesh.get_array().astype(float), np.nan).reshape(found.clean.shape)
    assert np.array_equal(drawn, found.per_area, equal_nan=True)
    assert mesh.get_coordinates()[0, 0].tolist() == [0.75, 0.75]
    other: Any = ratio.collections[0]
    assert np.nanmax(other.get_array()) == np.nanmax(found.significance) / 3**0.5
    assert "squares of 2 um" in density.get_title()
    assert density.get_ylim()[0] > density.get_ylim()[1]
    save(figure, tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 10_000


def test_grains_and_a_circuit(tmp_path):
    """The title tells grains, b and its noise; the circuit is drawn step by step."""
    crystal = bent()
    b = crystal.burgers(Circuit.square((1, 4), 5))
    figure = draw_grains(crystal, b)
    title = figure.axes[0].get_title()
    assert title.startswith("2 grains at 5 degrees")
    assert f"{b.size:.3g}" in title
    drawn: list[Any] = list(figure.axes[0].collections)
    _, boundaries, circuit = drawn
    # Twelve sides between the grains, and four round the hole.
    assert len(boundaries.get_segments()) == 16
    assert len(circuit.get_segments()) == 20
    save(figure, tmp_path / "b.svg")
    flat = OrientationMap.from_euler(np.zeros((9, 9, 3)), 0.5, "m-3m", sigma=1)
    told = draw_grains(flat, flat.burgers(Circuit.square((1, 1), 5))).axes[0].get_title()
    assert "no more than noise" in told
    assert told.startswith("1 grain at")


def test_a_map_without_clean_circuits():
    """Nothing to show is shown as nothing, without a warning."""
    angles = np.zeros((6, 6, 3))
    angles[..., 0] = 40 * (np.indices((6, 6)).sum(axis=0) % 2)
    crystal = OrientationMap.from_euler(angles, 0.5, "m-3m", sigma=1)
    found = crystal.burgers_map(2)
    assert not found.clean.any()
    assert len(draw_orientations(crystal, found).axes) == 4
