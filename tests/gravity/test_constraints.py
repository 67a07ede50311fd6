"""Constraints: initial data of formulas and on grids, against known solutions and wrong ones."""

from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GeomtorsionError
from tests.cli import running

FLAT = gt.Frame("x y z", [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
R = "sqrt(x**2 + y**2 + z**2)"
wrong: Any = g
UNIT = np.eye(3)[:, :, None, None, None]


def test_flat_space_at_rest():
    """Flat space without K is a solution, as a formula and on a grid, with nothing left."""
    found = g.constraints(FLAT)
    assert isinstance(found, g.Constraints)
    assert found.is_zero
    assert repr(found) == "constraints: H = 0, M_x = 0, M_y = 0, M_z = 0"
    grid = gt.SampledFrame.from_metric([np.arange(9.0)] * 3, UNIT * np.ones((9, 9, 9)))
    sampled = g.constraints(grid)
    assert isinstance(sampled, g.SampledConstraints)
    assert sampled.is_solution
    assert not sampled.hamiltonian.values.any()
    assert not sampled.momentum.values.any()
    assert sampled.residuals["hamiltonian"].relative == 0


def test_two_holes_of_brill_and_lindquist():
    """The metric psi^4 delta with K = 0 is a solution where psi is harmonic."""
    psi = "(1 + m/(2*sqrt(x**2+y**2+(z-b)**2)) + m/(2*sqrt(x**2+y**2+(z+b)**2)))"

    def hole(power: int) -> gt.Frame:
        entry = f"{psi}**{power}"
        rows = [[entry if i == j else 0 for j in range(3)] for i in range(3)]
        return gt.Frame("x y z", rows, parameters="m b")

    assert g.constraints(hole(2)).is_zero
    assert g.constraints(hole(3)).is_zero is False


def kerr_schild_rows(sign: str = "") -> list[list[str]]:
    """York's K_ij of the Kerr-Schild slice of Schwarzschild, M = m."""
    q = "xyz"
    return [
        [
            f"{sign}2*m/{R}**2/sqrt(1 + 2*m/{R})*({int(i == j)} - (2 + m/{R})*{q[i]}*{q[j]}/{R}**2)"
            for j in range(3)
        ]
        for i in range(3)
    ]


def kerr_schild_metric() -> gt.Frame:
    """The metric of the slice: delta_ij + 2 m x_i x_j/r^3."""
    q = "xyz"
    rows = [[f"{int(i == j)} + 2*m*{q[i]}*{q[j]}/{R}**3" for j in range(3)] for i in range(3)]
    return gt.Frame.from_metric("x y z", rows, parameters="m")


def test_a_slice_of_formulas_in_motion():
    """The Kerr-Schild slice is a solution; with one entry of K changed it is none."""
    assert g.constraints(kerr_schild_metric(), kerr_schild_rows()).is_zero
    rows = kerr_schild_rows()
    rows[0][0] += " + 1"
    assert g.constraints(kerr_schild_metric(), rows).is_zero is False


def test_the_slice_of_a_spacetime():
    """Surfaces t = const: Kerr in two charts is a solution; a cosmos has Friedmann's density."""
    assert g.constraints(gt.surface("kerr", "r theta phi")).is_zero
    cosmos = gt.surface("frw_flat", "x y z")
    energy = "3/(8*pi)*diff(a(t), t)**2/a(t)**2"
    assert g.constraints(cosmos).is_zero is False
    assert cosmos.frame is not None
    a = gt.Frame("t x y z", [[1, 0, 0, 0], [0, "t", 0, 0], [0, 0, "t", 0], [0, 0, 0, "t"]], "-+++")
    assert g.constraints(gt.surface(a, "x y z"), density="3/(8*pi*t**2)").is_zero
    assert g.constraints(gt.surface(a, "x y z"), density="1/(8*pi*t**2)").is_zero is False
    assert energy


def test_the_sign_of_the_momentum():
    """On a tilted slice of a cosmos rho = T_nn and j_i = -T_in, from Einstein's tensor there."""
    cosmos = gt.Frame("t x y", [[1, 0, 0], [0, "t", 0], [0, 0, "t"]], "-++")
    tilted = gt.surface(cosmos, "x y", {"t": "1 + x/3", "x": "x", "y": "y"})
    place = {"t": 1.25, "x": 0.75, "y": 0.5}
    einstein = np.asarray(cosmos.quantity("einstein").at(place))
    normal = np.array([float(n.subs({"x": 0.75})) for n in tilted.normal])
    # The normal of the surface points to the past.
    future = -normal
    assert future[0] > 0
    rho = float(future @ einstein @ future) / (8 * np.pi)
    slopes = np.array([[1 / 3, 1, 0], [0, 0, 1]])
    flux = -slopes @ einstein @ future / (8 * np.pi)
    assert abs(flux[0]) > 0.005
    found = g.constraints(tilted, density=Fraction(rho), momentum=[Fraction(x) for x in flux])
    here = {"x": 0.75, "y": 0.5}
    left = [float(found.hamiltonian.at(here)), *np.asarray(found.momentum.at(here))]
    assert np.abs(left).max() < 100 * np.finfo(float).eps
    turned = g.constraints(tilted, density=Fraction(rho), momentum=[Fraction(-x) for x in flux])
    assert abs(np.asarray(turned.momentum.at(here))[0]) > 0.1


def test_a_cosmological_constant():
    """A round sphere at rest has R = 6 = 2 Lambda."""
    sphere = gt.Frame("a b c", [["1", 0, 0], [0, "sin(a)", 0], [0, 0, "sin(a)*sin(b)"]])
    assert g.constraints(sphere, cosmological_constant=3).is_zero
    assert g.constraints(sphere, cosmological_constant=2).is_zero is False


# -- on grids ------------------------------------------------------------------------------------


def kerr_schild(n: int) -> tuple[list[np.ndarray], np.ndarray, np.ndarray]:
    """Axes, metric and K of the Kerr-Schild slice of Schwarzschild outside r = 1.7, M = 1."""
    axes = [np.linspace(1, 3, n)] * 3
    x = np.array(np.meshgrid(*axes, indexing="ij"))
    r = np.sqrt((x**2).sum(axis=0))
    ray = (x / r)[:, None] * (x / r)[None]
    K = 2 / r**2 / np.sqrt(1 + 2 / r) * (UNIT - (2 + 1 / r) * ray)
    return axes, UNIT + 2 / r * ray, K


def test_a_moving_slice_on_a_grid_converges():
    """Residuals fall with the order and are within the errors; a wrong factor shows."""
    worst = []
    for n in (15, 29):
        axes, metric, K = kerr_schild(n)
        frame = gt.SampledFrame.from_metric(axes, metric, unit="M")
        found = g.constraints(frame, K)
        assert found.is_solution
        assert (np.abs(found.hamiltonian.values) <= found.hamiltonian.error).all()
        assert (np.abs(found.momentum.values) <= found.momentum.error).all()
        assert found.hamiltonian.unit == found.momentum.unit == "1/M^2"
        worst.append([one.rms for one in found.residuals.values()])
    assert (np.log2(np.divide(*worst)) > 3).all()
    assert all(3 < one.order < 5 for one in found.residuals.values())
    for factor in (1.1, 0.9):
        other = g.constraints(frame, factor * K)
        assert not other.is_solution
        assert abs(other.residuals["hamiltonian"].order) < 0.5
        # M_i is linear in K: only H sees a factor.
        assert other.residuals["momentum"].mismatch < 1
    bent = K * (1 + 0.1 * axes[0][:, None, None])
    assert abs(g.constraints(frame, bent).residuals["momentum"].order) < 0.5


def test_terms_that_cancel_leave_rounding():
    """On the flat slice of Painleve and Gullstrand H is K^2 - K_ij K^ij, zero but for rounding."""
    axes, _, _ = kerr_schild(15)
    x = np.array(np.meshgrid(*axes, indexing="ij"))
    r = np.sqrt((x**2).sum(axis=0))
    K = np.sqrt(2) * r**-1.5 * (UNIT - 1.5 * (x / r)[:, None] * (x / r)[None])
    found = g.constraints(gt.SampledFrame.from_metric(axes, UNIT * np.ones_like(r)), K)
    assert found.is_solution
    assert np.isnan(found.residuals["hamiltonian"].order)
    assert found.residuals["momentum"].order > 3


def test_noise_is_an_error():
    """Noise of the metric hides a solution, and the errors contain it."""
    axes, metric, K = kerr_schild(17)
    noise = np.random.default_rng(1).normal(size=metric.shape)
    noise = 1e-5 * (noise + np.swapaxes(noise, 0, 1))
    found = g.constraints(gt.SampledFrame.from_metric(axes, metric + noise), K)
    assert found.is_solution
    assert found.residuals["hamiltonian"].order < 0
    clear = g.constraints(gt.SampledFrame.from_metric(axes, metric), K)
    ratio = found.residuals["hamiltonian"].error / clear.residuals["hamiltonian"].error
    assert np.median(ratio) > 3


def two_holes(n: int, power: float) -> gt.SampledFrame:
    """The metric psi^power delta of two holes at z = -1 and 1, excised within 0.6."""
    axes = [np.linspace(-2, 2, n), np.linspace(-2, 2, n), np.linspace(-3, 3, n)]
    x, y, z = np.meshgrid(*axes, indexing="ij")
    one, two = (np.sqrt(x**2 + y**2 + (z - b) ** 2) for b in (1, -1))
    mask = (one < 0.6) | (two < 0.6)
    with np.errstate(divide="ignore"):
        psi = 1 + 0.5 / one + 0.5 / two
    metric = UNIT * np.where(mask, np.nan, psi) ** power
    return gt.SampledFrame.from_metric(axes, metric, mask=mask, unit="M")


def test_two_excised_holes_on_a_grid():
    """Brill-Lindquist data with excised holes are a solution; psi^4.4 instead of psi^4 is none."""
    found = g.constraints(two_holes(31, 4))
    assert found.is_solution
    assert found.residuals["hamiltonian"].order > 2
    assert found.residuals["momentum"].largest == 0
    assert "falls with order" in repr(found)
    assert not g.constraints(two_holes(31, 4.4)).is_solution


@pytest.mark.parametrize("n", [21, 31, 41])
@pytest.mark.parametrize("power", [4, 4.1, 4.4])
def test_the_verdict_names_what_it_cannot_see(n: int, power: float):
    """R of psi^q delta is -2 q (q/4 - 1) psi^(-q/2 - 2) (psi')^2; more than `visible` shows."""
    found = g.constraints(two_holes(n, power))
    residual = found.residuals["hamiltonian"]
    x, y, z = np.meshgrid(*found.frame.axes, indexing="ij")
    psi, slope = 1.0, np.zeros((3, *x.shape))
    with np.errstate(divide="ignore", invalid="ignore"):
        for b in (1, -1):
            ray = np.array([x, y, z - b])
            r = np.sqrt((ray**2).sum(axis=0))
            psi, slope = psi + 0.5 / r, slope - 0.5 * ray / r**3
        H = -2 * power * (power / 4 - 1) * psi ** (-power / 2 - 2) * (slope**2).sum(axis=0)
        inside = residual._counted & (residual.scale > 0)
        share = np.sqrt(np.mean((H / residual.scale)[inside] ** 2))
    if residual.visible >= 1:
        assert found.is_solution is not True
        assert "too coarse" in repr(found)
    elif power == 4:
        assert found.is_solution
    elif share > 3 * residual.visible:
        assert found.is_solution is False
    # At 31 nodes an exponent of 4.1 is not seen, and the printed size is larger.
    if (n, power) == (31, 4.1):
        assert found.is_solution
        assert share < 2 * residual.visible
        assert f"relative size of {residual.visible:.1g}" in repr(found)


def test_a_finer_grid_sees_less_wrong_data():
    """The size that shows falls with the fourth power of the step."""
    sizes = []
    for n in (17, 33):
        axes, metric, K = kerr_schild(n)
        found = g.constraints(gt.SampledFrame.from_metric(axes, metric), K)
        assert found.is_solution
        sizes.append([one.visible for one in found.residuals.values()])
    assert (np.log2(np.divide(*sizes)) > 3.5).all()


def bowen_york(n: int, power: float = -2, sign: int = -1) -> tuple[gt.SampledFrame, Any, Any]:
    """A hole that moves along x (Bowen and York 1980), with the density that satisfies H = 0.

    K_ij = psi^-2 A_ij, A_ij = 3 P/(2 r^2) (x_i n_j + n_i x_j - (delta_ij - n_i n_j) n_x).
    """
    axes = [np.linspace(1, 3, n)] * 3
    x = np.array(np.meshgrid(*axes, indexing="ij"))
    r = np.sqrt((x**2).sum(axis=0))
    ray = x / r
    along = np.array([1.0, 0, 0])[:, None, None, None]
    both = ray[:, None] * along[None] + along[:, None] * ray[None]
    A = 1.5 / r**2 * (both + sign * (UNIT - ray[:, None] * ray[None]) * ray[0])
    psi = 1 + 0.5 / r
    K = psi**power * A
    square = psi ** (2 * power - 8) * (A**2).sum(axis=(0, 1))
    trace = psi ** (power - 4) * np.trace(A)
    frame = gt.SampledFrame.from_metric(axes, UNIT * psi**4)
    return frame, K, (trace**2 - square) / (16 * np.pi)


@pytest.mark.parametrize("n", [13, 17, 25])
def test_a_moving_hole_on_a_grid(n: int):
    """Bowen and York's K_ij solves M_i = 0; a wrong power of psi or a wrong sign does not."""
    frame, K, density = bowen_york(n)
    assert g.constraints(frame, K, density=density).is_solution
    for wrong_data in (bowen_york(n, -2.1), bowen_york(n, -4), bowen_york(n, sign=1)):
        found = g.constraints(wrong_data[0], wrong_data[1], density=wrong_data[2])
        assert found.is_solution is False
        assert found.residuals["hamiltonian"].mismatch < 1
        assert found.residuals["momentum"].mismatch > 1
    # Without the density the Hamiltonian constraint sees K.
    alone = g.constraints(frame, K)
    assert alone.is_solution is False
    assert alone.residuals["momentum"].mismatch < 1


@pytest.mark.parametrize("zero", [0, 0.0, np.float64(0), None])
def test_zero_is_a_value(zero: Any):
    """A number for the same value at all nodes, instead of arrays; zero for every tensor."""
    given = {"density": zero, "momentum": zero}
    assert g.constraints(GRID, zero, **given).is_solution
    found = g.constraints(FLAT, zero, **given)
    assert isinstance(found, g.Constraints)
    assert found.is_zero


def test_the_same_value_at_all_nodes():
    """rho = 3 H^2/(8 pi) with K_ij = -H delta_ij in flat space, as numbers without a grid."""
    K, density = -np.eye(3), 3 / (8 * np.pi)
    assert g.constraints(GRID, K, density=density, momentum=[0, 0, 0]).is_solution
    assert g.constraints(GRID, K).is_solution is False
    assert g.constraints(GRID, K, density=density, momentum=[1, 0, 0]).is_solution is False


def test_matter_on_a_grid():
    """A homogeneous cosmos: H = K^2 - K_ij K^ij = 16 pi rho, as in Friedmann's equation."""
    axes = [np.linspace(0, 1, 9)] * 3
    ones = np.ones((9, 9, 9))
    frame = gt.SampledFrame.from_metric(axes, UNIT * 4 * ones)
    K = -UNIT * 4 * 0.5 * ones
    rho = 6 * 0.25 / (16 * np.pi) * ones
    assert g.constraints(frame, K, density=rho).is_solution
    assert not g.constraints(frame, K).is_solution
    assert not g.constraints(frame, K, density=rho, momentum=np.ones((3, 9, 9, 9))).is_solution


def save(path: Path, **more: Any) -> None:
    """A file of the Kerr-Schild slice."""
    axes, metric, K = kerr_schild(11)
    lines = {f"axis_{name}": axis for name, axis in zip("xyz", axes, strict=True)}
    np.savez(path, **{"metric": metric, "extrinsic_curvature": K, "unit": "M", **lines, **more})


def test_files_and_the_command(tmp_path: Path):
    """A file gives the result of its arrays; the command prints it and writes a figure."""
    file = tmp_path / "slice.npz"
    save(file)
    axes, metric, K = kerr_schild(11)
    direct = g.constraints(gt.SampledFrame.from_metric(axes, metric, unit="M"), K)
    data = g.read_slice(file)
    assert repr(data.constraints()) == repr(direct)
    assert "extrinsic_curvature" in repr(data)
    done = running.run("constraints", str(file), "-o", str(tmp_path / "out"))
    assert "both vanish within the error of the grid" in " ".join(done.stdout.split())
    assert (tmp_path / "out" / "constraints.json").exists()
    figure = gt.pictures.draw_constraints(direct, (0, 2), at={"y": 2})
    assert "y = 2" in " ".join(text.get_text() for text in figure.texts)


def save_hdf5(path: Path, names: Any = None, **more: Any) -> None:
    """The same slice as an HDF5 file, with other data sets on request; None omits one."""
    h5py = pytest.importorskip("h5py")
    axes, metric, K = kerr_schild(11)
    lines = {f"axis_{name}": axis for name, axis in zip("xyz", axes, strict=True)}
    with h5py.File(path, "w") as file:
        for name, array in {"metric": metric, "extrinsic_curvature": K, **lines, **more}.items():
            if array is not None:
                file[name] = array
        file.attrs["unit"] = "M"
        if names:
            file.attrs["names"] = names


@pytest.mark.parametrize("end", [".h5", ".hdf5", ".H5"])
def test_hdf5_files_and_the_command(tmp_path: Path, end: str):
    """An HDF5 file gives the result of the NPZ file with the same arrays."""
    save(tmp_path / "slice.npz", density=np.ones((11, 11, 11)))
    save_hdf5(tmp_path / f"slice{end}", density=np.ones((11, 11, 11)))
    one, two = (g.read_slice(tmp_path / f"slice{x}", 2) for x in (".npz", end))
    assert repr(one) == repr(two)
    first, second = one.constraints(), two.constraints()
    assert first.hamiltonian.values.tobytes() == second.hamiltonian.values.tobytes()
    assert first.hamiltonian.unit == second.hamiltonian.unit == "1/M^2"
    done = running.run("constraints", str(tmp_path / f"slice{end}"))
    assert "they do not vanish" in " ".join(done.stdout.split())


def test_holes_and_periods_of_an_hdf5_file(tmp_path: Path):
    """mask marks excised nodes, and the attribute periodic lists axes."""
    h5py = pytest.importorskip("h5py")
    mask = np.zeros((11, 11, 11), dtype=int)
    mask[:3, :3, :3] = 1
    axes = {f"axis_{x}": np.arange(11.0) for x in "xyz"}
    flat = UNIT * np.ones((11, 11, 11))
    save_hdf5(tmp_path / "flat.h5", metric=flat, extrinsic_curvature=None, mask=mask, **axes)
    with h5py.File(tmp_path / "flat.h5", "a") as file:
        file.attrs["periodic"] = "x y"
    data = g.read_slice(tmp_path / "flat.h5")
    assert data.extrinsic_curvature is None
    assert data.constraints().is_solution
    assert np.isnan(data.constraints().hamiltonian.values[0, 0, 0])
    assert list(data.frame.periodic) == [True, True, False]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"metric": None}, "expected a data set metric"),
        ({"metric": np.ones((2, 3, 11, 11, 11))}, "expected shape"),
        ({"axis_y": None}, "order of the axes|axis_y"),
        ({"names": "x y z", "axis_y": None}, "axis_y"),
        ({"extrinsic_curvature": np.ones((3, 11, 11, 11))}, "extrinsic_curvature: expected shape"),
        ({"density": np.array([b"a"])}, "expected real numbers"),
        ({"mask": np.full((11, 11, 11), 7)}, "expected 1 at unknown nodes"),
    ],
)
def test_wrong_hdf5_files_are_refused(tmp_path: Path, change: dict[str, Any], words: str):
    """A file with wrong data sets is refused by the name of the data set."""
    save_hdf5(tmp_path / "slice.h5", **change)
    with pytest.raises(GeomtorsionError, match=words):
        g.read_slice(tmp_path / "slice.h5").constraints()


