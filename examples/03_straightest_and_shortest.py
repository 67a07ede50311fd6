"""Straightest and shortest: where the two paths differ, and the force that separates them.

    python examples/03_straightest_and_shortest.py
    python examples/03_straightest_and_shortest.py --spin 0 0 2 --speed 1 0 0

A rigid body starts with a spin and a velocity, both given in body axes. The straightest motion
keeps both constant in the body: a screw. The shortest motion keeps the velocity constant in space:
a straight flight while the body rotates. The torsion of the frame causes the difference.
"""

import argparse

import numpy as np

import geomtorsion as gt
from geomtorsion.curves import autoparallel, distance_apart, geodesic
from geomtorsion.ode import solve


def main(arguments: list[str] | None = None) -> None:
    """Solve both to the requested accuracy and compare with the closed forms."""
    parser = argparse.ArgumentParser(description="A rigid body, straightest and shortest.")
    parser.add_argument("--spin", type=float, nargs=3, default=[0.3, 0.5, -0.2])
    parser.add_argument("--speed", type=float, nargs=3, default=[1.0, 0.0, 0.5])
    parser.add_argument("--time", type=float, default=4.0)
    parser.add_argument("--accuracy", type=float, default=1e-10)
    options = parser.parse_args(arguments)

    frame = gt.spaces.load("r3xso3").frame  # coordinates: three Euler angles, then x, y, z
    start = [0.3, 1.0, 0.2, 0.0, 0.0, 0.0]
    u = [*options.spin, *options.speed]
    straightest = autoparallel(gt.cartan(frame), start, frame_velocity=u)
    shortest = geodesic(frame, start, frame_velocity=u)
    print(straightest)
    print(shortest)

    # The accuracy is the accuracy of the result, not of a single step.
    screw = solve(straightest, options.time, options.accuracy)
    flight = solve(shortest, options.time, options.accuracy)
    print(f"\n{screw}\n\n{flight}\n")

    apart = distance_apart(screw, flight)
    print("   t   distance  screw x, y, z            flight x, y, z")
    for k in range(0, len(screw.times), 16):
        one, two = screw.coordinates[k, 3:].round(4), flight.coordinates[k, 3:].round(4)
        print(f"{screw.times[k]:5.2f}  {apart[k]:8.3f}  {one!s:24} {two!s}")

    # Known: the flight is a straight line with the velocity of the body at the start.
    line = flight.times[:, None] * flight.velocity[0, 3:]
    assert np.abs(flight.coordinates[:, 3:] - line).max() < 100 * options.accuracy

    # Known: the screw continues along its axis; its frame velocity never changes.
    assert (screw.frame_velocity == screw.frame_velocity[0]).all()
    point = dict(zip(frame.coordinates, start, strict=True))
    force = gt.cartan(frame).torsion.force_coefficients.at(point)
    rate = screw.velocity[0]
    bend = np.einsum("abc,a,b->c", force, rate, rate)
    # Their distance grows like t^2 / 2 times the torsion force at the start (both rotate alike).
    t = 1e-3
    gap = screw.at(t).coordinates[3:] - flight.at(t).coordinates[3:]
    assert np.allclose(2 * gap / t**2, bend[3:], atol=2e-3 * max(1.0, np.abs(bend).max()))
    print(f"\ntorsion force at the start: {bend[3:].round(6)}; it predicts their distance")


if __name__ == "__main__":
    main()
