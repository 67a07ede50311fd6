"""Displacements of other programs: tables of DICe and VIC, and meshes of finite elements."""

from pathlib import Path

import numpy as np
import pytest

from geomtorsion.errors import FileFormatError, MissingExtraError
from geomtorsion.loops import Loop
from geomtorsion.materials.fields import SampledFrame, ScatteredFrame
from geomtorsion.materials.readers import open_source

B = 0.25
AXIS = np.arange(20.0, 420.0, 20.0)
X, Y = np.meshgrid(AXIS, AXIS, indexing="ij")
# A screw and edge part with the core between the nodes, and the jump along a line.
ANGLE = np.arctan2(Y - 211, X - 209) / (2 * np.pi)
U = np.stack([B * ANGLE, 0.001 * X])
DICE = (
    "SUBSET_ID,COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,SIGMA,GAMMA,BETA,"
    "STATUS_FLAG,UNCERTAINTY,VSG_STRAIN_XX,VSG_STRAIN_YY,VSG_STRAIN_XY"
)


def dice(path: Path, failed: np.ndarray, comments: str = "") -> Path:
    """A result of DICe, in which failed subsets have sigma -1 and displacement 0."""
    lines = [DICE]
    for k, (x, y, u, v, bad) in enumerate(
        zip(X.ravel(), Y.ravel(), *U.reshape(2, -1), failed.ravel(), strict=True)
    ):
        numbers = [x, y, 0.0, 0.0, -1.0, 0.0] if bad else [x, y, u, v, 5e-3, 2e-2]
        numbers += [0.0, 11.0 if bad else 4.0, 7e-3, 0.0, 0.0, 0.0]
        lines.append(f"{k}," + ",".join(f"{number:.9E}" for number in numbers))
    path.write_text(comments + "\n".join(lines) + "\n")
    return path


def test_a_table_of_dice(tmp_path: Path):
    """Column names of DICe are read; a negative sigma is a hole; b is the jump around the core."""
    failed = np.zeros(X.shape, dtype=bool)
    failed[3, 4] = failed[15, 15] = True
    comments = "***\n*** Digital Image Correlation Engine (DICe)\n*** Units: pixels\n***\n"
    for name, head in (("DICe_solution_0.txt", ""), ("a.csv", comments)):
        frame = SampledFrame.read(dice(tmp_path / name, failed, head))
        assert frame.mask[failed].all()
        assert frame.displacement is not None
        assert np.nanmax(np.abs(frame.displacement.values - np.where(failed, np.nan, U))) < 1e-8
        grid = SampledFrame.from_displacement(
            [AXIS, AXIS], frame.displacement.values, mask=failed, branch=[[B, 0]]
        )
        # The circle passes the node of a failed subset.
        b = grid.burgers(Loop.circle([210, 210], 144))
        assert b.vector == pytest.approx([B, 0], abs=1e-6)
        assert grid.burgers_map(4).known.mean() > 0.8


def test_a_table_of_vic_with_blanks_in_its_rows(tmp_path: Path):
    """Quoted names after blanks, a sigma of -1 for failed points."""
    lines = ['"x", "y", "u", "v", "sigma"']
    for x, y, u, v in zip(X.ravel(), Y.ravel(), *U.reshape(2, -1), strict=True):
        lines.append(f"{x}, {y}, {u}, {v}, {-1 if (x, y) == (40, 60) else 0.01}")
    path = tmp_path / "vic.csv"
    path.write_text("\n".join(lines))
    mask = SampledFrame.read(path).mask
    assert mask[1, 2]
    assert mask.sum() < 12


def mesh(path: Path, name: str, values: np.ndarray, points: np.ndarray) -> Path:
    """A mesh of triangles with point data, written by meshio."""
    meshio = pytest.importorskip("meshio")
    cells = [("triangle", np.array([[0, 1, 2]]))]
    meshio.write(path, meshio.Mesh(points, cells, point_data={name: values}))
    return path


@pytest.mark.parametrize("name", ["displacement", "Displacement", "U", "u", "DISP"])
@pytest.mark.parametrize("end", [".vtu", ".vtk"])
def test_a_mesh_of_finite_elements_on_a_grid(tmp_path: Path, name: str, end: str):
    """A vector at the nodes is a displacement; a component normal to the mesh is omitted."""
    points = np.stack([X.ravel(), Y.ravel(), 0 * X.ravel()], axis=1)
    values = np.stack([*U.reshape(2, -1), 0 * X.ravel()], axis=1)
    frame = SampledFrame.read(mesh(tmp_path / f"a{end}", name, values, points))
    assert frame.displacement is not None
    assert frame.displacement.values == pytest.approx(U)
    assert open_source(tmp_path / f"a{end}").names == ("x", "y")


def test_a_mesh_with_scattered_nodes(tmp_path: Path):
    """Nodes of any mesh are points of a scattered frame, which counts the jumps."""
    rng = np.random.default_rng(1)
    x, y = rng.uniform(-3, 3, (2, 500))
    u = np.stack([B * np.arctan2(y, x) / (2 * np.pi), 0 * x, 0.1 + 0 * x], axis=1)
    path = mesh(tmp_path / "a.vtu", "u", u, np.stack([x, y, 0 * x], axis=1))
    frame = ScatteredFrame.read(path, branch=[[B, 0, 0]], unit="mm")
    b = frame.burgers(Loop.circle([0, 0], 2))
    assert b.vector == pytest.approx([B, 0, 0], abs=1e-9)
    assert b.unit == "mm"
    with pytest.raises(FileFormatError, match="use ScatteredFrame"):
        SampledFrame.read(path)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.txt", "x y t\n1 2 3\n", "row of names such as x, y, u, v"),
        ("a.txt", f"{DICE}\n", "nodes below the header, got none"),
        ("a.npz", "", "ending in .csv"),
        ("b.csv", None, "no such file"),
    ],
)
def test_refused_displacements(tmp_path: Path, name: str, content: str | None, words: str):
    """Files without a displacement are refused with the expected names."""
    if content is not None:
        (tmp_path / name).write_text(content)
    with pytest.raises(FileFormatError, match=words):
        ScatteredFrame.read(tmp_path / name)


def test_a_mesh_without_a_displacement_is_refused(tmp_path: Path):
    """The message names the fields of the mesh."""
    points = np.random.default_rng(0).uniform(size=(20, 3))
    path = mesh(tmp_path / "a.vtu", "temperature", points[:, 0], points)
    try:
        with pytest.raises(FileFormatError, match=r"displacement, u or U .* got temperature"):
            ScatteredFrame.read(path)
    except MissingExtraError:
        pytest.skip("meshio is not installed")
