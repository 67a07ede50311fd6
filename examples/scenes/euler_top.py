"""A free asymmetric top: rates in Jacobi's elliptic functions, angular momentum at rest in space.

python examples/scenes/euler_top.py
python examples/scenes/euler_top.py --t 1000
"""

import argparse

import numpy as np
from scipy.special import ellipj, ellipkinc

import geomtorsion as gt


def rates(moments: tuple[float, ...], start: tuple[float, ...], t: np.ndarray) -> np.ndarray:
    """Landau and Lifshitz, section 37, for L^2 > 2 E I2: shape (m, 3)."""
    i1, i2, i3 = moments
    energy = sum(i * w**2 for i, w in zip(moments, start, strict=True))
    square = sum((i * w) ** 2 for i, w in zip(moments, start, strict=True))
    rate = np.sqrt((i3 - i2) * (square - energy * i1) / (i1 * i2 * i3))
    m = (i2 - i1) * (energy * i3 - square) / ((i3 - i2) * (square - energy * i1))
    sizes = [
        np.sqrt((energy * i3 - square) / (i1 * (i3 - i1))),
        np.sqrt((energy * i3 - square) / (i2 * (i3 - i2))),
        np.sqrt((square - energy * i1) / (i3 * (i3 - i1))),
    ]
    # Where the motion is at the start: cn = W1 / size, sn = W2 / size.
    phase = ellipkinc(np.arctan2(start[1] / sizes[1], start[0] / sizes[0]), m)
    sn, cn, dn, _ = ellipj(rate * t + phase, m)
    return np.stack([sizes[0] * cn, sizes[1] * sn, sizes[2] * dn], axis=1)


def main(arguments: list[str] | None = None) -> None:
    """Run the scene and compare with the formulas."""
    parser = argparse.ArgumentParser(description="A free asymmetric top.")
    parser.add_argument("--t", type=float, default=40.0, help="last time, s")
    options = parser.parse_args(arguments)
    scene = gt.Scene(
        gt.Body(mass=1, moments=(1, 2, 3)),
        start=gt.State(omega=(0.5, 0.4, 1), quaternion=(1, 0, 0, 0)),
        watch=["omega", "matrix", "energy", "angular_momentum_space"],
        t=40,
        name="euler_top",
        title="free asymmetric top",
    )
    assert scene == gt.scenes.load("euler_top")

    result = scene.with_values(t=options.t).run()
    print(result)
    known = rates((1, 2, 3), (0.5, 0.4, 1), result.times)
    gap = np.abs(result["omega"] - known).max()
    momentum = result["angular_momentum_space"]
    drift = np.abs(momentum - momentum[0]).max()
    print(f"elliptic functions agree to {gap:.1e}; angular momentum moves by {drift:.1e}")
    assert gap < 1e-10
    assert drift < 1e-11


if __name__ == "__main__":
    main()
