"""Bounds of sets on their way: at samples, at stops and from chart to chart, from both sides."""

# pyright: reportOptionalMemberAccess=false, reportOptionalIterable=false
# pyright: reportGeneralTypeIssues=false

import pytest
import sympy as sp
from flint import arb, arb_mat, fmpq

from geomtorsion.codegen import graph
from geomtorsion.codegen.balls import BallCode
from geomtorsion.proofs import arc_integrals, charts
from geomtorsion.proofs.events import Fall
from geomtorsion.proofs.motions import Leg, RefusalError, follow
from geomtorsion.proofs.sets import LohnerSet
from geomtorsion.proofs.steps import Method
from geomtorsion.support.precision import ball_precision
from tests.proofs.systems import system_of

RADIUS = arb(2) ** -12
TIGHT = arb(2) ** -24
X, Y = sp.symbols("x y")


@pytest.fixture(autouse=True)
def _bits():
    with ball_precision(100):
        yield


def is_tight(ball, ends, share=0.01):
    """Whether a ball contains both ends of an interval, and is wider by a small share only."""
    width = abs(ends[1] - ends[0])
    return all(ball.contains(x) for x in ends) and bool(2 * ball.rad() <= width * (1 + share))


def test_samples_contain_all_motions():
    """x' = x from 1 +- r: at each sample exp(t) (1 +- r)."""
    times = (fmpq(0), fmpq(1, 3), fmpq(1))
    leg = Leg(system_of({"x": "x"}), fmpq(0), fmpq(1), times)
    path = follow(leg, LohnerSet.of([arb(1, RADIUS)]), Method.of(90))
    boxes = [*(sample.states for sample in path.samples), path.whole.hull]
    for time, (box,) in zip((*times, fmpq(1)), boxes, strict=True):
        assert is_tight(box, [arb(time).exp() * (1 + sign * RADIUS) for sign in (-1, 1)])


def test_a_stop_contains_all_motions():
    """x' = -x from 1 +- r is 1/2 at log(2 (1 +- r)); there y' = y from 1 +- r is 2 (1 +- r)^2."""
    system = system_of({"x": "-x", "y": "y"})
    term = graph(["x", "y", ""], [X - sp.Rational(1, 2)], factor=False)
    fall = Fall(system, term, ("x", "y"), list, None)
    leg = Leg(system, fmpq(0), fmpq(3), (), fall)
    path = follow(leg, LohnerSet.of([arb(1, RADIUS)] * 2), Method.of(90))
    time, ((x, y), _) = path.stop
    signs = (-1, 1)
    assert is_tight(time, [(2 * (1 + sign * RADIUS)).log() for sign in signs])
    assert x.contains(0.5)
    assert x.rad() < 2 * RADIUS
    assert is_tight(y, [2 * (1 + sign * RADIUS) ** 2 for sign in signs], 0.1)


def test_a_change_of_charts_is_bounded_by_its_slope_on_the_hull():
    """x^2 on 1 +- 1/2: the slope is 3 at most, the radius of the image 3/2."""
    change = charts.SetMap(("x",), graph(["x"], [X**2], factor=False))
    (ball,) = change(LohnerSet.of([arb(1, 0.5)]), []).hull
    assert ball.mid() == 1
    assert 1.5 <= ball.rad() <= 1.5 * (1 + TIGHT)


def test_whole_turns_add_their_rounding():
    """7 - 2 pi has no finite number of digits: its ball contains it, and little more."""
    (ball,) = charts.turned(LohnerSet.of([arb(7)]), [0], [0.7]).hull
    with ball_precision(300):
        assert ball.contains(7 - 2 * arb.pi())
    assert ball.rad() < 1e-28


def test_sets_with_other_states():
    """States that are added keep their radii, others lose none; radii of a wider set add."""
    whole = LohnerSet((arb(1), arb(2)), arb_mat([[1, -2], [3, 0.5]]), (arb(0.5), arb(0.25)))
    wider = charts.widened(whole, [arb(1), arb(2)])
    more = charts.extended(whole, 1, [arb(5, 0.75)])
    fewer = charts.without(more, [0])
    for one, middle, radii in (
        (wider, [1, 2], [2, 3.625]),
        (more, [1, 5, 2], [1, 0.75, 1.625]),
        (fewer, [5, 2], [0.75, 1.625]),
    ):
        assert list(one.middle) == middle
        for radius, exact in zip(one.radii, radii, strict=True):
            assert exact <= radius <= exact * (1 + TIGHT)


@pytest.mark.parametrize(("edge", "is_inside"), [("499/1000", False), ("501/1000", True)])
def test_a_chart_is_left_within_a_step(edge, is_inside):
    """x = t - t^2/2 has its largest value, 1/2, in the middle of a step."""
    system = system_of({"x": "v", "v": "-1"})
    inside = graph(["x", "v"], [sp.Rational(edge) - X], factor=False)
    leg = Leg(system, fmpq(0), fmpq(2), (), None, inside, ("x < edge",))
    start = LohnerSet.of([arb(0), arb(1)])
    if is_inside:
        assert follow(leg, start, Method.of(90)).whole is not None
    else:
        with pytest.raises(RefusalError, match="reaches the edge of its chart"):
            follow(leg, start, Method.of(90))


@pytest.mark.parametrize(
    ("positive", "balls", "verdict"),
    [
        (True, [arb(1, 0.5)], True),
        (True, [arb(-1, 0.5)], False),
        (True, [arb(0.4, 0.5)], None),
        (False, [arb(2, 0.5), arb(2.5, 0.5)], True),
        (False, [arb(2, 0.5), arb(-2, 0.5)], False),
        (False, [arb(0, 1), arb(0.5, 1)], None),
    ],
)
def test_a_branch_is_decided_only_by_its_balls(positive, balls, verdict):
    """A sign, or two roots that are equal and not opposite; None where balls do not decide."""
    condition = arc_integrals._Condition(
        "", "", positive, BallCode(graph(["x"], [X], factor=False))
    )
    assert arc_integrals._holds(condition, balls) is verdict
