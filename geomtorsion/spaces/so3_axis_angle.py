"""so3_axis_angle: rotations by an angle about an axis (polar form of the exponential map)."""

from collections.abc import Sequence
from functools import partial

from sympy import Matrix, Symbol, atan2, cos, pi, sin, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.coordinates import length, spherical
from geomtorsion.spaces.embedding import Embedding
from geomtorsion.spaces.rotations import (
    BODY_FIXED,
    QUATERNION,
    QuaternionMap,
    quaternion_atlas,
    rotation,
)
from geomtorsion.spaces.space import KnownAnswer, Space, box, diagonal


def space(name: str) -> Space:
    """Rotation by chi about n(theta, phi): n dchi + sin(chi) dn - (1 - cos(chi)) n x dn."""
    chi, theta, phi = q = symbols("chi theta phi", real=True)
    axis = Matrix([sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)])
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
            *BODY_FIXED,
        ),
        atlas=partial(quaternion_atlas, _map),
        embedding=_embedding,
        group="rotations",
        notes="chi = 0 (no rotation), chi = 2 pi and the poles of the axis are edges of the chart.",
    )


def _map(q: Sequence[Symbol]) -> QuaternionMap:
    """Half of the angle, and the axis in spherical coordinates."""
    chi, theta, phi = q
    scalar, *vector = QUATERNION
    s = sin(chi / 2)
    back = [
        2 * atan2(length(*vector), scalar),
        atan2(length(*vector[:2]), vector[2]),
        atan2(vector[1], vector[0]),
    ]
    return QuaternionMap([cos(chi / 2), *spherical(s, theta, phi)], back, s * sin(theta), (2,))


def _embedding(frame: Frame) -> Embedding:
    """The attitude."""
    chi, theta, phi = frame.coordinates
    axis = spherical(sin(chi / 2), theta, phi)
    return Embedding(frame.coordinates, attitude=rotation([cos(chi / 2), *axis]))
