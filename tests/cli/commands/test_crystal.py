"""The command `crystal`: tables, files for other programs, resumed trajectories, bad input."""

import json
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geomtorsion.materials.crystals import trajectories
from geomtorsion.materials.lines import DislocationNetwork
from tests.cli import running
from tests.materials.crystals.making import BOX, copper_screw, written
from tests.materials.crystals.polycrystals import bicrystal, turned
from tests.materials.crystals.synthetic import block
from tests.real import real

pytest.importorskip("ase")
AXES = ("--lattice", "fcc", "--orient", "1,0,0;0,1,0;0,0,1", "--constant", "3.6")


def run(*arguments: str, code: int = 0) -> Any:
    """Result of `geomtorsion crystal`, which must end with the given code."""
    return running.run("crystal", *arguments, code=code)


def test_help_has_examples() -> None:
    """The help shows an example."""
    assert "geomtorsion crystal cu_edge.xyz -o out" in run("--help").stdout


def test_a_screw_in_given_axes(tmp_path: Path) -> None:
    """Exact b in both units, length and ends; a right-handed screw has b against its sense."""
    file = written(tmp_path, copper_screw())
    done = run(str(file), *AXES, "-o", str(tmp_path / "out"))
    assert re.search(r"0 +\(0, 0, -?1\) +\(0, 0, -?3\.6\) +<1 0 0> +14\.4 +periodic", done.stdout)
    assert "fcc, a = 3.6;" in done.stdout
    saved = json.loads((tmp_path / "out" / "crystal.json").read_text("utf-8"))
    (frame,) = saved["frames"]
    (line,) = frame["lines"]
    sense = np.sign(line["path"][-1][2] - line["path"][0][2])
    assert sense * np.array(line["burgers"]) == pytest.approx([0, 0, -3.6], abs=1e-9)
    assert frame["orient"] == np.eye(3).tolist()
    assert line["track"] == 0
    assert not (tmp_path / "out" / "frames").exists()


def test_signs_of_other_conventions(tmp_path: Path) -> None:
    """SF/RH and OVITO give b, FS/RH gives -b; an unknown convention is refused."""
    file = written(tmp_path, copper_screw())
    found = {}
    for name in ("SF/RH", "FS/RH", "OVITO"):
        text = run(str(file), *AXES, "--convention", name, "--format", "json").stdout
        ((line,),) = (frame["lines"] for frame in json.loads(text)["frames"])
        found[name] = [Fraction(x) for x in line["burgers_lattice"]]
    assert found["SF/RH"] == found["OVITO"] == [-x for x in found["FS/RH"]]
    assert "convention" in run(str(file), "--convention", "mine", code=2).stderr


def test_files_for_others(tmp_path: Path) -> None:
    """Line files that OVITO, ParaView and ParaDiS read, a figure, and a page without links."""
    file, out = written(tmp_path, copper_screw()), tmp_path / "out"
    run(str(file), *AXES, "-o", str(out))
    for end in (".ca", ".data"):
        (line,) = DislocationNetwork.read(out / f"lines{end}").polylines
        assert line.ends == "periodic"
        assert line.length == pytest.approx(14.4, rel=1e-3)
        assert np.abs([float(x) for x in line.burgers]) == pytest.approx([0, 0, 3.6], abs=1e-9)
    assert "1/2<110> (Perfect)" in (out / "lines.ca").read_text()
    assert "CELL_TYPES" in (out / "lines.vtk").read_text()
    assert (out / "crystal.png").stat().st_size > 10_000
    page = (out / "crystal.html").read_text("utf-8")
    assert "<canvas" in page
    # The name of the SVG language is not a link.
    assert "http" not in page.replace("http://www.w3.org/2000/svg", "")


