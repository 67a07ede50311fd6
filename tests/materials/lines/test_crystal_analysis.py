"""Crystal Analysis files: files of OVITO are read; damage is named by its line."""

# Networks accept any node names; type checkers cannot express a mapping with some of them.
# pyright: reportArgumentType=false, reportCallIssue=false

from pathlib import Path

import numpy as np
import pytest

from geomtorsion.errors import FileFormatError, NetworkError
from geomtorsion.materials.lines import Box, DislocationNetwork, LineArrays
from geomtorsion.materials.lines.crystal_analysis import Cluster, crystal_analysis_text
from tests.rounding import ROUNDED

# Two Shockley partials of a relaxed edge dislocation in copper, as OVITO 3.17.2 wrote them.
FILE = Path(__file__).parents[2] / "data" / "partials.ca"


def test_a_file_of_ovito():
    """Lengths and b in space agree with OVITO; the sum of b is the perfect dislocation's."""
    net = DislocationNetwork.read(FILE)
    one, two = net.polylines
    assert [one.ends, two.ends] == ["periodic", "periodic"]
    # From OVITO's lines: length, spatial_burgers_vector.
    assert (one.length, two.length) == pytest.approx((13.300066173820596, 13.304972137132118))
    assert np.array(one.burgers) == pytest.approx((-1.27834940, 0, -0.737910748), abs=3e-6)
    assert np.array(two.burgers) == pytest.approx((-1.27834892, 0, 0.737911105), abs=3e-6)
    assert np.add(one.burgers, two.burgers) == pytest.approx([-3.615 / 2**0.5, 0, 0], abs=2e-3)
    assert net.box is not None
    assert np.asarray(net.box.periodic).tolist() == [False, False, True]


def test_units_of_the_lattice_and_families(tmp_path: Path):
    """The file stores b in lattice units, with the matrix that maps it to space."""
    matrix = 3.615 * np.linalg.qr(np.arange(9.0).reshape(3, 3) ** 2 + np.eye(3))[0]
    box = Box.of_bounds([0, 0, 0], [9, 9, 9])
    b = matrix @ [0.5, -0.5, 0]
    net = DislocationNetwork.of_arrays(LineArrays([[1, 1, 1]], [[0, 0]], [b], box, [[0, 0, 1]]))
    text = crystal_analysis_text(net.arrays, net.polylines, [Cluster("fcc", matrix)])
    assert "1/2<110> (Perfect)" in text
    rows = text.splitlines()
    local = np.array(rows[rows.index("DISLOCATIONS 1") + 2].split(), dtype=float)
    assert local == pytest.approx([0.5, -0.5, 0], abs=ROUNDED)
    (tmp_path / "a.ca").write_text(text)
    (back,) = DislocationNetwork.read(tmp_path / "a.ca").polylines
    assert np.array(back.burgers) == pytest.approx(b, abs=ROUNDED)


