"""The Burgers vector of a picture: atoms around an edge dislocation, covered with noise.

    python examples/15_burgers_vector_of_an_image.py
    python examples/15_burgers_vector_of_an_image.py --noise 1.5 --picture lattice.png

An electron microscope shows columns of atoms. Two spots of the Fourier transform belong to the
lattice; the phases of their waves measure positions along the lattice. Along a circuit around a
dislocation a phase changes by a whole number of turns, the Burgers vector in lattice vectors,
however bent the crystal is. If noise could have changed the number, the result is refused.
"""

import argparse
from pathlib import Path

import numpy as np

from geomtorsion.errors import ImageError
from geomtorsion.loops import Loop
from geomtorsion.materials.images import LatticeImage


def micrograph(size: int, spacing: float, noise: float, seed: int) -> np.ndarray:
    """Rows of atoms with height one around an edge dislocation in the middle; b_0 is along x."""
    numbers = np.arange(-size // spacing, size // spacing)
    x, y = (spacing * (k.ravel() + 0.5) for k in np.meshgrid(numbers, numbers))
    # Displacement in an elastic medium with Poisson's ratio 0.3.
    square = x * x + y * y
    ux = spacing / (2 * np.pi) * (np.arctan2(y, x) + x * y / (1.4 * square))
    uy = -spacing / (2 * np.pi) * (np.log(square) / 7 + (x * x - y * y) / (2.8 * square))
    line = np.arange(size) - (size - 1) / 2
    columns, rows = (
        np.exp(-(((line[:, None] - place) / (spacing / 5)) ** 2) / 2) for place in (x + ux, y + uy)
    )
    random = np.random.default_rng(seed).normal(size=(size, size))
    # The first row of an image is its top.
    return (rows @ columns.T)[::-1] + noise * random


def main(arguments: list[str] | None = None) -> None:
    """Make an image, find its lattice, and follow a circuit around the dislocation."""
    parser = argparse.ArgumentParser(description="The Burgers vector of a lattice image.")
    parser.add_argument("--noise", type=float, default=1.0, help="in units of the peak of an atom")
    parser.add_argument("--picture", type=Path, help="draw phases and strain into this file")
    options = parser.parse_args(arguments)

    size, step = 256, 0.032
    image = LatticeImage(micrograph(size, 8.0, options.noise, seed=1), step, "nm")
    phases = image.phases()
    print(f"{image}: {phases}")
    print(f"    lattice vectors {phases.lattice.round(4).tolist()} nm; true lengths 0.256 nm")
    assert abs(phases.lattice - 0.256 * np.eye(2)).max() < 0.01 * 0.256

    middle = step * (size - 1) / 2
    circuit = Loop.circle([middle, middle], 0.3 * size * step)
    b = phases.burgers(circuit)
    print(f"Around the dislocation: {b}")
    print(f"    b = {b.vector.round(4).tolist()} nm +- {b.error:.1g} nm")
    assert b.whole.tolist() == [-1, 0]  # minus the integral of du
    assert abs(b.vector - [-0.256, 0]).max() <= b.error

    beside = Loop.circle([0.5 * middle, middle], 0.2 * middle)
    print(f"Beside it: {phases.burgers(beside)}")
    assert phases.burgers(beside).whole.tolist() == [0, 0]

    print("With increasing noise:")
    for noise in (2, 3, 4, 5):
        drowned = LatticeImage(micrograph(size, 8.0, noise, seed=1), step, "nm")
        try:
            told = drowned.phases(phases.spots).burgers(circuit)
        except ImageError as error:
            print(f"    {noise} times the peak of an atom: refused: {str(error).split(':')[0]}.")
            continue
        print(f"    {noise} times the peak of an atom: {told}")
        assert told.whole.tolist() == [-1, 0]

    if options.picture:
        from geomtorsion.pictures.lattice import draw_lattice

        draw_lattice(image, phases, b).savefig(options.picture)
        print(f"wrote {options.picture}")


if __name__ == "__main__":
    main()
