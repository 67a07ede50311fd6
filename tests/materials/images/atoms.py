"""Synthetic images of crystals, column by column, with a dislocation of known Burgers vector."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

POISSON = 0.3


def edge_displacement(x: np.ndarray, y: np.ndarray, b: float) -> tuple[np.ndarray, np.ndarray]:
    """u of an edge dislocation, b along x; Hirth and Lothe, Theory of Dislocations (1982)."""
    square = x * x + y * y
    ux = np.arctan2(y, x) + x * y / (2 * (1 - POISSON) * square)
    uy = (1 - 2 * POISSON) / (4 * (1 - POISSON)) * np.log(square)
    uy += (x * x - y * y) / (4 * (1 - POISSON) * square)
    return b / (2 * np.pi) * ux, -b / (2 * np.pi) * uy


def edge_strain_xx(x: np.ndarray, y: np.ndarray, b: float) -> np.ndarray:
    """epsilon_xx = d u_x / dx of the same field."""
    square = x * x + y * y
    top = y * ((3 - 2 * POISSON) * x**2 + (1 - 2 * POISSON) * y**2)
    return -b / (4 * np.pi * (1 - POISSON)) * top / square**2


@dataclass(frozen=True)
class Crystal:
    """An image and its known properties, lengths in pixels.

    values: rows from the top. vectors: g_1, g_2 as rows, cycles per pixel. b: integral of du along
    a right-handed circuit, x to the right and y upwards. centre: position of the dislocation.
    """

    values: np.ndarray
    vectors: np.ndarray
    b: np.ndarray
    centre: tuple[float, float]

    def noisy(self, level: float, seed: int) -> np.ndarray:
        """The image with white noise; level: standard deviation over the peak height of an atom."""
        return self.values + level * np.random.default_rng(seed).normal(size=self.values.shape)


def crystal(
    size: int, kind: str, spacing: float = 8.0, turned: float = 0.1, dislocated: bool = True
) -> Crystal:
    """Gaussian atoms of height one on a square or hexagonal lattice, moved by an edge field."""
    rows = {"square": [[1, 0], [0, 1]], "hexagonal": [[1, 0], [0.5, np.sqrt(0.75)]]}[kind]
    basis = spacing * np.array(rows)
    count = int(2 * size / spacing)
    numbers = np.stack(np.meshgrid(*2 * [np.arange(-count, count)], indexing="ij"), axis=-1)
    # The core is between atoms.
    places = numbers.reshape(-1, 2) @ basis + np.array([0.31, 0.47]) * spacing
    places = places[(np.abs(places) < size).all(axis=1)]
    if dislocated:
        places = places + np.stack(edge_displacement(*places.T, spacing), axis=1)
    cos, sin = np.cos(turned), np.sin(turned)
    rotation = np.array([[cos, -sin], [sin, cos]])
    centre = (size - 1) / 2 + 0.3
    places = places @ rotation.T + centre
    places = places[(np.abs(places - centre) < size / 2 + 4 * spacing).all(axis=1)]
    width, line = spacing / 5, np.arange(size)
    x, y = (np.exp(-(((line[:, None] - p) / width) ** 2) / 2) for p in places.T)
    values = np.ascontiguousarray((x @ y.T).T[::-1])
    b = rotation @ np.array([spacing, 0.0]) if dislocated else np.zeros(2)
    return Crystal(values, np.linalg.inv(basis @ rotation.T).T, b, (centre, centre))
