"""Sources of stresses: networks, coframes and Nye fields, their corrections and refusals."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geomtorsion import (
    Box,
    DislocationNetwork,
    ElasticConstants,
    LineArrays,
    NyeField,
    OrientationMap,
    SampledFrame,
    stresses,
)
from geomtorsion.errors import (
    ArgumentError,
    ElasticityError,
    FileFormatError,
    GridError,
    LimitError,
    NetworkError,
    UnknownNameError,
)
from geomtorsion.materials.elasticity import Stresses
from tests.real import real
from tests.rounding import ROUNDED

STEEL = ElasticConstants.isotropic(80.0, 0.3, unit="GPa")
BOX = Box.of_bounds([0, 0, 0], [4, 4, 4])
SQUARE = [[1, 1, 2], [3, 1, 2], [3, 3, 2], [1, 3, 2]]
SIDES = [[0, 1], [1, 2], [2, 3], [3, 0]]
LOOP = DislocationNetwork.of_arrays(LineArrays(SQUARE, SIDES, [[0.1, 0, 0.2]] * 4, BOX))
FOUND = stresses(LOOP, STEEL, shape=16)


def along_z(vectors, box=BOX) -> DislocationNetwork:
    """Straight lines along z, which leave the box and come back."""
    places = [[k + 0.5, 1.0, 0.0] for k in range(len(vectors))]
    pairs = [[k, k] for k in range(len(vectors))]
    lines = LineArrays(places, pairs, vectors, box, images=[[0, 0, 1]] * len(vectors))
    return DislocationNetwork.of_arrays(lines)


def test_three_sources_give_one_stress():
    """Lines, the coframe that they make and its Nye tensor have the same stress."""
    again = stresses(FOUND.frame, STEEL)
    np.testing.assert_allclose(again.stress, FOUND.stress, rtol=0, atol=1e-12 * FOUND.largest)
    nye = stresses(NyeField(FOUND.nye, BOX), STEEL)
    np.testing.assert_allclose(nye.stress, FOUND.stress, rtol=0, atol=1e-12 * FOUND.largest)
    assert nye.corrections == again.corrections == ()
    assert nye.energy == pytest.approx(FOUND.energy, rel=1e-12)


def test_a_displacement_has_no_stress():
    """A coframe without torsion relaxes to zero stress, however strained it is."""
    axes = [np.arange(12.0)] * 3
    x, y, z = np.meshgrid(*axes, indexing="ij")
    wave = np.cos(np.pi * (x + 2 * y + z) / 6) * np.pi / 600
    beta = np.einsum("i,m,xyz->imxyz", [1.0, 0.5, -2.0], [1.0, 2.0, 1.0], wave)
    frame = SampledFrame.from_distortion(axes, beta, periodic=True, unit="nm")
    found = stresses(frame, STEEL)
    assert found.largest < 1e-12 * STEEL.voigt[0][0]
    assert found.length_unit == "nm"
    assert found.energy_unit == "GPa nm^3"


def test_a_plane_map_repeats_along_z():
    """A map in the plane has the stress of lines along z, with all components of b."""
    net = along_z([[0.1, 0.05, 0.2], [-0.1, -0.05, -0.2]])
    lines = stresses(net, STEEL, shape=32)
    assert lines.cell.shape == (32, 32, 1)
    frame = lines.frame
    assert (frame.dimension, frame.rows) == (2, 3)
    found = stresses(frame, STEEL)
    np.testing.assert_allclose(found.stress, lines.stress, rtol=0, atol=1e-11 * lines.largest)
    # Per unit of thickness; the box is four units thick.
    assert found.energy == pytest.approx(lines.energy / 4, rel=1e-11)


def test_one_node_along_lines_is_as_good_as_many():
    """Lines along z need one node along z; more give the same stress."""
    net = along_z([[0.1, 0.05, 0.2], [-0.1, -0.05, -0.2]])
    one, many = (stresses(net, STEEL, shape=(24, 24, n), core=0.4) for n in (1, 24))
    np.testing.assert_allclose(many.stress[..., 5], one.stress[..., 0], rtol=0, atol=1e-12)
    assert one.energy == pytest.approx(many.energy, rel=1e-12)
    assert one.error == pytest.approx(many.error, rel=1e-2)


def test_the_error_covers_a_coarse_grid():
    """A core of one step is not resolved well: the error holds, and a finer grid removes it."""
    coarse, fine = (stresses(LOOP, STEEL, shape=n, core=0.25) for n in (16, 32))
    difference = np.abs(fine.stress[..., ::2, ::2, ::2] - coarse.stress).max()
    assert difference <= 1.01 * coarse.error < 10 * difference
    assert fine.error < 1e-4 * coarse.error
    assert abs(fine.energy - coarse.energy) <= 1.01 * coarse.energy_error


def test_the_error_of_data_is_in_their_short_waves():
    """Noise on a field is a large error; a smooth field has a small one."""
    smooth = FOUND.nye
    noise = np.random.default_rng(0).normal(size=smooth.shape) * np.abs(smooth).max() / 10
    quiet = stresses(NyeField(smooth, BOX), STEEL)
    noisy = stresses(NyeField(smooth + noise, BOX), STEEL, balance=True)
    assert quiet.error < 0.1 * quiet.largest
    assert noisy.error > 2 * quiet.error
    assert np.abs(noisy.stress - quiet.stress).max() < 4 * noisy.error


def test_a_skew_cell_describes_the_same_crystal():
    """A sheared box with the same periods has the same stress at the same points."""
    points = np.random.default_rng(2).uniform(0, 4, (4, 3))
    skew = Box([[4, 0, 0], [4, 4, 0], [0, 0, 4]])
    net = DislocationNetwork.of_arrays(LineArrays(SQUARE, SIDES, [[0.1, 0, 0.2]] * 4, skew))
    found = stresses(net, STEEL, shape=(32, 32, 24), core=0.4)
    wanted = stresses(LOOP, STEEL, shape=24, core=0.4)
    np.testing.assert_allclose(found.at(points), wanted.at(points), rtol=0, atol=1e-8)
    assert found.energy == pytest.approx(wanted.energy, rel=1e-9)


def test_a_shifted_origin_shifts_everything():
    """The origin of the box does not matter."""
    moved = Box([[4, 0, 0], [0, 4, 0], [0, 0, 4]], [10.0, -3.0, 0.5])
    places = np.add(SQUARE, [10.0, -3.0, 0.5])
    net = DislocationNetwork.of_arrays(LineArrays(places, SIDES, [[0.1, 0, 0.2]] * 4, moved))
    found = stresses(net, STEEL, shape=16)
    np.testing.assert_allclose(found.stress, FOUND.stress, atol=1e-12)
    assert found.frame.axes[1][0] == -3.0
    np.testing.assert_allclose(
        found.at(found.cell.points()[:, 3, 4, 5][None])[..., 0], found.stress[..., 3, 4, 5]
    )


def test_decreasing_axes_describe_the_same_crystal():
    """A frame whose first axis decreases has the same stress at the same points."""
    frame = FOUND.frame
    axes = [frame.axes[0][::-1], *frame.axes[1:]]
    found = stresses(SampledFrame(axes, frame.coframe[:, :, ::-1], periodic=True), STEEL)
    np.testing.assert_allclose(found.stress[:, :, ::-1], FOUND.stress, atol=1e-12 * FOUND.largest)
    assert found.frame.axes[0][0] == axes[0][0]


def test_a_box_without_lines_has_only_its_load():
    """Without lines the stress is the load, without error."""
    empty = LineArrays(np.zeros((0, 3)), np.zeros((0, 2), int), np.zeros((0, 3)), BOX)
    net = DislocationNetwork.of_arrays(empty)
    found = stresses(net, STEEL, shape=8, mean_stress=np.eye(3))
    np.testing.assert_allclose(found.stress[:, :, 1, 2, 3], np.eye(3), atol=ROUNDED)
    assert (found.error, found.forces.shape) == (0.0, (0, 3))


def test_a_net_b_is_balanced_and_reported():
    """Lines of one sign are refused; with balance=True they have the stress of a Wigner cell."""
    net = along_z([[0.0, 0.0, 0.2]])
    found = stresses(net, STEEL, shape=48, core=0.2, balance=True)
    (text,) = found.corrections
    assert "mean Nye tensor, at most 0.0125" in text
    # Around a square cell of a screw the shear along the edge averages to zero by symmetry.
    edge = found.at([[2.5, y, 0] for y in np.linspace(-1, 3, 17)[:-1]])
    assert abs(edge[0, 2].mean()) < 1e-10
    assert np.abs(edge[1, 2]).max() < 1e-10
    field = NyeField(found.nye + net.nye[..., None, None, None], BOX)
    again = stresses(field, STEEL, balance=True)
    np.testing.assert_allclose(again.stress, found.stress, atol=1e-10)


def test_padding_approaches_free_surroundings():
    """The stress of a map with open ends settles with the padding: images move away."""
    nodes, b = 24, 0.1
    x, y = np.meshgrid(np.arange(nodes) - 8.0, np.arange(nodes) - 12.0, indexing="ij")
    spread = [np.exp(-((x - a) ** 2 + y**2) / 8) / (8 * np.pi) for a in (0, 8)]
    alpha = np.zeros((3, 3, nodes, nodes, 1))
    alpha[2, 2, :, :, 0] = b * (spread[0] - spread[1])
    open_box = Box.of_bounds([-8, -12, 0], [16, 12, 1], (False, False, True))
    measured = NyeField(alpha, open_box)
    # Two screws with their Gaussian cores, without images.
    r2 = [(x - a) ** 2 + y**2 + 1e-9 for a in (0, 8)]
    one, two = ((1 - np.exp(-r / 8)) / r for r in r2)
    wanted = -80 * b / (2 * np.pi) * (x * one - (x - 8) * two)
    misses = []
    for padding in (24, 72):
        found = stresses(measured.padded(padding), STEEL, balance=True)
        part = found.stress[1, 2, :nodes, :nodes, 0]
        misses.append(np.abs(part - wanted).max() / np.abs(wanted).max())
    assert misses[1] < 0.25 * misses[0] < 0.05
    assert "Perfect crystal of 72 nodes" in found.corrections[0]


def test_an_open_map_goes_through_its_nye_tensor():
    """A coframe with open ends is refused; its padded Nye tensor gives the stress inside."""
    whole = stresses(along_z([[0.1, 0, 0], [-0.1, 0, 0]]), STEEL, shape=64, core=0.3)
    frame = whole.frame
    part = SampledFrame(frame.axes, frame.coframe, order=8)
    with pytest.raises(GridError, match="NyeField.of_frame"):
        stresses(part, STEEL)
    field = NyeField.of_frame(part)
    np.testing.assert_allclose(
        field.values[0, 2], whole.nye[0, 2], atol=2e-3 * abs(whole.nye).max()
    )
    again = stresses(field.padded(32), STEEL, balance=True)
    assert again.cell.shape == (96, 96, 1)


def test_a_turned_crystal_keeps_its_stress():
    """The same lattice described in turned axes has the same stress in the sample."""
    turn = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
    frame = FOUND.frame
    turned = SampledFrame(frame.axes, np.tensordot(turn, frame.coframe, 1), periodic=True)
    found = stresses(turned, STEEL)
    np.testing.assert_allclose(found.stress, FOUND.stress, atol=1e-12 * FOUND.largest)
    np.testing.assert_allclose(found.frame.coframe, turned.coframe, atol=1e-12)


def test_lines_that_end_in_a_field_are_reported():
    """A Nye field with divergence loses this part, and the result states its share."""
    alpha = np.zeros((3, 3, 8, 8, 8))
    alpha[0, 0, 2, 4, 4], alpha[0, 0, 6, 4, 4] = 1, -1
    found = stresses(NyeField(alpha, BOX), STEEL)
    assert "Lines that end" in found.corrections[0]
    again = stresses(NyeField(found.nye, BOX), STEEL)
    assert again.corrections == ()
    np.testing.assert_allclose(again.stress, found.stress, atol=1e-12 * found.largest)


def test_a_nye_field_is_saved_and_read(tmp_path):
    """An .npz file keeps values, cell, periods and unit."""
    box = Box([[4, 0, 0], [1, 4, 0], [0, 0, 4]], [1, 2, 3], (True, False, True))
    field = NyeField(np.random.default_rng(0).normal(size=(3, 3, 2, 3, 4)), box, "um")
    field.save(tmp_path / "nye.npz")
    again = NyeField.read(tmp_path / "nye.npz")
    np.testing.assert_array_equal(again.values, field.values)
    for name in ("vectors", "origin", "periodic"):
        np.testing.assert_array_equal(getattr(again.box, name), getattr(box, name))
    assert again.unit == "um"
    np.savez(tmp_path / "bad.npz", nye=field.values[:2], vectors=np.eye(3))
    with pytest.raises(FileFormatError, match=r"bad\.npz"):
        NyeField.read(tmp_path / "bad.npz")


def test_constants_of_each_symmetry():
    """Each maker gives the tensor of its symmetry, and the inverse gives the strain back."""
    c = ElasticConstants.hexagonal(165, 31.1, 50, 61.8, 39.6).tensor
    assert c[0, 1, 0, 1] == pytest.approx((165 - 31.1) / 2)
    assert (c[0, 0, 2, 2], c[2, 2, 2, 2], c[1, 2, 1, 2]) == (50, 61.8, 39.6)
    rng = np.random.default_rng(3)
    m = rng.normal(size=(6, 6))
    triclinic = ElasticConstants(m @ m.T + np.eye(6))
    assert ElasticConstants.of_voigt(np.asarray(triclinic.voigt)[np.triu_indices(6)]) == triclinic
    strain = rng.normal(size=(3, 3))
    strain += strain.T
    np.testing.assert_allclose(triclinic.strain(triclinic.stress(strain)), strain, atol=1e-12)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turned = triclinic.rotated(turn).stress(turn @ strain @ turn.T)
    np.testing.assert_allclose(turned, turn @ triclinic.stress(strain) @ turn.T, atol=1e-10)
    assert ElasticConstants.of_text("cubic 168.4 121.4 75.4 GPa").unit == "GPa"
    assert ElasticConstants.of_text("isotropic 80 0.3 GPa") == STEEL


OPEN = Box.of_bounds([0, 0, 0], [4, 4, 4], (True, True, False))
CROSSED = np.ones((3, 3, 4, 4, 1))
HOLED = SampledFrame([np.arange(8.0)] * 2, np.zeros((3, 2, 8, 8)), periodic=True,
                     mask=np.eye(8, dtype=bool))  # fmt: skip
FLAT = SampledFrame([np.arange(8.0)] * 2, np.zeros((2, 2, 8, 8)), periodic=True)
ENDED = LineArrays([[1, 1, 1], [2, 1, 1]], [[0, 1]], [[1, 0, 0]], BOX, constraints=[6, 6])
PLANAR = DislocationNetwork.of_arrays(LineArrays(SQUARE, SIDES, [[1.0, 0]] * 4, BOX))
TEXT: Any = "chains.data"
NO_BOX = DislocationNetwork.of_arrays(LineArrays(SQUARE, SIDES, [[1.0, 0, 0]] * 4))


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: stresses(NO_BOX, STEEL), NetworkError, "got no box"),
        (lambda: stresses(along_z([[1, 0, 0], [-1, 0, 0]], Box.of_bounds([0] * 3, [4] * 3, (
            False, True, True))), STEEL), NetworkError, "got open edges"),
        (lambda: stresses(DislocationNetwork.of_arrays(ENDED), STEEL), NetworkError, "end"),
        (lambda: stresses(along_z([[1, 0, 0]]), STEEL), NetworkError, "balance=True"),
        (lambda: stresses(PLANAR, STEEL), NetworkError, "three components, got 2"),
        (lambda: stresses(LOOP, STEEL, core=0.1, shape=16), NetworkError, "at least one step"),
        (lambda: stresses(LOOP, STEEL, shape=(16, 16, 1)), NetworkError, r"shape\[2\]"),
        (lambda: stresses(LOOP, STEEL, shape=(16, 16)), NetworkError, "three numbers or one"),
        (lambda: stresses(LOOP, STEEL, shape=2), NetworkError, "shape"),
        (lambda: stresses(LOOP, STEEL, shape=10**4), LimitError, "Give fewer nodes"),
        (lambda: stresses(LOOP, STEEL, core=-1), GridError, "core: expected a length"),
        (lambda: stresses(LOOP, STEEL, gauge=-1), GridError, "gauge: expected a length"),
        (lambda: stresses(LOOP, STEEL, gauge=float("nan")), GridError, "gauge"),
        (lambda: stresses(LOOP, STEEL, mean_stress=np.triu(np.ones((3, 3)))), GridError,
         "symmetric"),
        (lambda: stresses(LOOP, STEEL, convention="left"), UnknownNameError, "convention"),
        (lambda: stresses(LOOP, TEXT), ArgumentError, "ElasticConstants"),
        (lambda: stresses(TEXT, STEEL), ArgumentError, "DislocationNetwork"),
        (lambda: stresses(FOUND.frame, STEEL, shape=16), GridError, "expected none"),
        (lambda: stresses(HOLED, STEEL), GridError, "8 unknown nodes"),
        (lambda: stresses(FLAT, STEEL), GridError, "positive determinant"),
        (lambda: stresses(NyeField(np.ones((3, 3, 4, 4, 4)), BOX), STEEL), GridError, "balanced"),
        (lambda: stresses(NyeField(np.zeros((3, 3, 4, 4, 4)), OPEN), STEEL), GridError, "padded"),
        (lambda: NyeField(np.zeros((3, 3, 4, 4, 4)), BOX).padded(4), GridError, "periodic one"),
        (lambda: NyeField(CROSSED, BOX), GridError, "lines along z"),
        (lambda: NyeField(np.full((3, 3, 4, 4, 4), np.nan), BOX), GridError, "not finite"),
        (lambda: NyeField(np.zeros((3, 3, 0, 4, 4)), BOX), GridError, "expected nodes"),
        (lambda: stresses(FOUND.frame, STEEL).forces, NetworkError, "SampledFrame"),
        (lambda: FOUND.at([[0, 0, np.inf]]), GridError, "not finite"),
        (lambda: FOUND.save("stress.txt"), GridError, ".vtk, .nc"),
        (lambda: ElasticConstants.isotropic(1, 0.5), ElasticityError, "below 1/2"),
        (lambda: ElasticConstants.isotropic(-1, 0.3), ElasticityError, "positive"),
        (lambda: ElasticConstants.cubic(1, 2, 1), ElasticityError, "stable crystal"),
        (lambda: ElasticConstants.of_voigt(np.ones(20)), ElasticityError, "21 numbers"),
        (lambda: ElasticConstants(np.triu(np.ones((6, 6)))), ElasticityError, "symmetric"),
        (lambda: ElasticConstants.of_text("cubic 1 2"), ElasticityError, "3 numbers"),
        (lambda: ElasticConstants.of_text("cubic 3 1 x 1"), ElasticityError, "3 numbers"),
        (lambda: ElasticConstants.of_text("cubic 3 1 1 7"), ElasticityError, "3 numbers"),
        (lambda: ElasticConstants.of_text(""), ElasticityError, "isotropic, cubic"),
        (lambda: STEEL.rotated(np.ones((3, 3))), ElasticityError, "orthogonal"),
    ],
)  # fmt: skip
def test_refusals(call, error, words):
    """Sources and options without a stress are refused, with a remedy."""
    with pytest.raises(error, match=words):
        call()


def test_equal_calls_give_equal_bits():
    """A second run has the same bits."""
    again = stresses(LOOP, STEEL, shape=16)
    assert isinstance(again, Stresses)
    np.testing.assert_array_equal(again.stress, FOUND.stress)
    np.testing.assert_array_equal(again.forces, FOUND.forces)


def test_files_for_paraview_and_xarray(tmp_path: Path):
    """VTK and NetCDF files hold the same stress, position by position."""
    meshio = pytest.importorskip("meshio")
    xarray = pytest.importorskip("xarray")
    uneven = stresses(LOOP, STEEL, shape=(16, 8, 12), core=0.5)
    uneven.save(tmp_path / "stress.vtk")
    mesh = meshio.read(tmp_path / "stress.vtk")
    node = int(np.flatnonzero(np.abs(mesh.points - [1.0, 0.5, 3.0]).max(axis=1) < 1e-9)[0])
    wanted = uneven.at([[1.0, 0.5, 3.0]])[..., 0]
    np.testing.assert_allclose(mesh.point_data["stress"][node].reshape(3, 3), wanted, atol=1e-12)
    assert mesh.point_data["mises"].max() == uneven.mises.max()
    # Neighbours in the grid are neighbours in space.
    (cells,) = mesh.cells
    corners = mesh.points[cells.data]
    np.testing.assert_allclose(np.ptp(corners, axis=1), [uneven.cell.steps] * len(corners))
    wanted = FOUND.at([[1.0, 0.5, 2.25]])[..., 0]
    FOUND.save(tmp_path / "stress.nc")
    with xarray.open_dataset(tmp_path / "stress.nc", engine="h5netcdf") as data:
        value = data["stress"].sel(x=1.0, y=0.5, z=2.25)
        np.testing.assert_allclose(value.sel(i="x", j="z"), wanted[0, 2], atol=1e-12)
        assert data.attrs["energy"] == FOUND.energy
        assert data.attrs["unit"] == "GPa"


def test_a_wafer_has_no_stress_beyond_its_error():
    """The orientation map of a silicon wafer gives a stress that its noise explains."""
    wafer = OrientationMap.read(real("ebsd/si_wafer.ctf"))
    silicon = ElasticConstants.cubic(165.7, 63.9, 79.6, unit="GPa")
    field = NyeField.of_frame(wafer.frame(0)).padded(48)
    found = stresses(field, silicon, balance=True)
    assert 0.1 < found.largest < 3 * found.error
    assert found.energy_unit == "GPa um^3"


def test_a_simulated_network():
    """A network of a simulation of copper: balanced, resolved, and pushed across its lines."""
    net = DislocationNetwork.read(real("networks/180chains_16.10e.data"))
    copper = ElasticConstants.cubic(168.4, 121.4, 75.4, unit="GPa")
    with pytest.raises(NetworkError, match="balance=True"):
        stresses(net, copper, shape=16)
    found = stresses(net, copper, shape=16, balance=True, convention="Hirth-Lothe")
    assert "is spread over the cell" in found.corrections[0]
    assert found.forces.shape == net.arrays.steps.shape
    along = np.abs((found.forces * net.arrays.steps).sum(axis=1))
    assert along.max() < 1e-12 * np.abs(found.forces).max() * net.arrays.lengths.max()
    # Without the balancing b the mean of the torsion would equal the network's.
    np.testing.assert_allclose(found.nye.mean(axis=(2, 3, 4)), 0, atol=1e-12 * abs(found.nye).max())
