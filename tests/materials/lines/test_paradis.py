"""ParaDiS files: round trips, a simulated network, and damage named by its line."""

# The tests pass what users pass, including wrong types, and read optional values.
# pyright: reportArgumentType=false, reportCallIssue=false, reportOptionalMemberAccess=false

from pathlib import Path

import numpy as np
import pytest

from geomtorsion.errors import FileFormatError, NetworkError
from geomtorsion.materials.lines import Box, DislocationNetwork, LineArrays
from tests.cli.running import run
from tests.materials.lines.synthetic_networks import REAL, rings
from tests.real import real

SMALL = (Path(__file__).parents[2] / "data" / "triangle.data").read_text("utf-8")


@pytest.fixture
def small(tmp_path):
    """A function that writes a text into a file and reads it."""

    def read(text: str = SMALL, periodic: bool = True) -> DislocationNetwork:
        path = tmp_path / "small.data"
        path.write_text(text)
        return DislocationNetwork.read(path, periodic)

    return read


def test_a_file_by_hand(small):
    """Nodes, lines (each once, with b of its first node), constraints, planes and box are read."""
    net = small()
    assert net.lines == (
        ((0, 0), (0, 1), 0, (0.0, 0.0, 1.0)), ((0, 0), (0, 7), 0, (0.0, 0.0, -1.0)),
        ((0, 1), (0, 7), 0, (0.0, 0.0, 1.0)),
    )  # fmt: skip
    assert net.node_rule() == ()
    assert net.box.volume == 64
    assert net.graph.nodes[0, 1]["constraint"] == 7
    assert net.arrays.planes.tolist() == [[1, 0, 0]] * 3
    assert net.arrays.lengths.tolist() == pytest.approx([2, 3.25**0.5, 3.25**0.5])
    assert not small(periodic=False).box.periodic.any()


def test_pinned_and_surface_nodes(small):
    """A line may end at a surface node; an end at a pinned node is a violation marked as pinned."""
    one = SMALL.replace("nodeCount = 3", "nodeCount = 2").split(" 0,0 -1")[0]
    ends = " 0,0 -1 0 0 1 7\n 0,1 0 0 1 0 0 1\n 0,1 1 0 0 1 8\n 0,0 0 0 -1 0 0 1\n"
    (violation,) = small(one + ends).node_rule()
    assert violation.missing == (0, 0, -1)
    assert str(violation) == "node (0, 0) (pinned): b out minus b in = (0, 0, 1)"


def test_written_lines_read_back_to_the_last_digit(tmp_path):
    """Positions, lines, b, images, constraints and box; saving twice gives the same bytes."""
    lines = rings(15, seed=3, size=7.3)
    net = DislocationNetwork.of_arrays(lines)
    net.save(tmp_path / "a.data")
    back = DislocationNetwork.read(tmp_path / "a.data")
    assert np.array_equal(back.arrays.positions, lines.positions)
    assert np.array_equal(back.box.vectors, lines.box.vectors)
    assert described(back.arrays) == described(lines)
    back.save(tmp_path / "b.data")
    DislocationNetwork.read(tmp_path / "b.data").save(tmp_path / "c.data")
    assert (tmp_path / "c.data").read_bytes() == (tmp_path / "b.data").read_bytes()


def described(lines: LineArrays) -> set[tuple[float, ...]]:
    """Each line from its lower node to its higher: nodes, b and image."""
    rows = zip(lines.pairs.tolist(), lines.burgers.tolist(), lines.image_list, strict=True)
    return {
        (a, b, *vector, *image) if a < b else (b, a, *(-x for x in vector), *(-x for x in image))
        for (a, b), vector, image in rows
    }


def test_what_such_a_file_cannot_hold_is_refused(tmp_path):
    """No box, a skew box, a line longer than half a period, and two components are refused."""
    box = Box.of_bounds([0, 0, 0], [4, 4, 4])
    places, pair = [[0, 0, 0], [3, 0, 0]], [[0, 1]]
    for lines, message in (
        (LineArrays(places, pair, [[1, 0, 0]]), "box along the coordinates"),
        (LineArrays(places, pair, [[1, 0, 0]], Box([[1, 1, 0], [0, 1, 0], [0, 0, 1]])), "along"),
        (
            LineArrays(places, pair, [[1, 0, 0]], box, [[0, 0, 0]]),
            "at most half a period.* got the longer line 0 -> 1",
        ),
        (LineArrays(places, pair, [[1, 0]], box), "three components"),
    ):
        with pytest.raises(NetworkError, match=message):
            DislocationNetwork.of_arrays(lines).save(tmp_path / "a.data")
    assert not (tmp_path / "a.data").exists()


