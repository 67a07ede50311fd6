"""Chaplygin's sleigh: a blade lets it go forward and turn, and it forgets how it began.

python examples/scenes/chaplygin_sleigh.py
python examples/scenes/chaplygin_sleigh.py --t 20
"""

import argparse

import numpy as np

import geomtorsion as gt

MASS, ARM, SPEED, TURN = 1, 20 * 1e-2, -50 * 1e-2, 2.0


def main(arguments: list[str] | None = None) -> None:
    """Compare speed and turning with hyperbolic functions of time."""
    parser = argparse.ArgumentParser(description="Chaplygin's sleigh.")
    parser.add_argument("--t", type=float, default=6.0, help="last time, s")
    options = parser.parse_args(arguments)
    body = gt.Body.box(MASS, (80 * 1e-2, 50 * 1e-2, 5 * 1e-2))
    scene = gt.Scene(
        body,
        [gt.effects.KnifeEdge((ARM, 0, 0), speed=SPEED)],
        gt.State(omega=(0, 0, TURN), quaternion=(1, 0, 0, 0), position=(ARM, 0, 0)),
        watch=["forward", "omega", "position", "matrix", "energy"],
        t=6,
        name="chaplygin_sleigh",
        title="Chaplygin's sleigh",
    )
    assert scene == gt.scenes.load("chaplygin_sleigh")

    result = scene.with_values(t=options.t).run()
    print(result)
    # m u' = m a W^2 and (I3 + m a^2) W' = -m a u W: energy is conserved, u = U tanh(k t + c).
    inertia = float(body.tensor[2, 2]) + MASS * ARM**2
    fastest = np.sqrt(SPEED**2 + inertia / MASS * TURN**2)
    phase = MASS * ARM * fastest / inertia * result.times + np.arctanh(SPEED / fastest)
    forward = fastest * np.tanh(phase)
    turning = np.sqrt(MASS / inertia) * fastest / np.cosh(phase)
    gaps = (
        np.abs(result["forward"] - forward).max(),
        np.abs(result["omega"][:, 2] - turning).max(),
    )
    print(f"speed agrees to {gaps[0]:.1e} m/s, turning to {gaps[1]:.1e} rad/s")
    print(f"it began with {SPEED:g} m/s, backwards; it ends with {result['forward'][-1]:.6f} m/s")
    assert max(gaps) < 1e-9


if __name__ == "__main__":
    main()
