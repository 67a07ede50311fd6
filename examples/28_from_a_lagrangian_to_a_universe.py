"""From a Lagrangian to a universe: five theories, reduced, solved and compared.

    python examples/28_from_a_lagrangian_to_a_universe.py
    python examples/28_from_a_lagrangian_to_a_universe.py --last 5

Each theory is a Lagrangian on a frame with an unknown scale factor a(t). The field equations are
reduced to first-order equations; a constraint completes the start and stays as an invariant. The
universe of general relativity and the bounce of dust with spin have closed forms. Where T and Q
have the same value, f(T) and f(Q) give the same universe. A static black hole has no scalar hair:
a field that is regular at the horizon is constant.
"""

import argparse
import math
from collections.abc import Mapping

import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity

T, X, Y, Z = sp.symbols("t x y z")
A = sp.Function("a")(T)
COSMOS = gt.Frame([T, X, Y, Z], sp.diag(1, A, A, A), signature=(-1, 1, 1, 1))
DUST = gravity.fluid("rho(t)", 0, [1, 0, 0, 0])


def solved(
    name: str,
    equations: gravity.FieldEquations,
    last: float,
    start: Mapping[str, object],
    parameters: Mapping[str, object],
    near: Mapping[str, object],
) -> float:
    """The scale factor at the end; the drift of the constraint stays below the error."""
    solution = gravity.solve(equations, "t", last, start, parameters, near=near)
    drift = max(solution.drift.values())
    size = float(solution["a"][-1])
    print(f"{name:20} a({last:g}) = {size:.10f}  error {solution.error:.1e}  drift {drift:.1e}")
    assert drift <= solution.error
    return size


def accelerated(last: float) -> None:
    """Dust and a cosmological constant against a = (m/l)^(1/3) sinh^(2/3)(3 sqrt(l) t/2)."""
    matter, dark = 0.3, 0.7
    equations = gravity.equations(gt.levi_civita(COSMOS), "R/2 - Lambda", DUST)
    print(equations.reduce("t"), "\n")
    start, parameters = {"a": 1, "rho": "9/10"}, {"Lambda": "21/10"}
    size = solved("Lambda and dust", equations, last, start, parameters, {"a_1": 1})
    age = 2 / 3 / math.sqrt(dark) * math.asinh(math.sqrt(dark / matter))
    phase = 1.5 * math.sqrt(dark) * (last + age)
    exact = (matter / dark) ** (1 / 3) * math.sinh(phase) ** (2 / 3)
    assert abs(size / exact - 1) < 1e-9, "the closed form agrees"


def modified(last: float) -> None:
    """f(T) and f(Q) with one function, and Starobinsky's f(R), an equation of fourth order."""
    start, parameters = {"a": 1, "rho": "3.54"}, {"c": "1/100"}
    torsion = gravity.equations(gt.cartan(COSMOS), "-(T + c*T**2)/2", DUST)
    one = solved("T + c T^2", torsion, last, start, parameters, {"a_1": 1})
    flat = gt.from_coefficients(COSMOS, [[[0] * 4] * 4] * 4)
    nonmetric = gravity.equations(flat, "-(Q + c*Q**2)/2", DUST)
    two = solved("Q + c Q^2", nonmetric, last, start, parameters, {"a_1": 1})
    assert abs(one / two - 1) < 1e-9, "T = Q = 6 H^2 here"
    curvature = gravity.equations(gt.levi_civita(COSMOS), "R + R**2/(6*M**2)")
    inflation = {"a": 1, "a_1": 1, "a_2": "0.98"}
    solved("R + R^2/(6 M^2)", curvature, last, inflation, {"M": "1/2"}, {})


def bounce(last: float) -> None:
    """Einstein and Cartan: torsion is unknown, and dust with spin turns collapse into a bounce."""
    tau = COSMOS.scalar(sp.Function("tau")(T)).element()
    torsion = gt.Tensor(COSMOS, "DDU", {(1, 2, 0): tau, (2, 1, 0): -tau})
    spin = [[0] * 4, [0, 0, "sigma(t)", 0], [0, "-sigma(t)", 0, 0], [0] * 4]
    dust = gravity.weyssenhoff("rho(t)", 0, [1, 0, 0, 0], spin)
    equations = gravity.equations(gt.from_torsion(COSMOS, torsion), "R/2", dust)
    start = {"a": sp.Rational(1, 4) ** sp.Rational(1, 3), "a_1": 0, "rho": 4, "sigma": 4}
    size = solved("dust with spin", equations, last, start, {}, {})
    assert abs(size / (1 / 4 + 3 * last**2 / 4) ** (1 / 3) - 1) < 1e-9, "the closed form agrees"


def hair() -> float:
    """The change of r^2 psi' A/B, which is constant for a scalar field around a static hole."""
    t, r, theta, phi = sp.symbols("t r theta phi")
    A, B = (sp.Function(name)(r) for name in "AB")
    static = sp.diag(A, B, r, r * sp.sin(theta))
    frame = gt.Frame([t, r, theta, phi], static, signature=(-1, 1, 1, 1))
    field = gravity.scalar_field("psi(r)", name="psi")
    equations = gravity.equations(gt.levi_civita(frame), "R/2 - X/2", field)
    start = {"A": 1, "B": 1, "psi": 0, "psi_1": "1/100"}
    charge = {"charge": "r**2*psi_1*A/B"}
    solution = gravity.solve(equations, "r", 1.0, start, origin=10, outputs=charge)
    values = solution["charge"]
    print(f"r^2 psi' A/B = {values[0]:.6f} at r = 10, {values[-1]:.6f} at r = 1")
    return abs(values[-1] / values[0] - 1)


def main(arguments: list[str] | None = None) -> None:
    """Solve all theories and compare them with closed forms and with each other."""
    parser = argparse.ArgumentParser(description="From a Lagrangian to a universe.")
    parser.add_argument("--last", type=float, default=2.0, help="the last time")
    last = parser.parse_args(arguments).last
    accelerated(last)
    modified(last)
    bounce(last)
    assert hair() < 1e-9, "the charge of the field is constant"


if __name__ == "__main__":
    main()