def test_the_real_network(tmp_path):
    """5,055 nodes and 5,930 lines; sums at nodes of at most 4e-11; all b in the fcc lattice."""
    net = DislocationNetwork.read(real(REAL))
    assert (len(net.graph), len(net.lines)) == (5055, 5930)
    assert np.abs(net.arrays.excess).max() <= 4.1e-11
    assert net.node_rule() == ()
    families = net.families()
    assert [one.name for one in families] == ["0.7071 <1 1 0>", "1.414 <1 0 0>"]
    assert sum(one.lines for one in families) == 5930
    assert sum(one.density for one in families) == pytest.approx(net.density, rel=1e-12)
    net.save(tmp_path / "again.data")
    back = DislocationNetwork.read(tmp_path / "again.data")
    assert back.lines == net.lines
    assert np.array_equal(back.arrays.positions, net.arrays.positions)


@pytest.mark.parametrize(
    ("old", "new", "later", "message"),
    [
        ("nodeCount = 3", "nodeCount = 4", 22, "expected node 4 of 4, got the end of the file"),
        ("nodeCount = 3", "nodeCount = 2", 18, "after 2 nodes .nodeCount., got '0,7"),
        ("nodeCount = 3", "nodeCount = three", 0, "expected a whole number, got 'three'"),
        ("nodeCount = 3", "nodeCount = -1", 0, "expected 0 or more"),
        ("numFileSegments = 1", "numFileSegments = 2", 0, "in 1 file, got one in 2"),
        (" 0,1 1 0 0 2 7", " 0,1 1 0 nan 2 7", 0, "expected a finite number, got 'nan'"),
        (" 0,1 1 0 0 2 7", " 0,1 1 0 1e999 2 7", 0, "finite number"),
        (" 0,1 1 0 0 2 7", " 0,1 1 0 1_0 2 7", 0, "finite number"),
        (" 0,1 1 0 0 2 7", " 0,0 1 0 0 2 7", 0, "expected each node once, got node 0,0 again"),
        (" 0,1 1 0 0 2 7", " 0,1 1 0 0 3 7", 5, "expected a node such as 0,12|six numbers, got"),
        (" 0,1 1 0 0 2 7", " 0,1 1 0 0 1 7", 3, "number of arms|expected a node"),
        (" 0,1 1 0 0 2 7", " 0,1 1 0 0 -1 7", 0, "expected 0 or more"),
        (" 0,1 1 0 0 2 7", " 0,1 1 0", 0, "got 4 words|got 3 words"),
        ("   0,1 0 0 1\n", "   0,1 0 0 0\n", 0, "b = 0"),
        ("   0,1 0 0 1\n", "   0,0 0 0 1\n", 0, "to itself"),
        ("   0,1 0 0 1\n", "   0,9 0 0 1\n", 0, "an arm to a node of the file, got one to 0,9"),
        ("   0,1 0 0 1\n", "   0,1 0 1 1\n", 0, "expected opposite b at both nodes"),
        (
            "   0,7 0 0 1.\n",
            "   0,0 0 0 1.\n",
            -6,
            "from node 0,0 to 0,1 as back, got 1 and 2 back",
        ),
    ],
)
def test_damage_is_named_by_its_line(small, old, new, later, message):
    """The error names file, line, and the expected and given value."""
    line = SMALL[: SMALL.index(old)].count("\n") + 1 + later
    with pytest.raises(FileFormatError, match=rf"small.data: line {line}: .*({message})"):
        small(SMALL.replace(old, new, 1))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("minCoordinates", "lowCoordinates", "expected minCoordinates above nodalData"),
        ("nodalData", "nodes", "expected nodalData, got the end of the file"),
        ("[ 2 2 2 ]", "[ 2 2 -2 ]", "a highest corner above the lowest"),
        ("[ 2 2 2 ]", "[ 2 2 ]", "expected 3 numbers, got 2"),
        ("[ 2 2 2 ]", "[ 2 2 2", "maxCoordinates|nodalData"),
    ],
)
def test_a_damaged_head_is_named(small, old, new, message):
    """Missing, wrong or truncated keys are refused."""
    with pytest.raises(FileFormatError, match=rf"small.data: .*({message})"):
        small(SMALL.replace(old, new, 1))


def arms_in_one_line(text: str) -> str:
    """The same file with b and plane of an arm in one line."""
    head, key, body = text.partition("nodalData")
    rows = body.split("\n")
    for k in range(len(rows) - 1, 0, -1):
        if len(rows[k].split()) == 3 and len(rows[k - 1].split()) == 4:
            rows[k - 1 : k + 1] = [f"{rows[k - 1]} {rows[k]}"]
    return head + key + "\n".join(rows)


