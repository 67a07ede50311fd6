"""Motions that end exactly where their rates have no value."""

import math

import mpmath
import pytest

from geomtorsion import spaces
from geomtorsion.curves import autoparallel
from geomtorsion.errors import AccuracyError, ChartEdgeError, StuckError
from geomtorsion.geometry import cartan
from geomtorsion.ode import ODE, At, RungeKutta, Stiff, Taylor, When, solve, solve_many
from tests.ode.engines import every_engine, needs_heyoka

# Stiff is slow where steps become small: it gets a coarse accuracy.
ENGINES = [
    pytest.param(None, 1e-9, id="automatic"),
    pytest.param(RungeKutta(), 1e-9, id="RungeKutta"),
    pytest.param(Stiff(), 1e-3, id="Stiff"),
    *(
        pytest.param(Taylor(bits), 1e-9, id=f"Taylor({bits})", marks=needs_heyoka)
        for bits in (53, 64, 113)
    ),
]
on_engines = pytest.mark.parametrize(("engine", "accuracy"), ENGINES)
# Rates of y while x falls from 1 to 0, all infinite at x = 0; the last five have a finite integral.
INFINITE = [
    "1/x", "x**(-2)", "x**(-3)", "x**(-3/2)", "1/sin(x)", "1/tan(x)", "tan(x - pi/2)",
    "1/x**2 + 1/x", "1/(exp(x) - 1)", "1/(x - x**2/2)",
    "x**(-1/2)", "x**(-1/3)", "1/(2*sqrt(x))", "log(x)", "atanh(1 - x)",
]  # fmt: skip


def falling(rate, **more):
    """The motion x' = -1/2 from x = 1, with x = 0 at t = 2, and y' = a rate."""
    return ODE.of({"x": "-1/2", "y": rate}, {"x": 1, "y": 0}, **more)


@on_engines
@pytest.mark.parametrize("rate", INFINITE)
def test_no_value_at_a_pole(rate, engine, accuracy):
    """A motion that ends at a pole is refused, with the time in the message."""
    with pytest.raises(StuckError, match=r"cannot continue at t = (2|1\.99\d+), at x ="):
        solve(falling(rate), [2.0], accuracy, engine)


@on_engines
@pytest.mark.parametrize(
    ("rate", "end"),
    [("sin(x)/x", 2 * float(mpmath.si(1))), ("1/(x + 1)", 2 * math.log(2)), ("x**(3/2)", 0.8)],
)
def test_a_value_where_there_is_one(rate, end, engine, accuracy):
    """Rates that stay finite have no pole: the value is right, or this engine cannot reach it."""
    try:
        solution = solve(falling(rate), [2.0], accuracy, engine)
    except StuckError:
        # Steps of RungeKutta and Stiff look beyond the end of a root.
        assert rate == "x**(3/2)"
        return
    assert abs(solution["y"][-1] - end) <= solution.error * end


@needs_heyoka
@pytest.mark.parametrize("ulps", [4, 8, 16, 1000])
@pytest.mark.parametrize("power", [1, 2, 3])
def test_just_before_a_pole(power, ulps):
    """A few roundings before a pole more digits give the value, within its error."""
    t = 2 - ulps * 2.0**-52
    distance = mpmath.mpf(ulps) * 2.0**-53
    truth = -2 * mpmath.log(distance) if power == 1 else 2 * (distance ** (1 - power) - 1)
    truth = truth if power == 1 else truth / (power - 1)
    solution = solve(falling(f"x**(-{power})"), [t], 1e-9)
    assert abs(solution["y"][-1] / truth - 1) <= max(solution.error, 2.0**-52)


@needs_heyoka
@pytest.mark.parametrize(
    ("rates", "start"),
    [
        ({"x": "-1/2", "y": "1/(x - 5)"}, {"x": 6, "y": 0}),
        ({"x": "-1/2", "y": "1/(x + 100)"}, {"x": -99, "y": 0}),
        ({"x": "-1e-20/2", "y": "1e-20/x"}, {"x": 1e-20, "y": 0}),
        ({"x": "v", "v": "-1", "y": "1/x"}, {"x": 2, "v": 0, "y": 0}),
        ({"x": "1", "y": "1/(t - 2)"}, {"x": 0, "y": 0}),
        ({"x": "-1/2", "z": "1", "y": "1/(x*(z + 1))"}, {"x": 1, "z": 0, "y": 0}),
    ],
    ids=["beside 5", "beside -100", "small units", "free fall", "time", "product"],
)
@pytest.mark.parametrize("bits", [53, 64, 113])
def test_poles_elsewhere(rates, start, bits):
    """Neither the size of the state nor where the pole comes from matters."""
    # A state of size 100 rounds so much that already its accuracy is too low.
    with pytest.raises((StuckError, AccuracyError)):
        solve(ODE.of(rates, start), [1.0, 2.0], 1e-9, Taylor(bits))


@on_engines
def test_stops_and_switches_at_a_pole(engine, accuracy):
    """A stop, a jump of the state and a switch of a parameter at a pole are refused."""
    kinds = [{"events": [When("x")]}, {"events": [At(2.0, {"x": 3})]}]
    for kind in kinds:
        with pytest.raises(StuckError):
            solve(falling("1/x", **kind), [3.0], accuracy, engine)
    switched = ODE.of(
        {"x": "-k/2", "y": "k/x"}, {"x": 1, "y": 0}, parameters={"k": 1}, events=[At(2.0, {"k": 0})]
    )
    with pytest.raises(StuckError):
        solve(switched, [3.0], accuracy, engine)


def test_samples_before_a_pole_are_kept():
    """The error has the computed part: all samples before the pole."""
    with pytest.raises(StuckError) as caught:
        solve(falling("1/x"), [0.5, 1.0, 2.0], 1e-9)
    part = caught.value.solution
    assert part.times.tolist() == [0.5, 1.0]
    assert part["y"][-1] == pytest.approx(2 * math.log(2), rel=1e-9)


@pytest.mark.parametrize("t", [2.0, [2.0], [1.0, 2.0]])
@every_engine
def test_polar_coordinates_end_at_the_origin(t, engine):
    """An autoparallel in polar coordinates that meets r = 0 at its last time has no angle there."""
    polar = cartan(spaces.load("flat_polar").frame)
    with pytest.raises(ChartEdgeError, match="the motion stops at t = 2"):
        solve(autoparallel(polar, [1, 0.2], [-0.5, 1]), t, 1e-9, engine)


@every_engine
def test_members_at_a_pole_are_not_finished(engine):
    """Members that end at a pole are not finished; the others come to the end."""
    many = solve_many(falling("1/x"), {"x": [1.0, 2.0, 3.0]}, [1.0, 2.0], 1e-9, engine)
    assert many.unfinished == (0,)
    assert many["y"][1, -1] == pytest.approx(2 * math.log(2), rel=1e-9)
