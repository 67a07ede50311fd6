"""Sets: images contain the images of all members."""

import itertools

import pytest
from flint import arb, arb_mat

from geomtorsion.errors import ProofError
from geomtorsion.proofs.sets import LohnerSet
from geomtorsion.support.precision import ball_precision


def corners(whole):
    """Members of a set: m + A r with each r at an end of its interval."""
    n = len(whole.middle)
    for signs in itertools.product((-1, 1), repeat=len(whole.spread)):
        yield [
            whole.middle[i]
            + sum((s * whole.axes[i, j] * r for j, (s, r) in
                   enumerate(zip(signs, whole.spread, strict=True))), arb(0))
            for i in range(n)
        ]  # fmt: skip


def turned(point):
    """A linear map that rotates and stretches, with an offset."""
    x, y = point
    return [3 * x - 2 * y + 1, x + y / 4 - 5]


SLOPES = [[3, -2], [1, 0.25]]
START = [arb(1, 0.125), arb(-2, 2.0**-30)]


def inside(whole, point):
    """Whether a point may be in a set: A^-1 (x - m) is in the box of r."""
    back = whole.axes.inv() * arb_mat([[x - m] for x, m in zip(point, whole.middle, strict=True)])
    return all(abs(back[k, 0]) <= r * 1.000001 for k, r in enumerate(whole.spread))


def image_holds():
    """Whether the image of a set contains the images of its members, after a few maps."""
    with ball_precision(100):
        whole = LohnerSet.of(START)
        for _ in range(3):
            members = [turned(point) for point in corners(whole)]
            values = [x + arb(0, 1e-6) for x in turned(whole.middle)]
            box = whole.image(values, arb_mat(SLOPES))
            whole = whole.moved(values, arb_mat(SLOPES))
            for one in members:
                moved = [x + 1e-6 * 0.99 for x in one]
                if not (inside(whole, one) and inside(whole, moved)):
                    return False
                if not all(b.contains(x) for b, x in zip(box, one, strict=True)):
                    return False
                if not all(b.contains(x) for b, x in zip(whole.hull, one, strict=True)):
                    return False
        return True


def test_the_image_contains_all_members():
    """Corners are mapped into the set, and the radii of the values are added."""
    assert image_holds()


def test_sets_turn_without_wrapping():
    """A narrow set that rotates a thousand times keeps its area; boxes would grow by e^200."""
    with ball_precision(100):
        c, s = (arb(1) / 5).cos(), (arb(1) / 5).sin()
        slopes = arb_mat([[c, -s], [s, c]])
        whole = LohnerSet.of([arb(1, 1e-6), arb(0, 1e-9)])
        for _ in range(1000):
            x, y = whole.middle
            whole = whole.moved([c * x - s * y, s * x + c * y], slopes, [0.0, 0.0])
        assert max(map(float, whole.radii)) < 2e-6


def test_more_directions_than_states():
    """Sets may have more axes than states: they are reduced to as many."""
    with ball_precision(100):
        axes = arb_mat([[1, 0, 1], [0, 1, 1]])
        whole = LohnerSet((arb(0), arb(0)), axes, (arb(1), arb(1), arb(0.5)))
        moved = whole.moved([arb(0), arb(0)], arb_mat([[1, 0], [0, 1]]))
        assert moved.axes.ncols() == 2
        assert all(inside(moved, point) for point in corners(whole))


def test_sets_without_bounds_are_refused():
    """An infinite derivative gives no set."""
    with ball_precision(100), pytest.raises(ProofError, match="no finite bounds"):
        LohnerSet.of(START).moved([arb(0), arb(0)], arb_mat([["nan", 0], [0, 1]]))
