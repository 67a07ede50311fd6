"""Stars from a table: masses, radii and tides of neutron stars, against published numbers.

    python examples/47_stars_from_a_table.py
    python examples/47_stars_from_a_table.py --matter APR4 --picture stars.png

The matter is given by pieces, or by a table of pressures and densities. A family has one star for
each density at the centre; its heaviest star, and the deformability by a tide, have errors.
"""

import argparse
import tempfile
from pathlib import Path

import numpy as np

import geomtorsion as gt

# Largest mass in solar masses and radius of 1.4 solar masses in km (Read et al. 2009, table III).
PUBLISHED = {"SLy": (2.049, 11.736), "APR4": (2.213, 11.428), "MPA1": (2.461, 12.473)}


def from_a_table(name: str) -> gt.gravity.EquationOfState:
    """The same matter from a file of its pressures and densities in cgs units."""
    matter = gt.gravity.equation_of_state(name)
    densities = np.geomspace(1e8, 6e15, 300)
    rows = [f"{matter.pressure_at(x)!r},{x!r}" for x in densities.tolist()]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, f"{name}.csv")
        file.write_text("p,rho\n" + "\n".join(rows) + "\n")
        return gt.gravity.equation_of_state(file, units="cgs")


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="Stars from a table")
    parser.add_argument("--matter", default="SLy", choices=PUBLISHED, help="published matter")
    parser.add_argument("--picture", type=Path, help="file for a figure")
    options = parser.parse_args(arguments)

    matter = gt.gravity.equation_of_state(options.matter)
    stars = gt.gravity.family(matter, np.geomspace(5e14, 3.6e15, 8))
    usual = stars.at_mass(1.4)
    print(stars)
    print(usual)
    print(f"deformability {usual.deformability:.5g}, I = {usual.moment_of_inertia:.6g} in km^2")
    mass, radius = PUBLISHED[options.matter]
    # The published numbers belong to tables, to which the pieces are a fit.
    assert abs(stars.heaviest.mass / mass - 1) < 0.015
    assert abs(usual.radius / radius - 1) < 0.015

    table = from_a_table(options.matter)
    star = gt.gravity.star(table, density=usual.density)
    print(f"from a table of {table.pieces} rows: {star}")
    assert abs(star.mass / usual.mass - 1) < 1e-4
    if options.picture:
        gt.pictures.save(stars.plot(), options.picture)


if __name__ == "__main__":
    main()
