"""First motions: the default start of a motion in a space."""

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.spaces.first_motion import first_motion

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
    """Without a domain r is positive and theta between the poles."""
    motion = first_motion(gt.Frame(coordinates, sp.diag(*entries)))
    start = dict(zip(coordinates, motion.start, strict=True))
    assert start[R] > 0
    assert 0 < start.get(THETA, 1.0) < sp.pi


def test_a_domain_decides():
    """A sign declared by the user's domain decides the start."""
    frame = gt.Frame([R, PHI], sp.diag(1, R), domain=[R < 0])
    assert first_motion(frame).start[0] < 0


def test_the_start_is_the_point_of_the_region():
    """A start is positive where signs do not matter, and rounded to hundredths."""
    frame = gt.spaces.load("sol").frame
    start = first_motion(frame).start
    point = [float(frame.region.point[s]) for s in frame.coordinates]
    assert start == tuple(round(x, 2) for x in point)
    assert min(start) > 0


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        ("schwarzschild", {"M": 6}),
        ("kerr", {"M": 20.5, "a": 3}),
        ("de_sitter", {"L": 0.05}),
        ("schwarzschild_isotropic", {"M": 100}),
    ],
)
def test_the_start_suits_the_parameters(name, parameters):
    """With other values the domain changes, and the start is in it."""
    frame = gt.spaces.load(name).frame
    motion = first_motion(frame, parameters)
    symbols = (*frame.coordinates, *frame.parameters)
    point = dict(zip(symbols, (*motion.start, *motion.parameters.values()), strict=True))
    assert motion.parameters == parameters
    assert all(relation.subs(point) == sp.true for relation in frame.domain)


def test_a_start_that_suits_stays():
    """The space's chosen start is kept if valid, also on the very edge of its domain."""
    frame = gt.spaces.load("schwarzschild").frame
    assert first_motion(frame, {"M": 1.5}).start == first_motion(frame).start
