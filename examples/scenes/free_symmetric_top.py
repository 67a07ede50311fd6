"""A free symmetric top: its axis goes round the angular momentum on a cone, evenly.

python examples/scenes/free_symmetric_top.py
python examples/scenes/free_symmetric_top.py --t 200
"""

import argparse

import numpy as np

import geomtorsion as gt


def main(arguments: list[str] | None = None) -> None:
    """Compare rates and axis with their closed forms."""
    parser = argparse.ArgumentParser(description="A free symmetric top.")
    parser.add_argument("--t", type=float, default=20.0, help="last time, s")
    options = parser.parse_args(arguments)
    scene = gt.Scene(
        gt.Body(mass=1, moments=(2, 2, 1)),
        start=gt.State(omega=(0.6, 0, 2), quaternion=(1, 0, 0, 0)),
        watch=["omega", "axis", "matrix", "energy"],
        t=20,
        name="free_symmetric_top",
        title="free symmetric top",
    )
    assert scene == gt.scenes.load("free_symmetric_top")

    result = scene.with_values(t=options.t).run()
    print(result)
    # In the body: Omega1 + i Omega2 turns at (I3 - I1) / I1 times the spin.
    turned = 0.6 * np.exp(1j * (1 - 2) / 2 * 2 * result.times)
    rates = result["omega"][:, 0] + 1j * result["omega"][:, 1]
    # In space: the axis turns about L = (1.2, 0, 2) at |L| / I1.
    momentum = np.array([1.2, 0, 2])
    size = np.linalg.norm(momentum)
    along = momentum / size
    start = np.array([0.0, 0, 1])
    angle = size / 2 * result.times[:, None]
    across = start - (start @ along) * along
    around = np.cos(angle) * across + np.sin(angle) * np.cross(along, across)
    axis = (start @ along) * along + around
    gaps = np.abs(rates - turned).max(), np.abs(result["axis"] - axis).max()
    print(f"rates agree to {gaps[0]:.1e}, the axis on its cone to {gaps[1]:.1e}")
    assert max(gaps) < 1e-10


if __name__ == "__main__":
    main()
