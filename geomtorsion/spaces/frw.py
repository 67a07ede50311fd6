"""frw: the expanding universe with scale factor a(t), curved or flat."""

from sympy import Function, Rational, Symbol, cos, oo, pi, sin, sqrt, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.embedding import orbit_embedding
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, box, diagonal

SOURCE = "C. W. Misner, K. S. Thorne, J. A. Wheeler, Gravitation (1973), chapter 27"


def space(name: str) -> Space:
    """Comoving tetrads: spherical with curvature k, or Cartesian and flat."""
    return _flat(name) if name == "frw_flat" else _curved(name)


def _curved(name: str) -> Space:
    """Coframe (dt, a dr / sqrt(1 - k r^2), a r dtheta, a r sin(theta) dphi)."""
    t, r, theta, phi = symbols("t r theta phi", real=True)
    k = Symbol("k", real=True)
    a = Function("a")(t)
    rate = a.diff(t)
    root = sqrt(1 - k * r**2)
    frame = Frame(
        (t, r, theta, phi),
        [[1, 0, 0, 0], [0, a / root, 0, 0], [0, 0, a * r, 0], [0, 0, 0, a * r * sin(theta)]],
        signature=(-1, 1, 1, 1),
        parameters=(k,),
        domain=[k * r**2 < 1, *box({r: (0, oo), theta: (0, pi), phi: (0, 2 * pi)})],
        name=name,
    )
    half = Rational(1, 2)
    torsion = {(0, j, j): half * rate / a for j in (1, 2, 3)}
    torsion |= {(1, j, j): half * root / (a * r) for j in (2, 3)}
    torsion[2, 3, 3] = half * cos(theta) / (a * r * sin(theta))
    density = 3 * (rate**2 + k) / a**2
    pressure = -2 * a.diff(t, 2) / a - (rate**2 + k) / a**2
    return Space(
        name,
        story=(
            "A universe that looks the same everywhere, with a scale factor left unknown.\n"
            "Friedmann's equations are its Einstein tensor; the torsion T_0j^j is Hubble's rate."
        ),
        source=SOURCE,
        frame=frame,
        known=(
            KnownAnswer("torsion", antisymmetric(torsion), basis="frame"),
            KnownAnswer("torsion_axial", {}),
            KnownAnswer("torsion_scalar", 6 * rate**2 / a**2 - 2 * root**2 / (a * r) ** 2),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("scalar_curvature", 6 * (a.diff(t, 2) / a + (rate**2 + k) / a**2)),
            KnownAnswer("einstein", diagonal([density, *[pressure] * 3]), basis="frame"),
            KnownAnswer("weyl", {}),
            KnownAnswer(
                "kretschmann",
                12 * ((a.diff(t, 2) / a) ** 2 + ((rate**2 + k) / a**2) ** 2),
            ),
        ),
        embedding=orbit_embedding,
        motion=FirstMotion(
            (-0.34, 0.73, 0.73, 4.0), (1.25, 0.5, 0.25, 0.5), parameters={"k": -0.37}
        ),
        group="gravity",
        notes="Signature (-, +, +, +). For k > 0 the chart ends at r = 1/sqrt(k).",
    )


def _flat(name: str) -> Space:
    """Coframe (dt, a dx, a dy, a dz)."""
    t, x, y, z = symbols("t x y z", real=True)
    a = Function("a")(t)
    rate = a.diff(t)
    hubble = rate / a
    frame = Frame(
        (t, x, y, z),
        [[1, 0, 0, 0], [0, a, 0, 0], [0, 0, a, 0], [0, 0, 0, a]],
        signature=(-1, 1, 1, 1),
        name=name,
    )
    half = Rational(1, 2)
    pressure = -2 * a.diff(t, 2) / a - hubble**2
    return Space(
        name,
        story=(
            "The flat expanding universe, legs along x, y, z: teleparallel cosmology.\n"
            "The torsion scalar is six times the square of Hubble's rate, with nothing added."
        ),
        source="R. Aldrovandi, J. G. Pereira, Teleparallel Gravity (2013); " + SOURCE,
        frame=frame,
        known=(
            KnownAnswer(
                "torsion",
                antisymmetric({(0, j, j): half * hubble for j in (1, 2, 3)}),
                basis="frame",
            ),
            KnownAnswer("torsion_vector", {(0,): 3 * hubble}, basis="frame"),
            KnownAnswer("torsion_axial", {}),
            KnownAnswer("torsion_tensor", {}),
            KnownAnswer("torsion_scalar", 6 * hubble**2),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("scalar_curvature", 6 * (a.diff(t, 2) / a + hubble**2)),
            KnownAnswer("einstein", diagonal([3 * hubble**2, *[pressure] * 3]), basis="frame"),
            KnownAnswer("weyl", {}),
        ),
        group="gravity",
        notes="Signature (-, +, +, +).",
    )
