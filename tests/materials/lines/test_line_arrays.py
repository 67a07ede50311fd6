"""Lines as arrays: images, lengths, character, sums at nodes, and refused arrays."""

# The tests pass what users pass, including wrong types, and read optional values.
# pyright: reportArgumentType=false

import numpy as np
import pytest

from geomtorsion.errors import NetworkError
from geomtorsion.materials.lines import Box, LineArrays
from tests.materials.lines.synthetic_networks import rings
from tests.rounding import ROUNDED

BOX = Box.of_bounds([0, 0, 0], [4, 4, 4])


def test_lines_go_to_the_nearest_image():
    """A line that leaves the box and comes back is short; given images are kept."""
    lines = LineArrays([[0.5, 1, 1], [3.5, 1, 1]], [[0, 1], [0, 1]], [[1, 0, 0]] * 2, BOX)
    assert lines.steps.tolist() == [[-1, 0, 0]] * 2
    given = LineArrays(lines.positions, lines.pairs, lines.burgers, BOX, [[0, 0, 0], [-1, 0, 0]])
    assert given.lengths.tolist() == [3, 1]
    assert LineArrays(lines.positions, [[0, 1]], [[1, 0, 0]]).lengths.tolist() == [3]


def test_rings_have_their_length_and_close():
    """Each ring is a regular polygon however the box cuts it, and b is conserved at each node."""
    lines = rings(30, seed=1)
    whole = lines.steps.reshape(30, 12, 3)
    assert abs(whole.sum(axis=1)).max() < 1e-12
    sides = lines.lengths.reshape(30, 12)
    assert np.ptp(sides, axis=1).max() < 1e-12
    assert not lines.excess.any()


def test_the_excess_is_what_leaves_less_what_arrives():
    """A single line has an excess of b at its start and of -b at its end."""
    lines = LineArrays([[0, 0, 0], [1, 0, 0]], [[0, 1]], [[0.0, 1, 2]])
    assert lines.excess.tolist() == [[0, 1, 2], [0, -1, -2]]


def test_character_is_the_share_along_the_line():
    """Screw, edge, and 60 degrees between b and the line."""
    turned = [[1, 0, 0], [0, 1, 0], [0.5, np.sqrt(0.75), 0]]
    lines = LineArrays([[0, 0, 0], [2, 0, 0]], [[0, 1]] * 3, turned)
    assert lines.screw_shares == pytest.approx([1, 0, 0.25], abs=ROUNDED)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"positions": [[0, 0], [1, 1]]}, r"positions: expected shape"),
        ({"positions": [[0, 0, 0], [1, float("inf"), 1]]}, "not finite"),
        ({"pairs": [[0, 2]]}, "node numbers from 0 to 1"),
        ({"pairs": [[0.5, 1]]}, "whole numbers"),
        ({"burgers": [[1, 0, 0]] * 2}, "expected one for each of 1 lines, got 2"),
        ({"images": [[0, 0]]}, "images"),
        ({"images": [[1, 0, 0]], "box": None}, "expected a box for the periodic images"),
        ({"images": [[0, 0, 1]], "box": Box(np.eye(3), periodic=(1, 1, 0))}, "not periodic"),
        ({"labels": ["a"]}, "labels: expected one for each of 2"),
        ({"constraints": [0]}, "constraints: expected one for each of 2"),
        ({"planes": [[0, 0]]}, "planes: expected shape"),
        ({"box": "cube"}, "expected a Box"),
    ],
)
def test_bad_arrays_are_refused(change, message):
    """Each array is checked against the others."""
    given = {"positions": [[0, 0, 0], [1, 1, 1]], "pairs": [[0, 1]], "burgers": [[1, 0, 0]]}
    with pytest.raises(NetworkError, match=message):
        LineArrays(**{"box": BOX, **given, **change})
