"""The command `map`: text and files for grids, orientation maps and images, and refusals."""

import csv
import json
from typing import Any

import numpy as np
import pytest

from geomtorsion.materials.fields import SampledFrame
from tests.cli import running
from tests.materials.images.atoms import crystal
from tests.materials.maps.synthetic import noisy_wall
from tests.materials.maps.test_map_files import ctf, write
from tests.materials.test_readers import grid
from tests.real import real


def run(*arguments: str, code: int = 0) -> Any:
    """Result of `geomtorsion map`, which must end with the given code."""
    return running.run("map", *arguments, code=code)


@pytest.fixture
def wall(tmp_path):
    """A tilt wall of 2 degrees with noise of 0.1, as a .ctf file with steps of 0.5 um."""
    return write(tmp_path, ctf(noisy_wall(2.0, (24, 30), 0.1, 3)), "wall.ctf")


def test_a_grid_as_table_arrays_and_picture(tmp_path):
    """Torsion 1 everywhere: |b| per area is 1 in each of the files."""
    said = run(str(grid(tmp_path, sigma=1e-3, unit="nm")), "--size", "2", "-o", str(tmp_path / "o"))
    assert "largest 1 1/nm" in said.stdout
    assert "99 circuits of 2 x 2 cells" in said.stdout
    out = tmp_path / "o"
    lines = (out / "map.csv").read_text().splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    assert len(rows) == 99
    assert [float(row["b_per_area"]) for row in rows] == pytest.approx([1.0] * 99)
    assert (rows[1]["x_centre"], rows[1]["y_centre"]) == ("0.5", "1.0")
    with np.load(out / "map.npz") as arrays:
        assert arrays["density"] == pytest.approx(1.0)
        assert arrays["significance"].min() > 100
        assert str(arrays["unit"]) == "nm"
    found = json.loads((out / "map.json").read_text())
    assert found["largest"] == pytest.approx(1.0)
    assert found["significant"] == found["known"] == 99
    assert (out / "map.png").read_bytes().startswith(b"\x89PNG")


def test_an_orientation_map(wall, tmp_path):
    """The wall is above the noise: b per area is 2 sin(1 degree) / side."""
    said = run(str(wall), "--size", "8", "-o", str(tmp_path / "o"), "--picture-format", "svg")
    assert "1 grain at 5 degrees" in said.stdout
    found = json.loads((tmp_path / "o/map.json").read_text())
    assert found["largest"] == pytest.approx(2 * np.sin(np.radians(1)) / 4, rel=0.2)
    assert abs(found["place"][0] - 7.25) <= 2
    assert 0 < found["significant"] < found["known"]
    assert (tmp_path / "o/map.svg").stat().st_size > 1000


def test_grains_are_not_crossed(wall):
    """With a threshold below the wall, circuits that cross it are counted as missing."""
    said = run(str(wall), "--size", "4", "--threshold", "1.5")
    assert "more cross a boundary" in said.stdout
    assert "no circuit of this size fits" in run(
        str(wall), "--size", "20", "--threshold", "1.5"
    ).stdout  # fmt: skip


def test_without_matplotlib(tmp_path, no_pictures):
    """The table is written, and the message names the missing extra."""
    said = run(str(grid(tmp_path)), "-o", str(tmp_path / "o"), "--size", "2")
    assert (tmp_path / "o/map.csv").is_file()
    assert "pip install 'geomtorsion[plots]'" in said.stderr


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--size", "80"), "--size: expected a whole number from 1 to 23"),
        (("--size", "0"), "--size"),
        (("--sigma", "much"), "--sigma: expected a number of 0 or more, or estimate"),
        (("--sigma", "-1"), "--sigma: expected standard deviations of 0 or more, got -1"),
        (("--threshold", "nan"), "--threshold: expected a positive number"),
        (("--order", "4"), "--order: expected a file of sampled frames"),
        (("--plane", "x,z"), "--plane: expected two of the axes x, y"),
        (("--plane", "y,x"), "--plane: expected x and y, the only plane of an orientation map"),
    ],
)
def test_wrong_options_are_named(wall, options, words):
    """Each message names the option as typed."""
    assert words in run(str(wall), *options, code=2).stderr


