"""Section 2 of the paper: rotations in body-fixed axes, a space with torsion and no curvature.

    python examples/02_paper_so3.py
    python examples/02_paper_so3.py --order zxz

The generic classes derive torsion and curvature from the attitude of a rigid body. The only input
is the order of the three rotations. Indices count from 0 here, from 1 in the paper.
"""

import argparse

import sympy as sp

import geomtorsion as gt

PHI = phi1, phi2, phi3 = sp.symbols("phi1 phi2 phi3", real=True)


def turn(axis: str, angle: sp.Expr) -> sp.Matrix:
    """Rotation about a coordinate axis, counterclockwise."""
    k = "xyz".index(axis)
    generator = sp.Matrix(3, 3, lambda i, j: sp.LeviCivita(i, k, j))
    return sp.eye(3) + sp.sin(angle) * generator + (1 - sp.cos(angle)) * generator**2


def body_frame(order: str) -> gt.Frame:
    """Coframe e^i_mu of eq. (8): (R^T dR/dphi^mu)^vee, the angular velocity in body axes."""
    last, middle, first = order
    attitude = turn(last, phi3) * turn(middle, phi2) * turn(first, phi1)  # body to space
    spins = [attitude.T * attitude.diff(angle) for angle in PHI]
    rows = [[spin[(i + 2) % 3, (i + 1) % 3] for spin in spins] for i in range(3)]
    return gt.Frame(PHI, rows, domain=(phi2 > 0, phi2 < sp.pi))


def main(arguments: list[str] | None = None) -> None:
    """Print and check equations (5) to (12), one after the other."""
    parser = argparse.ArgumentParser(description="Section 2 of Fiziev and Kleinert.")
    parser.add_argument(
        "--order", choices=("zyz", "zxz"), default="zyz", help="axes of phi3, phi2, phi1"
    )
    frame = body_frame(parser.parse_args(arguments).order)
    print("(8)  coframe           ", frame.coframe)
    print("(9)  metric            ", frame.metric)
    print("(9)  inverse, not as printed: each entry needs 1/|g|", frame.inverse_metric)

    # The metric does not depend on the choice of frame: it describes a sphere S^3 of radius 2.
    bar = gt.levi_civita(frame)
    print("     Christoffel       ", bar.coefficients.lowered(2))
    print("     Ricci             ", bar.curvature.ricci)
    print("     scalar curvature  ", bar.curvature.scalar)

    # Cartan's connection keeps the body axes parallel: no curvature, but torsion.
    cartan = gt.cartan(frame)
    print("(10) Cartan connection ", cartan.coefficients)
    print("     Cartan curvature  ", cartan.curvature.riemann)
    print("     S_abc             ", cartan.torsion.S.lowered(2))
    print("(12) 2 S_ijk           ", cartan.torsion.T.in_frame().lowered(2))

    # The torsion force vanishes on this space: autoparallels are geodesics, uniform rotations.
    force = cartan.torsion.force(sp.symbols("w1 w2 w3"))
    print("     torsion force     ", force)

    torsion = cartan.torsion.T.in_frame().lowered(2)
    epsilon = {(i, j, k): sp.LeviCivita(i, j, k) for i, j, k in torsion.nonzero()}
    assert len(epsilon) == 6
    assert torsion.nonzero() == {index: -sign for index, sign in epsilon.items()}
    assert torsion == frame.anholonomy.lowered(2)
    assert cartan.curvature.is_zero
    assert force.is_zero
    assert bar.curvature.ricci == frame.metric / 2
    assert bar.curvature.scalar[()] == sp.Rational(3, 2)
    print("2 S_ijk = -eps_ijk, Cartan curvature 0, Ricci = g/2, R = 3/2, as in the paper")


if __name__ == "__main__":
    main()
