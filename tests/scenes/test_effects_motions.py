"""Motions under single effects agree with closed forms."""

# The tests pass bad input and arrays for lists, and use results that could be None.
# pyright: reportArgumentType=false

import math
from dataclasses import dataclass

import mpmath
import numpy as np
import pytest
from scipy.integrate import simpson

from geomtorsion.rigid.attitude import rotated
from geomtorsion.scenes import Body, Scene, State, effects
from tests.rounding import ROUNDED

E = effects
BODY = Body(mass=2.0, moments=(1.0, 1.6, 2.1))
SPHERE = Body(mass=2.0, moments=(1.5, 1.5, 1.5))
UPRIGHT = (1, 0, 0, 0)
# Runs request 1e-11, and no closed form is off by more than ten times that.
ACCURACY, NEAR = 1e-11, 1e-10


def run(body, acting, watch, t, **start):
    start = {"omega": (0, 0, 0), "quaternion": UPRIGHT} | start
    return Scene(body, acting, State(**start), watch, t, accuracy=ACCURACY, samples=41).run()


def test_a_spring_swings_as_a_sine():
    result = run(BODY, [E.Spring(8.0)], ["position"], 5, position=(1, 0, -2), velocity=(0, 3, 0))
    t = result.times
    exact = [np.cos(2 * t), 1.5 * np.sin(2 * t), -2 * np.cos(2 * t)]
    assert abs(result["position"] - np.transpose(exact)).max() < NEAR


def test_a_stretched_spring_keeps_its_length_in_a_circle():
    """k (r - length) = m w^2 r: 8 (1.25 - 1) = 2 * 0.8 * 1.25."""
    result = run(
        BODY, [E.Spring(8.0, length=1.0)], ["position"], 6,
        position=(1.25, 0, 0), velocity=(0, 1.25 * math.sqrt(0.8), 0),
    )  # fmt: skip
    angle = math.sqrt(0.8) * result.times
    exact = 1.25 * np.transpose([np.cos(angle), np.sin(angle), 0 * angle])
    assert abs(result["position"] - exact).max() < NEAR


def test_linear_drag_falls_to_its_last_speed():
    result = run(BODY, [E.LinearDrag(0.5), E.Gravity(9.81)], ["velocity"], 8, velocity=(3, 0, 0))
    fade = np.exp(-0.25 * result.times)
    exact = np.transpose([3 * fade, 0 * fade, -39.24 * (1 - fade)])
    assert abs(result["velocity"] - exact).max() < 40 * NEAR


def test_quadratic_drag_falls_as_tanh():
    g, last = 9.81, math.sqrt(2 * 9.81 / 0.5)
    result = run(BODY, [E.QuadraticDrag(0.5), E.Gravity(g)], ["velocity"], 3, velocity=(0, 0, -1))
    exact = -last * np.tanh(g * result.times / last + math.atanh(1 / last))
    assert abs(result["velocity"][:, 2] - exact).max() < 10 * NEAR


def test_a_stone_turns_at_the_top():
    """Straight up and down again: tan until the top, tanh after it; a dropped stone as well."""
    g, last = 9.81, math.sqrt(2 * 9.81 / 0.1)
    acting = [E.QuadraticDrag(0.1), E.Gravity(g)]
    result = run(BODY, acting, ["velocity"], 2, velocity=(0, 0, 5))
    angle = math.atan(5 / last) - g * result.times / last
    exact = last * np.where(angle > 0, np.tan(angle), np.tanh(angle))
    assert abs(result["velocity"][:, 2] - exact).max() < 10 * NEAR
    result = run(BODY, acting, ["velocity"], 2)
    exact = -last * np.tanh(g * result.times / last)
    assert abs(result["velocity"][:, 2] - exact).max() < 10 * NEAR


