"""Speed of loops: one loop to 1e-12 in a millisecond, a hundred thousand to 1e-10 in 5 s."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture
from scipy.integrate import quad

from geomtorsion.loops import (
    BurgersVector,
    Loop,
    burgers_vector,
    burgers_vectors,
    parallel_screws,
)
from geomtorsion.loops.forms import forms
from geomtorsion.loops.integrals import line_at
from geomtorsion.spaces import load

CENTRE = [0.3, 1.0, 0.2]
ONE_LOOP = 1e-3
MANY_LOOPS = 5.0


def best(benchmark: Any) -> float:
    """The shortest time of all runs, in seconds."""
    return benchmark.stats.stats.min


@pytest.mark.parametrize("radius", [0.3, 1e-3, 1e-12])
def test_one_loop(benchmark: BenchmarkFixture, radius: float) -> None:
    """One compiled loop on so3 to 1e-12, with both methods and their comparison, in 1 ms."""
    frame, loop = load("so3").frame, Loop.circle(CENTRE, radius)
    found = benchmark.pedantic(
        burgers_vector, args=(frame, loop), rounds=50, warmup_rounds=3, iterations=1
    )
    assert found.reached
    assert found.check.agrees
    assert best(benchmark) < ONE_LOOP


def test_one_loop_by_scipy(benchmark: BenchmarkFixture) -> None:
    """Time of scipy's adaptive quadrature of the line integral, without any check."""
    frame = load("so3").frame
    loop = Loop.circle(CENTRE, 0.3)
    part, compiled = loop.parts[0], forms(frame, None)
    (side,) = part.arcs

    def components() -> list[float]:
        return [
            part.size
            * quad(
                lambda s, i=i: line_at(compiled, part, *side.shape(np.array([s])))[i, 0],
                0,
                1,
                epsabs=1e-13,
            )[0]
            for i in range(3)
        ]

    found = benchmark.pedantic(components, rounds=5, warmup_rounds=1)
    assert found == pytest.approx(burgers_vector(frame, loop).vector, abs=1e-12)


def test_a_hundred_thousand_loops(benchmark: BenchmarkFixture) -> None:
    """A hundred thousand circles on so3 with radii from 1e-12 to 0.3, each to 1e-10, in 5 s."""
    rng = np.random.default_rng(1)
    count = 100_000
    centres = rng.uniform([0, 0.5, 0], [6, 2.6, 6], (count, 3))
    radii = 10 ** rng.uniform(-12, -0.5, count)
    frame = load("so3").frame
    found = benchmark.pedantic(
        burgers_vectors, args=(frame, centres, radii), rounds=3, warmup_rounds=1
    )
    assert found.complete
    assert found.reached.all()
    assert best(benchmark) < MANY_LOOPS
    for k in range(0, count, 9973):
        b = burgers_vector(frame, Loop.circle(centres[k], radii[k]), 1e-13)
        assert np.abs(found.vectors[:, k] - b.vector).max() <= 1e-10 * np.abs(b.vector).max()


@pytest.mark.parametrize(("lines", "seconds"), [(14, 1.0), (40, 1.0), (1000, 10.0)])
def test_a_circle_around_many_screws(
    benchmark: BenchmarkFixture, lines: int, seconds: float
) -> None:
    """Time from positions to the vector and the enclosed lines, with frame and compilation."""
    rng = np.random.default_rng(lines)
    places = list(dict.fromkeys(map(tuple, rng.integers(0, 10**6, (lines, 2)).tolist())))
    exact = [(Fraction(x, 10**6), Fraction(y, 10**6)) for x, y in places]
    loop = Loop.circle([0.5, 0.5, 0], 3)

    def measured() -> BurgersVector:
        found = burgers_vector(parallel_screws(exact, [1] * lines), loop)
        assert len(found.enclosed) == lines
        return found

    found = benchmark.pedantic(measured, rounds=3, warmup_rounds=1)
    assert abs(found.vector[2] - lines) <= found.error
    assert best(benchmark) < seconds
