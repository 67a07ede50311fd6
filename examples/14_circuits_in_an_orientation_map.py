"""Circuits in an orientation map: a tilt wall, its noise, its grains, and a measured file.

    python examples/14_circuits_in_an_orientation_map.py
    python examples/14_circuits_in_an_orientation_map.py scan.ctf --size 8 --pictures out

An EBSD map is a coframe that rotates and does not stretch: e^i_mu is the rotation from specimen to
crystal, and its integral around a circuit is the Burgers vector of all dislocations inside. This
crystal has a tilt wall of two degrees, noise of 0.1 degrees on each pixel, and a second grain. Each
pixel is in one of 24 equivalent orientations, as instruments report it.
"""

import argparse
from pathlib import Path

import numpy as np

import geomtorsion as gt
from geomtorsion.materials.maps import laue_group
from geomtorsion.rigid.attitude import product, quaternion_from_rotation_vector

# Beside a checkout: a silicon wafer, whose map contains only noise.
WAFER = Path(__file__).parents[2] / "shared/data/ebsd/si_wafer.ctf"
TILT, NOISE, STEP = 2.0, 0.1, 0.2
NICKEL = gt.Phase("nickel", "m-3m", (3.524, 3.524, 3.524))


def crystal(seed: int = 1) -> gt.OrientationMap:
    """80 x 120 pixels: a wall at column 40, a grain boundary at column 90."""
    rng = np.random.default_rng(seed)
    shape = (80, 120)
    turns = np.zeros((*shape, 3))
    turns[:, :40, 2], turns[:, 40:, 2] = -TILT / 2, TILT / 2
    turns[:, 90:] = (25.0, 10.0, 5.0)
    known = quaternion_from_rotation_vector(np.radians(turns))
    noise = quaternion_from_rotation_vector(np.radians(rng.normal(0, NOISE, turns.shape)))
    variants = laue_group("m-3m").quaternions[rng.integers(24, size=shape)]
    measured = product(product(noise, known), variants)
    return gt.OrientationMap(measured, np.ones(shape), {1: NICKEL}, (STEP, STEP))


def tell(found: gt.OrientationMap, size: int) -> None:
    """Print the Burgers vectors of the squares of one size."""
    squares = found.burgers_map(size)
    print(f"{found}: {found.grains.count} grains; {squares}")
    print(
        f"|b| per area: median {np.nanmedian(squares.per_area):.2e} 1/um, noise only "
        f"{np.nanmedian(squares.floor):.2e} 1/um"
    )


def main(arguments: list[str] | None = None) -> None:
    """Measure the wall, then a file if one is given."""
    parser = argparse.ArgumentParser(description="Burgers vectors in orientation maps.")
    parser.add_argument("file", nargs="?", type=Path, help="a .ctf or .ang file")
    parser.add_argument("--size", type=int, default=8, help="cells along a side of a square")
    parser.add_argument("--pictures", type=Path, help="write pictures into this folder")
    options = parser.parse_args(arguments)

    made = crystal()
    tell(made, options.size)
    assert made.grains.count == 2

    # The circuit contains 60 pixels of the wall, in steps of 0.2 um: L = 12 um.
    b = made.burgers(gt.Circuit.rectangle((10, 30), 60, 20))
    expected = 2 * np.sin(np.radians(TILT / 2))
    print(f"{b}\n|b| / L = {b.magnitude / 12:.5f}, 2 sin(theta / 2) = {expected:.5f}")
    assert abs(b.magnitude / 12 - expected) < 4 * b.noise / 12
    (lines,) = b.lines((0.5, 0.5, 0))
    print(f"{lines}; the noise is {b.noise:.1e} um, the significance {b.significance:.0f}")
    assert b.significance > 100

    quiet = made.burgers(gt.Loop.circle([14, 8], 3))
    print(f"beside the wall: {quiet.magnitude:.1e} um, noise {quiet.noise:.1e} um")
    assert quiet.significance < 4
    try:
        made.burgers(gt.Circuit.square((10, 80), 20))
    except gt.GeomtorsionError as error:
        print(f"across the boundary: {error}")

    if WAFER.is_file():
        wafer = gt.OrientationMap.read(WAFER)
        tell(wafer, 8)
        assert wafer.burgers_map(8).significance.max() < 5

    shown = made
    if options.file:
        shown = gt.OrientationMap.read(options.file)
        tell(shown, options.size)
    if options.pictures:
        from geomtorsion.pictures.measured import draw_circuits, draw_survey

        options.pictures.mkdir(parents=True, exist_ok=True)
        draw_survey(shown.burgers_map(options.size)).savefig(options.pictures / "squares.png")
        draw_circuits(made, [b]).savefig(options.pictures / "wall.png")
        print(f"wrote squares.png and wall.png into {options.pictures}")


if __name__ == "__main__":
    main()
