"""Loops that fail to close: Burgers vectors of dislocations, of a twisted bar, of rotations.

    python examples/06_loops_that_fail_to_close.py
    python examples/06_loops_that_fail_to_close.py --radius 0.5 --picture loop.png

Follow a closed loop in coordinates and add up the steps that the frame measures: in a space with
torsion the sum is not zero. The gap is the Burgers vector b^i = integral of e^i_mu dq^mu. It is
computed twice, along the loop and as the flux of torsion through it.
"""

import argparse
from pathlib import Path

import sympy as sp

from geomtorsion import spaces
from geomtorsion.loops import Loop, burgers_vector, exact_burgers_vector


def show(name: str, loop: Loop, **parameters: float):
    """Compute the Burgers vector of one loop; print it with its check."""
    b = burgers_vector(spaces.load(name).frame, loop, parameters=parameters)
    print(f"{name}, {loop.name}: b = {b.vector.round(12)}, error {b.error:.0e}")
    print(f"    {b.reason}")
    print(f"    {b.check}")
    return b


def main(arguments: list[str] | None = None) -> None:
    """Compute dislocations, where b counts turns, and torsion everywhere, where b measures area."""
    parser = argparse.ArgumentParser(description="Burgers vectors of simple loops.")
    parser.add_argument("--radius", type=float, default=1.0, help="radius of the circles")
    parser.add_argument("--picture", type=Path, help="draw the loop on so3 into this file")
    options = parser.parse_args(arguments)
    radius = options.radius

    print("A screw dislocation: one turn around the axis is one step up, for a loop of any size.")
    circle = Loop.circle([0, 0, 0], radius)
    screw = show("screw_dislocation", circle, b=0.25)
    twice = show("screw_dislocation", circle.times(2), b=0.25)
    assert abs(screw.vector - [0, 0, 0.25]).max() < 1e-12
    assert abs(twice.vector - [0, 0, 0.5]).max() < 1e-12
    assert screw.check.agrees is False  # torsion is only on the axis: no flux

    print("\nAn edge dislocation: b counts turns again, now perpendicular to the line.")
    corners = [
        [radius, -radius, 0],
        [radius, radius, 0],
        [-radius, radius, 0],
        [-radius, -radius, 0],
    ]
    edge = show("edge_dislocation_elastic", Loop.polygon(corners), b=0.25, nu=0.3)
    assert abs(edge.vector - [0.25, 0, 0]).max() < 1e-11
    assert abs(edge.screw([0, 0, 1])).max() < 1e-11

    print("\nHeisenberg's group: b is the area of any curve; here of a trefoil.")
    trefoil = Loop.parametric(
        ["sin(s) + 2*sin(2*s)", "cos(s) - 2*cos(2*s)", "-sin(3*s)"],
        interval=(0, "2*pi"),
        name="trefoil",
    )
    knot = show("heisenberg", trefoil)
    assert abs(knot.vector[2] + trefoil.area[0, 1]) < 1e-11

    print("\nRotations in Euler angles: torsion everywhere, and a closed form.")
    b = show("so3", Loop.circle([0.3, 1.5, 0.2], radius))
    R = sp.Symbol("R", positive=True)
    formula = exact_burgers_vector(spaces.load("so3").frame, Loop.circle([0.3, 1.5, 0.2], R))
    print(f"    exactly b = {formula.vector}")
    assert b.check.agrees
    assert abs(b.vector - formula.at({"R": radius})).max() < 1e-13 * max(1, radius)

    if options.picture:
        from geomtorsion.pictures.loops import draw_closure

        draw_closure(b).savefig(options.picture)
        print(f"\nwrote {options.picture}")


if __name__ == "__main__":
    main()
