"""Theories of your own: invariants written with indices, and all torsion with a symmetry.

    python examples/27_theories_of_your_own.py
    python examples/27_theories_of_your_own.py --dimension 8

Four theories whose Lagrangians have no name in the library: the third Lovelock invariant, a massive
vector field (Proca), a scalar field that is coupled to the Einstein tensor (Horndeski), and the
most general torsion of an expanding universe.
"""

import argparse
from math import prod

import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity

LOVELOCK = (
    "-2 R^abcd R_cdef R^ef_ab - 8 R^ab_ce R^cd_bf R^ef_ad + 24 R^abcd R_cdbe R^e_a"
    " + 3 R^abcd R_abcd R - 24 R^abcd R_ac R_bd + 16 R^ab R_bc R^c_a - 12 R^ab R_ab R + R^3"
)


def cosmos(n: int, *scales: str) -> gt.Frame:
    """A universe that expands along each axis by a scale factor; scale factors repeat."""
    t, *axes = sp.symbols(f"t x1:{n}")
    sizes = [sp.Function(scales[k % len(scales)])(t) for k in range(n - 1)]
    return gt.Frame([t, *axes], sp.diag(1, *sizes), (-1,) + (1,) * (n - 1))


def lovelock(n: int) -> None:
    """The third Lovelock invariant vanishes in four dimensions, but not in seven or more."""
    own = gravity.invariant("L3", LOVELOCK)
    four = gravity.equations(gt.levi_civita(cosmos(4, "a", "b", "c")), "L3", invariants=own)
    print("third Lovelock invariant: zero in four dimensions:", four.L.is_zero)
    frame = cosmos(n, "a")
    H = sp.diff(frame.coframe[1, 1], frame.coordinates[0]) / frame.coframe[1, 1]
    energy = gravity.equations(gt.levi_civita(frame), "L3", invariants=own).E[0, 0]
    print(f"in {n} dimensions E_1^1 =", energy)
    assert four.L.is_zero
    assert frame.scalar(energy) == prod(range(n - 6, n)) * H**6


def proca() -> None:
    """A charge of a massive vector field has Yukawa's potential exp(-m r)/r."""
    t, r, theta, phi = sp.symbols("t r theta phi")
    legs = sp.diag(1, 1, r, r * sp.sin(theta))
    flat = gt.Frame([t, r, theta, phi], legs, signature=(-1, 1, 1, 1))
    field = gravity.maxwell(["exp(-m*r)/r", 0, 0, 0])
    mass = gravity.invariant("Y", "A_a A^a")
    lagrangian = "-F2/4 - m**2*Y/2"
    equations = gravity.equations(gt.levi_civita(flat), lagrangian, field, invariants=mass)
    print("Yukawa's potential solves Proca's equation:", equations.matter_equations["A"].is_zero)
    assert equations.matter_equations["A"].is_zero


def horndeski() -> None:
    """A scalar field on which only its gradient acts has a conserved current."""
    frame = cosmos(4, "a")
    t, a = frame.coordinates[0], frame.coframe[1, 1]
    own = gravity.invariant("Y", "G^ab phi_a phi_b")
    equations = gravity.equations(
        gt.levi_civita(frame), "R/2 - X/2 + c*Y/2", gravity.scalar_field("u(t)"), invariants=own
    )
    H, slope, c = sp.diff(a, t) / a, sp.diff(sp.Function("u")(t), t), sp.Symbol("c")
    print("with G^ab phi_a phi_b: E_1^1 =", equations.E[0, 0])
    current = a**3 * slope * (1 + 3 * c * H**2)
    assert equations.matter_equations["phi"] == -sp.diff(current, t) / a**3


def torsion() -> list[sp.Expr]:
    """Two functions describe all torsion of a universe: their values without spin."""
    frame = cosmos(4, "a")
    S = gravity.invariant_torsion(frame)
    print(S.table())
    equations = gravity.equations(gt.from_torsion(frame, S), "R + c*vector2")
    left = set(equations.C.nonzero().values())
    print("the connection equation of R + c*vector2:", *left, sep="\n  ")
    assert all(check.holds for check in equations.identities())
    unknown = [sp.Function(name)(frame.coordinates[0]) for name in ("u1", "u2")]
    [solution] = sp.solve(left, unknown, dict=True)
    return [solution[u] for u in unknown]


def main(arguments: list[str] | None = None) -> None:
    """Four theories, each with a known answer."""
    parser = argparse.ArgumentParser(description="Theories of your own.")
    parser.add_argument("--dimension", type=int, default=7, help="for Lovelock, 7 or more")
    options = parser.parse_args(arguments)
    lovelock(options.dimension)
    proca()
    horndeski()
    values = torsion()
    print("torsion without spin:", *values)
    assert values == [0, 0]


if __name__ == "__main__":
    main()
