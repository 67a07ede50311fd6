"""Linking: crossings with spanning surfaces against closed forms, Gauss's integral and periods."""

# The tests read optional values.
# pyright: reportOptionalMemberAccess=false

from itertools import islice

import numpy as np
import pytest
import sympy as sp

from geomtorsion.errors import LoopError, SingularPointError
from geomtorsion.loops import Loop, burgers_vector, parallel_dislocations
from geomtorsion.materials.lines import Box, LineArrays
from geomtorsion.materials.lines.circuit import crossings
from geomtorsion.materials.lines.paradis import read_paradis
from tests.materials.lines.synthetic_networks import REAL, rings, straight
from tests.real import real

PLACES = [(0.3, 0.4), (-2.2, 1.7), (1.6, -2.4)]
VECTORS = [(0.0, 0.0, 1.0), (0.5, -0.25, 0.0), (1.0, 2.0, -3.0)]


def linked(lines: LineArrays, loop: Loop) -> np.ndarray:
    """b around a loop from the first surface; the second surface must agree."""
    one, two = (
        sum((x.count * lines.burgers[x.line] for x in found), np.zeros(3))
        for found in islice(crossings(lines, loop), 2)
    )
    assert one == pytest.approx(two, abs=1e-9)
    return one


def gauss(one: np.ndarray, two: np.ndarray) -> float:
    """Linking number of two closed polygons by Gauss's integral in closed form (Banchoff)."""
    total = 0.0
    for p, q in zip(one, np.roll(one, -1, axis=0), strict=True):
        for r, s in zip(two, np.roll(two, -1, axis=0), strict=True):
            corners = [r - p, s - p, s - q, r - q]
            sides = [np.cross(corners[k], corners[(k + 1) % 4]) for k in range(4)]
            sides = [side / np.linalg.norm(side) for side in sides]
            area = sum(np.arcsin(np.clip(sides[k] @ sides[(k + 1) % 4], -1, 1)) for k in range(4))
            total += area * np.sign(np.cross(s - r, q - p) @ (r - p))
    return total / (4 * np.pi)


@pytest.mark.parametrize(
    "loop",
    [
        Loop.circle([0, 0, 1], 1),
        Loop.circle([0, 0, 7.3], 4).reversed(),
        Loop.circle([0, 0, 1], 0.1),
        Loop.ellipse([-1, 0.5, 2], (3, 1.5)).times(3),
        Loop.polygon([[-1, -1, 0], [1, -1, 3], [1, 1, -2], [-1, 1, 1]]),
        Loop.spline([[3, -3, 0], [3, 3, 1], [-3, 3, 0], [-3, -3, -1], [0, 0, 5]]),
        Loop.parametric(["3*cos(2*s)", "3*sin(3*s)", "cos(s)/2"], "s", (0, "2*pi")),
    ],
    ids=lambda loop: loop.name,
)
def test_straight_lines_as_the_loop_integral_has_them(loop):
    """b agrees with the closed integral of e in the coframe of the same lines."""
    frame = parallel_dislocations(PLACES, VECTORS)
    wanted = burgers_vector(frame, loop, 1e-9).vector
    assert linked(straight(PLACES, VECTORS), loop) == pytest.approx(wanted, abs=1e-7)


def test_a_right_handed_circuit_has_plus_b():
    """The closed form: the line along +z, the circle counterclockwise."""
    lines = straight([(0, 0)], [(0.0, 0.0, 1.0)])
    (found,) = next(crossings(lines, Loop.circle([0, 0, 0.5], 1)))
    assert found.count == 1
    assert not list(next(crossings(lines, Loop.circle([3, 0, 0.5], 1))))
    twice = Loop.circle([0, 0, 0.5], 1).then(Loop.circle([0, 0, 0.5], 1))
    assert sum(one.count for one in next(crossings(lines, twice))) == 2


def test_random_polygons_as_gauss_has_them():
    """Closed polygons in space without a box have the linking number of Gauss's integral."""
    rng = np.random.default_rng(11)
    seen = set()
    for _ in range(40):
        one, two = rng.normal(size=(7, 3)), rng.normal(size=(6, 3))
        number = gauss(two, one)
        assert abs(number - round(number)) < 1e-9
        ring = np.stack([np.arange(7), np.roll(np.arange(7), -1)], axis=1)
        lines = LineArrays(one, ring, [[1, 0, 0]] * 7)
        found = linked(lines, Loop.polygon(two))[0]
        assert found == round(number)
        seen.add(found)
    assert {-1.0, 0.0, 1.0} <= seen


def test_images_count_as_lines_of_their_own():
    """A loop larger than the box links images; the same lines copied by hand agree."""
    lines = rings(4, seed=5)
    shifts = 10.0 * np.array(
        [[i, j, k] for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)]
    )
    unwrapped = lines.positions[lines.pairs[:, 0]]
    places = np.concatenate(
        [np.stack([unwrapped, unwrapped + lines.steps], axis=1) + shift for shift in shifts]
    )
    count = len(places)
    copies = LineArrays(
        places.reshape(-1, 3), np.arange(2 * count).reshape(-1, 2), np.tile(lines.burgers, (27, 1))
    )
    hits = 0
    for centre in ([2, 3, 4], [9.5, 0.1, 5], [5, 5, 5]):
        for plane in ((0, 1), (1, 2), ([1, 1, 0], [0, 1, 2])):
            loop = Loop.circle(centre, 6.5, plane)
            wanted = linked(copies, loop)
            assert linked(lines, loop) == pytest.approx(wanted, abs=1e-12)
            hits += bool(wanted.any())
    assert hits >= 3


