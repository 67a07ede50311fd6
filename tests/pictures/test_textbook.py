"""Figures of textbooks: open parallelograms, circuits in crystals, blades and rolling cones."""

# Bad input is given on purpose; matplotlib declares data of lines loosely.
# pyright: reportArgumentType=false, reportIndexIssue=false, reportAttributeAccessIssue=false

from __future__ import annotations

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import (
    ArgumentError,
    ChartEdgeError,
    CrystalError,
    GeomtorsionError,
    ShapeError,
)
from geomtorsion.pictures import curve_pictures, draw_burgers_circuit, draw_parallelogram
from geomtorsion.pictures.scene_cones import rolling_picture

pytest.importorskip("matplotlib")

POLAR = gt.Frame("r theta", [["1", "0"], ["0", "r"]], domain="r > 0")
PLANE = gt.Frame("x y", [[1, 0], [0, 1]])
# Ends of sides are read from lines that were computed with an accuracy of 1e-10.
SOLVED = 1e-9


def ends(figure) -> tuple[np.ndarray, np.ndarray]:
    """The last points of both ways."""
    ways = [line for line in figure.axes[0].lines if len(line.get_xdata()) > 2]
    data = [np.array(getattr(line, "get_data_3d", line.get_data)()) for line in ways]
    assert len(data) == 2
    return data[0][:, -1], data[1][:, -1]


def caption(figure) -> str:
    """Everything below the panels."""
    return "\n".join(text.get_text() for text in figure.texts)


def test_rulers_of_polar_coordinates_leave_a_gap():
    """A step of length b on the circle of radius R spans the angle b / R."""
    figure = draw_parallelogram(gt.cartan(POLAR), {"theta": 0, "r": 1}, [0.8, 0], [0, 0.75])
    blue, orange = ends(figure)
    assert np.abs(blue - [1.8, 0.75 / 1.8]).max() < SOLVED
    assert np.abs(orange - [1.8, 0.75]).max() < SOLVED
    assert figure.axes[0].get_title() == "gap = (0, 0.333333)"
    # 2 S_r,theta^theta = 1/r, times a step of 0.8 in r and of 0.75 / r in theta, at r = 1.
    assert "2 S(first, second) at the start: (0, 0.6)" in caption(figure)


def test_the_other_order_has_the_opposite_gap():
    """The gap is antisymmetric, and a step with itself has none."""
    figure = draw_parallelogram(gt.cartan(POLAR), [1, 0], [0, 0.75], [0.8, 0])
    assert figure.axes[0].get_title() == "gap = (0, −0.333333)"
    figure = draw_parallelogram(gt.cartan(POLAR), [1, 0], [0.1, 0.2], [0.1, 0.2])
    assert "no gap" in figure.axes[0].get_title()


def test_a_gap_across_the_steps_is_drawn_in_space():
    """Heisenberg group: 2 S_xy^z = -1 exactly, for steps of any size."""
    figure = draw_parallelogram("heisenberg", [0, 0, 0], [1.5, 0, 0], [0, 2, 0])
    blue, orange = ends(figure)
    assert np.abs(orange - blue - [0, 0, -3]).max() < SOLVED
    assert figure.axes[0].name == "3d"


@pytest.mark.parametrize(
    ("connection", "start", "first", "second"),
    [
        (gt.cartan(PLANE), [0, 0], [1, 0], [0, 1]),
        (gt.cartan(PLANE), [0, 0], [0, 0], [0, 0]),
        (gt.levi_civita(POLAR), [1, 0], [0.8, 0], [0, 0.75]),
    ],
)
def test_flat_spaces_without_torsion_close(connection, start, first, second):
    """Both ways meet, and there is no arrow."""
    figure = draw_parallelogram(connection, start, first, second)
    blue, orange = ends(figure)
    assert np.abs(orange - blue).max() < SOLVED
    assert "no gap" in figure.axes[0].get_title()
    assert not figure.axes[0].texts


def test_curvature_leaves_only_a_gap_of_third_order():
    """Steps of half the size on the sphere: without torsion the gap is about an eighth."""
    sphere = gt.levi_civita(gt.spaces.load("s2").frame)
    sizes = []
    for step in (0.2, 0.1):
        figure = draw_parallelogram(sphere, [1, 0], [step, 0], [0, step], parameters={"R": 1})
        blue, orange = ends(figure)
        sizes.append(np.linalg.norm(orange - blue))
    assert 7 < sizes[0] / sizes[1] < 9


