"""Plan: exactly the states that the question needs, with reasons."""

from typing import Any, cast

import networkx as nx
import pytest

from geomtorsion.errors import SceneError, StartError, UnknownNameError
from geomtorsion.scenes import Body, Scene, State, effects

E = effects
BODY = Body(mass=1.0, moments=(1, 2, 3))
START = State(omega=(0.1, 0.2, 3), euler=(0, 0.3, 0))
FLYING = State(omega=(0.1, 0.2, 3), euler=(0, 0.3, 0), velocity=(1, 2, 3))
OMEGA = ("Omega1", "Omega2", "Omega3")
N, Q = ("n1", "n2", "n3"), ("q0", "q1", "q2", "q3")
TOP = (E.Gravity(9.81), E.Pivot([0, 0, 0.1]))


@pytest.mark.parametrize(
    ("acting", "watch", "states"),
    [
        ((), ["omega"], OMEGA),
        ((), ["angular_momentum", "energy", "velocity"], OMEGA),
        ((), ["nutation"], (*OMEGA, *N)),
        ((), ["axis"], (*OMEGA, *Q)),
        ((), ["nutation", "precession"], (*OMEGA, *Q)),
        ((), ["position"], ("x", "y", "z")),
        ((), ["velocity_body"], (*OMEGA, *Q)),
        ((E.Gravity(9.81),), ["omega"], OMEGA),
        ((E.Gravity(9.81),), ["velocity"], ("vz",)),
        ((E.Gravity(9.81),), ["energy"], (*OMEGA, "z", "vz")),
        ((E.Gravity(9.81),), ["position"], ("x", "y", "z", "vz")),
        (TOP, ["omega"], (*OMEGA, *N)),
        (TOP, ["energy"], (*OMEGA, *N)),
        (TOP, ["precession"], (*OMEGA, *Q)),
        (TOP, ["velocity"], (*OMEGA, *Q)),
        ((E.Pivot([0, 0, 0.1]),), ["omega"], OMEGA),
        ((E.AngularDamping(0.1),), ["work"], (*OMEGA, "work")),
        ((E.AngularDamping(0.1), E.Gravity()), ["omega"], OMEGA),
        ((E.LinearDrag(0.1),), ["omega"], OMEGA),
        ((E.LinearDrag(0.1), E.Gravity()), ["velocity"], ("vx", "vy", "vz")),
    ],
)
def test_states_that_are_needed(acting, watch, states):
    """The states needed for each question, listed by hand, and no further equation."""
    scene = Scene(BODY, acting, START, watch, t=1)
    assert scene.selection.states == states
    assert scene.ode.states == states
    assert tuple(scene.equations) == states


def test_every_state_is_needed():
    """Each state of a plan is on a path to a watched quantity, as the graph shows."""
    scene = Scene(BODY, TOP, START, ["precession", "energy"], t=1)
    graph = scene.selection.graph
    for node in ("Omega1", "attitude", "effect gravity", "effect pivot", "effect spin"):
        assert nx.has_path(graph, node, "watch precession")
    assert not nx.has_path(graph, "watch energy", "Omega1")


def test_nothing_is_followed_where_nothing_moves():
    """A velocity that no force changes is a constant, and can still be watched."""
    scene = Scene(BODY, (), FLYING, ["velocity", "kinetic_energy"], t=1)
    assert [s.name for s in scene.selection.constants] == ["vx", "vy", "vz"]
    result = scene.run()
    assert result["velocity"].tolist()[-1] == [1, 2, 3]
    alone = Scene(BODY, (), FLYING, ["velocity"], t=1).run()
    assert alone["velocity"].tolist()[0] == [1, 2, 3]


