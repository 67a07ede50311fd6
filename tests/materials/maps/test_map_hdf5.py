"""Orientation maps in HDF5: files of seven programs, unknown ones, and several maps in one file."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geomtorsion.errors import FileFormatError, LimitError, MissingExtraError, OrientationError
from geomtorsion.materials.maps import OrientationMap
from geomtorsion.materials.readers import open_source
from tests.materials.maps.synthetic import bent
from tests.materials.maps.test_map_files import ang, write
from tests.materials.maps.test_map_points import h5oina

h5py = pytest.importorskip("h5py")

# Six rows of seven points, 0.5 um apart.
ROW, COLUMN = np.divmod(np.arange(42), 7)
DEGREES = np.stack([10.0 + COLUMN, 20.0 + 0.1 * ROW, 30.0 - ROW], axis=1)
EULER = np.radians(DEGREES)
X, Y = 0.5 * COLUMN, 0.5 * ROW
CELL = (3.57, 3.57, 3.57, 90.0, 90.0, 90.0)
Tree = dict[str, Any]


def put(path: Path, tree: Tree) -> Path:
    """Write data sets by their paths; a path with @ is an attribute."""
    with h5py.File(path, "w") as file:
        for name, value in tree.items():
            group, at, key = name.partition("@")
            if at:
                file.require_group(group or "/").attrs[key] = value
            else:
                file[name] = np.bytes_(value) if isinstance(value, str) else value
    return path


def named(prefix: str, names: str, *values: object) -> Tree:
    return {f"{prefix}/{name}": x for name, x in zip(names.split(","), values, strict=True)}


def edax(scan: str = "Scan 1", euler: np.ndarray = EULER, grid: str = "SqrGrid") -> Tree:
    data, header = f"{scan}/EBSD/Data", f"{scan}/EBSD/Header"
    sides = ("a", "b", "c", "alpha", "beta", "gamma")
    return {
        "Manufacturer": "EDAX",
        **named(data, "Phi1,Phi,Phi2,X Position,Y Position,CI,Phase", *euler.T, X, Y,
                np.where(ROW + COLUMN, 0.9, -1.0), np.zeros(42, int)),
        **named(header, "nRows,nColumns,Step X,Step Y,Grid Type", [6], [7], [0.5], [0.5], grid),
        f"{header}/Phase/1/MaterialName": "Nickel",
        f"{header}/Phase/1/Symmetry": [43],
        # Files of the trade hold texts where other readers expect whole numbers.
        f"{header}/Phase/1/atom data": "Ni,0,0,0,1.0,0.0035",
        **{f"{header}/Phase/1/Lattice Constant {side}": [CELL[k]] for k, side in enumerate(sides)},
    }  # fmt: skip


def bruker() -> Tree:
    order = np.random.default_rng(0).permutation(42)
    data, header = "a/EBSD/Data", "a/EBSD/Header"
    return {
        "Manufacturer": "Bruker Nano",
        **named(data, "phi1,PHI,phi2,X SAMPLE,Y SAMPLE,Phase", *DEGREES[order].T, X[order],
                Y[order], np.ones(42, int)),
        **named(header, "NROWS,NCOLS,XSTEP,YSTEP", 6, 7, 0.5, 0.5),
        **named(f"{header}/Phases/1", "Name,IT,LatticeConstants", "Nickel", 225, CELL),
    }  # fmt: skip


def orix() -> Tree:
    data, header = "crystal_map/data", "crystal_map/header"
    return {
        "manufacturer": "orix",
        **named(data, "phi1,Phi,phi2,x,y,z,phase_id,is_in_data", *EULER.T, 500 * X, 500 * Y, 0,
                np.zeros(42, int), np.ones(42, bool)),
        **named(header, "ny,nx,y_step,x_step,scan_unit", 6, 7, 250.0, 250.0, "nm"),
        **named(f"{header}/phases/0", "name,point_group,structure/lattice/abcABG", "Nickel",
                "m-3m", CELL),
    }  # fmt: skip


def orix_of(length: str = "nm") -> Tree:
    """Positions in the unit of the header."""
    tree, data = orix(), "crystal_map/data"
    factor = {"nm": 1e3, "um": 1.0}[length]
    steps = dict.fromkeys(("crystal_map/header/y_step", "crystal_map/header/x_step"), 0.5 * factor)
    places = {f"{data}/x": factor * X, f"{data}/y": factor * Y}
    return {**tree, **places, **steps, "crystal_map/header/scan_unit": length}


def emsoft(refined: bool = True) -> Tree:
    data, header = "Scan 1/EBSD/Data", "Scan 1/EBSD/Header"
    angles: Tree = {
        f"{data}/DictionaryEulerAngles": DEGREES[::-1],
        f"{data}/TopMatchIndices": np.stack([42 - np.arange(42), 1 + np.arange(42)], axis=1),
    }
    if refined:
        angles[f"{data}/RefinedEulerAngles"] = EULER
    # The positions along y are wrong in these files.
    return {
        **angles,
        **named(data, "X Position,Y Position,Phase", X, 0 * Y, np.ones(42, int)),
        **named(header, "nRows,nColumns,Step X,Step Y", [6], [7], [0.5], [0.5]),
        **named(f"{header}/Phase/1", "MaterialName,Point Group", "Nickel", "Cubic (Oh) [m3m]"),
    }


def dream3d(planes: int = 1, *, is_new: bool = False) -> Tree:
    root = "DataContainers/ImageDataContainer"
    euler = np.concatenate([EULER + 0.01 * k for k in range(planes)])
    ensembles = f"{root}/CellEnsembleData"
    size, step = np.array([7, 6, planes]), np.array([0.5, 0.5, 2.0])
    geometry = (
        {f"{root}@_DIMENSIONS": size, f"{root}@_SPACING": step}
        if is_new
        else named(f"{root}/_SIMPL_GEOMETRY", "DIMENSIONS,SPACING", size, step)
    )
    return {
        f"{root}/CellData/EulerAngles": euler.reshape(planes, 6, 7, 3),
        f"{root}/CellData/Phases": np.ones((planes, 6, 7, 1), int),
        f"{root}/CellFeatureData/AvgEulerAngles": np.zeros((3, 3)),
        **named(ensembles, "CrystalStructures,LatticeConstants", [[999], [1]],
                np.array([[0.0] * 6, CELL], "f4")),
        f"{ensembles}/PhaseName": np.array([b"Unknown", b"Nickel"]),
        **geometry,
    }  # fmt: skip


FILES: dict[str, Callable[[], Tree]] = {
    "edax.oh5": edax,
    "edax.h5": lambda: edax("Area 3"),
    "bruker.h5": bruker,
    "orix.h5": orix_of,
    "orix.hdf5": lambda: orix_of("um"),
    "emsoft.h5": emsoft,
    "dictionary.h5": lambda: emsoft(refined=False),
    "old.dream3d": dream3d,
    "new.dream3d": lambda: dream3d(is_new=True),
    "kikuchipy.h5": lambda: {**orix_of("um"), "manufacturer": "kikuchipy"},
}


def turned(path: Path, **options: Any) -> OrientationMap:
    """The map in a file, whose orientations are those above."""
    found = OrientationMap.read(path, sigma=0, **options)
    indexed = found.phase > 0
    expected = OrientationMap.from_euler(DEGREES.reshape(6, 7, 3), 0.5, "m-3m").quaternions
    dots = np.abs((found.quaternions * expected).sum(axis=-1))
    assert dots[indexed] == pytest.approx(np.ones(int(indexed.sum())), abs=1e-6)
    assert found.steps == pytest.approx((0.5, 0.5))
    return found


@pytest.mark.parametrize("name", FILES)
def test_files_of_programs(tmp_path: Path, name: str):
    """Angles, steps in um, phase and its group come from the file."""
    found = turned(put(tmp_path / name, FILES[name]()))
    (phase,) = found.phases.values()
    assert (phase.name, phase.laue) == ("Nickel", "m-3m")
    if "emsoft" not in name and "dictionary" not in name:
        assert phase.lengths == pytest.approx((3.57, 3.57, 3.57))
        assert phase.angles == pytest.approx((90, 90, 90))
    # EDAX marks a point that was not indexed by its confidence.
    assert int((found.phase == 0).sum()) == ("edax" in name)
    assert isinstance(open_source(tmp_path / name), OrientationMap)


def test_hexagonal_grids(tmp_path: Path):
    """Positions decide: every second row is shifted by half a step."""
    tree = edax(grid="HexGrid")
    tree["Scan 1/EBSD/Data/X Position"] = X + 0.25 * (ROW % 2)
    found = OrientationMap.read(put(tmp_path / "a.oh5", tree), sigma=0)
    assert found.shift == 0.5


SYMMETRIES = {
    "m-3": ("IT", 205), "6/mmm": ("IT", 194), "-3m": ("IT", 167), "2/m": ("IT", 14),
    "4/mmm": ("point_group", "-42m"), "mmm": ("point_group", "222"), "-3": ("point_group", "-3"),
    "m-3m": ("Laue Group", 11), "6/m": ("Symmetry", [6]), "4/m": ("Symmetry", "4"),
    "-1": ("space_group", 2),
}  # fmt: skip


@pytest.mark.parametrize("laue", SYMMETRIES)
def test_symmetries(tmp_path: Path, laue: str):
    """Numbers of Laue groups and space groups, point groups, and symmetries of EDAX."""
    key, value = SYMMETRIES[laue]
    tree = bruker()
    del tree["a/EBSD/Header/Phases/1/IT"]
    tree[f"a/EBSD/Header/Phases/1/{key}"] = value
    assert OrientationMap.read(put(tmp_path / "a.h5", tree), sigma=0).phases[1].laue == laue


SYMBOLS = {
    "m-3m": "F m#ovl3m,I m#ovl3m,Fd#ovl3m(*),F #ovl43m,Fm-3m,F d -3 m,P 43 3 2,Ia-3d",
    "6/mmm": "P 6#sub3/mmc,P 6#sub3mc,P 63/m m c,P6_3/mmc,P 65 2 2,P 6 2 2",
    "-3m": "R -3 m H,R 3 c,P 31 2 1", "-3": "R -3", "m-3": "P a -3,P 21 3,P213",
    "4/mmm": "P42/mnm,I 41/a m d,P 41 21 2,I-42d", "4/m": "I 4/m", "mmm": "P n m a,P212121,Cmce",
    "2/m": "P 1 21/c 1,C 2/m,P21/c", "-1": "P-1,P 1",
}  # fmt: skip


@pytest.mark.parametrize("laue", SYMBOLS)
def test_symbols_of_space_groups(tmp_path: Path, laue: str):
    """Bruker writes symbols with marks for bars and screw axes; others write them with blanks."""
    tree = bruker()
    del tree["a/EBSD/Header/Phases/1/IT"]
    for k, symbol in enumerate(SYMBOLS[laue].split(",")):
        path = put(tmp_path / f"{k}.h5", {**tree, "a/EBSD/Header/Phases/1/SpaceGroup": symbol})
        assert OrientationMap.read(path, sigma=0).phases[1].laue == laue, symbol


def test_positions_in_pixels(tmp_path: Path):
    """OIM 8.6 and the beam positions of Bruker count pixels; the header has the step."""
    data = "Scan 1/EBSD/Data"
    turned(
        put(tmp_path / "a.oh5", {**edax(), f"{data}/X Position": COLUMN, f"{data}/Y Position": ROW})
    )
    tree, order = bruker(), np.random.default_rng(0).permutation(42)
    data = "a/EBSD/Data"
    beam = {f"{data}/X BEAM": COLUMN[order], f"{data}/Y BEAM": ROW[order]}
    rest = {key: value for key, value in tree.items() if "SAMPLE" not in key}
    turned(put(tmp_path / "b.h5", {**rest, **beam}))


def test_emsphinx(tmp_path: Path):
    """EMSphInx writes the layout of EDAX under its own name, in the order of the rows."""
    tree = {key: value for key, value in edax().items() if "Position" not in key}
    tree |= {"Manufacturer": "EMSphInx", "Scan 1/EBSD/Data/Phase": np.ones(42, int)}
    found = turned(put(tmp_path / "a.h5", tree))
    assert (found.phases[1].name, found.phases[1].laue) == ("Nickel", "m-3m")


def test_processed_maps_of_oxford(tmp_path: Path):
    """A processed map has its own angles and phases, and the grid of the measured map."""
    path = h5oina(tmp_path / "a.h5oina")
    with h5py.File(path, "a") as file:
        file["1/Data Processing/Data/Euler"] = file["1/EBSD/Data/Euler"][()] + 0.1
        file["1/Data Processing/Data/Phase"] = file["1/EBSD/Data/Phase"][()]
        file.copy("1/EBSD/Header/Phases", "1/Data Processing/Header/Phases")
    with pytest.raises(OrientationError, match="0: 1/Data Processing/Data, 1: 1/EBSD/Data"):
        OrientationMap.read(path, sigma=0)
    processed, measured = (OrientationMap.read(path, sigma=0, slice=k) for k in (0, 1))
    assert processed.steps == measured.steps
    assert processed.phases == measured.phases
    assert np.abs(processed.quaternions - measured.quaternions).max() > 0.01


def unknown() -> Tree:
    """Names that no table has."""
    names = "orientation,columns,lines,material"
    return named("scan/results", names, DEGREES.reshape(6, 7, 3), X, Y, np.ones(42, int))


def test_an_unknown_file_lists_its_data_sets(tmp_path: Path):
    """The message shows names and shapes, and `columns` chooses them."""
    path = put(tmp_path / "a.h5", unknown())
    words = r"got scan/results/columns 42, .*orientation 6x7x3.*columns=\{"
    with pytest.raises(FileFormatError, match=words):
        OrientationMap.read(path)
    columns = {"euler": "results/orientation", "x": "columns", "y": "/scan/results/lines"}
    turned(path, columns=columns, laue={0: "m-3m"})
    small = put(tmp_path / "b.h5", {**unknown(), "scan/results/orientation": EULER})
    with pytest.raises(OrientationError, match="expected the unit of the angles"):
        turned(small, columns=columns, laue={0: "m-3m"})
    columns = {"euler (deg)": "orientation", "x": "columns", "y": "lines", "phase": "material"}
    found = turned(path, columns=columns, laue={0: "m-3m"})
    assert int(found.phase.sum()) == 42
    with pytest.raises(FileFormatError, match="its symmetry is not known"):
        turned(path, columns=columns)


def test_usual_names_in_an_unknown_file(tmp_path: Path):
    """Without a program, the unit is an attribute, or degrees for more than two turns."""
    names = "euler1,euler2,euler3,xpos,ypos"
    tree = named("map", names, *EULER.T, X, Y)
    with h5py.File(put(tmp_path / "a.h5", tree), "a") as file:
        file["map/euler1"].attrs["units"] = "rad"
    turned(tmp_path / "a.h5", laue={0: "m-3m"})
    turned(put(tmp_path / "b.h5", named("map", names, *DEGREES.T, X, Y)), laue={0: "m-3m"},
           columns={"phi1 (deg)": "euler1"})  # fmt: skip
    turned(put(tmp_path / "c.h5", named("map", names, *(DEGREES + np.array([360, 0, 0])).T, X, Y)),
           laue={0: "m-3m"})  # fmt: skip


def test_several_maps_in_one_file(tmp_path: Path):
    """The message lists them; a number or a name chooses one."""
    tree = {**edax("Scan 1"), **edax("Scan 2", EULER + 0.02)}
    path = put(tmp_path / "a.oh5", tree)
    words = r"0: Scan 1/EBSD/Data, 1: Scan 2/EBSD/Data\), got 2 maps in a.oh5.*slice=0"
    with pytest.raises(OrientationError, match=words):
        OrientationMap.read(path)
    turned(path, slice=0)
    turned(path, slice="Scan 1/EBSD/Data")
    assert isinstance(open_source(path, slice=1), OrientationMap)
    for odd in (2, -1, True, "Scan 3"):
        with pytest.raises(OrientationError, match="slice: expected the number or the name"):
            OrientationMap.read(path, slice=odd)


@pytest.mark.parametrize("is_new", [False, True])
def test_planes_of_a_volume(tmp_path: Path, is_new: bool):
    """Each plane of a volume of DREAM.3D is a map."""
    path = put(tmp_path / "a.dream3d", dream3d(3, is_new=is_new))
    with pytest.raises(OrientationError, match="plane 0, .*got 3 maps"):
        OrientationMap.read(path)
    turned(path, slice=0)
    with pytest.raises(AssertionError):
        turned(path, slice=1)


def test_planes_by_z(tmp_path: Path):
    """orix stores z of each point."""
    tree = {}
    for name, value in orix_of("um").items():
        is_array = isinstance(value, np.ndarray) and value.size == 42
        tree[name] = np.concatenate([value, value]) if is_array else value
    tree["crystal_map/data/z"] = np.repeat([0.0, 2.0], 42)
    path = put(tmp_path / "a.h5", tree)
    with pytest.raises(OrientationError, match="0: crystal_map/data z=0, 1: .* z=2"):
        OrientationMap.read(path)
    turned(path, slice=1)


def test_slices_belong_to_hdf5(tmp_path: Path):
    """Other files hold one map."""
    path = write(tmp_path, ang(bent((12, 14), 0.1)), "a.ang")
    with pytest.raises(OrientationError, match="slice: expected an HDF5 file"):
        OrientationMap.read(path, slice=0)


def changed(name: str, value: object) -> Tree:
    return {**edax(), name: value}


HEAD, DATA = "Scan 1/EBSD/Header/", "Scan 1/EBSD/Data/"
REFUSED: list[tuple[Tree, str]] = [
    (changed(HEAD + "nRows", [60]), "expected angles and phase of 7 x 60 points"),
    (changed(HEAD + "nRows", [2**30]), "expected angles and phase of 7 x 1073741824"),
    (changed(DATA + "Phi1", DEGREES[:, 0]), "expected Euler angles of at most two turns"),
    (changed(DATA + "Phi1", EULER[:20, 0]), "expected the data sets of an orientation map"),
    (changed(DATA + "Phase", np.full(42, 3)), r"expected a phase in the header \(1 .* got 3"),
    (changed(HEAD + "Phase/1/Symmetry", [7]), "its symmetry is not known"),
    ({**orix_of(), "crystal_map/header/scan_unit": "px"}, "expected steps in angstrom or nm"),
    ({"numbers": np.arange(5)}, "expected data sets phi1, Phi, phi2 or Euler .*got numbers 5"),
    ({}, "got no data sets"),
]


@pytest.mark.parametrize("number", range(len(REFUSED)))
def test_refusals(tmp_path: Path, number: int):
    """Wrong counts, units and phases are refused with the expected value."""
    tree, words = REFUSED[number]
    path = put(tmp_path / "a.h5", tree)
    with pytest.raises(FileFormatError, match=words):
        OrientationMap.read(path)


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ({"euler": "nothing"}, "expected the path of one data set .*'nothing', which is not in it"),
        ({"euler": "EBSD"}, "is not in it"),
        ({"x": "X Position"}, "expected euler, or phi1, Phi and phi2, got x"),
        ({"u": "X Position"}, "columns: expected a quantity"),
    ],
)
def test_refused_columns(tmp_path: Path, columns: dict[str, int | str], words: str):
    """The message lists the data sets."""
    path = put(tmp_path / "a.h5", edax())
    with pytest.raises(OrientationError, match=words):
        OrientationMap.read(path, columns=columns)


def test_a_declared_size_is_checked_first(tmp_path: Path):
    """A map that would not fit in memory is refused before it is read."""
    path = put(tmp_path / "a.h5", edax())
    with h5py.File(path, "a") as file:
        for name in ("Phi1", "Phi", "Phi2"):
            del file[DATA + name]
            file.create_dataset(DATA + name, shape=(10**10,), dtype="f4", chunks=(10**5,))
    with pytest.raises(LimitError, match=r"a\.h5.*would take|expected at most"):
        OrientationMap.read(path)


def test_without_h5py(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The message names the extra and the other formats."""
    path = h5oina(tmp_path / "a.h5oina")
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(MissingExtraError, match=r"geomtorsion\[files\].*\.ctf or \.ang"):
        OrientationMap.read(path)


@pytest.mark.filterwarnings("ignore")
def test_a_file_that_orix_wrote(tmp_path: Path):
    """An .ang file read by orix, written as HDF5 and read back agrees with our own reader."""
    io = pytest.importorskip("orix.io")
    path = write(tmp_path, ang(bent((12, 14), 0.1)), "a.ang")
    io.save(str(tmp_path / "a.h5"), io.load(str(path)))
    ours, theirs = (OrientationMap.read(tmp_path / name, sigma=0) for name in ("a.ang", "a.h5"))
    assert theirs.steps == pytest.approx(ours.steps)
    (phase,) = theirs.phases.values()
    assert (phase.laue, phase.lengths) == ("m-3m", (3.52, 3.52, 3.52))
    squares = ours.burgers_map(5), theirs.burgers_map(5)
    assert squares[0].arrows == pytest.approx(squares[1].arrows, abs=1e-7)
