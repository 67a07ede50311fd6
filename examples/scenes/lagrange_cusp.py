"""Lagrange's top let go at rest: the tip of its axis draws cusps.

python examples/scenes/lagrange_cusp.py
python examples/scenes/lagrange_cusp.py --spin 150
"""

import argparse
import math

import numpy as np

import geomtorsion as gt

MASS, ARM, G = 0.5, 50 * 1e-3, 9.81


def cubic_of(start: float, push: float, spin: float, moments: tuple) -> tuple[list, list]:
    """From Lagrange's cubic: angles between which the axis nutates, rates about the vertical there.

    start: angle at which the axis neither rises nor falls; push: its rate about the vertical then;
    moments: about the point that is held, across the axis and along it.
    """
    across, along = moments
    u0, weight = math.cos(start), MASS * G * ARM
    axial = along * spin
    vertical = across * push * (1 - u0**2) + axial * u0
    energy = across * push**2 * (1 - u0**2) / 2 + weight * u0
    cubic = np.polymul(np.polymul([-2 * weight, 2 * energy], [-1, 0, 1]), [across])
    cubic = np.polysub(cubic, np.polymul([-axial, vertical], [-axial, vertical]))
    inside = sorted((float(u.real) for u in np.roots(cubic) if abs(u) <= 1), reverse=True)
    return (
        [math.acos(u) for u in inside],
        [(vertical - axial * u) / (across * (1 - u**2)) for u in inside],
    )


def main(arguments: list[str] | None = None) -> None:
    """Compare the angles between which the axis nutates with Lagrange's cubic."""
    parser = argparse.ArgumentParser(description="Lagrange's top with cusps.")
    parser.add_argument("--spin", type=float, default=1000 * (2 * math.pi / 60), help="rad/s")
    options = parser.parse_args(arguments)
    body = gt.Body.cylinder(MASS, 45 * 1e-3, 10 * 1e-3)
    push = 0.0
    scene = gt.Scene(
        body,
        [gt.effects.Gravity(G), gt.effects.Pivot((0, 0, ARM))],
        gt.State(omega=(0, 0, 1000 * (2 * math.pi / 60)), euler=(0, 0.5, 0)),
        watch=["nutation", "axis", "energy"],
        t=2,
        name="lagrange_cusp",
        title="Lagrange's top: cusps",
    )
    assert scene == gt.scenes.load("lagrange_cusp")

    print(scene.run())
    steiner = float(body.tensor[0, 0]) + MASS * ARM**2, float(body.tensor[2, 2])
    angles, rates = cubic_of(0.5, push, options.spin, steiner)
    spun = {"start.omega[2]": [options.spin]}
    sweep = scene.sweep(spun, ["min nutation", "max nutation"])
    found = [float(sweep[name][0]) for name in ("min nutation", "max nutation")]
    print(f"nutates from {found[0]:.10f} to {found[1]:.10f}")
    print(f"Lagrange:    {angles[0]:.10f} to {angles[1]:.10f}")
    print(f"round the vertical with {rates[0]:.6g} rad/s at the top, {rates[1]:.6g} at the bottom")
    assert np.abs(np.subtract(found, angles)).max() < 1e-8
    assert abs(rates[0]) < 1e-6 < rates[1], "at rest at the top: cusps"


if __name__ == "__main__":
    main()
