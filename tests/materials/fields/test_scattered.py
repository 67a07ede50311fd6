"""Scattered points: dislocations between them, holes, noise, in the plane and in space."""

import numpy as np
import pytest

from geomtorsion.errors import GeomtorsionError
from geomtorsion.loops import Loop
from geomtorsion.materials.fields import ScatteredFrame
from tests.loops.edge_dislocation import displacement, distortion
from tests.rounding import ROUNDED

B = 0.25
RNG = np.random.default_rng(1)
# Jittered nodes of a hexagonal lattice, like the positions of tracked particles.
ROW, COLUMN = np.mgrid[-20:21, -20:21].reshape(2, -1)
POINTS = np.stack([COLUMN + ROW % 2 / 2, ROW * np.sqrt(3) / 2], axis=1) / 10
POINTS = POINTS + RNG.uniform(-0.02, 0.02, POINTS.shape) + [0.03, 0.01]
X, Y = POINTS.T
R = np.hypot(X, Y)
LOOPS = {
    "circle": Loop.circle([0, 0], 1.2),
    "backwards": Loop.circle([0.2, 0.1], 1.2).reversed(),
    "twice": Loop.circle([0, 0], 1).times(2),
    "square": Loop.plaquette([-0.9, -1], (1.9, 2)),
    "elsewhere": Loop.circle([1.0, 0.9], 0.5),
}
TIMES = {"circle": 1, "backwards": -1, "twice": 2, "square": 1, "elsewhere": 0}


@pytest.mark.parametrize("branch", [B, [B, 0], [[B, 0], [B / 2, B * 3**0.5 / 2]]], ids=str)
def test_displacements_of_an_edge_dislocation(branch):
    """b is a whole lattice vector around the core, and in the one triangle that contains it."""
    frame = ScatteredFrame.from_displacement(POINTS, displacement(X, Y, B), branch=branch)
    for name, loop in LOOPS.items():
        b = frame.burgers(loop)
        assert b.vector == pytest.approx([TIMES[name] * B, 0], abs=1e-12), name
        assert b.error < 1e-12
    found = frame.burgers_map()
    (there,) = np.flatnonzero(np.abs(found.vectors).max(axis=0) > 1e-9)
    assert found.vectors[:, there] == pytest.approx([B, 0], abs=1e-12)
    assert np.hypot(*found.places[:, there]) < 0.1


@pytest.mark.parametrize("order", [2, 4])
def test_distortions_of_an_edge_dislocation(order):
    """b around the unseen core is right within the reported error; a distant circuit has none."""
    frame = ScatteredFrame.from_distortion(
        POINTS, distortion(X, Y, B), mask=R < 0.35, order=order, unit="nm"
    )
    assert len(frame.holes) == 1
    assert "1 hole" in repr(frame)
    assert (R[frame.holes[0]] < 0.6).all()
    for name, loop in LOOPS.items():
        b = frame.burgers(loop)
        away = np.abs(b.vector - [TIMES[name] * B, 0]).max()
        assert away <= b.error < (0.05 if order == 2 else 0.03) * B, name
        assert b.unit == "nm"
    for margin in (1, 3, 5):
        b = frame.burgers(frame.loop_around(margin=margin))
        assert np.abs(b.vector - [B, 0]).max() <= b.error < 0.1 * B
    strain = distortion(X, Y, B)
    turned = (strain - strain.swapaxes(0, 1)) / 2
    same = ScatteredFrame.from_strain_rotation(
        POINTS, strain - turned, turned[1, 0], mask=R < 0.35, order=order
    )
    assert same.cochain.values == pytest.approx(frame.cochain.values, abs=1e-12)


def test_slopes_at_the_points_make_it_finer():
    """A differential closes: the remainder on a circuit falls with the order."""
    left = {2: [], 4: []}
    for count in (20, 40, 80):
        line = (np.arange(count) + 0.5) / count
        x, y = (p.ravel() for p in np.meshgrid(line, line, indexing="ij"))
        x = x + 0.3 / count * np.sin(7 * y)
        e = np.array([[2 * np.cos(2 * x) * np.cos(3 * y), -3 * np.sin(2 * x) * np.sin(3 * y)]])
        for order, found in left.items():
            frame = ScatteredFrame.from_coframe(np.stack([x, y], axis=1), e, order=order)
            found.append(abs(frame.burgers(Loop.circle([0.5, 0.5], 0.3)).vector[0]))
    # Spacings of 1, 1/2, 1/4: trapezoids have order two, and order four with slopes.
    assert left[2][0] / left[2][2] > 10
    assert left[4][0] / left[4][2] > 40
    assert left[4][2] < left[2][2] / 10


