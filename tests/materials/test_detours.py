"""Detours: circuits go around missing nodes of fields, maps and images, with their deviation."""

from dataclasses import replace

import numpy as np
import pytest

from geomtorsion.errors import GeomtorsionError, GridError, ImageError, OrientationError
from geomtorsion.loops import Loop
from geomtorsion.materials.detours import Passages
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.images import LatticeImage
from geomtorsion.materials.maps import Circuit, OrientationMap
from geomtorsion.materials.rings import Rings
from geomtorsion.materials.windows import Windows
from tests.rounding import ROUNDED

AXES = [np.linspace(0, 1, 81), np.linspace(2, 3.2, 97)]
X, Y = np.meshgrid(*AXES, indexing="ij")
VALUES = np.array([[-Y, X]]) / 2 + 0.1 * np.array([[np.cos(3 * Y), 0 * X]])


def scattered_nodes(shape: tuple[int, ...], share: float, seed: int = 0) -> np.ndarray:
    """A mask that is True at a share of all nodes."""
    return np.random.default_rng(seed).random(shape) < share


def wavy_map(shift: float = 0.0, noise: float = 0.02, seed: int = 1) -> OrientationMap:
    """A bent crystal of 60 x 70 pixels, with noise in degrees."""
    y, x = np.mgrid[:60, :70]
    angles = np.zeros((60, 70, 3))
    angles[..., 0], angles[..., 1] = 0.02 * x + 0.0002 * y**2, 20 + 0.01 * y
    angles += np.random.default_rng(seed).normal(0, noise, angles.shape)
    return replace(OrientationMap.from_euler(angles, 0.5, "m-3m", sigma=noise), shift=shift)


def without_pixels(crystal: OrientationMap, share: float) -> OrientationMap:
    """A map in which a share of the pixels is not indexed."""
    lost = scattered_nodes(crystal.shape, share)
    return replace(crystal, phase=np.where(lost, 0, crystal.phase))


def test_circles_through_missing_nodes_agree_with_the_whole_field():
    """With 1 % of the nodes missing, each of 40 circles has its b within the reported error."""
    rng = np.random.default_rng(3)
    whole = SampledFrame(AXES, VALUES)
    holed = SampledFrame(AXES, VALUES, mask=scattered_nodes(X.shape, 0.01))
    detours = 0
    for _ in range(40):
        centre = [rng.uniform(0.3, 0.7), rng.uniform(2.3, 2.9)]
        loop = Loop.circle(centre, rng.uniform(0.1, 0.2))
        b, exact = holed.burgers(loop), whole.burgers(loop)
        assert abs(b.vector - exact.vector).max() <= b.systematic_error + exact.systematic_error
        if b.detour is None:
            assert b.area == pytest.approx(exact.area)
            continue
        detours += 1
        assert holed.mask[tuple(b.detour.nodes.T)].all()
        assert b.area - exact.area == pytest.approx(b.detour.change, abs=1e-12)
        assert abs(b.detour.change) < b.detour.area < exact.area / 2
        assert b.systematic["detour"] == b.detour.error > 0
        assert 0.0125 <= b.detour.distance < 0.06
    assert detours > 25


@pytest.mark.parametrize("steps", [(1, 1), (-1, 1), (-1, -1)])
@pytest.mark.parametrize("periodic", [False, True])
def test_the_survey_of_a_field_follows_the_same_detours(steps, periodic):
    """Each circuit of a survey has b, area and error of the rectangle on the same nodes."""
    axes = [axis[::step] for axis, step in zip(AXES, steps, strict=True)]
    period = 2 * np.pi * np.arange(81) / 81
    values = VALUES
    if periodic:
        values = VALUES[:, :, :, :81] * 0
        values[0, 1] = np.sin(period)[:, None]
        axes = [axes[0], axes[1][:81]]
    mask = scattered_nodes(values.shape[2:], 0.02)
    grid = SampledFrame(axes, values, mask=mask, periodic=periodic)
    survey = grid.burgers_map((6, 8))
    assert survey.known.mean() > 0.95
    places = np.argwhere(survey.detoured)
    assert len(places) > 1000
    for i, j in np.random.default_rng(0).permutation(places)[:25]:
        middle = survey.places[:, i, j]
        sides = [6 * abs(grid.steps[0]), 8 * abs(grid.steps[1])]
        b = grid.burgers(Loop.plaquette((middle - np.array(sides) / 2).tolist(), sides))
        assert b.vector == pytest.approx(survey.vectors[:, i, j], abs=1e-10)
        assert b.area == pytest.approx(np.asarray(survey.area)[i, j])
        assert b.systematic["detour"] <= survey.systematic_error[i, j] + 1e-12
        assert survey.systematic_error[i, j] <= b.systematic_error + 1e-6