def test_damaged_files_name_their_line(tmp_path):
    """A truncated file is named, a bad value is reported with its line, missing ones fail."""
    path = write(tmp_path, ctf()[:-3], "cut.ctf")
    assert "cut.ctf" in run(str(path), code=2).stderr
    lines = ctf()
    lines[20] = lines[20].replace("\t", " x", 1)
    assert "line 21" in run(str(write(tmp_path, lines, "bad.ctf")), code=2).stderr
    assert "cannot be read" in run(str(tmp_path / "none.ang"), code=2).stderr
    assert "no such file" in run(str(tmp_path / "none.npz"), code=2).stderr


def test_the_steel(tmp_path):
    """144 grains at 3 degrees, and the number of circuits within them."""
    said = run(
        str(real("ebsd/sdss_ferrite_austenite.ang")), "--size", "4", "--threshold", "3"
    ).stdout
    assert "144 grains at 3 degrees" in said
    assert "3,286 circuits of 4 x 4 cells" in said


@pytest.fixture
def scan(tmp_path):
    """A bent crystal beside a grain that is rotated by 30 degrees."""
    angles = np.zeros((20, 30, 3))
    angles[..., 0] = 0.2 * np.arange(30)
    angles[:, 20:, 0] += 30
    return str(write(tmp_path, ctf(angles), "scan.ctf"))


def test_data_of_a_bent_crystal(scan):
    """The median density equals the bend; the known squares are those within one grain."""
    found = json.loads(run(scan, "--size", "4", "--sigma", "0.01", "--json").stdout)
    assert found["median"] == pytest.approx(np.radians(0.2) / 0.5, rel=1e-5)
    assert found["known"] == 16 * (16 + 6)


def test_slip_systems(scan):
    """The densities of a family sum to at least |b| per area over |b| of one line."""
    arguments = (scan, "--sigma", "0.01", "--circle", "4,4:2", "--slip", "fcc")
    (one,) = json.loads(run(*arguments, "--json").stdout)["circles"]
    (family,) = one["slip"]
    assert family["family"] == "{1, 1, 1} <0.5, -0.5, 0>"
    least = one["magnitude"] / one["area"] / (3.52e-4 * np.sqrt(0.5))
    assert least <= family["edge"] + family["screw"] < 4 * least
    assert "slip {1, 1, 1} <0.5, -0.5, 0>: edges" in run(*arguments).stdout
    assert "expected a known name, got 'bct'" in run(*arguments[:-1], "bct", code=2).stderr


def test_circles(scan, tmp_path):
    """A circle within a grain has a result; one across the boundary fails and names its grain."""
    arguments = (scan, "--sigma", "0.01", "--circle", "4,4:2", "--circle", "10,4:2")
    found = json.loads(run(*arguments, "--json", "-o", str(tmp_path / "o"), code=1).stdout)
    good, bad = found["circles"]
    assert good["magnitude"] / good["area"] == pytest.approx(np.radians(0.4), rel=1e-4)
    assert "is in grain 0" in bad["failed"]
    assert (tmp_path / "o/circuits.png").stat().st_size > 5000
    shown = run(*arguments, code=1).stdout
    assert "in specimen axes" in shown
    assert "failed: expected a circuit within one grain, got one that crosses" in shown


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--circle", "4,4"), "--circle 4,4: expected CENTRE:RADIUS"),
        (("--workers", "2"), "--workers: expected a map in blocks"),
        (("--circle", "a,b:c"), "--circle a,b:c"),
        (("--threshold", "0"), "threshold: expected a positive number"),
        (("--laue", "cubic"), "--laue: expected PHASE=GROUP, got 'cubic'"),
        (("--laue", "1=cubic"), "expected a known name, got 'cubic'"),
    ],
)
def test_more_wrong_options(scan, arguments, message):
    """Each wrong option ends with code 2 and its message."""
    assert message in " ".join(run(scan, *arguments, code=2).stderr.split())


