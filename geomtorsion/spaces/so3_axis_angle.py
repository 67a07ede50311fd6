"""so3_axis_angle: rotations by an angle about an axis (polar form of the exponential map)."""

from sympy import Matrix, Rational, cos, pi, sin, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import KnownAnswer, Space, alternating, box, diagonal


def space(name: str, title: str) -> Space:
    """Rotation by chi about n(theta, phi): n dchi + sin(chi) dn - (1 - cos(chi)) n x dn."""
    chi, theta, phi = q = symbols("chi theta phi", real=True)
    axis = Matrix([sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)])
    half = Rational(1, 2)
    legs = [axis]
    for angle in (theta, phi):
        change = axis.diff(angle)
        legs.append(sin(chi) * change - (1 - cos(chi)) * axis.cross(change))
    frame = Frame(
        q,
        Matrix.hstack(*legs).tolist(),
        domain=box({chi: (0, 2 * pi), theta: (0, pi), phi: (0, 2 * pi)}),
        name=name,
    )
    stretch = 2 * (1 - cos(chi))
    return Space(
        name,
        title,
        story=(
            "The exponential map of the rotation group, its argument in spherical coordinates.\n"
            "Straight lines through the origin are the rotations about one axis, at all speeds."
        ),
        source="M. D. Shuster, A survey of attitude representations, "
        "J. Astronaut. Sci. 41 (1993) 439",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([1, stretch, stretch * sin(theta) ** 2])),
            KnownAnswer("determinant", stretch * sin(theta)),
            KnownAnswer("torsion", alternating({(0, 1, 2): -half}), basis="frame"),
            KnownAnswer("torsion_scalar", -3 * half),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", diagonal([half] * 3), basis="frame"),
            KnownAnswer("scalar_curvature", 3 * half),
        ),
        group="rotations",
        notes="chi = 0 (no rotation), chi = 2 pi and the poles of the axis are edges of the chart.",
    )
