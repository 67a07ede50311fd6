"""Figures of measured fields: panels, arrows and captions."""

# Tests pass wrong types on purpose, as users do, and read attributes that may be missing.
# pyright: reportAttributeAccessIssue=false

import numpy as np
import pytest
from matplotlib.collections import LineCollection

from geomtorsion.loops import Loop
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.maps import Circuit, OrientationMap
from geomtorsion.pictures.measured import draw_circuits, draw_survey
from geomtorsion.pictures.style import save
from geomtorsion.support.outgoing import measured_text
from tests.materials.fields.test_sampled_source import field
from tests.materials.maps.synthetic import wall


def test_a_survey_shows_density_and_significance():
    """The panels show density and significance; arrows mark some of the significant vectors."""
    survey = (wall(2.0, (20, 30), 0.5, sigma=0.01)).burgers_map(4)
    left, right = draw_survey(survey).axes[:2]
    shown = np.asarray(left.collections[0].get_array()).reshape(16, 26)
    assert shown == pytest.approx(survey.per_area.T)
    assert right.collections[0].get_clim() == (0, 2 * survey.level)
    quiver = left.collections[1]
    assert 0 < quiver.N < survey.significant.sum()
    assert np.hypot(quiver.U, quiver.V) == pytest.approx(np.hypot(quiver.U, quiver.V)[0])
    low, high = left.get_ylim()
    assert low > high


def test_a_survey_far_above_its_noise_is_logarithmic():
    """The scale is logarithmic from the noise floor if the values are far above the noise."""
    survey = field(sigma=1e-5).burgers_map(2)
    norm = draw_survey(survey).axes[0].collections[0].norm
    assert norm.vmin == pytest.approx(float(np.median(survey.floor)))
    assert type(norm).__name__ == "LogNorm"
    assert type(
        draw_survey(field(sigma=0.1).burgers_map(2)).axes[0].collections[0].norm
    ).__name__ == ("Normalize")


def test_nothing_known_is_grey():
    """A survey whose circuits all touch a hole is drawn, and the caption states the reason."""
    mask = np.zeros((11, 13), dtype=bool)
    mask[::2, ::2] = True
    figure = draw_survey(field(mask=mask, sigma=0.1, order=2).burgers_map(3))
    assert "touch a hole" in figure.texts[0].get_text()


@pytest.mark.parametrize("kind", ["grid", "map"])
def test_circuits_are_drawn_on_the_data(kind):
    """The circuit is a line, with b and its noise beside it."""
    measured = field(sigma=0.01) if kind == "grid" else wall(2.0, (20, 30), 0.5, sigma=0.01)
    found = measured.burgers(Loop.circle([2.5, 3], 1.5))
    axes = draw_circuits(measured, [found]).axes[0]
    assert np.asarray(axes.lines[0].get_xdata()) == pytest.approx(found.path[0], nan_ok=True)
    texts = [text.get_text() for text in axes.texts]
    assert f"|b| = {measured_text(found.magnitude, found.error, found.unit)}" in texts


def test_boundaries_of_grains_and_circuits_step_by_step(tmp_path):
    """Twelve sides between two grains and four around a hole; a circuit given pixel by pixel."""
    angles = np.zeros((12, 16, 3))
    angles[..., 0] = 0.3 * np.arange(16)
    angles[:, 11:, 0] += 30
    angles[5, 2] = np.nan
    bent = OrientationMap.from_euler(angles, 0.5, "m-3m", sigma=0.05)
    found = bent.burgers(Circuit.square((1, 4), 5))
    assert np.isnan(found.path[0]).sum() == 20
    figure = draw_circuits(bent, [found])
    axes = figure.axes[0]
    assert axes.get_title() == "grains at 5 degrees"
    (sides,) = [one for one in axes.collections if isinstance(one, LineCollection)]
    assert len(sides.get_segments()) == 16
    save(figure, tmp_path / "b.svg")
    assert (tmp_path / "b.svg").stat().st_size > 10_000


def test_a_map_without_clean_circuits():
    """A survey without a known circuit is drawn without warnings, and the caption explains it."""
    angles = np.zeros((6, 6, 3))
    angles[..., 0] = 40 * (np.indices((6, 6)).sum(axis=0) % 2)
    crystal = OrientationMap.from_euler(angles, 0.5, "m-3m", sigma=1)
    survey = crystal.burgers_map(2)
    assert not survey.known.any()
    assert "cross a boundary" in draw_survey(survey).texts[0].get_text()


def test_circuits_of_a_volume_are_drawn_on_sections():
    """Each plane with circuits has a panel, with the section of the volume as background."""
    axes = [np.arange(7.0), np.arange(8.0), np.arange(6.0)]
    x, _y, z = np.meshgrid(*axes, indexing="ij")
    cube = SampledFrame(axes, np.array([[0 * x, x * z, 0 * x]]), sigma=0.01)
    loops = [Loop.circle([4, 3, 2], 1.5, plane=plane) for plane in ((1, 2), (0, 1), (1, 2))]
    figure = draw_circuits(cube, [cube.burgers(loop) for loop in loops])
    panels = [axes for axes in figure.axes if axes.lines]
    assert [axes.get_title() for axes in panels] == [
        "|b| per area of each cell, x = 4",
        "|b| per area of each cell, z = 2",
    ]
    assert [len(axes.lines) for axes in panels] == [4, 2]
    assert panels[0].get_ylabel() == "$z$"


def test_refused_circuits_are_drawn():
    """A refused circuit is dashed, also beside a valid one, and the caption explains the dashes."""
    measured = field(sigma=0.01)
    loop = Loop.circle([2.5, 3], 1.5)
    alone = draw_circuits(measured, [], [loop]).axes[0]
    assert [line.get_linestyle() for line in alone.lines] == ["-", "--"]
    closure = measured.burgers(loop)
    both = draw_circuits(measured, [closure], [Loop.circle([2.5, 3], 1.0)])
    assert len(both.axes[0].lines) == 4
    assert "Dashed" in both.texts[0].get_text()


def test_the_caption_names_only_visible_things():
    """Arrows are named where there are arrows; white is the level itself."""
    with_arrows = draw_survey((wall(2.0, (20, 30), 0.5, sigma=0.01)).burgers_map(4))
    text = " ".join(with_arrows.texts[0].get_text().split())
    assert "arrows: the direction of b" in text
    assert "white: above" not in text
    axes = [np.arange(12.0)] * 2
    noise = 0.1 * np.random.default_rng(2).normal(size=(2, 2, 12, 12))
    frame = SampledFrame(axes, noise, sigma=0.1)
    without = draw_survey(frame.burgers_map(3))
    assert "arrows" not in without.texts[0].get_text()
    one_row = SampledFrame(axes, noise[:1], sigma=0.1)
    circle = Loop.circle([5, 5], 3)
    alone = draw_circuits(one_row, [one_row.burgers(circle)])
    assert not any("rrows" in text.get_text() for text in alone.texts)
    both = draw_circuits(frame, [frame.burgers(circle)])
    assert "grey arrows may be noise" in both.texts[0].get_text()
