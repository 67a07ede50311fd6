"""Kepler as an oscillator: orbits without a singularity, straight through a collision.

    python examples/26_kepler_as_an_oscillator.py
    python examples/26_kepler_as_an_oscillator.py --eccentricity 0.999

The map from four dimensions to three of Kustaanheimo and Stiefel (1965), which Duru and Kleinert
(1979) used for the hydrogen atom. In the frame of this map, the acceleration -x/r^3 acts on a point
with an angle. In pseudo-time s, with dt = r ds, the same motion is an oscillation of q.
"""

import argparse

import numpy as np

import geomtorsion as gt

SPACE = gt.spaces.load("kustaanheimo_stiefel")
POTENTIAL = "-1/(q1**2 + q2**2 + q3**2 + q4**2)"


def lifted(place: list[float]) -> list[float]:
    """One q above a point with z + r > 0; the others differ by an angle."""
    x, y, z = place
    one = np.sqrt((np.linalg.norm(place) + z) / 2)
    return [float(one), 0.0, float(x / (2 * one)), float(y / (2 * one))]


def oscillator(place: list[float], velocity: list[float]) -> gt.ODE:
    """d2q/ds2 = E/2 q and dt/ds = r, from a place and a velocity in space."""
    energy = np.dot(velocity, velocity) / 2 - 1 / np.linalg.norm(place)
    q = lifted(place)
    frame = gt.numpy_function(SPACE.frame.legs, SPACE.frame.coordinates)
    # The fourth velocity is zero. dt = r ds multiplies all velocities by r = q^2.
    slopes = np.dot(q, q) * np.asarray(frame(*q)) @ [*velocity, 0.0]
    rates = {"t": "q1**2 + q2**2 + q3**2 + q4**2"}
    start = {"t": 0.0}
    for k in range(4):
        rates |= {f"q{k + 1}": f"p{k + 1}", f"p{k + 1}": f"E*q{k + 1}/2"}
        start |= {f"q{k + 1}": q[k], f"p{k + 1}": float(slopes[k])}
    return gt.ODE.of(rates, start, parameters={"E": float(energy)}, time="s")


def places(solution: gt.ode.Solution) -> np.ndarray:
    """Points in space of a solution, shape (m, 3)."""
    q = np.stack([solution[f"q{k}"] for k in (1, 2, 3, 4)], axis=1)
    assert SPACE.embedding is not None
    return SPACE.embedding(SPACE.frame).places(q, {})


def orbit(eccentricity: float) -> float:
    """An ellipse with half axis 1 agrees with Kepler's equation t = eta - e sin(eta)."""
    e = eccentricity
    problem = oscillator([1 - e, 0, 0], [0, np.sqrt((1 + e) / (1 - e)), 0])
    eta = np.linspace(0, 4 * np.pi, 41)
    solution = gt.solve(problem, eta, 1e-13)  # for half axis 1 the pseudo-time is eta
    ellipse = np.stack([np.cos(eta) - e, np.sqrt(1 - e**2) * np.sin(eta), 0 * eta], axis=1)
    misses = np.abs(places(solution) - ellipse).max()
    late = np.abs(solution["t"] - (eta - e * np.sin(eta))).max()
    print(f"e = {e}: two turns, place differs by {misses:.1e}, time by {late:.1e}")
    return float(max(misses, late))


def collision() -> float:
    """A stone without angular momentum falls into the centre and returns: r = 1 - cos(eta)."""
    eta = np.linspace(np.pi, 5 * np.pi, 41)
    problem = oscillator([0, 0, 2.0], [0, 0, 0])
    solution = gt.solve(problem, eta - np.pi, 1e-13)
    misses = np.abs(places(solution)[:, 2] - (1 - np.cos(eta))).max()
    late = np.abs(solution["t"] - (eta - np.sin(eta) - np.pi)).max()
    print(f"collision: through r = 0 twice, place differs by {misses:.1e}, time by {late:.1e}")
    return float(max(misses, late))


def physical_time() -> float:
    """The autoparallel of the frame with torsion and the force is the same motion in time t."""
    place, velocity = [0.5, 0.1, 0.3], [0.2, 1.1, -0.3]
    solution = gt.solve(oscillator(place, velocity), 3.0, 1e-13)
    problem = gt.autoparallel(
        gt.cartan(SPACE.frame), lifted(place), frame_velocity=[*velocity, 0.0], potential=POTENTIAL
    )
    end = gt.solve(problem, float(solution["t"][-1]), 1e-12).coordinates[-1]
    gap = max(abs(end[k] - solution[f"q{k + 1}"][-1]) for k in range(4))
    print(f"autoparallel with the potential -1/r: differs by {gap:.1e}")
    return gap


def main(arguments: list[str] | None = None) -> None:
    """An ellipse and a collision against closed forms, and the same motion in time."""
    parser = argparse.ArgumentParser(description="Kepler as an oscillator.")
    parser.add_argument("--eccentricity", type=float, default=0.9, help="of the ellipse, below 1")
    options = parser.parse_args(arguments)
    largest = max(orbit(options.eccentricity), collision(), physical_time())
    assert largest < 1e-10, "closed forms and both times agree"


if __name__ == "__main__":
    main()
