"""Motions in pieces: a bouncing ball, a thermostat, and a wheel that a measured torque drives.

    python examples/46_motions_in_pieces.py
    python examples/46_motions_in_pieces.py --picture pieces.png

Each event is a surface at which the solver restarts; errors and derivatives hold across it.
"""

import argparse
import math
from pathlib import Path

import numpy as np
from scipy.interpolate import PchipInterpolator

import geomtorsion as gt

# Measured torque in N m over time in s.
TORQUE = [(0, 0), (0.5, 1.8), (1, 2), (2, 2), (2.5, -1), (3, -1.2), (4, 0)]


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="Motions in pieces")
    parser.add_argument("--picture", type=Path, help="file for a figure")
    options = parser.parse_args(arguments)

    # A ball keeps 7/10 of its speed at each bounce.
    bounce = gt.When("z", {"v": "-e*v"})
    fall = {"z": "v", "v": "-g"}
    ball = gt.ODE.of(fall, [2, 0], parameters={"g": 10, "e": "7/10"}, events=[bounce])
    times = np.linspace(0, 3, 301)
    flight = gt.solve(ball, times, derivatives=["e"])
    first = math.sqrt(0.4)
    bounces = first * (1 + 2 * np.cumsum([0, 0.7, 0.7**2, 0.7**3, 0.7**4]))
    assert np.allclose(flight.change_times[:5], bounces, rtol=1e-9)
    last, speed = bounces[3], 10 * first * 0.7**4
    since = times[(times > bounces[3]) & (times < bounces[4])] - last
    assert np.allclose(flight["z"][(times > last) & (times < bounces[4])],
                       speed * since - 5 * since**2, atol=1e-9)  # fmt: skip
    print(f"{len(flight.change_times)} bounces, error {flight.error:.1e}")

    # The bounces add up to a finite time: beyond it the equations describe nothing.
    try:
        gt.solve(ball, 4.0)
    except gt.errors.StuckError as error:
        print(error)

    # Heating goes off at 21 degrees and on at 19.
    switches = [gt.When("21 - T", {"on": 0}), gt.When("T - 19", {"on": 1})]
    room = gt.ODE.of({"T": "(12*on + 12 - T)/10"}, {"T": 19}, parameters={"on": 1}, events=switches)
    warmth = gt.solve(room, np.linspace(0, 40, 401))
    heating, cooling = 10 * math.log(5 / 3), 10 * math.log(9 / 7)
    assert np.isclose(warmth.change_times[2] - warmth.change_times[0], heating + cooling)
    print(f"period of the thermostat {heating + cooling:.4f} s")

    # A wheel with a moment of inertia of 0.5 kg m^2.
    torque = gt.Table.of(TORQUE, "monotone")
    wheel = gt.ODE.of(
        {"angle": "speed", "speed": "torque(t)/I"},
        [0, 0],
        parameters={"I": 0.5},
        tables={"torque": torque},
        outputs={"torque": "torque(t)"},
    )
    turn = gt.solve(wheel, np.linspace(0, 4, 401))
    rows = np.array(TORQUE, dtype=float)
    exact = PchipInterpolator(*rows.T).integrate(0, 4) / 0.5
    assert np.isclose(turn["speed"][-1], exact, rtol=1e-9)
    print(f"final speed {turn['speed'][-1]:.6f} rad/s")
    if options.picture:
        draw(options.picture, flight, warmth, turn)


def draw(
    path: Path, flight: gt.ode.Solution, warmth: gt.ode.Solution, turn: gt.ode.Solution
) -> None:
    """Height, temperature and speed over time."""
    import matplotlib.pyplot as plt  # only the figure needs it

    figure, axes = plt.subplots(3, 1, figsize=(6, 7), layout="constrained")
    axes[0].plot(flight.times, flight["z"])
    axes[0].plot(flight.change_times, np.zeros(len(flight.change_times)), "k.", label="bounces")
    axes[0].set(xlabel="t (s)", ylabel="height (m)")
    axes[0].legend()
    axes[1].plot(warmth.times, warmth["T"])
    axes[1].fill_between(
        warmth.times, 18.5, 21.5, where=warmth["on"] > 0.5, alpha=0.2, step="post",
        label="heating on",
    )  # fmt: skip
    axes[1].set(xlabel="t (s)", ylabel="temperature (degrees)")
    axes[1].legend(loc="lower right")
    axes[2].plot(turn.times, turn["torque"], "C1", label="torque (N m)")
    axes[2].plot(*np.array(TORQUE, dtype=float).T, "k.", label="measured")
    axes[2].plot(turn.times, turn["speed"], "C0", label="speed (rad/s)")
    axes[2].set(xlabel="t (s)")
    axes[2].legend()
    gt.pictures.save(figure, path)


if __name__ == "__main__":
    main()
