"""Tiny loops: the sum along the loop loses digits, and the flux keeps them.

    python examples/07_tiny_loops.py
    python examples/07_tiny_loops.py --smallest 300 --map density.png

A loop of radius r has a Burgers vector of order r^2, but the terms of the sum along it are of order
r, so in floating point each decade costs a digit. The flux of the exact curl of the coframe loses
none. Then a hundred thousand loops are computed at once and compared with 2 S A.
"""

import argparse
from pathlib import Path

import mpmath
import numpy as np

from geomtorsion import spaces
from geomtorsion.loops import Loop, burgers_map, burgers_vector, burgers_vectors

CENTRE = [0.3, 1.0, 0.2]


def bessel(radius: float) -> list[mpmath.mpf]:
    """The closed form on so3 in the plane of phi1 and phi2, with 50 digits."""
    size = mpmath.mpf(radius)
    length = 2 * mpmath.pi * size * mpmath.besselj(1, size)
    return [length * mpmath.cos(CENTRE[0]), -length * mpmath.sin(CENTRE[0]), mpmath.mpf(0)]


def relative(found: np.ndarray, exact: list[mpmath.mpf]) -> float:
    """Largest error divided by the largest component."""
    errors = [abs(mpmath.mpf(x) - y) for x, y in zip(found.tolist(), exact, strict=True)]
    return float(max(errors) / max(map(abs, exact)))


def main(arguments: list[str] | None = None) -> None:
    """Print a table of radii, then compute a survey."""
    parser = argparse.ArgumentParser(description="Burgers vectors of tiny loops.")
    parser.add_argument("--smallest", type=int, default=12, help="smallest radius is 10**-SMALLEST")
    parser.add_argument("--map", type=Path, help="draw the density of b into this file")
    options = parser.parse_args(arguments)

    frame = spaces.load("so3").frame
    print("radius    error of the line    error of the result   estimate")
    with mpmath.workdps(50):
        for decade in range(1, min(options.smallest, 150) + 1):
            radius = 10.0**-decade
            b = burgers_vector(frame, Loop.circle(CENTRE, radius))
            exact = bessel(radius)
            along, best = relative(b.check.line, exact), relative(b.vector, exact)
            print(f"1e-{decade:<6} {along:12.0e} {best:20.0e} {b.relative_error:18.0e}")
            assert best < 1e-14
            assert best <= 10 * b.relative_error

    smallest = burgers_vector(frame, Loop.circle(CENTRE, 1e-300))
    print(f"radius 1e-300: b = {[mpmath.nstr(x, 12) for x in smallest.numbers]}")

    rng = np.random.default_rng(1)
    centres = rng.uniform([0, 0.5, 0], [6, 2.6, 6], (100_000, 3))
    survey = burgers_vectors(frame, centres, 10 ** rng.uniform(-12, -1, 100_000))
    print(f"\n{survey}: accuracy {survey.accuracy:g} reached by all: {survey.reached.all()}")
    tiny = survey.areas < 1e-12
    difference = abs(survey.vectors - survey.expected).max(axis=0)[tiny]
    print(
        f"b and 2 S A differ by {(difference / survey.areas[tiny]).max():.0e} for radii below 1e-6"
    )
    assert survey.reached.all()
    assert (difference < 1e-11 * survey.areas[tiny]).all()

    core = spaces.load("screw_core").frame
    grid = np.linspace(-1, 1, 42)
    density = burgers_map(core, (grid, grid), parameters={"b": 1, "c": 0.3})
    print(f"a screw with a soft core: {density}, total b = {density.total.round(12)}")
    outline = Loop.polygon([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    whole = burgers_vector(core, outline, parameters={"b": 1, "c": 0.3})
    assert abs(density.total - whole.vector).max() < 1e-10
    if options.map:
        from geomtorsion.pictures.loops import draw_map

        draw_map(density).savefig(options.map)
        print(f"wrote {options.map}")


if __name__ == "__main__":
    main()
