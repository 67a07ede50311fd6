"""Networks in time: files of a folder, densities, and junctions that form and dissolve."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import FileFormatError, GeomtorsionError, NetworkError
from geomtorsion.materials.lines import DislocationNetwork, DislocationSeries
from tests.cli import running
from tests.real import real

B = [[1, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]]


def crossed(shift: float = 0.0, *, joined: bool, scale: float = 1.0) -> DislocationNetwork:
    """Two lines that cross, in a box of side 10; or with a common segment of length 2."""
    ends = np.array([[1, 2, 5], [1, 8, 5], [9, 8, 5], [9, 2, 5], [4, 5, 5], [6, 5, 5]], float)
    sides = [[0, 4], [1, 4], [4, 5], [5, 2], [5, 3]]
    if not joined:
        # Each line passes its own node in the middle.
        ends[4:] = [5, 5, 5]
        sides = [[0, 4], [4, 2], [1, 5], [5, 3]]
    box = gt.Box.of_bounds([0, 0, 0], [10, 10, 10])
    b = scale * np.array(B if joined else [B[0], B[0], B[1], B[1]])
    places = ends + np.array([0, shift, 0])
    return DislocationNetwork.of_arrays(gt.LineArrays(places, sides, b, box))


def lengths() -> tuple[float, float]:
    """Lengths of the lines without and with the segment, by Pythagoras."""
    return 2 * np.hypot(8, 6), 4 * np.hypot(3, 3) + 2


def test_density_and_junctions():
    """Closed forms: length over volume, and the two junctions of a common segment."""
    steps = [crossed(0.1 * k, joined=k in (1, 2)) for k in range(4)]
    series = DislocationSeries([0, 10, 20, 30], steps)
    apart, joined = lengths()
    assert series.density == pytest.approx(np.array([apart, joined, joined, apart]) / 1000)
    assert series.junctions.tolist() == [0, 2, 2, 0]
    assert [len(one.lines) for one in series] == [4, 5, 5, 4]
    assert len(series) == 4
    assert series[0] is steps[0]
    families = series.densities()
    assert sum(families.values()) == pytest.approx(series.density)
    assert families["1 <1 1 0>"] == pytest.approx([0, 0.002, 0.002, 0])
    kinds = [(one.times, one.has_formed) for one in series.changes]
    assert kinds == [((0, 10), True)] * 2 + [((20, 30), False)] * 2
    places = sorted(one.position for one in series.changes[:2])
    assert np.array(places) == pytest.approx(np.array([[4, 5.1, 5], [6, 5.1, 5]]))
    ((reaction, (formed, dissolved)),) = series.reactions().items()
    assert reaction == "(-1, 0, 0) + (0, -1, 0) + (1, 1, 0) = 0"
    assert (formed.tolist(), dissolved.tolist()) == ([2, 0, 0], [0, 0, 2])
    assert "10 to" not in str(series.changes[0])
    assert str(series.changes[0]).endswith("= 0 forms")


def test_the_trivial_cases():
    """One network, a network with itself, and lines through the boundary of the box."""
    one = crossed(joined=True)
    assert DislocationSeries([5], [one]).changes == ()
    assert DislocationSeries([5], [one]).reactions() == {}
    assert DislocationSeries([0, 1], [one, one]).changes == ()
    moved = DislocationSeries([0, 1], [one, crossed(10.0, joined=True)])
    assert moved.changes == ()
    empty = DislocationNetwork.of_lines([])
    none = DislocationSeries([0, 1], [empty, empty])
    assert none.density.tolist() == [0, 0]
    assert none.changes == ()


def test_far_junctions_are_other_junctions():
    """A junction farther than half of the mean distance of lines has dissolved and formed."""
    series = DislocationSeries([0, 1], [crossed(joined=True), crossed(5.0, joined=True)])
    reach = 0.5 / np.sqrt(lengths()[1] / 1000)
    assert reach < 5
    assert sorted(one.has_formed for one in series.changes) == [False, False, True, True]
    near = DislocationSeries([0, 1], [crossed(joined=True), crossed(0.9 * reach, joined=True)])
    assert near.changes == ()


NAMES: list[tuple[list[str], list[float]]] = [
    (["config.00000.data", "config.00100.data", "config.01000.data"], [0, 100, 1000]),
    (["rs9.data", "rs10.data", "rs100.data"], [9, 10, 100]),
    (["t2_step5.ca", "t2_step50.ca", "t2_step500.ca"], [5, 50, 500]),
    (["1.json", "2.json", "3.json"], [1, 2, 3]),
    (["a.data", "b.data", "c.data"], [0, 1, 2]),
    (["run1_1.data", "run1_2.data", "run2_1.data"], [0, 1, 2]),
]


@pytest.mark.parametrize("number", range(len(NAMES)))
def test_files_of_a_folder(tmp_path: Path, number: int):
    """Files in the order of their numbers, with the number that differs as time."""
    names, times = NAMES[number]
    (tmp_path / "notes.txt").write_text("none")
    for k, name in enumerate(names):
        crossed(0.1 * k, joined=k == 1).save(tmp_path / name)
    sources: list[Any] = [
        tmp_path, str(tmp_path / f"*{Path(names[0]).suffix}"), [tmp_path / name for name in names]
    ]  # fmt: skip
    for source in sources:
        series = DislocationSeries.read(source)
        assert np.asarray(series.times).tolist() == times
        assert series.junctions.tolist() == [0, 2, 0]
    other = DislocationSeries.read(tmp_path, times=[0.5, 1.5, 4])
    assert np.asarray(other.times).tolist() == [0.5, 1.5, 4]
    assert repr(other) == "DislocationSeries(3 networks, times 0.5 to 4)"


def test_refusals(tmp_path: Path):
    """The message names the expected files or times."""
    with pytest.raises(FileFormatError, match="expected files of networks .*got none"):
        DislocationSeries.read(tmp_path)
    with pytest.raises(FileFormatError, match="expected files of networks"):
        DislocationSeries.read([])
    (tmp_path / "a.data").write_text("nothing")
    with pytest.raises(FileFormatError, match=r"a\.data"):
        DislocationSeries.read(tmp_path)
    one = crossed(joined=False)
    for times, networks in (([], []), ([0], [one, one]), ([1, 1], [one, one]), ([2, 1], [one] * 2)):
        with pytest.raises(NetworkError, match="times: expected .* increasing times"):
            DislocationSeries(times, networks)
    wrong: Any = ["b"]
    with pytest.raises(GeomtorsionError, match=r"networks\[0\]: expected a DislocationNetwork"):
        DislocationSeries([0], wrong)


def test_the_command(tmp_path: Path):
    """A folder gives a table in time, JSON and a figure."""
    folder = tmp_path / "run"
    folder.mkdir()
    for k in range(3):
        crossed(0.1 * k, joined=k > 0).save(folder / f"config.{100 * k:05d}.data")
    said = running.run("network", str(folder), "-o", str(tmp_path / "o"), code=0)
    assert "3 networks" in said.stdout
    assert "(-1, 0, 0) + (0, -1, 0) + (1, 1, 0) = 0" in said.stdout
    assert (tmp_path / "o/network.png").read_bytes().startswith(b"\x89PNG")
    assert '"times"' in (tmp_path / "o/network.json").read_text()
    said = running.run("network", str(folder), "--unit", "1e-9", "--format", "json", code=0)
    assert '"density_per_m2"' in said.stdout
    said = running.run("network", str(folder), "--circle", "0,0,0:1", code=2)
    assert "expected a single file, got a folder" in " ".join(said.stderr.split())


def test_a_figure_over_time():
    """Densities of all lines and of each family, and three curves of junctions."""
    series = DislocationSeries([0, 10], [crossed(joined=False), crossed(joined=True)])
    above, below = gt.pictures.draw_series(series, unit="nm").axes
    assert [len(axes.lines) for axes in (above, below)] == [3, 3]
    assert above.get_ylabel() == "density [1/nm^2]"
    assert np.asarray(above.lines[0].get_ydata()) == pytest.approx(series.density)


def test_a_real_network_with_itself():
    """A simulation of copper: nothing changes between equal times."""
    one = DislocationNetwork.read(real("networks/180chains_16.10e.data"))
    series = DislocationSeries([0, 1], [one, one])
    assert series.junctions[0] > 1000
    assert series.changes == ()
