"""Crystals with known dislocations, built by hand for the tests."""

from __future__ import annotations

from pathlib import Path

import numpy as np

BOX = np.diag([80.0, 80.0, 14.4])


def copper_screw(shift: float = 0.0, noise: float = 0.0, seed: int = 0) -> np.ndarray:
    """A right-handed screw of b = a [0 0 1] in a cylinder of copper, a = 3.6, periodic along z.

    shift: position of the line along x. The crystal axes are the axes of space.
    """
    sites = np.argwhere(np.ones((32, 32, 8))) - [16, 16, 0]
    places = 1.8 * sites[sites.sum(axis=1) % 2 == 0] + [0.4, 0.6, 0]
    places = places[np.hypot(places[:, 0], places[:, 1]) < 17]
    places[:, 2] += 3.6 * np.arctan2(places[:, 1], places[:, 0] - shift) / (2 * np.pi)
    places += noise * np.random.default_rng(seed).normal(size=places.shape)
    return places + np.array([40, 40, 0])


def xyz(*frames: np.ndarray, periodic: str = "F F T") -> str:
    """Frames as extended XYZ text, each number with all its digits."""
    rows = []
    for places in frames:
        edges = " ".join(map(str, BOX.ravel().tolist()))
        rows += [
            str(len(places)),
            f'Lattice="{edges}" Properties=species:S:1:pos:R:3 pbc="{periodic}"',
        ]
        rows += [f"Cu {x!r} {y!r} {z!r}" for x, y, z in places.tolist()]
    return "\n".join(rows) + "\n"


def written(folder: Path, *frames: np.ndarray) -> Path:
    """Write these frames to a file and return its path."""
    path = folder / "atoms.xyz"
    path.write_text(xyz(*frames), "utf-8")
    return path
