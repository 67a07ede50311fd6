"""axial_torsion: flat space with constant totally antisymmetric torsion, Cartan's staircase."""

from sympy import LeviCivita, Symbol, symbols

from geomtorsion.geometry import Frame, from_contortion
from geomtorsion.spaces.space import KnownAnswer, Space, alternating, diagonal


def space(name: str) -> Space:
    """The Cartesian coframe and the connection with contortion K_ab^c = lambda eps_abc."""
    x, y, z = symbols("x y z", real=True)
    pitch = Symbol("lambda", positive=True)
    frame = Frame((x, y, z), [[1, 0, 0], [0, 1, 0], [0, 0, 1]], parameters=(pitch,), name=name)
    contortion = [
        [[pitch * LeviCivita(a, b, c) for c in range(3)] for b in range(3)] for a in range(3)
    ]
    curvature = {
        (m, n, k, p): pitch**2 * ((n == p) * (k == m) - (m == p) * (k == n))
        for m in range(3)
        for n in range(3)
        for k in range(3)
        for p in range(3)
        if m != n and {k, p} == {m, n}
    }
    return Space(
        name,
        story=(
            "A traveller on a straight path rotates about it at a constant rate.\n"
            "Autoparallels are straight lines; vectors transported along them rotate."
        ),
        source="E. Cartan, C. R. Acad. Sci. Paris 174 (1922) 593; "
        "M. Lazar, F. W. Hehl, Found. Phys. 40 (2010) 1298",
        frame=frame,
        known=(
            KnownAnswer("torsion", {}),
            KnownAnswer("connection", alternating({(0, 1, 2): pitch})),
            KnownAnswer("connection_torsion", alternating({(0, 1, 2): pitch})),
            KnownAnswer("connection_contortion", alternating({(0, 1, 2): pitch})),
            KnownAnswer("connection_curvature", curvature),
            KnownAnswer("connection_ricci", diagonal([-2 * pitch**2] * 3)),
            KnownAnswer("connection_scalar", -6 * pitch**2),
        ),
        group="defects in crystals",
        notes="The connection is not the Cartan connection of the frame (that one is trivial here) "
        "and has curvature: `space.connection` carries it.",
        connection=from_contortion(frame, contortion),
    )
