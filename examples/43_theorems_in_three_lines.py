"""Theorems in three lines: closed orbits that exist, with their period and their stability.

    python examples/43_theorems_in_three_lines.py
    python examples/43_theorems_in_three_lines.py --digits 30 --picture orbits.png

Newton's method finds a closed orbit from a rough guess. Krawczyk's operator in ball arithmetic then
proves that a small box holds the start of exactly one. The orbits are a pendulum, the attractor of
van der Pol, Lorenz's shortest orbit and the equator of an ellipsoid, with known periods.
"""

import argparse
from pathlib import Path

import sympy as sp
from flint import arb

import geomtorsion as gt
from geomtorsion import pictures

PENDULUM = gt.ODE.of({"x": "v", "v": "-sin(x)"}, [1, 0], invariants={"E": "v**2/2-cos(x)"})
VAN_DER_POL = gt.ODE.of({"x": "v", "v": "(1-x**2)*v-x"}, [2, 0])
LORENZ = gt.ODE.of({"x": "10*(y-x)", "y": "x*(28-z)-y", "z": "x*y-8*z/3"}, [-13.7, -19.5, 27])


def equator() -> gt.curves.CurveProblem:
    """A geodesic near the equator of an ellipsoid with the axes 1, 1, 3."""
    theta, phi = sp.symbols("theta phi", real=True)
    meridian = sp.sqrt(sp.cos(theta) ** 2 + 9 * sp.sin(theta) ** 2)
    frame = gt.Frame([theta, phi], [[meridian, 0], [0, sp.sin(theta)]])
    return gt.geodesic(frame, [1.57, 0], frame_velocity=[0.01, 1])


def main(arguments: list[str] | None = None) -> None:
    """Prove four closed orbits and check their periods."""
    parser = argparse.ArgumentParser(description="Closed orbits, proved.")
    parser.add_argument("--digits", type=int, default=15)
    parser.add_argument("--picture", type=Path, help="file for a figure")
    options = parser.parse_args(arguments)
    digits = options.digits

    swing = gt.closed_orbit(PENDULUM, 6.5, section="v", conserved=["E"], digits=digits)
    print(f"A pendulum from the angle 1\n{swing}")
    # 4 K(sin 1/2).
    assert swing.period.overlaps(arb("6.69997566437045271270121137916 +/- 1e-29"))

    cycle = gt.closed_orbit(VAN_DER_POL, 6.5, section="v", digits=digits)
    print(f"\nVan der Pol's cycle\n{cycle}")
    assert cycle.stability == "attracting"

    chaos = gt.closed_orbit(LORENZ, 1.56, section="z-27", digits=digits)
    print(f"\nLorenz's shortest orbit\n{chaos}")
    # Viswanath 2003.
    assert chaos.period.overlaps(arb("1.55865221071617472757 +/- 1e-20"))
    assert chaos.stability == "saddle"

    round_trip = gt.closed_orbit(
        equator(), 6.2, section="phi", conserved={"u1**2+u2**2": 1}, shift={"phi": "2*pi"},
        digits=digits,
    )  # fmt: skip
    print(f"\nThe equator of an ellipsoid with the axes 1, 1, 3\n{round_trip}")
    assert round_trip.period.overlaps(2 * arb.pi())
    assert round_trip.stability == "elliptic"

    if options.picture:
        pictures.save(cycle.plot(), options.picture)


if __name__ == "__main__":
    main()
