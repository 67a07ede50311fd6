"""Tables with columns of any name: strain, surfaces in space, and columns that a user names."""

from pathlib import Path

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import FileFormatError, GeomtorsionError, GridError
from geomtorsion.materials.readers import open_source

X, Y = np.meshgrid(np.arange(9) * 0.5, np.arange(7) * 0.5, indexing="ij")
EXX, EXY, EYY, WXY = 0.01 * X, 0.002 + 0.001 * Y, -0.003 * Y, 0.01 * X - 0.002 * Y
ONE = np.array([[1 + EXX, EXY + WXY], [EXY - WXY, 1 + EYY]])
NONE: dict[str, int | str] = {}


def table(path: Path, head: str, *columns: np.ndarray, split: str = ",") -> Path:
    """A table with a row of names, or without one."""
    points = np.stack([column.ravel() for column in columns], axis=1)
    rows = [split.join(map(repr, point)) for point in points.tolist()]
    path.write_text("\n".join([*head.splitlines(), *rows]) + "\n", "utf-8")
    return path


STRAINS = {
    "exx": ("x,y,exx,exy,eyy,wxy", (EXX, EXY, EYY, WXY), NONE),
    "theta": ("x,y,e_xx,e_yy,e_xy,theta", (EXX, EYY, EXY, -WXY), NONE),
    "degrees": ("x y exx exy eyy Rotation [deg]", (EXX, EXY, EYY, -np.degrees(WXY)), NONE),
    "letters": ("x;y;εxx;εyy;γxy;ωxy", (EXX, EYY, 2 * EXY, WXY), NONE),
    "numbers": ("X (um),Y (um),e11,e12,e22,w12", (EXX, EXY, EYY, WXY), NONE),
    "percent": (
        "x,y,strain_xx (%),strain_yy (%),strain_xy (%),omega",
        (100 * EXX, 100 * EYY, 100 * EXY, -WXY), NONE,
    ),
    "gradient": ("x,y,du/dx,du/dy,dv/dx,dv/dy", (EXX, EXY + WXY, EXY - WXY, EYY), NONE),
    "preamble": ("Program: GPA\nDate, 2026\nx,y,exx,exy,eyy,wxy", (EXX, EXY, EYY, WXY), NONE),
    "comment": ("# x y exx exy eyy wxy", (EXX, EXY, EYY, WXY), NONE),
    "no names": (
        "", (EXX, EXY, EYY, WXY), {"x": 0, "y": 1, "exx": 2, "exy": 3, "eyy": 4, "wxy": 5},
    ),
    "named": (
        "p,q,normal 1,shear,normal 2,turn", (EXX, EXY, EYY, -np.degrees(WXY)),
        {"x": "p", "y": "Q", "exx": 2, "strain_xy": "shear", "eyy": "normal 2", "theta (deg)": 5},
    ),
    "coframe": ("x;y;e_0_0;e_0_1;e_1_0;e_1_1", tuple(ONE.reshape(4, 9, 7)), NONE),
}  # fmt: skip


@pytest.mark.parametrize("name", STRAINS)
def test_tables_of_strain(tmp_path: Path, name: str):
    """The coframe is 1 + strain + rotation, on the grid and at scattered points."""
    head, columns, named = STRAINS[name]
    split = ";" if ";" in head else " " if "," not in head and head else ","
    path = table(tmp_path / "a.txt", head, X, Y, *columns, split=split)
    frame = gt.SampledFrame.read(path, columns=named or None)
    assert frame.coframe == pytest.approx(ONE)
    assert frame.unit == ("um" if "um" in head else "")
    assert open_source(path, columns=named or None).names == ("x", "y")
    scattered = gt.ScatteredFrame.read(path, columns=named)
    loop = gt.Loop.circle([2, 1.5], 1)
    assert scattered.burgers(loop).vector.shape == (2,)


