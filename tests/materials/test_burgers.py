"""Burgers vectors: levels of noise and significance."""

import numpy as np
import pytest

from geomtorsion.materials.burgers import noise_level, significances


@pytest.mark.parametrize("rows", [1, 2, 3])
def test_noise_passes_the_level_once_in_a_thousand(rows):
    """Counted on a million normal vectors, within five standard deviations of the count."""
    lengths = np.linalg.norm(np.random.default_rng(rows).normal(size=(rows, 10**6)), axis=0)
    assert abs((lengths > noise_level(rows)).sum() - 1000) < 5 * np.sqrt(1000)


@pytest.mark.parametrize("rows", [1, 2, 3, 4])
def test_significance_is_the_length_in_units_of_errors(rows):
    """sqrt(b C^-1 b) by the inverse of C, with systematic errors on its diagonal."""
    rng = np.random.default_rng(rows)
    roots = rng.normal(size=(40, rows, rows))
    table, other = roots @ roots.swapaxes(1, 2), rng.uniform(0, 2, 40)
    b = rng.normal(size=(rows, 40))
    inverse = np.linalg.inv(table + other[:, None, None] ** 2 * np.eye(rows))
    expected = np.sqrt(np.einsum("ik,kij,jk->k", b, inverse, b))
    pairs = [(i, j) for i in range(rows) for j in range(i, rows)]
    found = significances(b, {(i, j): table[:, i, j] for i, j in pairs}, other)
    assert found == pytest.approx(expected, rel=1e-12)


def test_a_direction_without_error():
    """With noise in only one direction, b across it is infinitely significant, despite rounding."""
    along = np.array([0.1, 0.2, 0.3])
    table = np.outer(along, along)
    pairs = {(i, j): table[i, j] for i in range(3) for j in range(i, 3)}
    assert significances(7 * along, pairs) == pytest.approx(7)
    assert significances(np.array([1.0, 0.0, 0.0]), pairs) == np.inf
    assert significances(np.zeros(3), pairs) == 0
    assert np.isnan(significances(np.array([np.nan, 0.0, 1.0]), pairs))
