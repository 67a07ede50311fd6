"""A body thrown through the air: Bernoulli's relation between speed and direction.

python examples/scenes/thrown_body.py
python examples/scenes/thrown_body.py --t 6
"""

import argparse
import math

import numpy as np

import geomtorsion as gt

MASS, G, DRAG = 200 * 1e-3, 9.81, 4 * 1e-3


def main(arguments: list[str] | None = None) -> None:
    """The hodograph of 1719 holds all along, and the spin does not matter to the flight."""
    parser = argparse.ArgumentParser(description="A thrown spinning body.")
    parser.add_argument("--t", type=float, default=3.0, help="last time, s")
    options = parser.parse_args(arguments)
    scene = gt.Scene(
        gt.Body.box(MASS, (12 * 1e-2, 8 * 1e-2, 2 * 1e-2)),
        [gt.effects.Gravity(G), gt.effects.QuadraticDrag(DRAG), gt.effects.AngularDamping(1e-5)],
        gt.State(
            omega=(2 * math.pi, 2 * (2 * math.pi), 0.5),
            quaternion=(1, 0, 0, 0),
            position=(0, 0, 1.5),
            velocity=(43.2 * (1e3 / 3600), 0, 14.0),
        ),
        watch=["position", "velocity", "matrix", "omega", "energy"],
        t=3.0,
        name="thrown_body",
        title="thrown spinning body with drag",
    )
    assert scene == gt.scenes.load("thrown_body")

    result = scene.with_values(t=options.t).run()
    print(result)
    vx, vz = result["velocity"][:, 0], result["velocity"][:, 2]
    slope = vz / vx
    # 1 / vx^2 + (c / m g) (slope sqrt(1 + slope^2) + arsinh(slope)) is constant.
    bent = slope * np.sqrt(1 + slope**2) + np.arcsinh(slope)
    flat, steep = 1 / vx**2, DRAG / (MASS * G) * bent
    # On the way down both grow and cancel: what is left is known to the digits of the larger one.
    drift = np.abs((flat + steep - flat[0] - steep[0]) / flat).max()
    lost = result["energy"][0] - result["energy"][-1]
    print(f"Bernoulli's relation drifts by {drift:.1e}; the air has taken {lost:.3f} J")
    assert drift < 1e-9
    assert np.all(np.diff(result["energy"]) < 0)
    still = scene.with_values({"t": options.t, "start.omega": (0, 0, 0)}).run()
    assert np.abs(still["position"] - result["position"]).max() < 1e-8


if __name__ == "__main__":
    main()
