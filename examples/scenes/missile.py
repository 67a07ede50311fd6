"""A missile whose engine pushes askew: it turns over, unless it spins.

    python examples/scenes/missile.py
    python examples/scenes/missile.py --spin 2

Thrust and its moment are constant in the frame of the body. There Omega1 + i Omega2 obeys a linear
equation, which is why the paper mentions missiles.
"""

import argparse
import math

import numpy as np

import geomtorsion as gt


def main(arguments: list[str] | None = None) -> None:
    """Compare the rates with their closed form, and the flight with that without spin."""
    parser = argparse.ArgumentParser(description="A spin-stabilised missile.")
    parser.add_argument("--spin", type=float, default=5.0, help="turns per second")
    options = parser.parse_args(arguments)
    body = gt.Body.cylinder(50, 12 * 1e-2, 2)
    scene = gt.Scene(
        body,
        [gt.effects.Thrust(force=(40, 0, 5 * 1e3), point=(0, 0, -1), end=3)],
        gt.State(
            omega=(0, 0, 5 * (2 * math.pi)),
            euler=(0, math.radians(30), 0),
            position=(0, 0, 0),
            velocity=(0, 0, 0),
        ),
        watch=["position", "velocity", "axis", "omega"],
        t=5,
        name="missile",
        title="spin-stabilised missile",
    )
    assert scene == gt.scenes.load("missile")

    spin = options.spin * 2 * math.pi
    result = scene.with_values({"start.omega[2]": spin}).run()
    print(result)
    across, along = float(body.tensor[0, 0]), float(body.tensor[2, 2])
    # w' = i r w + i M / I1 with w = Omega1 + i Omega2, r = (I3 - I1) / I1 * spin, M = -40 N m.
    r, push = (along - across) / across * spin, -40 / across
    t = result.times
    lit = np.minimum(t, 3)
    burning = 1j * push * lit if r == 0 else push / r * (np.exp(1j * r * lit) - 1)
    rates = burning * np.exp(1j * r * np.maximum(t - 3, 0))
    gap = np.abs(result["omega"][:, 0] + 1j * result["omega"][:, 1] - rates).max()

    def off_course(run: gt.scenes.SceneResult) -> float:
        """Degrees between where it was aimed and where it has got to."""
        aim = np.array([math.sin(math.radians(30)), 0, math.cos(math.radians(30))])
        place = run["position"][-1]
        return math.degrees(math.acos(float(aim @ place) / float(np.linalg.norm(place))))

    spun = off_course(result)
    unspun = off_course(scene.with_values({"start.omega[2]": 0}).run())
    print(f"rates agree with the closed form to {gap:.1e} rad/s")
    print(f"off course by {spun:.2f} degrees spinning, by {unspun:.2f} without spin")
    assert gap < 1e-8
    assert spin == 0 or spun < 0.5 * unspun


if __name__ == "__main__":
    main()
