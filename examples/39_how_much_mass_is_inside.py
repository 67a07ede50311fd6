"""Mass, spin and charge inside a surface: Komar, quasi-local and teleparallel, and horizons.

    python examples/39_how_much_mass_is_inside.py
    python examples/39_how_much_mass_is_inside.py --picture masses.png

The Burgers vector is the integral of a form around a loop. The mass is the integral of a form over
a sphere. The definitions agree far outside and differ near a hole.
"""

import argparse
from pathlib import Path

import sympy as sp

from geomtorsion import gravity, pictures


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="How much mass is inside?")
    parser.add_argument("--picture", type=Path, help="file for a figure")
    options = parser.parse_args(arguments)

    mass = gravity.charge("kerr")
    spin = gravity.charge("kerr", killing="phi")
    print(mass, spin, sep="\n")
    assert mass.conserved
    assert spin.conserved
    assert (str(mass.value), str(spin.value)) == ("M", "M*a")

    # The electric field of a charged hole has energy outside of the sphere.
    charged = gravity.charge("kerr_newman")
    print(charged)
    assert not charged.conserved

    # Two definitions give the same energy inside a sphere: r (1 - sqrt(1 - 2M/r)).
    local = gravity.charge("schwarzschild", "brown-york")
    legs = gravity.charge("schwarzschild", "teleparallel", reference={"M": 0})
    print(local, legs, sep="\n")
    for r in (3, 10, 100):
        truth = float(r * (1 - sp.sqrt(1 - sp.Rational(2, r))))
        for one in (local, legs):
            assert abs(one.at({"M": 1, "r": r}) - truth) < 1e-12

    # Horizons: dM = T dS + Omega dJ.
    (hole,) = gravity.horizons("kerr")
    print(hole)
    ((_, total),) = hole.relation.items()
    r, a = sp.symbols("r a", positive=True)
    names = {x: {"r": r, "a": a}[x.name] for x in total.free_symbols}
    total, heat, turn, entropy = (
        sp.Add(x).xreplace(names)
        for x in (total, hole.temperature, hole.angular_velocity, hole.entropy)
    )
    for x in (r, a):
        work = heat * entropy.diff(x) + turn * (total * a).diff(x)
        assert sp.simplify(total.diff(x) - work) == 0

    for one in gravity.horizons("kerr", parameters={"M": 1, "a": "3/5"}):
        print(one)
    if options.picture:
        flat = gravity.charge("schwarzschild")
        figure = pictures.draw_charge([local, flat], parameters={"M": 1}, radii=(2, 20))
        pictures.save(figure, options.picture)


if __name__ == "__main__":
    main()
