"""Larger squares: they replace squares that missing nodes cut off, with their own errors."""

import csv

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.pictures import draw_survey
from geomtorsion.support.precision import CALCULATED

LINE = np.linspace(-10, 10, 101)
X, Y = np.meshgrid(LINE, LINE, indexing="ij")
CORES = {(-6.0, -6.0): 1, (-2.0, 3.0): -1, (5.2, -3.4): 2, (6.0, 6.0): 1, (-7.0, 5.0): -3}


def vortices(radius: float) -> tuple[np.ndarray, np.ndarray]:
    """The coframe of screw dislocations of whole b, and a mask around their cores."""
    values, mask = np.zeros((1, 2, *X.shape)), np.zeros(X.shape, dtype=bool)
    for (a, b), strength in CORES.items():
        r = (X - a) ** 2 + (Y - b) ** 2
        with np.errstate(divide="ignore", invalid="ignore"):
            values += strength * np.array([[-(Y - b), X - a]]) / (2 * np.pi * r)
        mask |= r < radius**2
    return values, mask


@pytest.mark.parametrize("radius", [0.3, 0.7, 1.1])
@pytest.mark.parametrize("size", [1, 2])
def test_squares_at_cores_have_the_b_of_their_core(radius, size):
    """At each core, b is right within its error, and all squares have a b."""
    values, mask = vortices(radius)
    survey = gt.SampledFrame([LINE, LINE], values, order=4, mask=mask).burgers_map(size)
    assert survey.known.all()
    assert survey.sides is not None
    for (a, b), strength in CORES.items():
        at = int(np.abs(LINE - a).argmin()), int(np.abs(LINE - b).argmin())
        assert survey.widened[at]
        missed = abs(survey.vectors[0][at] - strength)
        assert missed < survey.errors[at] < 0.2
        side = survey.sides[at] * 0.2
        assert np.asarray(survey.area)[at] == pytest.approx(side**2, rel=CALCULATED)
        # No square is larger than needed to surround the core.
        assert side <= 2 * (radius + 0.2)
    assert "larger squares of" in repr(survey)


def test_larger_squares_equal_a_survey_of_their_size():
    """b, error, noise and area are the bits of a survey of the larger size."""
    values, mask = vortices(0.3)
    values = values + 0.01 * np.random.default_rng(0).normal(size=values.shape)
    grid = gt.SampledFrame([LINE, LINE], values, mask=mask, sigma=0.01)
    survey = grid.burgers_map(1)
    assert survey.sides is not None
    sides = np.unique(survey.sides[survey.widened]).tolist()
    assert sides == [4]
    larger = grid.burgers_map(4, widen=False)
    for i, j in np.argwhere(survey.widened):
        low = max(i - 3, 0), max(j - 3, 0)
        around = larger.vectors[0, low[0] : i + 1, low[1] : j + 1]
        same = np.argwhere(around == survey.vectors[0, i, j])
        assert len(same) > 0
        at = tuple(same[0] + low)
        assert survey.errors[i, j] == larger.errors[at]
        assert survey.noise[i, j] == larger.noise[at] > 0
    unchanged = ~survey.widened
    alone = grid.burgers_map(1, widen=False)
    assert (survey.vectors[:, unchanged] == alone.vectors[:, unchanged]).all()
    assert (survey.errors[unchanged] == alone.errors[unchanged]).all()
    assert not alone.known[survey.widened].any()


def test_nothing_changes_without_missing_nodes():
    """Without missing nodes, with rectangles, and at the edge no larger square is taken."""
    values = np.array([[-Y, X]]) / 2
    assert gt.SampledFrame([LINE, LINE], values).burgers_map(1).sides is None
    mask = np.zeros(X.shape, dtype=bool)
    mask[50, 50] = mask[0, 20] = True
    grid = gt.SampledFrame([LINE, LINE], values, mask=mask)
    assert (~grid.burgers_map((1, 2)).known).sum() > 4
    survey = grid.burgers_map(1)
    # The hole at the edge has no square around it.
    assert np.argwhere(~survey.known).tolist() == [[0, 19], [0, 20]]
    assert survey.widened.sum() == 4
    # The cells around one missing node share the square of four cells: the mean is the density.
    assert survey.density[survey.known[None]] == pytest.approx(1.0)


@pytest.mark.parametrize("periodic", [False, True])
def test_layers_and_periods(periodic):
    """Cells at the end of a period and in each layer of a solid take their own squares."""
    axes = [np.arange(12.0), np.arange(5.0), np.arange(10.0)]
    x, _, z = np.meshgrid(*axes, indexing="ij")
    values = np.array([[0 * x, 0 * x, np.sin(2 * np.pi * x / 12) + 0 * z]])
    mask = np.zeros(x.shape, dtype=bool)
    mask[0, 1, 4] = mask[6, 2, 5] = True
    periods = (periodic, False, periodic)
    grid = gt.SampledFrame(axes, values, mask=mask, periodic=periods)
    survey = grid.burgers_map(1, (2, 0))
    layers = [int(survey.widened[:, k].sum()) for k in range(5)]
    assert layers == [0, 4 if periodic else 0, 4, 0, 0]
    whole = gt.SampledFrame(axes, values, periodic=periods).burgers_map(2, (2, 0))
    assert survey.vectors[0, 6, 2, 5] == pytest.approx(whole.vectors[0, 5, 2, 4])
    if periodic:
        assert survey.vectors[0, 0, 1, 4] == pytest.approx(whole.vectors[0, -1, 1, 3])


def test_displacements_count_jumps_around_missing_nodes():
    """A displacement with a missing core has the Burgers vector of its cut."""
    angle = np.arctan2(Y + 0.1, X + 0.1) / (2 * np.pi)
    mask = np.hypot(X + 0.1, Y + 0.1) < 0.5
    grid = gt.SampledFrame.from_displacement([LINE, LINE], angle[None], branch=1.0, mask=mask)
    survey = grid.burgers_map(1)
    assert survey.known.all()
    assert np.unique(np.abs(survey.vectors[0][survey.widened])).tolist() == [1.0]
    assert not survey.vectors[0][~survey.widened].any()


def test_tables_arrays_and_figures_contain_the_sides(tmp_path):
    """The table, the arrays, the summary and the caption name the larger squares."""
    values, mask = vortices(0.3)
    survey = gt.SampledFrame([LINE, LINE], values, mask=mask).burgers_map(1)
    survey.write_table(tmp_path / "map.csv")
    lines = (tmp_path / "map.csv").read_text().splitlines()[3:]
    sides = [float(row["cells"]) for row in csv.DictReader(lines)]
    assert sorted(set(sides)) == [1.0, 4.0]
    survey.write_arrays(tmp_path / "map.npz")
    with np.load(tmp_path / "map.npz") as arrays:
        assert (arrays["cells"][..., 0] == survey.sides).all()
    assert survey.summary()["widened"] == survey.widened.sum() > 0
    assert "larger squares of 4 x 4 cells" in draw_survey(survey).texts[0].get_text()
