"""Displacements: jumps are removed before differences are formed."""

# pyright: reportArgumentType=false, reportPossiblyUnboundVariable=false

from dataclasses import replace

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import GridError
from geomtorsion.loops import Loop
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.fields.stencils import Rule
from geomtorsion.materials.readers import open_in_blocks, open_source
from tests.loops.edge_dislocation import displacement
from tests.rounding import rounded

B = 0.286
AXIS = np.linspace(-3, 3, 60)
X, Y = np.meshgrid(AXIS, AXIS, indexing="ij")


def edge(x: np.ndarray, y: np.ndarray, b: float = B) -> np.ndarray:
    """The displacement of an edge dislocation; its cut is y = 0, x < 0."""
    return displacement(x, y, b)


def test_differences_across_the_cut_would_be_wrong():
    """np.gradient across the cut loses the dislocation: its closed integral is nearly zero."""
    beta = np.array([np.gradient(part, AXIS, AXIS) for part in edge(X, Y)])
    found = SampledFrame.from_distortion([AXIS, AXIS], beta).burgers(Loop.circle([0, 0], 2))
    assert abs(found.vector[0]) < 0.1 * B


@pytest.mark.parametrize("branch", ["find", B, [[B, 0]], [B, 0], [[B, 0], [B / 2, B * 3**0.5 / 2]]])
def test_an_edge_dislocation(branch):
    """b = (0.286, 0) on each circuit, within the reported error, and zero beside the core."""
    grid = SampledFrame.from_displacement([AXIS, AXIS], edge(X, Y), branch=branch)
    for loop in (Loop.circle([0, 0], 2), Loop.circle([0.4, -0.3], 1.5), grid_square(1.7)):
        found = grid.burgers(loop)
        # A found jump is as accurate as the field is smooth across the cut.
        assert np.abs(found.vector - [B, 0]).max() < found.error + (2e-4 if branch == "find" else 0)
        assert found.error < 0.01 * B
    beside = grid.burgers(Loop.circle([1, 1], 0.7))
    assert np.abs(beside.vector).max() < beside.error + 1e-6
    assert "edges" in grid.source


def grid_square(half: float) -> Loop:
    return Loop.plaquette([-half, -half], (2 * half, 2 * half))


def test_cuts_in_strongly_bent_fields_are_found():
    """A smooth part with steps of more than 0.6 b between nodes hides no jump."""
    smooth = np.array([4 * X + X**2 / 5 + Y * X / 9, X - 2 * Y])
    assert np.abs(np.diff(smooth[0], axis=0)).min() > 0.6 * B
    for branch in ("find", [B, 0]):
        grid = SampledFrame.from_displacement([AXIS, AXIS], edge(X, Y) + smooth, branch=branch)
        found = grid.burgers(Loop.circle([0, 0], 2))
        assert np.abs(found.vector - [B, 0]).max() < 0.005 * B


def test_cuts_in_short_waves_are_found():
    """In waves of eight steps and height b, only nearby steps predict the smooth part."""
    wave = np.array([B * np.sin(2 * np.pi * Y / (8 * (AXIS[1] - AXIS[0]))), 0 * X])
    grid = SampledFrame.from_displacement([AXIS, AXIS], edge(X, Y) + wave, branch="find")
    found = grid.burgers(Loop.circle([0, 0], 2))
    assert np.abs(found.vector - [B, 0]).max() < 0.1 * B


def test_two_cuts_of_different_vectors():
    """Two dislocations with different jumps: each circuit has its b, a common one the sum."""
    u = edge(X - 1.31, Y - 0.9) + edge(X + 1.2, Y + 1.1, 0.4)[::-1]
    grid = SampledFrame.from_displacement([AXIS, AXIS], u, branch="find")
    one = grid.burgers(Loop.circle([1.31, 0.9], 1.0))
    two = grid.burgers(Loop.circle([-1.2, -1.1], 1.0))
    both = grid.burgers(grid_square(2.7))
    assert one.vector == pytest.approx([B, 0], abs=0.01)
    assert two.vector == pytest.approx([0, 0.4], abs=0.01)
    assert both.vector == pytest.approx([B, 0.4], abs=0.01)
    assert grid.source.count("edges") == 2


def test_noise_and_strain_add_no_cuts():
    """Noise and smooth fields have no jumps."""
    rng = np.random.default_rng(0)
    for u in (
        rng.standard_normal((2, *X.shape)),
        rng.standard_normal((1, *X.shape)),
        np.array([np.sin(3 * X) * Y, np.exp(-(X**2) - Y**2)]),
        np.zeros((2, *X.shape)),
    ):
        grid = SampledFrame.from_displacement([AXIS, AXIS], u, branch="find")
        assert grid.source == "a displacement; jumps: none"


