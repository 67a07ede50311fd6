"""s2: the round sphere with the legs of its meridians and circles of latitude."""

import sympy as sp
from sympy import Symbol, cos, pi, sin, symbols

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap
from geomtorsion.geometry import Frame
from geomtorsion.spaces.coordinates import MARGIN, length, spherical
from geomtorsion.spaces.embedding import Embedding
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, box, diagonal


def space(name: str) -> Space:
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
        atlas=_atlas,
        embedding=_embedding,
        motion=FirstMotion((1.9, 0.0), (-0.2, 1.0), 6.0, {"R": 1.0}),
        group="spheres",
        notes="The poles are the edges of the chart: no compass points anywhere there.",
    )


def _atlas(frame: Frame) -> Atlas:
    """A second compass with its pole on the equator of the first."""
    theta, phi = frame.coordinates
    (radius,) = frame.parameters
    other = sp.symbols("theta_x phi_x", real=True)
    turned = Frame(
        other, [[radius, 0], [0, radius * sp.sin(other[0])]], parameters=(radius,), name="s2_x"
    )
    n = [sp.sin(theta) * sp.cos(phi), sp.sin(theta) * sp.sin(phi), sp.cos(theta)]
    m = [sp.cos(other[0]), sp.sin(other[0]) * sp.cos(other[1]), sp.sin(other[0]) * sp.sin(other[1])]
    there = (sp.atan2(length(n[1], n[2]), n[0]), sp.atan2(n[2], n[1]))
    back = (sp.atan2(length(m[0], m[1]), m[2]), sp.atan2(m[1], m[0]))
    makers = {
        "s2": lambda: Chart.of(frame, edge=sp.sin(theta), margin=MARGIN),
        "s2_x": lambda: Chart.of(turned, edge=sp.sin(other[0]), margin=MARGIN, keeps_frame=False),
    }
    maps = (
        TransitionMap("s2", "s2_x", (theta, phi), there, angles=(1,)),
        TransitionMap("s2_x", "s2", other, back, angles=(1,)),
    )
    return Atlas("s2", makers, lambda: maps)


def _embedding(frame: Frame) -> Embedding:
    """The sphere of radius R."""
    (radius,) = frame.parameters
    return Embedding(
        frame.coordinates,
        (radius,),
        spherical(radius, *frame.coordinates),
        ("x", "y", "z"),
        title="on the sphere",
    )