def test_strain_in_space_of_a_plane_map(tmp_path: Path):
    """A map of the surface may hold all nine components, as in high-resolution EBSD."""
    names = "e11,e12,e13,e22,e23,e33,w12,w13,w23".split(",")
    values = [0.001 * (k + 1) * X for k in range(9)]
    frame = gt.SampledFrame.read(table(tmp_path / "a.csv", f"x,y,{','.join(names)}", X, Y, *values))
    e, at = dict(zip(names, values, strict=False)), (3, 2)
    beta = frame.coframe[(..., *at)] - np.eye(3)
    assert beta[0, 2] == pytest.approx(e["e13"][at] + e["w13"][at])
    assert beta[2, 1] == pytest.approx(e["e23"][at] - e["w23"][at])


HEAD = "a,b,c,d"
REFUSED = [
    ("x,y,exx,eyy", NONE, "expected a column wxy.*A strain needs the rotation"),
    ("x,y,exx,wxy", NONE, "expected a column exy"),
    (HEAD, NONE, "or give their numbers|or name them"),
    ("phi1,Phi,phi2,x", NONE, r"belong to an orientation map: use OrientationMap\.read"),
    (HEAD, {"x": 9, "y": 1, "u": 2}, "x: expected the name of a column in a.csv or a number from"),
    (HEAD, {"x": -1, "y": 1, "u": 2}, "a number from 0 to 3, got -1"),
    (HEAD, {"x": "a", "y": "bb", "u": 2}, "expected a column 'bb'.*got columns a, b, c, d"),
    (HEAD, {"x": "a", "u": 2}, "expected the columns of x and y"),
    (HEAD, {"x": "a", "y": 1}, "expected columns of a displacement"),
    (HEAD, {"quality": 2}, "expected a quantity"),
    (HEAD, {"x": 1.5}, "expected the name of a column or its number from 0, got 1.5"),
    (HEAD, {"x": True}, "got True"),
    (HEAD, [1], "columns: expected names with values"),
]


@pytest.mark.parametrize("case", REFUSED)
def test_refused_columns(tmp_path: Path, case):
    """The message names the columns of the table and how to choose one."""
    head, columns, words = case
    path = table(tmp_path / "a.csv", head, X, Y, EXX, EYY)
    for read in (gt.SampledFrame.read, gt.ScatteredFrame.read):
        with pytest.raises((FileFormatError, GridError), match=words):
            read(path, columns=columns or None)


def test_columns_of_other_files(tmp_path: Path):
    """Arrays have names of their own; a table of orientations is one by its columns of angles."""
    frame = gt.SampledFrame([np.arange(5.0)] * 2, np.zeros((2, 2, 5, 5)))
    frame.save(tmp_path / "a.npz")
    with pytest.raises(GridError, match="columns: expected a table"):
        gt.SampledFrame.read(tmp_path / "a.npz", columns={"x": 0})
    path = table(tmp_path / "m.txt", "", 0 * X, 0 * X, 0 * X, X, Y)
    found = open_source(
        path, columns={"phi1": 0, "Phi": 1, "phi2": 2, "x": 3, "y": 4}, laue={0: "m-3m"}
    )
    assert isinstance(found, gt.OrientationMap)


SLOPES = [(0.0, 0.0), (0.3, 0.0), (1.0, -0.4), (-0.2, 0.7), (0.5, 0.5)]


@pytest.mark.parametrize("slopes", SLOPES)
def test_a_surface_in_space_on_a_grid(tmp_path: Path, slopes: tuple[float, float]):
    """Stereo correlation: e^T e is the metric of the deformed plane; the circuit closes."""
    a, b = slopes
    u = [0.01 * X, 0.002 * Y, 0.003 * X]
    frame = gt.SampledFrame.read(table(tmp_path / "a.csv", "x,y,z,u,v,w", X, Y, a * X + b * Y, *u))
    tangents = np.array([[1.01, 0, a + 0.003], [0, 1.002, b]])
    metric = np.einsum("imxy,inxy->mnxy", frame.coframe, frame.coframe)
    assert metric == pytest.approx(np.einsum("mn,xy->mnxy", tangents @ tangents.T, X**0))
    assert "a surface in space over x and y" in frame.source
    assert frame.burgers(gt.Loop.circle([2, 1.5], 1)).magnitude == pytest.approx(0, abs=1e-9)


