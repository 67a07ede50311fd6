"""Does a theory pass in the solar system: gamma and beta from the Lagrangian, and measurements.

    python examples/38_does_it_pass_in_the_solar_system.py
    python examples/38_does_it_pass_in_the_solar_system.py --picture gamma.png

Cassini measured the delay of signals that pass the Sun, laser ranging the fall of the Moon. Both
agree with general relativity to some parts in 10^5. The theory of Brans and Dicke passes only for a
coupling above 40000 (Bertotti, Iess, Tortora 2003).
"""

import argparse
from pathlib import Path

import sympy as sp

from geomtorsion import pictures
from geomtorsion.gravity import perturbed

om = sp.Symbol("om")


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="Does a theory pass in the solar system.")
    parser.add_argument("--picture", type=Path, help="file for a figure")
    options = parser.parse_args(arguments)

    theory = perturbed.post_newtonian("phi*R/2 - om*X/(2*phi)", "riemannian", scalars="phi")
    print(theory)
    assert sp.cancel(theory.gamma - (1 + om) / (2 + om)) == 0
    assert theory.beta == 1
    passes = theory.tests[0].passes
    assert [bool(passes.subs(om, x)) for x in (39000, 41000)] == [False, True]

    print("\nNew general relativity:")
    print(perturbed.post_newtonian("T + c*vector2", "teleparallel"))

    print("\nA scalar with a mass:")
    scalar = perturbed.post_newtonian("R/2 + R**2/12", "riemannian")
    print(scalar)
    for distance in (1, 20):
        print(f"r = {distance}: {scalar.tests_at(distance)[0]}")
    if options.picture:
        pictures.save(theory.plot(), options.picture)


if __name__ == "__main__":
    main()
