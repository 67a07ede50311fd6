"""The naive top: what comes out when a frame is varied as if its one-forms were coordinates.

    python examples/scenes/naive_top.py
    python examples/scenes/naive_top.py --t 100

I Omega' = 0 turns a free body evenly. Nothing turns it, and yet its angular momentum moves about in
space; its energy is conserved, for what the naive law leaves out, Omega x L, does no work.
"""

import argparse

import numpy as np

import geomtorsion as gt


def main(arguments: list[str] | None = None) -> None:
    """The naive law and the right one, from the same start."""
    parser = argparse.ArgumentParser(description="The naive top, and the right one.")
    parser.add_argument("--t", type=float, default=40.0, help="last time, s")
    options = parser.parse_args(arguments)
    scene = gt.Scene(
        gt.Body(mass=1, moments=(1, 2, 3)),
        [gt.effects.Naive()],
        gt.State(omega=(0.5, 0.4, 1), quaternion=(1, 0, 0, 0)),
        watch=["omega", "matrix", "energy", "angular_momentum_space"],
        t=40,
        name="naive_top",
        title="naive top: the wrong equations",
    )
    assert scene == gt.scenes.load("naive_top")

    naive = scene.with_values(t=options.t).run()
    right = gt.scenes.load("euler_top").with_values(t=options.t).run()
    print(f"{'t':>8}{'naive: L in space':>34}{'right: L in space':>34}")
    for k in range(0, len(naive.times), 40):
        rows = [run["angular_momentum_space"][k] for run in (naive, right)]
        shown = "".join(f"{'(' + ', '.join(f'{x:.4f}' for x in row) + ')':>34}" for row in rows)
        print(f"{naive.times[k]:>8.2f}{shown}")

    def change(run: gt.scenes.SceneResult, name: str) -> float:
        """Largest change of a quantity, relative to its size at the start."""
        values = run[name].reshape(len(run.times), -1)
        moved = np.linalg.norm(values - values[0], axis=1)
        return float(moved.max() / np.linalg.norm(values[0]))

    for name in ("energy", "angular_momentum_space"):
        print(
            f"{name}: changes by {change(naive, name):.2g} naively, "
            f"{change(right, name):.1g} rightly"
        )
    # Omega is constant: L goes round it, with the angle between them unchanged.
    omega, momentum = np.array([0.5, 0.4, 1]), np.array([0.5, 0.8, 3])
    across = momentum - (momentum @ omega) / (omega @ omega) * omega
    widest = 2 * np.linalg.norm(across) / np.linalg.norm(momentum)
    assert abs(change(naive, "angular_momentum_space") - widest) < 1e-2
    assert change(right, "angular_momentum_space") < 1e-11
    assert change(naive, "energy") < 1e-11


if __name__ == "__main__":
    main()