def test_three_lines_at_a_node_and_an_end_at_a_surface(tmp_path: Path):
    """A ring of three ends is a junction; a ring with only one end is an end at a surface."""
    places = {"j": (2, 2, 2), "a": (1, 1, 1), "b": (3, 1, 1), "c": (2, 3, 3)}
    lines = [("a", "j", (1, 0, 0)), ("b", "j", (0, 1, 0)), ("j", "c", (1, 1, 0))]
    graph = DislocationNetwork.of_lines(lines, surface="abc", positions=places).to_networkx()
    net = DislocationNetwork(graph, box=Box.of_bounds([0, 0, 0], [4, 4, 4], periodic=False))
    net.save(tmp_path / "a.ca")
    rows = (tmp_path / "a.ca").read_text().splitlines()
    rings = rows[rows.index("DISLOCATION_JUNCTIONS") + 1 :]
    assert len(rings) == 6
    assert sum(row == f"{1 - k % 2} {k // 2}" for k, row in enumerate(rings)) == 3
    back = DislocationNetwork.read(tmp_path / "a.ca")
    assert len(back.junctions) == 1
    assert back.node_rule() == ()
    assert sorted(one.ends for one in back.polylines) == sorted(one.ends for one in net.polylines)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("CA_FILE_VERSION 6", "ITEM: TIMESTEP", "holds lines, got a LAMMPS dump. Read it by"),
        ("CA_FILE_VERSION 6", "VERSION 6", "line 1: expected CA_FILE_VERSION, got 'VERSION"),
        ("CA_FILE_VERSION 6", "CA_FILE_VERSION 4", "line 1: expected version 5 or 6 .*, got '4'"),
        ("DISLOCATIONS 2", "DISLOCATIONS 3", "dislocation 2"),
        ("DISLOCATIONS 2", "DISLOCATIONS 99999999999", "line 17.: .*whole number below"),
        ("-0.1666666624", "nan", "expected a finite number, got 'nan"),
        ("0 1\n1 1\n", "0 1\n", "expected junction of dislocation 1, got the end"),
        ("1 1\n", "1 7\n", "whole number below 2"),
        ("0 1\n1 1\n", "0 0\n1 1\n", "expected a closed ring of junctions at dislocation"),
        ("DISLOCATION_JUNCTIONS", "# ", "expected DISLOCATION_JUNCTIONS, got the end"),
        ("DISLOCATIONS", "# ", "expected DISLOCATIONS, got the end"),
        ("DISLOCATION_JUNCTIONS", "1 2 3\nDISLOCATION_JUNCTIONS", "expected a keyword after 2"),
        ("SIMULATION_CELL_MATRIX", "# ", "expected SIMULATION_CELL_MATRIX"),
        ("PBC_FLAGS", "# ", "expected PBC_FLAGS, got a file without it"),
        ("PBC_FLAGS 0 0 1", "PBC_FLAGS 0 0 0.5", "PBC_FLAGS: expected 0 or 1 for each"),
        ("PBC_FLAGS 0 0 1", "PBC_FLAGS 0 1", "line 14.: PBC_FLAGS: expected 0 or 1 for"),
    ],
)  # fmt: skip
def test_damage_is_named(tmp_path: Path, old: str, new: str, message: str):
    """The error is our own and names the file, and the line if there is one."""
    text = FILE.read_text()
    assert old in text
    (tmp_path / "a.ca").write_text(text.replace(old, new, 1))
    with pytest.raises(FileFormatError, match=f"a.ca.*{message}"):
        DislocationNetwork.read(tmp_path / "a.ca")


def test_invalid_matrices_and_lattices_are_refused():
    """A singular matrix and a lattice that OVITO lacks are refused."""
    with pytest.raises(NetworkError, match="in one plane"):
        Cluster("fcc", np.ones((3, 3)))
    with pytest.raises(NetworkError, match="lattice: expected one of"):
        Cluster("quasi")


def test_clusters_have_their_own_axes(tmp_path: Path):
    """Two lines in two grains: b is stored in the units of its grain and read back in space to the
    last digits; the transition maps the components of a vector from one grain to the other."""
    turn = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
    matrices = [3.6 * np.eye(3), 2.9 * turn]
    b = [matrices[0] @ [0.5, -0.5, 0], matrices[1] @ [0.5, 0.5, -0.5]]
    box = Box.of_bounds([0, 0, 0], [9, 9, 9])
    places, images = [[1, 1, 1], [5, 5, 5]], [[0, 0, 1]] * 2
    net = DislocationNetwork.of_arrays(LineArrays(places, [[0, 0], [1, 1]], b, box, images))
    clusters = [Cluster("fcc", matrices[0], 70), Cluster("bcc", matrices[1], 50)]
    text = crystal_analysis_text(net.arrays, net.polylines, clusters, [0, 1], [(0, 1)])
    rows = text.splitlines()
    assert [row for row in rows if row.startswith("STRUCTURE_TYPE ")] == [
        "STRUCTURE_TYPE 1", "STRUCTURE_TYPE 3",
    ]  # fmt: skip
    assert [row for row in rows if "CLUSTER_S" in row] == [
        "CLUSTER_STRUCTURE 1", "CLUSTER_SIZE 70", "CLUSTER_STRUCTURE 3", "CLUSTER_SIZE 50",
    ]  # fmt: skip
    first = rows.index("DISLOCATIONS 2")
    found = [np.array(rows[first + 2 + 6 * k].split(), float) for k in (0, 1)]
    assert found[0] == pytest.approx([0.5, -0.5, 0], abs=ROUNDED)
    assert found[1] == pytest.approx([0.5, 0.5, -0.5], abs=ROUNDED)
    assert [rows[first + 3 + 6 * k] for k in (0, 1)] == ["1", "2"]
    between = np.array(rows[rows.index("TRANSITION 0 1") + 1].split(), float).reshape(3, 3)
    assert matrices[1] @ between @ found[0] == pytest.approx(b[0], abs=ROUNDED)
    (tmp_path / "a.ca").write_text(text)
    back = DislocationNetwork.read(tmp_path / "a.ca").polylines
    assert [np.array(one.burgers) for one in back] == [pytest.approx(x, abs=ROUNDED) for x in b]


