"""Sampled frames: orders, reliable errors, Nye tensor, files."""

# The tests pass what users pass, including wrong types, and read optional values.
# pyright: reportArgumentType=false, reportCallIssue=false

from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy.io import netcdf_file

import geomtorsion.spaces as spaces
from geomtorsion.errors import ArgumentError, FileFormatError, GridError, NetworkError
from geomtorsion.geometry import Frame
from geomtorsion.loops import (
    Cochain,
    EdgeList,
    Loop,
    Network,
    burgers_vector,
    develop,
    parallel_screws,
)
from geomtorsion.materials.fields import SampledFrame, blocked_map
from tests.rounding import ROUNDED

ORDERS = (2, 4, 6, 8)
x, y, z = sp.symbols("x y z", real=True)


@pytest.fixture(scope="module")
def wavy() -> Frame:
    """A smooth frame that depends on all coordinates."""
    return Frame(
        [x, y, z],
        [
            [1 + sp.sin(x + y) / 5, sp.cos(x + y + z) / 7, 0],
            [sp.exp(-z) * y / 9 * sp.cos(x), 1 + sp.sin(y) * x / 8, sp.sin(x * y + z) / 6],
            [y * z / 8 * sp.sin(x), -sp.cos(2 * y) * z / 9, 1 + x**2 * sp.exp(z) / 10],
        ],
    )


def sampled(frame: Frame, count: int, order: int) -> SampledFrame:
    axes = [np.linspace(-1, 1, count), np.linspace(-0.5, 1.5, count), np.linspace(0, 1, count)]
    return SampledFrame.from_frame(frame, axes, order)


@pytest.mark.parametrize("order", ORDERS)
def test_loops_converge_with_their_order_and_errors_hold(wavy, order):
    """Halving the spacing divides the error by 2^order; the stated error bounds the true one."""
    loop = Loop.ellipse([0.1, 0.4, 0.5], (0.6, 0.3), ((1, 0.2, 0.1), (0, 1, 0.4)))
    exact = burgers_vector(wavy, loop).vector
    errors = []
    for count in (13, 25):
        found = sampled(wavy, count, order).burgers(loop)
        errors.append(np.abs(found.vector - exact).max())
        assert errors[-1] <= found.error
        assert found.systematic["quadrature"] < 0.1 * found.systematic["interpolation"] + ROUNDED
    assert np.log2(errors[0] / errors[1]) > order - 0.8


@pytest.mark.parametrize("order", ORDERS)
def test_plaquettes_are_small_loops(wavy, order):
    """Each cell agrees with the loop around it, in each plane, within its error and order."""
    worst = {}
    for count in (11, 21):
        grid = sampled(wavy, count, order)
        worst[count] = 0.0
        for plane in ((0, 1), (1, 2), (2, 0)):
            cells = grid.plaquettes(plane)
            for place in ((0, 0, 0), (4, 3, 5), (count - 2,) * 3):
                corner = [float(axis[k]) for axis, k in zip(grid.axes, place, strict=True)]
                steps = (grid.steps[plane[0]], grid.steps[plane[1]])
                exact = burgers_vector(wavy, Loop.plaquette(corner, steps, plane)).vector
                missed = np.abs(cells.vectors[(slice(None), *place)] - exact).max()
                # One-sided stencils at the edge may be slightly worse than their comparison.
                assert missed <= 2 * cells.errors[place] + 1e-17
                worst[count] = max(worst[count], missed / cells.area)
    assert np.log2(worst[11] / worst[21]) > order - 1.2


def test_cells_sum_to_the_loop_around_them(wavy):
    """Neighbouring cells share edges, so a block of cells sums to the loop around the block."""
    grid = sampled(wavy, 15, 6)
    block = grid.plaquettes((0, 1)).vectors[:, 2:9, 3:12, 7].sum(axis=(1, 2))
    corner = [float(grid.axes[0][2]), float(grid.axes[1][3]), float(grid.axes[2][7])]
    loop = Loop.plaquette(corner, (7 * grid.steps[0], 9 * grid.steps[1]))
    found = grid.burgers(loop)
    assert np.abs(block - found.vector).max() < 1e-8
    assert np.abs(block - burgers_vector(wavy, loop).vector).max() < 1e-7