def test_impossible_sizes_are_refused_before_memory_is_taken(tmp_path: Path):
    """A data set that declares 10^15 bytes, and a file of text."""
    h5py = pytest.importorskip("h5py")
    save_hdf5(tmp_path / "slice.h5")
    with h5py.File(tmp_path / "slice.h5", "a") as file:
        file.create_dataset("density", (50_000, 50_000, 50_000), "f8", chunks=(10, 10, 10))
    with pytest.raises(GeomtorsionError, match="bytes"):
        g.read_slice(tmp_path / "slice.h5")
    (tmp_path / "text.h5").write_text("not a file of arrays")
    with pytest.raises(GeomtorsionError, match="not an HDF5 file"):
        g.read_slice(tmp_path / "text.h5")


AXES = [np.linspace(1, 2, 9)] * 3
GRID = gt.SampledFrame.from_metric(AXES, UNIT * np.ones((9, 9, 9)))
ONES = np.ones((3, 3, 9, 9, 9))
SKEW = np.triu(np.ones((3, 3)))[:, :, None, None, None] * np.ones((9, 9, 9))
LORENTZ = gt.SampledFrame.from_metric(AXES, np.diag([-1, 1, 1])[:, :, None, None, None]
                                      * np.ones((9, 9, 9)))  # fmt: skip
