"""Squares: all circuits of one size have the same whole numbers as single circuits."""

# The tests pass what users pass, including wrong types, and read optional values.
# pyright: reportArgumentType=false

from functools import cache

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import ImageError
from tests.materials.images.atoms import crystal

made = cache(crystal)


def square(x: int, y: int, size: int) -> gt.Loop:
    """A square of pixels as a loop, anticlockwise."""
    return gt.Loop.polygon([[x, y], [x + size, y], [x + size, y + size], [x, y + size]])


@pytest.mark.parametrize("size", [7, 60])
def test_squares_agree_with_circuits(size):
    """Whole numbers and chances agree at random positions, holes included."""
    image = made(256, "hexagonal")
    phases = gt.LatticeImage(image.noisy(1, 0), 0.5, "nm").phases(2 * image.vectors)
    found = phases.burgers_map(size)
    assert found.whole.shape == (2, 256 - size, 256 - size)
    assert found.area == (size / 2) ** 2
    rng = np.random.default_rng(3)
    told = 0
    for x, y in rng.integers(256 - size, size=(60, 2)).tolist():
        try:
            b = phases.burgers(square(x / 2, y / 2, size / 2), risk=1.0)
        except ImageError:
            assert not found.known[x, y]
            continue
        told += bool(b.whole.any())
        assert found.whole[:, x, y].tolist() == b.whole.tolist()
        assert found.estimated.chance is not None
        chance = found.estimated.chance[x, y]
        assert chance == pytest.approx(b.chance, rel=1e-6)
        assert found.known[x, y] == (chance <= 0.05)
        if found.known[x, y]:
            assert found.vectors[:, x, y] == pytest.approx(b.vector)
            assert found.significance[x, y] == pytest.approx(b.significance, rel=1e-6)
    assert told or size == 7
    x, y = (int(c) - size // 2 for c in image.centre)
    truth = (-np.rint(image.vectors @ image.b)).astype(int).tolist()
    if size == 60:
        assert found.whole[:, x, y].tolist() == truth != [0, 0]


@pytest.mark.parametrize("size", [1, 256, 2.5, "8", True])
def test_invalid_sizes_are_refused(size):
    """The error states the allowed range."""
    phases = gt.LatticeImage(made(256, "square").values).phases()
    with pytest.raises(ImageError, match="size: expected a whole number from 2 to 255"):
        phases.burgers_map(size)
