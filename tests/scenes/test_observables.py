"""Observables: every quantity agrees with brute force, for any axes, free and on a pivot."""

# The tests pass bad input and arrays for lists, and use results that could be None.
# pyright: reportArgumentType=false

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import geomtorsion as gt
from geomtorsion.scenes.observables import OBSERVABLES
from tests.rounding import ROUNDED
from tests.scenes import brute

E = gt.effects
MASS, G = 1.5, 9.81
SKEW = np.array([[0.12, 0.01, -0.015], [0.01, 0.16, 0.02], [-0.015, 0.02, 0.2]])
ARM = np.array([0.05, -0.1, 0.25])
OMEGA, ANGLES = np.array([1.0, -2.0, 8.0]), (0.5, 0.9, -0.4)
PLACE, SPEED = np.array([1.0, 2.0, 3.0]), np.array([0.5, -1.0, 4.0])
TIMES = np.linspace(0, 1.5, 16)
NAMES = [name for name in OBSERVABLES if name not in ("work", "energy_balance")]
MORE = ["euler:ZYX", "euler:xyx", "Omega2", "n3"]


def known(held):
    """The value of every quantity, from the brute force integration."""
    steiner = MASS * (ARM @ ARM * np.eye(3) - np.outer(ARM, ARM)) if held else np.zeros((3, 3))
    inertia = SKEW + steiner

    def moment(t, w, r, x, v):
        return np.cross(ARM, r.T @ [0, 0, -MASS * G]) if held else np.zeros(3)

    w, r, x, v = brute.motion(
        inertia, OMEGA, brute.zyz(*ANGLES), TIMES, moment, PLACE, SPEED,
        lambda t, w, r, x, v: np.array([0, 0, -G]),
    )  # fmt: skip
    if held:
        x = np.einsum("mij,j->mi", r, ARM)
        v = np.einsum("mij,mj->mi", r, np.cross(w, ARM))
    angular = w @ inertia
    space = lambda u: np.einsum("mij,mj->mi", r, u)  # noqa: E731
    turns = Rotation.from_matrix(r)
    zyz = np.unwrap(turns.as_euler("zyz"), axis=0)
    nodal = Rotation.from_euler("z", zyz[:, :1])
    rotational = 0.5 * np.einsum("mi,ij,mj->m", w, SKEW, w)
    kinetic, potential = rotational + 0.5 * MASS * (v**2).sum(1), MASS * G * x[:, 2]
    quaternion = turns.as_quat(scalar_first=True)
    return {
        "omega": w, "omega_space": space(w), "omega_axis": nodal.apply(w),
        "angular_momentum": angular, "angular_momentum_space": space(angular),
        "angular_momentum_axis": nodal.apply(angular), "quaternion": quaternion, "matrix": r,
        "euler": zyz, "nutation": zyz[:, 1], "spin": zyz[:, 0], "precession": zyz[:, 2],
        "axis": r[:, :, 2], "vertical": r[:, 2, :], "energy": kinetic + potential,
        "kinetic_energy": kinetic, "rotational_energy": rotational, "potential_energy": potential,
        "position": x, "velocity": v, "velocity_body": np.einsum("mij,mi->mj", r, v),
        "momentum": MASS * v, "euler:ZYX": np.unwrap(turns.as_euler("ZYX"), axis=0),
        "euler:xyx": np.unwrap(turns.as_euler("xyx"), axis=0), "Omega2": w[:, 1], "n3": r[:, 2, 2],
    }  # fmt: skip


@pytest.mark.parametrize("held", [False, True], ids=["free", "held"])
def test_every_quantity(held):
    body = gt.Body(MASS, inertia=SKEW)
    effects = [E.Gravity(G), *([E.Pivot(ARM)] if held else [])]
    moving = {} if held else {"position": PLACE, "velocity": SPEED}
    start = gt.State(omega=OMEGA, euler=ANGLES, **moving)
    names = [n for n in [*NAMES, *MORE] if n != "n3"]
    scene = gt.Scene(body, effects, start, names, TIMES, accuracy=1e-11)
    result, expected = scene.run(), known(held)
    assert len(names) > 24
    for name in names:
        ours, theirs = result[name], expected[name]
        assert ours.shape == theirs.shape, name
        if name == "quaternion":
            theirs = theirs * np.sign((ours * theirs).sum(1))[:, None]
        elif "euler" in name or name in ("spin", "precession"):
            # Angles are determined only up to whole turns.
            theirs = theirs - 2 * np.pi * np.round((theirs - ours)[:1] / (2 * np.pi))
        assert np.abs(ours - theirs).max() < 1e-9 * max(1, np.abs(theirs).max()), name
    single = gt.Scene(body, effects, start, ["nutation", "n3"], TIMES, accuracy=1e-11)
    assert "n1" in single.selection.states
    assert np.abs(single.run()["n3"] - expected["n3"]).max() < 1e-9