@pytest.fixture
def lattice(tmp_path):
    """Atoms 0.4 nm apart around an edge dislocation, as a TIFF file."""
    tifffile = pytest.importorskip("tifffile")
    path = tmp_path / "lattice.tif"
    tifffile.imwrite(path, crystal(256, "square", turned=0.0).noisy(0.5, 1).astype("float32"))
    return str(path)


def test_an_image(lattice, tmp_path):
    """b around the core is a whole lattice vector, in text and JSON; the figure is written."""
    options = ("--pixel", "0.05nm", "--size", "40", "--circle", "6.4,6.4:3")
    said = run(lattice, *options, "-o", str(tmp_path / "o")).stdout
    assert "b = (-1, 0) lattice vectors; the probability that noise changed it" in said
    assert "lattice vectors (0.40" in said
    found = json.loads((tmp_path / "o/map.json").read_text())
    assert found["largest"] == pytest.approx(0.4 / 4, rel=0.01)
    assert found["circles"][0]["whole"] == [-1, 0]
    assert (tmp_path / "o/circuits.png").stat().st_size > 5000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--pixel", "nm"), "--pixel: expected a positive size with its unit, got 'nm'"),
        (("--pixel", "0nm"), "--pixel: expected a positive size with its unit, got '0nm'"),
        (("--spots", "1,a"), "--spots: expected two spots in cycles per unit, got '1,a'"),
        (("--spots", "0.1,0"), "--spots: "),
        (("--resolution", "-1"), "--resolution: expected a positive number"),
        (("--sigma", "1"), "--sigma: expected a file of sampled frames"),
        (("--threshold", "1"), "--threshold: expected a file of orientation maps"),
        (("--size", "1"), "--size: expected a whole number from 2"),
        (("--plane", "y,x"), r"--plane: expected (0, 1), the only plane of an image, got (1, 0)"),
    ],
)
def test_wrong_options_of_images(lattice, arguments, message):
    """Each message names the option as typed."""
    assert message in " ".join(run(lattice, *arguments, code=2).stderr.split())


def masked(lines: list[str]) -> list[str]:
    """Lines of a .ctf file in which no pixel is indexed."""
    head = next(k for k, line in enumerate(lines) if line.startswith("Phase\t"))
    rest = ["0" + line[line.index("\t") :] for line in lines[head + 1 :]]
    return [*lines[: head + 1], *rest]


@pytest.mark.parametrize("command", ["map", "circuit"])
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("masked.ctf", "masked.ctf: expected pixels with an orientation, got phase 0"),
        ("mixed.ctf", "Steps are mixed"),
        ("phase.ctf", "or 0 for a pixel without an orientation, got 7"),
        ("nan.npz", "nan.npz: coframe: expected values at some nodes, got none"),
        ("shape.npz", "expected shape (rows, 2, 9, 8)"),
        ("nan.npy", "nan.npy: image[0, 0] = nan is not finite"),
        ("noise.npy", "no visible lattice"),
        ("flat.npy", "the image has no lattice"),
    ],
)
def test_bad_files_through_the_commands(tmp_path, command, name, words):
    """Each message describes the defect; both commands end with 2."""
    lines, path = ctf(), tmp_path / name
    first = next(k for k, line in enumerate(lines) if line.startswith("Phase\t")) + 5
    x, y = np.arange(9.0), np.arange(8.0)
    fields = lines[first].split("\t")
    if name == "masked.ctf":
        write(tmp_path, masked(lines), name)
    elif name == "mixed.ctf":
        lines[first] = "\t".join([fields[0], "0.37", *fields[2:]])
        write(tmp_path, lines, name)
    elif name == "phase.ctf":
        lines[first] = "\t".join(["7", *fields[1:]])
        write(tmp_path, lines, name)
    elif name == "nan.npz":
        np.savez(path, coframe=np.full((2, 2, 9, 8), np.nan), axis_x=x, axis_y=y)
    elif name == "shape.npz":
        np.savez(path, coframe=np.zeros((2, 2, 9, 7)), axis_x=x, axis_y=y)
    else:
        noise = np.random.default_rng(0).normal(size=(128, 128))
        np.save(path, {"nan.npy": noise * np.nan, "flat.npy": 0 * noise}.get(name, noise))
    options = () if command == "map" else ("--loop", "circle 3,3:1")
    error = " ".join(running.run(command, str(path), *options, code=2).stderr.split())
    assert words in error


