"""MuJoCo, an independent program, with RK4 at small steps, agrees on two scenes."""

import numpy as np
import pytest

from geomtorsion.scenes import Body, Scene, State, effects

mujoco = pytest.importorskip("mujoco", reason="mujoco is an optional witness")

E = effects
TOP = """
<mujoco>
  <option timestep="{step}" integrator="RK4" gravity="0 0 -9.81"/>
  <worldbody>
    <body name="top" pos="0 0 0">
      {joint}
      <inertial pos="{place}" mass="1.7" diaginertia="0.05 0.06 0.08"/>
    </body>
  </worldbody>
</mujoco>
"""


def stepped(xml, steps, position, velocity):
    """Position and velocity coordinates after this number of steps."""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = position, velocity
    mujoco.mj_step(model, data, nstep=steps)
    return data.qpos.copy(), data.qvel.copy()


def test_a_heavy_asymmetric_top():
    """A ball joint at the pivot, damped; quaternion and rates after a second."""
    quaternion, omega = (0.8, 0.36, 0.48, 0.0), (1.0, -2.0, 15.0)
    joint = '<joint type="ball" damping="0.01"/>'
    xml = TOP.format(step=2e-4, joint=joint, place="0.02 0.0 0.3")
    place, speed = stepped(xml, 5000, quaternion, omega)
    result = Scene(
        Body(1.7, (0.05, 0.06, 0.08)),
        [E.Gravity(9.81), E.Pivot((0.02, 0, 0.3)), E.AngularDamping(0.01)],
        State(omega=omega, quaternion=quaternion), ["omega", "quaternion"], [0.0, 1.0],
    ).run()  # fmt: skip
    # Fourth order in steps of 2e-4: their error is about 1e-11.
    assert abs(result["omega"][-1] - speed).max() < 1e-8 * np.linalg.norm(speed)
    ours = result["quaternion"][-1]
    assert abs(abs(ours @ place) - 1) < 1e-13
    assert abs(ours * np.sign(ours @ place) - place).max() < 1e-8


def test_a_thrown_tumbling_body_with_drag():
    """A free joint with damping: linear drag on the centre, angular damping in body axes."""
    quaternion, omega, velocity = (0.8, 0.36, 0.48, 0.0), (0.1, 9.0, 0.2), (4.0, -1.0, 6.0)
    joint = '<joint type="free" damping="0.03"/>'
    xml = TOP.format(step=2e-4, joint=joint, place="0 0 0")
    place, speed = stepped(xml, 7500, (0, 0, 0, *quaternion), (*velocity, *omega))
    result = Scene(
        Body(1.7, (0.05, 0.06, 0.08)),
        [E.Gravity(9.81), E.LinearDrag(0.03), E.AngularDamping(0.03)],
        State(omega=omega, quaternion=quaternion, velocity=velocity),
        ["omega", "quaternion", "velocity", "position"], [0.0, 1.5],
    ).run()  # fmt: skip
    assert abs(result["position"][-1] - place[:3]).max() < 1e-8
    assert abs(result["velocity"][-1] - speed[:3]).max() < 1e-8
    assert abs(result["omega"][-1] - speed[3:]).max() < 1e-8 * np.linalg.norm(speed[3:])
    ours = result["quaternion"][-1]
    assert abs(ours * np.sign(ours @ place[3:]) - place[3:]).max() < 1e-8
