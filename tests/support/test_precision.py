"""Precision: values on both sides of each threshold for rounding."""

import pytest

import geomtorsion as gt
from geomtorsion.errors import BodyError, StartError
from geomtorsion.ode import ODE
from geomtorsion.rigid import free_top
from geomtorsion.rigid.attitude import checked_quaternion
from geomtorsion.scenes import Body

UNIT_STARTS = (
    checked_quaternion,
    lambda q: free_top((1, 2, 3), (1, 1, 1), q),
    lambda q: ODE.of(
        {"a": "-b", "b": "a", "c": "0", "d": "0"}, list(q), normalized=[("a", "b", "c", "d")]
    ),
)


@pytest.mark.parametrize("start", UNIT_STARTS, ids=("scene", "free top", "equations"))
@pytest.mark.parametrize("sign", [1, -1])
def test_a_printed_unit_vector_is_rounded_a_longer_one_a_mistake(start, sign):
    """A quaternion whose length is off by less than 1e-6 is accepted; beyond that it is refused."""
    start((1 + 0.9 * sign * 1e-6, 0, 0, 0))
    with pytest.raises(StartError, match="length"):
        start((1 + 1.1 * sign * 1e-6, 0, 0, 0))


def test_a_calculated_plate_is_a_plate():
    """Moments with A + B = C up to rounding are accepted; a larger sum C is refused."""
    Body(1, (1.0, 2.0, 3.0 * (1 + 0.5 * 1e-12)))
    with pytest.raises(BodyError):
        Body(1, (1.0, 2.0, 3.0 * (1 + 2 * 1e-12)))


@pytest.mark.parametrize(("share", "right"), [(0.5, True), (4.0, False)])
def test_a_calculated_null_velocity_is_null(share, right):
    """A null velocity may be off by rounding: light along the first spatial leg of de Sitter."""
    frame = gt.spaces.load("de_sitter").frame
    velocity = [1.0, 1.0 + share * 1e-12, 0.0, 0.0]

    def follow():
        return gt.geodesic(
            frame, [0, 0.3, 1.2, 0], frame_velocity=velocity, parameters={"L": 2}, causal="null"
        )

    if right:
        follow()
    else:
        with pytest.raises(StartError, match="null"):
            follow()