REFUSALS = [
    (lambda: g.constraints(GRID, ONES[:2]), r"expected shape \(3, 3, 9, 9, 9\)"),
    (lambda: g.constraints(GRID, SKEW), "symmetric"),
    (lambda: g.constraints(GRID, density=ONES), "density: expected shape"),
    (lambda: g.constraints(GRID, momentum=ONES), "momentum: expected shape"),
    (lambda: g.constraints(GRID, ONES * np.inf), "extrinsic_curvature"),
    (lambda: g.constraints(GRID, cosmological_constant="x"), "cosmological_constant"),
    (lambda: g.constraints(LORENTZ), "positive metric of a slice"),
    (lambda: g.constraints(FLAT, [[0, 1], [1, 0]]), "3 rows of 3 entries"),
    (lambda: g.constraints(FLAT, [[0, "x", 0], [0, 0, 0], [0, 0, 0]]), "symmetric matrix"),
    (lambda: g.constraints(FLAT, momentum=[0, 0]), "momentum"),
    (lambda: g.constraints("schwarzschild"), "positive metric of a slice"),
    (lambda: g.constraints(gt.surface("schwarzschild", "t theta phi")), "spacelike"),
    (lambda: g.constraints(gt.surface("schwarzschild", "r theta phi"), [[0]]), "beside a surface"),
    (lambda: wrong.constraints(3), "metric"),
    (lambda: g.read_slice("slice.txt"), "ending in .npz or .h5"),
    (lambda: g.read_slice("absent.h5"), "absent"),
    (lambda: g.constraints(GRID, 1.0), "extrinsic_curvature: expected shape"),
    (lambda: g.read_slice("absent.npz"), "absent"),
    (lambda: g.read_slice("absent.npz", 5), "order"),
    (lambda: gt.pictures.draw_constraints(g.constraints(GRID), (0, 0)), "two different axes"),
    (lambda: gt.pictures.draw_constraints(g.constraints(GRID), (0, 1), {"t": 1}), "at"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_refusals(call: Any, words: str):
    """The message of each wrong call names the expected value."""
    with pytest.raises(GeomtorsionError, match=words):
        call()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"metric": np.ones((2, 3, 11, 11, 11))}, "expected shape"),
        ({"axis_x": np.arange(5.0)}, "expected shape"),
        ({"axis_x": np.geomspace(1, 2, 11)}, "equal steps"),
        ({"extrinsic_curvature": np.array(["a"])}, "does not fit"),
    ],
)
def test_wrong_files_are_refused(tmp_path: Path, change: dict[str, Any], words: str):
    """A file with wrong arrays is refused by the name of the array."""
    file = tmp_path / "slice.npz"
    save(file, **change)
    with pytest.raises(GeomtorsionError, match=words):
        g.read_slice(file).constraints()
