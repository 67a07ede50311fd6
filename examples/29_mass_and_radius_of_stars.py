"""Mass and radius of stars: from a metric ansatz and a fluid to a neutron star.

    python examples/29_mass_and_radius_of_stars.py
    python examples/29_mass_and_radius_of_stars.py --densities 1e-3,2e-3

The unknown functions are A(r), B(r) and the pressure p(r). The law of motion of the fluid follows
from a Noether identity, and the equations are named after Tolman, Oppenheimer and Volkoff. A power
series leads away from the centre, and the solution ends where the pressure vanishes. A star of
constant density is Schwarzschild's interior solution. The polytrope p = 100 rho^2 with the central
density 1.28e-3 has the published mass 1.400 and radius 9.586 (Font et al. 2002). The same star of
constant density is then solved for T + c T^2, and for R + c R^2 with the curvature at the centre.
"""

import argparse
import math
from collections.abc import Mapping

import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity

T, R, THETA, PHI = sp.symbols("t r theta phi")
A, B = (sp.Function(name)(R) for name in "AB")
STATIC = gt.Frame([T, R, THETA, PHI], sp.diag(A, B, R, R * sp.sin(THETA)), signature=(-1, 1, 1, 1))
# A tetrad whose spin connection vanishes: its radial leg turns with the sphere.
RADIAL = sp.Matrix([sp.sin(THETA) * sp.cos(PHI), sp.sin(THETA) * sp.sin(PHI), sp.cos(THETA)])
LEGS = sp.Matrix.hstack(B * RADIAL, R * RADIAL.diff(THETA), R * RADIAL.diff(PHI))
PROPER = gt.Frame([T, R, THETA, PHI], sp.diag(A, LEGS), signature=(-1, 1, 1, 1))
POLYTROPE = 100


def star(density: str) -> gravity.Reduction:
    """The equations of a star in general relativity, for units with G = c = 1."""
    fluid = gravity.fluid(density, "p(r)", [1, 0, 0, 0])
    return gravity.equations(gt.levi_civita(STATIC), "R/(16*pi)", fluid).reduce("r")


def torsion_star() -> gravity.Reduction:
    """The equations of a star of constant density for T + c T^2."""
    fluid = gravity.fluid("rho0", "p(r)", [1, 0, 0, 0])
    return gravity.equations(gt.cartan(PROPER), "-(T + c*T**2)/(16*pi)", fluid).reduce("r")


def curvature_star() -> gravity.Reduction:
    """The equations of a star of constant density for R + c R^2, with S = R as a function."""
    fluid = gravity.fluid("rho0", "p(r)", [1, 0, 0, 0])
    equations = gravity.equations(gt.levi_civita(STATIC), "(R + c*R**2)/(16*pi)", fluid)
    return equations.reduce("r", conditions=["S(r) = R"])


def mass_and_radius(
    reduced: gravity.Reduction,
    pressure: float,
    parameters: Mapping[str, object],
    **start: float,
) -> tuple[float, float]:
    """Mass and radius for a pressure at the centre, and further values there."""
    solution = gravity.solve(
        reduced,
        "r",
        100,
        {"A": 1, "p": pressure, **start},
        parameters,
        near={"B": 1},
        outputs={"m": "r*(1 - 1/B**2)/2"},
        events=[gt.When("p")],
        accuracy=1e-8,
    )
    return float(solution["m"][-1]), float(solution["r"][-1])


def curve(densities: list[float]) -> list[tuple[float, float]]:
    """Mass and radius of polytropes for densities at the centre."""
    reduced = star("sqrt(p(r)/K) + p(r)")
    constant = {"K": POLYTROPE}
    return [mass_and_radius(reduced, POLYTROPE * rho**2, constant) for rho in densities]


def main(arguments: list[str] | None = None) -> None:
    """A star of constant density, a published star, and masses and radii of others."""
    parser = argparse.ArgumentParser(description="Mass and radius of stars.")
    parser.add_argument("--densities", default="5e-4,1.28e-3,2e-3,3.2e-3,5e-3", help="at centres")
    densities = [float(x) for x in parser.parse_args(arguments).densities.split(",")]

    reduced = star("rho0")
    print(reduced, "\n")
    mass, radius = mass_and_radius(reduced, 1e-4, {"rho0": 1e-3})
    share = (1e-3 + 1e-4) / (1e-3 + 3e-4)
    exact = math.sqrt(3 * (1 - share**2) / (8 * math.pi * 1e-3))
    print(f"constant density: R = {radius:.10f}, exact {exact:.10f}\n")
    assert abs(radius / exact - 1) < 1e-7, "Schwarzschild's interior solution agrees"
    assert abs(mass / (4 / 3 * math.pi * 1e-3 * exact**3) - 1) < 1e-7

    print("polytropes: density at the centre, mass, radius")
    for density, (mass, radius) in zip(densities, curve(densities), strict=True):
        print(f"{density:10.2e} {mass:10.6f} {radius:10.6f}")
    [(mass, radius)] = curve([1.28e-3])
    assert abs(mass - 1.400) < 1e-3
    assert abs(radius - 9.586) < 1e-3

    print("\nconstant density in other theories: mass, radius")
    reduced = torsion_star()
    for c in (0, 10, 30):
        mass, radius = mass_and_radius(reduced, 1e-4, {"rho0": 1e-3, "c": c})
        print(f"T + {c:2} T^2            {mass:10.6f} {radius:10.6f}")
        assert abs(radius / exact - 1) < (1e-3 * c or 1e-7), "small terms change a star little"
    reduced = curvature_star()
    for S in (0.017, 0.018, 0.019):
        mass, radius = mass_and_radius(reduced, 1e-4, {"rho0": 1e-3, "c": -2}, S=S)
        print(f"R - 2 R^2, R(0) = {S} {mass:10.6f} {radius:10.6f}")


if __name__ == "__main__":
    main()
