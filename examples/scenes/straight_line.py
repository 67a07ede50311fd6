"""The shortest path: a free body turns as it likes, its centre goes straight on.

python examples/scenes/straight_line.py
python examples/scenes/straight_line.py --t 60
"""

import argparse

import numpy as np

import geomtorsion as gt


def main(arguments: list[str] | None = None) -> None:
    """Compare the path with a straight line, and the velocity as the body sees it."""
    parser = argparse.ArgumentParser(description="The shortest path.")
    parser.add_argument("--t", type=float, default=15.0, help="last time, s")
    options = parser.parse_args(arguments)
    scene = gt.Scene(
        gt.Body(mass=1, moments=(1, 1, 1)),
        [gt.effects.Drift()],
        gt.State(
            omega=(0, 0, 1), quaternion=(1, 0, 0, 0), position=(0, 0, 0), velocity=(1, 0, 0.2)
        ),
        watch=["position", "velocity", "matrix", "omega"],
        t=15,
        name="straight_line",
        title="geodesic of R^3 x SO(3): a straight line",
    )
    assert scene == gt.scenes.load("straight_line")

    result = scene.with_values(t=options.t).run()
    print(result)
    known = np.outer(result.times, [1, 0, 0.2])
    gap = np.abs(result["position"] - known).max()
    # Seen from the body the velocity turns: V' + Omega x V = 0.
    turned = np.einsum("mji,mj->mi", result["matrix"].reshape(-1, 3, 3), result["velocity"])
    seen = np.stack([np.cos(result.times), -np.sin(result.times), 0 * result.times + 0.2], axis=1)
    print(f"straight on to {gap:.1e} m; in the body the velocity turns once in 2 pi seconds")
    assert gap < 1e-12
    assert np.abs(turned - seen).max() < 1e-9


if __name__ == "__main__":
    main()