DISPLACED = {
    "x,y,u,v": {},
    "X [mm];Y [mm];Ux [mm];Uy [mm]": {},
    "x_pic y_pic u1 u2": {},
    "x position,y position,disp x,disp y": {},
    "COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y": {},
    "x_pic[Pixel];y_pic[Pixel];Horizontal Displacement U[Pixel];Vertical Displacement V[Pixel]": {},
    "a,b,c,d": {"x": 0, "y": "b", "u": 2, "v": 3},
}


@pytest.mark.parametrize("head", DISPLACED)
def test_names_of_displacements(tmp_path: Path, head: str):
    """Names of columns as several programs write them."""
    split = next((mark for mark in ";," if mark in head), " ")
    u, v = 0.01 * X, 0.002 * X * Y
    path = table(tmp_path / "a.txt", head, X, Y, u, v, split=split)
    frame = gt.SampledFrame.read(path, columns=DISPLACED[head])
    assert frame.displacement is not None
    assert frame.displacement.values == pytest.approx(np.array([u, v]))


def test_pixels_and_lengths_in_one_table(tmp_path: Path):
    """VIC writes x, y, u, v in pixels and X, ..., W in lengths: the latter belong together."""
    head = "x,y,u,v,sigma,X,Y,Z,U,V,W"
    z, pixels = 0.3 * X, 50 * X
    u = [0.01 * X, 0.002 * Y, 0.003 * X]
    path = table(tmp_path / "a.csv", head, pixels, 50 * Y, u[0], u[1], X**0, X, Y, z, *u)
    frame = gt.SampledFrame.read(path)
    assert frame.axes[0] == pytest.approx(X[:, 0])
    assert frame.coframe[2, 0] == pytest.approx(0.303 * X**0)


def test_a_curved_surface_has_the_curvature_of_its_metric(tmp_path: Path):
    """Points on a sphere of radius 5 without displacement: the scalar curvature is 2 / 25."""
    x, y = np.meshgrid(np.linspace(-1, 1, 21), np.linspace(-1, 1, 21), indexing="ij")
    z = np.sqrt(25 - x**2 - y**2)
    path = table(tmp_path / "a.csv", "x,y,z,u,v,w", x, y, z, 0 * x, 0 * x, 0 * x)
    frame = gt.SampledFrame.read(path)
    metric = np.einsum("imxy,inxy->mnxy", frame.coframe, frame.coframe)
    found = gt.SampledFrame.from_metric(frame.axes, metric).quantity("scalar_curvature")
    assert abs(found.values[10, 10] - 2 / 25) < found.error[10, 10]


VIEWS = {"x": (2, 0, 1), "y": (0, 2, 1), "z": (0, 1, 2)}


@pytest.mark.parametrize("normal", VIEWS)
def test_a_surface_in_space_with_a_dislocation(tmp_path: Path, normal: str):
    """The reader of scattered points takes the points that the reader of grids refuses.

    A screw of a crystal on a curved surface, seen along any axis, with failed points of VIC, which
    all have position zero and sigma -1.
    """
    p, q = np.random.default_rng(0).uniform(-3, 3, (2, 500))
    turn = 0.25 * np.arctan2(q, p) / (2 * np.pi)
    place, u = np.array([p, q, np.sqrt(25 - p**2)]), np.array([0 * p, 0 * p, turn])
    order = [*VIEWS[normal]]
    place, u = place[order], u[order]
    sigma = np.full(500, 0.02)
    failed = np.hypot(p - 2, q - 2) < 0.2
    place[:, failed], sigma[failed] = 0.0, -1.0
    head = "X [mm],Y [mm],Z [mm],U [mm],V [mm],W [mm],sigma"
    path = table(tmp_path / "a.csv", head, *place, *u, sigma)
    with pytest.raises(FileFormatError, match=r"use ScatteredFrame\.read"):
        gt.SampledFrame.read(path)
    frame = gt.ScatteredFrame.read(path, branch=[[0, 0, 0.25]])
    assert "a surface in space" in frame.source
    b = frame.burgers(gt.Loop.circle([0, 0], 2))
    assert np.abs(b.vector) == pytest.approx([0, 0, 0.25], abs=1e-9)
    assert b.unit == "mm"