BLOWS_UP = gt.Connection(PLANE, [[[-1, 0], [0, 0]], [[0, 0], [0, 0]]])


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ((gt.cartan(POLAR), [1, 0], [-2, 0], [0, 1]), ChartEdgeError, "r > 0"),
        ((gt.cartan(POLAR), [1, 0], [1], [0, 1]), ShapeError, "expected 2 numbers"),
        ((POLAR, [1, 0], [1, 0], [0, 1]), ArgumentError, "Give cartan"),
        ((3, [1, 0], [1, 0], [0, 1]), ArgumentError, "connection"),
        ((gt.cartan(gt.Frame("s", [[1]])), [1], [1], [1]), ShapeError, "two or more dimensions"),
        ((gt.cartan("s2"), [1, 0], [0.1, 0], [0, 0.1]), GeomtorsionError, "value for R"),
        # q'' = q'^2 is infinite at t = 1/2.
        ((BLOWS_UP, [0, 0], [2, 0], [0, 1]), ChartEdgeError, "no finite value"),
    ],
)
def test_refused_parallelograms(arguments, error, words):
    """Steps that leave the domain, wrong numbers, and no connection."""
    with pytest.raises(error, match=words):
        draw_parallelogram(*arguments)


# -- circuits in crystals ------------------------------------------------------------------------


def dislocated(x: np.ndarray, y: np.ndarray, turns: int = 1) -> np.ndarray:
    """Sites with an edge dislocation in the origin, of `turns` lattice vectors along x."""
    return np.column_stack([x + turns * np.arctan2(y, x) / (2 * np.pi), y])


GRID = (np.mgrid[-9:9, -9:9] + 0.5).reshape(2, -1)
A, B = np.mgrid[-14:15, -14:15].reshape(2, -1)
NET = np.array([A + B / 2, B * np.sqrt(3) / 2])


def titled(figure) -> str:
    """What the circuit encloses."""
    return figure.axes[1].get_title().removeprefix("the same steps in the lattice: ")


@pytest.mark.parametrize(
    ("places", "radius", "enclosed"),
    [
        (dislocated(*GRID), 4, "b = (−1, 0)"),
        (dislocated(*GRID, turns=-1), 5, "b = (1, 0)"),
        (dislocated(*GRID) @ [[0.6, 0.8], [-0.8, 0.6]], 4, "b = "),
        (GRID.T, 4, "closed"),
        (dislocated(*(NET - [[0.2], [0.3]])), 4, "b = (−1, 0)"),
        (NET.T[(A - B) % 3 != 0], 4, "closed"),
    ],
)
def test_a_circuit_in_a_crystal(places, radius, enclosed):
    """Anticlockwise around an edge dislocation that shifts atoms by +1: the steps sum to -1."""
    figure = draw_burgers_circuit(gt.crystals.Crystal(places), [0, 0], radius)
    assert titled(figure).startswith(enclosed)
    assert len(figure.axes[1].texts) >= 4 + (enclosed != "closed")


def test_the_circuit_is_closed_and_its_image_is_not():
    """The lines: both ends of the circuit are one atom, the ends of the image b apart."""
    left, right = draw_burgers_circuit(gt.crystals.Crystal(dislocated(*GRID)), [0, 0], 4).axes
    circuit, image = (
        next(np.array(x.get_xydata()) for x in axes.lines if x.get_linewidth() == 2.0)
        for axes in (left, right)
    )
    assert (circuit[0] == circuit[-1]).all()
    assert len(image) == len(circuit)
    # Mean lattice vectors of so small a crystal are shortened by its strain of some percent.
    assert np.abs(image[-1] - image[0] - [-1, 0]).max() < 0.05


def test_a_circuit_beside_a_dislocation_closes():
    """It encloses nothing."""
    crystal = gt.crystals.Crystal(dislocated(*GRID))
    assert titled(draw_burgers_circuit(crystal, [4, 4], 2)) == "closed"


def test_a_periodic_crystal():
    """No bond leads from one side of the figure to the other."""
    crystal = gt.crystals.Crystal(GRID.T, [[18, 0], [0, 18]], periodic=(True, True))
    figure = draw_burgers_circuit(crystal, [7, 7], 2)
    assert titled(figure) == "closed"
    lengths = [np.ptp(x.get_xydata(), axis=0).max() for x in figure.axes[0].lines[:9]]
    assert max(lengths) < 2


CRYSTAL = gt.crystals.Crystal(GRID.T)


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ((CRYSTAL, [0, 0], 40), CrystalError, "Change the radius"),
        ((CRYSTAL, [0.5, 0.5], 0.1), CrystalError, "Change the radius"),
        ((CRYSTAL, [0, 0], -1), CrystalError, "radius"),
        ((CRYSTAL, [0, 0], float("nan")), CrystalError, "radius"),
        ((CRYSTAL, [0, 0, 0], 1), CrystalError, "centre"),
        ((3, [0, 0], 1), ArgumentError, "crystal"),
    ],
)
def test_refused_circuits(arguments, error, words):
    """Circuits outside of the crystal, circuits without a size, and no crystal."""
    with pytest.raises(error, match=words):
        draw_burgers_circuit(*arguments)


