"""Stars from a metric ansatz and a fluid, from their centre to their surface."""

import math

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GravityError, StartError

T, R, THETA, PHI = sp.symbols("t r theta phi")
AT_REST = [1, 0, 0, 0]
A, B = (sp.Function(name)(R) for name in "AB")
STATIC = gt.Frame([T, R, THETA, PHI], sp.diag(A, B, R, R * sp.sin(THETA)), (-1, 1, 1, 1))
# A tetrad whose spin connection vanishes: the radial leg turns with the sphere.
RADIAL = sp.Matrix([sp.sin(THETA) * sp.cos(PHI), sp.sin(THETA) * sp.sin(PHI), sp.cos(THETA)])
PROPER = gt.Frame(
    [T, R, THETA, PHI],
    sp.diag(A, sp.Matrix.hstack(B * RADIAL, R * RADIAL.diff(THETA), R * RADIAL.diff(PHI))),
    (-1, 1, 1, 1),
)
MASS = {"m": "r*(1 - 1/B**2)/2"}
SURFACE = [gt.When("p")]
CLOSE = 1e-9


def star(density: str) -> g.Reduction:
    """A star in general relativity, kappa = 8 pi."""
    fluid = g.fluid(density, "p(r)", AT_REST)
    return g.equations(gt.levi_civita(STATIC), "R/(16*pi)", fluid).reduce("r")


@pytest.mark.parametrize(
    ("connection", "lagrangian"),
    [(gt.levi_civita(STATIC), "R/(2*kappa)"), (gt.cartan(PROPER), "-T/(2*kappa)")],
)
def test_constant_density_is_schwarzschilds_interior(
    connection: gt.Connection, lagrangian: str
) -> None:
    """(1 + p)/(1 + 3 p) = sqrt(1 - rho R^2/3) at the surface, for kappa = rho = 1; m = R^3/6."""
    fluid = g.fluid("rho0", "p(r)", AT_REST)
    equations = g.equations(connection, lagrangian, fluid)
    solution = g.solve(
        equations,
        "r",
        5,
        {"p": "1/10", "A": 1},
        {"kappa": 1, "rho0": 1},
        near={"B": 1},
        outputs=MASS,
        events=SURFACE,
    )
    radius = math.sqrt(3 * (1 - (1.1 / 1.3) ** 2))
    assert solution.stopped_by == "p"
    assert solution.error <= solution.accuracy
    assert float(solution["r"][-1]) == pytest.approx(radius, rel=CLOSE)
    assert float(solution["m"][-1]) == pytest.approx(radius**3 / 6, rel=CLOSE)
    root = math.sqrt(1 - radius**2 / 3)
    assert float(solution["A"][-1]) == pytest.approx(2 * root / (3 * root - 1), rel=CLOSE)


@pytest.mark.parametrize("density", ["1e-12", "1e12"])
def test_stars_of_any_size(density: str) -> None:
    """The radius of a star of constant density scales with 1/sqrt(rho)."""
    pressure = sp.Rational(density) / 10
    start, numbers = {"p": pressure, "A": 1}, {"rho0": density}
    scale = float(density) ** -0.5
    solution = g.solve(star("rho0"), "r", 10 * scale, start, numbers, near={"B": 1}, events=SURFACE)
    radius = math.sqrt(3 * (1 - (1.1 / 1.3) ** 2) / (8 * math.pi))
    assert float(solution["r"][-1]) / scale == pytest.approx(radius, rel=1e-8)


def test_the_equations_of_tolman_oppenheimer_and_volkoff() -> None:
    """The pressure follows p' = - (rho + p) A'/A, from the Noether identity of the fluid."""
    reduced = star("rho0")
    rates = reduced.rates
    symbols = {x.name: x for x in rates["p"].free_symbols | rates["A"].free_symbols}
    p, rho, size = (symbols[name] for name in ("p", "rho0", "A"))
    assert sp.simplify(rates["p"] + (rho + p) * rates["A"] / size) == 0
    assert reduced.constraints == ()


def test_a_neutron_star_of_a_polytrope() -> None:
    """K = 100, Gamma = 2, central rest-mass density 1.28e-3: M = 1.400, R = 9.586 (Font 2002)."""
    reduced = star("sqrt(p(r)/K) + p(r)")
    pressure = 100 * 1.28e-3**2
    solution = g.solve(
        reduced, "r", 30, {"p": pressure, "A": 1}, {"K": 100}, near={"B": 1}, outputs=MASS,
        events=SURFACE,
    )  # fmt: skip
    mass, radius = float(solution["m"][-1]), float(solution["r"][-1])
    assert mass == pytest.approx(1.400, abs=1e-3)
    assert radius == pytest.approx(9.586, abs=1e-3)

    def rates(r: float, y: np.ndarray) -> list[float]:
        p, m = y
        density = math.sqrt(max(p, 0.0) / 100) + p
        slope = -(density + p) * (m + 4 * math.pi * r**3 * p) / (r * (r - 2 * m))
        return [slope, 4 * math.pi * r**2 * density]

    # Below the surface, where the square root of the pressure is smooth.
    inside, near = 8.0, 1e-3
    density = math.sqrt(pressure / 100) + pressure
    first = [pressure, 4 * math.pi * near**3 * density / 3]
    options = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-16}
    other = solve_ivp(rates, (near, inside), first, **options).y[:, -1]
    here = solution.at(inside - float(solution["r"][0]))
    assert float(here["m"]) == pytest.approx(other[1], rel=1e-7)


def test_a_mass_has_a_largest_value() -> None:
    """Denser stars of one polytrope are smaller, and their mass has a maximum near 1.64."""
    reduced = star("sqrt(p(r)/K) + p(r)")
    masses, radii = [], []
    for density in (1e-3, 2e-3, 3.2e-3, 6e-3):
        solution = g.solve(
            reduced, "r", 40, {"p": 100 * density**2, "A": 1}, {"K": 100}, near={"B": 1},
            outputs=MASS, events=SURFACE, accuracy=1e-8,
        )  # fmt: skip
        masses.append(float(solution["m"][-1]))
        radii.append(float(solution["r"][-1]))
    assert radii == sorted(radii, reverse=True)
    assert max(masses) == masses[2] == pytest.approx(1.637, abs=2e-3)


def test_a_centre_of_flat_space_is_regular() -> None:
    """Without matter the regular solution with B(0) = 1 is flat."""
    flat = g.equations(gt.levi_civita(STATIC), "R").reduce("r")
    place, values = flat.begin({"A": 1}, near={"B": 1})
    assert place > 0
    assert values == {"A": 1, "B": 1}


def test_refusals() -> None:
    """A centre needs regular values; a higher pole needs a start beside it."""
    reduced = star("rho0")
    with pytest.raises(StartError, match="got B = -1 or 1"):
        reduced.begin({"p": 1, "A": 1}, {"rho0": 1})
    with pytest.raises(StartError, match="Omit one of the values"):
        reduced.begin({"p": 1, "A": 1, "B": 2}, {"rho0": 1})
    quadratic = g.equations(gt.levi_civita(STATIC), "R + c*R**2").reduce("r")
    with pytest.raises(GravityError, match="without a pole"):
        quadratic.begin({"A": 1, "B": 1}, {"c": 1})