@pytest.mark.parametrize("order", ORDERS)
def test_torsion_and_nye_tensor(wavy, order):
    """Differences agree with the exact curl; alpha^{ik} = eps^{kab} d_a e^i_b."""
    worst = []
    for count in (11, 21):
        grid = sampled(wavy, count, order)
        largest = 0.0
        nodes = np.meshgrid(*grid.axes, indexing="ij")
        for k, (a, b) in enumerate(((1, 2), (2, 0), (0, 1))):
            values, errors = grid.torsion((a, b))
            assert (grid.nye[:, k] == values).all()
            exact = np.stack(
                [
                    np.broadcast_to(
                        sp.lambdify(
                            (x, y, z),
                            wavy.coframe[i, b].diff((x, y, z)[a])
                            - wavy.coframe[i, a].diff((x, y, z)[b]),
                        )(*nodes),
                        nodes[0].shape,
                    )
                    for i in range(3)
                ]
            )
            missed = np.abs(values - exact)
            largest = max(largest, float(missed.max()))
            assert (missed <= 3 * errors + 3e-13 + 2 * errors.max()).all()
        worst.append(largest)
    assert np.log2(worst[0] / worst[1]) > order - 1.2


def test_screw_dislocation_between_nodes():
    """With a line between nodes the cells sum to b, the core is the largest, and a loop has b."""
    frame = parallel_screws([(0, 0)], [1])
    axes = [np.linspace(-1, 1, 40), np.linspace(-1, 1, 40), np.linspace(0, 1, 5)]
    grid = SampledFrame.from_frame(frame, axes, order=2)
    cells = grid.plaquettes()
    assert np.abs(cells.vectors.sum(axis=(1, 2))[2] - 1).max() < 1e-3
    core = np.unravel_index(np.abs(cells.vectors[2, :, :, 0]).argmax(), (39, 39))
    assert tuple(map(int, core)) == (19, 19)
    found = grid.burgers(Loop.circle([0, 0, 0.5], 0.8))
    assert abs(found.vector[2] - 1) <= found.error
    assert found.error < 1e-2


def test_distortion_is_the_coframe_less_one():
    """e = 1 + beta; a gradient closes for any order; decreasing axes are used as given."""
    axes = [np.linspace(2, -2, 21), np.linspace(-1, 1, 17)]
    X, Y = np.meshgrid(*axes, indexing="ij")
    gradient = np.array([[2 * X * Y, X**2], [np.cos(Y) * 0, -np.sin(Y)]]) / 10
    grid = SampledFrame.from_distortion(axes, gradient, 6, ("u", "v"))
    assert (grid.coframe[0, 0] == 1 + 2 * X * Y / 10).all()
    assert np.abs(grid.plaquettes().vectors).max() < 1e-9
    turning = np.array([[-Y, X]]) / 2
    spiral = SampledFrame(axes, turning)
    assert np.abs(spiral.torsion()[0] - 1).max() < 1e-12
    assert np.abs(spiral.nye[:, 0] - 1).max() < 1e-12
    assert np.abs(spiral.plaquettes().density - 1).max() < 1e-12
    b = spiral.burgers(Loop.circle([0.2, 0.1], 0.5))
    assert abs(b.vector[0] - np.pi / 4) <= b.error + 1e-14
    assert b.error < 1e-10


def test_npz_and_netcdf_come_back(tmp_path, wavy):
    """Grids read back unchanged, and so do distortion files."""
    grid = sampled(wavy, 9, 4)
    grid.save(tmp_path / "grid.npz")
    again = SampledFrame.read(tmp_path / "grid.npz")
    assert (again.coframe == grid.coframe).all()
    assert again.names == ("x", "y", "z")
    beta = grid.coframe - np.eye(3)[:, :, None, None, None]
    names = {f"axis_{name}": axis for name, axis in zip("xyz", grid.axes, strict=True)}
    np.savez(tmp_path / "beta.npz", **{"distortion": beta, **names})  # type: ignore[arg-type]
    assert np.abs(SampledFrame.read(tmp_path / "beta.npz").coframe - grid.coframe).max() < ROUNDED
    with netcdf_file(tmp_path / "grid.nc", "w") as data:
        for name, axis in zip("xyz", grid.axes, strict=True):
            data.createDimension(name, len(axis))
            data.createVariable(name, "d", (name,))[:] = axis
        data.createDimension("row", 3)
        data.createDimension("column", 3)
        data.createVariable("coframe", "d", ("row", "column", "x", "y", "z"))[:] = grid.coframe
    assert (SampledFrame.read(tmp_path / "grid.nc").coframe == grid.coframe).all()


