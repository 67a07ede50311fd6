"""A heavy top falls or not: a map over its first angle and its spin, against a closed form.

    python examples/45_a_top_that_falls_or_not.py
    python examples/45_a_top_that_falls_or_not.py --picture falls.png

Each start is a motion that ends at its own time. Starts whose end depends on the error are marked.
"""

import argparse
from pathlib import Path

import numpy as np

import geomtorsion as gt

# theta = q + y for a top released at rest from theta = q, with the spin b; moment of inertia and
# weight times length are one. The momentum of phi is b*cos(q).
RATES = {
    "y": "w",
    "w": "sin(q + y) + b**2*(cos(q) - cos(q + y))*(cos(q)*cos(q + y) - 1)/sin(q + y)**3",
}


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="A top that falls or not")
    parser.add_argument("--picture", type=Path, help="file for a figure")
    options = parser.parse_args(arguments)

    floor = gt.When("pi/2 - q - y")
    top = gt.ODE.of(RATES, [0, 0], parameters={"q": 1, "b": 1}, events=[floor])
    angles, spins = np.linspace(0.2, 1.4, 60), np.linspace(0.3, 3.0, 60)
    ends = gt.end_map(top, {"q": angles, "b": spins}, 20.0)
    print(ends)

    # The lowest angle of the nutation is below the floor if b^2 cos(q) < 2.
    falls = spins[:, None] ** 2 * np.cos(angles) < 2
    decided = ~ends.undecided
    assert np.array_equal((ends.fate == 0)[decided], falls[decided])
    assert decided.mean() > 0.99
    if options.picture:
        gt.pictures.save(ends.plot(), options.picture)


if __name__ == "__main__":
    main()
