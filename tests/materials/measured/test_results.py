"""Results: levels of noise and units."""

import numpy as np
import pytest

from geomtorsion.materials.measured.results import noise_level
from tests.materials.measured.test_fields import field


@pytest.mark.parametrize("rows", [1, 2, 3])
def test_noise_passes_the_level_once_in_a_thousand(rows):
    """Counted on a million normal vectors, to five standard deviations of the count."""
    lengths = np.linalg.norm(np.random.default_rng(rows).normal(size=(rows, 10**6)), axis=0)
    assert abs((lengths > noise_level(rows)).sum() - 1000) < 5 * np.sqrt(1000)


@pytest.mark.parametrize(
    ("unit", "other", "expected"), [("nm", "", "1/nm"), ("um", "nm", "nm/um^2"), ("", "", "")]
)
def test_units_of_the_density(unit, other, expected):
    """b per area."""
    assert field(sigma=0.1, unit=unit, vector_unit=other).survey(1).density_unit == expected
