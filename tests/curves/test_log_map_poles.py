"""Geodesics from and to points where the frame of the space is singular."""

import math

import numpy as np
import pytest
import sympy as sp

from geomtorsion import spaces
from geomtorsion.curves import exponential_map, log_map
from geomtorsion.errors import EndpointError, StartError
from geomtorsion.geometry import Frame, cartan, levi_civita

SPHERE = spaces.load("s2").frame
UNIT = SPHERE.subs({"R": 1})
QUARTER = math.pi / 2


def point(theta, phi):
    """A point of the unit sphere in space."""
    return np.array(
        [math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)]
    )


@pytest.mark.parametrize(
    ("start", "end"),
    [
        ([0.0, 0.0], [1.5707963, 1.0]),
        ([0.0, 2.0], [1.5707963, 1.0]),
        ([math.pi, 0.0], [2.0, -1.0]),
        ([1.5707963, 1.0], [0.0, 0.0]),
        ([2.0, 1.0], [math.pi, 0.0]),
        ([1e-9, 0.5], [1.0, 1.0]),
        ([0.0, 0.0], [QUARTER, 0.0]),
        ([QUARTER, 0.0], [0.0, 0.0]),
        ([QUARTER, 0.0], [1.0, 0.0]),
        ([0.0, 0.0], [0.0, 1.0]),
    ],
)
def test_distances_of_the_sphere(start, end):
    """The length is the angle between both points, wherever charts end."""
    found = log_map(levi_civita(UNIT), start, end)
    one, two = point(*start), point(*end)
    angle = math.atan2(np.linalg.norm(np.cross(one, two)), one @ two)
    assert found.length == pytest.approx(angle, abs=1e-9)
    assert np.linalg.norm(found.vector) == pytest.approx(angle, abs=1e-9)


def test_a_radius_as_parameter():
    """A parameter of the frame has the same effect as a substituted value."""
    found = log_map(levi_civita(SPHERE), [0, 0], [1, 1], parameters={"R": 3})
    assert found.length == pytest.approx(3, abs=1e-9)
    twice = SPHERE.subs({"R": 3})
    assert log_map(levi_civita(twice), [0, 0], [1, 1]).length == pytest.approx(3, abs=1e-9)


def test_the_velocity_is_in_the_frame_of_the_named_chart():
    """At a pole only another chart has legs; elsewhere the frame of the connection is used."""
    assert log_map(levi_civita(UNIT), [0, 0], [1, 1]).chart == "s2_x"
    south = log_map(levi_civita(UNIT), [2.0, 1.0], [math.pi, 0.0])
    assert south.chart == "s2"
    assert south.vector == pytest.approx([math.pi - 2, 0], abs=1e-9)
    north = log_map(levi_civita(UNIT), [QUARTER, 1.0], [0, 0])
    end = exponential_map(levi_civita(UNIT), [QUARTER, 1.0], 0.5 * north.vector)
    assert end == pytest.approx([QUARTER / 2, 1.0], abs=1e-9)


def test_a_guess_chooses_the_long_way_to_a_pole():
    """The guess is in the frame at the start."""
    long = log_map(levi_civita(UNIT), [1.0, 0.0], [0, 0], guess=[2 * math.pi - 1, 0.0])
    assert long.length == pytest.approx(2 * math.pi - 1, abs=1e-8)


def test_the_origin_of_the_plane():
    """Polar and spherical coordinates end at the origin; the space does not."""
    plane = levi_civita(spaces.load("flat_polar").frame)
    assert log_map(plane, [0, 0], [1.5, 1]).length == pytest.approx(1.5, abs=1e-9)
    assert log_map(plane, [1.5, 1], [0, 0]).vector == pytest.approx([-1.5, 0], abs=1e-9)
    space = levi_civita(spaces.load("flat_spherical").frame)
    assert log_map(space, [2, 0, 0], [2, QUARTER, 0]).length == pytest.approx(8**0.5, abs=1e-9)


def test_opposite_poles_have_no_shortest_geodesic():
    """The south pole is the cut locus of the north pole."""
    with pytest.raises(EndpointError):
        log_map(levi_civita(UNIT), [0, 0], [math.pi, 0])


def test_without_another_chart_a_pole_is_refused():
    """A frame of one's own has one chart; other connections depend on the frame itself."""
    theta, _ = SPHERE.coordinates
    own = Frame(SPHERE.coordinates, [[1, 0], [0, sp.sin(theta)]])
    for connection in (levi_civita(own), cartan(UNIT)):
        with pytest.raises(StartError, match="singular at the start"):
            log_map(connection, [0, 0], [1, 1])
