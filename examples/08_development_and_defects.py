"""Development and defects: a rolled-out loop shows a step (Burgers) and a rotation (Frank).

    python examples/08_development_and_defects.py
    python examples/08_development_and_defects.py --alpha 3/4 --step 0.2 --picture rolled.png

Cut a wedge out of a crystal, lift one face by a step and join them: a dispiration. Away from the
line the crystal is perfect: its metric is flat, without torsion and curvature. Still, a loop around
the line comes back rotated and moved, by the same screw motion for every shape of the loop. The
sphere shows the opposite: nothing is singular, and the angle of rotation is the area.
"""

import argparse
import math
from fractions import Fraction
from pathlib import Path

import sympy as sp

import geomtorsion as gt
from geomtorsion.loops import Loop, develop, develop_path, dispiration


def crystal_with_a_line(alpha: Fraction, step: Fraction, picture: Path | None) -> None:
    """Develop three loops around a dispiration, and one beside it."""
    crystal = gt.levi_civita(dispiration(alpha, step))
    print(f"flat: {crystal.is_flat}, torsion-free: {crystal.is_torsion_free}")
    loops = {
        "a circle": Loop.circle([0, 0, 0], 1),
        "a long ellipse": Loop.ellipse([0.5, -0.2, 3], (4, 1)),
        "a crooked polygon": Loop.polygon([[1, -1, 0], [2, 3, 1], [-1, 1, -2], [-1, -0.5, 0]]),
        "a circle beside it": Loop.circle([5, 0, 0], 1),
    }
    for name, loop in loops.items():
        turn = develop(crystal, loop)
        print(f"\n{name}: {turn.check.text}")
        print(f"  b = {turn.burgers.round(12)} +- {turn.error:.0e}")
        print(f"  rotated by {math.degrees(turn.angle):.10f} degrees")
        if turn.enclosed:
            print(f"  moved along the axis of rotation by {abs(turn.along_axis):.12f}")
            # The wedge is removed (alpha < 1) or inserted (alpha > 1); angles run from 0 to pi.
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
    """On the sphere the rotation angle is the area at each size; the step is of third order."""
    theta, phi = sp.symbols("theta phi", real=True)
    sphere = gt.levi_civita(gt.Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]], name="sphere"))
    print("\nradius    angle / area             |b| / radius^3      route")
    for radius in (0.5, 1e-3, 1e-8, 1e-13):
        square = Loop.plaquette([1 - radius / 2, 0.3], (radius, radius))
        turn = develop(sphere, square)
        # cos(1 - r/2) - cos(1 + r/2) = 2 sin(1) sin(r/2), which has no cancellation.
        area = radius * 2 * math.sin(1) * math.sin(radius / 2)
        gap = float(abs(turn.burgers).max()) / radius**3
        print(f"{radius:6.0e}    {turn.angle / area:.16f}       {gap:.12f}      {turn.route}")
        assert abs(turn.angle / area - 1) < 4e-15
    # From another corner of the square the rotation is the same, conjugated by the path to it.
    corners = [[1.0, 0.0], [1.4, 0.0], [1.4, 0.5], [1.0, 0.5]]
    here, there = (develop(sphere, Loop.polygon(corners[k:] + corners[:k])) for k in (0, 1))
    path = develop_path(sphere, corners[:2])
    print(f"\nfrom one corner b = {here.burgers}, from the next b = {there.burgers}")
    assert abs(here.seen_from(path).burgers - there.burgers).max() < 1e-15


def main(arguments: list[str] | None = None) -> None:
    """Develop loops around a line, beside it, and on a sphere."""
    parser = argparse.ArgumentParser(description="Loops that come back rotated and moved.")
    parser.add_argument("--alpha", type=Fraction, default=Fraction(5, 6), help="remaining angle")
    parser.add_argument("--step", type=Fraction, default=Fraction(3, 10), help="lift of the face")
    parser.add_argument("--picture", type=Path, help="draw the rolled-out circle into this file")
    options = parser.parse_args(arguments)
    if not Fraction(1, 2) < options.alpha < Fraction(3, 2):
        parser.error(f"expected alpha between 1/2 and 3/2, got {options.alpha}. Give another value")
    crystal_with_a_line(options.alpha, options.step, options.picture)
    sphere_without_any()
    assert gt.levi_civita(dispiration(options.alpha, options.step)).is_flat


if __name__ == "__main__":
    main()
