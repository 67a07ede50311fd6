"""Pictures of line networks: lines in their box, families, circuits, broken nodes."""

# Tests give what users give, wrong things included, and read what may be missing.
# pyright: reportAttributeAccessIssue=false

import numpy as np
import pytest

from geomtorsion.errors import NetworkError
from geomtorsion.loops import DislocationNetwork, LineArrays, Loop
from geomtorsion.pictures import draw_lines
from tests.loops.synthetic_networks import rings


def test_lines_are_drawn_in_the_box_once():
    """The box, one collection for each family with all its lines, middles in the box."""
    lines = rings(10, seed=4)
    mixed = lines.burgers.copy()
    mixed[:12] = [0, 0, 1]
    net = DislocationNetwork.of_arrays(LineArrays(lines.positions, lines.pairs, mixed, lines.box))
    space, bars = draw_lines(net, [Loop.circle([5, 5, 5], 4)]).axes
    box, *families = space.collections
    assert len(box._segments3d) == 12
    segments = np.concatenate([one._segments3d for one in families])
    assert sorted(len(one._segments3d) for one in families) == [12, 108]
    middles = segments.mean(axis=1)
    assert middles.min() >= 0
    assert middles.max() <= 10
    assert len(space.lines) == 1
    widths = [bar.get_width() for bar in bars.patches]
    assert sum(widths) == pytest.approx(100)


def test_broken_nodes_are_marked_and_counted():
    """Two ends of a line that ends in the crystal, without a box."""
    line = LineArrays([[0, 0, 0], [1, 0, 0]], [[0, 1]], [[1.0, 0, 0]])
    figure = draw_lines(DislocationNetwork.of_arrays(line))
    assert "not conserved at 2 nodes" in figure.get_suptitle()
    assert len(figure.axes[0].collections) == 2


def test_nothing_is_refused():
    """A network without lines has no picture."""
    empty = LineArrays(np.zeros((1, 3)), np.zeros((0, 2), int), np.zeros((0, 3)))
    with pytest.raises(NetworkError, match="needs a line"):
        draw_lines(DislocationNetwork.of_arrays(empty))
