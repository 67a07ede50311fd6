"""Speed of measured fields and lattice images: a million nodes or pixels.

pytest tests/benchmarks/test_measured_speed.py
"""

from __future__ import annotations

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

import geomtorsion as gt
from tests.materials.images.atoms import crystal

SIDE = 1000


def noisy_field(*, holes: bool) -> gt.SampledFrame:
    """A perfect crystal on a plane of SIDE^2 nodes, with noise and on request with holes."""
    rng = np.random.default_rng(0)
    values = np.eye(3)[:, :, None, None] + rng.normal(0, 0.01, (3, 3, SIDE, SIDE))
    mask = rng.random((SIDE, SIDE)) < 1e-3 if holes else None
    line = np.arange(SIDE, dtype=float)
    return gt.SampledFrame((line, line), values, sigma=0.01, mask=mask)


@pytest.mark.parametrize("size", [1, 8, 64])
@pytest.mark.parametrize("holes", [False, True], ids=["whole", "holes"])
def test_all_circuits_of_a_size(benchmark: BenchmarkFixture, size: int, holes: bool) -> None:
    """Time of |b| and its noise for each square."""
    field = noisy_field(holes=holes)
    significance = benchmark.pedantic(lambda: field.burgers_map(size).significance, rounds=2)
    # The field contains only noise.
    assert np.nanmedian(significance) == pytest.approx(np.sqrt(3), rel=0.15)


def test_nye_tensor(benchmark: BenchmarkFixture) -> None:
    """Time of the Nye tensor at each node."""

    def setup() -> tuple[tuple[gt.SampledFrame], dict[str, object]]:
        # A field computes it only once.
        return (noisy_field(holes=False),), {}

    assert np.isfinite(benchmark.pedantic(lambda field: field.nye, setup=setup, rounds=2)).all()


def test_a_lattice_image_of_a_megapixel(benchmark: BenchmarkFixture) -> None:
    """Time of spots, phases, coframe and a circuit from the pixels."""
    values = np.kron(np.ones((2, 2)), crystal(512, "square").values)

    def work() -> gt.materials.images.LatticeBurgers:
        phases = gt.LatticeImage(values).phases()
        assert np.isfinite(phases.coframe).any()
        return phases.burgers(gt.Loop.circle([256, 256], 100))

    assert benchmark.pedantic(work, rounds=2).whole.any()
