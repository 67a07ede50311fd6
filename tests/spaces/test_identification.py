"""Identification: a frame in disguise is named, with the values of its parameters."""

# Some results may be None in general, and some tests pass bad input.
# pyright: reportOptionalOperand=false, reportOptionalMemberAccess=false, reportArgumentType=false

import pickle

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import ArgumentError

U, V, W, Z = sp.symbols("u v w z", real=True)
L = sp.Symbol("l", positive=True)


def test_a_sphere_in_disguise_has_its_radius():
    """Stereographic coordinates hide a sphere; its radius is a parameter of the frame."""
    shape = 2 * L / (1 + U**2 + V**2)
    found = gt.spaces.identify(gt.Frame([U, V], [[shape, 0], [0, shape]]))
    (match,) = found.matches
    assert (match.name, dict(match.parameters)) == ("s2", {"R": L})
    assert match.equivalence.verdict == "same"
    assert gt.spaces.identify(gt.Frame([U, V], [[3, 0], [0, 3 * sp.cos(U)]])).matches[
        0
    ].parameters == {"R": 3}


def test_kerr_in_disguise_has_its_mass_and_spin():
    """Both parameters of a rotating black hole follow from the metric."""
    kerr = gt.spaces.load("kerr").frame.subs({"M": L, "a": L / 2})
    t, r, theta, phi = kerr.coordinates
    old = {t: U, r: V + 1, theta: W, phi: Z + U}
    disguise = kerr.in_coordinates([U, V, W, Z], old, domain=(V > 5 * L,))
    (match,) = gt.spaces.identify(disguise).matches
    assert (match.name, dict(match.parameters)) == ("kerr", {"M": L, "a": L / 2})
    assert match.equivalence.difference < 1e-50


def test_all_descriptions_of_the_rotations_are_listed():
    """Leg by leg, body-fixed frames are the same and the space-fixed frame is not."""
    found = gt.spaces.identify("so3", "legs", every=True)
    names = {match.name for match in found.matches}
    assert {"so3", "so3_zxz", "so3_quaternion", "so3_rodrigues", "bianchi_ix"} <= names
    assert "so3_right" not in names


def test_a_new_space_matches_no_shipped_space():
    """A surface of no constant curvature is not shipped, and is not mistaken for one."""
    found = gt.spaces.identify(gt.Frame([U, V], [[1, 0], [0, 1 + U**2]]))
    assert not found
    assert str(found).startswith("none of the shipped spaces")
    assert not found.undecided
    with pytest.raises(ArgumentError, match="unknown functions"):
        gt.spaces.identify("frw")
    with pytest.raises(ArgumentError, match="keep"):
        gt.spaces.identify("s2", "legz")


def test_results_are_equal_by_content():
    """Two results of one call are equal, as are their hashes and their copies by pickle."""
    frame = gt.Frame("u v", [[3, 0], [0, "3*cos(u)"]], domain="0 < u < 1")
    one, two = gt.spaces.identify(frame), gt.spaces.identify(frame)
    copy = pickle.loads(pickle.dumps(one))
    for other in (two, copy):
        assert other == one
        assert hash(other) == hash(one)
        assert other.matches[0] == one.matches[0]
        assert other.matches[0].equivalence == one.matches[0].equivalence
    assert copy.matches[0].equivalence.verdict == "same"
    larger = gt.spaces.identify(gt.Frame("u v", [[4, 0], [0, "4*cos(u)"]], domain="0 < u < 1"))
    nothing = gt.spaces.identify(gt.Frame("u v", [["3/u", 0], [0, "3/u"]], domain="u > 0"))
    assert len({one, two, copy, larger, nothing}) == 3
    assert one != "s2"


def test_flat_and_constant_curvature_are_answers():
    """A flat metric and a hyperbolic plane are named, though none of them is shipped."""
    rindler = gt.Frame.from_metric("t x", [["-x**2", 0], [0, 1]])
    flat = gt.spaces.identify(rindler)
    assert flat
    assert flat.classification.is_flat
    assert "flat (Minkowski space)" in str(flat)
    assert "x > 0, assumed" in str(flat)
    fisher = gt.spaces.identify(gt.Frame.from_metric("m s", [["1/s**2", 0], [0, "2/s**2"]]))
    assert fisher.classification.curvature == -sp.Rational(1, 2)


def test_the_other_sign_of_a_metric_is_identified():
    """A metric with minus signs for space is compared with plus signs; the answer reports it."""
    found = gt.spaces.identify(gt.Frame.from_metric("x y z", [[-1, 0, 0], [0, -1, 0], [0, 0, -1]]))
    assert found.negated
    assert "minus the metric" in str(found)
    assert found.matches[0].name == "flat_cylindrical"