def test_a_loop_is_the_sum_of_its_triangles():
    """Chains add up; circuits by nodes, by edges and by loops agree."""
    frame = ScatteredFrame.from_distortion(POINTS, distortion(X, Y, B), mask=R < 0.35)
    nodes = frame.mesh.walk(LOOPS["elsewhere"])
    one, other = frame.burgers(nodes.tolist()), frame.burgers(LOOPS["elsewhere"])
    assert (one.vector == other.vector).all()
    triangles = frame.burgers_map()
    edges, senses = frame.cochain.complex.steps(nodes[:-1], nodes[1:])
    chain = {int(e): int(s) for e, s in zip(edges, senses, strict=True)}
    assert frame.burgers(chain).vector == pytest.approx(one.vector, abs=ROUNDED)
    # The triangles inside are those around whose middles the path winds.
    way = POINTS[nodes]
    a, b = (way[:, None] - triangles.places.T for way in (way[:-1], way[1:]))
    angle = np.arctan2(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], (a * b).sum(axis=-1))
    inside = np.rint(angle.sum(axis=0) / (2 * np.pi)).astype(int)
    assert inside.sum() > 50
    assert triangles.vectors @ inside == pytest.approx(one.vector, abs=1e-12)
    stars = frame.burgers_map(rings=1)
    k = int(np.argmin(np.hypot(*(stars.places.T - [1, 1]).T)))
    star = (frame.mesh.corners == frame.mesh.inner[k]).any(axis=1)
    assert stars.vectors[:, k] == pytest.approx(triangles.vectors[:, star].sum(axis=1), abs=1e-12)
    assert np.asarray(stars.area)[k] == pytest.approx(np.asarray(triangles.area)[star].sum())


def linear_noise(frame_of, size, circuit):
    """Weight of each value in b of a circuit, shape (rows, values), by moving one at a time."""
    return np.stack(
        [frame_of(row.reshape(size)).burgers(circuit).vector for row in np.eye(np.prod(size))],
        axis=1,
    )


def test_noise_is_the_sum_over_all_weights():
    """Moving each component of each point by one gives its weight, and the weights give C_b."""
    rng = np.random.default_rng(3)
    points = rng.uniform(-1, 1, (24, 2))
    size, loop = (2, 2, 24), Loop.circle([0, 0], 0.4)
    root = rng.normal(size=(4, 4))
    table = (root @ root.T)[:, :, None] * (0.5 + rng.random(24))
    weights = linear_noise(lambda v: ScatteredFrame.from_coframe(points, v), size, loop)
    weights = weights.reshape(2, 4, 24)
    exact = np.einsum("apn,pqn,bqn->ab", weights, table, weights)
    frame = ScatteredFrame.from_coframe(points, np.ones(size), covariance=table)
    assert frame.burgers(loop).covariance == pytest.approx(exact, rel=1e-9)
    sigma = np.sqrt(np.einsum("ppn->pn", table)).reshape(size)
    frame = ScatteredFrame.from_coframe(points, np.ones(size), sigma=sigma)
    alone = (weights**2 * sigma.reshape(4, 24) ** 2).sum(axis=(1, 2))
    assert frame.burgers(loop).sigmas == pytest.approx(np.sqrt(alone), rel=1e-9)


