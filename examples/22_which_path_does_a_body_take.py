"""Which path does a body take: geodesic, autoparallel, or the path of a body with spin.

    python examples/22_which_path_does_a_body_take.py

In a space with torsion the straightest and the shortest lines differ. If matter couples to the
metric, conservation of energy and momentum decides: a body without spin moves on a geodesic
(Papapetrou 1951; Yasskin and Stoeger 1980). Fiziev and Kleinert 1994 claim autoparallels. This
script shows four exact facts about the two claims and about spin, and the orbit of a spinning body.
"""

import argparse
import math

import numpy as np
import sympy as sp

import geomtorsion as gt


def hover_in_schwarzschild() -> None:
    """With the static tetrad a body at rest stays at rest on an autoparallel and does not fall."""
    hole = gt.spaces.load("schwarzschild").frame
    force = gt.cartan(hole).torsion.force([1, 0, 0, 0])
    fall = gt.levi_civita(hole).coefficients
    assert all(force[c] == fall[0, 0, c] for c in range(4))
    print(f"Schwarzschild: the torsion force {force[1]} cancels the gravity of the metric.")
    rest = [0.0, 10.0, math.pi / 2, 0.0], [math.sqrt(1 / 0.8), 0.0, 0.0, 0.0]
    mass = {"M": 1.0}
    straight = gt.solve(gt.autoparallel(gt.cartan(hole), *rest, parameters=mass), 20.0)
    short = gt.solve(gt.geodesic(hole, *rest, parameters=mass), 20.0)
    assert np.all(straight["r"] == 10.0)
    assert short["r"][-1] < 9.0
    print(f"  after a proper time of 20 M: autoparallel r = 10, geodesic r = {short['r'][-1]:.3f}")


def redshift_in_cosmology() -> None:
    """With the tetrad (dt, a dx) the momentum of a body is constant on an autoparallel."""
    t, x, y, z = sp.symbols("t x y z")
    a = sp.Function("a")(t)
    frame = gt.Frame([t, x, y, z], sp.diag(1, a, a, a), signature=(-1, 1, 1, 1))
    straight, short = gt.cartan(frame), gt.levi_civita(frame)
    assert straight.spin_connection.is_zero
    # u'^1 = -(a'/a) u^0 u^1 on a geodesic: momentum falls as 1/a.
    turned = short.spin_connection.in_frame()
    assert turned[1, 0, 1] == a.diff(t) / a
    assert turned[0, 0, 1] == 0
    print("Cosmology: u^1 is constant on autoparallels of (dt, a dx), and a u^1 on geodesics.")


def spin_in_axial_torsion() -> None:
    """Totally antisymmetric torsion changes no path; a Dirac spin rotates three times as fast."""
    space = gt.spaces.load("axial_torsion")
    assert space.connection is not None
    assert space.connection.torsion.force_coefficients.is_zero
    unit, empty = np.eye(2), np.zeros((2, 2))
    pauli = [np.array([[0, 1], [1, 0]]), np.array([[0, -1j], [1j, 0]]), np.diag([1, -1])]
    gamma = [np.block([[unit, empty], [empty, -unit]])]
    gamma += [np.block([[empty, sigma], [-sigma, empty]]) for sigma in pauli]
    # K_cab = [cab] for c, a, b in 0, 1, 2: the part of the Hamiltonian gamma^0 gamma^c K_cab
    # gamma^a gamma^b / 4 that rotates spin about the third axis.
    terms = {}
    for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
        sign = round(np.linalg.det(np.eye(3)[list(order)]))
        c, i, j = order
        product = sign * gamma[0] @ gamma[c] @ gamma[i] @ gamma[j] / 4
        terms[c] = terms.get(c, 0) + product
    total = terms[0] + terms[1] + terms[2]
    assert np.allclose(total, 3 * terms[0])
    print(
        "Axial torsion: no path changes; a Dirac spin rotates 3 times as fast as a parallel vector."
    )


def rotating_frame() -> None:
    """In a rotating frame T_[012] = -2 Omega/3, and a Dirac spin rotates with Omega (Mashhoon)."""
    t, x, y, z, turn = sp.symbols("t x y z Omega")
    rows = [[1, 0, 0, 0], [-turn * y, 1, 0, 0], [turn * x, 0, 1, 0], [0, 0, 0, 1]]
    frame = gt.Frame([t, x, y, z], rows, signature=(-1, 1, 1, 1))
    axial = gt.cartan(frame).torsion.axial.in_frame()
    assert axial[0, 1, 2] == -2 * turn / 3
    # The metric connection differs from parallel legs by K = T/2; Dirac's factor is 3.
    assert 3 * axial[0, 1, 2] / 2 == -turn
    print(f"Rotating frame: T_[012] = {axial[0, 1, 2]}, so a Dirac spin rotates with Omega.")


def spin_changes_the_orbit(radius: float) -> float:
    """Frequency of a spinning body on a circular orbit: Omega_0 (1 - (3/2) (s/m) Omega_0)."""
    hole = gt.levi_civita(gt.spaces.load("schwarzschild").frame)
    spin, kepler = 0.01, radius**-1.5
    # Local speed of a circular geodesic; the speed of a body with spin is close to it.
    near = 1 / math.sqrt(radius - 2)

    def body(speed: float, s: float) -> gt.ODE:
        gamma = 1 / math.sqrt(1 - speed**2)
        velocity = [gamma / math.sqrt(1 - 2 / radius), 0, 0, gamma * speed / radius]
        start, turn = [0, radius, math.pi / 2, 0], [0, 0, -s, 0]
        return gt.spinning(hole, start, velocity, turn, coupling="orbital", parameters={"M": 1})

    def frequency(s: float) -> float:
        low, high = near, near * 1.01
        for _ in range(6):
            falls = [gt.solve(body(v, s), [0, 0.5])["r"][-1] - radius for v in (low, high)]
            if falls[0] == falls[1]:
                break
            low, high = high, high - falls[1] * (high - low) / (falls[1] - falls[0])
        solution = gt.solve(body(high, s), [0, 1.0])
        return float(solution["phi"][-1] / solution["t"][-1])

    slope = (frequency(spin) - frequency(-spin)) / (2 * spin * kepler)
    print(f"Spin: d ln Omega / ds = {slope:.6f}, expected -3/2 Omega_0 = {-1.5 * kepler:.6f}.")
    return slope


def main(arguments: list[str] | None = None) -> None:
    """Show the facts one after the other; each ends in an assertion."""
    parser = argparse.ArgumentParser(description="Three kinds of path.")
    parser.add_argument("--radius", type=float, default=10.0, help="radius of the circle, in M")
    options = parser.parse_args(arguments)
    hover_in_schwarzschild()
    redshift_in_cosmology()
    spin_in_axial_torsion()
    rotating_frame()
    slope = spin_changes_the_orbit(options.radius)
    assert abs(slope / (-1.5 * options.radius**-1.5) - 1) < 1e-3


if __name__ == "__main__":
    main()
