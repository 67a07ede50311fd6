"""Through the pole: the solver switches charts automatically.

    python examples/05_through_the_pole.py
    python examples/05_through_the_pole.py --bearing 45

A geodesic of the sphere crosses the pole, where colatitude and longitude are not defined, and
returns to its start. A ship that keeps a compass bearing has to stop at the pole: no compass
direction is defined there.
"""

import argparse

import numpy as np

import geomtorsion as gt
from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.errors import ChartEdgeError
from geomtorsion.ode import solve


def main(arguments: list[str] | None = None) -> None:
    """Follow a great circle, a loxodrome, and a fall through a horizon."""
    parser = argparse.ArgumentParser(description="Motions that leave their charts.")
    parser.add_argument("--bearing", type=float, default=60.0, help="degrees east of north")
    options = parser.parse_args(arguments)
    sphere = gt.spaces.load("s2").frame

    circle = geodesic(sphere, [1.0, 0.5], [-1.0, 0.0], parameters={"R": 1})
    sol = solve(circle, 2 * np.pi, accuracy=1e-11)
    print(sol)
    print(f"charts on the way: {' -> '.join(sol.charts)}")
    home = sol.coordinates[-1]
    print(f"after one turn: theta = {home[0]:.12f}, phi = {home[1]:.12f}")
    assert np.abs(home - [1.0, 0.5]).max() < 1e-10

    # With one chart only, the motion stops at the edge and keeps the solution so far.
    bearing = np.radians(options.bearing)
    u = [-np.cos(bearing), np.sin(bearing)]  # north is down in colatitude
    ship = autoparallel(gt.cartan(sphere), [1.0, 0.0], frame_velocity=u, parameters={"R": 1})
    try:
        course = solve(ship, 100.0, accuracy=1e-8)
        print("\nthis bearing follows a parallel and does not reach the pole")
        theta = course.coordinates[:, 0]
    except ChartEdgeError as stop:
        print(f"\n{stop}")
        course = stop.solution
        theta = course.coordinates[:, 0]
    # Known: the colatitude falls in proportion to the distance travelled northwards.
    assert np.abs(theta - (1.0 - np.cos(bearing) * course.times)).max() < 1e-6

    hole = gt.spaces.load("schwarzschild").frame
    fall = geodesic(
        hole, [0, 8, 1.2, 0.3], [4 / 3, -0.5, 0, 0], parameters={"M": 1}, causal="timelike"
    )
    sol = solve(fall, 9.8, accuracy=1e-9)
    radius = np.linalg.norm(sol.in_chart("kerr_schild")[:, 1:], axis=1)
    print(f"\ndust falls from r = 8 M to {radius[-1]:.6f} M: {' -> '.join(sol.charts)}")
    # Known: from rest at infinity r^(3/2) falls linearly in proper time.
    expected = (8**1.5 - 1.5 * np.sqrt(2) * sol.times) ** (2 / 3)
    assert np.abs(radius - expected).max() < 1e-7
    print("the fall agrees with r^(3/2) = r0^(3/2) - (3/2) sqrt(2 M) t, also through the horizon")


if __name__ == "__main__":
    main()