def face(lines: LineArrays, corner: list[float], axis: int) -> tuple[np.ndarray, np.ndarray]:
    """b around a face of the box by linking, and from the steps of all lines through it."""
    vectors = np.asarray(lines.box.vectors)
    one, two = vectors[(axis + 1) % 3], vectors[(axis + 2) % 3]
    loop = Loop.plaquette(corner, (1, 1), (one, two))
    through = lines.steps @ lines.box.inverse[:, axis]
    return linked(lines, loop), through @ lines.burgers


def test_a_face_of_the_box_is_pierced_as_often_as_lines_wind_around_it():
    """For nets across a skew box, b around a face is the sum of all steps over the period."""
    rng = np.random.default_rng(4)
    box = Box([[6, 0, 0], [1, 5, 0], [0.5, -1, 7]])
    # Closed walks of six nodes that end some periods away from their start.
    pairs, images, vectors = [], [], []
    for k in range(8):
        nodes = 6 * k + np.arange(6)
        pairs.append(np.stack([nodes, np.roll(nodes, -1)], axis=1))
        images.append(rng.integers(-1, 2, (6, 3)))
        vectors.append(np.repeat(rng.integers(1, 4, (1, 3)), 6, axis=0))
    lines = LineArrays(
        rng.uniform(0, 1, (48, 3)) @ box.vectors, np.concatenate(pairs), np.concatenate(vectors),
        box, np.concatenate(images),
    )  # fmt: skip
    assert not lines.excess.any()
    for axis in range(3):
        found, wanted = face(lines, [0.1234, -0.77, 0.31], axis)
        assert found == pytest.approx(wanted, abs=1e-9)
        assert found.any()


def test_the_faces_of_the_real_network():
    """The same law for a simulated network of 5,930 lines."""
    lines = read_paradis(real(REAL))
    for axis in range(3):
        found, wanted = face(lines, [1.1, 2.2, 3.3], axis)
        assert found == pytest.approx(wanted, abs=1e-6)


@pytest.mark.parametrize("gap", [10.0**-k for k in range(1, 12)])
def test_however_near_a_line_comes(gap):
    """Lines just inside and just outside a circle, down to 1e-11 of its radius."""
    for where, wanted in ((1 - gap, 1.0), (1 + gap, 0.0)):
        angle = 0.7
        lines = straight([(where * np.cos(angle), where * np.sin(angle))], [(0.0, 0.0, 1.0)])
        assert linked(lines, Loop.circle([0, 0, 1.3], 1))[2] == wanted


def test_symmetry_puts_no_node_into_the_surface():
    """Nodes in the plane of the loop, lines in it, and a line through its centre are exact."""
    square = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]
    ring = [[0, 1], [1, 2], [2, 3], [3, 0]]
    lines = LineArrays(square, ring, [[0, 0, 1]] * 4)
    assert linked(lines, Loop.plaquette([-1, -1, 0], (2, 2), (0, 2)))[2] == 0
    assert linked(lines, Loop.plaquette([1, 1, -1], (4, 2), (0, 2)))[2] == -1
    assert linked(lines, Loop.circle([2, 1, 0], 1, (0, 2)))[2] == -1
    axis = straight([(0, 0)], [(0.0, 0.0, 1.0)], height=2.0)
    for height in (0.2, 0.9, 1.6, 1.0):
        assert linked(axis, Loop.circle([0, 0, height], 1))[2] == 1


def test_a_tiny_loop_far_from_the_origin():
    """The centre is subtracted first, so a loop of radius 1e-6 at coordinates of 1e6 is exact."""
    place = (1e6 + 0.5, 2e6)
    line = LineArrays([[*place, -3], [*place, 3]], [[0, 1]], [[0, 0, 1.0]])
    assert linked(line, Loop.circle([*place, 0], 1e-6))[2] == 1
    assert linked(line, Loop.circle([place[0] + 3e-6, place[1], 0], 1e-6))[2] == 0


def test_loops_without_an_answer_are_refused():
    """Loops through a line or node, in two dimensions, with periods or symbols are refused."""
    lines = straight([(1, 0)], [(0.0, 0.0, 1.0)])
    for loop in (Loop.circle([0, 0, 1], 1), Loop.polygon([[1, -1, 1], [1, 1, 1], [0, 0, 1]])):
        with pytest.raises(SingularPointError, match=r"meets the line .* near \(1, .*Lead it past"):
            next(crossings(lines, loop))
    with pytest.raises(LoopError, match="loop: expected three coordinates, got 2"):
        next(crossings(lines, Loop.circle([0, 0], 1)))
    around = Loop.parametric(["cos(s)", "s", "0"], "s", (0, "2*pi"), periods={1: "2*pi"})
    with pytest.raises(LoopError, match="modulo periods"):
        next(crossings(lines, around))
    with pytest.raises(LoopError, match=r"without symbols, got R\..*loop\.at"):
        next(crossings(lines, Loop.circle([0, 0, 0], sp.Symbol("R", positive=True))))
