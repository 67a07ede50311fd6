"""Field equations of a tetrad: f(T) cosmology, and a test of the tetrad by the antisymmetric part.

    python examples/20_field_equations_of_a_tetrad.py
    python examples/20_field_equations_of_a_tetrad.py --lagrangian "T + c*T**2"

Three formulas that hold for every Lagrangian give the field equations; f stays unknown.
In the coframe (dt, a dx, a dy, a dz) the antisymmetric part of the equations vanishes. The coframe
(dt, a dr, a r dtheta, a r sin(theta) dphi) has the same metric and fails: its legs turn from point
to point, and the connection in which they are parallel does not have the symmetry of the cosmos.
"""

import argparse

import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity


def main(arguments: list[str] | None = None) -> None:
    """Print the equations of both tetrads and check them against known equations."""
    parser = argparse.ArgumentParser(description="Field equations of a Lagrangian of torsion.")
    parser.add_argument("--lagrangian", default="f(T)")
    lagrangian = parser.parse_args(arguments).lagrangian

    t, x, y, z = sp.symbols("t x y z")
    a = sp.Function("a")(t)
    cosmos = gt.Frame([t, x, y, z], sp.diag(1, a, a, a), (-1, 1, 1, 1))
    found = gravity.equations(gt.cartan(cosmos), lagrangian)
    print("T =", found.scalar("T")[()])
    print("E_t^t =", found.E[0, 0])
    print("antisymmetric part:", found.antisymmetric.nonzero() or 0)
    for identity in found.identities():
        print(identity)

    r, theta, phi = sp.symbols("r theta phi")
    polar = sp.diag(1, a, a * r, a * r * sp.sin(theta))
    bad = gt.Frame([t, r, theta, phi], polar, (-1, 1, 1, 1))
    antisymmetric = gravity.equations(gt.cartan(bad), lagrangian).antisymmetric
    print("\nthe diagonal tetrad in spherical coordinates: antisymmetric part")
    print(antisymmetric.table())

    # Known: T = 6 H^2, E_t^t = f - 12 H^2 f', and f(T) = T is general relativity in any tetrad.
    H = sp.diff(a, t) / a
    assert found.scalar("T") == 6 * H**2
    powers = gravity.equations(gt.cartan(cosmos), "T**3")
    assert powers.frame.scalar(powers.E[0, 0]) == (6 * H**2) ** 3 - 12 * H**2 * 3 * (6 * H**2) ** 2
    for frame in (cosmos, bad):
        plain = gravity.equations(gt.cartan(frame), gravity.tegr)
        einstein = gt.levi_civita(frame).curvature.einstein.in_frame()
        assert (plain.E.lowered() - einstein * 2).is_zero
    print("\nE = 2 G for f(T) = T in both")


if __name__ == "__main__":
    main()