def test_grains_keep_their_numbers(tmp_path: Path):
    """Grain numbers and clusters of a file with several clusters read back unchanged."""
    turn = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
    clusters = {0: Cluster("fcc", 3.6 * np.eye(3), 70), 2: Cluster("bcc", 2.9 * turn, 50)}
    box = Box.of_bounds([0, 0, 0], [9, 9, 9])
    lines = LineArrays(
        [[1, 1, 1], [5, 5, 5]], [[0, 0], [1, 1]], [[0, 1.8, 1.8], [0, 0, 2.9]], box,
        [[0, 0, 1]] * 2, grains=[2, 0], known={"clusters": clusters, "walls": [(0, 2)]},
    )  # fmt: skip
    net = DislocationNetwork.of_arrays(lines)
    net.save(tmp_path / "a.ca")
    back = DislocationNetwork.read(tmp_path / "a.ca")
    assert [line.grain for line in back.lines] == [2, 0]
    kept = back.graph.graph
    assert [(c.lattice, c.atoms) for c in kept["clusters"].values()] == [
        ("fcc", 70), ("fcc", 0), ("bcc", 50),
    ]  # fmt: skip
    assert np.array_equal(kept["clusters"][2].matrix, clusters[2].matrix)
    assert kept["walls"] == [(0, 2)]
    back.save(tmp_path / "b.ca")
    again = DislocationNetwork.read(tmp_path / "b.ca")
    assert [line.grain for line in again.lines] == [2, 0]


def test_one_cluster_has_no_grain_but_keeps_its_lattice(tmp_path: Path):
    """A single crystal has lines without a grain, and is written as it was read."""
    crystal = {None: Cluster("hcp", 3.2 * np.eye(3), 12)}
    box = Box.of_bounds([0, 0, 0], [9, 9, 9])
    lines = LineArrays(
        [[1, 1, 1]], [[0, 0]], [[0, 3.2, 0]], box, [[0, 0, 1]], known={"clusters": crystal}
    )
    DislocationNetwork.of_arrays(lines).save(tmp_path / "a.ca")
    back = DislocationNetwork.read(tmp_path / "a.ca")
    assert [line.grain for line in back.lines] == [None]
    back.save(tmp_path / "b.ca")
    assert (tmp_path / "a.ca").read_text() == (tmp_path / "b.ca").read_text()


def test_a_transition_to_no_cluster_is_refused(tmp_path: Path):
    """The error names the line."""
    box = Box.of_bounds([0, 0, 0], [9, 9, 9])
    clusters = {0: Cluster("fcc"), 1: Cluster("fcc")}
    lines = LineArrays(
        [[1, 1, 1]], [[0, 0]], [[0, 1, 0]], box, [[0, 0, 1]], grains=[1],
        known={"clusters": clusters, "walls": [(0, 1)]},
    )  # fmt: skip
    DislocationNetwork.of_arrays(lines).save(tmp_path / "a.ca")
    text = (tmp_path / "a.ca").read_text()
    (tmp_path / "a.ca").write_text(text.replace("TRANSITION 0 1", "TRANSITION 0 7"))
    with pytest.raises(FileFormatError, match="line.*TRANSITION: expected a whole number below 2"):
        DislocationNetwork.read(tmp_path / "a.ca")
