"""Domain: symbols with their ranges, and the points at which answers are compared."""

import pytest
import sympy as sp

from geomtorsion import spaces
from geomtorsion.teaching.exercises.compare import EQUAL, PARTLY, compare
from geomtorsion.teaching.exercises.domain import POINTS, Domain


def test_points_are_in_the_domain():
    """POINTS points cover the whole domain, and they are equal in each call."""
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
    """phi2 may be written with a Greek letter."""
    names = Domain.of(spaces.load("so3").frame).names
    assert names["φ2"] == names["phi2"]


@pytest.mark.parametrize(("share", "found"), [("0.05", PARTLY), ("0.03", EQUAL)])
def test_how_small_a_part_of_the_domain_is_looked_at(share, found):
    """A wrong sign of a root is noticed on 5 % of the domain, not on 3 %."""
    x = sp.Symbol("x", real=True)
    inner = x - sp.Rational(share)
    assert compare(Domain((x,), (x > 0, x < 1)), sp.sqrt(inner**2), inner) == found


def test_no_two_symbols_have_one_value():
    """No two values coincide, at one point or at different points, for twenty symbols."""
    symbols = sp.symbols("a:20", positive=True)
    values = [value for point in Domain(symbols).points for value in point.values()]
    assert len(set(values)) == len(values) == 20 * POINTS
