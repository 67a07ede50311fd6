"""Speed of mechanics: equations of motion from a Lagrangian, warm, beside sympy's method.

    pytest tests/benchmarks/test_action_speed.py

The goals are so3 in 50 ms, r3xso3 in 0.5 s, six dimensions with a potential in 2 s.
"""

from __future__ import annotations

import pytest
import sympy as sp
from pytest_benchmark.fixture import BenchmarkFixture
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

from tests.benchmarks.action import CASES, MOMENTS, derived, whole


@pytest.mark.parametrize("name", CASES)
def test_equations_of_motion(benchmark: BenchmarkFixture, name: str) -> None:
    """Time of Boltzmann and Hamel, solved for the accelerations; each run has a fresh frame."""
    found = benchmark.pedantic(
        derived, setup=lambda: ((CASES[name](),), {}), rounds=10, warmup_rounds=1
    )
    assert len(found.hamel.accelerations) == len(found.velocities)


@pytest.mark.parametrize("name", CASES)
def test_with_proof_and_invariants(benchmark: BenchmarkFixture, name: str) -> None:
    """Time of all steps: equations in sympy, proof of Euler and Lagrange, proved invariants."""
    found = benchmark.pedantic(
        whole, setup=lambda: ((CASES[name](),), {}), rounds=3, warmup_rounds=1
    )
    assert found.agrees is True


def test_lagranges_method_of_sympy(benchmark: BenchmarkFixture) -> None:
    """Time of sympy.physics.mechanics for so3 in angles, up to M q'' = f, not solved."""

    def formed() -> LagrangesMethod:
        angles = dynamicsymbols("phi1 phi2 phi3")
        rates = dynamicsymbols("phi1 phi2 phi3", 1)
        (one, two, _), (v1, v2, v3) = angles, rates
        omega = (
            sp.sin(one) * v2 - sp.cos(one) * sp.sin(two) * v3,
            sp.cos(one) * v2 + sp.sin(one) * sp.sin(two) * v3,
            v1 + sp.cos(two) * v3,
        )
        energy = sum(i * w**2 for i, w in zip(MOMENTS, omega, strict=True)) / 2
        method = LagrangesMethod(energy, list(angles))
        method.form_lagranges_equations()
        return method

    method = benchmark.pedantic(formed, rounds=5, warmup_rounds=1)
    assert method.mass_matrix.shape == (3, 3)
