"""Lagrange's top let go at rest, pushed back, pushed on: cusps, loops, waves.

python examples/scenes/lagrange_nutation.py
python examples/scenes/lagrange_nutation.py --spin 150
"""

import argparse
import math

import numpy as np

import geomtorsion as gt

MASS, ARM, G = 0.5, 50 * 1e-3, 9.81
SPIN = 1000 * (2 * math.pi / 60)
# What the tip draws: shipped scene, title, rate about the vertical at the start.
KINDS = (
    ("lagrange_cusp", "cusps", 0.0),
    ("lagrange_loop", "loops", -4.0),
    ("lagrange_wave", "waves", 2.0),
)


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


def nutation(name: str, drawn: str, push: float, spin: float) -> float:
    """How far the angles between which the axis nutates are from Lagrange's cubic."""
    body = gt.Body.cylinder(MASS, 45 * 1e-3, 10 * 1e-3)
    scene = gt.Scene(
        body,
        [gt.effects.Gravity(G), gt.effects.Pivot((0, 0, ARM))],
        gt.State(omega=(-push * math.sin(0.5), 0, SPIN), euler=(0, 0.5, 0)),
        watch=["nutation", "axis", "energy"],
        t=2,
        name=name,
        title=f"Lagrange's top: {drawn}",
    )
    assert scene == gt.scenes.load(name)

    print(scene.run())
    steiner = float(body.tensor[0, 0]) + MASS * ARM**2, float(body.tensor[2, 2])
    angles, rates = cubic_of(0.5, push, spin, steiner)
    sweep = scene.sweep({"start.omega[2]": [spin]}, ["min nutation", "max nutation"])
    found = [float(sweep[name][0]) for name in ("min nutation", "max nutation")]
    print(f"nutates from {found[0]:.10f} to {found[1]:.10f}")
    print(f"Lagrange:    {angles[0]:.10f} to {angles[1]:.10f}")
    print(f"round the vertical with {rates[0]:.6g} rad/s at the top, {rates[1]:.6g} at the bottom")
    # At rest, backwards or forwards at the top; forwards at the bottom.
    assert abs(rates[0]) < 1e-6 if push == 0 else rates[0] * push > 0, drawn
    assert rates[1] > 1e-6
    return float(np.abs(np.subtract(found, angles)).max())


def main(arguments: list[str] | None = None) -> None:
    """One motion of each kind."""
    parser = argparse.ArgumentParser(description="Lagrange's top with cusps, loops and waves.")
    parser.add_argument("--spin", type=float, default=SPIN, help="rad/s")
    options = parser.parse_args(arguments)
    gaps = [nutation(name, drawn, push, options.spin) for name, drawn, push in KINDS]
    assert max(gaps) < 1e-8
    assert len(KINDS) == 3


if __name__ == "__main__":
    main()