@pytest.mark.parametrize(
    ("loop", "words"),
    [
        ("circle 900,900:2", ("leaves",)),
        ("circle 3,3:300", ("leaves",)),
        (
            "circle 3,3,1:2",
            ("two coordinates", "expected 2 coordinates, one for each axis of the grid, got 3"),
        ),
    ],
)
def test_loops_outside_through_the_commands(scan, lattice, tmp_path, loop, words):
    """A loop outside the data or with an extra coordinate is refused for each kind of file."""
    for file in (scan, lattice, str(grid(tmp_path))):
        told = running.run("circuit", file, "--loop", loop, code=2).stderr
        assert any(word in told for word in words), told


def test_circuits_around_missing_nodes_are_counted_and_described(tmp_path):
    """The text names the circuits with detours, and how far a single circuit goes around."""
    line = np.linspace(0, 1, 41)
    x, y = np.meshgrid(line, line, indexing="ij")
    mask = np.zeros(x.shape, dtype=bool)
    mask[20, 10] = True
    SampledFrame([line, line], np.array([[-y, x]]) / 2, mask=mask).save(tmp_path / "a.npz")
    circle = "--circle=0.5,0.5:0.25"
    done = run(str(tmp_path / "a.npz"), "--size", "6", "--sigma", "0.001", circle)
    text = " ".join(done.stdout.split())
    assert "24 of them around missing nodes" in text
    assert "the circuit goes around 1 missing node, up to 0.0354 away" in text


COLUMNS = "x=0,y=b,exx (%)=2,exy=3,eyy=4,theta=turn"


def strains(folder, head="a,b,c,d,e,turn"):
    """A table of strain with names that no reader knows: exx = 0.01 y, in percent."""
    rows = [f"{i},{j},{1.0 * j},0,0,0" for i in range(9) for j in range(9)]
    (folder / "strain.txt").write_text("\n".join([*head.splitlines(), *rows]))
    return str(folder / "strain.txt")


def test_columns_of_a_table(tmp_path):
    """The torsion is d_y exx = 0.01 everywhere, with and without a row of names."""
    for head, columns in (("a,b,c,d,e,turn", COLUMNS), ("", COLUMNS.replace("turn", "5"))):
        path = strains(tmp_path, head)
        columns = columns if head else columns.replace("y=b", "y=1")
        run(path, "--columns", columns, "--size", "2", "-o", str(tmp_path / "o"))
        found = json.loads((tmp_path / "o/map.json").read_text())
        assert found["largest"] == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ("x", "--columns: expected QUANTITY=COLUMN"),
        ("x=0,x=1", "each quantity once"),
        ("x=0,y=1", "--columns: expected columns of a displacement"),
        ("x=0,y=1,u=2,v=nothing", "--columns: expected a column 'nothing'"),
        ("q=1", "--columns: expected a quantity"),
    ],
)
def test_refused_columns(tmp_path, columns, words):
    """The option is named as typed."""
    said = run(strains(tmp_path), "--columns", columns, "-o", str(tmp_path / "o"), code=2)
    assert words in " ".join(said.stderr.split())
