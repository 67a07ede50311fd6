"""schwarzschild_isotropic: the black hole in isotropic coordinates, legs along x, y, z."""

from sympy import Symbol, sqrt, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import KnownAnswer, Space, antisymmetric, diagonal


def space(name: str, title: str) -> Space:
    """Coframe (h dt, w dx, w dy, w dz), w = (1 + M/2s)^2, h = (1 - M/2s)/(1 + M/2s)."""
    t, x, y, z = symbols("t x y z", real=True)
    place = (x, y, z)
    mass = Symbol("M", positive=True)
    s = sqrt(x**2 + y**2 + z**2)
    inner, outer = 1 - mass / (2 * s), 1 + mass / (2 * s)
    height, width = inner / outer, outer**2
    frame = Frame(
        (t, x, y, z),
        [[height, 0, 0, 0], [0, width, 0, 0], [0, 0, width, 0], [0, 0, 0, width]],
        signature=(-1, 1, 1, 1),
        parameters=(mass,),
        # Outside the horizon s = M/2.
        domain=4 * (x**2 + y**2 + z**2) > mass**2,
        name=name,
    )
    torsion = {}
    for k, along in enumerate(place, start=1):
        torsion[k, 0, 0] = mass * along / (2 * s**3 * outer**3 * inner)
        for j in range(1, 4):
            if j != k:
                torsion[k, j, j] = -mass * along / (2 * s**3 * outer**3)
    return Space(
        name,
        title,
        story=(
            "The same black hole with legs along x, y, z, which far away are those of flat space.\n"
            "A proper tetrad: its torsion is gravity alone and vanishes with the mass."
        ),
        source="C. W. Misner, K. S. Thorne, J. A. Wheeler, Gravitation (1973), chapter 31 "
        "(isotropic coordinates)",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([-(height**2), width**2, width**2, width**2])),
            KnownAnswer("determinant", inner * outer**5),
            KnownAnswer("torsion", antisymmetric(torsion), basis="frame"),
            KnownAnswer("torsion_axial", {}),
            KnownAnswer("ricci", {}),
            KnownAnswer("kretschmann", 48 * mass**2 / (s * outer**2) ** 6),
        ),
        group="gravity",
        notes="Signature (-, +, +, +), G = c = 1; s > M/2 is the outside.",
    )
