"""How a black hole rings: quasi-normal modes from the Lagrangian, in general relativity and beyond.

    python examples/37_how_a_hole_rings.py
    python examples/37_how_a_hole_rings.py --picture rings.png

A struck black hole rings like a bell that loses its energy as waves. Each mode has one frequency
and one damping. They follow from the field equations to first order about the hole. Leaver (1985)
published them to ten digits.
"""

import argparse
from pathlib import Path

from geomtorsion import pictures
from geomtorsion.gravity import perturbed

# l = 2, M = 1: Leaver (1985), with the digits of Jansen (2017).
LEAVER = (0.373671684418042 - 0.088962315688936j, 0.346710996879163 - 0.273914875291235j)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="How a black hole rings.")
    parser.add_argument("--picture", type=Path, help="file for a figure")
    options = parser.parse_args(arguments)

    mass = {"M": 1}
    rings = perturbed.ringing("R", "schwarzschild", modes=2, parity="polar", parameters=mass)
    print(rings)
    for one, value in zip(rings.modes, LEAVER, strict=True):
        assert abs(one.frequency - value) < 1e-9

    print("\nThe same hole in teleparallel gravity, axial waves:")
    tegr = perturbed.ringing(
        "-T/2", "schwarzschild", parity="axial", parameters=mass, geometry="teleparallel"
    )
    print(tegr)
    assert abs(tegr.modes[0].frequency - LEAVER[0]) < 1e-9

    print("\nThe scalar of R + c R^2, with m^2 = 1/(6 c), has no wave of the tetrad for l = 1:")
    square = perturbed.ringing("R + c*R**2", "schwarzschild", l=1, parameters={"M": 1, "c": "5/3"})
    print(square)
    field = {"M": 1, "m2": "1/10"}
    test = perturbed.ringing("-X/2 - m2*phi**2/2", "schwarzschild", l=1, parameters=field)
    one, two = square.modes[0], test.modes[0]
    assert abs(one.frequency - two.frequency) < one.error + two.error

    print("\nA scalar field without a mass:")
    print(perturbed.ringing("-X/2", "schwarzschild", l=0, parameters=mass))

    # In seconds: a hole of 62 solar masses, the first one heard (GW150914).
    second = 62 * 4.925490947e-6
    w = rings.modes[0].frequency / second
    print(f"\n62 solar masses: {w.real / 6.283185307:.0f} Hz, {-1000 / w.imag:.1f} ms")
    if options.picture:
        pictures.save(rings.plot(), options.picture)


if __name__ == "__main__":
    main()
