"""OpenDiS arrays: round trips and refusals."""

# The tests pass what users pass, including wrong types, and read optional values.
# pyright: reportArgumentType=false, reportAttributeAccessIssue=false, reportOptionalMemberAccess=false

import numpy as np
import pytest

from geomtorsion.errors import NetworkError
from geomtorsion.loops import Loop
from geomtorsion.materials.lines import DislocationNetwork
from tests.materials.lines.synthetic_networks import rings

# A binary junction as ExaDiS exports it, pinned ends, not periodic; columns of h are the edges.
JUNCTION = {
    "cell": {"h": 8 * np.eye(3), "origin": np.zeros(3), "is_periodic": [0, 0, 0]},
    "nodes": {
        "tags": np.array([[0, 0], [0, 5], [0, 2], [0, 3], [0, 9]]),
        "positions": np.array([[2.0, 2, 4], [6, 6, 4], [2, 6, 4], [6, 2, 4], [4, 4, 4]]),
        "constraints": np.array([[7], [7], [7], [7], [0]]),
    },
    "segs": {
        "nodeids": np.array([[0, 4], [4, 1], [2, 4], [4, 3]]),
        "burgers": np.array([[-1.0, 1, 1], [-1, 1, 1], [1, -1, 1], [1, -1, 1]]),
        "planes": np.ones((4, 3)),
    },
}  # fmt: skip


def test_a_junction_there_and_back():
    """Tags are the node names; cell, nodes and lines come back unchanged."""
    net = DislocationNetwork.of_opendis(JUNCTION)
    assert net.excess((0, 9)) == (0, 0, 0)
    assert [one.constraint for one in net.node_rule()] == [7] * 4
    back = net.opendis()
    for table, arrays in JUNCTION.items():
        for name, wanted in arrays.items():
            if table != "segs":
                assert np.array_equal(back[table][name], wanted), name
    assert DislocationNetwork.of_opendis(back).lines == net.lines
    loop = Loop.circle([3, 3, 4], 0.5, ([1, -1, 0], [0, 0, 1]))
    assert abs(net.burgers(loop).vector).tolist() == [1, 1, 1]


def test_a_skew_cell_has_its_edges_as_columns():
    """h is the transpose of the vectors of a box."""
    h = np.array([[4, 1, 0], [0, 4, 1], [0, 0, 4.0]])
    data = {**JUNCTION, "cell": {"h": h, "is_periodic": np.array([True, True, False])}}
    net = DislocationNetwork.of_opendis(data)
    assert net.box.vectors[1].tolist() == [1, 4, 0]
    assert np.array_equal(net.opendis()["cell"]["h"], h)


def test_rings_keep_their_images():
    """A periodic network comes back with the same lengths and images."""
    lines = rings(9, seed=2)
    back = DislocationNetwork.of_opendis(DislocationNetwork.of_arrays(lines).opendis()).arrays
    assert np.array_equal(back.lengths, lines.lengths)
    assert np.array_equal(back.images, lines.images)


@pytest.mark.parametrize(
    ("table", "change", "message"),
    [
        ("segs", {"burgers": None}, "segs: expected burgers, got a table without.*export_data"),
        ("cell", {"h": np.eye(2)}, "h: expected shape"),
        ("nodes", {"positions": [[0, 0]]}, "positions: expected shape"),
        (
            "nodes",
            {"tags": [[0, 0]] * 5},
            "expected a different tag for each node, got one tag twice",
        ),
        ("nodes", {"constraints": ["a"] * 5}, "constraints: expected whole numbers"),
        ("segs", {"nodeids": [[0, 99]] * 4}, "node numbers from 0 to 4"),
        ("segs", {"burgers": [[0, 0, 0]] * 4}, "b = 0"),
    ],
)
def test_bad_tables_are_refused(table, change, message):
    """Missing or misshapen arrays are refused."""
    with pytest.raises(NetworkError, match=message):
        DislocationNetwork.of_opendis({**JUNCTION, table: {**JUNCTION[table], **change}})


def test_no_tables_no_network():
    """A list and mappings with missing tables are refused."""
    for data in ([], {"cell": 1}, {"nodes": {}}):
        with pytest.raises(NetworkError, match="expected .*, got a table without"):
            DislocationNetwork.of_opendis(data)