def test_planes_of_a_solid_have_their_own_detours():
    """In three dimensions, circuits go around missing nodes within their plane of nodes."""
    axes = [np.linspace(0, 1, 21), np.linspace(0, 1, 11), np.linspace(0, 1, 23)]
    x, _, z = np.meshgrid(*axes, indexing="ij")
    values = np.array([[-z, 0 * x, x]]) / 2
    mask = scattered_nodes(x.shape, 0.02)
    grid = SampledFrame(axes, values, mask=mask)
    survey = grid.burgers_map(6, (0, 2))
    assert survey.known.mean() > 0.9
    assert survey.detoured.sum() > 100
    assert np.nanmax(abs(survey.density - 1)) < 1e-10
    i, j, k = np.argwhere(survey.detoured)[40]
    corner = [axes[0][i], axes[1][j], axes[2][k]]
    b = grid.burgers(Loop.plaquette(corner, (6 / 20, 6 / 22), (0, 2)))
    assert b.vector == pytest.approx(survey.vectors[:, i, j, k])
    hole = np.argwhere(mask[5:15, :, 5:15])[0] + [5, 0, 5]
    off = [axes[0][hole[0]] - 0.12, axes[1][hole[1]] + 0.03, axes[2][hole[2]] - 0.1]
    with pytest.raises(GridError, match="plane of nodes"):
        grid.burgers(Loop.plaquette(off, (0.12, 0.3), (0, 2)))


@pytest.mark.parametrize("shift", [0.0, 0.5, -0.5])
def test_squares_of_a_map_go_around_pixels_that_are_not_indexed(shift):
    """With 2 % of the pixels lost, nearly all squares have the b of the whole map."""
    whole = wavy_map(shift)
    holed = without_pixels(whole, 0.02)
    survey, exact = holed.burgers_map(10), whole.burgers_map(10)
    assert survey.known.mean() > 0.97
    assert survey.detoured.mean() > 0.4
    missed = np.abs(survey.density - exact.density)[:, survey.known]
    assert missed.max() < 0.15 * np.abs(exact.density).max()
    for i, j in np.random.default_rng(0).permutation(np.argwhere(survey.detoured))[:40]:
        b = holed.burgers(Circuit.square((j, i), 10))
        assert b.vector == pytest.approx(survey.vectors[:, i, j], abs=1e-10)
        assert b.area == pytest.approx(np.asarray(survey.area)[i, j])
        assert b.systematic_error == pytest.approx(survey.systematic_error[i, j], rel=0.2, abs=2e-4)
        assert 0.99 * b.noise < survey.noise[i, j] < 2 * b.noise
        assert b.detour is not None
        assert (holed.phase[b.detour.nodes[:, 1], b.detour.nodes[:, 0]] == 0).all()
        assert b.area - 25 == pytest.approx(b.detour.change)
        assert (holed.phase[tuple(b.circuit.pixels.T)] > 0).all()


def test_noise_of_detours_is_not_too_small():
    """The scatter of b of one square over many noisy maps is within its noise."""
    calm = without_pixels(wavy_map(noise=1e-9), 0.03)
    i, j = np.argwhere(calm.burgers_map(8).passages == 3)[0]
    square, vectors, noise, noisy = Circuit.square((j, i), 8), [], 0.0, calm
    for seed in range(60):
        noisy = replace(wavy_map(seed=seed), phase=calm.phase, threshold=30.0)
        b = noisy.burgers(square)
        vectors.append(b.specimen)
        noise = b.noise
    survey = noisy.burgers_map(8)
    scatter = float(np.sqrt(np.var(vectors, axis=0, ddof=1).sum()))
    assert scatter == pytest.approx(noise, rel=0.2)
    assert scatter < survey.noise[i, j] < 2 * scatter


def test_a_core_makes_the_detour_uncertain_by_its_b():
    """A circle through a masked core has an error of b, and is not significant."""
    x, y = X - 0.5, Y - 2.6
    with np.errstate(all="ignore"):
        screw = np.array([[-y, x]]) / (2 * np.pi * (x**2 + y**2))
    grid = SampledFrame(AXES, screw, mask=np.hypot(x, y) < 0.03)
    b = grid.burgers(Loop.circle([0.75, 2.6], 0.25))
    assert b.detour is not None
    assert b.detour.error == pytest.approx(1, rel=0.01)
    assert abs(b.vector[0] - round(float(b.vector[0]))) < 0.01
    assert not b.is_significant


