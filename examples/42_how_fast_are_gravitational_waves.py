"""How fast are gravitational waves: their speed in a theory, over the life of a cosmos.

    python examples/42_how_fast_are_gravitational_waves.py
    python examples/42_how_fast_are_gravitational_waves.py --picture speed.png

A scalar field that couples to the Gauss-Bonnet term changes the speed of gravitational waves:
c_T^2 = (1 + 8 c phi'')/(1 + 8 c H phi') for L = R/2 - X/2 + c phi GB (Kobayashi, Yamaguchi and
Yokoyama 2011). Since 2017 it is known to be the speed of light to 10^-15 today.
"""

import argparse
from pathlib import Path

import numpy as np

from geomtorsion import pictures
from geomtorsion.gravity import perturbed


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="How fast are gravitational waves.")
    parser.add_argument("--picture", type=Path, help="file for a figure")
    options = parser.parse_args(arguments)

    waves = perturbed.tensor_modes("R/2 - X/2 + c*phi*GB", "riemannian", scalars="phi")
    print(waves)
    times = np.linspace(1, 10, 100)
    evolution = waves.over_time(times, a="t**(1/2)", phi="t", c="1/10")
    print(evolution)
    # H = 1/(2 t), phi' = 1.
    exact = 1 / (1 + 0.4 / times)
    error = np.abs(evolution.values["speed2"] - exact).max()
    print(f"largest difference to the closed form: {error:.1e}")
    assert error < 8 * np.finfo(float).eps

    print("\nA theory with a further mode:")
    higher = perturbed.tensor_modes("R/2 - X/2 + c*Box(phi)**2", "riemannian", scalars="phi")
    print(higher)
    assert higher.time_orders.orders["phi"] == 4
    if options.picture:
        pictures.save(evolution.plot(), options.picture)


if __name__ == "__main__":
    main()
