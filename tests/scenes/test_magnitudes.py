"""Magnitudes: effects that a scene does not have, with their numbers and their influence."""

# The tests pass bad input.
# pyright: reportArgumentType=false, reportAttributeAccessIssue=false

import json
import math
from dataclasses import replace

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import ArgumentError, GeomtorsionError, SceneError, UnknownNameError
from geomtorsion.scenes.effects.surroundings import mean_radius, semiaxes
from geomtorsion.scenes.magnitudes import at_surface

E = gt.effects
STONE = gt.Scene(
    gt.Body.ellipsoid(mass=0.2, semiaxes=(0.03, 0.03, 0.02)),
    start=gt.State(velocity=(20, 0, 5)),
    watch=["position"],
    t=1,
)


def test_numbers_follow_from_body_and_surroundings():
    """Drag of a sphere by Stokes and by its section, and the rate of the lowest orbit."""
    ball = gt.Body.ellipsoid(mass=3, semiaxes=(0.5, 0.5, 0.5))
    around = E.Surroundings(gravity=2, radius=8e6, density=1.5, viscosity=1e-3, drag_coefficient=1)

    def made(kind):
        return kind.typical(ball, around).effect

    assert made(E.Gravity) == E.Gravity(2)
    assert made(E.LinearDrag).coefficient == pytest.approx(6 * math.pi * 1e-3 * 0.5)
    assert made(E.AngularDamping).coefficient == pytest.approx(8 * math.pi * 1e-3 * 0.125)
    assert made(E.QuadraticDrag).coefficient == pytest.approx(1.5 * math.pi * 0.25 / 2)
    assert made(E.GravityGradient).rate == 5e-4
    assert E.Spring.typical(ball, around) is None
    # Period of the lowest orbit around the Earth: 84.4 minutes.
    assert 2 * math.pi / E.Surroundings().orbital_rate / 60 == pytest.approx(84.4, abs=0.1)


@pytest.mark.parametrize("axes", [(3, 2, 1), (1, 3, 2), (1, 1, 1)])
def test_semiaxes_of_an_ellipsoid(axes):
    body = gt.Body.ellipsoid(mass=0.7, semiaxes=axes)
    assert semiaxes(body) == pytest.approx(sorted(axes, reverse=True))
    assert mean_radius(body) == pytest.approx(math.prod(axes) ** (1 / 3))


def test_a_flat_body_has_a_radius():
    assert mean_radius(gt.Body(moments=(1, 1, 2))) == pytest.approx(math.sqrt(5))


def test_a_thrown_stone_lacks_gravity_and_drag():
    """The influence is the one by formulas: g t^2 / 2 of the distance, and so on."""
    table = STONE.magnitudes()
    rows = {row.effect.key: row for row in table.rows}
    # After a second the stone is at (20, 0, 5), its largest component 20.
    assert rows["gravity"].influence == pytest.approx(9.80665 / 2 / 20, rel=1e-9)
    # x = (m / c) (1 - e^(-c t / m)) v with the coefficient of Stokes.
    rate = rows["linear_drag"].effect.coefficient / 0.2
    short = 1 - (1 - math.exp(-rate)) / rate
    assert rows["linear_drag"].influence == pytest.approx(short, rel=1e-6)
    assert rows["angular_damping"].influence == 0
    assert table.lacking(1e-3) == (rows["gravity"].effect, rows["quadratic_drag"].effect)
    assert table.lacking(1) == ()
    assert "spring" in table.devices
    assert "naive" not in table.devices
    # Nothing is added.
    assert table.scene.effects == STONE.effects == ()


def test_what_a_scene_has_is_not_repeated():
    scene = replace(STONE, effects=[E.Gravity(9.81)])
    assert "gravity" not in [row.effect.key for row in scene.magnitudes().rows]
    assert {row.effect.key for row in scene.magnitudes().rows} < {
        row.effect.key for row in STONE.magnitudes().rows
    }


def test_other_surroundings():
    """On the Moon there is no air, and the weight is a sixth."""
    moon = E.Surroundings(gravity=1.62, radius=1.737e6, density=0, viscosity=0)
    rows = {row.effect.key: row.influence for row in STONE.magnitudes(moon).rows}
    assert rows["gravity"] == pytest.approx(1.62 / 2 / 20)
    assert rows["quadratic_drag"] == rows["linear_drag"] == 0


def test_showing():
    table = STONE.magnitudes()
    text = str(table)
    assert "g = 9.81 m/s^2" in text
    assert "F = m g: near the surface of the planet" in text
    assert "Nothing is added to the scene." in text
    assert "<svg" in table._repr_html_()
    data = json.loads(json.dumps(table.to_json(), allow_nan=False))
    assert data["rows"][0]["effect"] == "gravity"
    assert data["surroundings"]["gravity"] == 9.80665
    at_rest = replace(STONE, start=gt.State(velocity=(0, 0, 0)))
    assert "from 0" in str(at_rest.magnitudes())
    assert json.dumps(at_rest.magnitudes().to_json(), allow_nan=False)


@pytest.mark.parametrize(
    ("accuracy", "keys"),
    [
        (1, ()),
        (0.1, ("gravity",)),
        (1e-2, ("gravity", "quadratic_drag")),
        (1e-6, ("gravity", "linear_drag", "quadratic_drag")),
    ],
)
def test_a_scene_with_the_effects_that_it_calls_for(accuracy, keys):
    """`effects="called for"` takes gravity and air as far as the accuracy calls for them."""
    scene = replace(STONE, effects="called for", accuracy=accuracy)
    assert tuple(scene.keyed) == keys
    everything = replace(STONE, effects=at_surface(STONE.body))
    exact = replace(everything, accuracy=1e-10).run()["position"]
    assert np.abs(scene.run()["position"] - exact).max() <= accuracy * np.abs(exact).max()
    # It is a scene as any other.
    assert replace(scene, effects=list(scene.effects)) == scene
    assert "called for" not in gt.scenes.to_toml(scene)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: E.Surroundings(gravity=-1), SceneError, "surroundings.gravity: expected 0 or a positive number, got -1"),
        (lambda: E.Surroundings(density=math.nan), SceneError, "surroundings.density"),
        (lambda: E.Surroundings(viscosity="thick"), SceneError, "surroundings.viscosity"),
        (lambda: E.Surroundings(radius=0), SceneError, "surroundings.radius: expected a positive number, got 0"),
        (lambda: STONE.magnitudes("moon"), ArgumentError, "surroundings"),
        (lambda: STONE.magnitudes().lacking(-1), GeomtorsionError, "expected"),
        (lambda: replace(STONE, effects="all"), SceneError, "got 'all'.*'called for'"),
        (lambda: replace(STONE, effects="called for", watch=["size"]), UnknownNameError, "size"),
    ],
)
def test_refusals(call, error, words):
    with pytest.raises(error, match=words):
        call()
