"""A rolling disc: at the right spin it rolls round in a circle, leaning.

python examples/scenes/rolling_disc.py
python examples/scenes/rolling_disc.py --turning 3
"""

import argparse
import math

import numpy as np

import geomtorsion as gt

MASS, RADIUS, G = 1, 30 * 1e-2, 9.81
LEAN = math.radians(60)


def steady_spin(turning: float) -> float:
    """The component Omega3 at which a disc rolls round the vertical with this rate, rad/s.

    (I3 + m r^2) W3 p sin = I1 p^2 sin cos - m g r cos, of the angle between axis and vertical.
    """
    across, along = MASS * RADIUS**2 / 4, MASS * RADIUS**2 / 2
    sine, cosine = math.sin(LEAN), math.cos(LEAN)
    weight = MASS * G * RADIUS * cosine
    whole = (along + MASS * RADIUS**2) * turning * sine
    return (across * turning**2 * sine * cosine - weight) / whole


def main(arguments: list[str] | None = None) -> None:
    """The lean stays what it is, and the centre goes round in a circle of known radius."""
    parser = argparse.ArgumentParser(description="A rolling disc.")
    parser.add_argument("--turning", type=float, default=2.0, help="round the vertical, rad/s")
    options = parser.parse_args(arguments)
    p, spin = options.turning, steady_spin(options.turning)
    scene = gt.Scene(
        gt.Body.cylinder(MASS, RADIUS, 0),
        [gt.effects.Gravity(G), gt.effects.Rolling(RADIUS)],
        gt.State(
            omega=(-p * math.sin(LEAN), 0, spin),
            euler=(0, LEAN, 0),
            position=(0, 0, RADIUS * math.sin(LEAN)),
        ),
        watch=["nutation", "position", "contact", "matrix", "energy"],
        t=6,
        name="rolling_disc",
        title="rolling disc",
    )
    shipped = gt.scenes.load("rolling_disc")
    assert scene.with_values(start=shipped.start) == shipped
    if p == 2:
        for name in ("omega", "position"):
            mine, theirs = (getattr(one.start, name) for one in (scene, shipped))
            assert np.allclose(mine, theirs, rtol=1e-14, atol=0)

    result = scene.run()
    print(result)
    lean = np.abs(result["nutation"] - LEAN).max()
    centre = result["position"][:, :2]
    # The centre moves with r |Omega3|; it goes round with p.
    radius = RADIUS * abs(spin / p)
    middle = centre[0] - radius * np.array([1.0, 0.0]) * np.sign(-spin * p)
    off = np.abs(np.linalg.norm(centre - middle, axis=1) - radius).max()
    print(
        f"the lean changes by {lean:.1e}; the centre keeps to a circle of {radius:.6f} m "
        f"by {off:.1e}"
    )
    assert lean < 1e-9
    assert off < 1e-9
    assert np.ptp(result["energy"]) < 1e-9


if __name__ == "__main__":
    main()
