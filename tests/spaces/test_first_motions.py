"""First motions: where a look at a space begins."""

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.spaces.first_motions import first_motion

T, R, THETA, PHI = sp.symbols("t r theta phi")


@pytest.mark.parametrize(
    ("coordinates", "entries"),
    [
        ((R, PHI), (1, R)),
        ((R, THETA, PHI), (1, R, R * sp.sin(THETA))),
        ((PHI, R, THETA), (R * sp.sin(THETA), 1, R)),
        ((T, R, THETA, PHI), (1, 1, R, R * sp.sin(THETA))),
    ],
)
def test_radii_and_angles_are_in_their_usual_range(coordinates, entries):
    """Without a domain: r is positive, theta between the poles."""
    motion = first_motion(gt.Frame(coordinates, sp.diag(*entries)))
    start = dict(zip(coordinates, motion.start, strict=True))
    assert start[R] > 0
    assert 0 < start.get(THETA, 1.0) < sp.pi


def test_a_domain_decides():
    """What the user says about signs holds."""
    frame = gt.Frame([R, PHI], sp.diag(1, R), domain=[R < 0])
    assert first_motion(frame).start[0] < 0


def test_plain_coordinates_keep_their_signs():
    """Where no sign matters, the sample point is as good as another."""
    assert min(first_motion(gt.spaces.load("sol").frame).start) < 0
