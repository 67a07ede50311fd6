"""Domain: symbols with where they lie, and the points at which answers are compared."""

import sympy as sp

from geomtorsion import spaces
from geomtorsion.exercises.domain import POINTS, Domain


def test_points_lie_in_the_domain():
    """As many as asked for, spread over the whole of it, the same each time."""
    frame = spaces.load("so3").frame
    domain = Domain.of(frame)
    assert len(domain.points) == POINTS
    for relation in frame.domain:
        assert all(relation.subs(point) == sp.true for point in domain.points)
    second = [float(point[frame.coordinates[1]]) for point in domain.points]
    assert min(second) < 0.6
    assert max(second) > 2.5
    assert domain.points == Domain.of(frame).points


def test_greek_letters_are_names():
    """phi2 may be written as a person would."""
    names = Domain.of(spaces.load("so3").frame).names
    assert names["φ2"] == names["phi2"]