def test_damping_fades_exponentially():
    result = run(BODY, [E.AngularDamping((0.3, 0.2, 0.7))], ["omega"], 9, omega=(0, 0, 4))
    assert abs(result["omega"][:, 2] - 4 * np.exp(-result.times / 3)).max() < 10 * NEAR
    result = run(SPHERE, [E.AngularDamping(0.3)], ["omega"], 9, omega=(1, 2, 3))
    exact = np.exp(-0.2 * result.times)[:, None] * np.array([1, 2, 3])
    assert abs(result["omega"] - exact).max() < 10 * NEAR


def test_damping_of_a_tumbling_body_balances_its_energy():
    """The energy falls by the integral of c Omega^2, by Simpson's rule on the reported rates."""
    scene = Scene(
        BODY, [E.AngularDamping(0.4)], State(omega=(1, 2, -1)), ["omega", "energy"],
        np.linspace(0, 4, 4001), accuracy=1e-12,
    )  # fmt: skip
    result = scene.run()
    power = -0.4 * (result["omega"] ** 2).sum(axis=1)
    energy = result["energy"]
    # Simpson's error: h^4 = 1e-12 times the fourth derivative of the power.
    assert abs(energy[-1] - energy[0] - simpson(power, x=result.times)) < 1e-10 * energy[0]


@pytest.mark.parametrize(
    "acting",
    [
        [E.LinearDrag(0.3, arm=(0.1, 0.2, -0.4)), E.Gravity(9.81)],
        [E.QuadraticDrag(0.1, arm=(0, 0, -0.4), wind=(1, 0, 0)), E.Gravity(9.81)],
        [E.AngularDamping(0.2), E.Pivot((0, 0.1, 0.3)), E.Gravity(9.81)],
        [E.Rotor((0, 3, 4), 1.7, inertia=0.4, torque="-0.2*w")],
        [E.LinearDrag(0.2), E.KnifeEdge((0.3, 0, 0), speed=2)],
    ],
    ids=lambda acting: acting[0].key,
)
def test_energy_less_work_stays(acting):
    """Over a whole motion the lost energy equals the work of the effect."""
    start = {"omega": (0, 0, -1)} if acting[-1].key == "knife_edge" else {"omega": (1, 2, -1)}
    if acting[-1].key == "gravity" and acting[1].key != "pivot":
        start["velocity"] = (5, 0, 3)
    result = run(BODY, acting, ["energy", "work"], 3, **start)
    energy, work = result["energy"], result["work"]
    size = abs(energy).max()
    assert abs(energy - work - energy[0]).max() < NEAR * size
    assert abs(work[-1]) > 1e-2 * size


def test_a_compass_needle_swings_like_a_pendulum():
    """Quarter period sqrt(I / mu B) K(sin^2(angle / 2)), from mpmath."""
    angle = 2.0
    quarter = math.sqrt(1.0 / (0.5 * 3)) * float(mpmath.ellipk(math.sin(angle / 2) ** 2))
    result = run(
        BODY, [E.Magnet((0, 0, 0.5), (0, 0, 3))], ["nutation", "omega"], [0, quarter, 4 * quarter],
        quaternion=(math.cos(angle / 2), math.sin(angle / 2), 0, 0),
    )  # fmt: skip
    assert abs(result["nutation"] - [angle, 0, angle]).max() < 10 * NEAR
    assert abs(result["omega"][:, 1:]).max() < NEAR


def test_a_field_that_turns_takes_the_needle_along():
    """In step with the field: mu along B(t), Omega = the field's rate."""
    needle = E.Magnet((1, 0, 0), ("cos(2*t)", "sin(2*t)", 0))
    result = run(BODY, [needle], ["quaternion"], 5, omega=(0, 0, 2))
    exact = np.transpose([np.cos(result.times), np.sin(result.times)])
    assert abs(result["quaternion"][:, [0, 3]] - exact).max() < NEAR