def test_broken_files_are_refused(tmp_path, wavy):
    """Missing, truncated, malformed, incomplete and pickled files raise only our own errors."""
    grid = sampled(wavy, 9, 4)
    whole = tmp_path / "grid.npz"
    grid.save(whole)
    content = whole.read_bytes()
    for share in (0.0, 0.3, 0.9, 0.999):
        cut = tmp_path / "cut.npz"
        cut.write_bytes(content[: int(share * len(content))])
        with pytest.raises(FileFormatError, match="truncated"):
            SampledFrame.read(cut)
    bad = tmp_path / "bad.npz"
    for junk in (
        b"not an archive at all",
        b"PK\x03\x04" + b"\0" * 50,
        content[:200] + b"\xff" * 400,
    ):
        bad.write_bytes(junk)
        with pytest.raises(FileFormatError):
            SampledFrame.read(bad)
    for name, arrays, message in (
        ("a", {"axis_x": [0, 1]}, "exactly one of coframe and distortion"),
        ("b", {"coframe": grid.coframe}, "expected arrays axis_x, axis_y, ..., got coframe"),
        (
            "c",
            {"coframe": grid.coframe, "names": ["x", "y"], "axis_x": [0, 1]},
            "expected an array axis_y, because names lists",
        ),
        ("d", {"coframe": np.array([{}], dtype=object), "axis_x": [0, 1]}, "cannot be read"),
    ):
        np.savez(tmp_path / f"{name}.npz", **arrays)  # type: ignore[arg-type]
        with pytest.raises(FileFormatError, match=message):
            SampledFrame.read(tmp_path / f"{name}.npz")
    with pytest.raises(FileFormatError, match="no such file"):
        SampledFrame.read(tmp_path / "nothing.npz")
    (tmp_path / "grid.txt").write_text("1 2 3")
    with pytest.raises(FileFormatError, match="expected a row of names such as x, y, u, v"):
        SampledFrame.read(tmp_path / "grid.txt")
    for junk in (b"", b"CDF\x01", b"CDF\x01" + b"\xff" * 60, b"nonsense"):
        (tmp_path / "bad.nc").write_bytes(junk)
        with pytest.raises(FileFormatError):
            SampledFrame.read(tmp_path / "bad.nc")


AXES = [np.linspace(0, 1, 9), np.linspace(0, 1, 7)]
GOOD = np.ones((2, 2, 9, 7))
HOLE = GOOD.copy()
HOLE[1, 0, 3, 2] = np.inf


@pytest.mark.parametrize(
    ("axes", "values", "order", "message"),
    [
        (AXES, GOOD[:, :, :, :6], 4, r"expected shape \(rows, 2, 9, 7\)"),
        (AXES, GOOD[:, :1], 4, "frame index, coordinate index"),
        (
            AXES,
            HOLE,
            4,
            r"coframe\[1, 0\]: expected finite values, got infinity at x = 0.375, y = 0.333333",
        ),
        (AXES, GOOD, 8, "axis y: expected 9 points or more"),
        (AXES, GOOD, 3, "order: expected one of"),
        (AXES, GOOD.astype(complex), 4, "real numbers"),
        (AXES, "abc", 4, "real numbers"),
        (AXES[:1], GOOD, 4, "two axes or more"),
        (AXES, GOOD * np.nan, 4, "got none: every node is masked"),
        ([AXES[0] ** 2, AXES[1]], GOOD, 4, "axis x: expected equal steps"),
        (
            [AXES[0] * np.nan, AXES[1]],
            GOOD,
            4,
            "axis x: expected finite numbers, got nan at entry 0",
        ),
        ([AXES[0] * 0, AXES[1]], GOOD, 4, "axis x: expected equal steps"),
        ([AXES[0][None], AXES[1]], GOOD, 4, "axis x: expected a list"),
    ],
)
def test_bad_grids_are_refused(axes, values, order, message):
    """Each kind of bad grid has its own message."""
    with pytest.raises(GridError, match=message):
        SampledFrame(axes, values, order)


def test_loops_that_leave_the_grid_are_refused(wavy):
    """Nothing is extrapolated; the message names the point and the axis."""
    grid = sampled(wavy, 9, 4)
    with pytest.raises(GridError, match=r"leaves the grid at .*axis x runs from -1 to 1"):
        grid.burgers(Loop.circle([0.5, 0.5, 0.5], 0.6))
    assert grid.burgers(Loop.circle([0, 0.5, 0.5], 1)).error < 0.1
    with pytest.raises(
        GridError, match="expected 3 coordinates, one for each axis of the grid, got 2"
    ):
        grid.burgers(Loop.circle([0, 0], 0.1))
    for plane in ((0, 0), (0, 3), (0.0, 1.0), (0,), 1):
        with pytest.raises(GridError, match="plane: expected two different axes from 0 to 2, got"):
            grid.plaquettes(plane)
    with pytest.raises(GridError, match="axes: expected one for each of 3"):
        SampledFrame.from_frame(wavy, AXES)
    line = spaces.load("screw_dislocation").frame
    nodes = [np.linspace(-1, 1, 9)] * 3
    with pytest.raises(ArithmeticError, match="no finite value"):
        SampledFrame.from_frame(line, nodes, parameters={"b": 1})