@pytest.mark.parametrize(
    ("order", "sigma", "count"),
    [
        (2, 0.1, 60),
        pytest.param(2, 0.1, 200, marks=pytest.mark.slow),
        pytest.param(4, 0.01, 200, marks=pytest.mark.slow),
    ],
)
def test_the_reported_error_is_the_scatter(order, sigma, count):
    """Over many noisy fields the error is right within 20 percent, on loops and in maps."""
    rng = np.random.default_rng(5)
    keep = R < 0.8
    points, beta = POINTS[keep], distortion(X, Y, B)[..., keep]
    found, told, stars = [], [], []
    for _ in range(count):
        noisy = beta + sigma * rng.standard_normal(beta.shape)
        frame = ScatteredFrame.from_distortion(
            points, noisy, mask=R[keep] < 0.35, order=order, sigma=sigma
        )
        b = frame.burgers(Loop.circle([0, 0], 0.6))
        found.append(b.vector)
        told.append(b.error)
        stars.append(frame.burgers_map(rings=2))
    scatter = np.sqrt(((np.array(found) - [B, 0]) ** 2).mean(axis=0))
    assert np.mean(told) / np.linalg.norm(scatter) == pytest.approx(1, abs=0.2)
    ratio = np.std([s.vectors for s in stars], axis=0) / stars[0].sigmas
    assert ratio.mean() == pytest.approx(1, abs=0.03)
    assert np.mean([np.median(s.significance) for s in stars]) < np.sqrt(2) * 1.1


def test_noise_is_estimated_from_the_data():
    """Sigmas and covariances are estimated from the data, and the method is named."""
    rng = np.random.default_rng(7)
    put_in = np.array([[4.0, 1, 0, 0], [1, 2, 0, 0], [0, 0, 1, -0.5], [0, 0, -0.5, 9]]) * 1e-4
    noise = rng.multivariate_normal(np.zeros(4), put_in, len(X)).T.reshape(2, 2, -1)
    values = 0.1 * np.array([[X, Y], [X * Y, np.cos(X)]]) + noise
    loop = Loop.circle([0, 0], 1)
    exact = ScatteredFrame.from_coframe(POINTS, values, covariance=put_in).burgers(loop)
    together = ScatteredFrame.from_coframe(POINTS, values, covariance="estimate")
    for frame in (together, ScatteredFrame.from_coframe(POINTS, values, sigma="estimate")):
        assert "planes through the neighbours" in frame.sigma_source
        assert frame.burgers(loop).sigmas == pytest.approx(exact.sigmas, rel=0.2)
    away = np.abs(together.burgers(loop).covariance - exact.covariance).max()
    assert away < 0.15 * exact.covariance.max()


def test_noise_of_displacements():
    """A wrong jump changes b by a lattice vector; the reported noise covers such jumps."""
    rng = np.random.default_rng(2)
    keep = R < 0.7
    points, u = POINTS[keep], displacement(X[keep], Y[keep], B)
    loop, sigma = Loop.circle([0, 0], 0.4), 0.22 * B
    found, told, noisy = [], [], u
    for _ in range(200):
        noisy = u + sigma * rng.standard_normal(u.shape)
        frame = ScatteredFrame.from_displacement(points, noisy, branch=B, sigma=sigma)
        b = frame.burgers(loop)
        found.append(b.vector - [B, 0])
        told.append(b.sigmas)
    scatter = np.sqrt(np.mean(np.square(found), axis=0))
    assert scatter.min() > 0.02 * B
    # Wrong jumps on both sides of a point cancel, so the scatter is somewhat smaller.
    ratio = np.sqrt(np.mean(np.square(told), axis=0)) / scatter
    assert (ratio > 0.9).all()
    assert (ratio < 1.6).all()
    estimated = ScatteredFrame.from_displacement(points, noisy, branch=B, sigma="estimate")
    assert estimated.burgers(loop).noise == pytest.approx(told[-1].max(), rel=0.7)
    assert "planes through the neighbours" in estimated.sigma_source
    small = ScatteredFrame.from_displacement(1e-9 * points, 1e-9 * u, branch=1e-9 * B)
    inner = small.burgers(Loop.circle([0, 0], 0.4e-9))
    assert inner.vector == pytest.approx([1e-9 * B, 0], abs=1e-20)
    quiet = ScatteredFrame.from_displacement(points, u, branch=B, sigma=0.05 * B)
    assert quiet.burgers(loop).noise < 0.01 * B


