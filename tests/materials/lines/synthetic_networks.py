"""Synthetic networks of lines with known answers."""

import numpy as np

from geomtorsion.materials.lines import Box, LineArrays

# A simulated network, stored outside the project.
REAL = "networks/180chains_16.10e.data"


def rings(count: int, seed: int, size: float = 10.0, sides: int = 12) -> LineArrays:
    """Closed polygons in random planes of a periodic cube, with b of the fcc kind."""
    rng = np.random.default_rng(seed)
    angles = 2 * np.pi * np.arange(sides) / sides
    places, pairs, vectors = [], [], []
    for k in range(count):
        first, second = np.linalg.qr(rng.normal(size=(3, 2)))[0].T
        radius = rng.uniform(0.05, 0.3) * size
        offsets = np.outer(np.cos(angles), first) + np.outer(np.sin(angles), second)
        places.append(rng.uniform(0, size, 3) + radius * offsets)
        nodes = sides * k + np.arange(sides)
        pairs.append(np.stack([nodes, np.roll(nodes, -1)], axis=1))
        b = rng.permutation([1.0, rng.choice([-1.0, 1.0]), 0.0]) / np.sqrt(2)
        vectors.append(np.repeat(b[None], sides, axis=0))
    # Nodes are in the box, as simulations write them: lines leave on one side and come back.
    wrapped = np.mod(np.concatenate(places), size)
    box = Box.of_bounds([0, 0, 0], [size] * 3)
    return LineArrays(wrapped, np.concatenate(pairs), np.concatenate(vectors), box)


def straight(places, vectors, height: float = 4.0, periodic=(False, False, True)) -> LineArrays:
    """Straight lines along z through (x, y), three nodes each, periodic along z."""
    box = Box.of_bounds([-50, -50, 0], [50, 50, height], periodic)
    nodes = [[x, y, z * height] for x, y in places for z in (0.1, 0.45, 0.8)]
    pairs = [[3 * k + j, 3 * k + (j + 1) % 3] for k in range(len(places)) for j in range(3)]
    rows = [b for b in vectors for _ in range(3)]
    return LineArrays(nodes, pairs, rows, box)