def test_the_table_gives_reasons():
    text = str(Scene(BODY, TOP, START, ["nutation"], t=1, title="Top").selection)
    lines = text.splitlines()
    assert lines[0] == "Top: 6 equations for nutation"
    assert len(lines) == 9
    assert [line[:8].strip() for line in lines[1:]] == ["in"] * 5 + ["omitted"] * 3
    assert "vertical  n1..n3: watched as nutation" in text
    assert "attitude  the vertical is enough: nothing needs the rotation about it" in text
    assert "position  given by the constraint" in text
    assert "gravity   uniform gravity, downwards; acts on Omega1..Omega3" in text
    free = Scene(BODY, (E.Gravity(),), START, ["omega"], t=1).selection
    assert free.left_out == ("drift", "gravity", "attitude", "vertical", "position", "velocity")
    assert "acts only on vz; no output needs these" in str(free)


def test_who_asks_for_the_vertical():
    text = str(Scene(BODY, TOP, START, ["omega"], t=1).selection)
    assert "vertical  n1..n3: needed by rotation, through gravity, pivot" in text


def test_drawing():
    """The SVG has every box, also the omitted ones, and the same bytes each time."""
    pytest.importorskip("matplotlib")
    plan = Scene(BODY, TOP, START, ["nutation", "energy"], t=1).selection
    svg = plan.draw()
    assert svg.lstrip().startswith("<?xml")
    assert svg == plan.draw()
    assert svg.count("<!-- ") > 8
    for text in ("nutation", "energy", "gravity", "pivot", "attitude", "position"):
        assert f"<!-- {text} -->" in svg


def test_equal_moments_drop_out():
    """The axial rate of a symmetric top is constant, and no product with zero is computed."""
    scene = Scene(Body(moments=(2, 2, 1)), TOP, START, ["nutation"], t=1)
    assert scene.equations["Omega3"] == 0
    assert "axial_angular_momentum" in scene.ode.invariants


def test_missing_starts():
    with pytest.raises(SceneError, match=r"start: expected a State, got None\. Write State"):
        Scene(BODY)
    with pytest.raises(StartError, match="expected an angular velocity, got none"):
        _ = Scene(BODY, (), State(), ["omega"]).ode
    with pytest.raises(StartError, match="no attitude, which is needed .*watched as nutation"):
        _ = Scene(BODY, (), State(omega=(0, 0, 1)), ["nutation"]).ode
    with pytest.raises(StartError, match="needed by rotation, through gravity, pivot"):
        _ = Scene(BODY, TOP, State(omega=(0, 0, 1)), ["omega"]).ode
    assert Scene(BODY, TOP, State(position=(0, 0, 0)), ["omega"]).selection.states


@pytest.mark.parametrize(
    ("acting", "words"),
    [
        ((E.Drift(), E.Pivot([0, 0, 1])), "got drift .* and pivot .* contradict each other"),
        ((E.Pivot([0, 0, 1]), E.Rolling(0.1)), "contradict each other"),
        ((E.Gravity(), E.Gravity(1)), "got gravity twice"),
        ((E.Gravity,), "expected an effect, got Gravity. Write Gravity\\(...\\)"),
        (("gravity",), "expected an effect, got 'gravity'"),
    ],
)
def test_effects_that_do_not_go_together(acting, words):
    with pytest.raises(SceneError, match=words):
        Scene(BODY, acting, START)


@pytest.mark.parametrize(
    ("watch", "words"),
    [
        (["nutaton"], "'nutaton' can be watched.*Did you mean nutation"),
        (["wheel"], "no effect of the scene provides it"),
        (["euler:zzz"], "Euler angles: expected the name of a convention, got 'zzz'"),
    ],
)
def test_unknown_quantities_are_refused(watch, words):
    with pytest.raises(UnknownNameError, match=words):
        Scene(BODY, (), START, watch)


def test_other_bad_fields():
    with pytest.raises(SceneError, match="watch: expected at least one quantity, got none"):
        Scene(BODY, (), START, [])
    with pytest.raises(SceneError, match="expected a Body"):
        Scene(cast(Any, (1, 2, 3)), (), START)
    with pytest.raises(SceneError, match="samples: expected a whole number from 2 on"):
        Scene(BODY, (), START, samples=1)
    with pytest.raises(SceneError, match="as the constraint requires, got \\(1, 2, 3\\)"):
        _ = Scene(BODY, TOP, FLYING, ["velocity"]).ode


