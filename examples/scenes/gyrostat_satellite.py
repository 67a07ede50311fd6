"""A gyrostat satellite: pulled upright by the tide, steadied by a wheel.

python examples/scenes/gyrostat_satellite.py
python examples/scenes/gyrostat_satellite.py --orbits 5
"""

import argparse
import math

import numpy as np
from scipy.special import ellipk

import geomtorsion as gt

RATE = 2 * math.pi / 95 * (1 / 60)


def main(arguments: list[str] | None = None) -> None:
    """Jacobi's integral, and the period of swinging in the plane of the orbit."""
    parser = argparse.ArgumentParser(description="A gyrostat satellite.")
    parser.add_argument("--orbits", type=float, default=2.0, help="how many orbits to follow")
    options = parser.parse_args(arguments)
    scene = gt.Scene(
        gt.Body(mass=100, moments=(6, 8, 10)),
        [gt.effects.GravityGradient(RATE), gt.effects.Rotor((0, 0, 1), momentum=0.05)],
        gt.State(
            omega=(0, 0, RATE),
            euler=(math.radians(4), math.radians(3), math.radians(10)),
            euler_convention="xyz",
        ),
        watch=["omega", "matrix", "vertical", "energy", "angular_momentum_space"],
        t=190 * 60.0,
        name="gyrostat_satellite",
        title="gyrostat satellite in a gravity gradient",
    )
    shipped = gt.scenes.load("gyrostat_satellite")
    assert scene == shipped.with_values({"gravity_gradient.rate": RATE, "start.omega[2]": RATE})
    gradient = shipped.keyed["gravity_gradient"]
    assert isinstance(gradient, gt.effects.GravityGradient)
    assert math.isclose(float(gradient.rate), RATE, rel_tol=1e-15)

    result = scene.with_values(t=options.orbits * 95 * 60).run()
    print(result)
    # The field turns with the orbit: energy alone is not conserved, energy - n L_z is.
    turning = RATE * result["angular_momentum_space"][:, 2]
    jacobi = result["energy"] - turning
    drift = np.ptp(jacobi) / np.abs(turning).max()
    print(
        f"energy varies by {np.ptp(result['energy']):.2e} J, energy - n L_z by {drift:.1e} of n L_z"
    )

    # In the plane of the orbit it is a pendulum in twice the angle, wheel or no wheel.
    pitch = math.radians(25)
    swing = scene.with_values(
        {
            "start.euler": (0, 0, pitch),
            "watch": ("matrix",),
            "t": 3 * 95 * 60,
            "samples": 4001,
        }
    ).run()
    matrix = swing["matrix"].reshape(-1, 3, 3)
    angle = np.arctan2(matrix[:, 1, 0], matrix[:, 0, 0]) - RATE * swing.times
    angle = np.remainder(angle + np.pi, 2 * np.pi) - np.pi
    change = np.flatnonzero(angle[1:] * angle[:-1] < 0)
    share = angle[change] / (angle[change] - angle[change + 1])
    zeros = swing.times[change] + share * np.diff(swing.times)[0]
    found = 2 * np.diff(zeros).mean()
    known = 4 * ellipk(math.sin(pitch) ** 2) / (RATE * math.sqrt(3 * (8 - 6) / 10))
    print(f"it swings in {found / 60:.4f} min, by the elliptic integral {known / 60:.4f} min")
    assert drift < 1e-10
    assert abs(found / known - 1) < 1e-5


if __name__ == "__main__":
    main()