def test_arms_in_one_row(tmp_path, small):
    """Arms whose plane is in the row of b give the same network, with equal bits."""
    DislocationNetwork.of_arrays(rings(30, seed=5)).save(tmp_path / "usual.data")
    text = (tmp_path / "usual.data").read_text()
    odd = arms_in_one_line(text)
    assert odd.count("\n") < text.count("\n")
    one, two = small(text).arrays, small(odd).arrays
    for name in ("positions", "pairs", "burgers", "images", "constraints", "planes"):
        assert (getattr(one, name) == getattr(two, name)).all()
    assert list(one.labels) == list(two.labels)


def test_two_lines_between_the_same_nodes(tmp_path):
    """Their end nodes do not distinguish the two lines, but both b are kept."""
    box = Box.of_bounds([0, 0, 0], [4, 4, 4])
    vectors = [[1, 0, 0], [0, 1, 0]]
    lines = LineArrays([[1, 1, 1], [2, 1, 1]], [[0, 1], [0, 1]], vectors, box)
    DislocationNetwork.of_arrays(lines).save(tmp_path / "two.data")
    back = DislocationNetwork.read(tmp_path / "two.data")
    assert back.arrays.burgers.tolist() == vectors


def test_lines_between_the_same_nodes_in_any_order(small):
    """Arms are matched by b, not by order; lines between the same nodes follow each other."""
    head, _, _ = SMALL.partition("nodeCount")
    rows = [
        "nodeCount = 3", "nodalData =",
        "0,0 0 0 0 3 0", "0,2 1 0 0", "0 0 1", "0,1 0 0 1", "0 1 0", "0,2 0 1 0", "0 0 1",
        "0,1 1 0 0 1 0", "0,0 0 0 -1", "0 1 0",
        "0,2 0 1 0 2 0", "0,0 0 -1 0", "0 0 1", "0,0 -1 0 0", "0 0 1",
    ]  # fmt: skip
    arrays = small("\n".join([head, *rows])).arrays
    assert arrays.pairs.tolist() == [[0, 2], [0, 2], [0, 1]]
    assert arrays.burgers.tolist() == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    assert arrays.planes.tolist() == [[0, 0, 1], [0, 0, 1], [0, 1, 0]]
    rows[4] = "0 0 one"
    line = head.count("\n") + 2 + 4
    with pytest.raises(FileFormatError, match=f"line {line}: an arm: .* number, got 'one'"):
        small("\n".join([head, *rows]))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("2 0", "2.0 0", "expected a whole number, got '2.0'"),
        ("1.0 0.0 0.0", "1_0 0.0 0.0", "expected a finite number, got '1_0'"),
        ("1.0 0.0 0.0", "1e999 0.0 0.0", "expected a finite number, got '1e999'"),
        ("0,1", "0,1e0", "a node such as"),
    ],
)
def test_numbers_are_read_strictly(tmp_path, small, old, new, words):
    """Numbers are read strictly, also in otherwise usual files."""
    box = Box.of_bounds([0, 0, 0], [4, 4, 4])
    corners = [[1, 1, 2], [3, 1, 2], [3, 3, 2]]
    lines = LineArrays(corners, [[0, 1], [1, 2], [2, 0]], [[0, 0, 1]] * 3, box)
    DislocationNetwork.of_arrays(lines).save(tmp_path / "a.data")
    head, key, body = (tmp_path / "a.data").read_text().partition("nodalData")
    body = body.replace("0.0 0.0 1.0", "1.0 0.0 0.0")
    body = body.replace("-0.0 -0.0 -1.0", "-1.0 0.0 0.0")
    assert old in body
    small(head + key + body)
    with pytest.raises(FileFormatError, match=words):
        small(head + key + body.replace(old, new, 1))


def test_a_network_without_nodes(tmp_path: Path):
    """A simulation before the first line nucleates writes an empty network, which is accepted."""
    head, _, _ = SMALL.partition("nodeCount")
    path = tmp_path / "empty.data"
    path.write_text(f"{head}nodeCount = 0\nnodalData =\n")
    net = DislocationNetwork.read(path)
    assert (net.lines, net.junctions, float(np.abs(net.nye).max())) == ((), (), 0.0)
    for end in (".data", ".json", ".ca"):
        net.save(tmp_path / f"again{end}")
        assert DislocationNetwork.read(tmp_path / f"again{end}").lines == ()
    shown = run("network", str(path), "-o", str(tmp_path / "out"))
    assert "0 nodes, 0 lines" in shown.stdout
    assert (tmp_path / "out" / "network.json").exists()
    path.write_text(f"{head}nodeCount = 0\nnodalData =\n0,0 1 1 1 0 0\n")
    with pytest.raises(FileFormatError, match="expected the end of the file after 0 nodes"):
        DislocationNetwork.read(path)


def test_a_packed_name_is_not_written(small, tmp_path: Path):
    """Plain text under the name of a packed file would be unreadable."""
    with pytest.raises(NetworkError, match=r"expected the name of a plain file"):
        small().save(tmp_path / "lines.data.gz")
