"""Equations: Euler's, and those of straightest and shortest curves, in closed form."""

import pytest

from geomtorsion.errors import GeomtorsionError
from geomtorsion.lab.equations import curve_equations, equations
from geomtorsion.lab.space_info import drawable
from tests.chosen import one_in

ENERGY = "(I1*u1^2 + I2*u2^2 + I3*u3^2)/2"


def test_euler():
    """I1 w1' = (I2 - I3) w2 w3 and so on, of any textbook; energy and angular momentum stay."""
    found = equations("so3", ENERGY, "I1, I2, I3")
    assert found["rates"]["u1"] == "u2*u3*(I2 - I3)/I1"
    assert found["rates"]["u2"] == "u1*u3*(-I1 + I3)/I2"
    assert found["rates"]["u3"] == "u1*u2*(I1 - I2)/I3"
    assert "the same, exactly" in found["sentence"]
    assert "What stays" in found["html"]
    assert "<math" in found["html"]


def test_naive():
    """Without the torsion of the frame the velocities would stay, which no path does."""
    found = equations("so3", ENERGY, "I1, I2, I3", "naive")
    assert [found["rates"][name] for name in ("u1", "u2", "u3")] == ["0", "0", "0"]
    assert "wrong for a body" in found["sentence"]


@pytest.mark.parametrize("space", one_in(3, list(drawable().values())))
def test_straightest_curves_keep_their_velocity(space: str):
    """u' = 0 in every space; the shortest differ wherever there is a torsion force."""
    found = curve_equations(space)
    rates = [text for name, text in found["straightest"].items() if name.startswith("u")]
    assert set(rates) == {"0"}
    assert ("they are the same" in found["sentence"]) == (found["straightest"] == found["shortest"])


@pytest.mark.parametrize(
    ("action", "names"), [("<b>", ""), ("u1^2/2 + k", ""), ("u1^2", "2k"), ("u1 + u2", "")]
)
def test_odd_actions_are_told(action: str, names: str):
    """An error of our own for what is no action."""
    with pytest.raises(GeomtorsionError):
        equations("so3", action, names)
