"""Polylines: lines between junctions, joined from pieces of either sense."""

# Networks accept any node names; type checkers cannot express a mapping with some of them.
# pyright: reportArgumentType=false

import numpy as np
import pytest

from geomtorsion.materials.lines import Box, DislocationNetwork, LineArrays
from tests.materials.lines.synthetic_networks import rings, straight


def test_rings_are_closed_lines():
    """Each polygon is one closed line with its own perimeter, also across faces of the box."""
    lines = rings(15, seed=3, size=7.3)
    curves = DislocationNetwork.of_arrays(lines).polylines
    assert len(curves) == 15
    assert all(one.is_closed and not one.is_periodic and one.ends == "closed" for one in curves)
    assert [one.length for one in curves] == pytest.approx(
        lines.lengths.reshape(15, 12).sum(axis=1)
    )
    assert all(np.array_equal(one.points[0], one.points[-1]) for one in curves)


def test_straight_lines_are_periodic():
    """A line through the box ends one period further, and its character is reported."""
    net = DislocationNetwork.of_arrays(straight([(0, 0), (9, 3)], [[0, 0, 1], [1, 0, 0]]))
    screw, edge = net.polylines
    assert [one.ends for one in (screw, edge)] == ["periodic", "periodic"]
    assert screw.shift == (0, 0, 1)
    assert [one.length for one in (screw, edge)] == pytest.approx([4, 4])
    assert (screw.screw, edge.screw) == pytest.approx((1, 0))
    assert screw.points[-1] - screw.points[0] == pytest.approx([0, 0, 4])


def test_pieces_of_either_sense_are_one_line():
    """Reversed pieces give the same lines."""
    lines = rings(5, seed=8)
    net = DislocationNetwork.of_arrays(lines)
    turned = net
    for k in (1, 4, 5, 17, 40):
        turned = turned.reversed(net.lines[k][:3])
    one, two = ({(x.nodes[0], round(x.length, 9)) for x in n.polylines} for n in (net, turned))
    assert {length for _, length in one} == {length for _, length in two}
    assert len(turned.polylines) == 5


def test_a_line_to_itself_in_the_next_image():
    """One node and one piece: the line does not cancel with its image."""
    box = Box.of_bounds([0, 0, 0], [4, 4, 4])
    net = DislocationNetwork.of_arrays(
        LineArrays([[1, 1, 1]], [[0, 0]], [[0, 0, 1]], box, [[0, 0, 1]])
    )
    (one,) = net.polylines
    assert one.is_periodic
    assert one.length == 4


def test_lines_end_at_junctions_surfaces_and_where_b_changes():
    """Three lines at a node; a node at the surface; a node at which b is not conserved."""
    places = {"a": (0, 0, 0), "b": (1, 0, 0), "c": (2, 0, 0), "d": (1, 1, 0), "e": (3, 0, 0)}
    lines = [
        ("a", "b", (1, 0, 0)), ("d", "b", (0, 1, 0)), ("b", "c", (1, 1, 0)), ("c", "e", (1, 0, 0)),
    ]  # fmt: skip
    net = DislocationNetwork.of_lines(lines, surface="ad", positions=places)
    # A new line starts at a node that does not conserve b.
    assert [one.ends for one in net.polylines] == [
        "surface, junction", "junction", "surface, junction", "junction, nothing",
    ]  # fmt: skip
    marked = DislocationNetwork.of_lines(
        [("a", "b", (1, 0, 0)), ("b", "c", (1, 0, 0))], surface="abc", positions=places
    )
    assert len(marked.polylines) == 2
    joined = DislocationNetwork.of_lines(
        [("a", "b", (1, 0, 0)), ("c", "b", (-1, 0, 0))], surface="ac", positions=places
    )
    (one,) = joined.polylines
    assert (one.nodes, one.burgers, one.ends) == (("a", "b", "c"), (1, 0, 0), "surface")