def test_a_satellite_librates_on_its_orbit():
    """In the plane: a'' = -(3/2) n^2 (I2 - I1) / I3 sin 2a, a pendulum in 2 a."""
    n, swing = 0.8, 0.5
    rate = n * math.sqrt(3 * (1.6 - 1.0) / 2.1)
    quarter = float(mpmath.ellipk(math.sin(swing) ** 2)) / rate
    times = [0, quarter, 2 * quarter]
    result = run(
        BODY, [E.GravityGradient(n)], ["quaternion", "omega"], times,
        omega=(0, 0, n), quaternion=(math.cos(swing / 2), 0, 0, math.sin(swing / 2)),
    )  # fmt: skip
    angle = 2 * np.unwrap(np.arctan2(result["quaternion"][:, 3], result["quaternion"][:, 0]))
    assert abs(angle - n * result.times - [swing, 0, -swing]).max() < 10 * NEAR
    assert result["omega"][1, 2] - n == pytest.approx(-rate * math.sin(swing), abs=10 * NEAR)


def test_a_sphere_with_a_rotor_precesses_about_it():
    """I Omega' = -Omega x h: the angular velocity rotates around the axis at h / I."""
    result = run(
        SPHERE, [E.Rotor((0, 0, 2), momentum=3.0)], ["omega", "energy"], 6, omega=(1, 0, 5)
    )
    angle = 2 * result.times
    exact = np.transpose([np.cos(angle), np.sin(angle), 5 + 0 * angle])
    assert abs(result["omega"] - exact).max() < 10 * NEAR


def test_a_free_rotor_and_a_driven_one_differ():
    """A free wheel is coupled only by inertia: L = (I - J a a^T) Omega + h a in space."""
    wheel = E.Rotor((0, 3, 4), 1.7, inertia=0.4)
    watch = ["angular_momentum_space", "energy", "rotor_speed", "omega"]
    result = run(BODY, [wheel], watch, 5, omega=(1, 2, 3))
    momentum, energy = result["angular_momentum_space"], result["energy"]
    assert abs(momentum - momentum[0]).max() < 10 * NEAR
    assert abs(energy - energy[0]).max() < 10 * NEAR
    along = result["omega"] @ np.array([0, 0.6, 0.8])
    assert abs(0.4 * (result["rotor_speed"] + along) - 1.7).max() < NEAR
    assert np.ptp(result["rotor_speed"]) > 0.1


def test_friction_locks_a_rotor():
    """With friction in the bearing both speeds become equal and the momentum is kept."""
    wheel = E.Rotor((0, 0, 1), momentum=2.1, inertia=0.4, torque="-0.5*w")
    result = run(BODY, [wheel], ["rotor_speed", "omega"], 60, omega=(0, 0, 0))
    assert abs(result["rotor_speed"][-1]) < 1e-9
    # h + (I3 - J) Omega = const: at the end, I3 Omega3 = 2.1.
    assert result["omega"][-1, 2] == pytest.approx(1.0, abs=1e-9)


def test_thrust_is_switched_at_exact_times():
    """v = F (end - start) / m after the burn, and the position agrees as well."""
    start, end = 1 / 3, math.pi / 2
    burn = E.Thrust((0, 0, 6.0), start=start, end=end)
    times = [0.0, start, 1.0, end, 3.0]
    result = run(BODY, [burn], ["velocity", "position"], times)
    on = np.clip(result.times, start, end) - start
    speed = 3 * on
    place = 1.5 * on**2 + speed * np.maximum(result.times - end, 0)
    assert abs(result["velocity"][:, 2] - speed).max() < ROUNDED
    assert abs(result["position"][:, 2] - place).max() < 1e-13


def test_moments_follow_expressions_of_time():
    result = run(BODY, [E.BodyMoment((0, 0, "2.1*cos(3*t)"))], ["omega"], 4)
    assert abs(result["omega"][:, 2] - np.sin(3 * result.times) / 3).max() < NEAR


