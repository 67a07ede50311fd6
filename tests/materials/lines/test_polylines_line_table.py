"""Line table: the printed form of a network."""

import networkx as nx

from geomtorsion.materials.lines import DislocationNetwork
from tests.materials.lines.synthetic_networks import rings


def test_a_row_for_each_line_up_to_a_screen():
    """The first row has counts, columns are aligned, and the last row counts omitted lines."""
    shown = str(DislocationNetwork.of_arrays(rings(43, seed=1)))
    rows = shown.splitlines()
    assert rows[0].startswith("43 dislocation lines, no junctions, length ")
    assert rows[-1] == "  and 3 more"
    assert len(rows) == 43
    assert {row.index("0.7071 <1 1 0>") for row in rows[2:-1]} == {rows[1].index("family")}
    assert all(row.endswith("closed") for row in rows[2:-1])


def test_without_places_and_without_lines():
    """Without positions the table has nodes and b; an empty network is one row."""
    net = DislocationNetwork.of_lines([("a", "b", (1, 0, 0))], surface="ab")
    assert str(net).splitlines()[-1] == "  a     b   (1, 0, 0)"
    assert (
        str(DislocationNetwork(nx.MultiDiGraph())) == "no dislocation lines, no junctions, length 0"
    )


def test_families_of_a_crystal_are_named_as_there():
    """Lines with a family keep its name, which b in coordinates does not determine."""
    graph = nx.MultiDiGraph()
    graph.add_node("a", position=(0, 0, 0), surface=True)
    graph.add_node("b", position=(0, 0, 2), surface=True)
    graph.add_edge("a", "b", burgers=(2.0, 0.3, 0.1), family="1/2<1 1 0>")
    net = DislocationNetwork(graph)
    assert net.names == ["1/2<1 1 0>"]
    assert str(net).splitlines()[-1].split() == [
        "0", "(2,", "0.3,", "0.1)", "1/2<1", "1", "0>", "2", "0", "%", "surface",
    ]  # fmt: skip
