"""Measured fields: a dislocation from displacements, strains, and scattered points, with noise.

    python examples/17_measured_fields.py
    python examples/17_measured_fields.py field.npz --size 24 --pictures out

An edge dislocation of b = 0.286 nm in aluminium is measured in three ways. Image correlation gives
its displacement, which jumps by b across an invisible cut; differences across the cut would lose b.
Diffraction gives strain and rotation but nothing in the core; the circuit around this hole still
gives b. Tracked particles give the displacement at scattered points. Each measurement has noise,
and each result has an error.
"""

import argparse
from pathlib import Path

import numpy as np

import geomtorsion as gt
from geomtorsion.materials import Burgers

B, NU = np.array([0.286, 0.0]), 0.345
LINE = np.linspace(-4, 4, 81)


def displacement(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """u of Hirth and Lothe (1982), (3-45), in nm; its cut is y = 0, x < 0."""
    r2 = x**2 + y**2
    u = np.arctan2(y, x) + x * y / (2 * (1 - NU) * r2)
    v = -((1 - 2 * NU) * np.log(r2) + (x**2 - y**2) / r2) / (4 * (1 - NU))
    return B[0] / (2 * np.pi) * np.array([u, v])


def distortion(x: np.ndarray, y: np.ndarray, step: float = 1e-4) -> np.ndarray:
    """d_j u_i by central differences, with no jump between their points."""
    cut = (y > -step) & (y < step) & (x < 0)
    assert not cut.any()
    sides = [(step, 0.0), (0.0, step)]
    columns = [
        (displacement(x + dx, y + dy) - displacement(x - dx, y - dy)) / (2 * step)
        for dx, dy in sides
    ]
    return np.stack(columns, axis=1)


def tell(what: str, b: Burgers, bound: float) -> None:
    """Print a result with its error, and check that it is right within three times this error."""
    print(f"{what}: {b}, significance {b.significance:.0f}")
    assert np.abs(b.vector - B).max() < 3 * b.error < bound


def main(arguments: list[str] | None = None) -> None:
    """Measure displacement, strain with rotation, scattered points, and a file if one is given."""
    parser = argparse.ArgumentParser(description="Burgers vectors of measured fields.")
    parser.add_argument("file", nargs="?", type=Path, help="a field: .npz, .nc, .csv, .h5, .vtk")
    parser.add_argument("--size", type=int, default=24, help="cells along a side of a square")
    parser.add_argument("--pictures", type=Path, help="write a picture into this folder")
    options = parser.parse_args(arguments)
    rng = np.random.default_rng(1)
    # The grid has no node on the line of the cut.
    x, y = np.meshgrid(LINE, LINE + 0.03, indexing="ij")
    axes = [LINE, LINE + 0.03]
    circle = gt.Loop.circle([0, 0], 3)

    u = displacement(x, y) + 2e-3 * rng.normal(size=(2, *x.shape))
    field = gt.SampledFrame.from_displacement(axes, u, branch="find", sigma="estimate", unit="nm")
    print(field, field.source, sep="\n")
    tell("displacement", field.burgers(circle), 0.1)
    naive = np.stack([np.gradient(part, *axes) for part in u])
    lost = gt.SampledFrame.from_distortion(axes, naive).burgers(circle)
    print(f"differences across the cut: {lost.vector.round(3)}")
    assert abs(lost.vector[0]) < 0.1 * B[0]

    beta = distortion(x, y) + 5e-3 * rng.normal(size=(2, 2, *x.shape))
    strain, turn = (beta + beta.swapaxes(0, 1)) / 2, (beta[1, 0] - beta[0, 1]) / 2
    core = np.hypot(x, y) < 0.8
    # Strain and rotation contain halves of the same off-diagonal values, so components correlate.
    field = gt.SampledFrame.from_strain_rotation(
        axes, strain, turn, mask=core, covariance="estimate", unit="nm"
    )
    tell("strain and rotation", field.burgers(field.loop_around(margin=6)), 0.1)
    squares = field.burgers_map(options.size)
    best = np.nanmax(squares.significance)
    print(f"{squares}; highest significance {best:.0f}")
    assert best > 20

    points = rng.uniform(-4, 4, (4000, 2))
    u = displacement(*points.T) + 2e-3 * rng.normal(size=(2, len(points)))
    scattered = gt.ScatteredFrame.from_displacement(points, u, branch=B[0], sigma=2e-3, unit="nm")
    b = scattered.burgers(circle)
    print(f"scattered displacement: {b}: whole lattice vectors")
    assert np.abs(b.vector - B).max() < 1e-9
    known = np.abs(points[:, 1]) > 1e-3
    beta = distortion(*points[known].T)
    beta += 5e-3 * rng.normal(size=beta.shape)
    scattered = gt.ScatteredFrame.from_distortion(
        points[known], beta, mask=np.hypot(*points[known].T) < 0.8, sigma="estimate", unit="nm"
    )
    print(scattered)
    tell("scattered distortion", scattered.burgers(circle), 0.1)

    if options.file:
        field = gt.SampledFrame.read(options.file)
        print(field, field.burgers_map(options.size), sep="\n")
    if options.pictures:
        from geomtorsion.pictures.measured import draw_survey

        options.pictures.mkdir(parents=True, exist_ok=True)
        draw_survey(field.burgers_map(options.size)).savefig(options.pictures / "squares.png")
        print(f"wrote squares.png into {options.pictures}")


if __name__ == "__main__":
    main()
