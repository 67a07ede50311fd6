"""Local frames: sums and maxima of short rows equal numpy's results to the last bit."""

import numpy as np
import pytest

from geomtorsion.materials.crystals.local_frames import largest, squared


@pytest.mark.parametrize("shape", [(3,), (50, 3), (20, 12, 3), (5, 4, 12, 3)])
def test_squares_of_lengths_agree_with_numpy(shape):
    """The squares are added in the same order as in numpy."""
    vectors = np.random.default_rng(0).normal(size=shape) * 10.0 ** np.arange(-3, 4, 3)
    assert (squared(vectors) == (vectors**2).sum(axis=-1)).all()
    assert (np.sqrt(squared(vectors)) == np.linalg.norm(vectors, axis=-1)).all()


@pytest.mark.parametrize("columns", [1, 2, 14])
def test_the_largest_of_each_row(columns):
    """Equal entries and NaN give the same result as in numpy."""
    table = np.random.default_rng(1).integers(-3, 4, (200, columns)).astype(float)
    table[7, columns // 2] = np.nan
    before = table.copy()
    assert np.array_equal(largest(table), table.max(axis=1), equal_nan=True)
    assert np.array_equal(table, before, equal_nan=True)
