"""Is it a new solution? Two tetrads, one geometry; and the name of a metric in disguise.

    python examples/31_is_it_a_new_solution.py
    python examples/31_is_it_a_new_solution.py --radius 5

Torsion and curvature along the legs, and their derivatives, are all the invariants of a geometry
(Cartan 1946, Karlhede 1980). Where they agree, two sets of formulas are one geometry.
"""

import argparse

import sympy as sp

import geomtorsion as gt

MASS = sp.Rational(1, 3)


def teleparallel_twins() -> None:
    """Two tetrads of one black hole: one metric, and one torsion only if the legs agree."""
    one, falling, isotropic = (
        gt.spaces.load(name).frame.subs({"M": MASS})
        for name in ("schwarzschild_cartesian", "schwarzschild_falling", "schwarzschild_isotropic")
    )
    assert gt.same_geometry(one, falling).verdict == "same"
    assert gt.same_geometry(one, falling, "legs").verdict == "different"
    result = gt.same_geometry(one, isotropic, "legs")
    print(result)
    assert result.verdict == "same", "the legs agree in other coordinates"


def isotropic_radius(radius: float) -> float:
    """The map between two charts of a black hole, against its closed form."""
    one, two = (
        gt.spaces.load(name).frame.subs({"M": MASS})
        for name in ("schwarzschild", "schwarzschild_isotropic")
    )
    result = gt.same_geometry(one, two)
    assert result.match is not None
    start = {str(q): float(value) for q, value in result.match.start.items()}
    image = result.map({**start, "r": radius})
    rho = sum(image[q] ** 2 for q in "xyz") ** 0.5
    mass = float(MASS)
    exact = (radius - mass + (radius**2 - 2 * mass * radius) ** 0.5) / 2
    print(f"r = {radius} is rho = {rho:.12f}, exact {exact:.12f}, error {image.error:.0e}")
    return abs(rho - exact)


def disguise() -> str:
    """A rotating black hole in crooked coordinates, without its tetrad."""
    m = sp.Symbol("m", positive=True)
    u, v, w, z = sp.symbols("u v w z", real=True)
    kerr = gt.spaces.load("kerr").frame.subs({"M": m, "a": m / 2})
    t, r, theta, phi = kerr.coordinates
    crooked = kerr.in_coordinates(
        [u, v, w, z], {t: u + v / 3, r: v + 1, theta: w, phi: z + u}, domain=(v > 5 * m,)
    )
    name = str(gt.spaces.identify(crooked))
    print(name)
    return name


def main(arguments: list[str] | None = None) -> None:
    """Twins are recognised, the map is exact, and the disguise has a name."""
    parser = argparse.ArgumentParser(description="Is it a new solution?")
    parser.add_argument("--radius", type=float, default=3.0, help="at which the map is compared")
    options = parser.parse_args(arguments)
    teleparallel_twins()
    assert isotropic_radius(options.radius) < 1e-9, "the map agrees with its closed form"
    assert "M = m, a = m/2" in disguise()


if __name__ == "__main__":
    main()