def test_energy_balance():
    """The energy changes by the work of damping, drag and thrust."""
    start = gt.State(omega=(1, 2, -1), euler=(0, 0.5, 0), velocity=(5, 0, 3))
    effects = [
        E.AngularDamping(0.2), E.LinearDrag(0.3), E.Gravity(), E.Thrust((0, 0, 2), end=1.3),
    ]  # fmt: skip
    scene = gt.Scene(gt.Body(moments=(1, 2, 3)), effects, start, ["energy_balance", "work"], t=2)
    result = scene.run()
    balance = result["energy_balance"]
    assert np.ptp(balance) < 1e-9 * np.abs(balance).max()
    assert np.abs(result["work"]).max() > 0.5
    assert "energy" not in result.drift
    assert result.drift["energy_balance"] < 1e-10
    quiet = gt.Scene(gt.Body(moments=(1, 2, 3)), (), start, ["work"], t=1).run()
    assert not quiet["work"].any()


def test_moments_about_the_pivot():
    """A top with moments about its tip equals the top with Steiner's part added."""
    centre = gt.Body(MASS, inertia=SKEW)
    steiner = MASS * (ARM @ ARM * np.eye(3) - np.outer(ARM, ARM))
    tip = gt.Body(MASS, inertia=SKEW + steiner)
    start = gt.State(omega=OMEGA, euler=ANGLES)
    names = ["omega", "energy", "angular_momentum", "rotational_energy", "precession"]
    one = gt.Scene(centre, [E.Gravity(G), E.Pivot(ARM)], start, names, t=1).run()
    held = E.Pivot(ARM, moments_at="pivot")
    two = gt.Scene(tip, [E.Gravity(G), held], start, names, t=1).run()
    for name in names:
        assert np.abs(one[name] - two[name]).max() < 1e-9 * np.abs(one[name]).max()


def test_axis_of_symmetry_is_followed():
    """The observed axis of a body symmetric about its first axis is that axis."""
    start = gt.State(omega=(3, 0.2, 0), quaternion=(1, 0, 0, 0))
    result = gt.Scene(gt.Body(moments=(1, 2, 2)), (), start, ["axis", "matrix"], t=2).run()
    assert np.abs(result["axis"] - result["matrix"][:, :, 0]).max() < ROUNDED


def test_backwards_in_time():
    """To t = -5 the closed form and the integrator agree."""
    start = gt.State(omega=(0.3, 1, 0.2), euler=(0, 0.5, 0))
    scene = gt.Scene(gt.Body(moments=(1, 2, 3)), (), start, ["omega", "axis"], t=-5)
    closed, stepped = scene.run(), scene.run(engine=gt.Taylor())
    assert closed.closed_form
    assert closed.times[-1] == -5
    assert np.abs(closed["axis"] - stepped["axis"]).max() < 1e-9


def test_the_quaternion_keeps_its_length():
    """In ten thousand turns of a heavy top the length stays one and the matrix a rotation."""
    start = gt.State(omega=(0, 0, 20), euler=(0, 0.3, 0))
    top = [E.Gravity(), E.Pivot([0, 0, 0.1])]
    names = ["quaternion", "matrix", "vertical"]
    scene = gt.Scene(gt.Body(moments=(1, 1, 0.5)), top, start, names, [3000.0], accuracy=1e-8)
    result = scene.run()
    assert abs(np.linalg.norm(result["quaternion"]) - 1) < ROUNDED
    r = result["matrix"][0]
    assert np.abs(r.T @ r - np.eye(3)).max() < ROUNDED
    assert np.abs(r[2] - result["vertical"][0]).max() < ROUNDED
