"""Any tetrad: type four one-forms and compute their whole geometry, here of Ellis's wormhole.

    python examples/01_any_tetrad.py
    python examples/01_any_tetrad.py --throat 2 --at 1

Two flat spaces are joined by a throat of radius b. The distance s runs through it from one side to
the other. The tetrad belongs to a traveller: clock, straight on, along meridian and parallel.
"""

import argparse
from fractions import Fraction

import sympy as sp

import geomtorsion as gt


def wormhole() -> gt.Frame:
    """The frame: coordinates, then one row of coefficients per one-form."""
    t, s, theta, phi = sp.symbols("t s theta phi", real=True)
    b = sp.Symbol("b", positive=True)  # not a coordinate, so it is a parameter
    radius = sp.sqrt(s**2 + b**2)
    coframe = [
        [1, 0, 0, 0],  # dt
        [0, 1, 0, 0],  # ds
        [0, 0, radius, 0],  # radius dtheta
        [0, 0, 0, radius * sp.sin(theta)],  # radius sin(theta) dphi
    ]
    return gt.Frame(
        [t, s, theta, phi], coframe, signature=(-1, 1, 1, 1), domain=(theta > 0, theta < sp.pi)
    )


def main(arguments: list[str] | None = None) -> None:
    """Print the quantities of the frame, then compare them with the textbook."""
    parser = argparse.ArgumentParser(description="Geometry of Ellis's wormhole.")
    parser.add_argument("--throat", type=Fraction, default=Fraction(2), help="radius of the throat")
    parser.add_argument("--at", type=Fraction, default=Fraction(1), help="distance from the throat")
    options = parser.parse_args(arguments)

    frame = wormhole()
    print(frame.metric)
    print(frame.anholonomy)

    print("\nCartan's connection: the legs are parallel, so it is flat, but it has torsion.")
    cartan = gt.cartan(frame)
    print(cartan.coefficients)
    torsion = cartan.torsion
    print(torsion.S.in_frame())  # the traveller measures frame components
    for part in (torsion.vector, torsion.axial, torsion.tensor, torsion.scalar):
        print(part.in_frame())
    print(cartan.contortion.in_frame())

    print("\nLevi-Civita's connection: no torsion, but curvature.")
    bar = gt.levi_civita(frame)
    print(bar.coefficients)
    curvature = bar.curvature
    for tensor in (curvature.riemann, curvature.ricci, curvature.einstein, curvature.weyl):
        print(tensor.in_frame())
    print(curvature.scalar)
    print(curvature.kretschmann)

    print("\nIdentities that each connection must obey:")
    for connection in (cartan, bar):
        for identity in gt.identities(connection):
            print(identity)
            assert identity.holds, identity

    # Numbers come last, and only where a value is requested.
    s, (b,) = frame.coordinates[1], frame.parameters
    number = float(curvature.kretschmann.at({s: options.at, b: options.throat}))
    print(f"\nKretschmann scalar at s = {options.at} for b = {options.throat}: {number:.6g}")

    # The known answer [Ellis 1973; Morris, Thorne 1988]: Ricci has only one component, R_ss. It is
    # negative, so only matter of negative energy can hold the throat open.
    size = (s**2 + b**2) ** 2
    assert cartan.curvature.is_zero
    assert torsion.axial.is_zero
    assert curvature.ricci.nonzero().keys() == {(1, 1)}
    assert sp.cancel(curvature.ricci[1, 1] + 2 * b**2 / size) == 0
    assert sp.cancel(curvature.kretschmann[()] - 12 * b**4 / size**2) == 0
    assert sp.cancel(curvature.einstein[0, 0] + b**2 / size) == 0, "energy density below zero"
    print("Ricci = -2 b^2 / (s^2 + b^2)^2 ds ds and Kretschmann = 12 b^4 / (s^2 + b^2)^4, as known")


if __name__ == "__main__":
    main()