def dimmed_image() -> LatticeImage:
    """A lattice with a small dark spot without Burgers vector."""
    y, x = np.mgrid[:160, :160]
    values = np.cos(2 * np.pi * x / 8) + np.cos(2 * np.pi * y / 8)
    return LatticeImage(values * (1 - np.exp(-((((x - 60) ** 2 + (y - 90) ** 2) / 500) ** 4))))


def test_a_dark_spot_of_an_image_is_passed():
    """A circuit through a dark spot without Burgers vector has its number, in the survey too."""
    phases = dimmed_image().phases()
    x, y = np.argwhere(phases.holes).mean(axis=0)
    b = phases.burgers(Loop.plaquette([x, y - 40], (60, 80)))
    assert b.whole.tolist() == [0, 0]
    assert b.detour is not None
    assert b.detour.error == 0
    assert not phases.holes[tuple(b.pixels.T)].any()
    assert (np.abs(np.diff(b.pixels, axis=0)).sum(axis=1) == 1).all()
    assert b.area - 60 * 80 == pytest.approx(b.detour.change, abs=100)
    survey = phases.burgers_map(60)
    i, j = int(x), int(y) - 30
    assert survey.detoured[i, j]
    own = phases.burgers(Loop.plaquette([float(i), float(j)], (60, 60)))
    assert own.whole.tolist() == survey.whole[:, i, j].tolist()
    assert own.area == np.asarray(survey.area)[i, j]
    assert own.chance <= np.asarray(survey.estimated.chance)[i, j] + ROUNDED


def test_detours_are_numbers_in_results():
    """The deviation is in the text, the JSON and the table of results."""
    grid = SampledFrame(AXES, VALUES, mask=scattered_nodes(X.shape, 0.01))
    b = grid.burgers(Loop.circle([0.5, 2.6], 0.3))
    assert "around" in repr(b.detour)
    assert "detour" in repr(b)
    assert b.detour is not None
    assert b.to_json()["detour"]["nodes"] == b.detour.nodes.tolist()
    survey = grid.burgers_map(8)
    assert survey.summary()["detoured"] == survey.detoured.sum() > 0
    assert "around missing nodes" in repr(survey)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: hollow(slice(30, 50)).burgers(Loop.circle([0.5, 2.5], 0.1)), GridError, "hole"),
        (lambda: hollow(slice(0, 9)).burgers(Loop.circle([0.12, 2.5], 0.1)), GridError, "hole"),
        (
            lambda: without_pixels(wavy_map(), 0.3).burgers(Circuit.square((20, 20), 12)),
            OrientationError,
            "no orientation",
        ),
        (
            lambda: dimmed_image().phases().burgers(Loop.circle([60, 70], 8)),
            ImageError,
            "small beside it",
        ),
    ],
)
def test_refused_detours(call, error, words):
    """Holes at the edge, and holes that are not small beside the circuit, are refused."""
    with pytest.raises(error, match=words):
        call()
    assert issubclass(error, GeomtorsionError)


def hollow(rows: slice) -> SampledFrame:
    """A field with a rectangular hole."""
    mask = np.zeros(X.shape, dtype=bool)
    mask[rows, 30:50] = True
    return SampledFrame(AXES, VALUES, mask=mask)


@pytest.mark.parametrize("periodic", [(False, False), (True, False), (True, True)])
def test_sums_with_detours_agree_with_a_potential(periodic):
    """Edge values that are differences of a potential sum to zero, and areas are exact."""
    missing = scattered_nodes((40, 30), 0.15, 4)
    missing[10:14, 12:15] = True
    rings = Rings.of(missing, periodic=periodic)
    assert rings.count > 20
    height = np.random.default_rng(0).integers(0, 1000, (40, 30))
    edges = []
    for axis in (0, 1):
        steps = np.roll(height, -1, axis) - height
        edges.append((steps if periodic[axis] else np.delete(steps, -1, axis))[None])
    assert not rings.totals_of(rings.steps_of((edges[0], edges[1]))).any()
    passages = Passages(rings, Windows((0, 1), (7, 5), periodic))
    lines = passages.windows
    sums = lines.rounds(*lines.along(*rings.filled((edges[0], edges[1]))))[0]
    assert not sums[~passages.refused].any()
    assert (passages.count > 0)[~passages.refused].any()
    assert (rings.cells >= 4).all()