def test_a_start_that_fits_the_constraint():
    """The velocity that the pivot allows may be given."""
    omega, arm = (0.1, 0.2, 3.0), (0, 0, 0.5)
    start = State(omega=omega, euler=(0, 0, 0), velocity=(0.1, -0.05, 0), position=(0, 0, 0.5))
    assert Scene(BODY, (E.Pivot(arm),), start, ["energy"], t=1).run().complete


def test_rolling_disc():
    """The position of the disc needs the whole attitude; its rotation needs only the vertical."""
    body, start = Body(2.0, (0.05, 0.05, 0.1)), State(omega=(3, -2, 5), euler=(0.1, 0.5, 0.2))
    scene = Scene(body, (E.Rolling(0.3), E.Gravity()), start, ["position", "matrix"], t=2)
    assert scene.selection.states == (*OMEGA, *Q, "x", "y")
    assert scene.with_values(watch=["energy", "omega"]).selection.states == (*OMEGA, *N)
    result = scene.run()
    # The height of the centre follows from the tilt of the disc.
    height = 0.3 * (1 - result["matrix"][:, 2, 2] ** 2) ** 0.5
    rise = result["position"][:, 2] - result["position"][0, 2]
    assert abs(rise - height + height[0]).max() < 1e-9


def test_what_stops_is_followed():
    """A stop on the height adds height and fall, though no watched quantity needs them."""
    ground = E.Custom(stop="z")
    start = State(omega=(0, 0, 3), position=(0, 0, 20), euler=(0, 0, 0))
    scene = Scene(BODY, (E.Gravity(10), ground), start, ["omega"], t=5)
    assert scene.selection.states == (*OMEGA, "z", "vz")
    assert "z: needed to stop by custom" in str(scene.selection)
    result = scene.run()
    assert result.outcome == "stopped"
    assert result.complete
    assert result.times[-1] == pytest.approx(2, rel=1e-12)
    assert result.closed_form is None


def test_switches_of_omitted_effects():
    """A thrust through the centre of mass does not split the time of the rotation."""
    push = E.Thrust((0, 0, 5), start=0.1, end=0.2)
    scene = Scene(BODY, (push,), START, ["omega"], t=1)
    assert scene.ode.events == ()
    assert scene.run().closed_form
    assert len(scene.with_values(watch=["velocity"]).ode.events) == 2


def test_names_that_are_taken():
    with pytest.raises(
        SceneError, match="expected a new name for the watched quantity, got 'energy'"
    ):
        Scene(BODY, (E.Custom(outputs={"energy": "z"}),), START)
    two = (E.Custom(outputs={"height": "z"}), E.Custom(outputs={"height": "2*z"}))
    with pytest.raises(SceneError, match="got 'height', which another effect has"):
        Scene(BODY, two, START)


def test_energy_that_changes_with_time():
    """A field that grows with time puts energy in, and the balance accounts for it."""
    field = E.Custom(force=("0", "0", "-t"), energy="t*z")
    start = State(omega=(0, 0, 1), position=(0, 0, 2))
    scene = Scene(BODY, (field,), start, ["energy_balance", "work"], t=3)
    assert "energy_balance" in scene.ode.invariants
    result = scene.run()
    # z = 2 - t^3/6, so that the work is the integral of z.
    assert result["work"][-1] == pytest.approx(2 * 3 - 3**4 / 24, rel=1e-10)


def test_how_much_rounding_a_start_may_have():
    """A velocity may differ from the pivot's by 0.9e-6, as printed digits do, not by 1.1e-6."""
    pivot = (E.Pivot((0, 0, 1)),)
    for excess, fine in ((0.9e-6, True), (1.1e-6, False)):
        start = State(omega=(1, 0, 0), euler=(0, 0, 0), velocity=(0, -1 - excess, 0))
        scene = Scene(BODY, pivot, start, ["velocity"], t=1)
        if fine:
            assert scene.ode.size == 7
        else:
            with pytest.raises(SceneError, match="as the constraint requires"):
                _ = scene.ode