def test_points_in_a_volume_are_not_a_surface(tmp_path: Path):
    """Tracked particles and full grids in space remain in space."""
    points = np.random.default_rng(1).uniform(-3, 3, (3, 300))
    path = table(tmp_path / "a.csv", "x,y,z,u,v,w", *points, *(0.01 * points))
    assert gt.ScatteredFrame.read(path).mesh.dimension == 3
    nodes = np.array(np.meshgrid(*[np.arange(6.0)] * 3)).reshape(3, -1)
    path = table(tmp_path / "b.csv", "x,y,z,u,v,w", *nodes, *(0.01 * nodes))
    assert gt.SampledFrame.read(path).dimension == 3


def test_a_height_needs_a_displacement_in_space():
    """The refusal names both shapes."""
    with pytest.raises(GridError, match=r"height: expected shape \(9, 7\) and .* 3 components"):
        gt.SampledFrame.from_displacement(
            [X[:, 0], Y[0]], np.zeros((2, 9, 7)), height=np.zeros((9, 7))
        )


MAPS = {
    "mtex.txt": "% phi1 Phi phi2 x y",
    "aztec.csv": "Euler1,Euler2,Euler3,X,Y",
    "spaces.csv": "Euler 1,Euler 2,Euler 3,X Position,Y Position",
    "quoted.txt": '"phi1 (deg)";"Phi (deg)";"phi2 (deg)";"x (um)";"y (um)"',
    "none.ang": "",
    "others.txt": "first second third across down",
}


@pytest.mark.parametrize("name", MAPS)
def test_tables_of_orientations(tmp_path: Path, name: str):
    """Angles in degrees, in columns of five spellings, and by number or name of the column."""
    head = MAPS[name]
    split = next((mark for mark in ",;" if mark in head), " ")
    euler = 10.0 + X, 20.0 + 0 * X, 30.0 + Y
    path = table(tmp_path / name, head, *euler, X, Y, split=split)
    columns: dict[str, int | str] = {}
    if name in ("others.txt", "none.ang"):
        words = head.split() or range(5)
        columns = dict(zip(("phi1", "Phi", "phi2", "x", "y"), words, strict=True))
    found = gt.OrientationMap.read(path, laue={0: "m-3m"}, columns=columns)
    expected = gt.OrientationMap.from_euler(np.stack([e.T for e in euler], -1), 0.5, "m-3m")
    assert found.quaternions == pytest.approx(expected.quaternions)
    if name == "none.ang":
        columns = {f"{key} (rad)" if "hi" in key else key: k for key, k in columns.items()}
        with pytest.raises(GeomtorsionError, match="at most two turns in radians"):
            gt.OrientationMap.read(path, laue={0: "m-3m"}, columns=columns)


def test_refused_columns_of_orientations(tmp_path: Path):
    """A table of a field names its reader; missing quantities are listed."""
    path = table(tmp_path / "a.txt", "x,y,u,v", X, Y, EXX, EYY)
    with pytest.raises(FileFormatError, match=r"use SampledFrame\.read or ScatteredFrame\.read"):
        gt.OrientationMap.read(path, laue={0: "m-3m"})
    with pytest.raises(GeomtorsionError, match="got no Phi, phi2"):
        gt.OrientationMap.read(path, laue={0: "m-3m"}, columns={"phi1": 0})
    with pytest.raises(GeomtorsionError, match="columns: expected a quantity"):
        gt.OrientationMap.read(path, laue={0: "m-3m"}, columns={"u": 0})