def test_grains_are_clusters_for_others(tmp_path: Path) -> None:
    """A line in the second cluster: b in the file is in the axes of its cluster, and reading the
    file returns b in space; the wall is a transition with the misorientation of the table."""
    places, _, size = bicrystal("fcc", turned(40, (0, 0, 1)), (0.5, 0.5, 0), size=(11, 8, 2))
    file, out = written(tmp_path, 3.6 * (places + size / 2)), tmp_path / "out"
    run(str(file), "-o", str(out))
    (frame,) = json.loads((out / "crystal.json").read_text())["frames"]
    (line,), rows = frame["lines"], (out / "lines.ca").read_text().splitlines()
    first = rows.index("DISLOCATIONS 1")
    assert rows.count("CLUSTER_STRUCTURE 1") == len(frame["grains"]) == 2
    assert int(rows[first + 3]) == 1 + line["grain"]
    exact = [float(Fraction(x)) for x in line["burgers_lattice"]]
    assert np.array(rows[first + 2].split(), float) == pytest.approx(exact, abs=1e-12)
    assert [f"CLUSTER_SIZE {grain['atoms']}" in rows for grain in frame["grains"]] == [True, True]
    between = np.array(rows[rows.index("TRANSITION 0 1") + 1].split(), float).reshape(3, 3)
    scale = np.linalg.det(between) ** (1 / 3)
    # The rotation angle is smallest for the closest pair of variants.
    angle = np.degrees(np.arccos((np.trace(between / scale) - 1) / 2))
    assert angle == pytest.approx(frame["walls"][0]["degrees"], abs=1e-6)
    (back,) = DislocationNetwork.read(out / "lines.ca").polylines
    assert np.array(back.burgers) == pytest.approx(line["burgers"], abs=1e-12)
    assert back.length == pytest.approx(line["length"], rel=1e-12)


def test_families_of_hcp_for_others(tmp_path: Path) -> None:
    """c and a screws at c/a = 1.58 are written in OVITO's units (neighbours 1/sqrt(2) apart,
    ideal c/a); the families are named, and reading the file returns b in space."""
    for b, local in (((0, 0, 1.58), (0, 0, (4 / 3) ** 0.5)), ((1.0, 0, 0), (0.5**0.5, 0, 0))):
        sites, cell = block("hcp", (12, 7, 8))
        way = int(np.argmax(b))
        places = sites * [1, 1, 1.58 / (8 / 3) ** 0.5]
        cell = cell * [1, 1, 1.58 / (8 / 3) ** 0.5]
        one, other = (k for k in range(3) if k != way)
        centre = cell / 2 + [0.131, 0.077, 0.113]
        angle = np.arctan2(*(places - centre)[:, [other, one]].T)
        places[:, way] += np.max(b) * angle / (2 * np.pi)
        file, out = tmp_path / f"{way}.xyz", tmp_path / str(way)
        rows = [f"Mg {x!r} {y!r} {z!r}" for x, y, z in places.tolist()]
        edges = " ".join(map(str, np.diag(cell).ravel().tolist()))
        periodic = " ".join("FT"[k == way] for k in range(3))
        head = f'Lattice="{edges}" Properties=species:S:1:pos:R:3 pbc="{periodic}"'
        file.write_text("\n".join([str(len(rows)), head, *rows]) + "\n")
        run(str(file), "--lattice", "hcp", "-o", str(out))
        text = (out / "lines.ca").read_text()
        for name in ("1/3<1-210>", "<0001>", "<1-100>", "1/3<1-100>", "1/3<1-213>"):
            assert f"\n{name}\n" in text
        rows = text.splitlines()
        kept = np.array(rows[rows.index("DISLOCATIONS 1") + 2].split(), dtype=float)
        assert np.linalg.norm(kept) == pytest.approx(np.linalg.norm(local), abs=1e-9)
        assert abs(kept[2]) == pytest.approx(local[2], abs=1e-9)
        (line,) = DislocationNetwork.read(out / "lines.ca").polylines
        found = [float(x) for x in line.burgers]
        assert np.abs(found) == pytest.approx(b, abs=0.02)


