"""Operations in the rates of motions: counted, so that no change of the writing adds any.

Additions and products with constants cost next to nothing in an engine of series; everything else
costs a convolution at each order, and is counted here.
"""

import pytest

from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.geometry import cartan
from geomtorsion.ode import ODE
from geomtorsion.spaces import load
from geomtorsion.spaces.first_motion import first_motion
from tests.benchmarks.motions import ANGLES, MOMENTS, SPIN, heavy_ode

CHEAP = ("sum", "scale")


def convolutions(system):
    """Number of operations of two series in the rates that an engine of series runs."""
    counts = system.hoisted.system.rates.operations
    return sum(times for kind, times in counts.items() if kind not in CHEAP)


def motion(name):
    """The geodesic of a space's first motion."""
    frame = load(name).frame
    first = first_motion(frame)
    start, velocity = list(first.start), list(first.frame_velocity)
    return geodesic(
        frame, start, frame_velocity=velocity, parameters=dict(first.parameters), causal=None
    )


# name of the space, chart, most operations. Kerr in Carter's tetrad, by hand: 33 products, 4
# squares, 2 quotients, 2 roots, a sine and a cosine.
RATES = [
    ("kerr", "kerr", 42),
    ("kerr", "ingoing", 48),
    ("kerr", "axis", 88),
    ("kerr_newman", "kerr_newman", 42),
    ("taub_nut", "taub_nut", 31),
    ("schwarzschild", "schwarzschild", 23),
    ("schwarzschild", "kerr_schild", 71),
    ("schwarzschild_cartesian", "diagonal", 23),
    ("schwarzschild_falling", "schwarzschild_falling", 18),
    ("schwarzschild_isotropic", "schwarzschild_isotropic", 39),
    ("de_sitter", "painleve", 9),
    ("so3_axis_angle", "so3_axis_angle", 21),
    ("s7", "s7", 28),
]


@pytest.mark.parametrize(("name", "chart", "most"), RATES, ids=[f"{n}-{c}" for n, c, _ in RATES])
def test_a_geodesic_costs_no_more_operations_than_before(name, chart, most):
    """The rates of a shipped space in one of its charts."""
    assert convolutions(motion(name).system(chart)) <= most


def test_rates_of_tops_cost_what_they_cost_by_hand():
    """Euler: 3 products. With a quaternion: 12 more. In angles: 3 + 5, a quotient, 4 functions."""
    so3 = load("so3").frame
    top = geodesic(so3, ANGLES, frame_velocity=SPIN, metric=MOMENTS)
    rates = geodesic(so3, frame_velocity=SPIN, metric=MOMENTS)
    line = autoparallel(cartan(so3), ANGLES, frame_velocity=SPIN)
    assert convolutions(rates.system("")) == 3
    assert convolutions(top.system("quaternion")) == 3 + 12
    assert convolutions(top.system("so3")) == 3 + 5 + 1 + 4
    assert convolutions(line.system("quaternion")) == 0
    heavy = heavy_ode()
    assert isinstance(heavy, ODE)
    assert convolutions(heavy.system) == 2 + 6


@pytest.mark.parametrize(
    ("name", "chart"), [("de_sitter", "painleve"), ("schwarzschild_cartesian", "diagonal")]
)
def test_a_geodesic_begins_with_the_cheaper_legs(name, chart):
    """From two frames of one metric the one with fewer operations is followed."""
    problem = motion(name)
    assert problem.first_stage(53, 0.0).label == chart
    dear = convolutions(problem.system(problem.atlas.home))
    assert convolutions(problem.system(chart)) < 0.7 * dear
