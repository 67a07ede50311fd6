"""Which particles does a theory have: mass, spin, parity and sign of the energy about flat space.

    python examples/36_which_particles.py
    python examples/36_which_particles.py -L "R/2 + a*R7 + b*Q3" -g metric-affine
    python examples/36_which_particles.py --picture particles.png

A small wave on flat space obeys linear equations. Sorted by spin and parity, they are small
matrices, whose determinants vanish at the masses. Ghosts have negative energy, tachyons an
imaginary mass. All masses of the quadratic gauge theory of the Poincare group are published
(Hayashi and Shirafuji 1980, Karananas 2014): the program finds all six again.
"""

import argparse
from pathlib import Path

import sympy as sp

from geomtorsion import pictures
from geomtorsion.gravity import perturbed

KARANANAS = (
    "lam*R + (r4 + r5)*R4 + (r4 - r5)*R5 + (r1/3 + r2/6)*R1 + (2*r1/3 - 2*r2/3)*R2"
    " + (r1/3 + r2/6 - r3)*R3"
    " - (lam/4 + t1/3 + t2/12)*T1 + (-lam/2 - t1/3 + t2/6)*T2 - (-lam - t1/3 + 2*t3/3)*T3"
)
lam, r1, r2, r3, r4, r5, t1, t2, t3 = couplings = sp.symbols("lam r1 r2 r3 r4 r5 t1 t2 t3")
PUBLISHED = {
    "0-": -t2 / r2,
    "0+": lam * t3 / (2 * (t3 - lam) * (r1 - r3 + 2 * r4)),
    "1+": -3 * t1 * t2 / (2 * (t1 + t2) * (2 * r3 + r5)),
    "1-": -3 * t1 * t3 / (2 * (t1 + t3) * (r1 + r4 + r5)),
    "2+": -lam * t1 / (2 * (lam + t1) * (2 * r1 - 2 * r3 + r4)),
    "2-": -t1 / (2 * r1),
}


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="Which particles does a theory have.")
    parser.add_argument("-L", "--lagrangian", help="another theory")
    parser.add_argument("-g", "--geometry", default="riemannian", help="its geometry")
    parser.add_argument("--picture", type=Path, help="file for a figure of the nine couplings")
    options = parser.parse_args(arguments)
    if options.lagrangian:
        print(perturbed.spectrum(options.lagrangian, options.geometry))
        return

    print("Gravity with a squared curvature:")
    print(perturbed.spectrum("R/2 + c*R**2 + b*P1", "riemannian"))

    print("\nPoincare gauge theory, nine couplings:")
    spectrum = perturbed.spectrum(KARANANAS, "poincare", constants=couplings)
    print(spectrum)
    masses = {one.label: one.mass2 for one in spectrum.particles if not one.is_massless}
    for name, mass2 in PUBLISHED.items():
        assert sp.cancel(masses[name] - mass2) == 0, name
    assert spectrum.degrees_of_freedom == 20

    if options.picture:
        pictures.save(spectrum.plot(), options.picture)

    print("\nOnly the pseudoscalar, and where it is healthy:")
    alone = perturbed.spectrum("R/2 + c*holst**2 + d*axial2", "poincare")
    print(alone)
    c, d = sp.symbols("c d")
    assert set(alone.healthy.args) == {c > 0, 8 * d - 1 < 0}


if __name__ == "__main__":
    main()