def test_a_screw_or_a_straight_line():
    """With the torsion force the body moves on a helix (Omega, V constant in it), else straight."""
    omega, velocity, quaternion = (0.3, -0.4, 1.2), (1.0, 0.5, 2.0), (0.5, -0.5, 0.5, -0.5)
    start = {"omega": omega, "velocity": velocity, "quaternion": quaternion}
    watch = ["position", "omega", "velocity_body"]
    helix = run(SPHERE, [E.Torsion()], watch, 7, **start)
    line = run(SPHERE, [E.Torsion(strength=0)], ["position"], 7, **start)
    t = helix.times[:, None]
    assert abs(line["position"] - t * np.array(velocity)).max() < NEAR
    space = rotated(np.array(quaternion), np.array(omega))
    rate = np.linalg.norm(space)
    axis, v = space / rate, np.array(velocity)
    along = (v @ axis) * axis
    across = v - along
    sine, cosine = np.sin(rate * t) / rate, (1 - np.cos(rate * t)) / rate
    exact = along * t + across * sine + np.cross(axis, across) * cosine
    assert abs(helix["position"] - exact).max() < 10 * NEAR
    assert abs(helix["velocity_body"] - helix["velocity_body"][0]).max() < NEAR


def test_autoparallels_turn_uniformly_with_unequal_moments():
    """Omega and the energy are constant; the angular momentum in space is not."""
    watch = ["omega", "angular_momentum_space", "energy"]
    for law in (E.Torsion(), E.Naive()):
        result = run(BODY, [law], watch, 5, omega=(1, 2, 3))
        assert abs(result["omega"] - [1, 2, 3]).max() < NEAR
        assert np.ptp(result["energy"]) < NEAR
        assert np.ptp(result["angular_momentum_space"], axis=0).max() > 1


def test_the_naive_law_omits_the_whole_angular_momentum():
    """L' = M: without a torque Omega is constant, with a rotor and about a pivot as well."""
    for more in (
        E.Pivot((0.1, 0.2, 0.3)),
        E.Rotor((1, 2, 2), momentum=0.8),
        E.Rotor((1, 2, 2), momentum=0.8, inertia=0.3),
    ):
        result = run(BODY, [E.Naive(), more], ["omega", "energy"], 5, omega=(1, 2, 3))
        assert result.scene is not None
        assert "naive" in result.scene.selection.effects
        assert abs(result["omega"] - [1, 2, 3]).max() < NEAR
        assert np.ptp(result["energy"]) < NEAR


def test_a_naive_top_is_one_top_wherever_its_moments_are_about():
    """Moments about the centre of mass, and Steiner's about the pivot, give the same motion."""
    arm = np.array([0.1, 0.2, 0.3])
    about_pivot = np.diag((1.0, 1.6, 2.1)) + 2.0 * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    motions = [
        run(body, [E.Naive(), E.Pivot(tuple(arm), moments_at=place), E.Gravity(9.81)],
            ["omega"], 3, omega=(1, 2, 3))["omega"]
        for body, place in ((BODY, "centre"), (Body(2.0, inertia=about_pivot), "pivot"))
    ]  # fmt: skip
    assert abs(motions[0] - motions[1]).max() < NEAR


@dataclass(frozen=True)
class Blade(E.Effect):
    """Chaplygin's sleigh as a user would write it, without exclusions."""

    key = "blade"

    def adds(self, context):
        u, spin = context.state("u"), context.Omega[2]
        tied = E.Constraint(("u", "Omega3"), (0, 0, spin), (u, 0.3 * spin, 0), start={"u": -1})
        return E.Contribution(constraint=tied)


def test_the_naive_law_keeps_the_turning_of_a_velocity_in_body_axes():
    """m Omega x v is not part of Omega x L where no point is held: here Omega x L vanishes."""
    right, naive = (
        run(BODY, [Blade(), *law], ["velocity", "omega"], 3, omega=(0, 0, 2))
        for law in ([], [E.Naive()])
    )
    assert np.ptp(right["omega"][:, 2]) > 1
    for name in ("velocity", "omega"):
        assert abs(naive[name] - right[name]).max() < NEAR