@pytest.mark.parametrize("share", [pytest.param(0.01, marks=pytest.mark.slow), 0.04])
def test_noisy_displacements(share):
    """With noise of a few percent of b, declared jumps give the exact b and found jumps scatter."""
    rng = np.random.default_rng(1)
    loop = Loop.circle([0, 0], 2)
    found, errors = [], []
    for k in range(20):
        u = edge(X, Y) + share * B * rng.standard_normal((2, *X.shape))
        grid = SampledFrame.from_displacement([AXIS, AXIS], u, sigma="estimate", branch=B)
        b = grid.burgers(loop)
        assert b.vector == pytest.approx([B, 0], abs=1e-12)
        assert b.error < 1e-6 * B
        if k < 10:
            searched = SampledFrame.from_displacement([AXIS, AXIS], u, branch="find").burgers(loop)
            found.append(searched.vector)
            errors.append(searched.sigmas)
    scatter = np.sqrt(((np.array(found) - [B, 0]) ** 2).mean(axis=0))
    assert np.mean(errors, axis=0) == pytest.approx(scatter, rel=0.7)
    grid = SampledFrame.from_displacement([AXIS, AXIS], u, sigma="estimate", branch=B)
    fixed = SampledFrame.from_displacement([AXIS, AXIS], u, sigma=share * B, branch=B)
    assert grid.sigma[:, :, ~grid.mask].mean() / fixed.sigma[
        :, :, ~fixed.mask
    ].mean() == pytest.approx(1, abs=0.1)


