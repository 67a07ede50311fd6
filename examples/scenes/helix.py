"""The straightest path in the frame of a body: its centre draws a helix.

python examples/scenes/helix.py
python examples/scenes/helix.py --t 60
"""

import argparse

import numpy as np

import geomtorsion as gt


def main(arguments: list[str] | None = None) -> None:
    """Compare the path with its closed form."""
    parser = argparse.ArgumentParser(description="The straightest path in the frame of a body.")
    parser.add_argument("--t", type=float, default=15.0, help="last time, s")
    options = parser.parse_args(arguments)
    scene = gt.Scene(
        gt.Body(mass=1, moments=(1, 1, 1)),
        [gt.effects.Torsion()],
        gt.State(
            omega=(0, 0, 1), quaternion=(1, 0, 0, 0), position=(0, 0, 0), velocity=(1, 0, 0.2)
        ),
        watch=["position", "velocity", "matrix", "omega"],
        t=15,
        name="helix",
        title="autoparallel of R^3 x SO(3): a helix",
    )
    assert scene == gt.scenes.load("helix")

    result = scene.with_values(t=options.t).run()
    print(result)
    # Omega and V are constant in the body: x = R(t) V integrated.
    turn, v = np.array([0, 0, 1.0]), np.array([1, 0, 0.2])
    t = result.times[:, None]
    along = (v @ turn) * turn
    across = v - along
    known = along * t + np.sin(t) * across + (1 - np.cos(t)) * np.cross(turn, across)
    gap = np.abs(result["position"] - known).max()
    print(f"the helix agrees with its closed form to {gap:.1e} m; its radius is 1 m")
    radius = np.linalg.norm(result["position"][:, :2] - [0, 1], axis=1)
    assert gap < 1e-9
    assert np.abs(radius - 1).max() < 1e-9


if __name__ == "__main__":
    main()
