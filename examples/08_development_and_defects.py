"""Development and defects: roll a loop out; what is missing is a step (Burgers) and a turn (Frank).

    python examples/08_development_and_defects.py
    python examples/08_development_and_defects.py --alpha 3/4 --step 0.2 --picture rolled.png

Cut a wedge out of a crystal, lift one face by a step and join them: a dispiration. Away from the
line the crystal is perfect: its metric is flat, no torsion, no curvature. And yet a loop about the
line comes back turned and moved, by the same screw motion whatever its shape. On a sphere the
opposite: nothing is singular, the turn is the area.
"""

import argparse
import math
from fractions import Fraction
from pathlib import Path

import sympy as sp

import geomtorsion as gt
from geomtorsion.loops import Loop, develop, develop_path, dispiration


def crystal_with_a_line(alpha: Fraction, step: Fraction, picture: Path | None) -> None:
    """Three loops about a dispiration, and one next to it."""
    crystal = gt.levi_civita(dispiration(alpha, step))
    print(f"flat: {crystal.is_flat}, torsion-free: {crystal.is_torsion_free}")
    loops = {
        "a circle": Loop.circle([0, 0, 0], 1),
        "a long ellipse": Loop.ellipse([0.5, -0.2, 3], (4, 1)),
        "a crooked polygon": Loop.polygon([[1, -1, 0], [2, 3, 1], [-1, 1, -2], [-1, -0.5, 0]]),
        "a circle next to it": Loop.circle([5, 0, 0], 1),
    }
    for name, loop in loops.items():
        turn = develop(crystal, loop)
        print(f"\n{name}: {turn.check.text}")
        print(f"  b = {turn.burgers.round(12)} +- {turn.error:.0e}")
        print(f"  turned by {math.degrees(turn.angle):.10f} degrees")
        if turn.enclosed:
            print(f"  moved along the axis of the turn by {abs(turn.along_axis):.12f}")
            # The wedge is missing (alpha < 1) or too much (alpha > 1); turns count from 0 to pi.
            assert abs(turn.angle - abs(2 * math.pi * float(1 - alpha))) < 1e-11
            assert abs(abs(turn.along_axis) - abs(float(step))) < 1e-11
        else:
            assert abs(turn.motion.increment).max() < 1e-12
    circle = develop(crystal, loops["a circle"])
    chord = 2 * math.sin(math.pi * float(abs(1 - alpha)))
    assert abs(math.hypot(*circle.burgers[:2]) - chord) < 1e-12
    if picture is not None:
        from geomtorsion.pictures.development import draw_development

        draw_development(crystal, loops["a circle"]).savefig(picture, dpi=150)
        print(f"\n{picture} written")


def sphere_without_any() -> None:
    """On the sphere the turn is the area, at every size; the step is of third order."""
    theta, phi = sp.symbols("theta phi", real=True)
    sphere = gt.levi_civita(gt.Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]], name="sphere"))
    print("\nradius    turn / area              |b| / radius^3      route")
    for radius in (0.5, 1e-3, 1e-8, 1e-13):
        square = Loop.plaquette([1 - radius / 2, 0.3], (radius, radius))
        turn = develop(sphere, square)
        # cos(1 - r/2) - cos(1 + r/2) = 2 sin(1) sin(r/2), which cancels nothing.
        area = radius * 2 * math.sin(1) * math.sin(radius / 2)
        gap = float(abs(turn.burgers).max()) / radius**3
        print(f"{radius:6.0e}    {turn.angle / area:.16f}       {gap:.12f}      {turn.route}")
        assert abs(turn.angle / area - 1) < 4e-15
    # From another corner of the same square: conjugated by the path to it, the same turn.
    corners = [[1.0, 0.0], [1.4, 0.0], [1.4, 0.5], [1.0, 0.5]]
    here, there = (develop(sphere, Loop.polygon(corners[k:] + corners[:k])) for k in (0, 1))
    path = develop_path(sphere, corners[:2])
    print(f"\nfrom one corner b = {here.burgers}, from the next b = {there.burgers}")
    assert abs(here.seen_from(path).burgers - there.burgers).max() < 1e-15


def main(arguments: list[str] | None = None) -> None:
    """Develop loops about a line, next to it, and on a sphere."""
    parser = argparse.ArgumentParser(description="Loops that come back turned and moved.")
    parser.add_argument("--alpha", type=Fraction, default=Fraction(5, 6), help="angle that is left")
    parser.add_argument("--step", type=Fraction, default=Fraction(3, 10), help="lift of the face")
    parser.add_argument("--picture", type=Path, help="draw the rolled-out circle into this file")
    options = parser.parse_args(arguments)
    if not Fraction(1, 2) < options.alpha < Fraction(3, 2):
        parser.error("alpha must lie between 1/2 and 3/2, so that the turn is less than half")
    crystal_with_a_line(options.alpha, options.step, options.picture)
    sphere_without_any()
    assert gt.levi_civita(dispiration(options.alpha, options.step)).is_flat


if __name__ == "__main__":
    main()
