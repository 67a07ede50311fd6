"""Constraints are torsion: a sleigh, a rolling disc and a robot that parks.

    python examples/24_constraints_are_torsion.py
    python examples/24_constraints_are_torsion.py --drive 0.1 --turn 0.1

A body with linear constraints on its velocity follows an autoparallel of a metric connection with
torsion (Synge 1928, Vranceanu 1926; Shabanov 1998). The torsion along the forbidden leg decides
whether the constraint can be integrated, and how far a robot gets sideways.
"""

import argparse

import numpy as np

import geomtorsion as gt


def sleigh() -> float:
    """The sleigh agrees with Chaplygin's equations; a free body goes elsewhere."""
    space = gt.spaces.load("chaplygin_sleigh")
    assert space.connection is not None
    numbers = {"m": 2.0, "I": 0.5, "a": 0.3}
    start, velocity = [0, 0, 0], [1.0, 0.0, 2.0]
    bound = gt.solve(
        gt.autoparallel(space.connection, start, velocity, parameters=numbers), 5.0, 1e-11
    )
    free = gt.solve(gt.geodesic(space.frame, start, velocity, parameters=numbers), 5.0, 1e-11)
    speeds = {"u": "a*w**2", "w": "-m*a*u*w/(I + m*a**2)"}
    places = {"x": "u*cos(th)", "y": "u*sin(th)", "th": "w"}
    begin = {"u": 1.0, "w": 2.0, "x": 0, "y": 0, "th": 0}
    chaplygin = gt.solve(gt.ODE.of(speeds | places, begin, parameters=numbers), 5.0, 1e-11)
    end = bound.at(5.0).coordinates
    gap = max(abs(end[k] - chaplygin[name][-1]) for k, name in enumerate(("x", "y", "th")))
    away = float(np.abs(free.at(5.0).coordinates - end).max())
    print(
        f"sleigh: differs from Chaplygin's equations by {gap:.1e}, from a free body by {away:.2f}"
    )
    assert away > 1
    return gap


def disc() -> None:
    """A disc with constant rates rolls on a circle."""
    space = gt.spaces.load("rolling_disc")
    assert space.connection is not None
    numbers = {"m": 1.0, "J": 0.25, "I": 0.5, "R": 0.8}
    roll = gt.autoparallel(space.connection, [0] * 4, [1.6, 0, 0.5, 2.0], parameters=numbers)
    track = gt.solve(roll, 6.0, 1e-11).coordinates
    radius = np.hypot(track[:, 0], track[:, 1] - 3.2)
    print(f"disc: rolls on a circle of radius {radius.mean():.6f}; {space.connection.integrable}")
    assert np.abs(radius - 3.2).max() < 1e-12


def robot(drive: float, turn: float) -> float:
    """Forward, turn, back, turn back: the gap is the Burgers vector of the loop."""
    space = gt.spaces.load("wheeled_robot")
    assert space.connection is not None
    end = [drive - drive * np.cos(turn), -drive * np.sin(turn)]
    corners = [[0, 0, 0], [drive, 0, 0], [drive, 0, turn], [*end, turn], [*end, 0]]
    b = gt.burgers_vector(space.frame, gt.Loop.polygon(corners))
    twist = float(space.connection.torsion.T.in_frame()[0, 1, 2])
    print(
        f"robot: Burgers vector {b.vector.round(6).tolist()}, to the side {b.vector[2]:.6f}, "
        f"torsion times area {twist * drive * turn:.6f}"
    )
    assert np.allclose(b.vector, [-end[0], 0, -end[1]], atol=1e-12)
    return abs(float(b.vector[2]) - twist * drive * turn)


def main(arguments: list[str] | None = None) -> None:
    """Show the three bodies; each ends in an assertion."""
    parser = argparse.ArgumentParser(description="Bodies with constraints.")
    parser.add_argument("--drive", type=float, default=0.3, help="how far the robot drives")
    parser.add_argument("--turn", type=float, default=0.4, help="how far it turns, in radians")
    options = parser.parse_args(arguments)
    assert sleigh() < 1e-12
    disc()
    beyond = robot(options.drive, options.turn)
    assert beyond < options.drive * options.turn**2, "torsion times area, to leading order"


if __name__ == "__main__":
    main()