def bands(places: list[np.ndarray], rng: np.random.Generator) -> np.ndarray:
    """Slip bands of a few px, half a px to two wide, that fade along their length."""
    u = np.zeros((len(places), *places[0].shape))
    middle = [x.mean() for x in places]
    for _ in range(4):
        normal, slip = rng.normal(size=(2, len(places)))
        normal /= np.linalg.norm(normal)
        if rng.random() < 0.3:
            # Some bands are along the grid, as in steel specimens cut along their bands.
            normal = np.eye(len(places))[rng.integers(len(places))]
        slip -= normal * (normal @ slip)
        slip *= rng.uniform(0.5, 3) / np.linalg.norm(slip)
        away = [x - m - rng.uniform(-5, 5) for x, m in zip(places, middle, strict=True)]
        across = np.tensordot(normal, away, 1)
        along = np.tensordot(slip, away, 1)
        step = np.tanh(across / rng.uniform(0.1, 2)) * np.exp(-((along / rng.uniform(10, 40)) ** 2))
        u += np.multiply.outer(slip, step)
    return u


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("shape", "noise"), [((50, 44), 0.0), ((50, 44), 0.02), ((16, 15, 14), 0.02)]
)
@pytest.mark.parametrize("holes", [False, True])
def test_one_value_at_each_place_has_no_burgers_vector(seed, shape, noise, holes):
    """b is zero however steep slip bands are: for maps, loops, cells, and around holes."""
    rng = np.random.default_rng(seed)
    axes = [np.arange(float(n)) * step for n, step in zip(shape, (1, -1, 1), strict=False)]
    places = np.meshgrid(*axes, indexing="ij")
    u = bands(places, rng) + noise * rng.standard_normal((len(shape), *shape))
    mask = np.zeros(shape, dtype=bool)
    if holes:
        mask[(slice(6, 8),) * len(shape)] = True
        mask[(slice(3, 4),) * len(shape)] = True
    grid = SampledFrame.from_displacement(axes, u, sigma=noise or None, mask=mask)
    for size in (1, 4, 8):
        for plane in [(0, 1), (1, 0)] + [(2, 0)] * (len(shape) - 2):
            found = grid.burgers_map(size, plane)
            assert (
                found.known == SampledFrame(axes, 0 * grid.coframe).burgers_map(size, plane).known
            ).all()
            assert not found.vectors[:, found.known].any()
            assert not found.errors[found.known].any()
            assert not found.significance[found.known].any()
    middle = [float(axis[len(axis) // 2 + 3]) for axis in axes]
    loops = [Loop.circle(middle, 1.3)]
    loops += [grid.loop_around(hole, margin=1) for hole in grid.holes]
    for loop in loops:
        b = grid.burgers(loop)
        assert not b.vector.any()
        assert b.error == b.significance == 0
    torsion, error = grid.torsion()
    assert not np.nan_to_num(torsion).any()
    assert not np.nan_to_num(error).any()
    if not holes:
        assert np.abs(grid.cochain.coboundary().values).max() < 1e-12
    # A closed chain of edges with arbitrary corners between the nodes.
    corners = np.array(middle) + rng.uniform(-1, 1, (6, len(shape)))
    sides = grid.along_edges(corners, np.roll(corners, -1, axis=0))
    assert np.abs(sides.vectors.sum(axis=0)).max() < 1e-12


def test_possible_jumps_are_reported():
    """Without a declaration b is zero, and `source` names the large steps."""
    grid = SampledFrame.from_displacement([AXIS, AXIS], edge(X, Y))
    assert not grid.burgers(Loop.circle([0, 0], 2)).vector.any()
    assert "none declared. Steps of (0.28" in grid.source
    assert "declare them as branch" in grid.source


def test_declared_jumps_agree_with_scattered_points():
    """With three dislocations, noise and a hole, each loop has the same exact b by both classes."""
    rng = np.random.default_rng(4)
    line = np.linspace(-3, 3, 61) + 0.013
    x, y = np.meshgrid(line, line, indexing="ij")
    u = edge(x, y) + edge(x - 1.3, y - 0.9) - edge(x + 1.2, y + 1.1)[::-1]
    u += 0.02 * B * rng.standard_normal(u.shape)
    mask = np.hypot(x - 1.3, y - 0.9) < 0.35
    grid = SampledFrame.from_displacement([line, line], u, branch=B, sigma="estimate", mask=mask)
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    scattered = gt.ScatteredFrame.from_displacement(points, u.reshape(2, -1), branch=B)
    many = [Loop.circle([0, 0], r) for r in (0.5, 1.0, 2.3, 2.7)]
    many += [
        Loop.circle([1.3, 0.9], 0.7),
        Loop.circle([-1.2, -1.1], 0.5),
        Loop.circle([1, -1.5], 1),
    ]
    many += [many[0].reversed(), many[0].then(many[0])]
    for loop in many:
        b = grid.burgers(loop)
        assert b.vector == pytest.approx(scattered.burgers(loop).vector, abs=1e-12)
        assert b.error < 1e-9
    assert grid.burgers(many[2]).vector == pytest.approx([2 * B, -B], abs=1e-12)


def test_a_screw_in_space():
    """A declared jump in three dimensions: in maps, on loops, and on edges between nodes."""
    axes = [np.arange(12.0), np.arange(11.0), np.arange(5.0)]
    x, y, _ = np.meshgrid(*axes, indexing="ij")
    u = np.zeros((3, *x.shape))
    u[2] = np.arctan2(y - 5.3, x - 5.4) / (2 * np.pi)
    grid = SampledFrame.from_displacement(axes, u, branch=1.0)
    found = grid.burgers_map(8)
    inside = found.known & (np.abs(found.vectors).max(axis=0) > 0)
    assert inside.any()
    expected = np.tile([0, 0, 1.0], (inside.sum(), 1))
    assert found.vectors[:, inside] == pytest.approx(expected.T)
    assert grid.burgers(Loop.circle([5.4, 5.3, 2.2], 3)).vector == pytest.approx([0, 0, 1])
    assert not grid.burgers(Loop.circle([5.4, 8.6, 2.2], 1.5, (0, 2))).vector.any()
    ring = np.array([[5.4 + 3 * np.cos(t), 5.3 + 3 * np.sin(t), 2.2] for t in np.arange(6)])
    sides = grid.along_edges(ring, np.roll(ring, -1, axis=0))
    assert sides.vectors.sum(axis=0) == pytest.approx([0, 0, 1], abs=1e-12)


def test_another_coframe_is_refused_with_a_displacement():
    """A replaced coframe would keep the circuits of the old one, so it is refused."""
    grid = SampledFrame.from_displacement([AXIS, AXIS], edge(X, Y), branch=B)
    assert replace(grid, unit="nm").burgers(Loop.circle([0, 0], 2)).unit == "nm"
    with pytest.raises(GridError, match="expected the coframe of the displacement, got another"):
        replace(grid, coframe=2 * grid.coframe)


def test_noise_that_spoils_a_jump_is_a_hole():
    """With noise of a quarter of b many cells do not close and become holes."""
    rng = np.random.default_rng(2)
    u = edge(X, Y) + 0.25 * B * rng.standard_normal((2, *X.shape))
    grid = SampledFrame.from_displacement([AXIS, AXIS], u, branch=B)
    assert grid.mask.mean() > 0.5
    with pytest.raises(GridError, match="touches a hole"):
        grid.burgers(Loop.circle([0, 0], 2))


def test_holes_and_periods():
    """A core inside a hole has its b; a periodic displacement may be given modulo its period."""
    u = edge(X, Y)
    u[0, np.hypot(X, Y) < 0.6] = np.nan
    grid = SampledFrame.from_displacement([AXIS, AXIS], u, branch="find")
    found = grid.burgers(grid.loop_around(margin=3))
    assert found.vector == pytest.approx([B, 0], abs=2e-3)
    n = 20
    line = np.arange(n) * 2 * np.pi / n
    x, y = np.meshgrid(line, line, indexing="ij")
    u = 0.1 * np.sin(x + 2 * y)
    ring = SampledFrame.from_displacement([line, line], u[None], periodic=True, branch=1.0)
    assert np.abs(ring.plaquettes().vectors).max() < 2e-4
    assert ring.coframe[0, 0] == pytest.approx(1 + 0.1 * np.cos(x + 2 * y), abs=2e-3)
    # This displacement is given modulo its period, like a phase.
    shear = SampledFrame.from_displacement([line, line], x[None], periodic=True, branch=2 * np.pi)
    assert shear.coframe[0, 0] == pytest.approx(np.full((n, n), 2), abs=1e-12)


@pytest.mark.parametrize(
    ("u", "options", "message"),
    [
        (np.zeros((2, 5, 60)), {}, r"displacement: expected shape \(rows, 60, 60\)"),
        (np.zeros((60, 60)), {}, "displacement: expected shape"),
        ("u", {}, "displacement: expected an array of real numbers"),
        (
            edge(X, Y),
            {"branch": [[1, 0], [2, 0]]},
            "branch: expected a length, or up to 2 independent",
        ),
        (edge(X, Y), {"branch": [[1, 0, 0]]}, "vectors of 2 components"),
        (edge(X, Y), {"branch": 0}, "branch: expected a length"),
        (edge(X, Y), {"branch": "a"}, "branch: expected an array of real numbers"),
        (edge(X, Y) * np.nan, {}, "got none: every node is masked"),
        (edge(X, Y), {"sigma": -1}, "sigma: expected standard deviations"),
    ],
)
def test_invalid_displacements_are_refused(u, options, message):
    """Each wrong argument has its own message."""
    with pytest.raises(GridError, match=message):
        SampledFrame.from_displacement([AXIS, AXIS], u, **options)


@pytest.mark.parametrize("branch", [None, "find", B, [[B, 0]]])
@pytest.mark.parametrize("sigma", [None, "estimate", 0.01])
def test_a_file_keeps_the_displacement(tmp_path, branch, sigma):
    """A file read back has the same circuits bit for bit, with the same errors and holes."""
    u = edge(X, Y) + 0.005 * np.random.default_rng(0).standard_normal((2, *X.shape))
    u[:, 50:53, 10:14] = np.nan
    made = SampledFrame.from_displacement(
        [AXIS, AXIS], u, branch=branch, sigma=sigma, unit="nm", names=("x", "z")
    )
    made.save(tmp_path / "u.npz")
    read = SampledFrame.read(tmp_path / "u.npz")
    loop = Loop.circle([0, 0], 2)
    one, two = made.burgers(loop), read.burgers(loop)
    assert np.array_equal(one.vector, two.vector)
    assert two.error == pytest.approx(one.error, rel=1e-9)
    assert np.array_equal(made.coframe, read.coframe, equal_nan=True)
    assert (read.source, read.unit, read.names) == (made.source, "nm", ("x", "z"))
    squares = [frame.burgers_map(6) for frame in (made, read)]
    assert np.array_equal(squares[0].vectors, squares[1].vectors, equal_nan=True)
    assert open_source(tmp_path / "u.npz").burgers_map(6).vectors == pytest.approx(
        squares[0].vectors, nan_ok=True
    )
    with pytest.raises(GridError, match="blocks: expected a coframe or a distortion"):
        open_in_blocks(tmp_path / "u.npz")


@pytest.mark.parametrize("order", [2, 4, 6, 10])
@pytest.mark.parametrize("periodic", [False, True])
def test_slopes_from_steps_are_slopes_from_values(order, periodic):
    """Differences of neighbours give the slopes of the values, at the edges and beside holes."""
    values = np.random.default_rng(order).normal(size=24)
    holes = np.zeros((24, 1), dtype=bool)
    holes[11] = True
    rule = Rule.of(order, holes, periodic, slopes=True)
    steps = np.diff(values, append=values[:1]) if periodic else np.diff(values)
    terms = abs(rule.matrix) @ abs(values)
    assert rule.matrix_of_steps @ steps == pytest.approx(rule.matrix @ values, abs=rounded(terms))
    assert not rule.known[11]


@pytest.mark.parametrize("order", [2, 4, 6, 12])
def test_slopes_of_polynomials_are_exact(order):
    """A stencil of m nodes differentiates powers up to m - 1, to roundings of its terms."""
    places = np.arange(16.0) - 7.5
    rule = Rule.of(order, np.zeros((16, 1), dtype=bool), False, slopes=True)
    for power in range(order + 1):
        values = places**power
        exact = power * places ** max(power - 1, 0)
        terms = abs(rule.matrix) @ abs(values)
        assert rule.matrix @ values == pytest.approx(exact, abs=rounded(terms))
