"""The shadow of a black hole, seen by a camera that the tetrad carries; and a wormhole.

    python examples/44_the_shadow_of_a_hole.py
    python examples/44_the_shadow_of_a_hole.py --picture shadow.png

A pixel is a direction in the legs of the tetrad. Its ray is followed back until it comes near the
horizon, or escapes. No metric is inverted by hand, so that the same lines serve any frame.
"""

import argparse
from pathlib import Path

import numpy as np
import sympy as sp

import geomtorsion as gt


def kerr(spin: float, distance: float) -> gt.curves.Shadow:
    """The shadow of a hole of mass 1, seen from its equator."""
    camera = [0, distance, np.pi / 2, 0]
    return gt.shadow("kerr", camera, parameters={"M": 1, "a": spin})


def bardeen(spin: float, distance: float) -> list[float]:
    """Angles of the edge on the equator, right and left, from circular photon orbits (1973)."""
    angles = []
    for sign in (-1, 1):
        radius = 2 * (1 + np.cos(2 / 3 * np.arccos(-sign * spin)))
        delta, outside = radius**2 - 2 * radius + spin**2, distance**2 - 2 * distance + spin**2
        xi = (radius**2 + spin**2) / spin - 2 * radius * delta / (spin * (radius - 1))
        energy = (distance**2 + spin**2 - spin * xi) / np.sqrt(outside)
        angles.append(float(np.arcsin(abs(xi - spin) / energy)))
    return angles


def wormhole() -> gt.Frame:
    """Ellis' wormhole: a throat of radius b between two flat worlds."""
    t, length, theta, phi = sp.symbols("t l theta phi", real=True)
    b = sp.Symbol("b", positive=True)
    r = sp.sqrt(length**2 + b**2)
    return gt.Frame(
        [t, length, theta, phi], sp.diag(1, 1, r, r * sp.sin(theta)), signature=(-1, 1, 1, 1),
        parameters=[b], domain=[theta > 0, theta < sp.pi, phi > 0, phi < 2 * sp.pi],
    )  # fmt: skip


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="The shadow of a black hole")
    parser.add_argument("--picture", type=Path, help="file for a figure")
    options = parser.parse_args(arguments)

    hole = kerr(0.9, 30.0)
    edge = hole.edge([0.0, np.pi], accuracy=1e-7)
    print(hole, edge, sep="\n")
    assert np.abs(edge.radii - bardeen(0.9, 30.0)).max() < 1e-6

    # Light passes the throat of a wormhole where its impact parameter is below b.
    view = gt.shadow(
        wormhole(), [0, 3, np.pi / 3, 0], parameters={"b": 2}, dark="l + 10", sky="10 - l"
    )  # fmt: skip
    throat = view.edge([0.0, 1.0, 2.0], accuracy=1e-7)
    print(throat)
    assert np.abs(throat.radii - np.arcsin(2 / np.sqrt(13))).max() < 2e-7

    if options.picture:
        gt.pictures.save(kerr(0.9, 10.0).image(160, field=1.9).plot(), options.picture)


if __name__ == "__main__":
    main()
