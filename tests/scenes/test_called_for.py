"""Called for: influence of effects, the smallest set for an accuracy, and its error."""

# The tests pass bad input.
# pyright: reportArgumentType=false, reportOptionalMemberAccess=false

import json
import math
from dataclasses import replace

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import AccuracyError, SceneError, UnknownNameError
from geomtorsion.ode import RungeKutta
from tests.chosen import few

E = gt.effects
BALL = gt.Body(mass=1, moments=(1, 1, 1))


def shipped(name, *more, **fields):
    """A shipped scene with more effects."""
    scene = gt.scenes.load(name)
    return replace(scene, effects=[*scene.effects, *more], **fields)


def change(one, two):
    """Largest change of a watched quantity, relative to its largest size."""
    return max(np.abs(two[name] - one[name]).max() / np.abs(one[name]).max() for name in one)


MISSILE = shipped(
    "missile", E.Gravity(9.81), E.QuadraticDrag(1e-4), E.AngularDamping(1e-4), E.LinearDrag(1e-3)
)
TURNING = replace(MISSILE, watch=("omega",))
# A scene, an accuracy and the effects that it calls for.
ROWS = [
    (MISSILE, 1e-1, "thrust gravity"),
    (MISSILE, 1e-2, "thrust gravity"),
    (MISSILE, 1e-3, "thrust gravity quadratic_drag angular_damping"),
    (MISSILE, 1e-5, "thrust gravity quadratic_drag angular_damping linear_drag"),
    (MISSILE, 1e-8, "thrust gravity quadratic_drag angular_damping linear_drag"),
    (TURNING, 1e-1, ""),
    (TURNING, 1e-3, "thrust angular_damping"),
    (TURNING, 1e-6, "thrust angular_damping"),
    (TURNING, 1e-8, "thrust angular_damping"),
]
MORE = [
    (shipped("thrown_body", E.LinearDrag(1e-4)), 1e-3),
    (shipped("lagrange_loop", E.AngularDamping(1e-9)), 1e-4),
    (shipped("gyrostat_satellite", E.AngularDamping(1e-9)), 1e-3),
    (shipped("rolling_disc", E.AngularDamping(1e-8)), 1e-3),
    (shipped("chaplygin_sleigh", E.LinearDrag(1e-5), E.AngularDamping(1e-5)), 1e-3),
    (shipped("sleeping_top", E.AngularDamping(1e-7), t=2), 1e-2),
    (shipped("dzhanibekov", E.GravityGradient(1e-3), t=12), 1e-2),
    (shipped("euler_top", E.BodyMoment((1e-6, 0, 0)), E.AngularDamping(1e-3)), 1e-3),
    (shipped("free_symmetric_top", E.Gravity(9.81), E.AngularDamping(1e-7)), 1e-4),
    (shipped("helix", E.Gravity(1e-4), E.LinearDrag(1e-3)), 1e-2),
    (
        gt.Scene(
            BALL,
            [E.Spring(40, length=1), E.Gravity(9.81), E.LinearDrag(1e-3), E.QuadraticDrag(1e-6)],
            gt.State(omega=(0, 0, 0), position=(1, 0, 0.5)),
            watch=["position", "energy"],
            t=5,
        ),
        1e-2,
    ),
]


@pytest.mark.parametrize(("scene", "accuracy", "effects"), ROWS)
def test_a_missile_calls_for_few_effects(scene, accuracy, effects):
    """The set is the smallest one, and its total error is within the accuracy."""
    budget = scene.called_for(accuracy)
    assert budget.effects == tuple(effects.split())
    everything = replace(scene, accuracy=accuracy / 100).run()
    total = change(everything, budget.chosen.run())
    assert total <= budget.error <= accuracy
    # One effect less would exceed the accuracy.
    if effects:
        least = min(budget[key].influence for key in budget.effects)
        assert least + budget.omission_error > 0.9 * accuracy


@pytest.mark.parametrize(("scene", "accuracy"), few(5, MORE))
def test_the_error_is_within_the_accuracy(scene, accuracy):
    """Another engine with all effects and a hundredth of the accuracy confirms the error."""
    budget = scene.called_for(accuracy)
    everything = replace(scene, accuracy=accuracy / 100).run(RungeKutta())
    total = change(everything, budget.chosen.run())
    assert total <= accuracy
    # The other run has an error of its own.
    assert total <= budget.error + accuracy / 100
    assert budget.error <= accuracy
    assert budget.omitted
    assert budget.chosen.ode.size <= scene.ode.size
    assert {*budget.effects, *budget.omitted} == {*scene.keyed}
    assert all(row.included or row.influence <= accuracy for row in budget.rows)


