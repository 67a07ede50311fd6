"""Dzhanibekov's flip: a body about its middle axis turns over, after an elliptic integral.

python examples/scenes/dzhanibekov.py
python examples/scenes/dzhanibekov.py --picture flips.png
"""

import argparse

import numpy as np
from scipy.special import ellipkm1

import geomtorsion as gt


def flip_time(tilt: float) -> float:
    """Half a period of the middle component for moments 1, 2, 3 and omega = (tilt, 1, 0)."""
    square, energy = tilt**2 + 4, tilt**2 + 2
    rate = np.sqrt((2 - 1) * (3 * energy - square) / 6)
    return 2 * ellipkm1(tilt**2 / (1 + tilt**2)) / rate


def main(arguments: list[str] | None = None) -> None:
    """One flip, and how long bodies wait that start ever closer to the axis."""
    parser = argparse.ArgumentParser(description="Dzhanibekov's flip.")
    parser.add_argument("--picture", help="file for the picture of the sweep")
    options = parser.parse_args(arguments)
    scene = gt.Scene(
        gt.Body(mass=1, moments=(1, 2, 3)),
        start=gt.State(omega=(1e-3, 1, 0), quaternion=(1, 0, 0, 0)),
        watch=["omega", "matrix", "energy"],
        t=60,
        name="dzhanibekov",
        title="Dzhanibekov's flip",
    )
    assert scene == gt.scenes.load("dzhanibekov")

    print(scene.run())
    flip = "between zeros omega[1]"
    tilts = np.geomspace(1e-12, 0.1, 12)
    sweep = scene.with_values(t=160).sweep({"start.omega[0]": tilts}, flip)
    print(f"\n{'tilt':>10}{'flip after':>16}{'elliptic integral':>20}")
    for tilt, found in zip(tilts, sweep[flip], strict=True):
        print(f"{tilt:>10.1e}{found:>14.8f} s{flip_time(tilt):>18.8f} s")
    if options.picture:
        sweep.plot(options.picture, known=flip_time, known_name="elliptic integral")
    known = np.array([flip_time(tilt) for tilt in tilts])
    assert np.abs(sweep[flip] / known - 1).max() < 1e-10


if __name__ == "__main__":
    main()
