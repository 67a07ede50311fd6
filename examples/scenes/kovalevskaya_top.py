"""Kovalevskaya's top: a heavy top that keeps a fourth integral.

python examples/scenes/kovalevskaya_top.py
python examples/scenes/kovalevskaya_top.py --t 100
"""

import argparse

import numpy as np

import geomtorsion as gt


def main(arguments: list[str] | None = None) -> None:
    """Her integral, with her moments and with others."""
    parser = argparse.ArgumentParser(description="Kovalevskaya's top.")
    parser.add_argument("--t", type=float, default=20.0, help="last time, s")
    options = parser.parse_args(arguments)
    scene = gt.Scene(
        gt.Body(mass=1, moments=(2, 2, 1)),
        [gt.effects.Gravity(10), gt.effects.Pivot((10 * 1e-2, 0, 0), moments_at="pivot")],
        gt.State(omega=(0.5, 0.2, 1), euler=(0, 1, 0)),
        watch=["omega", "vertical", "nutation", "energy"],
        t=20,
        name="kovalevskaya_top",
        title="Kovalevskaya's top",
    )
    assert scene == gt.scenes.load("kovalevskaya_top")

    def integral(moments: tuple[float, ...]) -> np.ndarray:
        """|(W1 + i W2)^2 - (m g a / I3) (n1 + i n2)|^2 over time, n upwards."""
        result = scene.with_values({"t": options.t, "body.moments": moments}).run()
        w, n = result["omega"], result["vertical"]
        print(result)
        pull = 1 * 10 * 0.1 / moments[2]
        z = (w[:, 0] + 1j * w[:, 1]) ** 2 - pull * (n[:, 0] + 1j * n[:, 1])
        return np.abs(z) ** 2

    hers, others = integral((2, 2, 1)), integral((2, 2, 1.5))
    drift = np.abs(hers - hers[0]).max() / hers[0]
    print(f"her integral {hers[0]:.6f} drifts by {drift:.1e}; with I3 = 1.5 it is none: ", end="")
    print(f"{others.min():.3f} to {others.max():.3f}")
    assert drift < 1e-9
    assert np.ptp(others) > 0.1


if __name__ == "__main__":
    main()