# -- blades ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["chaplygin_sleigh", "rolling_disc", "wheeled_robot"])
def test_blades_point_along_autoparallels_only(name):
    """Bars on the constrained track are tangent to it; on the free track some point across it."""
    pair = gt.spaces.solve_pair(gt.spaces.load(name), t=6.0)
    figure = curve_pictures(pair)["paths"][0](pair)
    bars = [x for x in figure.axes[0].lines if x.get_linewidth() == 3.6]
    across = []
    for solution, some in zip(pair.curves.values(), np.array_split(np.array(bars), 2), strict=True):
        # The middle of each bar is a point of the track, whose velocity is known.
        tracks, velocities = solution.coordinates[:, :2], solution.velocity[:, :2]
        worst = 0.0
        for bar in some:
            points = bar.get_xydata()
            k = np.abs(tracks - points.mean(axis=0)).sum(axis=1).argmin()
            one = (points[1] - points[0]) / np.linalg.norm(points[1] - points[0])
            two = velocities[k] / np.linalg.norm(velocities[k])
            worst = max(worst, abs(one[0] * two[1] - one[1] * two[0]))
        across.append(worst)
    assert across[0] < 1e-6
    assert across[1] > 0.5
    assert "Bars: the blade" in caption(figure)


def test_other_spaces_have_no_blades():
    """A sphere has a place in space and no heading."""
    pair = gt.spaces.solve_pair(gt.spaces.load("s2"), t=1.0)
    assert "blade" not in caption(curve_pictures(pair)["paths"][0](pair))


# -- cones -----------------------------------------------------------------------------------------


def rims(moments, omega, t=4.0) -> tuple[np.ndarray, np.ndarray]:
    """The rims of the cones of space and body, from the definition, and the result is drawn."""
    body = gt.Body(mass=1.0, moments=moments)
    start = gt.State(omega=omega, euler=(0.2, 0.4, 0.1))
    result = gt.Scene(body, start=start, watch=["omega", "matrix"], t=t, samples=4001).run()
    figure = result.plot(figure="rolling")
    found = {}
    for name in ("cone of space", "cone of the body"):
        axes = figure.axes[0]
        [color] = {x.get_color() for x in axes.lines if x.get_label() == name}
        lines = [x for x in axes.lines if x.get_color() == color and len(x.get_xdata()) > 1]
        found[name] = [np.array(x.get_data_3d()).T for x in lines]
    length = {
        name: sum(np.linalg.norm(np.diff(x, axis=0), axis=1).sum() for x in parts)
        for name, parts in found.items()
    }
    # Rolling without slipping: equal lengths roll off. Chords are shorter than arcs, by some
    # millionths for 4001 points.
    assert abs(length["cone of space"] - length["cone of the body"]) < 1e-5
    space, body = (np.concatenate(parts) for parts in found.values())
    return space, body


def test_cones_of_a_symmetric_top():
    """Half angles: tan(body) = u_perp / u_3, and cos(space) = u . L / (|u| |L|)."""
    moments, omega = np.array([1, 1, 0.5]), np.array([0.3, 0.4, 1.5])
    space, body = rims(tuple(moments), tuple(omega))
    momentum = moments * omega
    for rim, cosine in (
        (body, omega[2] / np.linalg.norm(omega)),
        (space, omega @ momentum / np.linalg.norm(omega) / np.linalg.norm(momentum)),
    ):
        # Points of a circular cone are in a plane, at a height of the cosine.
        _, _, axes = np.linalg.svd(rim - rim.mean(axis=0), full_matrices=False)
        heights = np.abs(rim @ axes[2])
        assert np.abs(heights - cosine).max() < 1e-9


def test_cones_of_an_asymmetric_top_roll():
    """Without a closed form the lengths that roll off are equal (checked in `rims`)."""
    space, body = rims((1, 2, 3), (0.6, 0.3, 2.0))
    assert np.ptp(body @ body.mean(axis=0)) > 0.01  # it is not circular
    assert np.abs(np.linalg.norm(space, axis=1) - 1).max() < 1e-9


def test_moments_of_rest_have_no_axis():
    """A body that rests at one of the times is drawn without that time."""
    omega = np.array([[1.0, 0, 0.5], [0, 0, 0], [0, 1.0, 0.5], [-1.0, 0, 0.5]])
    figure = rolling_picture(omega, np.broadcast_to(np.eye(3), (4, 3, 3)))
    data = [np.array(x.get_data_3d()) for x in figure.axes[0].lines]
    assert all(np.isfinite(x).all() for x in data)