def test_an_influence_has_a_closed_form():
    """A body under weak drag falls short by c t / 2 m of its way, to first order."""
    scene = gt.Scene(
        BALL,
        [E.LinearDrag(1e-6)],
        gt.State(velocity=(3, 0, 0)),
        watch=["position", "velocity"],
        t=2,
    )
    row = scene.called_for(1e-3)["linear_drag"]
    # x = (v m / c) (1 - e^(-c t / m)), so that its relative change is c t / 2 m.
    assert row.changes["position"] == pytest.approx(1e-6, rel=1e-5)
    assert row.changes["velocity"] == pytest.approx(2e-6, rel=1e-5)
    assert row.quantity == "velocity"


def test_omitted_effects_add_no_equations():
    """Without forces the missile needs its rotation only."""
    budget = TURNING.called_for(0.1)
    assert budget.chosen.ode.size == 3
    assert budget.chosen.effects == ()
    assert budget["gravity"].influence == 0
    assert "exactly" in budget["gravity"].note
    assert shipped("missile", watch=["position"]).called_for(1e-2)["thrust"].equations == 10


def pair(size):
    """A turning body under two opposite torques and weak damping."""
    torques = [E.BodyMoment((0, 0, size)), E.BodyMoment((0, 0, -size))]
    start = gt.State(omega=(0.1, 0, 1))
    return gt.Scene(
        gt.Body(moments=(1, 2, 3)), [*torques, E.AngularDamping(1e-9)], start, watch=["omega"], t=10
    )


def test_effects_that_cancel_each_other_stay():
    """Two opposite torques change nothing together; each by itself is too large to be omitted."""
    budget = pair(0.1).called_for(1e-3)
    assert budget.omitted == ("angular_damping",)
    assert budget["body_moment"].influence > 0.1
    # Each is below the accuracy, but their sum is not: one of them stays.
    some = pair(2e-4).called_for(1e-3)
    assert max(row.influence for row in some.rows) < 9e-4
    assert len(some.effects) == 1
    assert pair(1e-5).called_for(1e-3).effects == ()


def test_effects_that_replace_each_other_do_not_go_together():
    """Either of two strong drags stops the body; their omission together is measured."""
    scene = gt.Scene(
        BALL,
        [E.LinearDrag(1e3), E.QuadraticDrag(1e9)],
        gt.State(velocity=(1, 0, 0)),
        watch=["velocity"],
        t=[0, 1, 2],
    )
    budget = scene.called_for(1e-2)
    assert max(row.influence for row in budget.rows) < 1e-3
    assert len(budget.effects) == 1
    everything = replace(scene, accuracy=1e-4).run()
    assert change(everything, budget.chosen.run()) <= 1e-2


def test_a_quantity_that_loses_digits_gets_more():
    """An energy that is a small difference of large ones is as accurate as requested."""
    weight = -0.981 * math.cos(2.5)
    speed = math.sqrt(2 * weight / 1.01) * (1 + 1e-6)
    swing = gt.Scene(
        gt.Body(mass=1, moments=(1, 1, 0.5)),
        [E.Gravity(9.81), E.Pivot([0, 0, 0.1])],
        gt.State(omega=(speed, 0, 0), euler=(0, 2.5, 0)),
        watch=["energy"],
        t=5,
    )
    budget = swing.called_for(1e-2)
    assert budget.chosen.accuracy < 1e-3
    assert budget.numerical_error <= 1e-2
    exact = 1.01 * speed**2 / 2 - weight
    assert budget.result["energy"] == pytest.approx(exact, rel=1e-2)


