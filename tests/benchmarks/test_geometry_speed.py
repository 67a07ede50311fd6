"""Speed of geometry: all tensors of each case in a warm process, with a fresh frame in each run."""

from __future__ import annotations

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from tests.benchmarks.cases import NAMES, load
from tests.benchmarks.geometry import whole_geometry
from tests.benchmarks.point import at_point, kretschmann_at_point


@pytest.mark.parametrize("name", NAMES)
def test_whole_geometry(benchmark: BenchmarkFixture, name: str) -> None:
    """The timed work has the right Ricci tensor and Kretschmann scalar."""
    case = load(name)
    outcome = benchmark.pedantic(whole_geometry, args=(case,), rounds=10, warmup_rounds=1)
    assert outcome.ricci_is_zero == case.vacuum
    expected = kretschmann_at_point(case)
    assert abs(at_point(outcome.kretschmann) - expected) < 1e-18 * abs(expected)
