"""s2: the round sphere with the legs of its meridians and circles of latitude."""

from sympy import Symbol, cos, pi, sin, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import KnownAnswer, Space, antisymmetric, box, diagonal


def space(name: str, title: str) -> Space:
    """Coframe (R dtheta, R sin(theta) dphi) on the sphere of radius R."""
    theta, phi = symbols("theta phi", real=True)
    radius = Symbol("R", positive=True)
    frame = Frame(
        (theta, phi),
        [[radius, 0], [0, radius * sin(theta)]],
        parameters=(radius,),
        domain=box({theta: (0, pi), phi: (0, 2 * pi)}),
        name=name,
    )
    slope = cos(theta) / (radius * sin(theta))
    return Space(
        name,
        title,
        story=(
            "Steering by compass: straight on means constant bearing, a loxodrome on the map.\n"
            "The compass frame is flat and has torsion; the sphere's own connection is the reverse."
        ),
        source="M. Nakahara, Geometry, Topology and Physics, section 7.3",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([radius**2, radius**2 * sin(theta) ** 2])),
            KnownAnswer("torsion", antisymmetric({(0, 1, 1): slope / 2}), basis="frame"),
            KnownAnswer("torsion_vector", {(0,): slope}, basis="frame"),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", diagonal([1, sin(theta) ** 2])),
            KnownAnswer("scalar_curvature", 2 / radius**2),
            KnownAnswer("einstein", {}),
            KnownAnswer("kretschmann", 4 / radius**4),
        ),
        group="spheres",
        notes="The poles are the edges of the chart: no compass points anywhere there.",
    )