def test_holes_by_length_and_by_boundary():
    """Holes come from missing points, from a window in the boundary, and from masks."""
    beta = distortion(X, Y, B)
    gone = R < 0.4
    frame = ScatteredFrame.from_distortion(POINTS[~gone], beta[..., ~gone], longest=0.25)
    found = frame.burgers(frame.loop_around())
    assert np.abs(found.vector - [B, 0]).max() <= found.error < 0.1 * B
    outer = [[-1.5, -1.5], [1.5, -1.5], [1.5, 1.5], [-1.5, 1.5]]
    window = [[-0.4, -0.5], [0.5, -0.4], [0.4, 0.5], [-0.5, 0.4]]
    frame = ScatteredFrame.from_distortion(POINTS, beta, boundary=[outer, window])
    assert len(frame.holes) == 1
    assert np.abs(frame.points[frame.mesh.inner]).max() < 1.7
    found = frame.burgers(frame.loop_around(margin=2))
    assert np.abs(found.vector - [B, 0]).max() <= found.error < 0.1 * B
    two = ScatteredFrame.from_distortion(POINTS, beta, mask=(R < 0.3) | (np.hypot(X - 1, Y) < 0.25))
    assert len(two.holes) == 2
    sizes = [two.burgers(two.loop_around(k)).vector[0] for k in (0, 1)]
    assert sorted(np.abs(sizes)) == pytest.approx([0, B], abs=0.1 * B)
    with pytest.raises(GeomtorsionError, match="expected the number of one of 2 holes, got none"):
        two.loop_around()


def solid():
    """Points in space, the distortion of a screw along z, and the distances from its line."""
    points = np.random.default_rng(4).uniform(-1, 1, (2000, 3))
    x, y, _ = points.T
    r2 = x**2 + y**2
    beta = np.zeros((3, 3, len(points)))
    beta[2, 0], beta[2, 1] = -y * B / (2 * np.pi * r2), x * B / (2 * np.pi * r2)
    return points, beta, np.sqrt(r2)


def test_a_screw_in_space():
    """Loops around the tube by distortions and displacements; faces of tetrahedra close."""
    points, beta, r = solid()
    frame = ScatteredFrame.from_distortion(points, beta, mask=r < 0.3)
    assert "tetrahedra" in repr(frame)
    for loop in (Loop.circle([0, 0, 0.1], 0.7), Loop.circle([0.1, 0, 0], 0.6).reversed()):
        b = frame.burgers(loop)
        sense = 1 if loop.points(9)[1, 1] > 0 else -1
        assert np.abs(b.vector - [0, 0, sense * B]).max() <= b.error < 0.15 * B
    off = frame.burgers(Loop.circle([0.6, 0.5, 0], 0.3))
    assert np.abs(off.vector).max() <= off.error
    bianchi = frame.cochain.coboundary().coboundary()
    assert (np.abs(bianchi.values).max(axis=1) <= bianchi.errors).all()
    u = np.zeros((3, len(points)))
    u[2] = B * np.arctan2(points[:, 1], points[:, 0]) / (2 * np.pi)
    jumps = ScatteredFrame.from_displacement(points, u, branch=B)
    assert jumps.burgers(Loop.circle([0, 0, 0], 0.7)).vector == pytest.approx([0, 0, B])
    faces = jumps.burgers_map()
    place = points[jumps.mesh.corners][..., :2]
    one, two = place, np.roll(place, -1, axis=1)
    turn = np.arctan2(one[..., 0] * two[..., 1] - one[..., 1] * two[..., 0], (one * two).sum(-1))
    times = np.rint(turn.sum(axis=1) / (2 * np.pi))
    assert np.abs(times).sum() > 20
    assert np.abs(faces.vectors[2]) == pytest.approx(B * np.abs(times), abs=1e-12)
    for call in (lambda: frame.holes, frame.loop_around, lambda: frame.burgers_map(1)):
        with pytest.raises(
            GeomtorsionError, match="expected points in a plane, got points in space"
        ):
            call()


def test_points_of_a_square_grid():
    """Where four points are equally near to a loop, the path goes through one of them."""
    x, y = (p.ravel() for p in np.mgrid[:9, :9].astype(float))
    frame = ScatteredFrame.from_coframe(np.stack([x, y], axis=1), np.array([[-y, x]]) / 2)
    assert frame.burgers(Loop.polygon([[1, 1], [5, 1], [5, 5], [1, 5]])).vector == pytest.approx(
        [16]
    )
    diamond = Loop.polygon([[4, 1], [7, 4], [4, 7], [1, 4]])
    assert frame.burgers(diamond).vector == pytest.approx([18], abs=7)