def test_chaplygins_sleigh_ends_straight_ahead():
    """Omega = W sech, u = a W c tanh with a > 0; E = (m u^2 + (I3 + m a^2) Omega^2) / 2."""
    a, m, inertia = 0.3, 2.0, 2.1
    whole = inertia + m * a * a
    spin, c = 1.2, math.sqrt(whole / m)
    result = run(BODY, [E.KnifeEdge((a, 0, 0))], ["forward", "omega"], 12, omega=(0, 0, spin))
    # u' = a Omega^2 and Omega' = -(m a / whole) u Omega.
    rate = a * spin / c
    t = result.times
    assert abs(result["omega"][:, 2] - spin / np.cosh(rate * t)).max() < 10 * NEAR
    assert abs(result["forward"] - spin * c * np.tanh(rate * t)).max() < 10 * NEAR


def test_a_sleigh_on_an_inclined_plane_does_not_slide_off():
    """The blade without an arm oscillates sideways instead of sliding down [NeimarkFufaev1972].

    u' = -g sin(tilt) cos(angle) along the blade, angle = Omega t.
    """
    tilt, spin, g = 0.4, 2.0, 9.81
    result = run(
        BODY, [E.KnifeEdge(), E.Gravity(g)], ["forward", "position"], 9,
        omega=(0, 0, spin), quaternion=(math.cos(tilt / 2), 0, -math.sin(tilt / 2), 0),
    )  # fmt: skip
    pull = -g * math.sin(tilt)
    t = result.times
    assert abs(result["forward"] - pull * np.sin(spin * t) / spin).max() < 10 * NEAR
    # Along the slope x it only oscillates: x = cos(tilt) pull (1 - cos 2 angle) / (4 spin^2).
    down = math.cos(tilt) * pull * (1 - np.cos(2 * spin * t)) / (4 * spin**2)
    assert abs(result["position"][:, 0] - down).max() < 10 * NEAR


def test_a_custom_effect_does_what_a_shipped_one_does():
    """A custom spring with drag agrees with the shipped effects."""
    own = E.Custom(
        force=("-k*x - c*vx", "-k*y - c*vy", "-k*z - c*vz"),
        parameters={"k": 8.0, "c": 0.25},
        energy=None,
        outputs={"reach": "sqrt(x^2 + y^2 + z^2)"},
    )
    start = {"position": (1, 0, -2), "velocity": (0, 3, 0)}
    mine = run(BODY, [own], ["position", "reach"], 4, **start)
    theirs = run(BODY, [E.Spring(8.0), E.LinearDrag(0.25)], ["position"], 4, **start)
    assert abs(mine["position"] - theirs["position"]).max() < NEAR
    assert abs(mine["reach"] - np.linalg.norm(theirs["position"], axis=1)).max() < NEAR


def test_a_custom_effect_has_states_and_switches():
    """A tank that empties at a rate proportional to its fuel until a valve shuts at t = 1.5."""
    tank = E.Custom(
        force=(0, 0, "fuel"), axes="body", parameters={"flow": 1.0}, states={"fuel": "-flow*fuel"},
        start={"fuel": 4.0}, switches=[(1.5, {"flow": 0.0})],
    )  # fmt: skip
    result = run(BODY, [tank], ["fuel", "velocity"], [0, 1, 1.5, 2.5])
    left = 4 * np.exp(-np.minimum(result.times, 1.5))
    assert abs(result["fuel"] - left).max() < NEAR
    speed = (4 - left + left * np.maximum(result.times - 1.5, 0)) / 2
    assert abs(result["velocity"][:, 2] - speed).max() < NEAR


def test_a_custom_effect_can_stop_the_motion():
    """A stone thrown up ends where z + 1 = 0, at t = (5 + sqrt(45)) / 10."""
    ground = E.Custom(stop="z + 1")
    result = run(
        BODY, [E.Gravity(10.0), ground], ["position"], 9, velocity=(1, 0, 5), position=(0, 0, 0)
    )
    assert result.solution.outcome == "stopped"
    assert result.times[-1] == pytest.approx((5 + math.sqrt(45)) / 10, abs=1e-9)
