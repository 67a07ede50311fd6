"""Orbits around a rotating black hole: constants, frequencies, and the end of a plunge.

    python examples/23_orbits_of_kerr.py
    python examples/23_orbits_of_kerr.py --shape 0.9 6 0.3 0.5

A bound orbit is given by the spin a, the semilatus rectum p, the eccentricity e and the cosine x of
its inclination. It has three frequencies, which no finite piece of it shows exactly. They exist
because energy, angular momentum and Carter's constant are conserved. The script finds all three
constants from the frame.
"""

import argparse
import math

import geomtorsion as gt

# KerrGeodesics of the Black Hole Perturbation Toolkit: a = 0.9, p = 6, e = 0.3, x = 1.
PUBLISHED = (0.037645648405229756, 0.05262560724893245, 0.05816122061091471)
KINETIC = "(-u1**2 + u2**2 + u3**2 + u4**2)/2"


def main(arguments: list[str] | None = None) -> None:
    """Find the constants, print the frequencies, follow the orbit, and stop a plunge."""
    parser = argparse.ArgumentParser(description="Orbits of Kerr's space.")
    parser.add_argument(
        "--shape", type=float, nargs=4, default=[0.9, 6, 0.3, 0.5], metavar=("a", "p", "e", "x")
    )
    options = parser.parse_args(arguments)

    kerr = gt.spaces.load("kerr").frame
    found = gt.conserved_quantities(kerr, KINETIC)
    print("Conserved along each geodesic of Kerr's space:")
    for name, value in found.items():
        print(f"    {name}: {value}")
    assert "killing tensor 1" in found, "Carter's constant"

    known = gt.spaces.kerr_orbit(0.9, 6, 0.3, 1).frequencies
    pairs = zip((known.radial, known.polar, known.azimuthal), PUBLISHED, strict=True)
    assert max(abs(one - two) for one, two in pairs) < 1e-15

    orbit = gt.spaces.kerr_orbit(*options.shape)
    print(f"\nE = {orbit.energy:.9f}, L = {orbit.angular_momentum:.9f}, Q = {orbit.carter:.9f}")
    for one in (orbit.mino_frequencies, orbit.proper_frequencies, orbit.frequencies):
        print(
            f"    per unit of {one.time:>4}: radial {one.radial:.9f}, polar {one.polar:.9f}, "
            f"azimuthal {one.azimuthal:.9f}"
        )

    # Mino time separates r from theta: the same orbit, solved in it and as a geodesic.
    turn = 2 * math.pi / orbit.mino_frequencies.radial
    mino = gt.solve(orbit.mino(), turn)
    proper = float(mino["tau"][-1])
    curve = gt.solve(orbit.geodesic(), proper)
    gap = abs(float(curve.coordinates[-1, 2] - mino["theta"][-1]))
    print(f"\nFrom periapsis to periapsis in proper time {proper:.6f}; both agree to {gap:.1e}")
    assert gap < 1e-7
    (back,) = gt.solve(orbit.geodesic(), 1.2 * proper).event_times("u2", 1)
    assert abs(back - proper) < 1e-6 * proper

    # A plunge ends at the requested radius, in the chart that it uses there.
    start = ([0, 10, math.pi / 2, 0], [1.3, -0.3, 0, 0.03])
    plunge = gt.geodesic(kerr, *start, parameters={"M": 1, "a": 0.5}, stop="r - 1.7")
    ended = gt.solve(plunge, 25.0)
    print(f"A plunge from r = 10 passes r = 1.7 at {ended.times[-1]:.8f}, in charts {ended.charts}")
    assert ended.stopped_by == "r - 1.7"
    assert abs(float(ended.event_times("r - 3")[0]) - 19.56305262) < 1e-8


if __name__ == "__main__":
    main()