FLAT = np.ones((1, 2, len(X)))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: ScatteredFrame.from_coframe(POINTS[:, :1], FLAT),
            r"shape \(N, 2\) with N > 2 or \(N, 3\)",
        ),
        (
            lambda: ScatteredFrame.from_coframe(POINTS, FLAT[:, :, 1:]),
            r"coframe: expected shape \(rows, 2",
        ),
        (lambda: ScatteredFrame.from_coframe(POINTS, FLAT, order=3), "order: expected one of 2, 4"),
        (
            lambda: ScatteredFrame.from_coframe(POINTS, FLAT, longest=-1),
            "longest: expected a positive",
        ),
        (
            lambda: ScatteredFrame.from_coframe(POINTS, FLAT, longest=1e-3),
            "expected at least one triangle, got none",
        ),
        (
            lambda: ScatteredFrame.from_coframe(POINTS, FLAT * np.nan),
            "expected at least one triangle, got none",
        ),
        (lambda: ScatteredFrame.from_coframe(POINTS, FLAT * np.inf), "got infinity at point 0"),
        (lambda: ScatteredFrame.from_coframe(POINTS, FLAT, shape=3), "option"),
        (lambda: ScatteredFrame.from_coframe(POINTS, FLAT, boundary=[[0, 1]]), "three corners"),
        (
            lambda: ScatteredFrame.from_coframe(
                POINTS, FLAT, boundary=[[0, 0], [1, 0], [1, np.nan]]
            ),
            "boundary: expected polygons with finite corners",
        ),
        (
            lambda: ScatteredFrame.from_coframe(POINTS, FLAT).burgers_map(plane=1),  # type: ignore[arg-type]  # on purpose
            "plane: expected two different axes from 0 to 1, got 1",
        ),
        (
            lambda: ScatteredFrame.from_coframe(POINTS, FLAT, sigma=-1),
            "sigma: expected standard deviations",
        ),
        (
            lambda: ScatteredFrame.from_coframe(POINTS, FLAT, sigma=1, covariance=np.eye(2)),
            "expected either sigma or covariance, got both",
        ),
        (
            lambda: ScatteredFrame.from_coframe(POINTS, FLAT, mask=[1]),
            "mask: expected truth values",
        ),
        (lambda: ScatteredFrame.from_coframe(POINTS * [1, 0], FLAT), "not all on one line"),
        (
            lambda: ScatteredFrame.from_coframe(
                np.concatenate([POINTS, POINTS[:1]]), np.ones((1, 2, len(X) + 1))
            ),
            "expected different points, got points",
        ),
        (lambda: ScatteredFrame.from_distortion(POINTS, FLAT[0]), "distortion: expected shape"),
        (lambda: ScatteredFrame.from_displacement(POINTS, FLAT), "displacement: expected shape"),
        (
            lambda: ScatteredFrame.from_displacement(POINTS, FLAT[0], branch=[0, 0]),
            "branch: expected a length",
        ),
    ],
    ids=range(19),
)
def test_invalid_points_are_refused(make, message):
    """Each wrong argument has its own message."""
    with pytest.raises(GeomtorsionError, match=message):
        make()


@pytest.mark.parametrize(
    ("circuit", "message"),
    [
        (Loop.circle([0, 0], 0.2), "touches a hole between point"),
        (Loop.circle([0, 0], 3), "leaves the points"),
        (Loop.circle([0, 0, 0], 1), "expected 2 coordinates, as the points have, got 3"),
        (Loop.circle([1, 1], 1e-3), "surrounds no triangle"),
        ([0, 1], "three points or more"),
        ([0, 1, 1600], "there is no edge"),
        ([0, 1, -1], "node -1 is not in the network"),
        ({0: 1}, "expected a closed chain of edges"),
        ({-1: 1}, "edge: expected a whole number from 0"),
        ({0: 0.5}, r"circuit\[0\]: expected a whole number"),
        ("here", "circuit"),
    ],
)
def test_circuits_that_there_are_not(circuit, message):
    """Each wrong circuit has its own message."""
    frame = ScatteredFrame.from_coframe(POINTS, FLAT, mask=R < 0.35)
    with pytest.raises(GeomtorsionError, match=message):
        frame.burgers(circuit)
    for hole, margin in ((3, 1), (0, 0), (-1, 1)):
        with pytest.raises(GeomtorsionError, match="hole|margin"):
            frame.loop_around(hole, margin)
    with pytest.raises(GeomtorsionError, match="no holes"):
        ScatteredFrame.from_coframe(POINTS, FLAT).loop_around()
