"""A sleeping top: upright and fast, it is not put off by a push; slow, it falls.

python examples/scenes/sleeping_top.py
python examples/scenes/sleeping_top.py --spin 90
"""

import argparse
import math

import geomtorsion as gt

MASS, ARM, G = 0.5, 50 * 1e-3, 9.81


def largest_tilt(push: float, spin: float, across: float, along: float) -> float:
    """How far a top that starts upright with a push (rad/s) across its axis leaves the vertical.

    Energy with the vertical angular momentum equal to the axial one: a quadratic equation in
    u = cos(theta), (I3 spin)^2 (1 - u) = (1 + u) (I1^2 push^2 + 2 I1 m g l (1 - u)).
    """
    a, b, c = (along * spin) ** 2, (across * push) ** 2, 2 * across * MASS * G * ARM
    # c u^2 - (a + b) u + (a - b - c) = 0
    root = math.sqrt((a + b) ** 2 - 4 * c * (a - b - c))
    return math.acos((a + b - root) / (2 * c))


def main(arguments: list[str] | None = None) -> None:
    """Compare the largest tilt with its closed form, above and below the limit of sleep."""
    parser = argparse.ArgumentParser(description="A sleeping top.")
    parser.add_argument("--spin", type=float, default=1000 * (2 * math.pi / 60), help="rad/s")
    options = parser.parse_args(arguments)
    body = gt.Body.cylinder(MASS, 45 * 1e-3, 10 * 1e-3)
    scene = gt.Scene(
        body,
        [gt.effects.Gravity(G), gt.effects.Pivot((0, 0, ARM))],
        gt.State(omega=(1, 0, 1000 * (2 * math.pi / 60)), euler=(0, 0, 0)),
        watch=["nutation", "axis", "energy"],
        t=4,
        name="sleeping_top",
        title="sleeping top",
    )
    assert scene == gt.scenes.load("sleeping_top")

    print(scene.run())
    across, along = float(body.tensor[0, 0]) + MASS * ARM**2, float(body.tensor[2, 2])
    limit = 2 * math.sqrt(MASS * G * ARM * across) / along
    spins = [options.spin, 1.05 * limit, 0.95 * limit]
    sweep = scene.sweep({"start.omega[2]": spins}, "max nutation")
    print(f"it sleeps above {limit:.4f} rad/s")
    for spin, tilt in zip(spins, sweep["max nutation"], strict=True):
        known = largest_tilt(1, spin, across, along)
        print(f"{spin:9.4f} rad/s: leaves the vertical by {tilt:.9f}, in closed form {known:.9f}")
        assert abs(tilt - known) < 1e-7
    assert sweep["max nutation"][0] < 0.2 < sweep["max nutation"][2]


if __name__ == "__main__":
    main()
