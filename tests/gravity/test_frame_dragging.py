"""Frame dragging by slow rotation, from field equations at first order in the angular velocity."""

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity as g

T, R, THETA, PHI = COORDINATES = sp.symbols("t r theta phi")
RATE, OMEGA = sp.symbols("epsilon Omega")
A, B, P, RHO, W = (sp.Function(name)(R) for name in ("A", "B", "p", "rho", "w"))
STATIC = sp.diag(A, B, R, R * sp.sin(THETA))
RADIAL = sp.Matrix([sp.sin(THETA) * sp.cos(PHI), sp.sin(THETA) * sp.sin(PHI), sp.cos(THETA)])
PROPER = sp.diag(
    A, sp.Matrix.hstack(B * RADIAL, R * RADIAL.diff(THETA), R * RADIAL.diff(PHI))
)  # fmt: skip


def rotating(legs: sp.Matrix, lagrangian: str) -> g.FieldEquations:
    """A star that rotates with Omega, in whose frame the star rotates with w."""
    rows = legs.copy()
    rows[:, 0] += RATE * (W - OMEGA) * legs[:, 3]
    frame = gt.Frame(COORDINATES, rows, "-+++", parameters=[RATE, OMEGA]).expanded(RATE, 1)
    velocity = list((rows[:, 0] + RATE * OMEGA * legs[:, 3]) / A)
    connection = gt.levi_civita(frame) if legs is STATIC else gt.cartan(frame)
    return g.equations(connection, lagrangian, g.fluid(RHO, P, velocity))


def azimuthal(equations: g.FieldEquations, legs: sp.Matrix) -> sp.Expr:
    """E_(t phi) at first order, along unit vectors."""
    first = equations.E.order(1)
    column = legs[:, 3] / (R * sp.sin(THETA))
    return sum(first[0, k] * column[k] for k in range(1, 4))


def drag(weight: sp.Expr) -> sp.Expr:
    """(r^4 F j w')' - 16 pi r^4 j B^2 (rho + p) w with j = 1/(A B), F = df/dR."""
    j = 1 / (A * B)
    return (R**4 * weight * j * W.diff(R)).diff(R) - 16 * sp.pi * R**4 * j * B**2 * (RHO + P) * W


@pytest.mark.parametrize(
    ("legs", "lagrangian"),
    [(STATIC, "R/(16*pi)"), (PROPER, "-T/(16*pi)"), (STATIC, "(R + c*R**2)/(16*pi)")],
    ids=["metric", "teleparallel", "square"],
)
def test_dragging_follows_from_the_field_equations(legs: sp.Matrix, lagrangian: str) -> None:
    """Hartle's equation (1967), and the one of f(R) (Staykov et al. 2014)."""
    equations = rotating(legs, lagrangian)
    assert equations.antisymmetric.order(1).is_zero
    weight = sp.S.One
    if "c" in lagrangian:
        still = gt.Frame(COORDINATES, STATIC, "-+++")
        weight = 1 + 2 * sp.Symbol("c") * still.quantity("scalar_curvature")[()]
    scale = sp.sin(THETA) / (16 * sp.pi * B * R**3)
    residual = azimuthal(equations, legs) - scale * drag(weight)
    assert sp.simplify(residual.subs(sp.Symbol("c", real=True), sp.Symbol("c"))) == 0


def test_a_square_of_torsion_needs_more_than_dragging() -> None:
    """The antisymmetric equation does not vanish: the tetrad has to be boosted as well."""
    assert not rotating(PROPER, "-(T + c*T**2)/(16*pi)").antisymmetric.order(1).is_zero