def test_a_stopped_trajectory_resumes_to_the_same_bits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Tracks keep their numbers; after Ctrl-C in frame 3, --resume writes the same bytes."""
    frames = [copper_screw(shift, 0.04, seed) for seed, shift in enumerate((0, 1.5, 3, 4))]
    file = written(tmp_path, *frames)
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    done = run(str(file), "-o", str(whole))
    assert "4 frames, in the axes of the first" in done.stdout
    rows = (whole / "tracks.csv").read_text().splitlines()
    assert len({tuple(row.split(",")[1:6]) for row in rows[1:]}) == 1
    made = trajectories.crystal_report
    calls = []

    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    def stopping(*arguments: Any) -> Any:
        calls.append(1)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return made(*arguments)

    monkeypatch.setattr(trajectories, "crystal_report", stopping)
    stopped = run(str(file), "-o", str(parts), code=130)
    assert "2 frames are in" in stopped.stderr
    monkeypatch.setattr(trajectories, "crystal_report", made)
    assert "--resume" in run(str(file), "-o", str(parts), code=2).stderr
    assert "other settings" in run(str(file), *AXES, "-o", str(parts), "--resume", code=2).stderr
    with monkeypatch.context() as patch:
        # Ctrl-C while the results are written.
        patch.setattr("geomtorsion.cli.commands.crystal._save", interrupted)
        late = run(str(file), "-o", str(parts), "--resume", code=130)
        assert "4 frames are in" in late.stderr
    run(str(file), "-o", str(parts), "--resume")
    names = sorted(path.name for path in whole.iterdir())
    assert sorted(path.name for path in parts.iterdir()) == names
    for name in names:
        assert (parts / name).read_bytes() == (whole / name).read_bytes(), name
    assert "expected a stopped trajectory, got none" in run(
        str(file), "-o", str(parts), "--resume", code=2
    ).stderr  # fmt: skip


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--orient", "1,0,0;0,1,0"), "Write three numbers"),
        (("--orient", "1,0,0;1,1,0;0,0,1"), "Give orthogonal directions"),
        (("--orient", "1,0,0;0,1,0;0,0,-1"), "right-handed"),
        (("--orient", "__import__('os')"), "got other text"),
        (("--lattice", "quasi"), "fcc"),
        (("--constant", "-1"), "positive"),
        (("--read-as", "traj"), "form: expected one of"),
        (("--resume",), "expected a directory, got none"),
        (("--cell", "80,80,14.4"), "its own cell"),
        (("--periodic", "z"), "its own cell"),
    ],
)
def test_wrong_options_are_refused(tmp_path: Path, options: tuple[str, ...], message: str) -> None:
    """Each wrong option ends the command with code 2 and a message."""
    file = written(tmp_path, copper_screw()[:200])
    assert message in " ".join(run(str(file), *options, code=2).stderr.split())


def test_anything_but_a_crystal_is_refused(tmp_path: Path) -> None:
    """A gas, NaN, three atoms, a truncated file and a missing file are refused."""
    rng = np.random.default_rng(0)
    good = copper_screw()
    # No two atoms are closer than 3.2; the cell has 14.4 along z.
    gas = 7.2 * np.argwhere(np.ones((16, 16, 2)))
    cases = {
        "of only": gas + rng.uniform(-2, 2, gas.shape),
        "is not finite": np.vstack([good, [[np.nan] * 3]]),
        "20 or more atoms": good[:3],
    }
    for message, places in cases.items():
        found = run(str(written(tmp_path, places)), code=2)
        assert message in " ".join(found.stderr.split())
        assert "atoms.xyz" in found.stderr
    cut = written(tmp_path, good)
    cut.write_text(cut.read_text()[: -len(good)])
    assert "the file ends after" in run(str(cut), code=2).stderr
    assert "cannot be read" in run(str(tmp_path / "none.xyz"), code=2).stderr


@pytest.mark.parametrize(("name", "lines"), [("w_tilt_gb", 4), ("cu_perfect", 0)])
def test_shared_files(name: str, lines: int) -> None:
    """The perfect crystal has no line, the tilt boundary has four."""
    found = json.loads(run(str(real(f"crystal/{name}.xyz")), "--format", "json").stdout)
    assert [len(frame["lines"]) for frame in found["frames"]] == [lines]
    text = run(str(real("crystal/cu_perfect.xyz"))).stdout
    assert "no dislocation line" in text


ARRAY = ("--cell", "80,80,14.4", "--periodic", "z")


def test_arrays_give_what_the_file_gives(tmp_path: Path) -> None:
    """Arrays with a cell from options or from the file give the same bytes as the XYZ file."""
    places = copper_screw()
    np.save(tmp_path / "atoms.npy", places)
    np.savez(tmp_path / "atoms.npz", positions=places, cell=BOX, periodic=[False, False, True])
    file = written(tmp_path, places)
    whole = run(str(file), "-o", str(tmp_path / "xyz")).stdout
    for end, options in (("npy", ARRAY), ("npz", ())):
        text = run(str(tmp_path / f"atoms.{end}"), *options, "-o", str(tmp_path / end)).stdout
        assert text == whole.replace("atoms.xyz", f"atoms.{end}")
        for path in (tmp_path / "xyz").iterdir():
            other = (tmp_path / end / path.name).read_bytes()
            assert other.replace(f"atoms.{end}".encode(), b"atoms.xyz") == path.read_bytes()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "--periodic none"),
        (("--periodic", "z"), "--cell"),
        (("--cell", "80,80"), "three lengths"),
        (("--cell", "a;b;c"), "three lengths"),
        (("--cell", "0,80,80"), "span a volume"),
        ((*ARRAY[:3], "w"), "letters of xyz"),
        ((*ARRAY, "--resume"), "expected a directory, got none"),
    ],
)
def test_wrong_options_of_arrays_are_refused(
    tmp_path: Path, options: tuple[str, ...], message: str
) -> None:
    """A missing or unreadable cell and wrong periodic edges end with code 2 and a message."""
    np.save(tmp_path / "atoms.npy", copper_screw())
    found = run(str(tmp_path / "atoms.npy"), *options, code=2)
    assert message in " ".join(found.stderr.split())


def test_damaged_arrays_are_refused(tmp_path: Path) -> None:
    """Truncated, flat, object, unnamed and missing arrays: each message names the file."""
    np.save(tmp_path / "cut.npy", copper_screw())
    content = (tmp_path / "cut.npy").read_bytes()
    (tmp_path / "cut.npy").write_bytes(content[: len(content) // 2])
    np.save(tmp_path / "flat.npy", copper_screw()[:, 0])
    np.save(tmp_path / "objects.npy", np.array([{}, []], dtype=object), allow_pickle=True)
    np.savez(tmp_path / "other.npz", places=copper_screw())
    for name in ("cut.npy", "flat.npy", "objects.npy", "other.npz", "none.npy", "none.npz"):
        found = run(str(tmp_path / name), "--periodic", "none", code=2)
        assert name in found.stderr
        assert "Traceback" not in found.stderr


def test_grains_and_walls_are_reported(tmp_path: Path) -> None:
    """A bicrystal: grains, misorientation, and the grain of the line, in text and in JSON."""
    turn = np.array([[4, -3, 0], [3, 4, 0], [0, 0, 5]]) / 5
    places, _, size = bicrystal("fcc", turn, (0.5, 0.5, 0), size=(11, 8, 2))
    places = 3.6 * (places + np.array([15, 9, 2]))
    path = tmp_path / "two.xyz"
    head = f'Lattice="200 0 0 0 200 0 0 0 {3.6 * size[2]}" pbc="F F T"'
    rows = [f"Cu {x!r} {y!r} {z!r}" for x, y, z in places.tolist()]
    path.write_text("\n".join([str(len(rows)), head, *rows, ""]), "utf-8")
    text = run(str(path), "-o", str(tmp_path / "out")).stdout
    assert re.search(r"2 grains: fcc 9\d\.\d%, in walls \d\.\d% of the atoms", text)
    assert re.search(r"0 \| 1 +36\.[89]\d degrees +\[", text)
    assert re.search(r"line +grain +b / a", text)
    (frame,) = json.loads((tmp_path / "out/crystal.json").read_text("utf-8"))["frames"]
    assert [grain["lattice"] for grain in frame["grains"]] == ["fcc", "fcc"]
    assert sum(frame["shares"].values()) == pytest.approx(1)
    (wall,), (line,) = frame["walls"], frame["lines"]
    assert wall["grains"] == [0, 1]
    assert wall["degrees"] == pytest.approx(36.87, abs=0.1)
    assert (line["family"], line["kind"]) == ("1/2<1 1 0>", "periodic")
    assert line["grain"] in (0, 1)
