"""Parameters from data: mass and spin of Kerr from an orbit, moments of a top from its attitude.

    python examples/33_parameters_from_data.py
    python examples/33_parameters_from_data.py --seed 7

The data are made here: a solved motion with noise of a known size. Exact derivatives of the motion
(variational equations) give the fit, its errors, and a warning where data do not determine a
parameter.
"""

import argparse
from collections.abc import Mapping
from typing import Any

import numpy as np
import sympy as sp

import geomtorsion as gt
from geomtorsion.rigid.attitude import quaternion_rates

ORBIT = gt.geodesic(
    "kerr", [0, 10, 1.2, 0], velocity=[1.2, 0, 0.012, 0.034], parameters={"M": 1.0, "a": 0.6}
)
ATTITUDE, TURN = ("q0", "q1", "q2", "q3"), ("w1", "w2", "w3")


def noisy(
    problem: gt.curves.CurveProblem | gt.ODE, times: np.ndarray, sigma: dict[str, float], seed: int
) -> dict[str, np.ndarray]:
    """Recorded quantities of a motion: exact numbers and Gaussian noise."""
    draws, solution = np.random.default_rng(seed), gt.solve(problem, times, 1e-11)
    return {name: solution[name] + x * draws.normal(size=len(times)) for name, x in sigma.items()}


def mass_and_spin(seed: int) -> gt.fits.Fit:
    """Mass and spin of a black hole, from radius and angle of one orbit."""
    times, sigma = np.linspace(5, 300, 60), {"r": 1e-3, "phi": 1e-4}
    data = noisy(ORBIT, times, sigma, seed)
    guess = ORBIT.with_values({"M": 1.0005, "a": 0.55, "r": 10.002})
    return gt.fit(guess, times, data, sigma, ["M", "a", "r"])


def free_top() -> gt.ODE:
    """Euler's equations with the attitude as a unit quaternion; moments 1, 2 and 3."""
    rates = {
        "w1": "(I2 - I3)/I1*w2*w3", "w2": "(I3 - I1)/I2*w3*w1", "w3": "(I1 - I2)/I3*w1*w2",
    }  # fmt: skip
    turns = quaternion_rates(sp.symbols(ATTITUDE), sp.symbols(TURN))
    return gt.ODE.of(
        rates | dict(zip(ATTITUDE, turns, strict=True)),
        {"w1": 0.1, "w2": 1.0, "w3": 0.2, "q0": 1, "q1": 0, "q2": 0, "q3": 0},
        parameters={"I1": 1, "I2": 2, "I3": 3},
        normalized=[ATTITUDE],
    )


def moments(seed: int) -> tuple[gt.fits.Fit, gt.fits.Fit]:
    """Moments of a top, from its recorded attitude: all three moments, then two of them."""
    times, sigma = np.linspace(0.2, 12, 60), dict.fromkeys(ATTITUDE, 1e-3)
    data = noisy(free_top(), times, sigma, seed)
    guess = free_top().with_values({"I2": 2.1, "I3": 2.9, "w1": 0.12})
    every = gt.fit(guess, times, data, 1e-3, ["I1", "I2", "I3", *TURN])
    return every, gt.fit(guess, times, data, 1e-3, ["I2", "I3", *TURN])


def check(fit: gt.fits.Fit, truth: Mapping[str, Any]) -> None:
    """Each value is within five of its errors of the truth."""
    for name, value in fit.values.items():
        assert abs(value - truth[name]) < 5 * fit.errors[name], name


def main(arguments: list[str] | None = None) -> None:
    """Both fits, against the values with which the data were made."""
    parser = argparse.ArgumentParser(description="Parameters from data.")
    parser.add_argument("--seed", type=int, default=1, help="of the noise")
    seed = parser.parse_args(arguments).seed
    hole = mass_and_spin(seed)
    print(f"A black hole, from 60 points of an orbit\n{hole}\n")
    check(hole, ORBIT.variables)
    every, two = moments(seed)
    print(f"A top, from its attitude: all moments\n{every}\n")
    print(f"A top, with I1 = 1\n{two}")
    assert len(every.undetermined) == 1, "only ratios of moments show"
    check(two, free_top().variables)


if __name__ == "__main__":
    main()