def test_burgers_vector_of_a_grid():
    """A sampled frame has the area of a circle where its torsion is 1, and refuses other types."""
    axes = [np.linspace(-1, 1, 9), np.linspace(-1, 1, 11)]
    x, y = np.meshgrid(*axes, indexing="ij")
    grid = SampledFrame(axes, np.array([[-y, x]]) / 2)
    loop = Loop.circle([0.1, 0.2], 0.5)
    found = grid.burgers(loop)
    assert abs(found.vector[0] - np.pi / 4) <= found.error + 1e-12
    wrong: Any = "loop"
    with pytest.raises(TypeError, match="loop: expected a Loop"):
        grid.burgers(wrong)


@pytest.mark.parametrize("signs", [(1, 1), (-1, 1), (1, -1), (-1, -1)])
def test_cells_turn_the_same_way_on_decreasing_axes(signs):
    """Cells have b of a right-handed circuit for increasing and decreasing axes."""
    axes = [sign * np.linspace(-1, 1, 9) for sign in signs]
    x, y = np.meshgrid(*axes, indexing="ij")
    cells = SampledFrame(axes, np.array([[-y, x]]) / 2).plaquettes()
    assert cells.area == pytest.approx(1 / 16)
    assert cells.vectors == pytest.approx(np.full((1, 8, 8), 1 / 16))
    assert cells.density == pytest.approx(np.ones((1, 8, 8)))


def test_edges_of_a_grid_are_a_cochain(wavy):
    """The coboundary contains all plaquettes of all planes, and their sums over cells vanish."""
    grid = sampled(wavy, 9, 4)
    torsion = grid.cochain.coboundary()
    start = 0
    for a, b in ((0, 1), (0, 2), (1, 2)):
        cells = grid.plaquettes((a, b))
        count = cells.errors.size
        found = torsion.values[start : start + count].T.reshape(cells.vectors.shape)
        assert np.abs(found - cells.vectors).max() < 1e-13
        start += count
    bianchi = torsion.coboundary()
    assert (np.abs(bianchi.values).max(axis=1) <= bianchi.errors).all()


def test_samples_instead_of_a_frame(wavy):
    """`Network` accepts samples; `burgers_vector` and `develop` name the method to use."""
    grid = sampled(wavy, 33, 6)
    loop = Loop.circle([0.1, 0.2, 0.3], 0.4)
    places = np.array([[0.1, 0.1, 0], [0.7, 0.2, 0.1], [0.3, 0.8, 0.9], [-0.6, 0.1, 0.4]])
    net = EdgeList(places, np.array([[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]]))
    exact, rough = Network(wavy, net), Network(grid, net)
    for cycle in ([0, 1, 2], [0, 1, 2, 3]):
        one, two = exact.burgers(cycle), rough.burgers(cycle)
        assert np.abs(one.vector - two.vector).max() <= two.error < 1e-3
    with pytest.raises(NetworkError, match="node rule compares"):
        rough.node_rule()
    with pytest.raises(GridError, match=r"the edge leaves the grid at .*Stay inside the grid"):
        _ = Network(grid, EdgeList(3 * places, net.pairs)).integrals
    samples: Any = grid
    for function in (develop, burgers_vector):
        with pytest.raises(ArgumentError, match=r"Use data.burgers\(loop\)"):
            function(samples, loop)


def test_masked_nodes_are_holes(tmp_path):
    """Masked values of an array are holes, as NaN is."""
    y, x = np.mgrid[:12, :10].astype(float)
    values = np.ma.array([[-x, y]], mask=False)
    values[0, 0, 5, 5] = 1e9
    values[0, 0, 5, 5] = np.ma.masked
    axes = (np.arange(12.0), np.arange(10.0))
    grid, known = (SampledFrame(axes, one) for one in (values, values.filled(np.nan)))
    assert [hole.nodes.tolist() for hole in grid.holes] == [[[5, 5]]]
    assert np.array_equal(grid.plaquettes().vectors, known.plaquettes().vectors, equal_nan=True)
    cut = [blocked_map(one, tmp_path / str(k), (1, 1), 20).read()
           for k, one in enumerate((values, values.filled(np.nan)))]  # fmt: skip
    assert np.array_equal(*cut, equal_nan=True)
    with pytest.raises(NetworkError, match="edge 1: expected finite values"):
        Cochain.of_edges([[0, 1], [1, 2], [2, 0]], np.ma.masked_equal([[1.0], [2.0], [3.0]], 2))
