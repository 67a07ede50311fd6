"""Edges: motions end where their frame ends, with every engine."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.curves.edges import edges_of
from geomtorsion.errors import AccuracyError, ChartEdgeError, CoordinateError, StartError
from geomtorsion.geometry import Frame, cartan
from geomtorsion.ode import RungeKutta, Stiff, Taylor, solve, solve_many
from geomtorsion.ode.engines.taylor import is_available
from tests.ode.engines import ENGINES as EXPLICIT
from tests.ode.engines import needs_heyoka

r, p, x, y, z, s = sp.symbols("r p x y z s")
ENGINES = [*EXPLICIT, Stiff(), Stiff("LSODA"), pytest.param(Taylor(113), marks=needs_heyoka)]
ONE_TURN = [p > 0, p < 2 * sp.pi]


def throat():
    """The upper half of a funnel whose throat has radius 1."""
    return Frame([r, p], [[1 / sp.sqrt(1 - 1 / r**2), 0], [0, r]], domain=[r > 1])


def ended(problem, t, engine, **options):
    """The message of the error that ends a motion, and the time of the end."""
    with pytest.raises(ChartEdgeError) as caught:
        solve(problem, t, engine=engine, **options)
    found = caught.value.solution
    return str(caught.value), float(found.trajectory.reached) / problem.time_unit


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
@pytest.mark.parametrize("law", ["autoparallel", "geodesic"])
def test_throat_of_a_funnel(engine, law):
    """Radially dr/dl = sqrt(1 - 1/r**2), so that r**2 = 1 + (l - l0)**2: the throat is at l0."""
    frame = throat()
    made = autoparallel(cartan(frame), [5, 0], [-0.3, 0]) if law == "autoparallel" else geodesic(
        frame, [5, 0], [-0.3, 0]
    )  # fmt: skip
    speed = 0.3 / np.sqrt(1 - 1 / 25)
    message, t = ended(made, 1.1 * np.sqrt(24) / speed, engine)
    assert t == pytest.approx(np.sqrt(24) / speed, rel=1e-6)
    assert "r = 1" in message


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
def test_a_motion_that_turns_before_the_throat(engine):
    """A motion comes as near as r = 1.3, goes out again and is not stopped."""
    accuracy = 1e-8
    found = solve(geodesic(throat(), [5, 0], [-0.3, 0.016]), 40.0, accuracy, engine=engine)
    assert found["r"].min() > 1.2
    # The angular momentum of the surface of revolution is kept.
    momentum = found["r"] ** 2 * found.velocity[:, 1]
    assert momentum == pytest.approx(momentum[0], rel=1e-7)


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
def test_the_declared_domain_is_an_edge(engine):
    """Polar coordinates, straight to the origin: the motion ends at t = 1."""
    polar = Frame([r, p], [[1, 0], [0, r]], domain=[r > 0, *ONE_TURN])
    message, t = ended(autoparallel(cartan(polar), [1, 0], [-1, 0]), 2.0, engine)
    assert t == pytest.approx(1.0, abs=1e-9)
    assert "r > 0 holds no longer" in message


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
def test_edges_in_the_past(engine):
    """A motion followed backwards ends at the edge as well."""
    polar = Frame([r, p], [[1, 0], [0, r]], domain=[r > 0, *ONE_TURN])
    message, t = ended(geodesic(polar, [1, 0], [1, 0]), -2.0, engine)
    assert t == pytest.approx(-1.0, abs=1e-9)
    assert "r > 0 holds no longer" in message


HALF_PLANE = Frame([x, y], sp.diag(1 / y, 1 / y), domain=[y > 0])
BESIDE = Frame([x, y], sp.diag(1 / (1 - x), 1 / (1 - x)), domain=[x < 1])


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
@pytest.mark.parametrize(
    ("frame", "start", "velocity"),
    [
        (HALF_PLANE, [0, 1], [0.3, -1.0]),
        (HALF_PLANE, [0, 1e-6], [1.0, 1.0]),
        (HALF_PLANE, [0, 1e9], [0.1, -1.5]),
        (BESIDE, [0, 0], [1, 0.2]),
    ],
)
def test_an_edge_to_which_a_motion_only_tends(engine, frame, start, velocity):
    """A complete geodesic continues, or its accuracy is refused: it never ends at the edge."""
    made = geodesic(frame, start, frame_velocity=velocity)
    refused = None
    try:
        found = solve(made, 40.0, engine=engine)
    except AccuracyError as error:
        refused, found = error, error.solution
    if refused is None:
        assert found.complete
    elif found is not None:
        assert "approaches the edge without reaching it" in str(refused)
        assert found.times[-1] < 40


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
@pytest.mark.parametrize("height", [1.0, 1e-9])
def test_edges_that_are_reached(engine, height):
    """A motion ends at a steady rate in a flat half plane, and at rest in the metric dy**2 / y."""
    flat = Frame([x, y], sp.eye(2), domain=[y > 0])
    _, t = ended(geodesic(flat, [0, height], frame_velocity=[0.3, -1]), 3 * height, engine)
    assert t == pytest.approx(height, rel=1e-6)
    slow = Frame([x, y], sp.diag(1, 1 / sp.sqrt(y)), domain=[y > 0])
    speed = np.sqrt(height)
    _, t = ended(geodesic(slow, [0, height], frame_velocity=[0, -speed]), 3.0, engine)
    assert t == pytest.approx(2.0, rel=1e-4)


@pytest.mark.parametrize("engine", EXPLICIT, ids=lambda engine: engine.name)
def test_members_end_at_edges_in_the_past(engine):
    """A member of an ensemble run backwards is unfinished where it meets an edge."""
    polar = Frame([r, p], [[1, 0], [0, r]], domain=[r > 0, *ONE_TURN])
    one = geodesic(polar, [1, 0], [1, 0])
    found = solve_many(one, None, -2.0, 1e-9, engine, velocities=[[1, 0], [-1, 0.1], [0, 0.5]])
    assert found.unfinished == (0,)


@pytest.mark.parametrize("engine", EXPLICIT, ids=lambda engine: engine.name)
def test_an_angle_has_no_edge(engine):
    """A full turn after which the frame repeats may be passed; other bounds may not."""
    turning = [[sp.cos(p), -r * sp.sin(p)], [sp.sin(p), r * sp.cos(p)]]
    angle = Frame([r, p], turning, domain=[r > 0, *ONE_TURN])
    found = solve(geodesic(angle, [1, 6], [0, 1]), 0.7, engine=engine)
    assert found["p"][-1] == pytest.approx(6 + np.arctan(0.7), rel=1e-9)
    half = Frame([r, p], turning, domain=[r > 0, p > 0, p < sp.pi])
    message, t = ended(geodesic(half, [1, 3], [0, 1]), 0.7, engine)
    assert t == pytest.approx(np.tan(np.pi - 3), rel=1e-9)
    assert "p < pi holds no longer" in message
    # Here the frame degenerates at both bounds, as at rotations by 0 and by 2 pi around an axis.
    pinched = Frame([r, p], [[1, 0], [0, sp.sin(p / 2) ** 2]], domain=ONE_TURN)
    assert len(edges_of(pinched)) == 2
    # This frame differs after a turn.
    spinor = [[sp.cos(p / 2), -r * sp.sin(p / 2)], [sp.sin(p / 2), r * sp.cos(p / 2)]]
    words = [edge.words for edge in edges_of(Frame([r, p], spinor, domain=ONE_TURN))]
    assert words == ["p > 0 holds no longer", "p < 2*pi holds no longer"]


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
def test_a_pole_without_a_chart(engine):
    """A sphere in (z, phi): z = sin(t / 2) reaches the pole at t = pi."""
    root = sp.sqrt(1 - z**2)
    sphere = Frame([z, p], [[1 / root, 0], [0, root]])
    message, t = ended(geodesic(sphere, [0, 0], [0.5, 0]), 4.0, engine)
    assert t == pytest.approx(np.pi, rel=1e-6)
    assert "sqrt((1 - z)*(z + 1)) = 0" in message


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
def test_a_bare_root(engine):
    """s = (1 - t)**2 ends at t = 1 with our own error for every engine."""
    line = Frame([s], [[1 / (2 * sp.sqrt(s))]])
    _, t = ended(autoparallel(cartan(line), [1], [-2]), 1.5, engine)
    assert t == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("engine", EXPLICIT, ids=lambda engine: engine.name)
def test_a_branch_is_an_edge(engine):
    """1 + sqrt(x**2), read as 1 + x, holds for x > 0: a motion may neither start nor go beyond."""
    kink = Frame([x, y], [[1, 0], [0, 1 + sp.sqrt(x**2)]])
    with pytest.raises(StartError, match=r"sqrt\(x\*\*2\) read as x: right where x >= 0"):
        solve(geodesic(kink, [-2, 0], [1, 0]), 1.0, engine=engine)
    message, t = ended(geodesic(kink, [2, 0], [-1, 0]), 3.0, engine)
    assert t == pytest.approx(2.0, rel=1e-9)
    assert "sqrt(x**2) read as x" in message
    wave = Frame([x, y], [[1, 0], [0, 2 + sp.sqrt(1 - sp.cos(x) ** 2)]])
    with pytest.raises(StartError, match="sin"):
        solve(geodesic(wave, [-1, 0], [0, 1]), 1.0, engine=engine)


@pytest.mark.parametrize("engine", EXPLICIT, ids=lambda engine: engine.name)
def test_a_chosen_branch_holds_where_it_is_chosen(engine):
    """With the domain x < 0 the root is -x, and the motion is right."""
    wave = Frame([x, y], [[1, 0], [0, 2 + sp.sqrt(1 - sp.cos(x) ** 2)]], domain=[x < 0, x > -3])
    plain = Frame([x, y], [[1, 0], [0, 2 - sp.sin(x)]])
    one, two = (
        solve(geodesic(frame, [-1, 0], [0, 1]), 1.0, engine=engine) for frame in (wave, plain)
    )
    assert one["x"][-1] == pytest.approx(two["x"][-1], rel=1e-9)
    assert one["x"][-1] == pytest.approx(-1.598, abs=1e-3)


def test_sums_of_squares_are_not_watched():
    """A sum of squares cannot fall through zero and adds no edge; other radicands do."""
    rows = [[sp.sqrt(1 + x**2), 0], [0, sp.sqrt(x**2 + y**2)]]
    assert edges_of(Frame([x, y], rows)) == ()
    words = [edge.words for edge in edges_of(Frame([x, y], [[1, 0], [0, sp.sqrt(x + 2)]]))]
    assert words == ["sqrt(x + 2) = 0"]
    words = [edge.words for edge in edges_of(Frame([x, y], [[1, 0], [0, 2 + sp.log(x)]]))]
    assert words == ["x = 0"]


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
@pytest.mark.parametrize("entry", [2 + sp.acos(x), 2 + sp.asin(x), 3 - sp.atanh(x)], ids=str)
def test_inverse_functions_end(engine, entry):
    """Straight to x = 1 at t = 1, beyond which the frame has no value."""
    frame = Frame([x, y], [[1, 0], [0, entry]])
    message, t = ended(geodesic(frame, [0.5, 0], [0.5, 0]), 4.0, engine)
    assert t == pytest.approx(1.0, abs=1e-6)
    assert "at x = 1, y = 0" in message
    assert "(1 - x)*(x + 1)" in message
    everywhere = Frame([x, y], [[1, 0], [0, 4 + sp.atan(x) + sp.asinh(x)]])
    assert edges_of(everywhere) == ()


def test_kinks_on_an_axis():
    """A motion through the axis ends there; series would continue with a negative radius."""
    radius = sp.sqrt(x**2 + y**2)
    frame = Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [0, 0, 1 / (2 + radius)]])
    assert [edge.words for edge in edges_of(frame)] == ["sqrt(x**2 + y**2) = 0"]
    through = geodesic(frame, [1, 1, 0], [-1, -1, 0.3])
    if is_available():
        message, _ = ended(through, 4.0, Taylor())
        assert "sqrt(x**2 + y**2) = 0" in message
    # For a path beside the axis scipy gives this; an even function of the radius has no kink.
    for engine in EXPLICIT:
        past = solve(geodesic(frame, [1, 1, 0], [-1, -0.9, 0.3]), 4.0, 1e-9, engine=engine)
        assert past["z"][-1] == pytest.approx(1.51038235183236, abs=2e-9)
    even = Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [0, 0, sp.cos(radius)]])
    assert edges_of(even) == ()


def test_domains_that_cannot_be_watched():
    """An absolute value is refused in our own words; bounds at infinity are not edges."""
    wide = Frame([x, y], [[1, 0], [0, 1]], domain=[sp.Abs(x) < 1])
    with pytest.raises(StartError, match="expected relations that can be evaluated along a motion"):
        solve(geodesic(wide, [0, 0], [1, 0]), 1.0)
    assert edges_of(Frame([x, y], [[1, 0], [0, 1]], domain=[x > -sp.oo])) == ()


@pytest.mark.parametrize("engine", EXPLICIT, ids=lambda engine: engine.name)
def test_members_end_at_edges_too(engine):
    """Members that reach the throat are unfinished; the others agree with single motions."""
    one = geodesic(throat(), [5, 0], [-0.3, 0.016])
    speeds = np.array([[-0.3, 0.016], [-0.3, 0.0], [0.3, 0.01]])
    found = solve_many(one, None, 20.0, 1e-9, engine, velocities=speeds)
    assert np.isnan(found.coordinates[1]).all()
    for k in (0, 2):
        alone = solve(one.with_start(velocity=speeds[k]), 20.0, 1e-9, engine=engine)
        assert found.coordinates[k, -1] == pytest.approx(alone.coordinates[-1], rel=1e-8)


@pytest.mark.parametrize("assumed", [{}, {"positive": True}, {"nonnegative": True}])
def test_an_angle_that_is_declared_positive(assumed: dict[str, bool]) -> None:
    """0 < phi < 2 pi is a full turn, whether the domain or the symbol declares the sign."""
    r, phi = sp.Symbol("r", positive=True), sp.Symbol("phi", **assumed)
    frame = Frame([r, phi], [[1, 0], [0, r]], domain=[r > 0, phi > 0, phi < 2 * sp.pi])
    assert [edge.words for edge in edges_of(frame) if "phi" in edge.words] == []
    round_it = solve(geodesic(frame, [1.0, 6.2], [0.0, 1.0]), t=1.0)
    assert round_it["phi"][-1] == pytest.approx(6.2 + np.pi / 4, rel=1e-9)


@pytest.mark.parametrize(("sign", "word"), [(1, "positive"), (-1, "negative")])
def test_a_sign_that_was_declared_is_an_edge(sign: int, word: str) -> None:
    """sympy has written x for Abs(x): beyond zero the frame is not the written one, and no motion
    begins or continues there."""
    x, y = sp.Symbol("x", **{word: True}), sp.Symbol("y", real=True)
    frame = Frame([x, y], [[1, 0], [0, 1 + sp.Abs(x)]])
    assert [edge.words for edge in edges_of(frame)] == [f"x was declared {word}"]
    with pytest.raises(CoordinateError, match=f"x: expected a value that is .*{word}"):
        geodesic(frame, [-sign, 0], [sign, 0])
    with pytest.raises(ChartEdgeError, match=f"x = .*x was declared {word}") as stop:
        solve(geodesic(frame, [sign * 0.2, 0], [-sign, 0]), 1.0)
    assert stop.value.solution.times[-1] <= 0.2 + 1e-9
    assert frame.metric.at({"x": sign, "y": 0})[1, 1] == 4
    assert frame.metric.at({"x": 0, "y": 0})[1, 1] == 1
    with pytest.raises(CoordinateError, match=f"x: expected a value that is .*{word}"):
        frame.metric.at({"x": -sign, "y": 0})


def test_an_irrelevant_sign_adds_no_edge() -> None:
    """A sign of an angle, or of a coordinate that the frame does not contain, is not an edge."""
    r, theta, phi, t = sp.symbols("r theta phi t", positive=True)
    frame = Frame([r, theta], [[1, 0], [0, r]])
    assert [edge.words for edge in edges_of(frame)] == ["r was declared positive"]
    back = solve(geodesic(frame, [1.0, 0.1], [0.0, -1.0]), 1.0)
    assert back["theta"][-1] == pytest.approx(0.1 - np.pi / 4, rel=1e-9)
    assert frame.metric.at({"r": 2, "theta": -3})[1, 1] == 4
    turned = Frame([t, phi], [[sp.cos(phi), sp.sin(phi)], [-sp.sin(phi), sp.cos(phi)]])
    assert edges_of(turned) == ()
    assert turned.metric.at({"t": -1, "phi": -1})[0, 0] == pytest.approx(1)


def test_long_edges_are_shortened():
    """The error at an edge of thousands of letters shows the beginning and the end of it."""
    room = sp.expand(1 - x + y * (x + y) ** 60)
    assert len(str(room)) > 1500
    frame = Frame([x, y], [[1, 0], [0, 1]], domain=[room > 0])
    with pytest.raises(ChartEdgeError) as caught:
        solve(geodesic(frame, [0, 0], [1, 0]), 50.0, engine=RungeKutta())
    message = str(caught.value)
    assert "x**59*y" in message or "x**60*y" in message
    assert "..." in message
    assert len(message) < 700