def test_a_needed_effect_gives_its_reason():
    """An effect without which nothing can be watched, or the motion ends elsewhere, is included."""
    wheel = E.Rotor((0, 0, 1), momentum=0.01, inertia=0.01)
    spun = gt.Scene(
        gt.Body(moments=(1, 2, 3)), [wheel], gt.State(omega=(0, 0.1, 1)), ["rotor_speed"], t=1
    )
    row = spun.called_for(0.5)["rotor"]
    assert math.isinf(row.influence)
    assert row.included
    assert "rotor_speed" in row.note
    # Without the first wheel the second one would be called rotor, and be compared with the first.
    two = replace(spun, effects=[wheel, E.Rotor((1, 0, 0), 1e-9, 1e-9)], watch=["rotor2_speed"])
    assert "other names" in two.called_for(0.5)["rotor"].note
    assert replace(two, watch=["rotor_speed"]).called_for(0.5).omitted == ("rotor2",)
    # At rest: a relative change of zero has no size.
    still = gt.Scene(
        BALL,
        [E.Gravity(1), E.Thrust((0, 0, 1))],
        gt.State(omega=(0, 0, 0), euler=(0, 0, 0)),
        ["z"],
        1,
    )
    assert still.called_for(0.5).effects == ("gravity", "thrust")


def test_a_chaotic_scene_is_reported():
    """A heavy asymmetric top: the choice holds for its times only; the report gives the reason."""
    top = gt.Scene(
        gt.Body(mass=1, moments=(1, 2, 2.7)),
        [E.Gravity(9.81), E.Pivot([0.1, 0.2, 0.5]), E.AngularDamping(1e-9)],
        gt.State(omega=(0.5, 0.2, 0.3), euler=(0.3, 0.3, 0.4)),
        watch=["omega"],
        t=40,
    )
    budget = top.called_for(1e-2)
    assert budget.growth.chaotic
    assert "no limit" in str(budget)
    assert budget.to_json()["chaotic"] is True
    for name in ("lagrange_loop", "rolling_disc", "sleeping_top", "missile", "kovalevskaya_top"):
        scene = gt.scenes.load(name)
        growth = scene.composite().growth(None)
        assert growth.power < 1.2, name
        assert not growth.chaotic, name
    assert "no limit" not in str(MISSILE.called_for(1e-2))


def test_showing():
    """The table, the figure, JSON and the look-up of a row."""
    budget = MISSILE.called_for(1e-2)
    text = str(budget)
    assert "calls for 2 of 5 effects" in text
    assert "omitted  linear_drag        6.9e-05  velocity" in text
    assert text in repr(budget)
    assert "<svg" in budget._repr_html_()
    data = json.loads(json.dumps(budget.to_json(), allow_nan=False))
    assert data["effects"] == ["thrust", "gravity"]
    assert data["rows"][0]["effect"] == "thrust"
    shown = [text.get_text() for text in budget.plot().axes[0].texts]
    assert "linear_drag (omitted)" in shown
    assert "6.9e−5 of velocity" in shown
    assert "accuracy 0.01" in shown


def test_results_do_not_depend_on_the_clock():
    """Equal calls give equal rows, errors and numbers."""
    one, two = MISSILE.called_for(1e-2), MISSILE.called_for(1e-2)
    assert one.rows == two.rows
    assert (one.error, one.integration_accuracy) == (two.error, two.integration_accuracy)
    assert np.array_equal(one.result["position"], two.result["position"])


def test_with_values_retains_called_for_effects():
    """`with_values` retains the effects that the new accuracy calls for."""
    some = MISSILE.with_values(accuracy=1e-2, effects="called for")
    assert tuple(some.keyed) == ("thrust", "gravity")
    assert some == MISSILE.called_for(1e-2).chosen
    bare = gt.Scene(BALL, start=gt.State(omega=(0, 0, 1)), t=1).called_for(1e-3)
    assert bare.rows == ()
    assert "calls for 0 of 0 effects" in str(bare)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: MISSILE.called_for(0), AccuracyError, "expected"),
        (lambda: MISSILE.called_for("much"), AccuracyError, "expected"),
        (lambda: MISSILE.called_for(1e-2)["drag"], UnknownNameError, "There are thrust"),
        (lambda: MISSILE.with_values(effects="some"), UnknownNameError, "expected 'called for'"),
        (lambda: replace(MISSILE, watch=["euler"]).called_for(1e-17), AccuracyError, "expected"),
        (lambda: gt.Scene(BALL, 3, gt.State()), SceneError, "expected an effect"),
    ],
)
def test_refusals(call, error, words):
    with pytest.raises(error, match=words):
        call()
